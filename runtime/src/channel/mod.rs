//! How tasks and rings talk: latest values and bounded queues. What a late reader loses is counted, never silent.

mod belt;
mod latest;
mod queue;

pub use belt::Belt;
pub use latest::Latest;
pub use queue::Queue;
