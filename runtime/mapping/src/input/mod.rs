//! What comes in: scans with the odometry of their time.

mod record;

pub use record::ScanRecord;
