//! In which ring and how far along it a point lies.

use floorguard_types::capacities::SWEEP_RINGS;
use floorguard_types::number::{count_f32, nearest_f32, saturating_u16};
use floorguard_types::units::radians;

use super::packet::Point;

/// The sensor's beams look no lower, thousandths of a degree (maker's manual: −7° to 52°).
pub const LOWEST_MDEG: i32 = -7_000;
/// And no higher.
pub const HIGHEST_MDEG: i32 = 52_000;
/// Rings where the robot's file names none, thousandths of a degree: 2° apart from the lowest on, as those of a VLP-16 are.
pub const DEFAULT_ELEVATIONS_MDEG: [i32; SWEEP_RINGS] = [
    -6_000, -4_000, -2_000, 0, 2_000, 4_000, 6_000, 8_000, 10_000, 12_000, 14_000, 16_000, 18_000, 20_000,
    22_000, 24_000,
];
/// Millimetres a count of range.
pub(super) const UNIT_MM: u8 = 4;
/// Nearer than this to the axis a point has no azimuth worth the name, millimetres.
const AXIS_MM: f32 = 20.0;

/// One ring.
#[derive(Clone, Copy, Debug, Default)]
struct Ring {
    /// Slopes (height by distance in the plane) between which a point belongs to it.
    slopes: [f32; 2],
    /// Counts of range along the ring for a millimetre in the plane.
    counts_per_mm: f32,
}

/// A point as a cell of a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placed {
    /// Clockwise seen from above, hundredths of a degree, 0…36,000.
    pub azimuth_cdeg: f32,
    /// 0 is the lowest.
    pub ring: usize,
    /// Counts of [`UNIT_MM`] along the ring.
    pub range_raw: u16,
}

/// The rings.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rings {
    rings: [Ring; SWEEP_RINGS],
}

impl Rings {
    /// Rings of these elevations, thousandths of a degree, rising: each takes the points that are nearer to it than to its
    /// neighbours, the outer ones as far outwards as inwards.
    pub fn new(elevations_mdeg: &[i32; SWEEP_RINGS]) -> Self {
        let deg = |index: usize| {
            let mdeg = elevations_mdeg.get(index).copied().unwrap_or(0);
            nearest_f32(mdeg) * 1.0e-3
        };
        let mut rings = [Ring::default(); SWEEP_RINGS];
        for (index, ring) in rings.iter_mut().enumerate() {
            let own = deg(index);
            let below = index.checked_sub(1).map(|below| own - deg(below));
            let above = (index < SWEEP_RINGS - 1).then(|| deg(index.saturating_add(1)) - own);
            let half = |gap: Option<f32>, other: Option<f32>| 0.5 * gap.or(other).unwrap_or(0.0);
            let slopes = [own - half(below, above), own + half(above, below)];
            *ring = Ring {
                slopes: slopes.map(|edge| libm::tanf(radians(edge))),
                counts_per_mm: 1.0 / (f32::from(UNIT_MM) * libm::cosf(radians(own)).max(0.01)),
            };
        }
        Self { rings }
    }

    /// Where a point belongs; `None` if nothing came back, or it lies between no two rings. The distance in the plane is that of
    /// the point, so that its height is off by at most half the gap between two rings.
    pub fn place(&self, point: &Point) -> Option<Placed> {
        let [x, y, z] = point.at_mm;
        let plane_mm = libm::sqrtf(x * x + y * y);
        if plane_mm < AXIS_MM {
            return None;
        }
        let slope = z / plane_mm;
        let holds = |ring: &Ring| {
            let [low, high] = ring.slopes;
            (low..high).contains(&slope)
        };
        let number = self.rings.iter().position(holds)?;
        let ring = self.rings.get(number)?;
        let range_raw = saturating_u16(libm::roundf(plane_mm * ring.counts_per_mm)).max(1);
        let turned_cdeg = libm::atan2f(-y, x) * (18_000.0 / core::f32::consts::PI);
        let azimuth_cdeg = if turned_cdeg < 0.0 { turned_cdeg + 36_000.0 } else { turned_cdeg };
        Some(Placed { azimuth_cdeg, ring: number, range_raw })
    }
}

/// The column of an azimuth, of so many a turn.
pub(super) fn column_of(azimuth_cdeg: f32, columns: usize) -> usize {
    let column = saturating_u16(azimuth_cdeg * (count_f32(columns) / 36_000.0));
    usize::from(column).min(columns.saturating_sub(1))
}
