//! From scan to scan: searching, found, in doubt.

use std::collections::VecDeque;

use floorguard_localisation::scan_matching::{Guess, refine};
use floorguard_types::geometry::Point2;
use nalgebra::{Matrix3, Vector3};

use super::config::LocaliseConfig;
use super::known_map::KnownMap;
use super::query::Query;
use super::searching::{SearchAnswer, Searcher};
use crate::front_end::{Step, Tracker};
use crate::input::ScanRecord;
use crate::se2::Se2;

/// What is known about the place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Belief {
    /// Not known: nothing was found yet, several places fit, or the place was lost.
    #[default]
    Unknown,
    /// A place is followed, but the last scans fit it badly.
    Doubt,
    /// Known.
    Found,
}

/// The answer after a scan.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Located {
    /// What is known.
    pub belief: Belief,
    /// Scanner in the map; `None` where the place is not known.
    pub pose: Option<Se2>,
    /// Mean value of the returns of this scan at its place, 0 to 1; 0 where it is not known.
    pub score: f32,
}

/// What the searches came to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LocaliserStatistics {
    /// Searches of the whole map.
    pub searches: usize,
    /// No place fitted.
    pub nowhere: usize,
    /// Several places fitted.
    pub ambiguous: usize,
    /// Beams went through walls.
    pub contradicted: usize,
    /// Times that a place was found.
    pub found: usize,
    /// Times that it was lost.
    pub lost: usize,
}

/// A place on which the last searches agree.
#[derive(Clone, Copy)]
struct Hypothesis {
    /// Path at the first of them, metres.
    since_m: f64,
    tracking_in_map: Se2,
}

/// The followed place: the frame of the tracking in the map.
struct Followed {
    tracking_in_map: Se2,
    scores: VecDeque<f32>,
}

/// Localises the scans of a drive in a known map.
pub struct Localiser {
    config: LocaliseConfig,
    map: KnownMap,
    tracker: Tracker,
    searcher: Searcher,
    followed: Option<Followed>,
    hypothesis: Option<Hypothesis>,
    /// First scan that belongs to the present place.
    since: usize,
    /// Path since then, and at the last search.
    path_m: f64,
    searched_m: Option<f64>,
    next_path_m: f64,
    checked_s: f64,
    /// What the searches came to.
    pub statistics: LocaliserStatistics,
}

impl Localiser {
    /// Nothing is known yet.
    #[must_use]
    pub fn new(map: KnownMap, config: LocaliseConfig) -> Self {
        Self {
            tracker: Tracker::new(config.front_end),
            config,
            map,
            searcher: Searcher::default(),
            followed: None,
            hypothesis: None,
            since: 0,
            path_m: 0.0,
            searched_m: None,
            next_path_m: config.next_path_m,
            checked_s: f64::NEG_INFINITY,
            statistics: LocaliserStatistics::default(),
        }
    }

    /// Takes the next scan. A whole map is searched at some of them: seconds in a large building.
    pub fn push(&mut self, record: &ScanRecord) -> Located {
        let step = self.tracker.push(record);
        let (scanner_in_tracking, points) = match step {
            Step::Node(index) => {
                let node = &self.tracker.nodes[index];
                if let Some(before) = index.checked_sub(1).and_then(|before| self.tracker.nodes.get(before)) {
                    let turn = before.pose.between(node.pose).heading_rad.abs();
                    self.path_m += before.pose.distance(node.pose) + turn;
                }
                (node.pose, node.points.clone())
            }
            Step::Passed => {
                let Some(passage) = self.tracker.passages.last() else { return Located::default() };
                let pose = self.tracker.nodes[passage.node].pose.compose(passage.from_node);
                (pose, passage.points.clone())
            }
        };
        if self.followed.is_some() {
            let is_due =
                matches!(step, Step::Node(_)) || record.time_s - self.checked_s >= self.config.check_s;
            return self.follow(scanner_in_tracking, &points, is_due.then_some(record.time_s));
        }
        if matches!(step, Step::Node(_)) {
            self.search_if_due();
        }
        match &self.followed {
            Some(followed) => {
                let pose = followed.tracking_in_map.compose(scanner_in_tracking);
                Located { belief: Belief::Found, pose: Some(pose), score: 0.0 }
            }
            None => Located::default(),
        }
    }

    fn follow(&mut self, scanner_in_tracking: Se2, points: &[Point2], checked_s: Option<f64>) -> Located {
        let Some(followed) = &mut self.followed else { return Located::default() };
        let expected = followed.tracking_in_map.compose(scanner_in_tracking);
        let Some(checked_s) = checked_s else {
            let belief = belief(&self.config, &followed.scores);
            return Located { belief, pose: Some(expected), score: 0.0 };
        };
        self.checked_s = checked_s;
        let levels = self.map.levels();
        // Drift of the tracking since the last scan: a few centimetres and a degree.
        let information = Matrix3::from_diagonal(&Vector3::new(100.0, 100.0, 2_500.0));
        let guess = Guess { start: expected.single(), expected: expected.single(), information };
        let refined = refine(&levels[0], points, &guess, &self.config.descent);
        let pose = Se2::from(refined.pose);
        let score = if points.is_empty() { 0.0 } else { refined.score };
        followed.scores.push_back(score);
        while followed.scores.len() > self.config.memory {
            followed.scores.pop_front();
        }
        if score >= self.config.doubt_below {
            followed.tracking_in_map = pose.compose(scanner_in_tracking.inverse());
        }
        let belief = belief(&self.config, &followed.scores);
        if belief == Belief::Unknown {
            self.lose();
            return Located { belief, pose: None, score };
        }
        Located { belief, pose: Some(pose), score }
    }

    fn lose(&mut self) {
        self.statistics.lost += 1;
        self.followed = None;
        self.hypothesis = None;
        self.searcher = Searcher::default();
        self.since = self.tracker.nodes.len().saturating_sub(1);
        self.path_m = 0.0;
        self.searched_m = None;
        self.next_path_m = self.config.next_path_m;
    }

    fn search_if_due(&mut self) {
        let due = self.searched_m.map_or(self.config.first_path_m, |last| last + self.next_path_m);
        if self.path_m < due {
            return;
        }
        self.searched_m = Some(self.path_m);
        let nodes = &self.tracker.nodes;
        let Some(query) = Query::new(nodes, self.since, &self.config) else { return };
        self.statistics.searches += 1;
        let answer = self.searcher.search(&self.map, nodes, &query, &self.config);
        let SearchAnswer::Alone(tracking_in_map) = answer else {
            let statistics = &mut self.statistics;
            let count = match answer {
                SearchAnswer::Nowhere => &mut statistics.nowhere,
                SearchAnswer::Contradicted => &mut statistics.contradicted,
                SearchAnswer::Ambiguous | SearchAnswer::Alone(_) => &mut statistics.ambiguous,
            };
            *count += 1;
            self.hypothesis = None;
            self.next_path_m = (self.next_path_m * self.config.patience).min(self.config.next_path_most_m);
            return;
        };
        self.next_path_m = self.config.next_path_m;
        let (distance_m, turn_rad) = self.config.agree;
        let agreeing = self.hypothesis.filter(|before| {
            let last = nodes.last().map(|node| node.pose).unwrap_or_default();
            let away = before.tracking_in_map.compose(last).between(tracking_in_map.compose(last));
            away.length_m() <= distance_m && away.heading_rad.abs() <= turn_rad
        });
        let since_m = agreeing.map_or(self.path_m, |before| before.since_m);
        self.hypothesis = Some(Hypothesis { since_m, tracking_in_map });
        if self.path_m - since_m >= self.config.confirm_path_m {
            self.followed = Some(Followed { tracking_in_map, scores: VecDeque::new() });
            self.hypothesis = None;
            self.searcher = Searcher::default();
            self.statistics.found += 1;
        }
    }
}

/// By the scans of the last metres; the last two alone raise a doubt.
fn belief(config: &LocaliseConfig, scores: &VecDeque<f32>) -> Belief {
    let mean = |count: usize| {
        let count = count.min(scores.len()).max(1);
        scores.iter().rev().take(count).sum::<f32>() / count as f32
    };
    if scores.is_empty() {
        Belief::Found
    } else if scores.len() >= config.memory / 2 && mean(config.memory / 2) < config.lost_below {
        Belief::Unknown
    } else if mean(2) < config.doubt_below || mean(config.memory) < config.doubt_below {
        Belief::Doubt
    } else {
        Belief::Found
    }
}
