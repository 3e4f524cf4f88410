//! An autopilot with measurements set by the test.

use core::time::Duration;

use fcc_core::flight::{
    Attitude, BodyRates, Measurements, OtherControl, Plant, PlantState, Position, SpecificForce,
    Surfaces,
};
use fcc_core::framework::{Controller, Flags, Reading, Switch, Tick, Time};
use fcc_fixed_wing::{Autopilot, AutopilotCommand, AutopilotConfig, flags};
use fcc_guidance::GuidanceConfig;

/// Every sensor needed by control, with its fault.
pub(crate) const SENSORS: [Flags; 6] = [
    flags::ATTITUDE,
    flags::HEADING,
    flags::BODY_RATES,
    flags::SPECIFIC_FORCE,
    flags::AIRSPEED,
    flags::ALTITUDE,
];

pub(crate) const DT_S: f64 = 0.025;
pub(crate) const KNOT_MPS: f64 = 1_852.0 / 3_600.0;

/// An autopilot and the aircraft simulated for it.
pub(crate) struct Cockpit {
    pub(crate) autopilot: Autopilot,
    pub(crate) tick: Tick,
    pub(crate) period: Duration,
    /// The sensors' readings, stamped at each tick.
    pub(crate) feel: Feel,
    pub(crate) rates: BodyRates,
    pub(crate) measurements: Measurements,
    pub(crate) silent: Flags,
    pub(crate) switch: Option<Switch>,
    /// How much the plant's clock is behind ours, s.
    pub(crate) stood_s: f64,
    /// The sensor from which the plant's clock comes.
    pub(crate) plant_source: u8,
    /// Degrees north of the start.
    pub(crate) north_deg: f64,
    pub(crate) other_control: OtherControl,
}

#[derive(Clone, Copy)]
pub(crate) struct Feel {
    pub(crate) pitch_deg: f64,
    pub(crate) roll_deg: f64,
    pub(crate) heading_deg: f64,
    pub(crate) airspeed_kt: f64,
    pub(crate) altitude_m: f64,
    pub(crate) plant: Option<PlantState>,
}

pub(crate) const LEVEL: Feel = Feel {
    pitch_deg: 0.0,
    roll_deg: 0.0,
    heading_deg: 30.0,
    airspeed_kt: 100.0,
    altitude_m: 914.4,
    plant: None,
};

pub(crate) const STANDING: Surfaces = Surfaces {
    throttle: 0.62,
    elevator: 0.05,
    aileron: -0.02,
    rudder: 0.01,
    ..Surfaces::IDLE
};

impl Cockpit {
    pub(crate) fn new(guidance: GuidanceConfig) -> Self {
        let config = AutopilotConfig {
            guidance,
            // The readings are the same to the last bit until the test changes
            // them.
            frozen_after: Duration::ZERO,
            ..AutopilotConfig::default()
        };
        let mut cockpit = Self {
            autopilot: Autopilot::new(config),
            tick: Tick {
                dt_s: DT_S,
                scheduled: Time::from_nanos(0),
                woke: Time::from_nanos(0),
                ..Tick::default()
            },
            period: Duration::from_millis(25),
            feel: LEVEL,
            rates: BodyRates::default(),
            measurements: Measurements::default(),
            silent: Flags::NONE,
            switch: None,
            stood_s: 0.0,
            plant_source: 0,
            north_deg: 0.0,
            other_control: OtherControl::default(),
        };
        for _ in 0..80 {
            cockpit.observe();
        }
        cockpit
    }

    pub(crate) fn engaged(guidance: GuidanceConfig) -> Self {
        let mut cockpit = Self::new(guidance);
        assert_eq!(cockpit.engage_inhibits(), Flags::NONE);
        cockpit
            .autopilot
            .engage(&cockpit.tick, &cockpit.measurements);
        cockpit
    }

    /// On a simulator that has run for some ticks, to turn to 100°.
    pub(crate) fn engaged_on_a_simulator(ticks: u32) -> Self {
        let mut cockpit = Self::new(GuidanceConfig::Hold);
        cockpit.feel.plant = Some(PlantState::Running);
        for _ in 0..ticks {
            cockpit.observe();
        }
        cockpit
            .autopilot
            .engage(&cockpit.tick, &cockpit.measurements);
        cockpit
            .autopilot
            .command(&AutopilotCommand::Heading(100.0_f64.to_radians()));
        cockpit
    }

    /// A tick in which nothing arrives.
    pub(crate) fn receive_nothing(&mut self) {
        self.next_tick();
        self.autopilot.estimate(&self.tick, &self.measurements);
    }

    fn next_tick(&mut self) {
        self.tick.number += 1;
        self.tick.woke = self.tick.woke + self.period;
        self.tick.dt_s = self.period.as_secs_f64();
        self.tick.scheduled = self.tick.woke;
    }

    pub(crate) fn observe(&mut self) {
        self.observe_with(|_| {});
    }

    /// A tick whose measurements are changed before they are read.
    pub(crate) fn observe_with(&mut self, change: impl FnOnce(&mut Measurements)) {
        self.next_tick();
        let (feel, now) = (self.feel, self.tick.woke);
        let before = self.measurements;
        self.measurements = Measurements {
            attitude: Reading::new(
                Attitude {
                    pitch_rad: feel.pitch_deg.to_radians(),
                    roll_rad: feel.roll_deg.to_radians(),
                },
                now,
            ),
            heading_rad: Reading::new(feel.heading_deg.to_radians(), now),
            body_rates: Reading::new(self.rates, now),
            specific_force: Reading::new(
                SpecificForce {
                    x_mps2: 9.806_65 * feel.pitch_deg.to_radians().sin(),
                    z_mps2: -9.806_65,
                    ..SpecificForce::default()
                },
                now,
            ),
            airspeed_mps: Reading::new(feel.airspeed_kt * KNOT_MPS, now),
            altitude_m: Reading::new(feel.altitude_m, now),
            surfaces: Reading::new(STANDING, now),
            position: feel.plant.map_or_else(Reading::default, |_| {
                let position = Position {
                    latitude_rad: (47.0 + self.north_deg).to_radians(),
                    ..Position::default()
                };
                Reading::new(position, now)
            }),
            other_control: Reading::new(self.other_control, now),
            plant: feel.plant.map_or_else(Reading::default, |state| {
                let time_s = now.as_nanos() as f64 * 1e-9 - self.stood_s;
                Reading {
                    source: self.plant_source,
                    ..Reading::new(Plant { time_s, state }, now)
                }
            }),
            engage_switch: self
                .switch
                .map_or(before.engage_switch, |switch| Reading::new(switch, now)),
            ..Measurements::default()
        };
        let (silent, now) = (self.silent, &mut self.measurements);
        if silent.contains(flags::ATTITUDE) {
            now.attitude = before.attitude;
        }
        if silent.contains(flags::HEADING) {
            now.heading_rad = before.heading_rad;
        }
        if silent.contains(flags::BODY_RATES) {
            now.body_rates = before.body_rates;
        }
        if silent.contains(flags::SPECIFIC_FORCE) {
            now.specific_force = before.specific_force;
        }
        if silent.contains(flags::AIRSPEED) {
            now.airspeed_mps = before.airspeed_mps;
        }
        if silent.contains(flags::ALTITUDE) {
            now.altitude_m = before.altitude_m;
        }
        if silent.contains(flags::PLANT_STALLED) {
            now.plant.value.time_s = before.plant.value.time_s;
            now.plant.value.state = PlantState::Stalled;
        }
        change(now);
        self.autopilot.estimate(&self.tick, &self.measurements);
    }

    /// A tick in which all sensors send, but the plant's clock does not
    /// advance.
    pub(crate) fn pause(&mut self, time_s: f64) {
        self.next_tick();
        let now = self.tick.woke;
        let measured = &mut self.measurements;
        measured.attitude.taken = now;
        measured.heading_rad.taken = now;
        measured.body_rates.taken = now;
        measured.specific_force.taken = now;
        measured.airspeed_mps.taken = now;
        measured.altitude_m.taken = now;
        let paused = Plant {
            time_s,
            state: PlantState::Paused,
        };
        measured.plant = Reading::new(paused, now);
        self.autopilot.estimate(&self.tick, &self.measurements);
    }

    pub(crate) fn step(&mut self) -> Surfaces {
        self.observe();
        self.act()
    }

    pub(crate) fn act(&mut self) -> Surfaces {
        self.autopilot.guide(&self.tick, &self.measurements);
        self.autopilot.control(&self.tick, &self.measurements)
    }

    pub(crate) fn failsafe(&mut self) -> Surfaces {
        self.autopilot.failsafe(&self.tick, &self.measurements)
    }

    pub(crate) fn steps(&mut self, count: u32) -> Surfaces {
        (0..count).fold(Surfaces::default(), |_, _| self.step())
    }

    pub(crate) fn engage_inhibits(&self) -> Flags {
        self.autopilot
            .engage_inhibits(&self.tick, &self.measurements)
    }

    pub(crate) fn must_release(&self) -> Flags {
        self.autopilot.must_release(&self.tick, &self.measurements)
    }

    pub(crate) fn withholds(&self) -> bool {
        self.autopilot
            .withholds_outputs(&self.tick, &self.measurements)
    }

    pub(crate) fn faults(&self) -> Flags {
        self.autopilot.faults(&self.tick, &self.measurements)
    }

    pub(crate) fn conditions(&self) -> Flags {
        self.autopilot.conditions(&self.tick, &self.measurements)
    }
}
