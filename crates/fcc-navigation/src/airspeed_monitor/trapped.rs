//! Whether an airspeed changes with height as that of a blocked pitot tube does.

use super::super::scalar_update::squared;
use super::DIFFERENCE_LAG_S;
use fcc_core::blocks::{LowPass, smoothing_factor};
use fcc_core::units::GRAVITY_MPS2;

/// What changed over this time, s, is compared.
const OVER_S: f64 = 1.0;
/// Standard deviation of what a blocked tube shows beside its law, m/s: noise and steps of sensor
/// and altimeter.
const NOISE_MPS: f64 = 0.2;
/// The least and the first standard deviation of what an open tube shows beside the
/// accelerometers, m/s; gusts and the errors of the accelerometers are learned over this time, s.
const LEAST_MPS: f64 = 0.3;
const FIRST_MPS: f64 = 0.5;
const LEARNED_OVER_S: f64 = 40.0;
/// A difference beyond so many standard deviations, and m/s, is learned as that.
const MOST_LEARNED_SDS: f64 = 3.0;
const MOST_LEARNED_MPS: f64 = 2.0;
/// Below this change by the law, m/s, nothing tells for it: in level flight a wind that changes
/// is felt, too, and not shown.
const TELLING_MPS: f64 = 0.4;
/// The logarithms of likelihood ratios: from this sum on a tube is blocked; what a second takes
/// away without evidence, and adds and takes away at most, for gusts last longer than a second;
/// from this sum on nothing is learned.
const BLOCKED: f64 = 8.0;
const TAKEN_PER_S: f64 = 1.0;
const MOST_PER_S: f64 = 2.0;
const LEAST_PER_S: f64 = -9.0;
const LEARNS_BELOW: f64 = 0.3 * BLOCKED;

/// What the sensor, the altimeter and the accelerometers show.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shown {
    pub(super) altitude_m: f64,
    pub(super) density_ratio: f64,
    pub(super) sensor_mps: f64,
    /// What the airspeed has changed by since the last tick by the accelerometers.
    pub(super) felt_mps: f64,
}

/// The total pressure of a blocked tube is trapped, so its dynamic pressure changes by
/// -dp = ρ g dh (FAA-H-8083-15B, chapter 5, blocked pitot tube and drain).
///
/// A cumulative sum (Page 1954) of the likelihood of this law against that of an open tube,
/// whose airspeed changes as the accelerometers feel, and with the gusts.
#[derive(Clone, Debug)]
pub(super) struct TrappedPressure {
    airspeed: LowPass,
    altitude: LowPass,
    felt: LowPass,
    is_begun: bool,
    /// What changed over the last second by that law; and beside it, by the sensor and by the
    /// accelerometers.
    law_mps: f64,
    shown_mps: f64,
    expected_mps: f64,
    /// The mean of their difference and its variance, learned.
    bias_mps: f64,
    variance_mps2: f64,
    evidence: f64,
    /// The airspeed by the accelerometers since there is evidence.
    known_mps: f64,
}

impl TrappedPressure {
    pub(super) const fn new() -> Self {
        Self {
            airspeed: LowPass::new(DIFFERENCE_LAG_S),
            altitude: LowPass::new(DIFFERENCE_LAG_S),
            felt: LowPass::new(DIFFERENCE_LAG_S),
            is_begun: false,
            law_mps: 0.0,
            shown_mps: 0.0,
            expected_mps: 0.0,
            bias_mps: 0.0,
            variance_mps2: FIRST_MPS * FIRST_MPS,
            evidence: 0.0,
            known_mps: 0.0,
        }
    }

    /// Begins anew with the next reading; what was learned is kept.
    pub(super) const fn reset(&mut self) {
        self.is_begun = false;
    }

    /// The airspeed by the accelerometers, m/s, once the tube is blocked.
    pub(super) fn step(&mut self, shown: &Shown, dt_s: f64) -> Option<f64> {
        if !self.is_begun {
            self.is_begun = true;
            self.airspeed.reset(shown.sensor_mps);
            self.altitude.reset(shown.altitude_m);
            self.felt.reset(shown.felt_mps);
            (self.law_mps, self.shown_mps, self.expected_mps) = (0.0, 0.0, 0.0);
            self.evidence = 0.0;
            return None;
        }
        let (from_mps, from_m) = (self.airspeed.output(), self.altitude.output());
        let airspeed_mps = self.airspeed.step(shown.sensor_mps, dt_s);
        let climbed_m = self.altitude.step(shown.altitude_m, dt_s) - from_m;
        let felt_mps = self.felt.step(shown.felt_mps, dt_s);
        // Of the square of the airspeed, indicated.
        let trapped_mps = GRAVITY_MPS2 * shown.density_ratio * climbed_m / airspeed_mps.max(1.0);
        let forgotten = dt_s / OVER_S;
        self.law_mps += trapped_mps - forgotten * self.law_mps;
        self.shown_mps += airspeed_mps - from_mps - trapped_mps - forgotten * self.shown_mps;
        self.expected_mps += felt_mps - trapped_mps - forgotten * self.expected_mps;
        let differs_mps = self.shown_mps - self.expected_mps - self.bias_mps;
        let open_mps2 = self.variance_mps2.max(squared(LEAST_MPS));
        let ratio_per_s = 0.5
            * (libm::log(open_mps2 / squared(NOISE_MPS)) + squared(differs_mps) / open_mps2
                - squared(self.shown_mps / NOISE_MPS));
        let is_told = self.law_mps.abs() > TELLING_MPS;
        let most_per_s = if is_told { MOST_PER_S } else { 0.0 };
        let evidence_per_s = (ratio_per_s - TAKEN_PER_S).clamp(LEAST_PER_S, most_per_s);
        self.evidence = (self.evidence + evidence_per_s * dt_s).max(0.0);
        self.known_mps = if self.evidence > 0.0 {
            self.known_mps + shown.felt_mps
        } else {
            airspeed_mps
        };
        if self.evidence < LEARNS_BELOW {
            let learned = smoothing_factor(dt_s, LEARNED_OVER_S);
            let seen_mps2 = squared(differs_mps).min(squared(MOST_LEARNED_SDS) * open_mps2);
            self.variance_mps2 += learned * (seen_mps2 - self.variance_mps2);
            self.bias_mps += learned * differs_mps.clamp(-MOST_LEARNED_MPS, MOST_LEARNED_MPS);
        }
        (self.evidence > BLOCKED).then_some(self.known_mps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fcc_core::units::{FOOT_M, KNOT_MPS};

    const DT_S: f64 = 0.025;

    /// The time, s, until a tube is called blocked at a climb rate after a minute of level flight,
    /// where the sensor and the accelerometers show these accelerations, m/s².
    fn found_s(climb_mps: f64, sensor_mps2: impl Fn(f64) -> f64, felt_mps2: f64) -> Option<f64> {
        let mut trapped = TrappedPressure::new();
        let mut shown = Shown {
            altitude_m: 900.0,
            density_ratio: 0.92,
            sensor_mps: 51.4,
            felt_mps: 0.0,
        };
        assert!((0..2_400).all(|_| trapped.step(&shown, DT_S).is_none()));
        shown.felt_mps = felt_mps2 * DT_S;
        let found = (0..1_200).find(|_| {
            shown.altitude_m += climb_mps * DT_S;
            shown.sensor_mps += sensor_mps2(shown.sensor_mps) * DT_S;
            trapped.step(&shown, DT_S).is_some()
        });
        found.map(|tick| f64::from(tick) * DT_S)
    }

    /// The sensor of a trapped pressure.
    fn blocked(climb_mps: f64) -> impl Fn(f64) -> f64 {
        move |airspeed_mps| GRAVITY_MPS2 * 0.92 * climb_mps / airspeed_mps
    }

    /// 700 ft/min: 10 kt are shown after 8 s (FAA-H-8083-15B has the law), and 5 s later it is
    /// to be known.
    #[test]
    fn a_blocked_tube_is_found_in_a_climb_and_in_a_descent() {
        let climb_mps = 700.0 * FOOT_M / 60.0;
        for climb_mps in [climb_mps, -climb_mps] {
            let found_s = found_s(climb_mps, blocked(climb_mps), 0.0).unwrap();
            let ten_kt_s = 10.0 * KNOT_MPS / blocked(climb_mps.abs())(51.4);
            assert!(found_s < ten_kt_s + 5.0, "{found_s} s, 10 kt at {ten_kt_s}");
        }
    }

    /// It gains as much speed as height, and feels it.
    #[test]
    fn an_aircraft_that_climbs_and_accelerates_has_no_blocked_tube() {
        let climb_mps = 2.5;
        let mps2 = blocked(climb_mps)(51.4);
        assert_eq!(found_s(climb_mps, blocked(climb_mps), mps2), None);
        // Nor one that climbs and keeps its airspeed.
        assert_eq!(found_s(climb_mps, |_| 0.0, 0.0), None);
        // Nor one that climbs for the speed that it loses.
        assert_eq!(
            found_s(climb_mps, |mps| -blocked(climb_mps)(mps), 0.0),
            None
        );
        // Nor one in level flight while the headwind falls by 2 kt/s.
        assert_eq!(found_s(0.0, |_| 0.0, 2.0 * KNOT_MPS), None);
    }
}
