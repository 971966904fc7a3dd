//! How tasks and rings talk: latest values and bounded queues. What a late reader loses is counted, never silent.

mod latest;
mod queue;

pub use latest::Latest;
pub use queue::Queue;
