//! Replays the recording of any controller's loop.

use std::path::PathBuf;
use std::time::Duration;

use fcc_core::framework::Controller;
use fcc_replay::{Chain, Deviation, Identity, Replay, Replayed};
use fcc_runtime::LoopConfig;
use fcc_telemetry::Telemetry;
use pyo3::prelude::*;
use serde::Serialize;

use crate::{errors, json};

/// Replays a recording, a file or its parts, oldest first, by the loop that
/// `make` gives. By the same configuration, every value of every tick is
/// compared, and the dict says in `identical` whether none differs; by another,
/// the dict says where it deviates.
///
/// # Errors
/// When a file cannot be read, or is of another plant.
pub fn replay<'py, C: Telemetry>(
    paths: &Bound<'py, PyAny>,
    is_same: bool,
    make: impl FnOnce(&Chain) -> Result<Replay<C>, String> + Send,
) -> PyResult<Bound<'py, PyAny>> {
    #[derive(Serialize)]
    struct Compared {
        #[serde(flatten)]
        replayed: Replayed,
        identical: Option<bool>,
        identity: Option<Identity>,
        deviation: Option<Deviation>,
    }
    let py = paths.py();
    let paths: Vec<PathBuf> = match paths.extract::<PathBuf>() {
        Ok(one) => vec![one],
        Err(_) => paths.extract()?,
    };
    let compared = py.detach(|| -> Result<Compared, String> {
        let chain = Chain::open::<C>(&paths).map_err(|error| error.to_string())?;
        let mut replay = make(&chain)?;
        let mut identity = is_same.then(Identity::of::<C>);
        let mut deviation = (!is_same).then(Deviation::of::<C>);
        let compare = |recorded: &_, again: &_| {
            if let Some(identity) = &mut identity {
                identity.take(recorded, again);
            }
            if let Some(deviation) = &mut deviation {
                deviation.take(recorded, again);
            }
        };
        Ok(Compared {
            replayed: chain.replay(&mut replay, compare, |_| {}),
            identical: identity.as_ref().map(Identity::is_identical),
            identity,
            deviation,
        })
    });
    json::to_python(
        py,
        &compared.map_err(|words| errors::RECORDING.with(words))?,
    )
}

/// A loop of this controller at the recorded rate.
///
/// # Errors
/// Why there is none, as text.
pub fn loop_of<C: Controller>(
    chain: &Chain,
    controller: C,
    config: &LoopConfig,
) -> Result<Replay<C>, String> {
    let period = Duration::try_from_secs_f64(1.0 / chain.about().rate_hz);
    let period = period.map_err(|error| error.to_string())?;
    Replay::new(controller, period, config).map_err(|error| error.to_string())
}
