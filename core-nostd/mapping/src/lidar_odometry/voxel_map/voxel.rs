//! What a cube remembers of the returns in it.

use nalgebra::Vector3;

use super::plane::Plane;

/// Sums about the middle of the cube.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sums {
    pub(super) count: u16,
    /// The count when the plane was computed last.
    fitted: u16,
    pub(super) sum: Vector3<f32>,
    /// xx, xy, xz, yy, yz, zz.
    pub(super) square: [f32; 6],
}

/// Returns in a cube, and the plane through them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Voxel {
    pub(super) plane: Plane,
    pub(super) sums: Sums,
    /// The newest sweep that has returns in it.
    pub(super) seen: u32,
}

/// A plane needs so many returns.
const COUNT_LEAST: u16 = 5;

impl Voxel {
    /// Without returns.
    pub const EMPTY: Self = Self {
        plane: Plane::NONE,
        sums: Sums { count: 0, fitted: 0, sum: Vector3::new(0.0, 0.0, 0.0), square: [0.0; 6] },
        seen: 0,
    };

    /// How many returns it holds.
    #[must_use]
    pub const fn count(&self) -> u16 {
        self.sums.count
    }

    /// A return more, unless the cube has its `count_most`; the plane is computed again when the count has grown by half.
    /// `middle` is that of the cube.
    pub(super) fn add(
        &mut self,
        point: &Vector3<f32>,
        (middle, edge_m): (&Vector3<f32>, f32),
        count_most: u16,
    ) {
        let sums = &mut self.sums;
        if sums.count >= count_most {
            return;
        }
        let d = point - middle;
        sums.count = sums.count.saturating_add(1);
        sums.sum += d;
        let squares = [d.x * d.x, d.x * d.y, d.x * d.z, d.y * d.y, d.y * d.z, d.z * d.z];
        sums.square.iter_mut().zip(squares).for_each(|(sum, square)| *sum += square);
        let due = sums.fitted.saturating_add(sums.fitted / 2).max(COUNT_LEAST);
        if sums.count >= due || sums.count == count_most {
            sums.fitted = sums.count;
            self.plane = Plane::of(sums, middle, edge_m);
        }
    }
}
