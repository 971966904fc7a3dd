//! How tasks and rings talk: latest values and bounded queues. What a late reader loses is counted, never silent.

mod latest;
mod queue;
mod slot_queue;

pub use latest::Latest;
pub use queue::Queue;
pub use slot_queue::SlotQueue;
