//! A convolution with its gradient, as sums over rows of an unfolded picture: plain loops that the compiler makes wide.

use floorguard_types::random::Pcg32;

/// Planes of numbers, each row by row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Planes {
    /// Channels, rows, columns.
    pub shape: [usize; 3],
    /// Their numbers.
    pub values: Vec<f32>,
}

impl Planes {
    /// All zero.
    #[must_use]
    pub fn zero(shape: [usize; 3]) -> Self {
        Self { shape, values: vec![0.0; shape.iter().product()] }
    }
}

/// Weights of a convolution, what their gradient sums up to, and their momentum.
#[derive(Clone, Debug)]
pub struct Convolution {
    /// Output channels, input channels, side of the kernel, step.
    pub form: ConvolutionForm,
    /// Output by input by row by column of the kernel.
    pub weights: Vec<f32>,
    /// One for each output channel.
    pub bias: Vec<f32>,
    gradient: [Vec<f32>; 2],
    momentum: [Vec<f32>; 2],
}

/// Sizes of a convolution. The rim is padded so that a step of 1 keeps rows and columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConvolutionForm {
    /// Channels out.
    pub out: usize,
    /// Channels in.
    pub into: usize,
    /// Side of the kernel: 1 or 3.
    pub side: usize,
    /// Step: 1 or 2.
    pub step: usize,
}

impl ConvolutionForm {
    /// Rows of the unfolded picture.
    const fn depth(self) -> usize {
        self.into * self.side * self.side
    }

    /// Padding of each rim.
    #[must_use]
    pub const fn pad(self) -> usize {
        self.side / 2
    }

    fn out_shape(self, [_, rows, columns]: [usize; 3]) -> [usize; 3] {
        [self.out, rows.div_ceil(self.step), columns.div_ceil(self.step)]
    }
}

impl Convolution {
    /// Normal weights whose sums keep their size behind a rectifier (He et al. 2015), and this bias.
    #[must_use]
    pub fn new(form: ConvolutionForm, bias: f32, random: &mut Pcg32) -> Self {
        let scale = libm::sqrtf(2.0 / form.depth() as f32);
        let count = form.out * form.depth();
        let weights = (0..count).map(|_| scale * random.normal()).collect();
        let zero = || [vec![0.0; count], vec![0.0; form.out]];
        Self { form, weights, bias: vec![bias; form.out], gradient: zero(), momentum: zero() }
    }

    /// The picture with every neighbour of a place below each other.
    fn unfold(&self, input: &Planes) -> Vec<f32> {
        let [_, rows, columns] = self.form.out_shape(input.shape);
        let mut unfolded = vec![0.0; self.form.depth() * rows * columns];
        self.each_row(input.shape, |to, from, (first, last, shift)| {
            for column in first..last {
                unfolded[to + column] =
                    input.values[from + column * self.form.step + shift - self.form.pad()];
            }
        });
        unfolded
    }

    /// Calls with the beginning of a row of the unfolded picture, of the input's row, and the columns that lie within it.
    fn each_row(
        &self,
        [_, in_rows, in_columns]: [usize; 3],
        mut each: impl FnMut(usize, usize, (usize, usize, usize)),
    ) {
        let ConvolutionForm { into, side, step, .. } = self.form;
        let (pad, rows, columns) = (self.form.pad(), in_rows.div_ceil(step), in_columns.div_ceil(step));
        for plane in 0..into * side * side {
            let (channel, down, shift) = (plane / (side * side), plane / side % side, plane % side);
            let first = usize::from(shift < pad);
            let last = columns.min((in_columns + pad - shift).div_ceil(step));
            for row in 0..rows {
                let Some(from) = (row * step + down).checked_sub(pad).filter(|row| *row < in_rows) else {
                    continue;
                };
                let to = (plane * rows + row) * columns;
                each(to, (channel * in_rows + from) * in_columns, (first, last, shift));
            }
        }
    }

    /// The answer.
    #[must_use]
    pub fn forward(&self, input: &Planes) -> Planes {
        let unfolded = self.unfold(input);
        let mut output = Planes::zero(self.form.out_shape(input.shape));
        let area = output.shape[1] * output.shape[2];
        let depth = self.form.depth();
        for (channel, plane) in output.values.chunks_mut(area).enumerate() {
            plane.fill(self.bias[channel]);
            for (weight, row) in
                self.weights[channel * depth..(channel + 1) * depth].iter().zip(unfolded.chunks(area))
            {
                plane.iter_mut().zip(row).for_each(|(sum, value)| *sum += weight * value);
            }
        }
        output
    }

    /// Adds the gradient of the weights for a gradient of the answer, and gives that of the input.
    pub fn backward(&mut self, input: &Planes, wanted: &Planes) -> Planes {
        let unfolded = self.unfold(input);
        let area = wanted.shape[1] * wanted.shape[2];
        let depth = self.form.depth();
        let mut back = vec![0.0; unfolded.len()];
        for (channel, plane) in wanted.values.chunks(area).enumerate() {
            self.gradient[1][channel] += plane.iter().sum::<f32>();
            for place in 0..depth {
                let row = &unfolded[place * area..(place + 1) * area];
                let index = channel * depth + place;
                self.gradient[0][index] +=
                    row.iter().zip(plane).map(|(value, slope)| value * slope).sum::<f32>();
                let weight = self.weights[index];
                let row = &mut back[place * area..(place + 1) * area];
                row.iter_mut().zip(plane).for_each(|(sum, slope)| *sum += weight * slope);
            }
        }
        let mut slopes = Planes::zero(input.shape);
        let (step, pad) = (self.form.step, self.form.pad());
        self.each_row(input.shape, |to, from, (first, last, shift)| {
            for column in first..last {
                slopes.values[from + column * step + shift - pad] += back[to + column];
            }
        });
        slopes
    }

    /// Sum of the squared gradient.
    #[must_use]
    pub fn gradient_squared(&self) -> f32 {
        self.gradient.iter().flatten().map(|one| one * one).sum()
    }

    /// One step against the gradient, scaled, with a momentum of 0.9 and a small decay of the weights; the gradient is zero
    /// afterwards.
    pub fn descend(&mut self, rate: f32, scale: f32) {
        let values = [&mut self.weights, &mut self.bias];
        let decays = [5.0e-4, 0.0];
        for (((values, gradient), momentum), decay) in
            values.into_iter().zip(&mut self.gradient).zip(&mut self.momentum).zip(decays)
        {
            for ((value, slope), speed) in values.iter_mut().zip(gradient).zip(momentum) {
                *speed = 0.9 * *speed - rate * (scale * *slope + decay * *value);
                *value += *speed;
                *slope = 0.0;
            }
        }
    }

    /// Gradient of a weight, for tests.
    #[must_use]
    pub fn weight_gradient(&self, index: usize) -> f32 {
        self.gradient[0][index]
    }
}
