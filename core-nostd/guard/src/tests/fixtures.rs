//! A robot on a bench: every source healthy, an ideal drive, and levers to corrupt each of it.

use heapless::Vec;

use crate::*;
use floorguard_types::geometry::{Point2, Point3, Pose2, Transform3, Twist2, wrap_angle};
use floorguard_types::sensing::*;
use floorguard_types::time::Stamp;
use floorguard_types::units::radians;

pub fn rectangle(x: [f32; 2], y: f32) -> Polygon {
    let corners = [(x[0], -y), (x[1], -y), (x[1], y), (x[0], y)];
    corners.iter().map(|(x, y)| Point2::new(*x, *y)).collect()
}

fn set(travel: Travel, speed_max_mps: f32, protective: Polygon, warning: Polygon) -> FieldSet {
    FieldSet { travel, speed_max_mps, protective, warning }
}

pub fn config() -> GuardConfig {
    let fields = [
        set(Travel::Straight, 0.3, rectangle([-0.45, 1.25], 0.5), rectangle([-0.45, 1.7], 0.6)),
        set(Travel::Straight, 0.6, rectangle([-0.45, 1.55], 0.5), rectangle([-0.45, 2.1], 0.6)),
        set(Travel::Straight, 1.1, rectangle([-0.45, 2.3], 0.51), rectangle([-0.45, 3.2], 0.6)),
        set(Travel::Reverse, 0.3, rectangle([-0.8, 0.95], 0.5), rectangle([-1.0, 0.95], 0.6)),
    ];
    GuardConfig {
        footprint: rectangle([-0.45, 0.95], 0.4),
        fields: fields.into_iter().collect(),
        scanner: ScannerGeometry {
            mounting: Pose2::new(0.9, 0.0, 0.0),
            first_angle_rad: radians(-135.0),
            step_rad: radians(0.5),
            beams: 541,
            sector_rad: [radians(-135.0), radians(135.0)],
        },
        rear_scanner: None,
        lidar: LidarGeometry {
            mounting: Transform3::from_mounting(Point3::new(0.5, 0.0, 0.8), 0.0, 0.0, 0.0),
            elevations_rad: (0..16_i8).map(|ring| radians(f32::from(ring) * 2.0 - 15.0)).collect(),
            self_mask: rectangle([-0.45, 0.95], 0.4),
            floor_clearance_m: 0.1,
            body_height_m: 1.0,
        },
        drive: DriveLimits {
            speed_mps: 1.0,
            turn_radps: 0.8,
            acceleration_mps2: 0.5,
            braking_mps2: 0.8,
            response_s: 0.15,
            wheelbase_m: 0.8,
            wheel_lever_m: 0.0,
        },
        thresholds: Thresholds::default(),
        unseen: UnseenLimits::NONE,
        sources: GuardConfig::default_sources(),
    }
}

/// The same robot with a second scanner at its rear, which looks behind and along both sides.
pub fn config_with_rear() -> GuardConfig {
    let mut config = config();
    let mounting = Pose2::new(-0.43, 0.0, core::f32::consts::PI);
    config.rear_scanner = Some(ScannerGeometry { mounting, ..config.scanner });
    config.sources[Source::RearScanner.index()] = config.rules(Source::Scanner);
    config
}

/// The tables of a configuration.
pub fn tables(config: &GuardConfig) -> (ScanTable, PacketTable) {
    let (mut scan, mut packet) = (ScanTable::EMPTY, PacketTable::EMPTY);
    scan.fill(&config.scanner, &config.fields);
    packet.fill(&config.lidar, &config.fields);
    (scan, packet)
}

pub fn forward(mps: f32) -> Twist2 {
    Twist2 { linear_mps: mps, angular_radps: 0.0 }
}

/// A scan with hits at the given points of the robot frame (three adjacent beams each), free elsewhere.
pub fn scan(stamp: Stamp, sequence: u32, obstacles: &[Point2]) -> Scan {
    scan_of(&config().scanner, (stamp, sequence), obstacles)
}

/// The same of any scanner; what lies outside of its view is not met.
pub fn scan_of(geometry: &ScannerGeometry, (stamp, sequence): (Stamp, u32), obstacles: &[Point2]) -> Scan {
    let mut beams: Vec<BeamReturn, { floorguard_types::capacities::SCAN_BEAMS_MAX }> =
        (0..geometry.beams).map(|_| BeamReturn::Free(30_000)).collect();
    for point in obstacles {
        let (dx, dy) = (point.x_m - geometry.mounting.x_m, point.y_m - geometry.mounting.y_m);
        let bearing_rad = wrap_angle(libm::atan2f(dy, dx) - geometry.mounting.heading_rad);
        let beam = ((bearing_rad - geometry.first_angle_rad) / geometry.step_rad).round();
        if !(0.0..geometry.beams as f32).contains(&beam) {
            continue;
        }
        let beam = beam as usize;
        for index in beam.saturating_sub(1)..=(beam + 1).min(geometry.beams - 1) {
            beams[index] = BeamReturn::Hit((dx.hypot(dy) * 1.0e3) as u16);
        }
    }
    Scan { stamp, sequence, first_angle_rad: geometry.first_angle_rad, step_rad: geometry.step_rad, beams }
}

/// A packet of 24 columns in which ring 7 (−1°) sees `range_m` and every other ring a far wall.
pub fn packet(stamp: Stamp, azimuth_cdeg: u16, range_m: f32) -> LidarPacket {
    let columns = (0..24_u16).map(|index| {
        let mut range_raw = [0_u16; floorguard_types::capacities::PACKET_RINGS_MAX];
        range_raw[..16].fill(10_000);
        range_raw[7] = (range_m * 500.0) as u16;
        LidarColumn {
            azimuth_cdeg: (azimuth_cdeg + index * 20) % 36_000,
            offset_us: u32::from(index) * 55,
            range_raw,
            ..LidarColumn::SILENT
        }
    });
    LidarPacket { stamp, range_unit_mm: 2, rings: 16, columns: columns.collect() }
}

/// The robot on the bench.
pub struct Rig {
    pub guard: Supervisor,
    pub now: Stamp,
    pub wanted: Twist2,
    pub measured: Twist2,
    pub obstacles: std::vec::Vec<Point2>,
    pub lidar_range_m: f32,
    pub inputs: DiscreteInputs,
    pub people: std::vec::Vec<AdvisedPerson>,
    /// Sources that say nothing.
    pub silent: std::vec::Vec<Source>,
    pub gyro_offset_radps: f32,
    pub drive_state: DriveState,
    pub stamp_ahead_us: [u64; Source::COUNT],
    pub frozen_scanner: bool,
    /// The operator gives the start command whenever the robot waits for it.
    pub operator_starts: bool,
    sequence: u32,
    azimuth_cdeg: u16,
}

impl Rig {
    pub fn new() -> Self {
        Self::with(config())
    }

    pub fn with(config: GuardConfig) -> Self {
        let now = Stamp::from_micros(5_000_000);
        Self {
            guard: Supervisor::new(config, now).unwrap(),
            now,
            wanted: forward(0.8),
            measured: Twist2::ZERO,
            obstacles: std::vec::Vec::new(),
            lidar_range_m: 20.0,
            inputs: DiscreteInputs::all_clear(now),
            people: std::vec::Vec::new(),
            silent: std::vec::Vec::new(),
            gyro_offset_radps: 0.0,
            drive_state: DriveState::Enabled,
            stamp_ahead_us: [0; Source::COUNT],
            frozen_scanner: false,
            operator_starts: true,
            sequence: 0,
            azimuth_cdeg: 0,
        }
    }

    /// Started and cruising.
    pub fn cruising() -> Self {
        let mut rig = Self::new();
        let decision = rig.run_ms(5_000);
        assert_eq!((decision.state, decision.action), (GuardState::Run, Action::None), "{decision:?}");
        assert!((decision.permitted.linear_mps - 0.8).abs() < 1.0e-3, "{decision:?}");
        rig
    }

    fn stamp(&self, source: Source) -> Stamp {
        self.now.plus_micros(self.stamp_ahead_us[source.index()])
    }

    /// 10 ms: every source that is not silent speaks, then a tick.
    pub fn step(&mut self) -> Decision {
        self.now = self.now.plus_micros(10_000);
        self.sequence += 1;
        for source in Source::ALL {
            if !self.silent.contains(&source) {
                self.speak(source);
            }
        }
        let mut decision = self.guard.tick(self.now);
        if self.operator_starts && decision.state == GuardState::AwaitsStart {
            decision = self.guard.request_start(self.now);
        }
        assert!(decision.permitted.linear_mps.abs() <= self.wanted.linear_mps.abs() + 1.0e-6, "{decision:?}");
        // The drive follows upwards at once and brakes with 0.8 m/s².
        let (from_mps, to_mps) = (self.measured.linear_mps, decision.permitted.linear_mps);
        let slower = to_mps.abs() < from_mps.abs();
        let linear_mps = if slower { from_mps + (to_mps - from_mps).clamp(-0.008, 0.008) } else { to_mps };
        self.measured = Twist2 { linear_mps, angular_radps: decision.permitted.angular_radps };
        decision
    }

    pub fn run_ms(&mut self, ms: u64) -> Decision {
        let mut decision = self.step();
        for _ in 1..ms / 10 {
            decision = self.step();
        }
        decision
    }

    /// Milliseconds until the condition holds, at most two seconds.
    pub fn until(&mut self, condition: impl Fn(&Decision) -> bool) -> Option<u64> {
        (1..=200_u64).find(|_| condition(&self.step())).map(|steps| steps * 10)
    }

    fn speak(&mut self, source: Source) {
        let (now, stamp) = (self.now, self.stamp(source));
        match source {
            Source::Scanner if self.sequence.is_multiple_of(4) => {
                let sequence = if self.frozen_scanner { 1 } else { self.sequence };
                self.guard.on_scan(&scan(stamp, sequence, &self.obstacles), now);
            }
            Source::Lidar => {
                self.azimuth_cdeg = (self.azimuth_cdeg + 3_600) % 36_000;
                self.guard.on_lidar_packet(&packet(stamp, self.azimuth_cdeg, self.lidar_range_m), now);
            }
            Source::Discrete => {
                self.inputs.stamp = stamp;
                self.guard.on_discrete(&self.inputs, now);
            }
            Source::Wheels => {
                self.guard.on_wheels(self.measured, stamp, now);
            }
            Source::Imu => {
                let yaw_radps = self.measured.angular_radps + self.gyro_offset_radps;
                let noise = (self.sequence % 7) as f32 * 1.0e-4;
                let sample = ImuSample {
                    stamp,
                    angular_radps: [noise, 0.0, yaw_radps],
                    linear_mps2: [0.0, 0.0, 9.81],
                    ..ImuSample::default()
                };
                self.guard.on_imu(&sample, now);
            }
            Source::Drive => {
                let steering_rad = libm::atan2f(self.measured.angular_radps * 0.8, self.measured.linear_mps);
                let steering_rad = if self.measured == Twist2::ZERO { 0.0 } else { steering_rad };
                let wheel_speed_mps = self.measured.linear_mps.hypot(self.measured.angular_radps * 0.8);
                let feedback =
                    DriveFeedback { stamp, state: self.drive_state, wheel_speed_mps, steering_rad };
                self.guard.on_drive(&feedback, now);
            }
            Source::Command => {
                self.guard.on_command(self.wanted, stamp, now);
            }
            Source::Perception if self.sequence.is_multiple_of(10) => {
                let people = self.people.iter().copied().collect();
                self.guard.on_advice(&Advice { stamp, people, ..Advice::default() }, now);
            }
            Source::RearScanner if self.sequence % 4 == 2 => {
                if let Some(geometry) = self.guard.config().rear_scanner {
                    let sequence = if self.frozen_scanner { 1 } else { self.sequence };
                    let mut scan = scan_of(&geometry, (stamp, sequence), &self.obstacles);
                    // Noise, without which it would be frozen.
                    scan.beams[0] = BeamReturn::Free(29_000 + (self.sequence % 97) as u16);
                    self.guard.on_rear_scan(&scan, now);
                    self.guard.remember_rear_scan(&scan);
                }
            }
            _ => {}
        }
    }
}
