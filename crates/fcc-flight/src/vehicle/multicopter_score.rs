//! The score of a multicopter's flight, by its truth.

use fcc_core::framework::RecordOf;
use fcc_multicopter::{Mode, Multicopter};
use fcc_sim::Truth;

use crate::flight::truth_recorder::TruthReceiver;
use crate::flight::{Figure, FlightTime, Observer, Outcome, Reports};

/// Higher than this above where it began it is in the air, m.
const TOUCHES_M: f64 = 0.003;

/// Compares where it was with where it was to be.
pub(super) struct Score {
    truth: TruthReceiver,
    /// Where it began.
    begin: Option<Truth>,
    squares_m2: f64,
    largest_m: f64,
    ticks: u64,
    /// In a landing: the sink before the ground was touched, and how far from the place.
    sink_mps: Option<f64>,
    touched: bool,
    off_m: Option<f64>,
}

impl Score {
    pub(super) const fn new(truth: TruthReceiver) -> Self {
        Self {
            truth,
            begin: None,
            squares_m2: 0.0,
            largest_m: 0.0,
            ticks: 0,
            sink_mps: None,
            touched: false,
            off_m: None,
        }
    }
}

impl Observer<Multicopter> for Score {
    fn record(&mut self, record: &RecordOf<Multicopter>, _: &FlightTime) {
        let Some(truth) = self.truth.of_tick(record.tick.number) else {
            return;
        };
        let begin = *self.begin.get_or_insert(truth);
        let wanted = &record.setpoints;
        let height_m = truth.altitude_m - begin.altitude_m;
        let north_m = truth.north_m - begin.north_m - wanted.north_m;
        let east_m = truth.east_m - begin.east_m - wanted.east_m;
        let off_m = north_m.hypot(east_m);
        match wanted.mode {
            Mode::Idle | Mode::Descend => {}
            Mode::Land => {
                if height_m > TOUCHES_M && !self.touched {
                    self.sink_mps = Some(truth.velocity.down_mps);
                } else {
                    self.touched = true;
                }
                self.off_m = Some(off_m);
            }
            _ => {
                let error_m = off_m.hypot(height_m - wanted.height_m);
                self.squares_m2 += error_m * error_m;
                self.largest_m = self.largest_m.max(error_m);
                self.ticks += 1;
            }
        }
    }

    fn end(&mut self, _: &str, outcome: &mut Outcome, _: &mut Reports) {
        let flown = (self.ticks > 0).then(|| (self.squares_m2 / self.ticks as f64).sqrt());
        let largest_m = (self.ticks > 0).then_some(self.largest_m);
        for (name, value, unit) in [
            ("error from the path (RMS)", flown, "m"),
            ("error from the path (largest)", largest_m, "m"),
            ("landing: off its place", self.off_m, "m"),
            ("landing: sink at touchdown", self.sink_mps, "m/s"),
        ] {
            let figure = |value| Figure { name, value, unit };
            outcome.figures.extend(value.map(figure));
        }
    }
}
