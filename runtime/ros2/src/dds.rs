//! One participant of DDS, whose messages are CDR that is written and read elsewhere.

use std::convert::Infallible;

use rustdds::bytes::Bytes;
use rustdds::no_key::{
    DataReader, DataSample, DataWriter, Decode, DefaultDecoder, DeserializerAdapter, SerializerAdapter,
};
use rustdds::policy::{Durability, History, Reliability};
use rustdds::{
    DomainParticipant, Duration, QosPolicies, QosPolicyBuilder, RTPSEntity as _, RepresentationIdentifier,
    Topic, TopicKind,
};

use super::names;

/// A message with its four bytes that say how it is written.
pub type Message = Vec<u8>;
/// Writes messages of one topic.
pub type MessageWriter = DataWriter<Message, Plain>;
/// Reads messages of one topic.
pub type MessageReader = DataReader<Message, Plain>;
/// One message, with who wrote it and when.
pub type Sample = DataSample<Message>;

/// Leaves messages as they are.
pub struct Plain;

impl SerializerAdapter<Message> for Plain {
    type Error = Infallible;

    fn output_encoding() -> RepresentationIdentifier {
        RepresentationIdentifier::CDR_LE
    }

    fn to_bytes(message: &Message) -> Result<Bytes, Infallible> {
        Ok(Bytes::copy_from_slice(message.get(4..).unwrap_or_default()))
    }
}

impl DeserializerAdapter<Message> for Plain {
    type Error = Infallible;
    type Decoded = Message;

    fn supported_encodings() -> &'static [RepresentationIdentifier] {
        &[RepresentationIdentifier::CDR_LE, RepresentationIdentifier::CDR_BE]
    }

    fn transform_decoded(decoded: Message) -> Message {
        decoded
    }
}

impl DefaultDecoder<Message> for Plain {
    type Decoder = PlainDecoder;
    const DECODER: PlainDecoder = PlainDecoder;
}

/// Puts the four bytes before the message again.
#[derive(Clone)]
pub struct PlainDecoder;

impl Decode<'_, Message> for PlainDecoder {
    type Error = Infallible;

    fn decode_bytes(self, bytes: &[u8], encoding: RepresentationIdentifier) -> Result<Message, Infallible> {
        let little = u8::from(encoding == RepresentationIdentifier::CDR_LE);
        Ok([&[0, little, 0, 0], bytes].concat())
    }
}

/// What a topic offers to those who come late or lose messages. All of them are reliable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// The newest few.
    Newest(i32),
    /// The same, and who comes late gets them, too.
    Kept(i32),
}

impl Quality {
    fn policies(self) -> QosPolicies {
        let (durability, depth) = match self {
            Self::Newest(depth) => (Durability::Volatile, depth),
            Self::Kept(depth) => (Durability::TransientLocal, depth),
        };
        // Only the bridge's own thread waits, and not for long: a reader that stalls loses messages.
        let max_blocking_time = Duration::from_millis(5);
        QosPolicyBuilder::new()
            .reliability(Reliability::Reliable { max_blocking_time })
            .durability(durability)
            .history(History::KeepLast { depth })
            .build()
    }
}

/// Reads from writers of any reliability.
fn undemanding() -> QosPolicies {
    QosPolicyBuilder::new()
        .reliability(Reliability::BestEffort)
        .durability(Durability::Volatile)
        .history(History::KeepLast { depth: 8 })
        .build()
}

/// A topic that has a name of DDS, and its type's name of ROS 2.
#[derive(Clone, Debug)]
pub struct Named {
    /// In DDS.
    pub topic: String,
    /// In ROS 2.
    pub kind: &'static str,
}

/// Our participant, and the names of all that it reads and writes.
pub struct Participant {
    participant: DomainParticipant,
    publisher: rustdds::Publisher,
    subscriber: rustdds::Subscriber,
    readers: Vec<[u8; 16]>,
    writers: Vec<[u8; 16]>,
}

/// What DDS refuses, in its own words.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Refused(String);

impl<E: std::error::Error> From<&E> for Refused {
    fn from(error: &E) -> Self {
        Self(error.to_string())
    }
}

fn refused(error: impl std::fmt::Debug) -> Refused {
    Refused(format!("{error:?}"))
}

impl Participant {
    /// Over an opened participant.
    ///
    /// # Errors
    /// DDS refuses it.
    pub fn over(participant: DomainParticipant) -> Result<Self, Refused> {
        let publisher = participant.create_publisher(&Quality::Newest(1).policies()).map_err(refused)?;
        let subscriber = participant.create_subscriber(&undemanding()).map_err(refused)?;
        Ok(Self { participant, publisher, subscriber, readers: Vec::new(), writers: Vec::new() })
    }

    fn topic(&self, named: &Named, policies: &QosPolicies) -> Result<Topic, Refused> {
        let kind = names::dds_type(named.kind);
        self.participant.create_topic(named.topic.clone(), kind, policies, TopicKind::NoKey).map_err(refused)
    }

    /// Writes a topic.
    ///
    /// # Errors
    /// DDS refuses it.
    pub fn writer(&mut self, named: &Named, quality: Quality) -> Result<MessageWriter, Refused> {
        let policies = quality.policies();
        let topic = self.topic(named, &policies)?;
        let writer = self.publisher.create_datawriter_no_key(&topic, Some(policies)).map_err(refused)?;
        self.writers.push(writer.guid().to_bytes());
        Ok(writer)
    }

    /// Reads a topic; `reliably` where every message counts.
    ///
    /// # Errors
    /// DDS refuses it.
    pub fn reader(&mut self, named: &Named, reliably: bool) -> Result<MessageReader, Refused> {
        let policies = if reliably { Quality::Newest(8).policies() } else { undemanding() };
        let topic = self.topic(named, &policies)?;
        let reader = self.subscriber.create_datareader_no_key(&topic, Some(policies)).map_err(refused)?;
        self.readers.push(reader.guid().to_bytes());
        Ok(reader)
    }

    /// The participant's own name.
    pub fn name(&self) -> [u8; 16] {
        self.participant.guid().to_bytes()
    }

    /// The names of all readers and of all writers so far.
    pub fn entities(&self) -> (&[[u8; 16]], &[[u8; 16]]) {
        (&self.readers, &self.writers)
    }
}
