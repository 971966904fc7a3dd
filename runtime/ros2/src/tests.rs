//! The bridge with a participant of the same library as the other side; other libraries play in `cargo xtask check-ros2`.

use std::net::UdpSocket;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use floorguard_drivers::velocity_link::VelocityRequest;
use floorguard_recording::cdr::{Decoder, Encoder};
use floorguard_recording::{Recorder, topics};
use floorguard_types::geometry::Pose2;
use floorguard_types::time::Stamp;

use super::bridge::take_part;
use super::dds::{Named, Participant, Quality};
use super::names;
use super::{BridgeOptions, RosBridge, RosRequest, VelocityFeed, VelocityRoute};

/// A recording that only listeners hear.
type NoFile = Recorder<std::io::Cursor<Vec<u8>>>;

/// A busy computer needs long to find what is on it.
const LONGEST: Duration = Duration::from_secs(60);

/// Domains of other tests and of other programs are not met.
fn domain() -> u16 {
    100 + (std::process::id() % 100) as u16
}

/// Tries again and again.
fn soon<T>(mut attempt: impl FnMut() -> Option<T>) -> T {
    let began = Instant::now();
    loop {
        if let Some(found) = attempt() {
            return found;
        }
        assert!(began.elapsed() < LONGEST, "nothing came");
        std::thread::sleep(Duration::from_millis(20));
    }
}

fn named(topic: &str, kind: &'static str) -> Named {
    Named { topic: topic.to_owned(), kind }
}

fn bridge(feed: VelocityFeed) -> Option<RosBridge> {
    let route = VelocityRoute { topic: "/cmd_vel".to_owned(), deadline_ms: 150 };
    let options = BridgeOptions { domain: domain(), address: None, velocities: Some((feed, route)) };
    match RosBridge::open(options) {
        Ok(bridge) => Some(bridge),
        Err(super::OpenError::NotKept(error)) => {
            eprintln!("skipped: this kernel does not tie sockets to a device ({error})");
            None
        }
        Err(other) => panic!("{other}"),
    }
}

/// It is as it was written, on the clock on the wall.
fn check_frame(frame: &[u8]) {
    let mut decoder = Decoder::new(frame).unwrap();
    assert_eq!(decoder.length(), Some(1));
    let seconds = decoder.i32().and_then(|seconds| u64::try_from(seconds).ok()).unwrap();
    let now_s = SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_secs();
    assert!(now_s.abs_diff(seconds) < 120, "{seconds} is not {now_s}");
    decoder.u32().unwrap();
    assert_eq!((decoder.text().as_deref(), decoder.text().as_deref()), (Some("odom"), Some("base_link")));
    assert_eq!(decoder.f64s::<2>(), Some([1.0, 2.0]));
}

#[test]
fn other_participant_reads_drives_and_asks() {
    let feed = VelocityFeed::open().unwrap();
    let (guard, _) = feed.addresses().unwrap();
    let guard = UdpSocket::bind(guard).unwrap();
    guard.set_read_timeout(Some(Duration::from_millis(20))).unwrap();
    let Some(mut bridge) = bridge(feed) else { return };
    let mut other = Participant::over(take_part(domain(), None).unwrap()).unwrap();
    let mut frames = other.reader(&named("rt/tf", "tf2_msgs/msg/TFMessage"), true).unwrap();
    let cmd_vel = named("rt/cmd_vel", "geometry_msgs/msg/Twist");
    let velocity = other.writer(&cmd_vel, Quality::Newest(1)).unwrap();
    let pause = named(&names::request_topic("/floorguard/pause"), "std_srvs/srv/Trigger_Request");
    let pause = other.writer(&pause, Quality::Newest(1)).unwrap();

    // A frame comes as it was written, on the clock on the wall.
    let mut recorder = NoFile::without_file();
    recorder.listen(bridge.listener());
    let mut robot_us = 5_000_000;
    let frame = soon(|| {
        robot_us += 20_000;
        let at = Stamp::from_micros(robot_us);
        recorder.frame(at, at, (("odom", "base_link"), Pose2::new(1.0, 2.0, 0.5))).unwrap();
        frames.take_next_sample().unwrap().map(|sample| sample.into_value())
    });
    check_frame(&frame);

    // A velocity reaches the guard's port as a request.
    let mut twist = Encoder::new();
    twist.f64s(&[0.4, 0.0, 0.0, 0.0, 0.0, -0.2]);
    let twist = twist.finish();
    let request = soon(|| {
        velocity.write(twist.clone(), None).unwrap();
        let mut bytes = [0; 64];
        let length = guard.recv(&mut bytes).ok()?;
        Some(VelocityRequest::decode(&bytes[..length]).unwrap())
    });
    assert_eq!(
        (request.twist.linear_mps, request.twist.angular_radps, request.deadline_ms),
        (0.4, -0.2, 150)
    );
    // The samples of this test bear no time of their own.
    assert!(request.sender != 0 && request.sent_ms == 0);

    // A service reaches the robot.
    let asked = soon(|| {
        pause.write(vec![0, 1, 0, 0, 0], None).unwrap();
        bridge.attend(0, || None).first().copied()
    });
    assert_eq!(asked, RosRequest::Pause);
    let figures = bridge.figures();
    assert!(figures.sent > 0 && figures.received >= 2 && figures.not_understood == 0, "{figures}");
}

#[test]
fn full_queue_drops_and_counts() {
    let (sink, waiting) = super::bridge::RecordedSink::over(4);
    let mut recorder = NoFile::without_file();
    let counters = sink.counters();
    recorder.listen(Box::new(sink));
    for step in 0..10 {
        let at = Stamp::from_micros(step);
        recorder.frame(at, at, (("odom", "base_link"), Pose2::default())).unwrap();
        recorder.digest(at, step).unwrap();
    }
    // Nobody takes anything out; what has no name in ROS 2 does not count.
    assert_eq!((waiting.try_iter().count(), counters.figures().dropped), (4, 6));
    assert!(super::published::index_of(topics::DIGEST).is_none());
}
