//! Answers in plain words, with what they rest on and how sure they are.

use floorguard_mapping::environment::{
    Confidence, PROFILE_STEP_S, Place, Profile, Wetness, best_time, removal_per_encounter, wetness,
};
use floorguard_mapping::environment::{PLACE_CELL_M, WallTime};
use serde::Serialize;
use serde_json::{Value, json};

use super::answer_people::people;
use super::model::{HOURS, Model, PERIODS};
use super::question::Question;
use super::zones::Zone;

/// Floor that the robot cleans in a minute, m²: half a metre at half a metre a second, less turns.
const M2_PER_MINUTE: f32 = 12.0;

/// An answer.
#[derive(Clone, Debug, Serialize)]
pub struct Answer {
    /// Which question.
    pub question: &'static str,
    /// In plain words.
    pub answer: String,
    /// `unknown`, `guess`, `fair` or `sure`.
    pub confidence: &'static str,
    /// What it rests on, in plain words.
    pub evidence: Vec<String>,
    /// The numbers.
    pub details: Value,
}

/// Answers a question as of `now`.
#[must_use]
pub fn answer(model: &Model, question: &Question, now: WallTime) -> Answer {
    match question {
        Question::BestTime { zone, minutes, days, delay_cost } => {
            when(model, (zone, now), (*minutes, *days, *delay_cost))
        }
        Question::BestZone { minutes } => which_zone(model, *minutes, now),
        Question::WetOrDry { zone, threshold } => wet_or_dry(model, zone, (*threshold, now)),
        Question::Dirt => dirt(model, now),
        Question::People { hours } => people(model, hours),
    }
}

/// The profile of a zone, in quarters of an hour from `now`.
pub(super) fn profile(model: &Model, zone: &Zone, now: WallTime) -> Profile {
    let places = model.places_of(zone);
    let grid = model.core.places.grid();
    let chosen = places.iter().filter_map(|index| grid.get(*index));
    Profile::new(chosen, now, model.calendar.offset_s(now))
}

pub(super) fn unknown(question: &'static str, what: &str) -> Answer {
    Answer {
        question,
        answer: format!("I do not know: nobody has watched {what} yet."),
        confidence: Confidence::Unknown.name(),
        evidence: vec![format!("{what}: not watched")],
        details: json!({}),
    }
}

fn watched(profile: &Profile, zone: &Zone) -> String {
    format!(
        "{}: {} of {} places of 2 m watched, {:.1} hours each on average",
        zone.name, profile.known_places, profile.places, profile.watched_hours
    )
}

fn model_words(model: &Model, zone: &Zone) -> String {
    let grid = model.core.places.grid();
    let mut names: Vec<&str> = model
        .places_of(zone)
        .iter()
        .filter_map(|index| grid.get(*index))
        .filter(|place| place.week.total().hours > 0.0)
        .map(|place| place.forecast().model().name())
        .collect();
    names.sort_unstable();
    let mut counted: Vec<(usize, &str)> = names
        .chunk_by(|a, b| a == b)
        .map(|same| (same.len(), same.first().copied().unwrap_or_default()))
        .collect();
    counted.sort_unstable_by(|a, b| b.cmp(a));
    let words: Vec<String> = counted.iter().map(|(count, name)| format!("{name} in {count}")).collect();
    format!("predicted by what has predicted best so far: {} places", words.join(", "))
}

fn when(
    model: &Model,
    (zone, now): (&Zone, WallTime),
    (minutes, days, delay_cost): (u32, u32, f32),
) -> Answer {
    let profile = profile(model, zone, now);
    let steps = (i64::from(minutes) * 60).div_euclid(PROFILE_STEP_S).max(1) as usize;
    let starts = (days.clamp(1, 7) * 96) as usize;
    let Some(best) = best_time(&profile, starts, steps, delay_cost) else {
        return unknown("best-time", &format!("zone {}", zone.name));
    };
    let (met, at_once) = (best.encounters, best.encounters_now);
    let confidence = met.confidence();
    let start = model.calendar.words(best.start);
    let now_words =
        if best.step == 0 { "Now is the best time".to_owned() } else { format!("Best on {start}") };
    Answer {
        question: "best-time",
        answer: format!(
            "{now_words} for {minutes} minutes in zone {}: about {:.1} people come near the robot ({:.1} to {:.1}); \
             starting at once it would be {:.1}.",
            zone.name, met.per_hour, met.low, met.high, at_once.per_hour
        ),
        confidence: confidence.name(),
        evidence: vec![
            watched(&profile, zone),
            model_words(model, zone),
            format!("{starts} start times a quarter of an hour apart compared; of equals the earliest"),
        ],
        details: json!({
            "zone": zone.name, "start": model.calendar.iso(best.start), "minutes": minutes,
            "encounters": met.per_hour, "encounters_interval95": [met.low, met.high],
            "encounters_now": at_once.per_hour, "watched_hours": profile.watched_hours,
            "places": profile.places, "known_places": profile.known_places,
        }),
    }
}

/// Dirt expected in a place, and whether dirt was ever measured there.
fn expected_units(model: &Model, place: &Place<HOURS, PERIODS>, now: WallTime) -> (f32, bool) {
    let is_measured = place.dirt.hours > 0.0;
    let is_known = is_measured || place.week.total().hours > 0.0;
    (if is_known { place.expected_dirt(now, &model.per_visit) } else { 0.0 }, is_measured)
}

/// What is expected in a zone.
struct ZoneDirt {
    units: f32,
    measured: usize,
    known: usize,
    places: usize,
    area_m2: f32,
}

fn zone_dirt(model: &Model, zone: &Zone, now: WallTime) -> ZoneDirt {
    let grid = model.core.places.grid();
    let places = model.places_of(zone);
    let mut sum = ZoneDirt { units: 0.0, measured: 0, known: 0, places: places.len(), area_m2: 0.0 };
    for place in places.iter().filter_map(|index| grid.get(*index)) {
        let (units, is_measured) = expected_units(model, place, now);
        sum.units += units;
        sum.measured += usize::from(is_measured);
        sum.known += usize::from(is_measured || place.week.total().hours > 0.0);
    }
    sum.area_m2 = (places.len() as f32 * PLACE_CELL_M * PLACE_CELL_M).min(zone.area_m2().max(1.0));
    sum
}

fn dirt_source(model: &Model, measured: usize, known: usize) -> String {
    let assumed = known.saturating_sub(measured);
    let origin =
        if model.per_visit.is_learned() { "as learned where dirt was measured" } else { "an assumption" };
    format!(
        "dirt measured in {measured} places; in {assumed} it is only inferred from people ({:.2} units a visit, {origin})",
        model.per_visit.mean()
    )
}

fn which_zone(model: &Model, minutes: u32, now: WallTime) -> Answer {
    let steps = (i64::from(minutes) * 60).div_euclid(PROFILE_STEP_S).max(1) as usize;
    let mut ranked: Vec<(f32, Zone, f32, f32, Confidence)> = Vec::new();
    let (mut measured, mut known, mut unseen) = (0, 0, 0);
    for zone in model.zones_or_tiles() {
        let expected = zone_dirt(model, &zone, now);
        let met = profile(model, &zone, now).encounters(0, steps);
        if met.confidence() == Confidence::Unknown {
            unseen += 1;
            continue;
        }
        measured += expected.measured;
        known += expected.known;
        let share = (M2_PER_MINUTE * minutes as f32 / expected.area_m2).min(1.0);
        let removed = expected.units * share;
        ranked.push((
            removal_per_encounter(removed, met.per_hour),
            zone,
            removed,
            met.per_hour,
            met.confidence(),
        ));
    }
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.name.cmp(&b.1.name)));
    let Some((_, zone, removed, met, surety)) = ranked.first() else {
        return unknown("best-zone", "any zone");
    };
    // Where dirt is inferred, the order of the zones is a guess at best.
    let confidence = if measured == 0 { (*surety).min(Confidence::Guess) } else { *surety };
    Answer {
        question: "best-zone",
        answer: format!(
            "Zone {}: {minutes} minutes there take away about {removed:.1} units of dirt and meet about {met:.1} people.",
            zone.name
        ),
        confidence: confidence.name(),
        evidence: vec![
            format!(
                "{} zones compared by dirt removed for each person met; {unseen} zones not watched",
                ranked.len()
            ),
            dirt_source(model, measured, known),
        ],
        details: json!({
            "zone": zone.name, "minutes": minutes,
            "zones": ranked.iter().map(|(score, zone, removed, met, surety)| json!({
                "zone": zone.name, "score": score, "expected_units_removed": removed, "encounters": met,
                "confidence": surety.name(),
            })).collect::<Vec<_>>(),
        }),
    }
}

fn wet_or_dry(model: &Model, zone: &Zone, (threshold, now): (f32, WallTime)) -> Answer {
    let profile = profile(model, zone, now);
    let step = profile.steps.first().copied().unwrap_or_default();
    let verdict = wetness(&step, threshold);
    let (word, why) = match verdict {
        _ if zone.is_always_dry => ("dry", "the zone is never cleaned wet".to_owned()),
        Wetness::Wet => ("wet", "the floor dries before somebody is likely to step on it".to_owned()),
        Wetness::Dry => ("dry", "somebody is likely to step on the floor while it is wet".to_owned()),
        Wetness::DryToBeSafe => {
            ("dry", "probably nobody would step on it, but too little is known to be sure".to_owned())
        }
        Wetness::DryUnknown => {
            ("dry", format!("nobody has watched zone {} yet, so wet cannot be justified", zone.name))
        }
    };
    let confidence = if zone.is_always_dry { Confidence::Sure } else { step.rate.confidence() };
    let is_observed = profile.known_places > 0;
    // A share of nothing is no number.
    let share = |value: f32| if is_observed { json!(value) } else { Value::Null };
    let observed = if is_observed {
        format!(
            "Somebody comes to a place within ten minutes with {:.0} % (at most {:.0} %); {:.0} % is accepted.",
            100.0 * step.presence,
            100.0 * step.presence_high,
            100.0 * threshold
        )
    } else {
        "Nothing was observed there: how often somebody comes is not known.".to_owned()
    };
    Answer {
        question: "wet-or-dry",
        answer: format!("Clean zone {} {word}: {why}. {observed}", zone.name),
        confidence: confidence.name(),
        evidence: vec![
            watched(&profile, zone),
            model_words(model, zone),
            format!("as of {}", model.calendar.words(now)),
        ],
        details: json!({
            "zone": zone.name, "clean": word, "observed": is_observed,
            "presence": share(step.presence), "presence_high": share(step.presence_high),
            "threshold": threshold, "drying_minutes": 10, "watched_hours": profile.watched_hours,
        }),
    }
}

fn dirt(model: &Model, now: WallTime) -> Answer {
    let mut ranked: Vec<(Zone, ZoneDirt)> = Vec::new();
    let mut unseen = 0_usize;
    for zone in model.zones_or_tiles() {
        let expected = zone_dirt(model, &zone, now);
        if expected.known > 0 { ranked.push((zone, expected)) } else { unseen += 1 }
    }
    ranked.sort_by(|(a, x), (b, y)| {
        (y.units / y.area_m2).total_cmp(&(x.units / x.area_m2)).then_with(|| a.name.cmp(&b.name))
    });
    if ranked.is_empty() {
        return unknown("dirt", "any zone");
    }
    let measured: usize = ranked.iter().map(|(_, expected)| expected.measured).sum();
    let known: usize = ranked.iter().map(|(_, expected)| expected.known).sum();
    let confidence = if 2 * measured >= known { Confidence::Fair } else { Confidence::Guess };
    let words: Vec<String> = ranked
        .iter()
        .take(3)
        .map(|(zone, expected)| {
            format!("{} ({:.1} units on {:.0} m²)", zone.name, expected.units, expected.area_m2)
        })
        .collect();
    Answer {
        question: "dirt",
        answer: format!("Most dirt for its size is expected in {}.", words.join(", then ")),
        confidence: confidence.name(),
        evidence: vec![dirt_source(model, measured, known), format!("{unseen} zones not watched")],
        details: json!({
            "at": model.calendar.iso(now),
            "zones": ranked.iter().map(|(zone, expected)| json!({
                "zone": zone.name, "expected_units": expected.units, "area_m2": expected.area_m2,
                "places": expected.places, "measured_places": expected.measured,
            })).collect::<Vec<_>>(),
        }),
    }
}
