//! Gusts after Dryden: MIL-F-8785C (1980), 3.7.
//!
//! White noise through forming filters. Each filter is discretised exactly for
//! the present step (Van Loan's integral, in closed form), so that variance and
//! correlation do not depend on the step. Filters run with unit variance and
//! their output is scaled, so that a change of height scales the present gust
//! and does not start a new one.
//!
//! Gusts are applied in body axes at every height.

use libm::{cbrt, exp, pow, sqrt};
use nalgebra::Vector3;

use crate::gauss::{Gauss, Stream};
use crate::units::{FOOT_M, KNOT_MPS};

/// The severity of the turbulence.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Severity {
    /// 15 kt of wind 20 ft above the ground; aloft exceeded one time in 10².
    Light,
    /// 30 kt; one time in 10³.
    Moderate,
    /// 45 kt; one time in 10⁵.
    Severe,
}

/// Scale lengths and standard deviations of the gusts at one height. Along
/// (u) and across (v) the aircraft they are the same.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Scales {
    /// Of u and v, m.
    pub horizontal_length_m: f64,
    /// Of w, m.
    pub vertical_length_m: f64,
    /// Of u and v, m/s.
    pub horizontal_sigma_mps: f64,
    /// Of w, m/s.
    pub vertical_sigma_mps: f64,
}

/// Below this height, ft, the low-altitude model holds.
const LOW_FT: f64 = 1000.0;
/// Above this height, ft, the medium- and high-altitude model holds.
const HIGH_FT: f64 = 2000.0;
/// Below this height, ft, the specification gives nothing.
const LOWEST_FT: f64 = 10.0;
/// Scale length above 2,000 ft, ft.
const HIGH_LENGTH_FT: f64 = 1750.0;

/// MIL-F-8785C figure 7: height in ft, then the standard deviation in ft/s
/// that is exceeded with probability 10⁻², 10⁻³ and 10⁻⁵.
const FIGURE_7: [[f64; 4]; 8] = [
    [1_750.0, 6.9, 9.6, 17.6],
    [3_750.0, 7.4, 10.6, 23.0],
    [7_500.0, 6.7, 10.1, 23.6],
    [15_000.0, 4.6, 8.0, 22.1],
    [25_000.0, 2.7, 6.6, 20.0],
    [35_000.0, 0.4, 5.0, 16.0],
    [45_000.0, 0.0, 4.2, 15.1],
    [55_000.0, 0.0, 2.7, 12.1],
];

impl Severity {
    /// Wind at 20 ft, m/s.
    fn low_wind_mps(self) -> f64 {
        KNOT_MPS
            * match self {
                Self::Light => 15.0,
                Self::Moderate => 30.0,
                Self::Severe => 45.0,
            }
    }

    /// The scales at a height in m.
    pub fn scales(self, height_m: f64) -> Scales {
        let height_ft = height_m / FOOT_M;
        if height_ft <= LOW_FT {
            return self.low(height_ft);
        }
        if height_ft >= HIGH_FT {
            return self.high(height_ft);
        }
        let share = (height_ft - LOW_FT) / (HIGH_FT - LOW_FT);
        let (low, high) = (self.low(LOW_FT), self.high(HIGH_FT));
        let between = |a: f64, b: f64| a + share * (b - a);
        Scales {
            horizontal_length_m: between(low.horizontal_length_m, high.horizontal_length_m),
            vertical_length_m: between(low.vertical_length_m, high.vertical_length_m),
            horizontal_sigma_mps: between(low.horizontal_sigma_mps, high.horizontal_sigma_mps),
            vertical_sigma_mps: between(low.vertical_sigma_mps, high.vertical_sigma_mps),
        }
    }

    fn low(self, height_ft: f64) -> Scales {
        let height_ft = height_ft.max(LOWEST_FT);
        let shape = 0.177 + 0.000_823 * height_ft;
        let vertical_sigma_mps = 0.1 * self.low_wind_mps();
        Scales {
            horizontal_length_m: height_ft * FOOT_M / pow(shape, 1.2),
            vertical_length_m: height_ft * FOOT_M,
            horizontal_sigma_mps: vertical_sigma_mps / pow(shape, 0.4),
            vertical_sigma_mps,
        }
    }

    fn high(self, height_ft: f64) -> Scales {
        let of_row = |row: &[f64; 4]| {
            let [_, light, moderate, severe] = *row;
            match self {
                Self::Light => light,
                Self::Moderate => moderate,
                Self::Severe => severe,
            }
        };
        let mut sigma_fps = FIGURE_7.first().map_or(0.0, of_row);
        for (below, above) in FIGURE_7.iter().zip(FIGURE_7.iter().skip(1)) {
            let ([from, ..], [to, ..]) = (*below, *above);
            let share = ((height_ft - from) / (to - from)).clamp(0.0, 1.0);
            if share > 0.0 {
                sigma_fps = of_row(below) + share * (of_row(above) - of_row(below));
            }
        }
        Scales {
            horizontal_length_m: HIGH_LENGTH_FT * FOOT_M,
            vertical_length_m: HIGH_LENGTH_FT * FOOT_M,
            horizontal_sigma_mps: sigma_fps * FOOT_M,
            vertical_sigma_mps: sigma_fps * FOOT_M,
        }
    }
}

/// Gusts along a flight.
#[derive(Clone, Debug)]
pub struct Dryden {
    severity: Severity,
    gauss: Gauss,
    along: f64,
    across: SecondOrder,
    vertical: SecondOrder,
    roll: f64,
    /// Gusts at the tail, for the air's turn rates.
    across_passed_mps: f64,
    vertical_passed_mps: f64,
}

/// The gust at one moment, body axes.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Gust {
    /// Velocity of the air, m/s.
    pub velocity_mps: Vector3<f64>,
    /// Turn rate of the air, rad/s.
    pub rates_radps: Vector3<f64>,
}

impl Dryden {
    /// Gusts of a severity. They are present from the start: the filters begin
    /// in a random sample of their steady state.
    pub fn new(severity: Severity, seed: u64) -> Self {
        let mut gauss = Gauss::new(seed, Stream::Gusts);
        Self {
            severity,
            along: gauss.draw(),
            across: SecondOrder::steady(&mut gauss),
            vertical: SecondOrder::steady(&mut gauss),
            roll: gauss.draw(),
            across_passed_mps: 0.0,
            vertical_passed_mps: 0.0,
            gauss,
        }
    }

    /// The gust `dt_s` later, for an aircraft of a true airspeed in m/s, a
    /// height above ground and a span in m.
    pub fn step(&mut self, dt_s: f64, airspeed_mps: f64, height_m: f64, span_m: f64) -> Gust {
        /// A lower bound of the airspeed, m/s, below that of any aircraft here:
        /// the gust field is fixed in space and the filters need a speed
        /// through it.
        const SLOWEST_MPS: f64 = 5.0;
        let speed = airspeed_mps.max(SLOWEST_MPS);
        let scales = self.severity.scales(height_m);
        let moved_m = speed * dt_s;

        let kept = exp(-moved_m / scales.horizontal_length_m);
        self.along = kept * self.along + sqrt(1.0 - kept * kept) * self.gauss.draw();
        let along = scales.horizontal_sigma_mps * self.along;
        let across = scales.horizontal_sigma_mps
            * self
                .across
                .step(moved_m / scales.horizontal_length_m, &mut self.gauss);
        let vertical = scales.vertical_sigma_mps
            * self
                .vertical
                .step(moved_m / scales.vertical_length_m, &mut self.gauss);

        // Turn rates of the air: the specification's filters applied to v and
        // w, with the lengths 3b/π and 4b/π, and a separate one for roll.
        let yaw_length_m = 3.0 * span_m / core::f64::consts::PI;
        let pitch_length_m = 4.0 * span_m / core::f64::consts::PI;
        self.across_passed_mps +=
            (1.0 - exp(-moved_m / yaw_length_m)) * (across - self.across_passed_mps);
        let pitch_kept = exp(-moved_m / pitch_length_m);
        self.vertical_passed_mps += (1.0 - pitch_kept) * (vertical - self.vertical_passed_mps);
        self.roll =
            pitch_kept * self.roll + sqrt(1.0 - pitch_kept * pitch_kept) * self.gauss.draw();
        Gust {
            velocity_mps: Vector3::new(along, across, vertical),
            rates_radps: Vector3::new(
                roll_sigma_radps(&scales, span_m) * self.roll,
                -(vertical - self.vertical_passed_mps) / pitch_length_m,
                (across - self.across_passed_mps) / yaw_length_m,
            ),
        }
    }
}

/// Standard deviation of the air's roll rate, rad/s: the specification's
/// spectrum Φp, integrated over all frequencies.
pub fn roll_sigma_radps(scales: &Scales, span_m: f64) -> f64 {
    use core::f64::consts::PI;
    let length_m = scales.vertical_length_m;
    let variance = 0.8 * PI * PI / (8.0 * span_m * length_m) * cbrt(PI * length_m / (4.0 * span_m));
    scales.vertical_sigma_mps * sqrt(variance)
}

/// Unit variance through `(1 + √3·T·s)/(1 + T·s)²`: the shape of v and w.
///
/// Two lags in a row, `x` with unit variance and `y` that follows it; the
/// filter's output is `√3·x + (1 - √3)·y`, of variance 2.
#[derive(Clone, Copy, Debug)]
struct SecondOrder {
    x: f64,
    y: f64,
}

impl SecondOrder {
    /// Steady covariance: var x = 1, cov = var y = 1/2.
    fn steady(gauss: &mut Gauss) -> Self {
        let x = gauss.draw();
        Self {
            x,
            y: 0.5 * (x + gauss.draw()),
        }
    }

    /// Output after a step of `ratio` time constants.
    fn step(&mut self, ratio: f64, gauss: &mut Gauss) -> f64 {
        let kept = exp(-ratio);
        let square = kept * kept;
        // The covariance that the noise must add to keep it steady: P - Φ·P·Φᵀ.
        let xx = 1.0 - square;
        let xy = 0.5 - square * (0.5 + ratio);
        let yy = 0.5 - square * (0.5 + ratio + ratio * ratio);
        let (first, second) = (gauss.draw(), gauss.draw());
        let spread = sqrt(xx);
        let shared = if spread > 0.0 { xy / spread } else { 0.0 };
        let own = sqrt((yy - shared * shared).max(0.0));
        self.y = kept * (self.y + ratio * self.x) + shared * first + own * second;
        self.x = kept * self.x + spread * first;

        let root_3 = 1.732_050_807_568_877_2_f64;
        (root_3 * self.x + (1.0 - root_3) * self.y) * core::f64::consts::FRAC_1_SQRT_2
    }
}
