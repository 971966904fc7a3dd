//! What the localisation in a known map is set by.

use floorguard_localisation::scan_matching::DescentConfig;

use crate::front_end::FrontEndConfig;

/// Settings. One set of values for all buildings and scanners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocaliseConfig {
    /// Tracking of the scans among each other.
    pub front_end: FrontEndConfig,
    /// Edge of a cell of the searched field, metres; a coarser map keeps its own.
    pub cell_m: f32,
    /// Distance at which a wall's value has fallen to zero, metres.
    pub reach_m: f32,
    /// A step of the heading in the search of the whole map, radians.
    pub turn_step_rad: f32,
    /// The first search comes after so much path, metres; a turn of one radian counts a metre.
    pub first_path_m: f64,
    /// Further searches after so much more.
    pub next_path_m: f64,
    /// After a search without an answer the next one waits longer by this factor...
    pub patience: f64,
    /// ... up to so much path.
    pub next_path_most_m: f64,
    /// Searches must agree over so much path.
    pub confirm_path_m: f64,
    /// Path whose scans are searched together, metres.
    pub query_path_m: f64,
    /// Returns of a search at most.
    pub query_points: usize,
    /// Mean value of the returns at a place that counts, 0 to 1.
    pub score_least: f32,
    /// A place needs this much support of the scans, at most 1: returns on walls for it, beams through walls against it.
    pub support_least: f64,
    /// A place in another map fits nearly as well if its support is less by no more than this.
    pub support_margin: f64,
    /// A place leads if it has so much more support than every other one...
    pub lead_least: f64,
    /// ... or so much divided by the metres that the scans of a search cover, if that is more.
    pub lead_metres: f64,
    /// What all counts in the advantage of a place over another that moved furniture can explain; beams through walls count in full.
    pub clutter_share: f64,
    /// A place is certain once its advantage over every other one comes to so much over the path, metres...
    pub certainty_m: f64,
    /// ... of which a share is forgotten over this path, metres: a small lead counts for nothing however long it lasts.
    pub forget_m: f64,
    /// Share of beams, at most, that went through a wall of the map.
    pub through_most: f64,
    /// Two searches agree within this distance, metres, and turn, radians.
    pub agree: (f64, f64),
    /// Mean support of the scans of the last metres below which the place is in doubt...
    pub doubt_below: f64,
    /// ... and below which it is given up.
    pub lost_below: f64,
    /// Scans over which that mean runs; the place is given up by half of them.
    pub memory: usize,
    /// A scan that lies so far from where the tracking expects it, metres and radians, and fits there too, lies on something that was moved:
    /// the tracking is believed.
    pub leap: (f64, f64),
    /// Share of what a scan lies away by which the place of the tracking in the map is corrected.
    pub correction_share: f64,
    /// Share of the curvature of a match that its weakest direction must have to hold the place along it.
    pub held_share: f32,
    /// Growth of the deviation along a way that the walls do not hold, metres a metre, and the least deviation, metres.
    pub unheld_growth: f64,
    /// See `unheld_growth`.
    pub deviation_least_m: f64,
    /// A larger deviation is a doubt, metres.
    pub deviation_most_m: f64,
    /// A place that is not known for longer than this asks for help, seconds.
    pub help_after_s: f64,
    /// Scans that the tracking keeps before it begins anew.
    pub scans_kept: usize,
    /// A robot that stands checks its place so often, seconds.
    pub check_s: f64,
    /// Descents.
    pub descent: DescentConfig,
}

impl Default for LocaliseConfig {
    fn default() -> Self {
        Self {
            front_end: FrontEndConfig::default(),
            cell_m: 0.1,
            reach_m: 0.3,
            turn_step_rad: 0.025,
            first_path_m: 1.5,
            next_path_m: 0.7,
            patience: 1.1,
            next_path_most_m: 2.0,
            confirm_path_m: 1.0,
            query_path_m: 14.0,
            query_points: 250,
            score_least: 0.4,
            support_least: 0.35,
            support_margin: 0.06,
            lead_least: 0.03,
            lead_metres: 0.3,
            clutter_share: 0.5,
            certainty_m: 0.2,
            forget_m: 6.0,
            through_most: 0.1,
            agree: (0.4, 0.15),
            doubt_below: 0.15,
            lost_below: 0.0,
            memory: 8,
            leap: (0.2, 0.08),
            correction_share: 0.25,
            held_share: 0.03,
            unheld_growth: 0.05,
            deviation_least_m: 0.05,
            deviation_most_m: 0.3,
            help_after_s: 10.0,
            scans_kept: 6_000,
            check_s: 0.25,
            descent: DescentConfig {
                reach_m: 0.3,
                return_deviation_m: 0.15,
                outlier_distance_m: 0.1,
                steps_max: 15,
                step_least: 2.0e-4,
            },
        }
    }
}

impl LocaliseConfig {
    /// Deviation after so much path that the walls did not hold, metres.
    #[must_use]
    pub fn deviation_m(&self, unheld_m: f64) -> f64 {
        self.deviation_least_m + self.unheld_growth * unheld_m
    }
}
