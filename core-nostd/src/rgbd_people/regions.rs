//! Regions of the floor on which something stands: connected occupied cells, and what of them is in the picture.
//!
//! Source: algorithms B.2 steps 3 to 5. The depth test uses the region's own extent ahead (DEV-05).

use heapless::Vec;

use super::floor_frame::{FloorFrame, FloorPoint};
use super::floor_grid::{FloorGrid, GRID_CELLS, GRID_COLUMNS, cell_of, lattice};
use super::parameters::UpperBodyRules;
use crate::capacities::{RGBD_LABELS_MAX, RGBD_REGIONS_MAX};
use crate::sensing::DepthImage;

/// Fewest cells of a region (algorithms B.2 step 3).
const CELLS_MIN: u16 = 10;

/// One region.
#[derive(Clone, Copy, Debug)]
pub(super) struct Region {
    /// Its label in the cells.
    pub label: u8,
    /// Nearest row of cells: the farthest regions are given up first.
    nearest: u16,
    /// Pixels looked at.
    pub pixels: u32,
    /// Corner of its rectangle in the picture.
    pub first_px: [usize; 2],
    /// Opposite corner, included.
    pub last_px: [usize; 2],
    /// Depths, metres: least, greatest and sum.
    pub depths_m: [f32; 3],
    /// Highest point, metres.
    pub top_m: f32,
}

impl Region {
    /// Mean depth, metres.
    pub(super) fn depth_m(&self) -> f32 {
        let [_, _, sum] = self.depths_m;
        sum / self.pixels.max(1) as f32
    }
}

/// Labels of the cells and the regions they form.
#[derive(Clone, Debug)]
pub(super) struct Regions {
    labels: [u8; GRID_CELLS],
    parents: Vec<u8, RGBD_LABELS_MAX>,
    pub found: Vec<Region, RGBD_REGIONS_MAX>,
    /// Labels and regions for which there was no room.
    pub dropped: u32,
}

impl Default for Regions {
    fn default() -> Self {
        Self { labels: [0; GRID_CELLS], parents: Vec::new(), found: Vec::new(), dropped: 0 }
    }
}

impl Regions {
    /// The label of a place; 0 where nothing stands.
    #[inline]
    pub(super) fn label(&self, point: &FloorPoint) -> u8 {
        cell_of(point).and_then(|cell| self.labels.get(cell)).copied().unwrap_or(0)
    }

    /// Finds the regions of a grid and their extent in the picture.
    pub(super) fn locate(
        &mut self,
        grid: &FloorGrid,
        (image, frame): (&DepthImage<'_>, &FloorFrame),
        rules: &UpperBodyRules,
    ) {
        self.dropped = 0;
        self.label_cells(grid, rules.occupied_min);
        self.collect();
        self.measure(image, frame, rules);
    }

    /// Labels 8-connected cells; labels that meet are united, the smaller one stays.
    fn label_cells(&mut self, grid: &FloorGrid, occupied_min: f32) {
        self.labels.fill(0);
        self.parents.clear();
        for cell in 0..GRID_CELLS {
            if grid.weights().get(cell).is_none_or(|weight| *weight < occupied_min) {
                continue;
            }
            let column = cell % GRID_COLUMNS;
            let neighbour = |back: usize, allowed: bool| {
                let index = cell.checked_sub(back).filter(|_| allowed);
                index.and_then(|index| self.labels.get(index)).copied().unwrap_or(0)
            };
            let neighbours = [
                neighbour(1, column > 0),
                neighbour(GRID_COLUMNS + 1, column > 0),
                neighbour(GRID_COLUMNS, true),
                neighbour(GRID_COLUMNS - 1, column + 1 < GRID_COLUMNS),
            ];
            let mut label = 0;
            for other in neighbours.into_iter().filter(|other| *other > 0) {
                let root = self.root(other);
                label = if label == 0 { root } else { self.unite(label, root) };
            }
            if label == 0 {
                label = self.new_label();
            }
            if let Some(slot) = self.labels.get_mut(cell) {
                *slot = label;
            }
        }
    }

    /// A label of its own, from 1; 0 when they are used up.
    fn new_label(&mut self) -> u8 {
        let label = u8::try_from(self.parents.len().saturating_add(1)).unwrap_or(0);
        if label > 0 && self.parents.push(label).is_ok() {
            return label;
        }
        self.dropped = self.dropped.saturating_add(1);
        0
    }

    fn parent(&self, label: u8) -> u8 {
        let index = usize::from(label).saturating_sub(1);
        self.parents.get(index).copied().unwrap_or(label)
    }

    /// Parents are smaller than their children, so the walk ends.
    fn root(&self, label: u8) -> u8 {
        let mut label = label;
        for _ in 0..RGBD_LABELS_MAX {
            let parent = self.parent(label);
            if parent == label {
                break;
            }
            label = parent;
        }
        label
    }

    fn unite(&mut self, a: u8, b: u8) -> u8 {
        let (kept, given) = (a.min(b), a.max(b));
        if let Some(slot) = self.parents.get_mut(usize::from(given).saturating_sub(1)) {
            *slot = kept;
        }
        kept
    }

    /// Gives every cell its final label and keeps the nearest regions that are large enough.
    fn collect(&mut self) {
        let mut counts = [(0_u16, u16::MAX); RGBD_LABELS_MAX];
        for cell in 0..GRID_CELLS {
            let label = self.labels.get(cell).copied().unwrap_or(0);
            if label == 0 {
                continue;
            }
            let root = self.root(label);
            if let Some(slot) = self.labels.get_mut(cell) {
                *slot = root;
            }
            if let Some((cells, nearest)) = counts.get_mut(usize::from(root).saturating_sub(1)) {
                *cells = cells.saturating_add(1);
                *nearest = (*nearest).min(u16::try_from(cell / GRID_COLUMNS).unwrap_or(u16::MAX));
            }
        }
        self.found.clear();
        for (index, (cells, nearest)) in counts.into_iter().enumerate() {
            let label = u8::try_from(index.saturating_add(1)).unwrap_or(0);
            if cells >= CELLS_MIN && label > 0 {
                self.keep(Region { label, nearest, ..Region::EMPTY });
            }
        }
    }

    fn keep(&mut self, region: Region) {
        if self.found.is_full() {
            self.dropped = self.dropped.saturating_add(1);
            if self.found.last().is_some_and(|last| last.nearest <= region.nearest) {
                return;
            }
            self.found.pop();
        }
        let place = self.found.iter().position(|other| other.nearest > region.nearest);
        let place = place.unwrap_or(self.found.len());
        if self.found.insert(place, region).is_err() {
            self.dropped = self.dropped.saturating_add(1);
        }
    }

    /// Where each region is in the picture, how far, how high.
    fn measure(&mut self, image: &DepthImage<'_>, frame: &FloorFrame, rules: &UpperBodyRules) {
        let [lowest, highest] = rules.heights_m;
        let mut slots = [u8::MAX; 256];
        for (slot, region) in (0_u8..).zip(&self.found) {
            if let Some(place) = slots.get_mut(usize::from(region.label)) {
                *place = slot;
            }
        }
        for (column, row, depth_m, point) in lattice(image, frame, rules.depth_m) {
            if !(point.height_m > lowest && point.height_m < highest) {
                continue;
            }
            let label = self.label(&point);
            let slot = slots.get(usize::from(label)).copied().filter(|_| label > 0).unwrap_or(u8::MAX);
            if let Some(region) = self.found.get_mut(usize::from(slot)) {
                region.absorb([column, row], depth_m, point.height_m);
            }
        }
    }
}

impl Region {
    const EMPTY: Self = Self {
        label: 0,
        nearest: 0,
        pixels: 0,
        first_px: [usize::MAX; 2],
        last_px: [0; 2],
        depths_m: [f32::INFINITY, 0.0, 0.0],
        top_m: 0.0,
    };

    fn absorb(&mut self, pixel: [usize; 2], depth_m: f32, height_m: f32) {
        self.pixels = self.pixels.saturating_add(1);
        for ((first, last), value) in self.first_px.iter_mut().zip(&mut self.last_px).zip(pixel) {
            *first = (*first).min(value);
            *last = (*last).max(value);
        }
        let [nearest, farthest, sum] = &mut self.depths_m;
        *nearest = nearest.min(depth_m);
        *farthest = farthest.max(depth_m);
        *sum += depth_m;
        self.top_m = self.top_m.max(height_m);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::floor::Plane;
    use crate::sensing::PinholeCamera;
    use crate::time::Stamp;
    use std::boxed::Box;
    use std::vec;

    /// Two boards of 0.4 × 1.2 m at 3 m, from a camera at 1 m height that looks level.
    #[test]
    fn two_boards_are_two_regions_with_their_tops() {
        let camera = PinholeCamera::new([131.0, 131.0], [79.5, 59.5]).unwrap();
        let mut pixels = vec![0_u16; 160 * 120];
        for (index, pixel) in pixels.iter_mut().enumerate() {
            let ray = camera.ray((index % 160) as f32, (index / 160) as f32);
            let (x, height) = (3.0 * ray[0], 1.0 - 3.0 * ray[1]);
            if (0.3..1.5).contains(&height) && (0.5..0.9).contains(&x.abs()) {
                *pixel = 3_000;
            }
        }
        let image = DepthImage::new(Stamp::ZERO, (160, 120), &pixels).unwrap();
        let frame = FloorFrame::new(camera, Plane::of_mounting(1.0, 0.0).unwrap());
        let (mut grid, mut regions) = (Box::<FloorGrid>::default(), Box::<Regions>::default());
        let rules = UpperBodyRules::DEFAULT;
        assert_eq!(grid.project(&image, &frame, &rules) as usize, image.returns());
        regions.locate(&grid, (&image, &frame), &rules);
        assert_eq!(regions.found.len(), 2);
        for region in &regions.found {
            assert!((region.top_m - 1.5).abs() < 0.03 && (region.depth_m() - 3.0).abs() < 1e-3);
        }
        assert_ne!(regions.found[0].label, regions.found[1].label);
    }
}
