//! What `--json` prints: one object per sweep or scan and line, whatever the input was.

use std::io::Write;

use floorguard_perception::legs::Leg;
use floorguard_perception::people::{
    Explanation, PeopleCounters, PeopleOutput, PeopleSensor, SensorSet, Track, TrackStatus,
};
use floorguard_recording::describe::is_person;
use floorguard_runtime::shared::{PeopleReport, PersonReport};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::sensing::Sweep;
use floorguard_types::time::Stamp;
use serde::{Serialize, Serializer};

/// A track.
#[derive(Clone, Debug, Serialize)]
pub struct PersonRow {
    id: u32,
    status: &'static str,
    /// Confirmed, rather a person than not, and nothing explains it.
    is_person: bool,
    #[serde(flatten)]
    motion: Motion,
    sigma_position_m: f32,
    sigma_velocity_mps: f32,
    person_probability: f32,
    moving_probability: f32,
    /// Who has seen it within the last half second.
    #[serde(serialize_with = "words")]
    sensors: SensorSet,
    /// What explains it, if it is no person in spite of its probability.
    #[serde(rename = "reason", skip_serializing_if = "Option::is_none", serialize_with = "name")]
    explanation: Option<Explanation>,
}

/// Place and velocity, metres and m/s: by the short names of tracking formats, and by names with units.
#[derive(Clone, Copy, Debug, Serialize)]
struct Motion {
    x: f32,
    y: f32,
    vx: f32,
    vy: f32,
    x_m: f32,
    y_m: f32,
    vx_mps: f32,
    vy_mps: f32,
}

impl Motion {
    const fn new(place: Point2, velocity: Point2) -> Self {
        let (x, y, vx, vy) = (place.x_m, place.y_m, velocity.x_m, velocity.y_m);
        Self { x, y, vx, vy, x_m: x, y_m: y, vx_mps: vx, vy_mps: vy }
    }
}

impl Motion {
    fn seen_from(self, transform: Pose2) -> Self {
        let turn = Pose2 { heading_rad: transform.heading_rad, ..Pose2::default() };
        let place = transform.transform(Point2::new(self.x_m, self.y_m));
        Self::new(place, turn.transform(Point2::new(self.vx_mps, self.vy_mps)))
    }
}

/// A leg in a scan.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct LegRow {
    x_m: f32,
    y_m: f32,
    probability: f32,
}

/// A sweep of the lidar or a scan of a scanner, and the list of people after it. What the sensor does not have is null.
#[derive(Clone, Debug, Serialize)]
pub struct FrameRow {
    stamp_us: u64,
    frame: &'static str,
    sensor: &'static str,
    /// Of a bag with several scanners.
    #[serde(skip_serializing_if = "Option::is_none")]
    topic: Option<String>,
    points: u32,
    floor_points: Option<u32>,
    clusters: Option<u32>,
    moving_clusters: Option<u32>,
    candidates: Option<u32>,
    segments: Option<u32>,
    legs: Option<Vec<LegRow>>,
    people: Vec<PersonRow>,
    lost_packets: Option<u16>,
    unknown_columns: Option<u32>,
    /// Degrees of the turn that the lidar is set to see.
    #[serde(skip_serializing_if = "Option::is_none")]
    coverage_deg: Option<f32>,
    dropped_clusters: Option<u32>,
    dropped_candidates: Option<u32>,
    dropped_legs: Option<u32>,
    health: &'static str,
    /// Fingerprint of everything that the robot has put out so far; only of recordings of whole robots.
    #[serde(skip_serializing_if = "Option::is_none")]
    digest: Option<String>,
}

/// What a scan was found to hold.
#[derive(Clone, Copy, Debug)]
pub struct ScanCounts {
    /// Beams with a return.
    pub points: u32,
    /// Segments that were examined.
    pub segments: u32,
    /// Legs left out because the list was full.
    pub dropped_legs: u32,
}

impl FrameRow {
    const NOTHING: Self = Self {
        stamp_us: 0,
        frame: "sensor",
        sensor: "lidar",
        topic: None,
        points: 0,
        floor_points: None,
        clusters: None,
        moving_clusters: None,
        candidates: None,
        segments: None,
        legs: None,
        people: Vec::new(),
        lost_packets: None,
        unknown_columns: None,
        coverage_deg: None,
        dropped_clusters: None,
        dropped_candidates: None,
        dropped_legs: None,
        health: "frozen",
        digest: None,
    };

    /// A sweep or scan that is not later than the one before it: nothing that depends on time is known, and it is
    /// not used for tracking.
    pub fn frozen((stamp, sensor): (Stamp, &'static str), (frame, points): (&'static str, u32)) -> Self {
        Self { stamp_us: stamp.as_micros(), sensor, frame, points, ..Self::NOTHING }
    }

    /// A sweep, in the frame in which the stages worked.
    pub fn of_sweep(sweep: &Sweep, output: &PeopleOutput<'_>, frame: &'static str) -> Self {
        let blind = output.counters.unknown_columns as usize * 2 > sweep.column_count;
        Self {
            lost_packets: Some(sweep.lost_packets),
            people: output.tracks.iter().map(|track| PersonRow::of_track(track, sweep.end_stamp)).collect(),
            ..Self::counted(sweep.end_stamp.as_micros(), (frame, blind), &output.counters)
        }
    }

    /// A scan, and the tracks after it.
    pub fn of_scan(
        (stamp, frame): (Stamp, &'static str),
        counts: ScanCounts,
        legs: &[Leg],
        tracks: &[Track],
    ) -> Self {
        let leg =
            |leg: &Leg| LegRow { x_m: leg.position.x_m, y_m: leg.position.y_m, probability: leg.probability };
        Self {
            stamp_us: stamp.as_micros(),
            frame,
            sensor: "scanner",
            points: counts.points,
            segments: Some(counts.segments),
            legs: Some(legs.iter().map(leg).collect()),
            people: tracks.iter().map(|track| PersonRow::of_track(track, stamp)).collect(),
            dropped_legs: Some(counts.dropped_legs),
            health: if counts.points == 0 { "blind" } else { "healthy" },
            ..Self::NOTHING
        }
    }

    /// Of a lidar that leaves out a sector, hundredths of a degree: what it cannot see there does not make it blind.
    pub fn with_closed(mut self, sweep: &Sweep, closed_cdeg: u32) -> Self {
        let Some(unknown) = self.unknown_columns.filter(|_| closed_cdeg > 0) else { return self };
        let columns = sweep.column_count as u64;
        let closed = columns * u64::from(closed_cdeg) / 36_000;
        let unknown = u64::from(unknown).saturating_sub(closed);
        let is_blind = self.points == 0 || unknown * 2 > columns.saturating_sub(closed);
        self.health = if is_blind { "blind" } else { "healthy" };
        self.coverage_deg = Some((36_000 - closed_cdeg.min(36_000)) as f32 / 100.0);
        self
    }

    /// The same as seen from elsewhere: every place through that transform, and velocities turned.
    pub fn seen_from(mut self, transform: Pose2) -> Self {
        for leg in self.legs.iter_mut().flatten() {
            let place = transform.transform(Point2::new(leg.x_m, leg.y_m));
            (leg.x_m, leg.y_m) = (place.x_m, place.y_m);
        }
        for person in &mut self.people {
            person.motion = person.motion.seen_from(transform);
        }
        self
    }

    /// The frame moves itself, it is not known how: a person who never walked in it may have walked.
    pub fn in_moving_frame(mut self) -> Self {
        for person in &mut self.people {
            if person.explanation == Some(Explanation::LegsThatNeverWalked) {
                person.explanation = None;
                person.is_person = is_person(&person.report());
            }
        }
        self
    }

    /// From this topic of a bag.
    pub fn of_topic(mut self, topic: &str) -> Self {
        self.topic = Some(topic.to_owned());
        self
    }

    /// Everybody in it.
    pub fn everybody(&self) -> &[PersonRow] {
        &self.people
    }

    /// Numbers of the people in it.
    pub fn people(&self) -> impl Iterator<Item = u32> + '_ {
        self.people.iter().filter(|row| row.is_person).map(|row| row.id)
    }

    /// Legs in it.
    pub fn legs(&self) -> usize {
        self.legs.as_ref().map_or(0, Vec::len)
    }

    /// It bears a later time than the one before.
    pub fn is_newer(&self) -> bool {
        self.health != "frozen"
    }

    /// From the robot's tasks, in the odometry frame.
    pub fn of_report(report: &PeopleReport, digest: u64) -> Self {
        let counters = &report.sweep.counters;
        let row = Self::counted(report.sweep.stamp.as_micros(), ("odom", false), counters);
        Self {
            // While the lidar is silent, the list is that of the newest scan, which counts no returns.
            sensor: if *counters == PeopleCounters::default() { "scanner" } else { "lidar" },
            lost_packets: Some(report.sweep.lost_packets),
            people: report.people.iter().map(PersonRow::of_report).collect(),
            digest: Some(format!("{digest:016x}")),
            ..row
        }
    }

    fn counted(stamp_us: u64, (frame, blind): (&'static str, bool), counters: &PeopleCounters) -> Self {
        Self {
            stamp_us,
            frame,
            points: counters.points,
            floor_points: Some(counters.floor_points),
            clusters: Some(counters.clusters),
            moving_clusters: Some(counters.moving_clusters),
            candidates: Some(counters.candidates),
            unknown_columns: Some(counters.unknown_columns),
            dropped_clusters: Some(counters.dropped_clusters),
            dropped_candidates: Some(counters.dropped_candidates),
            health: if blind || counters.points == 0 { "blind" } else { "healthy" },
            ..Self::NOTHING
        }
    }
}

impl PersonRow {
    /// As the robot tells it.
    pub fn report(&self) -> PersonReport {
        let all = [TrackStatus::Confirmed, TrackStatus::Hidden];
        let status = all.into_iter().find(|status| word(*status) == self.status);
        PersonReport {
            id: self.id,
            status: status.unwrap_or(TrackStatus::Tentative),
            position: Point2::new(self.motion.x_m, self.motion.y_m),
            velocity_mps: Point2::new(self.motion.vx_mps, self.motion.vy_mps),
            position_sigma_m: self.sigma_position_m,
            velocity_sigma_mps: self.sigma_velocity_mps,
            person_probability: self.person_probability,
            moving_probability: self.moving_probability,
            sensors: self.sensors,
            explanation: self.explanation,
        }
    }

    fn of_track(track: &Track, now: Stamp) -> Self {
        Self {
            id: track.id,
            status: word(track.status),
            is_person: track.is_taken_for_person(),
            motion: Motion::new(track.state.position, track.state.velocity),
            sigma_position_m: libm::sqrtf(track.state.position_variance),
            sigma_velocity_mps: libm::sqrtf(track.state.velocity_variance),
            person_probability: track.person_probability,
            moving_probability: track.moving_probability,
            sensors: track.sensors(now),
            explanation: track.explanation,
        }
    }

    fn of_report(track: &PersonReport) -> Self {
        Self {
            id: track.id,
            status: word(track.status),
            is_person: is_person(track),
            motion: Motion::new(track.position, track.velocity_mps),
            sigma_position_m: track.position_sigma_m,
            sigma_velocity_mps: track.velocity_sigma_mps,
            person_probability: track.person_probability,
            moving_probability: track.moving_probability,
            sensors: track.sensors,
            explanation: track.explanation,
        }
    }
}

const fn word(status: TrackStatus) -> &'static str {
    match status {
        TrackStatus::Tentative => "tentative",
        TrackStatus::Confirmed => "confirmed",
        TrackStatus::Hidden => "hidden",
    }
}

/// The names of some sensors. The signature is that of the serialiser.
#[allow(clippy::trivially_copy_pass_by_ref)]
fn words<S: Serializer>(sensors: &SensorSet, out: S) -> Result<S::Ok, S::Error> {
    let word = |sensor: PeopleSensor| match sensor {
        PeopleSensor::Lidar => "lidar",
        PeopleSensor::Scanner => "scanner",
        PeopleSensor::DepthCamera => "depth-camera",
    };
    out.collect_seq(PeopleSensor::ALL.into_iter().filter(|sensor| sensors.contains(*sensor)).map(word))
}

/// The name of what explains a track. The signature is that of the serialiser.
#[allow(clippy::trivially_copy_pass_by_ref, clippy::ref_option)]
fn name<S: Serializer>(explanation: &Option<Explanation>, out: S) -> Result<S::Ok, S::Error> {
    match explanation {
        Some(explanation) => out.serialize_str(explanation.name()),
        None => out.serialize_none(),
    }
}

/// One line on standard output.
///
/// # Errors
/// Standard output is closed.
pub fn print(row: &impl Serialize) -> std::io::Result<()> {
    let line = serde_json::to_string(row)?;
    writeln!(std::io::stdout().lock(), "{line}")
}
