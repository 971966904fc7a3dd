//! Any spinning lidar: one contract over the decoders of the makers.

mod any_decoder;
mod contract;
mod error;
mod straight_columns;

pub use any_decoder::{AnyDecoder, AnyDecoderOf};
pub use contract::LidarDecoder;
pub use error::LidarError;
pub use straight_columns::StraightColumns;
