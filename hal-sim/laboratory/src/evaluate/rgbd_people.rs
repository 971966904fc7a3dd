//! People in depth pictures: upper bodies and legs, against a key where there is one.

use std::path::{Path, PathBuf};

use floorguard_perception::floor::{FloorFault, FloorModel, FloorSource};
use floorguard_perception::rgbd_people::{
    RgbdCounters, RgbdDetection, RgbdKind, RgbdParameters, RgbdPeopleFinder,
};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::sensing::{ColorImage, DepthImage, ImageSize, PinholeCamera};
use floorguard_types::time::Stamp;
use serde::{Serialize, Serializer};

use super::floor::{camera, parameters};
use super::rgbd_key::{KeyedPeople, read_key};
use super::rgbd_picture::picture;
use floorguard_host::outcome::{BadInput, VerdictFailed};
use floorguard_robot::picture_files::{ColourFile, DepthFile, read_colour, read_depth};

/// Columns of the widest picture that the finder takes; wider ones are thinned.
const COLUMNS_MAX: usize = 640;
/// The search for the floor is seeded, so that the same picture gives the same answer.
const SEED: u64 = 1;
/// A person and a key this near to each other are one, metres.
const MATCH_M: f32 = 0.5;

/// What to evaluate.
#[derive(Clone, Debug)]
pub struct RgbdTask {
    /// Depth pictures.
    pub depths: Vec<PathBuf>,
    /// Colour pictures, one for each depth picture, or none.
    pub colours: Vec<PathBuf>,
    /// fx, fy, cx, cy in pixels.
    pub intrinsics: [f32; 4],
    /// Height (m) and downward pitch (rad) of the camera; without them any floor is searched.
    pub mounting: Option<[f32; 2]>,
    /// Who stood where.
    pub key: Option<PathBuf>,
    /// A folder for pictures.
    pub out: Option<PathBuf>,
}

/// All pictures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RgbdReport {
    /// Pictures.
    pub frames: usize,
    /// People found in all of them.
    pub found: usize,
    /// Milliseconds for a picture, floor and people, on average.
    pub ms_per_frame: f64,
    /// With a key: part of what was found that is there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub precision: Option<f64>,
    /// With a key: part of what is there that was found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recall: Option<f64>,
    /// With a key: harmonic mean of both.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub f1: Option<f64>,
    /// Each picture.
    pub pictures: Vec<RgbdPictureReport>,
}

/// One picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RgbdPictureReport {
    /// The depth picture.
    pub file: String,
    /// Height of the camera above the floor, metres.
    pub camera_height_m: f32,
    /// `measured` in this picture or `configured` by the mounting.
    pub floor: &'static str,
    /// Nearest first.
    pub people: Vec<RgbdPersonReport>,
    /// Why there are no more.
    pub account: RgbdAccount,
}

/// One person.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RgbdPersonReport {
    /// `upper_body`, `legs` or `both`.
    pub seen: &'static str,
    /// Metres before and left of the camera's foot point.
    pub position_m: [f32; 2],
    /// Covariance: xx, xy, yy, m².
    pub covariance_m2: [f32; 3],
    /// Highest point that was seen, metres.
    pub top_m: f32,
    /// Belief within 0..=1.
    pub confidence: f32,
    /// Difference from the silhouette; lower is better.
    pub score: f32,
    /// Rectangle in the picture: left, top, width, height.
    pub rectangle_px: [u16; 4],
}

/// What became of everything that was examined: each count under its name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RgbdAccount(pub RgbdCounters);

impl Serialize for RgbdAccount {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let RgbdCounters { returns, regions, wrong_top, out_of_view, heads, unseen, .. } = self.0;
        let RgbdCounters { no_silhouette, suppressed, leg_parts, leg_candidates, dropped, .. } = self.0;
        let first = [("returns", returns), ("regions", regions), ("wrong_top", wrong_top)];
        let heads = [("out_of_view", out_of_view), ("heads", heads), ("unseen", unseen)];
        let rest = [("no_silhouette", no_silhouette), ("suppressed", suppressed), ("leg_parts", leg_parts)];
        let last = [("leg_candidates", leg_candidates), ("dropped", dropped)];
        serializer.collect_map(first.into_iter().chain(heads).chain(rest).chain(last))
    }
}

impl From<&RgbdDetection> for RgbdPersonReport {
    fn from(person: &RgbdDetection) -> Self {
        let ([left, top], [right, bottom]) = (person.first_px, person.last_px);
        let seen = match person.kind {
            RgbdKind::UpperBody => "upper_body",
            RgbdKind::Legs => "legs",
            RgbdKind::UpperBodyAndLegs => "both",
        };
        let Point2 { x_m, y_m } = person.position_in_base;
        Self {
            seen,
            position_m: [x_m, y_m],
            covariance_m2: person.covariance_m2,
            top_m: person.top_m,
            confidence: person.confidence,
            score: person.score,
            rectangle_px: [left, top, right.saturating_sub(left) + 1, bottom.saturating_sub(top) + 1],
        }
    }
}

/// Finds the people of all pictures.
///
/// # Errors
/// A file or the intrinsics cannot be used, or nothing returned; or a picture shows no floor and the mounting is not
/// known, which is a failed verdict.
pub fn rgbd_people(task: &RgbdTask) -> anyhow::Result<RgbdReport> {
    if !task.colours.is_empty() && task.colours.len() != task.depths.len() {
        let (colours, depths) = (task.colours.len(), task.depths.len());
        return Err(BadInput(format!("{depths} depth pictures, but {colours} colour pictures")).into());
    }
    let key = task.key.as_deref().map(read_key).transpose()?;
    let mut report = RgbdReport {
        frames: 0,
        found: 0,
        ms_per_frame: 0.0,
        precision: None,
        recall: None,
        f1: None,
        pictures: Vec::new(),
    };
    let (mut right, mut keyed, mut seconds) = (0, 0, 0.0);
    for (index, path) in task.depths.iter().enumerate() {
        let colour = task.colours.get(index).map(|path| read_colour(path)).transpose()?;
        let started = std::time::Instant::now();
        let found = one(task, path, colour)?;
        seconds += started.elapsed().as_secs_f64();
        if let Some(key) = &key {
            let there = key.of(path);
            right += matched(&found.people, there);
            keyed += there.len();
        }
        report.frames += 1;
        report.found += found.people.len();
        report.pictures.push(found);
    }
    report.ms_per_frame = 1e3 * seconds / report.frames.max(1) as f64;
    if key.is_some() {
        let precision = right as f64 / report.found.max(1) as f64;
        let recall = right as f64 / keyed.max(1) as f64;
        report.precision = Some(precision);
        report.recall = Some(recall);
        report.f1 = Some(2.0 * precision * recall / (precision + recall).max(1e-9));
    }
    Ok(report)
}

fn one(task: &RgbdTask, path: &Path, colour: Option<ColourFile>) -> anyhow::Result<RgbdPictureReport> {
    let bad = |problem: String| BadInput(format!("{}: {problem}", path.display()));
    let file = read_depth(path)?;
    if let Some(colour) = &colour
        && (colour.width, colour.height) != (file.width, file.height)
    {
        let (width, height) = (colour.width, colour.height);
        return Err(bad(format!("its colour picture has another size: {width} × {height}")).into());
    }
    let camera = camera(task.intrinsics, (path, ImageSize { width: file.width, height: file.height }))?;
    let (file, colour, camera) = thinned(file, colour, camera);
    let size = (file.width, file.height);
    let image = DepthImage::new(Stamp::ZERO, ImageSize { width: size.0, height: size.1 }, &file.depth_mm)
        .map_err(|p| bad(p.to_string()))?;
    let estimate = FloorModel::new(parameters(camera, task.mounting)?, SEED).update(&image, Stamp::ZERO);
    if let Some(fault @ FloorFault::NoReturns { .. }) = estimate.fault {
        return Err(bad(format!("nothing to see: {fault}")).into());
    }
    // Without a mounting there is nothing to fall back on.
    if let Some(fault) = estimate.fault.filter(|_| task.mounting.is_none()) {
        return Err(VerdictFailed(format!("{}: floor unknown: {fault}", path.display())).into());
    }
    let view = colour
        .as_ref()
        .map(|colour| ColorImage::new(Stamp::ZERO, ImageSize { width: size.0, height: size.1 }, &colour.rgb))
        .transpose();
    let view = view.map_err(|problem| bad(problem.to_string()))?;
    let mut finder = Box::new(RgbdPeopleFinder::new(RgbdParameters::new(camera)));
    let found = finder
        .find_people((&image, view.as_ref()), &estimate.plane, Pose2::default())
        .map_err(|problem| bad(problem.to_string()))?;
    if let Some(folder) = &task.out {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let name = folder.join(format!("{stem}_people.png"));
        std::fs::create_dir_all(folder)
            .map_err(|problem| BadInput(format!("{}: {problem}", folder.display())))?;
        let drawn = picture(&image, colour.as_ref(), &found.people, finder.legs());
        drawn.save(&name).map_err(|problem| BadInput(format!("{}: {problem}", name.display())))?;
    }
    Ok(RgbdPictureReport {
        file: path.display().to_string(),
        camera_height_m: estimate.plane.distance_m,
        floor: if estimate.source == FloorSource::Measured { "measured" } else { "configured" },
        people: found.people.iter().map(RgbdPersonReport::from).collect(),
        account: RgbdAccount(found.counters),
    })
}

/// Every n-th pixel of a picture that is wider than the finder's rows.
fn thinned(
    file: DepthFile,
    colour: Option<ColourFile>,
    camera: PinholeCamera,
) -> (DepthFile, Option<ColourFile>, PinholeCamera) {
    let factor = file.width.div_ceil(COLUMNS_MAX);
    if factor < 2 {
        return (file, colour, camera);
    }
    let (width, height) = (file.width / factor, file.height / factor);
    let places: Vec<usize> = (0..width * height)
        .map(|index| (index / width * factor + factor / 2) * file.width + index % width * factor + factor / 2)
        .collect();
    let depth_mm = places.iter().map(|place| file.depth_mm[*place]).collect();
    let colour = colour.map(|colour| ColourFile {
        width,
        height,
        rgb: places
            .iter()
            .flat_map(|place| [0, 1, 2].map(|channel| colour.rgb[3 * place + channel]))
            .collect(),
    });
    (DepthFile { width, height, depth_mm }, colour, camera.shrunk(factor as u16))
}

/// People that are where the key says, each used once, nearest pairs first.
fn matched(people: &[RgbdPersonReport], there: &[Point2]) -> usize {
    let mut pairs: Vec<(f32, usize, usize)> = Vec::new();
    for (index, person) in people.iter().enumerate() {
        let [x_m, y_m] = person.position_m;
        for (other, place) in there.iter().enumerate() {
            pairs.push((place.distance(Point2 { x_m, y_m }), index, other));
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut used, mut taken) = (vec![false; people.len()], vec![false; there.len()]);
    let mut count = 0;
    for (distance_m, person, place) in pairs {
        if distance_m <= MATCH_M && !used[person] && !taken[place] {
            (used[person], taken[place]) = (true, true);
            count += 1;
        }
    }
    count
}

impl KeyedPeople {
    /// Who stands in a picture.
    fn of(&self, path: &Path) -> &[Point2] {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        self.places.get(name.as_ref()).map_or(&[], Vec::as_slice)
    }
}
