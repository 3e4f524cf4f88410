//! A device that meets every requirement passes; one that violates a
//! requirement fails its test.

use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use fcc_conformance::{ActuatorBench, SensorBench, VanishingPlant, VanishingSource};
use fcc_conformance::{actuator_conformance, sensor_conformance};
use fcc_core::framework::{Actuator, ActuatorFault, Reading, Sensor, SensorFault, Tick, Time};

/// The defect of a device: a number, so that each is a separate type.
mod defect {
    pub(crate) const NONE: u8 = 0;
    pub(crate) const WAITS: u8 = 1;
    pub(crate) const ALLOCATES: u8 = 2;
    pub(crate) const GIVES_THE_LAST_VALUE_A_NEW_TIME: u8 = 3;
    pub(crate) const IS_AHEAD_OF_TIME: u8 = 4;
    pub(crate) const SAYS_NOTHING_OF_SILENCE: u8 = 5;
    pub(crate) const STAYS_AWAY: u8 = 6;
    pub(crate) const SETS_BACK_TO_NOTHING: u8 = 7;
    pub(crate) const FAILS_AFTER_A_MISSED_TICK: u8 = 8;
    pub(crate) const DOES_NOTHING: u8 = 9;
    pub(crate) const HOLDS_ON: u8 = 10;
    pub(crate) const RELEASES_WHAT_IT_NEVER_TOOK: u8 = 11;
    pub(crate) const TAKES_ONCE: u8 = 12;
    pub(crate) const WRITES_TO_NOBODY: u8 = 13;
    pub(crate) const FORGETS_A_RELEASE: u8 = 14;
    pub(crate) const SENDS_IN_A_WARM_UP: u8 = 15;
    pub(crate) const TAKES_IN_A_WARM_UP: u8 = 16;
}

/// The link between a device and its counterpart.
#[derive(Default)]
struct Wire {
    is_cut: bool,
    value: Option<f64>,
    outputs: Option<f64>,
    messages: u64,
}

#[derive(Default)]
struct Device<const DEFECT: u8> {
    wire: Arc<Mutex<Wire>>,
    number: u32,
    last: f64,
    was_cut: bool,
    held: bool,
    taken: u32,
}

impl<const DEFECT: u8> Device<DEFECT> {
    fn wire(&self) -> MutexGuard<'_, Wire> {
        self.wire.lock().unwrap()
    }

    /// A system call without effect.
    fn call() {
        match DEFECT {
            defect::WAITS => std::thread::sleep(Duration::from_micros(10)),
            defect::ALLOCATES => drop(std::hint::black_box(Box::new(1))),
            _ => {}
        }
    }
}

type Measured = Reading<f64>;

impl<const DEFECT: u8> Sensor<Measured> for Device<DEFECT> {
    fn sample(&mut self, tick: &Tick, into: &mut Measured) -> Result<(), SensorFault> {
        Self::call();
        let is_cut = self.wire().is_cut;
        self.was_cut |= is_cut;
        let fails = match DEFECT {
            defect::STAYS_AWAY => self.was_cut,
            defect::FAILS_AFTER_A_MISSED_TICK => tick.missed > 0,
            _ => false,
        };
        let value = self.wire().value.take();
        if let Some(value) = value.filter(|_| !fails) {
            self.last = value;
            let ahead = Duration::from_secs(u64::from(DEFECT == defect::IS_AHEAD_OF_TIME));
            *into = Reading::new(value, tick.woke + ahead);
            return Ok(());
        }
        match DEFECT {
            defect::GIVES_THE_LAST_VALUE_A_NEW_TIME => *into = Reading::new(self.last, tick.woke),
            defect::SETS_BACK_TO_NOTHING => *into = Reading::default(),
            defect::SAYS_NOTHING_OF_SILENCE => return Ok(()),
            _ => {}
        }
        Err(SensorFault::Silent)
    }

    fn warm_up(&self, _: &Tick) {
        if DEFECT == defect::TAKES_IN_A_WARM_UP {
            self.wire().value = None;
        }
    }

    fn name(&self) -> &'static str {
        "device"
    }
}

impl<const DEFECT: u8> Actuator<f64> for Device<DEFECT> {
    fn apply(&mut self, _: &Tick, outputs: &f64) -> Result<(), ActuatorFault> {
        Self::call();
        if self.wire().is_cut {
            return match DEFECT {
                defect::WRITES_TO_NOBODY => Ok(()),
                _ => Err(ActuatorFault::NotConnected),
            };
        }
        self.taken += u32::from(!self.held);
        self.held = true;
        let moves = match DEFECT {
            defect::DOES_NOTHING => false,
            defect::TAKES_ONCE => self.taken == 1,
            _ => true,
        };
        let mut wire = self.wire();
        wire.messages += 1;
        if moves {
            wire.outputs = Some(*outputs);
        }
        Ok(())
    }

    fn release(&mut self) -> Result<(), ActuatorFault> {
        Self::call();
        if !self.held && DEFECT != defect::RELEASES_WHAT_IT_NEVER_TOOK {
            return Ok(());
        }
        if self.wire().is_cut {
            if DEFECT != defect::FORGETS_A_RELEASE {
                return Err(ActuatorFault::NotConnected);
            }
            self.held = false;
            return Ok(());
        }
        self.held = false;
        let mut wire = self.wire();
        wire.messages += 1;
        if DEFECT != defect::HOLDS_ON {
            wire.outputs = None;
        }
        Ok(())
    }

    fn warm_up(&self, _: &Tick, _: &f64) {
        self.wire().messages += u64::from(DEFECT == defect::SENDS_IN_A_WARM_UP);
    }

    fn name(&self) -> &'static str {
        "device"
    }
}

impl<const DEFECT: u8> SensorBench for Device<DEFECT> {
    type Measurements = Measured;

    fn new() -> Self {
        Self::default()
    }

    fn sensor(&mut self) -> &mut dyn Sensor<Measured> {
        self
    }

    fn provide(&mut self) {
        self.number += 1;
        let value = f64::from(self.number);
        let mut wire = self.wire();
        wire.value = (!wire.is_cut).then_some(value);
    }

    fn taken(measured: &Measured) -> Vec<Time> {
        vec![measured.taken]
    }
}

impl<const DEFECT: u8> VanishingSource for Device<DEFECT> {
    fn vanish(&mut self) {
        self.wire().is_cut = true;
    }

    fn come_back(&mut self) {
        self.wire().is_cut = false;
    }
}

impl<const DEFECT: u8> ActuatorBench for Device<DEFECT> {
    type Outputs = f64;

    fn new() -> Self {
        Self::default()
    }

    fn actuator(&mut self) -> &mut dyn Actuator<f64> {
        self
    }

    fn outputs(number: u32) -> f64 {
        f64::from(number + 1)
    }

    fn is_held(&mut self) -> bool {
        self.wire().outputs.is_some()
    }

    fn follows(&mut self, outputs: &f64) -> bool {
        self.wire().outputs == Some(*outputs)
    }

    fn messages(&mut self) -> u64 {
        self.wire().messages
    }
}

impl<const DEFECT: u8> VanishingPlant for Device<DEFECT> {
    const PATIENCE: usize = 0;
    const BACK_AFTER: usize = 0;

    fn vanish(&mut self) {
        self.wire().is_cut = true;
    }

    fn come_back(&mut self) {
        self.wire().is_cut = false;
    }
}

sensor_conformance!(whole_sensor: Device<{ defect::NONE }>, vanishes);
actuator_conformance!(whole_actuator: Device<{ defect::NONE }>, vanishes);

/// A test for each defect: the violated requirement, and the message.
macro_rules! broken {
    ($($defect:ident $kind:ident $promise:ident $words:literal)*) => {
        mod broken {
            use super::*;
            $(
                #[test]
                #[should_panic(expected = $words)]
                #[allow(non_snake_case, reason = "named after the defect")]
                fn $defect() {
                    fcc_conformance::$kind::$promise::<Device<{ defect::$defect }>>();
                }
            )*
        }
    };
}

broken! {
    WAITS sensor sampling_never_waits "waits in each of 5 trials"
    ALLOCATES sensor sampling_allocates_nothing "left: 400"
    GIVES_THE_LAST_VALUE_A_NEW_TIME sensor an_old_value_stays_old "left == right"
    IS_AHEAD_OF_TIME sensor every_reading_comes_and_none_is_of_the_future "of the future"
    SAYS_NOTHING_OF_SILENCE sensor silence_is_reported_and_ends "must be a fault: Ok"
    STAYS_AWAY sensor silence_is_reported_and_ends "Err(Silent)"
    SETS_BACK_TO_NOTHING sensor nothing_is_measured_before_the_source_is_there "left == right"
    FAILS_AFTER_A_MISSED_TICK sensor a_tick_after_missed_ones_is_sampled_like_any "Err(Silent)"
    TAKES_IN_A_WARM_UP sensor every_reading_comes_and_none_is_of_the_future "Err(Silent)"
    SENDS_IN_A_WARM_UP actuator a_warm_up_has_no_effect "a warm-up sends"
    DOES_NOTHING actuator the_first_apply_takes_control_and_each_is_followed "does not follow 2.0"
    HOLDS_ON actuator release_gives_control_back "is still held"
    RELEASES_WHAT_IT_NEVER_TOOK actuator a_release_before_any_apply_does_nothing "left == right"
    TAKES_ONCE actuator an_apply_after_a_release_takes_control_again "does not follow"
    WRITES_TO_NOBODY actuator a_plant_that_vanished_is_a_fault_until_it_is_back "is no fault"
    FORGETS_A_RELEASE actuator a_release_that_a_vanished_plant_missed_is_made_up_for "still held"
}
