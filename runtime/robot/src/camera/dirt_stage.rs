//! From a colour picture to the map of seen dirt.
//!
//! Only what the depth picture beside it shows as free floor is judged. A picture that repeats itself, comes from the
//! future or shows too little floor adds nothing: the floor stays as unknown as it was.

use floorguard_guard::SIGHT_MAX_US;
use floorguard_mapping::GridGeometry;
use floorguard_mapping::seen_dirt::{CellState, DirtSpots, SeenCell, SeenDirtMap, SeenLayer, ViewOutcome};
use floorguard_perception::floor::dirt::DirtFault;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::sensing::{ColorImage, FrameFault, FrameWatch, ImageSize, PinholeCamera};
use floorguard_types::time::{Age, Stamp};

use super::floor_stage::FloorStage;
use crate::picture_files::DirtDetectors;

/// Edge of a cell, and of the square around the start that is mapped, metres.
const CELL_M: f32 = 0.05;
const SIDE_M: f32 = 40.0;
/// A picture this old is judged no more, microseconds.
const LATE_US: u64 = SIGHT_MAX_US + 1;

/// Why a picture added nothing to the map.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DirtBlind {
    /// The picture says nothing about now.
    #[error(transparent)]
    Frame(#[from] FrameFault),
    /// The picture is too old to say anything about now.
    #[error("the picture came {} ms late", .0 / 1_000)]
    Late(u64),
    /// Not as many bytes as pixels of the agreed size.
    #[error("{bytes} bytes are no picture of {} × {} pixels", size.width, size.height)]
    WrongSize {
        /// That came.
        bytes: usize,
        /// That was agreed.
        size: ImageSize,
    },
    /// Without a plane nobody knows where a pixel lies.
    #[error("the floor's plane is unknown")]
    NoPlane,
    /// The picture cannot be judged.
    #[error(transparent)]
    Unjudged(#[from] DirtFault),
}

/// The memory of one colour camera, and the map that it fills, in the frame of the poses that it is given.
pub struct DirtStage {
    size: ImageSize,
    camera: PinholeCamera,
    watch: FrameWatch,
    detectors: DirtDetectors,
    map: SeenDirtMap<Vec<SeenCell>>,
    usable: Vec<bool>,
    /// Pictures that were judged, and that added nothing.
    pub frames: (u32, u32),
}

/// What was seen of the dirt so far.
#[derive(Clone, Debug)]
pub struct SeenDirt {
    /// Where the cells lie.
    pub geometry: GridGeometry,
    /// As first perceived, and as it is now: heat in percent, 0 clean; −1 unknown.
    pub layers: [Vec<i8>; 2],
    /// Square metres seen, and dirty, first and now.
    pub seen_m2: f32,
    /// See `seen_m2`.
    pub dirty_m2: [f32; 2],
    /// Spots as first perceived, largest first.
    pub spots: DirtSpots,
    /// Pictures that were judged, and that added nothing.
    pub frames: (u32, u32),
}

impl SeenDirt {
    /// For the console.
    #[must_use]
    pub fn words(&self) -> String {
        let ([first_m2, now_m2], (judged, unknown)) = (self.dirty_m2, self.frames);
        let spots = self.spots.spots.len();
        format!(
            "{:.1} m² of floor seen in {judged} pictures, {first_m2:.2} m² dirty at first and {now_m2:.2} m² now, in {spots} \
             spots; {unknown} pictures showed nothing that is known",
            self.seen_m2
        )
    }
}

impl DirtStage {
    /// For pictures of a size, whose intrinsics these are; `None` for a size that makes no map.
    #[must_use]
    pub fn new(size: ImageSize, camera: PinholeCamera) -> Option<Self> {
        let cells = (SIDE_M / CELL_M) as u16;
        let corner = Point2::new(-0.5 * SIDE_M, -0.5 * SIDE_M);
        let geometry = GridGeometry::new(cells, cells, CELL_M, corner)?;
        let map = SeenDirtMap::new(geometry, vec![SeenCell::default(); geometry.cell_count()])?;
        Some(Self {
            size,
            camera,
            watch: FrameWatch::NEW,
            detectors: DirtDetectors::default(),
            map,
            usable: vec![false; size.width * size.height],
            frames: (0, 0),
        })
    }

    /// Adds a picture that belongs to the depth picture that `floor` has just looked at.
    ///
    /// # Errors
    /// The picture adds nothing: why.
    pub fn process(
        &mut self,
        rgb: &[u8],
        floor: &FloorStage,
        robot_in_map: Pose2,
        (stamp, now): (Stamp, Stamp),
    ) -> Result<ViewOutcome, DirtBlind> {
        let outcome = self.judge(rgb, floor, robot_in_map, (stamp, now));
        match outcome {
            Ok(_) => self.frames.0 += 1,
            Err(_) => self.frames.1 += 1,
        }
        outcome
    }

    /// Something came that is no picture, or nothing at all.
    pub const fn miss(&mut self) {
        self.frames.1 = self.frames.1.saturating_add(1);
    }

    fn judge(
        &mut self,
        rgb: &[u8],
        floor: &FloorStage,
        robot_in_map: Pose2,
        (stamp, now): (Stamp, Stamp),
    ) -> Result<ViewOutcome, DirtBlind> {
        let image = ColorImage::new(stamp, self.size, rgb)
            .map_err(|_| DirtBlind::WrongSize { bytes: rgb.len(), size: self.size })?;
        self.watch.accept(stamp, image.fingerprint(), now)?;
        if let Age::Past(age_us @ LATE_US..) = stamp.age(now) {
            return Err(DirtBlind::Late(age_us));
        }
        let view = floor.view(self.camera, robot_in_map).ok_or(DirtBlind::NoPlane)?;
        self.take_mask(floor);
        // Without the view nothing is carried over from earlier pictures: the map itself asks whether views agree.
        self.detectors.watch(&image, &self.usable, None)?;
        Ok(self.map.add(&view, &self.detectors.scores(), now))
    }

    /// Free floor of the depth picture, which shows the same view in another size.
    fn take_mask(&mut self, floor: &FloorStage) {
        let depth: Vec<bool> = floor.is_floor().collect();
        let ImageSize { width, height } = self.size;
        let ImageSize { width: columns, height: rows } = floor.size();
        for (index, usable) in self.usable.iter_mut().enumerate() {
            let (column, row) = (index % width * columns / width, index / width * rows / height);
            *usable = depth.get(row * columns + column).copied().unwrap_or(false);
        }
    }

    /// What was seen so far.
    #[must_use]
    pub fn seen(&self, now: Stamp) -> SeenDirt {
        let limit = self.map.limit();
        let heat = |layer: SeenLayer| {
            let percent = |cell: &SeenCell| match cell.state(layer, limit) {
                CellState::Unknown => -1,
                CellState::Clean => 0,
                CellState::Dirty => {
                    let excess = cell.excess(layer, limit).unwrap_or(0.0);
                    (40.0 + 10.0 * excess).clamp(40.0, 100.0) as i8
                }
            };
            self.map.cells().iter().map(percent).collect()
        };
        let area_m2 = |layer, state| self.map.area_m2(layer, state);
        SeenDirt {
            geometry: *self.map.geometry(),
            layers: [heat(SeenLayer::First), heat(SeenLayer::Live)],
            seen_m2: area_m2(SeenLayer::Live, CellState::Clean) + area_m2(SeenLayer::Live, CellState::Dirty),
            dirty_m2: [SeenLayer::First, SeenLayer::Live].map(|layer| area_m2(layer, CellState::Dirty)),
            spots: self.map.spots(SeenLayer::First, now),
            frames: self.frames,
        }
    }
}
