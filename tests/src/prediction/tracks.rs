//! Tracks of a set: rows of frame, person, x, y, packed with gzip.

use std::collections::BTreeMap;
use std::io::Read as _;
use std::path::Path;

use anyhow::Context as _;
use floorguard_types::geometry::Point2;

/// A recording in steps.
#[derive(Clone, Debug)]
pub struct TrackSet {
    /// By step: everybody's place, by person.
    pub steps: Vec<BTreeMap<i64, Point2>>,
}

/// A row of a file: one person at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackRow {
    /// Number of the picture.
    pub frame: i64,
    /// Number of the person.
    pub person: i64,
    /// Place, metres.
    pub place: Point2,
}

/// The rows of a file, in its order.
///
/// # Errors
/// A row that is no row.
pub fn rows(path: &Path) -> anyhow::Result<Vec<TrackRow>> {
    let mut text = String::new();
    flate2::read::GzDecoder::new(std::fs::File::open(path)?).read_to_string(&mut text)?;
    let row = |line: &str| {
        let values: Vec<f64> =
            line.split_whitespace().map(str::parse).collect::<Result<_, _>>().context("a number")?;
        let [frame, person, x_m, y_m] = values[..] else { anyhow::bail!("no row: {line}") };
        let place = Point2::new(x_m as f32, y_m as f32);
        Ok(TrackRow { frame: frame as i64, person: person as i64, place })
    };
    text.lines().map(row).collect()
}

/// Reads a file; steps are numbered without gaps, as the protocol does.
///
/// # Errors
/// A row that is no row.
pub fn load(path: &Path) -> anyhow::Result<TrackSet> {
    let mut frames: BTreeMap<i64, BTreeMap<i64, Point2>> = BTreeMap::new();
    for TrackRow { frame, person, place } in rows(path)? {
        frames.entry(frame).or_default().insert(person, place);
    }
    Ok(TrackSet { steps: frames.into_values().collect() })
}
