//! A box before the sensor: Tables 1 and 2 again.

use std::fmt::Write as _;
use std::path::Path;

use floorguard_laboratory::mission::pictures::{Series, line_plot};
use floorguard_mapping::sliding_window::{CellPolicy, Face, WindowPoint};

use super::rig::{Rig, Stand, Sweep};
use super::scene::{Scene, Solid};
use super::tables::{
    DISTANCES, NEAREST_PART, RESOLUTIONS, Spread, TABLE_ONE, TABLE_TWO, TOLERANCE, Table, box_cells,
    box_elevations, is_alike, is_as_published, is_half_of_published, mean_spread, spread,
};
use super::{Window, window};

/// Sweeps of a published line.
const SWEEPS: u64 = 3;
/// Share of the box's cells that a sweep must fill at 0.05 m and coarser: scans are 1.7° apart.
const FILLED_MIN: f64 = 0.9;
const POLICIES: [CellPolicy; 2] = [CellPolicy::Compat, CellPolicy::Nearest];

/// Both tables.
#[derive(Clone, Debug)]
pub struct Accuracy {
    /// Lines of three sweeps each.
    trials: u64,
    /// Table 1 with the published policy.
    pub compat: Table,
    /// Table 1 with the nearest point in each cell.
    pub nearest: Table,
    /// Table 2, in the order of [`TABLE_TWO`].
    pub sides: [Spread; 3],
    /// The least share of the box's cells that was filled with the nearest point, at 0.05 m and 0.1 m.
    pub filled: f64,
}

/// A carton of 40 cm on a pedestal of 10 cm, its face so far ahead of the origin.
fn carton(distance: f64) -> Scene {
    let (near, far) = (distance, distance + 0.4);
    let pedestal = Solid::Box { low: [near, -0.2, 0.0], high: [far, 0.2, 0.1] };
    let body = Solid::Box { low: [near, -0.2, 0.1], high: [far, 0.2, 0.5] };
    Scene { solids: vec![pedestal, body], walkers: Vec::new() }
}

/// One sweep over the box, which stands in the direction of a grid's normal.
fn sweep(windows: &mut [Window], (distance, turn): (f64, f64), seed: u64) {
    let scene = carton(distance);
    let mut rig = Rig::new(Sweep { half: 0.5, middle: turn, speed: Sweep::WINDOW.speed }, seed);
    let stand = Stand { heading: -turn, ..Stand::default() };
    while rig.sweep.number(rig.seconds()) == 0 {
        let scan = rig.scan(&scene, |_| stand);
        let beams = scan.beams.to_vec();
        let scan = floorguard_mapping::sliding_window::ColumnScan { beams: &beams, ..scan };
        for window in windows.iter_mut() {
            window.insert(&scan, &rig.motor, stand.pose()).expect("a scan");
        }
    }
}

/// Runs `trials` lines of three sweeps; every point of a window is read through `read`, so that a corrupted window can be
/// judged as well.
///
/// # Errors
/// None in practice: the windows are built in.
pub fn accuracy(trials: u64, read: impl Fn(WindowPoint) -> WindowPoint) -> anyhow::Result<Accuracy> {
    let mut tables = [Table::default(); 2];
    let mut filled = 1.0_f64;
    for (column, distance) in DISTANCES.into_iter().enumerate() {
        let mut spreads = vec![Vec::new(); 6];
        for seed in 0..trials * SWEEPS {
            let kinds = POLICIES.into_iter().flat_map(|policy| RESOLUTIONS.map(|r| (policy, r)));
            let mut windows: Vec<Window> =
                kinds.map(|(policy, r)| window(r, policy)).collect::<Result<_, _>>()?;
            sweep(&mut windows, (distance, 0.0), 1_000 * (column as u64 + 1) + seed);
            for (number, window) in windows.iter().enumerate() {
                let points: Vec<WindowPoint> = window.points().map(&read).collect();
                let resolution = RESOLUTIONS[number % 3];
                let elevations = box_elevations(&points, Face::Front, resolution);
                spreads[number].push(spread(&elevations));
                if number > 3 {
                    filled = filled.min(elevations.len() as f64 / box_cells(resolution) as f64);
                }
            }
        }
        for (number, spreads) in spreads.iter().enumerate() {
            tables[number / 3][number % 3][column] = mean_spread(spreads);
        }
    }
    let [compat, nearest] = tables;
    Ok(Accuracy { trials, compat, nearest, sides: sides(trials, read)?, filled })
}

/// Table 2: the box before each grid, as published.
fn sides(trials: u64, read: impl Fn(WindowPoint) -> WindowPoint) -> anyhow::Result<[Spread; 3]> {
    let mut found = [Spread::default(); 3];
    for (number, (face, _)) in TABLE_TWO.into_iter().enumerate() {
        let mut spreads = Vec::new();
        for seed in 0..trials * SWEEPS {
            let mut windows = [window(0.05, CellPolicy::Compat)?];
            let turn = f64::from(face.azimuth_rad());
            sweep(&mut windows, (1.0, turn), 5_000 + 1_000 * number as u64 + seed);
            let points: Vec<WindowPoint> = windows[0].points().map(&read).collect();
            spreads.push(spread(&box_elevations(&points, face, 0.05)));
        }
        found[number] = mean_spread(&spreads);
    }
    Ok(found)
}

impl Accuracy {
    /// Everything that the tables must show.
    #[must_use]
    pub fn holds(&self) -> bool {
        is_as_published(&self.compat)
            && is_half_of_published(&self.nearest)
            && is_alike(&self.sides)
            && self.filled >= FILLED_MIN
    }

    /// Both tables beside the published ones.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = format!(
            "Table 1: elevation of a box of 40 x 40 cm on a pedestal, means of {} times {SWEEPS} sweeps, error and \
             deviation in cm.\nMust be within {} cm of the published error (compat, growing with the cell) and at most \
             {NEAREST_PART} of it (nearest).\n\
             cell cm  distance m   published      compat    nearest\n",
            self.trials,
            100.0 * TOLERANCE
        );
        for (row, resolution) in RESOLUTIONS.into_iter().enumerate() {
            for (column, distance) in DISTANCES.into_iter().enumerate() {
                let cell = |table: &Table| {
                    let one = table[row][column];
                    format!("{:>5.2} {:>5.2}", 100.0 * (one.mean - distance), 100.0 * one.deviation)
                };
                let _infallible = writeln!(
                    text,
                    "{:>7.1}  {distance:>10.1}  {} {} {}",
                    100.0 * resolution,
                    cell(&TABLE_ONE),
                    cell(&self.compat),
                    cell(&self.nearest),
                );
            }
        }
        text.push_str(
            "\nTable 2: the same box at 1 m before each grid, cells of 5 cm, compat (the robot turned by 75°, so that \
             the box stands square before the lateral grids).\nMust be within the same tolerance together, and differ from grid to grid by no \
             more than the published ones.\ngrid    published        here\n",
        );
        for ((face, published), found) in TABLE_TWO.iter().zip(&self.sides) {
            let cell =
                |one: &Spread| format!("{:>5.2} {:>5.2}", 100.0 * (one.mean - 1.0), 100.0 * one.deviation);
            let name = format!("{face:?}").to_lowercase();
            let _infallible = writeln!(text, "{name:<6} {} {}", cell(published), cell(found));
        }
        let _infallible = writeln!(
            text,
            "cells of the box that a sweep fills at 5 and 10 cm, nearest: {:.1} % at least",
            100.0 * self.filled
        );
        text
    }

    /// Mean error over the edge of a cell, a picture for each distance.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn draw(&self, folder: &Path) -> anyhow::Result<()> {
        for (column, distance) in DISTANCES.into_iter().enumerate() {
            let tables = [("published", &TABLE_ONE), ("compat", &self.compat), ("nearest", &self.nearest)];
            let series: Vec<Series> = tables
                .into_iter()
                .map(|(name, table)| Series {
                    name: name.to_owned(),
                    points: RESOLUTIONS
                        .into_iter()
                        .zip(table)
                        .map(|(resolution, row)| (100.0 * resolution, 100.0 * (row[column].mean - distance)))
                        .collect(),
                })
                .collect();
            let title = format!("Table 1: a box at {distance} m");
            let path = folder.join(format!("table_one_{column}.svg"));
            line_plot(&path, (&title, "edge of a cell, cm", "mean error, cm"), &series)?;
        }
        Ok(())
    }
}
