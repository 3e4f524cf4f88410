//! Where the aircraft is and how it moves, and which of its sensors are not used.

use super::ground_motion::GroundMotion;
use super::{AutopilotConfig, flags};
use fcc_core::flight::Measurements;
use fcc_core::framework::Flags;
use fcc_navigation::inertial::RawNavigation;
use fcc_navigation::{
    AirspeedSource, Estimate, FrozenDetector, MotionDoubt, Navigation, Replacement, is_possible_fix,
};

/// Where the aircraft is and how it moves.
#[derive(Clone, Debug)]
pub(super) struct Estimator {
    /// Navigation from raw readings, if it is flown by them.
    pub(super) raw: Option<RawNavigation>,
    pub(super) navigation: Navigation,
    pub(super) replacement: Replacement,
    pub(super) frozen: FrozenDetector,
    /// Where it is over the ground.
    pub(super) ground: GroundMotion,
}

impl Estimator {
    pub(super) fn new(config: &AutopilotConfig) -> Self {
        Self {
            raw: config.raw_navigation.map(RawNavigation::new),
            navigation: Navigation::new(&config.navigation)
                .for_stall_airspeed(config.envelope.stall_airspeed_mps)
                .for_aircraft(
                    config.reference_airspeed_mps,
                    config.airspeed.throttle_per_mps2,
                )
                .for_learned(config.airframe),
            replacement: Replacement::new(config.navigation.attitude_tau_s),
            frozen: FrozenDetector::new(config.frozen_after.as_secs_f64()),
            ground: if config.raw_navigation.is_some() {
                GroundMotion::default()
            } else {
                GroundMotion::judging(config.envelope.min_airspeed_mps)
            },
        }
    }

    /// Attitude, airspeed, altitude and their rates.
    pub(super) const fn estimate(&self) -> &Estimate {
        self.navigation.estimate()
    }

    /// The conditions that airspeed and altitude are excluded.
    pub(super) fn doubted(&self) -> Flags {
        Flags::NONE
            .with(
                flags::DOUBTED_AIRSPEED,
                self.navigation.airspeed_doubt().is_some(),
            )
            .with(
                flags::DOUBTED_ALTITUDE,
                self.navigation.altitude_doubt().is_some(),
            )
    }

    /// The faults that attitude or body rates are doubted.
    pub(super) fn doubted_motion(&self) -> Flags {
        let doubt = self.navigation.motion_doubt();
        Flags::NONE
            .with(
                flags::DOUBTED_ATTITUDE,
                doubt == Some(MotionDoubt::Attitude),
            )
            .with(
                flags::DOUBTED_BODY_RATES,
                doubt == Some(MotionDoubt::BodyRates),
            )
    }

    /// Whether a sensor's airspeed may be used beside others'.
    pub(super) fn permits_airspeed(&self, measurements: &Measurements) -> bool {
        let airspeed = measurements.airspeed_mps;
        airspeed.is_never() || self.navigation.permits_airspeed(airspeed.value)
    }

    pub(super) fn is_accurate(&self, config: &AutopilotConfig, ratio: f64) -> bool {
        let estimate = self.estimate();
        let accurate_mps = ratio * config.reference_airspeed_mps;
        estimate.airspeed_source == AirspeedSource::Forces
            && estimate.airspeed_uncertainty_mps < accurate_mps
    }

    /// The measurements of this tick, as they are flown by.
    pub(super) fn seen<'a>(&'a self, measured: &'a Measurements) -> &'a Measurements {
        self.raw.as_ref().map_or(measured, RawNavigation::found)
    }

    /// The raw sensors that are not used, and that control does not need.
    pub(super) fn unused_sensors(&self, measured: &Measurements) -> Flags {
        let has_fix = !measured.gnss.is_never();
        let is = |what: fn(&RawNavigation) -> bool| self.raw.as_ref().is_some_and(what);
        Flags::NONE
            .with(
                flags::IMPOSSIBLE_FIX,
                has_fix && !is_possible_fix(&measured.gnss.value),
            )
            .with(flags::REPEATED_FIX, is(RawNavigation::repeats_place))
            .with(flags::REPEATED_FIELD, is(RawNavigation::repeats_field))
            .with(flags::LEFT_UNIT, is(RawNavigation::left_a_unit))
            .with(flags::WRONG_SENSOR, is(RawNavigation::has_wrong_sensor))
    }

    /// Whether the gyroscopes are not flown by, because the magnetic field contradicts them;
    /// not by the attitude either until it is known which of the two is wrong: an aircraft
    /// that follows wrong gyroscopes rolls over meanwhile.
    pub(super) fn doubts_gyroscopes(&self) -> bool {
        self.raw
            .as_ref()
            .is_some_and(|raw| raw.doubts_gyroscopes() || raw.questions_gyroscopes())
    }

    /// Whether what comes from raw sensors has an attitude, if it is flown by them.
    pub(super) fn knows_attitude(&self) -> bool {
        self.raw
            .as_ref()
            .is_none_or(|raw| raw.knows_attitude() && !raw.questions_gyroscopes())
    }
}
