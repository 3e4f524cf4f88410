//! A page that watches a daemon.

use std::sync::Arc;
use std::time::Duration;

use axum::Json;
use axum::extract::ws::{Message, Utf8Bytes, WebSocket, WebSocketUpgrade};
use axum::extract::{Path, State};
use axum::response::Response;
use serde_json::{Value, json};
use tokio::sync::broadcast::error::RecvError;
use tokio::time::{Instant, interval, timeout};

use super::Feed;
use crate::failure::Failure;
use crate::station::{Station, instance_of};

/// A page that takes nothing for so long, or does not answer, is closed.
pub(crate) const PATIENCE: Duration = Duration::from_secs(30);
pub(crate) const PING_EVERY: Duration = Duration::from_secs(10);
/// The longest message of a page: it has nothing to say.
const MOST_BYTES: usize = 4 << 10;

/// `GET /api/live/{instance}/columns`.
pub(crate) async fn columns(
    State(station): State<Arc<Station>>,
    Path(instance): Path<String>,
) -> Result<Json<Value>, Failure> {
    let feed = station.feed(&instance_of(&instance)?)?;
    Ok(Json(json!({ "columns": feed.columns.all })))
}

/// WebSocket `/api/live/{instance}`.
pub(crate) async fn socket(
    State(station): State<Arc<Station>>,
    Path(instance): Path<String>,
    upgrade: WebSocketUpgrade,
) -> Result<Response, Failure> {
    let feed = station.feed(&instance_of(&instance)?)?;
    let place = station.socket_place()?;
    let client = station.machine.client();
    let upgrade = limited(upgrade, MOST_BYTES);
    Ok(upgrade.on_upgrade(async move |mut socket| {
        // A page that has left is no failure.
        let _ = watch(&mut socket, &feed).await;
        drop((place, client));
    }))
}

/// What a connection may keep in memory.
pub(super) fn limited(upgrade: WebSocketUpgrade, most_bytes: usize) -> WebSocketUpgrade {
    upgrade
        .max_message_size(most_bytes)
        .write_buffer_size(0)
        .max_write_buffer_size(1 << 20)
}

/// Why it ended does not matter.
pub(super) struct Closed;

pub(super) async fn send(socket: &mut WebSocket, message: Message) -> Result<(), Closed> {
    let sent = timeout(PATIENCE, socket.send(message)).await;
    sent.map_err(|_| Closed)?.map_err(|_| Closed)
}

pub(super) async fn text(socket: &mut WebSocket, text: Utf8Bytes) -> Result<(), Closed> {
    send(socket, Message::Text(text)).await
}

async fn watch(socket: &mut WebSocket, feed: &Feed) -> Result<(), Closed> {
    let (mut records, mut statuses, mut ends) = (feed.records(), feed.statuses(), feed.ends());
    let (past, mut events) = feed.events();
    text(socket, feed.hello().to_string().into()).await?;
    text(socket, feed.track().to_string().into()).await?;
    for event in past {
        text(socket, event).await?;
    }
    records.mark_changed();
    statuses.mark_changed();
    if !ends.borrow().is_empty() {
        ends.mark_changed();
    }
    let mut pings = interval(PING_EVERY);
    let mut heard = Instant::now();
    loop {
        tokio::select! {
            // Before records, of which there is always a next one.
            biased;
            received = socket.recv() => match received {
                Some(Ok(Message::Close(_)) | Err(_)) | None => return Err(Closed),
                Some(Ok(_)) => heard = Instant::now(),
            },
            event = events.recv() => match event {
                Ok(event) => text(socket, event).await?,
                // Those that it was too slow for.
                Err(RecvError::Lagged(_)) => {}
                Err(RecvError::Closed) => return Err(Closed),
            },
            status = statuses.changed() => {
                status.map_err(|_| Closed)?;
                let status = statuses.borrow_and_update().clone();
                if !status.is_empty() {
                    text(socket, status).await?;
                }
            }
            end = ends.changed() => {
                end.map_err(|_| Closed)?;
                let end = ends.borrow_and_update().clone();
                text(socket, end).await?;
                return send(socket, Message::Close(None)).await;
            }
            _ = pings.tick() => {
                if heard.elapsed() > PATIENCE {
                    return Err(Closed);
                }
                send(socket, Message::Ping(axum::body::Bytes::new())).await?;
            }
            record = records.changed() => {
                record.map_err(|_| Closed)?;
                let bytes = records.borrow_and_update().bytes.clone();
                if !bytes.is_empty() {
                    send(socket, Message::Binary(bytes)).await?;
                }
            }
        }
    }
}
