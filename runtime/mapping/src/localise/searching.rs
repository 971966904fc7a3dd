//! One search of the whole map.

use floorguard_localisation::scan_matching::{
    Candidate, CellOffset, Exclusion, Guess, MotionPenalty, SearchScratch, SearchWindow, refine, search,
};
use nalgebra::Matrix3;

use super::config::LocaliseConfig;
use super::known_map::KnownMap;
use super::query::Query;
use crate::front_end::Node;
use crate::se2::Se2;

/// What a search says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SearchAnswer {
    /// One place, and no other that is nearly as good: pose of the last scan in the map.
    Alone(Se2),
    /// No place fits.
    Nowhere,
    /// Another place fits nearly as well.
    Ambiguous,
    /// Beams went through walls there.
    Contradicted,
}

/// Blocks that a search can keep.
const BLOCKS: usize = 400_000;
/// A second place is another one beyond this, metres and radians.
const APART: (f32, f32) = (1.0, 0.3);
/// Scans and beams of each that are asked whether they went through walls.
const ASKED_SCANS: usize = 10;
const ASKED_BEAMS: usize = 90;

/// Room for searches.
pub struct Searcher {
    cells: Vec<CellOffset>,
    blocks: Vec<Candidate>,
}

impl Searcher {
    pub fn new() -> Self {
        Self { cells: Vec::new(), blocks: vec![Candidate::default(); BLOCKS] }
    }

    /// Searches the whole map, all headings.
    pub fn search(
        &mut self,
        map: &KnownMap,
        nodes: &[Node],
        query: &Query,
        config: &LocaliseConfig,
    ) -> SearchAnswer {
        let levels = map.levels();
        self.cells.resize(query.points.len(), CellOffset::default());
        let window = SearchWindow {
            centre: map.centre(),
            half_side_cells: map.half_side_cells(),
            half_turn_steps: (std::f32::consts::PI / config.turn_step_rad).ceil() as i32,
            turn_step_rad: config.turn_step_rad,
            penalty: MotionPenalty::default(),
            excluded: None,
            minimum_score: config.score_least * 0.9,
        };
        let (cells, blocks) = (&mut self.cells, &mut self.blocks);
        let Some(found) = search(&levels, &query.points, &window, SearchScratch { cells, blocks }) else {
            return SearchAnswer::Nowhere;
        };
        let guess = Guess { start: found.pose, expected: found.pose, information: Matrix3::zeros() };
        let refined = refine(&levels[0], &query.points, &guess, &config.descent);
        if refined.score < config.score_least {
            return SearchAnswer::Nowhere;
        }
        let pose = Se2::from(refined.pose);
        if through_share(map, nodes, query, pose) > config.through_most {
            return SearchAnswer::Contradicted;
        }
        let cell_m = levels[0].geometry.resolution_m();
        let excluded = Exclusion {
            column: found.place.column,
            row: found.place.row,
            turn: found.place.turn,
            half_side_cells: (APART.0 / cell_m).ceil() as i32,
            half_turn_steps: (APART.1 / config.turn_step_rad).ceil() as i32,
        };
        let minimum_score = 1.0 - (1.0 - found.score) * config.loss_ratio;
        let second = SearchWindow { excluded: Some(excluded), minimum_score, ..window };
        let (cells, blocks) = (&mut self.cells, &mut self.blocks);
        match search(&levels, &query.points, &second, SearchScratch { cells, blocks }) {
            Some(_) => SearchAnswer::Ambiguous,
            None => SearchAnswer::Alone(pose),
        }
    }
}

/// Share of the beams that went through a wall, with the last scan at `pose`.
fn through_share(map: &KnownMap, nodes: &[Node], query: &Query, pose: Se2) -> f64 {
    let Some(last) = nodes.last() else { return 1.0 };
    let scans = &nodes[query.first..];
    let (mut asked, mut through) = (0_usize, 0_usize);
    for node in scans.iter().rev().step_by(scans.len().div_ceil(ASKED_SCANS).max(1)) {
        let place = pose.compose(last.pose.between(node.pose));
        for point in node.points.iter().step_by(node.points.len().div_ceil(ASKED_BEAMS).max(1)) {
            asked += 1;
            through += usize::from(map.goes_through(place, *point));
        }
    }
    through as f64 / asked.max(1) as f64
}
