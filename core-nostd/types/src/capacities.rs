//! Every fixed size of the core, with its reason.
//!
//! Two profiles: bare metal (everything within 512 KiB of RAM) and a computer with an operating system. The target that is
//! compiled for decides, and no feature changes it. Running out of any of these is a value that the caller handles and
//! counts, never a silent loss.

/// Compiled for a computer with an operating system, not for bare metal.
const HOST: bool = cfg!(not(target_os = "none"));

/// The requested capacity, at most the own one. On bare metal it is always one's own, whatever is asked
/// for: on the microcontroller nobody asks for less, and the compiler knows it.
///
/// ```
/// use floorguard_types::capacities::{SCAN_BEAMS_MAX, limited_capacity};
///
/// assert_eq!(limited_capacity(10_000, SCAN_BEAMS_MAX), SCAN_BEAMS_MAX);
/// ```
pub const fn limited_capacity(asked: usize, own: usize) -> usize {
    if HOST && asked < own { asked } else { own }
}

/// Laser rings of the sweep: a VLP-16 or Puck Hi-Res.
pub const SWEEP_RINGS: usize = 16;
/// Columns of the sweep: 1,808.4 firings per revolution at 600 rpm, rounded up to whole packets (76 × 24).
pub const SWEEP_COLUMNS: usize = 1_824;
/// Rings of the largest lidar: VLP-32C and HDL-32E, or on the MCU VLP-16 and Puck Hi-Res. Packets of a larger one are
/// refused.
pub const PACKET_RINGS_MAX: usize = if HOST { 32 } else { 16 };
/// Firings in one lidar packet: 12 blocks of two sequences.
pub const PACKET_COLUMNS_MAX: usize = 24;
/// Beams of a scan: 270° at 0.5° and both ends (SICK S300).
#[cfg(target_os = "none")]
pub const SCAN_BEAMS_MAX: usize = 541;
/// Beams of a scan: the microScan3 family delivers up to 2,751.
#[cfg(not(target_os = "none"))]
pub const SCAN_BEAMS_MAX: usize = 2_751;
/// Clusters kept of one sweep; the farthest are dropped first and counted.
pub const CLUSTERS_MAX: usize = if HOST { 1_024 } else { CLUSTERS_ON_BOARD };
/// The same on the microcontroller.
pub const CLUSTERS_ON_BOARD: usize = 256;
/// Provisional names of objects while a sweep is grouped: one for each place where something begins. A sweep of a hall
/// needs some hundred, one through a tree some thousand; cells beyond stay ungrouped and are counted.
pub const LABELS_MAX: usize = if HOST { 16_384 } else { LABELS_ON_BOARD };
/// The same on the microcontroller.
pub const LABELS_ON_BOARD: usize = 4_096;
/// People tracked at once; the farthest are dropped first and counted.
pub const TRACKS_MAX: usize = if HOST { 128 } else { TRACKS_ON_BOARD };
/// The same on the microcontroller.
pub const TRACKS_ON_BOARD: usize = 32;
/// Poses kept for de-skewing and stamping: 1.28 s at 100 Hz (book, Odometry: Pose history).
pub const POSE_HISTORY: usize = 128;
/// Vertices of a protective or warning field.
pub const FIELD_VERTICES_MAX: usize = 16;
/// Field sets: four speed bins, forward and reverse.
pub const FIELD_SETS_MAX: usize = 8;
/// Columns of the widest colour image of the floor, and of the widest depth image in which people are looked for: 640 × 480.
pub const FLOOR_IMAGE_COLUMNS_MAX: usize = 640;
/// Blocks of 16 × 16 pixels in the largest colour image.
pub const FLOOR_BLOCKS_MAX: usize = 1_200;
/// Regions of a depth picture in which people are looked for; the farthest are dropped first and counted.
pub const RGBD_REGIONS_MAX: usize = 16;
/// Provisional names of occupied cells while they are grouped: a byte, 0 for none.
pub const RGBD_LABELS_MAX: usize = 255;
/// Heads tried in a region (the outline has no components).
pub const RGBD_HEADS_MAX: usize = 16;
/// Columns of a region at the size of the silhouette: 3.7 m of a body of 1.75 m.
pub const RGBD_CROP_COLUMNS: usize = 192;
/// Its rows: from above the head to below the shoulders of a person who is a head shorter.
pub const RGBD_CROP_ROWS: usize = 64;
/// Heads that fit the silhouette, before one stays for each person.
pub const RGBD_CANDIDATES_MAX: usize = 64;
/// People of one depth picture; the farthest are dropped first and counted.
pub const RGBD_PEOPLE_MAX: usize = 32;
/// Objects of the shape of a leg in one depth picture.
pub const RGBD_LEGS_MAX: usize = 32;
/// Objects in the band of the legs that may be open at once while a picture is read.
pub const RGBD_LEG_PARTS_MAX: usize = 512;
/// Labelled shapes of each class from which a robot learns: the published learner keeps 1,005 of each for an SVM; waves
/// need fewer.
pub const LEARNING_SAMPLES: usize = 1_024;
/// Labelled shapes of each class by which what was learnt is judged.
pub const LEARNING_HELD_OUT: usize = 256;
/// Shapes with a known truth, of both classes together, on which nothing may get worse.
pub const LEARNING_ANCHORS: usize = 2_048;
/// Tracks whose history is kept.
pub const LEARNING_TRACKS: usize = TRACKS_MAX;
/// Shapes kept of one track.
pub const LEARNING_SHAPES: usize = 12;
