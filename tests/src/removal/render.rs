//! A VLP-16 in a simulated building, by plain ray casting: noise, quantised ranges, turning head, labels.

use floorguard_mapping_host::clean::{RawReturn, Track};
use floorguard_mapping_host::metrics::read_tum;
use floorguard_types::geometry::Point3;

use super::building::{Building, CEILING_M, Cuboid};
use super::chance::Chance;
use super::sim3d::{LabelledSweep, quaternion};
use super::walkers::Walker;

/// Revolutions a second are 10; so many firings each.
const FIRINGS: usize = 900;
const SWEEP_S: f32 = 0.1;
/// Height of the lidar above the floor, metres.
pub(super) const SENSOR_M: f32 = 0.8;
const NOISE_M: f32 = 0.015;
const SPEED_MPS: f32 = 0.6;
const TURN_RADPS: f32 = 1.0;

/// A drive along straight lines, turning on the spot.
#[derive(Clone, Debug)]
pub struct Drive {
    /// Time, x, y, heading, ordered by time.
    poses: Vec<[f32; 4]>,
}

impl Drive {
    /// Along the corners of a route, from a time on.
    #[must_use]
    pub fn new(route: &[[f32; 2]], start_s: f32) -> Self {
        let mut drive = Self::begin([route[0][0], route[0][1], 0.0], start_s);
        route[1..].iter().for_each(|corner| drive.go_to(*corner));
        drive
    }

    /// Stands at x, y and heading at a time.
    #[must_use]
    pub fn begin([x, y, heading]: [f32; 3], start_s: f32) -> Self {
        Self { poses: vec![[start_s, x, y, heading]] }
    }

    /// Time, x, y, heading at the end.
    #[must_use]
    pub fn last(&self) -> [f32; 4] {
        self.poses[self.poses.len() - 1]
    }

    /// Turns towards a place and drives there.
    pub fn go_to(&mut self, [x, y]: [f32; 2]) {
        let [_, from_x, from_y, _] = self.last();
        let (right, up) = (x - from_x, y - from_y);
        if right.hypot(up) < 1.0e-3 {
            return;
        }
        self.face(up.atan2(right));
        let [time_s, _, _, heading] = self.last();
        self.poses.push([time_s + right.hypot(up) / SPEED_MPS + 0.01, x, y, heading]);
    }

    /// Turns on the spot.
    pub fn face(&mut self, to_rad: f32) {
        let [time_s, x, y, heading] = self.last();
        let turn = wrap(to_rad - heading);
        self.poses.push([time_s + turn.abs() / TURN_RADPS + 0.01, x, y, heading + turn]);
    }

    /// Is at x, y and heading so many seconds later.
    pub fn pass(&mut self, [x, y, heading]: [f32; 3], after_s: f32) {
        let [time_s, _, _, before] = self.last();
        self.poses.push([time_s + after_s, x, y, before + wrap(heading - before)]);
    }

    /// Stands still.
    pub fn wait(&mut self, seconds: f32) {
        let [time_s, x, y, heading] = self.last();
        self.poses.push([time_s + seconds, x, y, heading]);
    }

    /// Time of the end, seconds.
    #[must_use]
    pub fn end_s(&self) -> f32 {
        self.last()[0]
    }

    /// When its sweeps begin, seconds.
    pub fn sweep_starts(&self) -> impl Iterator<Item = f32> {
        let start_s = self.poses[0][0];
        let count = ((self.end_s() - start_s) / SWEEP_S) as usize;
        (0..count).map(move |number| start_s + number as f32 * SWEEP_S)
    }

    /// x, y and heading at a time.
    #[must_use]
    pub fn at(&self, time_s: f32) -> [f32; 3] {
        let after = self.poses.partition_point(|pose| pose[0] <= time_s).clamp(1, self.poses.len() - 1);
        let (from, to) = (self.poses[after - 1], self.poses[after]);
        let share = ((time_s - from[0]) / (to[0] - from[0])).clamp(0.0, 1.0);
        [1, 2, 3].map(|axis| from[axis] + share * (to[axis] - from[axis]))
    }

    /// The true poses, every 10 ms.
    ///
    /// # Panics
    /// Never: times ascend.
    #[must_use]
    pub fn track(&self) -> Track {
        let mut tum = String::new();
        let steps = ((self.end_s() - self.poses[0][0]) * 100.0) as usize + 20;
        for step in 0..steps {
            let time_s = self.poses[0][0] + step as f32 * 0.01;
            let [x, y, heading] = self.at(time_s);
            let [qx, qy, qz, qw] = quaternion(0.0, 0.0, f64::from(heading));
            tum += &format!(
                "{} {x} {y} {SENSOR_M} {qx} {qy} {qz} {qw}\n",
                self.poses[0][0] as f64 + step as f64 * 0.01
            );
        }
        Track::new(read_tum(&tum).expect("eight numbers a line")).expect("times ascend")
    }
}

fn wrap(angle: f32) -> f32 {
    angle - std::f32::consts::TAU * (angle / std::f32::consts::TAU).round()
}

/// The sweeps of a drive.
pub struct Survey<'a> {
    /// What stands.
    pub building: &'a Building,
    /// Who moves.
    pub people: &'a [Walker],
    /// The robot.
    pub drive: &'a Drive,
}

impl Survey<'_> {
    /// Renders sweep after sweep; the same seed gives the same bits.
    pub fn for_each(&self, seed: u64, mut each: impl FnMut(&LabelledSweep)) {
        let mut chance = Chance(seed);
        let mut sweep = LabelledSweep::default();
        for start_s in self.drive.sweep_starts() {
            self.render(start_s, &mut chance, &mut sweep);
            each(&sweep);
        }
    }

    fn render(&self, start_s: f32, chance: &mut Chance, sweep: &mut LabelledSweep) {
        sweep.sweep.start_s = f64::from(start_s);
        sweep.sweep.returns.clear();
        sweep.labels.clear();
        let bodies: Vec<(u8, Cylinder)> = self.bodies(start_s);
        for firing in 0..FIRINGS {
            let offset_s = firing as f32 / FIRINGS as f32 * SWEEP_S;
            let [x, y, heading] = self.drive.at(start_s + offset_s);
            let azimuth = -std::f32::consts::TAU * firing as f32 / FIRINGS as f32;
            for ring in 0..16_u8 {
                let elevation = (2.0 * f32::from(ring) - 15.0).to_radians();
                let direction =
                    |turn: f32| [elevation.cos() * turn.cos(), elevation.cos() * turn.sin(), elevation.sin()];
                let ray = Ray { from: [x, y, SENSOR_M], direction: direction(heading + azimuth) };
                let (range_m, label) = self.nearest(&ray, &bodies);
                if range_m < 0.3 {
                    continue;
                }
                let measured_m = ((range_m + NOISE_M * chance.normal()) / 0.002).round() * 0.002;
                let [dx, dy, dz] = direction(azimuth).map(|part| part * measured_m);
                sweep.sweep.returns.push(RawReturn {
                    point_in_sensor: Point3::new(dx, dy, dz),
                    offset_s,
                    ring,
                });
                sweep.labels.push(label);
            }
        }
    }

    /// Legs, trunk and head of everyone who is there.
    fn bodies(&self, time_s: f32) -> Vec<(u8, Cylinder)> {
        let mut bodies = Vec::new();
        for (number, person) in self.people.iter().enumerate() {
            let Some(middle) = person.at(time_s) else { continue };
            let stride = 0.2 * (6.0 * time_s).sin();
            let [x, y] = middle;
            let hip = 0.5 * person.height_m;
            let mut part = |middle, radius_m, heights| {
                bodies.push((number as u8 + 1, Cylinder { middle, radius_m, heights }))
            };
            part([x + stride, y + 0.1], 0.07, [0.0, hip]);
            part([x - stride, y - 0.1], 0.07, [0.0, hip]);
            part(middle, 0.2, [hip, person.height_m - 0.25]);
            part(middle, 0.1, [person.height_m - 0.25, person.height_m]);
        }
        bodies
    }

    fn nearest(&self, ray: &Ray, bodies: &[(u8, Cylinder)]) -> (f32, u8) {
        let [_, _, rise] = ray.direction;
        let level_m = if rise < 0.0 { -ray.from[2] / rise } else { (CEILING_M - ray.from[2]) / rise };
        let mut best = (level_m, 0);
        for cuboid in &self.building.cuboids {
            if let Some(distance_m) = ray.meets(cuboid).filter(|distance_m| *distance_m < best.0) {
                best = (distance_m, 0);
            }
        }
        for (label, body) in bodies {
            if let Some(distance_m) = ray.meets_cylinder(body).filter(|distance_m| *distance_m < best.0) {
                best = (distance_m, *label);
            }
        }
        best
    }
}

/// An upright part of a body.
pub(super) struct Cylinder {
    middle: [f32; 2],
    radius_m: f32,
    heights: [f32; 2],
}

/// From a place into a direction.
pub(super) struct Ray {
    pub from: [f32; 3],
    /// Of length 1.
    pub direction: [f32; 3],
}

impl Ray {
    /// Distance to a box by its slabs; `None` if missed.
    pub fn meets(&self, cuboid: &Cuboid) -> Option<f32> {
        let (mut near, mut far) = (0.0_f32, f32::INFINITY);
        for axis in 0..3 {
            let one = 1.0 / self.direction[axis];
            let (a, b) =
                ((cuboid.low[axis] - self.from[axis]) * one, (cuboid.high[axis] - self.from[axis]) * one);
            (near, far) = (near.max(a.min(b)), far.min(a.max(b)));
        }
        (near <= far && near > 0.0).then_some(near)
    }

    fn meets_cylinder(&self, body: &Cylinder) -> Option<f32> {
        let (x, y) = (self.from[0] - body.middle[0], self.from[1] - body.middle[1]);
        let [dx, dy, rise] = self.direction;
        let (a, b, c) = (dx * dx + dy * dy, x * dx + y * dy, x * x + y * y - body.radius_m * body.radius_m);
        let root = b * b - a * c;
        if root < 0.0 || c < 0.0 {
            return None;
        }
        let distance_m = (-b - root.sqrt()) / a;
        let height_m = self.from[2] + distance_m * rise;
        (distance_m > 0.0 && (body.heights[0]..=body.heights[1]).contains(&height_m)).then_some(distance_m)
    }
}
