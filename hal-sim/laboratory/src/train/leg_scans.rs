//! Segments of labelled scans, with the truth about them.

use floorguard_perception::any_scanner::Places;
use floorguard_perception::legs::{LEG_CUES, LegCues, LegLimits, Segment, Segments, leg_cues, leg_features};
use floorguard_types::geometry::Point2;
use floorguard_types::random::Pcg32;
use floorguard_types::sensing::{BeamReturn, Scan};

use super::boosting::Sample;
use super::standing_map::StandingMap;

/// A scan with the truth about its legs.
#[derive(Clone, Debug)]
pub struct LabelledScan {
    /// Which recording.
    pub source: String,
    /// The scan.
    pub scan: Scan,
    /// Middles of the legs, sensor frame, metres.
    pub legs: Vec<Point2>,
}

/// A segment farther than this from every label is no leg, metres; labels are middles of segments.
pub const LABEL_GATE_M: f32 = 0.1;

/// The jumps to the objects beside a segment, of its numbers.
const JUMPS: std::ops::Range<usize> = 2..4;
/// What is farther behind a segment than this is background, and where it may be in another room, metres.
const BACKGROUND_MIN_M: f32 = 0.3;
const BACKGROUND_MAX_M: f32 = 8.0;

/// Every `step`-th beam: what a coarser scanner would have seen.
#[must_use]
pub fn coarser(scan: &Scan, step: usize) -> Scan {
    let mut coarse = Scan { step_rad: scan.step_rad * step as f32, ..scan.clone() };
    coarse.beams.clear();
    for beam in scan.beams.iter().step_by(step) {
        // Fewer than before: they always fit.
        let _ = coarse.beams.push(*beam);
    }
    coarse
}

/// A segment of a labelled scan.
#[derive(Clone, Copy, Debug)]
pub struct LegSample {
    /// Numbers and truth.
    pub sample: Sample<LEG_CUES>,
    /// The same object in another room: what is behind it is somewhere else.
    pub elsewhere: Sample<LEG_CUES>,
    /// Furniture of the map.
    pub known: bool,
    /// Earlier scans showed what was at its place.
    pub place_known: bool,
}

/// Labels reach this far, metres; beyond it a leg may be there or not (and has too few returns, see the book,
/// Legs: Segments).
pub const LABELS_MAX_M: f32 = 5.0;

/// The segments of a scan that the classifier may be asked about, and how many labels no segment fits.
pub fn leg_samples(
    labelled: &LabelledScan,
    scan: &Scan,
    segments: &mut Segments,
    (map, places): (Option<&StandingMap>, Option<&Places>),
) -> (Vec<LegSample>, usize) {
    let limits = LegLimits::DEFAULT;
    segments.cut(scan, limits.gap_m);
    let mut samples = Vec::new();
    let mut random = Pcg32::new(hit_sum(scan), 1);
    let mut free: Vec<Point2> = labelled.legs.clone();
    for segment in segments.iter().filter(|segment| segment.points.len() >= limits.points_min) {
        let Some(features) = leg_features(&segment) else { continue };
        let count = segment.points.len() as f32;
        let sum = segment.points.iter().fold((0.0, 0.0), |(x, y), point| (x + point.x_m, y + point.y_m));
        let middle = Point2::new(sum.0 / count, sum.1 / count);
        if middle.norm() > LABELS_MAX_M {
            continue;
        }
        let label = free.iter().position(|leg| leg.distance(middle) < LABEL_GATE_M);
        if let Some(label) = label {
            free.swap_remove(label);
        }
        let known = map.is_some_and(|map| map.knows(middle));
        let evidence = places.and_then(|places| places.evidence(segment.points));
        let cues = leg_cues(&features, evidence);
        let sample = |features| Sample { features, positive: label.is_some() };
        let elsewhere = sample(with_another_wall(cues, &segment, &mut random));
        samples.push(LegSample { sample: sample(cues), elsewhere, known, place_known: evidence.is_some() });
    }
    (samples, free.len())
}

/// A number that differs from scan to scan.
fn hit_sum(scan: &Scan) -> u64 {
    let hits = scan.beams.iter().map(|beam| if let BeamReturn::Hit(range_mm) = beam { *range_mm } else { 0 });
    hits.map(u64::from).sum()
}

/// Puts a wall somewhere behind the segment. The recorder dropped what it was not sure of, so that four of five legs
/// have no return beside them and a jump of 0, while objects before a wall are furniture: a committee of these
/// recordings alone finds no leg in a hall. What is nearer than the segment or just beside it stays as it is.
fn with_another_wall(mut cues: LegCues, segment: &Segment<'_>, random: &mut Pcg32) -> LegCues {
    let ends = [(segment.points.first(), segment.previous), (segment.points.last(), segment.next)];
    for (jump_m, (end, beside)) in cues[JUMPS].iter_mut().zip(ends) {
        let wall_m = random.uniform_between(BACKGROUND_MIN_M, BACKGROUND_MAX_M);
        let behind_m = end.zip(beside).map(|(end, beside)| beside.norm() - end.norm());
        if behind_m.is_none_or(|behind_m| behind_m > BACKGROUND_MIN_M) {
            *jump_m = wall_m;
        }
    }
    cues
}
