//! Numbers as bytes, little-endian, with a checksum at the end: what is cut or damaged anywhere is not read.

use std::io::{self, Write};

use floorguard_types::geometry::Point2;

use crate::se2::Se2;

/// Writes numbers one by one: a mapping is not copied to be kept.
pub struct Saving<'a> {
    to: &'a mut dyn Write,
    sum: Checksum,
    refused: Option<io::Error>,
}

/// Reads what [`Saving`] wrote; each reading answers `None` beyond the end.
pub struct Reading<'a> {
    rest: &'a [u8],
}

/// FNV-1a, 64 bits (Fowler, Noll, Vo).
struct Checksum(u64);

impl Checksum {
    const NONE: Self = Self(0xCBF2_9CE4_8422_2325);

    fn add(&mut self, bytes: &[u8]) {
        let step = |sum: u64, byte: &u8| (sum ^ u64::from(*byte)).wrapping_mul(0x100_0000_01B3);
        self.0 = bytes.iter().fold(self.0, step);
    }
}

impl<'a> Saving<'a> {
    pub fn new(to: &'a mut dyn Write) -> Self {
        Self { to, sum: Checksum::NONE, refused: None }
    }

    fn put(&mut self, bytes: &[u8]) {
        self.sum.add(bytes);
        if self.refused.is_none() {
            self.refused = self.to.write_all(bytes).err();
        }
    }

    pub fn count(&mut self, value: usize) {
        self.put(&(value as u64).to_le_bytes());
    }

    pub fn number(&mut self, value: f64) {
        self.put(&value.to_le_bytes());
    }

    pub fn single(&mut self, value: f32) {
        self.put(&value.to_le_bytes());
    }

    pub fn pose(&mut self, pose: Se2) {
        [pose.x_m, pose.y_m, pose.heading_rad].into_iter().for_each(|value| self.number(value));
    }

    pub fn pose_if_any(&mut self, pose: Option<Se2>) {
        self.count(usize::from(pose.is_some()));
        self.pose(pose.unwrap_or_default());
    }

    pub fn points(&mut self, points: &[Point2]) {
        self.count(points.len());
        for point in points {
            self.single(point.x_m);
            self.single(point.y_m);
        }
    }

    pub fn bytes(&mut self, bytes: &[u8]) {
        self.count(bytes.len());
        self.put(bytes);
    }

    /// Ends with the checksum.
    ///
    /// # Errors
    /// Something could not be written.
    pub fn finish(mut self) -> io::Result<()> {
        let sum = self.sum.0;
        self.put(&sum.to_le_bytes());
        self.refused.map_or(Ok(()), Err)
    }
}

impl<'a> Reading<'a> {
    /// `None` if the checksum is wrong.
    pub fn new(bytes: &'a [u8]) -> Option<Self> {
        let (rest, sum) = bytes.split_last_chunk::<8>()?;
        let mut own = Checksum::NONE;
        own.add(rest);
        (own.0 == u64::from_le_bytes(*sum)).then_some(Self { rest })
    }

    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.rest.split_first_chunk::<N>()?;
        self.rest = rest;
        Some(*first)
    }

    pub fn count(&mut self) -> Option<usize> {
        usize::try_from(u64::from_le_bytes(self.take()?)).ok()
    }

    pub fn number(&mut self) -> Option<f64> {
        self.take().map(f64::from_le_bytes)
    }

    pub fn single(&mut self) -> Option<f32> {
        self.take().map(f32::from_le_bytes)
    }

    pub fn byte(&mut self) -> Option<u8> {
        self.take().map(u8::from_le_bytes)
    }

    /// Not wrapped again: the bits stay.
    pub fn pose(&mut self) -> Option<Se2> {
        let (x_m, y_m, heading_rad) = (self.number()?, self.number()?, self.number()?);
        Some(Se2 { x_m, y_m, heading_rad })
    }

    pub fn pose_if_any(&mut self) -> Option<Option<Se2>> {
        let is_there = self.count()? == 1;
        let pose = self.pose()?;
        Some(is_there.then_some(pose))
    }

    pub fn points(&mut self) -> Option<Box<[Point2]>> {
        let count = self.count()?;
        (0..count).map(|_| Some(Point2::new(self.single()?, self.single()?))).collect()
    }

    /// As many as a count before them says.
    pub fn all<T>(&mut self, mut one: impl FnMut(&mut Self) -> Option<T>) -> Option<Vec<T>> {
        let count = self.count()?;
        (0..count).map(|_| one(self)).collect()
    }
}
