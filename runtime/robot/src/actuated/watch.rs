//! What the thread of the window tells others while it runs, and the map that it leaves.

use std::sync::{Arc, Mutex, PoisonError};

use super::window_map::WindowMap;

/// The window in figures.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct WindowReport {
    /// Scans that entered it.
    pub scans: u64,
    /// Points that became surfaces.
    pub surfaces: u64,
    /// Points on people.
    pub people_points: u64,
    /// Cells that hold something now.
    pub cells: usize,
    /// Area of the floor that was seen free and that is occupied, square metres.
    pub free_m2: f64,
    /// See `free_m2`.
    pub occupied_m2: f64,
    /// Movement arrows so far.
    pub arrows: usize,
    /// People that the list of people heard of.
    pub people_given: u64,
    /// Why scans, angles or boxes were refused: the first reason of each kind, and how many.
    pub refused: Vec<(String, u64)>,
    /// What motor and lidar reported as wrong.
    pub faults: Vec<String>,
}

impl WindowReport {
    /// For the console.
    #[must_use]
    pub fn words(&self) -> String {
        let refused: u64 = self.refused.iter().map(|(_, count)| count).sum();
        let reasons = self.refused.iter().map(|(why, count)| format!("; {count} refused: {why}"));
        let faults = self.faults.iter().map(|fault| format!("; {fault}"));
        format!(
            "{} scans entered, {refused} refused, {} cells hold something, {:.1} m² of floor free and {:.1} m² occupied, {} movement \
             arrows, {} people given{}{}",
            self.scans,
            self.cells,
            self.free_m2,
            self.occupied_m2,
            self.arrows,
            self.people_given,
            reasons.collect::<String>(),
            faults.collect::<String>()
        )
    }
}

#[derive(Default)]
struct Published {
    report: Option<WindowReport>,
    map: Option<WindowMap>,
}

/// The newest report; the thread of the window writes it each second, others read it when they like.
#[derive(Clone, Default)]
pub struct WindowWatch(Arc<Mutex<Published>>);

impl std::fmt::Debug for WindowWatch {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(out, "WindowWatch({:?})", self.report())
    }
}

impl WindowWatch {
    /// The newest report; `None` without a lidar that a motor turns.
    #[must_use]
    pub fn report(&self) -> Option<WindowReport> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).report.clone()
    }

    /// The window as it was at the end of the run, once.
    #[must_use]
    pub fn take_map(&self) -> Option<WindowMap> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).map.take()
    }

    pub(super) fn publish(&self, report: WindowReport) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).report = Some(report);
    }

    pub(super) fn leave(&self, map: WindowMap) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).map = Some(map);
    }
}
