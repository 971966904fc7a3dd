//! From a captured frame to the UDP datagram in it.

use std::net::{Ipv4Addr, SocketAddrV4};

use pcap_parser::Linktype;

/// One UDP datagram of a capture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Datagram {
    /// When the capturing machine saw it, microseconds since its epoch.
    pub captured_us: u64,
    /// Who sent it.
    pub source: SocketAddrV4,
    /// Port of the receiver.
    pub destination_port: u16,
    /// Payload.
    pub payload: Vec<u8>,
}

/// What a datagram of a microScan3 begins with (book, microScan3: Datagrams).
const SCANNER_START: &[u8] = b"MS3 MD";

/// A microScan3 sent this payload, whatever the port.
pub fn is_scanner_datagram(payload: &[u8]) -> bool {
    payload.starts_with(SCANNER_START)
}

/// What a frame holds.
pub(super) enum Content<'a> {
    Udp { source: SocketAddrV4, destination_port: u16, payload: &'a [u8] },
    Fragment,
    Other,
}

const ETHERTYPE_IPV4: u16 = 0x0800;
const ETHERTYPES_VLAN: [u16; 2] = [0x8100, 0x88a8];
const PROTOCOL_UDP: u8 = 17;

/// Looks into a frame of the given link type.
pub(super) fn content(linktype: Linktype, frame: &[u8]) -> Content<'_> {
    match linktype {
        Linktype::ETHERNET => ethernet(frame),
        Linktype::RAW | Linktype::IPV4 => ipv4(frame),
        // Linux cooked: 16 bytes, the last two are the EtherType.
        Linktype::LINUX_SLL => match (frame.get(14..16), frame.get(16..)) {
            (Some([0x08, 0x00]), Some(rest)) => ipv4(rest),
            _ => Content::Other,
        },
        _ => Content::Other,
    }
}

/// Whether [`content`] understands the link type.
pub(super) fn is_known(linktype: Linktype) -> bool {
    matches!(linktype, Linktype::ETHERNET | Linktype::RAW | Linktype::IPV4 | Linktype::LINUX_SLL)
}

fn ethernet(frame: &[u8]) -> Content<'_> {
    let mut offset = 12;
    // At most two VLAN tags.
    for _ in 0..3 {
        let Some([high, low]) = frame.get(offset..offset + 2) else { return Content::Other };
        let ethertype = u16::from_be_bytes([*high, *low]);
        if ethertype == ETHERTYPE_IPV4 {
            return ipv4(frame.get(offset + 2..).unwrap_or_default());
        }
        if !ETHERTYPES_VLAN.contains(&ethertype) {
            return Content::Other;
        }
        offset += 4;
    }
    Content::Other
}

fn ipv4(packet: &[u8]) -> Content<'_> {
    let [first, _, length_high, length_low, _, _, flags, fragment, _, protocol, _, _, a, b, c, d, ..] =
        packet
    else {
        return Content::Other;
    };
    if first >> 4 != 4 || *protocol != PROTOCOL_UDP {
        return Content::Other;
    }
    if u16::from_be_bytes([*flags, *fragment]) & 0x3fff != 0 {
        return Content::Fragment;
    }
    let header = usize::from(first & 0xf) * 4;
    let total = usize::from(u16::from_be_bytes([*length_high, *length_low])).min(packet.len());
    match packet.get(header..total) {
        Some([source_high, source_low, port_high, port_low, udp_high, udp_low, _, _, payload @ ..]) => {
            let length = usize::from(u16::from_be_bytes([*udp_high, *udp_low])).saturating_sub(8);
            let destination_port = u16::from_be_bytes([*port_high, *port_low]);
            let source_port = u16::from_be_bytes([*source_high, *source_low]);
            let source = SocketAddrV4::new(Ipv4Addr::new(*a, *b, *c, *d), source_port);
            let payload = payload.get(..length).unwrap_or(payload);
            Content::Udp { source, destination_port, payload }
        }
        _ => Content::Other,
    }
}
