//! Ctrl-C ends a campaign in order: no new block begins, and what is done stays done.

use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::facts::facts;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag::{register, register_conditional_shutdown};

/// What shells say of a program that an interrupt has ended.
pub const INTERRUPTED: i32 = 130;

/// Stands after the first Ctrl-C, or after the TERM of a machine that shuts down; the second one ends the program at once.
pub fn flag() -> io::Result<Arc<AtomicBool>> {
    let flag = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        // In this order: the first one finds the flag down and raises it.
        register_conditional_shutdown(signal, INTERRUPTED, Arc::clone(&flag))?;
        register(signal, Arc::clone(&flag))?;
    }
    Ok(flag)
}

/// Where the campaign stands, and how it goes on.
pub fn words((name, seed): (&str, u64), done: u64, trials: u64) -> String {
    format!(
        "{name}: interrupted after {done} of {trials} trials, without a finding so far; go on with:\n  \
         {} campaign {name} --trials {trials} --seed {seed} --same-program",
        facts().command
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::Ordering;

    /// Without the handler the signal would end this test.
    #[test]
    fn interrupt_raises_the_flag_only() {
        let flag = flag().unwrap();
        for signal in [SIGINT, SIGTERM] {
            flag.store(false, Ordering::Relaxed);
            signal_hook::low_level::raise(signal).unwrap();
            assert!(flag.load(Ordering::Relaxed), "{signal}");
        }
    }
}
