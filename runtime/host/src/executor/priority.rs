//! Real-time priority for the rings where the system grants it, and a plain sentence where it does not.

use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadSchedulePolicy, set_thread_priority_and_policy,
    thread_native_id,
};

/// The two rings of the robot, and the simulated world when it plays in real time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ring {
    /// Sources, supervisor, drive.
    Guard,
    /// Sweeps, people, motion.
    Perception,
    /// Cleaning, driving to a goal: plans for seconds at a time, and below what takes in its progress.
    Mission,
    /// Pictures of the floor and of people in them, on their way to both rings.
    Camera,
    /// Simulated devices: real ones do not wait for anybody.
    World,
    /// Recording, panel, display and the file of latched stops: below both rings, but above everything else on the computer. Its
    /// work is short, and its queue must not run over while a mission plans.
    Telemetry,
}

impl Ring {
    /// First-in-first-out priority: the guard above perception, all below the kernel's own threads (50).
    const fn priority(self) -> u8 {
        match self {
            Self::Guard => 40,
            Self::Perception => 20,
            Self::World => 45,
            Self::Camera => 15,
            Self::Telemetry => 10,
            Self::Mission => 5,
        }
    }
}

/// Asks for real-time scheduling of the calling thread. Gives the line to show to the user.
#[must_use]
pub fn take_priority(ring: Ring) -> String {
    let name = match ring {
        Ring::Guard => "guard ring",
        Ring::Perception => "perception ring",
        Ring::Mission => "mission",
        Ring::Camera => "camera",
        Ring::World => "simulated world",
        Ring::Telemetry => "recording and panel",
    };
    match ask(ring) {
        Ok(()) => format!("{name}: real-time priority {}", ring.priority()),
        Err(reason) => format!("{name}: ordinary priority, the system refuses real time ({reason})"),
    }
}

/// Whether the guard ring would get its priority, tried on a thread that ends at once.
///
/// # Errors
/// Why the system refuses it.
pub fn grants_real_time() -> Result<(), String> {
    let tried = std::thread::spawn(|| ask(Ring::Guard)).join();
    tried.unwrap_or_else(|_| Err("the thread that tried ended early".to_owned()))
}

fn ask(ring: Ring) -> Result<(), String> {
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let priority = ring.priority().try_into().map(ThreadPriority::Crossplatform);
    let priority = priority.map_err(|_| "priority out of range".to_owned())?;
    set_thread_priority_and_policy(thread_native_id(), priority, policy).map_err(|error| error.to_string())
}
