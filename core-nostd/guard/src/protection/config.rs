//! What the guard must know about the robot, checked once at start.

use heapless::Vec;

use super::action::Action;
use super::config_error::GuardConfigError;
use super::field::{Polygon, point_in_polygon};
use super::source::{Source, SourceRules};
use super::swept_outline::{Zone, contains, swept_outline};
use super::unseen_limits::UnseenLimits;
use floorguard_types::capacities::{FIELD_SETS_MAX, PACKET_RINGS_MAX, REAR_SCANNERS_MAX, SCAN_BEAMS_MAX};
use floorguard_types::geometry::{Point2, Pose2, Transform3};

/// Where the robot is going: the steering bin of a field set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Travel {
    /// Forward, nearly straight.
    #[default]
    Straight,
    /// Forward in a left bend.
    Left,
    /// Forward in a right bend.
    Right,
    /// Turning on the spot.
    Spin,
    /// Backward.
    Reverse,
}

/// Protective and warning field for one direction up to one speed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FieldSet {
    /// For this direction of travel. Left, Right and Spin fall back to Straight where they are not configured.
    pub travel: Travel,
    /// Up to this speed, m/s.
    pub speed_max_mps: f32,
    /// Something inside: stop. Contains the footprint, so that an obstacle at the body stops at rest too
    /// (FG-REQ-026).
    pub protective: Polygon,
    /// Something inside: slow down.
    pub warning: Polygon,
}

/// Pose of the safety scanner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScannerGeometry {
    /// Sensor frame in the robot frame.
    pub mounting: Pose2,
    /// Angle of beam 0 in the sensor's frame, radians.
    pub first_angle_rad: f32,
    /// Angle between beams, radians, > 0.
    pub step_rad: f32,
    /// Beams of each scan.
    pub beams: usize,
    /// First and last angle in the sensor's frame that are not covered by the robot's own body, radians.
    pub sector_rad: [f32; 2],
}

impl ScannerGeometry {
    /// There is no beam.
    pub const NONE: Self = Self {
        mounting: Pose2 { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 },
        first_angle_rad: 0.0,
        step_rad: 0.0,
        beams: 0,
        sector_rad: [0.0; 2],
    };

    /// It has beams, not more than its table, one beside the other.
    const fn fits(&self) -> bool {
        let beams_fit = self.beams >= 1 && self.beams <= SCAN_BEAMS_MAX;
        beams_fit && self.step_rad.is_finite() && self.step_rad > 0.0
    }
}

/// Pose of the lidar.
#[derive(Clone, Debug, PartialEq)]
pub struct LidarGeometry {
    /// Sensor frame (x forward, y left, z up) to robot frame.
    pub mounting: Transform3,
    /// Elevation per ring, radians, rising.
    pub elevations_rad: Vec<f32, PACKET_RINGS_MAX>,
    /// Returns inside this outline come from the robot itself; empty: none do.
    pub self_mask: Polygon,
    /// Lower points are floor, metres above it.
    pub floor_clearance_m: f32,
    /// Higher points pass over the robot, metres above the floor.
    pub body_height_m: f32,
}

/// What the drive may and can do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveLimits {
    /// Greatest speed, m/s.
    pub speed_mps: f32,
    /// Greatest turning rate, rad/s.
    pub turn_radps: f32,
    /// Greatest acceleration, m/s².
    pub acceleration_mps2: f32,
    /// Braking that is always reached, m/s².
    pub braking_mps2: f32,
    /// From the decision to the brake's full effect, seconds.
    pub response_s: f32,
    /// Rear axle to steered wheel, metres; of a base without one, by what a turning rate is a speed.
    pub wheelbase_m: f32,
    /// How much faster the outer wheel is than the base point, metres per radian: half the distance between the wheels that brake;
    /// 0 where one wheel in the middle does.
    pub wheel_lever_m: f32,
}

/// Thresholds of the checks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thresholds {
    /// Adjacent beams that make an obstacle (book, Guard: Scanner check).
    pub scan_adjacent_beams: u8,
    /// Consecutive scans that make an obstacle (book, Guard: Scanner check).
    pub scan_consecutive: u8,
    /// Returns in two neighbouring packets that make an obstacle: noise has fewer.
    pub packet_returns: u8,
    /// A larger field is watched this long before its speed is allowed, microseconds (at least T_S, and a revolution).
    pub field_activation_us: u64,
    /// Speed with something in the warning field, m/s.
    pub warning_speed_mps: f32,
    /// Speed with a person within [`Self::person_near_m`], m/s (book, Guard: People near).
    pub person_speed_mps: f32,
    /// Distance from the body, metres (book, Guard: People near).
    pub person_near_m: f32,
    /// What the sensors meet is remembered up to this far from them, metres; the window of the memory ends at 3.2.
    pub memory_reach_m: f32,
    /// Firings of each lidar packet that the memory takes in, at least 1: a microcontroller has the time for one.
    pub memory_firings: u8,
    /// Speed while leaving an obstacle, m/s (book, Guard: Escape).
    pub escape_speed_mps: f32,
    /// What the emergency stop demands: category 0 or 1 (ISO 13850).
    pub emergency_action: Action,
    /// Overspeed tolerated this long, microseconds (book, Guard: Motion checks).
    pub overspeed_us: u64,
    /// Speeds of encoders and drive may differ by this, m/s, …
    pub speed_disagreement_mps: f32,
    /// … turning rates of encoders and gyroscope, or encoders and steering, by this, rad/s (book, Guard: Motion
    /// checks), …
    pub turn_disagreement_radps: f32,
    /// … for this long, microseconds. Steering (slip) has 0.2 s (book, Guard: Motion checks).
    pub disagreement_us: u64,
}

impl Thresholds {
    /// The values of the book, Guard.
    pub const DEFAULT: Self = Self {
        scan_adjacent_beams: 2,
        scan_consecutive: 2,
        packet_returns: 6,
        field_activation_us: 120_000,
        warning_speed_mps: 0.3,
        person_speed_mps: 0.3,
        person_near_m: 1.2,
        memory_reach_m: 3.2,
        memory_firings: 1,
        escape_speed_mps: 0.1,
        emergency_action: Action::Category0,
        overspeed_us: 100_000,
        speed_disagreement_mps: 0.25,
        turn_disagreement_radps: 0.3,
        disagreement_us: 500_000,
    };
}

impl Default for Thresholds {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Everything that the guard must know.
#[derive(Clone, Debug, PartialEq)]
pub struct GuardConfig {
    /// Outline of the body, counter-clockwise, around the origin.
    pub footprint: Polygon,
    /// Field sets, any order.
    pub fields: Vec<FieldSet, FIELD_SETS_MAX>,
    /// Safety scanner.
    pub scanner: ScannerGeometry,
    /// A second one, with [`Source::RearScanner`]; a program without the memory for it refuses it.
    pub rear_scanner: Option<ScannerGeometry>,
    /// Lidar.
    pub lidar: LidarGeometry,
    /// Drive.
    pub drive: DriveLimits,
    /// Thresholds.
    pub thresholds: Thresholds,
    /// Speeds where no sensor sees all of what the body goes into.
    pub unseen: UnseenLimits,
    /// Rules per source, in the order of [`Source::ALL`].
    pub sources: [SourceRules; Source::COUNT],
}

impl GuardConfig {
    /// No robot: it may not move, and every sensor is missing. What the guard has before it is configured.
    pub const NONE: Self = Self {
        footprint: Vec::new(),
        fields: Vec::new(),
        scanner: ScannerGeometry::NONE,
        rear_scanner: None,
        lidar: LidarGeometry {
            mounting: Transform3::IDENTITY,
            elevations_rad: Vec::new(),
            self_mask: Vec::new(),
            floor_clearance_m: 0.0,
            body_height_m: 0.0,
        },
        drive: DriveLimits {
            speed_mps: 0.0,
            turn_radps: 0.0,
            acceleration_mps2: 0.0,
            braking_mps2: 0.0,
            response_s: 0.0,
            wheelbase_m: 1.0,
            wheel_lever_m: 0.0,
        },
        thresholds: Thresholds::DEFAULT,
        unseen: UnseenLimits::NONE,
        sources: Self::default_sources(),
    };

    /// What a safety scanner must keep (book, Guard: Source deadlines): a counter that stands still in two scans is frozen.
    pub const RULES_OF_SCANNER: SourceRules =
        SourceRules { frozen_samples: 2, ..SourceRules::required(100, 0.3, 200) };

    /// Deadlines of the book, Guard: Source deadlines, in the order of [`Source::ALL`].
    #[must_use]
    pub const fn default_sources() -> [SourceRules; Source::COUNT] {
        let mut imu = SourceRules::required(50, 0.3, 100);
        imu.frozen_samples = 50;
        let mut lidar = SourceRules::required(100, 0.5, 300);
        lidar.frozen_samples = 8;
        let mut command = SourceRules::required(200, 0.0, 200);
        command.required_at_start = false;
        let mut perception = SourceRules::required(300, 0.5, 300);
        perception.required_at_start = false;
        perception.stop_after_us = None;
        let mut all = [SourceRules::ABSENT; Source::COUNT];
        if let Some(first) = all.first_chunk_mut() {
            *first = [
                Self::RULES_OF_SCANNER,
                lidar,
                SourceRules::required(50, 0.3, 100),
                SourceRules::required(50, 0.3, 50),
                imu,
                SourceRules::required(100, 0.3, 100),
                command,
                perception,
            ];
        }
        all
    }

    /// Rules of one source.
    #[must_use]
    pub fn rules(&self, source: Source) -> SourceRules {
        self.sources.get(source.index()).copied().unwrap_or(SourceRules::required(0, 0.0, 0))
    }

    /// Refuses what cannot be safe.
    ///
    /// # Errors
    /// The first broken rule, with its numbers.
    ///
    /// ```
    /// use floorguard_guard::{GuardConfig, GuardConfigError};
    ///
    /// assert_eq!(GuardConfig::NONE.validate(), Err(GuardConfigError::Footprint));
    /// ```
    pub fn validate(&self) -> Result<(), GuardConfigError> {
        if self.footprint.len() < 3 || !point_in_polygon(Point2::default(), &self.footprint) {
            return Err(GuardConfigError::Footprint);
        }
        self.validate_numbers()?;
        self.validate_sensors()?;
        if !self.fields.iter().any(|set| set.travel == Travel::Straight) {
            return Err(GuardConfigError::NoForwardField);
        }
        for (index, set) in self.fields.iter().enumerate() {
            self.validate_field(index, set)?;
        }
        Ok(())
    }

    fn validate_numbers(&self) -> Result<(), GuardConfigError> {
        let (drive, limits) = (&self.drive, &self.thresholds);
        let positive = [
            ("greatest speed", drive.speed_mps),
            ("greatest turning rate", drive.turn_radps),
            ("acceleration", drive.acceleration_mps2),
            ("braking", drive.braking_mps2),
            ("response time", drive.response_s),
            ("wheelbase", drive.wheelbase_m),
            ("speed in the warning field", limits.warning_speed_mps),
            ("speed near people", limits.person_speed_mps),
            ("distance to people", limits.person_near_m),
            ("reach of the memory", limits.memory_reach_m),
            ("escape speed", limits.escape_speed_mps),
            ("tolerated difference of speeds", limits.speed_disagreement_mps),
            ("tolerated difference of turning rates", limits.turn_disagreement_radps),
            // None is as right as some.
            ("lever of the wheels", drive.wheel_lever_m + f32::MIN_POSITIVE),
            ("way until the rear is known", self.unseen.known_after_m + f32::MIN_POSITIVE),
            ("number of adjacent beams", f32::from(limits.scan_adjacent_beams)),
            ("number of consecutive scans", f32::from(limits.scan_consecutive)),
            ("number of returns", f32::from(limits.packet_returns)),
        ];
        let unseen = self.unseen.speeds();
        match positive.iter().chain(&unseen).find(|(_, value)| !value.is_finite() || *value <= 0.0) {
            Some((name, _)) => Err(GuardConfigError::NotPositive(name)),
            None => Ok(()),
        }
    }

    fn validate_sensors(&self) -> Result<(), GuardConfigError> {
        if !self.scanner.fits() {
            return Err(GuardConfigError::Scanner);
        }
        let rear_rules = self.sources.get(Source::RearScanner.index());
        let is_awaited = rear_rules.is_some_and(|rules| rules.fitted);
        let has_room = REAR_SCANNERS_MAX > 0 || self.rear_scanner.is_none();
        let rear_fits = self.rear_scanner.is_none_or(|scanner| scanner.fits());
        if self.rear_scanner.is_some() != is_awaited || !has_room || !rear_fits {
            return Err(GuardConfigError::RearScanner);
        }
        if self.lidar.elevations_rad.is_empty() || self.lidar.body_height_m <= self.lidar.floor_clearance_m {
            return Err(GuardConfigError::Lidar);
        }
        for (source, rules) in Source::ALL.into_iter().zip(&self.sources) {
            let stop_after_us = rules.stop_after_us.unwrap_or(u64::MAX);
            if rules.limit_after_us == 0 || rules.limit_after_us > stop_after_us {
                return Err(GuardConfigError::Deadline(source));
            }
        }
        Ok(())
    }

    fn validate_field(&self, index: usize, set: &FieldSet) -> Result<(), GuardConfigError> {
        if set.protective.len() < 3 || set.warning.len() < 3 {
            return Err(GuardConfigError::FieldCorners(index));
        }
        // Half-open edges: a corner that lies on the field's own edge counts once it is drawn in by a hair.
        let drawn_in = |corner: &Point2| Point2::new(corner.x_m * 0.999, corner.y_m * 0.999);
        if !self.footprint.iter().all(|corner| point_in_polygon(drawn_in(corner), &set.protective)) {
            return Err(GuardConfigError::FieldInsideFootprint(index));
        }
        if !set.speed_max_mps.is_finite() || set.speed_max_mps <= 0.0 {
            return Err(GuardConfigError::NotPositive("speed of a field set"));
        }
        let needed =
            swept_outline(&self.footprint, &self.drive, (set.travel, set.speed_max_mps), Zone::Protective);
        let given_m = length_m(set.travel, &set.protective);
        let needed_m = length_m(set.travel, &needed);
        if given_m < needed_m - SAME_LENGTH_M {
            let body_m = length_m(set.travel, &self.footprint);
            let (needed_m, given_m) = (needed_m - body_m, given_m - body_m);
            return Err(GuardConfigError::FieldTooShort { set: index, needed_m, given_m });
        }
        if !contains(&set.protective, &needed) {
            let (first, corners) = (Point2::default(), needed.iter());
            let least = corners
                .clone()
                .fold(first, |at, corner| Point2::new(at.x_m.min(corner.x_m), at.y_m.min(corner.y_m)));
            let greatest =
                corners.fold(first, |at, corner| Point2::new(at.x_m.max(corner.x_m), at.y_m.max(corner.y_m)));
            return Err(GuardConfigError::FieldTooNarrow { set: index, least, greatest });
        }
        Ok(())
    }
}

/// Lengths that differ by less are the same, metres.
const SAME_LENGTH_M: f32 = 2.0e-3;

/// How far a field reaches where the robot goes, metres from the robot's origin; of a field for turning it says nothing.
fn length_m(travel: Travel, polygon: &[Point2]) -> f32 {
    match travel {
        Travel::Reverse => -rearmost_m(polygon),
        Travel::Spin => 0.0,
        _ => foremost_m(polygon),
    }
}

/// Greatest x of a polygon, metres.
pub(super) fn foremost_m(polygon: &[Point2]) -> f32 {
    polygon.iter().fold(f32::NEG_INFINITY, |x_m, corner| x_m.max(corner.x_m))
}

/// Least x of a polygon, metres.
pub(super) fn rearmost_m(polygon: &[Point2]) -> f32 {
    polygon.iter().fold(f32::INFINITY, |x_m, corner| x_m.min(corner.x_m))
}
