//! A picture of any size in the frame of a model: scaled alike in both directions, the rest grey.

use floorguard_types::sensing::Pixel;

use super::picture::RgbPicture;

/// Where the picture lies in the frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Placing {
    /// In the upper left corner, as YOLOX has it.
    Corner,
    /// In the middle, as YOLOv8 and YOLO11 have it.
    Middle,
}

/// How pixels of the picture become pixels of the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Letterbox {
    from: [u32; 2],
    to: [u32; 2],
    /// Pixels of the frame for one of the picture.
    scale: f32,
    /// Width and height of the picture in the frame, pixels.
    shown: [u32; 2],
    /// Empty columns on the left and rows above, pixels.
    margin: [u32; 2],
}

/// Grey of what is empty, of both families.
const EMPTY: f32 = 114.0;

impl Letterbox {
    /// Of pictures of a size into a frame; sides are at least 1.
    ///
    /// ```
    /// use floorguard_detector::{Letterbox, Placing};
    ///
    /// // 1280 × 720 in 640 × 640: half the size, 140 empty rows above and below.
    /// let middle = Letterbox::new([1_280, 720], [640, 640], Placing::Middle);
    /// let pixel = middle.to_picture([0.0, 140.0]);
    /// assert_eq!((pixel.column, pixel.row), (0.0, 0.0));
    /// let pixel = middle.to_picture([320.0, 320.0]);
    /// assert_eq!((pixel.column, pixel.row), (640.0, 360.0));
    /// ```
    #[must_use]
    pub fn new(from: [u32; 2], to: [u32; 2], placing: Placing) -> Self {
        let share = |axis: usize| to[axis].max(1) as f32 / from[axis].max(1) as f32;
        let scale = share(0).min(share(1));
        let shown = [0, 1].map(|axis: usize| {
            let side = from[axis] as f32 * scale;
            // YOLOX cuts off, the others round.
            let side = if placing == Placing::Corner { side.floor() } else { side.round() };
            (side as u32).clamp(1, to[axis])
        });
        let margin = match placing {
            Placing::Corner => [0, 0],
            // Ultralytics rounds half a pixel less a tenth: to the left and above.
            Placing::Middle => [0, 1]
                .map(|axis: usize| (0.5 * (to[axis] - shown[axis]) as f32 - 0.1).round().max(0.0) as u32),
        };
        Self { from, to, scale, shown, margin }
    }

    /// A place of the frame in the picture, pixels; within the picture.
    #[must_use]
    pub fn to_picture(&self, [column, row]: [f32; 2]) -> Pixel {
        let back = |value: f32, axis: usize| {
            ((value - self.margin[axis] as f32) / self.scale).clamp(0.0, self.from[axis] as f32)
        };
        Pixel { column: back(column, 0), row: back(row, 1) }
    }

    /// The picture in the frame, as three planes of `to` width × height. `channels` says which of red (0), green (1), blue (2)
    /// each plane holds, `factor` multiplies values of 0 to 255. Values between pixels are linear in both directions, with the
    /// middles of pixels half a pixel from their edges (as OpenCV's `INTER_LINEAR`), rounded to whole values.
    #[must_use]
    pub fn fill(&self, picture: &RgbPicture, channels: [usize; 3], factor: f32) -> Vec<f32> {
        let [width, height] = self.to.map(|side| side as usize);
        let mut planes = vec![EMPTY * factor; 3 * width * height];
        let step = [0, 1].map(|axis: usize| self.from[axis] as f32 / self.shown[axis] as f32);
        for row in 0..self.shown[1] {
            let (above, down) = split((row as f32 + 0.5) * step[1] - 0.5);
            for column in 0..self.shown[0] {
                let (left, across) = split((column as f32 + 0.5) * step[0] - 0.5);
                let corners = [(0, 0), (1, 0), (0, 1), (1, 1)]
                    .map(|(right, below)| picture.at(left + right, above + below).map(f32::from));
                let at = (row + self.margin[1]) as usize * width + (column + self.margin[0]) as usize;
                for (plane, channel) in channels.into_iter().enumerate() {
                    let upper = corners[0][channel] + across * (corners[1][channel] - corners[0][channel]);
                    let lower = corners[2][channel] + across * (corners[3][channel] - corners[2][channel]);
                    planes[plane * width * height + at] = (upper + down * (lower - upper)).round() * factor;
                }
            }
        }
        planes
    }
}

/// The pixel before a place, and how far behind it the place is.
fn split(place: f32) -> (i64, f32) {
    let before = place.floor();
    (before as i64, place - before)
}
