//! One search of the whole map, and the places that earlier ones left possible.

use floorguard_localisation::scan_matching::{Guess, refine};
use nalgebra::Matrix3;

use super::config::LocaliseConfig;
use super::known_map::KnownMap;
use super::places::{are_apart, places};
use super::query::Query;
use super::support::Support;
use crate::front_end::Node;
use crate::se2::Se2;

/// What a search says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SearchAnswer {
    /// One place, and no other that is nearly as good: the frame of the tracking in the map.
    Alone(Se2),
    /// No place fits.
    Nowhere,
    /// Another place fits nearly as well.
    Ambiguous,
    /// Beams went through walls there.
    Contradicted,
}

/// Places that a search gives, and those that are kept for the next one.
const PLACES: usize = 40;
const KEPT: usize = 24;
/// Beyond this a second place is another one that must lose: metres and radians.
const ANOTHER: (f64, f64) = (0.8, 0.3);
/// Scans, and beams of each, that are asked about a place.
const ASKED_SCANS: usize = 24;
const ASKED_BEAMS: usize = 60;

/// A place that is possible.
#[derive(Clone, Debug)]
struct Hypothesis {
    tracking_in_map: Se2,
    support: f64,
    through_share: f64,
    /// Support of each scan that was asked: the same scans for all places.
    of_scans: Vec<f64>,
}

impl Hypothesis {
    /// Whether another place is clearly worse: by far on the whole, or by less but scan after scan. The scans of a metre see
    /// much the same and count once.
    fn beats(&self, other: &Self, path_m: f64, config: &LocaliseConfig) -> bool {
        let gap = self.support - other.support;
        if gap >= config.support_margin.max(config.margin_metres / path_m.max(1.0)) {
            return true;
        }
        let gaps = self.of_scans.iter().zip(&other.of_scans).map(|(here, there)| here - there);
        let count = self.of_scans.len().min(other.of_scans.len()).max(2) as f64;
        let mean = gaps.clone().sum::<f64>() / count;
        let variance = gaps.map(|gap| (gap - mean) * (gap - mean)).sum::<f64>() / (count - 1.0);
        let independent = (path_m / INDEPENDENT_M).min(count);
        let deviation = (variance / independent.max(1.0)).sqrt().max(1.0e-6);
        independent >= INDEPENDENT_LEAST && gap >= config.steady_margin && mean >= config.sigmas * deviation
    }
}

/// Path over which scans see much the same, metres, and how many such pieces a comparison scan by scan needs.
const INDEPENDENT_M: f64 = 1.0;
const INDEPENDENT_LEAST: f64 = 3.0;

/// The possible places.
#[derive(Default)]
pub struct Searcher {
    hypotheses: Vec<Hypothesis>,
}

impl Searcher {
    /// Searches the whole map, all headings.
    pub fn search(
        &mut self,
        map: &KnownMap,
        nodes: &[Node],
        query: &Query,
        config: &LocaliseConfig,
    ) -> SearchAnswer {
        let Some(last) = nodes.last() else { return SearchAnswer::Nowhere };
        let mut poses: Vec<Se2> = Vec::new();
        for before in &self.hypotheses {
            let pose = refined(map, query, before.tracking_in_map.compose(last.pose), config);
            if poses.iter().all(|other| are_apart(*other, pose)) {
                poses.push(pose);
            }
        }
        for pose in places(map, &query.points, config, PLACES) {
            if poses.iter().all(|other| are_apart(*other, pose)) {
                poses.push(pose);
            }
        }
        let judged = poses.into_iter().map(|pose| {
            let of_scans = support_of(map, nodes, query, pose);
            let mut whole = Support::default();
            of_scans.iter().for_each(|scan| whole.join(scan));
            Hypothesis {
                tracking_in_map: pose.compose(last.pose.inverse()),
                support: whole.value(),
                through_share: whole.through_share(),
                of_scans: of_scans.iter().map(Support::value).collect(),
            }
        });
        self.hypotheses = judged.collect();
        self.hypotheses.sort_by(|a, b| b.support.total_cmp(&a.support));
        self.hypotheses.truncate(KEPT);
        self.answer(last.pose, query.path_m, config)
    }

    fn answer(&self, last: Se2, path_m: f64, config: &LocaliseConfig) -> SearchAnswer {
        let Some(best) = self.hypotheses.first() else { return SearchAnswer::Nowhere };
        if best.support < config.support_least {
            return SearchAnswer::Nowhere;
        }
        if best.through_share > config.through_most {
            return SearchAnswer::Contradicted;
        }
        let place = |hypothesis: &Hypothesis| hypothesis.tracking_in_map.compose(last);
        let is_other = |other: &&Hypothesis| {
            let away = place(best).between(place(other));
            away.length_m() > ANOTHER.0 || away.heading_rad.abs() > ANOTHER.1
        };
        if self.hypotheses.iter().filter(is_other).any(|other| !best.beats(other, path_m, config)) {
            return SearchAnswer::Ambiguous;
        }
        SearchAnswer::Alone(best.tracking_in_map)
    }

    /// Support of the best place.
    pub fn best_support(&self) -> f64 {
        self.hypotheses.first().map_or(f64::NEG_INFINITY, |best| best.support)
    }
}

fn refined(map: &KnownMap, query: &Query, pose: Se2, config: &LocaliseConfig) -> Se2 {
    let start = pose.single();
    let guess = Guess { start, expected: start, information: Matrix3::zeros() };
    refine(&map.levels()[0], &query.points, &guess, &config.descent).pose.into()
}

/// What each of the scans of a query says, with the last one at `pose`.
fn support_of(map: &KnownMap, nodes: &[Node], query: &Query, pose: Se2) -> Vec<Support> {
    let Some(last) = nodes.last() else { return Vec::new() };
    let scans = &nodes[query.first..];
    let asked = scans.iter().rev().step_by(scans.len().div_ceil(ASKED_SCANS).max(1));
    let support = |node: &Node| {
        let mut support = Support::default();
        let place = pose.compose(last.pose.between(node.pose));
        support.add(map, (place, &node.points), ASKED_BEAMS);
        support
    };
    asked.map(support).collect()
}
