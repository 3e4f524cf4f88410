//! Commands to a daemon.

use std::collections::BTreeMap;
use std::sync::{Arc, PoisonError};

use axum::extract::{Path, State};
use axum::{Extension, Json};
use fcc_live::{Command, Commander};
use fcc_telemetry::Instance;
use serde::Deserialize;
use serde_json::{Value, json};

use crate::failure::{Failure, Sent, aside};
use crate::guard::Peer;
use crate::orders::{Order, utc_ms};
use crate::station::{Station, instance_of};

/// The body of a command.
#[derive(Debug, Deserialize)]
pub(crate) struct Commanded {
    number: u64,
    deadline_ms_utc: u64,
    command: What,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
enum What {
    Engage,
    Disengage,
    Pause,
    Resume,
    Return,
    Land,
    GoAround,
    Item(u16),
    Set(BTreeMap<String, f64>),
    GoTo {
        latitude_deg: f64,
        longitude_deg: f64,
        altitude_m: f64,
    },
}

impl From<What> for Command {
    fn from(what: What) -> Self {
        match what {
            What::Engage => Self::Engage,
            What::Disengage => Self::Disengage,
            What::Pause => Self::set([("pause", 1.0)]),
            What::Resume => Self::set([("plan_item", 0.0)]),
            What::Return => Self::set([("return_home", 1.0)]),
            What::Land => Self::set([("land", 1.0)]),
            What::GoAround => Self::set([("go_around", 1.0)]),
            What::Item(number) => Self::set([("plan_item", f64::from(number))]),
            What::Set(values) => Self::Set(values.into_iter().collect()),
            What::GoTo {
                latitude_deg,
                longitude_deg,
                altitude_m,
            } => Self::set([
                ("go_to_latitude_rad", latitude_deg.to_radians()),
                ("go_to_longitude_rad", longitude_deg.to_radians()),
                ("go_to_altitude_m", altitude_m),
            ]),
        }
    }
}

/// Sends a command if it is still in time; returns the tick that carried it out.
pub(crate) fn send(
    instance: &Instance,
    command: &Command,
    order: Order,
    sender: &str,
) -> Result<u64, Failure> {
    let opened = Commander::open(instance, sender);
    let mut commander = opened.map_err(Failure::refused)?;
    order.in_time(utc_ms())?;
    commander.command(command).map_err(Failure::refused)
}

/// `POST /api/live/{instance}/command`.
pub(crate) async fn command(
    State(station): State<Arc<Station>>,
    Path(instance): Path<String>,
    Extension(peer): Extension<Peer>,
    Sent(commanded): Sent<Commanded>,
) -> Result<Json<Value>, Failure> {
    let instance = instance_of(&instance)?;
    let order = Order {
        number: commanded.number,
        deadline_ms_utc: commanded.deadline_ms_utc,
    };
    station.orders.take(order, utc_ms())?;
    let command = Command::from(commanded.command);
    let tick = aside(move || {
        let turn = station.orders.turn.lock();
        let _turn = turn.unwrap_or_else(PoisonError::into_inner);
        station.orders.permit_page()?;
        send(&instance, &command, order, &peer.sender())
    })
    .await?;
    Ok(Json(json!({ "carried_out": tick })))
}
