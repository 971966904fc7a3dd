//! One search of the whole map, and the places that earlier ones left possible.

use floorguard_localisation::scan_matching::{Guess, refine};
use nalgebra::Matrix3;

use super::config::LocaliseConfig;
use super::evidence::Evidence;
use super::known_map::KnownMap;
use super::places::{are_apart, places};
use super::query::Query;
use super::support::Support;
use crate::front_end::Node;
use crate::se2::Se2;

/// A place that stands before all others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lead {
    /// The frame of the tracking in the map.
    pub tracking_in_map: Se2,
    /// Support that it has more than any other place.
    pub margin: f64,
    /// The same, where what new furniture can explain counts a part only.
    pub advantage: f64,
}

/// What a search says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SearchAnswer {
    /// One place fits better than every other.
    Lead(Lead),
    /// No place fits.
    Nowhere,
    /// Beams went through walls there.
    Contradicted,
}

/// Places that a search gives, and those that are kept for the next one.
const PLACES: usize = 40;
const KEPT: usize = 24;
/// Beyond this a second place is another one that must lose: metres and radians.
const ANOTHER: (f64, f64) = (0.8, 0.3);

/// A place that is possible.
#[derive(Clone, Debug)]
struct Hypothesis {
    tracking_in_map: Se2,
    support: Support,
    /// Support of the newest scans alone.
    newest: f64,
}

impl Hypothesis {
    /// By how much this place is better than another if furniture may have changed: what contradicts the other one counts in full, all else in
    /// part.
    fn advantage(&self, other: &Self, config: &LocaliseConfig) -> f64 {
        let contradicted = (other.support.contradiction() - self.support.contradiction()).max(0.0);
        let rest = self.support.value() - other.support.value() - contradicted;
        contradicted + config.clutter_share * rest
    }
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
        let evidence = Evidence::new(&nodes[query.first..]);
        let judged = poses.into_iter().map(|pose| {
            let (support, newest) = evidence.support_at(map, pose);
            Hypothesis { tracking_in_map: pose.compose(last.pose.inverse()), support, newest }
        });
        self.hypotheses = judged.collect();
        self.hypotheses.sort_by(|a, b| b.support.value().total_cmp(&a.support.value()));
        self.hypotheses.truncate(KEPT);
        self.answer(last.pose, config)
    }

    fn answer(&self, last: Se2, config: &LocaliseConfig) -> SearchAnswer {
        let Some(best) = self.hypotheses.first() else { return SearchAnswer::Nowhere };
        if best.support.value() < config.support_least {
            return SearchAnswer::Nowhere;
        }
        if best.support.through_share() > config.through_most || best.newest < config.doubt_below {
            return SearchAnswer::Contradicted;
        }
        let place = |hypothesis: &Hypothesis| hypothesis.tracking_in_map.compose(last);
        let is_other = |other: &&Hypothesis| {
            let away = place(best).between(place(other));
            away.length_m() > ANOTHER.0 || away.heading_rad.abs() > ANOTHER.1
        };
        let (mut margin, mut advantage) = (f64::INFINITY, f64::INFINITY);
        for other in self.hypotheses.iter().filter(is_other) {
            margin = margin.min(best.support.value() - other.support.value());
            advantage = advantage.min(best.advantage(other, config));
        }
        SearchAnswer::Lead(Lead { tracking_in_map: best.tracking_in_map, margin, advantage })
    }

    /// Support of the best place.
    pub fn best_support(&self) -> f64 {
        self.hypotheses.first().map_or(f64::NEG_INFINITY, |best| best.support.value())
    }
}

fn refined(map: &KnownMap, query: &Query, pose: Se2, config: &LocaliseConfig) -> Se2 {
    let start = pose.single();
    let guess = Guess { start, expected: start, information: Matrix3::zeros() };
    refine(&map.levels()[0], &query.points, &guess, &config.descent).pose.into()
}
