//! Legs in labelled scans: learnt from some recordings, found in another.

use std::collections::BTreeMap;
use std::path::Path;

use floorguard_perception::any_scanner::Places;
use floorguard_perception::legs::{KnownPlaces, LEG_CUES, Segments, Stump, leg_score, score};
use floorguard_types::geometry::Pose2;
use serde::Serialize;

use crate::train::{
    LabelledScan, LegSample, Sample, StandingMap, adaboost, coarser, lean, leg_samples, read_leg_scans,
};
use floorguard_host::outcome::BadInput;

/// Comparisons of a committee (book, Legs: Committees).
const LEG_ROUNDS: usize = 100;
/// A committee that learns from fewer labelled legs knows less than the table of this build.
const LEGS_TO_LEARN_MIN: usize = 150;
/// A coarser scanner is played with every so manieth beam.
const COARSER: usize = 2;

/// How well legs are found at score 0, and over all scores.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LegsReport {
    /// Share of the claimed legs that are labelled.
    pub precision: f64,
    /// Share of the labelled legs that are claimed; legs that are no segment count as missed.
    pub recall: f64,
    /// Harmonic mean of both, over all scans.
    pub f1: f64,
    /// Mean and least of the tested recordings.
    pub f1_mean: f64,
    /// As above.
    pub f1_worst: f64,
    /// Area under the curve of precision over recall.
    pub average_precision: f64,
    /// `recordings`: each was tested with a committee of the others. `table`: the table of this build was tested.
    pub method: &'static str,
    /// Scans tested.
    pub scans: u64,
    /// Labelled legs.
    pub legs: u64,
    /// F1 with every second beam: with the 0.35° of the recordings, coarser than the 0.5° of a safety scanner.
    pub f1_coarse: f64,
    /// F1 where no map is known, only what the scans before each scan showed at its places; mean and least of the tested
    /// recordings after it.
    pub f1_without_map: f64,
    /// As above.
    pub f1_without_map_mean: f64,
    /// As above.
    pub f1_without_map_worst: f64,
    /// F1 of the same committee that sees each scan alone.
    pub f1_single_scan: f64,
    /// Each tested recording on its own.
    pub folds: Vec<FoldReport>,
    /// Precision and recall by falling score, for the picture.
    #[serde(skip)]
    pub curve: Vec<(f64, f64)>,
}

/// One tested recording.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FoldReport {
    /// Its name in the file.
    pub source: String,
    /// The scanner stood still, so that furniture is known.
    pub standing: bool,
    /// Scans.
    pub scans: u64,
    /// Labelled legs.
    pub legs: u64,
    /// As in the whole.
    pub precision: f64,
    /// As in the whole.
    pub recall: f64,
    /// As in the whole.
    pub f1: f64,
    /// As in the whole.
    pub f1_without_map: f64,
}

/// What was found in one recording: score and truth of each segment, and labels without a segment.
#[derive(Clone, Debug)]
struct Found {
    scores: Vec<(f32, bool)>,
    missed: u64,
    scans: u64,
}

/// Tests by recording. With labelled legs in two recordings at least, and enough of them, each of these is tested with a
/// committee that learnt from all others; else, or if `table` says so, the table of this build is tested. Where the scanner stood
/// still its furniture is known and no leg; labels reach 5 m, so nothing farther counts.
///
/// # Errors
/// The file cannot be read, has another form, or has no labelled leg.
pub fn legs(scans: &Path, table: bool) -> anyhow::Result<LegsReport> {
    let recordings = recordings(read_leg_scans(scans)?);
    let tested: Vec<&Recording> = recordings.iter().filter(|each| each.has_legs()).collect();
    if tested.is_empty() {
        return Err(BadInput(format!("{}: no labelled leg", scans.display())).into());
    }
    let all_legs: usize = tested.iter().map(|each| each.legs()).sum();
    let fewest = tested.iter().map(|each| all_legs - each.legs()).min().unwrap_or(0);
    let crossed = tested.len() > 1 && fewest >= LEGS_TO_LEARN_MIN && !table;
    let mut report =
        LegsReport { method: if crossed { "recordings" } else { "table" }, ..LegsReport::default() };
    let [mut all, mut coarse, mut bare, mut single] = [const { Found::EMPTY }; 4];
    for recording in tested {
        let learn = |map: bool| {
            let others = || recordings.iter().filter(|other| other.source != recording.source);
            crossed.then(|| LegCommittees::learn(others, map))
        };
        let [with_map, without] = [learn(true), learn(false)];
        let map_and_before = KnownPlaces { map: true, before: true };
        let found = recording.find(with_map.as_ref(), map_and_before, 1);
        let found_without = recording.find(without.as_ref(), KnownPlaces { map: false, before: true }, 1);
        report.folds.push(FoldReport::new(recording, &found, &found_without));
        coarse.add(recording.find(with_map.as_ref(), map_and_before, COARSER));
        single.add(recording.find(without.as_ref(), KnownPlaces { map: false, before: false }, 1));
        all.add(found);
        bare.add(found_without);
    }
    [report.f1_mean, report.f1_worst] = mean_and_least(report.folds.iter().map(|fold| fold.f1));
    [report.f1_without_map_mean, report.f1_without_map_worst] =
        mean_and_least(report.folds.iter().map(|fold| fold.f1_without_map));
    [report.precision, report.recall, report.f1] = all.figures();
    [_, _, report.f1_coarse] = coarse.figures();
    [_, _, report.f1_without_map] = bare.figures();
    [_, _, report.f1_single_scan] = single.figures();
    (report.scans, report.legs) = (all.scans, all.legs());
    (report.curve, report.average_precision) = all.curve();
    Ok(report)
}

fn mean_and_least(values: impl Iterator<Item = f64> + Clone) -> [f64; 2] {
    let count = values.clone().count().max(1) as f64;
    [values.clone().sum::<f64>() / count, values.fold(f64::INFINITY, f64::min)]
}

impl FoldReport {
    fn new(recording: &Recording, found: &Found, without_map: &Found) -> Self {
        let [precision, recall, f1] = found.figures();
        let [_, _, f1_without_map] = without_map.figures();
        Self {
            source: recording.source.clone(),
            standing: recording.map.is_some(),
            scans: found.scans,
            legs: found.legs(),
            precision,
            recall,
            f1,
            f1_without_map,
        }
    }
}

/// The scans of one recording and the furniture around it.
#[derive(Clone, Debug)]
pub struct Recording {
    /// Its name.
    pub source: String,
    scans: Vec<LabelledScan>,
    map: Option<StandingMap>,
}

/// The committees for one kind of map, known or not.
#[derive(Clone, Debug)]
struct LegCommittees {
    /// For places of which nothing is known.
    alone: Vec<Stump>,
    /// For places that earlier scans showed.
    among_places: Vec<Stump>,
}

impl LegCommittees {
    /// Learns both.
    fn learn<'a, R: Iterator<Item = &'a Recording>>(recordings: impl Fn() -> R, map: bool) -> Self {
        let learn =
            |before| learn_legs(&in_any_room(&training_samples(recordings(), KnownPlaces { map, before })));
        Self { alone: learn(false), among_places: learn(true) }
    }

    fn score(&self, sample: &LegSample) -> f32 {
        score(if sample.place_known { &self.among_places } else { &self.alone }, &sample.sample.features)
    }
}

/// Learns a committee that claims a leg above score 0.
#[must_use]
pub fn learn_legs(samples: &[Sample<LEG_CUES>]) -> Vec<Stump> {
    let mut stumps = adaboost(samples, LEG_ROUNDS);
    stumps.push(lean(&stumps, samples));
    stumps
}

/// Scans by recording, in the order of the names.
#[must_use]
pub fn recordings(scans: Vec<LabelledScan>) -> Vec<Recording> {
    let mut by_source: BTreeMap<String, Vec<LabelledScan>> = BTreeMap::new();
    for scan in scans {
        by_source.entry(scan.source.clone()).or_default().push(scan);
    }
    let recording = |(source, scans): (String, Vec<LabelledScan>)| {
        let map = StandingMap::new(scans.iter());
        Recording { source, scans, map }
    };
    by_source.into_iter().map(recording).collect()
}

/// Each segment where it was and in another room.
#[must_use]
pub fn in_any_room(samples: &[LegSample]) -> Vec<Sample<LEG_CUES>> {
    samples.iter().flat_map(|each| [each.sample, each.elsewhere]).collect()
}

/// What a committee learns from: segments of scans as they are and of every second beam, so that it knows fine and
/// coarse scanners. With a map: what the map does not explain, in recordings with legs where the scanner stood. With
/// earlier scans: what they showed the place of.
#[must_use]
pub fn training_samples<'a>(
    recordings: impl Iterator<Item = &'a Recording>,
    known: KnownPlaces,
) -> Vec<LegSample> {
    let mut samples = Vec::new();
    for recording in recordings.filter(|each| !known.map || each.map.is_some() && each.has_legs()) {
        for step in [1, COARSER] {
            recording.play(known, step, |some, _| {
                let of_use = |each: &LegSample| !each.known && each.place_known == known.before;
                samples.extend(some.into_iter().filter(of_use));
            });
        }
    }
    samples
}

impl Recording {
    fn has_legs(&self) -> bool {
        self.legs() > 0
    }

    /// Labelled legs.
    fn legs(&self) -> usize {
        self.scans.iter().map(|scan| scan.legs.len()).sum()
    }

    /// Segments of every `step`-th beam of each scan, in their order, and the labels that no segment fits.
    fn play(&self, known: KnownPlaces, step: usize, mut sink: impl FnMut(Vec<LegSample>, usize)) {
        let (mut segments, mut places) = (Box::new(Segments::new()), Box::new(Places::new()));
        let map = self.map.as_ref().filter(|_| known.map);
        for labelled in &self.scans {
            let scan = coarser(&labelled.scan, step);
            // Where the scanner was is not recorded; places say nothing while it moves.
            places.look(&scan, Pose2::default());
            let before = Some(&*places).filter(|_| known.before);
            let (samples, missed) = leg_samples(labelled, &scan, &mut segments, (map, before));
            places.learn(&scan, |_| false);
            sink(samples, missed);
        }
    }

    /// Scores of all segments of every `step`-th beam; without committees by the table of this build.
    fn find(&self, committees: Option<&LegCommittees>, known: KnownPlaces, step: usize) -> Found {
        let mut found = Found::EMPTY;
        let map = self.map.is_some() && known.map;
        self.play(known, step, |samples, missed| {
            found.missed += missed as u64;
            found.scans += 1;
            found.scores.extend(samples.iter().map(|each| {
                let score = match committees {
                    _ if each.known => f32::NEG_INFINITY,
                    Some(committees) => committees.score(each),
                    None => leg_score(&each.sample.features, KnownPlaces { map, before: each.place_known }),
                };
                (score, each.sample.positive)
            }));
        });
        found
    }
}

impl Found {
    const EMPTY: Self = Self { scores: Vec::new(), missed: 0, scans: 0 };

    fn add(&mut self, other: Self) {
        self.scores.extend(other.scores);
        self.missed += other.missed;
        self.scans += other.scans;
    }

    fn legs(&self) -> u64 {
        self.scores.iter().filter(|(_, is_leg)| *is_leg).count() as u64 + self.missed
    }

    /// Precision, recall and F1 of score 0.
    fn figures(&self) -> [f64; 3] {
        let claimed = self.scores.iter().filter(|(score, _)| *score >= 0.0);
        let (mut claims, mut right) = (0_u64, 0_u64);
        for (_, is_leg) in claimed {
            claims += 1;
            right += u64::from(*is_leg);
        }
        let share = |whole: u64| right as f64 / whole.max(1) as f64;
        [share(claims), share(self.legs()), 2.0 * right as f64 / (claims + self.legs()).max(1) as f64]
    }

    /// Precision and recall by falling score, and the area under it by steps.
    fn curve(&self) -> (Vec<(f64, f64)>, f64) {
        let mut scores = self.scores.clone();
        scores.sort_by(|a, b| b.0.total_cmp(&a.0));
        let legs = self.legs().max(1) as f64;
        let (mut right, mut area, mut curve) = (0_u64, 0.0, Vec::new());
        for (index, (_, is_leg)) in scores.iter().enumerate() {
            right += u64::from(*is_leg);
            let precision = right as f64 / (index + 1) as f64;
            if *is_leg {
                area += precision / legs;
            }
            curve.push((right as f64 / legs, precision));
        }
        (curve, area)
    }
}
