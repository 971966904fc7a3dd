//! Runs that nothing bad happened in, and what they came to.

use super::*;
use floorguard_robot::cleaner::LaneCount;

const MINUTE: Asked = Asked { duration_s: 60.0, until_clean: false, is_disturbed: false, repeats: true };

fn passed() -> Verdict {
    Verdict { passed: true, ready_s: Some(1.3), duration_s: 60.0, ..Verdict::default() }
}

fn cleaning(claimed_cells: u32, finished: bool) -> Verdict {
    let mission = MissionReport {
        claimed_cells,
        dirty_cells: 147,
        finished,
        finished_after_s: finished.then_some(50.0),
        ..MissionReport::default()
    };
    Verdict { mission: Some(mission), ..passed() }
}

/// The value of a run, and its reason.
fn value(mut verdict: Verdict, asked: Asked, standing: &Standing) -> (Outcome, String) {
    verdict.conclude(asked, standing);
    (verdict.verdict, verdict.reason)
}

fn at_rest(since_s: f64) -> Standing {
    Standing { since_s: Some(since_s), cause: Some("person near".to_owned()), ..Standing::default() }
}

#[test]
fn mission_under_way_as_asked_is_good() {
    let (outcome, reason) = value(cleaning(104, false), MINUTE, &Standing::default());
    assert_eq!(outcome, Outcome::Good);
    assert!(reason.contains("mission in progress: 104 of 147 dirty cells"), "{reason}");
}

#[test]
fn until_clean_needs_a_clean_floor() {
    let asked = Asked { until_clean: true, ..MINUTE };
    let (outcome, reason) = value(cleaning(104, false), asked, &Standing::default());
    assert_eq!(outcome, Outcome::NotFinished);
    assert!(reason.contains("104 of 147"), "{reason}");
    // It ends as soon as all is clean, which was not asked for.
    let early = Verdict { duration_s: 51.0, ..cleaning(147, true) };
    assert_eq!(value(early.clone(), asked, &Standing::default()).0, Outcome::Good);
    assert_eq!(value(early, MINUTE, &Standing::default()).0, Outcome::NotFinished);
}

#[test]
fn lanes_reach_no_guarantee() {
    let mut verdict = cleaning(43, true);
    let mission = verdict.mission.as_mut().unwrap();
    mission.lanes = Some(LaneCount { planned: 20, driven: 20 });
    let words = mission.end_in_words();
    assert!(words.contains("43 of 147") && !words.contains("guarantee"), "{words}");
    let (outcome, reason) = value(verdict, MINUTE, &Standing::default());
    assert_eq!(outcome, Outcome::NotFinished);
    assert!(reason.contains("20 of 20 lanes driven, 43 of 147"), "{reason}");
}

#[test]
fn lanes_left_out_are_not_finished() {
    let mut verdict = cleaning(147, true);
    verdict.mission.as_mut().unwrap().lanes = Some(LaneCount { planned: 20, driven: 4 });
    assert_eq!(value(verdict, MINUTE, &Standing::default()).0, Outcome::NotFinished);
}

#[test]
fn robot_that_stands_is_not_finished() {
    let on_its_way = || {
        let mut verdict = passed();
        verdict.bodies.job = JobOutcome::Blocked("shelf".to_owned());
        verdict
    };
    let (outcome, reason) = value(on_its_way(), MINUTE, &at_rest(10.0));
    assert_eq!(
        (outcome, reason.as_str()),
        (Outcome::NotFinished, "the robot stands since 10 s: person near")
    );
    assert_eq!(value(on_its_way(), MINUTE, &at_rest(40.0)).0, Outcome::Good);
    let idle = Standing { without_reason_s: 45.0, ..Standing::default() };
    assert_eq!(value(on_its_way(), MINUTE, &idle).0, Outcome::NotFinished);
    let disturbed = Asked { is_disturbed: true, ..MINUTE };
    assert_eq!(value(on_its_way(), disturbed, &at_rest(10.0)).0, Outcome::Good);
    // The first round of a route that begins again is not its end.
    let mut once_round = on_its_way();
    once_round.bodies.job = JobOutcome::Done;
    assert_eq!(value(once_round.clone(), MINUTE, &at_rest(10.0)).0, Outcome::NotFinished);
    assert_eq!(value(once_round, Asked { repeats: false, ..MINUTE }, &at_rest(10.0)).0, Outcome::Good);
    // Without a job there is nothing to stand in the way of.
    assert_eq!(value(passed(), MINUTE, &at_rest(2.0)).0, Outcome::Good);
}

#[test]
fn robot_off_its_place_is_not_finished() {
    for (off_m, outcome) in [(0.1, Outcome::Good), (1.4, Outcome::NotFinished)] {
        let mut verdict = cleaning(147, true);
        verdict.mission.as_mut().unwrap().localisation_error_max_m = Some(off_m);
        assert_eq!(value(verdict, MINUTE, &Standing::default()).0, outcome);
    }
}

#[test]
fn robot_never_ready_is_not_finished() {
    let never = Verdict { ready_s: None, passed: false, ..passed() };
    let (outcome, reason) = value(never, MINUTE, &at_rest(0.0));
    assert_eq!(outcome, Outcome::NotFinished);
    assert!(reason.contains("never became ready to move: person near"), "{reason}");
}

#[test]
fn what_judges_find_is_failed() {
    let failed =
        Verdict { passed: false, failures: vec!["1 missed stops".to_owned()], missed_stops: 1, ..passed() };
    assert_eq!(value(failed, MINUTE, &Standing::default()), (Outcome::Failed, "1 missed stops".to_owned()));
}
