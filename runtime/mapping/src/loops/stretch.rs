//! A few metres of the path with what was seen there.

use std::collections::BTreeSet;
use std::ops::Range;

use floorguard_mapping::GridGeometry;
use floorguard_mapping::match_field::{FieldLevel, FieldPart, MatchField, coarsen};
use floorguard_types::geometry::Point2;

use super::config::LoopConfig;
use crate::front_end::Node;
use crate::pages::Pages;
use crate::refine::ScanView;
use crate::se2::Se2;

/// Consecutive scans, rigid among each other.
#[derive(Clone, Debug)]
pub struct Stretch {
    /// First scan.
    pub first: usize,
    /// One after the last.
    pub end: usize,
    /// The scan whose frame is the stretch's.
    pub centre: usize,
    /// Returns in the stretch's frame, thinned.
    pub points: Vec<Point2>,
    /// Some of them, evenly: what is searched in other stretches.
    pub searched: Vec<Point2>,
}

/// Levels of the searched field: the coarsest bounds 64 × 64 cells.
const LEVELS: u8 = 6;

/// The searched field of a stretch.
pub struct StretchField {
    geometry: GridGeometry,
    levels: Vec<Pages>,
}

impl Stretch {
    /// From these scans.
    #[must_use]
    pub fn new((nodes, views): (&[Node], &[ScanView]), scans: Range<usize>, config: &LoopConfig) -> Self {
        let Range { start: first, end } = scans;
        let thin_m = config.thin_m;
        let centre = first + (end - first) / 2;
        let origin = nodes[centre].pose;
        let mut taken = BTreeSet::new();
        let mut points = Vec::new();
        for (node, view) in nodes[first..end].iter().zip(&views[first..end]) {
            let pose = origin.between(node.pose).single();
            for point in &view.returns() {
                let point = pose.transform(*point);
                let cell = ((point.x_m / thin_m).floor() as i32, (point.y_m / thin_m).floor() as i32);
                if taken.insert(cell) {
                    points.push(point);
                }
            }
        }
        let step = points.len().div_ceil(config.searched_points.max(1)).max(1);
        let searched = points.iter().step_by(step).copied().collect();
        points.shrink_to_fit();
        Self { first, end, centre, points, searched }
    }

    /// The field that other stretches are searched in; `None` if it would have no extent. `margin_m` is added around.
    #[must_use]
    pub fn field(&self, config: &LoopConfig) -> Option<StretchField> {
        let margin = config.reach_m + config.cell_m;
        let bound = |pick: fn(&Point2) -> f32, start: f32, choose: fn(f32, f32) -> f32| {
            self.points.iter().map(pick).fold(start, choose)
        };
        let (low_x, high_x) = (bound(|p| p.x_m, 0.0, f32::min), bound(|p| p.x_m, 0.0, f32::max));
        let (low_y, high_y) = (bound(|p| p.y_m, 0.0, f32::min), bound(|p| p.y_m, 0.0, f32::max));
        let cells = |low: f32, high: f32| ((high - low + 2.0 * margin) / config.cell_m).ceil() as u16 + 1;
        let corner = Point2::new(low_x - margin, low_y - margin);
        let geometry = GridGeometry::new(cells(low_x, high_x), cells(low_y, high_y), config.cell_m, corner)?;
        let count = geometry.cell_count();
        let mut field =
            MatchField::new(geometry, [Pages::new(count), Pages::new(count)], config.reach_m).ok()?;
        for point in &self.points {
            field.insert(*point);
        }
        let mut levels = vec![field.into_fine()];
        for shift in 0..LEVELS {
            let mut coarser = Pages::new(count);
            let part = FieldPart::whole(&geometry);
            coarsen(
                FieldLevel { geometry, part, values: levels[usize::from(shift)].as_ref(), shift },
                coarser.as_mut(),
            );
            levels.push(coarser);
        }
        Some(StretchField { geometry, levels })
    }

    /// Its place in the map.
    #[must_use]
    pub fn place(&self, poses: &[Se2]) -> Se2 {
        poses.get(self.centre).copied().unwrap_or_default()
    }
}

impl StretchField {
    /// The levels, fine first.
    #[must_use]
    pub fn levels(&self) -> Vec<FieldLevel<'_>> {
        let (geometry, part) = (self.geometry, FieldPart::whole(&self.geometry));
        self.levels
            .iter()
            .enumerate()
            .map(|(shift, values)| FieldLevel { geometry, part, values: values.as_ref(), shift: shift as u8 })
            .collect()
    }
}
