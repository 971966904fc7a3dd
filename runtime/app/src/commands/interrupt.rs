//! What asks a program to end: Ctrl-C, the TERM of systemd, and the HUP of a connection that is lost.

use std::thread;

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;

use floorguard_host::executor::StopFlag;

/// What shells say of a program that an interrupt has ended.
pub(super) const INTERRUPTED: i32 = 130;

/// The first Ctrl-C ends what goes on in order, with everything that it has to show until then; the second one at once.
///
/// # Errors
/// The system gives no handler.
pub(super) fn end_at_ctrl_c(ended: &StopFlag, what: &str) -> std::io::Result<()> {
    let (ended, what) = (ended.clone(), what.to_owned());
    at_interrupt(move || {
        if ended.is_stopped() {
            std::process::exit(INTERRUPTED);
        }
        ended.stop();
        say!("  Ctrl-C: {what}; again: at once");
    })
}

/// Calls `act` at each interrupt, on a thread of its own.
///
/// # Errors
/// The system gives no handler.
fn at_interrupt(mut act: impl FnMut() + Send + 'static) -> std::io::Result<()> {
    let mut wanted = vec![SIGINT, SIGTERM];
    // `nohup` requests it: the program is to outlive the connection.
    if !is_ignored(SIGHUP) {
        wanted.push(SIGHUP);
    }
    let mut signals = Signals::new(wanted)?;
    thread::Builder::new().name("interrupts".to_owned()).spawn(move || {
        for _ in signals.forever() {
            act();
        }
    })?;
    Ok(())
}

fn is_ignored(signal: i32) -> bool {
    std::fs::read_to_string("/proc/self/status").is_ok_and(|status| ignores(&status, signal))
}

/// Linux tells what a process ignores as a hexadecimal mask; its lowest bit stands for signal 1.
fn ignores(status: &str, signal: i32) -> bool {
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mask_marks_ignored_pixels() {
        let status = "Name:\tx\nSigBlk:\tffffffffffffffff\nSigIgn:\t0000000000001001\n";
        assert!(ignores(status, SIGHUP));
        assert!(!ignores(status, SIGINT));
        assert!(!ignores(status, SIGTERM));
        assert!(!ignores("", SIGHUP));
    }
}
