//! The floor without a prior: planes through three random points, judged by all.
//!
//! A table or an empty wall is a plane too. The floor is the one that faces up as expected and that *nothing lies
//! below*: a plane with more points under it than in it is furniture. Every loop has a fixed count (book, Floor
//! and dirt: Floor plane).

use super::lattice::Lattice;
use super::plane::{Plane, dot};
use floorguard_types::number::exact_usize;
use floorguard_types::profile::{List, ListOf, Size};
use floorguard_types::random::Pcg32;

/// What is known before looking.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expectation {
    /// The plane as the camera is mounted.
    pub mounted: Plane,
    /// Largest angle between the normals, radians.
    pub tilt_max_rad: f32,
    /// Lowest and highest place of the camera above the floor, metres.
    pub distance_range_m: [f32; 2],
}

impl Expectation {
    /// True for a plane that the mounting allows.
    #[must_use]
    pub fn allows(&self, plane: &Plane) -> bool {
        let [low, high] = self.distance_range_m;
        self.mounted.tilt_from_rad(plane) <= self.tilt_max_rad && (low..=high).contains(&plane.distance_m)
    }
}

/// Planes that are tried. With a third of the samples on the floor 200 planes miss it once in 1,500 searches.
const HYPOTHESES: u16 = 200;
/// Half of the thickness of a floor, metres (book, Floor and dirt: Floor plane).
const INLIER_M: f32 = 0.02;
/// Below this a point speaks against the plane, metres: more than a depth step at 4 m.
const BELOW_M: f32 = -0.06;
/// Part of the image, from the top, in which no floor is searched (book, Floor and dirt: Floor plane).
const UPPER_PART: f32 = 0.5;
/// Fewest samples.
const SAMPLES_MIN: usize = 10;

pub(super) type Samples<S> = ListOf<[f32; 3], S>;

/// The most supported plane that the expectation allows; `None` without points or without such a plane. Out of line: the
/// samples are most of what a task's stack may hold.
#[inline(never)]
pub(super) fn search<S: Size>(
    lattice: &Lattice<'_>,
    expectation: &Expectation,
    random: &mut Pcg32,
) -> Option<Plane> {
    let mut samples = Samples::<S>::EMPTY;
    choose::<S>(&mut samples, lattice.points(UPPER_PART), random);
    best(&samples, expectation, random)
}

/// The same among any points.
pub(super) fn best(samples: &[[f32; 3]], expectation: &Expectation, random: &mut Pcg32) -> Option<Plane> {
    if samples.len() < SAMPLES_MIN {
        return None;
    }
    let mut best: Option<(i32, Plane)> = None;
    for _ in 0..HYPOTHESES {
        let Some(plane) = hypothesis(samples, random).filter(|plane| expectation.allows(plane)) else {
            continue;
        };
        let score = score(samples, &plane);
        if score > 0 && best.is_none_or(|(highest, _)| score > highest) {
            best = Some((score, plane));
        }
    }
    best.map(|(_, plane)| plane)
}

/// An even choice of points: reservoir sampling, so that any number of them fits.
pub(super) fn choose<S: Size>(
    samples: &mut Samples<S>,
    points: impl Iterator<Item = [f32; 3]>,
    random: &mut Pcg32,
) {
    let mut seen = 0_u32;
    for point in points {
        seen = seen.saturating_add(1);
        if samples.push(point).is_err() {
            // Full: the new point takes the place of another with the probability that keeps the choice even.
            if let Some(slot) = samples.get_mut(exact_usize(random.below(seen))) {
                *slot = point;
            }
        }
    }
}

fn hypothesis(samples: &[[f32; 3]], random: &mut Pcg32) -> Option<Plane> {
    let count = u32::try_from(samples.len()).ok()?;
    let mut draw = || samples.get(exact_usize(random.below(count))).copied();
    Plane::through([draw()?, draw()?, draw()?])
}

/// Points in the plane less those below it.
fn score(samples: &[[f32; 3]], plane: &Plane) -> i32 {
    let mut score = 0_i32;
    for point in samples {
        let height = dot(plane.normal, *point) + plane.distance_m;
        let vote = i32::from(height.abs() < INLIER_M) - i32::from(height < BELOW_M);
        score = score.saturating_add(vote);
    }
    score
}
