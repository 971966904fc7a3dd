//! Drawings upon a picture: closed rectangles along the axes are boxes, words at their corner say class and score.

use floorguard_types::time::Stamp;
use serde_json::Value;

use super::boxes::{DetectedBox, Detections};
use super::protobuf::{Fields, number, pair};
use crate::cdr::Decoder;

/// A line or polygon.
#[derive(Clone, Debug, Default)]
struct Outline {
    stamp: Option<Stamp>,
    /// 2: closed, 3: open; others are no outline.
    shape: u64,
    corners_px: Vec<[f64; 2]>,
}

/// Words at a place.
#[derive(Clone, Debug, Default)]
struct Words {
    place_px: [f64; 2],
    text: String,
}

/// `foxglove.ImageAnnotations`, as far as it can be boxes.
#[derive(Clone, Debug, Default)]
pub struct Annotations {
    outlines: Vec<Outline>,
    words: Vec<Words>,
}

const CLOSED: u64 = 2;
const OPEN: u64 = 3;
/// Corners on one edge may differ by this, pixels.
const EDGE_PX: f64 = 1.0;
/// Words belong to a box whose upper left corner is this near, pixels.
const WORDS_PX: f64 = 24.0;

impl Annotations {
    /// The boxes; a picture without a time of its own bears that of the message. `None` for a time before 1970.
    pub fn boxes(self, published: Stamp) -> Option<Detections> {
        let stamp = self.outlines.iter().find_map(|outline| outline.stamp).unwrap_or(published);
        let boxes = self.outlines.iter().filter_map(Outline::edges).map(|edges_px| {
            let near = self.words.iter().find(|words| words.is_at(edges_px));
            let (class, score) = near.map_or((String::new(), 1.0), Words::class_and_score);
            DetectedBox { class, score, edges_px }
        });
        Some(Detections { stamp, boxes: boxes.collect() })
    }
}

impl Outline {
    fn edges(&self) -> Option<[f64; 4]> {
        let corners = match (self.shape, &self.corners_px[..]) {
            (CLOSED, [a, b, c, d]) => [*a, *b, *c, *d],
            (CLOSED | OPEN, [a, b, c, d, e]) if libm::hypot(a[0] - e[0], a[1] - e[1]) < EDGE_PX => {
                [*a, *b, *c, *d]
            }
            _ => return None,
        };
        let least = |axis: usize| corners.iter().map(|corner| corner[axis]).fold(f64::INFINITY, f64::min);
        let most = |axis: usize| corners.iter().map(|corner| corner[axis]).fold(f64::NEG_INFINITY, f64::max);
        let edges = [least(0), least(1), most(0), most(1)];
        let on_edge = |corner: &[f64; 2]| {
            let near =
                |value: f64, low: f64, high: f64| (value - low).abs().min((value - high).abs()) < EDGE_PX;
            near(corner[0], edges[0], edges[2]) && near(corner[1], edges[1], edges[3])
        };
        corners.iter().all(on_edge).then_some(edges)
    }
}

impl Words {
    fn is_at(&self, [left, top, right, _]: [f64; 4]) -> bool {
        let [x, y] = self.place_px;
        (left - WORDS_PX..=right).contains(&x) && (y - top).abs() <= WORDS_PX
    }

    /// `person 0.87`, `person: 87%`, `person`.
    fn class_and_score(&self) -> (String, f64) {
        let words: Vec<&str> =
            self.text.split([' ', ':', '(', ')', ',']).filter(|word| !word.is_empty()).collect();
        let value = |word: &str| match word.strip_suffix('%') {
            Some(share) => share.parse::<f64>().ok().map(|share| 0.01 * share),
            None => word.parse::<f64>().ok(),
        };
        let score = words.iter().find_map(|word| value(word)).filter(|score| (0.0..=1.0).contains(score));
        let class = words.iter().find(|word| value(word).is_none());
        (class.map_or_else(String::new, |class| (*class).to_owned()), score.unwrap_or(1.0))
    }
}

fn stamp_of(seconds: i64, nanoseconds: i64) -> Option<Stamp> {
    let (seconds, nanoseconds) = (u64::try_from(seconds).ok()?, u64::try_from(nanoseconds).ok()?);
    let micros = seconds.checked_mul(1_000_000)?.checked_add(nanoseconds / 1_000)?;
    (micros > 0).then(|| Stamp::from_micros(micros))
}

/// `foxglove_msgs/msg/ImageAnnotations`.
pub fn annotations_cdr(message: &[u8]) -> Option<Annotations> {
    let mut decoder = Decoder::new(message)?;
    let mut found = Annotations::default();
    for _ in 0..decoder.length()? {
        // A circle: time, place, diameter, thickness, two colours.
        let _time = (decoder.i32()?, decoder.u32()?);
        let _circle: [f64; 12] = decoder.f64s()?;
    }
    for _ in 0..decoder.length()? {
        let stamp = stamp_of(i64::from(decoder.i32()?), i64::from(decoder.u32()?));
        let shape = u64::from(decoder.u8()?);
        let corners = (0..decoder.length()?).map(|_| decoder.f64s::<2>()).collect::<Option<Vec<_>>>()?;
        let _colour: [f64; 4] = decoder.f64s()?;
        for _ in 0..decoder.length()? {
            let _colour: [f64; 4] = decoder.f64s()?;
        }
        let _fill_and_thickness: [f64; 5] = decoder.f64s()?;
        found.outlines.push(Outline { stamp, shape, corners_px: corners });
    }
    for _ in 0..decoder.length()? {
        let _time = (decoder.i32()?, decoder.u32()?);
        let (place_px, text) = (decoder.f64s::<2>()?, decoder.text()?);
        let _size_and_colours: [f64; 9] = decoder.f64s()?;
        found.words.push(Words { place_px, text });
    }
    Some(found)
}

/// The same as JSON.
pub fn annotations_json(message: &[u8]) -> Option<Annotations> {
    let whole: Value = serde_json::from_slice(message).ok()?;
    let list = |name: &str| whole.get(name).and_then(Value::as_array).cloned().unwrap_or_default();
    let place = |value: &Value| Some([value.get("x")?.as_f64()?, value.get("y")?.as_f64()?]);
    let time = |value: &Value| {
        let time = value.get("timestamp")?;
        stamp_of(time.get("sec")?.as_i64()?, time.get("nsec").and_then(Value::as_i64).unwrap_or(0))
    };
    let mut found = Annotations::default();
    for each in list("points") {
        let corners = each.get("points")?.as_array()?.iter().map(place).collect::<Option<Vec<_>>>()?;
        // A number, or the name that Protocol Buffers write.
        let shape = each.get("type").map_or(0, |shape| match shape.as_str() {
            Some("LINE_LOOP") => CLOSED,
            Some("LINE_STRIP") => OPEN,
            _ => shape.as_u64().unwrap_or(0),
        });
        found.outlines.push(Outline { stamp: time(&each), shape, corners_px: corners });
    }
    for each in list("texts") {
        let text = each.get("text").and_then(Value::as_str).unwrap_or_default().to_owned();
        found.words.push(Words { place_px: place(each.get("position")?)?, text });
    }
    Some(found)
}

/// The same as Protocol Buffers.
pub fn annotations_protobuf(message: &[u8]) -> Option<Annotations> {
    let mut found = Annotations::default();
    for field in Fields::of(message) {
        let field = field?;
        match field.number {
            2 => found.outlines.push(outline(field.bytes?)?),
            3 => found.words.push(words(field.bytes?)?),
            _ => {}
        }
    }
    Some(found)
}

fn outline(message: &[u8]) -> Option<Outline> {
    let mut outline = Outline::default();
    for field in Fields::of(message) {
        let field = field?;
        match (field.number, field.bytes) {
            (1, Some(time)) => {
                let [seconds, nanoseconds] = [1, 2].map(|wanted| number(time, wanted).unwrap_or(0));
                outline.stamp = stamp_of(i64::try_from(seconds).ok()?, i64::try_from(nanoseconds).ok()?);
            }
            (2, None) => outline.shape = field.value,
            (3, Some(point)) => outline.corners_px.push(pair(point)?),
            _ => {}
        }
    }
    Some(outline)
}

fn words(message: &[u8]) -> Option<Words> {
    let mut words = Words::default();
    for field in Fields::of(message) {
        let field = field?;
        match (field.number, field.bytes) {
            (2, Some(point)) => words.place_px = pair(point)?,
            (3, Some(text)) => words.text = String::from_utf8_lossy(text).into_owned(),
            _ => {}
        }
    }
    Some(words)
}
