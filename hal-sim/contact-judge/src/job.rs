//! Whether the robot did what it was sent for, and if not, whether anything kept it.

use serde::Serialize;

use crate::RobotPose;

/// What the robot is sent for.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Job {
    /// Nothing that could be left undone.
    #[default]
    None,
    /// To come to these places in their order, world frame, metres.
    Route(Vec<[f32; 2]>),
    /// To move about; somebody else judges what came of it.
    Mission,
}

/// What came of it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum JobOutcome {
    /// There was nothing to do.
    #[default]
    NoJob,
    /// It came to every place.
    Done,
    /// It was on its way when the run ended.
    OnItsWay,
    /// Something is in its way.
    Blocked(String),
    /// The caller that ran the world knows the reason: a fault, the emergency stop.
    Excused(String),
    /// Nothing was in its way.
    Undone,
}

/// A place counts as reached within this, metres.
const REACHED_M: f32 = 0.8;
/// It is on its way when it came as far as this within the last seconds, metres and seconds.
const HEADWAY: (f32, f64) = (0.3, 10.0);

/// Follows the robot along its route.
#[derive(Debug)]
pub(crate) struct JobWatch {
    job: Job,
    next: usize,
    /// Where it last had made headway, and when.
    headway: Option<(f64, RobotPose)>,
    now_s: f64,
}

impl JobWatch {
    pub(crate) fn new(job: Job) -> Self {
        Self { job, next: 0, headway: None, now_s: 0.0 }
    }

    /// The robot has come to a pose.
    pub(crate) fn observe(&mut self, at_s: f64, pose: RobotPose) {
        self.now_s = at_s;
        if let Job::Route(places) = &self.job
            && places
                .get(self.next)
                .is_some_and(|[x, y]| libm::hypotf(x - pose.x_m, y - pose.y_m) < REACHED_M)
        {
            self.next += 1;
        }
        let (_, from) = *self.headway.get_or_insert((at_s, pose));
        if libm::hypotf(from.x_m - pose.x_m, from.y_m - pose.y_m) > HEADWAY.0 {
            self.headway = Some((at_s, pose));
        }
    }

    /// The place that it is on its way to, world frame, metres.
    pub(crate) fn next_place(&self) -> Option<[f32; 2]> {
        self.place(self.next)
    }

    /// The place that counted last, while the robot is near to it: places count from afar, and a robot that has to come nearer is still
    /// on its way there.
    pub(crate) fn place_nearby(&self, pose: RobotPose) -> Option<[f32; 2]> {
        let place = self.place(self.next.checked_sub(1)?)?;
        let [x, y] = place;
        (libm::hypotf(x - pose.x_m, y - pose.y_m) < REACHED_M).then_some(place)
    }

    fn place(&self, index: usize) -> Option<[f32; 2]> {
        match &self.job {
            Job::Route(places) => places.get(index).copied(),
            Job::None | Job::Mission => None,
        }
    }

    /// What came of it; `blocked` names what stands in the way, `excuse` what else kept the robot.
    pub(crate) fn outcome(&self, blocked: Option<String>, excuse: Option<&str>) -> JobOutcome {
        let places = match &self.job {
            Job::None => return JobOutcome::NoJob,
            Job::Route(places) => places.len(),
            Job::Mission => usize::MAX,
        };
        let is_moving = self.headway.is_some_and(|(at_s, _)| self.now_s - at_s < HEADWAY.1);
        match (blocked, excuse) {
            _ if self.next >= places => JobOutcome::Done,
            _ if is_moving => JobOutcome::OnItsWay,
            (Some(what), _) => JobOutcome::Blocked(what),
            (None, Some(excuse)) => JobOutcome::Excused(excuse.to_owned()),
            (None, None) if self.job == Job::Mission => JobOutcome::Done,
            (None, None) => JobOutcome::Undone,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose(x_m: f32) -> RobotPose {
        RobotPose { x_m, ..RobotPose::default() }
    }

    #[test]
    fn places_are_reached_in_order() {
        let mut watch = JobWatch::new(Job::Route(vec![[3.0, 0.0], [0.0, 0.0]]));
        watch.observe(0.0, pose(0.0));
        watch.observe(5.0, pose(2.9));
        assert_eq!(watch.next_place(), Some([0.0, 0.0]));
        assert_eq!((watch.place_nearby(pose(2.9)), watch.place_nearby(pose(2.0))), (Some([3.0, 0.0]), None));
        assert_eq!(watch.outcome(None, None), JobOutcome::OnItsWay);
        watch.observe(20.0, pose(2.9));
        assert_eq!(watch.outcome(None, None), JobOutcome::Undone);
        assert_eq!(watch.outcome(Some("a box".into()), None), JobOutcome::Blocked("a box".into()));
        assert_eq!(watch.outcome(None, Some("fault")), JobOutcome::Excused("fault".into()));
        watch.observe(30.0, pose(0.1));
        assert_eq!(watch.outcome(None, None), JobOutcome::Done);
    }
}
