//! Three people walk through a hall, recorded by a real VLP-16: each must be followed, with one identity.

use std::collections::{BTreeMap, BTreeSet};

use floorguard_drivers::velodyne::{Decoder, Model, ModelChoice, SweepBuilder};
use floorguard_perception::people::{FloorHeight, PeoplePipeline, RingAngles, SweepContext};
use floorguard_recording::capture::Capture;
use floorguard_tests::data::recording;
use floorguard_types::geometry::{Point2, Point3, Pose2, Transform3, Twist2};
use floorguard_types::sensing::Sweep;
use floorguard_types::time::Stamp;

struct KeyRow {
    frame: usize,
    person: usize,
    position: Point2,
}

fn columns(text: &str) -> Vec<Vec<f64>> {
    text.lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect())
        .collect()
}

/// One sweep per frame of the key, from that frame's own packets.
fn sweeps() -> Option<Vec<Sweep>> {
    let capture = recording("vlp16_clouds/fabu_hall_people_A_reencoded.pcap.gz")?;
    let frames = recording("vlp16_clouds/fabu_hall_people_A_reencoded.frames.csv")?;
    let payloads: Vec<_> = Capture::open(&capture).expect("opens").map(|each| each.expect("whole")).collect();
    let mut decoder = Decoder::new(ModelChoice::Fixed(Model::Vlp16));
    let mut sweeps = Vec::new();
    for row in columns(&std::fs::read_to_string(frames).expect("a key is text")) {
        let (packets, first) = (row[3] as usize, row[4] as usize);
        let mut building = Box::new(Sweep::<16>::EMPTY);
        let mut complete: Option<Sweep> = None;
        let mut builder: Option<SweepBuilder> = None;
        for datagram in &payloads[first..first + packets] {
            let arrival = Stamp::from_micros(datagram.captured_us);
            let Ok((packet, _)) = decoder.decode(&datagram.payload, arrival) else { continue };
            let builder = builder.get_or_insert_with(|| SweepBuilder::new(packet.columns[0].azimuth_cdeg));
            builder.add(&packet, 0, &mut building, |sweep| complete = Some(sweep.clone()));
        }
        sweeps.push(complete.unwrap_or(*building));
    }
    Some(sweeps)
}

fn key() -> Option<Vec<KeyRow>> {
    let path = recording("vlp16_clouds/fabu_hall_people_A_reencoded.pseudo_tracks.csv")?;
    let rows = columns(&std::fs::read_to_string(path).expect("a key is text"));
    Some(
        rows.iter()
            .map(|row| KeyRow {
                frame: row[0] as usize,
                person: row[2] as usize,
                position: Point2::new(row[3] as f32, row[4] as f32),
            })
            .collect(),
    )
}

#[test]
fn three_walking_people_keep_their_identity() {
    let (Some(sweeps), Some(key)) = (sweeps(), key()) else { return };
    let angles = RingAngles::vlp16();
    let height_m = FloorHeight::estimate_m(&sweeps[0], &angles).expect("the hall has a floor");
    assert!((0.4..0.8).contains(&height_m), "the key says about 0.6 m, found {height_m}");
    let context = SweepContext {
        sensor_in_base: Transform3 { translation: Point3::new(0.0, 0.0, height_m), ..Transform3::IDENTITY },
        twist: Twist2::ZERO,
        base_in_odom: Pose2::default(),
    };
    let mut pipeline = Box::new(PeoplePipeline::new(angles));
    let (mut keyed, mut followed) = ([0_u32; 3], [0_u32; 3]);
    let (mut people, mut others) = ([0_u32; 3], 0_usize);
    let mut identities: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
    for (frame, sweep) in sweeps.iter().enumerate() {
        let output = pipeline.process(sweep, &context);
        let mut taken = BTreeSet::new();
        for row in key.iter().filter(|row| row.frame == frame && row.person < 3 && row.position.norm() < 12.0)
        {
            keyed[row.person] += 1;
            let nearest = output
                .tracks
                .iter()
                .filter(|track| !taken.contains(&track.id))
                .map(|track| (track.state.position.distance(row.position), track.id))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            if let Some((distance_m, id)) = nearest.filter(|(distance_m, _)| *distance_m < 0.5) {
                followed[row.person] += 1;
                taken.insert(id);
                let track = output.tracks.iter().find(|track| track.id == id);
                people[row.person] += u32::from(track.is_some_and(|track| track.person_probability >= 0.5));
                let history = identities.entry(row.person).or_default();
                if history.last() != Some(&id) {
                    history.push(id);
                }
                let _ = distance_m;
            }
        }
        let claimed = output.tracks.iter().filter(|track| track.person_probability >= 0.5);
        others += claimed.filter(|track| !taken.contains(&track.id)).count();
    }
    println!("taken for people in {people:?} frames, and {others} others in {} frames", sweeps.len());
    println!("followed {followed:?} of {keyed:?}, identities {identities:?}, floor at {height_m} m");
    for person in 0..3 {
        let share = f64::from(followed[person]) / f64::from(keyed[person]);
        assert!(share >= 0.90, "person {person}: followed in {share:.3} of the frames");
        assert!(
            identities[&person].len() <= 2,
            "person {person} had the identities {:?}",
            identities[&person]
        );
    }
}
