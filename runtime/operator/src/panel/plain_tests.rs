use std::collections::{BTreeMap, BTreeSet};

use super::*;
use floorguard_configuration::{EXAMPLE, parse};
use floorguard_guard::{Advice, FaultKind, GuardConfig, Supervisor};
use floorguard_types::geometry::Twist2;
use floorguard_types::sensing::{
    BeamReturn, DiscreteInputs, DriveFeedback, DriveState, ImuSample, LidarColumn, LidarPacket, Scan,
};
use floorguard_types::time::Stamp;

const STEP_US: u64 = 10_000;
/// All is well for two seconds, of which the start-up check takes one; then something fails for a second.
const WELL_STEPS: u64 = 200;
const STEPS: u64 = 300;
/// How far ahead a wrong stamp lies.
const AHEAD_US: u64 = 500_000;
/// Of a lidar's return, counts of 2 mm: 131 m.
const FAR: u16 = u16::MAX;

/// How a source may fail.
#[derive(Clone, Copy, Debug, PartialEq)]
enum SourceFailure {
    /// Nothing ever came.
    Never,
    /// Nothing comes any more.
    Silent,
    /// The same comes again and again.
    Frozen,
    /// Nothing is seen.
    Blind,
    /// Stamps lie in the future.
    Ahead,
    /// The driver reports a fault.
    Reported(FaultKind),
    /// The drive was found in operation.
    FoundRunning,
}

/// What the tasks of the guard ring can tell of each source; a stamp is ahead only where it is reckoned from a device's
/// clock or the length of a line.
fn failures(source: Source) -> Vec<SourceFailure> {
    let own: &[SourceFailure] = match source {
        Source::Scanner | Source::RearScanner => &[
            SourceFailure::Ahead,
            SourceFailure::Reported(FaultKind::Device(1)),
            SourceFailure::Reported(FaultKind::StandBy),
            SourceFailure::Reported(FaultKind::WrongGeometry),
            SourceFailure::Reported(FaultKind::LinkDown),
        ],
        Source::Lidar => {
            &[SourceFailure::Ahead, SourceFailure::Blind, SourceFailure::Reported(FaultKind::LinkDown)]
        }
        Source::Wheels => &[SourceFailure::Reported(FaultKind::Garbled)],
        Source::Imu => &[
            SourceFailure::Ahead,
            SourceFailure::Reported(FaultKind::Device(1)),
            SourceFailure::Reported(FaultKind::Garbled),
            SourceFailure::Reported(FaultKind::LinkDown),
        ],
        Source::Drive => &[
            SourceFailure::FoundRunning,
            SourceFailure::Reported(FaultKind::StandBy),
            SourceFailure::Reported(FaultKind::LinkDown),
        ],
        Source::Discrete | Source::Command | Source::Perception => &[],
    };
    [SourceFailure::Never, SourceFailure::Silent, SourceFailure::Frozen]
        .into_iter()
        .chain(own.iter().copied())
        .collect()
}

/// What a source sends in a step.
struct Sample {
    stamp: Stamp,
    /// Rises with each, if the source is alive.
    number: u16,
    /// Of each return of the lidar, counts of 2 mm.
    range_raw: u16,
}

/// Tells the guard of a step of a source.
fn hear(guard: &mut Supervisor, source: Source, failure: Option<SourceFailure>, step: u64) {
    let now = Stamp::from_micros(step * STEP_US);
    let well = Sample { stamp: now, number: step as u16, range_raw: FAR };
    let sample = match failure {
        None => well,
        Some(SourceFailure::Never | SourceFailure::Silent) => return,
        Some(SourceFailure::Frozen) => Sample { number: 0, ..well },
        Some(SourceFailure::Blind) => Sample { range_raw: 0, ..well },
        Some(SourceFailure::Ahead) => Sample { stamp: now.plus_micros(AHEAD_US), ..well },
        Some(SourceFailure::Reported(kind)) => {
            guard.on_source_fault(source, kind, now);
            return;
        }
        Some(SourceFailure::FoundRunning) => {
            guard.on_found_running(now);
            well
        }
    };
    measure(guard, source, &sample, now);
}

/// Tells the guard what a source measures where nothing stands and nothing moves.
fn measure(guard: &mut Supervisor, source: Source, sample: &Sample, now: Stamp) {
    let Sample { stamp, number, range_raw } = *sample;
    match source {
        Source::Scanner | Source::RearScanner => {
            let config = guard.config();
            let is_rear = source == Source::RearScanner;
            let geometry = config.rear_scanner.filter(|_| is_rear).unwrap_or(config.scanner);
            let beams = (0..geometry.beams).map(|_| BeamReturn::Free(u16::MAX)).collect();
            let (first_angle_rad, step_rad) = (geometry.first_angle_rad, geometry.step_rad);
            let scan = Scan { stamp, sequence: number.into(), first_angle_rad, step_rad, beams };
            if is_rear { guard.on_rear_scan(&scan, now) } else { guard.on_scan(&scan, now) }
        }
        Source::Lidar => {
            let column = |azimuth_cdeg| {
                let range_raw = LidarColumn::SILENT.range_raw.map(|_| range_raw);
                LidarColumn { azimuth_cdeg, range_raw, ..LidarColumn::SILENT }
            };
            let columns = [number, number + 18_000].into_iter().map(column).collect();
            guard.on_lidar_packet(&LidarPacket { stamp, range_unit_mm: 2, rings: 16, columns }, now)
        }
        Source::Discrete => guard.on_discrete(&DiscreteInputs::all_clear(stamp), now),
        Source::Wheels => guard.on_wheels(Twist2::ZERO, stamp, now),
        Source::Imu => {
            let angular_radps = [0.0, 0.0, 1.0e-6 * f32::from(number)];
            guard.on_imu(&ImuSample { stamp, angular_radps, ..ImuSample::default() }, now)
        }
        Source::Drive => {
            let state = DriveState::Enabled;
            let still = DriveFeedback { stamp, state, wheel_speed_mps: 0.0, steering_rad: 0.0 };
            guard.on_drive(&still, now)
        }
        Source::Command => guard.on_command(Twist2::ZERO, stamp, now),
        Source::Perception => guard.on_advice(&Advice { stamp, ..Advice::default() }, now),
    };
}

/// What a guard with the usual rules says of a source to which something happens.
fn records(source: Source, failure: SourceFailure) -> Vec<CauseRecord> {
    let robot = parse("robot.toml", EXAMPLE).unwrap().robot;
    let mut config = GuardConfig { sources: GuardConfig::default_sources(), ..robot.guard() };
    config.rear_scanner = Some(config.scanner);
    config.sources[Source::RearScanner.index()] = GuardConfig::RULES_OF_SCANNER;
    let mut guard = Box::new(Supervisor::UNCONFIGURED);
    guard.configure(config, Stamp::ZERO).unwrap();
    let mut records: Vec<CauseRecord> = Vec::new();
    for step in 1..=STEPS {
        let fails = step > WELL_STEPS || failure == SourceFailure::Never;
        for heard in Source::ALL {
            hear(&mut guard, heard, (fails && heard == source).then_some(failure), step);
        }
        guard.tick(Stamp::from_micros(step * STEP_US));
        for record in guard.causes() {
            let is_shown = records.iter().any(|shown| shown.cause == record.cause);
            match record.cause {
                Cause::StartUp | Cause::StartNeeded => {}
                Cause::SourceLate(of) | Cause::SourceLost(of) if of == source => {
                    if !is_shown {
                        records.push(*record);
                    }
                }
                other => panic!("{source:?}, {failure:?}: {other:?}"),
            }
        }
    }
    records
}

/// How it clears, in the words of the book.
fn clears(cause: Cause) -> String {
    match cause.clear() {
        Clear::Quiet(quiet_us) => {
            format!("by itself, {:.1} s after the last of it", quiet_us as f64 * 1.0e-6)
        }
        Clear::Start => String::from("after a start command"),
        Clear::Reset => String::from("after reset"),
        Clear::Restart => String::from("after a restart"),
    }
}

/// As the panel and the console tell it, without what was measured and what it demands.
fn shown_text(record: &CauseRecord) -> String {
    let unit = if record.unit == Unit::Code { Unit::Code } else { Unit::None };
    let shown = CauseRecord { unit, age_us: 0, ..*record }.to_string();
    let shown_text = shown.split(" -> ").next().unwrap_or_default();
    let words = shown_text.split(' ').map(|word| if word.contains(char::is_numeric) { "…" } else { word });
    words.collect::<Vec<_>>().join(" ")
}

/// What stands in the row of a record behind what it says.
fn rest(record: &CauseRecord) -> String {
    format!(" | {} | {} | {} |", record.action, clears(record.cause), remedy(record))
}

/// The table of the book: a row for each cause; sources with the same entry share one.
fn rows() -> BTreeSet<String> {
    let is_plain = |cause: &Cause| !matches!(cause, Cause::SourceLate(_) | Cause::SourceLost(_));
    let plain = Cause::all().into_iter().filter(is_plain).map(|cause| CauseRecord::new(cause, Stamp::ZERO));
    let plain = plain.map(|record| format!("| {}{}", shown_text(&record), rest(&record)));
    let mut shared: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for source in Source::ALL {
        for record in failures(source).into_iter().flat_map(|failure| records(source, failure)) {
            let shown_text = shown_text(&record);
            let how = shown_text.strip_prefix(source.name()).expect("a record begins with its source");
            let names = shared.entry(format!("{how}{}", rest(&record))).or_default();
            if !names.contains(&source.name()) {
                names.push(source.name());
            }
        }
    }
    plain.chain(shared.into_iter().map(|(row, names)| format!("| {}{row}", names.join(", ")))).collect()
}

#[test]
fn book_and_panel_list_the_same_causes() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/src/operating.md");
    let book = std::fs::read_to_string(file).expect("the chapter");
    let table = book.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| it says |"));
    let (shown, rows) = (table.map(String::from).collect::<BTreeSet<_>>(), rows());
    let lines = |rows: Vec<&String>| rows.into_iter().map(|row| format!("\n{row}")).collect::<String>();
    let (missing, other) = (rows.difference(&shown).collect(), shown.difference(&rows).collect());
    assert!(
        shown == rows,
        "docs/src/operating.md lacks:{}\nand has, though no guard says it:{}",
        lines(missing),
        lines(other)
    );
}

/// Only where it says nothing its cable is the first to be examined.
#[test]
fn answering_device_is_no_cable_fault() {
    let reported = SourceFailure::Reported;
    for (source, failure, help) in [
        (Source::Scanner, SourceFailure::Silent, "Check cable and power"),
        (Source::Scanner, reported(FaultKind::Device(1)), "look at its display"),
        (Source::Scanner, reported(FaultKind::WrongGeometry), "another one than the robot was set up for"),
        (Source::Scanner, SourceFailure::Frozen, "switch it off and on"),
        (Source::Lidar, SourceFailure::Silent, "Check cable and power"),
        (Source::Lidar, SourceFailure::Blind, "Uncover"),
        (Source::Lidar, SourceFailure::Ahead, "off and on"),
        (Source::Imu, reported(FaultKind::Device(7)), "look at its display"),
    ] {
        let records = records(source, failure);
        assert!(!records.is_empty(), "{source:?}, {failure:?}");
        for record in records {
            let shown = remedy(&record);
            assert!(shown.contains(help), "{record}: {shown}");
            let is_sent = shown.contains("Check cable");
            assert_eq!(is_sent, failure == SourceFailure::Silent, "{record}: {shown}");
        }
    }
}

#[test]
fn reset_advice_names_the_first_check() {
    let vague = Cause::all().into_iter().filter(|cause| {
        let help = remedy(&CauseRecord::new(*cause, Stamp::ZERO));
        cause.clear() == Clear::Reset && (!help.contains("press reset") || help.starts_with("Find out why"))
    });
    // The clock is nothing that anybody beside the robot could look at.
    assert_eq!(vague.collect::<Vec<_>>(), [Cause::ClockFault]);
}
