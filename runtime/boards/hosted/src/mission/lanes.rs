//! Lanes over the whole floor: the systematic strategy, and wet cleaning with headlands.

use floorguard_core::geometry::Point2;

use super::floor::Floor;

/// A straight stretch to be driven.
pub type Lane = (Point2, Point2);

/// Overlap of neighbouring lanes, metres (algorithms I.9).
const OVERLAP_M: f32 = 0.025;

/// Parallel lanes along the longer axis over all floor that the robot's centre can reach, in the order of a greedy
/// sweep from `start`.
pub fn lanes(floor: &Floor, brush_m: f32, start: Point2) -> Vec<Lane> {
    order(floor, parallel(floor, brush_m - OVERLAP_M), start)
}

fn parallel(floor: &Floor, spacing_m: f32) -> Vec<Lane> {
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
                lanes.push((at(from, across), at(last, across)));
            }
        }
        if let Some(from) = open {
            lanes.push((at(from, across), at(last, across)));
        }
    }
    lanes
}

/// The nearest end of any lane next; a lane that cannot be reached in a straight line counts three times as far.
fn order(floor: &Floor, mut lanes: Vec<Lane>, start: Point2) -> Vec<Lane> {
    let mut here = start;
    let mut ordered = Vec::with_capacity(lanes.len());
    while !lanes.is_empty() {
        let cost = |lane: &Lane, turned: bool| {
            let end = if turned { lane.1 } else { lane.0 };
            let far = here.distance(end);
            if floor.is_clear(here, end) { far } else { 3.0 * far }
        };
        let best = (0..lanes.len())
            .flat_map(|i| [(i, false), (i, true)])
            .min_by(|a, b| cost(&lanes[a.0], a.1).total_cmp(&cost(&lanes[b.0], b.1)));
        let Some((index, turned)) = best else { break };
        let lane = lanes.remove(index);
        let lane = if turned { (lane.1, lane.0) } else { lane };
        here = lane.1;
        ordered.push(lane);
    }
    ordered
}
