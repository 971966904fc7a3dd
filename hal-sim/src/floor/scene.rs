//! A floor with dirt and light, and pictures of it.

use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::random::Pcg32;
use floorguard_types::sensing::ImageSize;

use super::camera::{FloorCamera, Sight};
use super::kinds::{DirtKind, FloorKind};
use super::light::Lighting;
use super::picture::{FloorPicture, MarkingColour, PictureMoment};
use super::spill::Spill;
use super::texture::{Surface, surface};

/// Linear reflectance of a speck: a crumb of dark bread.
const SPECK: [f32; 3] = [0.20, 0.11, 0.05];
/// Steps of the table from light to bytes.
const TONES: usize = 4_096;

/// A floor.
#[derive(Clone, Debug)]
pub struct FloorScene {
    /// What it is made of.
    pub floor: FloorKind,
    /// What lies on it.
    pub spills: Vec<Spill>,
    /// Light on it.
    pub lighting: Lighting,
    /// Distance before the robot and colour of the line that a safety projector draws, if one does.
    pub marking: Option<(f32, MarkingColour)>,
    /// Standard deviation of the camera's noise in the dark and its growth with light, steps of 255.
    pub noise: [f32; 2],
    seed: u32,
    tones: Vec<u8>,
}

/// One pixel before noise.
#[derive(Clone, Copy, Default)]
struct Dot {
    light: [f32; 3],
    dirt: Option<DirtKind>,
    is_floor: bool,
    is_marking: bool,
}

impl FloorScene {
    /// A clean floor of a kind, with lamps over the square of the given half side.
    #[must_use]
    pub fn new(floor: FloorKind, half_side_m: f32, seed: u64) -> Self {
        let mut random = Pcg32::new(seed, 0xf100);
        let tone = |step: usize| {
            let linear = step as f32 / (TONES - 1) as f32;
            let curved = if linear <= 0.003_130_8 {
                12.92 * linear
            } else {
                1.055 * libm::powf(linear, 1.0 / 2.4) - 0.055
            };
            (255.0 * curved + 0.5) as u8
        };
        Self {
            floor,
            spills: Vec::new(),
            lighting: Lighting::random(half_side_m, &mut random),
            marking: None,
            noise: [0.8, 1.6],
            seed: random.next_u32(),
            tones: (0..TONES).map(tone).collect(),
        }
    }

    /// A picture from a pose of the robot at a time. The noise follows from scene, pose and frame.
    #[must_use]
    pub fn picture(
        &self,
        camera: &FloorCamera,
        robot_in_world: Pose2,
        moment: PictureMoment,
    ) -> FloorPicture {
        self.picture_with(camera, robot_in_world, moment, |_| false)
    }

    /// The same with specks of dirt wherever `is_speck` says so of a place of the world.
    pub fn picture_with(
        &self,
        camera: &FloorCamera,
        robot_in_world: Pose2,
        PictureMoment { frame, at_s }: PictureMoment,
        is_speck: impl Fn(Point2) -> bool,
    ) -> FloorPicture {
        let ImageSize { width, height } = camera.size;
        let dot = |index: usize| {
            self.dot((camera, robot_in_world), (index % width, index / width), at_s, &is_speck)
        };
        let dots: Vec<Dot> = (0..width * height).map(dot).collect();
        let gain = exposure(&dots);
        let mut random = Pcg32::new(u64::from(self.seed), u64::from(frame) + 1);
        let mut rgb = Vec::with_capacity(3 * dots.len());
        for index in 0..dots.len() {
            let light = blurred(&dots, width, index).map(|value| gain * value);
            for value in light {
                let clean = f32::from(self.tones[(value.clamp(0.0, 1.0) * (TONES - 1) as f32) as usize]);
                let sigma = self.noise[0] + self.noise[1] * value.clamp(0.0, 1.0).sqrt();
                rgb.push((clean + sigma * random.normal() + 0.5).clamp(0.0, 255.0) as u8);
            }
        }
        FloorPicture {
            size: camera.size,
            rgb,
            dirt: dots.iter().map(|dot| dot.dirt).collect(),
            is_floor: dots.iter().map(|dot| dot.is_floor).collect(),
            is_marking: dots.iter().map(|dot| dot.is_marking).collect(),
        }
    }

    fn dot(
        &self,
        (camera, robot): (&FloorCamera, Pose2),
        (column, row): (usize, usize),
        at_s: f32,
        is_speck: &impl Fn(Point2) -> bool,
    ) -> Dot {
        let Some(sight) = camera.sight(column as f32, row as f32) else { return Dot::default() };
        let (forward, left) = sight.place_m;
        let point = robot.transform(Point2 { x_m: forward + camera.forward_m, y_m: left });
        let place = (point.x_m, point.y_m);
        let mut found = surface(self.floor, place, sight.footprint_m, self.seed);
        let mut dirt = None;
        for spill in &self.spills {
            let inside = spill.place(place);
            found = spill.cover(found, place, inside);
            if inside < 1.0 {
                dirt = Some(spill.kind);
            }
        }
        if is_speck(point) {
            found = found.towards(SPECK, 0.9);
            found.gloss = 0.0;
            dirt = Some(DirtKind::Crumbs);
        }
        let mut dot = Dot { light: self.seen(found, &sight, (place, robot), at_s), dirt, ..Dot::default() };
        // Lenses are darker towards the corners.
        let (dx, dy) =
            (column as f32 / camera.size.width as f32 - 0.5, row as f32 / camera.size.height as f32 - 0.5);
        dot.light = dot.light.map(|value| value * (1.0 - 0.45 * (dx * dx + dy * dy)));
        dot.is_floor = libm::hypotf(forward, left) < camera.reach_m;
        if let Some((distance_m, colour)) = self.marking {
            let off = (forward + camera.forward_m - distance_m).abs();
            dot.is_marking = off < 0.012;
            if off < 0.006 {
                let line = match colour {
                    MarkingColour::Red => [0.9, 0.05, 0.05],
                    MarkingColour::Green => [0.05, 0.8, 0.1],
                };
                dot.light.iter_mut().zip(line).for_each(|(value, extra)| *value += extra);
            }
        }
        dot
    }

    /// Light from a surface to the camera.
    fn seen(
        &self,
        surface: Surface,
        sight: &Sight,
        (place, robot): ((f32, f32), Pose2),
        at_s: f32,
    ) -> [f32; 3] {
        let falling = self.lighting.falling(place, at_s);
        let (sin, cos) = libm::sincosf(robot.heading_rad);
        let [forward, left, up] = sight.ray;
        let ray = [cos * forward - sin * left, sin * forward + cos * left, up];
        let mirrored = surface.gloss * self.lighting.mirrored(place, ray);
        surface.colour.map(|value| value * falling + mirrored)
    }
}

/// What the camera multiplies light with, so that the middle of the floor is middle grey.
fn exposure(dots: &[Dot]) -> f32 {
    /// Linear light of a well exposed floor.
    const MIDDLE: f32 = 0.25;
    let mut light: Vec<f32> = dots
        .iter()
        .filter(|dot| dot.is_floor)
        .step_by(97)
        .map(|dot| dot.light.iter().sum::<f32>() / 3.0)
        .collect();
    light.sort_by(f32::total_cmp);
    light.get(light.len() / 2).map_or(1.0, |middle| MIDDLE / middle.max(1e-3))
}

/// Binomial blur of 3 × 3 pixels: no lens is perfectly sharp.
fn blurred(dots: &[Dot], width: usize, index: usize) -> [f32; 3] {
    let (column, row, height) = (index % width, index / width, dots.len() / width);
    let mut sum = [0.0; 3];
    for (dy, wy) in [(0, 1.0), (1, 2.0), (2, 1.0)] {
        for (dx, wx) in [(0, 1.0), (1, 2.0), (2, 1.0)] {
            let x = (column + dx).saturating_sub(1).min(width - 1);
            let y = (row + dy).saturating_sub(1).min(height - 1);
            let near = dots[y * width + x].light;
            sum.iter_mut().zip(near).for_each(|(total, value)| *total += wx * wy / 16.0 * value);
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene() -> FloorScene {
        let mut random = Pcg32::new(3, 3);
        let mut scene = FloorScene::new(FloorKind::Tiles, 3.0, 5);
        scene.spills.push(Spill::random(DirtKind::Powder, Point2 { x_m: 1.1, y_m: 0.0 }, &mut random));
        scene
    }

    #[test]
    fn the_same_seed_is_the_same_picture() {
        let camera = FloorCamera {
            size: ImageSize { width: 160, height: 120 },
            focal_px: 131.0,
            ..FloorCamera::default()
        };
        let pose = Pose2::new(0.0, 0.0, 0.1);
        assert_eq!(
            scene().picture(&camera, pose, PictureMoment { frame: 1, at_s: 0.0 }),
            scene().picture(&camera, pose, PictureMoment { frame: 1, at_s: 0.0 })
        );
        assert_ne!(
            scene().picture(&camera, pose, PictureMoment { frame: 1, at_s: 0.0 }).rgb,
            scene().picture(&camera, pose, PictureMoment { frame: 2, at_s: 0.0 }).rgb
        );
    }

    /// The spot's pixels are where its middle projects to, from two poses.
    #[test]
    fn dirt_stays_in_the_world() {
        let camera = FloorCamera {
            size: ImageSize { width: 160, height: 120 },
            focal_px: 131.0,
            ..FloorCamera::default()
        };
        for pose in [Pose2::new(0.0, 0.0, 0.0), Pose2::new(0.2, -0.1, 0.2)] {
            let scene = scene();
            let picture = scene.picture(&camera, pose, PictureMoment { frame: 1, at_s: 0.0 });
            let middle = camera.pixel(pose, scene.spills[0].centre_in_world).expect("ahead");
            let places = (0..160 * 120).filter(|index| picture.dirt[*index].is_some());
            let (mut x, mut y, mut count) = (0.0, 0.0, 0.0_f32);
            for index in places {
                x += (index % 160) as f32;
                y += (index / 160) as f32;
                count += 1.0;
            }
            assert!(count > 20.0);
            assert!((x / count - middle.column).abs() < 3.0 && (y / count - middle.row).abs() < 3.0);
            let back = camera.floor_place(pose, middle).expect("below the horizon");
            assert!(back.distance(scene.spills[0].centre_in_world) < 1e-3);
        }
    }
}
