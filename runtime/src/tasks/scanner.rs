//! The safety scanner: telegrams of an S300 over a serial line, datagrams of a microScan3 over UDP.

use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_time::Timer;
use embedded_io_async::Read;
use floorguard_drivers::{microscan3, s300};
use floorguard_guard::{FaultKind, Source};
use floorguard_types::sensing::Scan;
use floorguard_types::time::Stamp;

use crate::clock;
use crate::io::DatagramReceiver;
use crate::shared::Shared;

/// At 500 kBd 1 ms is 50 bytes: a read takes what is there.
pub(super) const PORTION_BYTES: usize = 128;
/// What an Ethernet frame holds, and more: a longer datagram must not pass for a right one.
const DATAGRAM_BYTES: usize = 1_600;
/// Legs are searched in beams as dense as those they were learned from, radians: half a degree.
pub const SEARCHED_STEP_RAD: f32 = 0.5 * floorguard_types::units::RADIANS_PER_DEGREE;
/// Bits 0 and 1 of the last byte of its state (book, microScan3: Blocks).
const DEVICE_ERROR: u16 = 0x03;
/// Pause after a failure of the line, milliseconds.
pub(super) const RETRY_MS: u64 = 20;

/// An S300. Guard ring. Runs for ever.
pub async fn scanner_input<M: RawMutex>(
    shared: &Shared<M>,
    mut line: impl Read,
    mut receiver: s300::Receiver,
) {
    let mut portion = [0; PORTION_BYTES];
    loop {
        let count = match line.read(&mut portion).await {
            Ok(count) if count > 0 => count,
            Ok(_) | Err(_) => {
                link_down(shared).await;
                continue;
            }
        };
        let now = clock::now();
        let bytes = portion.get(..count).unwrap_or_default();
        receiver.push(bytes, now, |event| match event {
            s300::Event::Scan(scan) => {
                hand_on(shared, scan, now);
                shared.scans.push(|slot| slot.copy_from(scan));
            }
            s300::Event::StandBy { .. } => fault(shared, FaultKind::StandBy, now),
            s300::Event::Refused(error) => {
                if let Some(kind) = fault_of_telegram(error) {
                    fault(shared, kind, now);
                }
                shared.complain(|complaints| complaints.scanner = Some(error));
                count_refused(shared);
            }
        });
    }
}

/// A scanner of the microScan3 family. Guard ring. Runs for ever.
pub async fn scanner_datagrams<M: RawMutex>(
    shared: &Shared<M>,
    mut socket: impl DatagramReceiver,
    mut receiver: microscan3::Receiver,
) {
    let mut buffer = [0; DATAGRAM_BYTES];
    loop {
        let Ok(received) = socket.receive(&mut buffer).await else {
            link_down(shared).await;
            continue;
        };
        let bytes = buffer.get(..received.length).unwrap_or_default();
        let now = clock::now();
        let mut is_understood = false;
        receiver.push(bytes, received.arrival, |event| match event {
            microscan3::Event::Scan(scan) => {
                is_understood = true;
                hand_on(shared, scan, now);
                shared.scans.push(|slot| slot.copy_thinned(scan, SEARCHED_STEP_RAD));
            }
            microscan3::Event::StandBy { .. } => fault(shared, FaultKind::StandBy, now),
            microscan3::Event::Refused(error) => {
                if let Some(kind) = fault_of_message(error) {
                    fault(shared, kind, now);
                }
                shared.complain(|complaints| complaints.scanner_message = Some(error));
                count_refused(shared);
            }
        });
        if is_understood {
            socket.keep_sender();
        }
    }
}

/// The guard first, then its display.
fn hand_on<M: RawMutex>(shared: &Shared<M>, scan: &Scan, now: Stamp) {
    shared.decide(|guard| guard.on_scan(scan, now));
    shared.remember(|guard| guard.remember_scan(scan));
    shared.scan.publish(scan.clone());
}

/// What a refused telegram says of its scanner.
pub(super) const fn fault_of_telegram(error: s300::TelegramError) -> Option<FaultKind> {
    match error {
        s300::TelegramError::LockOut { status } => Some(FaultKind::Device(status)),
        s300::TelegramError::Values { .. } => Some(FaultKind::WrongGeometry),
        // It may come beside the measured values, and says nothing about them.
        s300::TelegramError::Block { .. } => None,
    }
}

/// What a refused message says of its scanner: it answers, and is set up wrongly or at fault. Datagrams that are no whole
/// message may be a stranger's, and say nothing.
const fn fault_of_message(error: microscan3::ScanError) -> Option<FaultKind> {
    use microscan3::ScanError;
    match error {
        ScanError::Device => Some(FaultKind::Device(DEVICE_ERROR)),
        ScanError::NoGeometry | ScanError::NoMeasurement | ScanError::Geometry | ScanError::Beams { .. } => {
            Some(FaultKind::WrongGeometry)
        }
        ScanError::Fragment(_) | ScanError::Message(_) => None,
    }
}

fn fault<M: RawMutex>(shared: &Shared<M>, kind: FaultKind, now: Stamp) {
    shared.decide(|guard| guard.on_source_fault(Source::Scanner, kind, now));
}

fn count_refused<M: RawMutex>(shared: &Shared<M>) {
    shared.count(|links| links.scanner_refused = links.scanner_refused.saturating_add(1));
}

async fn link_down<M: RawMutex>(shared: &Shared<M>) {
    shared.count(|links| links.scanner_errors = links.scanner_errors.saturating_add(1));
    fault(shared, FaultKind::LinkDown, clock::now());
    Timer::after_millis(RETRY_MS).await;
}
