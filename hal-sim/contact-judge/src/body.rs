//! The true shape of the robot: upright prisms over outlines, each between two heights.

use parry3d::math::{Pose, Vector};
use parry3d::query;
use parry3d::shape::SharedShape;
use serde::Serialize;

use crate::motion::RobotPose;
use crate::solid::Placed;

/// A part of the robot: an outline on the floor plan between two heights.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyPart {
    /// What it is: body, squeegee, brushes, mast.
    pub name: String,
    /// Corners of a convex outline, robot frame, metres.
    pub outline_m: Vec<[f32; 2]>,
    /// Lower and upper face, metres above the floor.
    pub height_m: [f32; 2],
}

impl BodyPart {
    /// Longer and wider by this at each end, metres; as high as before.
    pub(crate) fn grown(&self, by_m: f32) -> Self {
        let middle = |axis: usize| {
            let values = || self.outline_m.iter().map(|corner| corner[axis]);
            (values().fold(f32::MAX, f32::min) + values().fold(f32::MIN, f32::max)) / 2.0
        };
        let [x, y] = [middle(0), middle(1)];
        let outward = |[cx, cy]: &[f32; 2]| [cx + by_m.copysign(cx - x), cy + by_m.copysign(cy - y)];
        Self { outline_m: self.outline_m.iter().map(outward).collect(), ..self.clone() }
    }
}

/// Why a body cannot be made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BodyError {
    /// A part has fewer than three corners, no height, or corners in one line.
    Flat(String),
    /// An outline is not convex; give it as several convex parts.
    NotConvex(String),
    /// There is no part.
    Empty,
}

impl core::fmt::Display for BodyError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Flat(name) => write!(f, "the part '{name}' of the robot's body has no volume"),
            Self::NotConvex(name) => {
                write!(f, "the outline of the part '{name}' is not convex; split it into convex parts")
            }
            Self::Empty => write!(f, "the robot's body has no part"),
        }
    }
}

impl std::error::Error for BodyError {}

/// Where on the body.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BodyPlace {
    /// Name of the part.
    pub part: String,
    /// Side as seen from above: front, front-left, left, rear-left, rear, rear-right, right, front-right.
    pub side: &'static str,
    /// Robot frame, metres: forward, left, up.
    pub point_m: [f32; 3],
}

/// Nearest points of the robot and something else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Metres; negative is the depth of the penetration.
    pub gap_m: f32,
    /// On the robot, world frame, metres.
    pub on_robot_m: [f32; 3],
    /// From the robot to the other, world frame, of length 1.
    pub direction: [f32; 3],
    /// Index of the robot's part.
    pub part: usize,
}

struct Piece {
    name: String,
    shape: SharedShape,
}

/// The whole robot.
pub struct RobotBody {
    pieces: Vec<Piece>,
    low_m: [f32; 2],
    high_m: [f32; 2],
    radius_m: f32,
    top_m: f32,
}

/// A gap up to which the nearest points are asked for, metres.
const NEAR_M: f32 = 100.0;

impl RobotBody {
    /// Of parts.
    ///
    /// # Errors
    /// A part has no volume or is not convex.
    pub fn new(parts: &[BodyPart]) -> Result<Self, BodyError> {
        let corners = || parts.iter().flat_map(|part| part.outline_m.iter().copied());
        let fold = |axis: usize, pick: fn(f32, f32) -> f32, from: f32| {
            corners().map(|corner| corner[axis]).fold(from, pick)
        };
        if parts.is_empty() {
            return Err(BodyError::Empty);
        }
        Ok(Self {
            pieces: parts.iter().map(piece).collect::<Result<_, _>>()?,
            low_m: [fold(0, f32::min, f32::MAX), fold(1, f32::min, f32::MAX)],
            high_m: [fold(0, f32::max, f32::MIN), fold(1, f32::max, f32::MIN)],
            radius_m: corners().map(|[x, y]| libm::hypotf(x, y)).fold(0.0, f32::max),
            top_m: parts.iter().map(|part| part.height_m[1]).fold(0.0, f32::max),
        })
    }

    /// Every point of the body is within this of the origin as seen from above, metres.
    #[must_use]
    pub const fn radius_m(&self) -> f32 {
        self.radius_m
    }

    /// Upper end of the highest part, metres above the floor.
    #[must_use]
    pub const fn top_m(&self) -> f32 {
        self.top_m
    }

    /// The corners of the box around the body as seen from above, robot frame, metres.
    #[must_use]
    pub const fn corners_m(&self) -> [[f32; 2]; 4] {
        let ([x, y], [far_x, far_y]) = (self.low_m, self.high_m);
        [[x, y], [far_x, y], [far_x, far_y], [x, far_y]]
    }

    /// The nearest points of the robot and a solid; the depth where they overlap.
    #[must_use]
    pub fn nearest(&self, pose: RobotPose, other: &crate::Solid) -> Nearest {
        self.nearest_to(&pose.placed(), &other.placed())
    }

    pub(crate) fn nearest_to(&self, robot: &Pose, other: &Placed) -> Nearest {
        let mut best = Nearest { gap_m: NEAR_M, on_robot_m: [0.0; 3], direction: [1.0, 0.0, 0.0], part: 0 };
        for (part, piece) in self.pieces.iter().enumerate() {
            let contact =
                query::contact(robot, piece.shape.as_ref(), &other.pose, other.shape.as_ref(), NEAR_M);
            let Some(contact) = contact.ok().flatten().filter(|contact| contact.dist < best.gap_m) else {
                continue;
            };
            best = Nearest {
                gap_m: contact.dist,
                on_robot_m: contact.point1.to_array(),
                direction: contact.normal1.to_array(),
                part,
            };
        }
        best
    }

    /// Distance of the robot and a solid, metres; 0 where they touch or overlap.
    pub(crate) fn distance_m(&self, robot: &Pose, other: &Placed) -> f32 {
        let of_piece = |piece: &Piece| {
            query::distance(robot, piece.shape.as_ref(), &other.pose, other.shape.as_ref())
                .map_or(NEAR_M, |found| found.distance)
        };
        self.pieces.iter().map(of_piece).fold(NEAR_M, f32::min)
    }

    /// Names a point of the body.
    #[must_use]
    pub fn place(&self, pose: RobotPose, nearest: &Nearest) -> BodyPlace {
        let [x, y, z] = nearest.on_robot_m;
        let [x, y] = pose.in_robot([x, y]);
        let share = |value: f32, axis: usize| {
            (value - self.low_m[axis]) / (self.high_m[axis] - self.low_m[axis]).max(1.0e-3)
        };
        let part = self.pieces.get(nearest.part).map(|piece| piece.name.clone()).unwrap_or_default();
        BodyPlace { part, side: side(share(x, 0), share(y, 1)), point_m: [x, y, z] }
    }
}

/// The side of a point at these shares of length (0 is the rear) and breadth (0 is the right).
fn side(along: f32, across: f32) -> &'static str {
    const CORNER: f32 = 0.25;
    let row = usize::from(along > CORNER) + usize::from(along > 1.0 - CORNER);
    let column = usize::from(across > CORNER) + usize::from(across > 1.0 - CORNER);
    // In the middle of the length every point belongs to one of the long sides.
    let names =
        [["rear-right", "rear", "rear-left"], ["right", "", "left"], ["front-right", "front", "front-left"]];
    match names[row][column] {
        "" if across < 0.5 => "right",
        "" => "left",
        name => name,
    }
}

fn piece(part: &BodyPart) -> Result<Piece, BodyError> {
    let [low_m, high_m] = part.height_m;
    let count = part.outline_m.len();
    if count < 3 || high_m - low_m < 1.0e-3 || area_m2(&part.outline_m).abs() < 1.0e-6 {
        return Err(BodyError::Flat(part.name.clone()));
    }
    if !is_convex(&part.outline_m) {
        return Err(BodyError::NotConvex(part.name.clone()));
    }
    let at = |z: f32| part.outline_m.iter().map(move |[x, y]| Vector::new(*x, *y, z));
    let points: Vec<Vector> = at(low_m).chain(at(high_m)).collect();
    let shape = SharedShape::convex_hull(&points).ok_or_else(|| BodyError::Flat(part.name.clone()))?;
    Ok(Piece { name: part.name.clone(), shape })
}

fn area_m2(outline_m: &[[f32; 2]]) -> f32 {
    let next = outline_m.iter().cycle().skip(1);
    outline_m.iter().zip(next).map(|(a, b)| (a[0] * b[1] - b[0] * a[1]) / 2.0).sum()
}

/// All corners turn the same way.
fn is_convex(outline_m: &[[f32; 2]]) -> bool {
    let count = outline_m.len();
    let turn = |at: usize| {
        let [a, b, c] = [0, 1, 2].map(|step| outline_m[(at + step) % count]);
        (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])
    };
    (0..count).all(|at| turn(at) >= -1.0e-6) || (0..count).all(|at| turn(at) <= 1.0e-6)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Solid;

    fn part(name: &str, outline_m: &[[f32; 2]], height_m: [f32; 2]) -> BodyPart {
        BodyPart { name: name.to_owned(), outline_m: outline_m.to_vec(), height_m }
    }

    fn robot() -> RobotBody {
        let body = [[-0.45, -0.4], [0.95, -0.4], [0.95, 0.4], [-0.45, 0.4]];
        let mast = [[0.45, -0.05], [0.55, -0.05], [0.55, 0.05], [0.45, 0.05]];
        RobotBody::new(&[part("body", &body, [0.05, 0.7]), part("mast", &mast, [0.7, 0.9])]).unwrap()
    }

    fn post(x_m: f32, y_m: f32, z_m: [f32; 2]) -> Solid {
        Solid::Cylinder { foot_m: [x_m, y_m, z_m[0]], radius_m: 0.1, height_m: z_m[1] - z_m[0] }
    }

    #[test]
    fn gaps_and_depths_by_hand() {
        let robot = robot();
        let gap = |solid| robot.nearest(RobotPose::default(), &solid).gap_m;
        assert!((gap(post(2.0, 0.0, [0.0, 1.0])) - 0.95).abs() < 1e-3);
        assert!((gap(post(0.98, 0.0, [0.0, 1.0])) + 0.07).abs() < 1e-3);
        // 5 cm pass under the body, over it the mast is met.
        assert!((gap(post(0.2, 0.2, [0.0, 0.03])) - 0.02).abs() < 1e-3);
        assert!(gap(post(0.5, 0.0, [0.85, 1.0])) < 0.0);
        assert!(gap(post(0.0, 0.0, [0.75, 1.0])) > 0.04);
    }

    #[test]
    fn the_whole_turns_with_the_robot() {
        let pose = RobotPose { x_m: 1.0, y_m: 1.0, heading_rad: core::f32::consts::FRAC_PI_2 };
        let nearest = robot().nearest(pose, &post(1.0, 2.5, [0.0, 1.0]));
        // The front is at y = 1.95 m, the post begins at 2.4 m.
        assert!((nearest.gap_m - 0.45).abs() < 1e-3, "{nearest:?}");
        let place = robot().place(pose, &nearest);
        assert_eq!((place.part.as_str(), place.side), ("body", "front"));
    }

    #[test]
    fn sides_have_names() {
        let names = [(0.0, 0.0), (0.5, 0.0), (1.0, 0.0), (0.0, 0.5), (0.5, 1.0), (0.0, 1.0), (1.0, 0.5)];
        assert_eq!(
            names.map(|(along, across)| side(along, across)),
            ["rear-right", "right", "front-right", "rear", "left", "rear-left", "front"]
        );
    }

    #[test]
    fn body_must_be_convex_with_volume() {
        let dent = [[0.0, 0.0], [1.0, 0.0], [0.2, 0.2], [0.0, 1.0]];
        assert_eq!(
            RobotBody::new(&[part("L", &dent, [0.0, 1.0])]).err(),
            Some(BodyError::NotConvex("L".into()))
        );
        let line = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]];
        assert_eq!(
            RobotBody::new(&[part("line", &line, [0.0, 1.0])]).err(),
            Some(BodyError::Flat("line".into()))
        );
        assert_eq!(RobotBody::new(&[]).err(), Some(BodyError::Empty));
    }
}
