//! All poses together: Gauss-Newton.

use floorguard_types::geometry::Pose2;
use heapless::Vec;

use super::edges::GraphEdge;
use super::gradient::{Gradient, Problem};
use super::kept::KeptScan;

/// Steps of Gauss-Newton at most.
const STEPS_MAX: usize = 6;
/// Shorter steps end it, metres and radians.
const STEP_LEAST: f32 = 2.0e-3;

/// Moves the poses to where the edges want them; the first stays. `trusted`: squared deviations up to which a loop counts in full. Cost:
/// at most 6 × 80 times the edges.
pub(super) fn solve<const NODES: usize, const POINTS: usize, const EDGES: usize>(
    scans: &mut Vec<KeptScan<POINTS>, NODES>,
    edges: &Vec<GraphEdge, EDGES>,
    (gradient, trusted): (&mut Gradient<NODES>, f32),
) {
    for _ in 0..STEPS_MAX {
        gradient.descend(&Problem { edges, scans, trusted });
        let mut longest = 0.0_f32;
        for (scan, step) in scans.iter_mut().zip(gradient.steps()) {
            let [x, y, turn] = step.data.0.as_flattened() else { continue };
            let moved = Pose2::new(scan.pose.x_m + x, scan.pose.y_m + y, scan.pose.heading_rad + turn);
            if moved.x_m.is_finite() && moved.y_m.is_finite() && moved.heading_rad.is_finite() {
                scan.pose = moved;
            }
            longest = longest.max(step.amax());
        }
        if longest < STEP_LEAST {
            break;
        }
    }
}
