//! What the robot knows, in the form in which it is drawn and listed.

use floorguard_guard::{CauseRecord, Decision, Health, ResetReport, SourceReport, Unit};
use floorguard_perception::people::TrackStatus;
use floorguard_runtime::configuration::FieldPair;
use floorguard_runtime::shared::{LinkCounters, PeopleReport, PersonReport, StopRecord};
use floorguard_runtime::tasks::PERSON_PROBABILITY_MIN;
use floorguard_types::geometry::{Point2, Pose2};

use super::messages::{Diagnostic, Marker, MarkerShape, Severity};

/// Group of the markers of people.
pub const PERSON_GROUP: &str = "people";
/// Group of the markers of tracks that are not taken for people.
pub const OTHER_GROUP: &str = "tracks";
/// Group of their velocities.
const VELOCITY_GROUP: &str = "velocities";
/// Group of the protective field.
pub const PROTECTIVE_GROUP: &str = "protective field";
/// Group of the warning field.
pub const WARNING_GROUP: &str = "warning field";

/// Name of the guard's state among the diagnostics.
pub const GUARD: &str = "guard";
/// Name of the answers to resets among the diagnostics.
pub const RESET: &str = "reset";

/// Confirmed, rather a person than not, and nothing explains it.
pub fn is_person(track: &PersonReport) -> bool {
    track.status == TrackStatus::Confirmed
        && track.person_probability >= PERSON_PROBABILITY_MIN
        && track.explanation.is_none()
}

/// How large a track is drawn along x, y, z, metres: tracks have no size of their own.
pub const fn body_size_m(is_person: bool) -> [f64; 3] {
    if is_person { [0.5, 0.5, 1.7] } else { [0.3, 0.3, 0.5] }
}

/// All tracks of a sweep: a cylinder each, and an arrow where it moves.
pub fn people(report: &PeopleReport) -> Vec<Marker> {
    report.people.iter().flat_map(person).collect()
}

/// A track: a cylinder, and an arrow where it moves.
pub fn person(track: &PersonReport) -> Vec<Marker> {
    const STILL_MPS: f32 = 0.1;
    let id = track.id.cast_signed();
    let heading_rad = libm::atan2f(track.velocity_mps.y_m, track.velocity_mps.x_m);
    let pose = Pose2 { x_m: track.position.x_m, y_m: track.position.y_m, heading_rad };
    let taken = is_person(track);
    let body = Marker {
        group: if taken { PERSON_GROUP } else { OTHER_GROUP },
        id,
        shape: MarkerShape::Cylinder,
        pose,
        size_m: body_size_m(taken),
        color: if taken { [0.85, 0.25, 0.15, 0.8] } else { [0.5, 0.5, 0.5, 0.4] },
        text: label(track),
        points: Vec::new(),
    };
    let speed_mps = track.velocity_mps.norm();
    let arrow = Marker {
        group: VELOCITY_GROUP,
        shape: MarkerShape::Arrow,
        size_m: [f64::from(speed_mps), 0.08, 0.08],
        text: String::new(),
        ..body.clone()
    };
    if speed_mps > STILL_MPS { vec![body, arrow] } else { vec![body] }
}

/// Number, probability, and what explains it.
fn label(track: &PersonReport) -> String {
    let known = track.explanation.map_or("", |explanation| explanation.name());
    format!("{} {:.2} {known}", track.id, track.person_probability).trim_end().to_owned()
}

/// Protective and warning field of a set, in the robot's frame.
pub fn fields(set: &FieldPair) -> Vec<Marker> {
    let outlines = [
        (PROTECTIVE_GROUP, &set.protective, [0.9, 0.1, 0.1, 1.0]),
        (WARNING_GROUP, &set.warning, [0.95, 0.7, 0.1, 1.0]),
    ];
    let line = |(group, polygon, color): (&'static str, &[Point2], [f32; 4])| Marker {
        group,
        id: 0,
        shape: MarkerShape::LineStrip,
        pose: Pose2::default(),
        size_m: [0.03, 0.0, 0.0],
        color,
        text: String::new(),
        points: polygon.iter().chain(polygon.first()).copied().collect(),
    };
    outlines
        .into_iter()
        .filter(|(_, polygon, _)| !polygon.is_empty())
        .map(|(group, polygon, color)| line((group, polygon.as_slice(), color)))
        .collect()
}

/// Unit of a cause's numbers.
pub const fn unit(unit: Unit) -> &'static str {
    match unit {
        Unit::None => "",
        Unit::Metres => "m",
        Unit::MetresPerSecond => "m/s",
        Unit::RadiansPerSecond => "rad/s",
        Unit::Seconds => "s",
        Unit::Percent => "%",
        Unit::Code => "code",
    }
}

/// A cause, with everything that it carries.
pub fn cause(record: &CauseRecord) -> Diagnostic {
    let mut values = vec![
        ("cause".to_owned(), record.cause.to_string()),
        ("action".to_owned(), record.action.to_string()),
    ];
    let known = record.unit != Unit::None;
    let number = |value: f32| if known { format!("{value:.3}") } else { String::new() };
    values.push(("value".to_owned(), number(record.measured)));
    values.push(("limit".to_owned(), number(record.limit)));
    values.push(("unit".to_owned(), unit(record.unit).to_owned()));
    let age = if record.age_us == u64::MAX { String::new() } else { (record.age_us / 1_000).to_string() };
    values.push(("age_ms".to_owned(), age));
    Diagnostic {
        severity: if record.action.stops() { Severity::Error } else { Severity::Warning },
        name: record.cause.to_string(),
        message: record.to_string(),
        values,
    }
}

/// A stop: its cause, and where and how fast the robot was.
pub fn stop(record: &StopRecord) -> Diagnostic {
    let mut diagnostic = cause(&record.cause);
    let pose = record.pose_in_odometry;
    let numbers = [
        ("speed_mps", record.speed_mps),
        ("x_m", pose.x_m),
        ("y_m", pose.y_m),
        ("heading_rad", pose.heading_rad),
    ];
    diagnostic.values.extend(numbers.map(|(name, value)| (name.to_owned(), format!("{value:.3}"))));
    diagnostic
}

/// What the guard decided.
pub fn decision(decision: &Decision) -> Diagnostic {
    let severity = match (decision.action.stops(), decision.primary_cause) {
        (true, _) => Severity::Error,
        (false, Some(_)) => Severity::Warning,
        (false, None) => Severity::Good,
    };
    let words = |record: CauseRecord| record.to_string();
    let message = decision.holding_cause.map_or_else(String::new, words);
    let values = vec![
        ("state".to_owned(), format!("{:?}", decision.state)),
        ("action".to_owned(), decision.action.to_string()),
        (
            "holding".to_owned(),
            decision.holding_cause.map_or_else(String::new, |record| record.cause.to_string()),
        ),
        ("first_cause".to_owned(), decision.primary_cause.map_or_else(String::new, words)),
        ("speed_limit_mps".to_owned(), format!("{:.3}", decision.speed_limit_mps)),
        ("permitted_mps".to_owned(), format!("{:.3}", decision.permitted.linear_mps)),
        ("field_set".to_owned(), decision.field_set.to_string()),
        ("escaping".to_owned(), decision.escaping.to_string()),
    ];
    Diagnostic { severity, name: GUARD.to_owned(), message, values }
}

/// What came of the operator's last reset.
pub fn reset(report: &ResetReport) -> Diagnostic {
    let (severity, message) = match report.refusal {
        Some(why) => (Severity::Warning, format!("refused: {why}")),
        None => (Severity::Good, "granted".to_owned()),
    };
    let counts = [("granted", report.granted), ("refused", report.refused)];
    let values = counts.map(|(name, count)| (name.to_owned(), count.to_string()));
    Diagnostic { severity, name: RESET.to_owned(), message, values: values.to_vec() }
}

/// A source.
pub fn source(report: &SourceReport) -> Diagnostic {
    let severity = match report.health {
        Health::Healthy => Severity::Good,
        Health::Blind => Severity::Warning,
        Health::Faulty | Health::Frozen => Severity::Error,
        Health::Stale | Health::Absent => Severity::Stale,
    };
    let age = if report.age_us == u64::MAX { String::new() } else { (report.age_us / 1_000).to_string() };
    Diagnostic {
        severity,
        name: report.source.name().to_owned(),
        message: report.health.to_string(),
        values: vec![("age_ms".to_owned(), age)],
    }
}

/// What happened on the links.
pub fn links(counters: &LinkCounters) -> Diagnostic {
    let counts = [
        ("lidar datagrams refused", counters.lidar_refused),
        ("lidar link failures", counters.lidar_errors),
        ("scanner telegrams refused", counters.scanner_refused),
        ("scanner link failures", counters.scanner_errors),
        ("rear scanner telegrams refused", counters.rear_scanner_refused),
        ("rear scanner link failures", counters.rear_scanner_errors),
        ("inertial sensor link failures", counters.imu_errors),
        ("CAN failures", counters.can_errors),
        ("CAN frames sent", counters.can_sent),
    ];
    counted("links", &counts)
}

/// What the recorder has missed of the lines.
pub fn lost(rows: u64) -> Diagnostic {
    let rows = u32::try_from(rows).unwrap_or(u32::MAX);
    Diagnostic {
        severity: Severity::Warning,
        message: "the recorder was too slow".to_owned(),
        ..counted("recording", &[("rows lost", rows)])
    }
}

/// What perception made of the newest sweep.
pub fn perception(report: &PeopleReport) -> Diagnostic {
    let counters = &report.sweep.counters;
    let counts = [
        ("points", counters.points),
        ("floor points", counters.floor_points),
        ("clusters", counters.clusters),
        ("candidates", counters.candidates),
        ("tracks", report.people.len() as u32),
        ("lost packets", report.sweep.lost_packets.into()),
        ("unknown columns", counters.unknown_columns),
        ("dropped clusters", counters.dropped_clusters),
        ("dropped candidates", counters.dropped_candidates),
        ("sweeps without a pose", report.unposed_sweeps),
    ];
    counted("sweep", &counts)
}

fn counted(name: &str, counts: &[(&str, u32)]) -> Diagnostic {
    Diagnostic {
        severity: Severity::Good,
        name: name.to_owned(),
        message: String::new(),
        values: counts.iter().map(|(name, count)| ((*name).to_owned(), count.to_string())).collect(),
    }
}
