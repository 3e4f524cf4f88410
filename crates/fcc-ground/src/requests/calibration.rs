//! A calibration that the page begins, watches and ends.

use std::sync::Arc;

use axum::Json;
use axum::extract::State;
use fcc_telemetry::Instance;
use serde::Deserialize;
use serde_json::Value;

use crate::failure::{Failure, Sent};
use crate::station::Station;

/// The body of a request to begin.
#[derive(Debug, Deserialize)]
pub(crate) struct Begin {
    instance: Instance,
    kind: String,
}

/// `GET /api/calibration`.
pub(crate) async fn course(State(station): State<Arc<Station>>) -> Json<Value> {
    Json(station.calibration.course())
}

/// `POST /api/calibration`.
pub(crate) async fn begin(
    State(station): State<Arc<Station>>,
    Sent(begin): Sent<Begin>,
) -> Result<Json<Value>, Failure> {
    let Begin { instance, kind } = begin;
    let config = station.configs.file(&instance).ok_or_else(|| {
        Failure::refused(format!(
            "the station does not know the configuration of '{instance}': start it with --config"
        ))
    })?;
    if station.daemons.feed(&instance).is_some() {
        return Err(Failure::refused(format!(
            "fccd '{instance}' reads these sensors: stop it first"
        )));
    }
    if kind.starts_with('-') {
        return Err(Failure::bad("kind: give the name of a calibration"));
    }
    let not_started = |error: &_| station.without_fccd(error);
    let began = station
        .calibration
        .begin(&station.fccd, kind, config, not_started)?;
    Ok(Json(began))
}

/// `DELETE /api/calibration`: nothing is changed.
pub(crate) async fn end(State(station): State<Arc<Station>>) -> Result<Json<Value>, Failure> {
    station.calibration.end().map(Json)
}
