//! Days of fleet traffic in virtual time: the broker is killed a hundred times a day, loses what waits with it or delivers it twice, and
//! the robot's program is cut off now and then. Every order is carried out once, or refused with a reason; no kept message is lost.
//!
//! A short part of a day is a test; `cargo xtask campaign fleet` plays whole days, each with other moments.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use floorguard_types::random::Pcg32;
use serde_json::Value;

use super::orders::{order, vehicle};
use crate::agent::FleetAgent;
use crate::messages::Topic;
use crate::queue::{OfflineQueue, Waiting};
use crate::vehicle::{OrderedPlace, VehicleCommand, VehicleMoment, VehiclePose};

/// Seconds of a step of the world.
const STEP_S: f64 = 2.0;
const DAY_S: f64 = 86_400.0;
const KILLS_A_DAY: f64 = 100.0;
/// So much of a day is played where nobody asks for more.
const SHARE_IN_TESTS: f64 = 0.05;
/// From one node to the next.
const DRIVE_S: f64 = 14.0;
/// A master that hears nothing of its order for so long sends it again.
const RESENT_AFTER_S: f64 = 30.0;

fn chance(random: &mut Pcg32, probability: f32) -> bool {
    random.uniform() < probability
}

/// What became of an order.
#[derive(Clone, Debug, Default, PartialEq)]
struct Fate {
    is_taken: bool,
    refusals: Vec<String>,
}

/// The master, and the broker between it and the robot.
struct Master {
    is_up: bool,
    back_s: f64,
    /// For the robot.
    waiting: Vec<Value>,
    /// What has arrived of the robot, without repetitions.
    arrived: Vec<String>,
    current: Option<(String, Value, f64)>,
    fates: BTreeMap<String, Fate>,
    orders: u32,
    next_x: u32,
}

impl Master {
    fn hear(&mut self, payload: String) {
        let state: Value = serde_json::from_str(&payload).unwrap();
        for error in state["errors"].as_array().into_iter().flatten() {
            let of_order = error["errorReferences"].as_array().into_iter().flatten();
            let named = of_order.filter(|reference| reference["referenceKey"] == "orderId");
            for name in named.filter_map(|reference| reference["referenceValue"].as_str()) {
                if let Some(fate) = self.fates.get_mut(name) {
                    fate.refusals.push(error["errorType"].as_str().unwrap_or_default().to_owned());
                }
            }
        }
        if let Some((name, ..)) = &self.current {
            let is_refused = self.fates.get(name).is_some_and(|fate| !fate.refusals.is_empty());
            let is_held = state["orderId"] == *name;
            if let Some(fate) = self.fates.get_mut(name) {
                fate.is_taken |= is_held;
            }
            let is_done = is_held && state["nodeStates"].as_array().is_some_and(Vec::is_empty);
            if is_done {
                self.next_x += 2;
            }
            if is_done || is_refused {
                self.current = None;
            }
        }
        if self.arrived.last() != Some(&payload) {
            self.arrived.push(payload);
        }
    }

    /// The next order, or the same again. One in twelve begins where the robot is not.
    fn ask(&mut self, now_s: f64, random: &mut Pcg32) {
        if self.current.is_none() {
            self.orders += 1;
            let name = format!("order {}", self.orders);
            let is_wrong = chance(random, 1.0 / 12.0);
            let first_x = if is_wrong { self.next_x + 40 } else { self.next_x };
            let message = order(&name, 0, (2 * first_x, 3, 0));
            self.fates.insert(name.clone(), Fate::default());
            self.current = Some((name, message, f64::NEG_INFINITY));
        }
        let Some((_, message, sent_s)) = &mut self.current else { return };
        if self.is_up && now_s - *sent_s >= RESENT_AFTER_S {
            *sent_s = now_s;
            self.waiting.push(message.clone());
            if chance(random, 0.2) {
                self.waiting.push(message.clone());
            }
        }
    }
}

struct Robot {
    agent: FleetAgent,
    queue: OfflineQueue,
    folder: PathBuf,
    moment: VehicleMoment,
    going: Option<(OrderedPlace, f64)>,
    /// Where it arrived, in order.
    arrivals: Vec<f64>,
    kept: Vec<String>,
}

impl Robot {
    fn switched_on(folder: &Path, moment: VehicleMoment) -> Self {
        let agent = FleetAgent::open(vehicle("7"), Some(folder.to_owned())).unwrap();
        let queue = OfflineQueue::open(Some(folder)).unwrap();
        let folder = folder.to_owned();
        Self { agent, queue, folder, moment, going: None, arrivals: Vec::new(), kept: Vec::new() }
    }

    /// The power goes and comes back: what is not on the disk is gone.
    fn cut(self) -> Self {
        let moment = VehicleMoment { reached: None, ..self.moment };
        Self { arrivals: self.arrivals, kept: self.kept, ..Self::switched_on(&self.folder, moment) }
    }

    fn step(&mut self, now_s: f64, heard: Vec<Value>) {
        for message in heard {
            let outcome = self.agent.receive(Topic::Order, message.to_string().as_bytes());
            assert!(outcome.commands.is_empty());
        }
        self.moment.now_s = now_s;
        if let Some((place, _)) = self.going.take_if(|(_, arrives_s)| *arrives_s <= now_s) {
            self.arrivals.push(place.pose.x_m);
            (self.moment.pose, self.moment.reached) = (Some(place.pose), Some(place.number));
        }
        self.moment.is_driving = self.going.is_some();
        let outcome = self.agent.attend(self.moment.clone(), "2026-11-24T04:00:00.000Z");
        for command in outcome.commands {
            if let VehicleCommand::Goto(place) = command {
                self.going = Some((place, now_s + DRIVE_S));
            }
        }
        for message in outcome.messages.into_iter().filter(|message| message.is_kept) {
            self.kept.push(message.payload.clone());
            self.queue.push(Waiting { topic: message.topic, payload: message.payload }).unwrap();
        }
    }
}

/// A part of a day; how many orders were carried out and refused.
fn play(seed: u64, share: f64) -> (u64, u64) {
    let folder = tempfile::tempdir().unwrap();
    let mut random = Pcg32::new(seed, 1);
    let moment = VehicleMoment {
        pose: Some(VehiclePose::default()),
        is_localised: true,
        is_automatic: true,
        ..VehicleMoment::default()
    };
    let mut robot = Robot::switched_on(folder.path(), moment);
    let mut master = Master {
        is_up: true,
        back_s: 0.0,
        waiting: Vec::new(),
        arrived: Vec::new(),
        current: None,
        fates: BTreeMap::new(),
        orders: 0,
        next_x: 0,
    };
    let (mut kills, steps) = (0, (DAY_S * share / STEP_S) as u32);
    let early_kb = resident_kb();
    for step in 0..steps {
        let now_s = f64::from(step) * STEP_S;
        // The last minutes are quiet, so that what is on its way arrives.
        let is_quiet = now_s > DAY_S * share - 400.0;
        if master.is_up && !is_quiet && chance(&mut random, (KILLS_A_DAY * STEP_S / DAY_S * 1.1) as f32) {
            kills += 1;
            (master.is_up, master.back_s) = (false, now_s + 5.0 + f64::from(random.uniform()) * 115.0);
            if chance(&mut random, 0.5) {
                master.waiting.clear();
            }
            // What was delivered and not yet confirmed comes again.
            if let Some(waiting) = robot.queue.get(0) {
                master.hear(waiting.payload.clone());
            }
        }
        master.is_up |= now_s >= master.back_s;
        if !is_quiet && chance(&mut random, (8.0 * STEP_S / DAY_S) as f32) {
            robot = robot.cut();
        }
        if !is_quiet || master.current.is_some() {
            master.ask(now_s, &mut random);
        }
        let heard = if master.is_up { std::mem::take(&mut master.waiting) } else { Vec::new() };
        robot.step(now_s, heard);
        while let Some(waiting) = robot.queue.get(0).filter(|_| master.is_up) {
            master.hear(waiting.payload.clone());
            robot.queue.leave().unwrap();
        }
    }
    assert!(kills > 0 && f64::from(kills) > 0.7 * KILLS_A_DAY * share, "{kills} kills");
    let grown_kb = resident_kb().saturating_sub(early_kb);
    // What the test itself keeps for its verdict: every state once on each side.
    let own_kb = robot.kept.iter().map(String::len).sum::<usize>() as u64 * 2 / 1_024;
    assert!(grown_kb < own_kb + 16_384, "{grown_kb} KB more, of which {own_kb} KB are the test's");
    verdict(&robot, &master)
}

fn verdict(robot: &Robot, master: &Master) -> (u64, u64) {
    assert_eq!(robot.queue.dropped, 0);
    // Each message arrived, in its order. Equal ones in a row are one.
    let mut kept = robot.kept.clone();
    kept.dedup();
    assert_eq!(master.arrived.len(), kept.len(), "messages kept and arrived");
    assert!(master.arrived == kept, "each message arrived once, in its order");
    let (mut done, mut refused) = (0, 0);
    let last = format!("order {}", master.orders);
    for (name, fate) in master.fates.iter().filter(|(name, _)| **name != last) {
        assert!(fate.is_taken == fate.refusals.is_empty(), "{name}: {fate:?}");
        done += u64::from(fate.is_taken);
        refused += u64::from(!fate.is_taken);
    }
    // The robot was at each node once, one after the other.
    let nodes: Vec<f64> = (1..=robot.arrivals.len()).map(|number| number as f64).collect();
    assert_eq!(robot.arrivals, nodes, "each node once");
    assert!((robot.arrivals.len() as u64).abs_diff(2 * done) <= 2, "{done} orders");
    (done, refused)
}

/// Memory of this process, KB; 0 where the system does not tell.
fn resident_kb() -> u64 {
    let pages = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    pages.split(' ').nth(1).and_then(|pages| pages.parse::<u64>().ok()).unwrap_or(0) * 4
}

#[test]
fn killed_broker_loses_and_repeats_no_order() {
    let number = |name: &str| std::env::var(name).ok().and_then(|text| text.parse::<u64>().ok());
    let days = number("FLOORGUARD_CAMPAIGN_FROM").unwrap_or(0)..number("FLOORGUARD_CAMPAIGN_TO").unwrap_or(1);
    let share = if number("FLOORGUARD_CAMPAIGN_TO").is_some() { 1.0 } else { SHARE_IN_TESTS };
    let seed = number("FLOORGUARD_CAMPAIGN_SEED").unwrap_or(1);
    let (mut done, mut refused) = (0, 0);
    for day in days {
        let (of_day, not) = play(seed.wrapping_mul(1_000_003).wrapping_add(day), share);
        (done, refused) = (done + of_day, refused + not);
    }
    println!("campaign: carried out = {done}\ncampaign: refused = {refused}");
    assert!(done > 10 && refused > 0, "{done} {refused}");
}
