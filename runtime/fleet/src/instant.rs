//! Instant actions (VDA 5050 2.1.0, chapters 6.8 and 6.9).

use super::agent::{FleetAgent, Outcome};
use super::messages::{Action, Report};
use super::order::state_of;
use super::rules::report;
use super::vehicle::{VehicleCommand, VehiclePose};

/// States of instant actions are kept for the newest so many; the master has read the others.
const KEPT: usize = 64;

impl FleetAgent {
    /// An instant action that came. One whose name is known was done before.
    pub(super) fn act(&mut self, action: &Action, outcome: &mut Outcome) {
        if self.instant.iter().any(|state| state.action_id == action.action_id) {
            return;
        }
        let done = match action.action_type.as_str() {
            "startPause" => {
                self.pauses.push(super::agent::Pending { action_id: action.action_id.clone(), wants: true });
                outcome.commands.push(VehicleCommand::Pause);
                Ok(None)
            }
            "stopPause" => {
                self.pauses.push(super::agent::Pending { action_id: action.action_id.clone(), wants: false });
                outcome.commands.push(VehicleCommand::Resume);
                Ok(None)
            }
            "cancelOrder" => self.cancel(action, outcome),
            "initPosition" => self.relocate(action, outcome),
            "stateRequest" => Ok(Some(None)),
            "factsheetRequest" => {
                self.publish_factsheet(outcome);
                Ok(Some(None))
            }
            "logReport" => self.log_report(action),
            other => Err(report(
                "instantActionError",
                format!("this vehicle knows no instant action {other}"),
                &[("actionId", &action.action_id), ("actionType", other)],
            )),
        };
        let (status, result) = match done {
            Ok(None) => ("RUNNING", None),
            Ok(Some(result)) => ("FINISHED", result),
            Err(error) => {
                let words = error.error_description.clone();
                self.note(error);
                ("FAILED", Some(words))
            }
        };
        self.instant.push(state_of(action, status, result));
        if self.instant.len() > KEPT {
            self.instant.remove(0);
        }
        self.is_changed = true;
    }

    fn cancel(&mut self, action: &Action, outcome: &mut Outcome) -> Result<Option<Option<String>>, Report> {
        if !self.held.cancel() {
            let words = "there is no order to cancel";
            return Err(report("noOrderToCancel", words, &[("actionId", &action.action_id)]));
        }
        outcome.commands.push(VehicleCommand::Stand);
        self.cancelling.push(action.action_id.clone());
        Ok(None)
    }

    fn relocate(&mut self, action: &Action, outcome: &mut Outcome) -> Result<Option<Option<String>>, Report> {
        let wrong = |words: &str| Err(report("initPositionError", words, &[("actionId", &action.action_id)]));
        let number =
            |key: &str| action.number(key).filter(|number| number.is_finite() && number.abs() < 1.0e5);
        let (Some(x_m), Some(y_m), Some(heading_rad)) = (number("x"), number("y"), number("theta")) else {
            return wrong("it needs x, y and theta");
        };
        let text = |key: &str| action.value(key).and_then(|value| value.as_str());
        if text("mapId").is_some_and(|map| map != self.vehicle.map_id) {
            return wrong("the vehicle is on another map");
        }
        if self.moment.is_driving {
            return wrong("the vehicle drives");
        }
        if let Some(node) = text("lastNodeId") {
            node.clone_into(&mut self.held.last_node_id);
        }
        outcome.commands.push(VehicleCommand::Relocate(VehiclePose { x_m, y_m, heading_rad }));
        Ok(Some(None))
    }

    /// The vehicle's recording holds everything; the report is a line with the reason, and its name is the result.
    fn log_report(&mut self, action: &Action) -> Result<Option<Option<String>>, Report> {
        let reason = action.value("reason").and_then(|value| value.as_str()).unwrap_or("no reason given");
        let failed = |error: std::io::Error| {
            report("logReportError", error.to_string(), &[("actionId", &action.action_id)])
        };
        let name = self.write_log(&action.action_id, reason).map_err(failed)?;
        Ok(Some(Some(name)))
    }
}
