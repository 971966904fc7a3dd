//! Many robots at one Mosquitto that is killed again and again: every order is carried out once, and the master learns of each.
//!
//! `cargo run --release -p floorguard-fleet --example many_robots -- ROBOTS ORDERS KILLS [5]`, with 5 over MQTT 5; it ends with 1 where an order was lost or
//! was carried out twice. The robots are where they are ordered to be at once: what is tried is the connection, not the driving.

use std::collections::BTreeMap;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::{Duration, Instant};

use floorguard_fleet::{
    BrokerAddress, Cleaning, FleetLink, MqttVersion, VehicleCommand, VehicleDescription, VehicleMoment,
    VehiclePose,
};
use rumqttc::{Client, Event, Incoming, MqttOptions, QoS};
use serde_json::{Value, json};

/// A master sends an order again that no state has shown for so long.
const AGAIN: Duration = Duration::from_secs(2);
/// Between two kills of the broker.
const KILL_EVERY: Duration = Duration::from_millis(1_200);
/// Longer than this nothing takes.
const LONGEST: Duration = Duration::from_secs(900);

struct Robot {
    link: FleetLink,
    moment: VehicleMoment,
    places: Vec<f64>,
}

impl Robot {
    fn step(&mut self, now_s: f64) {
        self.moment.now_s = now_s;
        for command in self.link.attend(self.moment.clone()) {
            if let VehicleCommand::Goto(place) = command {
                self.places.push(place.pose.x_m);
                (self.moment.pose, self.moment.reached) = (Some(place.pose), Some(place.number));
            }
        }
    }
}

fn vehicle(serial: &str) -> VehicleDescription {
    VehicleDescription {
        interface: "uagv".to_owned(),
        manufacturer: "floorguard".to_owned(),
        serial: serial.to_owned(),
        map_id: "hall".to_owned(),
        size_m: [1.2, 0.8, 1.1],
        speed_max_mps: 0.8,
        acceleration_max_mps2: [0.5, 0.8],
        outline_m: Vec::new(),
        within_m: 0.25,
        within_rad: 0.17,
        cleaning: Cleaning::Refused("it is only counted here".to_owned()),
    }
}

/// The order of a number: from where the one before ended, one metre on.
fn order(serial: &str, number: usize) -> Value {
    let node = |index: usize| {
        json!({"nodeId": format!("n{}", number + index), "sequenceId": 2 * index, "released": true, "actions": [],
            "nodePosition": {"x": (number + index) as f64, "y": 0.0, "mapId": "hall"}})
    };
    json!({"headerId": number, "timestamp": "2026-11-24T04:00:00.00Z", "version": "2.1.0", "manufacturer": "floorguard",
        "serialNumber": serial, "orderId": format!("o{number}"), "orderUpdateId": 0, "nodes": [node(0), node(1)],
        "edges": [{"edgeId": "e", "sequenceId": 1, "released": true, "startNodeId": format!("n{number}"),
            "endNodeId": format!("n{}", number + 1), "actions": []}]})
}

fn broker(file: &Path) -> Child {
    let mut command = Command::new("/usr/sbin/mosquitto");
    command.arg("-c").arg(file).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().expect("mosquitto is installed")
}

fn configure(folder: &Path, port: u16) -> PathBuf {
    let file = folder.join("mosquitto.conf");
    let kept = folder.display();
    let text = format!(
        "listener {port} 127.0.0.1\nallow_anonymous true\npersistence true\npersistence_location {kept}/\nuser root\n\
         autosave_interval 1\nmax_queued_messages 0\nlog_type error\n"
    );
    std::fs::write(&file, text).expect("a temporary folder");
    file
}

fn listen(port: u16) -> (Client, Receiver<(String, Value)>) {
    let mut options = MqttOptions::new("master", "127.0.0.1", port);
    options.set_clean_session(false).set_keep_alive(Duration::from_secs(5));
    let (client, mut connection) = Client::new(options, 4_096);
    let (sender, heard) = channel();
    let listener = client.clone();
    thread::spawn(move || {
        for event in connection.iter() {
            match event {
                Ok(Event::Incoming(Incoming::ConnAck(_))) => {
                    _ = listener.try_subscribe("uagv/v2/floorguard/+/state", QoS::AtLeastOnce);
                }
                Ok(Event::Incoming(Incoming::Publish(message))) => {
                    let serial = message.topic.split('/').nth(3).unwrap_or_default().to_owned();
                    let state = serde_json::from_slice(&message.payload).unwrap_or_default();
                    if sender.send((serial, state)).is_err() {
                        return;
                    }
                }
                Ok(_) => {}
                Err(_) => thread::sleep(Duration::from_millis(100)),
            }
        }
    });
    (client, heard)
}

/// Orders done by each robot as the master knows, and when it sent the next one.
struct Fleet {
    done: BTreeMap<String, (usize, Instant)>,
    orders: usize,
    sent: u64,
    refused: u64,
}

impl Fleet {
    fn hear(&mut self, serial: &str, state: &Value) {
        let Some((done, sent_at)) = self.done.get_mut(serial) else { return };
        let is_done = state["orderId"] == format!("o{done}")
            && state["nodeStates"].as_array().is_some_and(Vec::is_empty);
        if is_done {
            *done += 1;
            *sent_at = Instant::now() - AGAIN;
        }
        self.refused += u64::from(state["errors"].as_array().is_some_and(|errors| !errors.is_empty()));
    }

    fn send(&mut self, client: &Client) {
        for (serial, (done, sent_at)) in &mut self.done {
            if *done < self.orders && sent_at.elapsed() >= AGAIN {
                let topic = format!("uagv/v2/floorguard/{serial}/order");
                if client
                    .try_publish(topic, QoS::AtLeastOnce, false, order(serial, *done).to_string())
                    .is_ok()
                {
                    *sent_at = Instant::now();
                    self.sent += 1;
                }
            }
        }
    }

    fn is_done(&self) -> bool {
        self.done.values().all(|(done, _)| *done >= self.orders)
    }
}

/// Memory of this process, KiB.
fn memory_kib() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap_or_default();
    line.split_whitespace().next().and_then(|number| number.parse().ok()).unwrap_or(0)
}

fn main() {
    let numbers: Vec<usize> = std::env::args().skip(1).filter_map(|text| text.parse().ok()).collect();
    let (robots, orders, kills, mqtt) = match *numbers.as_slice() {
        [robots, orders, kills] => (robots, orders, kills, MqttVersion::V3),
        [robots, orders, kills, 5] => (robots, orders, kills, MqttVersion::V5),
        _ => panic!("give ROBOTS ORDERS KILLS [5]"),
    };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let port =
        TcpListener::bind("127.0.0.1:0").and_then(|socket| socket.local_addr()).expect("a free port").port();
    let file = configure(folder.path(), port);
    let mut child = broker(&file);
    let address = BrokerAddress { host: "127.0.0.1".to_owned(), port, mqtt, ..BrokerAddress::default() };
    let began = Instant::now();
    let mut fleet = Fleet { done: BTreeMap::new(), orders, sent: 0, refused: 0 };
    let mut driven: Vec<Robot> = Vec::new();
    for number in 0..robots {
        let serial = format!("robot-{number}");
        let link =
            FleetLink::open(vehicle(&serial), &address, Some(folder.path().join(&serial))).expect("opened");
        let pose = Some(VehiclePose::default());
        let moment =
            VehicleMoment { pose, is_automatic: true, is_localised: true, ..VehicleMoment::default() };
        driven.push(Robot { link, moment, places: Vec::new() });
        fleet.done.insert(serial, (0, Instant::now()));
    }
    let (client, heard) = listen(port);
    let (mut killed, mut last, mut early_kib) = (0, Instant::now(), 0);
    while !(fleet.is_done() && killed >= kills) && began.elapsed() < LONGEST {
        driven.iter_mut().for_each(|robot| robot.step(began.elapsed().as_secs_f64()));
        heard.try_iter().for_each(|(serial, state)| fleet.hear(&serial, &state));
        fleet.send(&client);
        if killed < kills && last.elapsed() >= KILL_EVERY {
            // Without a word: what it had not written is lost.
            child.kill().and_then(|()| child.wait().map(drop)).expect("it ran");
            thread::sleep(Duration::from_millis(100));
            child = broker(&file);
            (killed, last) = (killed + 1, Instant::now());
            // By a tenth of the kills everything has been there once.
            early_kib = if killed == kills.div_ceil(10) { memory_kib() } else { early_kib };
        }
        thread::sleep(Duration::from_millis(20));
    }
    let expected: Vec<f64> = (1..=orders).map(|place| place as f64).collect();
    let wrong = driven.iter().filter(|robot| robot.places != expected).count();
    let confirmed: u64 = driven.iter().map(|robot| robot.link.confirmed()).sum();
    println!(
        "{robots} robots, {orders} orders each, broker killed {killed} times, {:.0} s: {} orders sent, {confirmed} messages confirmed; \
         robots that did not drive each order once: {wrong}; all known to the master: {}; states with errors: {}; \
         memory {early_kib} KiB after a tenth of the kills, {} KiB at the end",
        began.elapsed().as_secs_f64(),
        fleet.sent,
        fleet.is_done(),
        fleet.refused,
        memory_kib()
    );
    let _ = child.kill().and_then(|()| child.wait().map(drop));
    std::process::exit(i32::from(wrong > 0 || !fleet.is_done()));
}
