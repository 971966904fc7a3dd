//! Boxes of people in the pictures of a panoramic camera, as a program beside sends them: one JSON object a datagram.

use floorguard_mapping::sliding_window::{PERSON_BOXES_MAX, PersonBox};
use serde::Deserialize;

/// A picture's boxes.
#[derive(Clone, Debug, PartialEq)]
pub struct ReceivedBoxes {
    /// How old the picture was when it was sent, microseconds.
    pub age_us: u64,
    /// The boxes, directions from the camera.
    pub boxes: Vec<PersonBox>,
}

/// Pictures older than this say nothing about now, seconds.
const AGE_MAX_S: f64 = 2.0;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Datagram {
    age_s: f64,
    boxes: Vec<[f32; 4]>,
}

/// Reads a datagram: `{"age_s": 0.05, "boxes": [[-0.1, 0.1, -0.7, 0.4]]}`, least and largest azimuth, least and largest elevation,
/// radians.
///
/// # Errors
/// In words, what is wrong with it.
pub fn read_boxes(bytes: &[u8]) -> Result<ReceivedBoxes, String> {
    let datagram: Datagram =
        serde_json::from_slice(bytes).map_err(|error| format!("boxes of people: {error}"))?;
    if !(0.0..=AGE_MAX_S).contains(&datagram.age_s) {
        return Err(format!("boxes of people: a picture {} s old, at most {AGE_MAX_S} s", datagram.age_s));
    }
    if datagram.boxes.len() > PERSON_BOXES_MAX {
        return Err(format!(
            "boxes of people: {} of a picture, at most {PERSON_BOXES_MAX}",
            datagram.boxes.len()
        ));
    }
    let boxes =
        datagram.boxes.iter().map(|[azimuth_min, azimuth_max, elevation_min, elevation_max]| PersonBox {
            azimuth_min_rad: *azimuth_min,
            azimuth_max_rad: *azimuth_max,
            elevation_min_rad: *elevation_min,
            elevation_max_rad: *elevation_max,
        });
    Ok(ReceivedBoxes { age_us: (datagram.age_s * 1.0e6) as u64, boxes: boxes.collect() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_datagrams_are_refused_with_reason() {
        let read = read_boxes(br#"{"age_s": 0.05, "boxes": [[-0.1, 0.1, -0.7, 0.4]]}"#).unwrap();
        assert_eq!((read.age_us, read.boxes[0].elevation_min_rad), (50_000, -0.7));
        let many = format!(r#"{{"age_s": 0, "boxes": [{}]}}"#, vec!["[0, 1, 0, 1]"; 17].join(","));
        for (wrong, reported) in [
            ("", "EOF"),
            ("{\"boxes\": []}", "age_s"),
            (r#"{"age_s": 3.0, "boxes": []}"#, "3 s old"),
            (r#"{"age_s": -1.0, "boxes": []}"#, "-1 s old"),
            (r#"{"age_s": 0.0, "boxes": [[1, 2, 3]]}"#, "invalid length"),
            (many.as_str(), "17 of a picture"),
        ] {
            let refused = read_boxes(wrong.as_bytes()).unwrap_err();
            assert!(refused.contains(reported), "{wrong}: {refused}");
        }
    }
}
