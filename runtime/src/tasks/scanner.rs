//! The scanners: telegrams of an S300 over a serial line, datagrams of a microScan3 over UDP, and what is no safety device.

use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_time::{Duration, Ticker, Timer};
use embedded_io_async::{Read, Write};
use floorguard_drivers::ranging::{RangingEvent, RangingScanner};
use floorguard_drivers::{microscan3, s300, scan_link};
use floorguard_guard::{FaultKind, Source};
use floorguard_types::profile::Native;
use floorguard_types::sensing::Scan;
use floorguard_types::time::Stamp;

use crate::clock;
use crate::io::DatagramReceiver;
use crate::shared::{Complaints, LinkCounters, Shared};

/// At 500 kBd 1 ms is 50 bytes: a read takes what is there.
const PORTION_BYTES: usize = 128;
/// What an Ethernet frame holds, and more: a longer datagram must not pass for a right one.
const DATAGRAM_BYTES: usize = 1_600;
/// Legs are searched in beams as dense as those they were learned from, radians: half a degree.
pub const SEARCHED_STEP_RAD: f32 = 0.5 * floorguard_types::units::RADIANS_PER_DEGREE;
/// Bits 0 and 1 of the last byte of its state (book, microScan3: Blocks).
const DEVICE_ERROR: u16 = 0x03;
/// A scan of a ranging scanner has some thousand bytes.
const RANGING_PORTION_BYTES: usize = 1_024;
/// How often such a scanner is asked for what is due, milliseconds.
const POLL_MS: u64 = 20;
/// Commands of one poll.
const COMMAND_BYTES: usize = 128;
/// Pause after a failure of the line, milliseconds.
const RETRY_MS: u64 = 20;

/// The place of a safety scanner: which source of the guard it is, what its scans are handed on to, and where its failures
/// are counted.
trait Place {
    /// For the guard.
    const SOURCE: Source;

    /// A scan: the guard first.
    fn hand_on<M: RawMutex>(shared: &Shared<M>, scan: &Scan, now: Stamp);

    /// The newest refused telegram.
    fn complaint(complaints: &mut Complaints) -> &mut Option<s300::TelegramError>;

    /// Telegrams that are right and of no use.
    fn refused(links: &mut LinkCounters) -> &mut u32;

    /// Failures of the line.
    fn errors(links: &mut LinkCounters) -> &mut u32;
}

/// The first scanner: the guard, its display, and the search for people.
struct Front;

impl Place for Front {
    const SOURCE: Source = Source::Scanner;

    fn hand_on<M: RawMutex>(shared: &Shared<M>, scan: &Scan, now: Stamp) {
        hand_on(shared, scan, now);
        shared.scans.push(|slot| slot.copy_from(scan));
    }

    fn complaint(complaints: &mut Complaints) -> &mut Option<s300::TelegramError> {
        &mut complaints.scanner
    }

    fn refused(links: &mut LinkCounters) -> &mut u32 {
        &mut links.scanner_refused
    }

    fn errors(links: &mut LinkCounters) -> &mut u32 {
        &mut links.scanner_errors
    }
}

/// The second scanner: the guard alone. People are not searched for in its scans.
struct Rear;

impl Place for Rear {
    const SOURCE: Source = Source::RearScanner;

    fn hand_on<M: RawMutex>(shared: &Shared<M>, scan: &Scan, now: Stamp) {
        shared.decide(|guard| guard.on_rear_scan(scan, now));
        shared.remember(|guard| guard.remember_rear_scan(scan));
    }

    fn complaint(complaints: &mut Complaints) -> &mut Option<s300::TelegramError> {
        &mut complaints.rear_scanner
    }

    fn refused(links: &mut LinkCounters) -> &mut u32 {
        &mut links.rear_scanner_refused
    }

    fn errors(links: &mut LinkCounters) -> &mut u32 {
        &mut links.rear_scanner_errors
    }
}

/// An S300. Guard ring. Runs for ever.
// Not async itself: its future would hold the receiver a second time.
pub fn scanner_input<M: RawMutex>(
    shared: &Shared<M>,
    line: impl Read,
    receiver: s300::Receiver,
) -> impl Future<Output = ()> {
    s300_input::<Front, M>(shared, line, receiver)
}

/// The second safety scanner, an S300 on a line of its own. Guard ring. Runs for ever.
pub fn rear_scanner_input<M: RawMutex>(
    shared: &Shared<M>,
    line: impl Read,
    receiver: s300::Receiver,
) -> impl Future<Output = ()> {
    s300_input::<Rear, M>(shared, line, receiver)
}

async fn s300_input<P: Place, M: RawMutex>(
    shared: &Shared<M>,
    mut line: impl Read,
    mut receiver: s300::Receiver,
) {
    let mut portion = [0; PORTION_BYTES];
    loop {
        let count = match line.read(&mut portion).await {
            Ok(count) if count > 0 => count,
            Ok(_) | Err(_) => {
                link_down::<P, M>(shared).await;
                continue;
            }
        };
        let now = clock::now();
        let bytes = portion.get(..count).unwrap_or_default();
        receiver.push(bytes, now, |event| match event {
            s300::Event::Scan(scan) => P::hand_on(shared, scan, now),
            s300::Event::StandBy { .. } => fault::<P, M>(shared, FaultKind::StandBy, now),
            s300::Event::Refused(error) => {
                if let Some(kind) = fault_of_telegram(error) {
                    fault::<P, M>(shared, kind, now);
                }
                shared.complain(|complaints| *P::complaint(complaints) = Some(error));
                count_one(shared, P::refused);
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
            link_down::<Front, M>(shared).await;
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
            microscan3::Event::StandBy { .. } => fault::<Front, M>(shared, FaultKind::StandBy, now),
            microscan3::Event::Refused(error) => {
                if let Some(kind) = fault_of_message(error) {
                    fault::<Front, M>(shared, kind, now);
                }
                shared.complain(|complaints| complaints.scanner_message = Some(error));
                count_one(shared, Front::refused);
            }
        });
        if is_understood {
            socket.keep_sender();
        }
    }
}

/// A scanner that is no safety device: it is asked to measure, over a line or a connection. Guard ring. Runs for ever.
pub async fn ranging_scanner<M: RawMutex>(
    shared: &Shared<M>,
    mut line: impl Read + Write,
    mut scanner: impl RangingScanner<Native>,
) {
    let mut ticker = Ticker::every(Duration::from_millis(POLL_MS));
    let mut portion = [0; RANGING_PORTION_BYTES];
    loop {
        match select(line.read(&mut portion), ticker.next()).await {
            Either::First(Ok(count)) if count > 0 => {
                let (bytes, now) = (portion.get(..count).unwrap_or_default(), clock::now());
                scanner.push(bytes, now, &mut |event| take_in(shared, &event, now));
            }
            Either::First(_) => {
                link_down::<Front, M>(shared).await;
            }
            Either::Second(()) => {}
        }
        let now = clock::now();
        let mut commands = heapless::Vec::<u8, COMMAND_BYTES>::new();
        // One poll sends a short command or two.
        let mut send = |bytes: &[u8]| {
            let _ = commands.extend_from_slice(bytes);
        };
        scanner.poll(now, &mut send, &mut |event| take_in(shared, &event, now));
        if !commands.is_empty() && line.write_all(&commands).await.is_err() {
            count_one(shared, Front::errors);
        }
    }
}

/// A scanner that is no safety device and sends datagrams by itself. Guard ring. Runs for ever.
pub async fn ranging_datagrams<M: RawMutex>(
    shared: &Shared<M>,
    mut socket: impl DatagramReceiver,
    mut scanner: impl RangingScanner<Native>,
) {
    let mut buffer = [0; DATAGRAM_BYTES];
    loop {
        let Ok(received) = socket.receive(&mut buffer).await else {
            link_down::<Front, M>(shared).await;
            continue;
        };
        let bytes = buffer.get(..received.length).unwrap_or_default();
        let now = clock::now();
        let mut is_understood = false;
        scanner.push(bytes, received.arrival, &mut |event| {
            is_understood |= matches!(event, RangingEvent::Scan(_));
            take_in(shared, &event, now);
        });
        if is_understood {
            socket.keep_sender();
        }
    }
}

/// What it reports, for the guard. A sensor that does not answer is absent or stale by its age.
fn take_in<M: RawMutex>(shared: &Shared<M>, event: &RangingEvent<'_, Native>, now: Stamp) {
    match event {
        RangingEvent::Scan(scan) => {
            hand_on(shared, scan, now);
            shared.scans.push(|slot| slot.copy_thinned(scan, SEARCHED_STEP_RAD));
        }
        RangingEvent::StandBy => fault::<Front, M>(shared, FaultKind::StandBy, now),
        RangingEvent::Fault(code) => fault::<Front, M>(shared, FaultKind::Device(*code), now),
        RangingEvent::Unsuitable => fault::<Front, M>(shared, FaultKind::WrongGeometry, now),
        RangingEvent::Datagram(error) => {
            // Other datagrams may be a stranger's, or damaged, and say nothing about the scanner.
            if matches!(error, scan_link::DecodeError::Shape { .. }) {
                fault::<Front, M>(shared, FaultKind::WrongGeometry, now);
            }
            shared.complain(|complaints| complaints.scan_link = Some(*error));
            count_one(shared, Front::refused);
        }
        RangingEvent::Refused | RangingEvent::Silent => count_one(shared, Front::refused),
    }
}

/// The guard first, then its display.
fn hand_on<M: RawMutex>(shared: &Shared<M>, scan: &Scan, now: Stamp) {
    shared.decide(|guard| guard.on_scan(scan, now));
    shared.remember(|guard| guard.remember_scan(scan));
    shared.scan.publish(scan.clone());
}

/// What a refused telegram says of its scanner.
const fn fault_of_telegram(error: s300::TelegramError) -> Option<FaultKind> {
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

fn fault<P: Place, M: RawMutex>(shared: &Shared<M>, kind: FaultKind, now: Stamp) {
    shared.decide(|guard| guard.on_source_fault(P::SOURCE, kind, now));
}

fn count_one<M: RawMutex>(shared: &Shared<M>, counter: impl for<'a> Fn(&'a mut LinkCounters) -> &'a mut u32) {
    shared.count(|links| {
        let count = counter(links);
        *count = count.saturating_add(1);
    });
}

async fn link_down<P: Place, M: RawMutex>(shared: &Shared<M>) {
    count_one(shared, P::errors);
    fault::<P, M>(shared, FaultKind::LinkDown, clock::now());
    Timer::after_millis(RETRY_MS).await;
}
