//! Labelled scans: `source,scan,n_legs,x:y;x:y,ranges…`, with a first line that names the geometry.

use std::path::Path;

use floorguard_core::geometry::Point2;
use floorguard_core::legs::{LEG_FEATURES, LegFeatures, LegLimits, Segment, Segments, leg_features};
use floorguard_core::random::Pcg32;
use floorguard_core::sensing::{BeamReturn, Scan};

use super::boosting::Sample;
use super::standing_map::StandingMap;
use crate::commands::BadInput;
use crate::evaluate::read_text;

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

/// The jumps to the things beside a segment, of its numbers.
const JUMPS: std::ops::Range<usize> = 2..4;
/// What is farther behind a segment than this is background, and where it may be in another room, metres.
const BACKGROUND_MIN_M: f32 = 0.3;
const BACKGROUND_MAX_M: f32 = 8.0;

/// Reads a file.
///
/// # Errors
/// The file cannot be read or has another form.
pub fn read_leg_scans(path: &Path) -> anyhow::Result<Vec<LabelledScan>> {
    let text = read_text(path)?;
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let bad = |line: usize, problem: &str| BadInput(format!("{}, line {line}: {problem}", path.display()));
    let (_, header) = lines.next().ok_or_else(|| bad(1, "the file is empty"))?;
    let named = |name: &str| {
        let value = header.split_whitespace().find_map(|word| word.strip_prefix(name)?.strip_prefix('='));
        value.and_then(|value| value.trim_end_matches(';').parse::<f32>().ok())
    };
    let (Some(first_angle_rad), Some(step_rad)) = (named("angle_min"), named("angle_increment")) else {
        return Err(bad(1, "expected `angle_min=` and `angle_increment=`").into());
    };
    let range_max_m = named("range_max").unwrap_or(f32::INFINITY);
    let mut scans = Vec::new();
    for (index, line) in lines {
        let wrong = |problem: &str| bad(index + 1, problem);
        let mut cells = line.split(',');
        let source = cells.next().unwrap_or_default().to_owned();
        let _ = cells.next();
        let count: usize = cells
            .next()
            .and_then(|cell| cell.trim().parse().ok())
            .ok_or_else(|| wrong("expected `source,scan,n_legs,legs,ranges…`"))?;
        let legs = parse_legs(cells.next().unwrap_or_default()).ok_or_else(|| wrong("legs are `x:y;x:y`"))?;
        if legs.len() != count {
            return Err(wrong("not as many legs as it says").into());
        }
        let mut scan = Scan { first_angle_rad, step_rad, ..Scan::default() };
        for cell in cells {
            let range_m = if cell.trim().is_empty() { Some(0.0) } else { cell.trim().parse::<f32>().ok() };
            let range_m = range_m.ok_or_else(|| wrong("ranges are numbers"))?;
            scan.beams
                .push(beam(range_m, range_max_m))
                .map_err(|_| wrong("more beams than a scanner has"))?;
        }
        scans.push(LabelledScan { source, scan, legs });
    }
    Ok(scans)
}

fn parse_legs(text: &str) -> Option<Vec<Point2>> {
    let parts = text.split(';').filter(|part| !part.trim().is_empty());
    parts
        .map(|part| {
            let (x, y) = part.split_once(':')?;
            Some(Point2::new(x.trim().parse().ok()?, y.trim().parse().ok()?))
        })
        .collect()
}

/// Strictly between its own minimum and the largest range; anything else is unknown.
fn beam(range_m: f32, range_max_m: f32) -> BeamReturn {
    if range_m > 0.02 && range_m < range_max_m.min(60.0) {
        BeamReturn::Hit((range_m * 1_000.0).round() as u16)
    } else {
        BeamReturn::Unknown
    }
}

/// Every `step`-th beam: what a coarser scanner would have seen.
#[must_use]
pub fn coarser(scan: &Scan, step: usize) -> Scan {
    let mut coarse = Scan { step_rad: scan.step_rad * step as f32, ..scan.clone() };
    coarse.beams.clear();
    for beam in scan.beams.iter().step_by(step) {
        // Fewer than before: always room.
        let _ = coarse.beams.push(*beam);
    }
    coarse
}

/// A segment of a labelled scan.
#[derive(Clone, Copy, Debug)]
pub struct LegSample {
    /// Numbers and truth.
    pub sample: Sample<LEG_FEATURES>,
    /// The same thing in another room: what is behind it is somewhere else.
    pub elsewhere: Sample<LEG_FEATURES>,
    /// Furniture of the map.
    pub known: bool,
}

/// Labels reach this far, metres; beyond it a leg may be there or not (and has too few returns, see the weaknesses of
/// algorithms C).
pub const LABELS_MAX_M: f32 = 5.0;

/// The segments of a scan that the classifier may be asked about, and how many labels no segment fits.
pub fn leg_samples(
    labelled: &LabelledScan,
    scan: &Scan,
    segments: &mut Segments,
    map: Option<&StandingMap>,
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
        let sample = |features| Sample { features, positive: label.is_some() };
        let elsewhere = sample(with_another_wall(features, &segment, &mut random));
        samples.push(LegSample { sample: sample(features), elsewhere, known });
    }
    (samples, free.len())
}

/// A number that differs from scan to scan.
fn hit_sum(scan: &Scan) -> u64 {
    let hits = scan.beams.iter().map(|beam| if let BeamReturn::Hit(range_mm) = beam { *range_mm } else { 0 });
    hits.map(u64::from).sum()
}

/// Puts a wall somewhere behind the segment. The recorder dropped what it was not sure of, so that four of five legs have no
/// return beside them and a jump of 0, while things before a wall are furniture: a committee of these recordings alone finds
/// no leg in a hall. What is nearer than the segment or just beside it stays as it is.
fn with_another_wall(mut features: LegFeatures, segment: &Segment<'_>, random: &mut Pcg32) -> LegFeatures {
    let ends = [(segment.points.first(), segment.previous), (segment.points.last(), segment.next)];
    for (jump_m, (end, beside)) in features[JUMPS].iter_mut().zip(ends) {
        let wall_m = random.uniform_between(BACKGROUND_MIN_M, BACKGROUND_MAX_M);
        let behind_m = end.zip(beside).map(|(end, beside)| beside.norm() - end.norm());
        if behind_m.is_none_or(|behind_m| behind_m > BACKGROUND_MIN_M) {
            *jump_m = wall_m;
        }
    }
    features
}
