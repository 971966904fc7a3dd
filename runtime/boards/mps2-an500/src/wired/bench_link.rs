//! What a bench wants to know, by UDP: the board's time, what arrived, and how late the guard was at worst.
//!
//! The bench says hello, and from then on gets a line of numbers every millisecond; it advances the simulated world to
//! the board's time and sends no more datagrams than the board has taken.

use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m_semihosting::debug;
use embassy_futures::select::{Either, select};
use embassy_net::udp::UdpSocket;
use embassy_time::{Duration, Instant, Ticker, Timer};
use floorguard_board_support::RobotShared;

use super::network;
use crate::ethernet::Ethernet;
use crate::uart::Uart;
use crate::{crash_record, executor, faults, uart};

/// First word of a report: "FGST".
const MAGIC: u32 = 0x5453_4746;
const REPORT_EVERY: Duration = Duration::from_millis(1);
/// How often the guard's executor is asked how late it is.
const ASK_EVERY: Duration = Duration::from_millis(1);
/// Words of a report.
const WORDS: usize = 27;

static LATEST_US: AtomicU32 = AtomicU32::new(0);
/// When that was, milliseconds since the start, and what had arrived since the guard was asked before: bytes of the
/// serial lines, datagrams of the lidar; and how long the guard ring worked at a stretch meanwhile, microseconds.
static LATEST_WITH: [AtomicU32; 4] = [const { AtomicU32::new(0) }; 4];

/// Bytes and datagrams so far; both wrap.
fn arrived() -> [u32; 2] {
    let bytes = [&uart::SCANNER, &uart::IMU, &uart::CAN].map(Uart::taken);
    [bytes.iter().fold(0, |sum, bytes| sum.wrapping_add(*bytes)), network::received()]
}

/// How late does the guard's executor come to what is due? Runs for ever.
#[embassy_executor::task]
pub async fn lateness() {
    let mut due = Instant::now();
    let mut before = arrived();
    loop {
        due += ASK_EVERY;
        Timer::at(due).await;
        let late_us = due.elapsed().as_micros() as u32;
        let [bytes, datagrams] = arrived();
        let stretch_us = executor::longest_guard_poll_us();
        if late_us > LATEST_US.fetch_max(late_us, Ordering::Relaxed) {
            let [with_bytes, with_datagrams] =
                [bytes.wrapping_sub(before[0]), datagrams.wrapping_sub(before[1])];
            let found = [Instant::now().as_millis() as u32, with_bytes, with_datagrams, stretch_us];
            LATEST_WITH.iter().zip(found).for_each(|(slot, value)| slot.store(value, Ordering::Relaxed));
        }
        before = [bytes, datagrams];
        // What was missed is not asked for again.
        due = due.max(Instant::now() - ASK_EVERY);
    }
}

/// Reports to the client that sent a hello. Runs until it receives the order to quit.
#[embassy_executor::task]
pub async fn bench_link(shared: &'static RobotShared, socket: UdpSocket<'static>) {
    let mut order = [0; 16];
    let Ok((_, mut bench)) = socket.recv_from(&mut order).await else { return };
    // Start-up does not count.
    LATEST_US.store(0, Ordering::Relaxed);
    let mut ticker = Ticker::every(REPORT_EVERY);
    loop {
        match select(socket.recv_from(&mut order), ticker.next()).await {
            Either::First(Ok((_, from))) => {
                bench = from;
                match order {
                    [b'R', ..] => shared.reset.signal(()),
                    [b'S', ..] => shared.start.signal(()),
                    [b'Q', ..] => debug::exit(debug::EXIT_SUCCESS),
                    _ => {}
                }
            }
            Either::First(Err(_)) => {}
            Either::Second(()) => {
                let mut bytes = [0; 4 * WORDS];
                for (slot, word) in bytes.chunks_exact_mut(4).zip(report(shared)) {
                    slot.copy_from_slice(&word.to_le_bytes());
                }
                // A report that does not fit is replaced by the next one.
                let _ = socket.send_to(&bytes, bench).await;
            }
        }
    }
}

fn report(shared: &RobotShared) -> [u32; WORDS] {
    let now_us = Instant::now().as_micros();
    let decision = shared.decision.get();
    let state = decision.map_or(0, |decision| decision.state as u32);
    let permitted_um_s = decision.map_or(0.0, |decision| decision.permitted.linear_mps * 1.0e6) as i32;
    // 0: none; otherwise its place in the list of causes, counted from 1.
    let objection = decision
        .and_then(|decision| decision.primary_cause)
        .map_or(0, |record| record.cause.index() as u32 + 1);
    let links = shared.links();
    let [cause, detail, uptime_ms, deaths] = crash_record::read();
    let [late_at_ms, late_bytes, late_datagrams, late_stretch_us] =
        LATEST_WITH.each_ref().map(|word| word.load(Ordering::Relaxed));
    [
        MAGIC,
        now_us as u32,
        (now_us >> 32) as u32,
        network::received(),
        Ethernet::lost_frames(),
        uart::SCANNER.taken(),
        uart::IMU.taken(),
        uart::CAN.taken(),
        shared.scan.published(),
        shared.people.published(),
        LATEST_US.load(Ordering::Relaxed),
        shared.packets.lost(),
        state,
        permitted_um_s as u32,
        links.can_sent,
        links.lidar_refused,
        Ethernet::overruns(),
        objection,
        faults::planned_ms(),
        late_at_ms,
        late_bytes,
        late_datagrams,
        late_stretch_us,
        cause,
        detail,
        uptime_ms,
        deaths,
    ]
}
