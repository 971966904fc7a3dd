//! Who should be found in a picture, who was, and how far off.

use floorguard_perception::rgbd_people::{RgbdDetection, RgbdKind};
use floorguard_sim::people::PersonKind;
use floorguard_sim::sensors::DepthPicture;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::sensing::ImageSize;

use super::scenes::RgbdScene;

/// A detection and a person this near to each other are one, metres.
const MATCH_M: f32 = 0.5;

/// Somebody as the picture shows them.
#[derive(Clone, Copy, Debug)]
pub struct Shown {
    /// Robot frame, metres.
    pub place: Point2,
    /// From the camera, metres.
    pub range_m: f32,
    /// Metres.
    pub height_m: f32,
    /// Head and both shoulders are in the picture, unhidden.
    pub upper_body: bool,
    /// Both shins are.
    pub legs: bool,
}

/// One detection and what it is.
#[derive(Clone, Copy, Debug)]
pub struct Judged {
    /// The detection.
    pub found: RgbdDetection,
    /// Who it is; `None` for nobody.
    pub person: Option<usize>,
    /// Normalised squared error of the position, two degrees of freedom.
    pub normalised: f32,
}

/// Everybody of a scene in its picture.
#[must_use]
pub fn shown(scene: &RgbdScene, picture: &DepthPicture) -> Vec<Shown> {
    let camera = scene.camera;
    let into_base = scene.robot.inverse();
    let to_camera = Pose2::new(camera.forward_m, 0.0, 0.0).inverse();
    let each = scene.people.iter().map(|person| {
        let base = into_base.transform(person.position);
        let place = Point2::new(base.x_m * camera.scale, base.y_m * camera.scale);
        let from_camera = to_camera.transform(place);
        let height_m = person.kind.height_m() * camera.scale;
        let sees = |aside_m: f32, up_m: f32| {
            pixel(scene, from_camera, (aside_m, up_m)).is_some_and(|index| picture.person[index] == person.id)
        };
        let size = height_m / 1.75;
        // The top of the head, its middle, both shoulders, chest.
        let upper = [(0.0, -0.02), (0.0, -0.11), (0.0, -0.35), (0.15, -0.4), (-0.15, -0.4), (0.0, -0.5)];
        let upper_body = upper.iter().all(|(aside, down)| sees(aside * size, height_m + down * size));
        let shins = person.feet().map(|foot| {
            let foot = into_base.transform(foot);
            to_camera.transform(Point2::new(foot.x_m * camera.scale, foot.y_m * camera.scale))
        });
        let on = |foot: &Point2, up_m| {
            pixel(scene, *foot, (0.0, up_m)).is_some_and(|index| picture.person[index] == person.id)
        };
        let walks = !matches!(person.kind, PersonKind::Wheelchair | PersonKind::Crouching);
        let [a, b] = shins;
        // Two shins one behind the other look like one.
        let apart = (a.y_m / a.x_m - b.y_m / b.x_m).abs() * from_camera.x_m > 0.15;
        let legs = walks && apart && shins.iter().all(|foot| on(foot, 0.12) && on(foot, 0.35));
        Shown { place, range_m: from_camera.norm(), height_m, upper_body, legs }
    });
    each.collect()
}

/// The pixel of a point beside and above a place, in a level robot's picture.
fn pixel(scene: &RgbdScene, from_camera: Point2, (aside_m, up_m): (f32, f32)) -> Option<usize> {
    let camera = scene.camera;
    let (sin, cos) = libm::sincosf(camera.pitch_rad);
    let (forward, left, up) = (from_camera.x_m, from_camera.y_m + aside_m, up_m - camera.height_m);
    let depth = forward * cos - up * sin;
    if depth < 0.2 {
        return None;
    }
    let down = -(up * cos + forward * sin);
    let ImageSize { width, height } = camera.size;
    let column = (width as f32 - 1.0) / 2.0 - camera.focal_px * left / depth;
    let row = (height as f32 - 1.0) / 2.0 + camera.focal_px * down / depth;
    let inside = column >= 0.0 && row >= 0.0 && column < width as f32 && row < height as f32;
    inside.then_some(row as usize * width + column as usize)
}

/// Nearest pairs first, each used once.
#[must_use]
pub fn judge(found: &[RgbdDetection], shown: &[Shown]) -> Vec<Judged> {
    let mut pairs: Vec<(f32, usize, usize)> = Vec::new();
    for (index, detection) in found.iter().enumerate() {
        for (person, shown) in shown.iter().enumerate() {
            pairs.push((detection.position_in_base.distance(shown.place), index, person));
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut judged: Vec<Judged> =
        found.iter().map(|found| Judged { found: *found, person: None, normalised: 0.0 }).collect();
    let mut taken = vec![false; shown.len()];
    for (distance_m, index, person) in pairs {
        if distance_m <= MATCH_M && judged[index].person.is_none() && !taken[person] {
            taken[person] = true;
            judged[index].person = Some(person);
            judged[index].normalised = normalised(&judged[index].found, shown[person].place);
        }
    }
    judged
}

fn normalised(found: &RgbdDetection, place: Point2) -> f32 {
    let [xx, xy, yy] = found.covariance_m2;
    let (dx, dy) = (found.position_in_base.x_m - place.x_m, found.position_in_base.y_m - place.y_m);
    (yy * dx * dx - 2.0 * xy * dx * dy + xx * dy * dy) / (xx * yy - xy * xy).max(1.0e-9)
}

/// Whether a detection saw the upper body.
#[must_use]
pub fn saw_upper_body(found: &RgbdDetection) -> bool {
    found.kind != RgbdKind::Legs
}
