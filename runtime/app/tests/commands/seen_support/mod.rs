//! A mission to be seen, and a browser to see it with.

mod browser;

pub use browser::{Page, browser};
use std::sync::Arc;

use floorguard_mapping::GridGeometry;
use floorguard_robot::cleaner::{CellState, Doubt, MissionPhase, MissionProgress, UncertainCell};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::time::Stamp;

/// A floor of 4 × 3 m of which so much is clean.
pub fn progress(share: f32) -> Arc<MissionProgress> {
    let geometry = GridGeometry::new(40, 30, 0.1, Point2::new(-2.0, -1.5)).expect("a floor");
    let cells = geometry.cell_count();
    let state = |cell: usize| match cell {
        cell if cell % 40 == 0 => CellState::OffLimits,
        cell if (cell as f32) < cells as f32 * share => CellState::Clean,
        cell if cell % 7 == 0 => CellState::Uncertain,
        _ => CellState::Dirty,
    };
    let states: Vec<CellState> = (0..cells).map(state).collect();
    let expected = |state: &CellState| if *state == CellState::Clean { 0.1 } else { 2.0 };
    Arc::new(MissionProgress {
        stamp: Stamp::ZERO,
        phase: if share < 1.0 { MissionPhase::Cleaning } else { MissionPhase::Done },
        geometry,
        odometry_in_map: Pose2::new(0.2, 0.1, 0.05),
        position_deviation_m: 0.02,
        expected_before: vec![2.0; cells],
        expected_now: states.iter().map(expected).collect(),
        cells: states,
        completion: share,
        claimed_fraction: share,
        uncertain: vec![UncertainCell { cell: 1_190, expected_units: 2.0, doubt: Doubt::Obstructed }],
        unreachable_cells: 3,
        tour: vec![Point2::new(0.0, 0.0), Point2::new(1.0, 0.5)],
        waypoints: Vec::new(),
        distance_m: 12.0,
        waited_s: 4.0,
        times: Default::default(),
        detours: 1,
        lanes: None,
    })
}
