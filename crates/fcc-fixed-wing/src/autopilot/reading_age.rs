//! How old readings are when they arrive, and how old those are that are flown.
//!
//! A source that has a clock of its own stamps its readings with the time at which
//! it sent them (`SourceClock`): what a network held back arrives old. Known ages
//! are latency like any other, and slow the loops.

use core::time::Duration;

use fcc_core::flight::Measurements;
use fcc_core::framework::Time;
use fcc_navigation::{Estimate, Quantities, Quantity};

/// The age of the body rates is averaged over this time, s: the mean age of
/// readings that are held between two samples is the delay of that hold.
const AVERAGED_S: f64 = 1.0;
/// The share of a new value in the jitter (RFC 3550, section 6.4.1).
const JITTER_SHARE: f64 = 1.0 / 16.0;

/// The ages of readings.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ReadingAges {
    /// The newest of each quantity that control needs.
    newest: [Time; Quantity::COUNT],
    /// The age of the newest reading when it arrived, s, and its jitter.
    arrival_s: f64,
    jitter_s: f64,
    /// The mean age of the body rates, s.
    rates_s: f64,
    /// The quantities whose newest reading was too old when it arrived.
    late: Quantities,
}

impl ReadingAges {
    /// Reads a tick's measurements. Of a plant whose time stands still no reading
    /// grows older: `judged` is the time by which they are.
    pub(super) fn step(
        &mut self,
        now: Time,
        judged: Time,
        measured: &Measurements,
        max_age: Duration,
        dt_s: f64,
    ) {
        let mut newest = Time::NEVER;
        for (last, quantity) in self.newest.iter_mut().zip(Quantity::ALL) {
            let taken = quantity.taken(measured);
            if taken > *last {
                *last = taken;
                newest = newest.max(taken);
                let others = self.late.keeping(quantity, false);
                self.late = others.with(quantity, now.since(taken) > max_age);
            }
        }
        if !newest.is_never() {
            let age_s = now.since(newest).as_secs_f64();
            self.jitter_s += JITTER_SHARE * ((age_s - self.arrival_s).abs() - self.jitter_s);
            self.arrival_s = age_s;
        }
        let rates = measured.body_rates.taken;
        if !rates.is_never() {
            let age_s = judged.since(rates).min(max_age).as_secs_f64();
            let share = (dt_s / AVERAGED_S).min(1.0);
            self.rates_s += share * (age_s - self.rates_s);
        }
    }

    /// The quantities that control needs and whose newest reading arrived older
    /// than it may be.
    pub(super) const fn late(&self) -> Quantities {
        self.late
    }

    /// The estimate with the ages of arrival.
    pub(super) fn shown_in(&self, estimate: &Estimate) -> Estimate {
        Estimate {
            reading_age_s: self.arrival_s,
            reading_jitter_s: self.jitter_s,
            ..*estimate
        }
    }

    /// The mean age of the body rates, s.
    pub(super) const fn rates_s(&self) -> f64 {
        self.rates_s
    }
}

/// When the newest of the readings was taken that control needs or that are the
/// plant's own.
pub(super) fn newest(measured: &Measurements) -> Time {
    Quantity::ALL
        .into_iter()
        .fold(measured.plant.taken, |newest, quantity| {
            newest.max(quantity.taken(measured))
        })
}
