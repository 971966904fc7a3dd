//! Camera, rules and limits of the person finder, with the published values and where ours differ.

use crate::floor::DepthNoise;
use floorguard_types::sensing::PinholeCamera;

/// What an upper body must be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UpperBodyRules {
    /// Depths that count, metres (book, Depth people: Depth images).
    pub depth_m: [f32; 2],
    /// Heights above the floor of what is projected on it, metres (book, Depth people: Floor grid).
    pub heights_m: [f32; 2],
    /// A column of the floor with something above this height is building or furniture, metres. Ours: without it a
    /// person at a wall is one region with it.
    pub structure_m: f32,
    /// Occupied from this weight on. A pixel of a camera of 525 px focal length weighs its depth in metres, as published;
    /// beyond 5 m a fifth of the depth's square, so that a body at 7 m weighs what it does at 5 m. Published: 500.
    pub occupied_min: f32,
    /// Top of a person above the floor, metres.
    pub top_m: [f32; 2],
    /// Mean squared difference from the silhouette up to which a place is a person (lower is better).
    pub score_max: f32,
    /// Score at which half of the detections are people, and the width of the transition.
    pub score_even: [f32; 2],
    /// Boxes that overlap by this much are one person.
    pub overlap_max: f32,
    /// Silhouettes are tried at these sizes, relative to what the height of the head suggests.
    pub scales: [f32; 3],
}

impl UpperBodyRules {
    /// Published values (book, Depth people); the score, its threshold and the belief are those of our silhouettes,
    /// from simulated rooms of seeds 1000 to 2150. The least height is 5 cm below the published one: the top of a head
    /// is seen to a pixel or two.
    pub const DEFAULT: Self = Self {
        depth_m: [0.4, 7.0],
        heights_m: [0.1, 2.5],
        structure_m: 2.2,
        occupied_min: 300.0,
        top_m: [0.95, 2.1],
        score_max: 0.145,
        score_even: [0.141, 0.033],
        overlap_max: 0.3,
        scales: [1.0, 0.9, 1.1],
    };
}

/// What a leg and a pair of legs must be (book, Depth people: Leg candidates).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegRules {
    /// Depths that count, metres.
    pub depth_m: [f32; 2],
    /// Heights above the floor of the band in which legs are looked for, metres.
    pub band_m: [f32; 2],
    /// Widths of a leg along any axis of the floor, metres.
    pub width_m: [f32; 2],
    /// The lowest return of a leg that is in view, metres above the floor.
    pub foot_max_m: f32,
    /// Cosine of two colour histograms from which on legs may belong to one person.
    pub likeness_min: f32,
    /// Distances between the legs of a person, metres.
    pub pair_m: [f32; 2],
    /// Something of a body must be this high above a pair, as far as it is in view, metres. Ours.
    pub body_min_m: f32,
}

impl LegRules {
    /// The values of the book, Depth people: Leg candidates; the body above is ours.
    pub const DEFAULT: Self = Self {
        depth_m: [0.3, 4.0],
        band_m: [0.05, 0.40],
        width_m: [0.07, 0.25],
        foot_max_m: 0.2,
        likeness_min: 0.8,
        pair_m: [0.05, 1.0],
        body_min_m: 1.0,
    };
}

/// Everything that is fixed about the finder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RgbdParameters {
    /// The depth camera.
    pub camera: PinholeCamera,
    /// Its noise.
    pub noise: DepthNoise,
    /// Upper bodies.
    pub upper_body: UpperBodyRules,
    /// Legs.
    pub legs: LegRules,
}

impl RgbdParameters {
    /// The usual rules for a camera.
    #[must_use]
    pub const fn new(camera: PinholeCamera) -> Self {
        Self {
            camera,
            noise: DepthNoise::NGUYEN,
            upper_body: UpperBodyRules::DEFAULT,
            legs: LegRules::DEFAULT,
        }
    }
}
