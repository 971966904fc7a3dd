//! Random office floors: a corridor, rooms with doors and furniture, and a drive through them.

use super::chance::Chance;

/// A solid box along the axes, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    /// Smallest coordinates.
    pub low: [f32; 3],
    /// Largest coordinates.
    pub high: [f32; 3],
}

/// What stands for ever, and where one can walk.
#[derive(Clone, Debug, Default)]
pub struct Building {
    /// Walls and furniture.
    pub cuboids: Vec<Cuboid>,
    /// Middle of each open room; its door lies on the line to the corridor.
    pub rooms: Vec<[f32; 2]>,
    /// Length of the corridor along x, metres.
    pub length_m: f32,
}

/// Height of the ceiling, metres.
pub const CEILING_M: f32 = 2.7;
/// Half the width of the corridor, metres.
pub const CORRIDOR_HALF_M: f32 = 1.2;
const ROOM_M: f32 = 6.0;
const DEPTH_M: f32 = 5.0;
const WALL_M: f32 = 0.1;
const DOOR_HALF_M: f32 = 0.5;

impl Building {
    /// A corridor with up to `rooms` rooms, at least one, on both sides.
    #[must_use]
    pub fn random(chance: &mut Chance, rooms: usize) -> Self {
        let per_side = rooms.div_ceil(2).max(1);
        let mut building = Self { length_m: ROOM_M * per_side as f32, ..Self::default() };
        building.corridor_ends();
        for place in 0..2 * per_side {
            let side = if place % 2 == 0 { 1.0 } else { -1.0 };
            let from_m = ROOM_M * (place / 2) as f32;
            if place < rooms.max(1) {
                building.room(from_m, side, chance);
            } else {
                building.wall([from_m, from_m + ROOM_M], [side * CORRIDOR_HALF_M; 2]);
            }
        }
        building
    }

    /// One hall of 12 m by 9 m with shelves along a wall, a cupboard and a counter: wide enough for the robot to turn anywhere on its
    /// way.
    #[must_use]
    pub fn hall() -> Self {
        let mut hall = Self { length_m: 12.0, ..Self::default() };
        for y in [-4.5, 4.5] {
            hall.wall([0.0, 12.0], [y; 2]);
        }
        for x in [0.0, 12.0] {
            hall.wall([x; 2], [-4.5, 4.5]);
        }
        hall.solid([4.0, 3.9], [3.0, 0.4], [0.0, 1.9]);
        hall.solid([8.5, 3.6], [0.8, 0.6], [0.0, 1.2]);
        hall.solid([3.0, -4.0], [2.0, 0.7], [0.0, 0.9]);
        hall
    }

    fn wall(&mut self, x: [f32; 2], y: [f32; 2]) {
        let half = 0.5 * WALL_M;
        let (y_low, y_high) = (y[0].min(y[1]), y[0].max(y[1]));
        self.cuboids.push(Cuboid {
            low: [x[0] - half, y_low - half, 0.0],
            high: [x[1] + half, y_high + half, CEILING_M],
        });
    }

    fn corridor_ends(&mut self) {
        for x in [0.0, self.length_m] {
            self.wall([x; 2], [-CORRIDOR_HALF_M, CORRIDOR_HALF_M]);
        }
    }

    fn room(&mut self, from_m: f32, side: f32, chance: &mut Chance) {
        let (near, far) = (side * CORRIDOR_HALF_M, side * (CORRIDOR_HALF_M + DEPTH_M));
        let (to_m, door_m) = (from_m + ROOM_M, from_m + 0.5 * ROOM_M);
        self.wall([from_m, door_m - DOOR_HALF_M], [near; 2]);
        self.wall([door_m + DOOR_HALF_M, to_m], [near; 2]);
        self.wall([from_m, to_m], [far; 2]);
        self.wall([from_m; 2], [near, far]);
        self.wall([to_m; 2], [near, far]);
        self.rooms.push([door_m, side * (CORRIDOR_HALF_M + 0.5 * DEPTH_M)]);
        for corner in [from_m + 0.3, to_m - 1.7] {
            let across = side * (CORRIDOR_HALF_M + chance.between(0.4, DEPTH_M - 1.6));
            self.furniture([corner, across.min(across + side)], chance);
        }
        let cupboard = [from_m + 0.2, far - if side > 0.0 { 0.5 } else { -0.1 }];
        self.solid(cupboard, [chance.between(0.8, 2.0), 0.4], [0.0, 1.8]);
    }

    fn solid(&mut self, corner: [f32; 2], size: [f32; 2], heights: [f32; 2]) {
        self.cuboids.push(Cuboid {
            low: [corner[0], corner[1], heights[0]],
            high: [corner[0] + size[0], corner[1] + size[1], heights[1]],
        });
    }

    /// A table with thin top and legs, a shelf, or chairs.
    fn furniture(&mut self, corner: [f32; 2], chance: &mut Chance) {
        match chance.below(3) {
            0 => {
                self.solid(corner, [1.4, 0.8], [0.70, 0.74]);
                for [right, up] in [[0.0, 0.0], [1.35, 0.0], [0.0, 0.75], [1.35, 0.75]] {
                    self.solid([corner[0] + right, corner[1] + up], [0.05, 0.05], [0.0, 0.70]);
                }
            }
            1 => self.solid(corner, [1.2, 0.35], [0.0, chance.between(0.6, 1.9)]),
            _ => {
                for right in [0.0, 0.8] {
                    let seat = [corner[0] + right, corner[1]];
                    self.solid(seat, [0.45, 0.45], [0.40, 0.46]);
                    self.solid(seat, [0.45, 0.05], [0.0, 0.95]);
                }
            }
        }
    }

    /// The drive of a survey: along the corridor, into every room and out again.
    #[must_use]
    pub fn route(&self) -> Vec<[f32; 2]> {
        let mut route = vec![[1.0, 0.0]];
        for [x, y] in &self.rooms {
            route.extend([[*x, 0.0], [*x, *y], [*x, 0.0]]);
        }
        route.push([self.length_m - 1.0, 0.0]);
        route
    }
}
