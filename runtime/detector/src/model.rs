//! What a detector needs of a model: planes in, numbers out.

/// What a model answers.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelOutput {
    /// Sizes of its dimensions.
    pub shape: Vec<usize>,
    /// Its numbers, the last dimension fastest.
    pub values: Vec<f32>,
}

/// Why a model cannot be used or run.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ModelError {
    /// The file cannot be read, or is no model.
    #[error("no usable ONNX model: {0}")]
    NoModel(String),
    /// The input is no picture.
    #[error("the model's input is {0}; one picture is expected: 1 × 3 × height × width")]
    Input(String),
    /// It stopped while it ran.
    #[error("the model cannot be run: {0}")]
    Run(String),
}

/// A model. Frames are planes of three colours, height × width each.
pub trait Model: Send {
    /// Width and height of its frame, pixels.
    fn frame(&self) -> [u32; 2];

    /// Runs it once.
    ///
    /// # Errors
    /// See [`ModelError`].
    fn run(&mut self, planes: Vec<f32>) -> Result<ModelOutput, ModelError>;
}
