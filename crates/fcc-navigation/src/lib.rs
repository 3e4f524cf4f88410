//! Navigation: attitude, airspeed, altitude and their rates.
//!
//! Sensors differ in accuracy over time: gyroscopes are accurate over short
//! times, gravity and the compass over long times; accelerometers over short
//! times, the barometer over long times. Each channel here combines one such
//! pair, and predicts through ticks in which nothing new arrived.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod agreement;
mod air_data;
mod airframe;
mod airspeed_filter;
mod airspeed_monitor;
mod airspeed_reason;
mod altitude_input;
mod altitude_monitor;
mod attitude;
mod coasting;
mod config;
mod estimate;
mod filter_bank;
mod force_sample;
mod frozen;
pub mod inertial;
mod lift;
mod marked_altitude;
mod monitored;
mod motion;
mod motion_monitor;
mod motion_witness;
mod path;
mod plausibility;
mod quantity;
mod replacement;
mod resolution;
mod returning_altitude;
mod sample_tracker;
mod scalar_update;
mod upward;
mod vertical;
mod vertical_covariance;
mod wind;
mod without_altimeter;

use core::time::Duration;

use agreement::Agreement;
use airframe::{AirframePrior, CESSNA_172, FULL_THRUST_SHARE};
use airspeed_monitor::{AirspeedMonitor, MonitorInput};
use altitude_monitor::AltitudeMonitor;
use fcc_core::blocks::LowPass;
use fcc_core::flight::Measurements;
use fcc_core::framework::Time;
use fcc_core::units::{GRAVITY_MPS2, KNOT_MPS};
use motion_monitor::MotionMonitor;
use path::{Density, Path};
use sample_tracker::SampleTracker;
pub use sample_tracker::is_current;

pub use agreement::Contradictions;
pub use air_data::AirspeedChannel;
pub use airframe::LearnedAirframe;
pub use airspeed_reason::{Doubt, DoubtReason};
pub use attitude::AttitudeChannel;
pub use config::NavigationConfig;
pub use estimate::{AirspeedSource, Estimate};
pub use frozen::{FrozenDetector, Known};
pub use lift::{Lift, LiftChannel};
pub use motion::KnownMotion;
pub use motion_monitor::MotionDoubt;
pub use plausibility::{
    AIRSPEED, ENGAGE_SWITCH, GateLimits, HEIGHT_M, PlausibilityLimit, RATES_RADPS,
    SPECIFIC_FORCE_MPS2, airspeed_can_follow, is_possible_altitude, is_possible_fix,
    plausibility_gate,
};
pub use quantity::{Quantities, Quantity};
pub use replacement::{DERIVED_RATES_LATE_S, Replacement};
pub use resolution::Resolutions;
pub use returning_altitude::ReturningAltitude;
use upward::Upward;
pub use vertical::VerticalChannel;

/// Computes an [`Estimate`] from measurements.
///
/// ```
/// use fcc_core::flight::Measurements;
/// use fcc_navigation::{Navigation, NavigationConfig};
/// use fcc_core::framework::{Reading, Time};
///
/// let now = Time::from_nanos(25_000_000);
/// let measured = Measurements {
///     airspeed_mps: Reading::new(51.444, now),
///     altitude_m: Reading::new(3_048.0, now),
///     ..Measurements::default()
/// };
/// let mut navigation = Navigation::new(&NavigationConfig::default());
/// navigation.step(now, &measured, 0.025);
/// // 100 kt indicated at 10,000 ft are 116.4 kt true, by pilots' tables.
/// let true_kt = navigation.estimate().true_airspeed_mps / 0.514_444;
/// assert!((true_kt - 116.4).abs() < 0.1);
/// ```
#[derive(Clone, Debug)]
pub struct Navigation {
    attitude: AttitudeChannel,
    vertical: VerticalChannel,
    airspeed: AirspeedChannel,
    lift: LiftChannel,
    monitor: AirspeedMonitor,
    altitude_monitor: AltitudeMonitor,
    agreement: Agreement,
    motion: MotionMonitor,
    airframe: AirframePrior,
    velocity: SampleTracker,
    throttle: Option<f64>,
    is_engaged: bool,
    is_flaring: bool,
    known_motion: KnownMotion,
    side_force: LowPass,
    density: Density,
    estimate: Estimate,
}

impl Navigation {
    /// Navigation in its initial state.
    pub const fn new(config: &NavigationConfig) -> Self {
        Self {
            attitude: AttitudeChannel::new(config.attitude_tau_s, config.heading_tau_s),
            vertical: VerticalChannel::new(config.vertical_bandwidth_radps),
            airspeed: AirspeedChannel::new(config.airspeed_tau_s),
            lift: LiftChannel::new(STALL_AIRSPEED_MPS),
            monitor: AirspeedMonitor::new(CESSNA_172),
            altitude_monitor: AltitudeMonitor::new(),
            agreement: Agreement::new(),
            motion: MotionMonitor::new(),
            airframe: CESSNA_172,
            velocity: SampleTracker::new(),
            throttle: None,
            is_engaged: false,
            is_flaring: false,
            known_motion: KnownMotion::InFlight,
            side_force: LowPass::new(config.side_force_tau_s),
            density: Density::AT_SEA_LEVEL,
            estimate: Estimate::INITIAL,
        }
    }

    /// The same for an aircraft that cruises near an airspeed, and whose throttle
    /// accelerates it by 1 m/s² per this much.
    #[must_use]
    pub fn for_aircraft(mut self, reference_airspeed_mps: f64, throttle_per_mps2: f64) -> Self {
        self.airframe = AirframePrior {
            reference_mps: reference_airspeed_mps,
            full_thrust_ratio: FULL_THRUST_SHARE / (throttle_per_mps2 * GRAVITY_MPS2),
            ..self.airframe
        };
        self.monitor = AirspeedMonitor::new(self.airframe);
        self
    }

    /// The same for an aircraft of which another flight has learned.
    #[must_use]
    pub fn for_learned(mut self, learned: Option<LearnedAirframe>) -> Self {
        self.airframe.learned = learned;
        self.monitor = AirspeedMonitor::new(self.airframe);
        self
    }

    /// The throttle from now on, 0..=1, if it is known, and whether the
    /// autopilot flies: only then is a sensor doubted; in a flare, where lift and drag
    /// are other ones, only the altimeter.
    pub const fn flown_with(&mut self, throttle: Option<f64>, is_engaged: bool, is_flaring: bool) {
        self.throttle = throttle;
        self.is_engaged = is_engaged;
        self.is_flaring = is_flaring;
    }

    /// Whether attitude, body rates and forces are measured from now on, and the
    /// altitude unless it is doubted: otherwise no sensor of air data is doubted,
    /// and what it is compared with begins anew afterwards. On wheels forces say nothing of
    /// the airspeed.
    pub const fn knows_motion(&mut self, known_motion: KnownMotion) {
        self.known_motion = known_motion;
    }

    /// The aircraft flies at about this airspeed, m/s, and its sensor shows one with which it
    /// cannot: that is doubted from the next tick on.
    pub const fn leave_airspeed(&mut self, airspeed_mps: f64) {
        self.monitor.leave_for(airspeed_mps);
    }

    /// The doubt of the airspeed sensor, while it lasts.
    pub const fn airspeed_doubt(&self) -> Option<Doubt> {
        self.monitor.doubt()
    }

    /// The wind towards north and east, m/s, and what true north is off the compass, rad;
    /// none before it is known.
    pub fn wind(&self) -> Option<([f64; 2], f64)> {
        self.monitor.wind()
    }

    /// Whether the altimeter is doubted, and the altitude without it known.
    pub fn altitude_doubt(&self) -> Option<bool> {
        let monitor = &self.altitude_monitor;
        monitor.is_doubted().then(|| monitor.is_sound())
    }

    /// What this flight has learned of the aircraft; none before a minute with an
    /// airspeed sensor that is believed and a known throttle.
    pub fn learned_airframe(&self) -> Option<LearnedAirframe> {
        self.monitor.learned()
    }

    /// Whether an airspeed may be used beside those of other sensors.
    pub fn permits_airspeed(&self, airspeed_mps: f64) -> bool {
        self.monitor.permits(airspeed_mps)
    }

    /// For an aircraft with this stalling speed, clean and without power, m/s.
    #[must_use]
    pub const fn for_stall_airspeed(self, stall_airspeed_mps: f64) -> Self {
        Self {
            lift: LiftChannel::new(stall_airspeed_mps),
            ..self
        }
    }

    /// Processes the measurements at `now`, `dt_s` seconds of the plant's time
    /// after the last.
    pub fn step(&mut self, now: Time, measurements: &Measurements, dt_s: f64) {
        let attitude = self.attitude.step(now, measurements, dt_s);
        let force = measurements.specific_force;
        let upward = Upward::of(attitude.roll_rad, attitude.pitch_rad);
        let vertical = self.step_vertical(now, measurements, (&attitude, upward), dt_s);
        let sqrt_density = self.sqrt_density(now, measurements, vertical.altitude_m);
        let path = Path {
            orientation: &attitude,
            upward,
            vertical,
            sqrt_density,
        };
        let measured_mps =
            self.airspeed
                .step(now, measurements, &attitude, &vertical, sqrt_density, dt_s);
        self.compare(now, measurements, sqrt_density, dt_s);
        let input = MonitorInput {
            over_ground: self.over_ground(now, measurements, &path, dt_s),
            ..self.monitor_input(now, measurements, &path)
        };
        let known = is_current(&force, now) && is_current(&measurements.attitude, now);
        self.monitor.step(&input, if known { dt_s } else { 0.0 });
        let without = self.monitor.without_sensor(&input);
        if without.is_some() {
            self.airspeed.adopt_next();
        }
        let (airspeed_mps, airspeed_uncertainty_mps) = without.unwrap_or((measured_mps, 0.0));
        let airspeed_source = if without.is_some() {
            AirspeedSource::Forces
        } else {
            AirspeedSource::Sensor
        };
        if is_current(&force, now) {
            self.side_force.step(force.value.y_mps2, dt_s);
        }
        let true_airspeed_mps = airspeed_mps / sqrt_density;
        let lift = self.lift.step(now, measurements, &path, airspeed_mps, dt_s);
        self.estimate = Estimate {
            roll_rad: attitude.roll_rad,
            pitch_rad: attitude.pitch_rad,
            heading_rad: attitude.heading_rad,
            body_rates: measurements.body_rates.value,
            airspeed_mps,
            true_airspeed_mps,
            altitude_m: vertical.altitude_m,
            climb_rate_mps: vertical.climb_rate_mps,
            side_force_mps2: self.side_force.output(),
            load_factor: lift.load_factor,
            gust_load: lift.gust_load,
            angle_of_attack_rad: lift.angle_of_attack_rad,
            acceleration_mps2: lift.acceleration_mps2,
            airspeed_source,
            airspeed_uncertainty_mps,
            ..self.estimate
        };
    }

    /// Compares the sensors with each other before engaging.
    fn compare(&mut self, now: Time, sensed: &Measurements, sqrt_density: f64, dt_s: f64) {
        if self.is_engaged {
            self.agreement = Agreement::new();
        } else {
            let true_mps = sensed.airspeed_mps.value / sqrt_density;
            self.agreement.step(now, sensed, true_mps, dt_s);
        }
    }

    /// Which sensors contradict each other, before engaging.
    pub fn contradictions(&self) -> Contradictions {
        self.agreement.contradictions()
    }

    /// The latest estimate.
    pub const fn estimate(&self) -> &Estimate {
        &self.estimate
    }

    /// Marks the present altitude.
    pub const fn mark_altitude(&mut self) {
        self.vertical.mark();
    }

    /// Counts the full turns of the heading so that it is the nearest to
    /// `near_rad`: after an upset they say nothing of the turn that was flown.
    pub fn count_heading_near(&mut self, near_rad: f64) {
        self.estimate.heading_rad = self.attitude.count_near(near_rad);
    }

    /// The present estimate of the altitude at the mark, m; none if nothing was
    /// marked.
    pub fn marked_altitude_m(&self) -> Option<f64> {
        self.vertical.marked_altitude_m()
    }

    /// Nothing arrived for a time that counts as not passed: later readings
    /// follow the last ones as if those had been taken `by` later, but not later
    /// than `latest`.
    pub fn postpone(&mut self, by: Duration, latest: Time) {
        self.attitude.postpone(by, latest);
        self.vertical.postpone(by, latest);
        self.airspeed.postpone(by, latest);
    }

    /// The aircraft flew on for `passed_s` unobserved: attitude, heading and
    /// airspeed are adopted from the next readings; altitude and climb rate are
    /// predicted, and their uncertainty grows.
    pub fn resume(&mut self, passed_s: f64) {
        self.attitude.adopt_next();
        self.vertical.coast(passed_s);
        self.airspeed.adopt_next();
        self.agreement = Agreement::new();
        self.motion = self.motion.renewed();
        if self.monitor.doubt().is_none() {
            self.monitor = AirspeedMonitor::new(self.airframe);
        }
        if !self.altitude_monitor.is_doubted() {
            self.altitude_monitor = AltitudeMonitor::new();
        }
    }

    /// Resets everything but what is known of the sensors, after the plant was
    /// repositioned.
    pub fn reset(&mut self, config: &NavigationConfig) {
        let known = self.clone();
        *self = Self::new(config);
        self.airframe = known.airframe;
        self.monitor = AirspeedMonitor::new(known.airframe);
        self.lift = known.lift.renewed();
        self.attitude.keep_resolution(&known.attitude);
        self.vertical.keep_resolution(&known.vertical);
        self.airspeed.keep_resolution(&known.airspeed);
    }

    /// The resolutions of the sensors, as far as their readings have shown them.
    pub const fn resolutions(&self) -> Resolutions {
        Resolutions {
            heading_rad: self.attitude.heading_resolution().smallest(),
            airspeed_mps: self.airspeed.resolution().smallest(),
            altitude_step_m: self.vertical.resolution().step(),
        }
    }

    /// What evidence of frozen sensors needs.
    pub const fn known(&self) -> Known {
        Known {
            felt_mps2: self.airspeed.felt_mps2(),
            felt_up_mps2: self.vertical.felt_mps2(),
            resolutions: self.resolutions(),
            rate_bias_radps: self.motion.rate_bias_radps(),
        }
    }
}

/// The stalling speed of a Cessna 172, m/s (53 kt).
const STALL_AIRSPEED_MPS: f64 = 53.0 * KNOT_MPS;
