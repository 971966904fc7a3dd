//! A hall is driven lane by lane: which spills the map of seen dirt finds, and what it invents.

use std::time::Duration;

use floorguard_mapping::GridGeometry;
use floorguard_mapping::seen_dirt::{DirtSpot, SeenCell, SeenDirtMap, SeenLayer};
use floorguard_robot::picture_files::DirtDetectors;
use floorguard_sim::floor::{DirtKind, FloorCamera, FloorKind, FloorScene, PictureMoment, Spill};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::random::Pcg32;
use floorguard_types::sensing::ColorImage;
use floorguard_types::time::Stamp;

use super::scenes::view;

/// Edge of a cell of the map, metres.
const CELL_M: f32 = 0.05;
/// Between lanes, and between frames along a lane, metres.
const LANE_M: f32 = 0.7;
const STEP_M: f32 = 0.12;
/// At 0.5 m/s.
const STEP_S: f32 = 0.24;
/// Shadows that pass in a lane.
const SHADOWS_A_LANE: u32 = 2;

/// What is added to the map's limit for the curve of spills found over spots invented, natural logarithms.
pub const OFFSETS: [f32; 15] =
    [-9.0, -7.0, -6.0, -5.0, -4.0, -3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 5.0, 7.0, 9.0];

/// A pass over a hall.
#[derive(Clone, Debug)]
pub struct Pass {
    /// The floor.
    pub floor: FloorKind,
    /// Square metres of the hall.
    pub area_m2: f32,
    /// Spills of each kind that were found, and that there were.
    pub found: [(DirtKind, u32, u32); 4],
    /// Spots where nothing was spilled.
    pub false_spots: u32,
    /// Every spot of the map within the hall, and whether something was spilled there.
    pub spots: Vec<(DirtSpot, bool)>,
    /// Spills found and spots invented with each of [`OFFSETS`].
    pub trade: Vec<(u32, u32)>,
    /// Frames.
    pub frames: u32,
    /// Of the detector and the map, all frames.
    pub took: Duration,
}

impl Pass {
    /// Adds another hall of the same floor.
    pub fn add(&mut self, other: &Self) {
        self.area_m2 += other.area_m2;
        for ((_, hits, all), (_, other_hits, other_all)) in self.found.iter_mut().zip(other.found) {
            (*hits, *all) = (*hits + other_hits, *all + other_all);
        }
        self.false_spots += other.false_spots;
        self.spots.extend_from_slice(&other.spots);
        for ((hits, invented), (other_hits, other_invented)) in self.trade.iter_mut().zip(&other.trade) {
            (*hits, *invented) = (*hits + other_hits, *invented + other_invented);
        }
        self.frames += other.frames;
        self.took += other.took;
    }
}

/// Two spills on each lane, the kinds in turn.
fn spill(scene: &mut FloorScene, (lanes, length_m): (u32, f32), random: &mut Pcg32) {
    for (number, kind) in DirtKind::ALL.into_iter().cycle().take(2 * lanes as usize).enumerate() {
        let lane = number as u32 / 2;
        let along =
            length_m * (0.25 + 0.5 * (number % 2) as f32) + random.uniform_between(-0.15, 0.15) * length_m;
        let across = LANE_M * (lane as f32 + 0.5) + random.uniform_between(-0.2, 0.2);
        scene.spills.push(Spill::random(kind, Point2::new(along, across), random));
    }
}

/// Drives lanes of a length over a hall with spills.
///
/// # Errors
/// A frame could not be judged.
pub fn pass(floor: FloorKind, (lanes, length_m): (u32, f32), seed: u64) -> anyhow::Result<Pass> {
    let mut random = Pcg32::new(seed, 77);
    let mut scene = FloorScene::new(floor, length_m.max(LANE_M * lanes as f32), seed);
    let width_m = LANE_M * lanes as f32;
    spill(&mut scene, (lanes, length_m), &mut random);
    let camera = FloorCamera::default();
    let geometry = GridGeometry::new(
        ((length_m + 1.0) / CELL_M) as u16,
        ((width_m + 1.0) / CELL_M) as u16,
        CELL_M,
        Point2::new(-0.5, -0.5),
    )
    .expect("a hall has an area");
    let mut cells = vec![SeenCell::default(); geometry.cell_count()];
    let mut map = SeenDirtMap::new(geometry, &mut cells[..]).expect("as many cells");
    let mut detectors = DirtDetectors::default();
    let (mut frame, mut took) = (0_u32, Duration::ZERO);
    for lane in 0..lanes {
        let across = LANE_M * (lane as f32 + 0.5);
        scene.lighting.shadows.clear();
        let steps = ((length_m + 1.5) / STEP_M) as u32;
        for _ in 0..SHADOWS_A_LANE {
            let near = Point2::new(random.uniform_between(0.0, length_m), across);
            let at_s = (near.x_m + 0.5) / STEP_M * STEP_S;
            scene.lighting.add_shadow(near, at_s, &mut random);
        }
        for step in 0..steps {
            let forward = -1.5 + STEP_M * step as f32;
            let wobble_rad = random.uniform_between(-0.02, 0.02);
            // Lanes are driven there and back.
            let pose = if lane % 2 == 0 {
                Pose2::new(forward, across, wobble_rad)
            } else {
                Pose2::new(length_m - forward, across, core::f32::consts::PI + wobble_rad)
            };
            let picture = scene.picture(&camera, pose, PictureMoment { frame, at_s: STEP_S * step as f32 });
            frame += 1;
            let started = std::time::Instant::now();
            let image = ColorImage::new(Stamp::ZERO, picture.size, &picture.rgb)?;
            let view = view(&camera, pose);
            detectors.watch(&image, &picture.usable(), None)?;
            map.add(&view, &detectors.scores(), Stamp::from_micros(u64::from(frame) * 240_000));
            took += started.elapsed();
        }
    }
    let end = Stamp::from_micros(u64::from(frame + 1) * 240_000);
    Ok(Pass { frames: frame, took, ..count(&map, &scene, ([length_m, width_m], end)) })
}

/// What of the spills the map shows, and what else.
fn count(map: &SeenDirtMap<&mut [SeenCell]>, scene: &FloorScene, (size_m, end): ([f32; 2], Stamp)) -> Pass {
    let [length_m, width_m] = size_m;
    let is_spill = |spot: &DirtSpot| scene.spills.iter().any(|spill| touches(spot, spill));
    let is_inside = |spot: &&DirtSpot| {
        let place = spot.centre_in_map;
        place.x_m >= 0.0 && place.x_m <= length_m && place.y_m >= 0.0 && place.y_m <= width_m
    };
    let trade = OFFSETS.iter().map(|offset| {
        let spots = map.spots_beyond(map.limit().moved(*offset), SeenLayer::First, end).spots;
        let hits = scene.spills.iter().filter(|spill| spots.iter().any(|spot| touches(spot, spill))).count();
        let invented = spots.iter().filter(is_inside).filter(|spot| !is_spill(spot)).count();
        (hits as u32, invented as u32)
    });
    let trade = trade.collect();
    let spots = map.spots(SeenLayer::First, end).spots;
    let found = DirtKind::ALL.map(|kind| {
        let of_kind = || scene.spills.iter().filter(move |spill| spill.kind == kind);
        let hits = of_kind().filter(|spill| spots.iter().any(|spot| touches(spot, spill))).count();
        (kind, hits as u32, of_kind().count() as u32)
    });
    let spots: Vec<(DirtSpot, bool)> =
        spots.iter().filter(is_inside).map(|spot| (*spot, is_spill(spot))).collect();
    let false_spots = spots.iter().filter(|(_, is_spill)| !is_spill).count() as u32;
    Pass {
        floor: scene.floor,
        area_m2: length_m * width_m,
        found,
        false_spots,
        spots,
        trade,
        frames: 0,
        took: Duration::ZERO,
    }
}

/// A spot belongs to a spill if its rectangle reaches within a cell of the spill's outline.
fn touches(spot: &DirtSpot, spill: &Spill) -> bool {
    let centre = spill.centre_in_world;
    let (low, high) = (spot.low_in_map, spot.high_in_map);
    let (x, y) = (centre.x_m.clamp(low.x_m, high.x_m), centre.y_m.clamp(low.y_m, high.y_m));
    centre.distance(Point2::new(x, y)) <= spill.radii_m[0].max(spill.radii_m[1]) + CELL_M
}
