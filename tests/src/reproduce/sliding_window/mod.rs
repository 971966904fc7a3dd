//! The window of an actuated lidar (Dalmedico et al. 2019), in a ray-cast simulation: `cargo xtask reproduce
//! sliding-window`.
//!
//! Scene, rays, noise, motor and judges are this module's own, in double precision; of the core only the window is taken.

mod accuracy;
mod drift;
mod navigation;
mod people;
mod picture;
mod reconstruction;
mod rig;
mod scene;
mod tables;

use std::path::Path;

use anyhow::anyhow;
use floorguard_mapping::sliding_window::{
    CellPolicy, SlidingWindow, WindowCell, WindowGeometry, WindowOptions,
};

pub use accuracy::{Accuracy, accuracy};
pub use drift::{Drift, drift};
pub use navigation::{Navigation, navigation};
pub use people::{Arrows, Erasure, arrows, erasure};
pub use reconstruction::{Reconstruction, reconstruction};
pub use scene::{Scene, Solid, Walker};

/// A window on the heap.
pub type Window = SlidingWindow<Vec<WindowCell>>;

/// An empty window with cells of an edge in metres.
///
/// # Errors
/// An edge that no window has.
pub fn window(resolution: f64, policy: CellPolicy) -> anyhow::Result<Window> {
    let geometry =
        WindowGeometry::of_resolution(resolution as f32).ok_or_else(|| anyhow!("cells of {resolution} m"))?;
    let buffers = [0, 1].map(|_| vec![WindowCell::EMPTY; geometry.cells()]);
    Ok(SlidingWindow::new(geometry, WindowOptions::published(policy), buffers)?)
}

/// Runs everything with `trials` lines of each table, writes tables and pictures into `folder`, and returns the text and
/// whether everything that must show did.
///
/// # Errors
/// A folder or a file that cannot be written.
pub fn sliding_window(trials: u64, folder: &Path) -> anyhow::Result<(String, bool)> {
    std::fs::create_dir_all(folder)?;
    let (mut text, mut holds) = (String::new(), true);
    let mut add = |part: (String, bool)| {
        let verdict = if part.1 { "holds" } else { "DOES NOT HOLD" };
        eprintln!("{}{verdict}\n", part.0);
        text.push_str(&format!("{}{verdict}\n\n", part.0));
        holds &= part.1;
    };
    let tables = accuracy(trials, |point| point)?;
    tables.draw(folder)?;
    add((tables.text(), tables.holds()));
    let rooms = reconstruction(CellPolicy::Nearest)?;
    rooms.draw(folder)?;
    add((rooms.text(), rooms.holds()));
    let drive = navigation(true)?;
    drive.draw(folder)?;
    add((drive.text(), drive.holds()));
    let person = erasure(true)?;
    person.draw(folder)?;
    add((person.text(), person.holds()));
    let walkers = arrows()?;
    walkers.draw(folder)?;
    add((walkers.text(), walkers.holds()));
    let still = drift(|point| point)?;
    add((still.text(), still.holds()));
    std::fs::write(folder.join("sliding_window.txt"), &text)?;
    Ok((text, holds))
}
