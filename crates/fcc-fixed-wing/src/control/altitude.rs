//! Altitude → climb rate → pitch → pitch rate → elevator.

use libm::{asin, cos, sin, tan};

use super::{Envelope, MAX_TURN_BANK_RAD, SURFACE, Schedule, SpeedLimits};
use fcc_core::blocks::{LowPass, Pid, PidConfig, RateLimit, SquareRootProfile, limit, limit_abs};
use fcc_core::units::GRAVITY_MPS2;
use fcc_navigation::{AirspeedSource, Estimate};

/// Gains of the altitude loop; surface gains hold at the reference airspeed.
///
/// ```
/// use fcc_fixed_wing::control::{AltitudeConfig, AltitudeLoop, Envelope};
///
/// let gentle = AltitudeConfig { altitude_gain_per_s: 0.5, ..AltitudeConfig::default() };
/// assert_eq!(AltitudeLoop::new(gentle, &Envelope::default()).trim(), 0.0);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct AltitudeConfig {
    /// Climb rate per altitude error near the target, 1/s.
    pub altitude_gain_per_s: f64,
    /// Planned vertical deceleration of the altitude capture, m/s².
    pub capture_mps2: f64,
    /// Largest rate of change of the commanded climb rate, m/s².
    pub climb_acceleration_mps2: f64,
    /// Commanded flight-path angle per climb-rate error over airspeed.
    pub climb_rate_gain: f64,
    /// The same, integrated, 1/s.
    pub climb_rate_integral_gain_per_s: f64,
    /// Lag of the flight path behind the commanded one, s: error explained by
    /// this lag is not integrated.
    pub flight_path_lag_s: f64,
    /// Angle of attack for 1 g at the reference airspeed, rad.
    pub angle_of_attack_per_g_rad: f64,
    /// Pitch rate per pitch error, 1/s.
    pub pitch_gain_per_s: f64,
    /// Largest commanded pitch rate in addition to that of the turn, rad/s.
    pub max_pitch_rate_radps: f64,
    /// Elevator per pitch-rate error, per rad/s.
    pub pitch_rate_gain: f64,
    /// Elevator per integrated pitch-rate error, per rad.
    pub pitch_rate_integral_gain: f64,
    /// Elevator for the load of a turn, per g above 1.
    pub elevator_per_g: f64,
}

impl Default for AltitudeConfig {
    fn default() -> Self {
        Self {
            altitude_gain_per_s: 1.25,
            capture_mps2: 1.108_151,            // 0.113 g
            climb_acceleration_mps2: 3.285_228, // 0.335 g
            climb_rate_gain: 1.45,
            climb_rate_integral_gain_per_s: 0.35,
            flight_path_lag_s: 0.235,
            angle_of_attack_per_g_rad: 0.038_572, // 2.21°
            pitch_gain_per_s: 4.6,
            max_pitch_rate_radps: 0.174_533, // 10 °/s
            pitch_rate_gain: 0.84,
            pitch_rate_integral_gain: 0.78,
            elevator_per_g: 0.30,
        }
    }
}

/// The commands of the altitude loop.
///
/// ```
/// use fcc_fixed_wing::control::PitchCommand;
///
/// assert_eq!(PitchCommand::default().elevator, 0.0);
/// ```
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct PitchCommand {
    /// Commanded climb rate, m/s.
    pub climb_rate_mps: f64,
    /// Commanded pitch, rad.
    pub pitch_rad: f64,
    /// -1..=1, positive raises the nose.
    pub elevator: f64,
}

/// Altitude → climb rate → pitch → pitch rate → elevator.
///
/// ```
/// use fcc_fixed_wing::control::{AltitudeConfig, AltitudeLoop, Envelope, Schedule};
/// use fcc_navigation::Estimate;
///
/// let level = Estimate {
///     airspeed_mps: 51.4,
///     true_airspeed_mps: 53.8,
///     altitude_m: 914.4,
///     ..Estimate::default()
/// };
/// let (envelope, schedule) = (Envelope::default(), Schedule::at(51.4, 51.4));
/// let mut altitude = AltitudeLoop::new(AltitudeConfig::default(), &envelope);
/// altitude.engage(0.05, &level, schedule);
/// // On target: the elevator stays.
/// let held = altitude.step(914.4, &level, &envelope, schedule, 0.025);
/// assert!((held.elevator - 0.05).abs() < 1e-9);
/// // 150 ft higher: the nose goes up.
/// let climb = altitude.step(960.1, &level, &envelope, schedule, 0.025);
/// assert!(climb.climb_rate_mps > 0.0 && climb.elevator > held.elevator);
/// ```
#[derive(Clone, Debug)]
pub struct AltitudeLoop {
    config: AltitudeConfig,
    climb_rate: RateLimit,
    /// The flight-path angle expected now from the past commands, rad.
    expected_path: LowPass,
    pub(super) speed: SpeedLimits,
    pitch: Pid,
    pitch_rate: Pid,
}

/// How fast the angle of attack approaches its limit, 1/s.
const ANGLE_OF_ATTACK_GAIN_PER_S: f64 = 2.0;
/// Nearer to its limit, rad (1°), the angle of attack is at it.
const NO_SPARE_RAD: f64 = 0.017;

impl AltitudeLoop {
    /// A loop that is not engaged.
    pub const fn new(config: AltitudeConfig, envelope: &Envelope) -> Self {
        Self {
            config,
            climb_rate: RateLimit::new(config.climb_acceleration_mps2),
            expected_path: LowPass::new(config.flight_path_lag_s),
            speed: SpeedLimits::new(),
            pitch: Pid::new(PidConfig {
                kp: config.climb_rate_gain,
                ki: config.climb_rate_integral_gain_per_s,
                output_min: envelope.min_pitch_rad,
                output_max: envelope.max_pitch_rad,
                ..SURFACE
            }),
            pitch_rate: Pid::new(PidConfig {
                kp: config.pitch_rate_gain,
                ki: config.pitch_rate_integral_gain,
                ..SURFACE
            }),
        }
    }

    /// Engages with the present elevator and motion of the aircraft.
    pub fn engage(&mut self, elevator: f64, estimate: &Estimate, schedule: Schedule) {
        let path = flight_path(estimate.climb_rate_mps, estimate);
        self.pitch.engage(
            estimate.pitch_rad,
            path,
            path,
            path + self.angle_of_attack(estimate, schedule),
            1.0,
        );
        let rate = estimate.body_rates.pitch_radps;
        let feed_forward = schedule.moment * self.config.elevator_per_g * turn_load(estimate);
        let gain = schedule.moment * schedule.pitch_pace;
        self.pitch_rate
            .engage(elevator, rate, rate, feed_forward, gain);
        self.restart(estimate);
    }

    /// Continues with the present motion of the aircraft, and with the trims found before.
    pub(crate) fn restart(&mut self, estimate: &Estimate) {
        self.climb_rate.reset(estimate.climb_rate_mps);
        let path = flight_path(estimate.climb_rate_mps, estimate);
        self.expected_path.reset(path);
        self.speed = SpeedLimits::new();
    }

    /// Changes the climb rate as fast as this at least (m/s²): 0 for as fast as
    /// usual.
    pub const fn pull_out(&mut self, least_mps2: f64) {
        let usual_mps2 = self.config.climb_acceleration_mps2;
        self.climb_rate.set_rate(usual_mps2.max(least_mps2));
    }

    /// The airspeed that is ordered, m/s: it goes before the altitude if the lowest
    /// airspeed needs more power than there is.
    pub const fn order_airspeed(&mut self, airspeed_mps: f64) {
        self.speed.order(airspeed_mps);
    }

    /// One step towards an altitude (m).
    pub fn step(
        &mut self,
        altitude_m: f64,
        estimate: &Estimate,
        envelope: &Envelope,
        schedule: Schedule,
        dt_s: f64,
    ) -> PitchCommand {
        let profile = SquareRootProfile {
            gain_per_s: schedule.outer * schedule.pace * self.config.altitude_gain_per_s,
            deceleration: self.config.capture_mps2,
        };
        let wanted = profile.speed(altitude_m - estimate.altitude_m);
        self.hold_climb_rate(wanted, estimate, envelope, schedule, dt_s)
    }

    /// One step towards a climb rate (m/s), as far as the airspeed allows it.
    pub fn hold_climb_rate(
        &mut self,
        climb_rate_mps: f64,
        estimate: &Estimate,
        envelope: &Envelope,
        schedule: Schedule,
        dt_s: f64,
    ) -> PitchCommand {
        let wanted = limit(
            climb_rate_mps,
            -envelope.max_sink_mps,
            envelope.max_climb_mps,
        );
        let climb_rate_mps = self.climb_rate.step(wanted, dt_s);
        let path = flight_path(climb_rate_mps, estimate);
        let expected = self.expected_path.step(path, schedule.path * dt_s);
        // The gain acts on the whole error, the integral only on the part not
        // explained by the lag.
        let ahead = schedule.path * self.config.climb_rate_gain * (path - expected);
        self.limit_pitch(estimate, envelope, dt_s);
        let pitch_rad = self.pitch.step_scheduled(
            expected,
            flight_path(estimate.climb_rate_mps, estimate),
            path + ahead + self.angle_of_attack(estimate, schedule),
            schedule.path,
            dt_s,
        );
        self.hold(
            climb_rate_mps,
            pitch_rad,
            estimate,
            envelope,
            schedule,
            dt_s,
        )
    }

    /// One step towards a pitch (rad), as far as the airspeed allows it.
    pub fn hold_pitch(
        &mut self,
        pitch_rad: f64,
        estimate: &Estimate,
        envelope: &Envelope,
        schedule: Schedule,
        dt_s: f64,
    ) -> PitchCommand {
        self.limit_pitch(estimate, envelope, dt_s);
        let pitch_rad = self.pitch.limited(pitch_rad);
        let climb_rate_mps = estimate.climb_rate_mps;
        self.climb_rate.reset(climb_rate_mps);
        self.hold(
            climb_rate_mps,
            pitch_rad,
            estimate,
            envelope,
            schedule,
            dt_s,
        )
    }

    /// One step towards the pitch expected for a flight path (rad, up) at the
    /// airspeed of the schedule `trimmed`, if the climb rate is not known.
    pub fn hold_path_pitch(
        &mut self,
        path_rad: f64,
        trimmed: Schedule,
        estimate: &Estimate,
        envelope: &Envelope,
        schedule: Schedule,
        dt_s: f64,
    ) -> PitchCommand {
        self.limit_pitch(estimate, envelope, dt_s);
        let level = self.angle_of_attack(estimate, trimmed) + self.pitch.integral();
        let pitch_rad = self.pitch.limited(path_rad + level);
        let climb_rate_mps = estimate.true_airspeed_mps * sin(path_rad);
        self.hold(
            climb_rate_mps,
            pitch_rad,
            estimate,
            envelope,
            schedule,
            dt_s,
        )
    }

    /// The elevator for a pitch-rate error (rad/s) and a load of the wing above
    /// that of the trim (g at the reference airspeed), without the integral: while
    /// another law determines the pitch.
    pub(crate) fn elevator_for(
        &self,
        error_radps: f64,
        load: f64,
        trim: f64,
        schedule: Schedule,
    ) -> f64 {
        trim + self.config.elevator_per_g * load
            + schedule.moment * self.config.pitch_rate_gain * error_radps
    }

    /// What `dt_s` of a pitch-rate error (rad/s) add to the elevator.
    pub(crate) fn elevator_increment(
        &self,
        error_radps: f64,
        schedule: Schedule,
        dt_s: f64,
    ) -> f64 {
        schedule.moment * self.config.pitch_rate_integral_gain * error_radps * dt_s
    }

    /// Whether energy is short for both height and airspeed: the airspeed is
    /// held, and height is given up.
    pub const fn gives_up_height(&self) -> bool {
        self.speed.is_short()
    }

    /// The least throttle, 0..=1: full while height is given up.
    pub fn least_throttle(&self) -> f64 {
        self.speed.shortage()
    }

    /// The elevator trim that the loop has found.
    pub const fn trim(&self) -> f64 {
        self.pitch_rate.integral()
    }

    /// Limits the pitch to that at which the airspeed stays within its limits.
    fn limit_pitch(&mut self, estimate: &Estimate, envelope: &Envelope, dt_s: f64) {
        let mut limits = self.speed.step(estimate, envelope, dt_s);
        if estimate.airspeed_source == AirspeedSource::Forces {
            // An estimate that is wrong neither dives nor zooms: it leads the path no further
            // than what may be commanded.
            let to = |climb_rate_mps: f64| {
                let path = flight_path(climb_rate_mps, estimate);
                estimate.pitch_rad + path - flight_path(estimate.climb_rate_mps, estimate)
            };
            limits.max_rad = limits.max_rad.max(to(-envelope.max_sink_mps));
            limits.min_rad = limits.min_rad.min(to(envelope.max_climb_mps));
        }
        let (least, most) = (envelope.min_pitch_rad, envelope.max_pitch_rad);
        self.pitch.set_output_limits(
            limit(limits.min_rad, least, most),
            limit(limits.max_rad, least, most),
        );
    }

    fn hold(
        &mut self,
        climb_rate_mps: f64,
        pitch_rad: f64,
        estimate: &Estimate,
        envelope: &Envelope,
        schedule: Schedule,
        dt_s: f64,
    ) -> PitchCommand {
        let spare_rad = envelope.max_angle_of_attack_rad - estimate.angle_of_attack_rad;
        self.speed
            .commanded(pitch_rad, spare_rad < NO_SPARE_RAD, dt_s);
        let config = &self.config;
        let speed = estimate.true_airspeed_mps.max(1.0);
        let bank = limit_abs(estimate.roll_rad, MAX_TURN_BANK_RAD);
        // Euler pitch rate converted to body axes, plus the pitch rate of the
        // turn: q = θ̇ cos φ + ψ̇ cos θ sin φ.
        let theta_rate = limit_abs(
            schedule.pitch_pace * config.pitch_gain_per_s * (pitch_rad - estimate.pitch_rad),
            config.max_pitch_rate_radps,
        );
        let cos_bank = cos(bank);
        let turn_rate = GRAVITY_MPS2 / speed * tan(bank);
        let turn_pitch_rate = turn_rate * cos(estimate.pitch_rad) * sin(bank);
        // Load factor in excess of 1 is about V q / g.
        let per_load = GRAVITY_MPS2 / speed;
        let most = per_load * (envelope.max_load_factor - cos_bank).max(0.1);
        let wanted = limit_abs(theta_rate * cos_bank + turn_pitch_rate, most);
        // α̇ = q - (n - cos φ) g/V: the pitch rate at which the angle of attack
        // approaches its limit and does not exceed it.
        let kept = per_load * (estimate.load_factor - cos_bank);
        let most_rate = 2.0 * config.max_pitch_rate_radps;
        let kept_rate = limit_abs(ANGLE_OF_ATTACK_GAIN_PER_S * spare_rad + kept, most_rate);
        // It lowers the nose to the smallest pitch, and not further.
        let to_least = schedule.pitch_pace
            * config.pitch_gain_per_s
            * (envelope.min_pitch_rad - estimate.pitch_rad);
        let least_rate = limit_abs(to_least, most_rate) * cos_bank + turn_pitch_rate;
        let pitch_rate = wanted.min(kept_rate.max(least_rate));
        let elevator = self.pitch_rate.step_scheduled(
            pitch_rate,
            estimate.body_rates.pitch_radps,
            schedule.moment * config.elevator_per_g * turn_load(estimate),
            schedule.moment * schedule.pitch_pace,
            // The integral's time constant is as long as the loop is slow.
            schedule.pitch_pace * dt_s,
        );
        PitchCommand {
            climb_rate_mps,
            pitch_rad,
            elevator,
        }
    }

    /// The angle of attack needed in this turn at this airspeed: proportional
    /// to load, inversely proportional to dynamic pressure.
    fn angle_of_attack(&self, estimate: &Estimate, schedule: Schedule) -> f64 {
        self.config.angle_of_attack_per_g_rad * schedule.moment * (1.0 + turn_load(estimate))
    }
}

/// Load factor above 1 of a level turn at the present bank: 1/cos φ - 1.
fn turn_load(estimate: &Estimate) -> f64 {
    1.0 / cos(limit_abs(estimate.roll_rad, MAX_TURN_BANK_RAD)) - 1.0
}

/// Flight-path angle of a climb rate at the present airspeed, rad.
fn flight_path(climb_rate_mps: f64, estimate: &Estimate) -> f64 {
    let speed = estimate.true_airspeed_mps.max(1.0);
    asin(limit_abs(climb_rate_mps / speed, 0.7))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Level at 100 kt, and the airspeed by forces is 60 kt too low: the nose is lowered for the
    /// sink rate that may be commanded, 965 ft/min or 13.8° at the estimate, from a sensor's to
    /// the smallest pitch.
    #[test]
    fn an_airspeed_by_forces_leads_to_no_more_sink_than_is_commanded() {
        let envelope = Envelope::default();
        let lowest = |airspeed_source| {
            let estimate = Estimate {
                airspeed_mps: 20.578,
                true_airspeed_mps: 20.578,
                airspeed_source,
                ..Estimate::default()
            };
            let mut altitude = AltitudeLoop::new(AltitudeConfig::default(), &envelope);
            let schedule = Schedule::at(51.444, 51.444);
            altitude.engage(0.0, &estimate, schedule);
            let commands = (0..400)
                .map(|_| altitude.hold_climb_rate(0.0, &estimate, &envelope, schedule, 0.025));
            commands.fold(0.0, |least: f64, command| least.min(command.pitch_rad))
        };
        let sink_rad = asin(envelope.max_sink_mps / 20.578);
        assert!((lowest(AirspeedSource::Forces) + sink_rad).abs() < 1e-6);
        assert!((lowest(AirspeedSource::Sensor) - envelope.min_pitch_rad).abs() < 1e-6);
    }
}
