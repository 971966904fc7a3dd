//! Everything that can stop the robot, on the executor of interrupt priority. One thin wrapper per task.

use core::mem::MaybeUninit;

use embassy_executor::{SendSpawner, Spawner};
use embassy_net::Runner;
use embassy_time::Instant;
use floorguard_board_support::{
    KeptBox, RobotShared, feed_while_deciding, keep_black_box, send_black_box, spawn_deciders,
};
use floorguard_drivers::s300::{Configuration, Receiver};
use floorguard_drivers::three_wheel_base::ThreeWheelBase;
use floorguard_drivers::velodyne::{Decoder, ModelChoice};
use floorguard_drivers::xsens::Device;
use floorguard_localisation::odometry::Tricycle;
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_runtime::io::SlcanBus;
use floorguard_runtime::kept_latches::KeptLatches;
use floorguard_runtime::tasks::{can_bus, imu_input, lidar_input, scanner_input};
use floorguard_types::geometry::Transform3;

use super::bench_link;
use super::network::{self, LidarSocket};
use super::options::Options;
use crate::ethernet::Ethernet;
use crate::faults::{Fault, break_guard, planned_ms};
use crate::uart::{self, Port};
use crate::{crash_record, watchdog};

/// Bit rates of the lines; the emulator does not simulate them.
const SCANNER_BAUD: u32 = 500_000;
const IMU_BAUD: u32 = 115_200;
const CAN_BAUD: u32 = 1_000_000;
const BLACK_BOX_BAUD: u32 = 115_200;

#[unsafe(link_section = ".kept.black_box")]
static KEPT: MaybeUninit<KeptBox> = MaybeUninit::uninit();
#[unsafe(link_section = ".kept.latches")]
static LATCHES: MaybeUninit<KeptLatches> = MaybeUninit::uninit();

/// Starts the ring. `robot` lives as long as the program.
pub fn start_guard_ring(
    spawner: SendSpawner,
    shared: &'static RobotShared,
    robot: &'static RobotConfiguration,
    options: Options,
) {
    spawner.spawn(ring(shared, robot, options).unwrap());
}

/// Starts the others: what they are made of may not leave this executor.
#[embassy_executor::task]
async fn ring(shared: &'static RobotShared, robot: &'static RobotConfiguration, options: Options) {
    // SAFETY: the spawner stays in this task, which stays on its executor.
    let spawner = unsafe { Spawner::for_current_executor().await };
    uart::SCANNER.start(SCANNER_BAUD);
    uart::IMU.start(IMU_BAUD);
    uart::CAN.start(CAN_BAUD);
    let (stack, runner) = network::stack(Ethernet::start());
    let choice = robot.lidar_model().map_or(ModelChoice::Auto, ModelChoice::Fixed);
    spawner.spawn(network(runner).unwrap());
    spawner.spawn(lidar(shared, LidarSocket::open(stack), Decoder::new(choice)).unwrap());
    spawner.spawn(scanner(shared).unwrap());
    if let Some(configured) = robot.imu {
        spawner.spawn(imu(shared, configured.mounting.transform()).unwrap());
    }
    spawner.spawn(can(shared, (ThreeWheelBase::new(robot.base()), robot.tricycle())).unwrap());
    // SAFETY: any bits are valid atomic words.
    spawn_deciders(spawner, shared, unsafe { LATCHES.assume_init_ref() });
    // SAFETY: any bits are a valid value; rows are recognised by their checksums.
    let kept = unsafe { KEPT.assume_init_ref() };
    kept.begin();
    uart::BLACK_BOX.start(BLACK_BOX_BAUD);
    spawner.spawn(keep(shared, kept).unwrap());
    spawner.spawn(tell(kept).unwrap());
    spawner.spawn(watchdog(shared, options.fault).unwrap());
    if let Some(fault) = options.fault {
        spawner.spawn(break_guard(shared, fault).unwrap());
    }
    spawner.spawn(bench_link::lateness().unwrap());
    if options.bench {
        spawner.spawn(bench_link::bench_link(shared, network::bench_socket(stack)).unwrap());
    }
}

/// Feeds the watchdog for as long as the guard decides.
#[embassy_executor::task]
async fn watchdog(shared: &'static RobotShared, fault: Option<Fault>) {
    feed_while_deciding(shared, || {
        let is_time = planned_ms() != 0 && Instant::now().as_millis() >= planned_ms().into();
        if fault != Some(Fault::Starvation) || !is_time {
            watchdog::feed();
        }
    })
    .await;
}

#[embassy_executor::task]
async fn keep(shared: &'static RobotShared, kept: &'static KeptBox) {
    keep_black_box(shared, kept).await;
}

#[embassy_executor::task]
async fn tell(kept: &'static KeptBox) {
    // The port cannot fail.
    let _ = send_black_box(kept, crash_record::restart(), Port(&uart::BLACK_BOX)).await;
}

#[embassy_executor::task]
async fn network(mut runner: Runner<'static, Ethernet>) -> ! {
    runner.run().await
}

#[embassy_executor::task]
async fn lidar(shared: &'static RobotShared, socket: LidarSocket, decoder: Decoder) {
    lidar_input(shared, socket, decoder).await;
}

#[embassy_executor::task]
async fn scanner(shared: &'static RobotShared) {
    scanner_input(shared, Port(&uart::SCANNER), Receiver::new(Configuration::default())).await;
}

#[embassy_executor::task]
async fn imu(shared: &'static RobotShared, mounting: Transform3) {
    imu_input(shared, Port(&uart::IMU), (Device::new(IMU_BAUD), mounting)).await;
}

#[embassy_executor::task]
async fn can(shared: &'static RobotShared, base: (ThreeWheelBase, Tricycle)) {
    can_bus(shared, SlcanBus::new(Port(&uart::CAN)), base).await;
}
