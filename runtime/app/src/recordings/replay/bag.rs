//! Anybody's ROS 2 bag: people out of its point clouds, legs and people out of its scans.
//!
//! Frames: with odometry in the bag, people are in its frame; mountings come from `/tf_static` (base_link or
//! base_footprint to the sensor, over any number of links). Without them the sensor stands upright at the robot's origin.

use std::collections::BTreeSet;
use std::io::Read;

use floorguard_localisation::odometry::PoseHistory;
use floorguard_perception::people::SweepContext;
use floorguard_types::geometry::{Pose2, Transform3, Twist2};
use floorguard_types::sensing::Sweep;
use floorguard_types::time::Stamp;

use super::cloud::CloudSorter;
use super::floor_below::floor_below_m;
use super::recorded::Recorded as Written;
use super::rows::print;
use super::scans::to_scan;
use super::stages::RobotStages;
use super::standing_lidar::ASSUMED_HEIGHT_M;
use super::summary::Summary;
use crate::recordings::arguments::ReplayArguments;
use crate::recordings::frame_tree::{FrameTree, flat};
use floorguard_host::outcome::BadInput;
use floorguard_recording::decode::{self, LaserScan};
use floorguard_recording::truth::is_truth;
use floorguard_recording::{ReadError, Recorded, Recording};

/// A lidar is at least this high, metres.
const FLOOR_NEAREST_M: f32 = 0.2;
/// Heights that differ by less are the same floor, metres: that of the frame tree is then the better one.
const SAME_FLOOR_M: f32 = 0.1;

/// What a bag is played through.
struct Player<'a> {
    name: &'a str,
    topic: Option<&'a str>,
    json: bool,
    lidar: Option<Lidar>,
    stages: RobotStages,
    /// Topics of scans so far.
    scanners: BTreeSet<String>,
    mountings: FrameTree,
    odometry: PoseHistory,
    twist: Twist2,
    sweeps: Summary,
    scans: Summary,
    damaged: u64,
    /// Whole messages in which the sensor sent nothing.
    empty: u64,
    written: Written,
}

struct Lidar {
    topic: String,
    sorter: CloudSorter,
    sweep: Box<Sweep>,
    /// Of the floor below, and with which mounting it was found.
    height: Option<(Option<Transform3>, f32)>,
}

/// Runs the command on a bag whose first message has been read.
///
/// # Errors
/// Bad input; everything before it has been processed and printed.
pub fn run<R: Read>(
    first: Recorded,
    recording: &mut Recording<R>,
    (name, arguments): (&str, &ReplayArguments),
) -> anyhow::Result<()> {
    let mut player = Player {
        name,
        topic: arguments.topic.as_deref(),
        json: arguments.json,
        lidar: None,
        stages: RobotStages::new()?,
        scanners: BTreeSet::new(),
        mountings: FrameTree::default(),
        odometry: PoseHistory::new(),
        twist: Twist2::ZERO,
        sweeps: Summary::new(),
        scans: Summary::new(),
        damaged: 0,
        empty: 0,
        written: Written::open(&arguments.file, arguments.record.as_deref())?,
    };
    let mut ended: Option<ReadError> = None;
    player.message(&first)?;
    for message in recording.by_ref() {
        match message {
            Ok(message) => player.message(&message)?,
            Err(error) => ended = Some(error),
        }
    }
    player.conclude(recording)?;
    player.written.finish()?;
    ended.map_or(Ok(()), |error| Err(BadInput(format!("{name}: {error}")).into()))
}

/// `sensor_msgs/msg/Imu` and `sensor_msgs/Imu` are the same.
fn kind(schema: &str) -> &str {
    schema.rsplit('/').next().unwrap_or(schema)
}

impl Player<'_> {
    fn message(&mut self, message: &Recorded) -> anyhow::Result<()> {
        let kind = kind(&message.schema);
        let known = matches!(kind, "PointCloud2" | "LaserScan" | "Odometry" | "TFMessage" | "Imu");
        if !known {
            return Ok(());
        }
        if &*message.encoding != "cdr" {
            return Err(BadInput(format!(
                "{}: {} is serialised as {:?}; a ROS 2 bag has \"cdr\" (convert bags of ROS 1 first)",
                self.name, message.topic, &*message.encoding
            ))
            .into());
        }
        let wanted = self.topic.is_none_or(|topic| topic == &*message.topic);
        let read = match kind {
            "PointCloud2" if wanted => self.cloud(message)?,
            "LaserScan" if wanted => self.scan(message)?,
            "Odometry" if !is_truth(&message.topic) => self.motion(message),
            "TFMessage" => self.frames(message),
            "Imu" => self.turn(message),
            _ => Some(()),
        };
        self.damaged += u64::from(read.is_none());
        Ok(())
    }

    fn motion(&mut self, message: &Recorded) -> Option<()> {
        let odometry = decode::odometry(&message.data)?;
        self.odometry.record(odometry.header.stamp, odometry.pose);
        self.twist = odometry.twist;
        Some(())
    }

    /// A gyroscope turns the sweep straight where no odometry tells how the robot moved.
    fn turn(&mut self, message: &Recorded) -> Option<()> {
        let imu = decode::imu(&message.data)?;
        if self.odometry.newest().is_none() {
            let mounting = self.mountings.mounting(&imu.header.frame).unwrap_or(Transform3::IDENTITY);
            let [_, _, row] = mounting.rotation;
            let turn: f32 = row.iter().zip(imu.angular_radps).map(|(a, b)| a * b).sum();
            self.twist.angular_radps = if turn.is_finite() { turn } else { 0.0 };
        }
        Some(())
    }

    fn frames(&mut self, message: &Recorded) -> Option<()> {
        decode::frames(&message.data)?.iter().for_each(|frame| self.mountings.enter(frame));
        Some(())
    }

    fn pose(&self, stamp: Stamp) -> Option<Pose2> {
        self.odometry.at(stamp).ok().or_else(|| self.odometry.newest().map(|(_, pose)| pose))
    }

    fn cloud(&mut self, message: &Recorded) -> anyhow::Result<Option<()>> {
        let Some(cloud) = decode::cloud(&message.data) else { return Ok(None) };
        if cloud.width == 0 || cloud.height == 0 {
            self.empty += 1;
            return Ok(Some(()));
        }
        let mounting = self.mountings.mounting(&cloud.header.frame);
        let (pose, twist) = (self.pose(cloud.header.stamp), self.twist);
        let lidar = self.lidar.get_or_insert_with(|| Lidar {
            topic: message.topic.to_string(),
            sorter: CloudSorter::default(),
            sweep: Box::new(Sweep::EMPTY),
            height: None,
        });
        if lidar.topic != *message.topic {
            return Ok(Some(()));
        }
        lidar
            .sorter
            .sweep(&cloud, &mut lidar.sweep)
            .map_err(|error| BadInput(format!("{}: {}: {error}", self.name, message.topic)))?;
        let angles = lidar.sorter.angles();
        self.stages.set_rings(angles);
        let mut sensor_in_base = mounting.unwrap_or(Transform3::IDENTITY);
        // The frame tree may name a lidar's mounting later than the first cloud.
        if lidar.height.is_none_or(|(with, _)| with != mounting) {
            let found_m = floor_below_m(&lidar.sweep, &angles, &sensor_in_base);
            lidar.height = found_m.map(|height_m| (mounting, height_m));
        }
        // The height in the frame tree is above its base, which may be the floor or an axle: the floor itself tells.
        let by_tree_m = Some(sensor_in_base.translation.z_m).filter(|z_m| *z_m > FLOOR_NEAREST_M);
        let seen_m = lidar.height.map(|(_, height_m)| height_m);
        sensor_in_base.translation.z_m = match (seen_m, by_tree_m) {
            (Some(seen_m), Some(tree_m)) if (seen_m - tree_m).abs() < SAME_FLOOR_M => tree_m,
            (Some(seen_m), _) => seen_m,
            (None, tree_m) => tree_m.unwrap_or(ASSUMED_HEIGHT_M),
        };
        let base_in_odom = pose.unwrap_or_default();
        let frame = if pose.is_some() { "odom" } else { "sensor" };
        let context = SweepContext { sensor_in_base, twist, base_in_odom };
        let row = self.stages.sweep(&lidar.sweep, &context, frame);
        self.sweeps.frame(&row);
        self.written.sweep(
            (&lidar.sweep, &angles),
            (&sensor_in_base, (base_in_odom, twist)),
            row.everybody(),
        );
        if self.json {
            print(&row)?;
        }
        Ok(Some(()))
    }

    fn scan(&mut self, message: &Recorded) -> anyhow::Result<Option<()>> {
        let Some(laser) = decode::laser_scan(&message.data) else { return Ok(None) };
        if laser.ranges_m.is_empty() {
            self.empty += 1;
            return Ok(Some(()));
        }
        if !is_usable(&laser) {
            return Ok(None);
        }
        let mounting = self.mountings.mounting(&laser.header.frame).unwrap_or(Transform3::IDENTITY);
        let stamp = laser.middle();
        let pose = self.pose(stamp);
        let angles = (laser.first_angle_rad, laser.step_rad);
        let limits_m = [laser.range_min_m, laser.range_max_m];
        let scan = to_scan(stamp, angles, &laser.ranges_m, limits_m);
        let mounting = flat(&mounting);
        let sensor = pose.unwrap_or_default().compose(mounting);
        let mut row = self.stages.scan(&message.topic, &scan, (mounting, pose));
        self.scanners.insert(message.topic.to_string());
        if self.scanners.len() > 1 {
            row = row.of_topic(&message.topic);
        }
        self.scans.frame(&row);
        self.written.scan(&scan, sensor, row.everybody());
        if self.json {
            print(&row)?;
        }
        Ok(Some(()))
    }

    fn conclude<R: Read>(&self, recording: &Recording<R>) -> anyhow::Result<()> {
        if self.damaged > 0 {
            say!("{} damaged messages were left out", self.damaged);
        }
        if self.empty > 0 {
            say!("{} empty scans or clouds: the sensor sent no values", self.empty);
        }
        for (summary, what) in [(&self.sweeps, "sweep"), (&self.scans, "scan")] {
            if summary.frames > 0 {
                say!("{}", summary.line(what));
            }
            summary.say_standing(what);
        }
        self.stages.say_times();
        if self.sweeps.frames + self.scans.frames > 0 {
            return Ok(());
        }
        let mut topics = recording.topics();
        // Who named a wrong topic wants to know the right ones, not all.
        let suits = |schema: &str| matches!(kind(schema), "PointCloud2" | "LaserScan");
        if topics.iter().any(|(_, schema)| suits(schema)) {
            topics.retain(|(_, schema)| suits(schema));
        }
        let listed: Vec<String> =
            topics.iter().map(|(topic, schema)| format!("{topic} ({schema})")).collect();
        let listed = if listed.is_empty() { "nothing".to_owned() } else { listed.join(", ") };
        let what = self.topic.map_or_else(String::new, |topic| format!(" of topic {topic}"));
        Err(BadInput(format!("{}: no PointCloud2 and no LaserScan{what}; it holds {listed}", self.name))
            .into())
    }
}

fn is_usable(scan: &LaserScan) -> bool {
    let numbers = [scan.first_angle_rad, scan.step_rad];
    numbers.iter().all(|number| number.is_finite()) && scan.step_rad.abs() > 1.0e-5
}
