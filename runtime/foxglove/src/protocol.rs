//! The protocol of Foxglove's live connections: text frames of JSON, binary frames of messages.
//!
//! Source: Foxglove WebSocket protocol v1, specification (ws-protocol, docs/spec.md): serverInfo, advertise, status, subscribe,
//! unsubscribe, message data and time.

use floorguard_recording::Schema;
use serde::Deserialize;
use serde_json::{Value, json};

/// Names of the protocol, the newest first: both understand what this server sends.
pub const SUBPROTOCOLS: [&str; 2] = ["foxglove.sdk.v1", "foxglove.websocket.v1"];

/// First byte of a message, and of a time.
const MESSAGE_DATA: u8 = 1;
const TIME: u8 = 2;
/// Level of a status: something is lost, and the connection goes on.
const WARNING: u8 = 1;
/// How the messages of all channels are written.
const MESSAGE_ENCODING: &str = "cdr";
/// How their definitions are written.
const SCHEMA_ENCODING: &str = "ros2msg";

/// A channel: one topic and its type.
#[derive(Clone, Debug)]
pub struct Channel {
    /// Its number, from 1.
    pub id: u32,
    /// Its topic.
    pub topic: &'static str,
    /// Name of its type.
    pub schema_name: &'static str,
    /// Definition of its type, with everything that it uses.
    pub schema: String,
}

impl Channel {
    /// A channel with a number.
    pub fn new(id: u32, topic: &'static str, schema: &'static Schema) -> Self {
        Self { id, topic, schema_name: schema.name, schema: schema.definition() }
    }

    fn described(&self) -> Value {
        json!({
            "id": self.id, "topic": self.topic, "encoding": MESSAGE_ENCODING, "schemaName": self.schema_name,
            "schema": self.schema, "schemaEncoding": SCHEMA_ENCODING,
        })
    }
}

/// The first frame of a connection.
pub fn server_info(name: &str, session: &str) -> String {
    json!({"op": "serverInfo", "name": name, "capabilities": ["time"], "supportedEncodings": [], "metadata": {},
        "sessionId": session})
    .to_string()
}

/// Channels that can be subscribed to.
pub fn advertise<'a>(channels: impl Iterator<Item = &'a Channel>) -> String {
    json!({"op": "advertise", "channels": channels.map(Channel::described).collect::<Vec<_>>()}).to_string()
}

/// Something that the viewer shows as a warning; a later one with the same number replaces it.
pub fn warning(id: &str, message: &str) -> String {
    json!({"op": "status", "level": WARNING, "message": message, "id": id}).to_string()
}

/// A message of a subscription: number, time in nanoseconds, content.
pub fn message_data(subscription: u32, log_time_ns: u64, data: &[u8]) -> Vec<u8> {
    let mut frame = Vec::with_capacity(13 + data.len());
    frame.push(MESSAGE_DATA);
    frame.extend(subscription.to_le_bytes());
    frame.extend(log_time_ns.to_le_bytes());
    frame.extend(data);
    frame
}

/// The robot's clock, nanoseconds.
pub fn time(now_ns: u64) -> Vec<u8> {
    let mut frame = vec![TIME];
    frame.extend(now_ns.to_le_bytes());
    frame
}

/// What a viewer asks for.
#[derive(Debug, Deserialize, PartialEq, Eq)]
#[serde(tag = "op", rename_all = "camelCase")]
pub enum Request {
    /// Messages of channels from now on.
    Subscribe {
        /// Under which numbers.
        subscriptions: Vec<Subscription>,
    },
    /// No more of them.
    #[serde(rename_all = "camelCase")]
    Unsubscribe {
        /// The numbers.
        subscription_ids: Vec<u32>,
    },
    /// What this server does not offer.
    #[serde(other)]
    Other,
}

/// A subscription as its viewer numbers it.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "camelCase")]
pub struct Subscription {
    /// The viewer's number.
    pub id: u32,
    /// The channel.
    pub channel_id: u32,
}
