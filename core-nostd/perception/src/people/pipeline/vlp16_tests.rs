//! What a VLP-16 that looks straight ahead makes of a scene, for tests.

use std::boxed::Box;

use super::context::SweepContext;
use super::state::PeoplePipeline;
use crate::clusters::RingAngles;
use floorguard_types::geometry::{Point3, Pose2, Transform3, Twist2};
use floorguard_types::sensing::Sweep;

/// Height of the lidar, metres.
pub(super) const SENSOR_M: f32 = 0.8;

/// A standing robot's context.
pub(super) fn standing() -> SweepContext {
    let translation = Point3::new(0.0, 0.0, SENSOR_M);
    SweepContext {
        sensor_in_base: Transform3 { translation, ..Transform3::IDENTITY },
        twist: Twist2::ZERO,
        base_in_odom: Pose2::default(),
    }
}

/// A pipeline after one sweep, and the sweep. `range_m` is how far the beam of a bearing and an elevation goes, radians and
/// metres; 0 where nothing returns.
pub(super) fn seen(range_m: impl Fn(f32, f32) -> f32) -> (Box<PeoplePipeline>, Box<Sweep>) {
    let sweep = swept(-15.0, range_m);
    let mut pipeline = Box::new(PeoplePipeline::new(RingAngles::vlp16()));
    pipeline.process(&sweep, &standing());
    (pipeline, sweep)
}

/// The same sweep by sixteen rings 2° apart from a lowest one on, degrees.
pub(super) fn swept(lowest_deg: f32, range_m: impl Fn(f32, f32) -> f32) -> Box<Sweep> {
    let mut sweep = Box::new(Sweep::EMPTY);
    sweep.column_count = 1_800;
    for (index, column) in sweep.columns.iter_mut().enumerate().take(1_800) {
        (column.azimuth_cdeg, column.measured) = (20 * index as u16, true);
        let bearing = -(0.2 * index as f32).to_radians();
        for (ring, raw) in column.range_raw.iter_mut().enumerate() {
            let elevation = (2.0 * ring as f32 + lowest_deg).to_radians();
            let is_ahead = libm::cosf(bearing) > 0.9;
            *raw = if is_ahead { (range_m(bearing, elevation) * 500.0) as u16 } else { 0 };
        }
    }
    sweep
}
