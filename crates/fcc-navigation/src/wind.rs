//! The wind from the velocity over the ground, and the airspeed from both.

use libm::{cos, fabs, hypot, sin, sqrt};

use super::Navigation;
use super::path::Path;
use super::sample_tracker::{NewSample, is_current};
use super::scalar_update::{Covariance, State, add_variance, squared, update, variance};
use fcc_core::flight::Measurements;
use fcc_core::framework::Time;

/// Standard deviations at the beginning: of the wind, m/s, of the airspeed sensor's
/// error over its airspeed, and of the variation with the error of the compass, rad
/// (20°).
const WIND_SD_MPS: f64 = 15.0;
const SCALE_SD: f64 = 0.03;
const TURNED_SD_RAD: f64 = 0.35;
/// Random walks per √s: of the wind, m/s, of the sensor's error over its airspeed,
/// of the variation, rad.
const WIND_WALK_MPS: f64 = 0.15;
const SCALE_WALK: f64 = 0.004;
const TURNED_WALK_RAD: f64 = 0.003;
/// The wind changes with altitude like a random walk, too: per √m, m/s (3.5 m/s in 300 m).
const WIND_WALK_BY_HEIGHT: f64 = 0.2;
/// Standard deviations of a reading: of the gusts at least, m/s, and across, of
/// compass and sideslip, rad (2°); both are correlated over this time, s
/// (MIL-F-8785C, 3.7.3: 533 m at 65 m/s).
const LEAST_GUSTS_MPS: f64 = 0.5;
const ACROSS_SD_RAD: f64 = 0.035;
pub(super) const CORRELATED_S: f64 = 8.0;
/// An innovation of this lag, s, beyond so many of its standard deviations is a wind
/// that has changed, by as much, m/s: a sensor that fails in seconds is found by the
/// forces.
const CHANGE_LAG_S: f64 = 2.0;
const CHANGE_SDS: f64 = 2.5;
const CHANGED_WIND_MPS: f64 = 10.0;

/// One reading of the velocity over the ground.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct OverGround {
    pub(super) north_mps: f64,
    pub(super) east_mps: f64,
    /// Magnetic, at the time of the reading.
    pub(super) heading_rad: f64,
    pub(super) climb_rate_mps: f64,
    pub(super) altitude_m: f64,
    /// √(density over its value at sea level).
    pub(super) sqrt_density: f64,
    /// Standard deviation of gusts, m/s.
    pub(super) gusts_mps: f64,
}

/// The state: wind towards north and east, m/s, the error of the airspeed sensor over
/// its airspeed, the variation (with the error of the compass and the sideslip), rad.
const N: usize = 4;

/// A Kalman filter of the wind triangle: the velocity over the ground is the wind and
/// the airspeed along the heading. The sensor's error and the wind along the heading
/// are told apart by a turn (Cho, Kim, Lee and Kee 2011, "Wind Estimation and Airspeed
/// Calibration using a UAV with a Single-Antenna GPS and Pitot Tube").
#[derive(Clone, Copy, Debug)]
pub(super) struct Wind {
    x: State<N>,
    covariance: Covariance<N>,
    altitude_m: Option<f64>,
    /// Innovations along and across, m/s, with a lag.
    along_mps: f64,
    across_mps: f64,
    /// Was corrected by a sensor's airspeed for this time, s.
    learned_s: f64,
}

impl Wind {
    pub(super) fn new() -> Self {
        let mut covariance = [[0.0; N]; N];
        let sds = [WIND_SD_MPS, WIND_SD_MPS, SCALE_SD, TURNED_SD_RAD];
        add_variance(&mut covariance, sds.map(squared));
        Self {
            x: [0.0; N],
            covariance,
            altitude_m: None,
            along_mps: 0.0,
            across_mps: 0.0,
            learned_s: 0.0,
        }
    }

    /// Processes a reading, `dt_s` after the last, with the indicated airspeed of
    /// a sensor that is believed, m/s, and its standard deviation beside gusts.
    pub(super) fn step(&mut self, read: &OverGround, sensor_mps: Option<(f64, f64)>, dt_s: f64) {
        self.predict(read, dt_s);
        let [north, east, scale, turned] = self.x;
        let (sin, cos) = (
            sin(read.heading_rad + turned),
            cos(read.heading_rad + turned),
        );
        let through = [read.north_mps - north, read.east_mps - east];
        let [along_mps, across_mps] = [
            cos * through[0] + sin * through[1],
            cos * through[1] - sin * through[0],
        ];
        let share = (dt_s / CHANGE_LAG_S).min(1.0);
        let gusts = squared(LEAST_GUSTS_MPS) + squared(read.gusts_mps);
        let per_reading = (2.0 * CORRELATED_S / dt_s).max(1.0);
        let mut changed = false;
        if let Some((sensor_mps, sd_mps)) = sensor_mps {
            let gusts = gusts + squared(sd_mps / read.sqrt_density);
            let level = squared(sensor_mps / read.sqrt_density) - squared(read.climb_rate_mps);
            let sensor_mps = sqrt(level.max(0.0));
            let by = along_mps - sensor_mps * (1.0 + scale);
            let h = [cos, sin, sensor_mps, 0.0];
            self.along_mps += share * (by - self.along_mps);
            changed |= self.is_beyond(h, gusts, self.along_mps);
            update(
                &mut self.x,
                &mut self.covariance,
                h,
                by,
                gusts * per_reading,
            );
            self.learned_s += dt_s;
        }
        let h = [-sin, cos, 0.0, along_mps];
        self.across_mps += share * (across_mps - self.across_mps);
        let across = gusts + squared(ACROSS_SD_RAD * along_mps);
        changed |= self.is_beyond(h, across, self.across_mps);
        update(
            &mut self.x,
            &mut self.covariance,
            h,
            across_mps,
            across * per_reading,
        );
        if changed {
            let wind = squared(CHANGED_WIND_MPS) * share;
            add_variance(&mut self.covariance, [wind, wind, 0.0, 0.0]);
        }
    }

    /// The sensor is believed from now on, whatever its error was.
    pub(super) fn trust_sensor(&mut self) {
        self.x[2] = 0.0;
        for [_, _, scale, _] in &mut self.covariance {
            *scale = 0.0;
        }
        self.covariance[2] = [0.0, 0.0, squared(SCALE_SD), 0.0];
    }

    /// The airspeed that takes the place of a sensor's is wrong by this share of it, one
    /// standard deviation.
    pub(super) fn expect_error(&mut self, share: f64) {
        self.covariance[2][2] = squared(share);
    }

    /// The true airspeed, m/s, and its standard deviation.
    pub(super) fn airspeed_mps(&self, read: &OverGround) -> Option<(f64, f64)> {
        if self.learned_s < CORRELATED_S {
            return None;
        }
        let [north, east, ..] = self.x;
        let through = [read.north_mps - north, read.east_mps - east];
        let level_mps = hypot(through[0], through[1]).max(1.0);
        let along = [through[0] / level_mps, through[1] / level_mps, 0.0, 0.0];
        let variance = variance(&self.covariance, along);
        let mps = hypot(level_mps, read.climb_rate_mps);
        Some((mps, sqrt(variance.max(0.0) + squared(read.gusts_mps))))
    }

    /// The wind towards north and east, m/s, and the variation, rad.
    pub(super) fn found(&self) -> Option<([f64; 2], f64)> {
        let [north, east, _, turned] = self.x;
        (self.learned_s >= CORRELATED_S).then_some(([north, east], turned))
    }

    fn predict(&mut self, read: &OverGround, dt_s: f64) {
        let climbed_m = fabs(read.altitude_m - self.altitude_m.unwrap_or(read.altitude_m));
        self.altitude_m = Some(read.altitude_m);
        let wind = squared(WIND_WALK_MPS) * dt_s + squared(WIND_WALK_BY_HEIGHT) * climbed_m;
        let more = [
            wind,
            wind,
            squared(SCALE_WALK) * dt_s,
            squared(TURNED_WALK_RAD) * dt_s,
        ];
        add_variance(&mut self.covariance, more);
    }

    fn is_beyond(&self, h: State<N>, noise: f64, innovation_mps: f64) -> bool {
        squared(innovation_mps) > squared(CHANGE_SDS) * (variance(&self.covariance, h) + noise)
    }
}

impl Navigation {
    /// A new velocity over the ground, with the heading by a compass.
    pub(super) fn over_ground(
        &mut self,
        now: Time,
        measurements: &Measurements,
        path: &Path<'_>,
        dt_s: f64,
    ) -> Option<OverGround> {
        let is_new = !matches!(
            self.velocity.of(&measurements.velocity, dt_s),
            NewSample::None
        );
        let velocity = measurements.velocity.value;
        (is_new && is_current(&measurements.heading_rad, now)).then(|| OverGround {
            north_mps: velocity.north_mps,
            east_mps: velocity.east_mps,
            heading_rad: path.orientation.heading_rad,
            climb_rate_mps: path.vertical.climb_rate_mps,
            altitude_m: path.vertical.altitude_m,
            sqrt_density: path.sqrt_density,
            gusts_mps: self.monitor.gusts_mps(),
        })
    }
}

#[cfg(test)]
mod tests;
