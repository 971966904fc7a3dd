//! A word on the progress now and then, where no bar is shown.

use std::io::IsTerminal as _;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::ProgressBar;

/// Without a terminal the progress is printed this often; the thread looks this often whether it is over.
const HEARTBEAT: Duration = Duration::from_secs(10);
const LOOK: Duration = Duration::from_millis(100);

/// Says now and then how far the missions are, where no bar is shown: a mission among many people takes minutes.
pub(super) struct Heartbeat {
    done: Arc<AtomicU64>,
    ended: Arc<AtomicBool>,
}

impl Heartbeat {
    /// Begins to tell, until it is dropped.
    pub(super) fn start(missions: u64) -> Self {
        let heartbeat = Self { done: Arc::default(), ended: Arc::default() };
        if std::io::stderr().is_terminal() {
            return heartbeat;
        }
        let (done, ended) = (Arc::clone(&heartbeat.done), Arc::clone(&heartbeat.ended));
        std::thread::spawn(move || {
            let (began, mut next) = (Instant::now(), HEARTBEAT);
            while !ended.load(Ordering::Relaxed) {
                std::thread::sleep(LOOK);
                if began.elapsed() >= next {
                    next += HEARTBEAT;
                    let done = done.load(Ordering::Relaxed);
                    say!("  {:.0} s: {done} of {missions} missions", began.elapsed().as_secs_f64());
                }
            }
        });
        heartbeat
    }

    /// A mission more is done.
    pub(super) fn count(&self, bar: &ProgressBar) {
        self.done.fetch_add(1, Ordering::Relaxed);
        bar.inc(1);
    }
}

impl Drop for Heartbeat {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
    }
}
