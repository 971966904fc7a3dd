//! What rays say about space: which voxels they ended in, and which they went through.

use floorguard_types::geometry::Point3;
use floorguard_types::number::{nearest_f32, saturating_i32};

use super::voxels::{BlockKey, Voxel, VoxelIndex, VoxelStore};

/// Voxels of a map with their counts, over a store.
///
/// ```
/// use floorguard_mapping::people_removal::{Block, FixedVoxels, FreeSpace};
/// use floorguard_types::geometry::Point3;
///
/// let mut space = FreeSpace::new(0.1, FixedVoxels::new(vec![Block::FREE; 64])).unwrap();
/// let person = Point3::new(2.03, 0.02, 0.55);
/// space.begin_sweep();
/// space.hit(person);
/// // In the next sweep the ray ends at the wall behind.
/// space.begin_sweep();
/// space.pass(Point3::new(0.0, 0.0, 0.55), Point3::new(4.0, 0.04, 0.55));
/// let voxel = space.at(person);
/// assert_eq!((voxel.hits, voxel.passes), (1, 1));
/// // What no ray has reached is unknown, not free.
/// assert_eq!(space.at(Point3::new(5.0, 0.0, 0.55)).passes, 0);
/// ```
#[derive(Clone, Debug)]
pub struct FreeSpace<S> {
    voxel_m: f32,
    per_m: f32,
    store: S,
    sweep: u16,
    counts: SweepCount,
    /// The block of the last hit, and its number.
    last_hit: (BlockKey, Option<usize>),
}

/// What could not be entered; saturating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SweepCount {
    /// Sweeps begun.
    pub sweeps: u32,
    /// Hits and stretches of rays that did not fit into the store.
    pub left_out: u32,
    /// Points and rays with numbers that are not finite, or beyond 8 km.
    pub refused: u32,
}

/// Voxels of a ray: 100 m in voxels of 0.05 m, in space.
const STEPS_MAX: u32 = 6_000;
/// Farther from the origin of the map lies nothing, metres.
const MAP_REACH_M: f32 = 8_000.0;

impl<S: VoxelStore> FreeSpace<S> {
    /// Empty space with voxels of this edge, 0.02 to 1 m. `None` for another edge.
    #[must_use]
    pub fn new(voxel_m: f32, store: S) -> Option<Self> {
        (0.02..=1.0).contains(&voxel_m).then(|| Self {
            voxel_m,
            per_m: 1.0 / voxel_m,
            store,
            sweep: 0,
            counts: SweepCount::default(),
            last_hit: (BlockKey::NONE, None),
        })
    }

    /// From now on hits and passes belong to another sweep. Enter the hits of a sweep before its passes: a voxel with a return
    /// is not free in that sweep.
    pub fn begin_sweep(&mut self) {
        // 0 means that no sweep touched a voxel yet.
        self.sweep = self.sweep.checked_add(1).unwrap_or(1);
        self.counts.sweeps = self.counts.sweeps.saturating_add(1);
    }

    /// Edge of a voxel, metres.
    #[must_use]
    pub const fn voxel_m(&self) -> f32 {
        self.voxel_m
    }

    /// Counters.
    #[must_use]
    pub const fn counts(&self) -> SweepCount {
        self.counts
    }

    /// A return, in the map.
    #[inline]
    pub fn hit(&mut self, point: Point3) {
        let Some(index) = self.index(point) else {
            self.counts.refused = self.counts.refused.saturating_add(1);
            return;
        };
        let key = index.block();
        if key != self.last_hit.0 {
            self.last_hit = (key, self.store.find_or_make(key));
        }
        let (number, sweep) = (self.last_hit.1, self.sweep);
        match number.and_then(|number| self.store.block_mut(number)?.voxels.get_mut(index.cell())) {
            Some(voxel) => voxel.hit(sweep),
            None => self.counts.left_out = self.counts.left_out.saturating_add(1),
        }
    }

    /// A stretch of a ray on which no return lies, in the map. Cost: a step for each face it crosses (Amanatides and Woo 1987), at
    /// most 6,000.
    pub fn pass(&mut self, from: Point3, to: Point3) {
        let (Some(first), Some(last)) = (self.index(from), self.index(to)) else {
            self.counts.refused = self.counts.refused.saturating_add(1);
            return;
        };
        let mut x = Axis::new([from.x_m, to.x_m], [first.x, last.x], self.voxel_m);
        let mut y = Axis::new([from.y_m, to.y_m], [first.y, last.y], self.voxel_m);
        let mut z = Axis::new([from.z_m, to.z_m], [first.z, last.z], self.voxel_m);
        let steps = x.steps.saturating_add(y.steps).saturating_add(z.steps).min(STEPS_MAX);
        let (mut key, mut number) = (BlockKey::NONE, None);
        for _ in 0..=steps {
            let index = VoxelIndex { x: x.index, y: y.index, z: z.index };
            if index.block() != key {
                key = index.block();
                number = self.store.find_or_make(key);
                self.counts.left_out = self.counts.left_out.saturating_add(u32::from(number.is_none()));
            }
            let block = number.and_then(|number| self.store.block_mut(number));
            if let Some(voxel) = block.and_then(|block| block.voxels.get_mut(index.cell())) {
                voxel.pass(self.sweep);
            }
            if x.next <= y.next && x.next <= z.next {
                x.step();
            } else if y.next <= z.next {
                y.step();
            } else {
                z.step();
            }
        }
    }

    /// What is known of the voxel around a point of the map.
    #[inline]
    #[must_use]
    pub fn at(&self, point: Point3) -> Voxel {
        self.reader().at(point)
    }

    /// Reads many points; neighbours in the order of a sweep mostly lie in the same block.
    #[must_use]
    pub const fn reader(&self) -> SpaceReader<'_, S> {
        SpaceReader { space: self, key: BlockKey::NONE, number: None }
    }

    #[inline]
    fn index(&self, point: Point3) -> Option<VoxelIndex> {
        let inside = |value: f32| libm::fabsf(value) < MAP_REACH_M;
        (inside(point.x_m) && inside(point.y_m) && inside(point.z_m)).then(|| VoxelIndex {
            x: floor(point.x_m * self.per_m),
            y: floor(point.y_m * self.per_m),
            z: floor(point.z_m * self.per_m),
        })
    }
}

/// Reads voxels and remembers the last block.
#[derive(Clone, Debug)]
pub struct SpaceReader<'a, S> {
    space: &'a FreeSpace<S>,
    key: BlockKey,
    number: Option<usize>,
}

impl<S: VoxelStore> SpaceReader<'_, S> {
    /// As [`FreeSpace::at`].
    #[inline]
    #[must_use]
    pub fn at(&mut self, point: Point3) -> Voxel {
        let Some(index) = self.space.index(point) else { return Voxel::default() };
        let key = index.block();
        if key != self.key {
            self.key = key;
            self.number = self.space.store.find(key);
        }
        let block = self.number.and_then(|number| self.space.store.block(number));
        block.and_then(|block| block.voxels.get(index.cell())).copied().unwrap_or_default()
    }
}

/// The whole number below; faster than `libm`'s floor.
#[inline]
pub(super) fn floor(value: f32) -> i32 {
    let towards_zero = saturating_i32(value);
    towards_zero.saturating_sub(i32::from(nearest_f32(towards_zero) > value))
}

/// One coordinate of a ray that walks through voxels.
struct Axis {
    index: i32,
    direction: i32,
    /// Share of the ray at which it enters the next voxel along this axis.
    next: f32,
    /// The same from voxel to voxel.
    delta: f32,
    /// Faces that it crosses along this axis.
    steps: u32,
}

impl Axis {
    fn new([from, to]: [f32; 2], [first, last]: [i32; 2], voxel_m: f32) -> Self {
        let length = to - from;
        let steps = first.abs_diff(last);
        let direction = if last >= first { 1 } else { -1 };
        if steps == 0 {
            return Self { index: first, direction, next: f32::INFINITY, delta: f32::INFINITY, steps };
        }
        // With a face to cross the length is not zero.
        let face_m = nearest_f32(first.saturating_add(i32::from(direction > 0))) * voxel_m;
        let next = (face_m - from) / length;
        Self { index: first, direction, next, delta: voxel_m / libm::fabsf(length), steps }
    }

    #[inline]
    fn step(&mut self) {
        self.index = self.index.wrapping_add(self.direction);
        self.next += self.delta;
    }
}
