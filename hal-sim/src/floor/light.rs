//! Light on the floor: lamps with their reflections, daylight, and shadows of people passing by.

use floorguard_types::geometry::Point2;
use floorguard_types::random::Pcg32;

/// Reflections below e⁻²⁵ are none.
const FAINTEST: f32 = 25.0 / 8.0;

/// A lamp under the ceiling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamp {
    /// Above this place.
    pub above_in_world: Point2,
    /// Metres above the floor.
    pub height_m: f32,
    /// Light on the floor straight below, 1 is a well-lit floor.
    pub power: f32,
}

/// A soft shadow that wanders, as a person's does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shadow {
    /// Its middle at time zero.
    pub start_in_world: Point2,
    /// Metres a second.
    pub velocity_mps: [f32; 2],
    /// Radius of the core and width of the rim, metres.
    pub radius_m: [f32; 2],
    /// Share of the lamps' light that it takes, 0..1.
    pub depth: f32,
}

/// All light of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lighting {
    /// Light from everywhere.
    pub ambient: f32,
    /// The lamps.
    pub lamps: Vec<Lamp>,
    /// The shadows.
    pub shadows: Vec<Shadow>,
    /// Sharpness of reflections: higher is smaller and brighter.
    pub sharpness: f32,
}

impl Lighting {
    /// Lamps in rows of 3.2 m at 2.5 to 3.5 m over the square of the given half side.
    pub fn random(half_side_m: f32, random: &mut Pcg32) -> Self {
        let (shift_x, shift_y) = (random.uniform_between(-1.6, 1.6), random.uniform_between(-1.6, 1.6));
        let height_m = random.uniform_between(2.5, 3.5);
        let rows = (half_side_m / 3.2).ceil() as i32 + 1;
        let lamps = (-rows..=rows).flat_map(|row| (-rows..=rows).map(move |column| (row, column)));
        let lamps = lamps.map(|(row, column)| Lamp {
            above_in_world: Point2 { x_m: 3.2 * column as f32 + shift_x, y_m: 3.2 * row as f32 + shift_y },
            height_m,
            power: random.uniform_between(0.35, 0.6),
        });
        Self { ambient: 0.35, lamps: lamps.collect(), shadows: Vec::new(), sharpness: 140.0 }
    }

    /// Adds the shadow of somebody who passes a place at a time.
    pub fn add_shadow(&mut self, near: Point2, at_s: f32, random: &mut Pcg32) {
        let (speed, heading) =
            (random.uniform_between(0.3, 1.2), random.uniform_between(0.0, core::f32::consts::TAU));
        let (sin, cos) = libm::sincosf(heading);
        let velocity_mps = [speed * cos, speed * sin];
        self.shadows.push(Shadow {
            start_in_world: Point2 {
                x_m: near.x_m - at_s * velocity_mps[0],
                y_m: near.y_m - at_s * velocity_mps[1],
            },
            velocity_mps,
            radius_m: [random.uniform_between(0.08, 0.25), random.uniform_between(0.05, 0.2)],
            depth: random.uniform_between(0.4, 0.8),
        });
    }

    /// Light that falls on a place of the floor.
    pub(super) fn falling(&self, (x, y): (f32, f32), at_s: f32) -> f32 {
        let lamps: f32 = self.lamps.iter().map(|lamp| lamp.falling((x, y))).sum();
        let free: f32 = self.shadows.iter().map(|shadow| 1.0 - shadow.cover((x, y), at_s)).product();
        self.ambient + lamps * free
    }

    /// Light that a mirror on the floor sends to the camera, for a unit ray from the camera to the place.
    pub(super) fn mirrored(&self, (x, y): (f32, f32), ray: [f32; 3]) -> f32 {
        let up = [ray[0], ray[1], -ray[2]];
        self.lamps.iter().map(|lamp| lamp.mirrored((x, y), up, self.sharpness)).sum()
    }
}

impl Lamp {
    fn falling(&self, (x, y): (f32, f32)) -> f32 {
        let (dx, dy) = (self.above_in_world.x_m - x, self.above_in_world.y_m - y);
        let squared = (dx * dx + dy * dy) / (self.height_m * self.height_m);
        // Cosine at the lamp and at the floor, and the square of the distance.
        self.power / ((1.0 + squared) * (1.0 + squared))
    }

    fn mirrored(&self, (x, y): (f32, f32), up: [f32; 3], sharpness: f32) -> f32 {
        let to = [self.above_in_world.x_m - x, self.above_in_world.y_m - y, self.height_m];
        let squared = to[0] * to[0] + to[1] * to[1] + to[2] * to[2];
        let along = to[0] * up[0] + to[1] * up[1] + to[2] * up[2];
        // Most lamps are nowhere near the mirrored ray, and what they would add is less than light can tell.
        let least = (1.0 - FAINTEST / sharpness).max(0.9);
        if along <= 0.0 || along * along < least * least * squared {
            return 0.0;
        }
        let cosine = along / squared.sqrt();
        self.power * libm::expf(sharpness * (cosine - 1.0) * 8.0) * 5.0
    }
}

impl Shadow {
    fn cover(&self, (x, y): (f32, f32), at_s: f32) -> f32 {
        let dx = x - self.start_in_world.x_m - at_s * self.velocity_mps[0];
        let dy = y - self.start_in_world.y_m - at_s * self.velocity_mps[1];
        let [core, rim] = self.radius_m;
        let outside = ((dx * dx + dy * dy).sqrt() - core) / rim;
        let part = (1.0 - outside).clamp(0.0, 1.0);
        self.depth * part * part * (3.0 - 2.0 * part)
    }
}
