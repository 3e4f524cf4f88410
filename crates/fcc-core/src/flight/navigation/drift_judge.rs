//! Which of two measures of height drifts, the altimeter or a satellite receiver.

use libm::fabs;

use crate::blocks::{LowPass, limit_abs};

/// The time constants of low passes of climb rates, s: of the difference of the two; of
/// what each is off that by pitch and lift, longer than a gust.
const DIFFERENCE_TAU_S: f64 = 4.0;
const PATH_TAU_S: f64 = 8.0;
/// Evidence is what is off over its standard deviation, half the square of it, counted once
/// in such a time, s: in which accelerometers alone tell a height, and in which the error by
/// pitch and lift is another one.
const ALONE_S: f64 = 12.0;
const PATH_S: f64 = 20.0;
/// That by pitch and lift has this standard deviation, m/s, and, because it may be off in
/// one direction for minutes, no more evidence than this.
const PATH_SD_MPS: f64 = 1.5;
const MOST_BY_PATH: f64 = 0.5;
/// Two climb rates agree within this, m/s; evidence of a time before is forgotten with this
/// time constant, s, and after the second time in agreement nobody drifts any more.
const AGREES_MPS: f64 = 0.4;
const FORGOTTEN_S: f64 = 60.0;
const AGREED_S: f64 = 60.0;

/// One tick's measures of how the aircraft climbs.
#[derive(Clone, Copy, Debug)]
pub(super) struct ClimbRates {
    /// By the altimeter, m/s.
    pub(super) altimeter_mps: f64,
    /// By pitch and lift, m/s.
    pub(super) path_mps: Option<f64>,
    pub(super) alone: Option<Alone>,
}

/// What altimeter and receiver have climbed more than the accelerometers say that they
/// have, each from its own climb rate on, and the standard deviation of the latter, m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Alone {
    pub(super) altimeter_m: f64,
    pub(super) receiver_m: f64,
    pub(super) sd_m: f64,
}

/// The accelerometers tell which of the two has begun to climb otherwise than before, and
/// cannot tell it of one that does so slowly. Pitch and lift tell it of that, less surely.
#[derive(Clone, Copy, Debug)]
pub(super) struct DriftJudge {
    /// The receiver's climb rate less the altimeter's.
    difference: LowPass,
    off_altimeter: LowPass,
    off_receiver: LowPass,
    /// Evidence for the receiver; negative is that for the altimeter.
    by_force: f64,
    by_path: f64,
    agrees_s: f64,
}

impl DriftJudge {
    pub(super) const fn new() -> Self {
        Self {
            difference: LowPass::new(DIFFERENCE_TAU_S),
            off_altimeter: LowPass::new(PATH_TAU_S),
            off_receiver: LowPass::new(PATH_TAU_S),
            by_force: 0.0,
            by_path: 0.0,
            agrees_s: 0.0,
        }
    }

    /// The receiver's climb rate less the altimeter's, m/s.
    pub(super) fn difference_mps(&self) -> f64 {
        self.difference.output()
    }

    /// Whether more speaks for the altimeter.
    pub(super) fn is_for_altimeter(&self) -> bool {
        self.by_force + self.by_path < 0.0
    }

    /// Whether the two have agreed for a minute.
    pub(super) fn they_agree(&self) -> bool {
        self.agrees_s >= AGREED_S
    }

    /// Processes one tick.
    pub(super) fn step(&mut self, receiver_mps: f64, rates: ClimbRates, dt_s: f64) {
        let difference_mps = self
            .difference
            .step(receiver_mps - rates.altimeter_mps, dt_s);
        if fabs(difference_mps) < AGREES_MPS {
            self.agrees_s += dt_s;
            self.by_force -= self.by_force * dt_s / FORGOTTEN_S;
            self.by_path -= self.by_path * dt_s / FORGOTTEN_S;
        } else {
            self.agrees_s = 0.0;
        }
        let evidence = |off_altimeter: f64, off_receiver: f64, sd: f64| {
            (off_altimeter * off_altimeter - off_receiver * off_receiver) / (2.0 * sd * sd)
        };
        if let Some(alone) = rates.alone {
            let one = evidence(alone.altimeter_m, alone.receiver_m, alone.sd_m);
            self.by_force += one * dt_s / ALONE_S;
        }
        if let Some(path_mps) = rates.path_mps {
            let off_altimeter = self
                .off_altimeter
                .step(path_mps - rates.altimeter_mps, dt_s);
            let off_receiver = self.off_receiver.step(path_mps - receiver_mps, dt_s);
            let one = evidence(off_altimeter, off_receiver, PATH_SD_MPS);
            self.by_path = limit_abs(self.by_path + one * dt_s / PATH_S, MOST_BY_PATH);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT_S: f64 = 0.025;

    /// Level flight; after a minute one of the two begins to climb by this, m/s, more, and
    /// pitch and lift are off by this one. Copies without the altimeter begin every 12 s.
    fn judged(altimeter_mps: f64, receiver_mps: f64, path_mps: f64) -> DriftJudge {
        let mut judge = DriftJudge::new();
        let (mut altimeter_m, mut receiver_m, mut began_more_mps, mut lasted_s) =
            (0.0, 0.0, 0.0, 0.0);
        for tick in 0..3_600 {
            let by = if f64::from(tick) * DT_S > 60.0 {
                1.0
            } else {
                0.0
            };
            lasted_s += DT_S;
            altimeter_m += by * altimeter_mps * DT_S;
            receiver_m += (by * receiver_mps - began_more_mps) * DT_S;
            if lasted_s > 12.0 {
                (altimeter_m, receiver_m, lasted_s) = (0.0, 0.0, 0.0);
                began_more_mps = judge.difference_mps();
            }
            let rates = ClimbRates {
                altimeter_mps: by * altimeter_mps,
                path_mps: Some(path_mps),
                alone: Some(Alone {
                    altimeter_m,
                    receiver_m,
                    sd_m: 1.0 + 0.25 * lasted_s,
                }),
            };
            judge.step(by * receiver_mps, rates, DT_S);
        }
        judge
    }

    /// What accelerometers feel decides, though pitch and lift are off towards the other one.
    #[test]
    fn the_one_that_begins_to_climb_without_a_force_is_wrong() {
        for mps in [1.0, -1.0, 3.0, -3.0] {
            for path_mps in [0.0, 4.0, -4.0] {
                assert!(judged(0.0, mps, path_mps).is_for_altimeter());
                assert!(!judged(mps, 0.0, path_mps).is_for_altimeter());
            }
        }
    }

    #[test]
    fn two_that_climb_alike_agree_after_a_minute() {
        assert!(judged(0.0, 0.2, 0.0).they_agree());
        assert!(!judged(0.0, 1.0, 0.0).they_agree());
    }
}
