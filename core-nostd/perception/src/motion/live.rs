//! Everything about a sweep at once: objects, which of them move, people, tracks that know whether they move.

use super::detector::{MotionDetectorOf, MotionOutput};
use crate::people::{DetectionOf, PeopleOutputOf, PeoplePipelineOf, SweepContext};
use floorguard_types::geometry::Point2;
use floorguard_types::profile::Profile;
use floorguard_types::sensing::SweepOf;

/// A position this near to a moving object is that object, metres: half a person and half a sweep's travel.
const SAME_M: f32 = 0.5;

/// Takes in a sweep. The clusters carry their verdict; the tracks take it into their probability of moving.
pub fn find_moving_people<'a, P: Profile>(
    people: &'a mut PeoplePipelineOf<P>,
    motion: &mut MotionDetectorOf<P>,
    sweep: &SweepOf<P>,
    context: &SweepContext,
) -> PeopleOutputOf<'a, P> {
    people.find_clusters(sweep, context);
    let output = motion.process(people, sweep, context);
    note_verdicts(people, &output);
    let robot = Point2::new(context.base_in_odom.x_m, context.base_in_odom.y_m);
    people.find_people_moving(sweep, context, |place| output.at(place, robot))
}

/// The same with what another pipeline has detected in other rings of the same revolution, see
/// [`PeoplePipelineOf::find_people_with_second_look`].
pub fn find_moving_people_with_second_look<'a, P: Profile>(
    people: &'a mut PeoplePipelineOf<P>,
    motion: &mut MotionDetectorOf<P>,
    (sweep, context): (&SweepOf<P>, &SweepContext),
    second: &[DetectionOf<P>],
) -> PeopleOutputOf<'a, P> {
    people.find_clusters(sweep, context);
    let output = motion.process(people, sweep, context);
    note_verdicts(people, &output);
    let robot = Point2::new(context.base_in_odom.x_m, context.base_in_odom.y_m);
    people.find_people_with_second_look(sweep, context, second, |place| output.at(place, robot))
}

/// Each cluster carries its verdict, where there is one.
fn note_verdicts<P: Profile>(people: &mut PeoplePipelineOf<P>, output: &MotionOutput<'_>) {
    let is_known = output.judged_within_m.is_some();
    people.note_motion(
        output.verdicts.iter().map(|verdict| (is_known && verdict.judged).then_some(verdict.moving)),
    );
}

impl MotionOutput<'_> {
    /// Whether what stands at a place moves; `None` where nothing was judged. Both places in the frame of the odometry.
    #[must_use]
    pub fn at(&self, place: Point2, robot: Point2) -> Option<bool> {
        let is_same = |object: Point2| object.distance(place) <= SAME_M;
        let moves =
            self.moving.iter().any(|object| is_same(Point2::new(object.centroid.x_m, object.centroid.y_m)));
        let in_reach = self.judged_within_m.is_some_and(|reach_m| place.distance(robot) <= reach_m);
        (moves || in_reach).then_some(moves)
    }
}
