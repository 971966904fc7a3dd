//! A cleaning mission in a recording: what is claimed clean, how much dirt is expected, and how far it is.

use floorguard_types::geometry::Pose2;

use super::messages::{Diagnostic, GridImage, Severity};
use floorguard_robot::cleaner::{CellState, Doubt, MissionProgress};

/// Name of the mission among the diagnostics.
pub const MISSION: &str = "mission";

/// The status of each cell, as percent clean; −1 where the mission does not answer.
pub fn claimed_cells(progress: &MissionProgress) -> Vec<i8> {
    let percent = |state: &CellState| match state {
        CellState::OffLimits => -1,
        CellState::Dirty => 0,
        CellState::Active | CellState::Uncertain => 50,
        CellState::Clean => 100,
    };
    progress.cells.iter().map(percent).collect()
}

/// Dirt of each cell in percent of the dirtiest before the mission; −1 where the mission does not answer.
pub fn dirt_cells(progress: &MissionProgress, units: &[f32]) -> Vec<i8> {
    let most = progress.expected_before.iter().copied().fold(0.0_f32, f32::max).max(1.0e-6);
    let percent = |(state, units): (&CellState, &f32)| match state {
        CellState::OffLimits => -1,
        _ => (units / most * 100.0).clamp(0.0, 100.0) as i8,
    };
    progress.cells.iter().zip(units).map(percent).collect()
}

/// Cells of a mission as a map.
pub fn grid<'a>(progress: &MissionProgress, cells: &'a [i8]) -> GridImage<'a> {
    let corner = progress.geometry.origin_in_map();
    GridImage {
        resolution_m: progress.geometry.resolution_m(),
        width: progress.geometry.width().into(),
        origin: Pose2::new(corner.x_m, corner.y_m, 0.0),
        cells,
    }
}

/// Area of the cells in a state, m².
pub fn area_m2(progress: &MissionProgress, wanted: impl Fn(CellState) -> bool) -> f32 {
    let cells = progress.cells.iter().filter(|state| wanted(**state)).count();
    cells as f32 * progress.geometry.resolution_m() * progress.geometry.resolution_m()
}

/// Still to be cleaned, or not surely enough.
pub const fn remains(state: CellState) -> bool {
    matches!(state, CellState::Dirty | CellState::Active | CellState::Uncertain)
}

/// Why cells are not claimed: name of the count among the diagnostics, and the reason in plain words.
pub const DOUBTS: [(&str, &str); 4] = [
    ("doubt_not_visited_cells", Doubt::NotVisited.words()),
    ("doubt_path_unsure_cells", Doubt::PathUnsure.words()),
    ("doubt_obstructed_cells", Doubt::Obstructed.words()),
    ("doubt_given_up_cells", Doubt::GivenUp.words()),
];

/// How far it is.
pub fn diagnostic(progress: &MissionProgress) -> Diagnostic {
    let total = |units: &[f32]| units.iter().sum::<f32>();
    let values = [
        ("state", progress.phase.name().to_owned()),
        ("completion_percent", format!("{:.1}", progress.completion * 100.0)),
        ("claimed_percent", format!("{:.1}", progress.claimed_fraction * 100.0)),
        ("claimed_m2", format!("{:.2}", area_m2(progress, |state| state == CellState::Clean))),
        ("remaining_m2", format!("{:.2}", area_m2(progress, remains))),
        ("uncertain_cells", progress.uncertain.len().to_string()),
        ("unreachable_cells", progress.unreachable_cells.to_string()),
        ("dirt_before_units", format!("{:.0}", total(&progress.expected_before))),
        ("dirt_now_units", format!("{:.0}", total(&progress.expected_now))),
        ("distance_m", format!("{:.1}", progress.distance_m)),
        ("waited_s", format!("{:.1}", progress.waited_s)),
        ("detours", progress.detours.to_string()),
        ("position_deviation_m", format!("{:.3}", progress.position_deviation_m)),
    ];
    let doubts = DOUBTS.iter().map(|(name, words)| {
        let cells = progress.uncertain.iter().filter(|cell| cell.doubt.words() == *words).count();
        (*name, cells.to_string())
    });
    let values = values.into_iter().chain(doubts);
    Diagnostic {
        severity: Severity::Good,
        name: MISSION.to_owned(),
        message: format!("{}, {:.0} % done", progress.phase.name(), progress.completion * 100.0),
        values: values.map(|(name, value)| (name.to_owned(), value)).collect(),
    }
}
