//! Scans that are kept for later, in a few bytes a beam.

use floorguard_types::geometry::Point2;

use crate::input::ScanRecord;
use crate::saved::{Reading, Saving};
use crate::se2::Se2;

/// Ranges as they were, to the bit.
#[derive(Clone, Debug, PartialEq)]
enum Ranges {
    /// Whole millimetres: `n / 1000`, as the text of a log gives them.
    Thousandths(Box<[u16]>),
    /// The same as `n × 0.001`, as our drivers give them.
    TimesThousandth(Box<[u16]>),
    /// Any others, metres.
    Metres(Box<[f32]>),
}

/// A scan whose believed returns come out again as they went in, to the bit.
#[derive(Clone, Debug, PartialEq)]
pub struct PackedScan {
    first_angle_rad: f32,
    step_rad: f32,
    between_s: f32,
    motion: Se2,
    ranges: Ranges,
}

/// Stands for a range that is not believed.
const NOTHING: u16 = u16::MAX;

fn by_division(value: u16) -> f32 {
    f32::from(value) / 1_000.0
}

fn by_product(value: u16) -> f32 {
    f32::from(value) * 1.0e-3
}

/// `None` if a range is lost by it.
fn packed(ranges_m: &[f32], metres: fn(u16) -> f32) -> Option<Box<[u16]>> {
    let pack = |range_m: &f32| {
        // Saturates; what is not finite was left out before.
        let value = (range_m * 1_000.0).round() as u16;
        let is_kept = value != NOTHING && metres(value).to_bits() == range_m.to_bits();
        if range_m.is_infinite() { Some(NOTHING) } else { is_kept.then_some(value) }
    };
    ranges_m.iter().map(pack).collect()
}

fn unpacked(values: &[u16], metres: fn(u16) -> f32) -> Vec<f32> {
    values.iter().map(|value| if *value == NOTHING { f32::INFINITY } else { metres(*value) }).collect()
}

impl PackedScan {
    /// Of a scan, seen in a motion; ranges outside of these bounds are lost.
    #[must_use]
    pub fn new(record: &ScanRecord, [least_m, most_m]: [f32; 2], motion: Se2) -> Self {
        let believed = |range_m: &f32| {
            if (least_m..=most_m).contains(range_m) { *range_m } else { f32::INFINITY }
        };
        let ranges_m: Vec<f32> = record.ranges_m.iter().map(believed).collect();
        let ranges = packed(&ranges_m, by_division)
            .map(Ranges::Thousandths)
            .or_else(|| packed(&ranges_m, by_product).map(Ranges::TimesThousandth))
            .unwrap_or_else(|| Ranges::Metres(ranges_m.into_boxed_slice()));
        let ScanRecord { first_angle_rad, step_rad, between_s, .. } = *record;
        Self { first_angle_rad, step_rad, between_s, motion, ranges }
    }

    /// The believed returns, in the scanner's frame, in the order of the beams.
    #[must_use]
    pub fn points(&self) -> Vec<Point2> {
        let ranges_m = match &self.ranges {
            Ranges::Thousandths(values) => unpacked(values, by_division),
            Ranges::TimesThousandth(values) => unpacked(values, by_product),
            Ranges::Metres(ranges_m) => ranges_m.to_vec(),
        };
        let Self { first_angle_rad, step_rad, between_s, motion, .. } = *self;
        let record = ScanRecord { first_angle_rad, step_rad, ranges_m, between_s, ..ScanRecord::default() };
        record.points_in_motion(0.0, f32::MAX, motion)
    }

    pub(super) fn save(&self, to: &mut Saving<'_>) {
        [self.first_angle_rad, self.step_rad, self.between_s].into_iter().for_each(|value| to.single(value));
        to.pose(self.motion);
        match &self.ranges {
            Ranges::Thousandths(values) => to.halves(0, values),
            Ranges::TimesThousandth(values) => to.halves(1, values),
            Ranges::Metres(ranges_m) => {
                to.count(2);
                to.count(ranges_m.len());
                ranges_m.iter().for_each(|range_m| to.single(*range_m));
            }
        }
    }

    pub(super) fn read(from: &mut Reading<'_>) -> Option<Self> {
        let (first_angle_rad, step_rad, between_s) = (from.single()?, from.single()?, from.single()?);
        let motion = from.pose()?;
        let ranges = match from.count()? {
            0 => Ranges::Thousandths(from.all(Reading::half)?.into()),
            1 => Ranges::TimesThousandth(from.all(Reading::half)?.into()),
            _ => Ranges::Metres(from.all(Reading::single)?.into()),
        };
        Some(Self { first_angle_rad, step_rad, between_s, motion, ranges })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn returns_come_out_to_the_bit() {
        let motion = Se2::new(0.8, 0.1, 1.2);
        let ranges: [fn(u16) -> f32; 3] =
            [by_division, by_product, |value| f32::from(value) * 0.001_234_5 + 0.01];
        for (kind, range) in ranges.into_iter().enumerate() {
            let mut ranges_m: Vec<f32> = (0..400).map(|beam| range(97 * beam)).collect();
            (ranges_m[7], ranges_m[9], ranges_m[11]) = (f32::NAN, f32::INFINITY, -2.0);
            let record = ScanRecord {
                first_angle_rad: -1.5,
                step_rad: 0.008,
                between_s: 5.0e-5,
                ranges_m,
                ..ScanRecord::default()
            };
            let packed = PackedScan::new(&record, [0.1, 30.0], motion);
            let size = match &packed.ranges {
                Ranges::Thousandths(values) | Ranges::TimesThousandth(values) => size_of_val(&**values),
                Ranges::Metres(values) => size_of_val(&**values),
            };
            assert_eq!(size, if kind < 2 { 800 } else { 1_600 });
            let points = record.points_in_motion(0.1, 30.0, motion);
            assert!(points.len() > 200 && packed.points() == points, "{kind}");
        }
    }
}
