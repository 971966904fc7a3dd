//! Rendered pictures of random rooms with people, and where the people are in them.

use floorguard_detector::RgbPicture;
use floorguard_sim::sensors::DepthCamera;
use floorguard_types::geometry::Pose2;
use floorguard_types::random::Pcg32;
use floorguard_types::sensing::ImageSize;

use crate::train::random_scenes;

/// Pictures of a room, in as many directions.
const PER_ROOM: u64 = 6;
/// People of fewer pixels, or lower than this, are neither learnt nor asked for.
const PIXELS_MIN: usize = 40;
const HEIGHT_MIN: f32 = 14.0;

/// A person in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabelledPerson {
    /// Left, upper, right, lower edge, pixels.
    pub edges: [f32; 4],
    /// Too small, or too little of it: neither right nor wrong.
    pub is_doubtful: bool,
}

/// A picture with its people.
#[derive(Clone, Debug)]
pub struct LabelledPicture {
    /// 160 × 120.
    pub picture: RgbPicture,
    /// Who is in it.
    pub people: Vec<LabelledPerson>,
}

/// So many rendered pictures, rooms from a seed on. Two seeds whose rooms do not overlap share nothing.
#[must_use]
pub fn rendered_pictures(first_seed: u64, count: u64) -> Vec<LabelledPicture> {
    let rooms = random_scenes(first_seed, count.div_ceil(PER_ROOM));
    let mut pictures = Vec::new();
    for room in rooms {
        let scene = room.scenario.scene.build();
        let people = room.scenario.people(room.seed);
        let start = room.scenario.start_pose();
        let mut random = Pcg32::new(room.seed, 91);
        for shot in 0..PER_ROOM {
            let turn = std::f32::consts::TAU * (shot as f32 + random.uniform()) / PER_ROOM as f32;
            let camera = DepthCamera {
                focal_px: random.uniform_between(95.0, 150.0),
                height_m: random.uniform_between(0.5, 1.4),
                pitch_rad: random.uniform_between(-0.15, 0.2),
                scale: room.scale,
                ..DepthCamera::FORWARD_SMALL
            };
            let pose = Pose2::new(start.x_m, start.y_m, start.heading_rad + turn);
            let found = camera.picture(&scene, &people, pose, room.seed * 16 + shot);
            let ImageSize { width, height } = found.size;
            let size = [width as u32, height as u32];
            let Ok(picture) = RgbPicture::new(size, found.rgb) else { continue };
            pictures.push(LabelledPicture { picture, people: people_of(&found.person, width) });
        }
    }
    pictures.truncate(count as usize);
    pictures
}

/// The box around each number.
fn people_of(numbers: &[u32], width: usize) -> Vec<LabelledPerson> {
    let mut boxes = std::collections::BTreeMap::<u32, ([f32; 4], usize)>::new();
    for (index, number) in numbers.iter().enumerate().filter(|(_, number)| **number > 0) {
        let (x, y) = ((index % width) as f32, (index / width) as f32);
        let (edges, count) = boxes.entry(*number).or_insert(([x, y, x, y], 0));
        *edges = [edges[0].min(x), edges[1].min(y), edges[2].max(x + 1.0), edges[3].max(y + 1.0)];
        *count += 1;
    }
    let person = |(edges, count): ([f32; 4], usize)| {
        let is_doubtful = count < PIXELS_MIN || edges[3] - edges[1] < HEIGHT_MIN;
        LabelledPerson { edges, is_doubtful }
    };
    boxes.into_values().map(person).collect()
}
