//! The predictor: learns from everybody's outcomes, predicts everybody.

use floorguard_types::geometry::Point2;
use floorguard_types::motion::MovingPerson;

use super::doubt::Doubt;
use super::motion_model::{MotionModel, Rows};
use super::place_flow::{FlowCell, PlaceFlow};
use super::trail::{Pending, PersonTrail, SEEN_STEPS};
use super::{STEP_S, STEPS};

/// A prediction of every person waits for its outcome this often, steps.
const PENDING_EVERY: u32 = 3;

/// Where somebody will be at one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PredictedPlace {
    /// Most likely, in the map frame.
    pub place_in_map: Point2,
    /// Half axes of the ellipse that holds 95 of 100, metres: along the person's direction, and across it.
    pub half_axes_m: [f32; 2],
}

/// Where somebody will be at the next steps of 0.4 s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PredictedPath {
    /// By step, the first one 0.4 s from now.
    pub places: [PredictedPlace; STEPS],
    /// The person's last step, metres: the direction of the ellipses.
    pub last_step: Point2,
}

impl PredictedPath {
    /// At a step, as planners want it: the doubt is that of the worst direction, as a standard deviation.
    #[must_use]
    pub fn person_at(&self, step: usize) -> Option<MovingPerson> {
        let place = self.places.get(step)?;
        let [along_m, across_m] = place.half_axes_m;
        let velocity = Point2::new(self.last_step.x_m / STEP_S, self.last_step.y_m / STEP_S);
        Some(MovingPerson {
            position_in_map: place.place_in_map,
            velocity_in_map_mps: velocity,
            position_deviation_m: along_m.max(across_m) / 2.448,
            velocity_deviation_mps: 0.0,
        })
    }
}

/// What was learnt of a place; `S` stores the flow.
#[derive(Clone, Debug)]
pub struct PeoplePredictor<S> {
    flow: PlaceFlow<S>,
    model: MotionModel,
    doubt: Doubt,
}

impl<S: AsRef<[FlowCell]> + AsMut<[FlowCell]>> PeoplePredictor<S> {
    /// Nothing learnt beyond what the flow holds.
    #[must_use]
    pub fn new(flow: PlaceFlow<S>) -> Self {
        Self { flow, model: MotionModel::default(), doubt: Doubt::default() }
    }

    /// The model of speeds and turns.
    #[must_use]
    pub const fn model(&self) -> &MotionModel {
        &self.model
    }

    /// How far predictions are off.
    #[must_use]
    pub const fn doubt(&self) -> &Doubt {
        &self.doubt
    }

    /// A person is seen again, one step after the last time. A place that is not finite interrupts the trail.
    pub fn observe(&mut self, trail: &mut PersonTrail, place_in_map: Point2) {
        if !place_in_map.norm().is_finite() {
            trail.interrupt();
            return;
        }
        self.learn_outcomes(trail, place_in_map);
        if let (Some(&last), Some(step)) = (trail.places().last(), trail.step(0)) {
            let next = Point2::new(place_in_map.x_m - last.x_m, place_in_map.y_m - last.y_m);
            self.flow.learn(last, step, next);
        }
        trail.push(place_in_map);
        trail.since_pending = trail.since_pending.saturating_add(1);
        let is_due = trail.places().len() == SEEN_STEPS && trail.since_pending >= PENDING_EVERY;
        let Some(rows) = Rows::of(trail, &self.flow).filter(|_| is_due) else { return };
        let pending = Pending { rows, from: place_in_map, outcome: heapless::Vec::new() };
        if trail.pending.push(pending).is_ok() {
            trail.since_pending = 0;
        }
    }

    /// Once a step, after everybody was observed: what was learnt takes effect.
    pub fn end_step(&mut self) {
        self.model.solve();
    }

    /// Outcomes that are complete teach model and doubt.
    fn learn_outcomes(&mut self, trail: &mut PersonTrail, place_in_map: Point2) {
        for pending in &mut trail.pending {
            let _ = pending.outcome.push(place_in_map);
        }
        let is_complete = trail.pending.first().is_some_and(|oldest| oldest.outcome.is_full());
        if !is_complete {
            return;
        }
        let Pending { rows, from, outcome } = trail.pending.remove(0);
        for (step, place) in outcome.iter().enumerate() {
            let travel = Point2::new(place.x_m - from.x_m, place.y_m - from.y_m);
            let predicted = self.model.travel(&rows, step);
            let error = Point2::new(travel.x_m - predicted.x_m, travel.y_m - predicted.y_m);
            self.doubt.learn(step, rows.last, error);
            self.model.learn(&rows, step, travel);
        }
    }

    /// Where a person will be; `None`: seen for fewer than three steps. Cost: twelve looks at the flow.
    #[must_use]
    pub fn predict(&self, trail: &PersonTrail) -> Option<PredictedPath> {
        let rows = Rows::of(trail, &self.flow)?;
        let from = *trail.places().last()?;
        let places = core::array::from_fn(|step| {
            let travel = self.model.travel(&rows, step);
            PredictedPlace {
                place_in_map: Point2::new(from.x_m + travel.x_m, from.y_m + travel.y_m),
                half_axes_m: self.doubt.half_axes_m(step, rows.last),
            }
        });
        Some(PredictedPath { places, last_step: rows.last })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_mapping::GridGeometry;
    use floorguard_types::random::Pcg32;
    use std::vec;
    use std::vec::Vec;

    fn predictor() -> PeoplePredictor<Vec<FlowCell>> {
        let geometry = GridGeometry::new(40, 40, 0.75, Point2::new(-5.0, -5.0)).unwrap();
        let cells = vec![FlowCell::default(); geometry.cell_count() * super::super::FLOW_HEADINGS];
        PeoplePredictor::new(PlaceFlow::new(geometry, cells).unwrap())
    }

    /// Error at the last step of somebody who walks along x and turns by 90° at x = 8 m.
    fn error_of_a_walk(predictor: &mut PeoplePredictor<Vec<FlowCell>>, random: &mut Pcg32) -> f32 {
        let mut trail = PersonTrail::default();
        let aside_m = random.uniform_between(-0.3, 0.3);
        let place = |step: usize| {
            let path_m = 0.5 * step as f32;
            if path_m < 8.0 { Point2::new(path_m, aside_m) } else { Point2::new(8.0 + aside_m, path_m - 8.0) }
        };
        let mut error_m = 0.0;
        for step in 0..30 {
            predictor.observe(&mut trail, place(step));
            predictor.end_step();
            if step == 12 {
                let predicted = predictor.predict(&trail).unwrap();
                error_m = predicted.places[11].place_in_map.distance(place(24));
            }
        }
        error_m
    }

    #[test]
    fn learns_where_people_turn_in_this_place() {
        let (mut predictor, mut random) = (predictor(), Pcg32::new(4, 4));
        let first_m = error_of_a_walk(&mut predictor, &mut random);
        for _ in 0..60 {
            error_of_a_walk(&mut predictor, &mut random);
        }
        let last_m = error_of_a_walk(&mut predictor, &mut random);
        assert!(first_m > 4.0 && last_m < 0.6 * first_m, "{first_m} m, then {last_m} m");
    }

    #[test]
    fn what_is_not_a_place_teaches_nothing() {
        let mut predictor = predictor();
        let mut trail = PersonTrail::default();
        for step in 0..10 {
            predictor.observe(&mut trail, Point2::new(0.4 * step as f32, 0.0));
        }
        predictor.observe(&mut trail, Point2::new(f32::NAN, 0.0));
        assert!(predictor.predict(&trail).is_none());
        predictor.end_step();
        assert!(predictor.model().numbers().iter().all(|number| number.is_finite()));
    }
}
