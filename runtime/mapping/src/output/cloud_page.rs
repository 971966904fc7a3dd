//! Two clouds as one page that turns them in space: everything is in the file, nothing is loaded, no WebGL is needed.

use std::fmt::Write as _;

use floorguard_types::geometry::Point3;

/// The page around the clouds; words in double braces are replaced.
const PAGE: &str = include_str!("cloud_page.html");
/// More points of a kind are thinned evenly: a page of some megabytes opens everywhere.
const POINTS_MAX: usize = 300_000;
/// Steps of a coordinate.
const STEPS: f32 = 65_535.0;

/// What the page shows.
#[derive(Clone, Copy, Debug)]
pub struct CloudPage<'a> {
    /// Heading.
    pub title: &'a str,
    /// Lines of figures above the clouds.
    pub figures: &'a [(&'a str, String)],
    /// Points that stay, in the map; coloured by height.
    pub kept: &'a [Point3],
    /// Points that were removed; red, in the left view only.
    pub removed: &'a [Point3],
    /// Points seen where something was removed; green, in the right view only.
    pub filled: &'a [Point3],
    /// Height of the floor in the map, metres.
    pub floor_m: f32,
}

/// The page. Cost: 8 letters a point.
///
/// ```
/// use floorguard_mapping_host::output::{CloudPage, cloud_page};
/// use floorguard_types::geometry::Point3;
///
/// let kept = [Point3::new(0.0, 0.0, 0.0), Point3::new(2.0, 1.0, 1.0)];
/// let page = cloud_page(&CloudPage {
///     title: "Hall <1>",
///     figures: &[("returns", "2".to_owned())],
///     kept: &kept,
///     removed: &[],
///     filled: &[],
///     floor_m: 0.0,
/// });
/// assert!(page.contains("Hall &lt;1&gt;") && page.contains("\"AAAAAAAA//////"));
/// assert!(!page.contains("{{") && !page.contains("http"));
/// ```
#[must_use]
pub fn cloud_page(page: &CloudPage<'_>) -> String {
    let frame = Frame::of([page.kept, page.removed, page.filled]);
    let mut figures = String::new();
    for (name, value) in page.figures {
        // Writing to a string cannot fail.
        let _ = write!(figures, "<li><b>{}</b>{}</li>", escaped(value), escaped(name));
    }
    let [x, y, z] = frame.low_m;
    let numbers = |values: [f32; 3]| format!("[{},{},{}]", values[0], values[1], values[2]);
    PAGE.replace("{{title}}", &escaped(page.title))
        .replace("{{figures}}", &figures)
        .replace("{{low}}", &numbers([x, y, z]))
        .replace("{{step}}", &numbers(frame.step_m))
        .replace("{{floor}}", &page.floor_m.to_string())
        .replace("{{kept}}", &frame.packed(page.kept))
        .replace("{{removed}}", &frame.packed(page.removed))
        .replace("{{filled}}", &frame.packed(page.filled))
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// The box around all points.
struct Frame {
    low_m: [f32; 3],
    step_m: [f32; 3],
}

fn coordinates(point: &Point3) -> [f32; 3] {
    [point.x_m, point.y_m, point.z_m]
}

impl Frame {
    fn of(clouds: [&[Point3]; 3]) -> Self {
        let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for point in clouds.into_iter().flatten() {
            for (axis, value) in coordinates(point).into_iter().enumerate().filter(|(_, v)| v.is_finite()) {
                low[axis] = low[axis].min(value);
                high[axis] = high[axis].max(value);
            }
        }
        let is_empty = low[0] > high[0];
        let (low, high) = if is_empty { ([0.0; 3], [1.0; 3]) } else { (low, high) };
        Self { low_m: low, step_m: [0, 1, 2].map(|axis| ((high[axis] - low[axis]) / STEPS).max(1.0e-6)) }
    }

    /// Three numbers of 16 bits a point, little-endian, as base 64 (RFC 4648).
    fn packed(&self, points: &[Point3]) -> String {
        let every = points.len().div_ceil(POINTS_MAX).max(1);
        let mut bytes = Vec::with_capacity(6 * points.len() / every + 6);
        for point in points.iter().step_by(every) {
            for (axis, value) in coordinates(point).into_iter().enumerate() {
                let step = ((value - self.low_m[axis]) / self.step_m[axis]).round().clamp(0.0, STEPS);
                bytes.extend((step as u16).to_le_bytes());
            }
        }
        base64(&bytes)
    }
}

/// Base 64 with padding.
pub(crate) fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let octet = |index: usize| u32::from(group.get(index).copied().unwrap_or(0));
        let bits = octet(0) << 16 | octet(1) << 8 | octet(2);
        for letter in 0..4 {
            let is_used = letter <= group.len();
            let index = (bits >> (18 - 6 * letter)) as usize & 63;
            text.push(if is_used { char::from(LETTERS[index]) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::base64;

    #[test]
    fn vectors_of_rfc_4648_hold() {
        let cases = [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")];
        for (plain, expected) in cases {
            assert_eq!(base64(plain.as_bytes()), expected);
        }
    }
}
