//! Voxels in memory that grows with the map.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use floorguard_mapping::people_removal::{Block, BlockKey, VoxelStore};

/// Blocks in the order in which they were first touched. Grows by 3 KiB for each 0.5 m³ of seen space (voxels of 0.1 m).
#[derive(Clone, Debug, Default)]
pub struct GrowingVoxels {
    blocks: Vec<Block>,
    numbers: HashMap<BlockKey, u32, BuildHasherDefault<KeyHasher>>,
}

impl GrowingVoxels {
    /// Memory of the blocks, bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.blocks.len() * size_of::<Block>()
    }
}

impl VoxelStore for GrowingVoxels {
    fn find_or_make(&mut self, key: BlockKey) -> Option<usize> {
        let next = u32::try_from(self.blocks.len()).ok()?;
        let number = *self.numbers.entry(key).or_insert(next);
        if number == next {
            self.blocks.push(Block::new(key));
        }
        Some(number as usize)
    }

    fn find(&self, key: BlockKey) -> Option<usize> {
        self.numbers.get(&key).map(|number| *number as usize)
    }

    #[inline]
    fn block(&self, number: usize) -> Option<&Block> {
        self.blocks.get(number)
    }

    #[inline]
    fn block_mut(&mut self, number: usize) -> Option<&mut Block> {
        self.blocks.get_mut(number)
    }
}

/// Multiplies and rotates each number in: keys come from measurements, not from an attacker.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct KeyHasher(u64);

impl Hasher for KeyHasher {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|byte| self.write_u64(u64::from(*byte)));
    }

    fn write_i32(&mut self, value: i32) {
        self.write_u64(value as u32 as u64);
    }

    fn write_u64(&mut self, value: u64) {
        self.0 = (self.0.rotate_left(23) ^ value).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    }
}
