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

use super::witnesses::Witnesses;
use crate::panel::Order;
use floorguard_host::executor::{Ring, take_priority};
use floorguard_robot::assembly::{HostedShared, Tap, TapRow, TapRows, tap};
use floorguard_robot::camera::SeenDirt;
use floorguard_robot::cleaner::MissionProgress;

/// How often it looks: scans come every 40 ms, poses are written every 20 ms.
const LOOK: Duration = Duration::from_millis(5);

/// What the thread with the display tells the onlooker.
enum Note {
    Stop(StopRecord),
    Mission(Arc<MissionProgress>),
    Order(Order),
    Dirt(Box<SeenDirt>),
}

/// The way to the onlooker, if there is one.
pub struct Notes<'a> {
    shared: &'a HostedShared,
    notes: Option<Sender<Note>>,
}

impl Notes<'_> {
    /// A stop that began.
    pub fn stop(&self, record: &StopRecord) {
        self.note(Note::Stop(*record));
    }

    /// The cleaning mission has told its progress.
    pub fn mission(&self, progress: &Arc<MissionProgress>) {
        self.note(Note::Mission(Arc::clone(progress)));
    }

    /// The floor camera's map of dirt.
    pub fn seen_dirt(&self, seen: Box<SeenDirt>) {
        self.note(Note::Dirt(seen));
    }

    /// An operator's order: the tasks get it, and so does the recording.
    pub fn order(&self, order: Order) {
        if !self.note(Note::Order(order)) {
            order.apply(self.shared);
        }
    }

    fn note(&self, note: Note) -> bool {
        self.notes.as_ref().is_some_and(|notes| notes.send(note).is_ok())
    }
}

/// Runs `body` while the witnesses look on. The body gives the tap to the robot's lines; without witnesses there is none.
///
/// # Errors
/// What `body` says, or the recording could not be written.
pub fn with_onlooker<T>(
    witnesses: &mut Witnesses,
    shared: &HostedShared,
    body: impl FnOnce(Option<Tap>, &Notes<'_>) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    if !witnesses.listen() {
        return body(None, &Notes { shared, notes: None });
    }
    let ((tap, rows), (sender, notes)) = (tap(), channel());
    let ended = AtomicBool::new(false);
    thread::scope(|scope| {
        let flag = &ended;
        let look_on = move || look_on(witnesses, shared, ((&rows, &notes), flag));
        let onlooker = thread::Builder::new().name("onlooker".to_owned()).spawn_scoped(scope, look_on)?;
        let at_end = SetAtEnd(&ended);
        let answer = body(Some(tap), &Notes { shared, notes: Some(sender) });
        drop(at_end);
        let written = onlooker.join().unwrap_or_else(|_| {
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

fn look_on(
    witnesses: &mut Witnesses,
    shared: &HostedShared,
    ((rows, notes), ended): ((&TapRows, &Receiver<Note>), &AtomicBool),
) -> anyhow::Result<()> {
    // Also because a thread begins with the priority of the one that started it, be it the simulated world's.
    say!("  {}", take_priority(Ring::Onlooker));
    let mut told = false;
    loop {
        // Read before the queues: what was put in before the end is still taken out.
        let last = ended.load(Ordering::Acquire);
        take_in(witnesses, shared, (rows, notes));
        if let Some(error) = witnesses.failure().filter(|_| !told) {
            told = true;
            say!("  {error}; the robot goes on without its recording");
        }
        if last {
            break;
        }
        thread::sleep(LOOK);
    }
    let lost = rows.lost();
    if lost > 0 {
        say!("  the recording misses {lost} messages of the lines: the disk was too slow");
    }
    witnesses
        .finish_in_real_time(clock::now().as_micros(), lost)
        .context("the run went on without its recording")
}

fn take_in(witnesses: &mut Witnesses, shared: &HostedShared, (rows, notes): (&TapRows, &Receiver<Note>)) {
    while let Some(row) = rows.next() {
        match row {
            TapRow::Delivered { at, arrival, line, bytes } => {
                witnesses.delivered((at.as_micros(), arrival.as_micros()), line, &bytes);
            }
            TapRow::Sent(at, frame) => witnesses.sent(&frame, at.as_micros()),
        }
    }
    let now_us = clock::now().as_micros();
    for note in notes.try_iter() {
        match note {
            Note::Stop(record) => witnesses.stop(&record),
            Note::Mission(progress) => witnesses.mission(&progress),
            Note::Dirt(seen) => witnesses.seen_dirt(&seen),
            Note::Order(order) => witnesses.order(order, shared, now_us),
        }
    }
    if let Some(panel) = &mut witnesses.panel {
        panel.look(shared);
        let orders: Vec<Order> = std::iter::from_fn(|| panel.order()).collect();
        orders.into_iter().for_each(|order| witnesses.order(order, shared, now_us));
    }
    witnesses.look(shared, now_us);
}
