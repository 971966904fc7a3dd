//! The anchors that ship with the program: shapes with a known truth, on which nothing that is learned may do worse.
//!
//! Made by `floorguard train anchors` from simulated rooms that did not make the shipped classifier. Coordinates are
//! sixteen bits in steps of 1/1024: the anchors are examples, and a millimetre more or less is another example.

use anyhow::{bail, ensure};
use crc::{CRC_32_ISO_HDLC, Crc};
use floorguard_perception::online_learning::LabelledShape;
use floorguard_perception::people::shape::SHAPE_FEATURES;

const SHIPPED: &[u8] = include_bytes!("anchors.bin");
/// Steps of a unit.
const STEPS: f32 = 1_024.0;
/// One label and the shape.
const ROW_BYTES: usize = 1 + 2 * SHAPE_FEATURES;
const CHECKSUM: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// The anchors that the program carries.
#[must_use]
pub fn shipped_anchors() -> Vec<LabelledShape> {
    // The file is part of the program, and a test reads it.
    read_anchors(SHIPPED).unwrap_or_default()
}

/// The content of a file of anchors.
///
/// # Errors
/// A number does not fit.
pub fn anchors_file(anchors: &[LabelledShape]) -> anyhow::Result<Vec<u8>> {
    let mut file = Vec::with_capacity(anchors.len() * ROW_BYTES);
    for anchor in anchors {
        file.push(u8::from(anchor.is_person));
        for value in anchor.shape {
            let steps = (value * STEPS).round();
            ensure!(steps.abs() <= f32::from(i16::MAX), "{value} is no number of a shape");
            file.extend_from_slice(&(steps as i16).to_le_bytes());
        }
    }
    Ok(file)
}

/// Reads a file of anchors.
///
/// # Errors
/// It is none.
pub fn read_anchors(bytes: &[u8]) -> anyhow::Result<Vec<LabelledShape>> {
    let (rows, rest) = bytes.as_chunks::<ROW_BYTES>();
    ensure!(rest.is_empty() && !rows.is_empty(), "{} bytes are no whole number of anchors", bytes.len());
    let row = |row: &[u8; ROW_BYTES]| {
        let [label, numbers @ ..] = row;
        let is_person = match label {
            0 => false,
            1 => true,
            other => bail!("label {other}"),
        };
        let mut shape = [0.0; SHAPE_FEATURES];
        for (value, steps) in shape.iter_mut().zip(numbers.as_chunks::<2>().0) {
            *value = f32::from(i16::from_le_bytes(*steps)) / STEPS;
        }
        Ok(LabelledShape { shape, is_person })
    };
    rows.iter().map(row).collect()
}

/// Tells one set of anchors from another: weights mean nothing with others, whose spreads are the units of the waves.
#[must_use]
pub fn anchors_fingerprint(anchors: &[LabelledShape]) -> u32 {
    let mut digest = CHECKSUM.digest();
    for anchor in anchors {
        digest.update(&[u8::from(anchor.is_person)]);
        anchor.shape.iter().for_each(|value| digest.update(&value.to_le_bytes()));
    }
    digest.finalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_perception::people::person_model::person_log_odds;

    #[test]
    fn shipped_anchors_match_the_shipped_classifier() {
        let anchors = read_anchors(SHIPPED).expect("the file is whole");
        let right = |person: bool| {
            let of: Vec<bool> = anchors
                .iter()
                .filter(|anchor| anchor.is_person == person)
                .map(|anchor| (person_log_odds(&anchor.shape) > 0.0) == person)
                .collect();
            (of.len(), of.iter().filter(|right| **right).count() as f64 / of.len() as f64)
        };
        let ((people, found), (others, refused)) = (right(true), right(false));
        assert!(people >= 400 && others >= 400, "{people} {others}");
        assert!(found > 0.9 && refused > 0.9, "{found} {refused}");
        assert_eq!(anchors_file(&anchors).unwrap(), SHIPPED);
        assert!(read_anchors(&SHIPPED[1..]).is_err() && read_anchors(&[]).is_err());
    }
}
