//! Whether a new watcher would find what is published: who publishes watches
//! itself.

use std::time::Duration;

use iceoryx2::prelude::PortFactory;

use super::place::{Presence, look};
use super::row_watcher::{newest, subscribe};
use super::services::{self, Access, INFO, RECORD};
use super::space;
use super::{Info, WatchError};
use fcc_telemetry::Instance;

const LOOK_EVERY: Duration = Duration::from_millis(5);

/// Whether a new watcher finds what is published, or there is no room for one;
/// waits for it while `goes_on`, which is called every few milliseconds once it
/// watches.
pub(super) fn is_offered(instance: &Instance, goes_on: impl FnMut() -> bool) -> bool {
    let Presence::Here(place) = look(instance) else {
        return false;
    };
    if space::too_little(place.root.as_path(), space::NEEDED_BYTES).is_some() {
        return true;
    }
    let Ok(access) = services::access(&place.root) else {
        return false;
    };
    match finds_records(&access, instance, goes_on) {
        Ok(is_found) => is_found,
        Err(error) => matches!(error, WatchError::TooMany(_)),
    }
}

fn finds_records(
    access: &Access,
    instance: &Instance,
    mut goes_on: impl FnMut() -> bool,
) -> Result<bool, WatchError> {
    let infos = subscribe(&INFO.watch::<Info>(access, instance)?, instance)?;
    loop {
        // In this order: this thread may get no time in between, and the one that
        // publishes enough.
        let is_last = !goes_on();
        if newest(&infos)?.is_some() {
            break;
        }
        if is_last {
            return Ok(false);
        }
        std::thread::sleep(LOOK_EVERY);
    }
    let records = RECORD.watch_slices::<u64>(access, instance)?;
    Ok(records.dynamic_config().number_of_publishers() == 1)
}
