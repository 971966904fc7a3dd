//! Assembles a scene out of furniture.

use parry3d::math::{Pose, Rotation, Vector};
use parry3d::shape::{Compound, SharedShape};

use super::{DropTruth, Material, PartShape, PartTruth, Scene};

/// Thickness of walls and panels, metres.
const WALL_M: f32 = 0.1;
/// Height up to which objects obstruct people, metres.
const HEAD_M: f32 = 1.6;

/// Collects parts.
#[derive(Default)]
pub struct SceneBuilder {
    parts: Vec<PartTruth>,
    plan: Vec<(Pose, SharedShape)>,
    drops: Vec<DropTruth>,
    name: String,
}

impl SceneBuilder {
    /// What is added from now on belongs to an object of this name.
    pub fn named(&mut self, name: String) {
        self.name = name;
    }

    /// A box: middle of its ground area, yaw, sizes along its own x and y, and from which height to which.
    pub fn cuboid(&mut self, place: (f32, f32, f32), size: (f32, f32), z: (f32, f32), material: Material) {
        let (x, y, yaw) = place;
        let half = ((size.0 / 2.0).max(0.005), (size.1 / 2.0).max(0.005), ((z.1 - z.0) / 2.0).max(0.005));
        let turn = Rotation::from_rotation_z(yaw);
        self.parts.push(PartTruth {
            name: self.name.clone(),
            shape: PartShape::Box([half.0, half.1, half.2]),
            centre_m: [x, y, (z.0 + z.1) / 2.0],
            yaw_rad: yaw,
            slope_rad: 0.0,
            material,
        });
        if z.0 < HEAD_M {
            let pose = Pose::from_parts(Vector::new(x, y, 1.0), turn);
            self.plan.push((pose, SharedShape::cuboid(half.0, half.1, 1.0)));
        }
    }

    /// A wall or panel between two points.
    pub fn wall(&mut self, from: [f32; 2], to: [f32; 2], height_m: f32, material: Material) {
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let length = libm::hypotf(dx, dy) + WALL_M;
        let place = ((from[0] + to[0]) / 2.0, (from[1] + to[1]) / 2.0, libm::atan2f(dy, dx));
        self.cuboid(place, (length, WALL_M), (0.0, height_m), material);
    }

    /// A shelf with plinth, back and boards: lasers reach into it.
    pub fn shelf(&mut self, place: (f32, f32, f32), size: (f32, f32), height_m: f32) {
        self.cuboid(place, size, (0.0, 0.25), Material::Matte);
        self.cuboid(place, (size.0, size.1 * 0.2), (0.25, height_m), Material::Matte);
        for board in 1..=3 {
            let z = 0.25 + (height_m - 0.25) * board as f32 / 3.0;
            self.cuboid(place, size, (z - 0.03, z), Material::Matte);
        }
    }

    /// A table: a board on four legs.
    pub fn table(&mut self, place: (f32, f32, f32), size: (f32, f32), height_m: f32) {
        self.cuboid(place, size, (height_m - 0.03, height_m), Material::Matte);
        self.legs(place, size, height_m);
    }

    /// A shopping trolley: a basket on four thin legs.
    pub fn trolley(&mut self, place: (f32, f32, f32)) {
        self.cuboid(place, (0.85, 0.5), (0.45, 0.95), Material::Matte);
        self.legs(place, (0.85, 0.5), 0.45);
    }

    fn legs(&mut self, place: (f32, f32, f32), size: (f32, f32), height_m: f32) {
        let (sin, cos) = libm::sincosf(place.2);
        for (sx, sy) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let (dx, dy) = (sx * (size.0 / 2.0 - 0.03), sy * (size.1 / 2.0 - 0.03));
            let at = (place.0 + cos * dx - sin * dy, place.1 + sin * dx + cos * dy, place.2);
            self.cuboid(at, (0.05, 0.05), (0.0, height_m), Material::Matte);
        }
    }

    /// A ramp that rises along its own x; people and the robot do not climb it, lasers see it.
    pub fn ramp(&mut self, place: (f32, f32, f32), size: (f32, f32), rise_m: f32) {
        let slope = libm::atan2f(rise_m, size.0);
        let length = libm::hypotf(size.0, rise_m);
        self.parts.push(PartTruth {
            name: self.name.clone(),
            shape: PartShape::Box([length / 2.0, size.1 / 2.0, 0.02]),
            centre_m: [place.0, place.1, rise_m / 2.0 - 0.02],
            yaw_rad: place.2,
            slope_rad: slope,
            material: Material::Matte,
        });
    }

    /// A round post.
    pub fn post(&mut self, at: (f32, f32), radius_m: f32, z: (f32, f32), material: Material) {
        let height_m = (z.1 - z.0).max(0.01);
        self.parts.push(PartTruth {
            name: self.name.clone(),
            shape: PartShape::Post(radius_m.max(0.005), height_m),
            centre_m: [at.0, at.1, (z.0 + z.1) / 2.0],
            yaw_rad: 0.0,
            slope_rad: 0.0,
            material,
        });
        if z.0 < HEAD_M {
            let pose = Pose::from_translation(Vector::new(at.0, at.1, 1.0));
            self.plan.push((pose, SharedShape::cuboid(radius_m, radius_m, 1.0)));
        }
    }

    /// A pallet truck: two tines of 0.16 m near the floor along its own x, the drive unit behind them.
    pub fn forks(&mut self, place: (f32, f32, f32), length_m: f32, z: (f32, f32)) {
        let (sin, cos) = libm::sincosf(place.2);
        let at = |ahead: f32, left: f32| {
            (place.0 + cos * ahead - sin * left, place.1 + sin * ahead + cos * left, place.2)
        };
        for left in [0.19, -0.19] {
            self.cuboid(at(0.0, left), (length_m, 0.16), z, Material::Dark);
        }
        self.cuboid(at(-length_m / 2.0 - 0.2, 0.0), (0.4, 0.54), (0.03, 1.2), Material::Matte);
    }

    /// A hole in the floor.
    pub fn hole(&mut self, drop: DropTruth) {
        self.drops.push(drop);
    }

    /// The finished scene.
    #[must_use]
    pub fn build(self) -> Scene {
        let compound = |parts: Vec<_>| (!parts.is_empty()).then(|| Compound::new(parts));
        let solids = compound(self.parts.iter().map(PartTruth::placed).collect());
        Scene::new(solids, (self.parts, self.drops), compound(self.plan))
    }
}
