//! The web side, on its own thread: a page, the newest picture, and orders.

use std::time::Duration;

use axum::Router;
use axum::body::Bytes;
use axum::extract::rejection::QueryRejection;
use axum::extract::{DefaultBodyLimit, Query, State};
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use serde::Deserialize;

use super::connections::Bounded;
use super::hub::{Hub, Order};

/// The page: everything in one file, so that it works without a network.
const PAGE: &str = include_str!("page.html");
/// An order is a few words.
const ORDER_BYTES_MAX: usize = 256;
/// A browser that waits for a picture gets the old one after this long.
const WAIT: Duration = Duration::from_secs(1);

/// Serves until the program ends.
pub fn serve(listener: std::net::TcpListener, hub: Hub) {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build();
    let served = runtime.and_then(|runtime| {
        runtime.block_on(async {
            let listener = tokio::net::TcpListener::from_std(listener)?;
            axum::serve(Bounded::new(listener), router(hub)).await
        })
    });
    if let Err(error) = served {
        say!("the panel has closed: {error}; the robot goes on without it");
    }
}

fn router(hub: Hub) -> Router {
    Router::new()
        .route("/", get(page))
        .route("/state", get(state))
        .route("/layers", get(layers))
        .route("/order", post(order))
        .layer(DefaultBodyLimit::max(ORDER_BYTES_MAX))
        .with_state(hub)
}

fn refusal(code: StatusCode, why: &'static str) -> Response {
    (code, [(header::CONTENT_TYPE, "text/plain; charset=utf-8")], why).into_response()
}

fn text<'a>(headers: &'a HeaderMap, name: &header::HeaderName) -> &'a str {
    headers.get(name).and_then(|value| value.to_str().ok()).unwrap_or_default()
}

fn has_token(hub: &Hub, headers: &HeaderMap) -> bool {
    let shown = text(headers, &header::AUTHORIZATION).strip_prefix("Bearer ").unwrap_or_default();
    hub.access.is_token(shown)
}

/// Refuses what was meant for another name, or comes from a page of somebody else.
fn stranger(hub: &Hub, headers: &HeaderMap) -> Option<Response> {
    let host = text(headers, &header::HOST);
    if !hub.access.is_host(host) {
        return Some(refusal(StatusCode::MISDIRECTED_REQUEST, "this panel has another name"));
    }
    let foreign =
        headers.contains_key(header::ORIGIN) && !is_own_origin(text(headers, &header::ORIGIN), host);
    foreign.then(|| refusal(StatusCode::FORBIDDEN, "another page may not speak to this panel"))
}

/// Whether the page that asks came from here. A browser names it in every order and cannot be made to lie.
fn is_own_origin(origin: &str, host: &str) -> bool {
    let name = origin.strip_prefix("http://").or_else(|| origin.strip_prefix("https://"));
    name.is_some_and(|name| name.eq_ignore_ascii_case(host))
}

async fn page(State(hub): State<Hub>, headers: HeaderMap) -> Response {
    if let Some(refused) = stranger(&hub, &headers) {
        return refused;
    }
    // The page itself says nothing about the robot; what it loads needs the token where there must be one.
    let mut response = (StatusCode::OK, PAGE).into_response();
    let policy = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; connect-src 'self'; \
                  img-src data:; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";
    let fixed = [
        (header::CONTENT_TYPE, "text/html; charset=utf-8"),
        (header::CONTENT_SECURITY_POLICY, policy),
        (header::X_FRAME_OPTIONS, "DENY"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::CACHE_CONTROL, "no-store"),
    ];
    for (name, value) in fixed {
        response.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    response
}

#[derive(Deserialize)]
struct After {
    /// Number of the picture that the browser has.
    after: Option<u64>,
}

/// The newest picture, as soon as there is another than the browser has. Pictures in between are lost to it.
async fn state(
    State(hub): State<Hub>,
    headers: HeaderMap,
    query: Result<Query<After>, QueryRejection>,
) -> Response {
    let newest = hub.newest.clone();
    snapshot(&hub, &headers, (query, newest)).await
}

/// The floor of the mission, in the same way.
async fn layers(
    State(hub): State<Hub>,
    headers: HeaderMap,
    query: Result<Query<After>, QueryRejection>,
) -> Response {
    let newest = hub.layers.clone();
    snapshot(&hub, &headers, (query, newest)).await
}

type Newest = tokio::sync::watch::Receiver<(u64, std::sync::Arc<str>)>;

async fn snapshot(
    hub: &Hub,
    headers: &HeaderMap,
    (query, mut newest): (Result<Query<After>, QueryRejection>, Newest),
) -> Response {
    if let Some(refused) = stranger(hub, headers) {
        return refused;
    }
    if !(hub.access.is_open_to_lookers() || has_token(hub, headers)) {
        return refusal(StatusCode::UNAUTHORIZED, "show the token");
    }
    let Ok(Query(After { after })) = query else {
        return refusal(StatusCode::BAD_REQUEST, "after= is the number of a picture");
    };
    let held = newest.clone();
    let fresh = newest.wait_for(|(number, _)| after.is_none_or(|after| *number != after));
    let text = match tokio::time::timeout(WAIT, fresh).await {
        Ok(Ok(newest)) => newest.1.clone(),
        Ok(Err(_)) => return refusal(StatusCode::GONE, "the robot's program has ended"),
        Err(_) => held.borrow().1.clone(),
    };
    let json = [(header::CONTENT_TYPE, "application/json"), (header::CACHE_CONTROL, "no-store")];
    (StatusCode::OK, json, text.to_string()).into_response()
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct OrderBody {
    order: Order,
}

async fn order(State(hub): State<Hub>, headers: HeaderMap, body: Bytes) -> Response {
    if let Some(refused) = stranger(&hub, &headers) {
        return refused;
    }
    if !has_token(&hub, &headers) {
        return refusal(StatusCode::UNAUTHORIZED, "open the panel with the address that the console shows");
    }
    // A form of somebody else's page cannot send this type without asking first.
    if text(&headers, &header::CONTENT_TYPE) != "application/json" {
        return refusal(StatusCode::UNSUPPORTED_MEDIA_TYPE, "send application/json");
    }
    let Ok(OrderBody { order }) = serde_json::from_slice(&body) else {
        return refusal(StatusCode::BAD_REQUEST, "orders are pause, resume, reset and start");
    };
    let awaited = *hub.awaited.borrow();
    match order {
        Order::Reset if awaited != Some(order) => {
            return refusal(StatusCode::CONFLICT, "no stop waits for a reset");
        }
        Order::Start if awaited != Some(order) => {
            return refusal(StatusCode::CONFLICT, "the robot does not wait for a start command");
        }
        _ => {}
    }
    if hub.order(order) {
        refusal(StatusCode::ACCEPTED, "the robot has it")
    } else {
        refusal(StatusCode::TOO_MANY_REQUESTS, "too many orders wait; try again")
    }
}
