//! What comes in: scans with the odometry of their time.

mod odometry_track;
mod record;

pub use odometry_track::OdometryTrack;
pub use record::ScanRecord;
