//! The panoramic picture: from a ring around a mirror to a strip of azimuth and elevation.

use floorguard_types::geometry::{Point2, Point3, wrap_angle};
use floorguard_types::number::{nearest_f32, saturating_u32, saturating_usize};

use core::f32::consts::TAU;

/// Pixels of a strip, as a bound of loops.
const PIXELS_MAX: usize = 1 << 22;
/// Elevations of a calibrated mirror.
pub const MIRROR_STEPS: usize = 16;

/// Where the ring lies in the picture, and the size of the strip. Column 0 looks to `first_azimuth_rad`; columns run to the
/// left if `is_counter_clockwise`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PanoramaGeometry {
    /// Centre of the ring, pixels of the picture.
    pub centre_x: f32,
    /// See `centre_x`.
    pub centre_y: f32,
    /// Inner and outer radius, pixels.
    pub inner_radius: f32,
    /// See `inner_radius`.
    pub outer_radius: f32,
    /// Columns and rows of the strip.
    pub columns: u16,
    /// See `columns`.
    pub rows: u16,
    /// The upper row is the outer circle; otherwise the inner one.
    pub is_outer_up: bool,
    /// Azimuth of column 0 in the base frame, radians.
    pub first_azimuth_rad: f32,
    /// The azimuth grows with the column.
    pub is_counter_clockwise: bool,
    /// Height of the camera above the floor, metres.
    pub height_m: f32,
    /// How elevations lie on the strip.
    pub mirror: Mirror,
}

/// Elevations of rows, evenly spaced from the upper to the lower row; interpolated between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror {
    /// Radians, falling.
    pub elevations_rad: [f32; MIRROR_STEPS],
}

impl Mirror {
    /// Elevation falls evenly from the upper to the lower row. `None` unless it falls.
    #[must_use]
    pub fn linear(upper_rad: f32, lower_rad: f32) -> Option<Self> {
        let step = (lower_rad - upper_rad) / nearest_f32(MIRROR_STEPS - 1);
        let mut elevations_rad = [upper_rad; MIRROR_STEPS];
        for (index, elevation_rad) in elevations_rad.iter_mut().enumerate() {
            *elevation_rad = upper_rad + nearest_f32(index) * step;
        }
        Self { elevations_rad }.checked()
    }

    /// `None` unless all elevations are finite and fall.
    #[must_use]
    pub fn checked(self) -> Option<Self> {
        let falls =
            self.elevations_rad.windows(2).all(|pair| matches!(pair, [a, b] if a > b && b.is_finite()));
        (falls && self.elevations_rad.first().is_some_and(|first| first.is_finite())).then_some(self)
    }

    /// Elevations of a mirror that was calibrated: marks of known elevation and where they appeared on the strip. Between two marks
    /// the elevation falls evenly; beyond the first and the last as between the two nearest. `None` for fewer than two marks, marks
    /// that are not in order from the upper row downwards, and elevations that do not fall.
    ///
    /// ```
    /// use floorguard_mapping::sliding_window::{Mirror, MirrorMark};
    ///
    /// let mark = |part, elevation_rad| MirrorMark { part, elevation_rad };
    /// let mirror = Mirror::from_marks(&[mark(0.0, 0.6), mark(0.5, 0.1), mark(1.0, -0.7)]).unwrap();
    /// assert!((mirror.elevations_rad[15] + 0.7).abs() < 1.0e-6);
    /// assert_eq!(Mirror::from_marks(&[mark(0.2, 0.1), mark(0.4, 0.3)]), None);
    /// ```
    #[must_use]
    pub fn from_marks(marks: &[MirrorMark]) -> Option<Self> {
        let mut elevations_rad = [0.0; MIRROR_STEPS];
        for (step, elevation_rad) in elevations_rad.iter_mut().enumerate() {
            let part = nearest_f32(step) / nearest_f32(MIRROR_STEPS - 1);
            let behind = |pair: &&[MirrorMark]| matches!(pair, [_, to] if part <= to.part);
            let pair = marks.windows(2).find(behind).or_else(|| marks.windows(2).last());
            let [from, to] = pair? else { return None };
            // Not for what is not a number.
            let is_in_order = from.part < to.part;
            if !is_in_order {
                return None;
            }
            // Not divided by 0: ruled out above.
            let share = (part - from.part) / (to.part - from.part);
            *elevation_rad = from.elevation_rad + share * (to.elevation_rad - from.elevation_rad);
        }
        let is_in_order = marks.windows(2).all(|pair| matches!(pair, [a, b] if a.part < b.part));
        if is_in_order { Self { elevations_rad }.checked() } else { None }
    }

    /// Part of the strip from the upper row, 0…1; `None` above or below it.
    fn part_of(&self, elevation_rad: f32) -> Option<f32> {
        let steps = self.elevations_rad.windows(2).enumerate();
        let found = steps.filter_map(|(index, pair)| {
            let [upper, lower] = pair else { return None };
            let is_between = (*lower..=*upper).contains(&elevation_rad);
            // Elevations fall: never divided by 0.
            is_between.then(|| nearest_f32(index) + (upper - elevation_rad) / (upper - lower))
        });
        found.take(1).map(|steps| steps / nearest_f32(MIRROR_STEPS - 1)).next()
    }
}

/// A mark of known elevation on the strip.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MirrorMark {
    /// Where it appeared: part of the strip from the upper row, 0…1.
    pub part: f32,
    /// Its elevation from the camera, radians.
    pub elevation_rad: f32,
}

/// A pixel of the strip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StripPixel {
    /// From 0.
    pub column: usize,
    /// From 0, downwards.
    pub row: usize,
}

impl PanoramaGeometry {
    /// Where a pixel of the strip lies in the picture: x and y in pixels.
    #[must_use]
    pub fn source(&self, pixel: StripPixel) -> Point2 {
        let turn_rad = TAU * nearest_f32(pixel.column) / nearest_f32(self.columns.max(1));
        let down = nearest_f32(pixel.row) / nearest_f32(self.rows.max(1));
        let (upper, lower) = if self.is_outer_up {
            (self.outer_radius, self.inner_radius)
        } else {
            (self.inner_radius, self.outer_radius)
        };
        let radius = upper + (lower - upper) * down;
        let (sin, cos) = libm::sincosf(turn_rad);
        Point2::new(self.centre_x + radius * cos, self.centre_y + radius * sin)
    }

    /// Azimuth of a column in the base frame, radians.
    #[must_use]
    pub fn azimuth_rad(&self, column: usize) -> f32 {
        let turn_rad = TAU * nearest_f32(column) / nearest_f32(self.columns.max(1));
        let sign = if self.is_counter_clockwise { 1.0 } else { -1.0 };
        wrap_angle(self.first_azimuth_rad + sign * turn_rad)
    }

    /// The pixel that shows a point of the base frame: the colour of a cell. `None` above or below the strip, and for what is
    /// not finite.
    #[must_use]
    pub fn pixel_of(&self, point: Point3) -> Option<StripPixel> {
        let distance_m = Point2::new(point.x_m, point.y_m).norm();
        let azimuth_rad = libm::atan2f(point.y_m, point.x_m);
        let down = self.mirror.part_of(libm::atan2f(point.z_m - self.height_m, distance_m))?;
        let sign = if self.is_counter_clockwise { 1.0 } else { -1.0 };
        let turn = sign * (azimuth_rad - self.first_azimuth_rad) / TAU;
        if !turn.is_finite() {
            return None;
        }
        let columns = usize::from(self.columns.max(1));
        let nearest = saturating_usize(libm::roundf((turn - libm::floorf(turn)) * nearest_f32(columns)));
        let rows = usize::from(self.rows).saturating_sub(1);
        let row = saturating_usize(libm::roundf(down * nearest_f32(self.rows))).min(rows);
        Some(StripPixel { column: nearest % columns, row })
    }

    /// Writes for each pixel of the strip, row by row, the number of the nearest pixel of a picture of so many columns and
    /// rows; [`NO_SOURCE`] outside of it. Returns how many were written. Done once: dewarping is then one look-up a pixel.
    pub fn fill_table(&self, picture: PictureSize, table: &mut [u32]) -> usize {
        let columns = usize::from(self.columns).max(1);
        let pixels = columns.saturating_mul(usize::from(self.rows)).min(PIXELS_MAX);
        let mut written = 0_usize;
        for (number, entry) in table.iter_mut().enumerate().take(pixels) {
            let source = self.source(StripPixel { column: number % columns, row: number / columns });
            *entry = picture.number_of(source).unwrap_or(NO_SOURCE);
            written = written.saturating_add(1);
        }
        written
    }
}

/// An entry of a table whose source lies outside of the picture.
pub const NO_SOURCE: u32 = u32::MAX;

/// Columns and rows of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureSize {
    /// Pixels in a row.
    pub columns: u16,
    /// Rows.
    pub rows: u16,
}

impl PictureSize {
    fn number_of(self, source: Point2) -> Option<u32> {
        let (x, y) = (libm::roundf(source.x_m), libm::roundf(source.y_m));
        let is_inside = x >= 0.0 && y >= 0.0 && x < nearest_f32(self.columns) && y < nearest_f32(self.rows);
        is_inside.then(|| {
            saturating_u32(y).saturating_mul(u32::from(self.columns)).saturating_add(saturating_u32(x))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;
    use std::vec::Vec;

    fn geometry() -> PanoramaGeometry {
        PanoramaGeometry {
            centre_x: 320.0,
            centre_y: 240.0,
            inner_radius: 60.0,
            outer_radius: 220.0,
            columns: 720,
            rows: 160,
            is_outer_up: true,
            first_azimuth_rad: 0.3,
            is_counter_clockwise: false,
            height_m: 0.7,
            mirror: Mirror::linear(0.7, -0.7).unwrap(),
        }
    }

    /// Each pixel of the strip shows the direction that leads back to it.
    #[test]
    fn directions_and_pixels_agree() {
        let geometry = geometry();
        for column in (0..720).step_by(7) {
            for row in (1..160).step_by(9) {
                let azimuth = f64::from(geometry.azimuth_rad(column));
                let elevation = 0.7 - 1.4 * row as f64 / 160.0;
                let point = Point3::new(
                    (2.0 * azimuth.cos()) as f32,
                    (2.0 * azimuth.sin()) as f32,
                    (0.7 + 2.0 * elevation.tan()) as f32,
                );
                assert_eq!(geometry.pixel_of(point), Some(StripPixel { column, row }));
            }
        }
        assert_eq!(geometry.pixel_of(Point3::new(1.0, 0.0, 3.0)), None);
        assert_eq!(geometry.pixel_of(Point3::new(f32::NAN, 0.0, 0.7)), None);
    }

    /// A ring whose grey value is its radius becomes a strip whose grey value is its row.
    #[test]
    fn a_drawn_ring_becomes_a_strip() {
        let geometry = geometry();
        let (columns, rows) = (640_u16, 480_u16);
        let radius_of = |number: u32| {
            let (x, y) = (number % 640, number / 640);
            (f64::from(x) - 320.0).hypot(f64::from(y) - 240.0)
        };
        let mut table = vec![0_u32; 720 * 160];
        assert_eq!(geometry.fill_table(PictureSize { columns, rows }, &mut table), 720 * 160);
        for (number, entry) in table.iter().enumerate() {
            let expected = 220.0 - (number / 720) as f64;
            assert!((radius_of(*entry) - expected).abs() < 0.75, "pixel {number}");
        }
        let small = PictureSize { columns: 400, rows };
        geometry.fill_table(small, &mut table);
        assert!(table.contains(&NO_SOURCE));
    }

    /// A mirror whose elevation is bent by 0.07 rad in the middle: nine marks, against the straight line through its ends.
    #[test]
    fn marks_calibrate_a_bent_mirror() {
        let bent = |part: f32| 0.6 - 1.35 * (0.8 * part + 0.2 * part * part);
        let marks: Vec<MirrorMark> = (0..9_u8)
            .map(|mark| f32::from(mark) / 8.0)
            .map(|part| MirrorMark { part, elevation_rad: bent(part) })
            .collect();
        let worst = |mirror: Mirror| {
            let steps = mirror.elevations_rad.iter().enumerate();
            steps.map(|(step, found)| (found - bent(step as f32 / 15.0)).abs()).fold(0.0_f32, f32::max)
        };
        assert!(worst(Mirror::from_marks(&marks).unwrap()) < 0.002);
        assert!(worst(Mirror::linear(0.6, -0.75).unwrap()) > 0.06);
        assert_eq!((Mirror::from_marks(&marks[..1]), Mirror::from_marks(&[])), (None, None));
        let swapped = [marks[0], marks[2], marks[1], marks[3]];
        assert_eq!(Mirror::from_marks(&swapped), None);
        let nowhere = MirrorMark { part: f32::NAN, elevation_rad: 0.0 };
        assert_eq!(Mirror::from_marks(&[marks[0], nowhere]), None);
    }

    #[test]
    fn mirrors_fall() {
        assert_eq!(Mirror::linear(-0.1, 0.1), None);
        assert_eq!(Mirror::linear(f32::NAN, 0.1), None);
        let mut mirror = Mirror::linear(0.7, -0.7).unwrap();
        mirror.elevations_rad[5] = 0.7;
        assert_eq!(mirror.checked(), None);
    }
}
