//! A table of cubes of fixed size: eight places for each value of the hash, found by eight comparisons.

use floorguard_types::number::truncating_usize;
use nalgebra::Vector3;

use super::key::{Level, VoxelKey, middle_m};
use super::plane::Plane;
use super::voxel::Voxel;

/// Cubes with the same value of the hash that can be kept.
pub const WAYS: usize = 8;

/// The cubes of one value of the hash.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bucket {
    keys: [VoxelKey; WAYS],
    voxels: [Voxel; WAYS],
}

impl Bucket {
    /// Without cubes.
    pub const EMPTY: Self = Self { keys: [VoxelKey::NONE; WAYS], voxels: [Voxel::EMPTY; WAYS] };
}

/// Sizes of the cubes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoxelMapConfig {
    /// Edge of a small cube, metres, > 0.
    pub fine_m: f32,
    /// Edge of a large one.
    pub coarse_m: f32,
    /// A cube takes no more returns than this: then its surface is known, and stays.
    pub count_most: u16,
}

impl Default for VoxelMapConfig {
    fn default() -> Self {
        Self { fine_m: 0.4, coarse_m: 1.2, count_most: 100 }
    }
}

/// Where a cube lies in the table; good until the next change of the map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VoxelPlace {
    bucket: u32,
    way: u8,
}

/// Cubes in storage that is handed in: a number of buckets that is a power of two (others are used in part). Invariant: a key
/// stands in one place at most. Full buckets give up the cube that was seen least recently.
///
/// ```
/// use floorguard_mapping::lidar_odometry::{Bucket, Level, VoxelMap, VoxelMapConfig};
/// use nalgebra::Vector3;
///
/// let mut map = VoxelMap::new([Bucket::EMPTY; 16], VoxelMapConfig::default());
/// for (y, z) in [(0.1, 0.1), (0.3, 0.1), (0.1, 0.3), (0.3, 0.3), (0.2, 0.2)] {
///     map.insert(&Vector3::new(2.0, y, z), 0);
/// }
/// let place = map.find(&Vector3::new(2.1, 0.2, 0.2), Level::Fine).unwrap();
/// let plane = map.plane(place);
/// assert!(plane.normal.x.abs() > 0.999 && (plane.mean.x - 2.0).abs() < 1.0e-6);
/// ```
#[derive(Clone, Debug)]
pub struct VoxelMap<S> {
    storage: S,
    config: VoxelMapConfig,
    mask: u64,
    used: u32,
    replaced: u32,
}

/// A map in an array: for places without a heap.
pub type FixedVoxelMap<const BUCKETS: usize> = VoxelMap<[Bucket; BUCKETS]>;

impl<S: AsRef<[Bucket]> + AsMut<[Bucket]>> VoxelMap<S> {
    /// An empty map.
    #[must_use]
    pub fn new(storage: S, config: VoxelMapConfig) -> Self {
        let buckets = floorguard_types::number::count_u64(storage.as_ref().len());
        // The largest power of two that fits, less one.
        let mask = if buckets == 0 { 0 } else { (1_u64 << buckets.ilog2()).saturating_sub(1) };
        let mut map = Self { storage, config, mask, used: 0, replaced: 0 };
        map.clear();
        map
    }

    /// The sizes.
    #[must_use]
    pub const fn config(&self) -> VoxelMapConfig {
        self.config
    }

    /// How many cubes it holds.
    #[must_use]
    pub const fn len(&self) -> u32 {
        self.used
    }

    /// Whether it holds none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.used == 0
    }

    /// How many cubes were given up for others.
    #[must_use]
    pub const fn replaced(&self) -> u32 {
        self.replaced
    }

    /// Empties the map.
    pub fn clear(&mut self) {
        self.storage.as_mut().iter_mut().for_each(|bucket| *bucket = Bucket::EMPTY);
        (self.used, self.replaced) = (0, 0);
    }

    /// Edge of a cube, metres.
    #[must_use]
    pub fn edge_m(&self, level: Level) -> f32 {
        match level {
            Level::Fine => self.config.fine_m,
            Level::Coarse => self.config.coarse_m,
        }
    }

    /// The cube of a point.
    #[inline]
    #[must_use]
    pub fn key(&self, point_in_map: &Vector3<f32>, level: Level) -> VoxelKey {
        VoxelKey::of(point_in_map, 1.0 / self.edge_m(level).max(1.0e-3), level)
    }

    /// Where the cube of a point is, if it has returns. Eight comparisons.
    #[must_use]
    pub fn find(&self, point_in_map: &Vector3<f32>, level: Level) -> Option<VoxelPlace> {
        self.find_key(self.key(point_in_map, level))
    }

    /// The same with the key.
    #[inline]
    #[must_use]
    pub fn find_key(&self, key: VoxelKey) -> Option<VoxelPlace> {
        let bucket = key.hash() & self.mask;
        let keys = &self.storage.as_ref().get(truncating_usize(bucket))?.keys;
        let way = keys.iter().position(|other| *other == key)?;
        Some(VoxelPlace {
            bucket: floorguard_types::number::truncating_u32(bucket),
            way: floorguard_types::number::truncating_u8(way),
        })
    }

    /// The plane of a cube; none for a place of another map.
    #[inline]
    #[must_use]
    pub fn plane(&self, place: VoxelPlace) -> &Plane {
        let bucket = self.storage.as_ref().get(truncating_usize(place.bucket));
        bucket
            .and_then(|bucket| bucket.voxels.get(usize::from(place.way)))
            .map_or(&Plane::NONE, |voxel| &voxel.plane)
    }

    /// Enters a return of sweep number `sweep` into its small and its large cube.
    pub fn insert(&mut self, point_in_map: &Vector3<f32>, sweep: u32) {
        self.insert_at(point_in_map, Level::Fine, sweep);
        self.insert_at(point_in_map, Level::Coarse, sweep);
    }

    fn insert_at(&mut self, point: &Vector3<f32>, level: Level, sweep: u32) {
        let edge_m = self.edge_m(level);
        let key = VoxelKey::of(point, 1.0 / edge_m.max(1.0e-3), level);
        let bucket = truncating_usize(key.hash() & self.mask);
        let Some(Bucket { keys, voxels }) = self.storage.as_mut().get_mut(bucket) else { return };
        let way = keys.iter().position(|other| *other == key).unwrap_or_else(|| {
            let free = keys.iter().position(|other| *other == VoxelKey::NONE);
            let oldest = || voxels.iter().enumerate().min_by_key(|(_, voxel)| voxel.seen);
            match free {
                Some(_) => self.used = self.used.saturating_add(1),
                None => self.replaced = self.replaced.saturating_add(1),
            }
            free.or_else(|| oldest().map(|(way, _)| way)).unwrap_or(0)
        });
        let (Some(old), Some(voxel)) = (keys.get_mut(way), voxels.get_mut(way)) else { return };
        if *old != key {
            (*old, *voxel) = (key, Voxel::EMPTY);
        }
        voxel.seen = sweep;
        voxel.add(point, (&middle_m(point, edge_m), edge_m), self.config.count_most);
    }

    /// The planes of all cubes of a level, in the order of the table.
    pub fn planes(&self, level: Level) -> impl Iterator<Item = &Plane> {
        let cells = self.storage.as_ref().iter().flat_map(|bucket| bucket.keys.iter().zip(&bucket.voxels));
        cells
            .filter(move |(key, voxel)| key.level() == Some(level) && voxel.plane.is_known())
            .map(|(_, voxel)| &voxel.plane)
    }
}
