//! What all requests share.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;

use axum::http::StatusCode;
use fcc_telemetry::Instance;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use crate::calibration::Calibration;
use crate::daemon_config::DaemonConfigs;
use crate::drafts::Drafts;
use crate::failure::Failure;
use crate::flights::summaries::Summaries;
use crate::hosts::Hosts;
use crate::live::{Daemons, Feed, Machine};
use crate::map_file::MapFile;
use crate::orders::Orders;
use crate::token::Token;

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
    pub(crate) map: Option<MapFile>,
    pub(crate) configs: DaemonConfigs,
    pub(crate) daemons: Daemons,
    pub(crate) machine: Machine,
    pub(crate) drafts: Drafts,
    pub(crate) orders: Orders,
    pub(crate) calibration: Calibration,
    pub(crate) flights: Summaries,
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

/// Everything that requests share, put together.
pub(crate) fn station(
    token: Token,
    hosts: Hosts,
    folders: (PathBuf, PathBuf),
    fccd: PathBuf,
    (restarts, foxglove): (bool, bool),
    map: Option<MapFile>,
    configs: DaemonConfigs,
) -> Result<Arc<Station>, String> {
    let (recordings, state) = folders;
    let machine = Machine::new(recordings.clone());
    Ok(Arc::new(Station {
        token,
        hosts,
        daemons: Daemons::start(&machine)?,
        drafts: Drafts::new(state.join("drafts")).map_err(|error| error.to_string())?,
        flights: Summaries::new(state.join("summaries")),
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
