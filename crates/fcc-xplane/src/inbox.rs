//! From datagrams to measurements.
//!
//! The datagrams of a tick are read one after the other, then the measurements
//! they completed are published. A measurement of several quantities (such as
//! pitch and roll) is that of the last datagram that had all of them, so they
//! belong to one instant: X-Plane sends the values of a frame in one datagram.
//! While no datagram has all of them, it is made of the latest of each and has
//! the age of the oldest (`values`).
//!
//! A datagram with an earlier flight time than the last one was overtaken and
//! is dropped as a whole. A position has no time: it is dropped for 0.4 s after a
//! datagram that is a second old. For others without a flight time (rows sent one by
//! one), and a position that arrives late but once, this cannot be detected: it gives
//! a state up to a second old for one tick.

use core::time::Duration;

use fcc_core::flight::{
    BodyRates, Measurements, OtherControl, PilotControls, Plant, Position, Surfaces,
};
use fcc_core::framework::{Reading, Switch, Time};

use crate::aircraft_state;
use crate::config::{DataRows, PlantKind};
use crate::counters::count;
use crate::engage_switch::NONEXISTENT_INDEX;
use crate::link::{Control, SharedState};
use crate::motion::Motion;
use crate::pressure_altitude::PressureAltitude;
use crate::protocol::{Kind, Malformed, data, rpos, rref};
use crate::quantity::Quantity;
use crate::reload_watch::ReloadWatch;
use crate::rows;
use crate::sending_clock::SendingClock;
use crate::simulator::{SimulatorClock, SimulatorReport, SimulatorState};
use crate::values::{Group, Values};

/// The engage switch is on from here upwards, and off below [`SWITCH_OFF`]; in
/// between it stays as it was, at first off. So noise on it does not switch.
const SWITCH_ON: f64 = 0.75;
const SWITCH_OFF: f64 = 0.25;

/// An override that stays set for this long after a release was left.
const LEFT_AFTER: Duration = Duration::from_secs(3);
/// X-Plane's own autopilots: they act whatever is written to the yoke.
const SERVOS: [Quantity; 3] = [Quantity::Servos, Quantity::Servos2, Quantity::Servos3];
const OVERRIDES: [Quantity; 2] = [Quantity::OverrideJoystick, Quantity::OverrideThrottles];

/// Converts datagrams to measurements.
#[derive(Clone, Debug)]
pub(crate) struct Inbox {
    plant: PlantKind,
    /// The rows to read, if rows are the input.
    rows: Option<DataRows>,
    clock: SimulatorClock,
    sending: SendingClock,
    values: Values,
    position: Reading<Position>,
    motion: Motion,
    switch: Switch,
    altitude: PressureAltitude,
    /// Since when an override that is not this program's is set; never without.
    overridden: Time,
    reload: ReloadWatch,
}

impl Inbox {
    pub(crate) fn new(plant: PlantKind, rows: Option<DataRows>, silent_after: Duration) -> Self {
        Self {
            plant,
            rows,
            clock: SimulatorClock::new(silent_after),
            sending: SendingClock::default(),
            values: Values::default(),
            position: Reading::default(),
            motion: Motion::new(rows),
            switch: Switch::Off,
            altitude: PressureAltitude::new(),
            overridden: Time::NEVER,
            reload: ReloadWatch::default(),
        }
    }

    /// Begins a tick.
    pub(crate) fn begin(&mut self) {
        self.clock.begin();
    }

    /// From now on another simulator sends, whose clock is another one.
    pub(crate) fn leave(&mut self) {
        self.sending.map_anew();
    }

    /// When a value of this quantity last arrived.
    pub(crate) fn arrived(&self, quantity: Quantity) -> Time {
        self.values.arrived(quantity)
    }

    /// When a position last arrived.
    pub(crate) const fn position_arrived(&self) -> Time {
        self.position.taken
    }

    /// When anything last arrived.
    pub(crate) const fn last_received(&self) -> Time {
        self.clock.last_received()
    }

    /// Reads a datagram of the simulator; returns whether anything in it was
    /// requested.
    pub(crate) fn accept(
        &mut self,
        datagram: &[u8],
        now: Time,
        link: &SharedState,
    ) -> Result<bool, Malformed> {
        match Kind::of(datagram) {
            Some(Kind::Rref) => self.accept_values(datagram, now, link),
            Some(Kind::Rpos) => self.accept_position(datagram, now, link),
            Some(Kind::Data) => match self.rows {
                Some(rows) => self.accept_rows(rows, datagram, now, link),
                // Data Output that the user sends for another program.
                None => Ok(false),
            },
            Some(Kind::Beacon) | None => {
                count(&link.counters.unknown);
                Ok(false)
            }
        }
    }

    fn accept_values(
        &mut self,
        datagram: &[u8],
        now: Time,
        link: &SharedState,
    ) -> Result<bool, Malformed> {
        let with_rows = self.rows.is_some();
        let pairs = rref::parse(datagram)?.filter_map(|(index, value)| {
            if index == NONEXISTENT_INDEX {
                link.set_answers_anything();
            }
            let quantity = Quantity::from_index(index)?;
            // Left over from a run with RREF input: now only rows are read.
            let elsewhere = with_rows && quantity.comes_in_rows();
            (!elsewhere).then_some((quantity, f64::from(value)))
        });
        let find = |time| {
            let mut pairs = pairs.clone();
            let found = pairs.find(|(quantity, _)| *quantity == time);
            found.and_then(|(quantity, value)| quantity.validate(value))
        };
        let (flight_s, network_s) = (find(Quantity::FlightTime), find(Quantity::NetworkTime));
        // A board has one clock, which never stands still.
        let time_s = match self.plant {
            PlantKind::Simulator => flight_s,
            PlantKind::ServoBoard => network_s,
        };
        let shows_replay = find(Quantity::Replay).is_some_and(|replay| replay >= 0.5);
        if self.is_late(now, (time_s, shows_replay), link) {
            return Ok(false);
        }
        if let (Some(network_s), Some(flight_s)) = (network_s, flight_s) {
            self.sending.receive(now, network_s, flight_s);
        }
        let mut report = SimulatorReport {
            time_s,
            ..SimulatorReport::default()
        };
        let mut is_requested = false;
        self.values.begin_frame();
        for (quantity, raw) in pairs {
            is_requested = true;
            self.take(quantity, raw, now, &mut report, link);
        }
        self.values.end_frame();
        if is_requested {
            self.clock.receive(now, report);
        }
        Ok(is_requested)
    }

    fn accept_rows(
        &mut self,
        layout: DataRows,
        datagram: &[u8],
        now: Time,
        link: &SharedState,
    ) -> Result<bool, Malformed> {
        let rows = data::parse(datagram)?;
        let time_s = rows.clone().find_map(|row| rows::flight_time(&row));
        if self.is_late(now, (time_s, false), link) {
            return Ok(false);
        }
        let mut report = SimulatorReport {
            time_s,
            ..SimulatorReport::default()
        };
        self.values.begin_frame();
        for row in rows {
            rows::quantities(layout, &row, |quantity, raw| {
                self.take(quantity, raw, now, &mut report, link);
            });
            if let Some(position) = rows::position(&row) {
                self.position = Reading::new(position, self.sending.stamp(now));
            }
        }
        self.values.end_frame();
        self.clock.receive(now, report);
        Ok(true)
    }

    fn accept_position(
        &mut self,
        datagram: &[u8],
        now: Time,
        link: &SharedState,
    ) -> Result<bool, Malformed> {
        let reply = rpos::parse(datagram)?;
        if self.rows.is_some() {
            // Left over from a run with RREF input.
            self.clock.receive(now, SimulatorReport::default());
            return Ok(false);
        }
        // A replay may show a place again.
        if self.clock.delivers_old(now) && !self.clock.is_replaying() {
            count(&link.counters.late);
            return Ok(false);
        }
        let position = Position {
            latitude_rad: reply.latitude_deg.to_radians(),
            longitude_rad: reply.longitude_deg.to_radians(),
            altitude_m: reply.elevation_m,
        };
        self.position = Reading::new(position, self.sending.stamp(now));
        self.clock.receive(now, SimulatorReport::default());
        Ok(true)
    }

    fn is_late(
        &mut self,
        now: Time,
        (time_s, shows_replay): (Option<f64>, bool),
        link: &SharedState,
    ) -> bool {
        let late = time_s.is_some_and(|time_s| self.clock.is_late(now, time_s, shows_replay));
        if late {
            count(&link.counters.late);
        }
        late
    }

    fn take(
        &mut self,
        quantity: Quantity,
        raw: f64,
        now: Time,
        report: &mut SimulatorReport,
        link: &SharedState,
    ) {
        let Some(value) = quantity.validate(raw) else {
            count(&link.counters.implausible);
            return;
        };
        self.values.set(quantity, value, self.sending.stamp(now));
        link.read_back.show(quantity, value, now);
        match quantity {
            Quantity::Paused => report.paused = Some(value >= 0.5),
            Quantity::Replay => report.replaying = Some(value >= 0.5),
            Quantity::FramePeriod => {
                report.frame_period_s = Some(value);
                link.set_frame_period_s(value);
            }
            Quantity::OnGround => link.set_on_ground(value >= 0.5),
            Quantity::Version => link.set_version(value as u32),
            _ => {}
        }
    }

    /// Publishes the measurements completed since the last call, and returns
    /// the simulator's state. `writing` is the connection over which this
    /// program writes.
    pub(crate) fn publish(
        &mut self,
        now: Time,
        into: &mut Measurements,
        link: &SharedState,
        writing: &SharedState,
    ) -> SimulatorState {
        let there = self.sending.there(now);
        self.motion.publish(there, &mut self.values, into, link);
        self.publish_attitude(into);
        let values = &mut self.values;
        aircraft_state::publish(values, into);
        if let Some(([airspeed], taken)) = values.whole(Group::Airspeed) {
            into.airspeed_mps = Reading::new(airspeed, taken);
        }
        self.altitude.publish(values, into);
        if let Some(([angle], taken)) = values.whole(Group::AngleOfAttack) {
            into.angle_of_attack_rad = Reading::new(angle, taken);
        }
        if let Some(([throttle, elevator, aileron, rudder], taken)) = values.whole(Group::Surfaces)
        {
            let trim = values.recent(Quantity::ElevatorTrim, now);
            // In reverse it is negative, and with emergency power above 1.
            let surfaces = Surfaces {
                throttle: throttle.clamp(0.0, 1.0),
                elevator,
                aileron,
                rudder,
                elevator_trim: trim.map(|trim| trim.clamp(-1.0, 1.0)),
                ..Surfaces::IDLE
            };
            into.surfaces = Reading::new(surfaces, taken);
        }
        if let Some(([switch], taken)) = values.whole(Group::Switch) {
            self.switch = position(switch).unwrap_or(self.switch);
            into.engage_switch = Reading::new(self.switch, taken);
        }
        if let Some(([pitch, roll, yaw], taken)) = values.whole(Group::PilotControls) {
            into.pilot_controls = Reading::new(PilotControls { pitch, roll, yaw }, taken);
        }
        if self.clock.last_received() == now {
            let is_set = |of| {
                let value = self.values.recent(of, there);
                value.is_some_and(|value| value >= 0.5)
            };
            let autopilot = SERVOS.into_iter().any(is_set);
            into.other_control = Reading::new(OtherControl { autopilot }, there);
            let is_overridden = OVERRIDES.into_iter().any(is_set);
            let is_left = is_overridden && writing.control() == Control::Free;
            if !is_left {
                self.overridden = Time::NEVER;
            } else if self.overridden.is_never() {
                self.overridden = now;
            }
            writing.set_left_overridden(is_left && now.since(self.overridden) >= LEFT_AFTER);
        }
        self.publish_plant(now, into, link)
    }

    fn publish_attitude(&mut self, into: &mut Measurements) {
        let values = &mut self.values;
        if let Some(([heading], taken)) = values.whole(Group::Heading) {
            into.heading_rad = Reading::new(round(heading), taken);
        }
        if let Some(([roll_radps, pitch_radps, yaw_radps], taken)) = values.whole(Group::Rates) {
            let rates = BodyRates {
                roll_radps,
                pitch_radps,
                yaw_radps,
            };
            into.body_rates = Reading::new(rates, taken);
        }
        if self.position.taken > into.position.taken {
            into.position = self.position;
        }
    }

    /// The simulator's clock and state, of a board none: written in every tick in which it sent its
    /// time. If that value alone is missing, the reading grows old.
    fn publish_plant(
        &mut self,
        now: Time,
        into: &mut Measurements,
        link: &SharedState,
    ) -> SimulatorState {
        if self.reload.step(now, link) {
            self.clock.reload();
        }
        let state = self.clock.state(now);
        if state == SimulatorState::Jumped {
            count(&link.counters.jumps);
        }
        if self.plant == PlantKind::Simulator
            && self.clock.time_seen() == now
            && let (Some(time_s), Some(state)) = (self.clock.time_s(), state.plant_state())
        {
            into.plant = Reading::new(Plant { time_s, state }, self.sending.stamp(now));
        }
        state
    }
}

/// The switch's position; none in between.
fn position(switch: f64) -> Option<Switch> {
    match switch {
        on if on >= SWITCH_ON => Some(Switch::On),
        off if off < SWITCH_OFF => Some(Switch::Off),
        _ => None,
    }
}

/// Wraps an angle into 0..2π.
fn round(angle_rad: f64) -> f64 {
    let angle = angle_rad.rem_euclid(core::f64::consts::TAU);
    // Rounding maps a tiny negative angle to 2π itself.
    if angle < core::f64::consts::TAU {
        angle
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests;
