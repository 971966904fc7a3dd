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
#[derive(Clone, Copy, Debug)]
struct Hypothesis {
    tracking_in_map: Se2,
    support: f64,
    through_share: f64,
}

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
            let support = support_of(map, nodes, query, pose);
            Hypothesis {
                tracking_in_map: pose.compose(last.pose.inverse()),
                support: support.value(),
                through_share: support.through_share(),
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
        let second = self.hypotheses.iter().find(is_other).map_or(f64::NEG_INFINITY, |second| second.support);
        let margin = config.support_margin.max(config.margin_metres / path_m.max(1.0));
        if second > best.support - margin {
            return SearchAnswer::Ambiguous;
        }
        SearchAnswer::Alone(best.tracking_in_map)
    }
}

fn refined(map: &KnownMap, query: &Query, pose: Se2, config: &LocaliseConfig) -> Se2 {
    let start = pose.single();
    let guess = Guess { start, expected: start, information: Matrix3::zeros() };
    refine(&map.levels()[0], &query.points, &guess, &config.descent).pose.into()
}

/// What the scans of a query say, with the last one at `pose`.
fn support_of(map: &KnownMap, nodes: &[Node], query: &Query, pose: Se2) -> Support {
    let mut support = Support::default();
    let Some(last) = nodes.last() else { return support };
    let scans = &nodes[query.first..];
    for node in scans.iter().rev().step_by(scans.len().div_ceil(ASKED_SCANS).max(1)) {
        let place = pose.compose(last.pose.between(node.pose));
        support.add(map, (place, &node.points), ASKED_BEAMS);
    }
    support
}
