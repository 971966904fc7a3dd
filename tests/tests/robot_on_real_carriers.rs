//! The same robot over what a real one has: UDP on the loopback, pseudo-terminals, an SLCAN adapter, two threads.

use floorguard_hosted::world::{Observer, Plan, run_real, run_virtual};

const DURATION_US: u64 = 10_000_000;

/// Nothing repeats bit for bit in real time; what counts is the same: nobody hurt, no stop missed, the robot drives and
/// sees people. A busy machine may make it stop for a late sensor, so distances are only bounded from below.
#[test]
fn real_carriers_give_the_verdict_of_virtual_time() {
    let plan = Plan::named("crossing", 2, DURATION_US).unwrap();
    let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
    let mut observer = Observer::new(&plan, &mut show);
    run_virtual(&plan, &mut observer).unwrap();
    let virtual_time = observer.into_observation();
    let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
    let mut observer = Observer::new(&plan, &mut show);
    let figures = run_real(&plan, None, &mut observer).unwrap();
    let real_time = observer.into_observation();
    println!("{figures:?} {:?}", real_time.verdict);
    assert!(virtual_time.verdict.passed && real_time.verdict.passed, "{:?}", real_time.verdict);
    assert!(real_time.ready_s.is_some(), "never ready: {:?}", real_time.under_cause_s);
    assert!(real_time.verdict.distance_m > 1.0, "{:?}", real_time.under_cause_s);
    assert!(real_time.verdict.mota.is_some_and(|mota| mota > 0.5), "{:?}", real_time.verdict);
}
