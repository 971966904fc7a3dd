//! The web side, on its own thread: a page, the newest picture, and orders.

use std::time::Duration;

use axum::Router;
use axum::extract::rejection::QueryRejection;
use axum::extract::{DefaultBodyLimit, Query, State};
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use serde::Deserialize;

use super::access::Role;
use super::connections::Bounded;
use super::hub::Hub;
use super::page::page as page_text;
use super::{server_orders, server_records, server_upkeep};

/// A button is a few words.
const BUTTON_BYTES_MAX: usize = 256;
/// An order may be the corners of all areas.
const ORDER_BYTES_MAX: usize = 24_576;
/// What has changed in the records reaches the disk this often.
const SAVE_EVERY: Duration = Duration::from_secs(5);
/// A browser that waits for a picture gets the old one after this long.
const WAIT: Duration = Duration::from_secs(1);

/// Serves until the program ends.
pub fn serve(listener: std::net::TcpListener, hub: Hub) {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build();
    let served = runtime.and_then(|runtime| {
        runtime.block_on(async {
            let listener = tokio::net::TcpListener::from_std(listener)?;
            tokio::spawn(keep_records(hub.clone()));
            hub.others.clone().read(hub.access.viewer_token())?;
            axum::serve(Bounded::new(listener), router(hub)).await
        })
    });
    if let Err(error) = served {
        say!("the panel has closed: {error}; the robot goes on without it");
    }
}

/// Writes what has changed, on a thread of its own: a disk that is busy holds up no other browser.
pub(super) async fn saved(hub: &Hub) -> anyhow::Result<()> {
    let records = hub.records.clone();
    tokio::task::spawn_blocking(move || records.save()).await?
}

/// Writes what has changed: at most the last seconds of a day are lost.
async fn keep_records(hub: Hub) {
    let mut is_reported = false;
    loop {
        tokio::time::sleep(SAVE_EVERY).await;
        if let Some(error) = saved(&hub).await.err().filter(|_| !is_reported) {
            say!("  panel: its records are not saved ({error:#})");
            is_reported = true;
        }
    }
}

fn router(hub: Hub) -> Router {
    Router::new()
        .route("/", get(page))
        .route("/state", get(state))
        .route("/layers", get(layers))
        .route("/map", get(map))
        .route("/role", get(role))
        .route("/records", get(server_records::records))
        .route("/proof.pdf", get(server_records::proof))
        .route("/brief", get(server_upkeep::brief))
        .route("/robots", get(server_upkeep::robots))
        .route("/camera.jpg", get(server_upkeep::camera))
        .route("/schedules", post(server_upkeep::schedules))
        .route("/changed", post(server_upkeep::changed))
        .route("/order", post(server_orders::order).layer(DefaultBodyLimit::max(BUTTON_BYTES_MAX)))
        .route("/mission", post(server_orders::mission))
        .route("/areas", post(server_orders::areas))
        .route("/acknowledge", post(server_orders::acknowledge))
        .layer(DefaultBodyLimit::max(ORDER_BYTES_MAX))
        .with_state(hub)
}

pub(super) fn refusal(code: StatusCode, why: impl Into<String>) -> Response {
    (code, [(header::CONTENT_TYPE, "text/plain; charset=utf-8")], why.into()).into_response()
}

pub(super) fn text<'a>(headers: &'a HeaderMap, name: &header::HeaderName) -> &'a str {
    headers.get(name).and_then(|value| value.to_str().ok()).unwrap_or_default()
}

fn role_of(hub: &Hub, headers: &HeaderMap) -> Option<Role> {
    let shown = text(headers, &header::AUTHORIZATION).strip_prefix("Bearer ").unwrap_or_default();
    hub.access.role(shown)
}

/// Refuses who is not meant, or may not do this.
pub(super) fn refused(hub: &Hub, headers: &HeaderMap, needed: Role) -> Option<Response> {
    if let Some(refused) = stranger(hub, headers) {
        return Some(refused);
    }
    match role_of(hub, headers) {
        Some(role) if role >= needed => None,
        Some(Role::Operator) => Some(refusal(StatusCode::FORBIDDEN, "only a technician may do this")),
        Some(_) => {
            Some(refusal(StatusCode::UNAUTHORIZED, "open the panel with the address that the console shows"))
        }
        None => Some(refusal(StatusCode::UNAUTHORIZED, "show the token")),
    }
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
    let mut response = (StatusCode::OK, page_text()).into_response();
    let policy = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; connect-src 'self'; \
                  img-src data: blob:; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";
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
    if let Some(refused) = refused(hub, headers, Role::Viewer) {
        return refused;
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
    json(text.to_string())
}

pub(super) fn json(text: String) -> Response {
    let json = [(header::CONTENT_TYPE, "application/json"), (header::CACHE_CONTROL, "no-store")];
    (StatusCode::OK, json, text).into_response()
}

/// The map of the mission.
async fn map(State(hub): State<Hub>, headers: HeaderMap) -> Response {
    if let Some(refused) = refused(&hub, &headers, Role::Viewer) {
        return refused;
    }
    json(hub.map.borrow().to_string())
}

/// What who asks may do.
async fn role(State(hub): State<Hub>, headers: HeaderMap) -> Response {
    if let Some(refused) = refused(&hub, &headers, Role::Viewer) {
        return refused;
    }
    json(serde_json::to_string(&role_of(&hub, &headers)).unwrap_or_default())
}
