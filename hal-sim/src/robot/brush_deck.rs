//! The brush deck of the simulated robot, and the floor that it really passes over.
//!
//! Written from the geometry of the machine alone: the robot's belief of its own swath (`floorguard-cleaning`) is judged by
//! this, and shares nothing with it.

use floorguard_types::geometry::{Point2, Pose2};

/// The scrubbing deck: a bar across the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrushDeck {
    /// From its left to its right end, metres, > 0.
    pub width_m: f32,
    /// Forward of the middle of the rear axle, metres.
    pub offset_m: f32,
}

impl BrushDeck {
    /// Left and right end, in the frame of the pose.
    fn ends(&self, robot: Pose2) -> [Point2; 2] {
        let (sin, cos) = libm::sincosf(robot.heading_rad);
        let (x_m, y_m) = (robot.x_m + cos * self.offset_m, robot.y_m + sin * self.offset_m);
        let half_m = 0.5 * self.width_m;
        [1.0, -1.0].map(|side: f32| Point2::new(x_m - side * (sin * half_m), y_m + side * (cos * half_m)))
    }

    /// What the deck passes over while the robot moves from one pose to another near it: its ends on straight lines.
    #[must_use]
    pub fn pass(&self, before: Pose2, after: Pose2) -> BrushPass {
        let ([left, right], [next_left, next_right]) = (self.ends(before), self.ends(after));
        match meeting([left, right], [next_left, next_right]) {
            None => BrushPass::Ahead([left, right, next_right, next_left]),
            Some(pivot) => BrushPass::Turning([[left, next_left, pivot], [right, next_right, pivot]]),
        }
    }
}

/// Floor that the deck passed over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BrushPass {
    /// Ahead or backwards: the deck, its path, the deck again.
    Ahead([Point2; 4]),
    /// About a place under the deck: a sector on either side, as triangles.
    Turning([[Point2; 3]; 2]),
}

impl BrushPass {
    /// The outlines, each convex.
    fn outlines(&self) -> [&[Point2]; 2] {
        match self {
            Self::Ahead(outline) => [outline, &[]],
            Self::Turning([left, right]) => [left, right],
        }
    }

    /// The deck passed over a place of the same frame; what lies between two passes in a row belongs to one of them.
    #[must_use]
    pub fn covers(&self, place: Point2) -> bool {
        self.outlines().into_iter().any(|outline| encloses(outline, place))
    }

    /// The lower left and the upper right corner of a square around it.
    #[must_use]
    pub fn bounds(&self) -> [Point2; 2] {
        let start = [Point2::new(f32::MAX, f32::MAX), Point2::new(f32::MIN, f32::MIN)];
        self.outlines().into_iter().flatten().fold(start, |[low, high], corner| {
            [
                Point2::new(low.x_m.min(corner.x_m), low.y_m.min(corner.y_m)),
                Point2::new(high.x_m.max(corner.x_m), high.y_m.max(corner.y_m)),
            ]
        })
    }
}

/// An odd number of edges lies to the right of the place (book, Conventions: Point in polygon).
fn encloses(outline: &[Point2], place: Point2) -> bool {
    let before = outline.iter().cycle().skip(outline.len().saturating_sub(1));
    let is_right = |(corner, before): &(&Point2, &Point2)| {
        let spans = (corner.y_m > place.y_m) != (before.y_m > place.y_m);
        let share = (place.y_m - corner.y_m) / (before.y_m - corner.y_m);
        spans && place.x_m < corner.x_m + share * (before.x_m - corner.x_m)
    };
    outline.iter().zip(before).filter(is_right).count() % 2 == 1
}

/// Where two bars cross; bars that only touch do not.
fn meeting(first: [Point2; 2], second: [Point2; 2]) -> Option<Point2> {
    let side = |[from, to]: [Point2; 2], of: Point2| {
        (to.x_m - from.x_m) * (of.y_m - from.y_m) - (to.y_m - from.y_m) * (of.x_m - from.x_m)
    };
    let [of_left, of_right] = first.map(|end| side(second, end));
    let [left_of, right_of] = second.map(|end| side(first, end));
    let is_crossed = of_left * of_right < 0.0 && left_of * right_of < 0.0;
    let share = of_left / (of_left - of_right);
    let [from, to] = first;
    is_crossed
        .then(|| Point2::new(from.x_m + share * (to.x_m - from.x_m), from.y_m + share * (to.y_m - from.y_m)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_types::random::Pcg32;

    /// Area of a pass, by random places.
    fn area_m2(pass: &BrushPass, random: &mut Pcg32) -> f32 {
        const PLACES: u32 = 200_000;
        let [low, high] = pass.bounds();
        let mut place = || {
            Point2::new(random.uniform_between(low.x_m, high.x_m), random.uniform_between(low.y_m, high.y_m))
        };
        let met = (0..PLACES).filter(|_| pass.covers(place())).count();
        (high.x_m - low.x_m) * (high.y_m - low.y_m) * met as f32 / PLACES as f32
    }

    /// Straight on it is width times path, on an arc width times the path of the deck's middle, on the spot two sectors.
    #[test]
    fn area_is_that_of_the_textbook() {
        let mut random = Pcg32::new(11, 0);
        let deck = BrushDeck { width_m: 0.65, offset_m: 0.25 };
        let start = Pose2::new(3.0, -2.0, 0.7);
        let ahead = deck.pass(start, start.compose(Pose2::new(0.3, 0.0, 0.0)));
        assert!((area_m2(&ahead, &mut random) - 0.65 * 0.3).abs() < 2.0e-3);
        let back = deck.pass(start, start.compose(Pose2::new(-0.3, 0.0, 0.0)));
        assert!((area_m2(&back, &mut random) - 0.65 * 0.3).abs() < 2.0e-3);
        let under_axle = BrushDeck { offset_m: 0.0, ..deck };
        let turn_rad = 0.2_f32;
        let spin = under_axle.pass(start, start.compose(Pose2::new(0.0, 0.0, turn_rad)));
        assert!(matches!(spin, BrushPass::Turning(_)));
        assert!((area_m2(&spin, &mut random) - 0.325 * 0.325 * turn_rad.sin()).abs() < 3.0e-4);
    }

    /// Whatever the path, a place between two passes in a row is passed once.
    #[test]
    fn passes_in_a_row_do_not_overlap() {
        let mut random = Pcg32::new(12, 0);
        let deck = BrushDeck { width_m: 0.65, offset_m: 0.25 };
        let mut before = Pose2::default();
        let passes: Vec<BrushPass> = (0..40)
            .map(|_| {
                let after = before.compose(Pose2::new(0.02, 0.0, 0.005));
                deck.pass(std::mem::replace(&mut before, after), after)
            })
            .collect();
        let along = || Point2::new(random.uniform_between(0.25, 0.95), random.uniform_between(-0.2, 0.2));
        let counts: Vec<usize> = std::iter::repeat_with(along)
            .take(20_000)
            .map(|place| passes.iter().filter(|pass| pass.covers(place)).count())
            .collect();
        assert!(counts.iter().all(|count| *count <= 1));
        assert!(counts.iter().filter(|count| **count == 1).count() > 15_000);
    }
}
