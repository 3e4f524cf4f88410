//! Whether a sensor lies still, and means of what it gives meanwhile.

use core::time::Duration;

use libm::sqrt;

use super::readings::Arrived;
use super::{between, difference, norm};
use fcc_core::framework::Time;

/// Readings are judged in blocks of this length.
const BLOCK: Duration = Duration::from_millis(250);
/// So many in a row must have been still.
const SETTLED: u32 = 2;
/// One standard deviation of what is still, hands and noise included, m/s² and
/// rad/s; in a hand it is about three times as much.
const STILL_MPS2: f64 = 0.25;
const STILL_RADPS: f64 = 0.03;
/// A single reading that is so many times as far away is a movement at once.
const AT_ONCE: f64 = 5.0;

/// The readings of one sensor, in blocks.
#[derive(Clone, Copy, Debug)]
struct Blocks {
    still: f64,
    before: Option<[f64; 3]>,
    block: Average<3>,
}

impl Blocks {
    fn new(still: f64) -> Self {
        Self {
            still,
            before: None,
            block: Average::default(),
        }
    }

    /// Whether nothing is against rest.
    fn take(&mut self, values: [f64; 3]) -> bool {
        self.block.take(values);
        self.is_near(values, AT_ONCE * self.still)
    }

    /// Ends a block: whether it was still, and as the one before.
    fn end(&mut self) -> bool {
        let block = core::mem::take(&mut self.block);
        if block.count == 0.0 {
            return true;
        }
        let is_still = block.deviation() <= self.still && self.is_near(block.mean, self.still);
        self.before = Some(block.mean);
        is_still
    }

    fn is_near(&self, values: [f64; 3], most: f64) -> bool {
        let differs = |before| norm(difference(values, before)) > most;
        !self.before.is_some_and(differs)
    }
}

/// Finds out whether the sensors lie still, by the accelerometer and the
/// gyroscope, as far as there are any.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rest {
    force: Blocks,
    rates: Blocks,
    /// When the present block began.
    since: Time,
    still_blocks: u32,
}

impl Default for Rest {
    fn default() -> Self {
        Self {
            force: Blocks::new(STILL_MPS2),
            rates: Blocks::new(STILL_RADPS),
            since: Time::NEVER,
            still_blocks: 0,
        }
    }
}

impl Rest {
    pub(super) fn take(&mut self, arrived: &Arrived) {
        if self.since.is_never() {
            self.since = arrived.at;
        }
        let sensors = [
            (&mut self.force, arrived.force),
            (&mut self.rates, arrived.rates),
        ];
        for (blocks, given) in sensors {
            if given.is_some_and(|given| !blocks.take(given)) {
                self.still_blocks = 0;
            }
        }
        if arrived.at.since(self.since) >= BLOCK {
            self.since = arrived.at;
            let is_still = [self.force.end(), self.rates.end()] == [true; 2];
            self.still_blocks = if is_still { self.still_blocks + 1 } else { 0 };
        }
    }

    /// Whether it lies still.
    pub(super) const fn is_given(&self) -> bool {
        self.still_blocks >= SETTLED
    }
}

/// Mean and standard deviation of values (Welford 1962).
#[derive(Clone, Copy, Debug)]
pub(super) struct Average<const N: usize> {
    count: f64,
    pub(super) mean: [f64; N],
    squares: [f64; N],
}

impl<const N: usize> Default for Average<N> {
    fn default() -> Self {
        Self {
            count: 0.0,
            mean: [0.0; N],
            squares: [0.0; N],
        }
    }
}

impl<const N: usize> Average<N> {
    fn take(&mut self, values: [f64; N]) {
        self.count += 1.0;
        let axes = self.mean.iter_mut().zip(&mut self.squares).zip(values);
        for ((mean, squares), value) in axes {
            let difference = value - *mean;
            *mean += difference / self.count;
            *squares += difference * (value - *mean);
        }
    }

    /// The standard deviation in the worst axis.
    fn deviation(&self) -> f64 {
        let most = self.squares.into_iter().fold(0.0, f64::max);
        sqrt(most / (self.count - 1.0).max(1.0))
    }

    /// The standard deviation of the mean in the worst axis.
    fn mean_sigma(&self) -> f64 {
        self.deviation() / sqrt(self.count.max(1.0))
    }
}

/// What a sensor gives while it is left alone for a while, in two halves: a
/// difference between them is a movement, or a sensor that warms up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Halves<const N: usize> {
    length: Duration,
    since: Time,
    now: Time,
    first: Average<N>,
    second: Average<N>,
}

impl<const N: usize> Halves<N> {
    pub(super) fn new(length: Duration) -> Self {
        Self {
            length,
            since: Time::NEVER,
            now: Time::NEVER,
            first: Average::default(),
            second: Average::default(),
        }
    }

    /// Begins again.
    pub(super) fn clear(&mut self) {
        *self = Self::new(self.length);
    }

    pub(super) fn take(&mut self, values: [f64; N], at: Time) {
        if self.since.is_never() {
            self.since = at;
        }
        self.now = at;
        if 2 * at.since(self.since) < self.length {
            self.first.take(values);
        } else {
            self.second.take(values);
        }
    }

    /// How much of the time has passed.
    pub(super) fn share(&self) -> f64 {
        if self.since.is_never() {
            return 0.0;
        }
        let passed = self.now.since(self.since).as_secs_f64();
        (passed / self.length.as_secs_f64()).min(1.0)
    }

    /// Whether it has begun.
    pub(super) const fn has_begun(&self) -> bool {
        !self.since.is_never()
    }

    /// Whether all of the time has passed.
    pub(super) fn is_full(&self) -> bool {
        self.has_begun() && self.now.since(self.since) >= self.length
    }

    pub(super) fn mean(&self) -> [f64; N] {
        let (one, other) = (self.first.count, self.second.count);
        let mut mean = self.first.mean;
        for (mean, second) in mean.iter_mut().zip(self.second.mean) {
            *mean = (*mean * one + second * other) / (one + other).max(1.0);
        }
        mean
    }

    /// From the first half to the second, in the worst axis.
    pub(super) fn change(&self) -> f64 {
        let halves = self.first.mean.iter().zip(self.second.mean);
        halves.fold(0.0, |most, (one, other)| (other - one).abs().max(most))
    }

    /// The standard deviation of the mean, in the worst axis: by the noise
    /// within the halves.
    pub(super) fn mean_sigma(&self) -> f64 {
        let [one, other] = [self.first, self.second].map(|half| half.mean_sigma());
        0.5 * sqrt(one * one + other * other)
    }
}

impl Halves<3> {
    /// The angle from the first half to the second, rad, beyond what noise gives;
    /// none of nothing.
    pub(super) fn turned_rad(&self) -> f64 {
        /// Of the standard deviation of the difference.
        const NOISE_SIGMAS: f64 = 5.0;
        if self.second.count <= 0.0 {
            return 0.0;
        }
        let sigma = 2.0 * self.mean_sigma();
        let noise_rad = NOISE_SIGMAS * sigma / norm(self.mean());
        (between(self.first.mean, self.second.mean) - noise_rad).max(0.0)
    }
}
