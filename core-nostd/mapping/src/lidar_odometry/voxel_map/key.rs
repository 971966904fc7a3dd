//! Which cube a point lies in.

use floorguard_types::number::{saturating_i32, truncating_u64};
use nalgebra::Vector3;

/// Cubes of two sizes: small ones for what was seen from near, large ones for what was seen from far.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Small.
    Fine,
    /// Large.
    Coarse,
}

/// A cube: its indices along x, y and z (20 bits each: beyond ±524,288 cubes they wrap) and its level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VoxelKey(u64);

const INDEX_MASK: u64 = 0xF_FFFF;

impl VoxelKey {
    /// No cube: it has a bit that no cube has.
    pub const NONE: Self = Self(u64::MAX);

    /// The cube of an edge of `1 / per_m` metres in which a point lies.
    #[inline]
    #[must_use]
    pub fn of(point_in_map: &Vector3<f32>, per_m: f32, level: Level) -> Self {
        let index = |value: f32| truncating_u64(i64::from(floor(value * per_m))) & INDEX_MASK;
        let bits = index(point_in_map.x) | index(point_in_map.y) << 20 | index(point_in_map.z) << 40;
        Self(bits | if level == Level::Coarse { 1 << 60 } else { 0 })
    }

    /// The level; `None` of no cube.
    #[must_use]
    pub(super) fn level(self) -> Option<Level> {
        match self.0 >> 60 {
            0 => Some(Level::Fine),
            1 => Some(Level::Coarse),
            _ => None,
        }
    }

    /// Evenly spread over 32 bits (Fibonacci hashing: Knuth 1998, section 6.4).
    #[inline]
    #[must_use]
    pub(super) const fn hash(self) -> u64 {
        (self.0 ^ (self.0 >> 23)).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32
    }
}

/// Middle of the cube that a point lies in, metres.
#[must_use]
pub(super) fn middle_m(point_in_map: &Vector3<f32>, edge_m: f32) -> Vector3<f32> {
    let middle = |value: f32| {
        let index = floor(value / edge_m.max(1.0e-3));
        (floorguard_types::number::nearest_f32(index) + 0.5) * edge_m
    };
    point_in_map.map(middle)
}

/// Rounded down; saturates, 0 for a NaN.
#[inline]
fn floor(value: f32) -> i32 {
    let towards_zero = saturating_i32(value);
    if floorguard_types::number::nearest_f32(towards_zero) > value {
        towards_zero.saturating_sub(1)
    } else {
        towards_zero
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubes_meet_at_zero_without_a_gap() {
        let key = |x: f32| VoxelKey::of(&Vector3::new(x, 0.0, 0.0), 2.0, Level::Fine);
        assert_ne!(key(-0.1), key(0.1));
        assert_eq!(key(-0.1), key(-0.5));
        assert_ne!(key(-0.5), key(-0.51));
        assert_eq!(key(0.49), key(0.0));
        assert_eq!(middle_m(&Vector3::new(-0.1, 0.1, 0.6), 0.5), Vector3::new(-0.25, 0.25, 0.75));
        let point = Vector3::new(0.1, 0.1, 0.1);
        assert_ne!(VoxelKey::of(&point, 2.0, Level::Fine), VoxelKey::of(&point, 2.0, Level::Coarse));
    }
}
