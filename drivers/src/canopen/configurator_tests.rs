//! A node from power-up to operation, and what may go wrong on the way.

use super::*;
use std::vec::Vec;

fn at(ms: u64) -> Stamp {
    Stamp::from_micros(ms * 1_000)
}

fn poll(node: &mut NodeConfigurator, ms: u64) -> (Vec<CanFrame>, bool) {
    let mut sent = Vec::new();
    let lost = node.poll(at(ms), &mut |frame| sent.push(*frame));
    (sent, lost)
}

fn script() -> Script {
    Script::new().write(0x1017, 0, 100, 2).read(0x6002, 0)
}

#[test]
fn boots_configures_starts_and_restarts_after_loss() {
    let mut node = NodeConfigurator::new(5, script());
    assert_eq!(poll(&mut node, 0).0.len(), 1);
    assert_eq!(poll(&mut node, 10).0.len(), 0, "one request in flight");
    node.on_heartbeat(0, at(20));
    assert_eq!(poll(&mut node, 20).0.len(), 2, "pre-operational and the first write");
    node.on_answer(&[0x60, 0x34, 0x12, 0, 0, 0, 0, 0], at(21));
    assert_eq!(node.phase(), NodePhase::Configuring(0), "an answer to something else");
    node.on_answer(&[0x60, 0x17, 0x10, 0, 0, 0, 0, 0], at(22));
    assert_eq!(poll(&mut node, 30).0.len(), 1);
    node.on_answer(&[0x43, 0x02, 0x60, 0, 0, 0, 0, 1], at(31));
    assert_eq!(node.read(0), Some(1 << 24));
    assert_eq!(poll(&mut node, 40).0, [network_frame(NetworkCommand::Start, 5)]);
    node.on_heartbeat(5, at(100));
    assert!(node.is_operational());
    assert!(!poll(&mut node, 450).1);
    assert!(poll(&mut node, 451).1, "three heartbeats are missing");
    node.on_heartbeat(5, at(2_000));
    assert_eq!(node.phase(), NodePhase::Configuring(0), "it may have lost its mapping");
}

#[test]
fn a_refusal_is_kept_and_tried_again_later() {
    let mut node = NodeConfigurator::new(5, script());
    node.on_heartbeat(0x7F, at(0));
    poll(&mut node, 0);
    node.on_answer(&[0x80, 0x17, 0x10, 0, 0, 0, 2, 6], at(1));
    assert_eq!(node.phase(), NodePhase::Refused);
    assert_eq!(node.failure().unwrap().error, SdoError(0x0602_0000));
    poll(&mut node, 1_000);
    assert_eq!(node.phase(), NodePhase::Refused);
    poll(&mut node, 2_100);
    assert_eq!(node.phase(), NodePhase::Absent);
}

/// It may have lost its configuration: all of it is sent again, and dependants are notified.
#[test]
fn a_restart_starts_over_from_any_phase() {
    for phase in [
        NodePhase::Absent,
        NodePhase::Configuring(1),
        NodePhase::Starting,
        NodePhase::Operational,
        NodePhase::Refused,
    ] {
        let mut node = NodeConfigurator::new(5, script());
        node.phase = phase;
        node.monitor.hear(NodeState::Operational, at(0));
        node.on_heartbeat(0, at(10));
        assert_eq!(node.phase(), NodePhase::Configuring(0), "{phase:?}");
        let (sent, lost) = poll(&mut node, 20);
        assert_eq!(sent.len(), 2, "pre-operational and the first write, {phase:?}");
        assert_eq!(lost, phase == NodePhase::Operational);
        assert!(!poll(&mut node, 30).1, "reported once");
    }
}

#[test]
fn node_taken_out_of_operation_is_lost() {
    for state in [0x04, 0x7F] {
        let mut node = NodeConfigurator::new(5, script());
        node.phase = NodePhase::Operational;
        node.on_heartbeat(state, at(10));
        assert_eq!((node.phase(), poll(&mut node, 20).1), (NodePhase::Configuring(0), true));
    }
}

/// A read is answered by a value, a write by an acknowledgement; text is of no use.
#[test]
fn answer_of_wrong_kind_is_ignored() {
    let mut node = NodeConfigurator::new(5, Script::new().read(0x6002, 0));
    node.on_heartbeat(0, at(0));
    poll(&mut node, 0);
    node.on_answer(&[0x60, 0x02, 0x60, 0, 0, 0, 0, 0], at(1));
    assert_eq!((node.phase(), node.read(0)), (NodePhase::Configuring(0), None));
    node.on_answer(&[0x41, 0x02, 0x60, 0, 9, 0, 0, 0], at(2));
    assert_eq!(node.failure().unwrap().error, SdoError::TOO_LONG);
    let mut node = NodeConfigurator::new(5, script());
    node.on_heartbeat(0, at(0));
    poll(&mut node, 0);
    node.on_answer(&[0x43, 0x17, 0x10, 0, 1, 0, 0, 0], at(1));
    assert_eq!(node.phase(), NodePhase::Configuring(0));
}

#[test]
fn silence_during_configuration_is_a_time_out() {
    let mut node = NodeConfigurator::new(5, script());
    node.on_heartbeat(0, at(0));
    for ms in (0..3_000).step_by(100) {
        poll(&mut node, ms);
    }
    assert_eq!(node.failure().unwrap().error, SdoError::TIME_OUT);
}

/// The first request, its repetition, and nothing in between; the same for the command to start.
#[test]
fn request_is_repeated_only_after_its_timeout() {
    let mut node = NodeConfigurator::new(5, Script::new().write(0x1017, 0, 100, 2));
    node.on_heartbeat(0, at(0));
    assert_eq!(poll(&mut node, 0).0.len(), 2);
    assert_eq!(poll(&mut node, 499).0.len(), 0);
    assert_eq!(poll(&mut node, 500).0.len(), 1, "the write alone");
    node.on_answer(&[0x60, 0x17, 0x10, 0, 0, 0, 0, 0], at(501));
    assert_eq!(poll(&mut node, 502).0.len(), 1, "start");
    assert_eq!((poll(&mut node, 1_001).0.len(), node.is_operational()), (0, false));
    assert_eq!(poll(&mut node, 1_002).0.len(), 1);
    assert_eq!((poll(&mut node, 1_502).0.len(), node.phase()), (1, NodePhase::Starting), "the third");
    assert_eq!((poll(&mut node, 2_002).0.len(), node.phase()), (1, NodePhase::Absent), "in vain");
}

/// Who comes to a bus that is running finds devices in operation that it has not started.
#[test]
fn operation_that_is_not_ours_is_found() {
    for (phase, found) in [
        (NodePhase::Absent, true),
        (NodePhase::Configuring(1), true),
        (NodePhase::Refused, true),
        (NodePhase::Starting, false),
        (NodePhase::Operational, false),
    ] {
        let mut node = NodeConfigurator::new(5, script());
        (node.phase, node.met) = (phase, true);
        assert!(!node.clone().on_heartbeat(0x7F, at(0)) && !node.clone().on_heartbeat(0, at(0)), "{phase:?}");
        assert_eq!(node.on_heartbeat(5, at(0)), found, "{phase:?}");
    }
}

/// Only what a device need not have may be missing, and only missing is excused.
#[test]
fn optional_missing_object_is_skipped() {
    let absent = [0x80, 0x29, 0x10, 1, 0, 0, 2, 6];
    let no_part = [0x80, 0x29, 0x10, 1, 0x11, 0, 9, 6];
    let refused = [0x80, 0x29, 0x10, 1, 0x30, 0, 9, 6];
    let after = |script: Script, answer: [u8; 8]| {
        let mut node = NodeConfigurator::new(5, script);
        node.on_heartbeat(0, at(0));
        poll(&mut node, 0);
        node.on_answer(&answer, at(1));
        node.phase()
    };
    let optional = || Script::new().write_if_present(0x1029, 1, 1, 1).write(0x1017, 0, 100, 2);
    assert_eq!(after(optional(), absent), NodePhase::Configuring(1));
    assert_eq!(after(optional(), no_part), NodePhase::Configuring(1));
    assert_eq!(after(optional(), refused), NodePhase::Refused);
    assert_eq!(after(Script::new().write(0x1029, 1, 1, 1), absent), NodePhase::Refused);
    let behind = Script::new().read(0x6002, 0).followed_by(&optional());
    assert_eq!([0, 1, 2, 3].map(|step| behind.is_optional(step)), [false, true, false, false]);
}

#[test]
fn abandoned_node_is_not_alive() {
    let mut node = NodeConfigurator::new(5, script());
    node.phase = NodePhase::Operational;
    node.monitor.hear(NodeState::Operational, at(0));
    assert!(poll(&mut node, 400).1);
    assert_eq!(node.monitor.state(at(401), 10_000_000), None);
}
