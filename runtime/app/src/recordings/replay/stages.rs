//! The robot's own stages for whatever is replayed: one memory of perception, one list of people for all sensors.
//!
//! What a recording does not hold is missing as it would be on the robot: without a lidar legs are followed alone,
//! without a scanner there are no legs, without odometry places are in the frame of the sensor.

use std::collections::BTreeMap;

use floorguard_configuration::{EXAMPLE, parse};
use floorguard_perception::any_scanner::ScannerPose;
use floorguard_perception::people::{RingAngles, SweepContext, hangs, turn_over, turned_over_mounting};
use floorguard_robot::assembly::{HostedLegs, HostedPerception, Stages, new_perception};
use floorguard_runtime::configuration::{LidarModel, RobotConfiguration};
use floorguard_runtime::tasks::{JudgeMotion as _, SEARCHED_STEP_RAD};
use floorguard_types::geometry::{Pose2, Transform3};
use floorguard_types::sensing::{LidarPacket, Scan, Sweep};
use floorguard_types::time::Stamp;

use super::rows::{FrameRow, ScanCounts};
use super::scan_odometry::{Place, ScanOdometry};
use super::scans::hits;

/// A sensor's time that falls back by more than this was set anew, microseconds: everything begins again.
const SET_BACK_US: u64 = 1_000_000;
/// The lidar among the sources; a scanner has the name of its topic.
const LIDAR: &str = "the lidar";

/// The robot's perception, fed from a recording.
pub struct RobotStages {
    robot: RobotConfiguration,
    perception: Box<HostedPerception>,
    /// Of the lidar as it is built.
    rings: RingAngles,
    /// Legs of each scanner.
    scanners: BTreeMap<String, HostedLegs>,
    /// Legs of a scanner that was not seen before.
    new_legs: fn() -> HostedLegs,
    /// Where each scanner stands that comes without a pose.
    odometry: BTreeMap<String, ScanOdometry>,
    /// Time of the newest sweep or scan of each source.
    newest: BTreeMap<String, Stamp>,
    searched: Box<Scan>,
    restarts: u64,
    late: u64,
}

impl RobotStages {
    /// Nothing seen yet; the stages are those of the example robot.
    ///
    /// # Errors
    /// The example is refused, which a test of its own excludes.
    pub fn new() -> anyhow::Result<Self> {
        let robot = parse("robot.toml", EXAMPLE)?.robot;
        Ok(Self {
            perception: new_perception(&robot, Stages::All),
            rings: RingAngles::vlp16(),
            robot,
            scanners: BTreeMap::new(),
            new_legs: HostedLegs::any,
            odometry: BTreeMap::new(),
            newest: BTreeMap::new(),
            searched: Box::new(Scan::EMPTY),
            restarts: 0,
            late: 0,
        })
    }

    /// The scanners are S300, which the committee near the floor was trained for.
    #[must_use]
    pub fn for_s300(mut self) -> Self {
        self.new_legs = HostedLegs::trained;
        self
    }

    /// The lidar is of that model: what its rings are, and whether people are looked for in others once more.
    pub fn set_lidar(&mut self, model: LidarModel) {
        self.robot.lidar.model = model;
        self.rings = self.robot.ring_angles();
        self.perception = new_perception(&self.robot, Stages::All);
    }

    /// A packet on its way into the next sweep, arranged for people, and how many are missing before it.
    pub fn note_packet(&mut self, packet: &LidarPacket, lost_before: u16, sensor_in_base: &Transform3) {
        self.perception.motion.note_packet(packet, lost_before, hangs(sensor_in_base));
    }

    /// The lidar has these rings.
    pub fn set_rings(&mut self, angles: RingAngles) {
        self.rings = angles;
    }

    /// The lidar's rings.
    pub const fn rings(&self) -> &RingAngles {
        &self.rings
    }

    /// A sweep of the lidar; `frame` is that of the robot's place in the context.
    pub fn sweep(&mut self, sweep: &Sweep, context: &SweepContext, frame: &'static str) -> FrameRow {
        if !self.is_newer(LIDAR, sweep.end_stamp) {
            return FrameRow::frozen((sweep.end_stamp, "lidar"), (frame, returns(sweep)));
        }
        let HostedPerception { people, motion, building, .. } = &mut *self.perception;
        let before = people.tracker().late;
        // As on the robot: a lidar that hangs upside down is turned over first.
        let is_hanging = hangs(&context.sensor_in_base);
        people.angles = if is_hanging { self.rings.turned_over() } else { self.rings };
        let row = if is_hanging {
            building.clone_from(sweep);
            turn_over(building);
            let sensor_in_base = turned_over_mounting(&context.sensor_in_base);
            let output = motion.people(people, building, &SweepContext { sensor_in_base, ..*context });
            FrameRow::of_sweep(building, &output, frame)
        } else {
            FrameRow::of_sweep(sweep, &motion.people(people, sweep, context), frame)
        };
        self.late += u64::from(self.perception.people.tracker().late - before);
        row
    }

    /// A scan of the scanner of that name, and where it stood on the robot and in the odometry. Without odometry the scans
    /// themselves tell how the scanner moves, and places come out in its own frame.
    pub fn scan(
        &mut self,
        name: &str,
        scan: &Scan,
        (mounting, odometry): (Pose2, Option<Pose2>),
    ) -> FrameRow {
        let points = hits(scan);
        let frame = if odometry.is_some() { "odom" } else { "sensor" };
        if !self.is_newer(name, scan.stamp) {
            return FrameRow::frozen((scan.stamp, "scanner"), (frame, points));
        }
        // With a lidar of unknown motion there is one frame for both: that of the robot.
        let is_alone = odometry.is_none() && !self.newest.contains_key(LIDAR);
        let pose = match odometry {
            Some(base) => ScannerPose::InFixedFrame(base.compose(mounting)),
            None if is_alone => self.matched(name, scan),
            None => ScannerPose::OnMovingRobot(mounting),
        };
        // As on the robot: beams no denser than those the legs were learned from.
        self.searched.copy_thinned(scan, SEARCHED_STEP_RAD);
        let legs = self.scanners.entry(name.to_owned()).or_insert_with(self.new_legs);
        let people = &mut self.perception.people;
        let (late, dropped) = (people.tracker().late, legs.dropped_legs());
        people.add_view(legs.process(&self.searched, pose));
        self.late += u64::from(people.tracker().late - late);
        let counts =
            ScanCounts { points, segments: legs.segments(), dropped_legs: legs.dropped_legs() - dropped };
        let row = FrameRow::of_scan((scan.stamp, frame), counts, legs.legs(), people.tracks());
        match pose {
            ScannerPose::InFixedFrame(place) if is_alone => row.seen_from(mounting.compose(place.inverse())),
            ScannerPose::OnMovingRobot(_) if is_alone => row.in_moving_frame(),
            _ => row,
        }
    }

    /// Where a scanner without odometry stands, by its scans. In a new frame everybody is followed anew.
    fn matched(&mut self, name: &str, scan: &Scan) -> ScannerPose {
        let odometry = self.odometry.entry(name.to_owned()).or_insert_with(ScanOdometry::new);
        match odometry.place(scan) {
            Place::Known(pose) => ScannerPose::InFixedFrame(pose),
            Place::Begins => {
                self.clear();
                ScannerPose::InFixedFrame(Pose2::default())
            }
            Place::Unknown => ScannerPose::OnMovingRobot(Pose2::default()),
        }
    }

    /// Notes the time of a source; false if it is not later than the one before. A clock that was set back begins anew.
    fn is_newer(&mut self, source: &str, stamp: Stamp) -> bool {
        let newest = self.newest.get(source).copied();
        if newest.is_some_and(|newest| stamp.past_us(newest) > SET_BACK_US) {
            self.begin_again();
        }
        let is_newer = self.newest.get(source).is_none_or(|newest| stamp > *newest);
        if is_newer {
            self.newest.insert(source.to_owned(), stamp);
        }
        is_newer
    }

    fn begin_again(&mut self) {
        self.clear();
        self.odometry.clear();
        self.newest.clear();
        self.restarts += 1;
    }

    /// Forgets everybody.
    fn clear(&mut self) {
        self.perception = new_perception(&self.robot, Stages::All);
        self.scanners.clear();
    }

    /// Says what the times of the recording did to the stages.
    pub fn say_times(&self) {
        if self.restarts > 0 {
            say!("the clock was set back {} times: everybody was followed anew from there", self.restarts);
        }
        if self.late > 0 {
            say!(
                "{} sweeps or scans were not used for tracking: they are more than 0.2 s older than those of another sensor",
                self.late
            );
        }
    }
}

fn returns(sweep: &Sweep) -> u32 {
    let columns = sweep.used_columns().iter();
    columns.flat_map(|column| column.range_raw).filter(|raw| *raw > 0).count() as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_drivers::velodyne::SweepBuilder;
    use floorguard_perception::people::TrackStatus;
    use floorguard_types::geometry::{Point3, Twist2};
    use floorguard_types::sensing::{BeamReturn, LidarColumn};

    fn scan(at_us: u64) -> Scan {
        let mut scan = Scan { stamp: Stamp::from_micros(at_us), step_rad: 0.01, ..Scan::default() };
        scan.beams.extend((0..100).map(|_| BeamReturn::Hit(4_000)));
        scan
    }

    /// Eight revolutions in which the rings of the second look alone see a person, 9 m ahead.
    fn packets(robot: &RobotConfiguration) -> impl Iterator<Item = LidarPacket> {
        let angles = robot.second_ring_angles().expect("it has more rings than a sweep");
        (0..8 * 75_u64).map(move |number| {
            let stamp = Stamp::from_micros(1_000_000 + 1_333 * number);
            let mut packet = LidarPacket { stamp, rings: 32, ..LidarPacket::EMPTY };
            for step in 0..24 {
                let azimuth_cdeg = ((number * 480 + step * 20) % 36_000) as u16;
                let mut column =
                    LidarColumn { azimuth_cdeg, offset_us: 55 * step as u32, ..LidarColumn::SILENT };
                let bearing_deg = (f32::from(azimuth_cdeg) * 0.01 + 180.0) % 360.0 - 180.0;
                for (raw, (sin, cos, _)) in column.range_raw.iter_mut().skip(16).zip(angles.rings) {
                    let height_m = 0.8 + 9.0 * sin / cos;
                    if bearing_deg.abs() < 1.4 && (0.0..1.7).contains(&height_m) {
                        *raw = (9.0 / cos * 500.0) as u16;
                    }
                }
                packet.columns.push(column).expect("24 fit");
            }
            packet
        })
    }

    /// A capture of a lidar of 32 rings is looked at as on the robot: once more in the rings between.
    #[test]
    fn second_look_finds_people_in_captures() {
        let translation = Point3::new(0.0, 0.0, 0.8);
        let sensor_in_base = Transform3 { translation, ..Transform3::IDENTITY };
        let context = SweepContext { sensor_in_base, twist: Twist2::ZERO, base_in_odom: Pose2::default() };
        for model in [LidarModel::Hdl32e, LidarModel::Vlp32c] {
            let mut stages = RobotStages::new().expect("the example robot");
            stages.set_lidar(model);
            let (mut builder, mut building) = (SweepBuilder::new(18_000), Box::new(Sweep::EMPTY));
            for packet in packets(&stages.robot.clone()) {
                stages.note_packet(&packet, 0, &sensor_in_base);
                builder.add(&packet, 0, &mut building, |sweep| {
                    stages.sweep(sweep, &context, "sensor");
                });
            }
            let people = stages.perception.people.tracks();
            let [person] = people else { panic!("{model:?}: {people:?}") };
            assert_eq!(person.status, TrackStatus::Confirmed, "{model:?}");
            assert!((person.state.position.x_m - 9.0).abs() < 0.3, "{model:?}: {person:?}");
        }
    }

    /// Of a scanner in a recording nothing is known; the bytes of an S300's line are those of an S300.
    #[test]
    fn recorded_scanners_learn_places_but_for_s300() {
        let is_any = |mut stages: RobotStages| {
            stages.scan("front", &scan(1_000_000), (Pose2::default(), Some(Pose2::default())));
            stages.scanners.values().all(|legs| matches!(legs, HostedLegs::Any(_)))
        };
        assert!(is_any(RobotStages::new().expect("the example robot")));
        assert!(!is_any(RobotStages::new().expect("the example robot").for_s300()));
    }

    /// A time that stands still is frozen; one that was set back by an hour begins anew and is healthy.
    #[test]
    fn times_of_each_source_are_judged() {
        let mut stages = RobotStages::new().expect("the example robot");
        let mut newer = |name: &str, at_us: u64| {
            let row = stages.scan(name, &scan(at_us), (Pose2::default(), None));
            row.is_newer()
        };
        let hour_us = 3_600_000_000;
        assert!(newer("front", hour_us) && !newer("front", hour_us) && !newer("front", hour_us - 500_000));
        assert!(newer("rear", hour_us) && newer("front", 0));
        assert_eq!(stages.restarts, 1);
    }
}
