//! The two profiles, side by side, with the reason of each size.

use core::fmt::Debug;

use super::keep::{Keep, Kept, LeftOut};
use super::sizes::{Of, Size};

/// Every size that differs between programs. What is the same in all is in [`crate::capacities`].
pub trait Profile: Copy + Debug + Default + PartialEq + Eq + 'static {
    /// Rings of the largest lidar; packets of a larger one are refused.
    type Rings: Size;
    /// Whether reflectivities are kept, and with them what people look like.
    type Reflectivity: Keep;
    /// Beams of a scan.
    type Beams: Size;
    /// Safety scanners beside the first one.
    type RearScanners: Size;
    /// Clusters kept of one sweep; the farthest are dropped first and counted.
    type Clusters: Size;
    /// Provisional names of objects while a sweep is grouped: one for each place where something begins. A sweep of a hall
    /// needs some hundred, one through a tree some thousand; cells beyond stay ungrouped and are counted.
    type Labels: Size;
    /// People tracked at once; the farthest are dropped first and counted.
    type Tracks: Size;
    /// Detections that take part in one association: two for each track.
    type Detections: Size;
    /// Pairs of one association: each track may have eight detections within its gate.
    type Pairs: Size;
    /// Objects of a sweep whose motion is judged; the farthest are dropped first and counted. The correspondence
    /// compares all pairs.
    type MotionObjects: Size;
    /// Moving objects believed in at once.
    type MotionTracked: Size;
    /// Columns along each side of the motion voxels, 0.1 m each; a power of two. Memory: four bytes a column and
    /// reference.
    type MotionVoxels: Size;
    /// Cells along each side of the same window: a quarter of the voxels.
    type MotionCells: Size;
    /// Sweeps kept to compare with: the more, the steadier the age of the oldest. At least two.
    type MotionReferences: Size;
    /// Columns of the widest depth image of the floor.
    type FloorColumns: Size;
    /// Points among which the floor is searched when nothing is known.
    type FloorSamples: Size;
    /// Objects on the floor in one image; the farthest are dropped first and counted.
    type FloorObjects: Size;
    /// Connected parts of an image that may be open at once: one can begin at every second column of a row.
    type FloorParts: Size;
    /// Lattice points a row from which the floor is fitted.
    const FLOOR_LATTICE_COLUMNS: u16;
}

/// A microcontroller: everything within 512 KiB of RAM.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Board;

/// A computer with an operating system.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Host;

impl Profile for Board {
    /// VLP-16 and Puck Hi-Res.
    type Rings = Of<16>;
    /// No stage on the microcontroller asks for it.
    type Reflectivity = LeftOut;
    /// 270° at 0.5° and both ends (SICK S300).
    type Beams = Of<541>;
    /// The table of a second one takes 22 KiB.
    type RearScanners = Of<0>;
    type Clusters = Of<256>;
    type Labels = Of<4_096>;
    type Tracks = Of<32>;
    type Detections = Of<64>;
    type Pairs = Of<256>;
    type MotionObjects = Of<64>;
    type MotionTracked = Of<16>;
    type MotionVoxels = Of<128>;
    type MotionCells = Of<32>;
    type MotionReferences = Of<2>;
    type FloorColumns = Of<160>;
    type FloorSamples = Of<512>;
    type FloorObjects = Of<16>;
    /// For every second one of a quarter of the columns, in several rows.
    type FloorParts = Of<256>;
    const FLOOR_LATTICE_COLUMNS: u16 = 54;
}

impl Profile for Host {
    /// VLP-32C and HDL-32E.
    type Rings = Of<32>;
    type Reflectivity = Kept;
    /// The microScan3 family delivers up to 2,751.
    type Beams = Of<2_751>;
    type RearScanners = Of<1>;
    type Clusters = Of<1_024>;
    type Labels = Of<16_384>;
    type Tracks = Of<128>;
    type Detections = Of<256>;
    type Pairs = Of<1_024>;
    type MotionObjects = Of<256>;
    type MotionTracked = Of<64>;
    type MotionVoxels = Of<256>;
    type MotionCells = Of<64>;
    type MotionReferences = Of<3>;
    type FloorColumns = Of<640>;
    /// Five times those of the published ground plane.
    type FloorSamples = Of<1_024>;
    type FloorObjects = Of<32>;
    type FloorParts = Of<1_024>;
    const FLOOR_LATTICE_COLUMNS: u16 = 160;
}

/// What the names without `Of` are of: a microcontroller's sizes on bare metal, a computer's elsewhere.
#[cfg(target_os = "none")]
pub type Native = Board;
/// What the names without `Of` are of: a microcontroller's sizes on bare metal, a computer's elsewhere.
#[cfg(not(target_os = "none"))]
pub type Native = Host;
