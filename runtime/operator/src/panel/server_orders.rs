//! What operators and technicians order over the web.

use axum::body::Bytes;
use axum::extract::State;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::Response;
use floorguard_robot::cleaner::{Area, MissionOrder};
use floorguard_robot::environment::Calendar;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::access::Role;
use super::hub::{Hub, Order, mission_of, standing_areas};
use super::server::{refusal, refused, saved, text};

/// The body of a request from who may make it.
pub(super) fn body_of<T: DeserializeOwned>(
    (hub, headers): (&Hub, &HeaderMap),
    needed: Role,
    (body, expected): (&Bytes, &'static str),
) -> Result<T, Box<Response>> {
    if let Some(refused) = refused(hub, headers, needed) {
        return Err(Box::new(refused));
    }
    // A form of somebody else's page cannot send this type without asking first.
    if text(headers, &header::CONTENT_TYPE) != "application/json" {
        return Err(Box::new(refusal(StatusCode::UNSUPPORTED_MEDIA_TYPE, "send application/json")));
    }
    serde_json::from_slice(body).map_err(|_| Box::new(refusal(StatusCode::BAD_REQUEST, expected)))
}

fn queued(is_queued: bool) -> Response {
    if is_queued {
        refusal(StatusCode::ACCEPTED, "the robot has it")
    } else {
        refusal(StatusCode::TOO_MANY_REQUESTS, "too many orders wait; try again")
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct OrderBody {
    order: Order,
}

pub(super) async fn order(State(hub): State<Hub>, headers: HeaderMap, body: Bytes) -> Response {
    let expected = "orders are pause, resume, reset and start";
    let order: OrderBody = match body_of((&hub, &headers), Role::Operator, (&body, expected)) {
        Ok(order) => order,
        Err(refused) => return *refused,
    };
    let awaited = *hub.awaited.borrow();
    match order.order {
        order @ Order::Reset if awaited != Some(order) => {
            refusal(StatusCode::CONFLICT, "no stop waits for a reset")
        }
        order @ Order::Start if awaited != Some(order) => {
            refusal(StatusCode::CONFLICT, "the robot does not wait for a start command")
        }
        order => queued(hub.order(order)),
    }
}

/// What a browser orders of the mission: areas by their names.
#[derive(Deserialize)]
#[serde(tag = "do", rename_all = "kebab-case", deny_unknown_fields)]
enum MissionBody {
    Begin { areas: Vec<String> },
    Cancel { place: usize },
    Locate { x_m: f32, y_m: f32, heading_rad: f32 },
}

impl MissionBody {
    /// With the areas that are kept.
    fn order(self, kept: &[Area]) -> Result<MissionOrder, &'static str> {
        let areas = match self {
            Self::Begin { areas } => areas,
            Self::Cancel { place } => return Ok(MissionOrder::Cancel { place }),
            Self::Locate { x_m, y_m, heading_rad } => {
                return Ok(MissionOrder::Locate { x_m, y_m, heading_rad });
            }
        };
        mission_of(&areas, kept).ok_or("there is no such area")
    }
}

pub(super) async fn mission(State(hub): State<Hub>, headers: HeaderMap, body: Bytes) -> Response {
    let expected = "orders are begin, cancel and locate";
    let order: MissionBody = match body_of((&hub, &headers), Role::Operator, (&body, expected)) {
        Ok(order) => order,
        Err(refused) => return *refused,
    };
    if hub.map.borrow().len() <= 2 {
        return refusal(StatusCode::CONFLICT, "this robot has no mission");
    }
    let order = order.order(&hub.records.lock().kept().areas);
    match order.map(|order| order.check().map(|()| order)) {
        Ok(Ok(order)) => queued(hub.order(super::PanelOrder::Mission(order))),
        Ok(Err(error)) => refusal(StatusCode::BAD_REQUEST, error.to_string()),
        Err(why) => refusal(StatusCode::CONFLICT, why),
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AreasBody {
    areas: Vec<Area>,
}

pub(super) async fn areas(State(hub): State<Hub>, headers: HeaderMap, body: Bytes) -> Response {
    let expected = "areas have a name, a kind (clean, no-go, slow) and corners";
    let AreasBody { areas } = match body_of((&hub, &headers), Role::Technician, (&body, expected)) {
        Ok(areas) => areas,
        Err(refused) => return *refused,
    };
    let order = MissionOrder::Areas { areas: standing_areas(&areas) };
    if let Err(error) = order.check() {
        return refusal(StatusCode::BAD_REQUEST, error.to_string());
    }
    let taken = hub.records.lock().set_areas(areas);
    if let Err(error) = taken {
        return refusal(StatusCode::BAD_REQUEST, error.to_string());
    }
    if let Err(error) = saved(&hub).await {
        return refusal(StatusCode::INTERNAL_SERVER_ERROR, format!("the areas are not saved: {error:#}"));
    }
    if hub.map.borrow().len() <= 2 {
        return refusal(StatusCode::ACCEPTED, "the areas are kept");
    }
    queued(hub.order(super::PanelOrder::Mission(order)))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AcknowledgeBody {
    /// The alert; without it, all.
    id: Option<u64>,
}

pub(super) async fn acknowledge(State(hub): State<Hub>, headers: HeaderMap, body: Bytes) -> Response {
    let expected = "name an alert, or none for all";
    let AcknowledgeBody { id } = match body_of((&hub, &headers), Role::Operator, (&body, expected)) {
        Ok(body) => body,
        Err(refused) => return *refused,
    };
    let now = Calendar::of_this_computer().iso(Calendar::now());
    if hub.records.lock().acknowledge(id, &now) {
        refusal(StatusCode::ACCEPTED, "acknowledged")
    } else {
        refusal(StatusCode::CONFLICT, "no such alert waits to be acknowledged")
    }
}
