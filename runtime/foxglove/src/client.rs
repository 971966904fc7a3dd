//! One connection: frames out of its queue, requests in.

use std::sync::atomic::Ordering;
use std::time::Duration;

use futures_util::{SinkExt as _, StreamExt as _};
use tokio::net::TcpStream;
use tokio::time::timeout;
use tokio_tungstenite::tungstenite::handshake::server::{ErrorResponse, Request as Asked, Response};
use tokio_tungstenite::tungstenite::http::{HeaderValue, StatusCode, header};
use tokio_tungstenite::tungstenite::protocol::WebSocketConfig;
use tokio_tungstenite::tungstenite::{Message, Utf8Bytes};
use tokio_tungstenite::{WebSocketStream, accept_hdr_async_with_config};

use super::protocol::{self, Request, SUBPROTOCOLS};
use super::viewers::{Frame, Seat, Viewers};

/// A viewer has so long to say what it wants to speak.
const HANDSHAKE_MAX: Duration = Duration::from_secs(5);
/// A viewer that takes nothing for so long has gone or does not mean well: its place is given to others.
const STALL_MAX: Duration = Duration::from_secs(20);
/// Requests are short.
const REQUEST_BYTES_MAX: usize = 65_536;
/// A viewer hears of what it has lost this often at most.
const REPORT_EVERY: Duration = Duration::from_secs(1);

/// Serves a viewer until it goes.
pub async fn serve(stream: TcpStream, viewers: Viewers, (name, session): (String, String)) {
    let limits = WebSocketConfig::default()
        .max_message_size(Some(REQUEST_BYTES_MAX))
        .max_frame_size(Some(REQUEST_BYTES_MAX));
    let handshake = accept_hdr_async_with_config(stream, choose_subprotocol, Some(limits));
    let Ok(Ok(mut socket)) = timeout(HANDSHAKE_MAX, handshake).await else { return };
    let Some(seat) = viewers.seat((&name, &session)) else {
        let full = protocol::warning("viewers", "this robot has all the viewers that it takes");
        let _ = timeout(HANDSHAKE_MAX, socket.send(Message::text(full))).await;
        return;
    };
    let number = seat.number;
    exchange(&mut socket, (&viewers, seat)).await;
    viewers.leave(number);
}

/// The newest name of the protocol that the viewer knows; without one it is refused.
#[expect(clippy::result_large_err, reason = "the library's type of callback")]
fn choose_subprotocol(asked: &Asked, mut response: Response) -> Result<Response, ErrorResponse> {
    let offered = asked.headers().get_all(header::SEC_WEBSOCKET_PROTOCOL);
    let offered: Vec<&str> = offered.iter().filter_map(|value| value.to_str().ok()).collect();
    let offers = |name: &str| offered.iter().flat_map(|list| list.split(',')).any(|one| one.trim() == name);
    match SUBPROTOCOLS.into_iter().find(|name| offers(name)) {
        Some(name) => {
            response.headers_mut().insert(header::SEC_WEBSOCKET_PROTOCOL, HeaderValue::from_static(name));
            Ok(response)
        }
        None => {
            let mut refusal = ErrorResponse::new(Some(format!("speak one of {}", SUBPROTOCOLS.join(", "))));
            *refusal.status_mut() = StatusCode::BAD_REQUEST;
            Err(refusal)
        }
    }
}

async fn exchange(socket: &mut WebSocketStream<TcpStream>, (viewers, mut seat): (&Viewers, Seat)) {
    let mut report = tokio::time::interval(REPORT_EVERY);
    let mut reported = 0;
    loop {
        let frame = tokio::select! {
            frame = seat.frames.recv() => match frame {
                Some(Frame::Text(text)) => Message::text(text),
                Some(Frame::Binary(bytes)) => Message::binary(bytes),
                None => return,
            },
            asked = socket.next() => match asked {
                Some(Ok(Message::Text(text))) => {
                    hear(viewers, seat.number, &text);
                    continue;
                }
                Some(Ok(Message::Close(_)) | Err(_)) | None => return,
                Some(Ok(_)) => continue,
            },
            _ = report.tick() => {
                let dropped = seat.dropped.load(Ordering::Relaxed);
                if dropped == reported {
                    continue;
                }
                reported = dropped;
                Message::text(protocol::warning("lost", &format!("this connection has lost {dropped} messages: it is too slow")))
            }
        };
        if !matches!(timeout(STALL_MAX, socket.send(frame)).await, Ok(Ok(()))) {
            return;
        }
    }
}

fn hear(viewers: &Viewers, number: u64, text: &Utf8Bytes) {
    // What is no request of the protocol is passed over: newer viewers ask for more than this server offers.
    if let Ok(request) = serde_json::from_str::<Request>(text) {
        viewers.request(number, request);
    }
}
