//! What others say is floor: SemanticKITTI's labels, or one bit a point.

use std::io::Read as _;
use std::path::Path;

use floorguard_host::packing::unpacked;
use serde::Serialize;

/// Road, parking, pavement, other ground, lane marking, terrain (SemanticKITTI).
const FLOOR: [u16; 6] = [40, 44, 48, 49, 60, 72];
/// Unlabelled, outlier, vegetation (it begins at the ground), bicycle rack and the like.
const LEFT_OUT: [u16; 4] = [0, 1, 70, 255];

/// How well found and true floor agree.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Agreement {
    /// Points that count.
    pub points: usize,
    /// Of what was found, the true share.
    pub precision: f64,
    /// Of what is true, the found share.
    pub recall: f64,
}

/// Compares; a file of four bytes a point holds labels, one of an eighth of a byte bits, highest first.
///
/// # Errors
/// The file cannot be read, or has another size.
pub fn compare(path: &Path, found: &[bool]) -> anyhow::Result<Agreement> {
    let mut bytes = Vec::new();
    unpacked(std::fs::File::open(path)?)?.read_to_end(&mut bytes)?;
    let truth: Vec<Option<bool>> = if bytes.len() == 4 * found.len() {
        let (labels, _) = bytes.as_chunks::<4>();
        let class = |[low, high, ..]: &[u8; 4]| u16::from_le_bytes([*low, *high]);
        let judged = |class: u16| (!LEFT_OUT.contains(&class)).then(|| FLOOR.contains(&class));
        labels.iter().map(|label| judged(class(label))).collect()
    } else if bytes.len() == found.len().div_ceil(8) {
        let bit = |index: usize| bytes.get(index / 8).is_some_and(|byte| byte & (0x80 >> (index % 8)) != 0);
        (0..found.len()).map(|index| Some(bit(index))).collect()
    } else {
        anyhow::bail!("{}: {} bytes fit no {} points", path.display(), bytes.len(), found.len());
    };
    let count = |wanted: (bool, bool)| {
        truth
            .iter()
            .zip(found)
            .filter(|(truth, found)| **truth == Some(wanted.0) && **found == wanted.1)
            .count()
    };
    let (both, missed, wrong) = (count((true, true)), count((true, false)), count((false, true)));
    let share = |part: usize, whole: usize| part as f64 / whole.max(1) as f64;
    Ok(Agreement {
        points: truth.iter().flatten().count(),
        precision: share(both, both + wrong),
        recall: share(both, both + missed),
    })
}
