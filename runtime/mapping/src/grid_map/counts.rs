//! Hits and passes of cells, in tiles that are made where beams go: a building may be large and winding.

use std::collections::BTreeMap;

/// What beams did in a cell. Saturating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CellCounts {
    /// Beams that ended in it.
    pub hits: u16,
    /// Beams that went through it.
    pub passes: u16,
}

/// Cells along a tile.
const TILE: i32 = 64;
const TILE_CELLS: usize = (TILE * TILE) as usize;

/// A raster without borders; cell (0, 0) begins at the origin of the map.
#[derive(Clone, Debug, Default)]
pub struct CountGrid {
    tiles: BTreeMap<(i32, i32), Box<[CellCounts]>>,
}

/// The tile that was written last: beams stay in a tile for dozens of cells.
struct Cursor<'a> {
    place: (i32, i32),
    tile: &'a mut [CellCounts],
}

impl CountGrid {
    /// Enters a beam from cell to cell: passes on the way, a hit at its end. The cell before the end is left alone: a
    /// wall seen at a flat angle must not be cleared by its own returns. Cost: a step a cell (Bresenham 1965).
    pub fn beam(&mut self, from: [i32; 2], to: [i32; 2]) {
        let (dx, dy) = ((to[0] - from[0]).abs(), (to[1] - from[1]).abs());
        let step = [(to[0] - from[0]).signum(), (to[1] - from[1]).signum()];
        let steps = dx.max(dy);
        let (mut x, mut y, mut error) = (from[0], from[1], dx - dy);
        let mut cursor: Option<Cursor<'_>> = None;
        for at in 0..=steps {
            if at == steps || at + 1 < steps {
                let place = (x.div_euclid(TILE), y.div_euclid(TILE));
                if cursor.as_ref().is_none_or(|cursor| cursor.place != place) {
                    let new = || vec![CellCounts::default(); TILE_CELLS].into_boxed_slice();
                    cursor = Some(Cursor { place, tile: self.tiles.entry(place).or_insert_with(new) });
                }
                let index = (y.rem_euclid(TILE) * TILE + x.rem_euclid(TILE)) as usize;
                if let Some(cell) = cursor.as_mut().and_then(|cursor| cursor.tile.get_mut(index)) {
                    let count = if at == steps { &mut cell.hits } else { &mut cell.passes };
                    *count = count.saturating_add(1);
                }
            }
            let twice = 2 * error;
            if twice > -dy {
                error -= dy;
                x += step[0];
            }
            if twice < dx {
                error += dx;
                y += step[1];
            }
        }
    }

    /// Enters the way of a beam whose end is judged apart: passes from cell to cell, the last one with them.
    pub fn pass(&mut self, from: [i32; 2], to: [i32; 2]) {
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let steps = dx.abs().max(dy.abs());
        for at in 0..=steps {
            let part = |first: i32, way: i32| {
                first + (f64::from(way) * f64::from(at) / f64::from(steps.max(1))).round() as i32
            };
            let (x, y) = (part(from[0], dx), part(from[1], dy));
            let new = || vec![CellCounts::default(); TILE_CELLS].into_boxed_slice();
            let tile = self.tiles.entry((x.div_euclid(TILE), y.div_euclid(TILE))).or_insert_with(new);
            let index = (y.rem_euclid(TILE) * TILE + x.rem_euclid(TILE)) as usize;
            if let Some(cell) = tile.get_mut(index) {
                cell.passes = cell.passes.saturating_add(1);
            }
        }
    }

    /// The counts of a cell.
    #[must_use]
    pub fn at(&self, [x, y]: [i32; 2]) -> CellCounts {
        let tile = self.tiles.get(&(x.div_euclid(TILE), y.div_euclid(TILE)));
        let index = (y.rem_euclid(TILE) * TILE + x.rem_euclid(TILE)) as usize;
        tile.and_then(|tile| tile.get(index)).copied().unwrap_or_default()
    }

    /// Smallest and largest cell of the smallest rectangle that holds every cell with at least so many beams; `None` without
    /// any.
    #[must_use]
    pub fn bounds(&self, beams_least: u16) -> Option<[[i32; 2]; 2]> {
        let is_known = |cell: &CellCounts| cell.hits.saturating_add(cell.passes) >= beams_least.max(1);
        let mut bounds: Option<[[i32; 2]; 2]> = None;
        for (&(column, row), tile) in &self.tiles {
            for (index, _) in tile.iter().enumerate().filter(|(_, cell)| is_known(cell)) {
                let index = index as i32;
                let (x, y) = (column * TILE + index % TILE, row * TILE + index / TILE);
                let [low, high] = bounds.get_or_insert([[x, y], [x, y]]);
                *low = [low[0].min(x), low[1].min(y)];
                *high = [high[0].max(x), high[1].max(y)];
            }
        }
        bounds
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beams_pass_and_hit_across_tiles() {
        let mut grid = CountGrid::default();
        for _ in 0..3 {
            grid.beam([-70, 0], [70, 20]);
        }
        grid.beam([5, 5], [5, 5]);
        assert_eq!(grid.at([70, 20]), CellCounts { hits: 3, passes: 0 });
        assert_eq!(grid.at([69, 20]), CellCounts::default(), "the cell before the end is left alone");
        assert_eq!(grid.at([-70, 0]).passes, 3);
        assert_eq!(grid.at([0, 10]).passes, 3, "the middle of the beam");
        assert_eq!(grid.at([5, 5]).hits, 1);
        let passed: u32 =
            (-70..=70).map(|x| (-1..=21).map(|y| u32::from(grid.at([x, y]).passes)).sum::<u32>()).sum();
        assert_eq!(passed, 3 * 139, "one cell a column");
        assert_eq!(grid.bounds(1), Some([[-70, 0], [70, 20]]));
    }
}
