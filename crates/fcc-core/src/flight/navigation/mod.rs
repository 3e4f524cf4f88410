//! Navigation: attitude, airspeed, altitude and their rates.
//!
//! Sensors differ in accuracy over time: gyroscopes are accurate over short
//! times, gravity and the compass over long times; accelerometers over short
//! times, the barometer over long times. Each channel here combines one such
//! pair, and predicts through ticks in which nothing new arrived.

mod air_data;
mod airspeed_filter;
mod airspeed_monitor;
mod airspeed_reason;
mod altitude_monitor;
mod attitude;
mod frozen;
mod lift;
mod plausibility;
mod replacement;
mod resolution;
mod upward;
mod vertical;
mod vertical_covariance;
mod without_altimeter;

use core::time::Duration;

use libm::sqrt;

use super::atmosphere::density_ratio;
use super::{BodyRates, Measurements};
use crate::blocks::LowPass;
use crate::framework::{Reading, Time};
use crate::schema;
use crate::units::{GRAVITY_MPS2, KNOT_MPS};
use airspeed_filter::{AirframePrior, ForceSample};
use airspeed_monitor::{AirspeedMonitor, MonitorInput, in_g};
use altitude_monitor::AltitudeMonitor;

pub use air_data::AirspeedChannel;
pub use airspeed_monitor::AirspeedSource;
pub(crate) use airspeed_reason::{Doubt, DoubtReason};
pub use attitude::AttitudeChannel;
use attitude::Orientation;
pub(crate) use frozen::{Frozen, FrozenDetector, Known};
pub use lift::{Lift, LiftChannel};
pub(crate) use plausibility::{
    ATTITUDE_RAD, GateLimits, HEADING_RAD, HEIGHT_M, PlausibilityLimit, airspeed_can_follow,
    airspeed_is_suspect, plausibility_gate,
};
pub(crate) use replacement::{Lost, Replacement};
pub(crate) use resolution::Resolutions;
pub use vertical::VerticalChannel;
use vertical::VerticalState;

/// Time constants of navigation's channels.
///
/// ```
/// use fcc_core::flight::navigation::{Navigation, NavigationConfig};
///
/// let smooth = NavigationConfig { airspeed_tau_s: 2.0, ..NavigationConfig::default() };
/// assert_eq!(Navigation::new(&smooth).estimate().airspeed_mps, 0.0);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct NavigationConfig {
    /// Time constant of the attitude, s: the gyroscopes determine it over
    /// shorter times, the measured pitch and roll over longer times.
    pub attitude_tau_s: f64,
    /// Time constant of the heading, s, likewise.
    pub heading_tau_s: f64,
    /// Bandwidth of the climb rate, rad/s: above it the accelerometers
    /// determine it, below it the barometer.
    pub vertical_bandwidth_radps: f64,
    /// Time constant of the airspeed, s: the accelerometers determine it over
    /// shorter times, the airspeed sensor over longer times.
    pub airspeed_tau_s: f64,
    /// Time constant of the low pass of the side force, s.
    pub side_force_tau_s: f64,
}

impl Default for NavigationConfig {
    fn default() -> Self {
        Self {
            attitude_tau_s: 1.36,
            heading_tau_s: 1.44,
            vertical_bandwidth_radps: 0.68,
            airspeed_tau_s: 0.89,
            side_force_tau_s: 0.19,
        }
    }
}

schema! {
    /// Navigation's estimate.
    ///
    /// ```
    /// use fcc_core::flight::navigation::Estimate;
    ///
    /// // The heading is continuous: 370° is 10° after a turn to the right.
    /// let turned = Estimate { heading_rad: 370.0_f64.to_radians(), ..Estimate::default() };
    /// let compass_rad = fcc_core::blocks::wrap_two_pi(turned.heading_rad);
    /// assert!((compass_rad.to_degrees() - 10.0).abs() < 1e-9);
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Estimate {
        /// Right wing down, rad.
        #[field(1)]
        pub roll_rad: f64,
        /// Nose up, rad.
        #[field(2)]
        pub pitch_rad: f64,
        /// Magnetic heading, rad, continuous through full turns: 370° is 10°
        /// after one turn to the right.
        #[field(3)]
        pub heading_rad: f64,
        /// Turn rates about the body axes.
        #[field(4)]
        pub body_rates: BodyRates,
        /// Indicated airspeed, m/s.
        #[field(5)]
        pub airspeed_mps: f64,
        /// True airspeed, m/s.
        #[field(6)]
        pub true_airspeed_mps: f64,
        /// Pressure altitude, m.
        #[field(7)]
        pub altitude_m: f64,
        /// Climb rate, m/s, up.
        #[field(8)]
        pub climb_rate_mps: f64,
        /// Specific force to the right, m/s²: 0 in a coordinated turn.
        #[field(9)]
        pub side_force_mps2: f64,
        /// Load factor, g, along the body's z axis, upwards.
        #[field(10)]
        pub load_factor: f64,
        /// Standard deviation of the load that gusts cause, g.
        #[field(11)]
        pub gust_load: f64,
        /// Angle of attack, rad: measured if a source has it, otherwise
        /// estimated from the lift.
        #[field(12, column = "estimated_angle_of_attack_rad")]
        pub angle_of_attack_rad: f64,
        /// Acceleration along the flight path, without gusts, m/s².
        #[field(13)]
        pub acceleration_mps2: f64,
        /// The time from an output to its effect, s, measured by the elevator;
        /// until then the assumed one.
        #[field(14)]
        pub output_latency_s: f64,
        /// The play of the elevator, in the elevator's units of -1 to 1.
        #[field(15)]
        pub elevator_play: f64,
        /// Where the airspeed comes from.
        #[field(16)]
        pub airspeed_source: AirspeedSource,
        /// Standard deviation of an airspeed that comes from the forces, m/s;
        /// 0 while the sensor is used.
        #[field(17)]
        pub airspeed_uncertainty_mps: f64,
        /// How old the newest reading was when it arrived, s, by its source's own
        /// clock and relative to the fastest one; 0 if it has none.
        #[field(410)]
        pub reading_age_s: f64,
        /// The mean change of that age from one arrival to the next, s.
        #[field(411)]
        pub reading_jitter_s: f64,
    }
}

/// Computes an [`Estimate`] from measurements.
///
/// ```
/// use fcc_core::flight::Measurements;
/// use fcc_core::flight::navigation::{Navigation, NavigationConfig};
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
    airframe: AirframePrior,
    throttle: Option<f64>,
    is_engaged: bool,
    side_force: LowPass,
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
            airframe: CESSNA_172,
            throttle: None,
            is_engaged: false,
            side_force: LowPass::new(config.side_force_tau_s),
            estimate: Estimate {
                roll_rad: 0.0,
                pitch_rad: 0.0,
                heading_rad: 0.0,
                body_rates: BodyRates {
                    roll_radps: 0.0,
                    pitch_radps: 0.0,
                    yaw_radps: 0.0,
                },
                airspeed_mps: 0.0,
                true_airspeed_mps: 0.0,
                altitude_m: 0.0,
                climb_rate_mps: 0.0,
                side_force_mps2: 0.0,
                output_latency_s: 0.0,
                elevator_play: 0.0,
                load_factor: 1.0,
                gust_load: 0.0,
                angle_of_attack_rad: 0.0,
                acceleration_mps2: 0.0,
                airspeed_source: AirspeedSource::Sensor,
                airspeed_uncertainty_mps: 0.0,
                reading_age_s: 0.0,
                reading_jitter_s: 0.0,
            },
        }
    }

    /// The same for an aircraft that cruises near an airspeed, and whose throttle
    /// accelerates it by 1 m/s² per this much.
    #[must_use]
    pub fn for_aircraft(mut self, reference_airspeed_mps: f64, throttle_per_mps2: f64) -> Self {
        self.airframe = AirframePrior {
            reference_mps: reference_airspeed_mps,
            full_thrust_ratio: FULL_THRUST_SHARE / (throttle_per_mps2 * GRAVITY_MPS2),
        };
        self.monitor = AirspeedMonitor::new(self.airframe);
        self
    }

    /// The throttle from now on, 0..=1, if it is known, and whether the
    /// autopilot is engaged: only then is a sensor doubted.
    pub(crate) const fn flown_with(&mut self, throttle: Option<f64>, is_engaged: bool) {
        self.throttle = throttle;
        self.is_engaged = is_engaged;
    }

    /// The doubt of the airspeed sensor, while it lasts.
    pub(crate) const fn airspeed_doubt(&self) -> Option<Doubt> {
        self.monitor.doubt()
    }

    /// Whether the altimeter is doubted, and the altitude without it known.
    pub(crate) fn altitude_doubt(&self) -> Option<bool> {
        let monitor = &self.altitude_monitor;
        monitor.is_doubted().then(|| monitor.is_sound())
    }

    /// Whether an airspeed may be used beside those of other sensors.
    pub(crate) fn permits_airspeed(&self, airspeed_mps: f64) -> bool {
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
        let vertical = self.step_vertical(now, measurements, &attitude, dt_s);
        let measured_mps = self
            .airspeed
            .step(now, measurements, &attitude, &vertical, dt_s);
        let input = self.monitor_input(now, measurements, &attitude, &vertical);
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
        let true_airspeed_mps =
            super::atmosphere::true_airspeed_mps(airspeed_mps, vertical.altitude_m);
        let path = lift::Path {
            orientation: &attitude,
            airspeed_mps,
            true_airspeed_mps,
            climb_rate_mps: vertical.climb_rate_mps,
        };
        let lift = self.lift.step(now, measurements, &path, dt_s);
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

    fn monitor_input(
        &self,
        now: Time,
        measurements: &Measurements,
        attitude: &Orientation,
        vertical: &VerticalState,
    ) -> MonitorInput {
        let force = measurements.specific_force.value;
        let (forward, up) = in_g(force.x_mps2, force.z_mps2);
        let airspeed = measurements.airspeed_mps;
        MonitorInput {
            sample: ForceSample {
                forward,
                up,
                pitch_rad: attitude.pitch_rad,
                roll_rad: attitude.roll_rad,
                climb_rate_mps: vertical.climb_rate_mps,
                climbs_by_lift: self.altitude_monitor.is_doubted()
                    && !self.monitor.shares_static_port()
                    && !is_current(&measurements.velocity, now),
                sqrt_density: sqrt(density_ratio(vertical.altitude_m)),
                ..ForceSample::default()
            },
            throttle: self.throttle,
            altitude_m: vertical.altitude_m,
            sensor_mps: is_current(&airspeed, now).then_some((airspeed.value, airspeed.source)),
            altimeter_is_doubted: self.altitude_monitor.is_doubted(),
            may_doubt: self.is_engaged,
        }
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
    pub(crate) fn count_heading_near(&mut self, near_rad: f64) {
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
    pub(crate) fn postpone(&mut self, by: Duration, latest: Time) {
        self.attitude.postpone(by, latest);
        self.vertical.postpone(by, latest);
        self.airspeed.postpone(by, latest);
    }

    /// The aircraft flew on for `passed_s` unobserved: attitude, heading and
    /// airspeed are adopted from the next readings; altitude and climb rate are
    /// predicted, and their uncertainty grows.
    pub(crate) fn resume(&mut self, passed_s: f64) {
        self.attitude.adopt_next();
        self.vertical.coast(passed_s);
        self.airspeed.adopt_next();
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
    pub(crate) const fn resolutions(&self) -> Resolutions {
        Resolutions {
            heading_rad: self.attitude.heading_resolution().smallest(),
            airspeed_mps: self.airspeed.resolution().smallest(),
            altitude_m: self.vertical.resolution().smallest(),
            altitude_step_m: self.vertical.resolution().step(),
        }
    }

    /// What evidence of frozen sensors needs.
    pub(crate) const fn known(&self) -> Known {
        Known {
            estimate: self.estimate,
            felt_mps2: self.airspeed.felt_mps2(),
            felt_up_mps2: self.vertical.felt_mps2(),
            resolutions: self.resolutions(),
        }
    }
}

/// The stalling speed of a Cessna 172, m/s (53 kt).
const STALL_AIRSPEED_MPS: f64 = 53.0 * KNOT_MPS;

/// The aircraft of the default gains: 100 kt, throttle for 1 g of 3.63.
const CESSNA_172: AirframePrior = AirframePrior {
    reference_mps: 51.444_444,
    full_thrust_ratio: 0.25,
};

/// Thrust over weight at full throttle, from the throttle per g in cruise: thrust
/// is proportional to the square of the throttle, whose slope is 1 at a half.
const FULL_THRUST_SHARE: f64 = 0.9;

/// A source that is silent for longer than this is no longer integrated, and
/// when it returns, its value is adopted at once.
const CURRENT: Duration = Duration::from_millis(500);

fn is_current<T>(reading: &Reading<T>, now: Time) -> bool {
    reading.is_fresh(now, CURRENT)
}

/// Distinguishes new values from ones processed before, and determines how to
/// use them.
#[derive(Clone, Copy, Debug, Default)]
struct SampleTracker {
    taken: Time,
    /// The next new one is adopted at once, whatever its age.
    adopts_next: bool,
}

enum NewSample {
    /// Nothing new.
    None,
    /// The first, or the first after a long silence: adopt it at once.
    First,
    /// A further one, this many seconds after the previous one.
    Next(f64),
}

impl SampleTracker {
    const fn new() -> Self {
        Self {
            taken: Time::NEVER,
            adopts_next: false,
        }
    }

    fn postpone(&mut self, by: Duration, latest: Time) {
        self.taken = self.taken.postponed(by, latest);
    }

    /// `dt_s` is the plant's time since the last tick: while it does not
    /// advance, a measurement is not new.
    fn of<T>(&mut self, reading: &Reading<T>, dt_s: f64) -> NewSample {
        if reading.is_never() || reading.taken <= self.taken {
            return NewSample::None;
        }
        let gap = reading.taken.since(self.taken);
        self.taken = reading.taken;
        if core::mem::take(&mut self.adopts_next) || gap > CURRENT {
            NewSample::First
        } else if dt_s > 0.0 {
            NewSample::Next(gap.as_secs_f64())
        } else {
            NewSample::None
        }
    }
}
