//! How a model writes its boxes: as YOLOX (Ge et al. 2021), or as YOLOv8 and YOLO11 (Jocher et al. 2023).

use super::letterbox::Placing;
use super::model::ModelOutput;

/// Steps of the three grids, pixels of the frame.
const STRIDES: [u32; 3] = [8, 16, 32];

/// The layout of an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// A row for each cell of the grids: offsets and logarithms of the size in steps of the grid, objectness, classes.
    Yolox,
    /// A column for each cell: middle and size in pixels, classes.
    YoloV8,
}

/// A box before suppression, pixels of the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// Left, upper, right, lower edge.
    pub edges: [f32; 4],
    /// 0 to 1.
    pub score: f32,
}

/// The output has neither layout.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the model's output is {shape:?}; for a frame of {}×{} YOLOX has 1 × {cells} × (5 + classes), YOLOv8 and YOLO11 1 × (4 + classes) \
     × {cells}", frame[0], frame[1]
)]
pub struct LayoutError {
    /// Of the output.
    pub shape: Vec<usize>,
    /// Of the model, pixels.
    pub frame: [u32; 2],
    /// Cells of the three grids.
    pub cells: usize,
}

fn cells([width, height]: [u32; 2]) -> usize {
    STRIDES.iter().map(|stride| (width / stride) as usize * (height / stride) as usize).sum()
}

impl Layout {
    /// The layout of an output of a model with a frame.
    ///
    /// ```
    /// use floorguard_detector::Layout;
    ///
    /// assert_eq!(Layout::of(&[1, 8_400, 85], [640, 640]), Ok(Layout::Yolox));
    /// assert_eq!(Layout::of(&[1, 84, 8_400], [640, 640]), Ok(Layout::YoloV8));
    /// assert!(Layout::of(&[1, 1_000], [224, 224]).is_err());
    /// ```
    ///
    /// # Errors
    /// Neither fits.
    pub fn of(shape: &[usize], frame: [u32; 2]) -> Result<Self, LayoutError> {
        let cells = cells(frame);
        match *shape {
            [1, rows, columns] if rows == cells && columns > 5 => Ok(Self::Yolox),
            [1, rows, columns] if columns == cells && rows > 4 => Ok(Self::YoloV8),
            _ => Err(LayoutError { shape: shape.to_vec(), frame, cells }),
        }
    }

    /// Where pictures lie in the frame.
    #[must_use]
    pub const fn placing(self) -> Placing {
        match self {
            Self::Yolox => Placing::Corner,
            Self::YoloV8 => Placing::Middle,
        }
    }

    /// Order of the colours (0 red, 1 green, 2 blue) and factor of the values.
    #[must_use]
    pub const fn colours(self) -> ([usize; 3], f32) {
        match self {
            Self::Yolox => ([2, 1, 0], 1.0),
            Self::YoloV8 => ([0, 1, 2], 1.0 / 255.0),
        }
    }

    /// Boxes of a class with at least a score; empty for a class that the model lacks. Cost: the cells once.
    #[must_use]
    pub fn candidates(
        self,
        output: &ModelOutput,
        frame: [u32; 2],
        (class, score_min): (usize, f32),
    ) -> Vec<Candidate> {
        let cells = cells(frame);
        let width = output.values.len() / cells.max(1);
        let value = |cell: usize, index: usize| {
            let at = match self {
                Self::Yolox => cell * width + index,
                Self::YoloV8 => index * cells + cell,
            };
            output.values.get(at).copied().unwrap_or(f32::NAN)
        };
        let head = if self == Self::Yolox { 5 } else { 4 };
        if head + class >= width {
            return Vec::new();
        }
        let mut found = Vec::new();
        for (cell, place) in grid(frame).enumerate() {
            let sure = if self == Self::Yolox { value(cell, 4) } else { 1.0 };
            let score = sure * value(cell, head + class);
            // Also false for a NaN.
            let is_sure = score >= score_min;
            if !is_sure {
                continue;
            }
            let [a, b, c, d] = [0, 1, 2, 3].map(|index| value(cell, index));
            let [x, y, across, down] = match self {
                Self::Yolox => place.placed([a, b, c, d]),
                Self::YoloV8 => [a, b, c, d],
            };
            let edges = [x - 0.5 * across, y - 0.5 * down, x + 0.5 * across, y + 0.5 * down];
            if edges.iter().all(|edge| edge.is_finite()) {
                found.push(Candidate { edges, score });
            }
        }
        found
    }
}

/// A cell of a grid.
struct Cell {
    column: f32,
    row: f32,
    stride: f32,
}

impl Cell {
    /// Middle and size, pixels of the frame.
    fn placed(&self, [x, y, across, down]: [f32; 4]) -> [f32; 4] {
        let stride = self.stride;
        [
            (x + self.column) * stride,
            (y + self.row) * stride,
            libm::expf(across) * stride,
            libm::expf(down) * stride,
        ]
    }
}

/// The cells, finest grid first, row by row.
fn grid([width, height]: [u32; 2]) -> impl Iterator<Item = Cell> {
    STRIDES.into_iter().flat_map(move |stride| {
        (0..height / stride).flat_map(move |row| {
            (0..width / stride).map(move |column| Cell {
                column: column as f32,
                row: row as f32,
                stride: stride as f32,
            })
        })
    })
}
