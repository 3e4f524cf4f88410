//! The state shared by the sensor, the actuator and status readers: atomics, no
//! lock.
//!
//! Sensor and actuator usually run in one thread and never race. The atomics
//! are for readers in other threads, and allow the two to run in separate
//! threads.

use core::sync::atomic::{
    AtomicBool, AtomicI64, AtomicU8, AtomicU16, AtomicU32, AtomicU64, Ordering,
};
use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4};
use std::sync::OnceLock;

use fcc_core::framework::{TakeoverNotice, Time};

use crate::missing::ValueSet;
use crate::quantity::Quantity;
use crate::simulator::SimulatorState;

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

/// A value reported by the simulator and its time.
#[derive(Debug)]
struct Readback {
    bits: AtomicU32,
    at: AtomicI64,
}

impl Readback {
    const fn never() -> Self {
        Self {
            bits: AtomicU32::new(0),
            at: AtomicI64::new(Time::NEVER.as_nanos()),
        }
    }
}

/// The quantities that are written to X-Plane and read back, and where a
/// released throttle returns to.
pub(crate) const READ_BACK: [Quantity; 6] = [
    Quantity::OverrideJoystick,
    Quantity::OverrideThrottles,
    Quantity::YokePitch,
    Quantity::YokeRoll,
    Quantity::YokeHeading,
    Quantity::ThrottleLever,
];

/// All counters since opening.
#[derive(Debug, Default)]
pub(crate) struct Counters {
    pub(crate) received: AtomicU64,
    pub(crate) discarded: AtomicU64,
    pub(crate) foreign: AtomicU64,
    pub(crate) malformed: AtomicU64,
    pub(crate) unknown: AtomicU64,
    pub(crate) late: AtomicU64,
    pub(crate) implausible: AtomicU64,
    pub(crate) jumps: AtomicU64,
    pub(crate) requests: AtomicU64,
    pub(crate) writes: AtomicU64,
    pub(crate) refused: AtomicU64,
}

/// Adds one.
pub(crate) fn count(counter: &AtomicU64) {
    counter.fetch_add(1, Ordering::Relaxed);
}

/// Marks any address as allowed: no packed address has so many bits.
const ANYWHERE: u64 = u64::MAX;
/// Stands for the configured address: no packed address has these bits.
const CONFIGURED: u64 = u64::MAX - 1;
/// No address is allowed: no packed address is 0.
const NOWHERE: u64 = 0;

#[derive(Debug)]
pub(crate) struct SharedState {
    /// The simulator's configured address, if there is one.
    configured: Option<SocketAddr>,
    /// [`CONFIGURED`], or the IPv4 address and port from a beacon in the low 48
    /// bits; 0 while unknown.
    simulator: AtomicU64,
    /// The address at which control may be taken, packed likewise, or
    /// [`ANYWHERE`].
    allowed: AtomicU64,
    /// The simulator's port that answered last, 0 while unknown.
    reply_port: AtomicU16,
    /// The port that is received on here, 0 while unknown.
    local_port: AtomicU16,
    state: AtomicU8,
    control: AtomicU8,
    unconfirmed: AtomicBool,
    /// Another program writes the held controls, too.
    other_writer: AtomicBool,
    /// An override is set, not by this program, and nothing moves the yoke.
    left_overridden: AtomicBool,
    loads_differ: AtomicBool,
    axial_backwards: AtomicBool,
    answers_anything: AtomicBool,
    version: AtomicU32,
    /// A [`ValueSet`].
    missing: AtomicU64,
    /// An f32, s.
    frame_period: AtomicU32,
    /// 0 not known, 1 in the air, 2 on the ground.
    ground: AtomicU8,
    read_back: [Readback; READ_BACK.len()],
    /// Is told before control is taken.
    notice: OnceLock<&'static dyn TakeoverNotice>,
    pub(crate) counters: Counters,
}

impl SharedState {
    pub(crate) fn new(simulator: Option<SocketAddr>) -> Self {
        Self {
            configured: simulator,
            simulator: AtomicU64::new(simulator.map_or(NOWHERE, |_| CONFIGURED)),
            allowed: AtomicU64::new(ANYWHERE),
            reply_port: AtomicU16::new(0),
            local_port: AtomicU16::new(0),
            state: AtomicU8::new(SimulatorState::Silent as u8),
            control: AtomicU8::new(Control::Free as u8),
            unconfirmed: AtomicBool::new(false),
            other_writer: AtomicBool::new(false),
            left_overridden: AtomicBool::new(false),
            loads_differ: AtomicBool::new(false),
            axial_backwards: AtomicBool::new(false),
            answers_anything: AtomicBool::new(false),
            version: AtomicU32::new(0),
            missing: AtomicU64::new(0),
            frame_period: AtomicU32::new(0),
            ground: AtomicU8::new(0),
            read_back: [const { Readback::never() }; READ_BACK.len()],
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

    pub(crate) fn simulator(&self) -> Option<SocketAddr> {
        match self.simulator.load(Ordering::Relaxed) {
            NOWHERE => None,
            CONFIGURED => self.configured,
            packed => Some(unpack(packed)),
        }
    }

    pub(crate) fn set_simulator(&self, address: SocketAddr) {
        self.simulator.store(self.pack(address), Ordering::Relaxed);
    }

    /// An address as a number. Any address other than the configured one comes
    /// from a beacon, and beacons are sent over IPv4.
    fn pack(&self, address: SocketAddr) -> u64 {
        match address {
            configured if Some(configured) == self.configured => CONFIGURED,
            SocketAddr::V4(at) => (u64::from(at.ip().to_bits()) << 16) | u64::from(at.port()),
            SocketAddr::V6(_) => NOWHERE,
        }
    }

    /// Whether control may be taken there.
    pub(crate) fn is_allowed(&self, simulator: SocketAddr) -> bool {
        let allowed = self.allowed.load(Ordering::Acquire);
        allowed == ANYWHERE || (allowed != NOWHERE && allowed == self.pack(simulator))
    }

    pub(crate) fn allow(&self, simulator: Option<SocketAddr>) {
        let allowed = simulator.map_or(NOWHERE, |simulator| self.pack(simulator));
        self.allowed.store(allowed, Ordering::Release);
    }

    pub(crate) fn reply_port(&self) -> Option<u16> {
        known_port(&self.reply_port)
    }

    pub(crate) fn set_reply_port(&self, port: u16) {
        self.reply_port.store(port, Ordering::Relaxed);
    }

    pub(crate) fn local_port(&self) -> Option<u16> {
        known_port(&self.local_port)
    }

    pub(crate) fn set_local_port(&self, port: u16) {
        self.local_port.store(port, Ordering::Relaxed);
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

    pub(crate) fn is_unconfirmed(&self) -> bool {
        self.unconfirmed.load(Ordering::Relaxed)
    }

    pub(crate) fn set_unconfirmed(&self, unconfirmed: bool) {
        self.unconfirmed.store(unconfirmed, Ordering::Relaxed);
    }

    /// Whether another program writes the held controls, too.
    pub(crate) fn has_other_writer(&self) -> bool {
        self.other_writer.load(Ordering::Relaxed)
    }

    pub(crate) fn set_other_writer(&self, writes: bool) {
        self.other_writer.store(writes, Ordering::Relaxed);
    }

    /// Whether an override is set, not by this program, and nothing moves the
    /// yoke.
    pub(crate) fn is_left_overridden(&self) -> bool {
        self.left_overridden.load(Ordering::Relaxed)
    }

    pub(crate) fn set_left_overridden(&self, left: bool) {
        self.left_overridden.store(left, Ordering::Relaxed);
    }

    /// Whether the local accelerations contradict the load factor.
    pub(crate) fn do_loads_differ(&self) -> bool {
        self.loads_differ.load(Ordering::Relaxed)
    }

    pub(crate) fn set_loads_differ(&self, differ: bool) {
        self.loads_differ.store(differ, Ordering::Relaxed);
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

    fn slot(&self, quantity: Quantity) -> Option<&Readback> {
        let index = READ_BACK.iter().position(|of| *of == quantity)?;
        self.read_back.get(index)
    }

    /// Stores a readback; quantities that are not read back are ignored.
    pub(crate) fn show(&self, quantity: Quantity, value: f64, at: Time) {
        if let Some(slot) = self.slot(quantity) {
            slot.bits.store((value as f32).to_bits(), Ordering::Relaxed);
            slot.at.store(at.as_nanos(), Ordering::Release);
        }
    }

    /// The simulator's last readback, and its time.
    pub(crate) fn shown(&self, quantity: Quantity) -> Option<(f32, Time)> {
        let slot = self.slot(quantity)?;
        let at = Time::from_nanos(slot.at.load(Ordering::Acquire));
        let value = f32::from_bits(slot.bits.load(Ordering::Relaxed));
        (!at.is_never()).then_some((value, at))
    }
}

fn known_port(port: &AtomicU16) -> Option<u16> {
    match port.load(Ordering::Relaxed) {
        0 => None,
        port => Some(port),
    }
}

fn unpack(packed: u64) -> SocketAddr {
    let [_, _, a, b, c, d, high, low] = packed.to_be_bytes();
    let port = u16::from_be_bytes([high, low]);
    SocketAddrV4::new(Ipv4Addr::new(a, b, c, d), port).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_is_restored_unchanged() {
        let [announced, v4, v6] = ["192.168.250.7:49000", "10.0.0.1:49000", "[fe80::1%2]:49000"]
            .map(|text| text.parse::<SocketAddr>().unwrap());
        for configured in [v4, v6] {
            let state = SharedState::new(Some(configured));
            assert_eq!(state.simulator(), Some(configured));
            state.allow(None);
            assert!(!state.is_allowed(configured) && !state.is_allowed(announced));
            state.allow(Some(configured));
            assert!(state.is_allowed(configured) && !state.is_allowed(announced));
        }
        let state = SharedState::new(None);
        assert_eq!(state.simulator(), None);
        state.set_simulator(announced);
        assert_eq!(state.simulator(), Some(announced));
        state.allow(Some(announced));
        assert!(state.is_allowed(announced) && !state.is_allowed(v4) && !state.is_allowed(v6));
    }

    #[test]
    fn a_readback_is_kept_with_its_time() {
        let link = SharedState::new(None);
        assert_eq!(link.shown(Quantity::YokeRoll), None);
        link.show(Quantity::YokeRoll, -0.25, Time::from_nanos(7));
        assert_eq!(
            link.shown(Quantity::YokeRoll),
            Some((-0.25, Time::from_nanos(7)))
        );
    }
}
