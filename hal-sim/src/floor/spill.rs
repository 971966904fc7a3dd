//! One spot of dirt: where it lies, and what it does to the surface.

use floorguard_types::geometry::Point2;
use floorguard_types::random::Pcg32;

use super::kinds::DirtKind;
use super::noise::{cloudy, hash, smooth, uniform};
use super::texture::Surface;

/// A spot of dirt in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spill {
    /// What it is.
    pub kind: DirtKind,
    /// Its middle, in the world.
    pub centre_in_world: Point2,
    /// Half axes of the ellipse that its outline wobbles around, metres.
    pub radii_m: [f32; 2],
    /// Direction of the first axis, radians.
    pub heading_rad: f32,
    /// Its colour as linear reflectance (powder, crumbs) or transmission (liquid, stain).
    pub colour: [f32; 3],
    /// How strongly it covers, 0..1.
    pub strength: f32,
    /// Outline and grain.
    pub seed: u32,
}

/// Colours that such dirt has: coffee, ketchup, ink, cola; flour, dust, earth; bread, chips, chocolate.
fn palette(kind: DirtKind) -> [[f32; 3]; 4] {
    match kind {
        DirtKind::Liquid => [[0.55, 0.42, 0.30], [0.72, 0.72, 0.74], [0.62, 0.30, 0.25], [0.45, 0.36, 0.32]],
        DirtKind::Powder => [[0.80, 0.79, 0.76], [0.60, 0.55, 0.47], [0.24, 0.17, 0.11], [0.75, 0.60, 0.30]],
        DirtKind::Crumbs => [[0.55, 0.38, 0.18], [0.70, 0.52, 0.15], [0.10, 0.06, 0.04], [0.65, 0.60, 0.52]],
        DirtKind::Stain => [[0.60, 0.48, 0.38], [0.75, 0.50, 0.45], [0.62, 0.62, 0.60], [0.55, 0.60, 0.72]],
    }
}

impl Spill {
    /// A spot of 6 to 24 cm.
    pub fn random(kind: DirtKind, centre_in_world: Point2, random: &mut Pcg32) -> Self {
        let long_m = random.uniform_between(0.03, 0.12);
        let colours = palette(kind);
        let colour = colours[random.below(colours.len() as u32) as usize];
        Self {
            kind,
            centre_in_world,
            radii_m: [long_m, long_m * random.uniform_between(0.5, 1.0)],
            heading_rad: random.uniform_between(0.0, core::f32::consts::PI),
            colour,
            strength: random.uniform_between(0.5, 1.0),
            seed: random.next_u32(),
        }
    }

    /// Distance from the middle in units of the outline: below 1 is inside.
    #[must_use]
    pub fn place(&self, (x, y): (f32, f32)) -> f32 {
        let (dx, dy) = (x - self.centre_in_world.x_m, y - self.centre_in_world.y_m);
        let reach = 1.4 * self.radii_m[0].max(self.radii_m[1]);
        if dx * dx + dy * dy > reach * reach {
            return f32::INFINITY;
        }
        let (sin, cos) = libm::sincosf(self.heading_rad);
        let (u, v) = ((cos * dx + sin * dy) / self.radii_m[0], (cos * dy - sin * dx) / self.radii_m[1]);
        let wobble = 0.18 * smooth(1.7 * u + 7.0, 1.7 * v, self.seed);
        (u * u + v * v).sqrt() * (1.0 + wobble)
    }

    /// The surface under the spot, as it looks.
    pub(super) fn cover(&self, surface: Surface, (x, y): (f32, f32), place: f32) -> Surface {
        if place >= 1.0 {
            return surface;
        }
        let clouds = cloudy(x / 0.03, y / 0.03, self.seed);
        let edge = (1.0 - place).clamp(0.0, 1.0);
        match self.kind {
            DirtKind::Liquid => {
                let depth = self.strength * (0.6 + 0.4 * (edge / 0.3).min(1.0));
                let mut wet = surface.times(self.colour.map(|value| 1.0 - depth * (1.0 - value)));
                wet.gloss = wet.gloss.max(0.10);
                wet
            }
            DirtKind::Powder => {
                let grain = 0.5 + 0.5 * smooth(x / 0.002, y / 0.002, self.seed ^ 2);
                let veil = self.strength * (edge / 0.5).min(1.0) * (0.6 + 0.3 * clouds) * grain;
                let mut dull = surface.towards(self.colour, veil.clamp(0.0, 1.0));
                dull.gloss *= 1.0 - veil.clamp(0.0, 1.0);
                dull
            }
            DirtKind::Crumbs => self.crumbs(surface, (x, y)),
            DirtKind::Stain => {
                let tint = self.strength * (edge / 0.4).min(1.0) * (0.75 + 0.25 * clouds);
                let mut dry = surface.times(self.colour.map(|value| 1.0 - tint * (1.0 - value)));
                dry.gloss *= 0.7;
                dry
            }
        }
    }

    fn crumbs(&self, surface: Surface, (x, y): (f32, f32)) -> Surface {
        let cell = 0.008;
        let (column, row) = ((x / cell).floor() as i32, (y / cell).floor() as i32);
        for (dx, dy) in (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy))) {
            let (cx, cy) = (column + dx, row + dy);
            if uniform(cx, cy, self.seed) > 0.25 + 0.45 * self.strength {
                continue;
            }
            let (px, py) = (
                x / cell - cx as f32 - uniform(cx, cy, self.seed ^ 3),
                y / cell - cy as f32 - uniform(cx, cy, self.seed ^ 4),
            );
            let radius = 0.15 + 0.35 * uniform(cx, cy, self.seed ^ 5);
            if px * px + py * py < radius * radius {
                let shade = 0.7 + 0.6 * (hash(cx, cy, self.seed ^ 6) % 64) as f32 / 64.0;
                let mut crumb = surface.towards(self.colour.map(|value| value * shade), 0.95);
                crumb.gloss = 0.0;
                return crumb;
            }
        }
        surface
    }
}
