//! What all requests share, and which function answers which.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;

use axum::extract::{DefaultBodyLimit, State};
use axum::http::HeaderMap;
use axum::http::StatusCode;
use axum::routing::{delete, get, post};
use axum::{Json, Router, middleware};
use fcc_telemetry::Instance;
use serde_json::{Value, json};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tower_http::compression::CompressionLayer;
use tower_http::compression::predicate::{NotForContentType, Predicate as _, SizeAbove};

use crate::calibration::{self, Calibration};
use crate::commands::{self, Orders};
use crate::daemon_config::{self, DaemonConfigs};
use crate::drafts::{self, Drafts};
use crate::failure::Failure;
use crate::guard::{Hosts, guard};
use crate::live::{self, Daemons, Feed, Machine};
use crate::token::Token;
use crate::{doctor, flights, map, page, plans, upload};

/// Pages that are connected by WebSocket at the same time.
const MOST_SOCKETS: usize = 256;

/// Curves and files that are being sent at the same time: each takes memory, or a thread,
/// until its client has taken it.
const MOST_SENDING: usize = 4;

/// What all requests share.
#[derive(Debug)]
pub(crate) struct Station {
    pub(crate) token: Token,
    pub(crate) hosts: Hosts,
    pub(crate) recordings: PathBuf,
    pub(crate) state: PathBuf,
    pub(crate) fccd: PathBuf,
    /// Daemons that were stopped are started again.
    pub(crate) restarts: bool,
    pub(crate) foxglove: bool,
    pub(crate) map: Option<map::MapFile>,
    pub(crate) configs: DaemonConfigs,
    pub(crate) daemons: Daemons,
    pub(crate) machine: Machine,
    pub(crate) drafts: Drafts,
    pub(crate) orders: Orders,
    pub(crate) calibration: Calibration,
    pub(crate) flights: flights::Summaries,
    sockets: Arc<Semaphore>,
    sending: Arc<Semaphore>,
}

/// The name of a daemon in a path.
pub(crate) fn instance_of(name: &str) -> Result<Instance, Failure> {
    name.parse()
        .map_err(|error| Failure::missing(format!("{name:?}: {error}")))
}

impl Station {
    /// A daemon that is watched.
    pub(crate) fn feed(&self, instance: &Instance) -> Result<Arc<Feed>, Failure> {
        self.daemons.feed(instance).ok_or_else(|| {
            let refused = self.daemons.refused();
            let why = refused.into_iter().find(|(refused, _)| refused == instance);
            Failure::missing(match why {
                Some((_, why)) => why,
                None => format!("no fccd named '{instance}' runs for the user of the station"),
            })
        })
    }

    /// The program `fccd` cannot be started.
    pub(crate) fn without_fccd(&self, error: &io::Error) -> Failure {
        let program = self.fccd.display();
        Failure::internal(format!(
            "{program}: cannot be started: {error}: give it with --fccd FILE"
        ))
    }

    /// A place for one more WebSocket.
    pub(crate) fn socket_place(&self) -> Result<OwnedSemaphorePermit, Failure> {
        let what = format!("{MOST_SOCKETS} pages are connected: close one of them");
        place(&self.sockets, what)
    }

    /// A place to send a part of a recording.
    pub(crate) fn sending_place(&self) -> Result<OwnedSemaphorePermit, Failure> {
        let what = "other recordings are being sent: try again when one has arrived";
        place(&self.sending, what)
    }
}

fn place(places: &Arc<Semaphore>, full: impl ToString) -> Result<OwnedSemaphorePermit, Failure> {
    let place = Arc::clone(places).try_acquire_owned();
    place.map_err(|_| Failure::new(StatusCode::SERVICE_UNAVAILABLE, full))
}

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
        "utc_ms": commands::utc_ms(),
        "configured": station.configs.instances().collect::<Vec<_>>(),
        "daemons": daemons.collect::<Vec<_>>(),
        "not_watched": refused
            .map(|(instance, error)| json!({ "instance": instance, "error": error }))
            .collect::<Vec<_>>(),
    }))
}

/// Everything that requests share, put together.
pub(crate) fn station(
    token: Token,
    hosts: Hosts,
    folders: (PathBuf, PathBuf),
    fccd: PathBuf,
    (restarts, foxglove): (bool, bool),
    map: Option<map::MapFile>,
    configs: DaemonConfigs,
) -> Result<Arc<Station>, String> {
    let (recordings, state) = folders;
    let machine = Machine::new(recordings.clone());
    Ok(Arc::new(Station {
        token,
        hosts,
        daemons: Daemons::start(&machine)?,
        drafts: Drafts::new(state.join("drafts")).map_err(|error| error.to_string())?,
        flights: flights::Summaries::new(state.join("summaries")),
        recordings,
        state,
        fccd,
        restarts,
        foxglove,
        map,
        configs,
        machine,
        orders: Orders::default(),
        calibration: Calibration::default(),
        sockets: Arc::new(Semaphore::new(MOST_SOCKETS)),
        sending: Arc::new(Semaphore::new(MOST_SENDING)),
    }))
}
