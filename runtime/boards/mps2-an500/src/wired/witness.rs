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
use crate::{faults, last_words, uart};

/// First word of a report: "FGST".
const MAGIC: u32 = 0x5453_4746;
const REPORT_EVERY: Duration = Duration::from_millis(1);
/// How often the guard's executor is asked how late it is.
const ASK_EVERY: Duration = Duration::from_millis(1);
/// Words of a report.
const WORDS: usize = 23;

static LATEST_US: AtomicU32 = AtomicU32::new(0);

/// How late does the guard's executor come to what is due? Runs for ever.
#[embassy_executor::task]
pub async fn lateness() {
    let mut due = Instant::now();
    loop {
        due += ASK_EVERY;
        Timer::at(due).await;
        let late_us = due.elapsed().as_micros() as u32;
        LATEST_US.fetch_max(late_us, Ordering::Relaxed);
        // What was missed is not asked for again.
        due = due.max(Instant::now() - ASK_EVERY);
    }
}

/// Reports to whoever said hello. Runs until told to quit.
#[embassy_executor::task]
pub async fn witness(shared: &'static RobotShared, socket: UdpSocket<'static>) {
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
                // A report that finds no room is made up for by the next one.
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
    let [cause, detail, uptime_ms, deaths] = last_words::read();
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
        cause,
        detail,
        uptime_ms,
        deaths,
    ]
}
