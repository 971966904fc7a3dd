//! The returns of the last metres.

use floorguard_mapping::GridGeometry;
use floorguard_mapping::match_field::MatchField;
use floorguard_types::geometry::Point2;

use super::config::FrontEndConfig;
use crate::se2::Se2;

/// A field of returns around the place where it began.
pub struct LocalMap {
    /// Its frame in the frame of the tracking.
    pub origin: Se2,
    /// Node with which it began.
    pub first_node: usize,
    /// Metres travelled since.
    pub travelled_m: f64,
    /// Scans written.
    pub scans: usize,
    field: MatchField<Box<[u8]>>,
}

impl LocalMap {
    /// An empty map. `None` if the settings give no raster.
    #[must_use]
    pub fn new(origin: Se2, first_node: usize, config: &FrontEndConfig) -> Option<Self> {
        let half = config.half_side_m;
        let side = (2.0 * half / config.cell_m) as u16;
        let geometry = GridGeometry::new(side, side, config.cell_m, Point2::new(-half, -half))?;
        let storage = || vec![0_u8; geometry.cell_count()].into_boxed_slice();
        let field = MatchField::new(geometry, [storage(), storage()], config.descent.reach_m).ok()?;
        Some(Self { origin, first_node, travelled_m: 0.0, scans: 0, field })
    }

    /// Writes the returns of a scan taken at a pose of the tracking's frame.
    pub fn insert(&mut self, pose: Se2, points: &[Point2]) {
        let pose_in_map = self.origin.between(pose).single();
        for point in points {
            self.field.insert(pose_in_map.transform(*point));
        }
        self.scans += 1;
    }

    /// The field.
    #[must_use]
    pub const fn field(&self) -> &MatchField<Box<[u8]>> {
        &self.field
    }
}
