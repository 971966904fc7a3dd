//! Two lidars in one network: the one whose datagrams the robot understood first is its own.

use std::collections::VecDeque;

use crate::sim_support::{bytes_of, room};
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use floorguard_drivers::velodyne::{Decoder, ModelChoice};
use floorguard_guard::{Health, Source};
use floorguard_host::executor::{TaskSet, use_virtual_clock};
use floorguard_laboratory::world::Plan;
use floorguard_robot::assembly::new_shared;
use floorguard_runtime::io::{DatagramReceiver, FirstSender, Received};
use floorguard_runtime::tasks::lidar_input;
use floorguard_sim::{Simulation, Stream};
use floorguard_types::geometry::Pose2;
use floorguard_types::time::Stamp;

const END_US: u64 = 800_000;

/// A port with datagrams that have arrived: sender, microseconds, bytes. Then nothing more comes.
struct Port {
    arrived: VecDeque<(char, u64, Vec<u8>)>,
    first: FirstSender<char>,
}

impl DatagramReceiver for Port {
    type Error = std::convert::Infallible;

    async fn receive(&mut self, buffer: &mut [u8]) -> Result<Received, Self::Error> {
        while let Some((sender, at_us, datagram)) = self.arrived.pop_front() {
            if self.first.hears(sender) {
                buffer[..datagram.len()].copy_from_slice(&datagram);
                return Ok(Received { length: datagram.len(), arrival: Stamp::from_micros(at_us) });
            }
        }
        std::future::pending().await
    }

    fn keep_sender(&mut self) {
        self.first.keep();
    }
}

/// How the guard finds a lidar that one sends for 300 ms, and another one for 500 ms more. Before both there is noise of a
/// third one.
fn health_of(senders: [char; 2]) -> Health {
    let mut arrived = VecDeque::from([('x', 0, vec![7; 33])]);
    let mut simulation = Simulation::new(&room(Pose2::new(0.7, -0.4, 0.5)), 1).unwrap();
    simulation.advance_to(END_US, &mut |event| {
        if let Some(bytes) = bytes_of(&event, Stream::LidarData) {
            arrived.push_back((senders[usize::from(event.at_us > 300_000)], event.at_us, bytes.to_vec()));
        }
    });
    use_virtual_clock(END_US);
    let now = Stamp::from_micros(END_US);
    let plan = Plan::named("corridor", 1, END_US).unwrap();
    let shared = new_shared::<NoopRawMutex>(&plan.robot, now).unwrap();
    let mut tasks = TaskSet::new();
    let port = Port { arrived, first: FirstSender::UNKNOWN };
    tasks.spawn(lidar_input(&*shared, port, Decoder::new(ModelChoice::Auto)));
    tasks.poll_until_quiet().unwrap();
    shared.inspect(|guard| guard.health()[Source::Lidar.index()].health)
}

#[test]
fn fg_req_037_another_lidar_replaces_no_dead_one() {
    assert_eq!(health_of(['a', 'a']), Health::Healthy);
    assert_eq!(health_of(['a', 'b']), Health::Stale, "another robot's");
}
