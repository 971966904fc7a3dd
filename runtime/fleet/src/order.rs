//! The order that a vehicle holds: whether another or an update is taken (VDA 5050 2.1.0, chapter 6.6.2, figure 8), and how far it is.

use serde::{Deserialize, Serialize};

use super::messages::{Action, ActionState, EdgeState, Node, NodeState, Order, Report};
use super::rules::{refusal, usable, validate};
use super::running::{NodeActions, joined};
use super::vehicle::{OrderedPlace, VehicleDescription, VehicleMoment, VehiclePose};

/// The first node of an order counts as reached within, metres, where the order does not say: the vehicle comes from anywhere.
const START_WITHIN_M: f64 = 1.0;
/// A node on the way counts as traversed within, metres, where the order does not say.
const PASSES_WITHIN_M: f64 = 0.3;
/// Nearer than it stops by itself no vehicle is asked to stop, metres.
const WITHIN_MIN_M: f64 = 0.05;

/// What became of an order that came.
#[derive(Clone, Debug, PartialEq)]
pub enum Taken {
    /// It is the vehicle's now.
    Accepted,
    /// It was the vehicle's before.
    Known,
    /// It is not taken, and why.
    Refused(Report),
}

/// The order of a vehicle. It is kept on the disk: a vehicle that was switched off goes on with it, and carries out none twice.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HeldOrder {
    /// Its name; empty before the first.
    pub order_id: String,
    /// Its newest update.
    pub order_update_id: u32,
    /// Name of the newest node that was traversed.
    pub last_node_id: String,
    /// Its place in the order.
    pub last_node_sequence_id: u32,
    /// Nodes that are still to be traversed.
    pub nodes: Vec<Node>,
    /// Edges that are still to be driven.
    pub edges: Vec<EdgeToDrive>,
    /// Its actions, and instant ones.
    pub action_states: Vec<ActionState>,
    /// Actions of the newest node.
    #[serde(flatten)]
    pub actions: NodeActions,
    /// The master has cancelled it.
    is_cancelled: bool,
    /// The last number of a place.
    pub place_number: u32,
    /// Nodes traversed so far, of all orders.
    pub traversed: u64,
    #[serde(skip)]
    ordered: Option<(u32, u32)>,
    #[serde(skip)]
    last_s: Option<f64>,
}

/// An edge that is still to be driven.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EdgeToDrive {
    edge_id: String,
    sequence_id: u32,
    released: bool,
    /// The vehicle drives no faster on it, m/s, where that is less than it could.
    #[serde(default)]
    speed_max_mps: Option<f64>,
    /// And turns no faster, rad/s.
    #[serde(default)]
    turn_max_radps: Option<f64>,
}

impl HeldOrder {
    /// The vehicle has something to do, or waits for an update.
    #[must_use]
    pub fn is_active(&self) -> bool {
        !self.nodes.is_empty() || !self.actions.is_empty()
    }

    /// An order that came.
    pub fn take(&mut self, order: &Order, (vehicle, moment): (&VehicleDescription, &VehicleMoment)) -> Taken {
        if order.order_id == self.order_id && !self.order_id.is_empty() {
            if order.order_update_id < self.order_update_id {
                return Taken::Refused(refusal("orderUpdateError", order, "a newer update is known", &[]));
            }
            if order.order_update_id == self.order_update_id {
                return Taken::Known;
            }
        }
        if let Err(report) = validate(order).and_then(|()| usable(order, vehicle)) {
            return Taken::Refused(report);
        }
        let taken = if order.order_id == self.order_id {
            self.update(order, vehicle)
        } else {
            self.begin(order, (vehicle, moment))
        };
        match taken {
            Ok(()) => Taken::Accepted,
            Err(report) => Taken::Refused(report),
        }
    }

    fn begin(
        &mut self,
        order: &Order,
        (vehicle, moment): (&VehicleDescription, &VehicleMoment),
    ) -> Result<(), Report> {
        if self.is_active() {
            return Err(refusal(
                "orderError",
                order,
                format!("the order {} is not done", self.order_id),
                &[],
            ));
        }
        let Some(first) = order.nodes.first() else { return Ok(()) };
        let is_last_node = !self.last_node_id.is_empty() && first.node_id == self.last_node_id;
        let is_near =
            moment.pose.is_some_and(|pose| distance_m(first, pose) <= start_within_m(first, vehicle));
        if !is_near && !is_last_node {
            let why = "the vehicle is not at the first node";
            return Err(refusal("orderError", order, why, &[("nodeId", &first.node_id)]));
        }
        self.action_states.clear();
        self.actions.clear();
        self.nodes.clear();
        self.edges.clear();
        self.order_id.clone_from(&order.order_id);
        self.order_update_id = order.order_update_id;
        self.is_cancelled = false;
        self.append(order, (0, vehicle));
        // The vehicle stands on the first node.
        self.traverse();
        Ok(())
    }

    fn update(&mut self, order: &Order, vehicle: &VehicleDescription) -> Result<(), Report> {
        let wrong = |words: &str| Err(refusal("orderUpdateError", order, words, &[]));
        if self.is_cancelled {
            return wrong("the order was cancelled");
        }
        let Some(first) = order.nodes.first() else { return Ok(()) };
        let released = self.nodes.iter().rfind(|node| node.released);
        let (name, sequence) = released.map_or((&self.last_node_id, self.last_node_sequence_id), |node| {
            (&node.node_id, node.sequence_id)
        });
        if first.node_id != *name || first.sequence_id != sequence {
            return wrong("it does not begin at the last released node");
        }
        // The horizon is replaced; the base stays as it was first sent.
        let horizon = |released: bool| released;
        self.nodes.retain(|node| horizon(node.released));
        self.edges.retain(|edge| horizon(edge.released));
        let kept: Vec<&str> =
            self.nodes.iter().flat_map(|node| &node.actions).map(|one| one.action_id.as_str()).collect();
        let kept: Vec<String> = kept.into_iter().chain(self.actions.names()).map(str::to_owned).collect();
        self.action_states
            .retain(|state| state.action_status != "WAITING" || kept.contains(&state.action_id));
        self.order_update_id = order.order_update_id;
        self.append(order, (1, vehicle));
        Ok(())
    }

    /// The nodes of an order from one on, and all its edges.
    fn append(&mut self, order: &Order, (from, vehicle): (usize, &VehicleDescription)) {
        let nodes = order.nodes.iter().skip(from);
        for node in nodes {
            let waiting = |action: &Action| state_of(action, "WAITING", None);
            self.action_states.extend(node.actions.iter().map(waiting));
            self.nodes.push(node.clone());
        }
        self.edges.extend(order.edges.iter().map(|edge| EdgeToDrive {
            edge_id: edge.edge_id.clone(),
            sequence_id: edge.sequence_id,
            released: edge.released,
            speed_max_mps: edge.max_speed.filter(|limit_mps| *limit_mps < vehicle.speed_max_mps),
            turn_max_radps: edge.max_rotation_speed,
        }));
    }

    /// The next node counts as traversed: the edge that led there, too, and its actions begin.
    fn traverse(&mut self) {
        if self.nodes.is_empty() {
            return;
        }
        let node = self.nodes.remove(0);
        self.edges.retain(|edge| edge.sequence_id > node.sequence_id);
        self.traversed += 1;
        self.last_node_sequence_id = node.sequence_id;
        self.last_node_id = node.node_id;
        self.ordered = None;
        self.actions.begin(node.actions);
    }

    /// The vehicle at a moment: nodes that it traverses, actions that end. True when something changed.
    pub fn follow(&mut self, moment: &VehicleMoment) -> bool {
        let lasted_s = moment.now_s - self.last_s.replace(moment.now_s).unwrap_or(moment.now_s);
        let has_waited = self.actions.run(&mut self.action_states, (lasted_s.max(0.0), moment));
        let has_passed = self.is_traversed(moment);
        if has_passed {
            self.traverse();
        }
        has_waited || has_passed
    }

    fn is_traversed(&self, moment: &VehicleMoment) -> bool {
        let Some(node) = self.nodes.first().filter(|node| node.released) else { return false };
        let Some((number, sequence)) = self.ordered else { return false };
        if sequence != node.sequence_id {
            return false;
        }
        let goes_on = |next: &Node| next.released && !self.is_slower_before(next, node);
        let is_on_the_way = self.nodes.get(1).is_some_and(goes_on) && node.actions.is_empty();
        let within_m = within_m(node).unwrap_or(PASSES_WITHIN_M);
        let is_near = moment.pose.is_some_and(|pose| distance_m(node, pose) <= within_m);
        let turned = node.node_position.as_ref().and_then(|position| position.theta);
        moment.reached == Some(number) || (is_on_the_way && is_near && turned.is_none())
    }

    /// The edge that leads to a node.
    fn edge_to(&self, node: &Node) -> Option<&EdgeToDrive> {
        self.edges.iter().find(|edge| edge.sequence_id + 1 == node.sequence_id)
    }

    /// The way to a node is to be driven more slowly than that to the one before it: the vehicle stands between them, so that it is
    /// nowhere too fast.
    fn is_slower_before(&self, next: &Node, node: &Node) -> bool {
        let speed = |node: &Node| self.edge_to(node)?.speed_max_mps;
        let slower = |next_mps: f64| speed(node).is_none_or(|before_mps| next_mps < before_mps);
        speed(next).is_some_and(slower)
    }

    /// Where to drive next, if it was not ordered yet; none while an action blocks, or at the end of the base.
    pub fn next_place(&mut self, vehicle: &VehicleDescription) -> Option<OrderedPlace> {
        if self.actions.block_drive() {
            return None;
        }
        let node = self.nodes.first().filter(|node| node.released)?;
        if self.ordered.is_some_and(|(_, sequence)| sequence == node.sequence_id) {
            return None;
        }
        let (node, sequence) = (node.clone(), node.sequence_id);
        let position = node.node_position.as_ref()?;
        let onwards = self.nodes.get(1).and_then(|next| next.node_position.as_ref());
        // Without a heading the vehicle arrives as it will drive on.
        let free_rad = onwards.map_or(0.0, |next| libm::atan2(next.y - position.y, next.x - position.x));
        let edge = self.edge_to(&node);
        let (speed_max_mps, turn_max_radps) =
            edge.map_or((None, None), |edge| (edge.speed_max_mps, edge.turn_max_radps));
        self.place_number = self.place_number.wrapping_add(1);
        self.ordered = Some((self.place_number, sequence));
        let theta_within =
            position.allowed_deviation_theta.filter(|rad| *rad > 0.0).unwrap_or(vehicle.within_rad);
        Some(OrderedPlace {
            number: self.place_number,
            pose: VehiclePose {
                x_m: position.x,
                y_m: position.y,
                heading_rad: position.theta.unwrap_or(free_rad),
            },
            within_m: within_m(&node).unwrap_or(vehicle.within_m),
            within_rad: if position.theta.is_some() { theta_within } else { std::f64::consts::PI },
            speed_max_mps,
            turn_max_radps,
        })
    }

    /// The number of the place that is driven to.
    #[must_use]
    pub fn ordered_number(&self) -> Option<u32> {
        self.ordered.map(|(number, _)| number)
    }

    /// The master cancels: what is not done fails. False without an order.
    pub fn cancel(&mut self) -> bool {
        if !self.is_active() {
            return false;
        }
        self.nodes.clear();
        self.edges.clear();
        self.actions.clear();
        self.ordered = None;
        self.is_cancelled = true;
        for state in &mut self.action_states {
            if !matches!(state.action_status.as_str(), "FINISHED" | "FAILED") {
                "FAILED".clone_into(&mut state.action_status);
                let so_far = state.result_description.take().unwrap_or_default();
                state.result_description = Some(joined("the order was cancelled", &so_far));
            }
        }
        true
    }

    /// Nodes that are still to be traversed.
    pub fn node_states(&self) -> Vec<NodeState> {
        let state = |node: &Node| NodeState {
            node_id: node.node_id.clone(),
            sequence_id: node.sequence_id,
            node_position: node.node_position.clone(),
            released: node.released,
        };
        self.nodes.iter().map(state).collect()
    }

    /// Edges that are still to be driven.
    pub fn edge_states(&self) -> Vec<EdgeState> {
        let state = |edge: &EdgeToDrive| EdgeState {
            edge_id: edge.edge_id.clone(),
            sequence_id: edge.sequence_id,
            released: edge.released,
        };
        self.edges.iter().map(state).collect()
    }

    /// The base ends soon and the horizon does not.
    #[must_use]
    pub fn needs_base(&self) -> bool {
        let released = self.nodes.iter().filter(|node| node.released).count();
        released <= 1 && self.nodes.len() > released
    }
}

/// The state of an action.
pub fn state_of(action: &Action, status: &str, result: Option<String>) -> ActionState {
    ActionState {
        action_id: action.action_id.clone(),
        action_type: action.action_type.clone(),
        action_status: status.to_owned(),
        result_description: result,
    }
}

fn distance_m(node: &Node, pose: VehiclePose) -> f64 {
    let Some(position) = &node.node_position else { return f64::INFINITY };
    libm::hypot(position.x - pose.x_m, position.y - pose.y_m)
}

fn within_m(node: &Node) -> Option<f64> {
    let given = node.node_position.as_ref()?.allowed_deviation_xy?;
    (given > 0.0).then_some(given.max(WITHIN_MIN_M))
}

fn start_within_m(node: &Node, vehicle: &VehicleDescription) -> f64 {
    within_m(node).unwrap_or(START_WITHIN_M).max(vehicle.within_m)
}
