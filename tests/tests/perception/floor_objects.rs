//! Objects of known size on rendered floors with the depth noise of a real camera: what is found, and what is not there.

use floorguard_perception::floor::{
    DepthNoise, FloorModel, FloorObject, FloorParameters, ObjectFinder, PixelClass, Plane, dot,
};
use floorguard_types::random::Pcg32;
use floorguard_types::sensing::{DepthImage, ImageSize, PinholeCamera};
use floorguard_types::time::Stamp;

const SIZE: ImageSize = ImageSize { width: 640, height: 480 };
const HEIGHT_M: f32 = 0.72;
const PITCH_RAD: f32 = 0.75;
/// Footprint of a box, metres (book, Floor and dirt: Objects).
const SIDE_M: f32 = 0.05;

/// A floor with a box or none, rendered ray by ray.
struct Scene {
    camera: PinholeCamera,
    plane: Plane,
    /// Depth of the empty floor, metres, a pixel.
    empty_m: Vec<f32>,
    noise_pool: Vec<f32>,
    random: Pcg32,
    /// Sag in the middle of the view, 1/m.
    sag_per_m: f32,
    /// Amplitude of a wavy floor, metres.
    waves_m: f32,
}

impl Scene {
    fn new(sag_per_m: f32, waves_m: f32) -> Self {
        let mut random = Pcg32::new(11, 3);
        // Drawing 3·10⁸ normal numbers would take longer than everything else: a pool is entered at random places.
        let noise_pool = (0..1_000_003).map(|_| random.normal()).collect();
        let mut scene = Self {
            camera: PinholeCamera::new([525.0, 525.0], [319.5, 239.5]).expect("a camera"),
            plane: Plane::of_mounting(HEIGHT_M, PITCH_RAD).expect("a plane"),
            empty_m: Vec::new(),
            noise_pool,
            random,
            sag_per_m,
            waves_m,
        };
        scene.empty_m = (0..SIZE.width * SIZE.height).map(|index| scene.empty_m(scene.ray(index))).collect();
        scene
    }

    fn ray(&self, index: usize) -> [f32; 3] {
        self.camera.ray((index % SIZE.width) as f32, (index / SIZE.width) as f32)
    }

    /// Height of the floor at a place right of and before the foot point.
    fn floor_m(&self, x: f32, y: f32) -> f32 {
        let (dx, dy) = (x, y - 1.0);
        self.sag_per_m * (dx * dx + dy * dy) + self.waves_m * (x * 12.0).sin() * (y * 12.0).cos()
    }

    /// Depth along a ray, where it meets the floor.
    fn empty_m(&self, ray: [f32; 3]) -> f32 {
        let [right, along] = self.plane.axes();
        let (down, x, y) = (-dot(self.plane.normal, ray), dot(right, ray), dot(along, ray));
        if down < 0.05 {
            return 0.0;
        }
        let mut z = HEIGHT_M / down;
        for _ in 0..4 {
            z = (HEIGHT_M - self.floor_m(x * z, y * z)) / down;
        }
        z
    }

    /// Depth along a ray where the box at `(bx, by)` with its height is in the way: the faces that a camera from
    /// before and above sees, top and front.
    fn solid_m(&self, ray: [f32; 3], ([bx, by], height): ([f32; 2], f32)) -> Option<f32> {
        let [right, along] = self.plane.axes();
        let (down, x, y) = (-dot(self.plane.normal, ray), dot(right, ray), dot(along, ray));
        let inside = |value: f32, middle: f32| (value - middle).abs() <= SIDE_M / 2.0;
        let base = self.floor_m(bx, by);
        let top = (HEIGHT_M - base - height) / down;
        let front = (by - SIDE_M / 2.0) / y.max(1e-3);
        let front_height = HEIGHT_M - base - down * front;
        if inside(x * top, bx) && inside(y * top, by) {
            return Some(top);
        }
        (inside(x * front, bx) && (0.0..=height).contains(&front_height)).then_some(front)
    }

    /// A picture in whole steps, with the noise of the model.
    fn render(&mut self, solid: Option<([f32; 2], f32)>) -> Vec<u16> {
        let noise = DepthNoise::NGUYEN;
        let start = self.random.below(600_000) as usize;
        let pixel = |index: usize| {
            let empty = self.empty_m[index];
            let z =
                solid.and_then(|solid| self.solid_m(self.ray(index), solid)).map_or(empty, |z| z.min(empty));
            let noisy = z + noise.axial_m(z) * self.noise_pool[start + index];
            let step = (noise.step_per_m * z * z).max(0.001);
            if z > 0.3 && z < 6.0 { ((noisy / step).round() * step * 1_000.0) as u16 } else { 0 }
        };
        (0..SIZE.width * SIZE.height).map(pixel).collect()
    }
}

/// A model that follows the frames of one scene.
struct Watcher {
    model: FloorModel,
    finder: Box<ObjectFinder>,
    classes: Vec<PixelClass>,
    frame: u64,
}

impl Watcher {
    fn new() -> Self {
        let camera = PinholeCamera::new([525.0, 525.0], [319.5, 239.5]).expect("a camera");
        let parameters = FloorParameters::mounted(camera, HEIGHT_M, PITCH_RAD).expect("a mounting");
        Self {
            model: FloorModel::new(parameters, 5),
            finder: Box::default(),
            classes: vec![PixelClass::Unknown; SIZE.width * SIZE.height],
            frame: 0,
        }
    }

    fn objects(&mut self, depth_mm: &[u16]) -> Vec<FloorObject> {
        self.frame += 1;
        let now = Stamp::from_micros(33_333 * self.frame);
        let image = DepthImage::new(now, SIZE, depth_mm).expect("the size fits");
        let estimate = self.model.update(&image, now);
        assert_eq!(estimate.fault, None);
        let parameters = *self.model.parameters();
        let found = self.finder.find(&image, (&parameters, &estimate), &mut self.classes).expect("fits");
        assert_eq!(found.dropped, 0);
        found.objects.to_vec()
    }
}

fn shows(objects: &[FloorObject], [x, y]: [f32; 2]) -> bool {
    objects.iter().any(|object| {
        let ([lx, ly], [hx, hy]) = (object.low_m, object.high_m);
        (0.5 * (lx + hx) - x).abs() < 0.05 && (0.5 * (ly + hy) - y).abs() < 0.08
    })
}

/// Boxes of one height at places all over the working range; how many are found, and how many other objects.
fn campaign(scene: &mut Scene, height_m: f32, trials: u32) -> (u32, u32) {
    let mut watcher = Watcher::new();
    let mut places = Pcg32::new(17, 4);
    let (mut found, mut others) = (0, 0);
    for _ in 0..trials {
        let place = [places.uniform_between(-0.25, 0.25), places.uniform_between(0.55, 1.05)];
        let objects = watcher.objects(&scene.render(Some((place, height_m))));
        let is_found = shows(&objects, place);
        found += u32::from(is_found);
        others += objects.len() as u32 - u32::from(is_found);
    }
    (found, others)
}

#[test]
fn two_centimetre_objects_are_found_on_uneven_floor() {
    for (name, sag, waves) in [("flat", 0.0, 0.0), ("wavy", 0.0, 0.0025), ("sagging", 0.02, 0.0)] {
        let mut scene = Scene::new(sag, waves);
        for (height_m, least) in [(0.02, 95), (0.05, 95)] {
            let (found, others) = campaign(&mut scene, height_m, 100);
            println!("{name}, {height_m} m: {found} of 100 found, {others} other objects");
            assert!(found >= least, "{name}, {height_m} m: {found} of 100");
            assert!(others == 0, "{name}, {height_m} m: {others} objects that are not there");
        }
    }
}

#[test]
fn an_empty_floor_has_no_objects() {
    let mut false_objects = 0;
    for (sag, waves) in [(0.0, 0.0), (0.0, 0.0025), (0.02, 0.0), (-0.015, 0.0)] {
        let mut scene = Scene::new(sag, waves);
        let mut watcher = Watcher::new();
        for _ in 0..250 {
            false_objects += watcher.objects(&scene.render(None)).len();
        }
    }
    assert_eq!(false_objects, 0, "in 1,000 frames");
}

#[test]
fn curvature_is_recovered() {
    let mut scene = Scene::new(0.015, 0.0);
    let mut watcher = Watcher::new();
    let depth = scene.render(None);
    watcher.objects(&depth);
    let image = DepthImage::new(Stamp::from_micros(1_000_000), SIZE, &depth).expect("the size fits");
    let estimate = watcher.model.update(&image, Stamp::from_micros(1_000_000));
    let [xx, xy, yy] = estimate.curvature.coefficients_per_m;
    println!("curvature {xx} {xy} {yy}");
    assert!((xx - 0.015).abs() < 0.003 && xy.abs() < 0.003 && (yy - 0.015).abs() < 0.003, "{xx} {xy} {yy}");
}
