//! Which scans are compared: those that stood near each other and looked the same way.

use std::collections::BTreeMap;

use crate::se2::{Se2, wrap};

/// How partners are chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairConfig {
    /// Farther scans are no partners, metres.
    pub distance_m: f64,
    /// Nor those that looked elsewhere, radians.
    pub turn_rad: f64,
    /// A scan is a neighbour in time up to so many scans away.
    pub recent: usize,
    /// Partners among the neighbours in time.
    pub recent_max: usize,
    /// Partners among all others.
    pub other_max: usize,
}

impl Default for PairConfig {
    fn default() -> Self {
        Self { distance_m: 6.0, turn_rad: 1.8, recent: 12, recent_max: 4, other_max: 8 }
    }
}

/// The pairs, each once, the later scan first.
#[must_use]
pub fn overlapping_pairs(poses: &[Se2], config: &PairConfig) -> Vec<[u32; 2]> {
    let cell = |pose: &Se2| {
        let index = |value: f64| (value / config.distance_m).floor() as i64;
        (index(pose.x_m), index(pose.y_m))
    };
    let mut places: BTreeMap<(i64, i64), Vec<usize>> = BTreeMap::new();
    let mut pairs = Vec::new();
    for (index, pose) in poses.iter().enumerate() {
        let (column, row) = cell(pose);
        let mut near: Vec<(f64, usize)> = Vec::new();
        for x in column - 1..=column + 1 {
            for y in row - 1..=row + 1 {
                for &other in places.get(&(x, y)).map_or(&[][..], Vec::as_slice) {
                    let distance = pose.distance(poses[other]);
                    let turn = wrap(pose.heading_rad - poses[other].heading_rad).abs();
                    if distance <= config.distance_m && turn <= config.turn_rad {
                        near.push((distance + turn, other));
                    }
                }
            }
        }
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let (recent, others): (Vec<_>, Vec<_>) =
            near.iter().partition(|(_, other)| index - other <= config.recent);
        let chosen = [spread(&recent, config.recent_max), spread(&others, config.other_max)].concat();
        pairs.extend(chosen.into_iter().map(|other| [index as u32, other as u32]));
        places.entry((column, row)).or_default().push(index);
    }
    pairs
}

/// At most so many of a list ordered by cost: half of them the cheapest, the other half evenly from the rest, so that far
/// partners hold the angles.
fn spread(near: &[(f64, usize)], most: usize) -> Vec<usize> {
    if near.len() <= most {
        return near.iter().map(|(_, other)| *other).collect();
    }
    let cheapest = most / 2;
    let mut chosen: Vec<usize> = near[..cheapest].iter().map(|(_, other)| *other).collect();
    let rest = &near[cheapest..];
    let wanted = most - cheapest;
    chosen.extend((0..wanted).map(|k| rest[k * rest.len() / wanted].1));
    chosen
}
