//! Time until the robot would touch a tracked person (book, Guard: Collision).
//!
//! More doubt never means a later time: doubt makes the person's disc larger, and a person inside the larger disc who
//! comes nearer is reached at once (FG-REQ-033).

use super::advice::AdvisedPerson;
use super::config::{DriveLimits, foremost_m, rearmost_m};
use floorguard_types::geometry::{Point2, Pose2, Twist2};

/// Radius of a person, metres.
pub(super) const PERSON_RADIUS_M: f32 = 0.3;
/// Standard deviations of the position that are added to the radius.
pub(super) const POSITION_SIGMAS: f32 = 2.0;
/// Added to the time to standstill before a person must be reached later (book, Guard: Collision), seconds.
const MARGIN_S: f32 = 0.5;
/// Steps of 0.1 s for a turning robot: three seconds.
const STEPS: u8 = 30;
/// Turning slower than this counts as straight, rad/s.
pub(super) const STRAIGHT_RADPS: f32 = 0.05;
/// Slower, squared, a person does not move relative to the robot, m²/s².
const STILL_M2PS2: f32 = 1.0e-6;

/// The box around the body.
///
/// ```
/// use floorguard_guard::Body;
/// use floorguard_types::geometry::Point2;
///
/// let body = Body { x_m: [-0.5, 0.5], y_m: [-0.4, 0.4] };
/// assert_eq!(body.distance_m(Point2::new(2.0, 0.0)), 1.5);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Body {
    /// Least and greatest x, metres.
    pub x_m: [f32; 2],
    /// Least and greatest y, metres.
    pub y_m: [f32; 2],
}

impl Body {
    /// The box around a footprint.
    #[must_use]
    pub fn around(footprint: &[Point2]) -> Self {
        let y_min = footprint.iter().fold(f32::INFINITY, |y_m, corner| y_m.min(corner.y_m));
        let y_max = footprint.iter().fold(f32::NEG_INFINITY, |y_m, corner| y_m.max(corner.y_m));
        Self { x_m: [rearmost_m(footprint), foremost_m(footprint)], y_m: [y_min, y_max] }
    }

    /// From the nearest point of the box to a point, metres; zero inside.
    pub(super) fn offset(&self, point: Point2) -> Point2 {
        let beyond = |at: f32, [low, high]: [f32; 2]| (at - high).max(0.0) + (at - low).min(0.0);
        Point2::new(beyond(point.x_m, self.x_m), beyond(point.y_m, self.y_m))
    }

    /// Distance from the box to a point, metres; 0 inside.
    #[must_use]
    pub fn distance_m(&self, point: Point2) -> f32 {
        self.offset(point).norm()
    }

    /// Seconds until a person is touched when the robot keeps `twist`; infinite when never. First as estimated, then
    /// with the person coming one standard deviation of the velocity faster: never later than the first.
    ///
    /// A person is a disc of 0.3 m and two standard deviations of the position. Who is inside of it and comes no nearer
    /// is not touched, else nobody could stand beside the robot; a person within 0.3 m of the body is touched now.
    #[must_use]
    pub fn times_to_person_s(&self, person: &AdvisedPerson, twist: Twist2) -> [f32; 2] {
        let (place, velocity) = (person.position, person.velocity_mps);
        let offset = self.offset(place);
        let distance_m = offset.norm();
        if distance_m < PERSON_RADIUS_M {
            return [0.0; 2];
        }
        let radius_m = PERSON_RADIUS_M + POSITION_SIGMAS * person.position_sigma_m.max(0.0);
        let doubt_mps = person.velocity_sigma_mps.max(0.0);
        let [estimated_s, doubtful_s] = if twist.angular_radps.abs() > STRAIGHT_RADPS {
            [0.0, doubt_mps].map(|growth_mps| self.turning_time_s(person, twist, (radius_m, growth_mps)))
        } else {
            let relative = Point2::new(velocity.x_m - twist.linear_mps, velocity.y_m);
            let share = doubt_mps / distance_m;
            let faster = Point2::new(relative.x_m - share * offset.x_m, relative.y_m - share * offset.y_m);
            [relative, faster].map(|relative| self.straight_time_s(place, relative, radius_m))
        };
        [estimated_s, doubtful_s.min(estimated_s)]
    }

    /// Seconds until a point that moves with `u` relative to the body is within `radius_m` of it.
    ///
    /// The distance to a convex body is a convex function of the time: who comes no nearer now never does. The body with
    /// a border of `radius_m` is two boxes and four discs; the soonest of them counts.
    fn straight_time_s(&self, point: Point2, u: Point2, radius_m: f32) -> f32 {
        let offset = self.offset(point);
        let closing = offset.x_m * u.x_m + offset.y_m * u.y_m < 0.0;
        if !closing || u.x_m * u.x_m + u.y_m * u.y_m < STILL_M2PS2 {
            return f32::INFINITY;
        }
        if offset.norm() <= radius_m {
            return 0.0;
        }
        let ([x_low, x_high], [y_low, y_high]) = (self.x_m, self.y_m);
        let (wide, long) = ([x_low - radius_m, x_high + radius_m], [y_low - radius_m, y_high + radius_m]);
        let boxes = [(wide, self.y_m), (self.x_m, long)].map(|(x_m, y_m)| {
            let (along, across) = (stay_s(point.x_m, u.x_m, x_m), stay_s(point.y_m, u.y_m, y_m));
            let (enters_s, leaves_s) = (along[0].max(across[0]), along[1].min(across[1]));
            if enters_s <= leaves_s && leaves_s >= 0.0 { enters_s.max(0.0) } else { f32::INFINITY }
        });
        let corners = [(x_low, y_low), (x_low, y_high), (x_high, y_low), (x_high, y_high)];
        let discs = corners.map(|(x_m, y_m)| {
            time_to_collision_s(Point2::new(point.x_m - x_m, point.y_m - y_m), u, radius_m)
        });
        boxes.into_iter().chain(discs).fold(f32::INFINITY, f32::min)
    }

    /// The same for a turning robot, by steps of 0.1 s from now on; the radius grows with the doubt about the velocity.
    fn turning_time_s(
        &self,
        person: &AdvisedPerson,
        twist: Twist2,
        (radius_m, growth_mps): (f32, f32),
    ) -> f32 {
        let (mut before_m, mut came_nearer) = (f32::INFINITY, false);
        let turn_radius_m = twist.linear_mps / twist.angular_radps;
        for step in 0..=STEPS.saturating_add(1) {
            let time_s = f32::from(step) * 0.1;
            let turned = twist.angular_radps * time_s;
            let (sin, cos) = libm::sincosf(turned);
            let robot = Pose2::new(turn_radius_m * sin, turn_radius_m * (1.0 - cos), turned);
            let ahead = Point2::new(
                person.position.x_m + person.velocity_mps.x_m * time_s,
                person.position.y_m + person.velocity_mps.y_m * time_s,
            );
            let gap_m = self.distance_m(robot.inverse().transform(ahead)) - growth_mps * time_s;
            let comes_nearer = step > 0 && gap_m < before_m;
            if before_m <= radius_m && (came_nearer || comes_nearer) {
                return time_s - 0.1;
            }
            (before_m, came_nearer) = (gap_m, comes_nearer);
        }
        f32::INFINITY
    }
}

/// When a number that changes with `rate` is within limits: from, to, seconds; never when from is later than to.
fn stay_s(at: f32, rate: f32, [low, high]: [f32; 2]) -> [f32; 2] {
    if rate == 0.0 {
        let never = [f32::INFINITY, f32::NEG_INFINITY];
        return if at >= low && at <= high { [f32::NEG_INFINITY, f32::INFINITY] } else { never };
    }
    let (low_s, high_s) = ((low - at) / rate, (high - at) / rate);
    [low_s.min(high_s), low_s.max(high_s)]
}

impl DriveLimits {
    /// Nobody may be reached sooner than this at a speed: the time to standstill, and a margin (book, Guard:
    /// Collision), seconds.
    #[must_use]
    pub const fn clear_of_people_s(&self, speed_mps: f32) -> f32 {
        self.response_s + speed_mps / self.braking_mps2 + MARGIN_S
    }
}

/// In which directions the robot would come nearer to a piece of evidence.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Blocked {
    /// Driving straight forward.
    pub forward: bool,
    /// Driving straight backward.
    pub backward: bool,
}

impl Blocked {
    /// Adds a point in the robot frame. Driving backward cannot shorten the distance from the body's box to a point
    /// unless it lies behind the rear edge, or inside the box; forward alike (FG-REQ-040).
    pub fn add(&mut self, point: Point2, body: &Body) {
        let touching = body.distance_m(point) <= 0.0;
        self.forward |= touching || point.x_m > body.x_m[1];
        self.backward |= touching || point.x_m < body.x_m[0];
    }
}

/// Seconds until a point at `p` moving with `u` relative to us is within `radius_m`; 0 when it is, infinite when it
/// never will be.
///
/// ```
/// use floorguard_guard::time_to_collision_s;
/// use floorguard_types::geometry::Point2;
///
/// // 5 m away, 1 m/s towards the disc of 1 m; and past it.
/// let towards = time_to_collision_s(Point2::new(5.0, 0.0), Point2::new(-1.0, 0.0), 1.0);
/// assert!((towards - 4.0).abs() < 1.0e-5);
/// let past = time_to_collision_s(Point2::new(5.0, 2.0), Point2::new(-1.0, 0.0), 1.0);
/// assert_eq!(past, f32::INFINITY);
/// ```
#[must_use]
pub fn time_to_collision_s(p: Point2, u: Point2, radius_m: f32) -> f32 {
    let a = u.x_m * u.x_m + u.y_m * u.y_m;
    let b = p.x_m * u.x_m + p.y_m * u.y_m;
    let c = p.x_m * p.x_m + p.y_m * p.y_m - radius_m * radius_m;
    if c <= 0.0 {
        return 0.0;
    }
    let discriminant = b * b - a * c;
    if a < STILL_M2PS2 || b >= 0.0 || discriminant < 0.0 {
        return f32::INFINITY;
    }
    (-b - libm::sqrtf(discriminant)) / a
}
