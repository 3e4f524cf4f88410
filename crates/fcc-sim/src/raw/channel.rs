//! One raw sensor: its errors, its samples, and their way to the loop.

use std::collections::VecDeque;

use libm::{exp, round, sin, sqrt};

use crate::gauss::{Gauss, Stream};

/// The errors of one axis, in the unit of the sensor.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct AxisErrors {
    /// One standard deviation of the white noise of a sample.
    pub white: f64,
    /// One standard deviation of a bias that changes slowly: exponentially
    /// correlated (Gauss-Markov, first order).
    pub drift: f64,
    /// The time in which its correlation falls to 1/e, s.
    pub drift_tau_s: f64,
    /// One standard deviation, over aircraft, of the constant bias.
    pub bias: f64,
    /// One standard deviation, over aircraft, of the change of the bias while the
    /// sensor warms up, with a time constant of ten minutes.
    pub warming: f64,
    /// One standard deviation, over aircraft, of the scale's error.
    pub scale: f64,
    /// One standard deviation, over aircraft, of the share of each other axis.
    pub misalignment: f64,
    /// Amplitude of the engine's vibration at full throttle.
    pub vibration: f64,
    /// The step of its values; 0 for none.
    pub resolution: f64,
    /// The largest magnitude that it gives.
    pub limit: f64,
}

impl AxisErrors {
    /// No errors.
    pub const NONE: Self = Self {
        white: 0.0,
        drift: 0.0,
        drift_tau_s: 1.0,
        bias: 0.0,
        warming: 0.0,
        scale: 0.0,
        misalignment: 0.0,
        vibration: 0.0,
        resolution: 0.0,
        limit: f64::INFINITY,
    };
}

/// How fast a sensor warms up after it was switched on, s; assumed.
const WARM_UP_S: f64 = 600.0;

/// A sensor of `N` axes.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct RawSensor<const N: usize> {
    /// Of each axis.
    pub errors: [AxisErrors; N],
    /// Samples per s.
    pub rate_hz: f64,
    /// From a sample to its arrival, s.
    pub delay_s: f64,
    /// How much later it may arrive: one standard deviation of a normal
    /// distribution, of which only the magnitude counts, s.
    pub jitter_s: f64,
}

/// The constant errors that were drawn for one sensor: it gives
/// `shape` · truth + `bias`, while it is cold.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct TrueErrors<const N: usize> {
    /// In the unit of the sensor.
    pub bias: [f64; N],
    /// Scale and share of each other axis, by rows.
    pub shape: [[f64; N]; N],
}

/// The engine's motion between two instants.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(super) struct Engine {
    /// Revolutions of the propeller since the start, at the two instants.
    pub(super) before: f64,
    pub(super) now: f64,
    pub(super) throttle: f64,
}

/// What arrived since it was last read: the mean of its samples, and when they
/// arrived in the mean, s.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Arrived<const N: usize> {
    pub(super) values: [f64; N],
    pub(super) at_s: f64,
}

/// A sensor at work.
#[derive(Clone, Debug)]
pub(super) struct Channel<const N: usize> {
    sensor: RawSensor<N>,
    gauss: Gauss,
    bias: [f64; N],
    warming: [f64; N],
    drift: [f64; N],
    start_s: f64,
    /// By rows, from the true axes to those of the sensor.
    shape: [[f64; N]; N],
    /// The truth at the last step.
    before: [f64; N],
    before_s: f64,
    next_s: f64,
    /// Samples under way, and when they arrive.
    under_way: VecDeque<(f64, [f64; N])>,
    last_s: f64,
    sum: [f64; N],
    sum_s: f64,
    count: u32,
}

impl<const N: usize> Channel<N> {
    /// A sensor whose constant errors are drawn by the seed; the first sample is
    /// taken within its period after `start_s`.
    pub(super) fn new(sensor: &RawSensor<N>, seed: u64, stream: Stream, start_s: f64) -> Self {
        let mut gauss = Gauss::new(seed, stream);
        let bias = sensor.errors.map(|of| of.bias * gauss.draw());
        let warming = sensor.errors.map(|of| of.warming * gauss.draw());
        let drift = sensor.errors.map(|of| of.drift * gauss.draw());
        let mut shape = [[0.0; N]; N];
        for (row, (errors, at)) in shape.iter_mut().zip(sensor.errors.iter().zip(0..)) {
            for (share, other) in row.iter_mut().zip(0..) {
                *share = if at == other {
                    1.0 + errors.scale * gauss.draw()
                } else {
                    errors.misalignment * gauss.draw()
                };
            }
        }
        let longest_s = sensor.delay_s + 6.0 * sensor.jitter_s;
        Self {
            sensor: *sensor,
            gauss,
            bias,
            warming,
            drift,
            start_s,
            shape,
            before: [0.0; N],
            before_s: start_s,
            next_s: start_s + 1.0 / sensor.rate_hz,
            under_way: VecDeque::with_capacity((longest_s * sensor.rate_hz) as usize + 2),
            last_s: start_s,
            sum: [0.0; N],
            sum_s: 0.0,
            count: 0,
        }
    }

    pub(super) const fn true_errors(&self) -> TrueErrors<N> {
        TrueErrors {
            bias: self.bias,
            shape: self.shape,
        }
    }

    /// Sets the truth of the start.
    pub(super) const fn begin(&mut self, truth: [f64; N]) {
        self.before = truth;
    }

    /// Takes the samples up to `now_s`; between two steps the truth is linear.
    pub(super) fn step(&mut self, now_s: f64, truth: [f64; N], engine: &Engine) {
        let span_s = now_s - self.before_s;
        while self.next_s <= now_s && span_s > 0.0 {
            // Makes room for the next.
            self.collect(self.next_s);
            let share = (self.next_s - self.before_s) / span_s;
            let mut at = truth;
            for (now, before) in at.iter_mut().zip(self.before) {
                *now = before + share * (*now - before);
            }
            let revolutions = engine.before + share * (engine.now - engine.before);
            let sample = self.sample(at, revolutions, engine.throttle);
            let late_s = self.sensor.jitter_s * self.gauss.draw().abs();
            // One does not overtake another.
            self.last_s = self.last_s.max(self.next_s + self.sensor.delay_s + late_s);
            if self.under_way.len() == self.under_way.capacity() {
                self.under_way.pop_front();
            }
            self.under_way.push_back((self.last_s, sample));
            self.next_s += 1.0 / self.sensor.rate_hz;
        }
        (self.before, self.before_s) = (truth, now_s);
        self.collect(now_s);
    }

    /// Adds up what has arrived.
    fn collect(&mut self, now_s: f64) {
        while let Some((at_s, sample)) = self.under_way.front().filter(|(at_s, _)| *at_s <= now_s) {
            for (sum, value) in self.sum.iter_mut().zip(sample) {
                *sum += value;
            }
            self.sum_s += at_s;
            self.count += 1;
            self.under_way.pop_front();
        }
    }

    fn sample(&mut self, truth: [f64; N], revolutions: f64, throttle: f64) -> [f64; N] {
        let mut shaken = truth;
        for ((value, errors), axis) in shaken.iter_mut().zip(&self.sensor.errors).zip(0..) {
            *value += errors.vibration * throttle * vibration(revolutions, f64::from(axis));
        }
        let warm = 1.0 - exp((self.start_s - self.next_s) / WARM_UP_S);
        let constant = self.bias.iter().zip(&self.warming).zip(&self.shape);
        let axes = self.sensor.errors.iter().zip(&mut self.drift).zip(constant);
        let mut sample = [0.0; N];
        for (value, ((errors, drift), ((bias, warming), row))) in sample.iter_mut().zip(axes) {
            if errors.drift > 0.0 {
                let kept = exp(-1.0 / (self.sensor.rate_hz * errors.drift_tau_s));
                let fresh = errors.drift * sqrt(1.0 - kept * kept);
                *drift = kept * *drift + fresh * self.gauss.draw();
            }
            let given: f64 = row.iter().zip(shaken).map(|(share, of)| share * of).sum();
            let mut given = given + bias + warm * warming + *drift;
            if errors.white > 0.0 {
                given += errors.white * self.gauss.draw();
            }
            if errors.resolution > 0.0 {
                given = errors.resolution * round(given / errors.resolution);
            }
            *value = given.clamp(-errors.limit, errors.limit);
        }
        sample
    }

    /// Takes what arrived since it was last taken.
    pub(super) fn take(&mut self) -> Option<Arrived<N>> {
        let count = f64::from(core::mem::take(&mut self.count));
        let sum = core::mem::replace(&mut self.sum, [0.0; N]);
        let sum_s = core::mem::take(&mut self.sum_s);
        (count > 0.0).then(|| Arrived {
            values: sum.map(|sum| sum / count),
            at_s: sum_s / count,
        })
    }
}

/// The vibration of an unbalanced propeller, once per revolution, and of the
/// firing of four cylinders, twice: each of magnitude 1 together, in another
/// phase in each axis.
fn vibration(revolutions: f64, axis: f64) -> f64 {
    let phase = core::f64::consts::TAU * (revolutions + axis / 3.0);
    0.5 * (sin(phase) + sin(2.0 * phase + axis))
}
