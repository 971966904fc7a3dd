//! Two lidars in one network: the one whose datagrams the robot understood first is its own.

use std::net::UdpSocket;

use crate::sim_support::{bytes_of, room};
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use floorguard_drivers::velodyne::{Decoder, ModelChoice};
use floorguard_guard::{Health, Source};
use floorguard_host::carriers::UdpReceiver;
use floorguard_host::executor::{TaskSet, advance_virtual, use_virtual_clock};
use floorguard_laboratory::world::Plan;
use floorguard_robot::assembly::new_shared;
use floorguard_runtime::tasks::lidar_input;
use floorguard_sim::{Simulation, Stream};
use floorguard_types::geometry::Pose2;
use floorguard_types::time::Stamp;

/// How the guard finds a lidar that sends from the first address for 300 ms, and from the second one for 500 ms more.
fn health_of(addresses: [&str; 2]) -> Health {
    let receiver = UdpReceiver::bind("127.0.0.1:0".parse().unwrap()).unwrap();
    let port = receiver.local_address().unwrap();
    let [first, second] = addresses.map(|address| UdpSocket::bind(address).unwrap());
    use_virtual_clock(0);
    let plan = Plan::named("corridor", 1, 1_000_000).unwrap();
    let shared = new_shared::<NoopRawMutex>(&plan.robot, Stamp::ZERO).unwrap();
    let mut tasks = TaskSet::new();
    tasks.spawn(lidar_input(&*shared, receiver, Decoder::new(ModelChoice::Auto)));
    let mut simulation = Simulation::new(&room(Pose2::new(0.7, -0.4, 0.5)), 1).unwrap();
    simulation.advance_to(800_000, &mut |event| {
        let Some(bytes) = bytes_of(&event, Stream::LidarData) else { return };
        advance_virtual(event.at_us);
        let socket = if event.at_us < 300_000 { &first } else { &second };
        assert_eq!(socket.send_to(bytes, port).unwrap(), bytes.len());
        tasks.poll_until_quiet().unwrap();
    });
    let now = Stamp::from_micros(800_000);
    shared.decide(|guard| guard.tick(now));
    shared.inspect(|guard| guard.health()[Source::Lidar.index()].health)
}

#[test]
fn fg_req_037_another_lidar_replaces_no_dead_one() {
    assert_eq!(
        health_of(["127.0.0.1:0", "127.0.0.1:0"]),
        Health::Healthy,
        "the same device from another port"
    );
    assert_eq!(health_of(["127.0.0.1:0", "127.0.0.2:0"]), Health::Stale, "a neighbour's");
}
