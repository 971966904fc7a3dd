//! ONNX models by `rten`, a runtime in Rust alone.

use std::path::Path;

use rten::{Dimension, Model as RtenModel, NodeId, Value};
use rten_tensor::prelude::*;
use rten_tensor::{NdTensor, Tensor};

use super::model::{Model, ModelError, ModelOutput};

/// A model from a file.
pub struct OnnxModel {
    model: RtenModel,
    input: NodeId,
    output: NodeId,
    frame: [u32; 2],
}

/// Frame of a model that leaves its size open, pixels.
const OPEN_FRAME: u32 = 640;
/// Larger frames are no detector's.
const SIDE_MAX: usize = 8_192;

impl OnnxModel {
    /// Loads a file.
    ///
    /// # Errors
    /// It cannot be read, is no ONNX, uses operators that the runtime lacks, or takes no picture.
    pub fn load(path: &Path) -> Result<Self, ModelError> {
        let model = RtenModel::load_file(path).map_err(|error| ModelError::NoModel(error.to_string()))?;
        let shape = model.input_shape(0).ok_or_else(|| ModelError::Input("missing".to_owned()))?;
        let described = || {
            let sizes: Vec<String> = shape
                .iter()
                .map(|side| match side {
                    Dimension::Fixed(size) => size.to_string(),
                    Dimension::Symbolic(name) => name.clone(),
                })
                .collect();
            ModelError::Input(sizes.join(" × "))
        };
        let side = |dimension: &Dimension| match dimension {
            Dimension::Fixed(size) if (32..=SIDE_MAX).contains(size) => u32::try_from(*size).ok(),
            Dimension::Fixed(_) => None,
            Dimension::Symbolic(_) => Some(OPEN_FRAME),
        };
        let [batch, colours, height, width] = &shape[..] else { return Err(described()) };
        let is_one = !matches!(batch, Dimension::Fixed(size) if *size != 1);
        let is_colour = !matches!(colours, Dimension::Fixed(size) if *size != 3);
        let (Some(width), Some(height), true) = (side(width), side(height), is_one && is_colour) else {
            return Err(described());
        };
        let first = |ids: &[NodeId]| ids.first().copied().ok_or_else(described);
        let (input, output) = (first(model.input_ids())?, first(model.output_ids())?);
        Ok(Self { model, input, output, frame: [width, height] })
    }
}

impl Model for OnnxModel {
    fn frame(&self) -> [u32; 2] {
        self.frame
    }

    fn run(&mut self, planes: Vec<f32>) -> Result<ModelOutput, ModelError> {
        let [width, height] = self.frame.map(|side| side as usize);
        if planes.len() != 3 * width * height {
            return Err(ModelError::Run(format!("{} numbers for {width} × {height} × 3", planes.len())));
        }
        let input = NdTensor::from_data([1, 3, height, width], planes);
        let ran = self.model.run(vec![(self.input, Value::from(input).into())], &[self.output], None);
        let mut answers = ran.map_err(|error| ModelError::Run(error.to_string()))?;
        let first = answers.pop().ok_or_else(|| ModelError::Run("no answer".to_owned()))?;
        let tensor: Tensor<f32> =
            first.try_into().map_err(|_| ModelError::Run("the answer is no list of floats".to_owned()))?;
        Ok(ModelOutput { shape: tensor.shape().to_vec(), values: tensor.to_vec() })
    }
}
