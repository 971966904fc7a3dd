//! Voxels in blocks of 8 × 8 × 8, so that a ray finds most of its voxels where it found the last one.

use floorguard_types::number::{truncating_u32, truncating_usize};

/// What was measured in a voxel. All zero: never touched, so nothing is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Voxel {
    /// Sweeps whose rays went through; halved together with `hits` when either would overflow.
    pub passes: u8,
    /// Sweeps with a return in it.
    pub hits: u8,
    /// Number of the last sweep that touched it; 0 for none.
    pub last_sweep: u16,
    /// Passes since the last hit.
    pub run: u8,
    /// Most passes between two hits, before the first or after the last: a person who leaves makes one long run, rays that
    /// now and then miss an edge make short ones.
    pub longest_run: u8,
}

/// Voxels along an edge of a block, as a power of two.
const EDGE_SHIFT: u32 = 3;
/// Voxels of a block.
const CELLS: usize = 512;

/// Which voxel: whole voxels from the origin of the map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct VoxelIndex {
    pub x: i32,
    pub y: i32,
    pub z: i32,
}

/// Which block: whole blocks from the origin of the map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BlockKey {
    /// Along x.
    pub x: i32,
    /// Along y.
    pub y: i32,
    /// Along z.
    pub z: i32,
}

impl BlockKey {
    /// No block of a map: metres beyond any building.
    pub const NONE: Self = Self { x: i32::MIN, y: i32::MIN, z: i32::MIN };

    /// A number to look the block up by; neighbours have different ones (Teschner et al. 2003).
    #[inline]
    #[must_use]
    pub fn hash(self) -> u32 {
        let mixed = truncating_u32(self.x).wrapping_mul(73_856_093)
            ^ truncating_u32(self.y).wrapping_mul(19_349_663)
            ^ truncating_u32(self.z).wrapping_mul(83_492_791);
        mixed ^ (mixed >> 15)
    }
}

impl VoxelIndex {
    #[inline]
    pub(super) const fn block(self) -> BlockKey {
        BlockKey { x: self.x >> EDGE_SHIFT, y: self.y >> EDGE_SHIFT, z: self.z >> EDGE_SHIFT }
    }

    #[inline]
    pub(super) fn cell(self) -> usize {
        let low = |value: i32| truncating_usize(value & 7);
        (low(self.z) << (2 * EDGE_SHIFT)) | (low(self.y) << EDGE_SHIFT) | low(self.x)
    }
}

/// 8 × 8 × 8 voxels; 3 KiB.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Block {
    pub(super) key: BlockKey,
    pub(super) voxels: [Voxel; CELLS],
}

impl Block {
    /// Belongs to no place yet.
    pub const FREE: Self = Self {
        key: BlockKey::NONE,
        voxels: [Voxel { passes: 0, hits: 0, last_sweep: 0, run: 0, longest_run: 0 }; CELLS],
    };

    /// An untouched block of a place.
    #[must_use]
    pub const fn new(key: BlockKey) -> Self {
        Self { key, ..Self::FREE }
    }
}

/// Where blocks are kept: fixed memory on a robot, growing memory on a computer.
pub trait VoxelStore {
    /// Number of the block, made if it is not there yet; `None` where memory is exhausted (the caller counts).
    fn find_or_make(&mut self, key: BlockKey) -> Option<usize>;
    /// Number of the block, if it is there.
    fn find(&self, key: BlockKey) -> Option<usize>;
    /// A block by its number.
    fn block(&self, number: usize) -> Option<&Block>;
    /// The same, to be changed.
    fn block_mut(&mut self, number: usize) -> Option<&mut Block>;
}

/// A hash table of blocks over storage that is handed in: an array, or a boxed slice.
#[derive(Clone, Debug)]
pub struct FixedVoxels<S> {
    blocks: S,
}

/// A block is searched in so many places; then memory counts as exhausted.
const PROBES: usize = 32;

impl<S: AsRef<[Block]> + AsMut<[Block]>> FixedVoxels<S> {
    /// An empty table; the storage is cleared.
    #[must_use]
    pub fn new(mut blocks: S) -> Self {
        blocks.as_mut().fill(Block::FREE);
        Self { blocks }
    }

    fn places(&self, key: BlockKey) -> impl Iterator<Item = usize> + use<S> {
        let length = self.blocks.as_ref().len();
        let first = truncating_usize(key.hash()).checked_rem(length).unwrap_or(0);
        (0..PROBES.min(length)).map(move |probe| {
            let place = first.saturating_add(probe);
            if place < length { place } else { place.saturating_sub(length) }
        })
    }
}

impl<S: AsRef<[Block]> + AsMut<[Block]>> VoxelStore for FixedVoxels<S> {
    fn find_or_make(&mut self, key: BlockKey) -> Option<usize> {
        for place in self.places(key) {
            let block = self.blocks.as_mut().get_mut(place)?;
            if block.key == BlockKey::NONE {
                block.key = key;
            }
            if block.key == key {
                return Some(place);
            }
        }
        None
    }

    fn find(&self, key: BlockKey) -> Option<usize> {
        self.places(key).find(|place| self.blocks.as_ref().get(*place).is_some_and(|block| block.key == key))
    }

    #[inline]
    fn block(&self, number: usize) -> Option<&Block> {
        self.blocks.as_ref().get(number)
    }

    #[inline]
    fn block_mut(&mut self, number: usize) -> Option<&mut Block> {
        self.blocks.as_mut().get_mut(number)
    }
}

impl Voxel {
    /// A return of the sweep lies in it. Counts once a sweep.
    #[inline]
    pub(super) fn hit(&mut self, sweep: u16) {
        if self.last_sweep != sweep {
            self.last_sweep = sweep;
            self.make_space();
            self.hits = self.hits.saturating_add(1);
            self.run = 0;
        }
    }

    /// A ray of the sweep went through. Counts once a sweep, and not where the sweep has a return.
    #[inline]
    pub(super) fn pass(&mut self, sweep: u16) {
        if self.last_sweep != sweep {
            self.last_sweep = sweep;
            self.make_space();
            self.passes = self.passes.saturating_add(1);
            self.run = self.run.saturating_add(1);
            self.longest_run = self.longest_run.max(self.run);
        }
    }

    #[inline]
    const fn make_space(&mut self) {
        if self.hits == u8::MAX || self.passes == u8::MAX {
            self.hits /= 2;
            self.passes /= 2;
        }
    }
}
