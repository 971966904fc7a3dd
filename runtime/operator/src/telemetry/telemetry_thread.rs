//! Recording and panel of a robot in real time, on a thread of their own: neither a slow disk nor a slow browser holds
//! up a ring or the display.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;
use std::time::Duration;

use anyhow::Context;
use floorguard_runtime::clock;
use floorguard_runtime::shared::StopRecord;

use super::run_sinks::RunSinks;
use crate::panel::Order;
use floorguard_host::executor::{Ring, take_priority};
use floorguard_robot::assembly::{HostedShared, Tap, TapRow, TapRows, tap};
use floorguard_robot::camera::{ColourPicture, SeenDirt};
use floorguard_robot::cleaner::MissionProgress;
use floorguard_robot::navigator::NavigationProgress;

/// Polling period: scans come every 40 ms, poses are written every 20 ms.
const POLL_PERIOD: Duration = Duration::from_millis(5);

/// Messages from the display thread to the telemetry thread.
enum TelemetryEvent {
    Stop(StopRecord),
    Mission(Arc<MissionProgress>),
    Navigation(Arc<NavigationProgress>),
    Order(Order),
    Dirt(Box<SeenDirt>),
    Picture(ColourPicture),
}

/// The channel to the telemetry thread, if there is one.
pub struct TelemetrySender<'a> {
    shared: &'a HostedShared,
    notes: Option<Sender<TelemetryEvent>>,
}

impl TelemetrySender<'_> {
    /// A stop that began.
    pub fn stop(&self, record: &StopRecord) {
        self.note(TelemetryEvent::Stop(*record));
    }

    /// The cleaning mission has reported its progress.
    pub fn mission(&self, progress: &Arc<MissionProgress>) {
        self.note(TelemetryEvent::Mission(Arc::clone(progress)));
    }

    /// The drive to a goal has reported its progress.
    pub fn navigation(&self, progress: &Arc<NavigationProgress>) {
        self.note(TelemetryEvent::Navigation(Arc::clone(progress)));
    }

    /// The floor camera's map of dirt.
    pub fn seen_dirt(&self, seen: Box<SeenDirt>) {
        self.note(TelemetryEvent::Dirt(seen));
    }

    /// A picture of the floor camera.
    pub fn camera_picture(&self, picture: ColourPicture) {
        self.note(TelemetryEvent::Picture(picture));
    }

    /// An operator's order: the tasks get it, and so does the recording.
    pub fn order(&self, order: Order) {
        if !self.note(TelemetryEvent::Order(order)) {
            order.apply(self.shared);
        }
    }

    fn note(&self, note: TelemetryEvent) -> bool {
        self.notes.as_ref().is_some_and(|notes| notes.send(note).is_ok())
    }
}

/// Runs `body` beside the telemetry thread. The body gives the tap to the robot's lines; without run sinks there is
/// none.
///
/// # Errors
/// What `body` says, or the recording could not be written.
pub fn with_telemetry<T>(
    sinks: &mut RunSinks,
    shared: &HostedShared,
    body: impl FnOnce(Option<Tap>, &TelemetrySender<'_>) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    if !sinks.listen() {
        return body(None, &TelemetrySender { shared, notes: None });
    }
    let ((tap, mut rows), (sender, notes)) = (tap(), channel());
    let ended = AtomicBool::new(false);
    thread::scope(|scope| {
        let flag = &ended;
        let run_telemetry = move || run_telemetry(sinks, shared, ((&mut rows, &notes), flag));
        let telemetry =
            thread::Builder::new().name("telemetry".to_owned()).spawn_scoped(scope, run_telemetry)?;
        let at_end = SetAtEnd(&ended);
        let answer = body(Some(tap), &TelemetrySender { shared, notes: Some(sender) });
        drop(at_end);
        let written = telemetry.join().unwrap_or_else(|_| {
            Err(anyhow::anyhow!("the recording's thread panicked; this is a defect, please report it"))
        });
        let answer = answer?;
        written.map(|()| answer)
    })
}

/// Ends the thread in a panic, too.
struct SetAtEnd<'a>(&'a AtomicBool);

impl Drop for SetAtEnd<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
    }
}

fn run_telemetry(
    sinks: &mut RunSinks,
    shared: &HostedShared,
    ((rows, notes), ended): ((&mut TapRows, &Receiver<TelemetryEvent>), &AtomicBool),
) -> anyhow::Result<()> {
    // Also because a thread begins with the priority of the one that started it, be it the simulated world's.
    say!("  {}", take_priority(Ring::Telemetry));
    let mut is_reported = false;
    loop {
        // Read before the queues: what was put in before the end is still taken out.
        let last = ended.load(Ordering::Acquire);
        take_in(sinks, shared, (rows, notes));
        if let Some(error) = sinks.failure().filter(|_| !is_reported) {
            is_reported = true;
            say!("  {error}; the robot goes on without its recording");
        }
        if last {
            break;
        }
        thread::sleep(POLL_PERIOD);
    }
    let lost = rows.lost();
    if lost > 0 {
        say!("  the recording misses {lost} messages of the lines: the disk was too slow");
    }
    sinks.finish_in_real_time(clock::now().as_micros(), lost).context("the run went on without its recording")
}

fn take_in(
    sinks: &mut RunSinks,
    shared: &HostedShared,
    (rows, notes): (&mut TapRows, &Receiver<TelemetryEvent>),
) {
    for row in rows.by_ref() {
        let now_us = clock::now().as_micros();
        // The bytes first: the entry of the order stands behind them.
        match &row {
            TapRow::Delivered { at, arrival, line, bytes } => {
                sinks.delivered((at.as_micros(), arrival.as_micros()), *line, bytes);
            }
            TapRow::Sent(at, frame) => sinks.sent(frame, at.as_micros()),
            _ => {}
        }
        sinks.ordered(&row, now_us);
    }
    let now_us = clock::now().as_micros();
    sinks.rows_taken(now_us, rows.lost() == 0);
    for note in notes.try_iter() {
        match note {
            TelemetryEvent::Stop(record) => sinks.stop(&record),
            TelemetryEvent::Mission(progress) => sinks.mission(&progress),
            TelemetryEvent::Navigation(progress) => sinks.navigation(&progress),
            TelemetryEvent::Dirt(seen) => sinks.seen_dirt(&seen),
            TelemetryEvent::Picture(picture) => sinks.camera_picture(&picture),
            TelemetryEvent::Order(order) => sinks.order(order, shared, now_us),
        }
    }
    let orders = sinks.outside_orders(shared, now_us);
    orders.into_iter().for_each(|order| sinks.order(order, shared, now_us));
    sinks.publish(shared, now_us);
}
