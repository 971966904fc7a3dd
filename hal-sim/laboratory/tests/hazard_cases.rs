//! Named worlds that hurt: which of them the robot gets through, and that each of these is lost when something that
//! protects is taken away. The judge is the one that knows true geometry alone.

use floorguard_laboratory::campaign::{Spoil, played};
use floorguard_laboratory::judge::Verdict;
use floorguard_laboratory::world::{Plan, load_scenario};

fn verdict(case: &str, spoil: Option<Spoil>) -> Verdict {
    let path = format!("{}/../scenarios/hazards/{case}.toml", env!("CARGO_MANIFEST_DIR"));
    let scenario = load_scenario(path.as_ref()).unwrap_or_else(|error| panic!("{case}: {error:#}"));
    let mut plan = Plan::of(case, scenario, 1, 14_000_000).expect("a plan");
    if let Some(spoil) = spoil {
        spoil.apply(&mut plan).expect("a line of that name");
    }
    let play = move || played(&plan);
    let thread = std::thread::Builder::new().stack_size(32 << 20).spawn(play).expect("a thread");
    thread.join().expect("no panic").unwrap_or_else(|error| panic!("{case}: {error:#}")).verdict
}

/// No contact at all, not even one that no sensor could have avoided.
fn holds(case: &str, spoil: Option<Spoil>) -> (bool, String) {
    let verdict = verdict(case, spoil);
    let is_free = verdict.passed && verdict.bodies.counts.while_moving() == 0;
    (is_free, format!("{case} {spoil:?}: {:?} {}", verdict.failures, verdict.contacts_in_words()))
}

/// Worlds that the robot gets through today.
const HOLD: [&str; 8] =
    ["board-55", "board-70", "box-30", "box-160", "box-aside", "person", "reverse-45", "edge"];
/// Worlds in which it runs into something today. Whoever mends the guard moves them to the other list.
const RED: [&str; 6] = ["board-30", "board-45", "low-box-8", "low-box-12", "tail-12", "tail-45"];

#[test]
fn worlds_that_hold_and_worlds_that_do_not() {
    for case in HOLD {
        let (holds, words) = holds(case, None);
        assert!(holds, "it held before: {words}");
    }
    for case in RED {
        let (holds, words) = holds(case, None);
        assert!(!holds, "it holds now, move it to the worlds that hold: {words}");
    }
}

/// Of a robot that gets through the world as it is.
#[test]
fn what_is_taken_away_is_noticed() {
    let taken = [
        ("box-aside", Spoil::NeedleFields),
        ("box-30", Spoil::BlindScanner),
        ("box-30", Spoil::BlindLidar),
        ("box-160", Spoil::Cut("scanner")),
        ("box-160", Spoil::Cut("lidar")),
        ("edge", Spoil::NoFloorSwitches),
        ("low-box-8", Spoil::NoBumpers),
        ("box-160", Spoil::NoProtectiveRules),
    ];
    for (case, spoil) in taken {
        let verdict = verdict(case, Some(spoil));
        assert!(!verdict.passed, "{case} without {spoil:?} passes: {}", verdict.contacts_in_words());
    }
}
