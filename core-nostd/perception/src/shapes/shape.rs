//! The shape of a candidate, in numbers that do not tell where it stands.
//!
//! The published features (book, People: Published features) encode the position: a model learns the hall it was
//! trained in. Here every number is a length on the object itself, seen across the line of sight or along it, or a
//! share; counts of returns, which fall with the square of the distance, are divided by what a closed surface would
//! give.

use floorguard_types::geometry::Point3;
use floorguard_types::number::{nearest_f32, truncating_u32};

/// Numbers of the vector.
pub const SHAPE_FEATURES: usize = 24;
/// The vector, in the order of [`SHAPE_NAMES`].
pub type ShapeVector = [f32; SHAPE_FEATURES];

/// What each number is; metres unless it is a share or a slope.
pub const SHAPE_NAMES: [&str; SHAPE_FEATURES] = [
    "width at 0.1 m",
    "width at 0.4 m",
    "width at 0.7 m",
    "width at 1.0 m",
    "width at 1.3 m",
    "width at 1.6 m",
    "closed share below 0.7 m",
    "closed share above 0.7 m",
    "top",
    "bottom",
    "height",
    "width",
    "depth",
    "spread over width",
    "slope along the width",
    "roughness",
    "slope along the height",
    "bulge",
    "head width over width",
    "head width",
    "lean of the slices",
    "occluded",
    "widest slice",
    "closed share of the silhouette",
];

/// Lower borders of the slices above the floor, metres: foot, knee, hip, belly, chest, head.
const BORDERS_M: [f32; SLICES] = [0.1, 0.4, 0.7, 1.0, 1.3, 1.6];
const SLICES: usize = 6;
/// Slices below the hip.
const LEG_SLICES: usize = 2;
/// What a slice without returns is called: no width is negative.
const UNSEEN: f32 = -1.0;
/// Angle from column to column, radians (0.199° at 600 rpm).
const COLUMN_STEP: f32 = 0.003_47;
/// Angle from ring to ring of a VLP-16, radians.
const RING_STEP: f32 = 0.034_9;

/// A range of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Span {
    low: f32,
    high: f32,
}

impl Span {
    const EMPTY: Self = Self { low: f32::INFINITY, high: f32::NEG_INFINITY };

    fn include(&mut self, value: f32) {
        self.low = self.low.min(value);
        self.high = self.high.max(value);
    }

    fn width(&self) -> f32 {
        (self.high - self.low).max(0.0)
    }
}

/// Returns between two heights.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Slice {
    across: Span,
    along_sum: f32,
    count: f32,
    rings: u32,
}

impl Slice {
    const EMPTY: Self = Self { across: Span::EMPTY, along_sum: 0.0, count: 0.0, rings: 0 };
}

/// A mean in the making.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Mean {
    sum: f32,
    count: f32,
}

impl Mean {
    fn add(&mut self, value: f32) {
        self.sum += value;
        self.count += 1.0;
    }

    fn value(&self) -> f32 {
        self.sum / self.count.max(1.0)
    }
}

/// Gathers the returns of one candidate; constant memory, one pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeBuilder {
    /// Unit vector of the line of sight on the floor.
    sight: [f32; 2],
    centre: Point3,
    distance_m: f32,
    top_m: f32,
    bottom_m: f32,
    slices: [Slice; SLICES],
    across: Span,
    along: Span,
    head: Span,
    /// Sums of a, l, a², a·l, l², z, z², l·z with a across and l along the line of sight.
    sums: [f32; 8],
    returns: f32,
    middle: Mean,
    sides: Mean,
}

/// Above the floor, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heights {
    /// Of the lowest return.
    pub bottom_m: f32,
    /// Of the highest.
    pub top_m: f32,
}

impl ShapeBuilder {
    /// For a candidate around `centre` (robot's frame, z above the floor) between two heights, seen from `sensor`.
    #[must_use]
    pub fn new(sensor: Point3, centre: Point3, heights: Heights) -> Self {
        let Heights { bottom_m, top_m } = heights;
        let (dx, dy) = (centre.x_m - sensor.x_m, centre.y_m - sensor.y_m);
        let distance_m = libm::sqrtf(dx * dx + dy * dy).max(0.1);
        Self {
            sight: [dx / distance_m, dy / distance_m],
            centre,
            distance_m,
            top_m,
            bottom_m,
            slices: [Slice::EMPTY; SLICES],
            across: Span::EMPTY,
            along: Span::EMPTY,
            head: Span::EMPTY,
            sums: [0.0; 8],
            returns: 0.0,
            middle: Mean::default(),
            sides: Mean::default(),
        }
    }

    /// Takes in a return of the candidate, measured by a ring.
    pub fn add(&mut self, point: Point3, ring: usize) {
        let (dx, dy) = (point.x_m - self.centre.x_m, point.y_m - self.centre.y_m);
        let [sx, sy] = self.sight;
        let (along, across, z) = (dx * sx + dy * sy, dy * sx - dx * sy, point.z_m);
        self.returns += 1.0;
        self.across.include(across);
        self.along.include(along);
        if z > self.top_m - HEAD_M {
            self.head.include(across);
        }
        // The highest border below the point. Not from the top down: a reversed `zip` can panic.
        let mut above = None;
        for (slice, border_m) in self.slices.iter_mut().zip(BORDERS_M) {
            if z >= border_m {
                above = Some(slice);
            }
        }
        if let Some(slice) = above {
            slice.across.include(across);
            slice.along_sum += along;
            slice.count += 1.0;
            slice.rings |= 1_u32.wrapping_shl(truncating_u32(ring));
        }
        let terms = [across, along, across * across, across * along, along * along, z, z * z, along * z];
        for (sum, term) in self.sums.iter_mut().zip(terms) {
            *sum += term;
        }
        if across.abs() < MIDDLE_M {
            self.middle.add(along);
        } else if across.abs() > SIDES_M {
            self.sides.add(along);
        }
    }

    /// The vector; `occluded` says that something nearer hides an edge.
    #[must_use]
    pub fn finish(&self, occluded: bool) -> ShapeVector {
        let beam_m = COLUMN_STEP * self.distance_m;
        let width_m = self.across.width() + beam_m;
        let height_m = self.top_m - self.bottom_m;
        let widths =
            self.slices.map(|slice| if slice.count >= 2.0 { slice.across.width() + beam_m } else { UNSEEN });
        let [foot, knee, hip, belly, chest, brow] = widths;
        let widest_m = widths.iter().fold(0.0_f32, |most, width| most.max(*width));
        let (legs, trunk) = self.slices.split_at(LEG_SLICES);
        let (spread_m, slope, roughness_m, tilt) = self.surface();
        let bulge_m = if self.middle.count > 0.0 && self.sides.count > 0.0 {
            self.sides.value() - self.middle.value()
        } else {
            0.0
        };
        let head_m = self.head.width() + beam_m;
        let silhouette_m2 = width_m * (height_m + RING_STEP * self.distance_m);
        let closed = self.returns * beam_m * RING_STEP * self.distance_m / silhouette_m2.max(1.0e-3);
        [
            foot,
            knee,
            hip,
            belly,
            chest,
            brow,
            closed_share(legs, beam_m),
            closed_share(trunk, beam_m),
            self.top_m,
            self.bottom_m.max(0.0),
            height_m,
            width_m,
            self.along.width(),
            spread_m / width_m.max(1.0e-3),
            slope,
            roughness_m,
            tilt,
            bulge_m,
            head_m / width_m.max(1.0e-3),
            head_m,
            self.lean_m(),
            f32::from(u8::from(occluded)),
            widest_m,
            closed,
        ]
    }

    /// Spread across, and the surface as a straight line over the width: its slope, what is left beside it, and its
    /// slope over the height.
    fn surface(&self) -> (f32, f32, f32, f32) {
        let count = self.returns.max(1.0);
        let [a, l, aa, al, ll, z, zz, lz] = self.sums.map(|sum| sum / count);
        let (across2, mixed, along2) = ((aa - a * a).max(0.0), al - a * l, (ll - l * l).max(0.0));
        let (height2, leaning) = ((zz - z * z).max(0.0), lz - l * z);
        let slope = mixed / across2.max(1.0e-5);
        let left_over = (along2 - slope * mixed).max(0.0);
        (libm::sqrtf(across2), slope.abs(), libm::sqrtf(left_over), leaning / height2.max(1.0e-4))
    }

    /// How far the slices stand before and behind each other, metres: a post is straight, a walker is not.
    fn lean_m(&self) -> f32 {
        let (mut count, mut sum, mut squares) = (0.0_f32, 0.0_f32, 0.0_f32);
        for slice in self.slices.iter().filter(|slice| slice.count >= 2.0) {
            let mean = slice.along_sum / slice.count;
            (count, sum, squares) = (count + 1.0, sum + mean, squares + mean * mean);
        }
        let mean = sum / count.max(1.0);
        libm::sqrtf((squares / count.max(1.0) - mean * mean).max(0.0))
    }
}

/// Share of the width that returns cover, over the rings of some slices; [`UNSEEN`] without a return.
fn closed_share(slices: &[Slice], beam_m: f32) -> f32 {
    let (mut covered_m, mut open_m) = (0.0_f32, 0.0_f32);
    for slice in slices.iter().filter(|slice| slice.count >= 2.0) {
        covered_m += slice.count * beam_m;
        open_m += nearest_f32(slice.rings.count_ones()) * (slice.across.width() + beam_m);
    }
    if open_m > 0.0 { covered_m / open_m } else { UNSEEN }
}

/// Height of a head, metres.
const HEAD_M: f32 = 0.25;
/// Half the breadth of the middle of a body, and where its sides begin, metres.
const MIDDLE_M: f32 = 0.08;
const SIDES_M: f32 = 0.13;

#[cfg(test)]
mod tests {
    use super::*;

    /// A plate of 0.5 × 1.7 m at a distance, as a VLP-16 0.8 m above the floor samples it.
    fn plate(distance_m: f32) -> ShapeVector {
        let sensor = Point3::new(0.0, 0.0, 0.8);
        let mut builder = ShapeBuilder::new(
            sensor,
            Point3::new(distance_m, 0.0, 0.8),
            Heights { bottom_m: 0.0, top_m: 1.7 },
        );
        for ring in 0..16_u8 {
            let z = 0.8 + distance_m * libm::tanf((-15.0 + 2.0 * f32::from(ring)).to_radians());
            for column in -200..=200_i16 {
                let y = distance_m * f32::from(column) * COLUMN_STEP;
                if y.abs() <= 0.25 && (0.1..=1.7).contains(&z) {
                    builder.add(Point3::new(distance_m, y, z), usize::from(ring));
                }
            }
        }
        builder.finish(false)
    }

    #[test]
    fn features_are_equal_at_every_distance() {
        let (near, far) = (plate(4.0), plate(9.0));
        for (index, (a, b)) in near.iter().zip(far).enumerate() {
            let same = (a - b).abs() < 0.1 + 0.1 * a.abs() || b == UNSEEN;
            assert!(same, "{}: {a} at 4 m, {b} at 9 m", SHAPE_NAMES[index]);
        }
        assert!((near[11] - 0.5).abs() < 0.03 && near[15] < 0.01 && near[17].abs() < 0.01, "{near:?}");
    }

    #[test]
    fn round_body_bulges_two_legs_stay_open() {
        let sensor = Point3::new(0.0, 0.0, 0.8);
        let mut builder =
            ShapeBuilder::new(sensor, Point3::new(4.0, 0.0, 0.8), Heights { bottom_m: 0.1, top_m: 1.5 });
        for step in -12..=12_i8 {
            let y = f32::from(step) * 0.0139;
            let x = 4.0 - libm::sqrtf((0.2 * 0.2 - y * y).max(0.0)) + 0.1;
            builder.add(Point3::new(x, y, 1.2), 9);
            if y.abs() > 0.08 {
                builder.add(Point3::new(4.0, y, 0.3), 4);
            }
        }
        let shape = builder.finish(false);
        assert!(shape[17] > 0.03, "bulge {}", shape[17]);
        assert!(shape[6] < 0.7 && shape[7] > 0.9, "closed {} {}", shape[6], shape[7]);
    }
}
