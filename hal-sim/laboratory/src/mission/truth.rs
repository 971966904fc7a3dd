//! What really happens: where the robot is, which specks of dirt lie where, and what its sensors say.
//!
//! Dirt here is single specks at places of their own, as in the simulator of the whole robot. The belief counts units in
//! cells; the two share no code, so one judges the other.

use floorguard_mapping::GridCoordinates;
use floorguard_sim::dirt::DirtyFloor;
use floorguard_sim::robot::BrushDeck;
use floorguard_types::geometry::{Point2, Pose2, Twist2};
use floorguard_types::random::Pcg32;

use floorguard_robot::site::Floor;

/// A range sensor in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeSensor {
    /// Field of view, radians, ahead.
    pub view_rad: f32,
    /// Beams.
    pub beams: u16,
    /// Shortest and longest range, metres.
    pub range_m: (f32, f32),
    /// Deviation, metres.
    pub noise_m: f32,
    /// Share of beams that mean nothing.
    pub outliers: f32,
}

impl RangeSensor {
    /// The depth camera of the published robot.
    pub const XTION: Self =
        Self { view_rad: 0.995, beams: 30, range_m: (0.5, 4.0), noise_m: 0.03, outliers: 0.01 };
    /// A safety scanner, every ninth beam of 541.
    pub const SAFETY_SCANNER: Self =
        Self { view_rad: 4.712, beams: 60, range_m: (0.05, 30.0), noise_m: 0.02, outliers: 0.01 };
}

/// Errors of the odometry (book, Cleaning: Published protocol). White parts are for 0.1 m of travel and grow with
/// its root.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OdometryErrors {
    /// Share of the distance.
    pub drive: f32,
    /// Radians of drift a metre.
    pub drift_rad_per_m: f32,
    /// Share of the turn.
    pub turn: f32,
}

impl OdometryErrors {
    /// The errors of the published protocol.
    pub const PUBLISHED: Self = Self { drive: 0.05, drift_rad_per_m: 0.02, turn: 0.03 };
}

/// The world as it is.
pub struct Truth {
    /// Where the robot is, in the map frame.
    pub pose: Pose2,
    /// What the wheels say, in the odometry frame.
    pub odometry: Pose2,
    /// Distance driven, metres.
    pub distance_m: f32,
    /// Simulated time, s.
    pub time_s: f32,
    /// Wheels turn, but the robot does not follow fully: share of the motion that is real.
    pub grip: f32,
    /// Cells over whose middle the brush has passed.
    pub passed: Vec<bool>,
    dirt: DirtyFloor,
    pickup_probability: f32,
    errors: OdometryErrors,
    drive_bias: f32,
    drift_bias: f32,
    turn_bias: f32,
    random: Pcg32,
}

impl Truth {
    /// Draws the dirt from what is expected and places the robot near the start.
    pub fn new(floor: &Floor, expected: &[f32], pickup_probability: f32, mut random: Pcg32) -> Self {
        let dirt = DirtyFloor::draw(floor.cells, expected, &mut random);
        let errors = OdometryErrors::PUBLISHED;
        let (x, y) = random.normal_pair();
        let (turn, drive) = random.normal_pair();
        let (drift, turning) = random.normal_pair();
        let start = floor.start;
        Self {
            pose: Pose2::new(start.x_m + 0.05 * x, start.y_m + 0.05 * y, start.heading_rad + 0.052 * turn),
            odometry: Pose2::default(),
            distance_m: 0.0,
            time_s: 0.0,
            grip: 1.0,
            passed: vec![false; expected.len()],
            dirt,
            pickup_probability,
            errors,
            // Half of the error stays the same for the whole run (wheel diameter), the rest comes and goes.
            drive_bias: 0.5 * errors.drive * drive,
            drift_bias: 0.5 * errors.drift_rad_per_m * drift,
            turn_bias: 0.5 * errors.turn * turning,
            random,
        }
    }

    /// Drives for `period_s`. Returns the hits of the dirt sensor, and whether an obstacle stopped the robot.
    pub fn drive(
        &mut self,
        floor: &Floor,
        twist: Twist2,
        period_s: f32,
        brush: Option<BrushDeck>,
    ) -> (u32, bool) {
        self.time_s += period_s;
        let forward = twist.linear_mps * period_s;
        let turn = twist.angular_radps * period_s;
        self.roll_wheels(forward, turn);
        let real = Pose2::new(forward * self.grip, 0.0, turn * (0.5 + 0.5 * self.grip));
        let before = self.pose;
        let after = before.compose(real);
        // An obstacle stops what goes towards it, forwards or backwards; away from it the robot comes free.
        let clearance_at = |pose: Pose2| floor.clearance.clearance_m(Point2::new(pose.x_m, pose.y_m));
        let clearance_m = clearance_at(after);
        if forward != 0.0 && clearance_m < floor.robot_radius_m - 0.02 && clearance_m <= clearance_at(before)
        {
            return (0, true);
        }
        self.pose = after;
        self.distance_m += (forward * self.grip).abs();
        let hits = brush.map_or(0, |brush| self.sweep(floor, brush, before));
        (hits, false)
    }

    /// A push or a skid that the wheels do not see.
    pub fn displace(&mut self, floor: &Floor, position_m: f32, heading_rad: f32) {
        let (x, y) = self.random.normal_pair();
        let turned = self.pose.heading_rad + self.random.normal() * heading_rad;
        let there = Pose2::new(self.pose.x_m + x * position_m, self.pose.y_m + y * position_m, turned);
        let (from, to) = (Point2::new(self.pose.x_m, self.pose.y_m), Point2::new(there.x_m, there.y_m));
        if floor.is_clear_by(from, to, floor.robot_radius_m) {
            self.pose = there;
        }
    }

    fn roll_wheels(&mut self, forward: f32, turn: f32) {
        let (a, b) = self.random.normal_pair();
        let c = self.random.normal();
        let root = |travel: f32, unit: f32| (travel.abs() * unit).sqrt();
        let travel = forward * (1.0 + self.drive_bias) + 0.87 * self.errors.drive * root(forward, 0.1) * a;
        let angle = turn * (1.0 + self.turn_bias)
            + self.drift_bias * forward
            + 0.87 * self.errors.drift_rad_per_m * root(forward, 0.1) * b
            + 0.87 * self.errors.turn * root(turn, 0.17) * c;
        self.odometry = self.odometry.compose(Pose2::new(travel, 0.0, angle));
    }

    fn sweep(&mut self, floor: &Floor, brush: BrushDeck, before: Pose2) -> u32 {
        let pass = brush.pass(before, self.pose);
        let GridCoordinates { column, row } =
            floor.cells.coordinates_of(Point2::new(self.pose.x_m, self.pose.y_m));
        for (dx, dy) in (-2..=2).flat_map(|dx| (-2..=2).map(move |dy| (dx, dy))) {
            let Some(cell) = floor.cells.index(column + dx, row + dy) else { continue };
            self.passed[cell] |= pass.covers(floor.cells.centre(cell));
        }
        self.dirt.sweep(&pass, self.time_s, (self.pickup_probability, &mut self.random))
    }

    /// Units that really lie in a cell.
    pub fn units(&self, cell: usize) -> u32 {
        self.dirt.units(cell)
    }

    /// Ends of the beams that hit something, in the robot's frame; people hide what is behind them.
    pub fn scan(&mut self, floor: &Floor, sensor: &RangeSensor, people: &[Point2]) -> Vec<Point2> {
        let mut hits = Vec::with_capacity(usize::from(sensor.beams));
        for beam in 0..sensor.beams {
            let share = f32::from(beam) / f32::from(sensor.beams.saturating_sub(1).max(1)) - 0.5;
            let angle = share * sensor.view_rad;
            let (sin, cos) = (self.pose.heading_rad + angle).sin_cos();
            let mut range = cast(floor, self.pose, (sin, cos), sensor.range_m.1);
            for person in people {
                range = range.min(range_to_person(self.pose, (sin, cos), *person).unwrap_or(f32::MAX));
            }
            let noisy = range + sensor.noise_m * self.random.normal();
            let measured = if self.random.bernoulli(sensor.outliers) {
                self.random.uniform_between(sensor.range_m.0, sensor.range_m.1.min(10.0))
            } else {
                noisy
            };
            if range < sensor.range_m.1 && measured > sensor.range_m.0 && measured < sensor.range_m.1 {
                hits.push(Point2::new(measured * angle.cos(), measured * angle.sin()));
            }
        }
        hits
    }
}

/// Distance to the nearest surface along a ray: marches by the distance field.
fn cast(floor: &Floor, pose: Pose2, (sin, cos): (f32, f32), range_max_m: f32) -> f32 {
    let pixel = floor.surfaces.geometry().resolution_m();
    let mut range = 0.0;
    for _ in 0..400 {
        let point = Point2::new(pose.x_m + cos * range, pose.y_m + sin * range);
        let Some(cell) = floor.surfaces.geometry().cell_at(point) else { return range_max_m };
        let clear = f32::from(*floor.surfaces.get(cell).unwrap_or(&0)) * 0.01;
        if clear < 0.5 * pixel {
            return range;
        }
        // Distances are between the centres of pixels: a pixel's diagonal less is safe.
        range += (clear - 1.4 * pixel).max(0.3 * pixel);
        if range >= range_max_m {
            return range_max_m;
        }
    }
    range_max_m
}

/// Where a ray meets the legs of a person, a circle of 0.2 m.
fn range_to_person(pose: Pose2, (sin, cos): (f32, f32), person: Point2) -> Option<f32> {
    let (dx, dy) = (person.x_m - pose.x_m, person.y_m - pose.y_m);
    let along = dx * cos + dy * sin;
    let across = dx * sin - dy * cos;
    (along > 0.0 && across.abs() < 0.2).then(|| along - (0.04 - across * across).max(0.0).sqrt())
}
