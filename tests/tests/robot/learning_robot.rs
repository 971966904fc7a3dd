//! `[learning]` in the live robot: what is learned changes the list of people, never what the guard permits; and a
//! recording learns the same once more.

use floorguard_laboratory::world::record_plan;
use std::io::BufReader;
use std::path::Path;

use floorguard_configuration::EXAMPLE;
use floorguard_laboratory::world::{Observation, Observer, Plan, run_recorded};
use floorguard_operator::report::{Circumstances, document, read_history};
use floorguard_operator::telemetry::RunSinks;
use floorguard_operator::words::Language;
use floorguard_perception::online_learning::Weights;
use floorguard_recording::Recording;
use floorguard_recording::replay::{ReplayAudience, ReplayOutcome, replay_recording};
use floorguard_robot::learning::{
    LearningReport, LearningSetup, anchors_fingerprint, load_weights, save_weights, shipped_anchors,
};
use floorguard_runtime::shared::PeopleReport;

/// Time enough to be started by hand and to meet what looks like people.
const SECONDS: u64 = 16;

fn plan() -> Plan {
    Plan::named("supermarket", 3, SECONDS * 1_000_000).expect("a built-in scenario")
}

fn play(plan: &Plan, record: Option<&Path>) -> Observation {
    let mut quiet = |_: f64, _: &_, _: usize, _: &[_]| {};
    let mut observer = Observer::new(plan, &mut quiet);
    let mut sinks = RunSinks::default();
    if let Some(path) = record {
        record_plan(&mut sinks, plan, path).expect("it is recorded");
    }
    run_recorded(plan, &mut observer, &mut sinks).expect("it runs");
    observer.into_observation()
}

struct NoAudience;

impl ReplayAudience for NoAudience {
    fn on_people(&mut self, _report: &PeopleReport, _digest: u64) {}
}

fn replay(path: &Path) -> ReplayOutcome {
    let file = std::fs::File::open(path).expect("the recording is there");
    let mut recording = Recording::new(BufReader::new(file));
    let first = recording.next().expect("a message").expect("it is whole");
    replay_recording(first, &mut recording, &mut NoAudience).expect("it is ours")
}

/// Without anchors nothing holds a correction back: the largest one there is calls everybody nobody.
fn reports_no_person() -> LearningSetup {
    LearningSetup::beside(Vec::new(), Weights { offset: -1.0e2, ..Weights::ZERO }, 5_000_000)
}

/// The same bytes go to the wheels, the same stops come, the same limits hold: only the list of people is another.
#[test]
fn whatever_was_learned_no_stop_is_loosened() {
    let shipped = play(&plan(), None);
    let mut forgetful = plan();
    forgetful.learning = Some(reports_no_person());
    let forgetful = play(&forgetful, None);
    let people =
        |seen: &Observation| seen.people_seen.iter().map(|moment| moment.people.len()).sum::<usize>();
    assert!(people(&shipped) > 50, "{}", people(&shipped));
    assert!(people(&forgetful) * 2 < people(&shipped), "{} {}", people(&forgetful), people(&shipped));
    assert!(shipped.verdict.distance_m > 1.0, "{:?}", shipped.verdict);
    assert_eq!(shipped.stops, forgetful.stops);
    assert_eq!(shipped.speeds, forgetful.speeds);
    assert_eq!(shipped.robot_path, forgetful.robot_path);
    assert_eq!(shipped.under_cause_s, forgetful.under_cause_s);
    assert_ne!(shipped.verdict.digest, forgetful.verdict.digest);
    // What adds people can only tighten: the limit is never higher before the robot has taken another path for
    // it.
    let mut anxious = plan();
    let all = Weights { offset: 1.0e2, ..Weights::ZERO };
    anxious.learning = Some(LearningSetup::beside(Vec::new(), all, 5_000_000));
    let anxious = play(&anxious, None);
    assert!(people(&anxious) >= people(&shipped), "{} {}", people(&anxious), people(&shipped));
    let mut pairs = shipped.speeds.iter().zip(&anxious.speeds);
    let differs = pairs.find(|(one, other)| one != other);
    assert!(differs.is_none_or(|(one, other)| other.2 <= one.2 || other.1 < one.1), "{differs:?}");
    // What it adds is furniture, which stays explained in the list, but the guard is advised of it. Both robots see the same
    // until one of them takes another path.
    let same =
        shipped.robot_path.iter().zip(&anxious.robot_path).take_while(|(one, other)| one == other).count();
    let same_until_us = same as u64 * 250_000;
    let moments =
        shipped.advised.iter().zip(&anxious.advised).take_while(|(one, _)| one.at_us < same_until_us);
    let (mut compared, mut longer) = (0, 0);
    for (one, other) in moments {
        assert_eq!(one.at_us, other.at_us);
        assert!(other.count >= one.count, "{one:?} {other:?}");
        compared += 1;
        longer += usize::from(other.count > one.count);
    }
    assert!(compared > 50 && longer > 0, "{longer} of {compared} longer");
    // A person whom the learned weights reject stays in the advice.
    assert_eq!(shipped.advised, forgetful.advised);
}

/// Before anything is taken over, the robot with `[learning]` is the robot without, to the bit.
#[test]
fn unlearned_robot_equals_the_shipped_one() {
    let shipped = play(&plan(), None);
    let mut new = plan();
    new.learning = Some(LearningSetup::from_nothing(30_000_000));
    let new = play(&new, None);
    assert_eq!((shipped.verdict.mota, shipped.stops), (new.verdict.mota, new.stops.clone()));
    assert_eq!((shipped.robot_path, shipped.people_seen), (new.robot_path.clone(), new.people_seen.clone()));
    let learned = new.learned.expect("it tells");
    assert!(
        learned.shapes_scored > 100 && learned.accepted == 0 && learned.decided_otherwise == 0,
        "{learned:?}"
    );
    assert_eq!(shipped.learned, None);
}

#[test]
fn equal_recordings_learn_equal_bits() {
    let folder = tempfile::tempdir().expect("a folder");
    let robot = folder.path().join("robot.toml");
    let model = folder.path().join("people.learned");
    std::fs::write(&robot, format!("{EXAMPLE}\n[learning]\nupdate_s = 5.0\n")).expect("it is written");
    let mut start = Weights { steps: 4_000, ..Weights::ZERO };
    start.waves[7] = 0.2;
    save_weights(&model, &start, anchors_fingerprint(&shipped_anchors())).expect("it is written");
    let plan = plan().with_robot(&robot).expect("the robot is the example with learning");
    let path = folder.path().join("run.mcap");
    let run = play(&plan, Some(&path));
    let learned = run.learned.expect("it tells");
    assert!(learned.resumed && learned.shapes_scored > 100, "{learned:?}");
    let again = replay(&path);
    assert!(again.is_identical() && again.compared > 5, "{again:?}");
    assert_eq!(format!("{:016x}", again.digest), run.verdict.digest);
    assert_eq!(again.learned, Some(learned));
    let mut new = plan.clone();
    new.learning = Some(LearningSetup::from_nothing(5_000_000));
    assert_ne!(play(&new, None).verdict.digest, run.verdict.digest, "the start was used");
    // The report of the recording says what was learned.
    let file = std::fs::File::open(&path).expect("the recording is there");
    let history = read_history(&mut Recording::new(BufReader::new(file))).expect("it is whole");
    assert_eq!(history.learned, Some(learned.words()));
    assert!(document(&history, &Circumstances::default(), Language::English).contains("Learned: "));
    // A replay leaves the file of the robot alone.
    let kept = load_weights(&model, anchors_fingerprint(&shipped_anchors()));
    assert_eq!(kept.expect("it is whole").map(|kept| kept.generation), Some(1));
}

/// What is taken over goes into its file while the robot drives, not at its end: the power may be cut.
#[test]
fn accepted_updates_are_saved_in_virtual_time() {
    let folder = tempfile::tempdir().expect("a folder");
    let robot = folder.path().join("robot.toml");
    std::fs::write(&robot, format!("{EXAMPLE}\n[learning]\n")).expect("it is written");
    let mut plan = Plan::named("empty", 3, 2_000_000).expect("a built-in scenario");
    plan = plan.with_robot(&robot).expect("the robot is the example with learning");
    let learned = Weights { steps: 4_000, offset: 0.1, ..Weights::ZERO };
    plan.learning.as_ref().expect("it learns").slot.put(LearningReport::default(), &learned);
    play(&plan, None);
    let model = folder.path().join("people.learned");
    let kept = load_weights(&model, anchors_fingerprint(&shipped_anchors())).expect("it is whole");
    assert!(kept.is_some(), "nothing was kept");
}
