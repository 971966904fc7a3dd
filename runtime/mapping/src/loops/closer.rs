//! Searches loops while the path grows.

use std::collections::VecDeque;

use floorguard_localisation::scan_matching::{
    Candidate, CellOffset, DescentConfig, Exclusion, Found, Guess, MotionPenalty, Refined, SearchScratch,
    SearchWindow, refine, search,
};
use floorguard_types::geometry::Pose2;
use nalgebra::Matrix3;

use super::config::LoopConfig;
use super::stretch::{Stretch, StretchField};
use super::verify::agreement;
use crate::front_end::Node;
use crate::pose_graph::{Edge, EdgeKind};
use crate::refine::ScanView;
use crate::se2::Se2;

/// What was searched and found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LoopStatistics {
    /// Pairs of stretches searched.
    pub searched: usize,
    /// No place with enough score.
    pub unlike: usize,
    /// The place lies near the rim of its window: what resembles it more may lie outside.
    pub at_rim: usize,
    /// A second place fits nearly as well.
    pub ambiguous: usize,
    /// One saw through what the other saw, or they share too little.
    pub contradicted: usize,
    /// Accepted.
    pub accepted: usize,
}

/// The search for loops.
pub struct LoopCloser {
    config: LoopConfig,
    /// The stretches so far.
    pub stretches: Vec<Stretch>,
    /// Searched fields of the last few stretches that were needed, the latest last.
    fields: VecDeque<(usize, StretchField)>,
    /// Pairs that wait for their search, in two steps: field, search.
    pub(super) waiting: VecDeque<Waiting>,
    /// Accepted loops between stretches.
    pub(super) links: Vec<[usize; 2]>,
    pub(super) next_node: usize,
    cells: Vec<CellOffset>,
    blocks: Vec<Candidate>,
    /// What was searched.
    pub statistics: LoopStatistics,
}

/// A pair of stretches that is to be compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Waiting {
    pub(super) stretch: usize,
    pub(super) other: usize,
    /// Path between both, metres.
    pub(super) path_m: f64,
    pub(super) has_field: bool,
}

/// Fields that are kept: some megabytes each.
const FIELDS_KEPT: usize = 2;
impl LoopCloser {
    /// Nothing yet.
    #[must_use]
    pub fn new(config: LoopConfig) -> Self {
        Self {
            config,
            stretches: Vec::new(),
            fields: VecDeque::new(),
            waiting: VecDeque::new(),
            links: Vec::new(),
            next_node: 0,
            cells: Vec::new(),
            blocks: Vec::new(),
            statistics: LoopStatistics::default(),
        }
    }

    /// Frees what is needed for searches alone; it is made again where it is needed.
    pub fn forget_fields(&mut self) {
        self.fields = VecDeque::new();
        self.cells = Vec::new();
        self.blocks = Vec::new();
    }

    /// Another one with nothing found yet.
    #[must_use]
    pub fn again(&self) -> Self {
        Self::new(self.config)
    }

    /// Cuts off the next stretch that has become complete, and names the earlier ones that it is to be compared with; `poses` are
    /// the best ones in the map so far. With `is_last`, the rest of the path is a stretch, too. False: none was complete.
    pub fn advance(&mut self, (nodes, views): (&[Node], &[ScanView]), poses: &[Se2], is_last: bool) -> bool {
        let mut travelled = 0.0;
        for node in self.next_node + 1..nodes.len() {
            travelled += nodes[node - 1].pose.distance(nodes[node].pose);
            if travelled >= self.config.stretch_m || node - self.next_node >= self.config.stretch_nodes {
                self.complete((nodes, views), poses, node);
                return true;
            }
        }
        let is_rest = is_last && nodes.len() > self.next_node + 1;
        if is_rest {
            self.complete((nodes, views), poses, nodes.len());
        }
        is_rest
    }

    /// All loops of the stretches that are complete, each stretch searched before the next one is cut off.
    pub fn search_all(
        &mut self,
        (nodes, views): (&[Node], &[ScanView]),
        poses: &[Se2],
        is_last: bool,
    ) -> Vec<Edge> {
        let mut found = Vec::new();
        loop {
            while self.is_searching() {
                found.extend(self.search_next(nodes, views, poses));
            }
            if !self.advance((nodes, views), poses, is_last) {
                return found;
            }
        }
    }

    fn complete(&mut self, scans: (&[Node], &[ScanView]), poses: &[Se2], end: usize) {
        let (nodes, _) = scans;
        let stretch = Stretch::new(scans, self.next_node..end, &self.config);
        self.next_node = end;
        let index = self.stretches.len();
        self.stretches.push(stretch);
        let paths = self.path_lengths(nodes, index);
        let here = self.stretches[index].place(poses);
        let mut partners: Vec<(f64, usize)> = (0..index)
            .filter(|&other| paths[other] >= self.config.path_least_m)
            .map(|other| (here.distance(self.stretches[other].place(poses)), other))
            .filter(|&(distance, other)| distance <= self.config.near_m + self.window_m(paths[other]))
            .collect();
        partners.sort_by(|a, b| a.0.total_cmp(&b.0));
        let waiting = |(_, other): (f64, usize)| Waiting {
            stretch: index,
            other,
            path_m: paths[other],
            has_field: false,
        };
        self.waiting.extend(partners.into_iter().take(self.config.partners_most).map(waiting));
    }

    /// Whether pairs of stretches wait for their search.
    #[must_use]
    pub fn is_searching(&self) -> bool {
        !self.waiting.is_empty()
    }

    /// Pairs of stretches that wait for their search.
    #[must_use]
    pub fn waiting(&self) -> usize {
        self.waiting.len()
    }

    /// Whether more pairs of the stretch that was joined last wait.
    #[must_use]
    pub fn goes_on(&self) -> bool {
        let next = self.waiting.front().map(|waiting| waiting.stretch);
        self.links.last().is_some_and(|[stretch, _]| next == Some(*stretch))
    }

    /// Takes the next step of the search that waits: makes a field, or searches a stretch in it. `views` are the scans by
    /// bearing. A pair that a loop joined meanwhile is compared all the same: the way between both was long.
    pub fn search_next(&mut self, nodes: &[Node], views: &[ScanView], poses: &[Se2]) -> Option<Edge> {
        let next = *self.waiting.front()?;
        self.prepare(next.other);
        if !next.has_field {
            self.waiting.front_mut()?.has_field = true;
            return None;
        }
        self.waiting.pop_front();
        self.statistics.searched += 1;
        let edge = self.compare((nodes, views), poses, [next.stretch, next.other], next.path_m)?;
        self.links.push([next.stretch, next.other]);
        Some(edge)
    }

    /// Makes the field of a stretch, if it is not there, and puts it last.
    fn prepare(&mut self, stretch: usize) {
        let found = self.fields.iter().position(|(index, _)| *index == stretch);
        let field = match found.and_then(|place| self.fields.remove(place)) {
            Some(field) => Some(field),
            None => self.stretches[stretch].field(&self.config).map(|field| (stretch, field)),
        };
        self.fields.extend(field);
        while self.fields.len() > FIELDS_KEPT {
            self.fields.pop_front();
        }
    }

    fn window_m(&self, path_m: f64) -> f64 {
        (self.config.window_m + self.config.drift_share * path_m).min(self.config.window_most_m)
    }

    /// Length of the shortest path from a stretch to all earlier ones; a loop has no length.
    fn path_lengths(&self, nodes: &[Node], from: usize) -> Vec<f64> {
        let count = self.stretches.len();
        let step = |a: usize| {
            nodes[self.stretches[a].centre]
                .pose
                .distance(nodes[self.stretches[a + 1].centre].pose)
                .max(0.5 * self.config.stretch_m)
        };
        let mut length = vec![f64::INFINITY; count];
        length[from] = 0.0;
        let mut done = vec![false; count];
        for _ in 0..count {
            let Some(here) =
                (0..count).filter(|&i| !done[i]).min_by(|&a, &b| length[a].total_cmp(&length[b]))
            else {
                break;
            };
            done[here] = true;
            let at = length[here];
            if here > 0 {
                length[here - 1] = length[here - 1].min(at + step(here - 1));
            }
            if here + 1 < count {
                length[here + 1] = length[here + 1].min(at + step(here));
            }
            for &[a, b] in &self.links {
                if a == here || b == here {
                    let there = a + b - here;
                    length[there] = length[there].min(at + 1.0);
                }
            }
        }
        length
    }

    /// Searches a stretch in an earlier one.
    fn compare(
        &mut self,
        scans: (&[Node], &[ScanView]),
        poses: &[Se2],
        [index, other]: [usize; 2],
        path_m: f64,
    ) -> Option<Edge> {
        let config = self.config;
        let (query, reference) = (&self.stretches[index], &self.stretches[other]);
        let levels = self.fields.back().filter(|(kept, _)| *kept == other)?.1.levels();
        let expected = reference.place(poses).between(query.place(poses));
        let window = config.window(expected, path_m);
        self.cells.resize(query.searched.len(), CellOffset::default());
        // The searched field has a block of the coarsest level for each that the window begins.
        let side = levels.last().map_or(1, |level| 1_usize << level.shift);
        let across = |half: i32| 2 * half.unsigned_abs() as usize;
        let rows = across(window.half_side_cells) / side + 1;
        let turns = across(window.half_turn_steps) + 1;
        self.blocks.resize(rows * rows * turns, Candidate::default());
        let found = observe(&levels, query, &window, (&mut self.cells, &mut self.blocks));
        let Some(found) = found else {
            self.statistics.unlike += 1;
            return None;
        };
        let aside_m = Se2::from(found.pose).distance(Se2::from(window.centre));
        if aside_m > config.inner_share * self.window_m(path_m) {
            // What resembles it more may lie outside.
            self.statistics.at_rim += 1;
            return None;
        }
        let guess = Guess { start: found.pose, expected: found.pose, information: Matrix3::zeros() };
        let refined = refine(&levels[0], &query.points, &guess, &descent(&config));
        if refined.score < config.score_least * 0.8 {
            self.statistics.unlike += 1;
            return None;
        }
        let (conflict, overlap) = mutual_sight(refined.pose, [query, reference], scans);
        if conflict > config.conflict_most || overlap < config.overlap_least {
            self.statistics.contradicted += 1;
            return None;
        }
        let needed = 1.0 - (1.0 - found.score) * config.loss_ratio;
        let second =
            SearchWindow { excluded: Some(config.exclusion(&found)), minimum_score: needed, ..window };
        if observe(&levels, query, &second, (&mut self.cells, &mut self.blocks)).is_some() {
            self.statistics.ambiguous += 1;
            return None;
        }
        self.statistics.accepted += 1;
        edge([reference.centre, query.centre], &refined)
    }
}

impl LoopConfig {
    /// Where a stretch is searched around its expected place, after a path of this length between both.
    fn window(&self, expected: Se2, path_m: f64) -> SearchWindow {
        let half_m = (self.window_m + self.drift_share * path_m).min(self.window_most_m);
        let [turn, growth, most] = self.turn_window_rad;
        let half_rad = (turn + growth * path_m).min(most);
        SearchWindow {
            centre: expected.single(),
            half_side_cells: (half_m as f32 / self.cell_m).ceil() as i32,
            half_turn_steps: (half_rad as f32 / self.turn_step_rad).ceil() as i32,
            turn_step_rad: self.turn_step_rad,
            penalty: MotionPenalty::default(),
            excluded: None,
            minimum_score: self.score_least * self.searched_share,
        }
    }

    /// Around the best place a second one is not looked for.
    fn exclusion(&self, found: &Found) -> Exclusion {
        Exclusion {
            column: found.place.column,
            row: found.place.row,
            turn: found.place.turn,
            half_side_cells: (0.8 / self.cell_m).ceil() as i32,
            half_turn_steps: (0.15 / self.turn_step_rad).ceil() as i32,
        }
    }
}

fn descent(config: &LoopConfig) -> DescentConfig {
    DescentConfig {
        reach_m: config.reach_m,
        return_deviation_m: 0.3,
        outlier_distance_m: 0.1,
        steps_max: 15,
        step_least: 5.0e-4,
    }
}

/// Both stretches' returns against the other's scans: share of conflicts, share of overlap.
fn mutual_sight(
    query_in_reference: Pose2,
    [query, reference]: [&Stretch; 2],
    scans: (&[Node], &[ScanView]),
) -> (f64, f64) {
    let (nodes, _) = scans;
    let forward: Vec<_> = query.points.iter().map(|point| query_in_reference.transform(*point)).collect();
    let inverse = Se2::from(query_in_reference).inverse().single();
    let backward: Vec<_> = reference.points.iter().map(|point| inverse.transform(*point)).collect();
    let there = agreement(&forward, nodes[reference.centre].pose, scans, reference.first..reference.end);
    let back = agreement(&backward, nodes[query.centre].pose, scans, query.first..query.end);
    (there.and(back).conflict_share(), there.overlap_share().max(back.overlap_share()))
}

/// The loop between two nodes, with what the returns tell of it.
fn edge([from, to]: [usize; 2], refined: &Refined) -> Option<Edge> {
    let (sin, cos) = libm::sincosf(refined.pose.heading_rad);
    let turn = Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0);
    let information = (turn.transpose() * refined.information * turn).map(f64::from);
    // Never surer than 3 cm and half a degree: the walls decide the rest.
    let floor = Matrix3::from_diagonal(&[9.0e-4, 9.0e-4, 8.0e-5].into());
    let covariance = (information + Matrix3::from_diagonal_element(1.0e-3)).try_inverse()? + floor;
    let information = covariance.try_inverse()?;
    Some(Edge { from, to, measured: Se2::from(refined.pose), information, kind: EdgeKind::Loop })
}

fn observe(
    levels: &[floorguard_mapping::match_field::FieldLevel<'_>],
    query: &Stretch,
    window: &SearchWindow,
    (cells, blocks): (&mut [CellOffset], &mut [Candidate]),
) -> Option<Found> {
    search(levels, &query.searched, window, SearchScratch { cells, blocks })
}
