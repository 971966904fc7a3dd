//! The `[[field]]` sections: zones that a user adds to those that follow from body and limits.
//!
//! Nobody needs to draw any: what the body sweeps until it stands is computed for every direction. A zone that is drawn must
//! contain that, and applies up to its speed.

use std::ops::Range;

use floorguard_guard::{OVERSPEED_SHARE, Travel, Zone, contains, swept_outline};
use floorguard_runtime::configuration::{DirectionOfTravel, FieldPair, Geometry, Limits, Polygon};
use floorguard_types::capacities::FIELD_SETS_MAX;

use super::polygon;
use super::reader::Reader;

/// Speeds up to which zones are computed, m/s, below the one for the limit.
const SPEED_BINS_MPS: [f32; 2] = [0.3, 0.6];
/// A robot that never goes backwards still rolls back a little, m/s.
const ROLLS_BACK_MPS: f32 = 0.05;

type Fields = heapless::Vec<FieldPair, FIELD_SETS_MAX>;

pub(super) fn read_polygon(section: &Reader<'_>, key: &'static str) -> Option<Polygon> {
    let (points, span) = section.points(key)?;
    match polygon::checked(&points) {
        Ok(polygon) => Some(polygon),
        Err(reason) => {
            section.refuse(&span, format!("`{key}`: {reason}"), "give 3 to 16 corners, counter-clockwise");
            None
        }
    }
}

pub(super) fn read_fields(top: &Reader<'_>, geometry: &Option<Geometry>, limits: &Limits) -> Fields {
    let mut fields = Fields::new();
    let mut last = top.span().clone();
    for section in top.sections("field") {
        let span = section.span().clone();
        last = span.clone();
        if let Some(field) = read_field(section, geometry.as_ref(), limits) {
            add((top, &span), &mut fields, field);
        }
    }
    if let (true, Some(geometry)) = (top.good_so_far(), geometry) {
        for field in computed(&fields, geometry, limits) {
            add((top, &last), &mut fields, field);
        }
    }
    fields
}

fn add((top, span): (&Reader<'_>, &Range<usize>), fields: &mut Fields, field: FieldPair) {
    if fields.push(field).is_err() {
        top.refuse(
            span,
            format!("more than {FIELD_SETS_MAX} fields, those included that follow from body and limits"),
            "remove speed bins that are not needed",
        );
    }
}

/// The zones of all speeds for which none is drawn.
fn computed(drawn: &[FieldPair], geometry: &Geometry, limits: &Limits) -> Vec<FieldPair> {
    let fastest_mps = OVERSPEED_SHARE * limits.speed_mps;
    let forward = SPEED_BINS_MPS.into_iter().filter(|bin| *bin < fastest_mps).chain([fastest_mps]);
    let back_mps = OVERSPEED_SHARE * limits.reverse_mps.max(ROLLS_BACK_MPS);
    let bins = forward.map(|mps| (DirectionOfTravel::Forward, mps));
    let bins = bins.chain([(DirectionOfTravel::Reverse, back_mps)]);
    let is_open = |(direction, mps): &(DirectionOfTravel, f32)| {
        !drawn.iter().any(|field| field.direction == *direction && field.speed_max_mps >= *mps)
    };
    let field = |(direction, speed_max_mps)| {
        let zone = |zone| zone_of((direction, speed_max_mps), (geometry, limits), zone);
        FieldPair {
            direction,
            speed_max_mps,
            protective: zone(Zone::Protective),
            warning: zone(Zone::Warning),
        }
    };
    bins.filter(is_open).map(field).collect()
}

/// What the body sweeps in a direction up to a speed.
fn zone_of(
    (direction, speed_mps): (DirectionOfTravel, f32),
    (geometry, limits): (&Geometry, &Limits),
    zone: Zone,
) -> Polygon {
    let drive = limits.drive(geometry);
    swept_outline(&geometry.footprint, &drive, (direction.travel(), speed_mps), zone)
}

fn read_field(section: Reader<'_>, geometry: Option<&Geometry>, limits: &Limits) -> Option<FieldPair> {
    let directions = [
        ("forward", DirectionOfTravel::Forward),
        ("reverse", DirectionOfTravel::Reverse),
        ("left", DirectionOfTravel::Left),
        ("right", DirectionOfTravel::Right),
        ("spin", DirectionOfTravel::Spin),
    ];
    let direction = section.choice("direction", &directions);
    let speed_max_mps = section.number("speed_max_mps", 0.05..=2.5);
    let protective = read_polygon(&section, "protective_m");
    let warning = read_polygon(&section, "warning_m");
    let span = section.find("protective_m").map_or(section.span().clone(), |value| value.span());
    if let (Some(protective), Some(warning)) = (&protective, &warning)
        && !polygon::covers(warning, protective)
    {
        section.refuse(
            &span,
            "the protective zone reaches beyond its warning zone",
            "make the warning zone larger",
        );
    }
    if section.good_so_far()
        && let (Some(direction), Some(protective), Some(geometry)) = (direction, &protective, geometry)
    {
        check_zone((&section, &span), (direction, speed_max_mps, protective), (geometry, limits));
    }
    section.finish();
    Some(FieldPair { direction: direction?, speed_max_mps, protective: protective?, warning: warning? })
}

/// A zone must contain all that the body sweeps until it stands.
fn check_zone(
    (section, span): (&Reader<'_>, &Range<usize>),
    (direction, speed_mps, protective): (DirectionOfTravel, f32, &Polygon),
    (geometry, limits): (&Geometry, &Limits),
) {
    let needed = zone_of((direction, speed_mps), (geometry, limits), Zone::Protective);
    if contains(protective, &needed) {
        return;
    }
    let reach_m = |polygon: &[floorguard_types::geometry::Point2]| match direction.travel() {
        Travel::Reverse => -polygon::x_extent_m(polygon).0,
        _ => polygon::x_extent_m(polygon).1,
    };
    let (given_m, needed_m) = (reach_m(protective), reach_m(&needed));
    let corners: Vec<String> =
        needed.iter().map(|corner| format!("[{:.2}, {:.2}]", corner.x_m, corner.y_m)).collect();
    let what = if given_m < needed_m - 1.0e-3 {
        let body_m = reach_m(&geometry.footprint);
        format!(
            "the protective zone reaches {:.2} m beyond the body; stopping from {speed_mps} m/s takes {:.2} m",
            given_m - body_m,
            needed_m - body_m
        )
    } else {
        format!("the protective zone leaves out what the body sweeps until it stands from {speed_mps} m/s")
    };
    section.refuse(span, what, format!("let it contain {}, or leave it out", corners.join(" ")));
}
