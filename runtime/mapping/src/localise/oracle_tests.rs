//! Whether what a drive showed fits one place of the map only: by a judge that knows the map's walls from its
//! furniture, and the way of the drive exactly.

use super::{Building, Ended, SOON_S, STEP_S, World, beam_rad, scan};
use crate::se2::{Se2, wrap};

/// A return agrees with the map within this, metres.
const AGREES_M: f64 = 0.15;
/// Every so manyth beam is asked...
const EACH: usize = 12;
/// ... of a scan every so many.
const SCANS: usize = 5;
/// Places nearer than this are the same, metres and radians.
const SAME: (f64, f64) = (0.8, 0.3);
/// Places that are judged by rays.
const JUDGED: usize = 200;

/// What the scans are at a place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Fit {
    /// Share of the beams that end where the map says.
    agrees: f64,
    /// Share that went through a wall.
    through: f64,
}

/// The true place, and the other one that fits best of those that no wall contradicts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ambiguity {
    own: Fit,
    other: Fit,
}

impl Ambiguity {
    /// Another place explains what was seen nearly as well: what else differs is furniture, of which a third was moved.
    pub(super) fn is_there(&self) -> bool {
        self.other.agrees > self.own.agrees - 0.05
    }
}

struct Seen {
    /// From the last pose of the drive.
    from_last: Se2,
    ranges_m: Vec<f64>,
}

struct Judge<'a> {
    walls: &'a World,
    mapped: &'a World,
    seen: Vec<Seen>,
}

impl Judge<'_> {
    fn fit(&self, place: Se2) -> Fit {
        let (mut all, mut agrees, mut through) = (0, 0, 0);
        for seen in &self.seen {
            let pose = place.compose(seen.from_last);
            for (index, range_m) in
                seen.ranges_m.iter().enumerate().filter(|(_, range_m)| range_m.is_finite())
            {
                let angle = pose.heading_rad + beam_rad(index * EACH);
                let from = [pose.x_m, pose.y_m];
                all += 1;
                agrees += u32::from((self.mapped.range_m(from, angle) - range_m).abs() < AGREES_M);
                through += u32::from(self.walls.range_m(from, angle) < range_m - AGREES_M);
            }
        }
        let share = |count: u32| f64::from(count) / f64::from(all.max(1));
        Fit { agrees: share(agrees), through: share(through) }
    }

    /// Steps to better places near by, ever smaller ones.
    fn climbed(&self, mut place: Se2) -> (Se2, Fit) {
        let value = |fit: Fit| fit.agrees - 2.0 * fit.through;
        let mut best = self.fit(place);
        for (step_m, step_rad) in [(0.1, 0.02), (0.05, 0.01), (0.025, 0.005)] {
            for _ in 0..4 {
                let steps = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)];
                let tried = steps.map(|(x, y, turn)| {
                    let [x, y, turn] = [x, y, turn].map(f64::from);
                    Se2::new(
                        place.x_m + step_m * x,
                        place.y_m + step_m * y,
                        place.heading_rad + step_rad * turn,
                    )
                });
                let fits = tried.map(|place| (place, self.fit(place)));
                let Some((next, fit)) = fits.into_iter().max_by(|a, b| value(a.1).total_cmp(&value(b.1)))
                else {
                    break;
                };
                if value(fit) <= value(best) {
                    break;
                }
                (place, best) = (next, fit);
            }
        }
        (place, best)
    }
}

fn is_same(a: Se2, b: Se2) -> bool {
    a.distance(b) < SAME.0 && wrap(a.heading_rad - b.heading_rad).abs() < SAME.1
}

/// `FLOORGUARD_ORACLE=late` asks of the drives that were found late whether another place was as possible after the first ten seconds; `all`
/// of all of them.
pub(super) fn asked(
    ended: &Ended,
    building: &Building,
    worlds: [&World; 2],
    path: &[Se2],
) -> Option<Ambiguity> {
    let is_late = ended.found_s.is_none_or(|found_s| found_s > SOON_S);
    let is_asked = std::env::var("FLOORGUARD_ORACLE").is_ok_and(|which| which == "all" || is_late);
    let path = &path[..path.len().min((SOON_S / STEP_S) as usize + 1)];
    if is_asked { ambiguity(building, worlds, path) } else { None }
}

/// Of a drive up to a pose: `world` is what was seen, `mapped` what the map shows.
pub(super) fn ambiguity(
    building: &Building,
    [mapped, world]: [&World; 2],
    path: &[Se2],
) -> Option<Ambiguity> {
    let last = *path.last()?;
    let seen = path.iter().rev().step_by(SCANS).map(|pose| {
        let ranges_m = scan(world, pose, EACH);
        Seen { from_last: last.between(*pose), ranges_m }
    });
    let judge = Judge { walls: &building.walls, mapped, seen: seen.collect() };
    let own = judge.climbed(last).1;
    let mut others: Vec<(Se2, Fit)> = Vec::new();
    for place in candidates(&judge, last) {
        let (place, fit) = judge.climbed(place);
        if !is_same(place, last) && fit.through <= own.through + 0.01 {
            others.push((place, fit));
        }
    }
    let best = others.into_iter().max_by(|a, b| a.1.agrees.total_cmp(&b.1.agrees));
    Some(Ambiguity { own, other: best.map_or_else(Fit::default, |(_, fit)| fit) })
}

impl World {
    /// Columns, rows, and which cells have something within so many cells.
    fn thickened(&self, by: usize) -> (usize, usize, Vec<bool>) {
        let mut near = vec![false; self.solid.len()];
        for index in (0..self.solid.len()).filter(|index| self.solid[*index]) {
            let (column, row) = (index % self.columns, index / self.columns);
            for y in row.saturating_sub(by)..(row + by + 1).min(self.rows) {
                near[y * self.columns..][column.saturating_sub(by)..(column + by + 1).min(self.columns)]
                    .fill(true);
            }
        }
        (self.columns, self.rows, near)
    }
}

/// Places at which many returns lie near something of the map.
fn candidates(judge: &Judge<'_>, last: Se2) -> Vec<Se2> {
    const STEP_M: f64 = 0.2;
    let (columns, rows, near) = judge.mapped.thickened(5);
    let mut ends: Vec<[f64; 2]> = Vec::new();
    for seen in &judge.seen {
        for (index, range_m) in seen.ranges_m.iter().enumerate().filter(|(_, range_m)| range_m.is_finite()) {
            let (sin, cos) = beam_rad(index * EACH).sin_cos();
            let pose = seen.from_last.compose(Se2::new(range_m * cos, range_m * sin, 0.0));
            ends.push([pose.x_m, pose.y_m]);
        }
    }
    let ends: Vec<[f64; 2]> = ends.iter().step_by(ends.len().div_ceil(160).max(1)).copied().collect();
    let cell = |value: f64| (value / 0.05).floor();
    let mut scored: Vec<(u32, Se2)> = Vec::new();
    for turn in 0..210 {
        let heading_rad = f64::from(turn) * std::f64::consts::TAU / 210.0;
        let (sin, cos) = heading_rad.sin_cos();
        let turned: Vec<[f64; 2]> =
            ends.iter().map(|[x, y]| [cos * x - sin * y, sin * x + cos * y]).collect();
        let mut y = 0.1;
        while y < rows as f64 * 0.05 {
            let mut x = 0.1;
            while x < columns as f64 * 0.05 {
                let is_near = |end: &&[f64; 2]| {
                    let (column, row) = (cell(x + end[0]), cell(y + end[1]));
                    let inside = column >= 0.0 && row >= 0.0 && column < columns as f64 && row < rows as f64;
                    inside && near[row as usize * columns + column as usize]
                };
                let count = turned.iter().filter(is_near).count() as u32;
                scored.push((count, Se2::new(x, y, heading_rad)));
                x += STEP_M;
            }
            y += STEP_M;
        }
    }
    scored.sort_by_key(|(count, _)| std::cmp::Reverse(*count));
    let mut chosen: Vec<Se2> = Vec::new();
    for (_, place) in scored.into_iter().take(400_000) {
        if chosen.len() >= JUDGED {
            break;
        }
        let is_near = |other: &Se2| {
            other.distance(place) < 0.5 && wrap(other.heading_rad - place.heading_rad).abs() < 0.15
        };
        if !is_same(place, last) && !chosen.iter().any(is_near) {
            chosen.push(place);
        }
    }
    chosen
}
