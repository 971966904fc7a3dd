//! With Debian's Mosquitto, which nobody here wrote: last will, retained messages, a broker that is killed.

use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::{Duration, Instant};

use rumqttc::{Client, Event, Incoming, MqttOptions, QoS};
use serde_json::{Value, json};

use super::orders::{instant, order, vehicle};
use crate::broker::FleetLink;
use crate::mqtt::{BrokerAddress, MqttVersion};
use crate::vehicle::{
    CleaningMoment, CleaningPlace, CleaningStage, VehicleCommand, VehicleMoment, VehiclePose,
};

const PROGRAM: &str = "/usr/sbin/mosquitto";
/// No step takes longer where it works.
const PATIENCE: Duration = Duration::from_secs(15);
/// States that a hanging broker is sent.
const TOGGLES: u64 = 8;

/// A broker on a free port; it keeps what waits on the disk.
struct Broker {
    child: Child,
    file: PathBuf,
    port: u16,
}

impl Broker {
    /// `None` where there is no Mosquitto.
    fn start(folder: &Path) -> Option<Self> {
        Self::start_keeping(folder, true)
    }

    /// One that keeps what waits over its own end, or not.
    fn start_keeping(folder: &Path, keeps: bool) -> Option<Self> {
        if !Path::new(PROGRAM).exists() {
            eprintln!("skipped: there is no {PROGRAM}; apt-get install mosquitto");
            return None;
        }
        let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let file = folder.join("mosquitto.conf");
        let kept = folder.display();
        let text = format!(
            "listener {port} 127.0.0.1\nallow_anonymous true\npersistence {keeps}\npersistence_location {kept}/\n\
             autosave_interval 1\nuser root\nlog_type error\n"
        );
        std::fs::write(&file, text).unwrap();
        Some(Self { child: spawn(&file), file, port })
    }

    /// Killed in order, so that it writes what it keeps, and started again.
    fn restart(&mut self, away: Duration) {
        self.signal("-TERM");
        self.child.wait().unwrap();
        thread::sleep(away);
        self.child = spawn(&self.file);
    }

    fn signal(&self, signal: &str) {
        let pid = self.child.id().to_string();
        assert!(Command::new("kill").args([signal, &pid]).status().unwrap().success());
    }

    /// Killed as by a loss of power, and started again.
    fn lose_power(&mut self) {
        let _ = self.child.kill();
        self.child.wait().unwrap();
        self.child = spawn(&self.file);
    }

    fn address(&self, mqtt: MqttVersion) -> BrokerAddress {
        BrokerAddress { host: "127.0.0.1".to_owned(), port: self.port, mqtt, ..BrokerAddress::default() }
    }
}

fn spawn(file: &Path) -> Child {
    let mut command = Command::new(PROGRAM);
    command.arg("-c").arg(file).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().expect("mosquitto starts")
}

impl Drop for Broker {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A master: it sends, and hears everything.
struct Master {
    client: Client,
    heard: Receiver<(String, Value)>,
}

impl Master {
    fn join(port: u16) -> Self {
        let mut options = MqttOptions::new("master", "127.0.0.1", port);
        options.set_clean_session(false).set_keep_alive(Duration::from_secs(5));
        let (client, mut connection) = Client::new(options, 64);
        let (sender, heard) = channel();
        let listener = client.clone();
        thread::spawn(move || {
            for event in connection.iter() {
                match event {
                    Ok(Event::Incoming(Incoming::ConnAck(_))) => {
                        _ = listener.try_subscribe("uagv/v2/#", QoS::AtLeastOnce);
                    }
                    Ok(Event::Incoming(Incoming::Publish(message))) => {
                        let name = message.topic.rsplit('/').next().unwrap_or_default().to_owned();
                        let value = serde_json::from_slice(&message.payload).unwrap_or_default();
                        if sender.send((name, value)).is_err() {
                            return;
                        }
                    }
                    Ok(_) => {}
                    Err(_) => thread::sleep(Duration::from_millis(50)),
                }
            }
        });
        Self { client, heard }
    }

    fn send(&self, topic: &str, message: &Value) {
        let name = format!("uagv/v2/floorguard/7/{topic}");
        self.client.publish(name, QoS::AtLeastOnce, false, message.to_string()).unwrap();
    }

    /// Waits for a message with something, while a robot goes on.
    fn until(&self, robot: &mut Robot, topic: &str, is_it: impl Fn(&Value) -> bool) -> Value {
        let began = Instant::now();
        while began.elapsed() < PATIENCE {
            robot.step();
            if let Ok((name, value)) = self.heard.recv_timeout(Duration::from_millis(10)) {
                robot.states.extend((name == "state").then(|| value.clone()));
                if name == topic && is_it(&value) {
                    return value;
                }
            }
        }
        panic!("no such message on {topic}");
    }
}

/// A robot that drives at once.
struct Robot {
    link: Option<FleetLink>,
    moment: VehicleMoment,
    began: Instant,
    places: Vec<f64>,
    states: Vec<Value>,
    cleanings: Vec<CleaningPlace>,
}

impl Robot {
    fn new((broker, mqtt): (&Broker, MqttVersion), folder: &Path) -> Self {
        let link = FleetLink::open(vehicle("7"), &broker.address(mqtt), Some(folder.join("fleet"))).unwrap();
        let pose = Some(VehiclePose::default());
        let moment =
            VehicleMoment { pose, is_automatic: true, is_localised: true, ..VehicleMoment::default() };
        Self {
            link: Some(link),
            moment,
            began: Instant::now(),
            places: Vec::new(),
            states: Vec::new(),
            cleanings: Vec::new(),
        }
    }

    fn step(&mut self) {
        self.moment.now_s = self.began.elapsed().as_secs_f64();
        let commands = self.link.as_mut().map(|link| link.attend(self.moment.clone())).unwrap_or_default();
        for command in commands {
            match command {
                VehicleCommand::Goto(place) => {
                    self.places.push(place.pose.x_m);
                    (self.moment.pose, self.moment.reached) = (Some(place.pose), Some(place.number));
                }
                VehicleCommand::Clean(place) => {
                    self.cleaned(place.number, CleaningStage::Running);
                    self.cleanings.push(place);
                }
                VehicleCommand::Pause => self.moment.is_paused = true,
                VehicleCommand::Resume => self.moment.is_paused = false,
                _ => {}
            }
        }
    }
}

impl Robot {
    fn cleaned(&mut self, number: u32, stage: CleaningStage) {
        let words = "9 of 9 dirty cells are clean".to_owned();
        self.moment.cleaning = Some(CleaningMoment { number, stage, words });
    }
}

/// The broker goes while the robot cleans, and the cleaning ends meanwhile: the master hears of it, and it is done once.
#[test]
fn cleaning_ends_while_the_broker_is_away() {
    for mqtt in [MqttVersion::V3, MqttVersion::V5] {
        let folder = tempfile::tempdir().unwrap();
        let Some((mut broker, master, mut robot)) = joined(mqtt, folder.path()) else { return };
        let mut message = order("a", 0, (0, 3, 0));
        message["nodes"][1]["actions"] = json!([super::cleaning::clean("c1", json!([]))]);
        master.send("order", &message);
        let is = |state: &Value, wanted: &str| state["actionStates"][0]["actionStatus"] == wanted;
        master.until(&mut robot, "state", |state| is(state, "RUNNING"));
        let away = thread::spawn(move || {
            broker.restart(Duration::from_millis(300));
            broker
        });
        thread::sleep(Duration::from_millis(100));
        let number = robot.cleanings[0].number;
        robot.cleaned(number, CleaningStage::Finished);
        for _ in 0..20 {
            robot.step();
            thread::sleep(Duration::from_millis(10));
        }
        let broker = away.join().unwrap();
        let done = master.until(&mut robot, "state", |state| is(state, "FINISHED"));
        assert_eq!(done["actionStates"][0]["resultDescription"], "9 of 9 dirty cells are clean");
        master.until(&mut robot, "state", |state| state["lastNodeId"] == "n2");
        assert_eq!((robot.places.as_slice(), robot.cleanings.len()), ([1.0, 2.0].as_slice(), 1), "{mqtt:?}");
        drop(broker);
    }
}

#[test]
fn order_survives_broker_restarts() {
    order_survives(MqttVersion::V3);
}

#[test]
fn order_survives_broker_restarts_over_mqtt_5() {
    order_survives(MqttVersion::V5);
}

/// A broker that forgets everything with its power: what was on its way goes out again, and what comes after it, too.
#[test]
fn broker_that_forgets_loses_no_state() {
    for mqtt in [MqttVersion::V3, MqttVersion::V5] {
        let folder = tempfile::tempdir().unwrap();
        let Some(mut broker) = Broker::start_keeping(folder.path(), false) else { return };
        let mut robot = Robot::new((&broker, mqtt), folder.path());
        let master = Master::join(broker.port);
        master.until(&mut robot, "connection", |value| value["connectionState"] == "ONLINE");
        let confirmed = |robot: &Robot| robot.link.as_ref().map_or(0, FleetLink::confirmed);
        // What it announced has arrived by then.
        for _ in 0..50 {
            robot.step();
            thread::sleep(Duration::from_millis(10));
        }
        let before = confirmed(&robot);
        // A broker that hangs confirms nothing: these are on their way when it loses its power.
        broker.signal("-STOP");
        for round in 0..TOGGLES {
            robot.moment.is_paused = round % 2 == 0;
            for _ in 0..12 {
                robot.step();
                thread::sleep(Duration::from_millis(10));
            }
        }
        assert_eq!(confirmed(&robot), before, "{mqtt:?}: it hangs");
        broker.lose_power();
        let began = Instant::now();
        while confirmed(&robot) < before + TOGGLES && began.elapsed() < PATIENCE {
            robot.step();
            thread::sleep(Duration::from_millis(10));
        }
        let arrived = confirmed(&robot) - before;
        assert!(arrived >= TOGGLES, "{mqtt:?}: {arrived} of {TOGGLES} states arrived");
    }
}

/// A broker, a master and a robot whose master knows that it is there; `None` where there is no Mosquitto.
fn joined(mqtt: MqttVersion, folder: &Path) -> Option<(Broker, Master, Robot)> {
    let broker = Broker::start(folder)?;
    let mut robot = Robot::new((&broker, mqtt), folder);
    let master = Master::join(broker.port);
    master.until(&mut robot, "connection", |value| value["connectionState"] == "ONLINE");
    Some((broker, master, robot))
}

/// What is ordered while a vehicle is switched off waits for it at the broker.
#[test]
fn order_waits_for_an_absent_vehicle() {
    for mqtt in [MqttVersion::V3, MqttVersion::V5] {
        let folder = tempfile::tempdir().unwrap();
        let Some((broker, master, mut robot)) = joined(mqtt, folder.path()) else { return };
        drop(robot.link.take());
        master.until(&mut robot, "connection", |value| value["connectionState"] == "OFFLINE");
        master.send("order", &order("w", 0, (0, 2, 0)));
        // The broker has the order before the vehicle is back.
        thread::sleep(Duration::from_millis(300));
        let mut robot = Robot::new((&broker, mqtt), folder.path());
        master.until(&mut robot, "state", |state| state["lastNodeId"] == "n1");
        assert_eq!(robot.places.last(), Some(&1.0), "{mqtt:?}");
    }
}

/// A vehicle whose connection breaks says no farewell: the broker publishes its last will. Here it breaks because another client takes
/// the vehicle's name.
#[test]
fn vanished_vehicle_is_announced_by_its_will() {
    for mqtt in [MqttVersion::V3, MqttVersion::V5] {
        let folder = tempfile::tempdir().unwrap();
        let Some((broker, master, mut robot)) = joined(mqtt, folder.path()) else { return };
        let (client, mut connection) =
            Client::new(MqttOptions::new("floorguard-7", "127.0.0.1", broker.port), 8);
        let taken = connection.iter().take(5).flatten();
        assert!(taken.into_iter().any(|event| matches!(event, Event::Incoming(Incoming::ConnAck(_)))));
        master.until(&mut robot, "connection", |value| value["connectionState"] == "CONNECTIONBROKEN");
        client.disconnect().unwrap();
    }
}

fn order_survives(mqtt: MqttVersion) {
    let folder = tempfile::tempdir().unwrap();
    let Some((mut broker, master, mut robot)) = joined(mqtt, folder.path()) else { return };
    master.send("instantActions", &instant("factsheetRequest", "f", json!([])));
    let sheet = master.until(&mut robot, "factsheet", |_| true);
    assert_eq!(sheet["protocolFeatures"]["agvActions"].as_array().unwrap().len(), 9);
    master.send("order", &order("a", 0, (0, 3, 0)));
    master.until(&mut robot, "state", |state| state["lastNodeId"] == "n2");
    // While the broker is away the robot is paused and goes on: the master hears of both.
    let pid = broker.child.id();
    assert!(pid > 0);
    let away = thread::spawn(move || {
        broker.restart(Duration::from_millis(200));
        broker
    });
    for paused in [false, true, false, true] {
        robot.moment.is_paused = paused;
        for _ in 0..12 {
            robot.step();
            // Longer than the least time from state to state, 100 ms, in all.
            thread::sleep(Duration::from_millis(10));
        }
    }
    let broker = away.join().unwrap();
    let before = robot.states.len();
    robot.moment.is_paused = false;
    master
        .until(&mut robot, "state", |state| state["paused"] == false && state["headerId"].as_u64() > Some(0));
    master.send("order", &order("a", 1, (4, 3, 0)));
    master.until(&mut robot, "state", |state| state["lastNodeId"] == "n4");
    assert_eq!(robot.places, [1.0, 2.0, 3.0, 4.0], "each node once");
    let paused = robot.states[before..].iter().filter(|state| state["paused"] == true).count();
    assert!(paused >= 1, "what happened while the broker was away arrived");
    let mut headers: Vec<u64> = robot.states.iter().filter_map(|state| state["headerId"].as_u64()).collect();
    headers.dedup();
    let missing = headers.windows(2).filter(|pair| pair[1] > pair[0] + 1).count();
    assert_eq!(missing, 0, "no state is lost: {headers:?}");
    drop(robot.link.take());
    master.until(&mut robot, "connection", |value| value["connectionState"] == "OFFLINE");
    drop(broker);
}
