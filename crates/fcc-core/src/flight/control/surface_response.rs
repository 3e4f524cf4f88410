//! Whether a control surface moves the aircraft.

use libm::copysign;
use nalgebra::{Matrix4, Vector4};

use crate::blocks::{LowPass, smoothing_factor};

/// The aircraft answers this late, s: a servo, and the lag of the roll or of the pitch.
const LATE_S: f64 = 0.25;
/// What has been commanded for longer, s, is the trim, and a rate that lasts longer a turn's.
const USUAL_S: f64 = 8.0;
/// An answer of this share of what is expected is one: gains may be those of another aircraft.
const LEAST_SHARE: f64 = 0.2;
/// A slower rate is no answer that is missed, rad/s (0.7 °/s): biases, and noise.
const ALLOWED_RADPS: f64 = 0.012;
/// An angle that was commanded and not answered, rad (18°), and how much more of it for each g
/// of the gusts' load, one standard deviation: a gust turns the aircraft against its surfaces.
const UNANSWERED_RAD: f64 = 0.314;
const PER_GUST_LOAD: f64 = 5.0;

/// Whether a control surface moves the aircraft: sums up what is commanded and not answered by
/// a rate (the cumulative sum of Page 1954).
///
/// A surface that is jammed, or whose linkage is broken, is commanded farther and farther and
/// answered by nothing. One that works, but against a gust, is answered when the gust is over,
/// which takes as much off the sum.
#[derive(Clone, Debug)]
pub(crate) struct SurfaceResponse {
    command: LowPass,
    trim: LowPass,
    usual: LowPass,
    unanswered_rad: f64,
}

impl SurfaceResponse {
    pub(crate) const fn new() -> Self {
        Self {
            command: LowPass::new(LATE_S),
            trim: LowPass::new(USUAL_S),
            usual: LowPass::new(USUAL_S),
            unanswered_rad: 0.0,
        }
    }

    /// Takes the command of a surface (-1..=1), the rate for each unit of it (rad/s), the rate
    /// (rad/s) and the load of gusts (g). Returns what is unanswered, 1 and more if it is so much
    /// that the surface seems not to move the aircraft.
    pub(crate) fn step(
        &mut self,
        command: f64,
        radps_per_command: f64,
        rate_radps: f64,
        gust_load: f64,
        dt_s: f64,
    ) -> f64 {
        let moved = self.command.step(command, dt_s) - self.trim.step(command, dt_s);
        let answer_radps = rate_radps - self.usual.step(rate_radps, dt_s);
        let expected_radps = moved * radps_per_command;
        let missed_radps = LEAST_SHARE * expected_radps.abs()
            - copysign(1.0, expected_radps) * answer_radps
            - ALLOWED_RADPS;
        self.unanswered_rad = (self.unanswered_rad + missed_radps * dt_s).max(0.0);
        self.unanswered_rad / (UNANSWERED_RAD * (1.0 + PER_GUST_LOAD * gust_load.max(0.0)))
    }

    /// The trim of the latest seconds.
    pub(crate) fn trim(&self) -> f64 {
        self.trim.output()
    }
}

/// What is compared: faster than trim and turns, slower than noise, s.
const SLOW_S: f64 = 3.0;
const FAST_S: f64 = 0.12;
/// The time over which is averaged, s.
const MEMORY_S: f64 = 6.0;
/// The angular acceleration for a rate that is expected of the surface, 1/s, below which it does
/// nothing, and below which it may do nothing: the inverse of the lag of the roll is 4 to 10 /s.
/// A Cessna 182 flown with the gains of a 172, slow and in gusts, has 0.07 to 0.25, jammed
/// ailerons have 0.2 at first and 0.04 after 2 s.
const NO_EFFECT_PER_S: f64 = 0.05;
const DOUBTFUL_PER_S: f64 = 0.2;
/// So much is unanswered that a doubtful effect is none.
const FAR_UNANSWERED: f64 = 2.0;

/// A signal without its slow and fast parts.
#[derive(Clone, Copy, Debug)]
struct Band {
    fast: LowPass,
    slow: LowPass,
}

impl Band {
    const NEW: Self = Self {
        fast: LowPass::new(FAST_S),
        slow: LowPass::new(SLOW_S),
    };

    fn step(&mut self, input: f64, dt_s: f64) -> f64 {
        let fast = self.fast.step(input, dt_s);
        fast - self.slow.step(fast, dt_s)
    }
}

/// Whether a surface does not move the aircraft, by what is unanswered and its effect.
pub(crate) fn is_jammed(unanswered: f64, effect_per_s: f64) -> bool {
    (unanswered > 1.0 && effect_per_s < NO_EFFECT_PER_S)
        || (unanswered > FAR_UNANSWERED && effect_per_s < DOUBTFUL_PER_S)
}

/// What a surface adds to the angular acceleration: the regression of the acceleration on the
/// rate that is expected of the surface, on the rate itself, which damps, and on two other
/// causes. Gusts act through the damping, so that they do not pass for the surface.
#[derive(Clone, Debug)]
pub(crate) struct SurfaceEffect {
    causes: [Band; 4],
    last_rate: Option<f64>,
    /// Means of products: of the causes, and of the acceleration with them.
    products: Matrix4<f64>,
    with_acceleration: Vector4<f64>,
}

impl SurfaceEffect {
    pub(crate) const fn new() -> Self {
        Self {
            causes: [Band::NEW; 4],
            last_rate: None,
            products: Matrix4::new(
                0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
            ),
            with_acceleration: Vector4::new(0.0, 0.0, 0.0, 0.0),
        }
    }

    /// Takes the rate that is expected of a surface's command, the rate (rad/s) and what else
    /// may accelerate it. Returns the surface's effect, 1/s; infinite if that is not known.
    pub(crate) fn step(
        &mut self,
        expected_radps: f64,
        rate_radps: f64,
        others: [f64; 2],
        dt_s: f64,
    ) -> f64 {
        /// Beside the products of causes that there are, nothing; a cause that is always 0 has
        /// no effect with it.
        const NONE: f64 = 1e-12;
        let mut causes = Vector4::new(expected_radps, rate_radps, others[0], others[1]);
        for (cause, band) in causes.iter_mut().zip(&mut self.causes) {
            *cause = band.step(*cause, dt_s);
        }
        let rate = causes.y;
        let Some(last) = self.last_rate.replace(rate).filter(|_| dt_s > 0.0) else {
            return f64::INFINITY;
        };
        let acceleration = (rate - last) / dt_s;
        let share = smoothing_factor(dt_s, MEMORY_S);
        self.products += (causes * causes.transpose() - self.products) * share;
        self.with_acceleration += (causes * acceleration - self.with_acceleration) * share;
        let regular = self.products + Matrix4::from_diagonal_element(NONE);
        let effects = regular
            .cholesky()
            .map(|products| products.solve(&self.with_acceleration));
        effects
            .map(|effects| effects.x)
            .filter(|effect| effect.is_finite())
            .unwrap_or(f64::INFINITY)
    }

    /// The mean square of the rate that was expected in the latest seconds, rad²/s².
    pub(crate) fn mean_square(&self) -> f64 {
        self.products.m11
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT_S: f64 = 0.025;
    /// A Cessna 172 at 100 kt: a full aileron rolls it by 1.2 rad/s, with a lag of 0.14 s
    /// (JSBSim 1.2's c172p: Clda 0.229, Clp -0.484, span 11 m).
    const FULL_RADPS: f64 = 1.2;
    const ROLL_LAG_S: f64 = 0.14;

    /// Turns to either side against a steady disturbance and gusts, with ailerons that have
    /// `authority` until `until_s` and stand still from there on; when that is seen, s.
    fn seen_after_s(authority: f64, until_s: f64, gust_radps: f64) -> Option<f64> {
        let mut response = SurfaceResponse::new();
        let mut effect = SurfaceEffect::new();
        let mut integral = 0.0_f64;
        let (mut bank, mut rate, mut stands) = (0.0_f64, 0.0_f64, 0.0_f64);
        for n in 0..8_000_u32 {
            let at_s = f64::from(n) * DT_S;
            let turn_rad = if at_s % 40.0 < 20.0 { 0.3 } else { -0.3 };
            let wanted = (1.5 * (turn_rad - bank)).clamp(-0.4, 0.4);
            integral = (integral + 0.8 * (wanted - rate) * DT_S).clamp(-1.0, 1.0);
            let command = (0.8 * (wanted - rate) + integral).clamp(-1.0, 1.0);
            if at_s < until_s {
                stands = command;
            }
            let gust = gust_radps * (libm::sin(1.3 * at_s) + libm::sin(3.1 * at_s + 1.0));
            let steady = authority * FULL_RADPS * stands + gust + 0.02;
            rate += (steady - rate) * DT_S / ROLL_LAG_S;
            bank += rate * DT_S;
            let unanswered = response.step(command, FULL_RADPS, rate, 0.1, DT_S);
            let effect_per_s = effect.step(command * FULL_RADPS, rate, [0.0; 2], DT_S);
            if is_jammed(unanswered, effect_per_s) {
                return Some(at_s - until_s);
            }
            if bank.abs() > 1.0 && at_s > until_s {
                return Some(f64::INFINITY);
            }
        }
        None
    }

    #[test]
    fn ailerons_that_jam_are_seen_before_a_bank_of_57_degrees() {
        for gust_radps in [0.0, 0.05, 0.1] {
            let seen_s = seen_after_s(1.0, 55.0, gust_radps).unwrap();
            assert!((0.0..15.0).contains(&seen_s), "{gust_radps}: {seen_s}");
        }
    }

    #[test]
    fn ailerons_of_a_third_of_the_effect_work() {
        for gust_radps in [0.0, 0.05, 0.1] {
            for authority in [0.3, 1.0, 3.0] {
                let seen = seen_after_s(authority, f64::INFINITY, gust_radps);
                assert_eq!(seen, None, "{authority}, {gust_radps}");
            }
        }
    }
}
