//! What the gaps of the sensors leave of the speed: a limit by direction, for the guard and for the reader of `check`.

use std::fmt;

use floorguard_guard::{UnseenLimits, signed_distance_m};
use floorguard_runtime::configuration::{RobotConfiguration, ScannerConfiguration};
use floorguard_types::geometry::{Point2, Pose2};

use super::analysis::{Coverage, GapMotion};
use super::area::{Motion, Outline, Swept};
use super::gap::Gap;
use super::rays::SCANNER_RANGE_M;
use super::sight::place;

/// In turns beside a rear that no sensor has looked at: what the bumper of a robot that creeps still makes harmless, m/s.
const UNKNOWN_REAR_MPS: f32 = 0.15;
/// Steps of the way ahead, metres, and how many are tried.
const AHEAD_STEP_M: f32 = 0.05;
const AHEAD_STEPS: u8 = 80;
/// No way ahead brings the place into a sensor's view, metres.
const NEVER_M: f32 = 1.0e6;

/// A gap that is accepted up to a speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GapSpeed {
    /// The gap.
    pub gap: Gap,
    /// The body may touch what is there so fast at most, m/s.
    pub touched_mps: f32,
}

/// Kinds of motion that have a limit of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Forward, nearly straight.
    Forward,
    /// Forward in a bend.
    Turning,
    /// On the spot.
    Spinning,
    /// Backwards.
    Reverse,
}

impl Direction {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Forward, Self::Turning, Self::Spinning, Self::Reverse];

    const fn of(motion: Motion) -> Self {
        match motion {
            Motion::Forward => Self::Forward,
            Motion::TurnLeft | Motion::TurnRight => Self::Turning,
            Motion::SpinLeft | Motion::SpinRight => Self::Spinning,
            Motion::Reverse => Self::Reverse,
        }
    }

    /// In words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Forward => "forward",
            Self::Turning => "turning",
            Self::Spinning => "spinning",
            Self::Reverse => "reverse",
        }
    }
}

/// A direction that is slower for a gap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionLimit {
    /// Which one.
    pub direction: Direction,
    /// So fast the fastest point of the body is there, m/s.
    pub limit_mps: f32,
    /// Instead of this, m/s.
    pub configured_mps: f32,
    /// Because of this gap.
    pub because: GapSpeed,
}

impl fmt::Display for DirectionLimit {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { direction, limit_mps, configured_mps, because } = self;
        write!(
            out,
            "{} at most {limit_mps:.2} m/s instead of {configured_mps:.2}: \"{}\" is accepted at {:.2} m/s",
            direction.name(),
            because.gap,
            because.touched_mps
        )
    }
}

impl Coverage {
    /// Every direction that is slower for a gap, with the gap that costs it most (FG-REQ-063).
    #[must_use]
    pub fn limits(&self, speeds: &[GapSpeed]) -> Vec<DirectionLimit> {
        let of = |direction| {
            let all = speeds.iter().flat_map(|because| self.limits_of(because, direction));
            all.reduce(|a, b| if b.limit_mps < a.limit_mps { b } else { a })
        };
        Direction::ALL.into_iter().filter_map(of).collect()
    }

    fn limits_of<'a>(
        &'a self,
        because: &'a GapSpeed,
        direction: Direction,
    ) -> impl Iterator<Item = DirectionLimit> + 'a {
        let gaps = self.gaps.iter().filter(|found| found.gap.is_same(&because.gap));
        let motions = gaps.flat_map(|found| &found.motions);
        let of_direction = motions.filter(move |motion| Direction::of(motion.motion) == direction);
        of_direction.filter_map(move |motion| {
            let GapMotion { body_share, free_mps, fastest_mps, .. } = *motion;
            let limit_mps = (because.touched_mps / body_share.max(1.0e-3)).max(free_mps);
            let limit =
                DirectionLimit { direction, limit_mps, configured_mps: fastest_mps, because: *because };
            (limit_mps < fastest_mps).then_some(limit)
        })
    }
}

/// The limits for the guard.
pub(crate) fn unseen_limits(robot: &RobotConfiguration, limits: &[DirectionLimit]) -> UnseenLimits {
    let of = |direction| {
        let limit = limits.iter().find(|limit| limit.direction == direction);
        limit.map_or(f32::MAX, |limit| limit.limit_mps)
    };
    UnseenLimits {
        forward_mps: of(Direction::Forward),
        turning_mps: of(Direction::Turning),
        spinning_mps: of(Direction::Spinning),
        reverse_mps: of(Direction::Reverse),
        unknown_rear_mps: UNKNOWN_REAR_MPS,
        known_after_m: known_after_m(robot),
    }
}

/// How far ahead the robot must drive (FG-REQ-064) until a scanner, or the body, was at every place that a spin brings the body to, metres.
fn known_after_m(robot: &RobotConfiguration) -> f32 {
    let outline = Outline::of(&robot.geometry);
    let scanners: Vec<ScannerConfiguration> = [robot.scanner].into_iter().chain(robot.rear_scanner).collect();
    let spins =
        [Motion::SpinLeft, Motion::SpinRight].into_iter().flat_map(|spin| spin.twists(&robot.limits, 1.0));
    let swept = spins.filter_map(|twist| Swept::of(&outline, twist, (&robot.geometry, &robot.limits)));
    let places = swept.flat_map(|swept| swept.places).map(place);
    let known_at = |at: Point2| {
        let ahead = (0..=AHEAD_STEPS).map(|step| f32::from(step) * AHEAD_STEP_M);
        let is_known = |ahead_m: &f32| {
            let before = Point2::new(at.x_m + ahead_m, at.y_m);
            let was_inside = signed_distance_m(&robot.geometry.footprint, before) <= 0.0;
            was_inside || scanners.iter().any(|scanner| is_in_view(scanner, before))
        };
        ahead.into_iter().find(is_known).unwrap_or(NEVER_M)
    };
    places.map(known_at).fold(0.0, f32::max)
}

/// The place lies in the scanner's sector and range.
fn is_in_view(scanner: &ScannerConfiguration, at: Point2) -> bool {
    let mounting = &scanner.mounting;
    let pose = Pose2::new(mounting.position.x_m, mounting.position.y_m, mounting.yaw_rad);
    let seen = pose.inverse().transform(at);
    let [first_rad, last_rad] = scanner.sector_rad;
    let [nearest_m, farthest_m] = SCANNER_RANGE_M;
    (first_rad..=last_rad).contains(&seen.y_m.atan2(seen.x_m))
        && (nearest_m..=farthest_m).contains(&seen.norm())
}
