//! The thread that writes a servo's pulses.

use core::sync::atomic::{AtomicBool, AtomicI32, AtomicU8, AtomicU64, Ordering};
use core::time::Duration;
use std::io;
use std::sync::{Arc, OnceLock};
use std::thread;
use std::time::Instant;

use fcc_core::flight::Surfaces;
use fcc_core::framework::{PlantId, TakeoverNotice};
use rtrb::{Consumer, RingBuffer};
use serde::{Deserialize, Serialize};

use super::{Drives, ServoActuator, ServoChannel};
use crate::{DeviceError, DeviceStatus};

/// Orders that fit between the loop and the thread: it falls behind only while a
/// bus hangs.
const CAPACITY: usize = 64;
const STACK_BYTES: usize = 256 * 1024;
/// Pulses that do not change are repeated, so that a bus that is gone is noticed.
const REPEATED_EVERY: Duration = Duration::from_secs(1);
/// The pause before a bus is opened again.
const OPENED_EVERY: Duration = Duration::from_millis(100);

/// Where pulses are written: outputs in the order of the channels.
pub trait PulseOutputs: Send {
    /// Writes the pulses, µs; none is an output that is off. May wait, in a thread
    /// of its own.
    ///
    /// # Errors
    /// When not all were written: the outputs are closed, and opened anew.
    fn write(&mut self, pulses_us: &[Option<f64>]) -> Result<(), DeviceError>;
}

/// An output that changes while the loop has control, for a multiplexer that gives
/// the servos back to the pilot when it does not.
pub trait HeartbeatLine: Send {
    /// Sets its level.
    ///
    /// # Errors
    /// When it cannot be set.
    fn set(&mut self, is_high: bool) -> Result<(), DeviceError>;
}

/// What is opened, and opened anew after an error.
pub struct ServoBus {
    /// The servos' outputs.
    pub outputs: Box<dyn PulseOutputs>,
    /// For a multiplexer.
    pub heartbeat: Option<Box<dyn HeartbeatLine>>,
}

/// What servos do while nobody has control.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Released {
    /// They hold their failsafe positions.
    Failsafe,
    /// They get no pulse: most servos give way, most motor controllers stop.
    Off,
}

/// Servos, and what holds for all of them.
#[derive(Clone, PartialEq, Debug)]
pub struct ServoSettings {
    /// In the order of the outputs.
    pub channels: Vec<ServoChannel>,
    /// When nobody has control.
    pub released: Released,
    /// After so long without outputs of a loop that has control, failsafe.
    pub silent_after: Duration,
    /// The least time between two changes of the heartbeat.
    pub heartbeat_every: Duration,
}

impl ServoSettings {
    /// Holds failsafe positions when released, and after 200 ms of silence; the
    /// heartbeat changes 50 times a second at most.
    pub const fn new(channels: Vec<ServoChannel>) -> Self {
        Self {
            channels,
            released: Released::Failsafe,
            silent_after: Duration::from_millis(200),
            heartbeat_every: Duration::from_millis(20),
        }
    }

    /// The pulses while nobody has control, µs.
    pub fn released_pulses(&self) -> Vec<Option<f64>> {
        let pulse = |channel: &ServoChannel| match self.released {
            Released::Failsafe => Some(channel.pulse_us(channel.failsafe)),
            Released::Off => None,
        };
        self.channels.iter().map(pulse).collect()
    }
}

/// What the loop wants.
#[derive(Clone, Copy, Debug)]
pub(super) enum Order {
    Apply(Surfaces),
    Release,
}

/// What both ends see.
#[derive(Debug)]
pub(super) struct Shared {
    /// [`CONNECTED`], [`NOT_OPEN`] or an error number.
    pub(super) state: AtomicI32,
    /// How many orders were handed over, and how many of them were taken.
    pub(super) given: AtomicU64,
    pub(super) taken: AtomicU64,
    pub(super) end: AtomicBool,
    /// Whether the loop wants control, and whether pulses of its outputs were, or
    /// are being, written since the last release.
    pub(super) is_wanted: AtomicBool,
    pub(super) is_driven: AtomicBool,
    /// [`PERMITTED`] or [`PERMITTED_AFTER_CHECK`].
    pub(super) permission: AtomicU8,
    /// Is told before control is taken.
    pub(super) notice: OnceLock<(&'static dyn TakeoverNotice, PlantId)>,
}

impl Shared {
    /// Whether the loop has control, or its last pulses may still be there.
    pub(super) fn is_held(&self) -> bool {
        self.is_wanted.load(Ordering::SeqCst) || self.is_driven.load(Ordering::SeqCst)
    }
}

pub(super) const PERMITTED: u8 = 0;
/// Not yet.
pub(super) const PERMITTED_AFTER_CHECK: u8 = 1;

pub(super) const CONNECTED: i32 = 0;
pub(super) const NOT_OPEN: i32 = -1;

const THREAD: &str = "servos";

/// How the thread of servos is started.
#[derive(Clone, Debug)]
pub struct ServoThread {
    name: String,
    settings: ServoSettings,
    pause: Duration,
    status: DeviceStatus,
}

impl ServoThread {
    /// A thread for servos with this name, which is that of their actuator.
    pub fn new(name: impl Into<String>, settings: ServoSettings) -> Self {
        Self {
            name: name.into(),
            settings,
            pause: OPENED_EVERY,
            status: DeviceStatus::default(),
        }
    }

    /// The pause before outputs are opened again, 100 ms by default.
    #[must_use]
    pub const fn pause(mut self, pause: Duration) -> Self {
        self.pause = pause;
        self
    }

    /// What is wrong with the outputs, for outside of the loop.
    pub fn status(&self) -> DeviceStatus {
        self.status.clone()
    }

    /// Starts the thread, which opens the outputs.
    ///
    /// # Errors
    /// When the thread cannot be started.
    pub fn start(
        self,
        open: impl FnMut() -> Result<ServoBus, DeviceError> + Send + 'static,
    ) -> io::Result<ServoActuator> {
        let (orders, taking) = RingBuffer::new(CAPACITY);
        let shared = Arc::new(Shared {
            state: AtomicI32::new(NOT_OPEN),
            given: AtomicU64::new(0),
            taken: AtomicU64::new(0),
            end: AtomicBool::new(false),
            is_wanted: AtomicBool::new(false),
            is_driven: AtomicBool::new(false),
            permission: AtomicU8::new(PERMITTED),
            notice: OnceLock::new(),
        });
        let writer = Writer {
            wanted: Wanted::Released,
            positions: self.settings.channels.iter().map(|c| c.failsafe).collect(),
            pulses: vec![None; self.settings.channels.len()],
            heard: Instant::now(),
            stepped: Instant::now(),
            written: Instant::now(),
            beat: Instant::now(),
            is_high: false,
            bus: None,
            tried: None,
            open,
            orders: taking,
            shared: Arc::clone(&shared),
            settings: self.settings,
            pause: self.pause,
            status: self.status,
        };
        let thread = thread::Builder::new()
            .name(THREAD.to_owned())
            .stack_size(STACK_BYTES)
            .spawn(move || writer.run())?;
        Ok(ServoActuator::new(self.name, orders, shared, thread))
    }
}

#[derive(Clone, Copy)]
enum Wanted {
    Released,
    Followed(Surfaces),
    /// The loop has control, and is silent.
    Failsafe,
}

struct Writer<O> {
    wanted: Wanted,
    positions: Vec<f64>,
    pulses: Vec<Option<f64>>,
    heard: Instant,
    /// When the positions followed new outputs.
    stepped: Instant,
    written: Instant,
    beat: Instant,
    is_high: bool,
    bus: Option<ServoBus>,
    /// When it was tried last; none before the first time.
    tried: Option<Instant>,
    open: O,
    orders: Consumer<Order>,
    shared: Arc<Shared>,
    settings: ServoSettings,
    pause: Duration,
    status: DeviceStatus,
}

impl<O: FnMut() -> Result<ServoBus, DeviceError>> Writer<O> {
    fn run(mut self) {
        loop {
            let is_ending = self.shared.end.load(Ordering::Acquire);
            let taken = self.take_orders();
            if is_ending {
                (self.wanted, self.tried) = (Wanted::Released, None);
            } else if self.silent_in().is_zero() {
                self.wanted = Wanted::Failsafe;
            }
            let written = self.open_and_write(taken > 0);
            self.report(written.as_ref().err());
            if written.is_ok() && self.bus.is_some() && matches!(self.wanted, Wanted::Released) {
                self.shared.is_driven.store(false, Ordering::SeqCst);
            }
            self.shared.taken.fetch_add(taken, Ordering::Release);
            if is_ending {
                return;
            }
            thread::park_timeout(self.until_next());
        }
    }

    /// The latest order holds; how many there were.
    fn take_orders(&mut self) -> u64 {
        let mut taken = 0;
        while let Ok(order) = self.orders.pop() {
            self.wanted = match order {
                Order::Apply(surfaces) => {
                    self.shared.is_driven.store(true, Ordering::SeqCst);
                    Wanted::Followed(surfaces)
                }
                Order::Release => Wanted::Released,
            };
            self.heard = Instant::now();
            taken += 1;
        }
        taken
    }

    /// When the loop will count as silent, if it says nothing until then.
    fn silent_in(&self) -> Duration {
        match self.wanted {
            Wanted::Followed(_) => {
                let silent_after = self.settings.silent_after;
                silent_after.saturating_sub(self.heard.elapsed())
            }
            Wanted::Released | Wanted::Failsafe => Duration::MAX,
        }
    }

    fn until_next(&self) -> Duration {
        let regular = match self.bus {
            Some(_) => REPEATED_EVERY,
            None => self.pause,
        };
        regular.min(self.silent_in())
    }

    fn open_and_write(&mut self, is_new: bool) -> Result<(), DeviceError> {
        let is_open = self.bus.is_some();
        if !is_open {
            let waits = |tried: Instant| tried.elapsed() < self.pause;
            if self.tried.is_some_and(waits) {
                return Ok(());
            }
            self.tried = Some(Instant::now());
            self.bus = Some((self.open)()?);
        }
        let has_changed = self.update(is_new);
        let is_due = self.written.elapsed() >= REPEATED_EVERY;
        if has_changed || is_due || !is_open {
            self.write()?;
        }
        self.beat(is_new)
    }

    /// The pulses of now; whether they are others than before.
    fn update(&mut self, is_new: bool) -> bool {
        // After a pause it moves on as slowly as after the shortest.
        let passed_s = self
            .stepped
            .elapsed()
            .min(self.settings.silent_after)
            .as_secs_f64();
        if is_new {
            self.stepped = Instant::now();
        }
        let mut has_changed = false;
        let channels = self.settings.channels.iter();
        let parts = channels.zip(&mut self.positions).zip(&mut self.pulses);
        for ((channel, position), pulse) in parts {
            *position = match &self.wanted {
                Wanted::Followed(surfaces) if is_new => {
                    channel.towards(*position, surfaces, passed_s)
                }
                Wanted::Followed(_) => *position,
                // An engine must not run before the loop engages, or after its release.
                Wanted::Released if channel.drives == Drives::Throttle => 0.0,
                Wanted::Released | Wanted::Failsafe => channel.failsafe,
            };
            let is_off =
                matches!(self.wanted, Wanted::Released) && self.settings.released == Released::Off;
            let now = (!is_off).then(|| channel.pulse_us(*position));
            has_changed |= now != *pulse;
            *pulse = now;
        }
        has_changed
    }

    fn write(&mut self) -> Result<(), DeviceError> {
        if let Some(bus) = &mut self.bus {
            bus.outputs.write(&self.pulses)?;
        }
        self.written = Instant::now();
        Ok(())
    }

    /// Changes the heartbeat for new outputs that were written; without control it
    /// is low.
    fn beat(&mut self, is_new: bool) -> Result<(), DeviceError> {
        let is_followed = matches!(self.wanted, Wanted::Followed(_));
        let is_due = is_new && self.beat.elapsed() >= self.settings.heartbeat_every;
        let is_high = if is_followed {
            self.is_high ^ is_due
        } else {
            false
        };
        let line = self.bus.as_mut().and_then(|bus| bus.heartbeat.as_mut());
        if let Some(line) = line.filter(|_| is_high != self.is_high) {
            line.set(is_high)?;
            (self.is_high, self.beat) = (is_high, Instant::now());
        }
        Ok(())
    }

    fn report(&mut self, error: Option<&DeviceError>) {
        let state = match error {
            None if self.bus.is_some() => CONNECTED,
            None => return,
            Some(error) => error.errno(),
        };
        self.shared.state.store(state, Ordering::Release);
        self.status.set(error);
        if error.is_some() {
            self.bus = None;
            self.tried = Some(Instant::now());
        }
    }
}
