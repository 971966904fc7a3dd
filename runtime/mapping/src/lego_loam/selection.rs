//! Which returns become edges and flats.

use super::config::LegoLoamConfig;
use super::features::{Features, SIDE, Segmented, SegmentedCloud, smoothness};
use super::thinning::thinned;

/// Sectors of a row.
const SECTORS: usize = 6;
/// Sharp edges, all edges and flats of a sector.
const SHARP: usize = 2;
const LESS_SHARP: usize = 20;
const FLAT: usize = 4;
/// Columns beyond which returns are no neighbours.
const GAP: usize = 10;
/// A step of the range hides what is behind it, metres.
const STEP_M: f32 = 0.3;
/// Steps to both sides of this share of the range: a surface along the view.
const GRAZING: f32 = 0.02;
/// Edge of the cubes that thin the less flat returns of a row, metres.
const LESS_FLAT_M: f32 = 0.2;

/// The state of the selection: one entry for each return.
struct Selection<'a> {
    returns: &'a [Segmented],
    smoothness: Vec<f32>,
    is_taken: Vec<bool>,
    is_edge: Vec<bool>,
}

/// Edges and flats of all rows.
pub(super) fn select(cloud: &SegmentedCloud, config: &LegoLoamConfig) -> Features {
    let mut selection = Selection::new(&cloud.returns);
    let mut features = Features::default();
    for &[first, last] in &cloud.spans {
        let mut less_flat = Vec::new();
        for sector in 0..SECTORS {
            let part = |sector: usize| (first * (SECTORS - sector) + last * sector) / SECTORS;
            let (start, end) = (part(sector), part(sector + 1).saturating_sub(1));
            if start >= end || last <= first {
                continue;
            }
            let mut order: Vec<usize> = (start..=end).collect();
            // As in the program, the last one keeps its place.
            let (sorted, _) = order.split_at_mut(end - start);
            sorted.sort_by(|a, b| selection.smoothness[*a].total_cmp(&selection.smoothness[*b]));
            selection.edges(&order, config, &mut features);
            selection.flats(&order, config, &mut features);
            let rest = (start..=end).filter(|index| !selection.is_edge[*index]);
            less_flat.extend(rest.map(|index| cloud.returns[index].feature));
        }
        features.less_flat.extend(thinned(&less_flat, LESS_FLAT_M));
    }
    features
}

impl<'a> Selection<'a> {
    fn new(returns: &'a [Segmented]) -> Self {
        let count = returns.len();
        let mut bends = vec![0.0; count];
        for middle in SIDE..count.saturating_sub(SIDE) {
            let mut ranges = [0.0; 2 * SIDE + 1];
            for (range, each) in ranges.iter_mut().zip(&returns[middle - SIDE..]) {
                *range = each.range_m;
            }
            bends[middle] = smoothness(&ranges);
        }
        let mut selection =
            Self { returns, smoothness: bends, is_taken: vec![false; count], is_edge: vec![false; count] };
        selection.mark_hidden();
        selection
    }

    /// Returns beside a step, on the side that is hidden, and on surfaces along the view say little.
    fn mark_hidden(&mut self) {
        for index in SIDE..self.returns.len().saturating_sub(SIDE + 1) {
            let range = |at: usize| self.returns[at].range_m;
            let (here, next) = (range(index), range(index + 1));
            let before = (range(index - 1) - here).abs();
            if self.returns[index + 1].column.abs_diff(self.returns[index].column) < GAP {
                if here - next > STEP_M {
                    self.is_taken[index - SIDE..=index].fill(true);
                } else if next - here > STEP_M {
                    self.is_taken[index + 1..=index + SIDE + 1].fill(true);
                }
            }
            if before > GRAZING * here && (next - here).abs() > GRAZING * here {
                self.is_taken[index] = true;
            }
        }
    }

    fn edges(&mut self, order: &[usize], config: &LegoLoamConfig, features: &mut Features) {
        let mut picked = 0;
        for &index in order.iter().rev() {
            let is_edge = self.smoothness[index] > config.smoothness && !self.returns[index].is_ground;
            if self.is_taken[index] || !is_edge {
                continue;
            }
            picked += 1;
            if picked > LESS_SHARP {
                break;
            }
            if picked <= SHARP {
                features.sharp.push(self.returns[index].feature);
            }
            features.less_sharp.push(self.returns[index].feature);
            self.is_edge[index] = true;
            self.take(index);
        }
    }

    fn flats(&mut self, order: &[usize], config: &LegoLoamConfig, features: &mut Features) {
        let mut picked = 0;
        for &index in order {
            let is_flat = self.smoothness[index] < config.smoothness && self.returns[index].is_ground;
            if self.is_taken[index] || !is_flat {
                continue;
            }
            features.flat.push(self.returns[index].feature);
            picked += 1;
            if picked >= FLAT {
                break;
            }
            self.take(index);
        }
    }

    /// A return and its neighbours are not taken again.
    fn take(&mut self, index: usize) {
        self.is_taken[index] = true;
        let column = |at: usize| self.returns[at].column;
        for step in 1..=SIDE {
            let next = index + step;
            if next >= self.returns.len() || column(next).abs_diff(column(next - 1)) > GAP {
                break;
            }
            self.is_taken[next] = true;
        }
        for step in 1..=SIDE {
            let Some(next) = index.checked_sub(step) else { break };
            if column(next).abs_diff(column(next + 1)) > GAP {
                break;
            }
            self.is_taken[next] = true;
        }
    }
}

#[cfg(test)]
#[path = "selection_tests.rs"]
mod tests;
