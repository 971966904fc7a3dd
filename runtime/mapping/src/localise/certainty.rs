//! How sure the searches of the last metres are of the place that leads.

use super::config::LocaliseConfig;
use super::searching::Lead;
use crate::se2::Se2;

/// A place on which the last searches agree.
#[derive(Clone, Copy)]
pub struct Certainty {
    /// Path at the first of them, metres.
    since_m: f64,
    /// Path at the last of them, metres.
    searched_m: f64,
    /// Advantage over every other place, summed over the path since, metres.
    advantage_m: f64,
    tracking_in_map: Se2,
}

impl Certainty {
    /// After one more search, with the robot at a place of the tracking after so much path, metres. A place that leads now and did not before
    /// begins anew.
    pub fn after(
        before: Option<Self>,
        lead: Lead,
        (place, path_m): (Se2, f64),
        config: &LocaliseConfig,
    ) -> Self {
        let Lead { tracking_in_map, advantage, .. } = lead;
        let (distance_m, turn_rad) = config.agree;
        let agreeing = before.filter(|before| {
            let away = before.tracking_in_map.compose(place).between(tracking_in_map.compose(place));
            away.length_m() <= distance_m && away.heading_rad.abs() <= turn_rad
        });
        let Some(before) = agreeing else {
            return Self { since_m: path_m, searched_m: path_m, advantage_m: 0.0, tracking_in_map };
        };
        let step_m = path_m - before.searched_m;
        let kept = libm::exp(-step_m / config.forget_m.max(1.0e-3));
        let advantage_m = (kept * before.advantage_m + advantage * step_m).max(0.0);
        Self { since_m: before.since_m, searched_m: path_m, advantage_m, tracking_in_map }
    }

    /// The place counts.
    pub fn is_enough(&self, config: &LocaliseConfig) -> bool {
        self.searched_m - self.since_m >= config.confirm_path_m && self.advantage_m >= config.certainty_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Searches every 0.7 m with an advantage: path after which the place counts.
    fn enough_m(advantage: f64) -> Option<f64> {
        let config = LocaliseConfig::default();
        let mut certainty = None;
        (0..100).map(|search| 0.7 * f64::from(search)).find(|path_m| {
            let lead = Lead { tracking_in_map: Se2::default(), margin: advantage, advantage };
            let after = Certainty::after(certainty, lead, (Se2::default(), *path_m), &config);
            certainty = Some(after);
            after.is_enough(&config)
        })
    }

    #[test]
    fn large_leads_count_soon_small_ones_never() {
        assert_eq!(enough_m(0.5), Some(1.4), "a metre of path at least");
        assert!(enough_m(0.05).is_some_and(|path_m| (3.5..8.0).contains(&path_m)), "{:?}", enough_m(0.05));
        assert_eq!(enough_m(0.03), None);
        assert_eq!(enough_m(0.01), None);
        assert_eq!(enough_m(-0.1), None);
    }

    #[test]
    fn other_place_begins_anew() {
        let config = LocaliseConfig::default();
        let lead = |x_m| Lead { tracking_in_map: Se2::new(x_m, 0.0, 0.0), margin: 0.5, advantage: 0.5 };
        let mut certainty = None;
        for (search, x_m) in [0.0, 5.0, 0.0, 5.0, 0.0, 5.0].into_iter().enumerate() {
            let path_m = 0.7 * search as f64;
            certainty = Some(Certainty::after(certainty, lead(x_m), (Se2::default(), path_m), &config));
            assert!(certainty.is_some_and(|certainty| !certainty.is_enough(&config)));
        }
    }
}
