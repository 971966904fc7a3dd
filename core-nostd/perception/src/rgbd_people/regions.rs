//! Regions of the floor on which something stands: connected occupied cells, and what of them is in the picture.
//!
//! Source: book, Depth people: Regions. The depth test uses the region's own extent ahead.

use heapless::Vec;

use super::floor_frame::{FloorFrame, FloorPoint};
use super::floor_grid::{FloorGrid, GRID_CELLS, GRID_COLUMNS, cell_of, lattice};
use super::parameters::UpperBodyRules;
use floorguard_types::capacities::{RGBD_LABELS_MAX, RGBD_REGIONS_MAX};
use floorguard_types::number::nearest_f32;
use floorguard_types::profile::Of;
use floorguard_types::sensing::DepthImage;
use floorguard_types::united_parts::{Absorb, UnitedParts};

/// Fewest cells of a region (book, Depth people: Regions).
const CELLS_MIN: u16 = 10;

/// One region.
#[derive(Clone, Copy, Debug)]
pub(super) struct Region {
    /// Its label in the cells.
    pub label: u8,
    /// Nearest row of cells: the farthest regions are given up first.
    nearest: u16,
    /// Pixels examined.
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
        sum / nearest_f32(self.pixels.max(1))
    }
}

/// Cells that touch.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Patch {
    cells: u16,
    nearest: u16,
}

impl Absorb for Patch {
    fn absorb(&mut self, other: &Self) {
        self.cells = self.cells.saturating_add(other.cells);
        self.nearest = self.nearest.min(other.nearest);
    }
}

/// Labels of the cells and the regions they form.
#[derive(Clone, Debug)]
pub(super) struct Regions {
    /// Of each cell the number of its patch and 1; 0 where nothing stands.
    labels: [u8; GRID_CELLS],
    patches: UnitedParts<Patch, Of<RGBD_LABELS_MAX>>,
    pub found: Vec<Region, RGBD_REGIONS_MAX>,
    /// Labels and regions beyond the capacity.
    pub dropped: u32,
}

impl Default for Regions {
    fn default() -> Self {
        Self { labels: [0; GRID_CELLS], patches: UnitedParts::default(), found: Vec::new(), dropped: 0 }
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

    /// Labels 8-connected cells.
    fn label_cells(&mut self, grid: &FloorGrid, occupied_min: f32) {
        self.labels.fill(0);
        self.patches.clear();
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
            let touching = neighbours.into_iter().filter_map(number_of);
            let nearest = u16::try_from(cell / GRID_COLUMNS).unwrap_or(u16::MAX);
            let patch = self.patches.join(touching, &Patch { cells: 1, nearest });
            self.dropped = self.dropped.saturating_add(u32::from(patch.is_err()));
            let label = patch.map_or(0, label_of);
            if let Some(slot) = self.labels.get_mut(cell) {
                *slot = label;
            }
        }
    }

    /// Gives every cell its final label and keeps the nearest regions that are large enough.
    fn collect(&mut self) {
        for label in &mut self.labels {
            *label = number_of(*label).map_or(0, |number| label_of(self.patches.root(number)));
        }
        self.found.clear();
        for (number, patch) in self.patches.numbered() {
            if patch.cells >= CELLS_MIN {
                let region = Region { label: label_of(number), nearest: patch.nearest, ..Region::EMPTY };
                self.dropped = self.dropped.saturating_add(u32::from(!keep(&mut self.found, region)));
            }
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

/// Keeps a region among the nearest; false where that cost one, this or the farthest.
fn keep(found: &mut Vec<Region, RGBD_REGIONS_MAX>, region: Region) -> bool {
    let had_capacity = !found.is_full();
    if !had_capacity {
        if found.last().is_some_and(|last| last.nearest <= region.nearest) {
            return false;
        }
        let _ = found.pop();
    }
    let place = found.iter().position(|other| other.nearest > region.nearest).unwrap_or(found.len());
    found.insert(place, region).is_ok() && had_capacity
}

/// Numbers of patches fit into a label.
const _: () = assert!(RGBD_LABELS_MAX < 256);

/// The label of a patch, from 1.
fn label_of(patch: u16) -> u8 {
    u8::try_from(patch.saturating_add(1)).unwrap_or(0)
}

/// The patch of a label; `None` where nothing stands.
fn number_of(label: u8) -> Option<u16> {
    label.checked_sub(1).map(u16::from)
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
    use floorguard_types::sensing::ImageSize;
    use floorguard_types::sensing::PinholeCamera;
    use floorguard_types::time::Stamp;
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
        let image = DepthImage::new(Stamp::ZERO, ImageSize { width: 160, height: 120 }, &pixels).unwrap();
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
