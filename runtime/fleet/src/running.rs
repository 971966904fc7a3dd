//! Actions of the node where the vehicle stands (VDA 5050 2.1.0, chapters 6.11 and 6.12): what runs, what waits for it, and what comes of it.

use serde::{Deserialize, Serialize};

use super::cleaning::{CLEAN_ACTION, cleaning_of};
use super::messages::{Action, ActionState};
use super::vehicle::{CleaningMoment, CleaningStage, VehicleCommand, VehicleMoment};

/// A vehicle that has not begun a cleaning after so long does not begin it, seconds: making ready for a large floor takes some.
const BEGINS_WITHIN_S: f64 = 60.0;

/// An action that runs, or waits for one that does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct RunningAction {
    action: Action,
    /// Seconds that it still stands, or may still clean.
    left_s: f64,
    /// Number of its cleaning; 0: none was ordered.
    #[serde(default)]
    cleaning: u32,
    /// It was ordered of the vehicle, by this program or one before.
    #[serde(default)]
    ordered_before: bool,
    /// Since this cleaning was ordered of the vehicle by this program, seconds.
    #[serde(skip)]
    ordered_s: Option<f64>,
    /// The vehicle has reported it.
    #[serde(skip)]
    is_seen: bool,
}

/// How an action stands, and what it has come to.
struct Step {
    status: &'static str,
    result: Option<String>,
}

impl Step {
    const fn of(status: &'static str) -> Self {
        Self { status, result: None }
    }

    fn is_over(&self) -> bool {
        matches!(self.status, "FINISHED" | "FAILED")
    }
}

impl RunningAction {
    /// It begins with the node, or when those before it are done.
    fn new(action: Action) -> Self {
        let cleaned_s = || cleaning_of(&action, 0).map_or(0.0, |(_, longest_s)| longest_s);
        let left_s = if action.action_type == CLEAN_ACTION {
            cleaned_s()
        } else {
            action.number("duration").unwrap_or(0.0)
        };
        Self { action, left_s, cleaning: 0, ordered_before: false, ordered_s: None, is_seen: false }
    }

    fn stand(&mut self, lasted_s: f64) -> Step {
        self.left_s -= lasted_s;
        Step::of(if self.left_s <= 0.0 { "FINISHED" } else { "RUNNING" })
    }

    /// Gives what the vehicle is to do beside how it stands.
    fn clean(&mut self, lasted_s: f64, moment: &VehicleMoment) -> (Step, Option<VehicleCommand>) {
        let reported = moment.cleaning.as_ref().filter(|reported| reported.number == self.cleaning);
        match (reported, self.ordered_s) {
            (Some(reported), Some(_)) => self.watch(reported, lasted_s),
            // The vehicle's computer has lost its power meanwhile.
            (None, Some(_)) if self.is_seen => (Step::of("INITIALIZING"), self.order(true, moment)),
            (None, Some(waited_s)) if waited_s > BEGINS_WITHIN_S => {
                let result = Some(format!("the vehicle has not begun it within {BEGINS_WITHIN_S:.0} s"));
                (Step { status: "FAILED", result }, Some(VehicleCommand::EndCleaning))
            }
            (None, Some(waited_s)) => {
                self.ordered_s = Some(waited_s + lasted_s);
                (Step::of("INITIALIZING"), None)
            }
            // What a program before this one has ordered goes on.
            (_, None) => {
                let goes_on = self.ordered_before;
                (Step::of("INITIALIZING"), self.order(goes_on, moment))
            }
        }
    }

    fn order(&mut self, goes_on: bool, moment: &VehicleMoment) -> Option<VehicleCommand> {
        let (mut place, _) = cleaning_of(&self.action, self.cleaning).ok()?;
        if !moment.is_automatic {
            return None;
        }
        (self.ordered_s, self.is_seen, self.ordered_before) = (Some(0.0), false, true);
        place.goes_on = goes_on;
        Some(VehicleCommand::Clean(place))
    }

    fn watch(&mut self, reported: &CleaningMoment, lasted_s: f64) -> (Step, Option<VehicleCommand>) {
        self.is_seen = true;
        self.left_s -= lasted_s;
        let words = reported.words.as_str();
        let step = |status, result: String| Step { status, result: Some(result) };
        match &reported.stage {
            CleaningStage::Finished => (step("FINISHED", words.to_owned()), None),
            CleaningStage::Failed(why) => (step("FAILED", joined(why, words)), None),
            CleaningStage::Running if self.left_s <= 0.0 => {
                (step("FAILED", joined("maxDuration is over", words)), Some(VehicleCommand::EndCleaning))
            }
            CleaningStage::Running => (step("RUNNING", words.to_owned()), None),
        }
    }
}

/// A reason, and how far it was.
pub fn joined(why: &str, words: &str) -> String {
    if words.is_empty() { why.to_owned() } else { format!("{why}; {words}") }
}

/// The actions of the node where the vehicle stands that are not over.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NodeActions {
    running: Vec<RunningAction>,
    /// The last number of a cleaning.
    #[serde(default)]
    cleaning_number: u32,
    #[serde(skip)]
    due: Vec<VehicleCommand>,
    #[serde(skip)]
    failed: Vec<(Action, String)>,
}

impl NodeActions {
    /// None is left.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.running.is_empty()
    }

    /// They begin, after those that are not over.
    pub fn begin(&mut self, actions: Vec<Action>) {
        self.running.extend(actions.into_iter().map(RunningAction::new));
    }

    /// Nothing more comes of them.
    pub fn clear(&mut self) {
        self.running.clear();
        self.due.clear();
    }

    /// Names of those that are not over.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.running.iter().map(|one| one.action.action_id.as_str())
    }

    /// The vehicle must not drive meanwhile.
    #[must_use]
    pub fn block_drive(&self) -> bool {
        self.running.iter().any(|one| one.action.blocking_type != "NONE")
    }

    /// Runs them in their order, those that block hard alone. True when one of their states changed.
    pub fn run(&mut self, states: &mut [ActionState], (lasted_s, moment): (f64, &VehicleMoment)) -> bool {
        if moment.is_paused {
            return self.pause(states);
        }
        let (mut has_changed, mut is_blocked) = (false, false);
        let mut left = Vec::new();
        for mut one in std::mem::take(&mut self.running) {
            let is_hard = one.action.blocking_type == "HARD";
            if is_blocked || (is_hard && !left.is_empty()) {
                is_blocked = true;
                left.push(one);
                continue;
            }
            is_blocked = is_hard;
            let step = self.step(&mut one, lasted_s, moment);
            let is_over = step.is_over();
            has_changed |= self.set_state(states, &one.action, step);
            if !is_over {
                left.push(one);
            }
        }
        self.running = left;
        has_changed
    }

    fn step(&mut self, one: &mut RunningAction, lasted_s: f64, moment: &VehicleMoment) -> Step {
        if one.action.action_type != CLEAN_ACTION {
            return one.stand(lasted_s);
        }
        if one.cleaning == 0 {
            self.cleaning_number = self.cleaning_number.wrapping_add(1).max(1);
            one.cleaning = self.cleaning_number;
        }
        let (step, command) = one.clean(lasted_s, moment);
        self.due.extend(command);
        step
    }

    /// What runs is paused; what has not begun stays as it is.
    fn pause(&self, states: &mut [ActionState]) -> bool {
        let mut has_changed = false;
        for state in states {
            let runs = self.running.iter().any(|one| one.action.action_id == state.action_id);
            if runs && state.action_status == "RUNNING" {
                "PAUSED".clone_into(&mut state.action_status);
                has_changed = true;
            }
        }
        has_changed
    }

    /// True when its status is another now: how far a cleaning is changes all the time, and goes out with the next state.
    fn set_state(&mut self, states: &mut [ActionState], action: &Action, step: Step) -> bool {
        let Step { status, result } = step;
        let is_named = |state: &&mut ActionState| state.action_id == action.action_id;
        let Some(state) = states.iter_mut().find(is_named) else { return false };
        let is_new = state.action_status != status;
        status.clone_into(&mut state.action_status);
        if result.is_some() {
            state.result_description.clone_from(&result);
        }
        if status == "FAILED" {
            self.failed.push((action.clone(), result.unwrap_or_default()));
        }
        is_new
    }

    /// What the vehicle is to do for its actions, since this was asked last.
    pub fn take_due(&mut self) -> Vec<VehicleCommand> {
        std::mem::take(&mut self.due)
    }

    /// Actions that have failed since this was asked last, and why.
    pub fn take_failed(&mut self) -> Vec<(Action, String)> {
        std::mem::take(&mut self.failed)
    }
}
