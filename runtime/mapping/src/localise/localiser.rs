//! From scan to scan: searching, found, in doubt.

use std::collections::VecDeque;

use floorguard_localisation::scan_matching::{Guess, Refined, refine};
use floorguard_types::geometry::Point2;
use nalgebra::{Matrix3, Vector3};

use super::certainty::Certainty;
use super::config::LocaliseConfig;
use super::freshness::{Freshness, ScanAge};
use super::known_map::KnownMap;
use super::query::Query;
use super::searching::{SearchAnswer, Searcher};
use super::support::Support;
use crate::front_end::{Step, Tracker};
use crate::input::ScanRecord;
use crate::se2::Se2;

/// Beams of a scan that are asked when a place is checked.
const CHECKED_BEAMS: usize = 90;

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
    /// Standard deviation of the place in its weakest direction, metres: grows along a corridor whose walls say nothing about
    /// the way along it. 0 where the place is not known.
    pub deviation_m: f64,
    /// The place has not been known for so long that a person should say where the robot is.
    pub asks_for_help: bool,
}

/// What the searches came to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LocaliserStatistics {
    /// Searches of the whole map.
    pub searches: usize,
    /// No place fitted.
    pub nowhere: usize,
    /// A place led, but not clearly.
    pub ambiguous: usize,
    /// Beams went through walls at the best place, or its newest scans did not fit.
    pub contradicted: usize,
    /// Times that a place was found.
    pub found: usize,
    /// Times that it was lost.
    pub lost: usize,
    /// Scans that were not later than the one before; they are left out.
    pub not_later: usize,
    /// Scans that showed the same ranges while the robot moved; they are left out.
    pub frozen: usize,
}

/// The followed place: the frame of the tracking in the map.
struct Followed {
    tracking_in_map: Se2,
    /// Support of the last scans.
    supports: VecDeque<f64>,
    /// Where the place was last checked, in the frame of the tracking.
    checked_at: Se2,
    /// Path since the walls last held every direction, metres.
    unheld_m: f64,
}

impl Followed {
    const fn new(tracking_in_map: Se2, checked_at: Se2) -> Self {
        Self { tracking_in_map, supports: VecDeque::new(), checked_at, unheld_m: 0.0 }
    }
}

/// Localises the scans of a drive in a known map.
pub struct Localiser {
    config: LocaliseConfig,
    map: KnownMap,
    tracker: Tracker,
    searcher: Searcher,
    followed: Option<Followed>,
    hypothesis: Option<Certainty>,
    /// Path since the place was lost, and at the last search.
    path_m: f64,
    searched_m: Option<f64>,
    next_path_m: f64,
    checked_s: f64,
    unknown_since_s: Option<f64>,
    freshness: Freshness,
    last: Located,
    best_support: f64,
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
            path_m: 0.0,
            searched_m: None,
            next_path_m: config.next_path_m,
            checked_s: f64::NEG_INFINITY,
            unknown_since_s: None,
            freshness: Freshness::default(),
            last: Located::default(),
            best_support: f64::NEG_INFINITY,
            statistics: LocaliserStatistics::default(),
        }
    }

    /// Takes the next scan. A whole map is searched at some of them: tenths of a second in a building of 1,000 m².
    pub fn push(&mut self, record: &ScanRecord) -> Located {
        let mut located = match self.freshness.judge(record) {
            ScanAge::NotLater => {
                self.statistics.not_later += 1;
                return self.last;
            }
            ScanAge::Frozen => {
                self.statistics.frozen += 1;
                doubted(self.last)
            }
            ScanAge::Fresh => self.locate(record),
            ScanAge::AfterGap => doubted(self.locate(record)),
        };
        let is_unknown = located.belief == Belief::Unknown;
        let since_s = if is_unknown { self.unknown_since_s.or(Some(record.time_s)) } else { None };
        self.unknown_since_s = since_s;
        located.asks_for_help =
            since_s.is_some_and(|since_s| record.time_s - since_s > self.config.help_after_s);
        self.last = located;
        located
    }

    /// Forgets the place and the drive; the map stays.
    pub fn reset(&mut self) {
        self.lose();
        self.last = Located::default();
        self.best_support = f64::NEG_INFINITY;
    }

    /// Support of the best place at the last search, at most 1; −∞ before any.
    #[must_use]
    pub const fn best_support(&self) -> f64 {
        self.best_support
    }

    fn locate(&mut self, record: &ScanRecord) -> Located {
        self.forget_old_scans(record);
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
                (pose, passage.scan.points().into())
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
                Located { belief: Belief::Found, pose: Some(pose), ..Located::default() }
            }
            None => Located::default(),
        }
    }

    /// A robot drives for years: the tracking begins anew now and then, at the place that is known.
    fn forget_old_scans(&mut self, record: &ScanRecord) {
        let count = self.tracker.nodes.len() + self.tracker.passages.len();
        let (Some(followed), true) = (&mut self.followed, count >= self.config.scans_kept) else { return };
        let Some(pose) = self.last.pose else { return };
        // The new tracking begins at the odometry of this scan, the last one stood a scan before.
        let start = record.odometry.unwrap_or_default();
        let last = self.tracker.nodes.last().and_then(|node| node.odometry).zip(record.odometry);
        let moved = match (last, self.tracker.nodes.last()) {
            (Some((before, now)), Some(node)) => {
                let node_in_map = followed.tracking_in_map.compose(node.pose);
                pose.between(node_in_map.compose(before.between(now)))
            }
            _ => Se2::default(),
        };
        followed.tracking_in_map = pose.compose(moved).compose(start.inverse());
        followed.checked_at = start;
        self.tracker = Tracker::new(self.config.front_end);
    }

    fn follow(&mut self, scanner_in_tracking: Se2, points: &[Point2], checked_s: Option<f64>) -> Located {
        let Some(followed) = &mut self.followed else { return Located::default() };
        let expected = followed.tracking_in_map.compose(scanner_in_tracking);
        let Some(checked_s) = checked_s else {
            let belief = belief(&self.config, followed);
            let deviation_m = self.config.deviation_m(followed.unheld_m);
            return Located { belief, pose: Some(expected), deviation_m, ..Located::default() };
        };
        self.checked_s = checked_s;
        // Drift of the tracking since the last scan: a few centimetres and a degree.
        let information = Matrix3::from_diagonal(&Vector3::new(100.0, 100.0, 2_500.0));
        let guess = Guess { start: expected.single(), expected: expected.single(), information };
        let refined = refine(&self.map.levels()[0], points, &guess, &self.config.descent);
        let matched = Se2::from(refined.pose);
        let away = expected.between(matched);
        let (leap_m, leap_rad) = self.config.leap;
        let is_leap = away.length_m() > leap_m || away.heading_rad.abs() > leap_rad;
        let support_at = |pose: Se2| {
            let mut support = Support::default();
            support.ask_scan(&self.map, (pose, points), CHECKED_BEAMS);
            support.lenient_value()
        };
        // Where the scan fits as the tracking expects it, a leap is something that was moved.
        let unmoved = is_leap.then(|| support_at(expected)).filter(|value| *value >= self.config.doubt_below);
        let (pose, support, share) = match unmoved {
            Some(support) => (expected, support, 0.0),
            None => (matched, support_at(matched), if is_leap { 1.0 } else { self.config.correction_share }),
        };
        let score = if points.is_empty() { 0.0 } else { refined.score };
        followed.supports.push_back(support);
        while followed.supports.len() > self.config.memory {
            followed.supports.pop_front();
        }
        let is_good = unmoved.is_none() && support >= self.config.doubt_below;
        if is_good {
            let part = Se2::new(share * away.x_m, share * away.y_m, share * away.heading_rad);
            followed.tracking_in_map = expected.compose(part).compose(scanner_in_tracking.inverse());
        }
        followed.unheld_m += followed.checked_at.distance(scanner_in_tracking);
        followed.checked_at = scanner_in_tracking;
        if is_good && holds_every_direction(&refined, self.config.held_share) {
            followed.unheld_m = 0.0;
        }
        let belief = belief(&self.config, followed);
        if belief == Belief::Unknown {
            self.lose();
            return Located { belief, score, ..Located::default() };
        }
        let deviation_m = self.config.deviation_m(followed.unheld_m);
        Located { belief, pose: Some(pose), score, deviation_m, asks_for_help: false }
    }

    fn lose(&mut self) {
        self.statistics.lost += 1;
        self.followed = None;
        self.hypothesis = None;
        self.searcher = Searcher::default();
        self.tracker = Tracker::new(self.config.front_end);
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
        let Some(query) = Query::new(nodes, &self.config) else { return };
        self.statistics.searches += 1;
        let answer = self.searcher.search(&self.map, nodes, &query, &self.config);
        self.best_support = self.searcher.best_support();
        let lead = match answer {
            SearchAnswer::Lead(lead) => lead,
            SearchAnswer::Nowhere => return self.search_failed(|statistics| &mut statistics.nowhere),
            SearchAnswer::Contradicted => {
                return self.search_failed(|statistics| &mut statistics.contradicted);
            }
        };
        let last = nodes.last().map(|node| node.pose).unwrap_or_default();
        let hypothesis = Certainty::after(self.hypothesis, lead, (last, self.path_m), &self.config);
        self.hypothesis = Some(hypothesis);
        let is_clear =
            lead.margin >= self.config.lead_least.max(self.config.lead_metres / query.path_m.max(1.0));
        if !is_clear {
            self.statistics.ambiguous += 1;
            self.be_patient();
            return;
        }
        self.next_path_m = self.config.next_path_m;
        if hypothesis.is_enough(&self.config) {
            self.followed = Some(Followed::new(lead.tracking_in_map, last));
            self.hypothesis = None;
            self.searcher = Searcher::default();
            self.statistics.found += 1;
        }
    }

    fn search_failed(&mut self, count: impl Fn(&mut LocaliserStatistics) -> &mut usize) {
        *count(&mut self.statistics) += 1;
        self.hypothesis = None;
        self.be_patient();
    }

    /// The next search waits longer.
    fn be_patient(&mut self) {
        self.next_path_m = (self.next_path_m * self.config.patience).min(self.config.next_path_most_m);
    }
}

/// The same place, no longer certain.
fn doubted(located: Located) -> Located {
    let belief = if located.belief == Belief::Found { Belief::Doubt } else { located.belief };
    Located { belief, ..located }
}

/// Whether the returns hold the place along every direction: the smaller curvature of the match is a share of the larger one.
fn holds_every_direction(refined: &Refined, share: f32) -> bool {
    let [xx, xy, yy] = [(0, 0), (0, 1), (1, 1)].map(|at| refined.information[at]);
    let half_trace = 0.5 * (xx + yy);
    let root = (0.25 * (xx - yy) * (xx - yy) + xy * xy).sqrt();
    half_trace - root >= share * (half_trace + root) && half_trace > 0.0
}

/// By the scans of the last metres; the last two alone raise a doubt, and so does a long way that the walls did not hold.
fn belief(config: &LocaliseConfig, followed: &Followed) -> Belief {
    let supports = &followed.supports;
    let mean = |count: usize| {
        let count = count.min(supports.len()).max(1);
        supports.iter().rev().take(count).sum::<f64>() / count as f64
    };
    if config.deviation_m(followed.unheld_m) > config.deviation_most_m {
        Belief::Doubt
    } else if supports.is_empty() {
        Belief::Found
    } else if supports.len() >= config.memory / 2 && mean(config.memory / 2) < config.lost_below {
        Belief::Unknown
    } else if mean(2) < config.doubt_below || mean(config.memory) < config.doubt_below {
        Belief::Doubt
    } else {
        Belief::Found
    }
}
