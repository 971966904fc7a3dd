//! The safety scanner's telegrams.

use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_time::Timer;
use embedded_io_async::Read;
use floorguard_core::guard::{FaultKind, Source};
use floorguard_drivers::s300::{Event, Receiver};

use crate::clock;
use crate::shared::Shared;

/// At 500 kBd 1 ms is 50 bytes: a read takes what is there.
const PORTION_BYTES: usize = 128;
/// Pause after a failure of the line, milliseconds.
const RETRY_MS: u64 = 20;

/// Guard ring. Runs for ever.
pub async fn scanner_input<M: RawMutex>(shared: &Shared<M>, mut line: impl Read, mut receiver: Receiver) {
    let mut portion = [0; PORTION_BYTES];
    loop {
        let count = match line.read(&mut portion).await {
            Ok(count) if count > 0 => count,
            Ok(_) | Err(_) => {
                shared.count(|links| links.scanner_errors = links.scanner_errors.saturating_add(1));
                shared.decide(|guard| {
                    guard.on_source_fault(Source::Scanner, FaultKind::LinkDown, clock::now())
                });
                Timer::after_millis(RETRY_MS).await;
                continue;
            }
        };
        let now = clock::now();
        let bytes = portion.get(..count).unwrap_or_default();
        receiver.push(bytes, now, |event| match event {
            Event::Scan(scan) => {
                shared.decide(|guard| guard.on_scan(scan, now));
                shared.scans.push(|slot| slot.copy_from(scan));
                shared.scan.publish(scan.clone());
            }
            Event::StandBy { .. } => {
                shared.decide(|guard| guard.on_source_fault(Source::Scanner, FaultKind::StandBy, now));
            }
            Event::Refused(_) => {
                shared.count(|links| links.scanner_refused = links.scanner_refused.saturating_add(1));
            }
        });
    }
}
