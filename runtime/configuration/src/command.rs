//! Who drives, if it is not the robot itself: a program outside that sends velocities (book, Velocity link).

use std::net::SocketAddr;

use super::address::{DatagramAddress, SenderAddress, SerialAddress, parse_serial};
use super::reader::Reader;
use super::ros2::{DEADLINE_MS, RosTopic};

/// How often permits go out by datagrams and over a line, a second.
const PERMITS_HZ: i64 = 50;
/// The bytes of permits of which a line must take this many a second, with a start and a stop bit each.
const BITS_PER_PERMIT: u32 = 236 * 10;
/// Programs that only listen.
const SUBSCRIBERS_MAX: usize = 8;
/// Sections that request velocities, too.
const OTHER_DRIVERS: [&str; 3] = ["mission", "navigation", "route"];

/// What a section may say.
#[cfg(test)]
pub(crate) const EXAMPLE_SECTION: &str = "[command]\nsource = \"udp:127.0.0.1:7000\"\n";

/// Where velocities come from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CommandAddress {
    /// A port, and its accepted sender.
    Datagrams(DatagramAddress),
    /// A serial line.
    Serial(SerialAddress),
    /// A topic of ROS 2.
    Ros(RosTopic),
}

/// How the robot is driven from outside.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CommandConfiguration {
    /// Where velocities come from; permits go back there.
    pub address: CommandAddress,
    /// The only sender that is listened to; without it, the first that sends.
    pub sender_id: Option<u32>,
    /// Who gets the permits, too.
    pub subscribers: Vec<SocketAddr>,
    /// Permits a second, 20 to 50.
    pub permits_hz: u32,
}

impl CommandConfiguration {
    /// A port on which the first sender is listened to.
    #[must_use]
    pub const fn on_port(local: SocketAddr) -> Self {
        Self::at(CommandAddress::Datagrams(DatagramAddress { local, sender: None }))
    }

    /// A topic of ROS 2.
    #[must_use]
    pub const fn on_topic(topic: RosTopic) -> Self {
        Self::at(CommandAddress::Ros(topic))
    }

    const fn at(address: CommandAddress) -> Self {
        Self { address, sender_id: None, subscribers: Vec::new(), permits_hz: PERMITS_HZ as u32 }
    }
}

impl CommandConfiguration {
    /// Where velocities come from and whose, in words.
    #[must_use]
    pub fn in_words(&self) -> String {
        let place = match &self.address {
            CommandAddress::Datagrams(address) => format!("udp:{}", address.local),
            CommandAddress::Serial(line) => format!("serial:{}", line.device.display()),
            CommandAddress::Ros(topic) => format!("ros2:{}", topic.name),
        };
        let sender = self.sender_id.map_or("the first sender".to_owned(), |id| format!("sender {id}"));
        format!("velocities of {sender} at {place}, {} permits a second", self.permits_hz)
    }
}

pub(super) fn read_command(top: &Reader<'_>, section: Reader<'_>) -> Option<CommandConfiguration> {
    for other in OTHER_DRIVERS.into_iter().filter(|other| top.find(other).is_some()) {
        section.refuse(
            section.span(),
            format!("[command] and [{other}] both request velocities"),
            format!("remove [{other}] where a program outside drives, or [command] where the robot does"),
        );
    }
    let address = read_address(&section);
    let sender_id = section.integer_or("sender_id", 0..=i64::from(u32::MAX), 0) as u32;
    let sender_id = (sender_id != 0).then_some(sender_id);
    let subscribers = read_subscribers(&section);
    let permits_hz = section.integer_or("permits_hz", 20..=50, PERMITS_HZ) as u32;
    if let Some(CommandAddress::Serial(line)) = &address
        && line.baud < permits_hz * BITS_PER_PERMIT
    {
        section.refuse(
            section.span(),
            format!("[command]: {permits_hz} permits a second do not fit {} Bd", line.baud),
            format!("write baud = {} or more, or fewer permits_hz", permits_hz * BITS_PER_PERMIT),
        );
    }
    section.finish();
    Some(CommandConfiguration { address: address?, sender_id, subscribers, permits_hz })
}

fn read_address(section: &Reader<'_>) -> Option<CommandAddress> {
    let example = "udp:0.0.0.0:7000";
    let (text, span) = section.text("source", example)?;
    let sender = read_sender(section);
    let datagrams = DatagramAddress::parse(text)
        .map(|address| CommandAddress::Datagrams(DatagramAddress { sender, ..address }));
    let baud = || section.integer("baud", 9_600..=4_000_000) as u32;
    let line =
        || parse_serial(text).map(|device| CommandAddress::Serial(SerialAddress { device, baud: baud() }));
    let deadline_ms = || section.integer_or("deadline_ms", 20..=1_000, DEADLINE_MS.into()) as u16;
    let held = |topic| RosTopic { deadline_ms: deadline_ms(), ..topic };
    let topic = || RosTopic::parse(text).map(|topic| CommandAddress::Ros(held(topic)));
    let address = datagrams.or_else(line).or_else(topic);
    if address.is_none() {
        section.refuse(
            &span,
            format!("[command]: `source` is \"{text}\", no address of this kind"),
            format!("write for example \"{example}\", \"serial:/dev/ttyUSB2\" or \"ros2:/cmd_vel\""),
        );
    }
    address
}

fn read_sender(section: &Reader<'_>) -> Option<SenderAddress> {
    let (text, span) = section.text_or_absent(
        "sender",
        "192.168.1.10",
        "every address may send; the first holds the robot",
    )?;
    let sender = SenderAddress::parse(text);
    if sender.is_none() {
        section.refuse(
            &span,
            format!("[command]: `sender` is \"{text}\", no address of a computer"),
            "write for example \"192.168.1.10\", or with its port \"192.168.1.10:7001\"",
        );
    }
    sender
}

/// Addresses separated by commas.
fn read_subscribers(section: &Reader<'_>) -> Vec<SocketAddr> {
    let Some((text, span)) =
        section.text_or_absent("subscribers", "192.168.1.11:7001", "only the sender gets permits")
    else {
        return Vec::new();
    };
    let read: Option<Vec<SocketAddr>> = text.split(',').map(|address| address.trim().parse().ok()).collect();
    let read = read.filter(|addresses| addresses.len() <= SUBSCRIBERS_MAX);
    if read.is_none() {
        section.refuse(
            &span,
            format!(
                "[command]: `subscribers` is \"{text}\", not up to {SUBSCRIBERS_MAX} addresses with ports"
            ),
            "write for example \"192.168.1.11:7001, 192.168.1.12:7001\"",
        );
    }
    read.unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EXAMPLE, parse};

    /// The example robot without its route, and with this section.
    fn with(section: &str) -> String {
        let body = EXAMPLE.split("[route]").next().unwrap_or_default();
        format!("{body}{section}")
    }

    #[test]
    fn command_by_datagrams_or_line_is_read() {
        let text = with(
            "[command]\nsource = \"udp:127.0.0.1:7000\"\nsender = \"10.0.0.2\"\nsender_id = 7\nsubscribers = \"10.0.0.3:7001, 10.0.0.4:7001\"\n",
        );
        let command =
            parse("robot.toml", &text).unwrap_or_else(|refused| panic!("{refused}")).command.unwrap();
        assert_eq!((command.sender_id, command.permits_hz, command.subscribers.len()), (Some(7), 50, 2));
        let text = with("[command]\nsource = \"serial:/dev/ttyUSB2\"\nbaud = 115200\npermits_hz = 20\n");
        let command =
            parse("robot.toml", &text).unwrap_or_else(|refused| panic!("{refused}")).command.unwrap();
        assert!(matches!(command.address, CommandAddress::Serial(SerialAddress { baud: 115_200, .. })));
        let text = with("[command]\nsource = \"ros2:/cmd_vel\"\ndeadline_ms = 300\n");
        let command =
            parse("robot.toml", &text).unwrap_or_else(|refused| panic!("{refused}")).command.unwrap();
        let topic = RosTopic { name: "/cmd_vel".to_owned(), deadline_ms: 300 };
        assert_eq!(command.address, CommandAddress::Ros(topic));
        assert!(parse("robot.toml", EXAMPLE).unwrap().command.is_none());
    }

    #[test]
    fn wrong_command_sections_are_refused() {
        let line = "[command]\nsource = \"serial:/dev/ttyUSB2\"\nbaud = 115200\n";
        let port = EXAMPLE_SECTION;
        for (text, words) in [
            (format!("{EXAMPLE}\n{port}"), "[command] and [route] both request velocities"),
            (with(line), "50 permits a second do not fit 115200 Bd"),
            (with(&port.replace("udp:", "tcp:")), "no address of this kind"),
            (with("[command]\nsource = \"ros2:cmd_vel\"\n"), "no address of this kind"),
            (with(&format!("{port}deadline_ms = 100\n")), "`deadline_ms` is not a known key"),
            (with(&format!("{port}sender = \"robot\"\n")), "`sender` is \"robot\""),
            (with(&format!("{port}sender_id = -1\n")), "sender_id"),
            (with(&format!("{port}subscribers = \"10.0.0.3\"\n")), "`subscribers` is \"10.0.0.3\""),
            (with(&format!("{port}permits_hz = 10\n")), "permits_hz"),
            (with(&format!("{port}baud = 9600\n")), "`baud` is not a known key"),
            (with(&port.replace("7000", "2368")), "so is that of [lidar]"),
        ] {
            let refused = parse("robot.toml", &text).expect_err(words).to_string();
            assert!(refused.contains(words), "{words} is not in: {refused}");
        }
    }
}
