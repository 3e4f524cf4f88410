//! The daemon as a process: what a flight needs of the program around it.
//!
//! | module | what it does |
//! |---|---|
//! | `guard`, `relief` | a second process that gives controls back if this one is killed |
//! | `instance_lock` | keeps two daemons from one plant |
//! | `signals` | the signals that end a flight |

mod guard;
mod instance_lock;
mod relief;
mod signals;

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use fcc_core::framework::{ControlAuthority, PlantId};
use fcc_flight::config::Config;
use fcc_flight::flight::Host;
use fcc_runtime::StopHandle;

use crate::exit::Exit;
use crate::output;
use guard::Guard;
pub(crate) use guard::run_release_helper;
use instance_lock::InstanceLock;
use signals::Kept;

/// While control is held, it is looked this often for a guard of an earlier
/// daemon that gives it away; looking is one refused connection.
const RELIEVE_EVERY: Duration = Duration::from_secs(1);

/// This process, as the host of one flight.
pub(crate) struct Process<'a> {
    config: &'a Config,
    held_signals: Option<Kept>,
    interrupted: Arc<AtomicBool>,
    plant: Option<Plant>,
}

/// What outlives the process, or other processes may have.
struct Plant {
    authority: Arc<dyn ControlAuthority>,
    lock: InstanceLock,
    guard: Option<Guard>,
    /// When a guard was last looked for.
    relieved: Instant,
}

impl<'a> Process<'a> {
    /// For a flight by this configuration.
    pub(crate) fn new(config: &'a Config) -> Self {
        Self {
            config,
            held_signals: None,
            interrupted: Arc::default(),
            plant: None,
        }
    }
}

impl Host for Process<'_> {
    fn prepare(&mut self, authority: Option<&Arc<dyn ControlAuthority>>) -> io::Result<()> {
        let lock = authority.map(|authority| InstanceLock::of(Arc::clone(authority)));
        self.held_signals = Some(Kept::from_new_threads().map_err(|error| uncaught(&error))?);
        self.plant = authority.zip(lock).map(|(authority, lock)| Plant {
            authority: Arc::clone(authority),
            guard: lock.taken().is_none().then(|| guard(self.config)).flatten(),
            lock,
            relieved: Instant::now(),
        });
        Ok(())
    }

    fn attach(&mut self, stop: &StopHandle) -> io::Result<()> {
        self.interrupted = signals::stop_by(stop).map_err(|error| uncaught(&error))?;
        Ok(())
    }

    fn started(&mut self) {
        self.held_signals = None;
    }

    fn poll(&mut self) {
        if let Some(plant) = &mut self.plant {
            plant.lock.follow();
            let held = plant.authority.held();
            if held.is_some() && plant.relieved.elapsed() >= RELIEVE_EVERY {
                plant.relieve_guard();
            }
            if let Some(guard) = &mut plant.guard {
                guard.tell(held);
            }
        }
    }

    fn taken_by_another(&self) -> Option<PlantId> {
        self.plant.as_ref()?.lock.taken()
    }

    fn before_control(&mut self) {
        if let Some(plant) = &mut self.plant {
            plant.relieve_guard();
        }
    }

    /// At once, as a crash would: what runs at an orderly exit may wait for a
    /// thread that hangs, and has had its time.
    fn last_resort(&self) -> Box<dyn FnOnce(bool) + Send> {
        Box::new(|released| {
            let exit = if released {
                Exit::Hung
            } else {
                Exit::NotReleased
            };
            signal_hook::low_level::exit(i32::from(exit as u8));
        })
    }

    fn continues_release(&self) -> &'static str {
        match &self.plant {
            Some(Plant { guard: Some(_), .. }) => {
                "; the guard process goes on trying for two minutes"
            }
            _ => "",
        }
    }

    /// A guard that is not dismissed sees the pipe end, and goes on trying.
    fn end(&mut self, released: bool) {
        let guard = self.plant.as_mut().and_then(|plant| plant.guard.take());
        if let Some(guard) = guard.filter(|_| released) {
            guard.dismiss();
        }
    }

    fn was_interrupted(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }
}

impl Plant {
    /// Sends away the guard of a daemon that was killed, if one still releases
    /// the controls that are, or are to be, held here.
    fn relieve_guard(&mut self) {
        self.relieved = Instant::now();
        if let Some(plant) = self.authority.plant() {
            relief::relieve(&plant);
        }
    }
}

/// Without a guard the flight goes on, and says so.
fn guard(config: &Config) -> Option<Guard> {
    Guard::start(config)
        .inspect_err(|error| {
            output::message(format!(
                "no guard process ({error}): if this process is killed, release the controls by \
                 hand"
            ));
        })
        .ok()
}

fn uncaught(error: &io::Error) -> io::Error {
    io::Error::new(error.kind(), format!("signals cannot be caught: {error}"))
}
