//! Which cells a mission visits next: the tour, how often each cell was visited, and when to plan anew.

use floorguard_navigation::SearchCell;

use super::planner::{PlanCells, PlanReport, Planner};
use super::tour::TourError;

/// Re-planning interval, seconds (book, Cleaning: Re-planning).
const REPLAN_S: f32 = 5.0;

/// A tour with its memory of visits. `S` and `D` store the planner's search and distances, `V` a count for every cell of the
/// raster, `N` − 2 cells fit on the tour.
///
/// ```
/// use floorguard_cleaning::{PlanCells, Planner, VisitPlan};
/// use floorguard_mapping::GridGeometry;
/// use floorguard_navigation::{PathSearch, SearchCell};
/// use floorguard_types::{geometry::Point2, random::Pcg32};
///
/// let raster = GridGeometry::new(4, 1, 0.1, Point2::default()).unwrap();
/// let search = PathSearch::new(raster, [SearchCell::EMPTY; 4]);
/// let planner: Planner<_, _, 8> = Planner::new(search, [0; 64], Pcg32::new(1, 1));
/// let mut plan = VisitPlan::new(planner, [0; 4], 1);
/// let cells = PlanCells { wanted: |cell: usize| cell > 1, passable: |_: usize| true };
/// plan.replan((0, 0.0), &cells, 0).unwrap();
/// assert_eq!(plan.tour().collect::<Vec<_>>(), [2, 3]);
/// plan.finish(2);
/// // Visited as often as it may be: it is on no tour again.
/// plan.replan((2, 5.0), &cells, 0).unwrap();
/// assert_eq!(plan.tour().collect::<Vec<_>>(), [3]);
/// ```
#[derive(Clone, Debug)]
pub struct VisitPlan<S, D, V, const N: usize> {
    planner: Planner<S, D, N>,
    visits: V,
    visits_max: u8,
    next_plan_s: f32,
}

impl<S, D, V, const N: usize> VisitPlan<S, D, V, N>
where
    S: AsRef<[SearchCell]> + AsMut<[SearchCell]>,
    D: AsRef<[u16]> + AsMut<[u16]>,
    V: AsRef<[u8]> + AsMut<[u8]>,
{
    /// Nothing planned. A cell that was visited `visits_max` times is given up. The first plan is due at once.
    #[must_use]
    pub const fn new(planner: Planner<S, D, N>, visits: V, visits_max: u8) -> Self {
        Self { planner, visits, visits_max, next_plan_s: 0.0 }
    }

    /// The interval since the last plan is over, or somebody has asked for a plan.
    #[must_use]
    pub fn is_due(&self, now_s: f32) -> bool {
        now_s >= self.next_plan_s
    }

    /// The next plan is due then, seconds of the mission.
    pub const fn plan_at(&mut self, at_s: f32) {
        self.next_plan_s = at_s;
    }

    /// The next plan is due an interval from now.
    pub const fn plan_later(&mut self, now_s: f32) {
        self.next_plan_s = now_s + REPLAN_S;
    }

    /// The next plan is due an interval from now, if it was not due before.
    pub const fn plan_soon(&mut self, now_s: f32) {
        self.next_plan_s = self.next_plan_s.min(now_s + REPLAN_S);
    }

    /// The cell was not visited too often.
    #[must_use]
    pub fn may_visit(&self, cell: usize) -> bool {
        self.visits_of(cell) < self.visits_max
    }

    /// How often a cell was visited; a cell beyond the raster as often as it may be.
    #[must_use]
    pub fn visits_of(&self, cell: usize) -> u8 {
        self.visits.as_ref().get(cell).copied().unwrap_or(self.visits_max)
    }

    /// Visits of every cell.
    #[must_use]
    pub fn visits(&self) -> &[u8] {
        self.visits.as_ref()
    }

    /// Sets how often a cell was visited; a cell beyond the raster is ignored.
    pub fn set_visits(&mut self, cell: usize, count: u8) {
        if let Some(visits) = self.visits.as_mut().get_mut(cell) {
            *visits = count;
        }
    }

    /// No pass over the cell was found: it is on no tour again.
    pub fn give_up(&mut self, cell: usize) {
        self.set_visits(cell, self.visits_max);
    }

    /// Cells in the order of the visit.
    pub fn tour(&self) -> impl Iterator<Item = usize> + '_ {
        self.planner.tour()
    }

    /// Plans anew from the robot's cell at a time, over the wanted cells that may still be visited: see
    /// [`Planner::replan`]. The next plan is due an interval later.
    ///
    /// # Errors
    /// As [`Planner::replan`]; the tour is then the one before, without what is not wanted any more.
    pub fn replan(
        &mut self,
        (robot_cell, now_s): (usize, f32),
        cells: &PlanCells<impl Fn(usize) -> bool, impl Fn(usize) -> bool>,
        experiments: u32,
    ) -> Result<PlanReport, TourError> {
        self.plan_later(now_s);
        let (visits, visits_max) = (self.visits.as_ref(), self.visits_max);
        let PlanCells { wanted, passable } = cells;
        let is_open = |cell: usize| visits.get(cell).is_some_and(|count| *count < visits_max) && wanted(cell);
        self.planner.replan(robot_cell, &PlanCells { wanted: is_open, passable }, experiments)
    }

    /// The visit of a cell has ended: counts it, and takes the cell off the tour if it is the next one.
    pub fn finish(&mut self, cell: usize) {
        self.set_visits(cell, self.visits_of(cell).saturating_add(1));
        if self.planner.tour().next() == Some(cell) {
            self.planner.drop_first();
        }
    }
}
