//! A daemon's records for Foxglove, as in a recording of it: by its WebSocket protocol,
//! version 1 (<https://github.com/foxglove/ws-protocol/blob/main/docs/spec.md>).

use std::collections::BTreeMap;
use std::sync::Arc;

use axum::body::Bytes;
use axum::extract::ws::{Message, Utf8Bytes, WebSocket, WebSocketUpgrade};
use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::response::Response;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use fcc_fixed_wing::Autopilot;
use fcc_record::RecordMessages;
use fcc_telemetry::FlightRecord;
use fcc_telemetry::schema::read_words;
use serde::Deserialize;
use serde_json::{Value, json};
use tokio::sync::broadcast::error::RecvError;
use tokio::time::{Instant, interval};

use super::socket::{Closed, PATIENCE, PING_EVERY, limited, send, text};
use super::{Feed, Newest};
use crate::failure::{Failure, Given};
use crate::station::{Station, instance_of};

/// Its first name is that of the SDK, its second that of the older specification.
const PROTOCOLS: [&str; 2] = ["foxglove.sdk.v1", "foxglove.websocket.v1"];
/// The longest message of a client, which may subscribe to all topics at once.
const MOST_BYTES: usize = 16 << 10;
/// Begins a binary message that is the message of a topic.
const MESSAGE_DATA: u8 = 1;

type Messages = RecordMessages<Autopilot>;

/// What an address carries: who connects from Foxglove cannot give headers.
#[derive(Deserialize)]
pub(crate) struct Address {
    #[serde(default)]
    token: String,
}

/// WebSocket `/foxglove/{instance}?token=TOKEN`.
pub(crate) async fn socket(
    State(station): State<Arc<Station>>,
    Path(instance): Path<String>,
    Given(given): Given<Address>,
    upgrade: WebSocketUpgrade,
) -> Result<Response, Failure> {
    if !station.foxglove {
        return Err(Failure::missing("start the station with --foxglove"));
    }
    if !station.token.is(given.token.as_bytes()) {
        let what = "give the token of the printed link: ?token=TOKEN";
        return Err(Failure::new(StatusCode::UNAUTHORIZED, what));
    }
    let feed = station.feed(&instance_of(&instance)?)?;
    if !feed.is_flight {
        return Err(Failure::refused(format!(
            "the records of '{instance}' are not those of this program's aircraft"
        )));
    }
    let place = station.socket_place()?;
    let client = station.machine.client();
    let upgrade = limited(upgrade, MOST_BYTES).protocols(PROTOCOLS);
    Ok(upgrade.on_upgrade(async move |mut socket| {
        // A client that has left is no failure.
        let _ = Client::new(&feed).serve(&mut socket).await;
        drop((place, client));
    }))
}

/// What a client wants: the number that it has given to each topic.
struct Client<'a> {
    feed: &'a Feed,
    subscriptions: BTreeMap<usize, u32>,
    messages: Messages,
}

#[derive(Deserialize)]
#[serde(tag = "op", rename_all = "camelCase")]
enum Asked {
    Subscribe {
        subscriptions: Vec<Subscription>,
    },
    #[serde(rename_all = "camelCase")]
    Unsubscribe {
        subscription_ids: Vec<u32>,
    },
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Subscription {
    id: u32,
    channel_id: usize,
}

impl<'a> Client<'a> {
    fn new(feed: &'a Feed) -> Self {
        Self {
            feed,
            subscriptions: BTreeMap::new(),
            messages: Messages::default(),
        }
    }

    async fn serve(&mut self, socket: &mut WebSocket) -> Result<(), Closed> {
        let (mut records, mut ends) = (self.feed.records(), self.feed.ends());
        let (mut past, mut events) = self.feed.events();
        for opening in [self.server_info(), advertised()] {
            text(socket, opening.to_string().into()).await?;
        }
        let mut pings = interval(PING_EVERY);
        let mut heard = Instant::now();
        loop {
            let to_send = tokio::select! {
                biased;
                received = socket.recv() => {
                    match received {
                        Some(Ok(Message::Close(_)) | Err(_)) | None => return Err(Closed),
                        Some(Ok(Message::Text(asked))) => self.update_subscriptions(&asked),
                        Some(Ok(_)) => {}
                    }
                    heard = Instant::now();
                    match self.subscriptions.get(&Messages::LOG) {
                        Some(_) => past.drain(..).filter_map(|event| self.event(&event)).collect(),
                        None => Vec::new(),
                    }
                }
                event = events.recv() => match event {
                    Ok(event) => self.event(&event).into_iter().collect(),
                    // Those that it was too slow for.
                    Err(RecvError::Lagged(_)) => Vec::new(),
                    Err(RecvError::Closed) => return Err(Closed),
                },
                _ = ends.changed() => return send(socket, Message::Close(None)).await,
                _ = pings.tick() => {
                    if heard.elapsed() > PATIENCE {
                        return Err(Closed);
                    }
                    send(socket, Message::Ping(Bytes::new())).await?;
                    Vec::new()
                }
                record = records.changed() => {
                    record.map_err(|_| Closed)?;
                    let newest = records.borrow_and_update().clone();
                    self.record(&newest)
                }
            };
            for message in to_send {
                send(socket, Message::Binary(message)).await?;
            }
        }
    }

    fn server_info(&self) -> Value {
        json!({
            "op": "serverInfo",
            "name": format!("fccd {}", self.feed.instance),
            "capabilities": [],
            // Another daemon is another session.
            "sessionId": self.feed.info.started_unix_ns.to_string(),
        })
    }

    /// What is not understood is no fault: later versions ask for more.
    fn update_subscriptions(&mut self, asked: &str) {
        match serde_json::from_str(asked) {
            Ok(Asked::Subscribe { subscriptions }) => {
                let known = Messages::topics().len();
                let known = subscriptions.iter().filter(|one| one.channel_id < known);
                self.subscriptions
                    .extend(known.map(|one| (one.channel_id, one.id)));
            }
            Ok(Asked::Unsubscribe { subscription_ids }) => self
                .subscriptions
                .retain(|_, id| !subscription_ids.contains(id)),
            Err(_) => {}
        }
    }

    /// ns since 1970 of a time on the loop's clock.
    fn unix_ns(&self, time_ns: i64) -> u64 {
        let since = time_ns.saturating_sub(self.feed.info.started_ns);
        let started = self.feed.info.started_unix_ns;
        u64::try_from(started.saturating_add(since)).unwrap_or(0)
    }

    fn record(&mut self, newest: &Newest) -> Vec<Bytes> {
        let mut to_send = Vec::new();
        if self.subscriptions.is_empty() {
            return to_send;
        }
        // What is no record is not shown.
        if let Ok(record) = read_words::<FlightRecord>(&newest.row) {
            let unix_ns = self.unix_ns(record.tick.woke.as_nanos());
            let Self {
                messages,
                subscriptions,
                ..
            } = self;
            messages.record(&record, unix_ns, |topic, bytes| {
                let id = subscriptions.get(&topic);
                to_send.extend(id.map(|id| message(*id, unix_ns, bytes)));
            });
        }
        to_send
    }

    /// The log line of an event, from the message to pages.
    fn event(&self, told: &Utf8Bytes) -> Option<Bytes> {
        let id = self.subscriptions.get(&Messages::LOG)?;
        let told: Value = serde_json::from_str(told).ok()?;
        let event = told.get("event")?;
        let since_ns = event.get("time_s")?.as_f64()? * 1e9;
        let started = self.feed.info.started_ns;
        let unix_ns = self.unix_ns(started.saturating_add(since_ns as i64));
        let remark = Messages::remark(event.get("text")?.as_str()?, unix_ns);
        Some(message(*id, unix_ns, &remark))
    }
}

/// The topics of a recording.
fn advertised() -> Value {
    let topics = Messages::topics().into_iter().enumerate();
    let channels = topics.map(|(id, (topic, schema_name, schema))| {
        json!({
            "id": id,
            "topic": topic,
            "encoding": "protobuf",
            "schemaName": schema_name,
            "schema": STANDARD.encode(schema),
            "schemaEncoding": "protobuf",
        })
    });
    json!({ "op": "advertise", "channels": channels.collect::<Vec<_>>() })
}

/// The message of a topic, by the number of its subscription.
fn message(subscription: u32, unix_ns: u64, bytes: &[u8]) -> Bytes {
    let head = [MESSAGE_DATA].into_iter().chain(subscription.to_le_bytes());
    let head = head.chain(unix_ns.to_le_bytes());
    head.chain(bytes.iter().copied()).collect()
}
