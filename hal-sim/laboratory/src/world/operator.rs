//! The person with the key: presses the emergency stop when the plan says so, resets when the robot waits for it, and gives
//! the start command, after power-up and after each reset.

use floorguard_guard::GuardState;
use floorguard_operator::panel::Order;

/// How long a human looks around before pressing reset, microseconds.
const RESET_DELAY_US: u64 = 3_000_000;

/// What the operator does now.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OperatorAction {
    /// The emergency stop is pressed.
    pub pressed: bool,
    /// Reset is pressed once.
    pub reset: bool,
    /// Start is pressed once.
    pub start: bool,
    /// It is the first start of the run.
    pub begins: bool,
}

impl OperatorAction {
    /// The buttons that are pressed. Where somebody sits at a panel the run is begun for them, and they press the rest.
    pub fn orders(self, operated: bool) -> Option<Order> {
        match (self.reset, self.start) {
            (true, _) if !operated => Some(Order::Reset),
            (false, true) if !operated || self.begins => Some(Order::Start),
            _ => None,
        }
    }
}

/// A scripted operator.
#[derive(Clone, Debug)]
pub struct Operator {
    presses_us: Vec<(u64, u64)>,
    latched_since_us: Option<u64>,
    resets: u32,
    starts: u32,
}

impl Operator {
    /// Who presses the emergency stop within these times.
    pub const fn new(presses_us: Vec<(u64, u64)>) -> Self {
        Self { presses_us, latched_since_us: None, resets: 0, starts: 0 }
    }

    /// Observes the robot.
    pub fn act(&mut self, now_us: u64, state: GuardState) -> OperatorAction {
        let pressed = self.presses_us.iter().any(|(from, to)| (*from..*to).contains(&now_us));
        if pressed || state != GuardState::Latched {
            self.latched_since_us = None;
            let start = !pressed && state == GuardState::AwaitsStart;
            let begins = start && self.starts == 0;
            self.starts += u32::from(start);
            return OperatorAction { pressed, reset: false, start, begins };
        }
        let since_us = *self.latched_since_us.get_or_insert(now_us);
        let reset = now_us - since_us >= RESET_DELAY_US;
        if reset {
            self.latched_since_us = None;
            self.resets += 1;
        }
        OperatorAction { pressed, reset, ..OperatorAction::default() }
    }

    /// Times that reset was pressed.
    pub const fn resets(&self) -> u32 {
        self.resets
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn start_releases_only_what_awaits_it() {
        let mut operator = Operator::new(vec![(1_000_000, 2_000_000)]);
        let action = operator.act(0, GuardState::AwaitsStart);
        assert_eq!(action, OperatorAction { start: true, begins: true, ..OperatorAction::default() });
        assert!(!operator.act(1_500_000, GuardState::AwaitsStart).start);
        assert!(!operator.act(2_500_000, GuardState::Init).start);
        assert_eq!(operator.starts, 1);
    }

    #[test]
    fn resets_only_what_is_latched_and_released() {
        let mut operator = Operator::new(vec![(1_000_000, 5_000_000)]);
        let mut resets = Vec::new();
        for step in 0..100_u64 {
            let now_us = step * 100_000;
            let state = if now_us >= 1_000_000 { GuardState::Latched } else { GuardState::Run };
            let action = operator.act(now_us, state);
            assert_eq!(action.pressed, (1_000_000..5_000_000).contains(&now_us));
            if action.reset {
                resets.push(now_us);
            }
        }
        assert_eq!(resets, [8_000_000]);
        assert_eq!(operator.resets(), 1);
    }
}
