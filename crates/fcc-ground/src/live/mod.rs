//! Live telemetry: of every daemon of this user, encoded once for all pages.
//!
//! ```text
//! shared memory ─► a thread for each daemon ─► Feed ─► newest record, status ─► pages
//!                                                └──► events ───────────────► pages
//! ```
//!
//! A page that reads slowly gets the newest record when it has read the one before.

mod feed;
mod foxglove;
mod machine;
mod socket;
mod track;

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use fcc_live::running;
use fcc_telemetry::{Instance, not_started};

pub(crate) use feed::{Feed, Newest};
pub(crate) use foxglove::socket as foxglove_socket;
pub(crate) use machine::Machine;
pub(crate) use socket::{PATIENCE, PING_EVERY, columns, socket};

/// How often it is looked for daemons that have started.
const LOOK_EVERY: Duration = Duration::from_millis(250);
/// One that could not be watched is tried again after this time.
const AGAIN_AFTER: Duration = Duration::from_secs(2);

/// The daemons that are watched now.
#[derive(Clone, Debug, Default)]
pub(crate) struct Daemons(Arc<Mutex<Watched>>);

#[derive(Debug, Default)]
struct Watched {
    feeds: BTreeMap<Instance, Arc<Feed>>,
    /// Why one is not watched, and since when.
    refused: BTreeMap<Instance, (String, Instant)>,
}

impl Daemons {
    /// Watches every daemon of this user, from now on, until this is dropped.
    pub(crate) fn start(machine: &Machine) -> Result<Self, String> {
        let daemons = Self::default();
        let (watched, machine) = (Arc::downgrade(&daemons.0), machine.clone());
        thread::Builder::new()
            .name("ground-daemons".to_owned())
            .spawn(move || {
                // Until the station is dropped.
                while let Some(watched) = watched.upgrade() {
                    Self(watched).look(&machine);
                    thread::sleep(LOOK_EVERY);
                }
            })
            .map_err(|error| not_started(error).to_string())?;
        Ok(daemons)
    }

    fn locked(&self) -> MutexGuard<'_, Watched> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn feed(&self, instance: &Instance) -> Option<Arc<Feed>> {
        self.locked().feeds.get(instance).cloned()
    }

    pub(crate) fn feeds(&self) -> Vec<Arc<Feed>> {
        self.locked().feeds.values().cloned().collect()
    }

    /// The daemons that run and cannot be watched, and why.
    pub(crate) fn refused(&self) -> Vec<(Instance, String)> {
        let watched = self.locked();
        let refused = watched.refused.iter();
        refused
            .map(|(instance, (why, _))| (instance.clone(), why.clone()))
            .collect()
    }

    fn look(&self, machine: &Machine) {
        let running = running();
        let new: Vec<Instance> = {
            let mut watched = self.locked();
            watched.feeds.retain(|_, feed| !feed.has_ended());
            watched
                .refused
                .retain(|instance, _| running.contains(instance));
            let is_new = |instance: &Instance| {
                let refused = watched.refused.get(instance);
                !watched.feeds.contains_key(instance)
                    && refused.is_none_or(|(_, since)| since.elapsed() > AGAIN_AFTER)
            };
            running.into_iter().filter(is_new).collect()
        };
        for instance in new {
            let started = Feed::start(&instance, machine.clone());
            let mut watched = self.locked();
            match started {
                Ok(feed) => {
                    watched.refused.remove(&instance);
                    watched.feeds.insert(instance, feed);
                }
                Err(why) => {
                    watched.refused.insert(instance, (why, Instant::now()));
                }
            }
        }
    }
}
