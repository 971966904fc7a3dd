//! Fixed sizes that are the same in every program, each with its reason. What differs between programs is in their
//! [`profile`](crate::profile).
//!
//! Running out of any of these is a value that the caller handles and counts, never a silent loss.

use crate::profile::{Host, Native, Profile, Size};

/// Laser rings of the sweep: a VLP-16 or Puck Hi-Res.
pub const SWEEP_RINGS: usize = 16;
/// Columns of the sweep: 1,808.4 firings per revolution at 600 rpm, rounded up to whole packets (76 × 24).
pub const SWEEP_COLUMNS: usize = 1_824;
/// Rings of the largest lidar whose packets fit a `LidarPacket`.
pub const PACKET_RINGS_MAX: usize = <Native as Profile>::Rings::N;
/// Safety scanners beside the first one: none on a board.
pub const REAR_SCANNERS_MAX: usize = <Native as Profile>::RearScanners::N;
/// Firings in one lidar packet: 12 blocks of two sequences.
pub const PACKET_COLUMNS_MAX: usize = 24;
/// Beams that fit a `Scan`.
pub const SCAN_BEAMS_MAX: usize = <Native as Profile>::Beams::N;
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
pub const LEARNING_TRACKS: usize = <Host as Profile>::Tracks::N;
/// Shapes kept of one track.
pub const LEARNING_SHAPES: usize = 12;
