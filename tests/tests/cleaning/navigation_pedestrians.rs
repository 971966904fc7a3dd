//! A small slice of `cargo xtask reproduce pedestrians`.

use floorguard_tests::data::recording;
use floorguard_tests::pedestrians::{
    Behaviour, Policy, Recording, SCENES, Trial, draw, drive, example_robot, undisturbed,
};

fn quiet_scene() -> Option<Recording> {
    let (_, file) = SCENES[3];
    let path = recording(&format!("trajectories/eth_ucy/{file}.txt.gz"))?;
    Some(Recording::load(&path).expect("tracks"))
}

/// One start in the recording with the fewest people: the goal is reached without a collision, and two runs are equal to the bit.
#[test]
fn drive_among_recorded_people_repeats_itself() {
    let Some(recording) = quiet_scene() else { return };
    let robot = example_robot().unwrap();
    let start = draw(&recording, 1).expect("people are there");
    let alone = undisturbed(&recording, &start);
    let trial = Trial { start, behaviour: Behaviour::Reacting, policy: Policy::Ours, seed: 1 };
    let once = |()| drive(&robot, &recording, (&trial, Some(&alone)));
    let [first, second] = [(), ()].map(once);
    println!("{first:?}");
    assert_eq!(first, second);
    assert!(first.is_reached && first.people > 0, "{first:?}");
    assert_eq!(first.driven_into, 0, "{first:?}");
}

/// Without a robot between them people follow the recording: nobody is delayed by nobody.
#[test]
fn undisturbed_people_are_not_delayed() {
    let Some(recording) = quiet_scene() else { return };
    let start = draw(&recording, 1).expect("people are there");
    let [once, again] = [(), ()].map(|()| undisturbed(&recording, &start));
    assert!(once.passages.len() > 5 && once.passages == again.passages);
    let walks = once.passages.iter().map(|(number, passage)| (&recording.walks[*number], passage));
    let entered_whole = walks.filter(|(walk, _)| walk.begins_s > start.begins_s);
    let late: Vec<f32> = entered_whole.map(|(walk, passage)| passage.time_s - walk.lasts_s()).collect();
    let mean_s = late.iter().sum::<f32>() / late.len().max(1) as f32;
    println!("{} people, late by {mean_s} s", late.len());
    assert!(late.len() > 3 && mean_s.abs() < 3.0, "{late:?}");
}
