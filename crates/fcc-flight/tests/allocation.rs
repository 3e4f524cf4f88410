//! Ten thousand ticks of the whole thing - aircraft, navigation, guidance,
//! control, actuators, record, and a warm-up before each - do not touch the
//! allocator; nor does a flight in which sensors fail and the aircraft is upset.
//!
//! A process of its own: what another test initialises first would not allocate here.
#![cfg(test)]

use std::sync::{Arc, Mutex};
use std::time::Duration;

use fcc_conformance::allocator_calls;
use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Actuator, ActuatorFault, Reading, Sensor, SensorFault, State, Tick};
use fcc_fixed_wing::Autopilot;
use fcc_flight::config::{
    BuiltInSection, Config, GustsChoice, NavigationMethod, NavigationSection, RawSensorsChoice,
};
use fcc_flight::flight::assemble;
use fcc_navigation::inertial::MagneticNorth;
use fcc_runtime::{Machine, Message, Parts};
use fcc_timer::ManualTimer;

/// Flies 10,000 ticks. Returns the calls of the allocator, the engaged ticks, the
/// records, and what happened.
fn fly(
    navigation: NavigationMethod,
    second: Option<Box<dyn Sensor<Measurements>>>,
    sensor: impl Fn(Box<dyn Sensor<Measurements>>) -> Box<dyn Sensor<Measurements>>,
    actuator: impl Fn(Box<dyn Actuator<Surfaces>>) -> Box<dyn Actuator<Surfaces>>,
) -> (u64, u32, u32, Vec<String>) {
    let config = Config {
        built_in: Some(BuiltInSection {
            gusts: GustsChoice::Moderate,
            delay_ms: 25,
            // By raw sensors engaging waits for the magnetic field, 20 s at most.
            engage_at_s: Some(25.0),
            raw_sensors: match navigation {
                NavigationMethod::Measured => RawSensorsChoice::None,
                NavigationMethod::Kalman => RawSensorsChoice::Board,
            },
            ..BuiltInSection::default()
        }),
        navigation: NavigationSection {
            method: navigation,
            ..NavigationSection::default()
        },
        ..Config::default()
    };
    let assembly = assemble(&config).unwrap();
    let mut autopilot = *assembly.autopilot.config();
    if let Some(raw) = &mut autopilot.raw_navigation {
        // Computed in the tick of the first fix.
        raw.north = MagneticNorth::ModelOf(2027.5);
    }
    let parts = Parts {
        timer: Box::new(
            ManualTimer::new(Duration::from_millis(25))
                .unwrap()
                .with_warm_up(),
        ),
        sensors: assembly
            .sensors
            .into_iter()
            .map(sensor)
            .chain(second)
            .collect(),
        controller: Autopilot::new(autopilot),
        actuators: assembly.actuators.into_iter().map(actuator).collect(),
    };
    let (mut machine, mut link) = Machine::new(parts, &assembly.loop_config).unwrap();
    machine.start().unwrap();

    let (mut engaged, mut records) = (0, 0);
    let mut events = Vec::with_capacity(1_000);
    let ((), calls) = allocator_calls(|| {
        for _ in 0..10_000 {
            if machine.step() == State::Engaged {
                engaged += 1;
            }
            while let Some(message) = link.messages.receive() {
                match message {
                    Message::Tick(_) => records += 1,
                    Message::Event(event) => events.push(event.kind),
                }
            }
        }
    });
    let events = events
        .iter()
        .map(|kind| kind.description::<Autopilot>().to_string());
    (calls, engaged, records, events.collect())
}

#[test]
fn ten_thousand_ticks_of_a_flight_do_not_allocate() {
    for navigation in [NavigationMethod::Measured, NavigationMethod::Kalman] {
        let (calls, engaged, records, events) =
            fly(navigation, None, |sensor| sensor, |actuator| actuator);
        assert_eq!(calls, 0);
        // It was a flight: 25 s of standby, and engaged to the end.
        assert_eq!(records, 10_000);
        assert!((8_980..=9_000).contains(&engaged), "{engaged}: {events:#?}");
    }
}

#[test]
fn doubts_degraded_flight_and_recoveries_do_not_allocate() {
    let (calls, _, records, events) = fly(
        NavigationMethod::Measured,
        None,
        |sensor| Box::new(Failing(sensor)),
        |actuator| Box::new(Sticking(actuator)),
    );
    assert_eq!(calls, 0);
    assert_eq!(records, 10_000);
    for text in [
        "airspeed of sensor 1 is excluded",
        "attitude is missing or too old",
        "altitude is missing or too old",
        "recovering from an upset",
        "the simulator stood still",
    ] {
        assert!(
            events.iter().any(|event| event.contains(text)),
            "{text}: {events:#?}"
        );
    }
}

#[test]
fn a_second_filter_for_two_units_that_disagree_does_not_allocate() {
    let measured = Arc::default();
    let (calls, _, records, events) = fly(
        NavigationMethod::Kalman,
        Some(Box::new(Second(Arc::clone(&measured)))),
        |sensor| Box::new(Biased(sensor, Arc::clone(&measured))),
        |actuator| actuator,
    );
    assert_eq!(calls, 0);
    assert_eq!(records, 10_000);
    let text = "inertial unit of sensor 1 is not used again: another of its kind";
    assert!(
        events.iter().any(|event| event.contains(text)),
        "{events:#?}"
    );
}

/// A sensor whose gyroscope is off by 5 °/s in pitch after 100 s.
struct Biased(Box<dyn Sensor<Measurements>>, Arc<Mutex<Measurements>>);

impl Sensor<Measurements> for Biased {
    fn sample(&mut self, tick: &Tick, into: &mut Measurements) -> Result<(), SensorFault> {
        let mut measured = self.1.lock().unwrap();
        self.0.sample(tick, &mut measured)?;
        *into = *measured;
        if tick.number >= 4_000 {
            into.raw_body_rates.value.pitch_radps += 5.0_f64.to_radians();
        }
        Ok(())
    }

    fn name(&self) -> &str {
        self.0.name()
    }
}

/// One beside it that is not.
struct Second(Arc<Mutex<Measurements>>);

impl Sensor<Measurements> for Second {
    fn sample(&mut self, _: &Tick, into: &mut Measurements) -> Result<(), SensorFault> {
        *into = *self.0.lock().unwrap();
        Ok(())
    }

    fn name(&self) -> &'static str {
        "second"
    }
}

/// A sensor whose airspeed is wrong for 20 s, which then loses attitude, altitude, and
/// everything for a while.
struct Failing(Box<dyn Sensor<Measurements>>);

impl Sensor<Measurements> for Failing {
    fn sample(&mut self, tick: &Tick, into: &mut Measurements) -> Result<(), SensorFault> {
        if (7_000..7_040).contains(&tick.number) {
            return Err(SensorFault::Silent);
        }
        self.0.sample(tick, into)?;
        match tick.number {
            2_000..2_800 => into.airspeed_mps.value += 15.0,
            4_000..4_080 => into.attitude = Reading::default(),
            5_000..5_080 => into.altitude_m = Reading::default(),
            _ => {}
        }
        Ok(())
    }

    fn name(&self) -> &str {
        self.0.name()
    }
}

/// Ailerons that stick at their limit for 3 s.
struct Sticking(Box<dyn Actuator<Surfaces>>);

impl Actuator<Surfaces> for Sticking {
    fn apply(&mut self, tick: &Tick, outputs: &Surfaces) -> Result<(), ActuatorFault> {
        let mut outputs = *outputs;
        if (6_000..6_120).contains(&tick.number) {
            outputs.aileron = 1.0;
        }
        self.0.apply(tick, &outputs)
    }

    fn release(&mut self) -> Result<(), ActuatorFault> {
        self.0.release()
    }

    fn name(&self) -> &str {
        self.0.name()
    }
}
