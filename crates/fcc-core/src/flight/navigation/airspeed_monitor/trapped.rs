//! Whether an airspeed changes with height as that of a blocked pitot tube does.

use super::super::scalar_update::squared;
use super::DIFFERENCE_LAG_S;
use crate::blocks::LowPass;
use crate::units::GRAVITY_MPS2;

/// How far it may be from that of a trapped pressure, m/s: half a step of 1 kt, and what the
/// lag makes in a climb of 5 m/s. An altimeter whose half step is more says too little.
const TOLERANCE_MPS: f64 = 0.7;
/// The change that tells, m/s (9 kt) and in multiples of the gusts, in at most this time, s, of
/// which the accelerometers feel less than this share: an aircraft that gains speed and height
/// alike feels it, and with a blocked tube it is flown the other way.
const TELLING_MPS: f64 = 4.6;
const TELLING_GUSTS: f64 = 4.0;
const TELLING_S: f64 = 15.0;
const FELT_SHARE: f64 = 0.2;

/// What the sensor, the altimeter and the accelerometers show.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shown {
    pub(super) altitude_m: f64,
    /// Of a coarse altimeter; 0 of a fine one.
    pub(super) altitude_step_m: f64,
    pub(super) density_ratio: f64,
    pub(super) sensor_mps: f64,
    /// Standard deviation of the gusts.
    pub(super) gusts_mps: f64,
    /// What the airspeed has changed by since the last tick by the accelerometers.
    pub(super) felt_mps: f64,
}

/// The total pressure of a blocked tube is trapped, so its dynamic pressure changes by
/// -dp = ρ g dh (FAA-H-8083-15B, chapter 5, blocked pitot tube and drain).
#[derive(Clone, Debug)]
pub(super) struct TrappedPressure {
    airspeed: LowPass,
    /// Altitude and airspeed since when the sensor has followed that law.
    since: Option<(f64, f64)>,
    since_s: f64,
    felt_mps: f64,
}

impl TrappedPressure {
    pub(super) const fn new() -> Self {
        Self {
            airspeed: LowPass::new(DIFFERENCE_LAG_S),
            since: None,
            since_s: 0.0,
            felt_mps: 0.0,
        }
    }

    /// Begins anew with the next reading.
    pub(super) const fn reset(&mut self) {
        self.since = None;
    }

    /// The airspeed by the accelerometers, m/s, once the tube is blocked.
    pub(super) fn step(&mut self, shown: &Shown, dt_s: f64) -> Option<f64> {
        let Some((from_m, from_mps)) = self.since else {
            self.airspeed.reset(shown.sensor_mps);
            self.begin(shown);
            return None;
        };
        let airspeed_mps = self.airspeed.step(shown.sensor_mps, dt_s);
        self.felt_mps += shown.felt_mps;
        self.since_s += dt_s;
        // Of squares of airspeeds, indicated.
        let per_m = 2.0 * GRAVITY_MPS2 * shown.density_ratio;
        let trapped = squared(from_mps) + per_m * (shown.altitude_m - from_m);
        let error_mps = (squared(airspeed_mps) - trapped) / (2.0 * from_mps);
        let step_mps = 0.5 * shown.altitude_step_m * per_m / (2.0 * from_mps);
        let is_coarse = step_mps > TOLERANCE_MPS;
        if is_coarse || error_mps.abs() > TOLERANCE_MPS || self.since_s > TELLING_S {
            self.begin(shown);
            return None;
        }
        let changed_mps = airspeed_mps - from_mps;
        let telling_mps = TELLING_MPS.max(TELLING_GUSTS * shown.gusts_mps);
        let is_told = changed_mps.abs() > telling_mps;
        let is_felt = self.felt_mps * changed_mps.signum() > FELT_SHARE * changed_mps.abs();
        (is_told && !is_felt).then_some(from_mps + self.felt_mps)
    }

    fn begin(&mut self, shown: &Shown) {
        self.since = Some((shown.altitude_m, self.airspeed.output()));
        self.since_s = 0.0;
        self.felt_mps = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::{FOOT_M, KNOT_MPS};

    const DT_S: f64 = 0.025;

    /// The time, s, until a tube is called blocked at a climb rate, where the sensor and the
    /// accelerometers show these accelerations, m/s².
    fn found_s(climb_mps: f64, sensor_mps2: impl Fn(f64) -> f64, felt_mps2: f64) -> Option<f64> {
        let mut trapped = TrappedPressure::new();
        let mut shown = Shown {
            altitude_m: 900.0,
            altitude_step_m: 0.0,
            density_ratio: 0.92,
            sensor_mps: 51.4,
            gusts_mps: 0.3,
            felt_mps: felt_mps2 * DT_S,
        };
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

    /// 700 ft/min: 10 kt are shown after 8 s (FAA-H-8083-15B has the law).
    #[test]
    fn a_blocked_tube_is_found_in_a_climb_and_in_a_descent() {
        let climb_mps = 700.0 * FOOT_M / 60.0;
        for climb_mps in [climb_mps, -climb_mps] {
            let found_s = found_s(climb_mps, blocked(climb_mps), 0.0).unwrap();
            let shown_kt = found_s * GRAVITY_MPS2 * 0.92 * climb_mps.abs() / 51.4 / KNOT_MPS;
            assert!((8.0..11.0).contains(&shown_kt), "{shown_kt} kt");
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
    }
}
