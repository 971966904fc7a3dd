//! Every bit of the guard's state, flipped at moments all over a mission, one at a time; and of its constants.
//!
//! Classes: no effect, stop within the same decision, silent unsafe. The last must not occur. A short slice of the
//! moments runs here; `cargo xtask campaign flips` takes them all.

use super::bits::Bits;
use super::fixtures::{Rig, forward};
use crate::machine::SELF_TEST_US;
use crate::protection::PARTS;
use crate::*;
use floorguard_types::geometry::{Point2, Twist2};
use floorguard_types::sensing::SafetyInput;

/// Moments of the mission that can be asked for.
const MOMENTS: u64 = 2_000;
/// Ticks of the mission between two moments.
const TICKS: u64 = 2;
/// Ticks of 10 ms at which the emergency stop is pressed, and at which the operator asks for the reset.
const PRESSED_AT: u64 = 2_600;
const RESET_AT: u64 = 2_800;
/// Ticks at which the emergency stop holds: the self-test after the reset begins between two ticks and is passed at the last.
const EMERGENCY: std::ops::Range<u64> = PRESSED_AT..RESET_AT + SELF_TEST_US / 10_000 - 1;

/// 40 s in which everything happens: start, cruise, warning, stop, leaving backwards, clear path, lidar stop, lost
/// sources, emergency stop, reset, a stamp from the future, contact. `visit` also receives whether the emergency stop
/// holds now and at the next tick; nothing else in the mission may cut the torque.
fn mission(mut visit: impl FnMut(u64, &Supervisor, bool)) {
    let mut rig = Rig::new();
    for tick in 0..MOMENTS * TICKS {
        match tick {
            600 => rig.obstacles.push(Point2::new(3.0, 0.0)),
            750 => rig.obstacles = std::vec![Point2::new(1.1, 0.0)],
            950 => rig.wanted = forward(-0.2),
            1_150 => {
                rig.obstacles.clear();
                rig.wanted = forward(0.8);
            }
            1_700 => rig.lidar_range_m = 1.5,
            1_750 => rig.lidar_range_m = 20.0,
            2_000 => rig.silent = std::vec![Source::Perception],
            2_100 => rig.silent = std::vec![Source::Imu],
            2_200 => rig.silent.clear(),
            PRESSED_AT => rig.inputs.emergency_stop = SafetyInput::Active,
            2_650 => rig.inputs.emergency_stop = SafetyInput::Clear,
            RESET_AT => {
                rig.guard.request_reset(rig.now);
            }
            3_300 => rig.stamp_ahead_us[Source::Scanner.index()] = 50_000,
            3_350 => rig.stamp_ahead_us[Source::Scanner.index()] = 0,
            3_700 => rig.inputs.bumper_front = SafetyInput::Active,
            _ => {}
        }
        let decision = rig.step();
        let is_stopped = EMERGENCY.contains(&tick);
        assert_eq!(decision.action == Action::Category0, is_stopped, "tick {tick}: {decision:?}");
        if tick % TICKS == 0 {
            visit(tick / TICKS, &rig.guard, is_stopped && EMERGENCY.contains(&(tick + 1)));
        }
    }
}

/// The moments that the campaign asks for.
fn asked_for() -> Option<std::ops::Range<u64>> {
    let number = |name: &str| std::env::var(name).ok().and_then(|text| text.parse::<u64>().ok());
    Some(number("FLOORGUARD_CAMPAIGN_FROM")?..number("FLOORGUARD_CAMPAIGN_TO")?)
}

/// The moments to look at: those that the campaign asks for, or a few of all.
fn is_asked_for(moment: u64) -> bool {
    asked_for().map_or(moment % 100 == 50, |moments| moments.contains(&moment))
}

/// Flips without effect, and flips that stop.
#[derive(Default)]
struct Classes {
    no_effect: u64,
    stops: u64,
}

impl Classes {
    fn book(&mut self, decision: &Decision, expected: &Decision, bit: u32) {
        if decision == expected {
            self.no_effect += 1;
            return;
        }
        let stands = decision.permitted == Twist2::ZERO && decision.action == Action::Category0;
        assert!(stands, "silent unsafe, bit {bit}: {decision:?} instead of {expected:?}");
        self.stops += 1;
    }
}

#[test]
fn fg_req_008_no_flipped_state_bit_is_silently_unsafe() {
    let (mut classes, mut moments, mut stopped) = (Classes::default(), 0, 0);
    mission(|moment, guard, is_stopped| {
        if !is_asked_for(moment) {
            return;
        }
        moments += 1;
        let mut guard = guard.clone();
        // Only the state and its copy change: the tables need not be cloned for each flip.
        let (state, copy) = (guard.state, guard.copy);
        let now = state.decided_at.plus_micros(10_000);
        let expected = guard.tick(now);
        assert_eq!(
            expected.action == Action::Category0,
            is_stopped,
            "moment {moment}, no flip: {expected:?}"
        );
        stopped += u64::from(is_stopped);
        for bit in 0..state.bits() {
            (guard.state, guard.copy) = (state, copy);
            guard.state.flip(bit);
            classes.book(&guard.tick(now), &expected, bit);
        }
        for bit in 0..copy.bits() {
            (guard.state, guard.copy) = (state, copy);
            guard.copy.flip(bit);
            classes.book(&guard.tick(now), &expected, bit);
        }
    });
    let Classes { no_effect, stops } = classes;
    assert!(moments > 0, "no moment of the mission, which has {MOMENTS}, was checked");
    // A robot that is stopped already, by an emergency stop, has nothing to stop for.
    let moving = moments - stopped;
    assert!(
        stops > 1_000 * moving || moving == 0,
        "{no_effect} without effect, {stops} stops in {moving} moments"
    );
    assert!(moving > 10 || asked_for().is_some(), "{moving} of {moments} moments could tell anything");
    let counts = [
        ("moments", moments),
        ("moments under an emergency stop", stopped),
        ("no effect", no_effect),
        ("stop at once", stops),
        ("silent unsafe", 0),
    ];
    for (name, count) in counts {
        std::println!("campaign: {name} = {count}");
    }
}

/// Ticks until a constant that was changed stops the robot; `None` if it does not within all parts.
fn found_after(guard: &mut Supervisor) -> Option<usize> {
    let (state, copy) = (guard.state, guard.copy);
    let found = (1..=PARTS).find(|tick| {
        let decision = guard.tick(state.decided_at.plus_micros(10_000 * *tick as u64));
        decision.action == Action::Category0 && decision.permitted == Twist2::ZERO
    });
    (guard.state, guard.copy) = (state, copy);
    found
}

#[test]
fn fg_req_017_every_flipped_bit_of_the_configuration_stops() {
    let mut guard = Rig::cruising().guard;
    let (mut found, mut equal) = (0, 0);
    let original = guard.config.clone();
    macro_rules! flip_all {
        ($($part:ident).+) => {
            for bit in 0..guard.$($part).+.bits() {
                guard.$($part).+.flip(bit);
                match found_after(&mut guard) {
                    Some(_) => found += 1,
                    // The sign of a zero has no meaning.
                    None if guard.config == original => equal += 1,
                    None => panic!("bit {bit} of {}", stringify!($($part).+)),
                }
                guard.config = original.clone();
            }
        };
    }
    flip_all!(config.drive);
    flip_all!(config.thresholds);
    flip_all!(config.sources);
    flip_all!(config.fields);
    flip_all!(config.footprint);
    flip_all!(config.scanner);
    flip_all!(config.unseen);
    flip_all!(config.lidar.elevations_rad);
    flip_all!(config.lidar.floor_clearance_m);
    flip_all!(config.lidar.body_height_m);
    assert!(found > 3_000 && equal < 50, "{found} found, {equal} zeros with another sign");
    for bit in 0..guard.body.x_m.bits() {
        guard.body.x_m.flip(bit);
        assert!(found_after(&mut guard).is_some(), "bit {bit} of the body");
        guard.body.x_m.flip(bit);
    }
}

#[test]
fn fg_req_017_every_changed_word_of_the_tables_stops() {
    let mut guard = Rig::cruising().guard;
    // One bit of each word, another one each time.
    macro_rules! flip_word {
        ($number:expr, $($word:tt)+) => {{
            let bit = $number as u32 % guard.$($word)+.bits();
            guard.$($word)+.flip(bit);
            assert!(found_after(&mut guard).is_some(), "word {} of {}", $number, stringify!($($word)+));
            guard.$($word)+.flip(bit);
        }};
    }
    // Every word would take minutes; the strides have no common factor with the parts.
    for set in 0..guard.scan_table.protective.len() {
        for beam in (set..guard.scan_table.protective[set].len()).step_by(37) {
            flip_word!(beam, scan_table.protective[set][beam]);
            flip_word!(beam, scan_table.warning[set][beam]);
        }
        flip_word!(set, scan_table.watched[set]);
    }
    for beam in (0..guard.scan_table.directions.len()).step_by(37) {
        flip_word!(beam, scan_table.directions[beam].x_m);
        flip_word!(beam, scan_table.directions[beam].y_m);
    }
    for bin in 0..guard.packet_table.bins.len() {
        for ring in (bin % 5..16).step_by(5) {
            flip_word!(ring, packet_table.bins[bin].plane_share[ring]);
            flip_word!(ring, packet_table.bins[bin].height_mm[ring]);
        }
        flip_word!(bin, packet_table.bins[bin].protective_mm[bin % 8]);
        flip_word!(bin, packet_table.bins[bin].own_mm);
        flip_word!(bin, packet_table.bins[bin].least_share);
        flip_word!(bin, packet_table.bins[bin].direction.x_m);
    }
    flip_word!(3, packet_table.origin.x_m);
    assert!(found_after(&mut guard).is_none(), "unchanged again");
}
