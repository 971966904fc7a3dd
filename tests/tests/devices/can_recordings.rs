//! Two public logs of CiA 402 drives that start, against their keys: every frame understood, and written again bit for
//! bit by our own master where it is a master's frame.

use std::collections::BTreeMap;

use floorguard_drivers::can::{CanFrame, SlcanEvent, SlcanReceiver, encode_slcan};
use floorguard_drivers::canopen::{
    Emergency, NetworkCommand, NodeConfigurator, NodePhase, NodeState, Script, SdoAnswer, SdoRequest,
    decode_sdo, network_frame,
};
use floorguard_drivers::cia402::PowerState;
use floorguard_drivers::three_wheel_base::{BaseConfiguration, BaseEvent, ThreeWheelBase};
use floorguard_tests::data::recording;
use floorguard_types::time::Stamp;

const NAVICAN: &str = "can_canopen/navican_two_wheel_cia402_start.candump.txt";
const ROS_CANOPEN: &str = "can_canopen/ros_canopen_issue259_start.candump.txt";

/// A line of a log: seconds where it has them, then the frame.
fn read_log(path: &str) -> Option<Vec<(f64, CanFrame)>> {
    let text = std::fs::read_to_string(recording(path)?).unwrap();
    let line = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        let seconds =
            words[0].strip_prefix('(').map_or(0.0, |time| time.trim_end_matches(')').parse().unwrap());
        let length_at = words.iter().position(|word| word.starts_with('[')).unwrap();
        let hex = |word: &&str| u16::from_str_radix(word, 16).unwrap();
        let data: Vec<u8> = words[length_at + 1..].iter().map(|word| hex(word) as u8).collect();
        assert_eq!(words[length_at], format!("[{}]", data.len()));
        (seconds, CanFrame::standard(hex(&words[length_at - 1]), &data))
    };
    Some(text.lines().map(line).collect())
}

/// A master's SDO frame as our own type: size from the command byte, by the table of the book, CANopen: SDO.
fn request(data: &[u8]) -> SdoRequest {
    let &[command, low, high, subindex, a, b, c, d] = data else { panic!("{data:?}") };
    let bytes = match command {
        0x40 => None,
        0x2F => Some(1),
        0x2B => Some(2),
        0x23 => Some(4),
        _ => panic!("{command:02X}"),
    };
    let value = u32::from_le_bytes([a, b, c, d]);
    SdoRequest { index: u16::from_le_bytes([low, high]), subindex, write: bytes.map(|bytes| (value, bytes)) }
}

/// What a node's objects hold after all writes.
fn dictionary<'a>(requests: impl Iterator<Item = &'a SdoRequest>) -> BTreeMap<(u16, u8), u32> {
    let written =
        |request: &SdoRequest| request.write.map(|(value, _)| ((request.index, request.subindex), value));
    requests.filter_map(written).collect()
}

#[test]
fn two_wheel_base_requests_are_reproduced_exactly() {
    let Some(frames) = read_log(NAVICAN) else { return };
    assert_eq!(frames.len(), 110);
    let mut requests = 0;
    for (_, frame) in &frames {
        let id = frame.standard_id().unwrap();
        if id & 0x780 == 0x600 {
            assert_eq!(request(frame.payload()).frame((id & 0x7F) as u8), *frame);
            requests += 1;
        }
    }
    assert_eq!(requests, 86);
    let network: Vec<CanFrame> =
        frames.iter().map(|(_, frame)| *frame).filter(|frame| frame.standard_id() == Some(0)).collect();
    let commands =
        [(NetworkCommand::ResetCommunication, 0), (NetworkCommand::Start, 1), (NetworkCommand::Start, 2)];
    assert_eq!(network, commands.map(|(command, node)| network_frame(command, node)));
}

#[test]
fn two_wheel_base_answers_identify_it() {
    let Some(frames) = read_log(NAVICAN) else { return };
    for node in [1, 2] {
        let answers: Vec<(u16, u8, SdoAnswer)> = frames
            .iter()
            .filter(|(_, frame)| frame.standard_id() == Some(0x580 + node))
            .map(|(_, frame)| decode_sdo(frame.payload()).unwrap())
            .collect();
        let expected = [
            (0x1000, 0, SdoAnswer::Value(0x0002_0192)),
            (0x1018, 1, SdoAnswer::Value(0x300)),
            (0x1018, 2, SdoAnswer::Value(0x4644)),
            (0x1016, 1, SdoAnswer::Written),
        ];
        assert_eq!(answers, expected);
    }
    let boots: Vec<u16> = frames
        .iter()
        .filter_map(|(_, frame)| frame.standard_id().filter(|id| id & 0x780 == 0x700).map(|id| (id, frame)))
        .inspect(|(_, frame)| assert_eq!(NodeState::from_byte(frame.payload()[0]), Some(NodeState::BootUp)))
        .map(|(id, _)| id & 0x7F)
        .collect();
    assert_eq!(boots, [100, 2, 1]);
}

/// The mapping that its master writes leaves the drive's objects as ours would.
#[test]
fn our_scripts_leave_the_same_mapping() {
    let Some(frames) = read_log(NAVICAN) else { return };
    for node in [1_u8, 2] {
        let recorded: Vec<SdoRequest> = frames
            .iter()
            .filter(|(_, frame)| frame.standard_id() == Some(0x600 + u16::from(node)))
            .map(|(_, frame)| request(frame.payload()))
            .collect();
        let script = Script::new()
            .receive(node, 0, (1, &[0x6040_0010, 0x6060_0008]))
            .receive(node, 1, (1, &[0x60FF_0020, 0x607A_0020]))
            .transmit(node, 0, (1, &[0x6041_0010, 0x6061_0008]));
        let rest = Script::new()
            .transmit(node, 1, (1, &[0x606C_0020, 0x6064_0020]))
            .transmit(node, 2, (1, &[0x6079_0020, 0x6078_0010, 0x603F_0010]))
            .write(0x1016, 1, (100 << 16) | 600, 4)
            .write(0x6007, 0, 1, 2)
            .write(0x605A, 0, 6, 2)
            .write(0x605C, 0, 1, 2);
        let ours = (0..script.len()).filter_map(|step| script.step(step));
        let ours = ours.chain((0..rest.len()).filter_map(|step| rest.step(step)));
        assert_eq!(dictionary(ours), dictionary(recorded.iter()));
    }
}

#[test]
fn first_process_data_of_two_wheel_base() {
    let Some(frames) = read_log(NAVICAN) else { return };
    let payload = |id: u16| {
        let found = frames.iter().find(|(_, frame)| frame.standard_id() == Some(id)).unwrap();
        found.1.payload().to_vec()
    };
    for (node, position, current) in [(1, -2, 1), (2, 1, 0)] {
        let status = payload(0x180 + node);
        let word = u16::from_le_bytes([status[0], status[1]]);
        assert_eq!((word, status[2]), (0x4238, 0), "fault and remote, no mode");
        assert_eq!(PowerState::from_statusword(word), Some(PowerState::Fault));
        let motion = payload(0x280 + node);
        assert_eq!(i32::from_le_bytes(motion[..4].try_into().unwrap()), 0);
        assert_eq!(i32::from_le_bytes(motion[4..].try_into().unwrap()), position);
        let power = payload(0x380 + node);
        assert_eq!(i16::from_le_bytes([power[4], power[5]]), current);
        assert_eq!(u16::from_le_bytes([power[6], power[7]]), 0x8100, "603Fh: communication");
    }
}

/// Our configurator in the place of the recorded master: it sends the same requests and reads the same values.
#[test]
fn configurator_repeats_the_single_drive_dialogue() {
    let Some(frames) = read_log(ROS_CANOPEN) else { return };
    assert_eq!(frames.len(), 14);
    let at = |seconds: f64| Stamp::from_micros((seconds * 1.0e6).round() as u64);
    let script = Script::new()
        .write(0x1017, 0, 1_000, 2)
        .read(0x6041, 0)
        .read(0x6061, 0)
        .read(0x6064, 0)
        .read(0x6040, 0);
    let mut node = NodeConfigurator::new(3, script);
    let mut emergencies = Vec::new();
    for (seconds, frame) in &frames {
        match frame.standard_id().unwrap() {
            0x000 => assert_eq!(*frame, network_frame(NetworkCommand::ResetCommunication, 3)),
            0x603 => {
                let mut sent = Vec::new();
                node.poll(at(*seconds), &mut |frame| sent.push(*frame));
                assert_eq!(sent.last(), Some(frame), "{seconds}");
            }
            0x583 => _ = node.on_answer(frame.payload(), at(*seconds)),
            0x703 => _ = node.on_heartbeat(frame.payload()[0], at(*seconds)),
            0x083 => emergencies.push(Emergency::decode(frame.payload()).unwrap()),
            id => panic!("{id:03X}"),
        }
    }
    assert_eq!(node.phase(), NodePhase::Starting);
    // The bytes behind the value are rubbish (8F AF) and must not be read.
    let reads: Vec<u32> = (0..4).filter_map(|number| node.read(number)).collect();
    assert_eq!(reads, [0x0218, 1, 4_607, 0]);
    assert_eq!(PowerState::from_statusword(0x0218), Some(PowerState::Fault));
    let emergency = |code| Emergency { code, register: 1, manufacturer: [0; 5] };
    assert_eq!(emergencies, [emergency(0x81B0), emergency(0x81A0)]);
}

/// A bus of somebody else: nothing of it may pass for our sensors, and each frame survives its text.
#[test]
fn a_foreign_bus_is_survived_and_carried() {
    for path in [NAVICAN, ROS_CANOPEN] {
        let Some(frames) = read_log(path) else { return };
        let mut base = ThreeWheelBase::new(BaseConfiguration::default());
        let mut events = Vec::new();
        let mut receiver = SlcanReceiver::new();
        let mut carried = Vec::new();
        for (number, (_, frame)) in frames.iter().enumerate() {
            receiver.push(&encode_slcan(frame), |event| {
                if let SlcanEvent::Frame(frame) = event {
                    carried.push(frame);
                }
            });
            let now = Stamp::from_micros(1_000 * number as u64);
            base.on_frame(frame, now, &mut |event| events.push(event));
        }
        assert_eq!(carried, frames.iter().map(|(_, frame)| *frame).collect::<Vec<_>>());
        assert_eq!(receiver.counters().refused, 0);
        let measured = |event: &&BaseEvent| !matches!(event, BaseEvent::Emergency(..));
        assert_eq!(events.iter().find(measured), None);
    }
}
