//! The threads that speak with a broker: one carries MQTT, one thinks. The vehicle's side never waits for either.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use floorguard_host::executor::{Ring, take_priority};

use super::agent::{FleetAgent, Outcome};
use super::connection::{BROKEN, OFFLINE, ONLINE, connection, timestamp};
use super::messages::{Topic, Topics};
use super::mqtt::{BrokerAddress, Client, Connection, Event, Farewell, OpenError};
use super::queue::{OfflineQueue, Waiting};
use super::vehicle::{VehicleCommand, VehicleDescription, VehicleMoment};

/// A broker that is away is asked again after.
const RETRY: Duration = Duration::from_millis(500);
/// The agent thinks this often.
const PERIOD: Duration = Duration::from_millis(50);
/// Messages on their way to the broker and not confirmed.
const IN_FLIGHT_MAX: usize = 32;
/// Requests that wait for the connection.
const REQUESTS_MAX: usize = 256;
/// Commands that wait for the vehicle.
const COMMANDS_MAX: usize = 64;
/// So long a program that ends waits for its last message to leave.
const FAREWELL: Duration = Duration::from_secs(2);

/// The vehicle's side of a fleet.
pub struct FleetLink {
    moment: Arc<Mutex<Option<VehicleMoment>>>,
    commands: Receiver<VehicleCommand>,
    ended: Arc<AtomicBool>,
    confirmed: Arc<AtomicU64>,
    thread: Option<JoinHandle<()>>,
}

/// What comes from the broker.
enum Heard {
    /// The broker remembers what was on its way, or not.
    Connected(bool),
    Lost(String),
    Message(Topic, Vec<u8>),
    Sent(u16),
    Confirmed(u16),
}

impl FleetLink {
    /// Joins a fleet, now or as soon as the broker is there. What has to outlive the program is kept in `folder`.
    ///
    /// # Errors
    /// The folder, or encryption that this program was built without.
    pub fn open(
        vehicle: VehicleDescription,
        broker: &BrokerAddress,
        folder: Option<PathBuf>,
    ) -> Result<Self, OpenError> {
        let topics = Topics::of(&vehicle);
        let name = format!("{}-{}", vehicle.manufacturer, vehicle.serial);
        let farewell =
            Farewell { topic: topics.full(Topic::Connection), payload: connection(&vehicle, 0, BROKEN) };
        let capacities = (REQUESTS_MAX, IN_FLIGHT_MAX as u16 * 2);
        let (client, connected) = Client::join(&name, broker, farewell, capacities)?;
        let (queue, ended) = (OfflineQueue::open(folder.as_deref())?, Arc::new(AtomicBool::new(false)));
        let agent = FleetAgent::open(vehicle.clone(), folder)?;
        let (to_agent, heard) = channel();
        let (to_vehicle, commands) = sync_channel(COMMANDS_MAX);
        let moment = Arc::new(Mutex::new(None));
        let confirmed = Arc::new(AtomicU64::new(0));
        let carrier = Carrier { topics: topics.clone(), ended: Arc::clone(&ended) };
        thread::Builder::new()
            .name("fleet-mqtt".to_owned())
            .spawn(move || carrier.carry(connected, &to_agent))?;
        let speaker = Speaker {
            vehicle,
            topics,
            client,
            agent,
            queue,
            in_flight: VecDeque::new(),
            sent: 0,
            is_connected: false,
            lost_by: None,
            connections: 0,
            has_reported: false,
            early: Vec::new(),
            knows_place: false,
            to_vehicle,
            moment: Arc::clone(&moment),
            ended: Arc::clone(&ended),
            confirmed: Arc::clone(&confirmed),
        };
        let thread = thread::Builder::new().name("fleet".to_owned()).spawn(move || speaker.speak(&heard))?;
        Ok(Self { moment, commands, ended, confirmed, thread: Some(thread) })
    }

    /// Shows the vehicle as it is now; gives what it is to do. It never waits.
    pub fn attend(&mut self, moment: VehicleMoment) -> Vec<VehicleCommand> {
        *self.moment.lock().unwrap_or_else(PoisonError::into_inner) = Some(moment);
        self.commands.try_iter().collect()
    }

    /// Messages that the broker has confirmed.
    #[must_use]
    pub fn confirmed(&self) -> u64 {
        self.confirmed.load(Ordering::Relaxed)
    }
}

impl Drop for FleetLink {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Carries MQTT.
struct Carrier {
    topics: Topics,
    ended: Arc<AtomicBool>,
}

impl Carrier {
    fn carry(self, connected: Connection, to_agent: &Sender<Heard>) {
        let _ = take_priority(Ring::Telemetry);
        connected.listen(|event| {
            let heard = match event {
                Event::Connected { remembers } => Some(Heard::Connected(remembers)),
                Event::Message(topic, payload) => {
                    self.topics.incoming(&topic).map(|topic| Heard::Message(topic, payload))
                }
                Event::Confirmed(number) => Some(Heard::Confirmed(number)),
                Event::Sent(number) => Some(Heard::Sent(number)),
                Event::Left => return false,
                Event::Other => None,
                Event::Lost(reason) => {
                    if self.ended.load(Ordering::Acquire) || to_agent.send(Heard::Lost(reason)).is_err() {
                        return false;
                    }
                    thread::sleep(RETRY);
                    None
                }
            };
            heard.is_none_or(|heard| to_agent.send(heard).is_ok())
        });
    }
}

/// A message on its way.
struct InFlight {
    number: Option<u16>,
    is_queued: bool,
}

/// Thinks and speaks.
struct Speaker {
    vehicle: VehicleDescription,
    topics: Topics,
    client: Client,
    agent: FleetAgent,
    queue: OfflineQueue,
    in_flight: VecDeque<InFlight>,
    /// The oldest so many of the queue are on their way.
    sent: usize,
    is_connected: bool,
    /// Why there is no broker, as it was reported.
    lost_by: Option<String>,
    connections: u32,
    has_reported: bool,
    /// What came before the place of the vehicle was known: orders are judged by that.
    early: Vec<(Topic, Vec<u8>)>,
    knows_place: bool,
    to_vehicle: SyncSender<VehicleCommand>,
    moment: Arc<Mutex<Option<VehicleMoment>>>,
    ended: Arc<AtomicBool>,
    confirmed: Arc<AtomicU64>,
}

impl Speaker {
    fn speak(mut self, heard: &Receiver<Heard>) {
        let _ = take_priority(Ring::Telemetry);
        loop {
            match heard.recv_timeout(PERIOD) {
                Ok(first) => {
                    self.hear(first);
                    heard.try_iter().for_each(|more| self.hear(more));
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return,
            }
            let moment = self.moment.lock().unwrap_or_else(PoisonError::into_inner).take();
            if let Some(moment) = moment {
                self.knows_place |= moment.pose.is_some();
                let outcome = self.agent.attend(moment, &timestamp());
                self.carry_out(outcome);
                let early = if self.knows_place { std::mem::take(&mut self.early) } else { Vec::new() };
                early.into_iter().for_each(|(topic, payload)| self.hear(Heard::Message(topic, payload)));
            }
            self.pump();
            if self.ended.load(Ordering::Acquire) {
                return self.leave(heard);
            }
        }
    }

    fn hear(&mut self, heard: Heard) {
        match heard {
            Heard::Connected(remembers) => {
                self.is_connected = true;
                self.lost_by = None;
                if !remembers {
                    // What was on its way is forgotten on both sides: it goes out again from the queue.
                    self.in_flight.clear();
                    self.sent = 0;
                }
                self.greet();
            }
            Heard::Lost(reason) => {
                self.is_connected = false;
                // Asked twice a second, it would say so twice a second.
                if self.lost_by.as_ref() != Some(&reason) {
                    say!("  fleet: no broker ({reason}); tried again every {} ms", RETRY.as_millis());
                    self.lost_by = Some(reason);
                }
            }
            Heard::Message(topic, payload) if self.knows_place => {
                let outcome = self.agent.receive(topic, &payload);
                self.carry_out(outcome);
            }
            Heard::Message(topic, payload) => {
                if self.early.len() < REQUESTS_MAX {
                    self.early.push((topic, payload));
                }
            }
            Heard::Sent(number) => {
                // What is sent again after a loss has its number.
                if self.in_flight.iter().all(|message| message.number != Some(number)) {
                    let next = self.in_flight.iter_mut().find(|message| message.number.is_none());
                    next.into_iter().for_each(|message| message.number = Some(number));
                }
            }
            Heard::Confirmed(number) => self.confirm(number),
        }
    }

    fn confirm(&mut self, number: u16) {
        let Some(index) = self.in_flight.iter().position(|message| message.number == Some(number)) else {
            return;
        };
        let Some(message) = self.in_flight.remove(index) else { return };
        self.confirmed.fetch_add(1, Ordering::Relaxed);
        if message.is_queued {
            // Confirmations come in the order of the messages.
            self.sent = self.sent.saturating_sub(1);
            let left = self.queue.leave();
            self.report(left.err());
        }
    }

    /// What a vehicle does first on each connection.
    fn greet(&mut self) {
        for topic in [Topic::Order, Topic::InstantActions] {
            let subscribed = self.client.subscribe(self.topics.full(topic));
            if let Err(error) = subscribed {
                say!("  fleet: {error}");
            }
        }
        self.connections = self.connections.wrapping_add(1);
        self.announce(ONLINE);
    }

    fn announce(&mut self, state: &'static str) {
        let payload = connection(&self.vehicle, self.connections, state);
        let topic = self.topics.full(Topic::Connection);
        if self.client.publish(topic, payload, (true, true)).is_ok() {
            self.in_flight.push_back(InFlight { number: None, is_queued: false });
        }
    }

    fn carry_out(&mut self, outcome: Outcome) {
        for command in outcome.commands {
            if self.to_vehicle.try_send(command).is_err() {
                say!("  fleet: a command was lost: the vehicle takes none");
            }
        }
        for message in outcome.messages {
            if message.is_kept {
                let waiting = Waiting { topic: message.topic, payload: message.payload };
                // The oldest, which is dropped where the queue is full, may be on its way.
                let pushed = self.queue.push(waiting);
                if matches!(pushed, Ok(true)) {
                    self.sent = self.sent.saturating_sub(1);
                }
                self.report(pushed.err());
            } else if self.is_connected {
                let topic = self.topics.full(message.topic);
                // What comes often may be lost: the next one is newer.
                let _ = self.client.publish(topic, message.payload, (false, false));
            }
        }
    }

    /// What waits goes out, in its order.
    fn pump(&mut self) {
        while self.is_connected && self.in_flight.len() < IN_FLIGHT_MAX {
            let Some(waiting) = self.queue.get(self.sent) else { return };
            let is_retained = waiting.topic == Topic::Factsheet;
            let topic = self.topics.full(waiting.topic);
            let payload = waiting.payload.clone();
            if self.client.publish(topic, payload, (true, is_retained)).is_err() {
                return;
            }
            self.sent += 1;
            self.in_flight.push_back(InFlight { number: None, is_queued: true });
        }
    }

    fn report(&mut self, error: Option<std::io::Error>) {
        if let Some(error) = error.filter(|_| !self.has_reported) {
            self.has_reported = true;
            say!("  fleet: what waits is not kept on the disk ({error})");
        }
    }

    /// The program ends: the master hears it.
    fn leave(mut self, heard: &Receiver<Heard>) {
        if self.is_connected {
            self.announce(OFFLINE);
            let until = std::time::Instant::now() + FAREWELL;
            while !self.in_flight.is_empty() && std::time::Instant::now() < until {
                if let Ok(more) = heard.recv_timeout(PERIOD) {
                    self.hear(more);
                }
            }
        }
        self.client.leave();
    }
}
