//! Heading → turn rate → bank → roll rate → aileron, and the rudder.

use libm::{atan, tan};

use super::{Envelope, MAX_TURN_BANK_RAD, SURFACE, Schedule};
use fcc_core::blocks::{HighPass, Pid, PidConfig, RateLimit, SquareRootProfile, limit_abs};
use fcc_core::units::GRAVITY_MPS2;
use fcc_navigation::Estimate;

/// Gains of the heading loop; surface gains hold at the reference airspeed.
///
/// ```
/// use fcc_fixed_wing::control::{HeadingConfig, HeadingLoop};
///
/// let calm = HeadingLoop::new(HeadingConfig { heading_gain_per_s: 0.5, ..HeadingConfig::default() });
/// assert_eq!(calm.aileron_trim(), 0.0);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct HeadingConfig {
    /// Turn rate per heading error near the target, 1/s.
    pub heading_gain_per_s: f64,
    /// Planned roll rate of the roll-out, rad/s.
    pub rollout_rate_radps: f64,
    /// Prediction time of the heading, s: the lag of the roll loop.
    pub lead_s: f64,
    /// Roll rate per bank error, 1/s.
    pub roll_gain_per_s: f64,
    /// Largest commanded roll rate, rad/s.
    pub max_roll_rate_radps: f64,
    /// Largest rate of change of the commanded roll rate, rad/s².
    pub max_roll_acceleration_radps2: f64,
    /// Aileron for a steady roll rate, per rad/s.
    pub aileron_per_roll_rate: f64,
    /// Aileron per roll-rate error, per rad/s.
    pub roll_rate_gain: f64,
    /// Aileron per integrated roll-rate error, per rad.
    pub roll_rate_integral_gain: f64,
    /// Rudder per aileron, against adverse yaw, at the reference airspeed.
    pub rudder_per_aileron: f64,
    /// Time constant of its washout, s: after it, an aileron beyond that of
    /// the commanded roll rate moves no rudder.
    pub rudder_washout_s: f64,
    /// Rudder per side force, per m/s².
    pub side_force_gain: f64,
    /// Rudder per integrated side force, per m/s.
    pub side_force_integral_gain: f64,
    /// Rudder per yaw rate in excess of the turn's, per rad/s.
    pub yaw_damping: f64,
}

impl Default for HeadingConfig {
    fn default() -> Self {
        Self {
            heading_gain_per_s: 0.92,
            rollout_rate_radps: 0.366_519, // 21 °/s
            lead_s: 0.28,
            roll_gain_per_s: 3.1,
            max_roll_rate_radps: 0.698_132,          // 40 °/s
            max_roll_acceleration_radps2: 1.204_277, // 69 °/s²
            aileron_per_roll_rate: 0.27,
            roll_rate_gain: 0.38,
            roll_rate_integral_gain: 0.40,
            rudder_per_aileron: 0.76,
            rudder_washout_s: 2.0,
            side_force_gain: 0.060_163,          // 0.59 per g
            side_force_integral_gain: 0.054_045, // 0.53 per g and s
            yaw_damping: 1.5,
        }
    }
}

/// The commands of the heading loop.
///
/// ```
/// use fcc_fixed_wing::control::{HeadingConfig, HeadingLoop, Lateral, Schedule};
/// use fcc_navigation::Estimate;
///
/// let mut heading = HeadingLoop::new(HeadingConfig::default());
/// let schedule = Schedule::at(51.4, 51.4);
/// let level: Lateral = heading.hold_bank(0.0, &Estimate::default(), schedule, 0.025);
/// assert_eq!(level, Lateral::default());
/// ```
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Lateral {
    /// Commanded bank, rad.
    pub roll_rad: f64,
    /// -1..=1, positive rolls right.
    pub aileron: f64,
    /// -1..=1, positive yaws right.
    pub rudder: f64,
}

/// Heading → turn rate → bank → roll rate → aileron, and the rudder.
///
/// ```
/// use fcc_fixed_wing::control::{Envelope, HeadingConfig, HeadingLoop, Schedule};
/// use fcc_navigation::Estimate;
///
/// let level = Estimate {
///     airspeed_mps: 51.4,
///     true_airspeed_mps: 53.8,
///     altitude_m: 914.4,
///     ..Estimate::default()
/// };
/// let (envelope, schedule) = (Envelope::default(), Schedule::at(51.4, 51.4));
/// let mut heading = HeadingLoop::new(HeadingConfig::default());
/// heading.engage(0.0, 0.0, &level, schedule);
/// // 90° to the right: the commanded bank is the limit, 30°.
/// let command = heading.step(90.0_f64.to_radians(), &level, &envelope, schedule, 0.025);
/// assert!((command.roll_rad.to_degrees() - 30.0).abs() < 1e-9);
/// assert!(command.aileron > 0.0);
/// ```
#[derive(Clone, Debug)]
pub struct HeadingLoop {
    config: HeadingConfig,
    roll_command: RateLimit,
    roll_rate: Pid,
    side_force: Pid,
    /// The aileron that corrects the roll rate, without its constant part.
    correction: HighPass,
    /// While the commanded bank is led from an earlier command to the present
    /// one.
    lead: Option<Lead>,
    /// What the turn needs, before it is limited for want of speed, rad.
    needed_rad: f64,
}

/// A bank command that follows another.
#[derive(Clone, Copy, Debug)]
struct Lead {
    roll_rad: f64,
    /// How much longer at least, s: what is wanted may itself step.
    left_s: f64,
}

/// How fast a bank command is led from an earlier one, rad/s (100 °/s): faster
/// than any aircraft rolls, and without a step.
const LED_RADPS: f64 = 1.745;
/// The longest step of that, s: 4°.
const LED_STEP_S: f64 = 0.04;
const LED_FOR_S: f64 = 0.5;

impl HeadingLoop {
    /// A loop that is not engaged.
    pub const fn new(config: HeadingConfig) -> Self {
        Self {
            config,
            roll_command: RateLimit::new(config.max_roll_acceleration_radps2),
            roll_rate: Pid::new(PidConfig {
                kp: config.roll_rate_gain,
                ki: config.roll_rate_integral_gain,
                ..SURFACE
            }),
            side_force: Pid::new(PidConfig {
                kp: config.side_force_gain,
                ki: config.side_force_integral_gain,
                ..SURFACE
            }),
            correction: HighPass::new(config.rudder_washout_s),
            lead: None,
            needed_rad: 0.0,
        }
    }

    /// Continues from an earlier bank command (rad), after a time in which the
    /// loop did not run: the next commands lead from there to what is wanted.
    pub const fn lead_from(&mut self, roll_rad: f64) {
        self.lead = Some(Lead {
            roll_rad,
            left_s: LED_FOR_S,
        });
    }

    /// Engages with the present surfaces.
    pub fn engage(&mut self, aileron: f64, rudder: f64, estimate: &Estimate, schedule: Schedule) {
        let roll_rate = estimate.body_rates.roll_radps;
        let rolling = self.aileron_feed_forward(roll_rate, schedule);
        self.roll_rate.engage(
            aileron,
            roll_rate,
            roll_rate,
            rolling,
            schedule.moment * schedule.lateral_pace,
        );
        self.side_force.engage(
            rudder,
            0.0,
            estimate.side_force_mps2,
            self.rudder_feed_forward(rolling, estimate, schedule),
            schedule.moment * schedule.lateral_pace,
        );
        self.restart(estimate);
    }

    /// Continues with the present motion of the aircraft, and with the trims found before.
    pub(crate) fn restart(&mut self, estimate: &Estimate) {
        self.lead = None;
        self.needed_rad = 0.0;
        self.roll_command.reset(estimate.body_rates.roll_radps);
        self.correction.reset(self.aileron_trim());
    }

    /// One step towards a heading (rad, continuous through full turns).
    pub fn step(
        &mut self,
        heading_rad: f64,
        estimate: &Estimate,
        envelope: &Envelope,
        schedule: Schedule,
        dt_s: f64,
    ) -> Lateral {
        let speed = estimate.true_airspeed_mps.max(1.0);
        let turn_rate = GRAVITY_MPS2 / speed * tan(limit_abs(estimate.roll_rad, MAX_TURN_BANK_RAD));
        let error = heading_rad - estimate.heading_rad - self.config.lead_s * turn_rate;
        let profile = SquareRootProfile {
            gain_per_s: schedule.outer * schedule.lateral_pace * self.config.heading_gain_per_s,
            deceleration: GRAVITY_MPS2 / speed * self.config.rollout_rate_radps,
        };
        // Coordinated turn: tan φ = V ψ̇ / g.
        let needed_rad = atan(speed / GRAVITY_MPS2 * profile.speed(error));
        self.needed_rad = needed_rad.abs().min(envelope.bank_limit_rad());
        let roll_rad = limit_abs(needed_rad, envelope.bank_limit_at_rad(estimate));
        let roll_rad = self.led(roll_rad, dt_s);
        self.hold_bank(roll_rad, estimate, schedule, dt_s)
    }

    /// One step towards a bank (rad) that is commanded in place of a heading.
    pub fn bank_to(
        &mut self,
        bank_rad: f64,
        estimate: &Estimate,
        envelope: &Envelope,
        schedule: Schedule,
        dt_s: f64,
    ) -> Lateral {
        self.needed_rad = bank_rad.abs().min(envelope.bank_limit_rad());
        let roll_rad = limit_abs(bank_rad, envelope.bank_limit_at_rad(estimate));
        let roll_rad = self.led(roll_rad, dt_s);
        self.hold_bank(roll_rad, estimate, schedule, dt_s)
    }

    /// The bank that the turn needs, rad, 0 or more: that of the last step.
    pub(crate) const fn needed_bank_rad(&self) -> f64 {
        self.needed_rad
    }

    /// The bank command on the way from an earlier one to `wanted_rad`.
    pub(crate) fn led(&mut self, wanted_rad: f64, dt_s: f64) -> f64 {
        let Some(lead) = &mut self.lead else {
            return wanted_rad;
        };
        let most_rad = LED_RADPS * dt_s.min(LED_STEP_S);
        let off_rad = wanted_rad - lead.roll_rad;
        lead.left_s -= dt_s;
        lead.roll_rad += limit_abs(off_rad, most_rad);
        let roll_rad = lead.roll_rad;
        if off_rad.abs() <= most_rad && lead.left_s <= 0.0 {
            self.lead = None;
        }
        roll_rad
    }

    /// One step towards a bank (rad), independent of the heading.
    pub fn hold_bank(
        &mut self,
        roll_rad: f64,
        estimate: &Estimate,
        schedule: Schedule,
        dt_s: f64,
    ) -> Lateral {
        let wanted = self.roll_rate_for(roll_rad, estimate, schedule);
        let roll_rate = self.roll_command.step(wanted, dt_s);
        let rolling = self.aileron_feed_forward(roll_rate, schedule);
        let aileron = self.roll_rate.step_scheduled(
            roll_rate,
            estimate.body_rates.roll_radps,
            rolling,
            schedule.moment * schedule.lateral_pace,
            schedule.lateral_pace * dt_s,
        );
        let correction = self
            .correction
            .step(aileron - rolling, schedule.lateral_pace * dt_s);
        // A side force to the right requires yaw to the left.
        let rudder = self.side_force.step_scheduled(
            0.0,
            estimate.side_force_mps2,
            self.rudder_feed_forward(rolling + correction, estimate, schedule),
            schedule.moment * schedule.lateral_pace,
            schedule.lateral_pace * dt_s,
        );
        Lateral {
            roll_rad,
            aileron,
            rudder,
        }
    }

    /// The roll rate (rad/s) towards a bank (rad).
    fn roll_rate_for(&self, roll_rad: f64, estimate: &Estimate, schedule: Schedule) -> f64 {
        let gain_per_s = schedule.lateral_pace * self.config.roll_gain_per_s;
        limit_abs(
            gain_per_s * (roll_rad - estimate.roll_rad),
            self.config.max_roll_rate_radps,
        )
    }

    /// The surfaces for a roll rate (rad/s) from trims, without the integrals:
    /// while another law determines the roll.
    pub(crate) fn surfaces_for(
        &self,
        roll_rate_radps: f64,
        aileron_trim: f64,
        rudder_trim: f64,
        estimate: &Estimate,
        schedule: Schedule,
    ) -> Lateral {
        let error = roll_rate_radps - estimate.body_rates.roll_radps;
        let aileron = aileron_trim
            + self.aileron_feed_forward(roll_rate_radps, schedule)
            + schedule.moment * self.config.roll_rate_gain * error;
        let aileron = limit_abs(aileron, 1.0);
        let rudder = rudder_trim
            + self.rudder_feed_forward(aileron - aileron_trim, estimate, schedule)
            - schedule.moment * self.config.side_force_gain * estimate.side_force_mps2;
        Lateral {
            roll_rad: 0.0,
            aileron,
            rudder: limit_abs(rudder, 1.0),
        }
    }

    /// The aileron for a steady roll rate.
    fn aileron_feed_forward(&self, roll_rate_radps: f64, schedule: Schedule) -> f64 {
        schedule.rate * self.config.aileron_per_roll_rate * roll_rate_radps
    }

    /// The rudder for an aileron off its trim, plus damping of the yaw rate in
    /// excess of the turn's.
    ///
    /// Adverse yaw is proportional to the lift coefficient where it comes from
    /// the wing, and does not depend on it where it comes from the profile drag
    /// of the ailerons (Etkin and Reid 1996, chapter 3): the rudder against
    /// it follows V₀/V, between the two.
    fn rudder_feed_forward(&self, aileron: f64, estimate: &Estimate, schedule: Schedule) -> f64 {
        let excess_radps = estimate.yaw_excess_radps();
        schedule.rate * self.config.rudder_per_aileron * aileron
            - schedule.moment * schedule.lateral_pace * self.config.yaw_damping * excess_radps
    }

    /// The aileron trim that the loop has found for wings level.
    pub const fn aileron_trim(&self) -> f64 {
        self.roll_rate.integral()
    }

    /// The rudder trim that the loop has found for no sideslip.
    pub const fn rudder_trim(&self) -> f64 {
        self.side_force.integral()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A roll rate that the ailerons cannot stop: at first the rudder moves
    /// with them, against adverse yaw; later it does not, or it would hold a
    /// sideslip.
    #[test]
    fn a_constant_correction_moves_no_rudder() {
        let rolling = Estimate {
            airspeed_mps: 50.0,
            true_airspeed_mps: 50.0,
            body_rates: fcc_core::flight::BodyRates {
                roll_radps: 0.1,
                ..fcc_core::flight::BodyRates::default()
            },
            ..Estimate::default()
        };
        let schedule = Schedule::at(50.0, 50.0);
        let mut heading = HeadingLoop::new(HeadingConfig::default());
        heading.engage(0.0, 0.0, &Estimate::default(), schedule);
        let first = heading.hold_bank(0.0, &rolling, schedule, 0.025);
        assert!(first.aileron < -0.03);
        let config = HeadingConfig::default();
        assert!((first.rudder / first.aileron - config.rudder_per_aileron).abs() < 0.05);
        let mut later = first;
        for _ in 0..400 {
            later = heading.hold_bank(0.0, &rolling, schedule, 0.025);
        }
        assert!(later.aileron < -0.3);
        assert!(later.rudder.abs() < 0.2 * later.aileron.abs());
    }
}
