//! Recordings of every kind: what is in them, their rows, and what the robot's stages make of them.

mod arguments;
mod decode;
mod decode_can;
mod decode_inertial;
mod findings;
mod frame_tree;
mod ground;
mod inspect;
mod replay;

pub use arguments::{DecodeArguments, ModelArgument, ReplayArguments};
pub use decode::{decode_to, run as decode};
pub(crate) use findings::say_findings;
pub(crate) use frame_tree::{FrameTree, flat, is_base};
pub use ground::{GroundArguments, run as eval_ground};
pub use inspect::{InspectArguments, run as inspect};
pub use replay::run as replay;
pub(crate) use replay::{MCAP_MAGIC, cloud_number, is_capture, is_log, not_for_us};
