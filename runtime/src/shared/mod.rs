//! What the tasks of both rings share: the guard itself, and the signals and queues between the rings.
//!
//! Only tasks of the guard ring call [`Shared::decide`] and [`Shared::move_by`]. Everything else here is a latest
//! value or a bounded queue, so that no ring ever waits for the other.

mod complaints;
mod devices;
mod motion;
mod records;
mod reports;

pub use complaints::Complaints;
pub use devices::{BusReport, DeviceReport};
pub use motion::{Motion, StampedPose};
pub use records::{BoxEntry, STOPS_KEPT, StopRecord};
pub use reports::{LinkCounters, PeopleReport, PersonReport, RobotStatus, SweepReport};

use core::cell::{Cell, RefCell};
use core::sync::atomic::{AtomicBool, Ordering};

use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_sync::signal::Signal;
use floorguard_guard::{Advice, Decision, FloorSight, GuardConfig, GuardConfigError, Supervisor};
use floorguard_types::geometry::Twist2;
use floorguard_types::sensing::{DirtReading, LidarPacket, Scan};
use floorguard_types::time::Stamp;
use heapless::Vec;

use crate::channel::{Latest, Queue, SlotQueue};

/// Lidar packets that perception may be late by: 21 ms. Eight more do not fit beside the legs into the memory of the boards.
pub const PACKETS_QUEUED: usize = 16;
/// Scans that perception may be late by: it searches all of them for legs, after each packet.
pub const SCANS_QUEUED: usize = 3;
/// Poses that perception may be late by: 640 ms at 200 Hz.
pub const POSES_QUEUED: usize = 128;

/// A lidar packet on its way to perception, and how many were lost before it.
#[derive(Clone, Debug)]
pub struct QueuedPacket {
    /// The packet.
    pub packet: LidarPacket,
    /// Packets missing before it.
    pub lost_before: u16,
}

impl QueuedPacket {
    /// Nothing. A place to decode into.
    pub const EMPTY: Self = Self { packet: LidarPacket::EMPTY, lost_before: 0 };

    /// Nothing but zeros, which take no space in a program: a place to decode into, too.
    const BLANK: Self = Self {
        packet: LidarPacket { stamp: Stamp::ZERO, range_unit_mm: 0, rings: 0, columns: Vec::new() },
        lost_before: 0,
    };

    /// Becomes equal to another one without a copy on the way.
    pub fn copy_from(&mut self, other: &Self) {
        self.packet.copy_from(&other.packet);
        self.lost_before = other.lost_before;
    }
}

/// Shared by all tasks. Large (the guard's tables): place it once.
pub struct Shared<M: RawMutex> {
    guard: Mutex<M, RefCell<Supervisor>>,
    motion: Mutex<M, RefCell<Motion>>,
    /// What is permitted now. Wakes the task that commands the drive.
    pub decision: Latest<M, Decision>,
    /// Guard ring → perception: every lidar packet.
    pub packets: SlotQueue<M, QueuedPacket, PACKETS_QUEUED>,
    /// Guard ring → perception: where the robot was.
    pub poses: Queue<M, StampedPose, POSES_QUEUED>,
    /// Guard ring → readers of the newest: where the robot is.
    pub pose: Latest<M, StampedPose>,
    /// Guard ring → perception: every scan.
    pub scans: SlotQueue<M, Scan, SCANS_QUEUED>,
    /// Guard ring → readers of the newest: a scan.
    pub scan: Latest<M, Scan>,
    /// Guard ring → mission: what the dirt sensor has counted.
    pub dirt: Latest<M, DirtReading>,
    /// Perception → guard ring: can only tighten.
    pub advice: Latest<M, Advice>,
    /// Floor camera → perception: what lies on the floor. Nothing without a camera.
    pub floor: Latest<M, FloorSight>,
    /// Mission → guard ring: what it would like.
    pub wanted: Latest<M, (Stamp, Twist2)>,
    /// The operator pressed reset.
    pub reset: Signal<M, ()>,
    /// The operator gave the start command.
    pub start: Signal<M, ()>,
    /// The causes that hold and need a reset, one bit for each `Cause::index`; published when they change, for memory that
    /// outlives the computer.
    pub latches: Latest<M, u64>,
    /// The drives are to be led out of their faults, too.
    pub drive_reset: Signal<M, ()>,
    /// What perception saw last.
    pub people: Latest<M, PeopleReport>,
    /// How everything is, ten times a second.
    pub status: Latest<M, RobotStatus>,
    /// How far the devices on the CAN bus are; published when it changes.
    pub bus: Latest<M, BusReport>,
    /// Every stop, in order.
    pub stops: Queue<M, StopRecord, STOPS_KEPT>,
    paused: AtomicBool,
    records: Mutex<M, RefCell<records::Records>>,
    links: Mutex<M, RefCell<LinkCounters>>,
    complaints: Mutex<M, Cell<Complaints>>,
}

impl<M: RawMutex> Shared<M> {
    /// For a robot that stands and of which nothing is known.
    ///
    /// # Errors
    /// The guard refuses its configuration.
    pub fn new(config: GuardConfig, motion: Motion, now: Stamp) -> Result<Self, GuardConfigError> {
        let shared = Self::unconfigured(motion);
        shared.configure(config, now)?;
        Ok(shared)
    }

    /// The same with a guard that lets nothing move until [`Self::configure`]. The large parts are constants, so that a
    /// static can be filled with it without a copy on the stack.
    #[inline(never)]
    pub fn unconfigured(motion: Motion) -> Self {
        Self {
            guard: const { Mutex::new(RefCell::new(Supervisor::UNCONFIGURED)) },
            motion: Mutex::new(RefCell::new(motion)),
            decision: Latest::new(),
            packets: const { SlotQueue::new([const { QueuedPacket::BLANK }; PACKETS_QUEUED]) },
            poses: Queue::new(),
            pose: Latest::new(),
            scans: SlotQueue::new([const { Scan::EMPTY }; SCANS_QUEUED]),
            scan: Latest::new(),
            dirt: Latest::new(),
            advice: Latest::new(),
            floor: Latest::new(),
            wanted: Latest::new(),
            reset: Signal::new(),
            start: Signal::new(),
            latches: Latest::new(),
            drive_reset: Signal::new(),
            people: Latest::new(),
            status: Latest::new(),
            bus: Latest::new(),
            stops: Queue::new(),
            paused: AtomicBool::new(false),
            records: Mutex::new(RefCell::new(records::Records::new())),
            links: Mutex::new(RefCell::new(LinkCounters::default())),
            complaints: Mutex::new(Cell::new(Complaints::default())),
        }
    }

    /// Tells the guard its robot, in place.
    ///
    /// # Errors
    /// The guard refuses its configuration, and goes on as it was.
    pub fn configure(&self, config: GuardConfig, now: Stamp) -> Result<(), GuardConfigError> {
        self.guard.lock(|guard| guard.borrow_mut().configure(config, now))
    }

    /// Gives evidence to the guard and makes its answer known: to the drive, to the black box, to the list of stops.
    pub fn decide(&self, evidence: impl FnOnce(&mut Supervisor) -> Decision) -> Decision {
        let (decision, latches) = self.guard.lock(|guard| {
            let guard = &mut *guard.borrow_mut();
            (evidence(guard), guard.latches())
        });
        let pose = self.pose.get().unwrap_or_default();
        let (began, latched) = self.records.lock(|records| {
            let records = &mut *records.borrow_mut();
            (records.note(&decision, &pose), records.note_latches(latches))
        });
        if latched {
            self.latches.publish(latches);
        }
        if let Some(stop) = began {
            self.stops.push(stop);
        }
        self.decision.publish(decision);
        decision
    }

    /// Gives the guard what it keeps without deciding anything: call it after the decision.
    pub fn remember(&self, evidence: impl FnOnce(&mut Supervisor)) {
        self.guard.lock(|guard| evidence(&mut guard.borrow_mut()));
    }

    /// What was latched when the computer last ran is latched again (FG-REQ-070). Call before the tasks run.
    pub fn restore_latches(&self, latches: u64, now: Stamp) {
        if latches != 0 {
            self.decide(|guard| guard.on_latches(latches, now));
        }
    }

    /// Reads the guard's state without input to it.
    pub fn inspect<R>(&self, observe: impl FnOnce(&Supervisor) -> R) -> R {
        self.guard.lock(|guard| observe(&guard.borrow()))
    }

    /// New evidence about the robot's own motion; the newest pose is made known.
    pub fn move_by<R>(&self, evidence: impl FnOnce(&mut Motion) -> R) -> R {
        let (answer, pose) = self.motion.lock(|motion| {
            let motion = &mut *motion.borrow_mut();
            let answer = evidence(motion);
            (answer, motion.newest())
        });
        if let Some(pose) = pose {
            self.poses.push(pose);
            self.pose.publish(pose);
        }
        answer
    }

    /// The last ten seconds, oldest first, given to `entry` one by one.
    pub fn black_box(&self, mut entry: impl FnMut(Stamp, BoxEntry)) {
        self.records.lock(|records| {
            for (stamp, boxed) in records.borrow().ring.iter() {
                entry(stamp, boxed);
            }
        });
    }

    /// The entries of the black box after the first `written` ones, oldest first; gives how many were ever written.
    pub fn black_box_since(&self, written: u64, mut entry: impl FnMut(Stamp, BoxEntry)) -> u64 {
        self.records.lock(|records| {
            let ring = &records.borrow().ring;
            ring.since(written).for_each(|(stamp, boxed)| entry(stamp, boxed));
            ring.written()
        })
    }

    /// The operator wants the mission to wait, or to go on. Only the mission listens: it can hold the robot, never
    /// release it.
    pub fn pause(&self, paused: bool) {
        self.paused.store(paused, Ordering::Relaxed);
    }

    /// The mission waits.
    pub fn is_paused(&self) -> bool {
        self.paused.load(Ordering::Relaxed)
    }

    /// Counts something on a link.
    pub fn count(&self, change: impl FnOnce(&mut LinkCounters)) {
        self.links.lock(|links| change(&mut links.borrow_mut()));
    }

    /// Keeps why a device is of no use, where there is a console that tells it: a board pays nothing.
    pub fn complain(&self, change: impl FnOnce(&mut Complaints)) {
        if !Complaints::ARE_REPORTED {
            return;
        }
        self.complaints.lock(|complaints| {
            let mut changed = complaints.get();
            change(&mut changed);
            complaints.set(changed);
        });
    }

    /// Why devices are, or were, of no use.
    pub fn complaints(&self) -> Complaints {
        self.complaints.lock(Cell::get)
    }

    /// What happened on the links.
    pub fn links(&self) -> LinkCounters {
        self.links.lock(|links| *links.borrow())
    }
}
