//! A tour judged by where the robot truly stood, and for how long.

use floorguard_robot::navigator::TourProgress;
use floorguard_types::geometry::{Point2, Pose2, wrap_angle};
use serde::Serialize;

/// Shorter stands are no look, seconds.
const LOOK_S: f64 = 2.0;

/// What came of a tour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct TourReport {
    /// Places to look from.
    pub places: u32,
    /// Places at which it truly stood for two seconds in one stretch.
    pub stood_at: u32,
    /// Places that the robot says it has looked from.
    pub claimed: u32,
    /// Places that it says no way leads to.
    pub left_out: u32,
}

impl TourReport {
    /// It stood at every place.
    pub(super) const fn is_whole(&self) -> bool {
        self.stood_at == self.places
    }

    /// What was asked for and not done.
    pub(super) fn shortfall(&self) -> Option<String> {
        let Self { places, stood_at, claimed, left_out } = self;
        if claimed > stood_at {
            return Some(format!(
                "the robot says that it looked from {claimed} places, and stood at {stood_at}"
            ));
        }
        (stood_at < places)
            .then(|| format!("the robot stood at {stood_at} of {places} places, {left_out} it left out"))
    }

    /// In one line, for people.
    pub(super) fn words(&self) -> String {
        format!(
            "stood at {} of {} places of the tour, left out {}",
            self.stood_at, self.places, self.left_out
        )
    }
}

/// Watches a tour beside the truth.
#[derive(Clone, Debug)]
pub(super) struct TourJudge {
    within: (f32, f32),
    /// Each place with the longest stand there, seconds.
    places: Vec<(Pose2, f64)>,
    stretch_s: f64,
}

impl TourJudge {
    /// Of places that count as reached within so many metres and radians; `None` for a single one, which is a goal.
    pub(super) fn of(places: &[Pose2], within: (f32, f32)) -> Option<Self> {
        let places: Vec<(Pose2, f64)> = places.iter().map(|place| (*place, 0.0)).collect();
        (places.len() > 1).then_some(Self { within, places, stretch_s: 0.0 })
    }

    /// A moment; with how long it lasted, if the robot stood.
    pub(super) fn observe(&mut self, robot: Pose2, stood_s: Option<f64>) {
        self.stretch_s = stood_s.map_or(0.0, |lasted_s| self.stretch_s + lasted_s);
        for (place, longest_s) in &mut self.places {
            let off_m = Point2::new(robot.x_m, robot.y_m).distance(Point2::new(place.x_m, place.y_m));
            let off_rad = wrap_angle(robot.heading_rad - place.heading_rad).abs();
            if off_m <= self.within.0 && off_rad <= self.within.1 {
                *longest_s = longest_s.max(self.stretch_s);
            }
        }
    }

    /// The end, beside what the robot says.
    pub(super) fn judge(&self, reported: TourProgress) -> TourReport {
        let stood_at = self.places.iter().filter(|(_, longest_s)| *longest_s >= LOOK_S).count() as u32;
        TourReport {
            places: self.places.len() as u32,
            stood_at,
            claimed: reported.seen_from,
            left_out: reported.left_out,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passing_by_is_no_look() {
        let places = [Pose2::new(1.0, 0.0, 0.0), Pose2::new(3.0, 0.0, 0.0)];
        let mut judge = TourJudge::of(&places, (0.3, 0.2)).unwrap();
        (0..300).for_each(|step| judge.observe(Pose2::new(0.01 * step as f32, 0.0, 0.0), None));
        assert_eq!(judge.judge(TourProgress::default()).stood_at, 0);
        (0..250).for_each(|_| judge.observe(Pose2::new(3.1, 0.0, 0.1), Some(0.01)));
        let reported = TourProgress { places: 2, seen_from: 2, left_out: 0 };
        let report = judge.judge(reported);
        assert_eq!((report.stood_at, report.claimed, report.is_whole()), (1, 2, false));
        assert!(report.shortfall().unwrap().contains("says that it looked from 2 places, and stood at 1"));
        assert!(TourJudge::of(&places[..1], (0.3, 0.2)).is_none());
    }
}
