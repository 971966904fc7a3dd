//! What a claim is worth when wheels slip, the robot is pushed, packets are lost and power fails.
//! `cargo xtask campaign claims` runs as many missions as one likes and prints both shares with their intervals.

use floorguard_laboratory::mission::statistics::wilson95;
use floorguard_laboratory::mission::{FaultKind, FaultRates, MissionConfig, Robot, Strategy, run};
use floorguard_robot::site::{DirtSource, Floor, rooms};
use floorguard_tests::campaign::{Slice, report};
use floorguard_types::random::Pcg32;

/// What a cell that is called clean may be wrong with, and the share of the truly clean ones that must be claimed.
const DELTA: f64 = 0.01;
const CLAIMED: f64 = 0.99;

/// The published rule, one δ for each cell: the weakest of the three, so the most false claims.
fn config(trial: u64) -> MissionConfig {
    let faults = if trial.is_multiple_of(4) { &[][..] } else { &[FaultKind::All][..] };
    MissionConfig {
        robot: Robot::WITH_SCANNER,
        faults: FaultRates::of(faults),
        ..MissionConfig::published(Strategy::Guarantee)
    }
}

#[test]
fn claims_hold_under_slip_pushes_and_losses() {
    let slice = Slice::from_environment(4);
    let plain = Floor::new("plain", rooms::plain().expect("a room"), 0.17).expect("a floor");
    let furnished = Floor::new("furnished", rooms::furnished().expect("a room"), 0.17).expect("a floor");
    let dirt: DirtSource = "random:5%:10-15".parse().expect("the form of the command line");
    let [mut claimed, mut falsely, mut calm, mut calm_falsely] = [0_u64; 4];
    let [mut clean, mut clean_claimed, mut faults, mut missions] = [0_u64; 4];
    for trial in slice.trials.clone() {
        let seed = slice.random(trial).next();
        let floor = if (trial / 4).is_multiple_of(2) { &furnished } else { &plain };
        let expected = dirt.expected_units(floor, &mut Pcg32::new(seed, 0)).expect("drawn, not read");
        let result = run(floor, &config(trial), &expected, seed).expect("a mission");
        missions += 1;
        if trial.is_multiple_of(4) {
            calm += u64::from(result.claimed_cells);
            calm_falsely += u64::from(result.falsely_claimed_cells);
        } else {
            claimed += u64::from(result.claimed_cells);
            falsely += u64::from(result.falsely_claimed_cells);
        }
        clean += u64::from(result.truly_clean_cells);
        clean_claimed += u64::from(result.truly_clean_claimed_cells);
        faults += u64::from(result.faults);
    }
    report(&[
        ("missions", missions),
        ("faults", faults),
        ("claimed with faults", claimed),
        ("falsely with faults", falsely),
        ("claimed without faults", calm),
        ("falsely without faults", calm_falsely),
        ("truly clean", clean),
        ("truly clean and claimed", clean_claimed),
    ]);
    assert!(missions == 0 || faults > 0 || missions == calm, "nothing went wrong: nothing was tried");
    // A block is small: it fails where chance does not explain it. The campaign judges the sum.
    assert!(wilson95(falsely, claimed).0 <= DELTA, "{falsely} of {claimed} claimed cells are not clean");
    assert!(wilson95(calm_falsely, calm).0 <= DELTA, "{calm_falsely} of {calm} without faults");
    assert!(wilson95(clean_claimed, clean).1 >= CLAIMED, "only {clean_claimed} of {clean} are claimed");
}
