//! People in pictures by any detector that the user brings as an ONNX file (feature `onnx`): boxes for maps without people.
//!
//! A picture is fitted into the model's frame ([`Letterbox`]), the output is read in the layout of YOLOX or of YOLOv8 and
//! YOLO11 ([`Layout`]), boxes that show the same person are reduced to the best one, and a thread of its own ([`DetectorThread`])
//! keeps a slow model from holding up anything else.
#![forbid(unsafe_code)]

mod detector;
mod layout;
mod letterbox;
mod model;
#[cfg(feature = "onnx")]
mod onnx;
mod picture;
mod suppression;
mod worker;

pub use detector::{Detector, DetectorConfig, DetectorError};
pub use layout::{Candidate, Layout, LayoutError};
pub use letterbox::{Letterbox, Placing};
pub use model::{Model, ModelError, ModelOutput};
#[cfg(feature = "onnx")]
pub use onnx::OnnxModel;
pub use picture::{RgbPicture, SizeError};
pub use suppression::suppress;
pub use worker::{DetectorThread, Found, WorkerCounts};
