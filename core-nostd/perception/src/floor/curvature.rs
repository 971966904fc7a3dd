//! A floor that is not quite plane: a second-order surface over the fitted plane, within the working range.
//!
//! Halls sag, cameras bend. Without the curvature a sag of 2 cm over 2 m would be an object; with too much of it an
//! object would be floor, so the coefficients are limited, and outside the part that was seen the surface continues
//! level. Source: book, Floor and dirt: Curvature.

use super::depth_noise::DepthNoise;
use super::lanes::{LaneSums, Lanes};
use super::lattice::{Lattice, LatticePoints};
use super::normal_equations::NormalEquations;
use super::plane::{Plane, dot};
use super::refine::height_variances_m2;

/// Largest coefficient, 1/m: 2 cm at 1 m (book, Floor and dirt: Curvature).
const COEFFICIENT_MAX_PER_M: f32 = 0.02;
/// A fit must cover this much along both axes, metres (book, Floor and dirt: Curvature).
const COVERAGE_MIN_M: f32 = 0.5;
/// Half width of the band around the plane, metres: the plane itself and the largest sag at 1 m.
const BAND_M: f32 = 0.03;
/// Fewest points for three coefficients.
const POINTS_MIN: f32 = 64.0;

/// Height of the floor over its plane, in coordinates of the plane: x across the view, y along it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curvature {
    /// Axes of the plane, in the camera frame.
    axes: [[f32; 3]; 2],
    /// Middle of the footprint, metres.
    centre_m: [f32; 2],
    /// Half of the sides of the footprint, metres.
    half_size_m: [f32; 2],
    /// Offset (m) and slopes over the plane.
    level: [f32; 3],
    /// Coefficients of x², x·y and y², 1/m; 0 where the floor is taken as plane.
    pub coefficients_per_m: [f32; 3],
}

impl Curvature {
    /// A plane floor.
    #[must_use]
    pub fn none(plane: &Plane) -> Self {
        Self {
            axes: plane.axes(),
            centre_m: [0.0; 2],
            half_size_m: [0.0; 2],
            level: [0.0; 3],
            coefficients_per_m: [0.0; 3],
        }
    }

    /// False for a plane floor.
    #[must_use]
    pub fn is_bent(&self) -> bool {
        self.coefficients_per_m.iter().any(|coefficient| *coefficient != 0.0)
    }

    /// Height of the floor over the plane below or above a point of the camera frame, metres.
    #[must_use]
    pub fn height_m(&self, point: [f32; 3]) -> f32 {
        let [across, along] = self.axes;
        self.surface_m(dot(across, point), dot(along, point))
    }

    /// The same for many points of one row of an image.
    pub(super) fn row(&self, ray_y: f32) -> CurvatureRow<'_> {
        let rays = self.axes.map(|[x, y, z]| [x, y * ray_y + z]);
        CurvatureRow { curvature: self, rays }
    }

    /// Height at a place along the axes; outside of the footprint that of its edge.
    #[inline]
    fn surface_m(&self, x: f32, y: f32) -> f32 {
        let ([cx, cy], [hx, hy]) = (self.centre_m, self.half_size_m);
        let ([c, sx, sy], [xx, xy, yy]) = (self.level, self.coefficients_per_m);
        let (x, y) = (within(x - cx, hx), within(y - cy, hy));
        c + x * (sx + xx * x + xy * y) + y * (sy + yy * y)
    }

    /// The surface of the points nearer than `range_m`; plane where they cover too little.
    pub(super) fn fit(lattice: &Lattice<'_>, noise: &DepthNoise, plane: &Plane, range_m: f32) -> Self {
        let mut surface = Self::none(plane);
        let floor = Selection { noise, plane, range_m };
        if !surface.cover(lattice, &floor) {
            return Self::none(plane);
        }
        let Some([of_xx, of_xy, of_yy, of_height]) = surface.explained(lattice, &floor) else {
            return Self::none(plane);
        };
        let Some(found) = surface.bend(lattice, &floor, [of_xx, of_xy, of_yy, of_height]) else {
            return Self::none(plane);
        };
        let [xx, xy, yy] = found.map(|value| value.clamp(-COEFFICIENT_MAX_PER_M, COEFFICIENT_MAX_PER_M));
        surface.coefficients_per_m = [xx, xy, yy];
        for (slot, (height, (of_xx, (of_xy, of_yy)))) in surface
            .level
            .iter_mut()
            .zip(of_height.into_iter().zip(of_xx.into_iter().zip(of_xy.into_iter().zip(of_yy))))
        {
            *slot = height - xx * of_xx - xy * of_xy - yy * of_yy;
        }
        surface
    }

    /// What offset and slopes explain of the three squares and of the heights. It is taken out of them first; what is
    /// left determines the coefficients exactly as the full system of six would (Frisch and Waugh 1933).
    fn explained(&self, lattice: &Lattice<'_>, floor: &Selection<'_>) -> Option<[[f32; 3]; 4]> {
        let mut sums = [0.0; 13];
        for row in lattice.rows() {
            let mut part = LaneSums::default();
            for points in row {
                let (weight, height) = floor.weights(&points);
                let (x, y) = self.coordinates(&points);
                let (wx, wy, wh) = (weight * x, weight * y, weight * height);
                let (wxx, wxy, wyy) = (wx * x, wx * y, wy * y);
                let thirds = [wxx * x, wxx * y, wxy * y, wyy * y];
                let [xxx, xxy, xyy, yyy] = thirds;
                part.take([weight, wx, wy, wxx, wxy, wyy, xxx, xxy, xyy, yyy, wh, wh * x, wh * y]);
            }
            part.pour_into(&mut sums);
        }
        let [w, x, y, xx, xy, yy, xxx, xxy, xyy, yyy, h, hx, hy] = sums;
        let explained = |right| NormalEquations::of_sums([w, x, y, xx, xy, yy], right).solve();
        Some([
            explained([xx, xxx, xxy])?,
            explained([xy, xxy, xyy])?,
            explained([yy, xyy, yyy])?,
            explained([h, hx, hy])?,
        ])
    }

    /// Coefficients from what offset and slopes leave.
    fn bend(
        &self,
        lattice: &Lattice<'_>,
        floor: &Selection<'_>,
        [of_xx, of_xy, of_yy, of_height]: [[f32; 3]; 4],
    ) -> Option<[f32; 3]> {
        let mut sums = [0.0; 9];
        for row in lattice.rows() {
            let mut part = LaneSums::default();
            for points in row {
                let (weight, height) = floor.weights(&points);
                let (x, y) = self.coordinates(&points);
                let left = |value: Lanes, [c, sx, sy]: [f32; 3]| value - (x * sx + y * sy + c);
                let (a, b) = (left(x * x, of_xx), left(x * y, of_xy));
                let (c, h) = (left(y * y, of_yy), left(height, of_height));
                let (wa, wb, wc) = (weight * a, weight * b, weight * c);
                part.take([wa * a, wa * b, wa * c, wb * b, wb * c, wc * c, wa * h, wb * h, wc * h]);
            }
            part.pour_into(&mut sums);
        }
        let [aa, ab, ac, bb, bc, cc, ah, bh, ch] = sums;
        NormalEquations::of_sums([aa, ab, ac, bb, bc, cc], [ah, bh, ch]).solve()
    }

    /// Takes the footprint of the points; false where it is too small.
    fn cover(&mut self, lattice: &Lattice<'_>, floor: &Selection<'_>) -> bool {
        let (mut low, mut high) = ([Lanes::all(f32::MAX); 2], [Lanes::all(f32::MIN); 2]);
        let mut count = [0.0];
        for row in lattice.rows() {
            let mut part = LaneSums::default();
            for points in row {
                let is_floor = floor.is_floor(&points);
                part.take([is_floor]);
                let (x, y) = self.coordinates(&points);
                // Far beyond all limits where there is no floor.
                let away = (Lanes::all(1.0) - is_floor) * 1.0e9;
                for ((low, high), value) in low.iter_mut().zip(&mut high).zip([x, y]) {
                    *low = low.smaller(value + away);
                    *high = high.larger(value - away);
                }
            }
            part.pour_into(&mut count);
        }
        let [lx, ly] = low.map(|low| low.0.into_iter().fold(f32::MAX, f32::min));
        let [hx, hy] = high.map(|high| high.0.into_iter().fold(f32::MIN, f32::max));
        self.centre_m = [0.5 * (lx + hx), 0.5 * (ly + hy)];
        self.half_size_m = [0.5 * (hx - lx), 0.5 * (hy - ly)];
        let [count] = count;
        count >= POINTS_MIN && self.half_size_m.iter().all(|half| 2.0 * half >= COVERAGE_MIN_M)
    }

    fn coordinates(&self, points: &LatticePoints) -> (Lanes, Lanes) {
        let ([across, along], [cx, cy]) = (self.axes, self.centre_m);
        (points.along_rays(across) * points.z + -cx, points.along_rays(along) * points.z + -cy)
    }
}

/// Between −half and half, by comparisons that compilers vectorise.
#[inline]
fn within(value: f32, half: f32) -> f32 {
    let value = if value < half { value } else { half };
    if value > -half { value } else { -half }
}

/// The surface under one row of an image.
pub(super) struct CurvatureRow<'a> {
    curvature: &'a Curvature,
    /// Along each axis: growth of a ray with its first component, and the rest of it.
    rays: [[f32; 2]; 2],
}

impl CurvatureRow<'_> {
    /// Height of the floor over the plane at a depth along a ray of the row, metres.
    #[inline]
    pub(super) fn height_m(&self, depth_m: f32, ray_x: f32) -> f32 {
        let [[ax, a], [lx, l]] = self.rays;
        self.curvature.surface_m(depth_m * (ax * ray_x + a), depth_m * (lx * ray_x + l))
    }
}

/// Which points are of the floor, and what they weigh.
struct Selection<'a> {
    noise: &'a DepthNoise,
    plane: &'a Plane,
    range_m: f32,
}

impl Selection<'_> {
    /// 1 for floor within the range, else 0.
    #[inline]
    fn is_floor(&self, points: &LatticePoints) -> Lanes {
        let height = points.along_rays(self.plane.normal) * points.z + self.plane.distance_m;
        let is_near = height.size().is_below(Lanes::all(BAND_M));
        is_near * points.z.is_below(Lanes::all(self.range_m)) * points.is_return
    }

    /// Weights, ≤ 1 and 0 for what is no floor: 1 mm² over 1 mm² plus the variance that its depth error gives the
    /// height; and the heights over the plane.
    #[inline]
    fn weights(&self, points: &LatticePoints) -> (Lanes, Lanes) {
        const SQUARE_MM: f32 = 1.0e-6;
        let along_rays = points.along_rays(self.plane.normal);
        let height = along_rays * points.z + self.plane.distance_m;
        let variance = height_variances_m2(self.noise, along_rays, points.z) + SQUARE_MM;
        let inverse = variance.inverse_root();
        (inverse * inverse * SQUARE_MM * self.is_floor(points), height)
    }
}
