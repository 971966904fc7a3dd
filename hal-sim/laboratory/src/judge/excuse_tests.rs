//! What excuses a robot that does not do its job.

use floorguard_contact_judge::JobOutcome;
use floorguard_sim::scenario::{MisplacedFile, Scenario};

use super::TrueContacts;
use crate::plan::Plan;

/// Longer than a robot may stand without a reason, microseconds.
const DURATION_US: usize = 12_000_000;

/// What is reported of a robot that stands in an empty hall, and of its lidar, which is that much higher than its file says, metres.
fn job(z_m: f32) -> JobOutcome {
    let text = "title = \"low\"\n[route]\nspeed_mps = 0.5\nwaypoints_m = [[5.0, 0.0]]\n";
    let mut scenario = Scenario::from_toml(text).unwrap();
    scenario.lidar_misplaced = Some(MisplacedFile { x_m: 0.0, y_m: 0.0, z_m, yaw_deg: 0.0 });
    let plan = Plan::of("low", scenario, 1, DURATION_US as u64).unwrap();
    let mut simulation = plan.simulation().unwrap();
    let mut judge = TrueContacts::new(&plan, &simulation).unwrap();
    for at_us in (0..DURATION_US).step_by(10_000) {
        simulation.advance_to(at_us as u64, &mut |_| {});
        judge.observe(&simulation);
    }
    judge.report(Some(1.0)).job
}

#[test]
fn low_lidar_excuses_the_job() {
    assert!(matches!(job(-0.06), JobOutcome::Excused(_)));
    assert_eq!(job(-0.04), JobOutcome::Undone);
    assert_eq!(job(0.08), JobOutcome::Undone);
}
