//! The robot as planners see it: outline, drive, what the costmap keeps around obstacles.

use floorguard_navigation::costmap::InflationConfig;
use floorguard_navigation::global::{GearOutlines, Pace};
use floorguard_navigation::local::{Arrival, DwaConfig, MppiConfig, MppiWeights};
use floorguard_navigation::recovery::RecoveryTimes;
use floorguard_runtime::configuration::{DirectionOfTravel, DriveTrain, RobotConfiguration};
use floorguard_types::geometry::Point2;
use floorguard_types::motion::{DriveGeometry, DriveKinematics, Footprint};

use super::plan::NavigationSettings;

/// Kept around the body, metres: what the guard keeps beside it, and half a cell.
const MARGIN_M: f32 = 0.08;
/// Kept beyond the guard's field, metres: what its own place, the map and the scanner may be wrong by.
const FIELD_MARGIN_M: f32 = 0.03;
/// Cost falls off to a hundredth over this beyond the outline, metres.
const INFLATION_M: f32 = 0.6;
const DECAY_PER_M: f32 = 4.0;
/// Backwards and on the spot a robot sees less of where it goes: slower than it could, m/s and rad/s.
const REVERSE_MPS: f32 = 0.2;
const SPIN_RADPS: f32 = 0.35;
/// The steered wheel is turned so fast, as the body's turning rate, rad/s².
const TURN_ACCELERATION_RADPS2: f32 = 1.0;
/// A steered wheel that swings costs more than one that turns freely: seconds for (rad/s)².
const TURN_CHANGE: f32 = 0.1;
/// Samples this much worse than the best count e times less, seconds. The mean of many turns the wheel less to and fro than that
/// of a few: near people the guard limits the fastest point of the body, which is a corner as soon as the robot turns.
const TEMPERATURE_S: f32 = 0.25;
/// A second in the middle of a person's place, seconds. The guard's rules for people are costs of their own.
const NEAR_PERSON: f32 = 2.0;
/// Unannounced acceleration of people, m/s²: with 0.3 the doubt of three seconds fills an aisle, and every motion looks worse than standing.
const PEOPLE_ACCELERATION_MPS2: f32 = 0.1;
/// Of what a period's acceleration gives, the slowest motion that counts.
const REACHED: f32 = 0.8;
/// From command to command, seconds.
pub(super) const PERIOD_S: f32 = 0.1;
/// Radius of a person, metres.
pub(super) const PERSON_RADIUS_M: f32 = 0.3;

/// How long each measure of recovery may take.
pub(super) fn times_of(settings: &NavigationSettings) -> RecoveryTimes {
    RecoveryTimes { help_s: settings.help_after_s, ..RecoveryTimes::DEFAULT }
}

/// What planners know of the robot.
#[derive(Clone, Debug)]
pub(super) struct Model {
    /// The outline with its margin.
    pub(super) outline: Footprint,
    /// What a path needs: before a robot that goes ahead or turns what its guard keeps clear of it at its slowest.
    pub(super) outlines: GearOutlines,
    /// How it moves.
    pub(super) drive: DriveKinematics,
    /// How obstacles are widened.
    pub(super) inflation: InflationConfig,
    /// Below this cost nothing touches the circumscribed disc.
    pub(super) clear_cost: u8,
    /// When the goal is reached.
    pub(super) arrival: Arrival,
}

/// How speed and turning rate are bound to each other.
fn drive_geometry(robot: &RobotConfiguration) -> DriveGeometry {
    let wheelbase_m = robot.geometry.wheelbase_m;
    match robot.train {
        DriveTrain::Tricycle => {
            DriveGeometry::Tricycle { wheelbase_m, steering_max_rad: std::f32::consts::FRAC_PI_2 }
        }
        // What binds its speed to its turning rate is the same: v·tan(α)/L.
        DriveTrain::Ackermann { steering_max_rad } => {
            DriveGeometry::Tricycle { wheelbase_m, steering_max_rad }
        }
        DriveTrain::Differential | DriveTrain::Omnidirectional { .. } => DriveGeometry::Differential,
    }
}

/// The front of the field that the guard wants clear before the robot may go ahead, or turn, at all: how far ahead of the base point,
/// and how far to either side, metres.
fn slowest_field_m(robot: &RobotConfiguration) -> (f32, f32) {
    let ahead = robot.fields.iter().filter(|pair| pair.direction == DirectionOfTravel::Forward);
    let slowest = ahead.min_by(|a, b| a.speed_max_mps.total_cmp(&b.speed_max_mps));
    let corners = || slowest.into_iter().flat_map(|pair| &pair.protective);
    let reach_m = corners().map(|corner| corner.x_m).fold(0.0, f32::max);
    let front = corners().filter(|corner| corner.x_m > reach_m - 0.01);
    (reach_m, front.map(|corner| corner.y_m.abs()).fold(0.0, f32::max))
}

impl Model {
    /// Of a robot that is to drive like this, on cells of this edge.
    ///
    /// # Errors
    /// The base point lies outside the outline.
    pub(super) fn of(
        robot: &RobotConfiguration,
        settings: &NavigationSettings,
        cell_m: f32,
    ) -> anyhow::Result<Self> {
        let (mut low, mut high) = (Point2::default(), Point2::default());
        for corner in &robot.geometry.footprint {
            low = Point2::new(low.x_m.min(corner.x_m), low.y_m.min(corner.y_m));
            high = Point2::new(high.x_m.max(corner.x_m), high.y_m.max(corner.y_m));
        }
        let (rear_m, front_m) = (low.x_m - MARGIN_M, high.x_m + MARGIN_M);
        let (right_m, left_m) = (low.y_m - MARGIN_M, high.y_m + MARGIN_M);
        let corners = [(rear_m, right_m), (front_m, right_m), (front_m, left_m), (rear_m, left_m)];
        let outline = Footprint::new(&corners.map(|(x_m, y_m)| Point2::new(x_m, y_m)))?;
        let (reach_m, half_m) = slowest_field_m(robot);
        let (reach_m, half_m) = (front_m.max(reach_m + FIELD_MARGIN_M), left_m.min(half_m + FIELD_MARGIN_M));
        let nose = [(reach_m, right_m.max(-half_m)), (reach_m, half_m)];
        let ahead = [corners[0], corners[1], nose[0], nose[1], corners[2], corners[3]];
        let ahead = Footprint::new(&ahead.map(|(x_m, y_m)| Point2::new(x_m, y_m)))?;
        let outlines = GearOutlines { ahead, back: outline.clone() };
        let around_m = outline.circumscribed_radius_m() + cell_m;
        let inflation = InflationConfig {
            inscribed_radius_m: outline.inscribed_radius_m(),
            inflation_radius_m: around_m.max(outline.inscribed_radius_m() + INFLATION_M),
            decay_per_m: DECAY_PER_M,
        };
        let drive = DriveKinematics {
            geometry: drive_geometry(robot),
            speed_max_mps: settings.speed_mps.min(robot.limits.speed_mps),
            reverse_max_mps: robot.limits.reverse_mps.min(REVERSE_MPS),
            turn_max_radps: settings.turn_radps.min(robot.limits.turn_radps),
            acceleration_mps2: robot.limits.acceleration_mps2,
            braking_mps2: robot.limits.braking_mps2,
            turn_acceleration_radps2: TURN_ACCELERATION_RADPS2,
        };
        let spin_radps = SPIN_RADPS.min(drive.turn_max_radps);
        let arrival = Arrival {
            // A little inside: the robot rolls on, and its place moves with each scan.
            within_m: 0.8 * settings.within_m,
            within_rad: 0.8 * settings.within_rad,
            turn_min_radps: 0.15,
            turn_max_radps: spin_radps,
        };
        let clear_cost = inflation.cost_at(around_m - 0.5 * cell_m).max(1);
        Ok(Self { outline, outlines, drive, inflation, clear_cost, arrival })
    }

    /// What the lattice counts on, for a raster of this edge.
    pub(super) fn pace(&self, raster_m: f32) -> Pace {
        Pace {
            speed_mps: self.drive.speed_max_mps,
            turn_radps: self.arrival.turn_max_radps,
            reverse_mps: self.drive.reverse_max_mps.max(0.05),
            change_s: 2.0,
            step_m: 1.5 * raster_m,
            arc_m: 0.9,
            haste: 1.3,
        }
    }

    /// Parameters of ours.
    pub(super) const fn mppi(&self) -> MppiConfig {
        MppiConfig {
            drive: self.drive,
            step_s: 0.1,
            period_s: PERIOD_S,
            speed_noise_mps: 0.25,
            turn_noise_radps: 0.3,
            temperature_s: TEMPERATURE_S,
            clear_cost: self.clear_cost,
            people_acceleration_mps2: PEOPLE_ACCELERATION_MPS2,
            person_radius_m: PERSON_RADIUS_M,
            arrival: self.arrival,
            weights: MppiWeights { turn_change: TURN_CHANGE, person: NEAR_PERSON, ..MppiWeights::DEFAULT },
        }
    }

    /// Parameters of the dynamic window: as published, with the limits and tolerances of this robot.
    pub(super) fn dwa(&self) -> DwaConfig {
        let step_mps = self.drive.acceleration_mps2 * PERIOD_S;
        let step_radps = self.drive.turn_acceleration_radps2 * PERIOD_S;
        DwaConfig {
            speed_max_mps: self.drive.speed_max_mps,
            // The published ones belong to a robot that reaches them in one period; this one never would.
            translation_min_mps: DwaConfig::PUBLISHED.translation_min_mps.min(REACHED * step_mps),
            turn_min_radps: DwaConfig::PUBLISHED.turn_min_radps.min(REACHED * step_radps),
            turn_max_radps: self.drive.turn_max_radps,
            acceleration_mps2: self.drive.acceleration_mps2,
            turn_acceleration_radps2: self.drive.turn_acceleration_radps2,
            goal_within_m: self.arrival.within_m,
            goal_within_rad: self.arrival.within_rad,
            period_s: PERIOD_S,
            ..DwaConfig::PUBLISHED
        }
    }
}
