//! A recording, read once from its beginning to its end: what the report of it needs.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Read;
use std::sync::Arc;

use floorguard_types::geometry::{Point2, Point3, Pose2, Transform3};
use floorguard_types::time::Stamp;

use super::close_up::{self, Fields};
use floorguard_recording::decode::{self, Cloud, Drawn, Grid, LaserScan, Status};
use floorguard_recording::mission::MISSION;
use floorguard_recording::truth::is_truth;
use floorguard_recording::{
    END_METADATA, LEARNED, RUN_METADATA, ReadError, Recorded, Recording, describe, topics,
};

/// The path has a place every quarter of a second.
const PATH_S: f64 = 0.25;
/// The slider knows two moments a second.
const SIGHTING_S: f64 = 0.5;
/// The map takes two scans a second.
const MAP_S: f64 = 0.5;
/// Speeds are drawn five times a second.
const SPEED_S: f64 = 0.2;
/// Points of a cloud that the map takes, and the heights above the floor at which they count, metres.
const CLOUD_POINTS: usize = 4_000;
const STANDS_M: std::ops::Range<f32> = 0.2..1.8;
/// Number of the type in `sensor_msgs/msg/PointField`.
const FLOAT32: u8 = 7;
/// Level of a status of an error in `diagnostic_msgs/msg/DiagnosticStatus`: the guard's while it stops the robot.
const STOPPED: u8 = 2;
/// Pairs of fields that are kept: a robot has few, a recording of another one may draw a new one in each picture.
const FIELDS_MAX: usize = 64;
/// More pictures of stops than this make the page too long for a phone.
const MOMENTS_MAX: usize = 80;

/// What surrounded the robot at a moment, in its own frame.
#[derive(Clone, Debug, Default)]
pub struct Moment {
    /// Where the scanner saw something.
    pub hits: Vec<Point2>,
    /// Tracked people and their numbers.
    pub people: Vec<(i32, Point2)>,
    /// The protective field that was watched.
    pub protective: Vec<Point2>,
    /// The warning field.
    pub warning: Vec<Point2>,
}

/// A stop.
#[derive(Clone, Debug)]
pub struct Stop {
    /// Seconds since the beginning.
    pub at_s: f64,
    /// What the recording says about it.
    pub status: Status,
    /// Where the robot was.
    pub pose: Pose2,
    /// What surrounded it; none after too many stops.
    pub moment: Option<Moment>,
}

/// Speed and limit at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speed {
    /// Seconds since the beginning.
    pub at_s: f64,
    /// Measured, m/s.
    pub speed_mps: f32,
    /// Permitted, m/s; none before the guard's first decision.
    pub limit_mps: Option<f32>,
}

/// Where the robot and the people were at a moment, for the slider over the run.
#[derive(Clone, Debug)]
pub struct Sighting {
    /// Seconds since the beginning.
    pub at_s: f64,
    /// The robot.
    pub pose: Pose2,
    /// Measured speed, m/s.
    pub speed_mps: f32,
    /// People, each with its number.
    pub people: Vec<(i32, Point2)>,
    /// What the scanner saw around the robot, as [`close_up::seen`] packs it; empty without a scanner.
    pub seen: String,
    /// Which of [`History::fields`] were watched; none before the first.
    pub fields: Option<usize>,
}

/// A scan where it was taken, for the map.
#[derive(Clone, Debug)]
pub struct MapScan {
    /// The scanner in the odometry frame.
    pub sensor: Pose2,
    /// Hits in the scanner's frame.
    pub hits: Vec<Point2>,
}

/// Everything.
#[derive(Clone, Debug, Default)]
pub struct History {
    /// About the run: scenario, seed, version.
    pub texts: BTreeMap<String, String>,
    /// What the robot learned of the appearance of people, in words, if it does.
    pub learned: Option<String>,
    /// From the first message to the last, seconds.
    pub duration_s: f64,
    /// Messages read.
    pub messages: u64,
    /// Why it ends early.
    pub ended: Option<String>,
    /// Where the robot was.
    pub path: Vec<Pose2>,
    /// Metres driven.
    pub driven_m: f64,
    /// Twice a second.
    pub sightings: Vec<Sighting>,
    /// Every pair of fields that was watched.
    pub fields: Vec<Fields>,
    /// Speed and limit.
    pub speeds: Vec<Speed>,
    /// Where each person was, by number.
    pub people: BTreeMap<i32, Vec<Point2>>,
    /// Seconds that people were in each place of the heat map, by place.
    pub heat: BTreeMap<(i32, i32), u32>,
    /// How each source was: from when on, and the word.
    pub sources: BTreeMap<String, Vec<(f64, u8, String)>>,
    /// Counters at the end: name, value, by group.
    pub counters: BTreeMap<String, Vec<(String, String)>>,
    /// How far the cleaning mission was, and when: named values.
    pub mission: Vec<(f64, Vec<(String, String)>)>,
    /// What held the robot and what came of the resets: when, and in words.
    pub held: Vec<(f64, String)>,
    /// Every stop.
    pub stops: Vec<Stop>,
    /// Scans for the map.
    pub scans: Vec<MapScan>,
    /// Maps in the recording: the first and the last of each topic.
    pub grids: BTreeMap<String, (Grid, Grid)>,
}

/// Edge of a place of the heat map, metres.
pub const HEAT_M: f32 = 0.5;

/// What is known while reading.
#[derive(Default)]
struct Reader {
    history: History,
    first: Option<Stamp>,
    odometry: Option<Arc<str>>,
    pose: Pose2,
    limit_mps: Option<f32>,
    mountings: BTreeMap<String, Transform3>,
    scan: Option<LaserScan>,
    people: Vec<(i32, Point2)>,
    fields: Vec<Drawn>,
    held: BTreeSet<String>,
    next_path_s: f64,
    next_map_s: f64,
    next_speed_s: f64,
}

/// Reads a recording.
///
/// # Errors
/// Not even its first message can be read.
pub fn read_history<R: Read>(recording: &mut Recording<R>) -> Result<History, ReadError> {
    let mut reader = Reader::default();
    for message in recording.by_ref() {
        match message {
            // A damaged message is left out, like a lost one.
            Ok(message) => _ = reader.take(&message),
            Err(error) if reader.history.messages == 0 => return Err(error),
            Err(error) => reader.history.ended = Some(error.to_string()),
        }
    }
    let mut history = reader.history;
    history.texts = recording.metadata(RUN_METADATA).cloned().unwrap_or_default();
    history.learned = recording.metadata(END_METADATA).and_then(|texts| texts.get(LEARNED).cloned());
    Ok(history)
}

fn flat(transform: &Transform3) -> Pose2 {
    let [[cos, ..], [sin, ..], _] = transform.rotation;
    Pose2::new(transform.translation.x_m, transform.translation.y_m, libm::atan2f(sin, cos))
}

/// A scanner on its head sees its beams the other way round.
fn hits(scan: &LaserScan, upside_down: bool) -> Vec<Point2> {
    let beams = scan.ranges_m.iter().enumerate();
    let real = beams.filter(|(_, range_m)| range_m.is_finite() && **range_m > 0.05);
    real.map(|(index, range_m)| {
        let (sin, cos) = libm::sincosf(scan.first_angle_rad + index as f32 * scan.step_rad);
        Point2::new(range_m * cos, if upside_down { -range_m * sin } else { range_m * sin })
    })
    .collect()
}

impl Reader {
    fn take(&mut self, message: &Recorded) -> Option<()> {
        self.history.messages += 1;
        let first = *self.first.get_or_insert(message.at);
        let at_s = message.at.as_micros().saturating_sub(first.as_micros()) as f64 * 1.0e-6;
        self.history.duration_s = self.history.duration_s.max(at_s);
        let kind = message.schema.rsplit('/').next().unwrap_or_default();
        match (kind, &*message.topic) {
            ("Odometry", _) if self.is_own(&message.topic) => {
                self.motion(at_s, &decode::odometry(&message.data)?)
            }
            ("PointCloud2", _) if self.scan.is_none() => {
                self.on_cloud(at_s, &decode::cloud(&message.data)?)?
            }
            ("LaserScan", _) => self.on_scan(at_s, decode::laser_scan(&message.data)?),
            ("TFMessage", topics::TF_STATIC) => {
                for frame in decode::frames(&message.data)? {
                    self.mountings.insert(frame.child, frame.transform);
                }
            }
            ("Float32", topics::SPEED_LIMIT) => self.limit_mps = decode::number(&message.data),
            ("MarkerArray", topics::PEOPLE) => self.on_people(&decode::markers(&message.data)?),
            ("MarkerArray", topics::FIELDS) => self.fields = decode::markers(&message.data)?,
            ("DiagnosticArray", topics::STOPS) => self.on_stops(at_s, decode::diagnostics(&message.data)?.1),
            ("DiagnosticArray", _) => self.on_status(at_s, decode::diagnostics(&message.data)?.1),
            ("OccupancyGrid", topic) => {
                let grid = decode::grid(&message.data)?;
                let first = grid.clone();
                self.history.grids.entry(topic.to_owned()).or_insert_with(|| (first.clone(), first)).1 = grid;
            }
            _ => {}
        }
        Some(())
    }

    /// Whether the robot's own odometry is on a topic: the first one that is no truth of a simulator.
    fn is_own(&mut self, topic: &Arc<str>) -> bool {
        !is_truth(topic) && *self.odometry.get_or_insert_with(|| topic.clone()) == *topic
    }

    fn motion(&mut self, at_s: f64, odometry: &decode::Odometry) {
        self.pose = odometry.pose;
        if at_s >= self.next_path_s {
            self.next_path_s = at_s + PATH_S;
            let place = |pose: &Pose2| Point2::new(pose.x_m, pose.y_m);
            let step_m = self.history.path.last().map_or(0.0, |last| place(last).distance(place(&self.pose)));
            self.history.driven_m += f64::from(step_m);
            self.history.path.push(self.pose);
        }
        if self.history.sightings.last().is_none_or(|last| at_s >= last.at_s + SIGHTING_S) {
            let (pose, people, speed_mps) = (self.pose, self.people.clone(), odometry.twist.linear_mps);
            let (seen, fields) = (close_up::seen(&self.around()), self.watched());
            self.history.sightings.push(Sighting { at_s, pose, speed_mps, people, seen, fields });
        }
        if at_s >= self.next_speed_s {
            self.next_speed_s = at_s + SPEED_S;
            let (speed_mps, limit_mps) = (odometry.twist.linear_mps, self.limit_mps);
            self.history.speeds.push(Speed { at_s, speed_mps, limit_mps });
        }
    }

    fn on_scan(&mut self, at_s: f64, scan: LaserScan) {
        if at_s >= self.next_map_s {
            self.next_map_s = at_s + MAP_S;
            let (mounting, upside_down) = self.mounting(&scan.header.frame);
            let sensor = self.pose.compose(mounting);
            self.history.scans.push(MapScan { sensor, hits: hits(&scan, upside_down) });
        }
        self.scan = Some(scan);
    }

    /// A capture has no scanner: what stands above the floor makes the map.
    fn on_cloud(&mut self, at_s: f64, cloud: &Cloud<'_>) -> Option<()> {
        if at_s < self.next_map_s || cloud.big_endian || cloud.point_step == 0 {
            return Some(());
        }
        self.next_map_s = at_s + MAP_S;
        let offset = |name: &str| {
            let found = cloud.fields.iter().find(|field| field.name == name && field.datatype == FLOAT32);
            found.map(|field| field.offset)
        };
        let (x, y, z) = (offset("x")?, offset("y")?, offset("z")?);
        let number =
            |point: &[u8], at: usize| Some(f32::from_le_bytes(*point.get(at..)?.first_chunk::<4>()?));
        let mounting = self.mountings.get(&cloud.header.frame).copied().unwrap_or(Transform3::IDENTITY);
        let every = (cloud.width * cloud.height).div_ceil(CLOUD_POINTS).max(1);
        let mut hits = Vec::new();
        for point in cloud.data.chunks_exact(cloud.point_step).step_by(every) {
            let place = Point3::new(number(point, x)?, number(point, y)?, number(point, z)?);
            let place = mounting.transform(place);
            if STANDS_M.contains(&place.z_m) && place.x_m.is_finite() && place.y_m.is_finite() {
                hits.push(Point2::new(place.x_m, place.y_m));
            }
        }
        self.history.scans.push(MapScan { sensor: self.pose, hits });
        Some(())
    }

    fn mounting(&self, frame: &str) -> (Pose2, bool) {
        let mounting = self.mountings.get(frame).copied().unwrap_or(Transform3::IDENTITY);
        let [_, _, [_, _, up]] = mounting.rotation;
        (flat(&mounting), up < 0.0)
    }

    fn on_people(&mut self, drawn: &[Drawn]) {
        let people = drawn.iter().filter(|marker| marker.group == describe::PERSON_GROUP);
        self.people =
            people.map(|marker| (marker.id, Point2::new(marker.pose.x_m, marker.pose.y_m))).collect();
        for (id, place) in &self.people {
            self.history.people.entry(*id).or_default().push(*place);
            let place = ((place.x_m / HEAT_M).floor() as i32, (place.y_m / HEAT_M).floor() as i32);
            *self.history.heat.entry(place).or_default() += 1;
        }
    }

    fn on_stops(&mut self, at_s: f64, list: Vec<Status>) {
        for status in list {
            let number = |name: &str| status.number(name).unwrap_or(0.0) as f32;
            let pose = Pose2::new(number("x_m"), number("y_m"), number("heading_rad"));
            let moment = (self.history.stops.len() < MOMENTS_MAX).then(|| self.moment(pose));
            self.history.stops.push(Stop { at_s, status, pose, moment });
        }
    }

    /// What the scanner saw last, in the robot's frame.
    fn around(&self) -> Vec<Point2> {
        let Some(scan) = &self.scan else { return Vec::new() };
        let (mounting, upside_down) = self.mounting(&scan.header.frame);
        hits(scan, upside_down).into_iter().map(|point| mounting.transform(point)).collect()
    }

    fn outlines(&self) -> Fields {
        let outline = |group: &str| {
            let found = self.fields.iter().find(|drawn| drawn.group == group);
            found.map(|drawn| drawn.points.clone()).unwrap_or_default()
        };
        Fields { protective: outline(describe::PROTECTIVE_GROUP), warning: outline(describe::WARNING_GROUP) }
    }

    /// The fields that are watched, kept once.
    fn watched(&mut self) -> Option<usize> {
        let fields = self.outlines();
        if fields == Fields::default() {
            return None;
        }
        let known = &mut self.history.fields;
        let found = known.iter().position(|other| *other == fields);
        if found.is_none() && known.len() < FIELDS_MAX {
            known.push(fields);
            return Some(known.len() - 1);
        }
        found
    }

    fn moment(&self, pose: Pose2) -> Moment {
        let to_robot = pose.inverse();
        let Fields { protective, warning } = self.outlines();
        let people = self.people.iter().map(|(id, place)| (*id, to_robot.transform(*place))).collect();
        Moment { hits: self.around(), people, protective, warning }
    }

    /// A cause that has not held the robot during this stop; causes that take turns are reported once.
    fn on_held(&mut self, at_s: f64, status: &Status) {
        let holding = status.value("holding").filter(|cause| !cause.is_empty() && status.level == STOPPED);
        let Some(cause) = holding else { return self.held.clear() };
        if self.held.insert(cause.to_owned()) {
            self.history.held.push((at_s, format!("held by: {}", status.message)));
        }
    }

    fn on_status(&mut self, at_s: f64, list: Vec<Status>) {
        for status in list {
            if ["links", "sweep", "recording"].contains(&status.name.as_str()) {
                self.history.counters.insert(status.name, status.values);
                continue;
            }
            if status.name == MISSION {
                self.history.mission.push((at_s, status.values));
                continue;
            }
            if status.name == describe::RESET {
                self.history.held.push((at_s, format!("reset {}", status.message)));
                self.held.clear();
                continue;
            }
            if status.name == describe::GUARD {
                self.on_held(at_s, &status);
            }
            let (level, word) = match status.value("state") {
                Some(state) => (status.level, state.to_lowercase()),
                None => (status.level, status.message.clone()),
            };
            let known = self.history.sources.entry(status.name).or_default();
            if known.last().is_none_or(|(_, last_level, last)| (*last_level, last) != (level, &word)) {
                known.push((at_s, level, word));
            }
        }
    }
}
