//! Window, plan, people and what was refused, wherever scans come from.

use std::collections::BTreeMap;

use floorguard_host::outcome::BadInput;
use floorguard_mapping::Occupancy;
use floorguard_mapping::sliding_window::{
    CellPolicy, ColumnScan, Inserted, LidarMount, MotorTrack, MovementArrow, MovementArrows, PassedPerson,
    PersonBoxes, Plan, PlanCell, ScanError, SightLimits, SlidingWindow, SweptWedge, WindowCell,
    WindowGeometry, WindowOptions,
};
use floorguard_mapping_host::output::plan_map;
use floorguard_types::geometry::{Point2, Point3, Pose2};
use floorguard_types::time::Stamp;

/// Movement arrows that are kept, the first ones.
const ARROWS_MAX: usize = 10_000;
/// Cells of a side of the plan, of 0.2 m.
const PLAN_SIDE: u16 = 100;

/// What became of the scans.
#[derive(Clone, Debug, Default)]
pub struct Taken {
    /// Entered the window.
    pub scans: u64,
    /// Points that became surfaces.
    pub surfaces: u64,
    /// Points on people.
    pub people: u64,
    /// Refused: why, the first one in words, and how many.
    pub refused: BTreeMap<&'static str, Refusals>,
}

/// Refusals of one kind.
#[derive(Clone, Debug)]
pub struct Refusals {
    /// The first one.
    pub first: String,
    /// How many.
    pub count: u64,
}

impl Taken {
    /// Counts something that was not used.
    pub fn refuse(&mut self, kind: &'static str, words: String) {
        self.refused.entry(kind).or_insert(Refusals { first: words, count: 0 }).count += 1;
    }
}

/// How the window is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowSetup {
    /// Edge of a cell, metres.
    pub cell_m: f32,
    /// Which point a cell keeps.
    pub policy: CellPolicy,
    /// What hangs higher is no obstacle, metres.
    pub threshold_m: f32,
    /// How the lidar is mounted.
    pub mount: LidarMount,
}

/// All of it.
pub struct WindowMap {
    /// The surfaces around the robot.
    pub window: SlidingWindow<Vec<WindowCell>>,
    /// Floor and ceiling.
    pub plan: Plan<Vec<PlanCell>>,
    /// What became of the scans.
    pub taken: Taken,
    /// When the newest of them was measured.
    pub now: Stamp,
    arrows: MovementArrows,
    found: Vec<MovementArrow>,
    limits: SightLimits,
}

impl WindowMap {
    /// Empty.
    ///
    /// # Errors
    /// A cell that no window has.
    pub fn new(setup: &WindowSetup) -> Result<Self, BadInput> {
        let bad = |what: String| BadInput(what);
        let geometry = WindowGeometry::of_resolution(setup.cell_m)
            .ok_or_else(|| bad(format!("cells of {} m: from 0.01 to 0.5", setup.cell_m)))?;
        let options = WindowOptions { mount: setup.mount, ..WindowOptions::published(setup.policy) };
        let buffers = [0, 1].map(|_| vec![WindowCell::EMPTY; geometry.cells()]);
        let window =
            SlidingWindow::new(geometry, options, buffers).map_err(|error| bad(error.to_string()))?;
        let cells = vec![PlanCell::UNKNOWN; usize::from(PLAN_SIDE) * usize::from(PLAN_SIDE)];
        let plan = Plan::square(PLAN_SIDE, Point2::new(0.0, 0.0), cells)
            .ok_or_else(|| bad("no plan of that size".to_owned()))?
            .map_err(|error| bad(error.to_string()))?;
        Ok(Self {
            window,
            plan,
            taken: Taken::default(),
            now: Stamp::ZERO,
            arrows: MovementArrows::new(),
            found: Vec::new(),
            limits: SightLimits::of_threshold(setup.threshold_m),
        })
    }

    /// Takes a scan of an actuated lidar, or counts why not.
    pub fn insert(&mut self, scan: &ColumnScan<'_>, motor: &MotorTrack, pose: Pose2) {
        match self.window.insert(scan, motor, pose) {
            Ok(inserted) => {
                self.now = scan.first_beam;
                let returns: Vec<Point2> = self.window.person_returns().collect();
                for place in returns {
                    self.arrows.take(place, scan.first_beam);
                }
                self.count(inserted);
                if let Some(swept) = inserted.swept {
                    self.enter(swept);
                }
            }
            Err(error) => self.taken.refuse(kind(error), error.to_string()),
        }
    }

    /// Takes points of another mechanism.
    pub fn insert_points(&mut self, points: &[Point3], stamp: Stamp) {
        match self.window.insert_points(points, Pose2::default(), stamp) {
            Ok(inserted) => {
                self.now = stamp;
                self.count(inserted);
                self.enter(SweptWedge::ALL);
            }
            Err(error) => self.taken.refuse(kind(error), error.to_string()),
        }
    }

    /// Takes the people of a picture.
    pub fn take_people(&mut self, boxes: &PersonBoxes<'_>, now: Stamp) {
        if let Err(error) = self.window.take_people(boxes, now) {
            self.taken.refuse("boxes", error.to_string());
        }
    }

    /// The next person whom the sweep has left: a detection for the list of people.
    pub fn next_passed(&mut self, now: Stamp) -> Option<PassedPerson> {
        self.arrows.next_passed(now)
    }

    /// Area of the plan's floor in a state, square metres.
    #[must_use]
    pub fn area_m2(&self, state: Occupancy) -> f64 {
        plan_map(&self.plan, self.now).area_m2(state)
    }

    /// The motor turned back.
    pub fn end_sweep(&mut self) {
        self.arrows.end_sweep();
        let room = ARROWS_MAX.saturating_sub(self.found.len());
        self.found.extend(self.arrows.arrows().iter().take(room));
    }

    /// Where people walked.
    #[must_use]
    pub fn arrows(&self) -> &[MovementArrow] {
        &self.found
    }

    fn count(&mut self, inserted: Inserted) {
        self.taken.scans += 1;
        self.taken.surfaces += u64::from(inserted.surfaces);
        self.taken.people += u64::from(inserted.people);
    }

    fn enter(&mut self, swept: SweptWedge) {
        let in_map = self.window.frame_in_odometry();
        self.plan.enter((&self.window, in_map), swept, (&self.limits, self.now));
    }
}

fn kind(error: ScanError) -> &'static str {
    match error {
        ScanError::MotorStalled { .. } => "motor_stalled",
        ScanError::AngleMissing { .. } => "angle_missing",
        ScanError::OutOfOrder { .. } => "out_of_order",
        ScanError::BeamCount { .. } => "beam_count",
        ScanError::NotFinite => "not_finite",
    }
}
