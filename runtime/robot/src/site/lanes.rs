//! Lanes over the whole floor: the systematic strategy, and wet cleaning with headlands.

use floorguard_cleaning::Lane;
use floorguard_types::geometry::Point2;

use super::floor::{CELL_M, Floor};

/// Places of a cell, from its centre, that must all be covered, metres.
const SAMPLES_M: [(f32, f32); 5] = [(0.0, 0.0), (0.04, 0.04), (-0.04, 0.04), (0.04, -0.04), (-0.04, -0.04)];

/// Overlap of neighbouring lanes, metres (book, Cleaning: Strategies).
const OVERLAP_M: f32 = 0.025;

/// Parallel lanes along the longer axis over all floor that the robot's centre can reach, headlands across them where
/// they leave something out, in the order of a greedy sweep from `start`.
pub fn lanes(floor: &Floor, brush_m: f32, start: Point2) -> Vec<Lane> {
    let (mut lanes, along_x) = parallel(floor, brush_m - OVERLAP_M);
    let across = headlands(floor, (&lanes, brush_m), !along_x);
    lanes.extend(across);
    let rest = headlands(floor, (&lanes, brush_m), along_x);
    lanes.extend(rest);
    order(floor, lanes, start)
}

fn parallel(floor: &Floor, spacing_m: f32) -> (Vec<Lane>, bool) {
    let passable: Vec<Point2> =
        (0..floor.cells.cell_count()).filter(|&i| floor.passable[i]).map(|i| floor.cells.centre(i)).collect();
    let range = |pick: fn(&Point2) -> f32| {
        let low = passable.iter().map(pick).fold(f32::MAX, f32::min);
        (low, passable.iter().map(pick).fold(f32::MIN, f32::max))
    };
    let (x, y) = (range(|p| p.x_m), range(|p| p.y_m));
    let along_x = x.1 - x.0 >= y.1 - y.0;
    let (long, short) = if along_x { (x, y) } else { (y, x) };
    // As many lanes as the spacing needs, spread so that the outermost ones run along both walls.
    let count = ((short.1 - short.0) / spacing_m).ceil().max(1.0) as usize;
    let at = |along: f32, across: f32| {
        if along_x { Point2::new(along, across) } else { Point2::new(across, along) }
    };
    let clearance = floor.robot_radius_m + 0.02;
    let mut lanes = Vec::new();
    for lane in 0..=count {
        let across = short.0 + (short.1 - short.0) * lane as f32 / count as f32;
        let steps = ((long.1 - long.0) / 0.025).round() as usize;
        let mut open: Option<f32> = None;
        let mut last = long.0;
        for step in 0..=steps {
            let along = long.0 + (long.1 - long.0) * step as f32 / steps.max(1) as f32;
            let point = at(along, across);
            let inside = floor.cells.cell_at(point).is_some_and(|c| floor.passable[c]);
            if inside && floor.clearance.clearance_m(point) >= clearance {
                open.get_or_insert(along);
                last = along;
            } else if let Some(from) = open.take() {
                lanes.push(Lane { from: at(from, across), to: at(last, across) });
            }
        }
        if let Some(from) = open {
            lanes.push(Lane { from: at(from, across), to: at(last, across) });
        }
    }
    (lanes, along_x)
}

/// Lanes through the runs of cells that `lanes` leave out, along x or along y.
fn headlands(floor: &Floor, (lanes, brush_m): (&[Lane], f32), along_x: bool) -> Vec<Lane> {
    let covered = covered(floor, lanes, brush_m);
    let (width, height) = (i32::from(floor.cells.width()), i32::from(floor.cells.height()));
    let (lines, places) = if along_x { (height, width) } else { (width, height) };
    let cell_at = |line: i32, place: i32| {
        let (column, row) = if along_x { (place, line) } else { (line, place) };
        floor.cells.index(column, row)
    };
    let mut added = Vec::new();
    for line in 0..lines {
        let mut run: Option<(usize, usize)> = None;
        for place in 0..=places {
            let open = cell_at(line, place).filter(|&cell| floor.reachable[cell] && !covered[cell]);
            match (open, run) {
                (Some(cell), None) => run = Some((cell, cell)),
                (Some(cell), Some((first, _))) => run = Some((first, cell)),
                (None, Some((first, last))) => {
                    added.push(through(floor, (first, last), along_x));
                    run = None;
                }
                (None, None) => {}
            }
        }
    }
    added
}

/// From before the first cell to behind the last one, as far as the robot fits.
fn through(floor: &Floor, (first, last): (usize, usize), along_x: bool) -> Lane {
    let (a, b) = (floor.cells.centre(first), floor.cells.centre(last));
    let beyond = |point: Point2, by: f32| {
        let (dx, dy) = if along_x { (by, 0.0) } else { (0.0, by) };
        let end = Point2::new(point.x_m + dx, point.y_m + dy);
        if floor.is_clear(point, end) { end } else { point }
    };
    Lane { from: beyond(a, -0.5 * CELL_M), to: beyond(b, 0.5 * CELL_M) }
}

/// Reachable cells of which all sample places lie below the brush on some lane.
fn covered(floor: &Floor, lanes: &[Lane], brush_m: f32) -> Vec<bool> {
    let mut seen = vec![0_u8; floor.cells.cell_count()];
    for &Lane { from, to } in lanes {
        let length_m = from.distance(to).max(1e-6);
        let (ux, uy) = ((to.x_m - from.x_m) / length_m, (to.y_m - from.y_m) / length_m);
        let low = Point2::new(from.x_m.min(to.x_m) - brush_m, from.y_m.min(to.y_m) - brush_m);
        let high = Point2::new(from.x_m.max(to.x_m) + brush_m, from.y_m.max(to.y_m) + brush_m);
        let (first, last) = (floor.cells.coordinates_of(low), floor.cells.coordinates_of(high));
        for row in first.row..=last.row {
            for column in first.column..=last.column {
                let Some(cell) = floor.cells.index(column, row) else { continue };
                let centre = floor.cells.centre(cell);
                for (bit, (x, y)) in SAMPLES_M.iter().enumerate() {
                    let (dx, dy) = (centre.x_m + x - from.x_m, centre.y_m + y - from.y_m);
                    let (along, beside) = (dx * ux + dy * uy, dx * uy - dy * ux);
                    // Half a cell beyond the end is what a wall leaves.
                    let is_along = along > -0.5 * CELL_M && along < length_m + 0.5 * CELL_M;
                    if is_along && beside.abs() <= 0.5 * brush_m {
                        seen[cell] |= 1 << bit;
                    }
                }
            }
        }
    }
    seen.iter().map(|&bits| u32::from(bits).count_ones() as usize == SAMPLES_M.len()).collect()
}

/// The nearest end of any lane next; a lane that cannot be reached in a straight line counts three times as far.
fn order(floor: &Floor, mut lanes: Vec<Lane>, start: Point2) -> Vec<Lane> {
    let mut here = start;
    let mut ordered = Vec::with_capacity(lanes.len());
    while !lanes.is_empty() {
        let mut best: Option<(f32, usize, bool)> = None;
        for (index, lane) in lanes.iter().enumerate() {
            for (end, turned) in [(lane.from, false), (lane.to, true)] {
                let far = here.distance(end);
                let least = best.map_or(f32::MAX, |b| b.0);
                // The line of sight is expensive: only for what can still win.
                let cost = match far {
                    far if far >= least => continue,
                    far if floor.is_clear(here, end) => far,
                    far => 3.0 * far,
                };
                if cost < least {
                    best = Some((cost, index, turned));
                }
            }
        }
        let Some((_, index, turned)) = best else { break };
        let lane = lanes.swap_remove(index);
        let lane = if turned { Lane { from: lane.to, to: lane.from } } else { lane };
        here = lane.to;
        ordered.push(lane);
    }
    ordered
}
