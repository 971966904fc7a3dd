//! A small detector of people, trained on rendered pictures: so that the chain from pictures to maps runs without foreign weights.
//! Of real people it knows nothing.

mod convolution;
mod loss;
mod network;
#[cfg(feature = "detector")]
mod onnx_file;
mod pictures;
mod training;

pub use convolution::{Convolution, ConvolutionForm, Planes};
pub use network::Network;
#[cfg(feature = "detector")]
pub use onnx_file::onnx_file;
pub use pictures::{LabelledPerson, LabelledPicture, rendered_pictures};
pub use training::{DetectorQuality, DetectorTraining, judge_detector, train_detector};

#[cfg(test)]
mod tests;
