//! Captures of every kind and in every state of repair: the datagrams that are there come out, then a clear error.

use std::io::{Cursor, Write as _};

use flate2::Compression;
use flate2::write::GzEncoder;
use floorguard_recording::capture::{Capture, CaptureError, Datagram};

/// IPv4 and UDP around a payload, from 192.168.1.201:2368 to port 2368.
fn ip_packet(payload: &[u8], fragment: u16) -> Vec<u8> {
    let total = (28 + payload.len()) as u16;
    let mut packet = vec![0x45, 0];
    packet.extend(total.to_be_bytes());
    packet.extend([0, 1]);
    packet.extend(fragment.to_be_bytes());
    packet.extend([64, 17, 0, 0, 192, 168, 1, 201, 255, 255, 255, 255]);
    packet.extend(2_368_u16.to_be_bytes());
    packet.extend(2_368_u16.to_be_bytes());
    packet.extend((8 + payload.len() as u16).to_be_bytes());
    packet.extend([0, 0]);
    packet.extend(payload);
    packet
}

/// An Ethernet frame with VLAN tags and, as short frames have, padding behind.
fn frame(payload: &[u8], tags: usize, fragment: u16) -> Vec<u8> {
    let mut frame = vec![0xff; 12];
    (0..tags).for_each(|_| frame.extend([0x81, 0x00, 0x00, 0x05]));
    frame.extend([0x08, 0x00]);
    frame.extend(ip_packet(payload, fragment));
    frame.extend([0; 6]);
    frame
}

/// A number as four bytes of the capture's byte order.
type Four = fn(u32) -> [u8; 4];

fn pcap(frames: &[Vec<u8>], magic: u32, four: Four, link: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    bytes.extend(four(magic));
    // Version 2.4 as two halves in the capture's order.
    bytes.extend(if four(1)[0] == 1 { [2, 0, 4, 0] } else { [0, 2, 0, 4] });
    [0, 0, 65_535, link].iter().for_each(|word| bytes.extend(four(*word)));
    for (index, frame) in frames.iter().enumerate() {
        let length = frame.len() as u32;
        [100 + index as u32, 2_000, length, length].iter().for_each(|word| bytes.extend(four(*word)));
        bytes.extend(frame);
    }
    bytes
}

fn pcapng(frames: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut block = |kind: u32, body: &[u8]| {
        let length = 12 + body.len().next_multiple_of(4) as u32;
        bytes.extend(kind.to_le_bytes());
        bytes.extend(length.to_le_bytes());
        bytes.extend(body);
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        bytes.extend(length.to_le_bytes());
    };
    let mut header = 0x1a2b_3c4d_u32.to_le_bytes().to_vec();
    header.extend([1, 0, 0, 0]);
    header.extend([0xff; 8]);
    block(0x0a0d_0d0a, &header);
    // Ethernet, nanoseconds (option 9, value 9), end of options.
    block(1, &[1, 0, 0, 0, 0xff, 0xff, 0, 0, 9, 0, 1, 0, 9, 0, 0, 0, 0, 0, 0, 0]);
    for (index, frame) in frames.iter().enumerate() {
        let ticks = (100 + index as u64) * 1_000_000_000 + 2_000_000;
        let length = frame.len() as u32;
        let mut body = Vec::new();
        [0, (ticks >> 32) as u32, ticks as u32, length, length]
            .iter()
            .for_each(|word: &u32| body.extend(word.to_le_bytes()));
        body.extend(frame);
        block(6, &body);
    }
    bytes
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).expect("memory takes everything");
    encoder.finish().expect("memory takes everything")
}

/// Everything that a capture delivers, and how it ends.
fn read(bytes: Vec<u8>) -> (Vec<Datagram>, Option<CaptureError>) {
    let mut datagrams = Vec::new();
    match Capture::read("test", Cursor::new(bytes)) {
        Err(error) => (datagrams, Some(error)),
        Ok(capture) => {
            for datagram in capture {
                match datagram {
                    Ok(datagram) => datagrams.push(datagram),
                    Err(error) => return (datagrams, Some(error)),
                }
            }
            (datagrams, None)
        }
    }
}

fn three_frames() -> Vec<Vec<u8>> {
    vec![frame(b"first", 0, 0), frame(b"second one", 1, 0), frame(&[7; 1_206], 2, 0x4000)]
}

fn is_three(datagrams: &[Datagram]) {
    let payloads: Vec<_> = datagrams.iter().map(|datagram| datagram.payload.as_slice()).collect();
    assert_eq!(payloads, [&b"first"[..], b"second one", &[7; 1_206]]);
    for (index, datagram) in datagrams.iter().enumerate() {
        assert_eq!(datagram.captured_us, (100 + index as u64) * 1_000_000 + 2_000);
        assert_eq!(datagram.destination_port, 2_368);
        assert_eq!(datagram.source.to_string(), "192.168.1.201:2368");
    }
}

#[test]
fn byte_orders_resolutions_kinds_and_packings() {
    let frames = three_frames();
    let micros = pcap(&frames, 0xa1b2_c3d4, u32::to_le_bytes, 1);
    let swapped = pcap(&frames, 0xa1b2_c3d4, u32::to_be_bytes, 1);
    for bytes in [micros, swapped, pcapng(&frames)] {
        for bytes in [gzip(&bytes), bytes] {
            let (datagrams, ended) = read(bytes);
            assert!(ended.is_none(), "{ended:?}");
            is_three(&datagrams);
        }
    }
    // 2,000 ns are 2 us.
    let (datagrams, _) = read(pcap(&frames, 0xa1b2_3c4d, u32::to_le_bytes, 1));
    assert_eq!(datagrams[0].captured_us, 100_000_002);
}

#[test]
fn other_links_carry_the_same_datagrams() {
    let raw = vec![ip_packet(b"raw", 0)];
    let (datagrams, ended) = read(pcap(&raw, 0xa1b2_c3d4, u32::to_le_bytes, 101));
    assert!(ended.is_none() && datagrams[0].payload == b"raw", "{ended:?}");
    let mut cooked = vec![0; 14];
    cooked.extend([0x08, 0x00]);
    cooked.extend(ip_packet(b"cooked", 0));
    let (datagrams, ended) = read(pcap(&[cooked], 0xa1b2_c3d4, u32::to_le_bytes, 113));
    assert!(ended.is_none() && datagrams[0].payload == b"cooked", "{ended:?}");
    let (datagrams, ended) = read(pcap(&three_frames(), 0xa1b2_c3d4, u32::to_le_bytes, 105));
    assert!(datagrams.is_empty());
    assert!(matches!(ended, Some(CaptureError::LinkType { linktype: 105, .. })), "{ended:?}");
}

#[test]
fn fragments_and_other_protocols_are_counted() {
    let mut arp = vec![0xff; 12];
    arp.extend([0x08, 0x06, 0, 1]);
    let frames =
        [frame(b"whole", 0, 0), frame(b"first part", 0, 0x2000), frame(b"last part", 0, 0x00b9), arp, vec![]];
    let bytes = pcap(&frames, 0xa1b2_c3d4, u32::to_le_bytes, 1);
    let mut capture = Capture::read("test", Cursor::new(bytes)).expect("a capture");
    assert_eq!(capture.by_ref().filter_map(Result::ok).count(), 1);
    let notes = capture.notes();
    assert_eq!((notes.packets, notes.fragments, notes.other), (5, 2, 2));
}

#[test]
fn cut_capture_delivers_whole_packets_and_reports() {
    let frames = three_frames();
    let bytes = pcap(&frames, 0xa1b2_c3d4, u32::to_le_bytes, 1);
    let mut whole = vec![24];
    for frame in &frames {
        whole.push(whole.last().expect("never empty") + 16 + frame.len());
    }
    for cut in 0..bytes.len() {
        let (datagrams, ended) = read(bytes[..cut].to_vec());
        match ended {
            None => assert!(whole.contains(&cut), "nobody noticed the cut at {cut}"),
            Some(CaptureError::Empty { .. }) => assert_eq!(cut, 0),
            Some(CaptureError::NotACapture { .. }) => assert!(cut < 24, "{cut}"),
            Some(CaptureError::Truncated { packets, .. }) => assert_eq!(packets as usize, datagrams.len()),
            Some(other) => panic!("cut at {cut}: {other}"),
        }
        let complete = whole.iter().filter(|end| **end <= cut).count().saturating_sub(1);
        assert_eq!(datagrams.len(), complete, "cut at {cut}");
    }
}

#[test]
fn cut_packed_capture_is_reported() {
    let packed = gzip(&pcap(&three_frames(), 0xa1b2_c3d4, u32::to_le_bytes, 1));
    for cut in 1..packed.len() {
        let (_, ended) = read(packed[..cut].to_vec());
        assert!(
            matches!(
                ended,
                Some(
                    CaptureError::Truncated { .. }
                        | CaptureError::NotACapture { .. }
                        | CaptureError::Damaged { .. }
                )
            ),
            "cut at {cut}: {ended:?}"
        );
    }
}

proptest::proptest! {
    #![proptest_config(proptest::test_runner::Config::with_cases(300))]

    #[test]
    fn damage_gives_a_value_or_an_error(
        damage in proptest::collection::vec((0_usize..1_500, 0_u8..), 1..6),
        is_ng: bool,
    ) {
        let frames = three_frames();
        let mut bytes =
            if is_ng { pcapng(&frames) } else { pcap(&frames, 0xa1b2_c3d4, u32::to_le_bytes, 1) };
        for (at, value) in damage {
            let at = at % bytes.len();
            bytes[at] = value;
        }
        let (datagrams, _) = read(bytes);
        proptest::prop_assert!(datagrams.len() <= 40);
    }

    #[test]
    fn any_bytes_give_value_or_error(bytes in proptest::collection::vec(0_u8.., 0..400)) {
        let _ = read(bytes.clone());
        let _ = read(gzip(&bytes));
    }
}
