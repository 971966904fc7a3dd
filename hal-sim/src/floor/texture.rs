//! The surface of a clean floor: colour and gloss of every place.

use super::kinds::FloorKind;
use super::noise::{cloudy, hash, smooth, uniform};

/// Linear reflectance of red, green and blue, and the share of light that is mirrored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Surface {
    pub(super) colour: [f32; 3],
    pub(super) gloss: f32,
}

impl Surface {
    pub(super) fn times(mut self, factors: [f32; 3]) -> Self {
        self.colour.iter_mut().zip(factors).for_each(|(value, factor)| *value *= factor);
        self
    }

    /// Mixed with another colour.
    pub(super) fn towards(mut self, colour: [f32; 3], part: f32) -> Self {
        self.colour.iter_mut().zip(colour).for_each(|(value, other)| *value += part * (other - *value));
        self
    }
}

/// The surface at a place of the world, metres. `footprint_m` is what one pixel covers: finer lines fade.
pub(super) fn surface(kind: FloorKind, (x, y): (f32, f32), footprint_m: f32, seed: u32) -> Surface {
    match kind {
        FloorKind::Concrete => concrete(x, y, seed),
        FloorKind::Tiles => tiles(x, y, footprint_m, seed),
        FloorKind::Terrazzo => terrazzo(x, y, seed),
        FloorKind::Vinyl => vinyl(x, y, seed),
        FloorKind::Wood => wood(x, y, footprint_m, seed),
        FloorKind::Epoxy => epoxy(x, y, seed),
    }
}

fn grey(value: f32) -> [f32; 3] {
    [value; 3]
}

fn concrete(x: f32, y: f32, seed: u32) -> Surface {
    let clouds = 0.16 * cloudy(x / 0.45, y / 0.45, seed) + 0.08 * cloudy(x / 0.04, y / 0.04, seed ^ 1);
    let grain = 0.07 * smooth(x / 0.003, y / 0.003, seed ^ 2);
    let base = Surface { colour: [0.33, 0.32, 0.295], gloss: 0.02 };
    let cell = ((x / 0.02).floor() as i32, (y / 0.02).floor() as i32);
    let pore = uniform(cell.0, cell.1, seed ^ 3);
    // One cell of seven has a pore of a millimetre or two at a place of its own.
    let (px, py) = (uniform(cell.0, cell.1, seed ^ 4), uniform(cell.0, cell.1, seed ^ 5));
    let (dx, dy) = (x / 0.02 - cell.0 as f32 - px, y / 0.02 - cell.1 as f32 - py);
    let is_pore = pore < 0.14 && dx * dx + dy * dy < 0.012 * (0.4 + pore / 0.14);
    base.times(grey((1.0 + clouds + grain) * if is_pore { 0.62 } else { 1.0 }))
}

/// How much of a pixel a line along a grid takes, 0..1.
fn line(place: f32, width_m: f32, pitch_m: f32, footprint_m: f32) -> f32 {
    let from_line = (place - pitch_m * (place / pitch_m).round()).abs();
    ((0.5 * (width_m + footprint_m) - from_line) / footprint_m.max(1e-4))
        .clamp(0.0, (width_m / footprint_m).min(1.0))
}

fn tiles(x: f32, y: f32, footprint_m: f32, seed: u32) -> Surface {
    let size = 0.30;
    let cell = ((x / size + 0.5).floor() as i32, (y / size + 0.5).floor() as i32);
    let own = 1.0 + 0.07 * (uniform(cell.0, cell.1, seed) - 0.5);
    let mottled =
        0.035 * cloudy(x / 0.02, y / 0.02, seed ^ 6) + 0.02 * smooth(x / 0.003, y / 0.003, seed ^ 7);
    let tile = Surface { colour: [0.47, 0.43, 0.37], gloss: 0.06 }.times(grey(own + mottled));
    // Lines lie at whole multiples of the size, half a tile from the middles.
    let (gx, gy) = (x - 0.5 * size, y - 0.5 * size);
    let gap = line(gx, 0.005, size, footprint_m).max(line(gy, 0.005, size, footprint_m));
    let grout = 0.15 * (1.0 + 0.3 * cloudy(x / 0.05, y / 0.05, seed ^ 8));
    let mut surface = tile.towards([grout, 0.95 * grout, 0.9 * grout], gap);
    surface.gloss *= 1.0 - gap;
    surface
}

fn terrazzo(x: f32, y: f32, seed: u32) -> Surface {
    const CHIPS: [[f32; 3]; 4] =
        [[0.62, 0.60, 0.56], [0.20, 0.19, 0.18], [0.38, 0.30, 0.24], [0.45, 0.46, 0.47]];
    let cell = 0.013;
    let (column, row) = ((x / cell).floor() as i32, (y / cell).floor() as i32);
    let mut surface = Surface { colour: [0.46, 0.44, 0.41], gloss: 0.05 };
    for (dx, dy) in (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy))) {
        let (cx, cy) = (column + dx, row + dy);
        let centre = (uniform(cx, cy, seed), uniform(cx, cy, seed ^ 9));
        let (px, py) = (x / cell - cx as f32 - centre.0, y / cell - cy as f32 - centre.1);
        let radius = 0.15 + 0.35 * uniform(cx, cy, seed ^ 10);
        let stretch = 0.6 + 0.8 * uniform(cx, cy, seed ^ 11);
        if px * px * stretch + py * py / stretch < radius * radius && uniform(cx, cy, seed ^ 12) < 0.8 {
            surface.colour = CHIPS[hash(cx, cy, seed ^ 13) as usize % CHIPS.len()];
        }
    }
    surface.times(grey(1.0 + 0.04 * cloudy(x / 0.3, y / 0.3, seed ^ 14)))
}

fn vinyl(x: f32, y: f32, seed: u32) -> Surface {
    let flake = |size: f32, salt: u32| {
        let wobble = 0.4 * smooth(x / (2.0 * size), y / (2.0 * size), seed ^ salt);
        let (column, row) = ((x / size + wobble).floor() as i32, (y / (0.6 * size) - wobble).floor() as i32);
        uniform(column, row, seed ^ salt) - 0.5
    };
    let (large, small) = (flake(0.012, 15), flake(0.004, 16));
    let base = Surface { colour: [0.27, 0.31, 0.36], gloss: 0.04 };
    base.times([1.0 + 0.12 * large + 0.06 * small, 1.0 + 0.11 * large + 0.06 * small, 1.0 + 0.08 * large])
}

fn wood(x: f32, y: f32, footprint_m: f32, seed: u32) -> Surface {
    let (wide, long) = (0.09, 0.9);
    let row = (y / wide + 0.5).floor() as i32;
    let shift = long * uniform(row, 0, seed);
    let plank = ((x + shift) / long + 0.5).floor() as i32;
    let own = 1.0 + 0.22 * (uniform(plank, row, seed ^ 17) - 0.5);
    let salt = hash(plank, row, seed ^ 18);
    let grain = 0.12 * cloudy(x / 0.25, y / 0.006, salt) + 0.05 * smooth(x / 0.03, y / 0.0015, salt ^ 1);
    let base = Surface { colour: [0.44, 0.29, 0.17], gloss: 0.04 };
    let seams = line(y - 0.5 * wide, 0.0012, wide, footprint_m).max(line(
        x + shift - 0.5 * long,
        0.0012,
        long,
        footprint_m,
    ));
    base.times(grey(own + grain)).towards([0.08, 0.05, 0.03], seams)
}

fn epoxy(x: f32, y: f32, seed: u32) -> Surface {
    let base = Surface { colour: [0.26, 0.35, 0.31], gloss: 0.10 };
    base.times(grey(
        1.0 + 0.03 * cloudy(x / 0.6, y / 0.6, seed) + 0.012 * smooth(x / 0.004, y / 0.004, seed ^ 19),
    ))
}
