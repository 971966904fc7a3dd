//! One client over both versions of MQTT that are spoken: 3.1.1 and 5.
//!
//! Of version 5 only what version 3.1.1 cannot say is used: how long the broker keeps what waits for a vehicle that is away.

use std::path::{Path, PathBuf};
use std::time::Duration;

use rumqttc::v5::mqttbytes as v5_bytes;
use rumqttc::{Outgoing, QoS, v5};

/// Broker and vehicle show each other this often that they are there, seconds (chapter 6.14).
const KEEP_ALIVE: Duration = Duration::from_secs(15);
/// Largest message, bytes.
const PACKET_MAX: u32 = 1 << 20;
/// So long a broker of version 5 keeps what waits, seconds: a week's holiday. One of version 3.1.1 decides itself.
const SESSION_S: u32 = 7 * 24 * 3_600;

/// Which MQTT.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MqttVersion {
    /// 3.1.1: what every broker speaks.
    #[default]
    V3,
    /// 5.
    V5,
}

/// Where a broker is, and how it is spoken to.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BrokerAddress {
    /// Name or address.
    pub host: String,
    /// 1883, or 8883 with TLS.
    pub port: u16,
    /// Certificates of the authority that has signed the broker's, PEM; with it the connection is encrypted.
    pub authority: Option<PathBuf>,
    /// Name and password.
    pub login: Option<(String, String)>,
    /// Which MQTT it speaks.
    pub mqtt: MqttVersion,
}

/// The vehicle cannot join a fleet.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// Folder, file or thread.
    #[error("{0}")]
    Input(#[from] std::io::Error),
    /// Encryption.
    #[error("{0}")]
    Tls(String),
}

/// The last will: what the broker publishes when the vehicle has gone.
pub struct Farewell {
    /// Topic.
    pub topic: String,
    /// Message; the broker keeps it for who comes later.
    pub payload: String,
}

/// Orders to the carrier. Nothing of it waits.
pub enum Client {
    /// Version 3.1.1.
    V3(rumqttc::Client),
    /// Version 5.
    V5(v5::Client),
}

/// What happens at the broker; it must be listened to, or nothing moves.
pub enum Connection {
    /// Version 3.1.1.
    V3(rumqttc::Connection),
    /// Version 5.
    V5(v5::Connection),
}

/// What happened.
#[derive(Debug, PartialEq, Eq)]
pub enum Event {
    /// The broker took the vehicle in. It remembers what was on its way before, or not: then all of that is lost.
    Connected {
        /// It remembers.
        remembers: bool,
    },
    /// There is no broker, or it sends the vehicle away.
    Lost(String),
    /// Topic and content.
    Message(String, Vec<u8>),
    /// A message that must be confirmed has gone with this number.
    Sent(u16),
    /// The broker has it.
    Confirmed(u16),
    /// The vehicle has left.
    Left,
    /// Nothing of interest.
    Other,
}

/// The queue of requests is full.
#[derive(Debug, thiserror::Error)]
#[error("the connection takes nothing more: {0}")]
pub struct Full(String);

impl Client {
    /// A vehicle of a name, in a fleet whose broker is at an address; so many requests wait, so many messages are on their way.
    ///
    /// # Errors
    /// Encryption.
    pub fn join(
        name: &str,
        broker: &BrokerAddress,
        farewell: Farewell,
        (requests, in_flight): (usize, u16),
    ) -> Result<(Self, Connection), OpenError> {
        let transport = broker.authority.as_deref().map(encrypted).transpose()?;
        Ok(match broker.mqtt {
            MqttVersion::V3 => {
                let mut options = rumqttc::MqttOptions::new(name, &broker.host, broker.port);
                let will = rumqttc::LastWill::new(farewell.topic, farewell.payload, QoS::AtLeastOnce, true);
                options
                    .set_keep_alive(KEEP_ALIVE)
                    // What comes while the vehicle is away waits at the broker.
                    .set_clean_session(false)
                    .set_inflight(in_flight)
                    .set_max_packet_size(PACKET_MAX as usize, PACKET_MAX as usize)
                    .set_last_will(will);
                if let Some((user, password)) = &broker.login {
                    options.set_credentials(user, password);
                }
                transport.map(|transport| options.set_transport(transport));
                let (client, connection) = rumqttc::Client::new(options, requests);
                (Self::V3(client), Connection::V3(connection))
            }
            MqttVersion::V5 => {
                let mut options = v5::MqttOptions::new(name, &broker.host, broker.port);
                let will = v5_bytes::v5::LastWill::new(
                    farewell.topic,
                    farewell.payload,
                    v5_bytes::QoS::AtLeastOnce,
                    true,
                    None,
                );
                options
                    .set_keep_alive(KEEP_ALIVE)
                    .set_clean_start(false)
                    .set_session_expiry_interval(Some(SESSION_S))
                    .set_outgoing_inflight_upper_limit(in_flight)
                    .set_max_packet_size(Some(PACKET_MAX))
                    .set_last_will(will);
                if let Some((user, password)) = &broker.login {
                    options.set_credentials(user, password);
                }
                transport.map(|transport| options.set_transport(transport));
                let (client, connection) = v5::Client::new(options, requests);
                (Self::V5(client), Connection::V5(connection))
            }
        })
    }

    /// From now on messages of a topic come, each at least once.
    ///
    /// # Errors
    /// [`Full`].
    pub fn subscribe(&self, topic: String) -> Result<(), Full> {
        match self {
            Self::V3(client) => client.try_subscribe(topic, QoS::AtLeastOnce).map_err(full),
            Self::V5(client) => client.try_subscribe(topic, v5_bytes::QoS::AtLeastOnce).map_err(full),
        }
    }

    /// Sends a message: confirmed, or as it may be lost; kept by the broker for who comes later, or not.
    ///
    /// # Errors
    /// [`Full`].
    pub fn publish(
        &self,
        topic: String,
        payload: String,
        (is_confirmed, is_retained): (bool, bool),
    ) -> Result<(), Full> {
        match self {
            Self::V3(client) => {
                let quality = if is_confirmed { QoS::AtLeastOnce } else { QoS::AtMostOnce };
                client.try_publish(topic, quality, is_retained, payload).map_err(full)
            }
            Self::V5(client) => {
                use v5_bytes::QoS;
                let quality = if is_confirmed { QoS::AtLeastOnce } else { QoS::AtMostOnce };
                client.try_publish(topic, quality, is_retained, payload).map_err(full)
            }
        }
    }

    /// Leaves in order.
    pub fn leave(&self) {
        // Without a broker there is nobody to leave.
        let _ = match self {
            Self::V3(client) => client.try_disconnect().map_err(full),
            Self::V5(client) => client.try_disconnect().map_err(full),
        };
    }
}

fn full(error: impl std::fmt::Display) -> Full {
    Full(error.to_string())
}

impl Connection {
    /// Shows everything that happens, until the listener has enough.
    pub fn listen(self, mut listener: impl FnMut(Event) -> bool) {
        match self {
            Self::V3(mut connection) => {
                _ = connection.iter().map(of_v3).all(&mut listener);
            }
            Self::V5(mut connection) => {
                _ = connection.iter().map(of_v5).all(&mut listener);
            }
        }
    }
}

fn of_v3(event: Result<rumqttc::Event, rumqttc::ConnectionError>) -> Event {
    use rumqttc::{Event as Happened, Incoming};
    match event {
        Ok(Happened::Incoming(Incoming::ConnAck(taken))) => {
            Event::Connected { remembers: taken.session_present }
        }
        Ok(Happened::Incoming(Incoming::Publish(message))) => {
            Event::Message(message.topic, message.payload.to_vec())
        }
        Ok(Happened::Incoming(Incoming::PubAck(ack))) => Event::Confirmed(ack.pkid),
        Ok(Happened::Outgoing(sent)) => of_sent(&sent),
        Ok(Happened::Incoming(_)) => Event::Other,
        Err(error) => Event::Lost(error.to_string()),
    }
}

fn of_v5(event: Result<v5::Event, v5::ConnectionError>) -> Event {
    use v5::{Event as Happened, Incoming};
    match event {
        Ok(Happened::Incoming(Incoming::ConnAck(taken))) => {
            Event::Connected { remembers: taken.session_present }
        }
        Ok(Happened::Incoming(Incoming::Publish(message))) => {
            Event::Message(String::from_utf8_lossy(&message.topic).into_owned(), message.payload.to_vec())
        }
        Ok(Happened::Incoming(Incoming::PubAck(ack))) => Event::Confirmed(ack.pkid),
        Ok(Happened::Outgoing(sent)) => of_sent(&sent),
        Ok(Happened::Incoming(_)) => Event::Other,
        Err(error) => Event::Lost(error.to_string()),
    }
}

const fn of_sent(sent: &Outgoing) -> Event {
    match sent {
        Outgoing::Publish(number) if *number > 0 => Event::Sent(*number),
        Outgoing::Disconnect => Event::Left,
        _ => Event::Other,
    }
}

#[cfg(feature = "tls")]
fn encrypted(authority: &Path) -> Result<rumqttc::Transport, OpenError> {
    let ca = std::fs::read(authority)?;
    // The first of the process is kept: there is one.
    let _ = rustls::crypto::ring::default_provider().install_default();
    Ok(rumqttc::Transport::tls_with_config(rumqttc::TlsConfiguration::Simple {
        ca,
        alpn: None,
        client_auth: None,
    }))
}

#[cfg(not(feature = "tls"))]
fn encrypted(_authority: &Path) -> Result<rumqttc::Transport, OpenError> {
    Err(OpenError::Tls("this program was built without TLS; build it with `--features fleet-tls`".to_owned()))
}
