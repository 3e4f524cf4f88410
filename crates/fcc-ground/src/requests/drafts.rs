//! Drafts for the page.

use std::sync::Arc;

use axum::Json;
use axum::body::Bytes;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::ws::{Message, WebSocketUpgrade};
use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::response::{IntoResponse as _, Response};
use fcc_plan::Plan;
use serde::Deserialize;
use serde_json::{Value, json};
use tokio::time::{Instant, interval, timeout};

use crate::drafts::Refused;
use crate::failure::{Failure, Sent, aside, reading};
use crate::live::{PATIENCE, PING_EVERY};
use crate::plans::hash_text;
use crate::station::Station;

/// `GET /api/drafts`: the list, or a WebSocket of changes.
pub(crate) async fn list_or_socket(
    State(station): State<Arc<Station>>,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Result<Response, Failure> {
    let Ok(upgrade) = upgrade else {
        let list = reading(move || station.drafts.list()).await?;
        return Ok(Json(list).into_response());
    };
    let place = station.socket_place()?;
    let mut changes = station.drafts.changes.subscribe();
    let upgrade = upgrade.max_message_size(4 << 10);
    Ok(upgrade.on_upgrade(async move |mut socket| {
        let _place = place;
        let mut pings = interval(PING_EVERY);
        let mut heard = Instant::now();
        loop {
            tokio::select! {
                _ = pings.tick() => {
                    let ping = socket.send(Message::Ping(Bytes::new()));
                    if heard.elapsed() > PATIENCE || !matches!(timeout(PATIENCE, ping).await, Ok(Ok(()))) {
                        return;
                    }
                }
                change = changes.recv() => match change {
                    Ok(text) => {
                        if socket.send(Message::Text(text)).await.is_err() {
                            return;
                        }
                    }
                    // The page asks for the drafts again when it connects again.
                    Err(_) => return,
                },
                received = socket.recv() => match received {
                    Some(Ok(Message::Close(_)) | Err(_)) | None => return,
                    Some(Ok(_)) => heard = Instant::now(),
                },
            }
        }
    }))
}

/// `GET /api/drafts/{name}`.
pub(crate) async fn get(
    State(station): State<Arc<Station>>,
    Path(name): Path<String>,
) -> Result<Json<Value>, Failure> {
    let draft = reading(move || station.drafts.get(&name)).await?;
    Ok(Json(draft.to_json()))
}

/// The body of an edit.
#[derive(Debug, Deserialize)]
pub(crate) struct Edit {
    /// The revision that was edited; 0 or null for a new draft.
    based_on: Option<u64>,
    plan: Plan,
}

/// `PUT /api/drafts/{name}`.
pub(crate) async fn put(
    State(station): State<Arc<Station>>,
    Path(name): Path<String>,
    Sent(edit): Sent<Edit>,
) -> Result<Json<Value>, Failure> {
    let draft = aside(move || {
        let put = station
            .drafts
            .put(&name, edit.based_on.unwrap_or(0), edit.plan);
        put.map_err(|refused| match refused {
            Refused::Other(failure) => failure,
            Refused::Newer(newer) => {
                let mut body = newer.to_json();
                if let Some(body) = body.as_object_mut() {
                    let what = "another page has changed this draft: this is its newest revision";
                    body.insert("error".to_owned(), what.into());
                }
                Failure::with(StatusCode::CONFLICT, body)
            }
        })
    })
    .await?;
    Ok(Json(json!({
        "name": draft.name,
        "revision": draft.revision,
        "changed_utc_s": draft.changed_utc_s,
        "hash": hash_text(&draft.plan),
    })))
}

/// `DELETE /api/drafts/{name}`.
pub(crate) async fn delete(
    State(station): State<Arc<Station>>,
    Path(name): Path<String>,
) -> Result<StatusCode, Failure> {
    aside(move || station.drafts.delete(&name)).await?;
    Ok(StatusCode::NO_CONTENT)
}
