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
}

impl Profile for Host {
    /// VLP-32C and HDL-32E.
    type Rings = Of<32>;
    type Reflectivity = Kept;
    /// The microScan3 family delivers up to 2,751.
    type Beams = Of<2_751>;
}

/// What the names without `Of` are of: a microcontroller's sizes on bare metal, a computer's elsewhere.
#[cfg(target_os = "none")]
pub type Native = Board;
/// What the names without `Of` are of: a microcontroller's sizes on bare metal, a computer's elsewhere.
#[cfg(not(target_os = "none"))]
pub type Native = Host;
