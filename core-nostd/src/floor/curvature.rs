//! A floor that is not quite plane: a second-order surface over the fitted plane, within the working range.
//!
//! Halls sag, cameras bend. Without the curvature a sag of 2 cm over 2 m would be an object; with too much of it an
//! object would be floor, so the coefficients are limited, and outside the part that was seen the surface continues
//! level. Source: algorithms E.2 steps 4 and 6.

use super::depth_noise::DepthNoise;
use super::lattice::Lattice;
use super::normal_equations::NormalEquations;
use super::plane::{Plane, dot};
use super::refine::height_variance_m2;

/// Largest coefficient, 1/m: 2 cm at 1 m (algorithms E.2).
const COEFFICIENT_MAX_PER_M: f32 = 0.02;
/// A fit must cover this much along both axes, metres (algorithms E.2 step 6).
const COVERAGE_MIN_M: f32 = 0.5;
/// Half width of the band around the plane, metres: the plane itself and the largest sag at 1 m.
const BAND_M: f32 = 0.03;
/// Fewest points for three coefficients.
const POINTS_MIN: u32 = 64;

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
    #[inline]
    #[must_use]
    pub fn height_m(&self, point: [f32; 3]) -> f32 {
        let ([across, along], [cx, cy], [hx, hy]) = (self.axes, self.centre_m, self.half_size_m);
        let x = (dot(across, point) - cx).max(-hx).min(hx);
        let y = (dot(along, point) - cy).max(-hy).min(hy);
        self.surface_m(x, y)
    }

    #[inline]
    fn surface_m(&self, x: f32, y: f32) -> f32 {
        let ([c, sx, sy], [xx, xy, yy]) = (self.level, self.coefficients_per_m);
        c + x * (sx + xx * x + xy * y) + y * (sy + yy * y)
    }

    /// The surface of the points nearer than `range_m`; plane where they cover too little.
    pub(super) fn fit(lattice: &Lattice<'_>, noise: &DepthNoise, plane: &Plane, range_m: f32) -> Self {
        let floor_points = || {
            lattice.rows(0.0).flatten().filter(move |point| {
                let [_, _, z] = *point;
                z < range_m && plane.height_m(*point).abs() < BAND_M
            })
        };
        let mut surface = Self::none(plane);
        if !surface.cover(floor_points()) {
            return Self::none(plane);
        }
        // What offset and slopes can explain is taken out of the heights and of the three squares first; what is left
        // of them determines the coefficients exactly as the full system of six would (Frisch and Waugh 1933).
        let mut linear = [NormalEquations::default(); 4];
        for point in floor_points() {
            let (x, y) = surface.coordinates(point);
            let weight = weight(noise, plane, point);
            for (system, value) in linear.iter_mut().zip([x * x, x * y, y * y, plane.height_m(point)]) {
                system.add(weight, [1.0, x, y], value);
            }
        }
        let [Some(of_xx), Some(of_xy), Some(of_yy), Some(of_height)] = linear.map(|system| system.solve())
        else {
            return Self::none(plane);
        };
        let mut bend = NormalEquations::default();
        for point in floor_points() {
            let (x, y) = surface.coordinates(point);
            let left = |value: f32, explained: [f32; 3]| value - dot(explained, [1.0, x, y]);
            let squares = [left(x * x, of_xx), left(x * y, of_xy), left(y * y, of_yy)];
            bend.add(weight(noise, plane, point), squares, left(plane.height_m(point), of_height));
        }
        let Some(found) = bend.solve() else { return Self::none(plane) };
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

    /// Takes the footprint of the points; false where it is too small.
    fn cover(&mut self, points: impl Iterator<Item = [f32; 3]>) -> bool {
        let [across, along] = self.axes;
        let (mut low, mut high, mut count) = ([f32::MAX; 2], [f32::MIN; 2], 0_u32);
        for point in points {
            let place = [dot(across, point), dot(along, point)];
            count = count.saturating_add(1);
            for ((low, high), value) in low.iter_mut().zip(&mut high).zip(place) {
                *low = low.min(value);
                *high = high.max(value);
            }
        }
        let ([lx, ly], [hx, hy]) = (low, high);
        self.centre_m = [0.5 * (lx + hx), 0.5 * (ly + hy)];
        self.half_size_m = [0.5 * (hx - lx), 0.5 * (hy - ly)];
        count >= POINTS_MIN && self.half_size_m.iter().all(|half| 2.0 * half >= COVERAGE_MIN_M)
    }

    fn coordinates(&self, point: [f32; 3]) -> (f32, f32) {
        let ([across, along], [cx, cy]) = (self.axes, self.centre_m);
        (dot(across, point) - cx, dot(along, point) - cy)
    }
}

/// Weight of a floor point, ≤ 1: 1 mm² over 1 mm² plus the variance that its depth error gives its height.
fn weight(noise: &DepthNoise, plane: &Plane, point: [f32; 3]) -> f32 {
    const SQUARE_MM: f32 = 1.0e-6;
    SQUARE_MM / (height_variance_m2(noise, plane, point) + SQUARE_MM)
}
