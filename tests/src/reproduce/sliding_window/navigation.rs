//! A drive around a corner: 3 m, a turn of 90°, 2 m.

use std::path::Path;

use floorguard_mapping::sliding_window::{
    CellPolicy, OccupancyScale, Plan, PlanCell, SightLimits, WindowPoint,
};
use floorguard_types::geometry::Point2;
use floorguard_types::time::Stamp;

use super::picture::{draw, plan_squares};
use super::reconstruction::accurate_share;
use super::rig::{Rig, Stand, Sweep};
use super::scene::{Scene, Solid};
use super::window;

/// Metres and radians per second; lengths of both legs, metres.
const SPEED: f64 = 0.3;
const TURN: f64 = 0.5;
const LEGS: [f64; 2] = [3.0, 2.0];
const QUARTER: f64 = std::f64::consts::FRAC_PI_2;
/// The sweep is as fast as coverage at 0.1 m allows, so that walls are seen while they pass.
const SWEEP: Sweep = Sweep { speed: 1.0, ..Sweep::WINDOW };
/// A surface may be so far from a true one: a cell, and three deviations of the lidar at 3 m, metres.
const TOLERANCE: f64 = 0.115;
/// Shares that must be right.
const ACCURATE_MIN: f64 = 0.97;
const OCCUPIED_MIN: f64 = 0.97;
/// Diagonal of a cell of the plan and the tolerance: an occupied cell has a wall within that, metres.
const CELL_REACH: f64 = 0.145 + TOLERANCE;

/// What the drive left.
#[derive(Clone, Debug)]
pub struct Navigation {
    /// Share of the window's surfaces that lie on a true one, after the drive.
    pub accurate: f64,
    /// Share of the plan's occupied cells that have a wall.
    pub occupied_right: f64,
    /// Occupied cells of the plan.
    pub occupied: usize,
    /// Cells of the plan in the middle of a wall that it calls free.
    pub walls_free: usize,
    /// Cells of the path that the plan does not call free, of all.
    pub path_blocked: usize,
    path_cells: usize,
    plan: Plan<Vec<PlanCell>>,
}

/// Two corridors of 1.6 m, one ahead and one to the left at its end, with a closed end each.
fn corridors() -> Scene {
    let solids = vec![
        Solid::wall([-2.0, -0.9], [3.9, -0.8]),
        Solid::wall([-2.0, 0.8], [2.2, 0.9]),
        Solid::wall([3.8, -0.9], [3.9, 4.6]),
        Solid::wall([2.1, 0.8], [2.2, 4.6]),
        Solid::wall([2.1, 4.5], [3.9, 4.6]),
        Solid::Box { low: [2.2, 3.9, 0.0], high: [2.5, 4.5, 0.5] },
    ];
    Scene { solids, walkers: Vec::new() }
}

/// Seconds before the robot drives: one sweep.
const FIRST_LOOK: f64 = 4.0;

/// Seconds of it all.
fn duration() -> f64 {
    FIRST_LOOK + LEGS[0] / SPEED + QUARTER / TURN + LEGS[1] / SPEED
}

fn stand(seconds: f64) -> Stand {
    let seconds = (seconds - FIRST_LOOK).max(0.0);
    let first = seconds.min(LEGS[0] / SPEED);
    let turning = (seconds - LEGS[0] / SPEED).clamp(0.0, QUARTER / TURN);
    let second = (seconds - LEGS[0] / SPEED - QUARTER / TURN).clamp(0.0, LEGS[1] / SPEED);
    Stand { x: SPEED * first, y: SPEED * second, heading: TURN * turning }
}

/// Drives around the corner. Without `follows` the window gets poses of a robot that stands still: what the judges must refuse.
///
/// # Errors
/// A scan that the window refuses: none in practice.
pub fn navigation(follows: bool) -> anyhow::Result<Navigation> {
    let (scene, mut window) = (corridors(), window(0.05, CellPolicy::Nearest)?);
    let storage = vec![PlanCell::UNKNOWN; 80 * 80];
    let mut plan = Plan::square(80, Point2::default(), storage).expect("a plan of 16 m")?;
    let mut rig = Rig::new(SWEEP, 90);
    let limits = SightLimits::of_threshold(1.0);
    while rig.seconds() < duration() {
        let middle = stand(rig.seconds() + 0.025);
        let scan = rig.scan(&scene, stand);
        let beams = scan.beams.to_vec();
        let scan = floorguard_mapping::sliding_window::ColumnScan { beams: &beams, ..scan };
        let pose = if follows { middle } else { Stand::default() }.pose();
        let inserted = window.insert(&scan, &rig.motor, pose)?;
        if let Some(swept) = inserted.swept {
            let in_map = if follows { window.frame_in_odometry() } else { middle.pose() };
            plan.enter((&window, in_map), swept, (&limits, rig.now()));
        }
    }
    let frame = window.frame_in_odometry();
    let end =
        Stand { x: f64::from(frame.x_m), y: f64::from(frame.y_m), heading: f64::from(frame.heading_rad) };
    let end = if follows { end } else { stand(duration()) };
    let points: Vec<WindowPoint> = window.points().collect();
    let accurate = accurate_share(&points, &scene, (end, TOLERANCE));
    Ok(judged(plan, &scene, (accurate, rig.now())))
}

fn judged(plan: Plan<Vec<PlanCell>>, scene: &Scene, (accurate, now): (f64, Stamp)) -> Navigation {
    let mut percents = vec![0; plan.grid().values().len()];
    plan.export(OccupancyScale::PUBLISHED, now, &mut percents);
    let geometry = *plan.grid().geometry();
    let (mut occupied, mut right, mut walls_free) = (0_usize, 0_usize, 0_usize);
    for (index, percent) in percents.iter().enumerate() {
        let middle = geometry.centre(index);
        let place = [f64::from(middle.x_m), f64::from(middle.y_m), 0.4];
        let from_wall = scene.solids.iter().map(|solid| solid.distance(place)).fold(f64::INFINITY, f64::min);
        let is_in_wall = scene.solids.iter().any(|solid| {
            let Solid::Box { low, high } = solid else { return false };
            (0..2).all(|axis| (low[axis]..=high[axis]).contains(&place[axis]))
        });
        if *percent == 100 {
            occupied += 1;
            right += usize::from(from_wall <= CELL_REACH);
        }
        walls_free += usize::from(is_in_wall && *percent == 0);
    }
    let mut path: Vec<usize> = (0..)
        .map(|step| stand(f64::from(step) * 0.2))
        .take((duration() / 0.2) as usize)
        .filter_map(|at| geometry.cell_at(Point2::new(at.x as f32, at.y as f32)))
        .collect();
    path.dedup();
    let path_blocked = path.iter().filter(|cell| percents[**cell] != 0).count();
    let occupied_right = right as f64 / occupied as f64;
    Navigation { accurate, occupied_right, occupied, walls_free, path_blocked, path_cells: path.len(), plan }
}

impl Navigation {
    /// Walls are where they are, nothing of them is free, and the path is.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.accurate >= ACCURATE_MIN
            && self.occupied_right >= OCCUPIED_MIN
            && self.occupied > 100
            && self.walls_free == 0
            && self.path_blocked == 0
    }

    /// What was found.
    #[must_use]
    pub fn text(&self) -> String {
        format!(
            "Navigation: {} m, a turn of 90°, {} m between walls.\n\
             surfaces of the window on a true one: {:.1} %; occupied cells with a wall: {:.1} % of {}; wall cells called \
             free: {}; path cells not free: {} of {}\n",
            LEGS[0],
            LEGS[1],
            100.0 * self.accurate,
            100.0 * self.occupied_right,
            self.occupied,
            self.walls_free,
            self.path_blocked,
            self.path_cells,
        )
    }

    /// The plan after the drive, with the path.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn draw(&self, folder: &Path) -> anyhow::Result<()> {
        let line: Vec<(f64, f64)> = (0..(duration() * 5.0) as u32)
            .map(|step| stand(f64::from(step) * 0.2))
            .map(|at| (at.x, at.y))
            .collect();
        let near =
            |one: &super::picture::Square| (-3.0..5.0).contains(&one.x) && (-2.0..6.0).contains(&one.y);
        let squares: Vec<_> = plan_squares(&self.plan, Stamp::ZERO).into_iter().filter(near).collect();
        draw(&folder.join("navigation.svg"), "the floor after the drive around the corner", &squares, &line)
    }
}
