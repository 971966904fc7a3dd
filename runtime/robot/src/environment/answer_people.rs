//! Where people walk in some hours of the week.

use floorguard_mapping::environment::{Confidence, Evidence, PLACE_CELL_M, Rate};
use serde_json::json;

use super::answer::{Answer, unknown};
use super::model::Model;
use super::question::WeekHours;

/// Places named in the answer.
const NAMED: usize = 5;

/// What was seen of a place in the hours asked for.
struct Seen {
    index: usize,
    evidence: Evidence,
    rate: Rate,
}

/// Places that were watched in these hours, the busiest first.
fn watched(model: &Model, hours: &WeekHours) -> Vec<Seen> {
    let grid = model.core.places.grid();
    let mut seen: Vec<Seen> = Vec::new();
    for (index, place) in grid.values().iter().enumerate() {
        let mut evidence = Evidence::default();
        for (bin, hour) in place.week.bins().iter().zip(0_u8..) {
            if hours.contains(hour) {
                evidence.visits += f32::from(bin.visits);
                evidence.hours += bin.watched_ds as f32 / 36_000.0;
            }
        }
        if evidence.hours > 0.0 {
            let rate = Rate::with_doubt(evidence.visits / evidence.hours, evidence.hours, place.spread());
            seen.push(Seen { index, evidence, rate });
        }
    }
    seen.sort_by(|a, b| b.rate.per_hour.total_cmp(&a.rate.per_hour).then(a.index.cmp(&b.index)));
    seen
}

pub fn people(model: &Model, hours: &WeekHours) -> Answer {
    let grid = model.core.places.grid();
    let seen = watched(model, hours);
    let Some(busiest) = seen.first() else {
        return unknown("people", &format!("the floor {}", hours.words()));
    };
    let zones = model.zones_or_tiles();
    let named = |index: usize| {
        let middle = grid.geometry().centre(index);
        let zone =
            zones.iter().find(|zone| zone.contains(middle)).map_or("outside all zones", |zone| &zone.name);
        (zone.to_owned(), middle)
    };
    let walked: Vec<&Seen> = seen.iter().filter(|place| place.evidence.visits > 0.0).collect();
    let words: Vec<String> = walked
        .iter()
        .take(NAMED)
        .map(|place| {
            let (zone, middle) = named(place.index);
            format!(
                "{zone} around ({:.0} m, {:.0} m) with {:.0} an hour",
                middle.x_m, middle.y_m, place.rate.per_hour
            )
        })
        .collect();
    let text = if words.is_empty() {
        format!("Nobody was seen {}.", hours.words())
    } else {
        format!("People walk {} mostly through {}.", hours.words(), words.join("; "))
    };
    let mean_hours = seen.iter().map(|place| place.evidence.hours).sum::<f32>() / seen.len() as f32;
    Answer {
        question: "people",
        answer: text,
        confidence: busiest.rate.confidence().max(Confidence::Guess).name(),
        evidence: vec![
            format!(
                "{} of {} places of {PLACE_CELL_M} m watched in these hours, {mean_hours:.1} hours each on average; the others are unknown, not empty",
                seen.len(),
                grid.geometry().cell_count()
            ),
            format!("people passed {} places", walked.len()),
        ],
        details: json!({
            "from_hour": hours.from, "to_hour": hours.to, "days": hours.days, "watched_hours": mean_hours,
            "places": walked.iter().map(|place| {
                let (zone, middle) = named(place.index);
                json!({
                    "zone": zone, "x_m": middle.x_m, "y_m": middle.y_m, "visits_per_hour": place.rate.per_hour,
                    "interval95": [place.rate.low, place.rate.high], "visits": place.evidence.visits,
                    "watched_hours": place.evidence.hours, "confidence": place.rate.confidence().name(),
                })
            }).collect::<Vec<_>>(),
        }),
    }
}
