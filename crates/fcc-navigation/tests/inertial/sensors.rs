//! Sensors of a flight, with their errors and delays.

use std::collections::VecDeque;
use std::time::Duration;

use fcc_core::flight::atmosphere::{pressure_pa, true_airspeed_mps};
use fcc_core::flight::earth::metres_per_radian;
use fcc_core::flight::orientation::earth_to_body;
use fcc_core::framework::Time;
use fcc_navigation::inertial::{
    GeodeticPosition, InertialNavigation, KalmanConfig, KalmanNavigation, Observation, Solution,
};

use super::flight::{Flight, Truth};
use super::noise::Random;

pub(crate) const STEP_S: f64 = 0.02;
/// By how much a position and a velocity come late, s.
const RECEIVER_DELAY_S: f64 = 0.12;
/// The field at 47° N, 8° E (WMM 2025, to a microtesla): north, east, down.
pub(crate) const FIELD_UT: [f64; 3] = [21.5, 1.3, 43.0];

/// What is made of a receiver's velocity, m/s, so many seconds after it failed.
pub(crate) type VelocityFault = fn([f64; 3], f64, &mut Random) -> [f64; 3];

/// Which sensors there are, and what is wrong with them.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::struct_excessive_bools, reason = "each sensor is there or not")]
pub(crate) struct Fitted {
    pub(crate) compass: bool,
    pub(crate) airspeed: bool,
    pub(crate) receiver: bool,
    /// The receiver is lost from here to there, s.
    pub(crate) receiver_lost_s: (f64, f64),
    /// The receiver shows the place of its begin and no motion from here to there, s.
    pub(crate) receiver_stands_s: (f64, f64),
    /// Fixes come later by this time than they say, s, from here to there, s.
    pub(crate) receiver_late: (f64, (f64, f64)),
    /// That time comes to it by so much in a second.
    pub(crate) later_by: f64,
    /// What is made of the receiver's velocity from here to there, s.
    pub(crate) velocity_fault: (VelocityFault, (f64, f64)),
    /// Gyroscopes and accelerometers are both lost from here to there, s.
    pub(crate) inertial_lost_s: (f64, f64),
    /// The compass is turned by an angle from a time on, rad, s.
    pub(crate) compass_turned: (f64, f64),
    /// Errors that last: biases of the inertial sensors, the receiver's and the
    /// barometer's slow errors.
    pub(crate) slow_errors: bool,
    /// The end of the accelerometer's range, m/s².
    pub(crate) force_range: f64,
    /// By how much the biases of gyroscopes and accelerometers change from a time on, rad/s²,
    /// m/s³, s.
    pub(crate) drifts: ([f64; 3], [f64; 3], f64),
    /// By how much the bias of the gyroscopes jumps at a time, rad/s, s.
    pub(crate) jumps: ([f64; 3], f64),
    /// By how much that of the accelerometers does, m/s², s.
    pub(crate) force_jumps: ([f64; 3], f64),
}

impl Default for Fitted {
    fn default() -> Self {
        Self {
            compass: true,
            airspeed: true,
            receiver: true,
            receiver_lost_s: (f64::INFINITY, f64::INFINITY),
            receiver_stands_s: (f64::INFINITY, f64::INFINITY),
            receiver_late: (0.0, (0.0, f64::INFINITY)),
            later_by: f64::MAX,
            velocity_fault: (|velocity, _, _| velocity, (f64::INFINITY, f64::INFINITY)),
            inertial_lost_s: (f64::INFINITY, f64::INFINITY),
            compass_turned: (0.0, f64::INFINITY),
            slow_errors: true,
            force_range: f64::INFINITY,
            drifts: ([0.0; 3], [0.0; 3], f64::INFINITY),
            jumps: ([0.0; 3], f64::INFINITY),
            force_jumps: ([0.0; 3], f64::INFINITY),
        }
    }
}

/// A flight, its sensors and the filter.
pub(crate) struct Run {
    pub(crate) flight: Flight,
    pub(crate) navigation: KalmanNavigation,
    pub(crate) solution: Solution,
    fitted: Fitted,
    random: Random,
    rate_bias: [f64; 3],
    force_bias: [f64; 3],
    hard_iron: [f64; 3],
    drift: [f64; 3],
    late: VecDeque<(f64, Truth)>,
    /// What the receiver shows where it stands.
    stands: Truth,
    steps: u64,
}

impl Run {
    pub(crate) fn new(flight: Flight, fitted: Fitted, seed: u64) -> Self {
        let mut random = Random::new(seed);
        let stands = flight.now;
        let slow = f64::from(u8::from(fitted.slow_errors));
        Self {
            flight,
            navigation: KalmanNavigation::new(KalmanConfig {
                delay: Duration::from_secs_f64(RECEIVER_DELAY_S),
                earth_field_ut: Some(FIELD_UT),
            }),
            solution: Solution::UNKNOWN,
            fitted,
            rate_bias: random.vector(0.01),
            force_bias: random.vector(0.04),
            hard_iron: random.vector(1.0),
            drift: random.vector(1.5 * slow),
            random,
            late: VecDeque::new(),
            stands,
            steps: 0,
        }
    }

    /// Flies until a time, and calls a function after each step.
    pub(crate) fn until(&mut self, time_s: f64, mut each: impl FnMut(&Truth, &Solution)) {
        while self.flight.now.time_s < time_s - 1e-9 {
            self.step();
            each(&self.flight.now, &self.solution);
        }
    }

    fn step(&mut self) {
        self.flight.step(STEP_S);
        self.steps += 1;
        let truth = self.flight.now;
        let now = time(truth.time_s);
        let noisy = |random: &mut Random, value: [f64; 3], bias: [f64; 3], sigma: f64| {
            let noise = random.vector(sigma);
            [0, 1, 2].map(|axis| value[axis] + bias[axis] + noise[axis])
        };
        let (rate_drift, force_drift, from_s) = self.fitted.drifts;
        let since_s = (truth.time_s - from_s).max(0.0);
        let drifted =
            |bias: [f64; 3], by: [f64; 3]| [0, 1, 2].map(|at| bias[at] + by[at] * since_s);
        let jumped = |bias: [f64; 3], (jump, at_s): ([f64; 3], f64)| {
            let has_jumped = f64::from(u8::from(truth.time_s >= at_s));
            [0, 1, 2].map(|axis| bias[axis] + jump[axis] * has_jumped)
        };
        let rate_bias = jumped(drifted(self.rate_bias, rate_drift), self.fitted.jumps);
        let force_bias = drifted(self.force_bias, force_drift);
        let force_bias = jumped(force_bias, self.fitted.force_jumps);
        // 0.01 °/s/√Hz, 300 µg/√Hz.
        let rates = noisy(&mut self.random, truth.rates, rate_bias, 0.0012);
        let range = self.fitted.force_range;
        let force = noisy(&mut self.random, truth.force, force_bias, 0.02)
            .map(|axis| axis.clamp(-range, range));
        let (lost_s, back_s) = self.fitted.inertial_lost_s;
        if !(lost_s..back_s).contains(&truth.time_s) {
            self.navigation.observe(now, Observation::Rates(rates));
            self.navigation
                .observe(now, Observation::SpecificForce(force));
        }
        if self.fitted.compass && self.steps.is_multiple_of(2) {
            let field = self.field(&truth);
            let field = noisy(&mut self.random, field, self.hard_iron, 0.5);
            self.navigation
                .observe(now, Observation::MagneticField(field));
        }
        if self.steps.is_multiple_of(2) {
            let slow = f64::from(u8::from(self.fitted.slow_errors));
            let wave = 2.0 * slow * (truth.time_s / 80.0).sin();
            let altitude = truth.place.altitude_m + wave + self.random.normal(0.3);
            let pressure = Observation::StaticPressure(pressure_pa(altitude));
            self.navigation.observe(now, pressure);
        }
        if self.fitted.airspeed && self.steps.is_multiple_of(5) {
            let density = 1.0 / true_airspeed_mps(1.0, truth.place.altitude_m);
            let equivalent = truth.airspeed * density + self.random.normal(0.3);
            self.navigation
                .observe(now, Observation::Airspeed(equivalent));
        }
        self.receive(&truth);
        self.solution = self.navigation.step(now);
    }

    fn field(&self, truth: &Truth) -> [f64; 3] {
        let (angle, from_s) = self.fitted.compass_turned;
        let (sin, cos) = if truth.time_s >= from_s {
            angle.sin_cos()
        } else {
            (0.0, 1.0)
        };
        let [north, east, down] = FIELD_UT;
        let turned = [north * cos - east * sin, north * sin + east * cos, down];
        earth_to_body(truth.quaternion, turned)
    }

    /// 5 Hz: 0.5 m white and 1.5 m over 100 s, 0.1 m/s.
    fn receive(&mut self, truth: &Truth) {
        if self.fitted.receiver && self.steps.is_multiple_of(10) {
            let lost = self.fitted.receiver_lost_s;
            if !(lost.0..lost.1).contains(&truth.time_s) {
                let (late_s, (from_s, to_s)) = self.fitted.receiver_late;
                let is_late = (from_s..to_s).contains(&truth.time_s);
                let late_s = if is_late {
                    late_s.min((truth.time_s - from_s) * self.fitted.later_by)
                } else {
                    0.0
                };
                let (from_s, to_s) = self.fitted.receiver_stands_s;
                if truth.time_s < from_s {
                    self.stands = *truth;
                }
                let shown = if (from_s..to_s).contains(&truth.time_s) {
                    Truth {
                        velocity: [0.0; 3],
                        ..self.stands
                    }
                } else {
                    *truth
                };
                self.late
                    .push_back((truth.time_s + RECEIVER_DELAY_S + late_s, shown));
            }
            if self.fitted.slow_errors {
                let kept = (-0.2_f64 / 100.0).exp();
                let renewed = self.random.vector(1.5 * (1.0 - kept * kept).sqrt());
                self.drift = [0, 1, 2].map(|axis| kept * self.drift[axis] + renewed[axis]);
            }
        }
        while let Some((arrival_s, then)) = self.late.front().copied() {
            if arrival_s > truth.time_s + 1e-9 {
                break;
            }
            self.late.pop_front();
            let taken = time(arrival_s - RECEIVER_DELAY_S);
            let noise = self.random.vector(0.5);
            let off = [0, 1, 2].map(|axis| noise[axis] + self.drift[axis]);
            let (north, east) = metres_per_radian(then.place.latitude_rad, then.place.altitude_m);
            let place = GeodeticPosition {
                latitude_rad: then.place.latitude_rad + off[0] / north,
                longitude_rad: then.place.longitude_rad + off[1] / east,
                altitude_m: then.place.altitude_m - off[2],
            };
            self.navigation.observe(taken, Observation::Position(place));
            let noise = self.random.vector(0.1);
            let mut velocity = [0, 1, 2].map(|axis| then.velocity[axis] + noise[axis]);
            let (fault, (from_s, to_s)) = self.fitted.velocity_fault;
            if (from_s..to_s).contains(&then.time_s) {
                velocity = fault(velocity, then.time_s - from_s, &mut self.random);
            }
            self.navigation
                .observe(taken, Observation::Velocity(velocity));
        }
    }
}

pub(crate) fn time(seconds: f64) -> Time {
    Time::from_nanos((seconds * 1e9).round() as i64)
}
