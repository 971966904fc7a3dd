//! Scans that are kept for later, in a few bytes a beam.

use floorguard_types::geometry::Point2;

use crate::input::ScanRecord;
use crate::saved::{Reading, Saving};
use crate::se2::Se2;

/// What the numbers of the ranges are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Unit {
    /// Whole millimetres: `n / 1000`, as the text of a log gives them.
    Thousandths,
    /// The same as `n × 0.001`, as our drivers give them.
    TimesThousandth,
    /// Any others: the bits of the metres, four bytes a beam.
    Metres,
}

/// A scan whose believed returns come out again as they went in, to the bit. Along a wall a range differs little from the one
/// before: most of them take a byte.
#[derive(Clone, Debug, PartialEq)]
pub struct PackedScan {
    /// The unit, how the scan was measured, and its ranges.
    bytes: Box<[u8]>,
}

/// A byte for a range that is not believed...
const NOTHING: u8 = 254;
/// ... and one before a range that is written out. All smaller ones are differences, from −127 on.
const WHOLE: u8 = 255;
const LEAST: i32 = -127;

impl Unit {
    const ALL: [Self; 3] = [Self::Thousandths, Self::TimesThousandth, Self::Metres];

    /// `None` if the range is lost by it.
    fn number(self, range_m: f32) -> Option<u16> {
        // Saturates.
        let number = (range_m * 1_000.0).round() as u16;
        (self.metres(number).to_bits() == range_m.to_bits()).then_some(number)
    }

    fn metres(self, number: u16) -> f32 {
        match self {
            Self::TimesThousandth => f32::from(number) * 1.0e-3,
            _ => f32::from(number) / 1_000.0,
        }
    }

    /// `None` if a range is lost by it.
    fn packed(self, ranges_m: impl Iterator<Item = Option<f32>>, to: &mut Vec<u8>) -> Option<()> {
        let mut before = 0_u16;
        for range_m in ranges_m {
            if self == Self::Metres {
                to.extend_from_slice(&range_m.unwrap_or(f32::INFINITY).to_le_bytes());
                continue;
            }
            let Some(range_m) = range_m else {
                to.push(NOTHING);
                continue;
            };
            let number = self.number(range_m)?;
            match u8::try_from(i32::from(number) - i32::from(before) - LEAST) {
                Ok(byte) if byte < NOTHING => to.push(byte),
                _ => {
                    to.push(WHOLE);
                    to.extend_from_slice(&number.to_le_bytes());
                }
            }
            before = number;
        }
        Some(())
    }

    fn unpacked(self, bytes: &[u8]) -> Vec<f32> {
        if self == Self::Metres {
            let (ranges_m, _) = bytes.as_chunks::<4>();
            return ranges_m.iter().map(|range_m| f32::from_le_bytes(*range_m)).collect();
        }
        let mut ranges_m = Vec::with_capacity(bytes.len());
        let mut before = 0_u16;
        let mut rest = bytes.iter().copied();
        while let Some(byte) = rest.next() {
            if byte == NOTHING {
                ranges_m.push(f32::INFINITY);
                continue;
            }
            before = if byte == WHOLE {
                u16::from_le_bytes([rest.next().unwrap_or(0), rest.next().unwrap_or(0)])
            } else {
                before.wrapping_add_signed((i32::from(byte) + LEAST) as i16)
            };
            ranges_m.push(self.metres(before));
        }
        ranges_m
    }
}

impl PackedScan {
    /// Of a scan, seen in a motion; ranges outside of these bounds are lost.
    #[must_use]
    pub fn new(record: &ScanRecord, [least_m, most_m]: [f32; 2], motion: Se2) -> Self {
        let believed = |range_m: &f32| (least_m..=most_m).contains(range_m).then_some(*range_m);
        let ScanRecord { first_angle_rad, step_rad, between_s, .. } = *record;
        let mut bytes = Vec::with_capacity(2 * record.ranges_m.len());
        for (number, unit) in Unit::ALL.into_iter().enumerate() {
            bytes.clear();
            bytes.push(number as u8);
            [first_angle_rad, step_rad, between_s]
                .iter()
                .for_each(|value| bytes.extend_from_slice(&value.to_le_bytes()));
            [motion.x_m, motion.y_m, motion.heading_rad]
                .iter()
                .for_each(|value| bytes.extend_from_slice(&value.to_le_bytes()));
            if unit.packed(record.ranges_m.iter().map(believed), &mut bytes).is_some() {
                break;
            }
        }
        Self { bytes: bytes.into_boxed_slice() }
    }

    /// The believed returns, in the scanner's frame, in the order of the beams.
    #[must_use]
    pub fn points(&self) -> Vec<Point2> {
        self.record().map_or_else(Vec::new, |(record, motion)| record.points_in_motion(0.0, f32::MAX, motion))
    }

    fn record(&self) -> Option<(ScanRecord, Se2)> {
        let (&number, rest) = self.bytes.split_first()?;
        let unit = *Unit::ALL.get(usize::from(number))?;
        let (singles, rest) = rest.split_first_chunk::<12>()?;
        let (doubles, rest) = rest.split_first_chunk::<24>()?;
        let (singles, _) = singles.as_chunks::<4>();
        let (doubles, _) = doubles.as_chunks::<8>();
        let [first_angle_rad, step_rad, between_s] =
            [0, 1, 2].map(|place| f32::from_le_bytes(singles[place]));
        let [x_m, y_m, heading_rad] = [0, 1, 2].map(|place| f64::from_le_bytes(doubles[place]));
        let ranges_m = unit.unpacked(rest);
        let record = ScanRecord { first_angle_rad, step_rad, ranges_m, between_s, ..ScanRecord::default() };
        Some((record, Se2 { x_m, y_m, heading_rad }))
    }

    pub(super) fn save(&self, to: &mut Saving<'_>) {
        to.bytes(&self.bytes);
    }

    pub(super) fn read(from: &mut Reading<'_>) -> Option<Self> {
        Some(Self { bytes: from.all(Reading::byte)?.into() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn returns_come_out_to_the_bit() {
        let motion = Se2::new(0.8, 0.1, 1.2);
        let ranges: [fn(u16) -> f32; 3] = [
            |value| f32::from(value) / 1_000.0,
            |value| f32::from(value) * 1.0e-3,
            |value| f32::from(value) * 0.001_234_5 + 0.01,
        ];
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
            // A third of the ranges lies within the bounds and one by one 97 mm apart; the others say nothing.
            assert!(packed.bytes.len() < if kind < 2 { 450 } else { 2_000 }, "{}", packed.bytes.len());
            let points = record.points_in_motion(0.1, 30.0, motion);
            assert!(points.len() > 200 && packed.points() == points, "{kind}");
        }
    }
}
