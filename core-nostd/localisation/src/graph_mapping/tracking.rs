//! A scan matched against kept ones.

use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::number::saturating_i32;
use nalgebra::Matrix3;

use super::kept::index;
use super::lines::onto_lines;
use super::mapper::{FIELD_CELL_M, GraphMapper, KNOWN_PATH_M, Searching};
use super::surroundings::Surroundings;
use crate::scan_matching::{Guess, MotionPenalty, Refined, SearchScratch, SearchWindow, refine, search};

/// Returns of a scan that are matched, at most.
const MATCHED_MAX: usize = 160;
/// A scan of which a smaller mean value lies on the last ones fits nowhere.
pub(super) const SCORE_LEAST: f32 = 0.3;

/// Where a scan lies.
pub(super) struct Match {
    /// In the reference's frame; its score is the mean value of the field.
    pub(super) refined: Refined,
    /// Share of the returns that lie on a line of the kept scans.
    pub(super) share: f32,
}

impl<const NODES: usize, const POINTS: usize, const EDGES: usize, const CELLS: usize>
    GraphMapper<NODES, POINTS, EDGES, CELLS>
{
    /// Thins the returns into the room for searches.
    pub(super) fn take(&mut self, returns: &[Point2]) -> usize {
        let [least_m, most_m] = [self.config.range_least_m, self.config.range_most_m];
        let used = || returns.iter().filter(|point| point.norm() >= least_m && point.norm() <= most_m);
        let step = used().count().div_ceil(MATCHED_MAX).max(1);
        let mut count = 0_usize;
        for (room, point) in self.searching.points.iter_mut().zip(used().step_by(step)) {
            *room = *point;
            count = count.saturating_add(1);
        }
        count
    }

    /// Searches the scan among the returns around the reference; `half` is half the window, metres and radians. In the reference's frame.
    pub(super) fn locate(&mut self, count: usize, expected: Pose2, [half_m, half_rad]: [f32; 2]) -> Match {
        self.refresh_field();
        let surroundings = self.surroundings();
        let Searching { points, cells, blocks, nearest } = &mut self.searching;
        let scan = self.scans.get(index(self.reference));
        let (Some(points), Some(scan)) = (points.get(..count), scan) else {
            return Match { refined: Refined::none(), share: 0.0 };
        };
        let window = SearchWindow {
            centre: expected,
            half_side_cells: saturating_i32(half_m / FIELD_CELL_M),
            half_turn_steps: saturating_i32(half_rad / self.config.search_step_rad.max(1.0e-3)),
            turn_step_rad: self.config.search_step_rad,
            penalty: MotionPenalty {
                per_square_metre: self.config.rim_penalty / (half_m * half_m).max(1.0e-6),
                per_square_radian: self.config.rim_penalty / (half_rad * half_rad).max(1.0e-6),
            },
            excluded: None,
            minimum_score: 0.0,
        };
        let levels = self.field.levels();
        let found = search(&levels, points, &window, SearchScratch { cells, blocks });
        let start = found.map_or(expected, |found| found.pose);
        let inverse_square = |value: f32| 1.0 / (value * value).max(1.0e-6);
        let (place, heading) = (inverse_square(0.5 * half_m), inverse_square(0.5 * half_rad));
        let information = Matrix3::from_diagonal(&[place, place, heading].into());
        let guess = Guess { start, expected, information };
        let rough = refine(&levels[0], points, &guess, &self.config.descent);
        if rough.score < SCORE_LEAST {
            return Match { refined: rough, share: 0.0 };
        }
        let guess = Guess { start: rough.pose, ..guess };
        let into_frame = scan.pose.inverse();
        let scans = surroundings.of(&self.scans).map(|scan| (into_frame.compose(scan.pose), scan));
        let fine = onto_lines((points, nearest), &guess, scans);
        Match { refined: Refined { score: rough.score, ..fine }, share: fine.score }
    }

    /// Which kept scans a new one is matched against.
    fn surroundings(&self) -> Surroundings {
        let reference = self.scans.get(index(self.reference));
        let place = reference.map_or(Pose2::default(), |scan| scan.pose);
        let path_m = reference.map_or(0.0, |scan| scan.path_m);
        Surroundings { place, path_m, is_known: self.is_known(), recent_m: self.config.recent_m }
    }

    /// The field holds the surroundings of the reference in its frame.
    fn refresh_field(&mut self) {
        if core::mem::replace(&mut self.field_is_fresh, true) {
            return;
        }
        let Some(scan) = self.scans.get(index(self.reference)) else { return };
        let into_frame = scan.pose.inverse();
        let surroundings = self.surroundings();
        let field = &mut self.field;
        field.clear();
        for scan in surroundings.of(&self.scans) {
            let pose = into_frame.compose(scan.pose);
            scan.surfaces().for_each(|point| field.insert(pose.transform(point)));
        }
    }

    /// The robot is where it was before, or came from there a moment ago.
    pub(super) fn is_known(&self) -> bool {
        self.is_full() || self.path_m - self.known_path_m < KNOWN_PATH_M
    }

    /// Writes the returns of some scans into the field, in this frame.
    pub(super) fn fill_field(&mut self, frame: Pose2, [first, end]: [usize; 2]) {
        let field = &mut self.field;
        field.clear();
        let into_frame = frame.inverse();
        for scan in self.scans.get(first..end).unwrap_or_default() {
            let pose = into_frame.compose(scan.pose);
            scan.surfaces().for_each(|point| field.insert(pose.transform(point)));
        }
        self.field_is_fresh = false;
    }
}
