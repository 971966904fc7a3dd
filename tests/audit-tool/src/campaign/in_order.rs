//! Work on all cores, handed out in its order.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use anyhow::Result;

/// What is behind a lock, whatever became of those who held it before.
pub fn held<T>(lock: &Mutex<T>) -> MutexGuard<'_, T> {
    lock.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Runs the parts on all cores, the first ones first, until `stop` stands: parts that are done then are the first ones, but
/// for those that were running. An error ends the others, too.
pub fn run<T: Send>(parts: Vec<T>, stop: &AtomicBool, part: impl Fn(T) -> Result<()> + Sync) -> Result<()> {
    let queue = Mutex::new(parts.into_iter());
    let next = || if stop.load(Ordering::Relaxed) { None } else { held(&queue).next() };
    let work = || -> Result<()> {
        while let Some(one) = next() {
            part(one).inspect_err(|_| stop.store(true, Ordering::Relaxed))?;
        }
        Ok(())
    };
    rayon::broadcast(|_| work()).into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::bail;

    /// Dealt out from the middle, as parallel iterators do, hundreds of parts would be done out of order.
    #[test]
    fn stopped_campaign_keeps_its_beginning() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(4).build().unwrap();
        let (done, stop) = (Mutex::new(Vec::new()), AtomicBool::new(false));
        let part = |number: u32| {
            held(&done).push(number);
            if number == 300 {
                stop.store(true, Ordering::Relaxed);
            }
            // The others have their turn.
            std::thread::sleep(std::time::Duration::from_micros(50));
            Ok(())
        };
        pool.install(|| run((0..100_000).collect(), &stop, part)).unwrap();
        let mut done = done.into_inner().unwrap();
        done.sort_unstable();
        assert!((301..100_000).contains(&done.len()), "{} parts", done.len());
        assert!(done.iter().copied().eq(0..done.len() as u32), "a part was left out");
    }

    #[test]
    fn error_is_reported_and_ends_the_others() {
        let stop = AtomicBool::new(false);
        let failed = run(vec![1, 2, 3], &stop, |number| if number == 1 { bail!("full") } else { Ok(()) });
        assert_eq!(failed.unwrap_err().to_string(), "full");
        assert!(stop.load(Ordering::Relaxed));
    }
}
