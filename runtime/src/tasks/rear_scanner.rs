//! The second safety scanner, an S300 on a line of its own. The guard alone listens to it: people are not searched for in its scans.

use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_time::Timer;
use embedded_io_async::Read;
use floorguard_drivers::s300;
use floorguard_guard::{FaultKind, Source};

use super::scanner::{PORTION_BYTES, RETRY_MS, fault_of_telegram};
use crate::clock;
use crate::shared::Shared;

/// Guard ring. Runs for ever.
pub async fn rear_scanner_input<M: RawMutex>(
    shared: &Shared<M>,
    mut line: impl Read,
    mut receiver: s300::Receiver,
) {
    let mut portion = [0; PORTION_BYTES];
    loop {
        let count = match line.read(&mut portion).await {
            Ok(count) if count > 0 => count,
            Ok(_) | Err(_) => {
                shared.count(|links| links.scanner_errors = links.scanner_errors.saturating_add(1));
                fault(shared, FaultKind::LinkDown);
                Timer::after_millis(RETRY_MS).await;
                continue;
            }
        };
        let now = clock::now();
        receiver.push(portion.get(..count).unwrap_or_default(), now, |event| match event {
            s300::Event::Scan(scan) => {
                shared.decide(|guard| guard.on_rear_scan(scan, now));
                shared.remember(|guard| guard.remember_rear_scan(scan));
            }
            s300::Event::StandBy { .. } => fault(shared, FaultKind::StandBy),
            s300::Event::Refused(error) => {
                if let Some(kind) = fault_of_telegram(error) {
                    fault(shared, kind);
                }
                shared.complain(|complaints| complaints.rear_scanner = Some(error));
                shared.count(|links| links.scanner_refused = links.scanner_refused.saturating_add(1));
            }
        });
    }
}

fn fault<M: RawMutex>(shared: &Shared<M>, kind: FaultKind) {
    shared.decide(|guard| guard.on_source_fault(Source::RearScanner, kind, clock::now()));
}
