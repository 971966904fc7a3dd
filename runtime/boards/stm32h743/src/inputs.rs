//! Emergency stop, bumpers and cliff sensors on pins, two channels each. They can only stop: only the safety controller
//! on the bus reports that all is clear.

use embassy_stm32::gpio::Input;
use embassy_time::{Duration, Ticker};
use floorguard_board_support::RobotShared;
use floorguard_types::sensing::{DiscreteInputs, SafetyInput};
use floorguard_runtime::clock;

/// How often the pins are read; test pulses of the devices are shorter and filtered in hardware.
const READ_EVERY: Duration = Duration::from_millis(5);
/// Both channels must agree within this many readings: 50 ms.
const DISCREPANCY_READINGS: u8 = 10;

/// Two channels of one input, low = danger or cut.
pub struct Pair {
    pub channels: [Input<'static>; 2],
    pub disagreed: u8,
}

impl Pair {
    fn judge(&mut self) -> SafetyInput {
        let [first, second] = [self.channels[0].is_high(), self.channels[1].is_high()];
        self.disagreed = if first == second { 0 } else { self.disagreed.saturating_add(1) };
        match (first, second) {
            (true, true) => SafetyInput::Clear,
            _ if self.disagreed > DISCREPANCY_READINGS => SafetyInput::Fault,
            _ => SafetyInput::Active,
        }
    }
}

/// Guard ring. Order: emergency stop, bumper front and rear, cliff front and rear.
#[embassy_executor::task]
pub async fn direct_inputs(shared: &'static RobotShared, mut pairs: [Pair; 5]) {
    let mut ticker = Ticker::every(READ_EVERY);
    loop {
        ticker.next().await;
        let now = clock::now();
        let [emergency_stop, bumper_front, bumper_rear, cliff_front, cliff_rear] =
            pairs.each_mut().map(Pair::judge);
        let inputs =
            DiscreteInputs { stamp: now, emergency_stop, bumper_front, bumper_rear, cliff_front, cliff_rear };
        // Saying "clear" here would hide that the safety controller has fallen silent.
        if inputs != DiscreteInputs::all_clear(now) {
            shared.decide(|guard| guard.on_discrete(&inputs, now));
        }
    }
}

/// Readings after which a button counts as pressed or released: 30 ms, contacts bounce for less.
const STEADY_READINGS: u8 = 6;

/// A push button of the operator, high = pressed. It acts when it is released (ISO 13849-1, 5.2.2): one that is stuck or
/// tied down does nothing.
pub struct Button {
    pub input: Input<'static>,
    pub is_pressed: bool,
    pub steady: u8,
}

impl Button {
    /// A reading; true when the button has just been released.
    fn is_released(&mut self) -> bool {
        let reads = self.input.is_high();
        self.steady = if reads == self.is_pressed { 0 } else { self.steady.saturating_add(1) };
        if self.steady < STEADY_READINGS {
            return false;
        }
        self.steady = 0;
        core::mem::replace(&mut self.is_pressed, reads)
    }
}

/// Guard ring. Order: reset, start.
#[embassy_executor::task]
pub async fn operator_buttons(shared: &'static RobotShared, buttons: [Button; 2]) {
    let [mut reset, mut start] = buttons;
    let mut ticker = Ticker::every(READ_EVERY);
    loop {
        ticker.next().await;
        if reset.is_released() {
            shared.reset.signal(());
        }
        if start.is_released() {
            shared.start.signal(());
        }
    }
}
