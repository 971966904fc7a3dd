//! A small network that finds people in pictures of 160 × 128: five steps of convolutions and three grids of boxes, as YOLOX lays
//! them out (Ge et al. 2021).

use floorguard_detector::{Model, ModelError, ModelOutput};
use floorguard_types::random::Pcg32;

use super::convolution::{Convolution, ConvolutionForm, Planes};

/// Width and height of its frame, pixels.
pub const FRAME: [u32; 2] = [160, 128];
/// Steps of the grids, pixels.
pub const STRIDES: [usize; 3] = [8, 16, 32];
/// Numbers of a cell: place, size, objectness.
pub const CELL: usize = 5;
/// Objectness at the start: few cells hold a person.
const RARE: f32 = -4.0;
/// Input by output channels and step of the trunk.
const TRUNK: [(usize, usize, usize); 7] =
    [(3, 8, 2), (8, 16, 2), (16, 24, 2), (24, 24, 1), (24, 32, 2), (32, 48, 2), (48, 48, 1)];
/// After these layers of the trunk a grid is read.
const READ_AFTER: [usize; 3] = [3, 4, 6];

/// The network. Values of pixels are 0 to 255, blue, green, red, as YOLOX takes them.
#[derive(Clone, Debug)]
pub struct Network {
    /// The trunk, each layer followed by a rectifier.
    pub trunk: Vec<Convolution>,
    /// One for each grid: place, size and objectness before the sigmoid.
    pub heads: Vec<Convolution>,
}

/// What a picture has made of the layers.
pub struct Passed {
    /// Input of each layer of the trunk, and the last answer.
    inputs: Vec<Planes>,
    /// Each grid.
    pub grids: Vec<Planes>,
}

/// Pixels become small numbers around zero within the first layer's input.
pub const PIXEL_SCALE: f32 = 1.0 / 128.0;

impl Network {
    /// With random weights.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let random = &mut Pcg32::new(seed, 77);
        let layer = |(into, out, step): (usize, usize, usize), random: &mut Pcg32| {
            Convolution::new(ConvolutionForm { out, into, side: 3, step }, 0.0, random)
        };
        let trunk: Vec<_> = TRUNK.into_iter().map(|sizes| layer(sizes, random)).collect();
        let heads = READ_AFTER.map(|layer| {
            let into = trunk[layer].form.out;
            let form = ConvolutionForm { out: CELL, into, side: 1, step: 1 };
            let mut head = Convolution::new(form, 0.0, random);
            head.weights.iter_mut().for_each(|weight| *weight *= 0.1);
            head.bias[CELL - 1] = RARE;
            head
        });
        Self { trunk, heads: heads.into() }
    }

    /// The grid that is read after a layer of the trunk, if one is.
    #[must_use]
    pub fn grid_after(layer: usize) -> Option<usize> {
        READ_AFTER.iter().position(|after| *after == layer)
    }

    /// Runs it on planes of 0 to 255.
    #[must_use]
    pub fn pass(&self, planes: &[f32]) -> Passed {
        let shape = [3, FRAME[1] as usize, FRAME[0] as usize];
        let first = Planes { shape, values: planes.iter().map(|value| value * PIXEL_SCALE).collect() };
        let mut passed = Passed { inputs: vec![first], grids: Vec::new() };
        for (number, layer) in self.trunk.iter().enumerate() {
            let mut next = layer.forward(&passed.inputs[number]);
            next.values.iter_mut().for_each(|value| *value = value.max(0.0));
            if let Some(grid) = Self::grid_after(number) {
                passed.grids.push(self.heads[grid].forward(&next));
            }
            passed.inputs.push(next);
        }
        passed
    }

    /// Adds the gradients of all weights for those of the grids.
    pub fn learn(&mut self, passed: &Passed, slopes: &[Planes]) {
        let mut back: Option<Planes> = None;
        for number in (0..self.trunk.len()).rev() {
            let answer = &passed.inputs[number + 1];
            if let Some(grid) = Self::grid_after(number) {
                let of_head = self.heads[grid].backward(answer, &slopes[grid]);
                match &mut back {
                    Some(back) => {
                        back.values.iter_mut().zip(&of_head.values).for_each(|(sum, more)| *sum += more);
                    }
                    None => back = Some(of_head),
                }
            }
            let Some(mut slope) = back.take() else { continue };
            // What the rectifier cut has no slope.
            slope.values.iter_mut().zip(&answer.values).for_each(|(slope, value)| {
                if *value <= 0.0 {
                    *slope = 0.0;
                }
            });
            back = Some(self.trunk[number].backward(&passed.inputs[number], &slope));
        }
    }

    /// A step of all weights against their gradient of so many pictures; a gradient longer than 5 is shortened.
    pub fn descend(&mut self, rate: f32, pictures: usize) {
        let layers = || self.trunk.iter().chain(&self.heads);
        let mean = 1.0 / pictures.max(1) as f32;
        let length = mean * libm::sqrtf(layers().map(Convolution::gradient_squared).sum());
        let scale = mean * if length > 5.0 { 5.0 / length } else { 1.0 };
        for layer in self.trunk.iter_mut().chain(&mut self.heads) {
            layer.descend(rate, scale);
        }
    }
}

/// 1 / (1 + e^−x).
#[must_use]
pub fn sigmoid(value: f32) -> f32 {
    1.0 / (1.0 + libm::expf(-value))
}

impl Model for Network {
    fn frame(&self) -> [u32; 2] {
        FRAME
    }

    /// As the file does: a row for each cell with place, size, objectness, and 1 for the only class.
    fn run(&mut self, planes: Vec<f32>) -> Result<ModelOutput, ModelError> {
        let mut values = Vec::new();
        for grid in self.pass(&planes).grids {
            let area = grid.shape[1] * grid.shape[2];
            for cell in 0..area {
                values.extend((0..CELL - 1).map(|number| grid.values[number * area + cell]));
                values.extend([sigmoid(grid.values[(CELL - 1) * area + cell]), 1.0]);
            }
        }
        Ok(ModelOutput { shape: vec![1, values.len() / (CELL + 1), CELL + 1], values })
    }
}
