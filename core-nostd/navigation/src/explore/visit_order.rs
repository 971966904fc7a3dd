//! A short open way from the robot through a few places: nearest neighbour, then 2-opt (Croes 1958) and Or-opt (Or 1976) until
//! neither helps.

use heapless::Vec;

use super::view_points::VIEW_POINTS_MAX;

/// The robot and the places.
pub const PLACES_MAX: usize = VIEW_POINTS_MAX + 1;
/// Rounds of improvement; each shortens the way, and a dozen is what it takes.
const ROUNDS_MAX: usize = 200;
/// Places that are moved together.
const MOVED_MAX: usize = 3;
/// Shorter by less is the same, metres.
const SHORTER_M: f32 = 1.0e-3;

/// Ways between places, metres; place 0 is the robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Ways {
    metres: [[f32; PLACES_MAX]; PLACES_MAX],
    count: usize,
}

impl Ways {
    /// Between so many places, the robot included; at most [`PLACES_MAX`]. All ways are as long as can be.
    #[must_use]
    pub fn new(count: usize) -> Self {
        Self { metres: [[f32::MAX / 64.0; PLACES_MAX]; PLACES_MAX], count: count.min(PLACES_MAX) }
    }

    /// Places, the robot included.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.count
    }

    /// Sets the way between two places, in both directions.
    pub fn set(&mut self, (from, to): (usize, usize), way_m: f32) {
        for (a, b) in [(from, to), (to, from)] {
            if let Some(way) = self.metres.get_mut(a).and_then(|row| row.get_mut(b)) {
                *way = way_m;
            }
        }
    }

    /// The way between two places, metres.
    #[must_use]
    pub fn between(&self, from: usize, to: usize) -> f32 {
        self.metres.get(from).and_then(|row| row.get(to)).copied().unwrap_or(f32::MAX / 64.0)
    }
}

/// An order of all places.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VisitOrder {
    /// Place 0 first.
    pub places: Vec<usize, PLACES_MAX>,
    /// Along all of them, metres.
    pub length_m: f32,
}

/// A short open way from place 0 through all others; `first`: this one comes next, whatever it costs. Deterministic; at most
/// 200 rounds of 16³ sums.
#[must_use]
pub fn visit_order(ways: &Ways, first: Option<usize>) -> VisitOrder {
    let mut places = nearest_neighbours(ways, first);
    // What comes before this index stays.
    let fixed = if first.is_some_and(|place| place > 0 && place < ways.count()) { 2 } else { 1 };
    for _ in 0..ROUNDS_MAX {
        if !reverse_a_part(ways, &mut places, fixed) && !move_a_part(ways, &mut places, fixed) {
            break;
        }
    }
    let length_m = length_m(ways, &places);
    VisitOrder { places, length_m }
}

fn nearest_neighbours(ways: &Ways, first: Option<usize>) -> Vec<usize, PLACES_MAX> {
    let mut places: Vec<usize, PLACES_MAX> = Vec::new();
    // As many as the capacity: pushes fit.
    let _ = places.push(0);
    if let Some(first) = first.filter(|&place| place > 0 && place < ways.count()) {
        let _ = places.push(first);
    }
    for _ in 0..PLACES_MAX {
        let Some(&here) = places.last() else { break };
        let rest = (0..ways.count().min(PLACES_MAX)).filter(|place| !places.contains(place));
        let nearest = rest.min_by(|&a, &b| ways.between(here, a).total_cmp(&ways.between(here, b)));
        let Some(nearest) = nearest else { break };
        let _ = places.push(nearest);
    }
    places
}

fn length_m(ways: &Ways, places: &[usize]) -> f32 {
    places.windows(2).map(|pair| leg_m(ways, pair.first(), pair.last())).sum()
}

/// Zero where one of the ends is missing: the way is open.
fn leg_m(ways: &Ways, from: Option<&usize>, to: Option<&usize>) -> f32 {
    from.zip(to).map_or(0.0, |(&from, &to)| ways.between(from, to))
}

/// The first part whose reversal shortens the way is reversed.
fn reverse_a_part(ways: &Ways, places: &mut [usize], fixed: usize) -> bool {
    let count = places.len().min(PLACES_MAX);
    for begin in fixed..count {
        for end in begin.saturating_add(1)..count {
            let before = places.get(begin.wrapping_sub(1));
            let (first, last, after) =
                (places.get(begin), places.get(end), places.get(end.saturating_add(1)));
            let now_m = leg_m(ways, before, first) + leg_m(ways, last, after);
            let then_m = leg_m(ways, before, last) + leg_m(ways, first, after);
            if then_m < now_m - SHORTER_M {
                if let Some(part) = places.get_mut(begin..=end) {
                    part.reverse();
                }
                return true;
            }
        }
    }
    false
}

/// The first part of up to three places that lies better elsewhere is moved there.
fn move_a_part(ways: &Ways, places: &mut [usize], fixed: usize) -> bool {
    let count = places.len().min(PLACES_MAX);
    let now_m = length_m(ways, places);
    for length in 1..=MOVED_MAX {
        for begin in fixed..count.saturating_sub(length).saturating_add(1) {
            for to in fixed..count.saturating_sub(length).saturating_add(1) {
                if to == begin {
                    continue;
                }
                turn_part(places, (begin, to, length));
                if length_m(ways, places) < now_m - SHORTER_M {
                    return true;
                }
                turn_part(places, (to, begin, length));
            }
        }
    }
    false
}

/// Takes `length` places out at `begin` and puts them in again so that they begin at `to`.
fn turn_part(places: &mut [usize], (begin, to, length): (usize, usize, usize)) {
    let end = begin.max(to).saturating_add(length);
    let Some(part) = places.get_mut(begin.min(to)..end) else { return };
    let by = length.min(part.len());
    if begin < to { part.rotate_left(by) } else { part.rotate_right(by) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_types::random::Pcg32;
    use std::vec;

    fn ways_of(points: &[(f32, f32)]) -> Ways {
        let mut ways = Ways::new(points.len());
        for (from, a) in points.iter().enumerate() {
            for (to, b) in points.iter().enumerate() {
                ways.set((from, to), libm::hypotf(a.0 - b.0, a.1 - b.1));
            }
        }
        ways
    }

    /// The best way by trying every order.
    fn best_m(ways: &Ways, here: usize, left: &[usize]) -> f32 {
        let after = |&next: &usize| {
            let rest: vec::Vec<usize> = left.iter().copied().filter(|&place| place != next).collect();
            ways.between(here, next) + best_m(ways, next, &rest)
        };
        left.iter().map(after).reduce(f32::min).unwrap_or(0.0)
    }

    #[test]
    fn orders_are_near_the_best_of_all() {
        let mut random = Pcg32::new(7, 1);
        let (mut ours_m, mut all_m) = (0.0, 0.0);
        for _ in 0..60 {
            let points: vec::Vec<(f32, f32)> =
                (0..8).map(|_| (random.uniform() * 20.0, random.uniform() * 20.0)).collect();
            let ways = ways_of(&points);
            let found = visit_order(&ways, None);
            let mut sorted: vec::Vec<usize> = found.places.iter().copied().collect();
            sorted.sort_unstable();
            assert_eq!(sorted, (0..8).collect::<vec::Vec<_>>());
            assert_eq!(found.places[0], 0);
            let best_m = best_m(&ways, 0, &[1, 2, 3, 4, 5, 6, 7]);
            assert!(found.length_m >= best_m - 1e-3 && found.length_m <= 1.25 * best_m, "{found:?} {best_m}");
            ours_m += found.length_m;
            all_m += best_m;
            let forced = visit_order(&ways, Some(3));
            assert_eq!(forced.places[1], 3);
            assert!(forced.length_m >= best_m - 1e-3);
        }
        assert!(ours_m <= 1.02 * all_m, "{ours_m} against {all_m}");
    }

    #[test]
    fn few_places_and_none() {
        assert_eq!(visit_order(&Ways::new(1), None).length_m, 0.0);
        let two = visit_order(&ways_of(&[(0.0, 0.0), (3.0, 4.0)]), Some(9));
        assert_eq!((two.places.len(), two.length_m), (2, 5.0));
    }
}
