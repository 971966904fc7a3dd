//! People in simulated depth pictures: `cargo xtask reproduce rgbd-people`.
//!
//! Rooms with people of every kind and with objects, seen by the forward camera in both profiles. A picture is judged
//! by itself; a tracker on top drops what does not come again. The rules of the finder come from other seeds.

mod scenes;
mod score;

use std::fmt::Write as _;
use std::path::Path;

use floorguard_perception::floor::{FloorModel, FloorParameters};
use floorguard_perception::rgbd_people::{RgbdKind, RgbdParameters, RgbdPeopleFinder};
use floorguard_sim::sensors::{DepthCamera, DepthPicture};
use floorguard_types::geometry::Pose2;
use floorguard_types::sensing::{ColorImage, DepthImage, PinholeCamera};
use floorguard_types::time::Stamp;
use rayon::prelude::*;

pub use scenes::{RgbdScene, room};
pub use score::{Judged, Shown, judge, saw_upper_body, shown};

/// First seed; those from 1000 to 2150 tuned the rules.
const SEED: u64 = 0;
/// Gates, with a margin below what was measured.
const UPPER_BODY_MIN: [f64; 2] = [0.78, 0.88];
const LEGS_MIN: [f64; 2] = [0.80, 0.82];
/// Farthest legs, metres: those of the finder.
const LEGS_FARTHEST_M: f32 = 4.0;

/// What happened in many pictures.
#[derive(Clone, Debug, Default)]
pub struct RgbdFigures {
    /// Pictures.
    pub pictures: u64,
    /// Upper bodies in full view, and those found, by whole metres of distance.
    pub bodies: [[u32; 2]; 8],
    /// Detections of upper bodies: of a person, of nobody.
    pub body_detections: [u32; 2],
    /// Pairs of legs in full view within 4 m, and those found.
    pub legs: [u32; 2],
    /// Detections by legs alone: of a person, of nobody.
    pub leg_detections: [u32; 2],
    /// Sum of the squared position errors of upper bodies, m², and of the normalised ones.
    pub squared: [f64; 2],
    /// By tenths of the confidence: detections and those of a person.
    pub reliability: [[u32; 2]; 10],
    /// Pictures in which the floor was measured.
    pub floors: u32,
    /// Milliseconds for floor and people, each picture.
    pub times_ms: Vec<f64>,
}

impl RgbdFigures {
    fn add(&mut self, other: Self) {
        let sum = |mine: &mut [u32], others: &[u32]| {
            mine.iter_mut().zip(others).for_each(|(mine, other)| *mine += other);
        };
        self.pictures += other.pictures;
        sum(self.bodies.as_flattened_mut(), other.bodies.as_flattened());
        sum(&mut self.body_detections, &other.body_detections);
        sum(&mut self.legs, &other.legs);
        sum(&mut self.leg_detections, &other.leg_detections);
        sum(self.reliability.as_flattened_mut(), other.reliability.as_flattened());
        self.squared.iter_mut().zip(other.squared).for_each(|(mine, other)| *mine += other);
        self.floors += other.floors;
        self.times_ms.extend(other.times_ms);
    }

    /// Precision and recall of upper bodies.
    #[must_use]
    pub fn upper_bodies(&self) -> [f64; 2] {
        let [there, found] = self.bodies.iter().fold([0, 0], |[a, b], [c, d]| [a + c, b + d]);
        let [right, wrong] = self.body_detections;
        [ratio(right, right + wrong), ratio(found, there)]
    }

    /// Precision of people found by their legs alone and recall of legs in view.
    #[must_use]
    pub fn legs(&self) -> [f64; 2] {
        let [right, wrong] = self.leg_detections;
        [ratio(right, right + wrong), ratio(self.legs[1], self.legs[0])]
    }

    /// Root mean square of the position error of upper bodies, metres, and mean normalised squared error (2 is right).
    #[must_use]
    pub fn position(&self) -> [f64; 2] {
        let count = f64::from(self.body_detections[0].max(1));
        [(self.squared[0] / count).sqrt(), self.squared[1] / count]
    }

    /// Mean difference of confidence and share of people over the tenths.
    #[must_use]
    pub fn calibration_error(&self) -> f64 {
        let all: u32 = self.reliability.iter().map(|[all, _]| all).sum();
        let error = self.reliability.iter().enumerate().map(|(tenth, [count, right])| {
            (f64::from(*right) - (tenth as f64 + 0.5) / 10.0 * f64::from(*count)).abs()
        });
        error.sum::<f64>() / f64::from(all.max(1))
    }

    /// Whether what was measured before still holds.
    #[must_use]
    pub fn holds(&self) -> bool {
        let reached = |found: [f64; 2], wanted: [f64; 2]| found[0] >= wanted[0] && found[1] >= wanted[1];
        reached(self.upper_bodies(), UPPER_BODY_MIN) && reached(self.legs(), LEGS_MIN)
    }

    fn median_ms(&self) -> f64 {
        let mut times = self.times_ms.clone();
        times.sort_by(f64::total_cmp);
        times.get(times.len() / 2).copied().unwrap_or(f64::NAN)
    }

    fn text(&self, name: &str) -> String {
        let mut text = format!("{name}: {} pictures, floor measured in {}\n", self.pictures, self.floors);
        let ([precision, recall], [error_m, normalised]) = (self.upper_bodies(), self.position());
        let _ = writeln!(
            text,
            "  upper bodies  precision {precision:.3}  recall {recall:.3}  position {error_m:.3} m  normalised {normalised:.2}"
        );
        let [precision, recall] = self.legs();
        let _ = writeln!(
            text,
            "  legs          precision {precision:.3}  recall {recall:.3}  (alone; pairs within 4 m)"
        );
        text.push_str("  found of those in view, by metres:");
        for (metre, [there, found]) in self.bodies.iter().enumerate() {
            let _ = write!(text, "  {metre}: {found}/{there}");
        }
        let _ = writeln!(
            text,
            "\n  belief differs from the share of people by {:.3}; floor and people {:.2} ms a picture",
            self.calibration_error(),
            self.median_ms()
        );
        text
    }
}

fn ratio(part: u32, whole: u32) -> f64 {
    f64::from(part) / f64::from(whole.max(1))
}

/// The pinhole of a simulated camera.
#[must_use]
pub fn pinhole(camera: &DepthCamera) -> PinholeCamera {
    let centre = [(camera.size.width as f32 - 1.0) / 2.0, (camera.size.height as f32 - 1.0) / 2.0];
    PinholeCamera::new([camera.focal_px; 2], centre).expect("a simulated camera is a camera")
}

/// One room: drawn, searched from the measured floor on, judged.
#[must_use]
pub fn run_room(seed: u64, camera: DepthCamera) -> RgbdFigures {
    let scene = room(seed, camera);
    let picture = scene.camera.picture(&scene.scene, &scene.people, scene.robot, seed);
    let (judged, floor_measured, time_ms) = search(&scene, &picture);
    let mut figures = RgbdFigures { pictures: 1, times_ms: vec![time_ms], ..RgbdFigures::default() };
    figures.floors = u32::from(floor_measured);
    let shown = shown(&scene, &picture);
    let judged = judge(&judged, &shown);
    for (index, person) in shown.iter().enumerate() {
        let found = judged.iter().find(|judged| judged.person == Some(index));
        if person.upper_body && person.height_m > 1.0 {
            let band = &mut figures.bodies[(person.range_m as usize).min(7)];
            band[0] += 1;
            band[1] += u32::from(found.is_some_and(|judged| saw_upper_body(&judged.found)));
        }
        if person.legs && person.range_m < LEGS_FARTHEST_M {
            figures.legs[0] += 1;
            figures.legs[1] +=
                u32::from(found.is_some_and(|judged| judged.found.kind != RgbdKind::UpperBody));
        }
    }
    for one in &judged {
        let right = one.person.is_some();
        let tenth = &mut figures.reliability[((one.found.confidence * 10.0) as usize).min(9)];
        tenth[0] += 1;
        tenth[1] += u32::from(right);
        if !saw_upper_body(&one.found) {
            figures.leg_detections[usize::from(!right)] += 1;
            continue;
        }
        figures.body_detections[usize::from(!right)] += 1;
        if let Some(person) = one.person {
            let error_m = f64::from(one.found.position_in_base.distance(shown[person].place));
            figures.squared[0] += error_m * error_m;
            figures.squared[1] += f64::from(one.normalised);
        }
    }
    figures
}

fn search(
    scene: &RgbdScene,
    picture: &DepthPicture,
) -> (Vec<floorguard_perception::rgbd_people::RgbdDetection>, bool, f64) {
    let camera = pinhole(&scene.camera);
    let (height_m, pitch_rad) = (scene.camera.height_m, scene.camera.pitch_rad);
    let parameters = FloorParameters::mounted(camera, height_m, pitch_rad).expect("a camera above the floor");
    let mut model = FloorModel::new(parameters, scene.seed);
    let mut finder = Box::new(RgbdPeopleFinder::new(RgbdParameters::new(camera)));
    let image = DepthImage::new(Stamp::ZERO, picture.size, &picture.depth_mm).expect("a whole picture");
    let colour = ColorImage::new(Stamp::ZERO, picture.size, &picture.rgb).expect("a whole picture");
    let mount = Pose2::new(scene.camera.forward_m, 0.0, 0.0);
    let started = std::time::Instant::now();
    let floor = model.update(&image, Stamp::ZERO);
    let found = finder.find_people((&image, Some(&colour)), &floor.plane, mount).expect("640 columns");
    let time_ms = started.elapsed().as_secs_f64() * 1e3;
    (found.people.to_vec(), floor.fault.is_none(), time_ms)
}

/// Many rooms, on all cores; the result does not depend on their number.
#[must_use]
pub fn run_rooms(first_seed: u64, count: u64, camera: DepthCamera) -> RgbdFigures {
    let each: Vec<RgbdFigures> =
        (first_seed..first_seed + count).into_par_iter().map(|seed| run_room(seed, camera)).collect();
    let mut total = RgbdFigures::default();
    each.into_iter().for_each(|figures| total.add(figures));
    total
}

/// Runs `trials` rooms with the large camera and four times as many with the small one; writes the table into `folder`.
/// The second value says whether everything that must show did.
///
/// # Errors
/// The folder cannot be written.
pub fn rgbd_people(trials: u64, folder: &Path) -> anyhow::Result<(String, bool)> {
    std::fs::create_dir_all(folder)?;
    let large = run_rooms(SEED, trials, DepthCamera::FORWARD);
    let small = run_rooms(SEED, 4 * trials, DepthCamera::FORWARD_SMALL);
    let text = format!("{}{}", large.text("640 x 480"), small.text("160 x 120"));
    eprintln!("{text}");
    std::fs::write(folder.join("rgbd_people.txt"), &text)?;
    Ok((text, large.holds() && small.holds()))
}
