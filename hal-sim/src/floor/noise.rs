//! Noise over the plane that needs no memory: the same place always has the same value.

/// Mixes a place and a seed into 32 bits (the finaliser of MurmurHash3, public domain).
pub(super) fn hash(x: i32, y: i32, seed: u32) -> u32 {
    let mut h = (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77) ^ seed;
    h ^= h >> 16;
    h = h.wrapping_mul(0x85eb_ca6b);
    h ^= h >> 13;
    h = h.wrapping_mul(0xc2b2_ae35);
    h ^ (h >> 16)
}

/// 0..1 for a cell.
pub(super) fn uniform(x: i32, y: i32, seed: u32) -> f32 {
    (hash(x, y, seed) >> 8) as f32 / 16_777_216.0
}

/// −1..1, smooth between the points of a grid of width 1.
pub(super) fn smooth(x: f32, y: f32, seed: u32) -> f32 {
    let (column, row) = (x.floor(), y.floor());
    let fade = |t: f32| t * t * (3.0 - 2.0 * t);
    let (u, v) = (fade(x - column), fade(y - row));
    let at = |dx: i32, dy: i32| uniform(column as i32 + dx, row as i32 + dy, seed);
    let upper = at(0, 0) + u * (at(1, 0) - at(0, 0));
    let lower = at(0, 1) + u * (at(1, 1) - at(0, 1));
    2.0 * (upper + v * (lower - upper)) - 1.0
}

/// Three octaves of [`smooth`], within −1..1.
pub(super) fn cloudy(x: f32, y: f32, seed: u32) -> f32 {
    (smooth(x, y, seed)
        + 0.5 * smooth(2.1 * x, 2.1 * y, seed ^ 0x55)
        + 0.25 * smooth(4.3 * x, 4.3 * y, seed ^ 0xaa))
        / 1.75
}
