//! Whether an airspeed is wrong because the static port is blocked.

use super::super::airspeed_reason::DoubtReason;
use super::super::altitude_monitor::{LEAST_MPS, height_by_total_pressure_m};
use super::super::filter_bank::FilterBank;
use super::super::scalar_update::squared;
use super::{AirspeedMonitor, MonitorInput};

/// Both heights are this large, m, the one by pitch and lift beyond this many
/// of its standard deviations, and the latter is this share of the former.
const CLIMBED_M: f64 = 12.0;
const CLIMBED_SDS: f64 = 0.5;
const SHARE: core::ops::RangeInclusive<f64> = 0.35..=2.5;
/// The altimeter has stood if it changed by less than this share.
const STOOD_SHARE: f64 = 0.25;
/// They agree for this time, s.
const AGREE_FOR_S: f64 = 1.0;
/// Compared for this time after the airspeed was doubted, s: then the error of
/// the path is larger.
const COMPARED_S: f64 = 30.0;
/// The error of the climb rate by pitch and lift, m/s (0.5° of the angle of
/// attack of zero lift at 50 m/s), and the correlation time of vertical gusts, s
/// (MIL-F-8785C, 3.7.3).
const PATH_ERROR_MPS: f64 = 0.4;
const GUST_S: f64 = 8.0;

/// One tick's inputs while an airspeed is doubted.
#[derive(Clone, Copy, Debug)]
pub(super) struct StaticPortInput {
    /// By the altimeter, m.
    pub(super) altitude_m: f64,
    /// Above that, if the static port is blocked, m: by the total pressure.
    pub(super) height_m: f64,
    /// By pitch and lift of the remembered model, m/s.
    pub(super) climb_rate_mps: f64,
    pub(super) gusts_mps: f64,
}

/// Heights since the airspeed was doubted.
///
/// With a blocked static port the altimeter stands, and the tube still tells
/// the total pressure: the height by it changes as the aircraft climbs. Any
/// other fault of the airspeed changes that height, but the aircraft does not
/// climb with it.
#[derive(Clone, Copy, Debug)]
pub(super) struct StaticPort {
    began: StaticPortInput,
    climbed_m: f64,
    lasted_s: f64,
    agree_s: f64,
}

impl StaticPort {
    /// Begins when the airspeed is doubted.
    pub(super) const fn new(began: StaticPortInput) -> Self {
        Self {
            began,
            climbed_m: 0.0,
            lasted_s: 0.0,
            agree_s: 0.0,
        }
    }

    /// Whether the static port is blocked.
    pub(super) fn step(&mut self, input: &StaticPortInput, dt_s: f64) -> bool {
        self.lasted_s += dt_s;
        self.climbed_m += input.climb_rate_mps * dt_s;
        let shown_m = input.altitude_m - self.began.altitude_m;
        let height_m = input.height_m - self.began.height_m;
        let path_m = self.climbed_m - shown_m;
        let gusts_m = input.gusts_mps * libm::sqrt(2.0 * GUST_S * self.lasted_s);
        let sd_m = PATH_ERROR_MPS * self.lasted_s + gusts_m;
        let agree = self.lasted_s < COMPARED_S
            && squared(height_m) > squared(CLIMBED_M)
            && path_m.abs() > CLIMBED_M + CLIMBED_SDS * sd_m
            && SHARE.contains(&(path_m / height_m))
            && shown_m.abs() < STOOD_SHARE * height_m.abs();
        self.agree_s = if agree { self.agree_s + dt_s } else { 0.0 };
        self.agree_s > AGREE_FOR_S
    }
}

/// What is known when the static port is found to be blocked.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Blocked {
    /// Above the altimeter's altitude, m.
    pub(in super::super) height_m: f64,
    pub(in super::super) climb_rate_mps: f64,
}

impl AirspeedMonitor {
    /// Whether the static port has just been found to be blocked.
    pub(in super::super) const fn blocked_static(&self) -> Option<Blocked> {
        self.blocked
    }

    /// The altimeter is doubted, because the sensor's static port is blocked.
    pub(in super::super) fn doubt_static_port(&mut self) {
        if let Some(bank) = &mut self.bank {
            bank.older.restore_models();
            (bank.believing, bank.younger) = (bank.older, bank.older);
            bank.younger_s = 0.0;
        }
        self.set_reason(DoubtReason::BlockedStatic);
    }

    /// The altimeter has moved: the static port is not blocked.
    pub(in super::super) fn static_port_is_free(&mut self) {
        self.set_reason(if self.difference.output() > 0.0 {
            DoubtReason::TooHigh
        } else {
            DoubtReason::TooLow
        });
    }

    /// Changes the reason of a doubt; the static port is looked at no more.
    const fn set_reason(&mut self, reason: DoubtReason) {
        (self.static_port, self.blocked) = (None, None);
        if let Some(doubt) = &mut self.doubt {
            doubt.reason = reason;
        }
    }

    /// Processes one tick of a doubted sensor, with its airspeed, m/s.
    pub(super) fn look_at_static_port(
        &mut self,
        bank: &FilterBank,
        input: &MonitorInput,
        sensor_mps: f64,
        holds: bool,
        dt_s: f64,
    ) {
        let now = self.port_input(bank, input, sensor_mps);
        let is_blocked = match &mut self.static_port {
            Some(known) => holds && sensor_mps > LEAST_MPS && known.step(&now, dt_s),
            None => false,
        };
        self.blocked = is_blocked.then_some(Blocked {
            height_m: now.height_m,
            climb_rate_mps: now.climb_rate_mps,
        });
    }

    /// With the airspeed by the sensor, m/s.
    pub(super) fn port_input(
        &self,
        bank: &FilterBank,
        input: &MonitorInput,
        sensor_mps: f64,
    ) -> StaticPortInput {
        let density = squared(input.sample.sqrt_density);
        let forces_mps = bank.older.airspeed_mps();
        StaticPortInput {
            altitude_m: input.altitude_m,
            height_m: height_by_total_pressure_m(sensor_mps, forces_mps, density),
            climb_rate_mps: bank.older.kept_climb_rate_mps(&input.sample),
            gusts_mps: self.gusts_mps(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a climb of 2 m/s, felt by path and shown by each so much of it, is
    /// that of a blocked static port within 15 s.
    fn is_found(by_path: f64, by_total: f64, by_altimeter: f64, gusts_mps: f64) -> bool {
        let input = |s: f64| StaticPortInput {
            altitude_m: 900.0 + by_altimeter * 2.0 * s,
            height_m: 25.0 + by_total * 2.0 * s,
            climb_rate_mps: 2.0 * by_path,
            gusts_mps,
        };
        let mut port = StaticPort::new(input(0.0));
        (1..=600).any(|n| port.step(&input(f64::from(n) * 0.025), 0.025))
    }

    #[test]
    fn a_climb_that_only_the_altimeter_misses_is_a_blocked_static_port() {
        assert!(is_found(1.0, 1.0, 0.0, 0.3));
        assert!(is_found(-1.0, -1.0, 0.0, 0.3));
    }

    #[test]
    fn an_airspeed_that_decays_or_an_updraught_or_a_shown_climb_is_none() {
        assert!(!is_found(0.0, 1.0, 0.0, 0.3), "the airspeed decays");
        assert!(!is_found(1.0, 0.0, 0.0, 0.3), "the air sinks");
        assert!(!is_found(-1.0, 1.0, 0.0, 0.3));
        assert!(!is_found(1.0, 1.0, 1.0, 0.3), "the altimeter moves");
        assert!(!is_found(1.0, 1.0, 0.0, 3.0), "gusts explain the path");
    }
}
