//! What `--json` prints: one object per sweep or scan and line, whatever the input was.

use std::io::Write;

use floorguard_perception::legs::{LegTrack, PersonByLegs};
use floorguard_perception::people::{
    Explanation, PeopleCounters, PeopleOutput, PeopleSensor, SensorSet, Track, TrackStatus,
};
use floorguard_runtime::shared::{PeopleReport, PersonReport};
use floorguard_types::geometry::Point2;
use floorguard_types::sensing::Sweep;
use floorguard_types::time::Stamp;
use serde::{Serialize, Serializer};

/// A track.
#[derive(Clone, Debug, Serialize)]
pub struct PersonRow {
    id: u32,
    status: &'static str,
    #[serde(flatten)]
    motion: Motion,
    sigma_position_m: f32,
    sigma_velocity_mps: f32,
    person_probability: f32,
    #[serde(skip_serializing_if = "is_unknown")]
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

/// A sweep of the three-dimensional lidar.
#[derive(Serialize)]
pub struct SweepRow {
    stamp_us: u64,
    frame: &'static str,
    points: u32,
    floor_points: u32,
    clusters: u32,
    moving_clusters: u32,
    candidates: u32,
    people: Vec<PersonRow>,
    lost_packets: u16,
    unknown_columns: u32,
    /// Degrees of the turn that the lidar is set to see.
    #[serde(skip_serializing_if = "Option::is_none")]
    coverage_deg: Option<f32>,
    dropped_clusters: u32,
    dropped_candidates: u32,
    health: &'static str,
    /// Fingerprint of everything that the robot has put out so far; only of recordings of whole robots.
    #[serde(skip_serializing_if = "Option::is_none")]
    digest: Option<String>,
}

impl SweepRow {
    /// From the people stages alone, in the frame in which they worked.
    pub fn of_output(sweep: &Sweep, output: &PeopleOutput<'_>) -> Self {
        let blind = output.counters.unknown_columns as usize * 2 > sweep.column_count;
        Self {
            lost_packets: sweep.lost_packets,
            people: output.tracks.iter().map(|track| PersonRow::of_track(track, sweep.end_stamp)).collect(),
            ..Self::counted(sweep.end_stamp.as_micros(), ("sensor", blind), &output.counters)
        }
    }

    /// Of a lidar that leaves out a sector, hundredths of a degree: what it cannot see there does not make it blind.
    pub fn with_closed(mut self, sweep: &Sweep, closed_cdeg: u32) -> Self {
        if closed_cdeg == 0 {
            return self;
        }
        let columns = sweep.column_count as u64;
        let closed = columns * u64::from(closed_cdeg) / 36_000;
        let unknown = u64::from(self.unknown_columns).saturating_sub(closed);
        let is_blind = self.points == 0 || unknown * 2 > columns.saturating_sub(closed);
        self.health = if is_blind { "blind" } else { "healthy" };
        self.coverage_deg = Some((36_000 - closed_cdeg.min(36_000)) as f32 / 100.0);
        self
    }

    /// Everybody in it.
    pub fn people(&self) -> &[PersonRow] {
        &self.people
    }

    /// The same in another frame.
    pub fn in_frame(mut self, frame: &'static str) -> Self {
        self.frame = frame;
        self
    }

    /// From the robot's tasks, in the odometry frame.
    pub fn of_report(report: &PeopleReport, digest: u64) -> Self {
        Self {
            lost_packets: report.sweep.lost_packets,
            people: report.people.iter().map(PersonRow::of_report).collect(),
            digest: Some(format!("{digest:016x}")),
            ..Self::counted(report.sweep.stamp.as_micros(), ("odom", false), &report.sweep.counters)
        }
    }

    fn counted(stamp_us: u64, (frame, blind): (&'static str, bool), counters: &PeopleCounters) -> Self {
        Self {
            stamp_us,
            frame,
            points: counters.points,
            floor_points: counters.floor_points,
            clusters: counters.clusters,
            moving_clusters: counters.moving_clusters,
            candidates: counters.candidates,
            people: Vec::new(),
            lost_packets: 0,
            unknown_columns: counters.unknown_columns,
            coverage_deg: None,
            dropped_clusters: counters.dropped_clusters,
            dropped_candidates: counters.dropped_candidates,
            health: if blind || counters.points == 0 { "blind" } else { "healthy" },
            digest: None,
        }
    }
}

impl PersonRow {
    /// Number of the track, if it is confirmed.
    pub fn confirmed_id(&self) -> Option<u32> {
        (self.status == word(TrackStatus::Confirmed)).then_some(self.id)
    }

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

    /// Two legs that belong together, the person's number, and whether they have walked: only then is it confirmed.
    pub fn of_legs(person: &PersonByLegs, [one, other]: [&LegTrack; 2], (id, walked): (u32, bool)) -> Self {
        let mean = |a: f32, b: f32| (a + b) * 0.5;
        Self {
            id,
            status: word(if walked { TrackStatus::Confirmed } else { TrackStatus::Tentative }),
            motion: Motion::new(
                person.position,
                Point2::new(
                    mean(one.state.velocity.x_m, other.state.velocity.x_m),
                    mean(one.state.velocity.y_m, other.state.velocity.y_m),
                ),
            ),
            sigma_position_m: person.sigma_m(),
            sigma_velocity_mps: libm::sqrtf(one.state.velocity_variance.max(other.state.velocity_variance)),
            person_probability: person.reliability,
            moving_probability: f32::NAN,
            sensors: SensorSet::NONE.with(PeopleSensor::Scanner),
            explanation: None,
        }
    }

    fn of_track(track: &Track, now: Stamp) -> Self {
        Self {
            id: track.id,
            status: word(track.status),
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

/// Legs tell nothing about it.
fn is_unknown(probability: &f32) -> bool {
    probability.is_nan()
}

/// One line on standard output.
///
/// # Errors
/// Standard output is closed.
pub fn print(row: &impl Serialize) -> std::io::Result<()> {
    let line = serde_json::to_string(row)?;
    writeln!(std::io::stdout().lock(), "{line}")
}
