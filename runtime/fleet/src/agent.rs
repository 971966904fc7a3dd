//! The agent: messages and moments in, messages and commands out. It knows neither a network nor a clock.

use std::io;
use std::path::PathBuf;

use serde::Serialize;
use serde_json::Value;

use super::factsheet::factsheet;
use super::messages::{
    ActionState, AgvPosition, BatteryState, Header, Information, InstantActions, MapState, Order, Report,
    SafetyState, State, Topic, Velocity, Visualization,
};
use super::order::{HeldOrder, Taken};
use super::rules::report;
use super::vehicle::{
    CleaningMoment, CleaningStage, EmergencyStop, VehicleCommand, VehicleDescription, VehicleFault,
    VehicleMoment,
};

/// A state goes out this often even if nothing changes, seconds.
const STATE_EVERY_S: f64 = 10.0;
/// Not more often than this, seconds.
const STATE_MIN_S: f64 = 0.1;
/// Where the vehicle is goes out this often, seconds.
const VISUALIZATION_EVERY_S: f64 = 1.0;
/// Refusals are reported until an order is taken, the newest so many.
const REFUSALS_MAX: usize = 16;

/// A message that goes out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outgoing {
    /// Its kind.
    pub topic: Topic,
    /// JSON.
    pub payload: String,
    /// It must not be lost.
    pub is_kept: bool,
}

/// What comes of a message or a moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Messages, in their order.
    pub messages: Vec<Outgoing>,
    /// What the vehicle is to do.
    pub commands: Vec<VehicleCommand>,
}

/// A pause or its end that the vehicle has not reported yet.
pub(super) struct Pending {
    pub(super) action_id: String,
    pub(super) wants: bool,
}

/// Speaks for a vehicle.
pub struct FleetAgent {
    pub(super) vehicle: VehicleDescription,
    pub(super) held: HeldOrder,
    pub(super) moment: VehicleMoment,
    pub(super) instant: Vec<ActionState>,
    pub(super) pauses: Vec<Pending>,
    pub(super) cancelling: Vec<String>,
    pub(super) is_changed: bool,
    /// Where the order and the logs are kept; none: in memory only.
    pub(super) folder: Option<PathBuf>,
    refusals: Vec<Report>,
    headers: [u32; 4],
    state_s: f64,
    visualization_s: f64,
    shown: Option<(bool, bool, bool, bool, EmergencyStop, Vec<VehicleFault>)>,
}

impl FleetAgent {
    /// An agent that goes on with the order that lies in a folder.
    ///
    /// # Errors
    /// The folder cannot be made, or what lies in it cannot be read.
    pub fn open(vehicle: VehicleDescription, folder: Option<PathBuf>) -> io::Result<Self> {
        let held = folder.as_deref().map(super::queue::read_order).transpose()?.flatten().unwrap_or_default();
        Ok(Self {
            vehicle,
            held,
            moment: VehicleMoment::default(),
            instant: Vec::new(),
            pauses: Vec::new(),
            cancelling: Vec::new(),
            is_changed: true,
            folder,
            refusals: Vec::new(),
            headers: [0; 4],
            state_s: f64::NEG_INFINITY,
            visualization_s: f64::NEG_INFINITY,
            shown: None,
        })
    }

    /// The order that the vehicle holds.
    #[must_use]
    pub const fn held(&self) -> &HeldOrder {
        &self.held
    }

    /// A message of the master.
    pub fn receive(&mut self, topic: Topic, payload: &[u8]) -> Outcome {
        let mut outcome = Outcome::default();
        match topic {
            Topic::Order => self.receive_order(payload),
            Topic::InstantActions => match serde_json::from_slice::<InstantActions>(payload) {
                Ok(message) if message.serial_number == self.vehicle.serial => {
                    message.actions.iter().for_each(|action| self.act(action, &mut outcome));
                }
                Ok(_) => {}
                Err(error) => {
                    self.note(report("validationError", error.to_string(), &[("topic", "instantActions")]));
                }
            },
            _ => {}
        }
        self.keep_order();
        outcome
    }

    fn receive_order(&mut self, payload: &[u8]) {
        self.is_changed = true;
        let order = match serde_json::from_slice::<Order>(payload) {
            Ok(order) => order,
            Err(error) => {
                return self.note(report("validationError", error.to_string(), &[("topic", "order")]));
            }
        };
        if order.serial_number != self.vehicle.serial || order.manufacturer != self.vehicle.manufacturer {
            let words = "the order is for another vehicle";
            return self.note(super::rules::refusal("validationError", &order, words, &[]));
        }
        match self.held.take(&order, (&self.vehicle, &self.moment)) {
            Taken::Accepted => self.refusals.clear(),
            Taken::Known => {}
            Taken::Refused(report) => self.note(report),
        }
    }

    /// An error that is reported until an order is taken.
    pub(super) fn note(&mut self, error: Report) {
        if self.refusals.last() != Some(&error) {
            self.refusals.push(error);
        }
        if self.refusals.len() > REFUSALS_MAX {
            self.refusals.remove(0);
        }
        self.is_changed = true;
    }

    /// The vehicle at a moment: what it is to do next, and what goes out.
    pub fn attend(&mut self, moment: VehicleMoment, now: &str) -> Outcome {
        let mut outcome = Outcome::default();
        self.moment = moment;
        if self.held.follow(&self.moment) {
            self.is_changed = true;
            self.keep_order();
        }
        outcome.commands.append(&mut self.held.actions.take_due());
        for (action, words) in self.held.actions.take_failed() {
            let of = [
                ("orderId", self.held.order_id.as_str()),
                ("nodeId", &self.held.last_node_id),
                ("actionId", &action.action_id),
            ];
            self.note(report(&format!("{}Error", action.action_type), words, &of));
        }
        if self.moment.is_automatic
            && let Some(place) = self.held.next_place(&self.vehicle)
        {
            outcome.commands.push(VehicleCommand::Goto(place));
            self.keep_order();
        }
        self.settle();
        self.send(now, &mut outcome);
        outcome
    }

    /// Actions that wait for the vehicle: pauses, and a cancelled order's stand.
    fn settle(&mut self) {
        let (is_paused, is_driving) = (self.moment.is_paused, self.moment.is_driving);
        let settled = |pending: &Pending| pending.wants == is_paused && !(pending.wants && is_driving);
        let paused =
            self.pauses.iter().filter(|pending| settled(pending)).map(|pending| pending.action_id.clone());
        let mut done: Vec<String> = paused.collect();
        self.pauses.retain(|pending| !settled(pending));
        let is_cleaning = |cleaning: &CleaningMoment| cleaning.stage == CleaningStage::Running;
        if !is_driving && !self.moment.cleaning.as_ref().is_some_and(is_cleaning) {
            done.append(&mut self.cancelling);
        }
        for state in self.instant.iter_mut().filter(|state| done.contains(&state.action_id)) {
            "FINISHED".clone_into(&mut state.action_status);
            self.is_changed = true;
        }
    }

    fn send(&mut self, now: &str, outcome: &mut Outcome) {
        let moment = &self.moment;
        let shown = (
            moment.is_driving,
            moment.is_paused,
            moment.is_automatic,
            moment.is_field_violated,
            moment.emergency_stop,
            self.faults(),
        );
        let now_s = moment.now_s;
        if self.shown.as_ref() != Some(&shown) {
            self.shown = Some(shown);
            self.is_changed = true;
        }
        let since_s = now_s - self.state_s;
        if since_s >= STATE_EVERY_S || (self.is_changed && since_s >= STATE_MIN_S) {
            let is_kept = std::mem::take(&mut self.is_changed);
            self.state_s = now_s;
            let state = self.state(now);
            push(outcome, Topic::State, &state, is_kept);
        }
        if now_s - self.visualization_s >= VISUALIZATION_EVERY_S {
            self.visualization_s = now_s;
            let header = self.header(Topic::Visualization, now);
            let (agv_position, velocity) = (self.position(), self.velocity());
            push(outcome, Topic::Visualization, &Visualization { header, agv_position, velocity }, false);
        }
    }

    fn header(&mut self, topic: Topic, now: &str) -> Header {
        let counter = match topic {
            Topic::State => 0,
            Topic::Visualization => 1,
            Topic::Factsheet => 2,
            _ => 3,
        };
        let header_id = self.headers[counter];
        self.headers[counter] = header_id.wrapping_add(1);
        Header::of(&self.vehicle, header_id, now.to_owned())
    }

    pub(super) fn publish_factsheet(&mut self, outcome: &mut Outcome) {
        let header = self.header(Topic::Factsheet, &super::connection::timestamp());
        let mut sheet = serde_json::to_value(header).unwrap_or_default();
        if let (Value::Object(all), Value::Object(more)) = (&mut sheet, factsheet(&self.vehicle)) {
            all.extend(more);
        }
        push(outcome, Topic::Factsheet, &sheet, true);
    }

    fn position(&self) -> Option<AgvPosition> {
        let pose = self.moment.pose?;
        Some(AgvPosition {
            x: pose.x_m,
            y: pose.y_m,
            theta: pose.heading_rad,
            map_id: self.vehicle.map_id.clone(),
            position_initialized: self.moment.is_localised,
        })
    }

    fn velocity(&self) -> Velocity {
        let [vx, omega] = self.moment.speed;
        Velocity { vx, vy: 0.0, omega }
    }

    /// What is wrong with the vehicle, and the node that it cannot reach.
    fn faults(&self) -> Vec<VehicleFault> {
        let is_barred =
            self.moment.unreachable.is_some() && self.moment.unreachable == self.held.ordered_number();
        let node = self.held.nodes.first().map_or("", |node| node.node_id.as_str());
        let barred = is_barred.then(|| VehicleFault {
            kind: "noRouteError".to_owned(),
            words: format!("the node {node} cannot be reached on the map"),
            is_fatal: true,
        });
        self.moment.faults.iter().cloned().chain(barred).collect()
    }

    fn state(&mut self, now: &str) -> State {
        let of_vehicle = self.faults().into_iter().map(|fault| Report {
            error_level: if fault.is_fatal { "FATAL" } else { "WARNING" }.to_owned(),
            ..report(&fault.kind, fault.words, &[("orderId", &self.held.order_id)])
        });
        let errors = of_vehicle.chain(self.refusals.iter().cloned()).collect();
        let action_states = self.held.action_states.iter().chain(&self.instant).cloned().collect();
        let emergency_stop = match self.moment.emergency_stop {
            EmergencyStop::None => "NONE",
            EmergencyStop::Automatic => "AUTOACK",
            EmergencyStop::Manual => "MANUAL",
        };
        State {
            header: self.header(Topic::State, now),
            maps: vec![MapState {
                map_id: self.vehicle.map_id.clone(),
                map_version: "1".to_owned(),
                map_status: "ENABLED",
            }],
            order_id: self.held.order_id.clone(),
            order_update_id: self.held.order_update_id,
            last_node_id: self.held.last_node_id.clone(),
            last_node_sequence_id: self.held.last_node_sequence_id,
            node_states: self.held.node_states(),
            edge_states: self.held.edge_states(),
            agv_position: self.position(),
            velocity: self.velocity(),
            driving: self.moment.is_driving,
            paused: self.moment.is_paused,
            new_base_request: self.held.needs_base(),
            action_states,
            battery_state: BatteryState { battery_charge: 100.0, charging: false },
            operating_mode: if self.moment.is_automatic { "AUTOMATIC" } else { "MANUAL" },
            errors,
            information: vec![battery_information()],
            safety_state: SafetyState {
                e_stop: emergency_stop,
                field_violation: self.moment.is_field_violated,
            },
        }
    }

    fn keep_order(&self) {
        if let Some(folder) = &self.folder {
            super::queue::write_order(folder, &self.held);
        }
    }

    pub(super) fn write_log(&self, action_id: &str, reason: &str) -> io::Result<String> {
        let Some(folder) = &self.folder else {
            return Err(io::Error::other("this vehicle keeps no logs: it has no folder"));
        };
        super::queue::write_log(
            folder,
            action_id,
            &format!("{reason}\n{:#?}\n{:#?}\n", self.moment, self.held),
        )
    }
}

/// The standard wants a charge, and this vehicle measures none.
fn battery_information() -> Information {
    Information {
        info_type: "batteryNotMeasured".to_owned(),
        info_level: "INFO",
        info_description: "this vehicle does not measure its battery; batteryCharge is no measurement"
            .to_owned(),
        info_references: Vec::new(),
    }
}

fn push(outcome: &mut Outcome, topic: Topic, message: &impl Serialize, is_kept: bool) {
    if let Ok(payload) = serde_json::to_string(message) {
        outcome.messages.push(Outgoing { topic, payload, is_kept });
    }
}
