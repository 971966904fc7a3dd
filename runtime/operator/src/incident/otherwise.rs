//! What would have happened without the cause that held the robot.

use floorguard_guard::{CauseRecord, DriveLimits, signed_distance_m, stop_distance_m};
use floorguard_types::geometry::Point2;
use serde::Serialize;

use super::gather::Snapshot;
use super::rule::requirement;
use super::summary::cause_words;
use crate::surroundings::{Surroundings, direction};
use crate::words::Language;

/// What is in the way, and how soon it would have been reached.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ahead {
    /// `a person` or `an obstacle`.
    pub what: &'static str,
    /// Where it is.
    pub direction: &'static str,
    /// Free way to it, straight on, metres.
    pub free_m: f32,
    /// Seconds until it would have been reached at the speed before the stop; none at rest.
    pub reached_s: Option<f32>,
    /// Way that the robot needs to stand from that speed, metres.
    pub braking_m: f32,
}

/// What would have happened otherwise.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Otherwise {
    /// The cause that would have held the robot instead, the most severe first: in words, and its requirement.
    pub next_cause: Option<(String, &'static str)>,
    /// Speed in the second before, m/s; negative backwards.
    pub speed_mps: f32,
    /// What the mission asked for, m/s.
    pub wanted_mps: Option<f32>,
    /// The next object straight on, within ten metres.
    pub ahead: Option<Ahead>,
    /// All of it in one sentence.
    pub sentence: String,
}

/// Farther objects matter to no stop, metres.
const HORIZON_M: f32 = 10.0;

/// Of the snapshots of the seconds before; the last of them is the moment.
pub fn otherwise(snapshots: &[Snapshot], drive: &DriveLimits, language: Language) -> Option<Otherwise> {
    let moment = snapshots.last()?;
    let holding = moment.decision.holding_cause.map(|record| record.cause);
    let mut others: Vec<&CauseRecord> =
        moment.causes.iter().filter(|record| Some(record.cause) != holding).collect();
    others.sort_by_key(|record| std::cmp::Reverse(record.action));
    let next_cause = others.first().map(|record| (cause_words(record, language), requirement(record.cause)));
    let speed_mps = speed_before(snapshots);
    let wanted_mps = moment.wanted.map(|wanted| wanted.linear_mps);
    let heading_mps = if speed_mps == 0.0 { wanted_mps.unwrap_or(0.0) } else { speed_mps };
    let braking_m = stop_distance_m(speed_mps.abs(), drive.response_s, 0.0, drive.braking_mps2);
    let ahead = nearest_ahead(&moment.around, heading_mps < 0.0).map(|(what, place, free_m)| Ahead {
        what,
        direction: direction(place),
        free_m,
        reached_s: (speed_mps != 0.0).then(|| free_m / speed_mps.abs()),
        braking_m,
    });
    let next = next_cause.as_ref().map(|(text, _)| text.as_str());
    let sentence = sentence((next, language), speed_mps, ahead.as_ref());
    Some(Otherwise { next_cause, speed_mps, wanted_mps, ahead, sentence })
}

/// The fastest of the last second: at the moment itself it may stand already.
fn speed_before(snapshots: &[Snapshot]) -> f32 {
    /// Slower counts as standing, m/s.
    const STANDING_MPS: f32 = 0.02;
    let until_us = snapshots.last().map_or(0, |snapshot| snapshot.at.as_micros());
    let near = snapshots.iter().filter(|snapshot| snapshot.at.as_micros() + 1_000_000 >= until_us);
    let speeds = near.map(|snapshot| snapshot.pose.twist.linear_mps);
    let fastest = speeds.fold(0.0_f32, |most, speed| if speed.abs() > most.abs() { speed } else { most });
    if fastest.abs() < STANDING_MPS { 0.0 } else { fastest }
}

/// What the body would touch first straight on, or straight back: what it is, where, and the way to it in metres.
fn nearest_ahead(around: &Surroundings, backwards: bool) -> Option<(&'static str, Point2, f32)> {
    /// Half the width of a person, metres.
    const PERSON_M: f32 = 0.25;
    let sign = if backwards { -1.0 } else { 1.0 };
    let corners = || around.footprint.iter();
    let (left_m, right_m) = (
        corners().map(|corner| corner.y_m).fold(f32::NEG_INFINITY, f32::max),
        corners().map(|corner| corner.y_m).fold(f32::INFINITY, f32::min),
    );
    let front_m = corners().map(|corner| sign * corner.x_m).fold(f32::NEG_INFINITY, f32::max);
    let in_way = |place: Point2, half_m: f32| {
        let free_m = sign * place.x_m - front_m - half_m;
        let beside = place.y_m - half_m > left_m || place.y_m + half_m < right_m;
        let at_body = signed_distance_m(&around.footprint, place) <= half_m;
        (!beside && (free_m >= 0.0 || at_body) && free_m < HORIZON_M).then_some(free_m.max(0.0))
    };
    let people = around.followed.iter().filter(|track| track.person).filter_map(|track| {
        let place = Point2::new(track.x_m, track.y_m);
        in_way(place, PERSON_M).map(|free_m| ("a person", place, free_m))
    });
    let hits =
        around.hits.iter().filter_map(|hit| in_way(*hit, 0.0).map(|free_m| ("an obstacle", *hit, free_m)));
    people.chain(hits).min_by(|a, b| a.2.total_cmp(&b.2))
}

fn sentence((next, language): (Option<&str>, Language), speed_mps: f32, ahead: Option<&Ahead>) -> String {
    let number = |value: f32, digits| language.number(value.into(), digits);
    let instead = match next {
        Some(cause) => language.fill("Without this cause, the next one would have decided: {}.", &[cause]),
        None => {
            language.say("No other cause held the robot: without this one it would have gone on.").to_owned()
        }
    };
    let Some(ahead) = ahead else {
        let horizon = number(HORIZON_M, 0);
        return instead + " " + &language.fill("Straight on, nothing was seen within {} m.", &[&horizon]);
    };
    let (what, side) = (language.say(ahead.what), language.say(ahead.direction));
    let place = language.fill("{} {} m away, {}", &[what, &number(ahead.free_m, 2), side]);
    let way = match ahead.reached_s {
        Some(reached_s) => {
            let figures = [(reached_s, 1), (speed_mps.abs(), 2), (ahead.braking_m, 2)];
            let [reached, speed, braking] = figures.map(|(value, digits)| number(value, digits));
            language.fill(
                "Straight on, {}, would have been reached after {} s at {} m/s; to stand the robot needs {} m.",
                &[&place, &reached, &speed, &braking],
            )
        }
        None => language.fill("The robot stood; straight on there was {}.", &[&place]),
    };
    instead + " " + &way
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surroundings::Followed;

    fn around() -> Surroundings {
        let footprint = [(0.5, 0.4), (-0.5, 0.4), (-0.5, -0.4), (0.5, -0.4)];
        Surroundings {
            footprint: footprint.map(|(x_m, y_m)| Point2::new(x_m, y_m)).to_vec(),
            hits: vec![Point2::new(2.5, 0.0), Point2::new(1.0, 2.0), Point2::new(-3.0, 0.1)],
            followed: vec![Followed { id: 1, person: true, x_m: 1.75, y_m: 0.5, speed_mps: 0.0 }],
            ..Surroundings::default()
        }
    }

    #[test]
    fn what_the_body_would_touch_first_is_found() {
        let (what, _, free_m) = nearest_ahead(&around(), false).unwrap();
        assert!(what == "a person" && (free_m - 1.0).abs() < 1e-5, "{what} {free_m}");
        let (what, _, free_m) = nearest_ahead(&around(), true).unwrap();
        assert!(what == "an obstacle" && (free_m - 2.5).abs() < 1e-5, "{what} {free_m}");
        assert_eq!(nearest_ahead(&Surroundings { hits: Vec::new(), ..around() }, true), None);
    }
}
