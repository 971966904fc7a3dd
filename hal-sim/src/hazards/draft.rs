//! A world while it is drawn.

use floorguard_types::random::Pcg32;

use crate::people::PersonKind;
use crate::scenario::{PersonFile, RouteFile, Scenario};
use crate::scene::{FurnitureFile, FurnitureKind, Material, WallFile};

/// The robot's outline with what stays free around it at the start, metres: rear, right, front, left.
const START_M: [f32; 4] = [-0.48, -0.43, 0.985, 0.43];
/// Furniture is examined in points that are this far apart, metres.
const POINTS_M: f32 = 0.02;

/// Draws a world.
pub(super) struct Draft<'r> {
    pub random: &'r mut Pcg32,
    pub scenario: Scenario,
}

impl<'r> Draft<'r> {
    /// A hall with a robot at the origin that looks along x.
    pub fn new(family: &str, random: &'r mut Pcg32) -> Self {
        let mut scenario =
            Scenario { title: format!("hazards: {family}"), bumpers: true, ..Scenario::default() };
        for y_m in [-9.0, 9.0] {
            let (from_m, to_m) = ([-8.0, y_m], [22.0, y_m]);
            scenario.scene.wall.push(WallFile { from_m, to_m, height_m: 2.2, material: Material::Matte });
        }
        Self { random, scenario }
    }

    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        self.random.uniform_between(low, high)
    }

    pub fn chance(&mut self, share: f32) -> bool {
        self.random.bernoulli(share)
    }

    pub fn count(&mut self, low: u32, high: u32) -> u32 {
        low + self.random.below(high - low + 1)
    }

    pub fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.random.below(choices.len() as u32) as usize]
    }

    pub fn sign(&mut self) -> f32 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }

    /// The way, at a speed of 0.4 to 1.0 m/s.
    pub fn route(&mut self, waypoints_m: &[[f32; 2]]) {
        let speed_mps = self.between(0.4, 1.0);
        self.scenario.route = RouteFile { speed_mps, repeat: false, waypoints_m: waypoints_m.to_vec() };
    }

    /// Straight on.
    pub fn straight(&mut self) {
        self.route(&[[12.0, 0.0]]);
    }

    /// Ahead with one or two turns; gives the way.
    pub fn winding(&mut self) -> Vec<[f32; 2]> {
        let first = [self.between(2.5, 5.0), self.between(-0.5, 0.5)];
        let side = self.sign();
        let second = [first[0] + self.between(-1.5, 2.0), side * self.between(2.0, 4.0)];
        let mut path = vec![first, second];
        if self.chance(0.6) {
            path.push([self.between(-2.0, 8.0), side * self.between(-1.0, 5.0)]);
        }
        self.route(&path);
        path
    }

    /// Adds a piece unless it stands in the robot.
    pub fn furniture(&mut self, piece: FurnitureFile) -> bool {
        let is_free = !stands_in_robot(&piece);
        if is_free {
            self.scenario.scene.furniture.push(piece);
        }
        is_free
    }

    /// A box between two heights.
    pub fn block(&mut self, at_m: [f32; 2], size_m: [f32; 2], z_m: [f32; 2]) -> bool {
        self.furniture(FurnitureFile {
            size_m,
            from_m: z_m[0],
            height_m: z_m[1],
            ..piece(FurnitureKind::Box, at_m)
        })
    }

    /// Somebody who stands.
    pub fn person(&mut self, kind: PersonKind, at_m: [f32; 2]) {
        let yaw_deg = self.between(-180.0, 180.0);
        self.scenario.person.push(PersonFile {
            kind,
            at_m,
            yaw_deg,
            sees_robot: false,
            ..PersonFile::default()
        });
    }
}

/// A piece of a kind at a place, as large as its kind is by default.
pub(super) fn piece(kind: FurnitureKind, at_m: [f32; 2]) -> FurnitureFile {
    FurnitureFile::new(kind, at_m, ([1.0, 1.0], 1.0))
}

/// Any point of the piece as seen from above lies in the robot at its start.
fn stands_in_robot(piece: &FurnitureFile) -> bool {
    let (sin, cos) = libm::sincosf(piece.yaw_deg.to_radians());
    // The drive unit of a pallet truck stands behind its tines; a post is as wide as it is long.
    let (behind_m, size_m) = match piece.kind {
        FurnitureKind::Forks => (0.45, [piece.size_m[0], 0.6]),
        FurnitureKind::Post => (0.0, [piece.size_m[0]; 2]),
        FurnitureKind::Trolley => (0.0, [0.85, 0.5]),
        _ => (0.0, piece.size_m),
    };
    let (low_m, high_m) = (-size_m[0] / 2.0 - behind_m, size_m[0] / 2.0);
    let steps = |length_m: f32| (length_m / POINTS_M) as u16 + 1;
    let along = steps(high_m - low_m);
    let across = steps(size_m[1]);
    (0..=along).any(|i| {
        let x = low_m + (high_m - low_m) * f32::from(i) / f32::from(along);
        (0..=across).any(|j| {
            let y = size_m[1] * (f32::from(j) / f32::from(across) - 0.5);
            let [px, py] = [piece.at_m[0] + cos * x - sin * y, piece.at_m[1] + sin * x + cos * y];
            let [rear, right, front, left] = START_M;
            (rear..front).contains(&px) && (right..left).contains(&py)
        })
    })
}
