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

/// Reads a file; steps are numbered without gaps, as the protocol does.
///
/// # Errors
/// A row that is no row.
pub fn load(path: &Path) -> anyhow::Result<TrackSet> {
    let mut text = String::new();
    flate2::read::GzDecoder::new(std::fs::File::open(path)?).read_to_string(&mut text)?;
    let mut frames: BTreeMap<i64, BTreeMap<i64, Point2>> = BTreeMap::new();
    for line in text.lines() {
        let values: Vec<f64> =
            line.split_whitespace().map(str::parse).collect::<Result<_, _>>().context("a number")?;
        let [frame, person, x_m, y_m] = values[..] else { anyhow::bail!("no row: {line}") };
        let place = Point2::new(x_m as f32, y_m as f32);
        frames.entry(frame as i64).or_default().insert(person as i64, place);
    }
    Ok(TrackSet { steps: frames.into_values().collect() })
}
