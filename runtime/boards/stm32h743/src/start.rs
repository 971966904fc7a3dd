//! Start-up: clocks, pins, both executors.

use core::arch::global_asm;

use cortex_m_rt::entry;
use defmt_rtt as _;
use embassy_executor::{Executor, InterruptExecutor, Spawner};
use embassy_stm32::can::CanConfigurator;
use embassy_stm32::eth::Ethernet;
use embassy_stm32::gpio::{AnyPin, Input, Pull};
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::usart::BufferedUart;
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_stm32::{Peri, Peripherals, bind_interrupts, peripherals};
use floorguard_board_support::{RobotShared, robot, share, start_perception_ring};
use floorguard_runtime::configuration::RobotConfiguration;
use panic_probe as _;
use static_cell::StaticCell;

use crate::can::FdcanBus;
use crate::guard_ring::{Devices, spawn_ring};
use crate::inputs::{Button, Pair};
use crate::{clocks, network, serial};

const SCANNER_BAUD: u32 = 500_000;
/// Bit rate of the inertial sensor.
pub const IMU_BAUD: u32 = 115_200;
const CAN_BITS_PER_SECOND: u32 = 500_000;
const WATCHDOG_US: u32 = 100_000;

bind_interrupts!(struct Irqs {
    ETH => embassy_stm32::eth::InterruptHandler;
    USART2 => embassy_stm32::usart::BufferedInterruptHandler<peripherals::USART2>;
    USART6 => embassy_stm32::usart::BufferedInterruptHandler<peripherals::USART6>;
    FDCAN1_IT0 => embassy_stm32::can::IT0InterruptHandler<peripherals::FDCAN1>;
    FDCAN1_IT1 => embassy_stm32::can::IT1InterruptHandler<peripherals::FDCAN1>;
});

// The stack lies in SRAM1 to 3, whose clocks are off after a reset: on before the first push. RCC_AHB2ENR, bits 29 to 31.
global_asm!(
    ".section .text.__pre_init, \"ax\"",
    ".global __pre_init",
    ".type __pre_init, %function",
    ".thumb_func",
    "__pre_init:",
    "ldr r0, =0x580244dc",
    "ldr r1, [r0]",
    "orr r1, r1, #0xe0000000",
    "str r1, [r0]",
    // Two cycles until the clock runs: the read waits for the write.
    "ldr r1, [r0]",
    "b __zero_dtcm",
);

static GUARD: InterruptExecutor = InterruptExecutor::new();
static PERCEPTION: StaticCell<Executor> = StaticCell::new();
#[unsafe(link_section = ".dtcm.robot")]
static ROBOT: StaticCell<RobotConfiguration> = StaticCell::new();

/// No device of this robot has this line: it carries the guard's executor.
#[interrupt]
unsafe fn CEC() {
    // SAFETY: this is the handler of the line that the executor was started with.
    unsafe { GUARD.on_interrupt() }
}

#[entry]
fn main() -> ! {
    let chip = embassy_stm32::init(clocks::config());
    let robot = ROBOT.init(robot());
    let shared = match share(robot) {
        Ok(shared) => shared,
        Err(_) => defmt::panic!("the guard refuses the robot"),
    };
    interrupt::CEC.set_priority(Priority::P6);
    // What the devices are made of may be sent to the guard's executor, where they stay.
    GUARD.start(interrupt::CEC).spawn(guard_ring(shared, robot, chip).unwrap());
    PERCEPTION.init(Executor::new()).run(|spawner| start_perception_ring(spawner, shared, robot))
}

#[embassy_executor::task]
async fn guard_ring(shared: &'static RobotShared, robot: &'static RobotConfiguration, chip: Peripherals) {
    // SAFETY: the spawner stays in this task, which stays on its executor.
    let spawner = unsafe { Spawner::for_current_executor().await };
    spawn_ring(spawner, shared, robot, devices(chip));
}

fn devices(chip: Peripherals) -> Devices {
    let ethernet = Ethernet::new(
        network::QUEUE.init_with(network::Queue::new),
        chip.ETH,
        Irqs,
        chip.PA1,
        chip.PA7,
        chip.PC4,
        chip.PC5,
        chip.PG13,
        chip.PB13,
        chip.PG11,
        network::HARDWARE_ADDRESS,
        chip.ETH_SMA,
        chip.PA2,
        chip.PC1,
    );
    let buffers = serial::SCANNER.init_with(serial::Buffers::new);
    let scanner = BufferedUart::new(
        chip.USART2,
        chip.PD6,
        chip.PD5,
        &mut buffers.send,
        &mut buffers.receive,
        Irqs,
        serial::config(SCANNER_BAUD),
    );
    let buffers = serial::IMU.init_with(serial::Buffers::new);
    let imu = BufferedUart::new(
        chip.USART6,
        chip.PC7,
        chip.PC6,
        &mut buffers.send,
        &mut buffers.receive,
        Irqs,
        serial::config(IMU_BAUD),
    );
    let mut can = CanConfigurator::new(chip.FDCAN1, chip.PD0, chip.PD1, Irqs);
    can.set_bitrate(CAN_BITS_PER_SECOND);
    Devices {
        ethernet,
        // The rates are within what the lines can do at this clock: the configuration cannot be refused.
        scanner: scanner.unwrap(),
        imu: imu.unwrap(),
        can: FdcanBus(can.into_normal_mode()),
        inputs: [
            pair(chip.PE2.into(), chip.PE4.into()),
            pair(chip.PE5.into(), chip.PE6.into()),
            pair(chip.PE3.into(), chip.PF8.into()),
            pair(chip.PF7.into(), chip.PF9.into()),
            pair(chip.PG0.into(), chip.PG1.into()),
        ],
        buttons: [button(chip.PG2.into()), button(chip.PG3.into())],
        watchdog: IndependentWatchdog::new(chip.IWDG1, WATCHDOG_US),
    }
}

/// Pulled down: a cut wire reads as not pressed.
fn button(pin: Peri<'static, AnyPin>) -> Button {
    Button { input: Input::new(pin, Pull::Down), is_pressed: false, steady: 0 }
}

/// Pulled down: a cut wire reads as danger.
fn pair(first: Peri<'static, AnyPin>, second: Peri<'static, AnyPin>) -> Pair {
    Pair { channels: [Input::new(first, Pull::Down), Input::new(second, Pull::Down)], disagreed: 0 }
}
