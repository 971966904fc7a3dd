//! Time until the robot would touch a tracked person (book, Guard: Collision).

use super::advice::AdvisedPerson;
use super::config::{DriveLimits, foremost_m, rearmost_m};
use floorguard_types::geometry::{Point2, Pose2, Twist2};

/// Radius of a person, metres.
const PERSON_RADIUS_M: f32 = 0.3;
/// Standard deviations added to the radius (k) and taken from the velocity (k_v).
const POSITION_SIGMAS: f32 = 2.0;
/// A person whose disc touches the body is a collision, whatever the direction, metres.
const TOUCHING_M: f32 = 0.3;
/// Added to the time to standstill before a person must be reached later (book, Guard: Collision), seconds.
const MARGIN_S: f32 = 0.5;
/// Steps of 0.1 s for a turning robot: three seconds.
const STEPS: u8 = 30;
/// Turning slower than this counts as straight, rad/s.
const STRAIGHT_RADPS: f32 = 0.05;

/// The body as three circles in a row, for times to collision, and as a box, for distances.
///
/// ```
/// use floorguard_guard::{AdvisedPerson, Body};
/// use floorguard_types::geometry::{Point2, Twist2};
///
/// let body = Body { x_m: [-0.5, 0.5], y_m: [-0.4, 0.4] };
/// assert_eq!(body.distance_m(Point2::new(2.0, 0.0)), 1.5);
/// // Somebody stands 3.5 m ahead of a robot that drives 1 m/s.
/// let person = AdvisedPerson { position: Point2::new(3.5, 0.0), ..AdvisedPerson::default() };
/// let [estimated_s, doubtful_s] = body.times_to_person_s(&person, Twist2 { linear_mps: 1.0, angular_radps: 0.0 });
/// assert!((2.0..3.0).contains(&estimated_s) && doubtful_s <= estimated_s);
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

    /// Distance from the box to a point, metres; 0 inside.
    #[must_use]
    pub fn distance_m(&self, point: Point2) -> f32 {
        let ahead = (point.x_m - self.x_m[1]).max(self.x_m[0] - point.x_m).max(0.0);
        let aside = (point.y_m - self.y_m[1]).max(self.y_m[0] - point.y_m).max(0.0);
        Point2::new(ahead, aside).norm()
    }

    fn circles(&self) -> ([Point2; 3], f32) {
        let length_m = self.x_m[1] - self.x_m[0];
        let middle_y = 0.5 * (self.y_m[0] + self.y_m[1]);
        let centre = |sixths: f32| Point2::new(self.x_m[0] + length_m * sixths / 6.0, middle_y);
        let radius_m = Point2::new(length_m / 6.0, 0.5 * (self.y_m[1] - self.y_m[0])).norm();
        ([centre(1.0), centre(3.0), centre(5.0)], radius_m)
    }

    /// Seconds until a person is touched when the robot keeps `twist`; infinite when never. First as estimated, then
    /// with the person coming one standard deviation of the velocity faster (k_v): never later than the first.
    #[must_use]
    pub fn times_to_person_s(&self, person: &AdvisedPerson, twist: Twist2) -> [f32; 2] {
        let (centres, circle_m) = self.circles();
        let radius_m = circle_m + PERSON_RADIUS_M + POSITION_SIGMAS * person.position_sigma_m;
        if twist.angular_radps.abs() > STRAIGHT_RADPS {
            return [0.0, person.velocity_sigma_mps]
                .map(|growth_mps| turning_time_s(person, twist, (&centres, radius_m, growth_mps)));
        }
        let velocity = person.velocity_mps;
        let mut least_s = [f32::INFINITY; 2];
        for centre in centres {
            let p = Point2::new(person.position.x_m - centre.x_m, person.position.y_m - centre.y_m);
            let u = Point2::new(velocity.x_m - twist.linear_mps, velocity.y_m);
            let away = person.velocity_sigma_mps / p.norm().max(1.0e-3);
            let pessimistic = Point2::new(u.x_m - away * p.x_m, u.y_m - away * p.y_m);
            let [estimated_s, doubtful_s] = least_s;
            let estimated_s = estimated_s.min(time_to_collision_s(p, u, radius_m));
            let doubtful_s = doubtful_s.min(time_to_collision_s(p, pessimistic, radius_m));
            least_s = [estimated_s, doubtful_s.min(estimated_s)];
        }
        least_s
    }
}

/// A person at this distance from the body, reached after this time, is one to stop for. Who is within reach already and
/// does not touch the robot is none: else nobody could stand beside it.
#[must_use]
pub const fn is_collision(time_s: f32, distance_m: f32) -> bool {
    time_s > 0.0 || distance_m < TOUCHING_M
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
    if a < 1.0e-6 || b >= 0.0 || discriminant < 0.0 {
        return f32::INFINITY;
    }
    (-b - libm::sqrtf(discriminant)) / a
}

/// The same for a turning robot, by steps of 0.1 s from t = 0 on (book, Guard: Collision).
fn turning_time_s(
    person: &AdvisedPerson,
    twist: Twist2,
    (centres, radius_m, growth_mps): (&[Point2; 3], f32, f32),
) -> f32 {
    for step in 0..=STEPS {
        let time_s = f32::from(step) * 0.1;
        let turned = twist.angular_radps * time_s;
        let (sin, cos) = libm::sincosf(turned);
        let radius = twist.linear_mps / twist.angular_radps;
        let robot = Pose2::new(radius * sin, radius * (1.0 - cos), turned);
        let ahead = Point2::new(
            person.position.x_m + person.velocity_mps.x_m * time_s,
            person.position.y_m + person.velocity_mps.y_m * time_s,
        );
        let reach_m = radius_m + growth_mps * time_s;
        if centres.iter().any(|centre| robot.transform(*centre).distance(ahead) <= reach_m) {
            return time_s;
        }
    }
    f32::INFINITY
}
