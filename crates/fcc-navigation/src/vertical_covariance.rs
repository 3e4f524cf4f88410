//! The covariance of the vertical channel's altitude, climb rate and bias.
//!
//! The gains depend on ratios only, so the barometer's noise is fixed and the
//! other densities are relative to it.

/// The barometer's noise, as a spectral density, m² s: 0.76 m of one sigma, 40
/// times a second.
const ALTITUDE_NOISE: f64 = 0.0145;

/// Bandwidth of the bias estimate, rad/s: a change of the bias is tracked
/// within about the inverse of this.
const BIAS_BANDWIDTH_RADPS: f64 = 0.1;

/// The density used without an accelerometer, m²/s³: the aircraft may
/// accelerate by a tenth of a g for a second.
const UNFELT_NOISE: f64 = 1.0;

/// One sigma of the climb rate before anything is known, m/s.
const FIRST_CLIMB_RATE_MPS: f64 = 5.0;

/// One sigma of the accelerometer's bias before anything is known, m/s²: 10 mg,
/// and the difference of gravity between the equator and the poles.
const FIRST_BIAS_MPS2: f64 = 0.1;

/// Readings of a coarse altimeter this far apart count as independent, s: about
/// as long as an aircraft in level flight stays within half a step of 100 ft by
/// its accelerometers alone.
const SAME_STEP_S: f64 = 1.0;

/// What a coarse altimeter leaves unknown of the vertical acceleration, m²/s³: 0.03 m/s² with
/// the wings level, and banked by an attitude that is off by 1°, 0.17 m/s² tan φ, both for
/// 10 s: 2 σ² τ. Finer ones correct it at once.
const COARSE_NOISE: f64 = 0.02;
const COARSE_BANKED_NOISE: f64 = 0.6;

/// The first altitude is weighted as a sample of this length, s.
const FIRST_SAMPLE_S: f64 = 0.025;

/// Covariance of altitude (h), climb rate (v) and the accelerometer's bias (b).
#[derive(Clone, Copy, Debug)]
pub(super) struct VerticalCovariance {
    /// Spectral densities: of the accelerometer, m²/s³, and of its bias, m²/s⁵.
    acceleration_noise: f64,
    bias_noise: f64,
    hh: f64,
    hv: f64,
    hb: f64,
    vv: f64,
    vb: f64,
    bb: f64,
}

/// The gains per metre of altitude error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gains {
    /// To the altitude, 0..=1.
    pub(super) altitude: f64,
    /// To the climb rate, 1/s.
    pub(super) climb_rate_per_s: f64,
    /// To the bias, 1/s²; negative.
    pub(super) bias_per_s2: f64,
    /// Inverse of the variance of the altitude error, 1/m².
    per_variance: f64,
}

impl Gains {
    /// The variance of the altitude error that was expected, m².
    pub(super) fn variance_m2(&self) -> f64 {
        1.0 / self.per_variance
    }
}

impl VerticalCovariance {
    /// The initial covariance. In the steady state the barometer determines
    /// frequencies below `bandwidth_radps`, the accelerometer those above: for
    /// white noise on both that is the fourth root of the ratio of their
    /// densities.
    pub(super) const fn new(bandwidth_radps: f64) -> Self {
        let squared = bandwidth_radps * bandwidth_radps;
        let bias_squared = BIAS_BANDWIDTH_RADPS * BIAS_BANDWIDTH_RADPS;
        let mut covariance = Self {
            acceleration_noise: ALTITUDE_NOISE * squared * squared,
            bias_noise: ALTITUDE_NOISE * bias_squared * bias_squared * bias_squared,
            hh: 0.0,
            hv: 0.0,
            hb: 0.0,
            vv: 0.0,
            vb: 0.0,
            bb: 0.0,
        };
        covariance.restart();
        covariance
    }

    /// Restarts from a measured altitude, without other information.
    pub(super) const fn restart(&mut self) {
        self.hh = ALTITUDE_NOISE / FIRST_SAMPLE_S;
        self.vv = FIRST_CLIMB_RATE_MPS * FIRST_CLIMB_RATE_MPS;
        self.bb = FIRST_BIAS_MPS2 * FIRST_BIAS_MPS2;
        self.hv = 0.0;
        self.hb = 0.0;
        self.vb = 0.0;
    }

    /// `dt_s` seconds pass, with or without an accelerometer.
    pub(super) fn predict(&mut self, measured: bool, dt_s: f64) {
        if measured {
            // v -= b dt
            self.hv -= self.hb * dt_s;
            self.vv += (self.bb * dt_s - 2.0 * self.vb) * dt_s;
            self.vb -= self.bb * dt_s;
        }
        // h += v dt
        self.hh += (2.0 * self.hv + self.vv * dt_s) * dt_s;
        self.hv += self.vv * dt_s;
        self.hb += self.vb * dt_s;
        self.vv += dt_s
            * if measured {
                self.acceleration_noise
            } else {
                UNFELT_NOISE
            };
        self.bb += self.bias_noise * dt_s;
    }

    /// The same pass with a coarse altimeter, at a bank of this tangent: the accelerometer is
    /// known less.
    pub(super) fn predict_coarse(&mut self, tan_bank: f64, dt_s: f64) {
        let tan_squared = (tan_bank * tan_bank).min(1.0);
        self.vv += (COARSE_NOISE + COARSE_BANKED_NOISE * tan_squared) * dt_s;
    }

    /// `passed_s` seconds pass in which nothing was measured, however many. The
    /// climb rate's random walk has by then also moved the altitude: white
    /// acceleration of density q adds q T³/3, q T²/2 and q T to the variances
    /// (Bar-Shalom, Li and Kirubarajan 2001, section 6.2.2). Between two ticks
    /// only the last of these matters.
    pub(super) fn coast(&mut self, passed_s: f64) {
        self.predict(false, passed_s);
        let noise = UNFELT_NOISE * passed_s * passed_s;
        self.hh += noise * passed_s / 3.0;
        self.hv += noise / 2.0;
    }

    /// Corrects by an altitude, `since_s` seconds after the previous one.
    pub(super) fn correct(&mut self, since_s: f64) -> Gains {
        self.correct_by(ALTITUDE_NOISE / since_s)
    }

    /// Corrects by the moment in which a coarse altimeter changed, known to
    /// within `since_s` at this climb rate: an error that is uniform in that
    /// interval.
    pub(super) fn correct_by_edge(&mut self, climb_rate_mps: f64, since_s: f64) -> Gains {
        let passed_m = climb_rate_mps * since_s;
        self.correct_by(ALTITUDE_NOISE / FIRST_SAMPLE_S + passed_m * passed_m / 12.0)
    }

    /// Corrects by an altitude known to within a step, uniformly. The error of
    /// the readings between two changes is the same in all of them, so they
    /// count as one in [`SAME_STEP_S`].
    pub(super) fn correct_by_step(&mut self, step_m: f64, since_s: f64) -> Gains {
        self.correct_by(step_m * step_m / 12.0 * SAME_STEP_S / since_s)
    }

    /// The altitude is known to within a step only.
    pub(super) const fn widen(&mut self, step_m: f64) {
        self.hh = self.hh.max(step_m * step_m / 12.0);
    }

    /// Corrects by an altitude of this variance, m².
    fn correct_by(&mut self, variance: f64) -> Gains {
        let per_variance = 1.0 / (self.hh + variance);
        let gains = Gains {
            altitude: self.hh * per_variance,
            climb_rate_per_s: self.hv * per_variance,
            bias_per_s2: self.hb * per_variance,
            per_variance,
        };
        self.vv -= gains.climb_rate_per_s * self.hv;
        self.vb -= gains.climb_rate_per_s * self.hb;
        self.bb -= gains.bias_per_s2 * self.hb;
        let left = 1.0 - gains.altitude;
        self.hh *= left;
        self.hv *= left;
        self.hb *= left;
        gains
    }

    /// The covariance of the present altitude with the state.
    pub(super) const fn of_altitude(&self) -> CrossCovariance {
        CrossCovariance {
            h: self.hh,
            v: self.hv,
            b: self.hb,
        }
    }
}

/// Covariance of a past quantity with the present altitude, climb rate and
/// bias.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CrossCovariance {
    h: f64,
    v: f64,
    b: f64,
}

impl CrossCovariance {
    /// As [`VerticalCovariance::predict`].
    pub(super) fn predict(&mut self, measured: bool, dt_s: f64) {
        if measured {
            self.v -= self.b * dt_s;
        }
        self.h += self.v * dt_s;
    }

    /// As [`VerticalCovariance::correct`]; returns the gain of the past
    /// quantity per metre of altitude error.
    pub(super) fn correct(&mut self, gains: &Gains) -> f64 {
        let gain = self.h * gains.per_variance;
        self.v -= self.h * gains.climb_rate_per_s;
        self.b -= self.h * gains.bias_per_s2;
        self.h -= self.h * gains.altitude;
        gain
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT_S: f64 = 0.025;

    /// The steady filter of a double integrator with both noises white, r and q
    /// = ω⁴ r. From its Riccati equation: 2 hv = hh²/r, vv = hh hv/r, q =
    /// hv²/r, so the gains are √2 ω and ω². The bias adds a little.
    #[test]
    fn the_steady_gains_are_those_of_the_textbook() {
        let bandwidth = 0.6;
        let mut covariance = VerticalCovariance::new(bandwidth);
        let mut gains = covariance.correct(DT_S);
        for _ in 0..40_000 {
            covariance.predict(true, DT_S);
            gains = covariance.correct(DT_S);
        }
        let altitude = gains.altitude / DT_S / (core::f64::consts::SQRT_2 * bandwidth);
        let climb_rate = gains.climb_rate_per_s / DT_S / (bandwidth * bandwidth);
        assert!((0.97..1.05).contains(&altitude), "{altitude}");
        assert!((0.97..1.05).contains(&climb_rate), "{climb_rate}");
    }

    /// A straight line fitted to N samples: the variance of its end is 4/N of a
    /// sample's, of its slope 12/(N³ dt²) (Bar-Shalom, Li and Kirubarajan 2001,
    /// section 3.5). The bias is small enough not to matter in this time.
    #[test]
    fn at_first_it_fits_a_straight_line() {
        let mut covariance = VerticalCovariance::new(0.01);
        let samples = 40;
        for _ in 1..samples {
            covariance.predict(true, DT_S);
            covariance.correct(DT_S);
        }
        let n = f64::from(samples);
        let end = covariance.hh / (ALTITUDE_NOISE / DT_S) / (4.0 / n);
        let slope = covariance.vv / (ALTITUDE_NOISE / DT_S) / (12.0 / (n * n * n * DT_S * DT_S));
        assert!((0.9..1.1).contains(&end), "{end}");
        assert!((0.9..1.1).contains(&slope), "{slope}");
    }

    /// After a gap the altitude that returns says what the mean climb rate was,
    /// and the climb rate at the end is 3/2 of the change of that: a gain of
    /// 3/(2T) if it was known well before. The same in one step or in many.
    #[test]
    fn an_altitude_after_a_gap_corrects_by_the_mean_climb_rate() {
        for gap_s in [3.0, 12.0, 60.0] {
            let mut covariance = VerticalCovariance::new(0.7);
            for _ in 0..4_000 {
                covariance.predict(true, DT_S);
                covariance.correct(DT_S);
            }
            let mut in_steps = covariance;
            covariance.coast(gap_s);
            for _ in 0..600 {
                in_steps.coast(gap_s / 600.0);
            }
            for (one, many) in [
                (covariance.hh, in_steps.hh),
                (covariance.hv, in_steps.hv),
                (covariance.vv, in_steps.vv),
            ] {
                assert!((one / many - 1.0).abs() < 1e-9, "{one} or {many}");
            }
            let gain = covariance.correct(DT_S).climb_rate_per_s * gap_s;
            assert!((1.35..1.55).contains(&gain), "{gain} after {gap_s} s");
        }
    }

    #[test]
    fn it_stays_a_covariance() {
        let mut covariance = VerticalCovariance::new(2.0);
        for n in 0..200_000 {
            covariance.predict(n % 7 != 0, if n % 11 == 0 { 0.2 } else { 0.001 });
            if n % 3 == 0 {
                covariance.correct(0.02);
            }
            assert!(covariance.hh > 0.0 && covariance.vv > 0.0 && covariance.bb > 0.0);
            assert!(covariance.hv * covariance.hv <= covariance.hh * covariance.vv);
        }
    }
}
