//! The action `clean`: a part of the floor that the vehicle cleans at a node of an order. The standard names no such action; this one is
//! the maker's own, and the factsheet says so (VDA 5050 2.1.0, chapters 6.8 and 6.15).

use serde_json::{Value, json};

use super::messages::Action;
use super::vehicle::{Cleaning, CleaningPlace, CleaningPromise};

/// Its name.
pub const CLEAN_ACTION: &str = "clean";
/// Corners of an area at most.
const CORNERS_MAX: usize = 32;
/// Corners lie within this distance of the map's origin, metres.
const FAR_M: f64 = 2_000.0;
/// Units of dirt that an order may tolerate at most.
const TOLERATED_MAX: f64 = 50.0;
/// Confidence that an order may ask for.
const CONFIDENCE: std::ops::RangeInclusive<f64> = 0.5..=0.999_9;
/// Longest cleaning, seconds.
const LONGEST_S: f64 = 86_400.0;
/// What an order may say.
const KEYS: [&str; 4] = ["area", "toleratedUnits", "confidence", "maxDuration"];

/// The cleaning of an action, and after how many seconds it is given up.
///
/// # Errors
/// What is wrong with it, in words.
pub fn cleaning_of(action: &Action, number: u32) -> Result<(CleaningPlace, f64), String> {
    if let Some(other) = action.action_parameters.iter().find(|one| !KEYS.contains(&one.key.as_str())) {
        return Err(format!("{} is no parameter of clean; it knows {}", other.key, KEYS.join(", ")));
    }
    if action.blocking_type != "HARD" {
        return Err(format!(
            "clean drives by itself: its blockingType is HARD, not {}",
            action.blocking_type
        ));
    }
    let number_within = |key: &str, limits: std::ops::RangeInclusive<f64>| {
        let Some(value) = action.value(key) else { return Ok(None) };
        match value.as_f64().filter(|number| limits.contains(number)) {
            Some(number) => Ok(Some(number)),
            None => Err(format!("{key} is {value}; it goes from {} to {}", limits.start(), limits.end())),
        }
    };
    let tolerated = number_within("toleratedUnits", 0.0..=TOLERATED_MAX)?;
    if let Some(units) = tolerated.filter(|units| units.fract() != 0.0) {
        return Err(format!("toleratedUnits is {units}; write a whole number"));
    }
    let place = CleaningPlace {
        number,
        corners_m: action.value("area").map(corners_of).transpose()?.unwrap_or_default(),
        tolerated_units: tolerated.map(|units| units as u8),
        confidence: number_within("confidence", CONFIDENCE)?,
        goes_on: false,
    };
    let longest_s = number_within("maxDuration", 1.0..=LONGEST_S)?;
    Ok((place, longest_s.unwrap_or(LONGEST_S)))
}

/// Corners of a polygon; two stand for a rectangle along the axes of the map.
fn corners_of(area: &Value) -> Result<Vec<[f64; 2]>, String> {
    let wrong = || {
        format!(
            "area is {area}; write corners in metres of the map, [[x, y], [x, y], ...]: 3 to {CORNERS_MAX} of a polygon, or 2 \
             opposite ones of a rectangle"
        )
    };
    let corner = |value: &Value| -> Option<[f64; 2]> {
        let pair = value.as_array().filter(|pair| pair.len() == 2)?;
        let [x_m, y_m] = [pair.first()?.as_f64()?, pair.get(1)?.as_f64()?];
        [x_m, y_m].iter().all(|metres| metres.abs() <= FAR_M).then_some([x_m, y_m])
    };
    let corners: Option<Vec<[f64; 2]>> = area.as_array().ok_or_else(wrong)?.iter().map(corner).collect();
    let corners = corners.ok_or_else(wrong)?;
    match corners.as_slice() {
        [[ax, ay], [bx, by]] if ax != bx && ay != by => {
            Ok(vec![[*ax, *ay], [*bx, *ay], [*bx, *by], [*ax, *by]])
        }
        [_, _, _, ..] if corners.len() <= CORNERS_MAX => Ok(corners),
        _ => Err(wrong()),
    }
}

/// Why a vehicle does not clean as an action says.
pub fn refused_cleaning(action: &Action, cleaning: &Cleaning) -> Option<String> {
    match cleaning {
        Cleaning::Refused(why) => Some(why.clone()),
        Cleaning::Offered(_) => cleaning_of(action, 0).err(),
    }
}

/// The action in the factsheet. `blockingTypes` is left out: the schema of 2.1.0 lets no list of them be valid.
pub fn described(promise: CleaningPromise) -> Value {
    let CleaningPromise { tolerated_units, confidence } = promise;
    let parameter = |key: &str, kind: &str, words: String| json!({"key": key, "valueDataType": kind, "description": words, "isOptional": true});
    json!({
        "actionType": CLEAN_ACTION,
        "actionDescription": "cleans a part of the floor, driving by itself; blockingType HARD only",
        "actionScopes": ["NODE"],
        "actionParameters": [
            parameter("area", "ARRAY", "corners [[x, y], ...] in metres of the map: a polygon, or 2 opposite corners of a \
                rectangle; without it the whole floor".to_owned()),
            parameter("toleratedUnits", "INTEGER", format!("units of dirt that may stay in a cell of 0.1 x 0.1 m; without it {tolerated_units}")),
            parameter("confidence", "NUMBER", format!("probability with which a clean cell holds no more; without it {confidence}")),
            parameter("maxDuration", "NUMBER", "seconds after which it is given up; a pause does not count".to_owned()),
        ],
        "resultDescription": "cells that were dirty, cells that are guaranteed clean, metres driven; with FAILED why",
    })
}
