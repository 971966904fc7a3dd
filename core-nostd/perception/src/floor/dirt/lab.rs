//! Perceptual colour: CIELAB from sRGB, by table.
//!
//! Distances in Lab are differences that one sees, so one threshold fits dark and bright floor. The curves of both
//! steps are tables: no power and no root for a pixel. Source: book, Floor and dirt: Lab colours.

use floorguard_types::number::{exact_usize, nearest_f32};

/// Lightness 0..=100, green to red, blue to yellow.
pub type Lab = [f32; 3];

/// Steps of the table of cube roots.
const ROOT_STEPS: usize = 1_024;
/// 2²³: the smallest number whose neighbours are one apart.
const WHOLE: f32 = 8_388_608.0;
/// Bits of a step, and of the one that white rounds to.
const MASK: u32 = 2_047;
/// Below this the cube root is replaced by a line (CIE 1976).
const LINEAR_BELOW: f32 = 0.008_856;
/// sRGB to XYZ, each row over the white point (book, Floor and dirt: Lab colours).
const TO_WHITE: [[f32; 3]; 3] = [
    [0.412_453 / 0.950_456, 0.357_580 / 0.950_456, 0.180_423 / 0.950_456],
    [0.212_671, 0.715_160, 0.072_169],
    [0.019_334 / 1.088_754, 0.119_193 / 1.088_754, 0.950_227 / 1.088_754],
];

/// The curves of both steps as tables. Built once at start, at most 0.06 from the formula.
#[derive(Clone, Debug)]
pub struct LabTables {
    /// sRGB's curve: byte to linear light 0..=1.
    linear: [f32; 256],
    /// Cube root at the start of each step, and its rise over the step.
    roots: [[f32; 2]; ROOT_STEPS + 1],
}

impl Default for LabTables {
    fn default() -> Self {
        let (mut linear, mut roots) = ([0.0; 256], [[0.0; 2]; ROOT_STEPS + 1]);
        for (byte, slot) in linear.iter_mut().enumerate() {
            let c = nearest_f32(byte) / 255.0;
            *slot = if c <= 0.04045 { c / 12.92 } else { libm::powf((c + 0.055) / 1.055, 2.4) };
        }
        let root = |step: usize| libm::cbrtf(nearest_f32(step) / nearest_f32(ROOT_STEPS));
        for (step, slot) in roots.iter_mut().enumerate() {
            *slot = [root(step), root(step.saturating_add(1)) - root(step)];
        }
        Self { linear, roots }
    }
}

impl LabTables {
    /// Lab of one sRGB pixel.
    #[inline]
    #[must_use]
    pub fn lab(&self, [red, green, blue]: [u8; 3]) -> Lab {
        let linear = |byte: u8| self.linear.get(usize::from(byte)).copied().unwrap_or(0.0);
        let (r, g, b) = (linear(red), linear(green), linear(blue));
        let [[xr, xg, xb], [yr, yg, yb], [zr, zg, zb]] = TO_WHITE;
        let x = self.curve(xr * r + xg * g + xb * b);
        let y = self.curve(yr * r + yg * g + yb * b);
        let z = self.curve(zr * r + zg * g + zb * b);
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    #[inline]
    fn curve(&self, t: f32) -> f32 {
        let place = t * nearest_f32(ROOT_STEPS);
        // Adding 2²³ leaves the nearest whole number in the low bits; half a step less makes it the step before. On the
        // border of two steps both give the same root.
        let shifted = place + (WHOLE - 0.5);
        let step = shifted - WHOLE;
        let [start, rise] =
            self.roots.get(exact_usize(shifted.to_bits() & MASK)).copied().unwrap_or_default();
        if t > LINEAR_BELOW { start + rise * (place - step) } else { 7.787 * t + 16.0 / 116.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The test values of the book, Floor and dirt: Lab colours.
    #[test]
    fn published_vectors() {
        let vectors = [
            ([255, 0, 0], [53.2406, 80.0942, 67.2015]),
            ([0, 128, 0], [46.2277, -51.6976, 49.8957]),
            ([128, 128, 128], [53.585, 0.0, 0.0]),
            ([64, 32, 200], [30.1367, 59.0945, -79.8878]),
            ([10, 10, 10], [2.7418, 0.0, 0.0]),
        ];
        for (rgb, expected) in vectors {
            let found = LabTables::default().lab(rgb);
            let error = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(error < 0.05, "{rgb:?}: {found:?}, not {expected:?}");
        }
    }

    /// Every 17th value of every channel against the formula in double precision.
    #[test]
    fn tables_follow_the_formula() {
        let linear = |byte: u8| {
            let c = f64::from(byte) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        };
        let curve = |t: f64| if t > 0.008_856 { t.cbrt() } else { 7.787 * t + 16.0 / 116.0 };
        let tables = LabTables::default();
        let mut worst = 0.0_f64;
        for index in 0..4_096_u16 {
            let byte = |shift: u16| ((index >> shift) & 15) as u8 * 17;
            let (r, g, b) = (linear(byte(8)), linear(byte(4)), linear(byte(0)));
            let x = curve((0.412_453 * r + 0.357_580 * g + 0.180_423 * b) / 0.950_456);
            let y = curve(0.212_671 * r + 0.715_160 * g + 0.072_169 * b);
            let z = curve((0.019_334 * r + 0.119_193 * g + 0.950_227 * b) / 1.088_754);
            let exact = [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)];
            for (found, exact) in tables.lab([byte(8), byte(4), byte(0)]).into_iter().zip(exact) {
                worst = worst.max((f64::from(found) - exact).abs());
            }
        }
        assert!(worst < 0.06, "{worst}");
    }

    /// OpenCV 5.0, `cvtColor` of eight bits, RGB to Lab, for every combination of six values.
    const OPENCV: &str = concat!(
        "00808003886b13a74b2ab53740c32552cf141d699120747c2a8f5938a54149b82b5ac6195956a959599b5d6879637d5c",
        "6c934177a72c8946b88a48af8c51938f607795725b9b8543b837c7b838c1b93eaabb4990bf5774c4675ce02ad3e02bcf",
        "e12fbce337a4e5438ae95072098f850c98711ba9512fb63b43c42755cf16247b942680802f935d3ca7434cb92d5cc71a",
        "5b5caa5b609c5f6d7a65805d6e954278a82c8a4ab88b4cb08d549490627796755b9c8743b839c7b93ac1ba40abbc4a90",
        "c05974c4685ce02cd3e12ccfe131bde338a5e6448ae951722ea79c2fa88736b06242ba4751c6305fd11d3b99a23c9b8d",
        "42a3694bb04d58bd3465ca206576ae6578a16880806d8e63759e477fae31905bbb905cb3926397956e7a9b7e5ea18e46",
        "bc45c9bc46c3bd4bacbf5492c36176c76f5ee334d5e335d0e439bee640a6e84b8ceb57744eb6ac4fb79953bb755ac257",
        "65cb3d70d52856aeae56ae9d5ab37961bb5b6ac54075cf2b7490b57491a97796897b9f6b82ab508ab7389a72c09a72b7",
        "9b779c9e8080a38c64a9994cc257ccc358c6c45cb0c66396c96e7acd7b62e843d7e844d3e947c1ea4da9ed578ef06276",
        "6dc4b96dc5aa70c78775cc687cd34c85db3572beba73bfab75c2897ac76b81cf4f89d73888a7be88a8b48aab958eb177",
        "94ba5b9ac343a78ac6a88bbea98fa4ac9588b09e6cb5a853cc6ed0cc6ecbcd72b5cf779bd28080d68a68ef56daef57d6",
        "f05ac5f15fadf46793f7707b88d0c388d0b78ad2968ed67893dc5b9ae2438bccc38cccb88ecf9891d27a97d85d9ddf45",
        "9db9c79dbabd9ebca1a1c183a6c767abcf4eb7a0cdb7a0c6b8a3adbba791beae75c3b65cd783d5d884d0d986bcda8ba2",
        "dd9287e19a6ef86adff86bdaf96dc9fa71b2fc7898ff8080",
    );

    /// OpenCV's integer tables are up to 2.5 steps off the formula, so most agree to half a step and all to its error.
    #[test]
    fn equals_opencv_to_its_rounding() {
        const VALUES: [u8; 6] = [0, 37, 96, 150, 205, 255];
        let tables = LabTables::default();
        let (mut close, mut worst) = (0, 0.0_f32);
        for index in 0..216 {
            let found = tables.lab([VALUES[index / 36], VALUES[index / 6 % 6], VALUES[index % 6]]);
            let [l, a, b] = found;
            for (channel, value) in [l * 2.55, a + 128.0, b + 128.0].into_iter().enumerate() {
                let place = 6 * index + 2 * channel;
                let byte = u8::from_str_radix(&OPENCV[place..place + 2], 16).unwrap();
                let error = (value - f32::from(byte)).abs();
                worst = worst.max(error);
                close += u32::from(error < 0.6);
            }
        }
        assert!(worst < 1.5 && close > 600, "{worst} at worst, {close} of 648 to half a step");
    }
}
