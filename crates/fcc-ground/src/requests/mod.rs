//! Which function answers which request.

mod calibration;
pub(crate) mod commands;
mod drafts;
mod map;
mod plans;

use std::sync::Arc;

use axum::extract::{DefaultBodyLimit, State};
use axum::http::HeaderMap;
use axum::routing::{delete, get, post};
use axum::{Json, Router, middleware};
use serde_json::{Value, json};
use tower_http::compression::CompressionLayer;
use tower_http::compression::predicate::{NotForContentType, Predicate as _, SizeAbove};

use crate::failure::Failure;
use crate::guard::guard;
use crate::orders::utc_ms;
use crate::station::Station;
use crate::{daemon_config, doctor, flights, live, page, upload};

/// Answers every request.
pub(crate) fn router(station: Arc<Station>) -> Router {
    let compressed =
        SizeAbove::new(1_024).and(NotForContentType::const_new("application/octet-stream"));
    Router::new()
        .route("/api/status", get(status))
        .route("/api/live/{instance}", get(live::socket))
        .route("/api/live/{instance}/columns", get(live::columns))
        .route("/api/live/{instance}/command", post(commands::command))
        .route(
            "/api/live/{instance}/plan",
            get(upload::vehicle_plan).post(upload::upload),
        )
        .route("/api/drafts", get(drafts::list_or_socket))
        .route(
            "/api/drafts/{name}",
            get(drafts::get).put(drafts::put).delete(drafts::delete),
        )
        .route("/api/plan/check", post(plans::check))
        .route("/api/plan/import", post(plans::import))
        .route("/api/plan/export", post(plans::export))
        .route("/api/flights", get(flights::list))
        .route("/api/flights/{file}", delete(flights::delete))
        .route("/api/flights/{file}/data", get(flights::data))
        .route("/api/flights/{file}/events", get(flights::events))
        .route("/api/flights/{file}/plan", get(flights::plan))
        .route("/api/flights/{file}/aircraft", get(flights::aircraft))
        .route("/api/flights/{file}/report", get(flights::report))
        .route("/api/flights/{file}/download", get(flights::download))
        .route("/api/flights/{a}/compare/{b}", get(flights::compare))
        .route("/api/doctor", get(doctor::doctor))
        .route(
            "/api/calibration",
            get(calibration::course)
                .post(calibration::begin)
                .delete(calibration::end),
        )
        .route("/api/terrain", get(map::terrain))
        .route("/api/map", get(map::map))
        .route("/foxglove/{instance}", get(live::foxglove_socket))
        .route("/map.pmtiles", get(map::tiles))
        .route("/api/{*unknown}", get(unknown))
        .fallback(page::page)
        // The guard limits them.
        .layer(DefaultBodyLimit::disable())
        .layer(CompressionLayer::new().gzip(true).compress_when(compressed))
        .layer(middleware::from_fn_with_state(Arc::clone(&station), guard))
        .with_state(station)
}

async fn unknown() -> Failure {
    Failure::missing("there is no such part of the interface: see docs/ground-station.md")
}

/// `GET /api/status`.
async fn status(State(station): State<Arc<Station>>, headers: HeaderMap) -> Json<Value> {
    let daemons = station.daemons.feeds().into_iter().map(|feed| {
        let instance = &feed.instance;
        let config = station.configs.of(Some(instance));
        let in_standby = station.restarts && station.configs.plan_file(instance).is_some();
        json!({
            "instance": instance,
            "plant": feed.info.plant.as_str(),
            "software": feed.info.software.as_str(),
            "rate_hz": feed.info.rate_hz,
            "process_id": feed.info.process_id,
            "guidance_mode": json!(config.guidance).get("mode"),
            "plan_upload": if in_standby { "standby" } else { "flight" },
            "setpoints": daemon_config::setpoints(config),
            "aircraft": daemon_config::aircraft(config),
        })
    });
    let refused = station.daemons.refused().into_iter();
    Json(json!({
        "software": env!("CARGO_PKG_VERSION"),
        "writable": station.token.is_in(&headers),
        "utc_ms": utc_ms(),
        "configured": station.configs.instances().collect::<Vec<_>>(),
        "daemons": daemons.collect::<Vec<_>>(),
        "not_watched": refused
            .map(|(instance, error)| json!({ "instance": instance, "error": error }))
            .collect::<Vec<_>>(),
    }))
}
