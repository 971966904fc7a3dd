//! The `[[field]]` sections: zones that are long enough for their speed, and leave no speed out.

use floorguard_runtime::configuration::{DirectionOfTravel, FieldPair, Geometry, Limits, Polygon};
use floorguard_types::capacities::FIELD_SETS_MAX;

use super::polygon;
use super::reader::Reader;

/// Scanner response, two scans of 40 ms (book, Guard: Field length).
const SCANNER_RESPONSE_S: f32 = 0.08;
/// General tolerance of the scanner, metres (Z_G; book, Guard: Field length).
const SCANNER_TOLERANCE_M: f32 = 0.10;
/// Reserve for brake wear, share of the braking distance (Z_B; book, Guard: Field length).
const BRAKE_WEAR: f32 = 0.10;

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

pub(super) fn read_fields(
    top: &Reader<'_>,
    geometry: &Option<Geometry>,
    limits: &Limits,
) -> heapless::Vec<FieldPair, FIELD_SETS_MAX> {
    let mut fields = heapless::Vec::new();
    let mut last = top.span().clone();
    for section in top.sections("field") {
        let span = section.span().clone();
        last = span.clone();
        if let Some(field) = read_field(section, geometry.as_ref(), limits)
            && fields.push(field).is_err()
        {
            top.refuse(
                &span,
                format!("more than {FIELD_SETS_MAX} fields"),
                "remove speed bins that are not needed",
            );
        }
    }
    if top.good_so_far() {
        check_cover((top, &last), &fields, (DirectionOfTravel::Forward, "forward"), limits.speed_mps);
        check_cover((top, &last), &fields, (DirectionOfTravel::Reverse, "reverse"), limits.reverse_mps);
    }
    fields
}

/// Every speed that the robot may drive needs a field.
pub(super) fn check_cover(
    (top, last): (&Reader<'_>, &std::ops::Range<usize>),
    fields: &[FieldPair],
    direction: (DirectionOfTravel, &str),
    speed_mps: f32,
) {
    let of_direction = fields.iter().filter(|field| field.direction == direction.0);
    let covered_mps = of_direction.map(|field| field.speed_max_mps).fold(0.0, f32::max);
    if covered_mps < speed_mps {
        top.refuse(
            last,
            format!(
                "[[field]]: {} fields end at {covered_mps} m/s, the limit is {speed_mps} m/s",
                direction.1
            ),
            "add a field for the higher speeds or lower the limit",
        );
    }
}

pub(super) fn read_field(
    section: Reader<'_>,
    geometry: Option<&Geometry>,
    limits: &Limits,
) -> Option<FieldPair> {
    let directions = [("forward", DirectionOfTravel::Forward), ("reverse", DirectionOfTravel::Reverse)];
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
        check_zone(&section, &span, (direction, speed_max_mps, protective), (geometry, limits));
    }
    section.finish();
    Some(FieldPair { direction: direction?, speed_max_mps, protective: protective?, warning: warning? })
}

/// A zone must enclose the body and reach as far as the robot needs to stop.
pub(super) fn check_zone(
    section: &Reader<'_>,
    span: &std::ops::Range<usize>,
    (direction, speed_mps, protective): (DirectionOfTravel, f32, &Polygon),
    (geometry, limits): (&Geometry, &Limits),
) {
    if polygon::covers(&geometry.footprint, protective) {
        section.refuse(span, "the protective zone lies inside the footprint", "let it reach beyond the body");
        return;
    }
    if !polygon::covers(protective, &geometry.footprint) {
        section.refuse(span, "the protective zone does not enclose the footprint", "include the whole body");
        return;
    }
    let (zone, body) = (polygon::x_extent_m(protective), polygon::x_extent_m(&geometry.footprint));
    let reach_m = match direction {
        DirectionOfTravel::Forward => zone.1 - body.1,
        DirectionOfTravel::Reverse => body.0 - zone.0,
    };
    let driven_mps = match direction {
        DirectionOfTravel::Forward => speed_mps.min(limits.speed_mps),
        DirectionOfTravel::Reverse => speed_mps.min(limits.reverse_mps),
    };
    let needed_m = field_length_m(driven_mps, limits);
    if reach_m + 1.0e-3 < needed_m {
        section.refuse(
            span,
            format!("the protective zone reaches {reach_m:.2} m ahead; stopping from {driven_mps} m/s takes {needed_m:.2} m"),
            "lengthen the zone or lower speed_max_mps",
        );
    }
}

/// Field length ahead of the body that a speed needs (without retro-reflectors and ground clearance; book, Guard: Field
/// length).
pub(super) fn field_length_m(speed_mps: f32, limits: &Limits) -> f32 {
    let braking_m = speed_mps * speed_mps / (2.0 * limits.braking_mps2);
    speed_mps * (SCANNER_RESPONSE_S + limits.response_s)
        + braking_m * (1.0 + BRAKE_WEAR)
        + SCANNER_TOLERANCE_M
}
