//! Over the web: schedules, parts that were changed, the camera's picture, and this robot in short for other panels.

use axum::body::Bytes;
use axum::extract::State;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse as _, Response};
use floorguard_robot::environment::Calendar;
use serde::Deserialize;

use super::access::Role;
use super::hub::Hub;
use super::records::Schedule;
use super::server::{json, refusal, refused, saved};
use super::server_orders::body_of;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SchedulesBody {
    schedules: Vec<Schedule>,
}

pub(super) async fn schedules(State(hub): State<Hub>, headers: HeaderMap, body: Bytes) -> Response {
    let expected = "schedules have a name, weekdays, a minute of the day and areas";
    let SchedulesBody { schedules } = match body_of((&hub, &headers), Role::Operator, (&body, expected)) {
        Ok(body) => body,
        Err(refused) => return *refused,
    };
    if hub.map.borrow().len() <= 2 {
        return refusal(StatusCode::CONFLICT, "this robot has no mission");
    }
    let taken = hub.records.lock().set_schedules(schedules);
    if let Err(error) = taken {
        return refusal(StatusCode::BAD_REQUEST, error.to_string());
    }
    match saved(&hub).await {
        Ok(()) => refusal(StatusCode::ACCEPTED, "the schedules are kept"),
        Err(error) => {
            refusal(StatusCode::INTERNAL_SERVER_ERROR, format!("the schedules are not saved: {error:#}"))
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ChangedBody {
    part: String,
}

/// A technician has changed a part.
pub(super) async fn changed(State(hub): State<Hub>, headers: HeaderMap, body: Bytes) -> Response {
    let expected = "name the part";
    let ChangedBody { part } = match body_of((&hub, &headers), Role::Technician, (&body, expected)) {
        Ok(body) => body,
        Err(refused) => return *refused,
    };
    let now = Calendar::of_this_computer().iso(Calendar::now());
    if !hub.records.lock().part_changed(&part, &now) {
        return refusal(StatusCode::CONFLICT, "there is no such part");
    }
    match saved(&hub).await {
        Ok(()) => refusal(StatusCode::ACCEPTED, "the part is new"),
        Err(error) => refusal(StatusCode::INTERNAL_SERVER_ERROR, format!("this is not saved: {error:#}")),
    }
}

/// The floor camera's newest picture.
pub(super) async fn camera(State(hub): State<Hub>, headers: HeaderMap) -> Response {
    if let Some(refused) = refused(&hub, &headers, Role::Viewer) {
        return refused;
    }
    let file = hub.camera.borrow().clone();
    if file.is_empty() {
        return refusal(StatusCode::NOT_FOUND, "there is no picture of a camera");
    }
    let head = [(header::CONTENT_TYPE, "image/jpeg"), (header::CACHE_CONTROL, "no-store")];
    (StatusCode::OK, head, file.to_vec()).into_response()
}

/// This robot in short.
pub(super) async fn brief(State(hub): State<Hub>, headers: HeaderMap) -> Response {
    if let Some(refused) = refused(&hub, &headers, Role::Viewer) {
        return refused;
    }
    json(hub.brief.borrow().to_string())
}

/// The other robots of the site in short.
pub(super) async fn robots(State(hub): State<Hub>, headers: HeaderMap) -> Response {
    if let Some(refused) = refused(&hub, &headers, Role::Viewer) {
        return refused;
    }
    json(hub.others.list().to_string())
}
