//! What a detector found in a picture, whatever message it stands in.

use floorguard_types::time::Stamp;

use super::annotations::{annotations_cdr, annotations_json, annotations_protobuf};
use crate::Recorded;
use crate::cdr::Decoder;

/// A box in a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct DetectedBox {
    /// What the detector takes it for; empty where it does not say.
    pub class: String,
    /// 0 to 1; 1 where it does not say.
    pub score: f64,
    /// Left, upper, right and lower edge, pixels.
    pub edges_px: [f64; 4],
}

/// All boxes of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Detections {
    /// Time of the picture.
    pub stamp: Stamp,
    /// The boxes.
    pub boxes: Vec<DetectedBox>,
}

fn kind(schema: &str) -> &str {
    schema.rsplit(['/', '.']).next().unwrap_or(schema)
}

/// Whether a message of this type can hold boxes.
#[must_use]
pub fn is_detections(schema: &str) -> bool {
    matches!(kind(schema), "Detection2DArray" | "ImageAnnotations")
}

/// The boxes of a message; `None` if it is damaged, or of another type or encoding.
#[must_use]
pub fn read_detections(message: &Recorded) -> Option<Detections> {
    match (kind(&message.schema), &*message.encoding) {
        ("Detection2DArray", "cdr") => detection_array(&message.data),
        ("ImageAnnotations", "cdr") => annotations_cdr(&message.data)?.boxes(message.published),
        ("ImageAnnotations", "json") => annotations_json(&message.data)?.boxes(message.published),
        ("ImageAnnotations", "protobuf") => annotations_protobuf(&message.data)?.boxes(message.published),
        _ => None,
    }
}

fn stamp(decoder: &mut Decoder<'_>) -> Option<Stamp> {
    let (seconds, nanoseconds) = (decoder.i32()?, decoder.u32()?);
    Some(Stamp::from_micros(u64::try_from(seconds).ok()? * 1_000_000 + u64::from(nanoseconds / 1_000)))
}

/// `vision_msgs/msg/Detection2DArray` of `vision_msgs` 4 (ROS 2 Humble and later).
fn detection_array(message: &[u8]) -> Option<Detections> {
    let mut decoder = Decoder::new(message)?;
    let of_array = stamp(&mut decoder)?;
    decoder.text()?;
    let count = decoder.length()?;
    let boxes = (0..count).map(|_| detection(&mut decoder)).collect::<Option<Vec<_>>>()?;
    Some(Detections { stamp: of_array, boxes })
}

/// The most likely of its hypotheses counts.
fn detection(decoder: &mut Decoder<'_>) -> Option<DetectedBox> {
    stamp(decoder)?;
    decoder.text()?;
    let (mut class, mut score) = (String::new(), f64::NEG_INFINITY);
    for _ in 0..decoder.length()? {
        let (named, rated) = (decoder.text()?, decoder.f64()?);
        let (_pose, _covariance): ([f64; 7], [f64; 36]) = (decoder.f64s()?, decoder.f64s()?);
        if rated > score {
            (class, score) = (named, rated);
        }
    }
    let [x, y, _theta, width, height] = decoder.f64s()?;
    let _id = decoder.text()?;
    let score = if score.is_finite() { score } else { 1.0 };
    let edges_px = [x - 0.5 * width, y - 0.5 * height, x + 0.5 * width, y + 0.5 * height];
    Some(DetectedBox { class, score, edges_px })
}
