//! How to drive over one cell: from where to where, so that the whole bar passes over the whole cell.

use floorguard_types::geometry::Point2;

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

/// What a pass has to cover.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassShape {
    /// Edge of a cell, metres.
    pub cell_m: f32,
    /// Distance before and behind the cell, for position uncertainty, metres.
    pub margin_m: f32,
    /// Distance equivalent of a turn in the middle of a cell: its corners have less clearance than the rim of a
    /// straight pass.
    pub turn_cost_m: f32,
}

impl PassShape {
    /// Half the length of a pass: half of the cell as seen in the direction of travel, and the margin.
    fn reach_m(&self, (sin, cos): (f32, f32)) -> f32 {
        self.half_extent_m((sin, cos)) + self.margin_m
    }

    /// A square is as wide across a direction as along it.
    fn half_extent_m(&self, (sin, cos): (f32, f32)) -> f32 {
        0.5 * self.cell_m * (libm::fabsf(sin) + libm::fabsf(cos))
    }
}

/// Where a pass is wanted, map frame, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassPlaces {
    /// Where the robot comes from.
    pub from: Point2,
    /// Middle of the cell.
    pub centre: Point2,
    /// Where it goes on to, if that is known.
    pub towards: Option<Point2>,
}

/// Chooses the pass over the cell around `centre` with the shortest path from `from` and on to `towards`.
/// `is_clear(a, b)` says that the robot can drive straight from a to b. Falls back to shorter passes beside walls;
/// `None` where not even the centre can be reached.
///
/// ```
/// use floorguard_cleaning::{PassPlaces, PassShape, choose_pass};
/// use floorguard_types::geometry::Point2;
///
/// let (centre, towards) = (Point2::new(1.0, 0.0), Some(Point2::new(2.0, 0.0)));
/// let places = PassPlaces { from: Point2::default(), centre, towards };
/// let shape = PassShape { cell_m: 0.1, margin_m: 0.05, turn_cost_m: 1.0 };
/// let pass = choose_pass(places, &shape, |_, _| true).unwrap();
/// assert!((pass.entry.x_m - 0.9).abs() < 1.0e-6 && (pass.exit.x_m - 1.1).abs() < 1.0e-6);
/// assert!(choose_pass(places, &shape, |_, _| false).is_none());
/// ```
#[must_use]
pub fn choose_pass(
    places: PassPlaces,
    shape: &PassShape,
    is_clear: impl Fn(Point2, Point2) -> bool,
) -> Option<Pass> {
    let PassPlaces { from, centre, towards } = places;
    for share in [1.0_f32, 0.75, 0.5] {
        let mut best: Option<(f32, Pass)> = None;
        for direction in 0..DIRECTIONS {
            let angle = f32::from(direction) * (core::f32::consts::TAU / f32::from(DIRECTIONS));
            let (sin, cos) = libm::sincosf(angle);
            let reach_m = share * shape.reach_m((sin, cos));
            let (dx, dy) = (cos * reach_m, sin * reach_m);
            let pass = Pass {
                entry: Point2::new(centre.x_m - dx, centre.y_m - dy),
                exit: Point2::new(centre.x_m + dx, centre.y_m + dy),
            };
            let onward = towards.map_or(0.0, |next| pass.exit.distance(next));
            let cost = from.distance(pass.entry) + 2.0 * reach_m + onward;
            if best.is_none_or(|(least, _)| cost < least) && is_clear(pass.entry, pass.exit) {
                best = Some((cost, pass));
            }
        }
        if share >= 1.0
            && let Some((cost, pass)) = turn_in_the_middle(places, shape)
            && best.is_none_or(|(least, _)| cost < least)
            && is_clear(from, centre)
            && is_clear(centre, centre)
        {
            best = Some((cost, pass));
        }
        if let Some((_, pass)) = best {
            return Some(pass);
        }
    }
    is_clear(centre, centre).then_some(Pass { entry: centre, exit: centre })
}

/// In to the middle of the cell, a turn on the spot, and out again: the bar sweeps the strip before, its own circle,
/// and the strip behind, so nothing of the cell is left out, and no distance is spent on a straight line through it.
/// Both paths must begin outside the cell.
fn turn_in_the_middle(places: PassPlaces, shape: &PassShape) -> Option<(f32, Pass)> {
    let PassPlaces { from, centre, towards } = places;
    let next = towards?;
    let (entry_m, exit_m) = (from.distance(centre), centre.distance(next));
    let needed_m = 0.5 * core::f32::consts::SQRT_2 * shape.cell_m;
    let cost = entry_m + exit_m + shape.turn_cost_m;
    (entry_m >= needed_m && exit_m >= needed_m).then_some((cost, Pass { entry: centre, exit: centre }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_in_the_middle_where_that_is_shorter() {
        let (from, centre) = (Point2::new(0.8, 0.0), Point2::new(1.0, 0.0));
        let shape = PassShape { cell_m: 0.1, margin_m: 0.015, turn_cost_m: 0.0 };
        let back =
            choose_pass(PassPlaces { from, centre, towards: Some(Point2::new(0.8, 0.1)) }, &shape, |_, _| {
                true
            })
            .unwrap();
        assert_eq!((back.entry, back.exit), (centre, centre));
        // A path that begins within the cell would leave the part behind it: a straight pass.
        let near = Point2::new(0.97, 0.0);
        let pass = choose_pass(
            PassPlaces { from: near, centre, towards: Some(Point2::new(0.8, 0.1)) },
            &shape,
            |_, _| true,
        )
        .unwrap();
        assert!(pass.entry.distance(pass.exit) > 0.1);
    }

    #[test]
    fn passes_follow_travel_and_walls() {
        let (from, centre) = (Point2::new(0.0, 0.0), Point2::new(1.0, 0.0));
        let next = Some(Point2::new(2.0, 0.0));
        let shape = PassShape { cell_m: 0.1, margin_m: 0.05, turn_cost_m: 1.0 };
        let pass = choose_pass(PassPlaces { from, centre, towards: next }, &shape, |_, _| true).unwrap();
        assert!((pass.entry.x_m - 0.9).abs() < 1e-6 && pass.entry.y_m.abs() < 1e-6);
        // A wall right behind the cell: only passes that stay left of it.
        let beside =
            choose_pass(PassPlaces { from, centre, towards: next }, &shape, |a, b| a.x_m.max(b.x_m) < 1.001)
                .unwrap();
        assert!((beside.entry.x_m - beside.exit.x_m).abs() < 1e-6);
        assert!(choose_pass(PassPlaces { from, centre, towards: next }, &shape, |_, _| false).is_none());
    }
}
