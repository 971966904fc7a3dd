//! Any-angle smoothing: straight lines instead of steps along the raster, where they are not more expensive.

use floorguard_types::motion::Waypoint;

use super::trace::head_forward;
use crate::costmap::{CostmapView, Costs, line_cost};

/// Straight lines are tried over at most this many waypoints.
const REACH: usize = 400;
/// A line may pass cells this much more expensive than the most expensive waypoint that it replaces.
const SLACK: u8 = 4;

/// Replaces stretches of a forward path by straight lines that pass no obstacle and nothing more expensive than what
/// they replace; gives how many waypoints are left. Ends stay. Cost: waypoints × log₂(400) lines of cells.
pub fn smooth(costmap: CostmapView<'_>, path: &mut [Waypoint]) -> usize {
    let count = path.len();
    let (mut kept, mut at) = (1_usize, 0_usize);
    for _ in 0..count {
        if at.saturating_add(1) >= count {
            break;
        }
        at = farthest_in_line(costmap, path, at);
        let Some(corner) = path.get(at).copied() else { break };
        if let Some(slot) = path.get_mut(kept) {
            *slot = corner;
        }
        kept = kept.saturating_add(1);
    }
    let kept = kept.min(count);
    head_forward(path.get_mut(..kept).unwrap_or(&mut []));
    kept
}

/// The last waypoint that a straight line reaches, by doubling and halving the stretch.
fn farthest_in_line(costmap: CostmapView<'_>, path: &[Waypoint], from: usize) -> usize {
    let last = path.len().saturating_sub(1).min(from.saturating_add(REACH));
    let (mut good, mut stretch, mut is_growing) = (from.saturating_add(1), 2_usize, true);
    // Nine doublings and nine halvings cover 400 waypoints.
    for _ in 0..20 {
        let to = if is_growing { from.saturating_add(stretch) } else { good.saturating_add(stretch) };
        let to = to.min(last);
        if to > good && is_line(costmap, path, from, to) {
            good = to;
            stretch = if is_growing { stretch.saturating_mul(2) } else { stretch / 2 };
            if good == last {
                break;
            }
        } else {
            is_growing = false;
            stretch /= 2;
        }
        if stretch == 0 {
            break;
        }
    }
    good
}

fn is_line(costmap: CostmapView<'_>, path: &[Waypoint], from: usize, to: usize) -> bool {
    let (Some(first), Some(last)) = (path.get(from), path.get(to)) else { return false };
    let stretch = path.get(from..=to).unwrap_or(&[]);
    let highest_cost = stretch.iter().map(|at| costmap.cost_at(at.place_in_map())).max().unwrap_or(0);
    let geometry = costmap.geometry();
    let ends = [first, last].map(|at| geometry.coordinates_of(at.place_in_map()));
    let [begin, end] = ends;
    let limit = highest_cost.saturating_add(SLACK).min(Costs::INSCRIBED - 1);
    line_cost(costmap, begin, end).is_ok_and(|cost| cost <= limit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_mapping::GridGeometry;
    use floorguard_types::geometry::{Point2, Pose2};
    use floorguard_types::motion::Gear;
    use std::vec;
    use std::vec::Vec;

    #[test]
    fn staircase_becomes_line_corner_stays() {
        let geometry = GridGeometry::new(60, 60, 0.1, Point2::default()).unwrap();
        let mut costs = vec![0; 3_600];
        for row in 0..30 {
            for column in 20..60 {
                costs[row * 60 + column] = Costs::LETHAL;
            }
        }
        let view = CostmapView::new(geometry, &costs, 0).unwrap();
        let cells = (5..31).map(|row| (18, row)).chain((19..50).map(|column| (column, 31)));
        let mut path: Vec<Waypoint> = cells
            .map(|(column, row)| {
                let centre = geometry.centre(geometry.index(column, row).unwrap());
                Waypoint { pose_in_map: Pose2::new(centre.x_m, centre.y_m, 0.0), gear: Gear::Ahead }
            })
            .collect();
        let (first, last) = (path[0].place_in_map(), path.last().unwrap().place_in_map());
        let kept = smooth(view, &mut path);
        assert!((3..8).contains(&kept), "{kept}");
        assert_eq!((path[0].place_in_map(), path[kept - 1].place_in_map()), (first, last));
        for pair in path[..kept].windows(2) {
            for step in 0..=100 {
                let t = step as f32 / 100.0;
                let (a, b) = (pair[0].place_in_map(), pair[1].place_in_map());
                let point = Point2::new(a.x_m + t * (b.x_m - a.x_m), a.y_m + t * (b.y_m - a.y_m));
                let (x, y) = (point.x_m / 0.1, point.y_m / 0.1);
                let at_border = (x - x.round()).abs() < 0.35 || (y - y.round()).abs() < 0.35;
                assert!(view.cost_at(point) == 0 || at_border, "{point:?}");
            }
        }
    }
}
