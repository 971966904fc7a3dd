//! Velocities of a ROS 2 program, as the guard takes them from any program outside: frames of the velocity link, over the loopback.
//!
//! A `Twist` has neither a number nor a deadline. The number is that of the DDS sample and the moment is that of its writing, so that
//! what the link says of late, repeated and swapped requests and of other senders holds here, too.

use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash as _, Hasher as _};
use std::io;
use std::net::{Ipv4Addr, SocketAddr, UdpSocket};

use floorguard_drivers::velocity_link::{StopDemand, VelocityRequest};
use floorguard_recording::cdr::Decoder;
use floorguard_types::geometry::Twist2;

use super::dds::Sample;

/// Bytes of a `Twist`: six doubles behind the header of the message.
const TWIST_BYTES: usize = 4 + 48;

/// Which velocities are taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VelocityRoute {
    /// The topic, such as `/cmd_vel`.
    pub topic: String,
    /// How long a velocity holds, milliseconds.
    pub deadline_ms: u16,
}

/// The way to the guard: two ports of the loopback.
#[derive(Debug)]
pub struct VelocityFeed {
    socket: UdpSocket,
    guard: SocketAddr,
}

impl VelocityFeed {
    /// Chooses two free ports.
    ///
    /// # Errors
    /// The computer has none.
    pub fn open() -> io::Result<Self> {
        let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0))?;
        // The guard's task binds it itself; until then nobody else is given it.
        let guard = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0))?.local_addr()?;
        socket.set_nonblocking(true)?;
        Ok(Self { socket, guard })
    }

    /// Where the guard's task is to listen, and the only sender that it is to hear.
    ///
    /// # Errors
    /// The socket has no address.
    pub fn addresses(&self) -> io::Result<(SocketAddr, SocketAddr)> {
        Ok((self.guard, self.socket.local_addr()?))
    }

    fn send(&self, request: &VelocityRequest) {
        // Before the guard listens and after it has ended there is nobody to hear; the robot stands then.
        let _ = self.socket.send_to(&request.encode(), self.guard);
    }
}

/// From samples to frames.
#[derive(Debug)]
pub struct Velocities {
    feed: VelocityFeed,
    deadline_ms: u16,
    newest: Option<(u32, u32)>,
}

impl Velocities {
    /// Takes velocities for the guard.
    pub fn new(feed: VelocityFeed, route: &VelocityRoute) -> Self {
        Self { feed, deadline_ms: route.deadline_ms, newest: None }
    }

    /// A sample has come; false when it is no velocity.
    pub fn take(&mut self, sample: &Sample) -> bool {
        let Some(twist) = twist_of(sample.value()) else { return false };
        let info = sample.sample_info();
        let identity = info.sample_identity();
        let sender = sender_of(&identity.writer_guid.to_bytes());
        let sequence = identity.sequence_number.low();
        // Readers of both types share the topic's samples: each comes once for each of them.
        if self.newest.replace((sender, sequence)) != Some((sender, sequence)) {
            let sent_ms = info.source_timestamp().map_or(0, |stamp| milliseconds(stamp.to_ticks()));
            let (deadline_ms, stop) = (self.deadline_ms, StopDemand::None);
            self.feed.send(&VelocityRequest { sender, sequence, sent_ms, deadline_ms, stop, twist });
        }
        true
    }
}

/// A writer's name as a number that is not 0.
fn sender_of(name: &[u8; 16]) -> u32 {
    let mut hasher = DefaultHasher::new();
    name.hash(&mut hasher);
    (hasher.finish() as u32).max(1)
}

/// Seconds in the upper half, their fraction in the lower; milliseconds that wrap.
const fn milliseconds(ticks: u64) -> u32 {
    let (seconds, fraction) = (ticks >> 32, ticks & 0xffff_ffff);
    (seconds.wrapping_mul(1_000).wrapping_add((fraction * 1_000) >> 32)) as u32
}

/// Speed ahead and rate about the vertical of a `Twist` or a `TwistStamped`. The other four numbers are no motion of a robot on wheels.
fn twist_of(message: &[u8]) -> Option<Twist2> {
    let mut decoder = Decoder::new(message)?;
    if message.len() != TWIST_BYTES {
        let (_, _, _) = (decoder.i32()?, decoder.u32()?, decoder.text()?);
    }
    let [ahead, .., turn] = decoder.f64s::<6>()?;
    Some(Twist2 { linear_mps: ahead as f32, angular_radps: turn as f32 })
}

#[cfg(test)]
mod tests {
    use floorguard_recording::cdr::Encoder;

    use super::*;

    const NUMBERS: [f64; 6] = [0.5, 0.1, 0.2, 0.3, 0.4, -0.25];

    #[test]
    fn both_types_of_velocity_are_read() {
        let expected = Twist2 { linear_mps: 0.5, angular_radps: -0.25 };
        let mut plain = Encoder::new();
        plain.f64s(&NUMBERS);
        let plain = plain.finish();
        assert_eq!(twist_of(&plain), Some(expected));
        for frame in ["", "base_link", "abc"] {
            let mut stamped = Encoder::new();
            stamped.i32(1).u32(2).text(frame).f64s(&NUMBERS);
            assert_eq!(twist_of(&stamped.finish()), Some(expected), "{frame}");
        }
        assert!((0..plain.len()).all(|cut| twist_of(&plain[..cut]).is_none()));
    }

    #[test]
    fn clock_of_the_sender_wraps() {
        assert_eq!(milliseconds(1 << 32), 1_000);
        assert_eq!(milliseconds((2 << 32) | 0x8000_0000), 2_500);
        assert_eq!(milliseconds(4_294_968 << 32), 704);
        assert_ne!(sender_of(&[0; 16]), sender_of(&[1; 16]));
    }

    #[test]
    fn guard_and_feed_have_different_ports() {
        let (guard, own) = VelocityFeed::open().unwrap().addresses().unwrap();
        assert!(guard.ip().is_loopback() && own.ip().is_loopback() && guard.port() != own.port());
    }
}
