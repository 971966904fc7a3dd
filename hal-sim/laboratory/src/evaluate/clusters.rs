//! People that the detector claims in a lidar capture, against a key of where people stood.

use std::collections::BTreeMap;
use std::path::Path;

use floorguard_perception::people::{PeoplePipeline, RingAngles};
use floorguard_types::geometry::Point2;
use serde::Serialize;

use super::frames::{capture_frames, standing_context};
use floorguard_host::outcome::BadInput;
use floorguard_robot::picture_files::{numbers, read_text};

/// A claim farther than this from a person of the key is another object, metres (book, Tracking: Metrics).
const GATE_M: f32 = 0.5;
/// Farther away neither key nor claims count, metres: the keys end there too.
const RANGE_MAX_M: f32 = 12.0;

/// How well the claims agree with the key.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ClustersReport {
    /// Frames compared.
    pub frames: u64,
    /// People of the key.
    pub key_people: u64,
    /// People of the key in frames that the capture does not have: they do not count.
    pub key_people_outside: u64,
    /// People claimed: tracks with probability one half at least, seen in the frame.
    pub claims: u64,
    /// Of both, those that fit each other.
    pub matches: u64,
    /// Share of the claims that the key knows.
    pub precision: f64,
    /// Share of the key's people that are claimed.
    pub recall: f64,
    /// Harmonic mean of both.
    pub f1: f64,
    /// Share of the key's people where an object of any kind was found.
    pub clustered: f64,
    /// Claims a frame that the key does not know.
    pub other_claims_per_frame: f64,
    /// Mean distance of the pairs, metres.
    pub mean_error_m: f64,
}

/// Runs the people stages over a capture of a standing VLP-16. The key has columns `frame`, and `x`, `y` or `cx`, `cy`.
///
/// # Errors
/// A file cannot be read or has another form.
pub fn clusters(capture: &Path, key: &Path) -> anyhow::Result<ClustersReport> {
    let people = read_key(key)?;
    let sweeps = capture_frames(capture)?;
    let frames = sweeps.len() as u64;
    let outside = people.range(frames..).map(|(_, people)| people.len() as u64).sum();
    if people.range(..frames).next().is_none() {
        let (first, last) = (people.keys().next(), people.keys().next_back());
        return Err(BadInput(format!(
            "{}: people in frames {} to {}, and {} has frames 0 to {}: nothing to compare; give the key of this capture",
            key.display(),
            first.copied().unwrap_or(0),
            last.copied().unwrap_or(0),
            capture.display(),
            frames.saturating_sub(1)
        ))
        .into());
    }
    let angles = RingAngles::vlp16();
    let context = standing_context(&sweeps, &angles);
    let mut pipeline = Box::new(PeoplePipeline::new(angles));
    let mut report = ClustersReport { key_people_outside: outside, ..ClustersReport::default() };
    let (mut clustered, mut error_m) = (0_u64, 0.0_f64);
    for (frame, sweep) in sweeps.iter().enumerate() {
        let output = pipeline.process(sweep, &context);
        let none = Vec::new();
        let wanted = people.get(&(frame as u64)).unwrap_or(&none);
        let claims: Vec<Point2> = output
            .tracks
            .iter()
            .filter(|track| track.person_probability >= 0.5 && track.last_seen == sweep.end_stamp)
            .map(|track| track.state.position)
            .filter(|position| position.norm() < RANGE_MAX_M)
            .collect();
        let centroids =
            output.clusters.iter().map(|cluster| Point2::new(cluster.centroid.x_m, cluster.centroid.y_m));
        let centroids: Vec<Point2> = centroids.collect();
        clustered += pairs(wanted, &centroids).len() as u64;
        let found = pairs(wanted, &claims);
        error_m += found.iter().map(|distance_m| f64::from(*distance_m)).sum::<f64>();
        report.frames += 1;
        report.key_people += wanted.len() as u64;
        report.claims += claims.len() as u64;
        report.matches += found.len() as u64;
    }
    let share = |part: u64, whole: u64| part as f64 / whole.max(1) as f64;
    report.precision = share(report.matches, report.claims);
    report.recall = share(report.matches, report.key_people);
    report.f1 = share(2 * report.matches, report.claims + report.key_people);
    report.clustered = share(clustered, report.key_people);
    report.other_claims_per_frame = share(report.claims - report.matches, report.frames);
    report.mean_error_m = error_m / report.matches.max(1) as f64;
    Ok(report)
}

/// Pairs one to one, nearest first; gives their distances.
fn pairs(wanted: &[Point2], found: &[Point2]) -> Vec<f32> {
    let mut all: Vec<(f32, usize, usize)> = Vec::new();
    for (row, person) in wanted.iter().enumerate() {
        for (column, claim) in found.iter().enumerate() {
            let distance_m = person.distance(*claim);
            if distance_m <= GATE_M {
                all.push((distance_m, row, column));
            }
        }
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut rows, mut columns, mut distances_m) = (Vec::new(), Vec::new(), Vec::new());
    for (distance_m, row, column) in all {
        if !rows.contains(&row) && !columns.contains(&column) {
            rows.push(row);
            columns.push(column);
            distances_m.push(distance_m);
        }
    }
    distances_m
}

/// Places of people by frame, sensor frame, metres.
fn read_key(key: &Path) -> anyhow::Result<BTreeMap<u64, Vec<Point2>>> {
    let text = read_text(key)?;
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let bad = |problem: &str| BadInput(format!("{}: {problem}", key.display()));
    let (_, names) = lines.next().ok_or_else(|| bad("the key is empty"))?;
    let column = |wanted: [&str; 2]| names.split(',').position(|name| wanted.contains(&name.trim()));
    let (Some(frame), Some(x), Some(y)) =
        (column(["frame", "frame"]), column(["x", "cx"]), column(["y", "cy"]))
    else {
        return Err(bad(
            "its first line names no columns `frame`, and `x`, `y` or `cx`, `cy`, separated by commas",
        )
        .into());
    };
    let mut people: BTreeMap<u64, Vec<Point2>> = BTreeMap::new();
    let mut nearest_m = f32::INFINITY;
    for (index, line) in lines {
        let row = numbers(key, index + 1, line)?;
        let (Some(frame), Some(x), Some(y)) = (row.get(frame), row.get(x), row.get(y)) else {
            return Err(bad(&format!(
                "line {} has {} cells, fewer than its first line names; is the file cut off?",
                index + 1,
                row.len()
            ))
            .into());
        };
        if !(0.0..1.0e12).contains(frame) || frame.fract() != 0.0 {
            return Err(bad(&format!("line {}: frame {frame}: whole numbers from 0", index + 1)).into());
        }
        let place = Point2::new(*x as f32, *y as f32);
        nearest_m = nearest_m.min(place.norm());
        if place.norm() < RANGE_MAX_M {
            people.entry(*frame as u64).or_default().push(place);
        }
    }
    if people.is_empty() && nearest_m.is_finite() {
        let problem = format!(
            "nobody stands within {RANGE_MAX_M} m, the nearest one at {nearest_m:.1} m; places are metres in the lidar's frame"
        );
        return Err(bad(&problem).into());
    }
    if people.is_empty() {
        return Err(bad("no rows; a key names at least one person").into());
    }
    Ok(people)
}
