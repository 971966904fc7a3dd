//! Lidar datagrams: each is judged by the guard before any other use.

use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_time::Timer;
use floorguard_drivers::lidar::LidarDecoder;
use floorguard_guard::{FaultKind, Source};
use floorguard_types::profile::Native;

use crate::clock;
use crate::io::DatagramReceiver;
use crate::shared::{QueuedPacket, Shared};

/// Longer than the largest datagram, so that a longer one does not pass for a right one: on a microcontroller that of the Velodyne
/// family (1,206 bytes), elsewhere that of an Ouster with 128 beams and two echoes (33,024 bytes).
const DATAGRAM_BYTES: usize = if cfg!(target_os = "none") { 1_300 } else { 33_100 };
/// More than one firing of a packet is remembered where the guard is set up for it: a microcontroller has no time for that.
const HAS_TIME: bool = cfg!(not(target_os = "none"));
/// Pause after a failure of the socket, milliseconds.
const RETRY_MS: u64 = 50;

/// Guard ring. Runs for ever.
pub async fn lidar_input<M: RawMutex>(
    shared: &Shared<M>,
    mut socket: impl DatagramReceiver,
    mut decoder: impl LidarDecoder<Native>,
) {
    let mut buffer = [0; DATAGRAM_BYTES];
    let mut newest = QueuedPacket::EMPTY;
    loop {
        let Ok(received) = socket.receive(&mut buffer).await else {
            shared.count(|links| links.lidar_errors = links.lidar_errors.saturating_add(1));
            shared.decide(|guard| guard.on_source_fault(Source::Lidar, FaultKind::LinkDown, clock::now()));
            Timer::after_millis(RETRY_MS).await;
            continue;
        };
        let bytes = buffer.get(..received.length).unwrap_or_default();
        match decoder.decode_datagram(bytes, received.arrival, &mut newest.packet) {
            Ok(lost_before) => {
                socket.keep_sender();
                newest.lost_before = lost_before;
                shared.decide(|guard| guard.on_lidar_packet(&newest.packet, clock::now()));
                shared.remember(|guard| guard.remember_packet(&newest.packet));
                if HAS_TIME {
                    shared.remember(|guard| guard.remember_more(&newest.packet));
                }
                // The guard has judged its rings; a sweep, in which people are looked for, has fewer than some lidars.
                decoder.arrange_for_people(&mut newest.packet);
                shared.packets.push(|slot| slot.copy_from(&newest));
                let (odd, closed) = (decoder.left_out_block(), decoder.known_closed_sector());
                if odd.is_some() || closed.is_some() {
                    shared.complain(|complaints| {
                        complaints.lidar = odd.or(complaints.lidar);
                        complaints.lidar_closed = closed;
                    });
                }
            }
            // One bad datagram is no fault of the device; if no good one comes, its age stops the robot.
            Err(error) => {
                if error.is_corruption() {
                    shared.decide(|guard| guard.on_corruption(clock::now()));
                }
                shared.complain(|complaints| complaints.lidar = Some(error));
                shared.count(|links| links.lidar_refused = links.lidar_refused.saturating_add(1));
            }
        }
    }
}
