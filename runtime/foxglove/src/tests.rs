use std::net::TcpStream;
use std::time::Duration;

use floorguard_recording::{LiveMessage, MessageListener as _, Recorder, topics};
use floorguard_types::geometry::Twist2;
use floorguard_types::time::Stamp;
use tokio_tungstenite::tungstenite::client::IntoClientRequest as _;
use tokio_tungstenite::tungstenite::http::HeaderValue;
use tokio_tungstenite::tungstenite::{Message, WebSocket, client};

use super::FoxgloveServer;

type Viewer = WebSocket<TcpStream>;

fn connect(server: &FoxgloveServer, subprotocols: &'static str) -> Option<Viewer> {
    let stream = TcpStream::connect(server.address()).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(5))).unwrap();
    let mut request = format!("ws://{}/", server.address()).into_client_request().unwrap();
    request.headers_mut().insert("sec-websocket-protocol", HeaderValue::from_static(subprotocols));
    client(request, stream).ok().map(|(viewer, _)| viewer)
}

fn text(viewer: &mut Viewer) -> serde_json::Value {
    serde_json::from_str(viewer.read().unwrap().to_text().unwrap()).unwrap()
}

/// The next message of a subscription; times are passed over.
fn message(viewer: &mut Viewer) -> (u32, u64, Vec<u8>) {
    for _ in 0..1_000 {
        if let Message::Binary(bytes) = viewer.read().unwrap()
            && let (Some(1), Some((id, rest))) = (bytes.first(), bytes[1..].split_first_chunk::<4>())
        {
            let (time, data) = rest.split_first_chunk::<8>().unwrap();
            return (u32::from_le_bytes(*id), u64::from_le_bytes(*time), data.to_vec());
        }
    }
    panic!("no message came");
}

fn recorder(server: &FoxgloveServer) -> Recorder<std::io::Cursor<Vec<u8>>> {
    let mut recorder = Recorder::without_file();
    recorder.listen(Box::new(server.clone()));
    recorder
}

fn server() -> FoxgloveServer {
    FoxgloveServer::open("127.0.0.1:0".parse().unwrap(), "robot").unwrap()
}

#[test]
fn subscribed_channel_arrives_as_recorded() {
    let server = server();
    let mut out = recorder(&server);
    let forward = Twist2 { linear_mps: 0.4, angular_radps: 0.0 };
    out.permitted(Stamp::from_micros(1_000_000), forward, 0.8).unwrap();
    let mut viewer = connect(&server, "foxglove.websocket.v1, foxglove.sdk.v1").unwrap();
    let info = text(&mut viewer);
    assert_eq!((&info["op"], &info["name"]), (&"serverInfo".into(), &"robot".into()));
    let channels = text(&mut viewer);
    let limit =
        channels["channels"].as_array().unwrap().iter().find(|one| one["topic"] == topics::SPEED_LIMIT);
    let limit = limit.unwrap();
    assert_eq!((&limit["schemaName"], &limit["encoding"]), (&"std_msgs/msg/Float32".into(), &"cdr".into()));
    let subscribe =
        serde_json::json!({"op": "subscribe", "subscriptions": [{"id": 7, "channelId": limit["id"]}]});
    viewer.send(Message::text(subscribe.to_string())).unwrap();
    // The request has been taken when the figures move.
    for step in 0..500_u64 {
        out.permitted(Stamp::from_micros(2_000_000 + step), forward, 0.8).unwrap();
        if server.figures().sent > 0 {
            break;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    let (id, time_ns, data) = message(&mut viewer);
    assert!(id == 7 && time_ns >= 2_000_000_000 && time_ns % 1_000 == 0, "{id} {time_ns}");
    assert_eq!(data, [&[0, 1, 0, 0][..], &0.8_f32.to_le_bytes()].concat());
}

#[test]
fn connection_without_subprotocol_is_refused() {
    let server = server();
    assert!(connect(&server, "chat").is_none());
    assert!(connect(&server, "foxglove.sdk.v1").is_some());
}

#[test]
fn stalled_viewer_loses_messages_and_delays_nothing() {
    let mut server = server();
    let mut viewer = connect(&server, "foxglove.sdk.v1").unwrap();
    viewer.send(Message::text(r#"{"op":"subscribe","subscriptions":[{"id":1,"channelId":1}]}"#)).unwrap();
    // It never reads. 64 kB a message: the buffers of the connection and the queue hold a part of 4,000 of them.
    let data = vec![0; 65_536];
    let mut publish = |step: u64| {
        let times = Stamp::from_micros(step).into();
        let message =
            LiveMessage { topic: topics::CLOUD, schema: &floorguard_recording::OCTETS, times, data: &data };
        server.message(&message);
        server.figures()
    };
    let began = (0..500).find(|step| {
        std::thread::sleep(Duration::from_millis(1));
        publish(*step).sent > 0
    });
    assert!(began.is_some(), "its subscription arrived");
    let figures = (0..4_000).map(publish).last().unwrap();
    assert!(figures.dropped > 1_000, "{figures:?}");
    assert!(figures.sent + figures.dropped >= 4_000, "all are accounted for: {figures:?}");
}
