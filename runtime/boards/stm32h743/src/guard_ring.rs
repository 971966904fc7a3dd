//! Everything that can stop the robot, on the executor of interrupt priority. One thin wrapper per task.

use core::mem::MaybeUninit;

use embassy_executor::Spawner;
use embassy_net::Runner;
use embassy_stm32::peripherals::IWDG1;
use embassy_stm32::wdg::IndependentWatchdog;
use floorguard_board_support::{RobotShared, feed_while_deciding, spawn_deciders};
use floorguard_types::geometry::Transform3;
use floorguard_localisation::odometry::Tricycle;
use floorguard_drivers::s300::{Configuration, Receiver};
use floorguard_drivers::three_wheel_base::ThreeWheelBase;
use floorguard_drivers::velodyne::{Decoder, ModelChoice};
use floorguard_drivers::xsens::Device as ImuDevice;
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_runtime::kept_latches::KeptLatches;
use floorguard_runtime::tasks::{can_bus, imu_input, lidar_input, scanner_input};

use crate::can::FdcanBus;
use crate::inputs::{Button, Pair, direct_inputs, operator_buttons};
use crate::network::{self, Device, LidarSocket};
use crate::serial::Line;
use crate::start::IMU_BAUD;

/// The devices of the ring.
pub struct Devices {
    pub ethernet: Device,
    pub scanner: Line,
    pub imu: Line,
    pub can: FdcanBus,
    pub inputs: [Pair; 5],
    /// Reset, start.
    pub buttons: [Button; 2],
    pub watchdog: IndependentWatchdog<'static, IWDG1>,
}

/// In SRAM4, which neither start-up code nor loader writes.
#[unsafe(link_section = ".kept.latches")]
static LATCHES: MaybeUninit<KeptLatches> = MaybeUninit::uninit();

/// Starts all tasks of the ring on the executor that runs this.
pub fn spawn_ring(
    spawner: Spawner,
    shared: &'static RobotShared,
    robot: &'static RobotConfiguration,
    devices: Devices,
) {
    let (stack, runner) = network::stack(devices.ethernet);
    let choice = robot.lidar_model().map_or(ModelChoice::Auto, ModelChoice::Fixed);
    spawner.spawn(network_task(runner).unwrap());
    spawner.spawn(lidar(shared, LidarSocket::open(stack), Decoder::new(choice)).unwrap());
    spawner.spawn(scanner(shared, devices.scanner).unwrap());
    if let Some(configured) = robot.imu {
        spawner.spawn(imu(shared, devices.imu, configured.mounting.transform()).unwrap());
    }
    let base = (ThreeWheelBase::new(robot.base()), robot.tricycle());
    spawner.spawn(can(shared, devices.can, base).unwrap());
    spawner.spawn(direct_inputs(shared, devices.inputs).unwrap());
    // SAFETY: any bits are valid atomic words.
    spawn_deciders(spawner, shared, unsafe { LATCHES.assume_init_ref() });
    spawner.spawn(operator_buttons(shared, devices.buttons).unwrap());
    spawner.spawn(watchdog(shared, devices.watchdog).unwrap());
}

/// Feeds the watchdog for as long as the guard decides.
#[embassy_executor::task]
async fn watchdog(shared: &'static RobotShared, mut watchdog: IndependentWatchdog<'static, IWDG1>) {
    watchdog.unleash();
    feed_while_deciding(shared, || watchdog.pet()).await;
}

#[embassy_executor::task]
async fn network_task(mut runner: Runner<'static, Device>) -> ! {
    runner.run().await
}

#[embassy_executor::task]
async fn lidar(shared: &'static RobotShared, socket: LidarSocket, decoder: Decoder) {
    lidar_input(shared, socket, decoder).await;
}

#[embassy_executor::task]
async fn scanner(shared: &'static RobotShared, line: Line) {
    scanner_input(shared, line, Receiver::new(Configuration::default())).await;
}

#[embassy_executor::task]
async fn imu(shared: &'static RobotShared, line: Line, mounting: Transform3) {
    imu_input(shared, line, (ImuDevice::new(IMU_BAUD), mounting)).await;
}

#[embassy_executor::task]
async fn can(shared: &'static RobotShared, bus: FdcanBus, base: (ThreeWheelBase, Tricycle)) {
    can_bus(shared, bus, base).await;
}
