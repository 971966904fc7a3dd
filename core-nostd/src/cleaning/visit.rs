//! How to drive over one cell: from where to where, so that the whole bar passes over the whole cell.

use crate::geometry::Point2;

/// Directions that are tried: every 22.5°.
const DIRECTIONS: u8 = 16;

/// A straight pass over a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pass {
    /// Where the kinematic centre enters, in the map frame.
    pub entry: Point2,
    /// Where it may turn away.
    pub exit: Point2,
}

/// Chooses the pass over the cell around `centre` that costs the least way from `from` and on to `towards`.
/// `reach_m` is half the way of the pass; `is_clear(a, b)` says that the robot can drive straight from a to b. Falls
/// back to shorter passes beside walls; `None` where not even the centre can be reached.
#[must_use]
pub fn choose_pass(
    (from, centre, towards): (Point2, Point2, Option<Point2>),
    reach_m: f32,
    is_clear: impl Fn(Point2, Point2) -> bool,
) -> Option<Pass> {
    for share in [1.0_f32, 0.75, 0.5] {
        let mut best: Option<(f32, Pass)> = None;
        for direction in 0..DIRECTIONS {
            let angle = f32::from(direction) * (core::f32::consts::TAU / f32::from(DIRECTIONS));
            let (sin, cos) = libm::sincosf(angle);
            let (dx, dy) = (cos * reach_m * share, sin * reach_m * share);
            let pass = Pass {
                entry: Point2::new(centre.x_m - dx, centre.y_m - dy),
                exit: Point2::new(centre.x_m + dx, centre.y_m + dy),
            };
            let onward = towards.map_or(0.0, |next| pass.exit.distance(next));
            let cost = from.distance(pass.entry) + onward;
            if best.is_none_or(|(least, _)| cost < least) && is_clear(pass.entry, pass.exit) {
                best = Some((cost, pass));
            }
        }
        if let Some((_, pass)) = best {
            return Some(pass);
        }
    }
    is_clear(centre, centre).then_some(Pass { entry: centre, exit: centre })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_in_the_direction_of_travel_and_along_walls() {
        let (from, centre) = (Point2::new(0.0, 0.0), Point2::new(1.0, 0.0));
        let next = Some(Point2::new(2.0, 0.0));
        let pass = choose_pass((from, centre, next), 0.1, |_, _| true).unwrap();
        assert!((pass.entry.x_m - 0.9).abs() < 1e-6 && pass.entry.y_m.abs() < 1e-6);
        // A wall right behind the cell: only passes that stay left of it.
        let beside = choose_pass((from, centre, next), 0.1, |a, b| a.x_m.max(b.x_m) < 1.001).unwrap();
        assert!((beside.entry.x_m - beside.exit.x_m).abs() < 1e-6);
        assert!(choose_pass((from, centre, next), 0.1, |_, _| false).is_none());
    }
}
