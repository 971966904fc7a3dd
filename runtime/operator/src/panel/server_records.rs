//! What is kept, over the web: areas, alerts and days, and the proof of a day as a PDF file.

use axum::extract::rejection::QueryRejection;
use axum::extract::{Query, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::{Deserialize, Serialize};

use super::access::Role;
use super::hub::Hub;
use super::pdf_of_day::pdf_of_day;
use super::records::Kept;
use super::server::{json, refusal, refused};
use crate::words::Language;

#[derive(Serialize)]
struct Numbered<'a> {
    number: u64,
    #[serde(flatten)]
    kept: &'a Kept,
}

pub(super) async fn records(State(hub): State<Hub>, headers: HeaderMap) -> Response {
    if let Some(refused) = refused(&hub, &headers, Role::Viewer) {
        return refused;
    }
    let records = hub.records.lock();
    let numbered = Numbered { number: records.number(), kept: records.kept() };
    json(serde_json::to_string(&numbered).unwrap_or_default())
}

#[derive(Deserialize)]
pub(super) struct OfDay {
    /// The date, `2026-11-24`.
    day: String,
    /// Two letters; English without.
    language: Option<String>,
}

pub(super) async fn proof(
    State(hub): State<Hub>,
    headers: HeaderMap,
    query: Result<Query<OfDay>, QueryRejection>,
) -> Response {
    if let Some(refused) = refused(&hub, &headers, Role::Viewer) {
        return refused;
    }
    let Ok(Query(OfDay { day, language })) = query else {
        return refusal(StatusCode::BAD_REQUEST, "day= is a date, as 2026-11-24");
    };
    let language = language.and_then(|code| Language::of_code(&code)).unwrap_or_default();
    let record = hub.records.lock().kept().days.get(&day).cloned();
    let Some(record) = record else {
        return refusal(StatusCode::NOT_FOUND, "nothing is known of that day");
    };
    let head = [(header::CONTENT_TYPE, "application/pdf"), (header::CACHE_CONTROL, "no-store")];
    (StatusCode::OK, head, pdf_of_day(&day, &record, (&hub.title, language))).into_response()
}
