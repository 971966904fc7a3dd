//! The figures that a run of the tracker comes to.

use serde::Serialize;

/// CLEAR-MOT (Bernardin and Stiefelhagen 2008) and identity measures. Ratios are `None` where nothing was to be
/// measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct MotSummary {
    /// Frames compared.
    pub frames: u64,
    /// Observations of true objects.
    pub objects: u64,
    /// Observations by tracks.
    pub predictions: u64,
    /// Observations of true objects that a track covers, switches included.
    pub matches: u64,
    /// Observations of tracks without an object.
    pub false_positives: u64,
    /// Observations of objects without a track.
    pub misses: u64,
    /// Times that an object was covered by another track than before.
    pub switches: u64,
    /// Times that a covered object was lost and found again.
    pub fragmentations: u64,
    /// True objects.
    pub unique_objects: u64,
    /// Objects covered for at least 80 % of their life.
    pub mostly_tracked: u64,
    /// Objects covered for less than 20 % of their life.
    pub mostly_lost: u64,
    /// 1 − (misses + false positives + switches) / objects; at most 1, may be negative.
    pub mota: Option<f64>,
    /// Mean distance of the matches, in the unit of the distance (metres for points); 0 is perfect.
    pub motp: Option<f64>,
    /// Identity F1 score, 0 to 1.
    pub idf1: Option<f64>,
    /// Identity precision, 0 to 1.
    pub identity_precision: Option<f64>,
    /// Identity recall, 0 to 1.
    pub identity_recall: Option<f64>,
}

/// `part` of `whole`, if there is a whole.
pub(super) fn ratio(part: f64, whole: u64) -> Option<f64> {
    (whole > 0).then(|| part / whole as f64)
}
