//! Replays the recording of any controller's loop.

use std::path::PathBuf;
use std::time::Duration;

use fcc_core::framework::Controller;
use fcc_record::About;
use fcc_replay::{Chain, Identity, Replay, Replayed};
use fcc_runtime::LoopConfig;
use pyo3::prelude::*;
use serde::Serialize;

use crate::{errors, json};

/// Replays a recording by the controller that recorded it, and compares every
/// value of every tick; a dict with `identical`, and the differences.
///
/// # Errors
/// When a file cannot be read.
pub fn replay<'py, C: Controller>(
    py: Python<'py>,
    files: &[PathBuf],
    controller: impl FnOnce(&About) -> C + Send,
    config: &LoopConfig,
) -> PyResult<Bound<'py, PyAny>> {
    #[derive(Serialize)]
    struct Compared {
        #[serde(flatten)]
        replayed: Replayed,
        identical: bool,
        identity: Identity,
    }
    let compared = py.detach(|| -> Result<Compared, String> {
        let chain = Chain::open(files).map_err(|error| error.to_string())?;
        let period = Duration::try_from_secs_f64(1.0 / chain.about().rate_hz)
            .map_err(|error| error.to_string())?;
        let replay = Replay::new(controller(chain.about()), period, config)
            .map_err(|error| error.to_string())?;
        let mut identity = Identity::of::<C>();
        let compare = |recorded: &_, again: &_| identity.take(recorded, again);
        Ok(Compared {
            replayed: chain.replay(replay, compare, |_| {}),
            identical: identity.is_identical(),
            identity,
        })
    });
    json::to_python(
        py,
        &compared.map_err(|words| errors::RECORDING.with(words))?,
    )
}
