//! Whether a control surface turns the aircraft the other way than it should.

use libm::copysign;

use crate::blocks::LowPass;

/// A surface acts this late at least, s; what was commanded for longer than the second is trim;
/// faster than the third is noise.
const LATE_S: f64 = 0.1;
const USUAL_S: f64 = 4.0;
const FAST_S: f64 = 0.06;
/// Less is not commanded, rad/s (5 °/s), and more counts as this much, rad/s (86 °/s).
const COMMANDED_RADPS: f64 = 0.08;
const MOST_RADPS: f64 = 1.5;
/// The rate has grown against the command for this time, s: what answers as late as 0.5 s, and
/// swings, does so for 0.4 s. For a suspicion the second is enough.
const GROWS_S: f64 = 0.5;
const SUSPECT_S: f64 = 0.2;
/// By this at least, rad/s (6 °/s), and by this times the rate that was commanded, rad²/s²; in
/// gusts by as much more for each g of their load.
const GROWN_RADPS: f64 = 0.1;
const GROWN: f64 = 0.25;
/// What is suspected is remembered for so long, s.
const SUSPECT: f64 = 0.05;
const SUSPECTED_S: f64 = 1.0;
const PER_GUST_LOAD: f64 = 3.0;
/// Or the rate has been against a command of at least the first, rad/s, for so long, s, and has
/// turned the aircraft by so much, rad (7°): a heavy one diverges slowly.
const SLOWLY_RADPS: f64 = 0.3;
const SLOWLY_S: f64 = 2.0;
const TURNED_RAD: f64 = 0.12;
/// It is at least this share of the most that it was, and in the seconds before no rate of the
/// other sign was more than the second share of it: neither a gust that is being stopped, nor a
/// swing.
const STILL: f64 = 0.8;
const SWUNG: f64 = 0.4;
const SWING_S: f64 = 3.0;

/// A rate that grows against what is commanded.
///
/// A loop around a surface that acts the wrong way diverges without a swing: the farther it
/// commands, the faster the aircraft turns the other way. A gust also turns it against the
/// command, but a surface that works reduces the rate within its lag.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ReversedSurface {
    command: LowPass,
    usual: LowPass,
    rate: LowPass,
    /// The sign of what is commanded, and for how long the rate has been against it, s; the
    /// least and the most of the rate in this time, rad/s.
    sign: f64,
    against_s: f64,
    least_radps: f64,
    most_radps: f64,
    /// For how long, s, and by how much, rad, a large command was not followed.
    slowly_s: f64,
    turned_rad: f64,
    /// The largest rates to either side in the latest seconds, rad/s.
    swings_radps: [f64; 2],
    /// How much it has grown times what is commanded, rad²/s²; and the most in the latest second.
    grown: f64,
    suspected: f64,
}

impl ReversedSurface {
    pub(crate) const fn new() -> Self {
        Self {
            command: LowPass::new(LATE_S),
            usual: LowPass::new(USUAL_S),
            rate: LowPass::new(FAST_S),
            sign: 1.0,
            against_s: 0.0,
            least_radps: 0.0,
            most_radps: 0.0,
            slowly_s: 0.0,
            turned_rad: 0.0,
            swings_radps: [0.0; 2],
            grown: 0.0,
            suspected: 0.0,
        }
    }

    /// Takes the command of a surface (-1..=1), the rate for each unit of it and the rate
    /// (rad/s).
    pub(crate) fn step(
        &mut self,
        command: f64,
        radps_per_command: f64,
        rate_radps: f64,
        dt_s: f64,
    ) {
        let moved = self.command.step(command, dt_s) - self.usual.step(command, dt_s);
        let commanded_radps = moved * radps_per_command;
        let rate_radps = self.rate.step(rate_radps, dt_s);
        let sides = [rate_radps, -rate_radps];
        for (swing, side) in self.swings_radps.iter_mut().zip(sides) {
            *swing = (*swing * (1.0 - dt_s / SWING_S)).max(side).max(0.0);
        }
        self.suspected *= 1.0 - dt_s / SUSPECTED_S;
        let sign = copysign(1.0, commanded_radps);
        let against_radps = -sign * rate_radps;
        if commanded_radps.abs() < COMMANDED_RADPS || against_radps <= 0.0 {
            self.against_s = 0.0;
            (self.slowly_s, self.turned_rad) = (0.0, 0.0);
            self.grown = 0.0;
            return;
        }
        if commanded_radps.abs() > SLOWLY_RADPS {
            self.slowly_s += dt_s;
            self.turned_rad += against_radps * dt_s;
        }
        if sign != self.sign || self.against_s == 0.0 {
            self.sign = sign;
            self.against_s = 0.0;
            (self.least_radps, self.most_radps) = (against_radps, against_radps);
        }
        self.against_s += dt_s;
        self.least_radps = self.least_radps.min(against_radps);
        self.most_radps = self.most_radps.max(against_radps);
        let grown_radps = against_radps - self.least_radps;
        self.grown = if grown_radps > GROWN_RADPS {
            grown_radps * commanded_radps.abs().min(MOST_RADPS)
        } else {
            0.0
        };
        if self.against_s >= SUSPECT_S {
            self.suspected = self.suspected.max(self.grown);
        }
    }

    /// The rate against the latest command, rad/s.
    pub(crate) fn against_radps(&self) -> f64 {
        -self.sign * self.rate.output()
    }

    /// Whether the surface seems to act the wrong way, in gusts of this load, g.
    pub(crate) fn seems_reversed(&self, gust_load: f64) -> bool {
        let against_radps = self.against_radps();
        let [positive_radps, negative_radps] = self.swings_radps;
        let swung_radps = if self.sign > 0.0 {
            positive_radps
        } else {
            negative_radps
        };
        let slowly = self.slowly_s > SLOWLY_S && self.turned_rad > TURNED_RAD;
        let grows = self.against_s >= GROWS_S
            && self.grown > GROWN * (1.0 + PER_GUST_LOAD * gust_load.max(0.0))
            && against_radps >= STILL * self.most_radps
            && swung_radps < SWUNG * against_radps;
        grows || slowly
    }

    /// Whether that may be so, if another one acts the wrong way.
    pub(crate) fn is_suspect(&self) -> bool {
        self.suspected > SUSPECT
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

    /// The bank, rad, at which the ailerons seem to act the wrong way, if they do in 20 s: with
    /// `authority` of their usual effect, an answer that is so many ticks late, and a wind that
    /// rolls by up to `gust_radps`.
    fn bank_when_found(authority: f64, late_ticks: usize, gust_radps: f64) -> Option<f64> {
        let mut surface = ReversedSurface::new();
        let mut sent = [0.0; 32];
        let (mut bank, mut rate, mut integral) = (0.01_f64, 0.0_f64, 0.0_f64);
        for n in 0..800_u32 {
            let at_s = f64::from(n) * DT_S;
            let wanted = (3.1 * -bank).clamp(-0.7, 0.7);
            integral = (integral + 0.4 * (wanted - rate) * DT_S).clamp(-1.0, 1.0);
            let aileron = (0.27 * wanted + 0.38 * (wanted - rate) + integral).clamp(-1.0, 1.0);
            sent.rotate_right(1);
            sent[0] = aileron;
            let gust = gust_radps * libm::sin(3.1 * at_s + 1.0);
            let steady = authority * FULL_RADPS * sent[late_ticks] + gust;
            rate += (steady - rate) * DT_S / ROLL_LAG_S;
            bank += rate * DT_S;
            surface.step(aileron, 1.0 / 0.27, rate, DT_S);
            if surface.seems_reversed(0.0) {
                return Some(bank.abs());
            }
        }
        None
    }

    #[test]
    fn reversed_ailerons_are_found_before_a_bank_of_30_degrees() {
        for (authority, late_ticks) in [(-1.0, 0), (-0.5, 0), (-1.0, 4), (-2.0, 4)] {
            for gust_radps in [0.0, 0.1, 0.2] {
                let found = bank_when_found(authority, late_ticks, gust_radps);
                assert!(
                    found.is_some_and(|bank| bank < 0.524),
                    "{authority}, {late_ticks}, {gust_radps}: {found:?}"
                );
            }
        }
    }

    #[test]
    fn ailerons_that_work_are_not_reversed_in_gusts_nor_while_they_answer_late() {
        for authority in [0.5, 1.0, 2.0] {
            for late_ticks in [0, 4, 12, 20] {
                for gust_radps in [0.0, 0.2, 0.4] {
                    let found = bank_when_found(authority, late_ticks, gust_radps);
                    assert_eq!(found, None, "{authority}, {late_ticks}, {gust_radps}");
                }
            }
        }
    }
}
