//! Sizes of the window, each with its reason.

use super::cell::WindowCell;
use super::geometry::WindowGeometry;

/// Beams of a scan: a URG-04LX gives 682, of which 511 are within ±90°.
pub const WINDOW_BEAMS_MAX: usize = 768;
/// Person boxes of a picture: more people do not fit between two walls of a corridor.
pub const PERSON_BOXES_MAX: usize = 16;
/// Cells of one buffer of the three grids at 0.05 m, 6.2 m wide and 2.4 m high.
pub const WINDOW_CELLS: usize = 3 * 124 * 48;
/// The same at 0.025 m.
pub const FINE_WINDOW_CELLS: usize = 3 * 248 * 96;
/// Bearings of a sight polygon: half a degree each over 225°.
pub const SIGHT_BEARINGS: usize = 450;

/// The window reaches this far to both sides of a normal, metres: 4 m of a URG-04LX within ±37.5° are 3.07 m.
pub const WINDOW_HALF_WIDTH_M: f32 = 3.1;
/// Height of the window, metres.
pub const WINDOW_HEIGHT_M: f32 = 2.4;

const _: () = assert!(size_of::<WindowCell>() == 8, "a cell has eight bytes");
const _: () = assert!(size_of::<WindowGeometry>() <= 32);
