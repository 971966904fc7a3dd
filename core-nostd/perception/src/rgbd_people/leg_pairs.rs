//! Two legs are one person: of the pairs that are near and alike the closest comes first, and takes both away.
//!
//! Source: book, Depth people: Leg pairs, repeated until no pair is left. Ours: above a pair there must be a body, as
//! far as the camera sees that high.

use heapless::Vec;

use super::detection::{RgbdDetection, RgbdKind, turned_covariance};
use super::floor_frame::FloorPoint;
use super::floor_grid::FloorGrid;
use super::leg_parts::LegCandidate;
use super::silhouette::AREAS;
use super::upper_bodies::Scene;
use floorguard_types::capacities::{RGBD_LEGS_MAX, RGBD_PEOPLE_MAX};

/// Candidates of one picture.
pub(super) type Legs = Vec<LegCandidate, RGBD_LEGS_MAX>;

/// A body is looked for within this of a pair, metres.
const BODY_NEAR_M: f32 = 0.3;
/// What is lost at the picture's upper border, metres.
const BORDER_M: f32 = 0.1;
/// From the surface that the camera sees to the middle of a leg, metres.
const HALF_LEG_M: f32 = 0.06;
/// Where the body is over its two legs, standard deviation, metres: legs swing.
const POSE_M: f32 = 0.08;
/// Belief in a pair with a body above it, and in one above which nobody can look.
const BELIEF: [f32; 2] = [0.8, 0.5];

/// People by their legs.
pub(super) fn pairs(scene: &Scene<'_>, legs: &Legs, grid: &FloorGrid) -> Vec<RgbdDetection, RGBD_PEOPLE_MAX> {
    let mut people = Vec::new();
    let mut used = [false; RGBD_LEGS_MAX];
    for _ in 0..RGBD_LEGS_MAX / 2 {
        let Some((first, second)) = closest(scene, legs, &used, grid) else { break };
        for index in [first, second] {
            if let Some(slot) = used.get_mut(index) {
                *slot = true;
            }
        }
        if let (Some(a), Some(b)) = (legs.get(first), legs.get(second)) {
            let belief = if is_upright_above(scene, &middle(a, b)) { BELIEF[0] } else { BELIEF[1] };
            // There are at most half as many pairs as legs: a push cannot fail.
            let _ = people.push(detection(scene, a, b, belief));
        }
    }
    people
}

/// The closest pair that is not joined yet.
fn closest(
    scene: &Scene<'_>,
    legs: &Legs,
    used: &[bool; RGBD_LEGS_MAX],
    grid: &FloorGrid,
) -> Option<(usize, usize)> {
    let rules = scene.parameters.legs;
    let [nearest, farthest] = rules.pair_m;
    let free = || legs.iter().enumerate().zip(used).filter(|(_, used)| !**used).map(|(leg, _)| leg);
    let mut best: Option<(f32, (usize, usize))> = None;
    for (first, a) in free() {
        for (second, b) in free().filter(|(second, _)| *second > first) {
            let distance_m = a.distance_m(b);
            let fits = distance_m > nearest && distance_m < farthest;
            if fits
                && best.is_none_or(|(least, _)| distance_m < least)
                && a.likeness(b) > rules.likeness_min
                && has_body(scene, &middle(a, b), grid)
            {
                best = Some((distance_m, (first, second)));
            }
        }
    }
    best.map(|(_, pair)| pair)
}

fn middle(a: &LegCandidate, b: &LegCandidate) -> FloorPoint {
    let ([ar, aa], [br, ba]) = (a.place_m, b.place_m);
    FloorPoint { right_m: 0.5 * (ar + br), ahead_m: 0.5 * (aa + ba), height_m: 0.0 }
}

/// Height up to which the camera sees at a place, metres.
fn view_top_m(scene: &Scene<'_>, place: &FloorPoint) -> f32 {
    let [centre, _] = scene.frame.camera().centre_px();
    let (near, far) = (scene.frame.point(centre, 0.0, 1.0), scene.frame.point(centre, 0.0, 2.0));
    let slope = (far.height_m - near.height_m) / (far.ahead_m - near.ahead_m).max(1.0e-3);
    near.height_m + slope * (place.ahead_m - near.ahead_m) - BORDER_M
}

fn is_upright_above(scene: &Scene<'_>, place: &FloorPoint) -> bool {
    view_top_m(scene, place) >= scene.parameters.legs.body_min_m
}

fn has_body(scene: &Scene<'_>, place: &FloorPoint, grid: &FloorGrid) -> bool {
    let wanted = scene.parameters.legs.body_min_m.min(view_top_m(scene, place));
    grid.top_near_m(place, BODY_NEAR_M) >= wanted
}

fn detection(scene: &Scene<'_>, a: &LegCandidate, b: &LegCandidate, belief: f32) -> RgbdDetection {
    let mut place = middle(a, b);
    let range_m = place.range_m().max(0.1);
    let farther = 1.0 + HALF_LEG_M / range_m;
    place.right_m *= farther;
    place.ahead_m *= farther;
    let depth_m = 0.5 * (a.depth_m + b.depth_m);
    let variance = POSE_M * POSE_M;
    let along = scene.parameters.noise.variance_m2(depth_m) + variance;
    let bearing = libm::atan2f(-place.right_m, place.ahead_m) + scene.mount.heading_rad;
    let ([al, at], [bl, bt]) = (a.first_px, b.first_px);
    let ([ar, ab], [br, bb]) = (a.last_px, b.last_px);
    let ([_, a_top], [_, b_top]) = (a.heights_m, b.heights_m);
    RgbdDetection {
        kind: RgbdKind::Legs,
        position_in_base: place.in_base(scene.mount),
        covariance_m2: turned_covariance(along, variance, bearing),
        distance_m: place.range_m(),
        top_m: a_top.max(b_top),
        confidence: belief,
        score: 0.0,
        differences: [0.0; AREAS],
        seen_share: 1.0,
        first_px: [al.min(bl), at.min(bt)],
        last_px: [ar.max(br), ab.max(bb)],
    }
}
