//! Several sensors of one kind: which one is wrong, although it does not repeat itself.
//!
//! Each sensor is compared with the one that is used. Of three or more, one that differs from
//! a majority is wrong. Of two that differ, the one with which a filter contradicts all other
//! sensors: beside the filter that is used, a copy of it takes the other's samples for as long
//! as they disagree (PX4's EKF2 and `ArduPilot`'s EKF3 run a filter for each unit throughout).
//!
//! What is found decides which readings are used, and nothing else: a recording has those, and
//! no others.

use super::super::{KalmanNavigation, Observation};
use super::compared::Compared;
use super::sensor_kind::{Sample, SensorKind};
use super::trial::{Trial, Wrong};
use fcc_core::flight::Measurements;
use fcc_core::framework::{ReadingSet, Time};

/// A trial that finds nothing ends after so long, s: the next pair is tried.
const TRIAL_S: f64 = 15.0;

/// A sensor of which there are several, and that is not used any more.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct WrongSensor {
    /// What it measures.
    pub kind: SensorKind,
    /// Its number in the loop.
    pub sensor: u8,
    /// By what it was found.
    pub by: FoundBy,
}

/// Why a sensor is not used any more.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FoundBy {
    /// A majority of its kind differs from it.
    Majority,
    /// The other kinds of sensors contradict it, and agree with another of its kind.
    OtherKinds,
    /// The magnetic field contradicts its gyroscopes.
    MagneticField,
    /// It repeats itself although it moves.
    Repeats,
    /// It is silent.
    Silence,
}

/// Compares the sensors of each kind.
#[derive(Clone, Debug, Default)]
pub(super) struct SensorMonitor {
    compared: [Compared; SensorKind::ALL.len()],
    trial: Option<Trial>,
    found: Option<WrongSensor>,
    /// Of one sensor alone nothing is compared.
    has_several: bool,
}

impl SensorMonitor {
    /// Of a sensor's readings those that may be used.
    pub(super) fn permitted(&self, sensor: u8, readings: ReadingSet) -> ReadingSet {
        let each = SensorKind::ALL.into_iter().zip(&self.compared);
        each.fold(readings, |all, (kind, compared)| {
            all.keeping(kind.readings(), !compared.is_wrong(sensor))
        })
    }

    /// Which sensor was found to be wrong since the last call.
    pub(super) const fn take_found(&mut self) -> Option<WrongSensor> {
        self.found.take()
    }

    /// An inertial unit is not used any more, for a reason of its own; none if it was found to
    /// be wrong before.
    pub(super) fn leave_unit(&mut self, sensor: u8, by: FoundBy) -> Option<WrongSensor> {
        let [units, ..] = &mut self.compared;
        let kind = SensorKind::InertialUnit;
        (!units.is_wrong(sensor)).then(|| WrongSensor {
            kind,
            sensor: units.leave(sensor),
            by,
        })
    }

    /// Whether a sensor other than an inertial unit was.
    pub(super) fn has_wrong_sensor(&self) -> bool {
        let mut each = SensorKind::ALL.into_iter().zip(&self.compared);
        each.any(|(kind, compared)| kind != SensorKind::InertialUnit && compared.has_wrong())
    }

    /// Takes what one of several sensors measures.
    pub(super) fn observe(&mut self, sensor: u8, measured: &Measurements) {
        self.has_several = true;
        let each = SensorKind::ALL.into_iter().zip(&mut self.compared);
        for (kind, compared) in each {
            let own = kind
                .samples(measured)
                .map(|sample| sample.map(|own| Sample { sensor, ..own }));
            if let Some(trial) = &mut self.trial
                && trial.kind == kind
                && trial.sensor == sensor
            {
                trial.observe(&own);
            }
            compared.observe(sensor, own);
        }
    }

    /// Takes a sample that is used.
    pub(super) fn share(&mut self, taken: Time, observation: Observation) {
        if let Some(trial) = &mut self.trial {
            trial.share(taken, observation);
        }
    }

    /// The year's magnetic field at the first fix.
    pub(super) fn learn_earth_field(&mut self, field_ut: [f64; 3]) {
        if let Some(trial) = &mut self.trial {
            trial.learn_earth_field(field_ut);
        }
    }

    /// Which samples are used.
    pub(super) fn follow(&mut self, measured: &Measurements) {
        if !self.has_several {
            return;
        }
        let each = SensorKind::ALL.into_iter().zip(&mut self.compared);
        for (kind, compared) in each {
            if compared.follow(kind.samples(measured)) {
                self.trial.take_if(|trial| trial.kind == kind);
            }
        }
    }

    /// Judges the sensors at a time, after the step of the filter that is used; without one
    /// by majorities alone.
    pub(super) fn judge(&mut self, now: Time, filter: Option<&KalmanNavigation>) {
        if !self.has_several {
            return;
        }
        let each = SensorKind::ALL.into_iter().zip(&mut self.compared);
        for (kind, compared) in each {
            if compared.is_outvoted(now) {
                let wrong = compared.leave_used();
                self.found = wrong.map(|sensor| WrongSensor {
                    kind,
                    sensor,
                    by: FoundBy::Majority,
                });
            }
        }
        match filter {
            Some(filter) if self.trial.is_some() => self.go_on_trying(now, filter),
            Some(filter) => self.trial = self.begin_to_try(now, filter),
            None => self.trial = None,
        }
    }

    /// Whether a second filter tells which of two sensors is wrong.
    pub(super) const fn is_trying(&self) -> bool {
        self.trial.is_some()
    }

    /// Begins with the pair that disagrees and was not tried for the longest time.
    fn begin_to_try(&mut self, now: Time, filter: &KalmanNavigation) -> Option<Trial> {
        let each = SensorKind::ALL.into_iter().zip(&mut self.compared);
        let pairs = each.filter_map(|(kind, compared)| {
            let (used, other) = compared.next_pair(now)?;
            Some((kind, used, other))
        });
        let (kind, used, other) = pairs.min_by_key(|(.., other)| other.tried)?;
        other.tried = now;
        Trial::new(kind, &other.samples, &used, filter, now)
    }

    fn go_on_trying(&mut self, now: Time, filter: &KalmanNavigation) {
        let Some(trial) = &mut self.trial else {
            return;
        };
        let (kind, sensor) = (trial.kind, trial.sensor);
        let mut each = SensorKind::ALL.into_iter().zip(&mut self.compared);
        let Some((_, compared)) = each.find(|(of, _)| *of == kind) else {
            return;
        };
        let wrong = match trial.judge(now, filter) {
            Some(Wrong::Used) => compared.leave_used(),
            Some(Wrong::Other) => Some(compared.leave(sensor)),
            None => None,
        };
        if let Some(sensor) = wrong {
            let by = FoundBy::OtherKinds;
            self.found = Some(WrongSensor { kind, sensor, by });
        }
        let is_over = now.since(trial.began).as_secs_f64() > TRIAL_S;
        if wrong.is_some() || is_over || !compared.disagrees(now, sensor) {
            self.trial = None;
        }
    }
}
