//! The share of full thrust that hovering takes, from what thrust does.

use fcc_core::units::GRAVITY_MPS2;

/// How fast it can change, 1/√s: a battery that sags within minutes (PX4: 0.0036).
const NOISE_PER_ROOT_S: f64 = 0.003_6;
/// Of the measured specific force: gusts of this size, m/s², that last so long, s. With the above
/// it follows within some 10 s (`ArduPilot`: 10 s).
const GUSTS_MPS2: f64 = 2.0;
const GUSTS_S: f64 = 0.2;
/// Beyond so many times a gust it is the ground.
const GATE: f64 = 3.0;
/// The time constant of the surplus, s, and the most of it, m/s².
const SURPLUS_S: f64 = 0.05;
const MOST_SURPLUS_MPS2: f64 = 4.0;
/// Uncertainty at the start.
const START: f64 = 0.02;

/// Estimates the hover thrust h from f = g u / h: u is the share of thrust that is given, f the
/// specific force along the thrust. A Kalman filter of one state.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct HoverThrust {
    share: f64,
    variance: f64,
    /// The share given, as late as the motors and the sensors are.
    given: f64,
    lag_s: f64,
    surplus_mps2: f64,
}

impl HoverThrust {
    /// Begins at a share; what is given acts after `lag_s`.
    pub const fn new(share: f64, lag_s: f64) -> Self {
        Self {
            share,
            variance: START * START,
            given: 0.0,
            lag_s,
            surplus_mps2: 0.0,
        }
    }

    /// The share of full thrust that hovering takes.
    pub const fn share(&self) -> f64 {
        self.share
    }

    /// What the air gives beyond what thrust does, smoothed, m/s²: gusts along the rotors' axes.
    pub const fn surplus_mps2(&self) -> f64 {
        self.surplus_mps2
    }

    /// Takes a tick in flight; returns the share before over that after it.
    pub fn update(&mut self, given: f64, specific_mps2: f64, dt_s: f64) -> f64 {
        self.given += (given - self.given) * (dt_s / (self.lag_s + dt_s));
        self.variance += NOISE_PER_ROOT_S * NOISE_PER_ROOT_S * dt_s;
        if self.given < 0.5 * self.share {
            return 1.0;
        }
        let expected = GRAVITY_MPS2 * self.given / self.share;
        let slope = -expected / self.share;
        let noise = GUSTS_MPS2 * GUSTS_MPS2 * (GUSTS_S / dt_s).max(1.0);
        let spread = slope * slope * self.variance + noise;
        let innovation = specific_mps2 - expected;
        let surplus = innovation.clamp(-MOST_SURPLUS_MPS2, MOST_SURPLUS_MPS2);
        self.surplus_mps2 += (surplus - self.surplus_mps2) * (dt_s / (SURPLUS_S + dt_s));
        if innovation.abs() > GATE * GUSTS_MPS2 {
            return 1.0;
        }
        let before = self.share;
        let gain = self.variance * slope / spread;
        self.share = (self.share + gain * innovation).clamp(0.1, 0.8);
        self.variance *= 1.0 - gain * slope;
        before / self.share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A battery sags: the same speed gives 10 % less within a minute.
    #[test]
    fn it_follows_a_battery_that_sags() {
        let mut hover = HoverThrust::new(0.4, 0.03);
        let (mut truth, dt_s) = (0.45, 0.0025);
        for tick in 0..24_000_u32 {
            truth += 0.045 / 24_000.0;
            // A climb and a descent of 2 m/s² by turns.
            let up = if tick / 400 % 2 == 0 { 2.0 } else { -2.0 };
            let specific = GRAVITY_MPS2 + up;
            hover.update(truth * specific / GRAVITY_MPS2, specific, dt_s);
        }
        assert!((hover.share() - truth).abs() < 0.01, "{}", hover.share());
    }

    /// On the ground the specific force is g whatever the rotors give.
    #[test]
    fn a_force_that_does_not_fit_is_not_used() {
        let mut hover = HoverThrust::new(0.4, 0.0);
        for _ in 0..4_000 {
            hover.update(0.4, GRAVITY_MPS2, 0.0025);
        }
        let settled = hover.share();
        hover.update(0.7, GRAVITY_MPS2, 0.0025);
        assert_eq!(hover.share(), settled, "{settled}");
    }
}
