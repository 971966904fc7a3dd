//! A depth camera of the structured-light kind (Kinect, Xtion) with colour: noise, steps, shadows and holes.
//!
//! Every picture comes with the truth of every pixel. Source: book, Floor and dirt: Depth noise (axial and lateral
//! noise of Nguyen et al. 2012, steps of the disparity).

use floorguard_perception::floor::DepthNoise;
use floorguard_types::geometry::{Pose2, wrap_angle};
use floorguard_types::random::Pcg32;
use floorguard_types::sensing::ImageSize;
use parry3d::math::Vector;
use parry3d::query::Ray;

use crate::people::{BodyPart, Person, body_parts};
use crate::scene::Scene;

/// Depths that the camera measures, metres.
const DEPTHS_M: [f32; 2] = [0.4, 8.0];
/// Between projector and camera, metres: what the projector does not light has no depth.
const BASELINE_M: f32 = 0.075;
/// Share of pixels that get lost for no visible reason.
const DROP_OUT: f32 = 0.005;
/// Surfaces that lie in the view more flatly than this sine bring nothing back.
const GRAZING_SINE: f32 = 0.06;
/// Lateral noise, pixels of a picture of 640 columns.
const LATERAL_PX: f32 = 0.8;
/// Nothing of a person reaches further from the middle of the body, metres.
const REACH_M: f32 = 1.25;

/// A pinhole camera on the robot without roll; the principal point is the middle of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthCamera {
    /// Columns and rows.
    pub size: ImageSize,
    /// Focal length, pixels.
    pub focal_px: f32,
    /// Metres above the floor.
    pub height_m: f32,
    /// Downwards from the horizon, radians.
    pub pitch_rad: f32,
    /// Metres before the robot's origin.
    pub forward_m: f32,
    /// Every length of the world is multiplied by this: people of other sizes.
    pub scale: f32,
    /// Axial noise.
    pub noise: DepthNoise,
}

impl DepthCamera {
    /// The forward camera of the published robot: 0.55 m above the floor (Yan et al. 2020a), tilted up by 8° so that
    /// heads are in view from 2.2 m on.
    pub const FORWARD: Self = Self {
        size: ImageSize { width: 640, height: 480 },
        focal_px: 525.0,
        height_m: 0.55,
        pitch_rad: -0.14,
        forward_m: 0.9,
        scale: 1.0,
        noise: DepthNoise::NGUYEN,
    };

    /// The same with 160 × 120 pixels.
    pub const FORWARD_SMALL: Self =
        Self { size: ImageSize { width: 160, height: 120 }, focal_px: 131.25, ..Self::FORWARD };
}

/// A picture and what is on each of its pixels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DepthPicture {
    /// Columns and rows.
    pub size: ImageSize,
    /// Along the optical axis in millimetres, row by row; 0 where nothing came back.
    pub depth_mm: Vec<u16>,
    /// Red, green, blue, row by row.
    pub rgb: Vec<u8>,
    /// Number of the person on each pixel, 0 for nobody.
    pub person: Vec<u32>,
}

/// One pixel before noise.
#[derive(Clone, Copy, Default)]
struct Dot {
    depth_m: f32,
    rgb: [u8; 3],
    person: u32,
}

struct Seen<'a> {
    person: &'a Person,
    parts: Vec<BodyPart>,
    bearing_rad: f32,
    half_angle_rad: f32,
}

impl DepthCamera {
    /// A picture of a scene and its people from a pose of the robot; the noise follows from the seed.
    #[must_use]
    pub fn picture(&self, scene: &Scene, people: &[Person], robot: Pose2, seed: u64) -> DepthPicture {
        let ImageSize { width, height } = self.size;
        let camera = robot.compose(Pose2::new(self.forward_m / self.scale, 0.0, 0.0));
        let seen: Vec<Seen<'_>> = people.iter().map(|person| seen(person, camera)).collect();
        let mut random = Pcg32::new(seed, 0xDE);
        let jitter_px = LATERAL_PX * width as f32 / 640.0;
        let mut dots = Vec::with_capacity(width * height);
        for index in 0..width * height {
            let (du, dv) = random.normal_pair();
            let column = (index % width) as f32 + jitter_px * du;
            let row = (index / width) as f32 + jitter_px * dv;
            dots.push(self.dot(scene, &seen, camera, (column, row)));
        }
        let mut depths: Vec<f32> = dots.iter().map(|dot| self.measured(dot.depth_m, &mut random)).collect();
        self.cast_shadows(&dots, &mut depths);
        self.lose_grazing(&dots, &mut depths);
        DepthPicture {
            size: self.size,
            depth_mm: depths.iter().map(|depth| (depth * 1_000.0 + 0.5) as u16).collect(),
            rgb: dots.iter().flat_map(|dot| shaded(dot.rgb, &mut random)).collect(),
            person: dots.iter().map(|dot| dot.person).collect(),
        }
    }

    fn dot(&self, scene: &Scene, people: &[Seen<'_>], camera: Pose2, (column, row): (f32, f32)) -> Dot {
        let (sin, cos) = libm::sincosf(self.pitch_rad);
        let x = (column - (self.size.width as f32 - 1.0) / 2.0) / self.focal_px;
        let y = (row - (self.size.height as f32 - 1.0) / 2.0) / self.focal_px;
        let (forward, left, up) = (cos - y * sin, -x, -sin - y * cos);
        let length = (1.0 + x * x + y * y).sqrt();
        let (heading_sin, heading_cos) = libm::sincosf(camera.heading_rad);
        let direction = Vector::new(
            (heading_cos * forward - heading_sin * left) / length,
            (heading_sin * forward + heading_cos * left) / length,
            up / length,
        );
        let origin = Vector::new(camera.x_m, camera.y_m, self.height_m / self.scale);
        let farthest = 20.0;
        let standing = scene.cast(origin, direction, farthest);
        let mut range_m = standing.map_or(farthest, |hit| hit.range_m);
        let mut dot = Dot { depth_m: 0.0, rgb: [0; 3], person: 0 };
        if standing.is_some() {
            dot.rgb = surface(origin + direction * range_m);
        }
        let bearing_rad = libm::atan2f(direction.y, direction.x);
        let ray = Ray::new(origin, direction);
        for seen in people {
            if wrap_angle(bearing_rad - seen.bearing_rad).abs() > seen.half_angle_rad {
                continue;
            }
            for (part, shape) in seen.parts.iter().enumerate() {
                if let Some(range) = shape.cast(&ray, range_m).filter(|range| *range < range_m) {
                    range_m = range;
                    dot.person = seen.person.id;
                    dot.rgb = clothes(seen.person.id, part);
                }
            }
        }
        if range_m < farthest {
            dot.depth_m = range_m * self.scale / length;
        }
        dot
    }

    /// Noise, steps of the disparity, lost pixels; 0 where nothing comes back.
    fn measured(&self, depth_m: f32, random: &mut Pcg32) -> f32 {
        let noise = random.normal();
        let is_lost = random.bernoulli(DROP_OUT);
        let [nearest, farthest] = DEPTHS_M;
        if is_lost || depth_m < nearest || depth_m > farthest {
            return 0.0;
        }
        let noisy = (depth_m + self.noise.axial_m(depth_m) * noise).max(0.1);
        let step = self.noise.step_per_m;
        if step <= 0.0 { noisy } else { 1.0 / ((1.0 / noisy / step).round().max(1.0) * step) }
    }

    /// What lies behind a nearer surface as seen from the projector has no depth.
    fn cast_shadows(&self, dots: &[Dot], depths: &mut [f32]) {
        let width = self.size.width;
        let reach = self.focal_px * BASELINE_M;
        let disparity = |dot: &Dot| if dot.depth_m > 0.0 { reach / dot.depth_m } else { 0.0 };
        for (line, depths) in dots.chunks(width).zip(depths.chunks_mut(width)) {
            let mut lit = vec![0.0_f32; width];
            let place = |column: usize, dot: &Dot| (column as f32 - disparity(dot) + 0.5) as usize;
            for (column, dot) in line.iter().enumerate() {
                if let Some(slot) = lit.get_mut(place(column, dot)) {
                    *slot = slot.max(disparity(dot));
                }
            }
            for (column, (dot, depth)) in line.iter().zip(depths).enumerate() {
                // A step of one disparity is a slope, not an edge.
                if lit.get(place(column, dot)).is_some_and(|nearest| *nearest > disparity(dot) + 1.0) {
                    *depth = 0.0;
                }
            }
        }
    }

    /// Surfaces seen too flatly have no depth: their depth changes by more than their distance from pixel to pixel.
    fn lose_grazing(&self, dots: &[Dot], depths: &mut [f32]) {
        let width = self.size.width;
        for (index, depth) in depths.iter_mut().enumerate() {
            let (Some(here), Some(below)) = (dots.get(index), dots.get(index + width)) else { continue };
            let climb = (here.depth_m - below.depth_m).abs();
            let across = here.depth_m / self.focal_px;
            if here.person == below.person && across > 0.0 && across / climb.max(1.0e-6) < GRAZING_SINE {
                *depth = 0.0;
            }
        }
    }
}

fn seen(person: &Person, camera: Pose2) -> Seen<'_> {
    let (dx, dy) = (person.position.x_m - camera.x_m, person.position.y_m - camera.y_m);
    let distance = libm::hypotf(dx, dy);
    let half_angle_rad =
        if distance > REACH_M + 0.1 { libm::asinf(REACH_M / distance) + 0.02 } else { core::f32::consts::PI };
    Seen { person, parts: body_parts(person), bearing_rad: libm::atan2f(dy, dx), half_angle_rad }
}

fn hash(a: u32, b: u32) -> u32 {
    Pcg32::new(u64::from(a), u64::from(b)).next_u32()
}

/// Trousers, top, skin, objects: by the order in which bodies are built.
fn clothes(person: u32, part: usize) -> [u8; 3] {
    let layer = match part {
        0 | 1 => 0,
        2 | 3 => 1,
        4 => return [205, 160, 130],
        _ => 2,
    };
    let colour = hash(person, layer);
    [colour, colour >> 8, colour >> 16].map(|value| 20 + (value & 0x7F) as u8)
}

/// Grey floor, coloured objects in blocks of half a metre.
fn surface(at: Vector) -> [u8; 3] {
    if at.z < 0.01 {
        return [125, 122, 118];
    }
    let block = |value: f32| (value * 2.0 + 1_000.0) as u32;
    let colour = hash(block(at.x), block(at.y));
    [colour, colour >> 8, colour >> 16].map(|value| 60 + (value & 0x7F) as u8)
}

fn shaded(rgb: [u8; 3], random: &mut Pcg32) -> [u8; 3] {
    let light = random.uniform_between(-12.0, 12.0);
    rgb.map(|value| (f32::from(value) + light).clamp(0.0, 255.0) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::people::{Build, PersonKind};
    use crate::scene::{Material, SceneBuilder};
    use floorguard_types::geometry::Point2;

    fn person(at: (f32, f32)) -> Person {
        Person {
            id: 7,
            kind: PersonKind::Adult,
            build: Build::SAME,
            position: Point2::new(at.0, at.1),
            velocity: Point2::new(0.0, 0.0),
            heading_rad: 1.0,
            gait_rad: 0.0,
            goals: Vec::new(),
            goal: 0,
            speed_mps: 0.0,
            starts_us: 0,
            sees_robot: true,
            walk: None,
        }
    }

    #[test]
    fn person_is_placed_and_shades_the_wall() {
        let mut builder = SceneBuilder::default();
        builder.wall([6.0, -5.0], [6.0, 5.0], 3.0, Material::Matte);
        let camera = DepthCamera { forward_m: 0.0, ..DepthCamera::FORWARD_SMALL };
        let picture = camera.picture(&builder.build(), &[person((3.0, 0.5))], Pose2::default(), 1);
        let (mut columns, mut depths) = (Vec::new(), Vec::new());
        for (index, person) in picture.person.iter().enumerate().filter(|(_, person)| **person == 7) {
            let depth = f32::from(picture.depth_mm[index]) * 0.001;
            assert_eq!(*person, 7);
            columns.push((index % 160) as f32);
            if depth > 0.0 {
                depths.push(depth);
            }
        }
        let mean = |values: &[f32]| values.iter().sum::<f32>() / values.len() as f32;
        assert!(columns.len() > 400, "{}", columns.len());
        // 0.5 m to the left at 3 m.
        assert!((mean(&columns) - (79.5 - 131.25 * 0.5 / 3.0)).abs() < 2.0, "{}", mean(&columns));
        assert!((mean(&depths) - 2.95).abs() < 0.15, "{}", mean(&depths));
        // Beside the person the wall has a shadow: more holes than anywhere else.
        let holes = picture.depth_mm.iter().filter(|depth| **depth == 0).count();
        assert!(holes > 200, "{holes}");
        // The same seed is the same picture.
        let again = camera.picture(&SceneBuilder::default().build(), &[], Pose2::default(), 1);
        assert_eq!(again, camera.picture(&SceneBuilder::default().build(), &[], Pose2::default(), 1));
    }
}
