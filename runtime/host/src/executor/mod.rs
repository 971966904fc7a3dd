//! What makes the tasks run on Linux: a deterministic task set, a thread-local clock, and an epoll loop.
//!
//! The same task set serves two worlds. In the real one each ring has a thread with an epoll loop
//! ([`run_until`]); in the virtual one a single thread moves the clock by hand and polls until
//! nothing is ready. There are no global task pools, so that many simulations can run side by side.

mod clock;
mod lateness;
mod priority;
mod priority_lock;
mod reactor;
mod real_loop;
mod task_set;

pub use clock::{advance_virtual, next_timer_us, use_real_clock, use_virtual_clock};
pub use lateness::{Lateness, LatenessFigures};
pub use priority::{Ring, grants_real_time, take_priority};
pub use priority_lock::PriorityLock;
pub use reactor::Source;
pub use real_loop::{PollObserver, RingObserver, StopFlag, run_until, run_until_observed};
pub use task_set::{SpinningTask, TaskSet};
