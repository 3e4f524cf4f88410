//! Sensors with the very errors that the filter expects: its parameters, as
//! `kalman/parameters.rs` states them.

use fcc_core::flight::atmosphere::pressure_pa;
use fcc_core::flight::earth::metres_per_radian;
use fcc_core::flight::orientation::earth_to_body;
use fcc_navigation::inertial::{
    GeodeticPosition, InertialNavigation, KalmanConfig, KalmanNavigation, Observation, Solution,
};

use super::flight::{Flight, Truth};
use super::noise::Random;
use super::sensors::{FIELD_UT, STEP_S, time};

/// An error with a standard deviation that is another one after a time
/// (first-order Gauss-Markov; Gelb 1974, section 3.8).
struct Lasting<const N: usize> {
    sigma: [f64; N],
    tau_s: f64,
    now: [f64; N],
}

impl<const N: usize> Lasting<N> {
    fn new(random: &mut Random, sigma: [f64; N], tau_s: f64) -> Self {
        let now = sigma.map(|sigma| random.normal(sigma));
        Self { sigma, tau_s, now }
    }

    fn after(&mut self, random: &mut Random, dt_s: f64) -> [f64; N] {
        let kept = (-dt_s / self.tau_s).exp();
        let renewed = (1.0 - kept * kept).sqrt();
        for (now, sigma) in self.now.iter_mut().zip(self.sigma) {
            *now = kept * *now + renewed * random.normal(sigma);
        }
        self.now
    }
}

/// What walks at random, by a standard deviation over the root of a second.
struct Walk<const N: usize> {
    density: f64,
    now: [f64; N],
}

impl<const N: usize> Walk<N> {
    fn after(&mut self, random: &mut Random, dt_s: f64) -> [f64; N] {
        let step = self.density * dt_s.sqrt();
        for now in &mut self.now {
            *now += random.normal(step);
        }
        self.now
    }
}

/// A flight, these sensors and the filter. No sensor is late, and there is none of
/// airspeed.
pub(crate) struct Matched {
    pub(crate) flight: Flight,
    pub(crate) solution: Solution,
    navigation: KalmanNavigation,
    random: Random,
    rate_bias: Walk<3>,
    force_bias: Walk<3>,
    barometer_bias: Walk<1>,
    body_field: Walk<3>,
    earth_field: Walk<3>,
    field: Lasting<3>,
    barometer: Lasting<1>,
    position: Lasting<3>,
    velocity: Lasting<3>,
    steps: u64,
}

impl Matched {
    pub(crate) fn new(flight: Flight, seed: u64) -> Self {
        let mut random = Random::new(seed);
        let r = &mut random;
        let [north, east, down] = FIELD_UT;
        let strength = north.hypot(east).hypot(down);
        let model_error = r.vector(0.5);
        let walk = |density: f64, now: [f64; 3]| Walk { density, now };
        Self {
            rate_bias: walk(5e-5, r.vector(0.02)),
            force_bias: walk(5e-4, r.vector(0.05)),
            barometer_bias: Walk {
                density: 0.08,
                now: [r.normal(2.0)],
            },
            body_field: walk(0.02, r.vector(2.0)),
            earth_field: walk(0.01, [0, 1, 2].map(|at| FIELD_UT[at] + model_error[at])),
            field: Lasting::new(r, [1.0_f64.hypot(0.05 * strength); 3], 10.0),
            barometer: Lasting::new(r, [1.0], 0.5),
            position: Lasting::new(r, [1.5, 1.5, 3.0], 1.0),
            velocity: Lasting::new(r, [0.3, 0.3, 0.5], 0.2),
            flight,
            solution: Solution::UNKNOWN,
            navigation: KalmanNavigation::new(KalmanConfig {
                delay: std::time::Duration::ZERO,
                earth_field_ut: Some(FIELD_UT),
            }),
            random,
            steps: 0,
        }
    }

    pub(crate) fn until(&mut self, time_s: f64) {
        while self.flight.now.time_s < time_s - 1e-9 {
            self.step();
        }
    }

    fn step(&mut self) {
        self.flight.step(STEP_S);
        self.steps += 1;
        let truth = self.flight.now;
        let now = time(truth.time_s);
        let (rates, force) = self.inertial(&truth);
        self.navigation.observe(now, Observation::Rates(rates));
        self.navigation
            .observe(now, Observation::SpecificForce(force));
        let earth_field = self.earth_field.after(&mut self.random, STEP_S);
        let body_field = self.body_field.after(&mut self.random, STEP_S);
        let bias_m = self.barometer_bias.after(&mut self.random, STEP_S)[0];
        if self.steps.is_multiple_of(2) {
            let field = earth_to_body(truth.quaternion, earth_field);
            let error = self.field.after(&mut self.random, 2.0 * STEP_S);
            let field = [0, 1, 2].map(|axis| field[axis] + body_field[axis] + error[axis]);
            self.navigation
                .observe(now, Observation::MagneticField(field));
            let [error_m] = self.barometer.after(&mut self.random, 2.0 * STEP_S);
            let altitude_m = truth.place.altitude_m + bias_m + error_m;
            let pressure = Observation::StaticPressure(pressure_pa(altitude_m));
            self.navigation.observe(now, pressure);
            self.receive(&truth);
        }
        self.solution = self.navigation.step(now);
    }

    /// White noise of 5·10⁻⁴ rad/√s and 0.02 m/s/√s; and errors of scale and axes,
    /// 1 % of the rate over one radian, 1 % of the acceleration over 0.2 s, as the
    /// white noise with the spectral density 2 σ² τ.
    fn inertial(&mut self, truth: &Truth) -> ([f64; 3], [f64; 3]) {
        let norm = |of: [f64; 3]| of.iter().map(|part| part * part).sum::<f64>().sqrt();
        let rate_density = 5e-4_f64.powi(2) + 2.0 * 0.01_f64.powi(2) * norm(truth.rates);
        let [x, y, z] = truth.acceleration;
        let by_scale = 0.01 * norm([x, y, z]);
        let force_density = 0.02_f64.powi(2) + 2.0 * by_scale * by_scale * 0.2;
        let random = &mut self.random;
        let rate_bias = self.rate_bias.after(random, STEP_S);
        let force_bias = self.force_bias.after(random, STEP_S);
        let white = random.vector((rate_density / STEP_S).sqrt());
        let rates = [0, 1, 2].map(|axis| truth.rates[axis] + rate_bias[axis] + white[axis]);
        let white = random.vector((force_density / STEP_S).sqrt());
        let force = [0, 1, 2].map(|axis| truth.force[axis] + force_bias[axis] + white[axis]);
        (rates, force)
    }

    /// 25 Hz: the filter takes an error that lasts for τ and comes every Δt for an
    /// independent one of the variance σ² (1 + 2 τ/Δt), which is so where τ is several
    /// times Δt; of a receiver's velocity τ is 0.2 s. At 5 Hz it is a third too
    /// large, and the filter less sure than it could be.
    fn receive(&mut self, truth: &Truth) {
        let now = time(truth.time_s);
        let off = self.position.after(&mut self.random, 2.0 * STEP_S);
        let (north, east) = metres_per_radian(truth.place.latitude_rad, truth.place.altitude_m);
        let place = GeodeticPosition {
            latitude_rad: truth.place.latitude_rad + off[0] / north,
            longitude_rad: truth.place.longitude_rad + off[1] / east,
            altitude_m: truth.place.altitude_m - off[2],
        };
        self.navigation.observe(now, Observation::Position(place));
        let off = self.velocity.after(&mut self.random, 2.0 * STEP_S);
        let velocity = [0, 1, 2].map(|axis| truth.velocity[axis] + off[axis]);
        self.navigation
            .observe(now, Observation::Velocity(velocity));
    }
}
