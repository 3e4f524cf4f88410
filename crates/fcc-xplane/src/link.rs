//! The state shared by the sensor, the actuator and status readers: atomics, no
//! lock.
//!
//! Sensor and actuator usually run in one thread and never race. The atomics
//! are for readers in other threads, and allow the two to run in separate
//! threads.

mod ports;

use core::sync::atomic::{AtomicBool, AtomicU8, AtomicU16, AtomicU32, AtomicU64, Ordering};
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use fcc_core::framework::TakeoverNotice;

use crate::beacon_group::BeaconGroup;
use crate::counters::Counters;
use crate::missing::ValueSet;
use crate::readbacks::Readbacks;
use crate::sent_yoke::SentYoke;
use crate::shared_address::SharedAddress;
use crate::simulator::SimulatorState;
use crate::source_filter::SourceFilter;

/// Who has the controls, as far as this program knows.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum Control {
    /// The simulator's pilot.
    Free = 0,
    /// The actuator: overrides are set.
    Held = 1,
    /// Released, but X-Plane has not yet confirmed that the overrides are
    /// cleared.
    ReleaseMonitor = 2,
}

#[derive(Debug)]
pub(crate) struct SharedState {
    pub(crate) address: SharedAddress,
    /// The simulator's port that answered last, 0 while unknown.
    reply_port: AtomicU16,
    /// The port that answered when control was taken, or in its place one of
    /// the simulator started again; 0 while nothing is held.
    flown_port: AtomicU16,
    /// The port that is received on here, 0 while unknown.
    local_port: AtomicU16,
    /// Each [`Ports`], of 16 bits each.
    delivered_ports: AtomicU64,
    held_ports: AtomicU64,
    gone_ports: AtomicU64,
    /// Whether all ports that are gone are known.
    is_gone_known: AtomicBool,
    /// Nothing comes from a port any more, or none is known.
    is_port_silent: AtomicBool,
    filter: OnceLock<SourceFilter>,
    beacon_group: OnceLock<BeaconGroup>,
    /// Further connections to read, without a watch of their own; not used in a
    /// tick.
    beside: Mutex<Vec<Arc<Self>>>,
    state: AtomicU8,
    control: AtomicU8,
    /// A confirmed release of this program's may still be undone by a late write.
    may_be_undone: AtomicBool,
    /// Another simulator that announced itself while this one was held.
    announced: SharedAddress,
    /// Both overrides were read as cleared, once.
    maybe_reloaded: AtomicBool,
    unconfirmed: AtomicBool,
    /// An override is set, not by this program.
    left_overridden: AtomicBool,
    axial_backwards: AtomicBool,
    answers_anything: AtomicBool,
    version: AtomicU32,
    /// A [`ValueSet`].
    missing: AtomicU64,
    /// An f32, s.
    frame_period: AtomicU32,
    /// 0 not known, 1 in the air, 2 on the ground.
    ground: AtomicU8,
    pub(crate) read_back: Readbacks,
    pub(crate) sent_yoke: SentYoke,
    /// Is told before control is taken.
    notice: OnceLock<&'static dyn TakeoverNotice>,
    pub(crate) counters: Counters,
}

impl SharedState {
    pub(crate) fn new(simulator: Option<SocketAddr>) -> Self {
        Self {
            address: SharedAddress::new(simulator),
            reply_port: AtomicU16::new(0),
            flown_port: AtomicU16::new(0),
            local_port: AtomicU16::new(0),
            delivered_ports: AtomicU64::new(0),
            held_ports: AtomicU64::new(0),
            gone_ports: AtomicU64::new(0),
            is_gone_known: AtomicBool::new(false),
            is_port_silent: AtomicBool::new(true),
            filter: OnceLock::new(),
            beacon_group: OnceLock::new(),
            beside: Mutex::new(Vec::new()),
            state: AtomicU8::new(SimulatorState::Silent as u8),
            control: AtomicU8::new(Control::Free as u8),
            may_be_undone: AtomicBool::new(false),
            announced: SharedAddress::new(None),
            maybe_reloaded: AtomicBool::new(false),
            unconfirmed: AtomicBool::new(false),
            left_overridden: AtomicBool::new(false),
            axial_backwards: AtomicBool::new(false),
            answers_anything: AtomicBool::new(false),
            version: AtomicU32::new(0),
            missing: AtomicU64::new(0),
            frame_period: AtomicU32::new(0),
            ground: AtomicU8::new(0),
            read_back: Readbacks::never(),
            sent_yoke: SentYoke::new(),
            notice: OnceLock::new(),
            counters: Counters::default(),
        }
    }

    /// Only the first one counts.
    pub(crate) fn notify(&self, notice: &'static dyn TakeoverNotice) {
        let _ = self.notice.set(notice);
    }

    pub(crate) fn notice(&self) -> Option<&'static dyn TakeoverNotice> {
        self.notice.get().copied()
    }

    /// Another connection is watched together with this one.
    pub(crate) fn add_beside(&self, link: Arc<Self>) {
        let mut beside = self.beside.lock().unwrap_or_else(PoisonError::into_inner);
        beside.push(link);
    }

    pub(crate) fn beside(&self) -> Vec<Arc<Self>> {
        let beside = self.beside.lock().unwrap_or_else(PoisonError::into_inner);
        beside.clone()
    }

    pub(crate) fn state(&self) -> SimulatorState {
        SimulatorState::from_number(self.state.load(Ordering::Relaxed))
    }

    pub(crate) fn set_state(&self, state: SimulatorState) {
        self.state.store(state as u8, Ordering::Relaxed);
    }

    pub(crate) fn control(&self) -> Control {
        match self.control.load(Ordering::Acquire) {
            1 => Control::Held,
            2 => Control::ReleaseMonitor,
            _ => Control::Free,
        }
    }

    pub(crate) fn set_control(&self, control: Control) {
        self.control.store(control as u8, Ordering::Release);
    }

    /// Whether a confirmed release of this program's may still be undone by a
    /// late write of its own.
    pub(crate) fn may_be_undone(&self) -> bool {
        self.may_be_undone.load(Ordering::Relaxed)
    }

    pub(crate) fn set_may_be_undone(&self, may: bool) {
        self.may_be_undone.store(may, Ordering::Relaxed);
    }

    /// Whether the controls are held, or their release is not yet confirmed, or may
    /// still be undone.
    pub(crate) fn is_held(&self) -> bool {
        self.control() != Control::Free || self.may_be_undone()
    }

    /// Another simulator that announced itself while this one is held.
    pub(crate) fn announced(&self) -> Option<SocketAddr> {
        self.announced.simulator()
    }

    pub(crate) fn set_announced(&self, address: SocketAddr) {
        self.announced.set_simulator(address);
    }

    pub(crate) fn forget_announced(&self) {
        self.announced.forget();
    }

    /// Another simulator takes the place of this one, whose controls are free.
    pub(crate) fn change_simulator(&self, address: SocketAddr) {
        self.reply_port.store(0, Ordering::Relaxed);
        self.address.set_simulator(address);
    }

    /// The simulator no longer exists, and another one waits: what was released is
    /// free. Returns whether it is.
    pub(crate) fn free_if_gone(&self) -> bool {
        let waits = self.announced().is_some() && self.control() != Control::Held;
        if waits {
            self.set_free_if_releasing();
            self.set_may_be_undone(false);
        }
        waits
    }

    /// `Free` becomes `ReleaseMonitor`: another program's overrides are cleared.
    pub(crate) fn set_releasing_if_free(&self) {
        self.change_control(Control::Free, Control::ReleaseMonitor);
    }

    /// `ReleaseMonitor` becomes `Free`, unless control was taken again meanwhile.
    pub(crate) fn set_free_if_releasing(&self) {
        self.change_control(Control::ReleaseMonitor, Control::Free);
    }

    fn change_control(&self, from: Control, to: Control) {
        let (from, to) = (from as u8, to as u8);
        // If the exchange fails, there is nothing to do.
        let _ = self
            .control
            .compare_exchange(from, to, Ordering::AcqRel, Ordering::Acquire);
    }

    /// Whether both overrides were read as cleared, once.
    pub(crate) fn is_maybe_reloaded(&self) -> bool {
        self.maybe_reloaded.load(Ordering::Relaxed)
    }

    pub(crate) fn set_maybe_reloaded(&self, maybe: bool) {
        self.maybe_reloaded.store(maybe, Ordering::Relaxed);
    }

    pub(crate) fn is_unconfirmed(&self) -> bool {
        self.unconfirmed.load(Ordering::Relaxed)
    }

    pub(crate) fn set_unconfirmed(&self, unconfirmed: bool) {
        self.unconfirmed.store(unconfirmed, Ordering::Relaxed);
    }

    /// Whether an override is set, not by this program.
    pub(crate) fn is_left_overridden(&self) -> bool {
        self.left_overridden.load(Ordering::Relaxed)
    }

    pub(crate) fn set_left_overridden(&self, left: bool) {
        self.left_overridden.store(left, Ordering::Relaxed);
    }

    /// Whether the axial load in row 4 is positive backwards.
    pub(crate) fn is_axial_backwards(&self) -> bool {
        self.axial_backwards.load(Ordering::Relaxed)
    }

    pub(crate) fn set_axial_backwards(&self, backwards: bool) {
        self.axial_backwards.store(backwards, Ordering::Relaxed);
    }

    /// Whether the simulator answers requests for datarefs that it does not have.
    pub(crate) fn answers_anything(&self) -> bool {
        self.answers_anything.load(Ordering::Relaxed)
    }

    pub(crate) fn set_answers_anything(&self) {
        self.answers_anything.store(true, Ordering::Relaxed);
    }

    pub(crate) fn missing(&self) -> ValueSet {
        ValueSet::from_bits(self.missing.load(Ordering::Relaxed))
    }

    pub(crate) fn set_missing(&self, missing: ValueSet) {
        self.missing.store(missing.bits(), Ordering::Relaxed);
    }

    pub(crate) fn version(&self) -> Option<u32> {
        match self.version.load(Ordering::Relaxed) {
            0 => None,
            version => Some(version),
        }
    }

    pub(crate) fn set_version(&self, version: u32) {
        self.version.store(version, Ordering::Relaxed);
    }

    /// The simulator's last frame period, s; 0 until it is known.
    pub(crate) fn frame_period_s(&self) -> f64 {
        f32::from_bits(self.frame_period.load(Ordering::Relaxed)).into()
    }

    pub(crate) fn set_frame_period_s(&self, frame_period_s: f64) {
        let bits = (frame_period_s as f32).to_bits();
        self.frame_period.store(bits, Ordering::Relaxed);
    }

    pub(crate) fn on_ground(&self) -> Option<bool> {
        match self.ground.load(Ordering::Relaxed) {
            0 => None,
            ground => Some(ground == 2),
        }
    }

    pub(crate) fn set_on_ground(&self, on_ground: bool) {
        self.ground
            .store(1 + u8::from(on_ground), Ordering::Relaxed);
    }
}
