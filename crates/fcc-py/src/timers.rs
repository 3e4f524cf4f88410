//! The kernel's timers, and their timing statistics.

use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread;
use std::time::Duration;

use fcc_timer::{Expiry, Timer, TimerKind, TimingStats, TimingSummary};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arguments::within;
use crate::errors;

/// One deadline: its number (from 1), when it was due and when the thread woke,
/// in ns on `CLOCK_MONOTONIC`, and how many deadlines were missed before it.
///
/// >>> next(iter(fcc.Timer(0.01))).number
/// 1
#[pyclass(name = "Expiry", module = "fcc", frozen, get_all)]
pub(crate) struct PyExpiry {
    number: u64,
    scheduled_ns: i64,
    woke_ns: i64,
    missed: u64,
}

#[pymethods]
impl PyExpiry {
    /// How late the thread woke, ns after the deadline.
    #[getter]
    const fn lateness_ns(&self) -> i64 {
        self.woke_ns.saturating_sub(self.scheduled_ns)
    }

    fn __repr__(&self) -> String {
        format!(
            "Expiry(number={}, lateness_ns={}, missed={})",
            self.number,
            self.lateness_ns(),
            self.missed
        )
    }
}

impl From<Expiry> for PyExpiry {
    fn from(expiry: Expiry) -> Self {
        Self {
            number: expiry.number,
            scheduled_ns: expiry.scheduled_ns,
            woke_ns: expiry.woke_ns,
            missed: expiry.missed,
        }
    }
}

/// Timing statistics: periods in ms, lateness in µs, the share (0..1) of periods
/// within 2 % of the nominal one. The values of periods are NaN before the
/// second tick, those of lateness before the first.
///
/// >>> fcc.Timer(0.02).summary().rate_hz
/// 50.0
#[pyclass(name = "TimingSummary", module = "fcc", frozen)]
pub(crate) struct PyTimingSummary(TimingSummary);

/// Makes fields of the summary attributes.
macro_rules! attributes {
    ($($name:ident: $type:ty),* $(,)?) => {
        #[pymethods]
        impl PyTimingSummary {
            $(
                #[getter]
                const fn $name(&self) -> $type {
                    self.0.$name
                }
            )*

            fn __repr__(&self) -> String {
                format!(
                    "TimingSummary(rate_hz={}, ticks={}, missed={}, period_mean_ms={:.4}, \
                     lateness_p99_us={:.1}, lateness_max_us={:.1})",
                    self.0.rate_hz,
                    self.0.ticks,
                    self.0.missed,
                    self.0.period_mean_ms,
                    self.0.lateness_p99_us,
                    self.0.lateness_max_us
                )
            }
        }
    };
}

attributes! {
    rate_hz: f64, ticks: u64, missed: u64, runtime_s: f64,
    period_mean_ms: f64, period_median_ms: f64, period_min_ms: f64, period_max_ms: f64,
    period_range_ms: f64, period_within_2_percent: f64,
    lateness_p50_us: f64, lateness_p99_us: f64, lateness_p99_9_us: f64, lateness_max_us: f64,
}

/// A periodic timer of the kernel, `"timerfd"`, `"posix"` or `"nanosleep"`:
/// absolute deadlines on `CLOCK_MONOTONIC`, `period_s` (10 µs to 1 h) apart,
/// whose phase is constant. The GIL is released while it waits; Ctrl-C ends the
/// wait within 0.1 s.
///
/// Iterating starts the timer if it was not started, and gives an `Expiry` for
/// each deadline, without an end.
///
/// >>> timer = fcc.Timer(0.01)
/// >>> for expiry in timer:
/// ...     if expiry.number == 3:
/// ...         break
/// >>> timer.summary().ticks
/// 3
#[pyclass(name = "Timer", module = "fcc")]
pub(crate) struct PyTimer {
    timer: Mutex<Started>,
    stats: Mutex<TimingStats>,
    kind: TimerKind,
    period: Duration,
}

struct Started {
    timer: Box<dyn Timer>,
    /// The next deadline, ns on the timer's clock; none if it was not started.
    next_ns: Option<i64>,
}

/// The interval of checks for Ctrl-C. Shorter waits are done by the timer
/// itself, which is precise.
const LOOK_EVERY: Duration = Duration::from_millis(50);

impl PyTimer {
    fn timer(&self) -> PyResult<MutexGuard<'_, Started>> {
        match self.timer.try_lock() {
            Ok(timer) => Ok(timer),
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => {
                Err(errors::TIMER.with("another thread waits for this timer: give each its own"))
            }
        }
    }

    fn stats(&self) -> MutexGuard<'_, TimingStats> {
        self.stats.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl PyTimer {
    #[new]
    #[pyo3(signature = (period_s, kind = "timerfd"))]
    fn new(period_s: f64, kind: &str) -> PyResult<Self> {
        let period = Duration::from_secs_f64(within("period_s", period_s, 1e-5, 3_600.0)?);
        let kind: TimerKind = kind
            .parse()
            .map_err(|error: fcc_timer::UnknownTimer| PyValueError::new_err(error.to_string()))?;
        let refused = |error| errors::TIMER.with(error);
        let timer = kind.build(period).map_err(refused)?;
        Ok(Self {
            timer: Mutex::new(Started {
                timer,
                next_ns: None,
            }),
            stats: Mutex::new(TimingStats::new(period).map_err(refused)?),
            kind,
            period,
        })
    }

    /// Starts the deadlines now, on the thread that will wait. Calling it again
    /// restarts them and resets the statistics.
    fn start(&self) -> PyResult<()> {
        let mut timer = self.timer()?;
        timer
            .timer
            .start()
            .map_err(|error| errors::TIMER.with(error))?;
        timer.next_ns = Some(timer.timer.now_ns() + self.period.as_nanos() as i64);
        self.stats().reset();
        Ok(())
    }

    /// Waits for the next deadline; never returns before it. Missed deadlines are
    /// counted, and for the latest of them it returns at once.
    fn wait(&self, py: Python<'_>) -> PyResult<PyExpiry> {
        let mut guard = self.timer()?;
        let timer = &mut *guard;
        while timer.next_ns.is_some_and(|next_ns| {
            next_ns - timer.timer.now_ns() > 2 * LOOK_EVERY.as_nanos() as i64
        }) {
            py.detach(|| thread::sleep(LOOK_EVERY));
            py.check_signals()?;
        }
        let waited = py.detach(|| {
            let expiry = timer.timer.wait();
            let expiry = expiry.map_err(|error| errors::TIMER.with(error))?;
            timer.next_ns = Some(expiry.scheduled_ns + self.period.as_nanos() as i64);
            self.stats().record(&expiry);
            Ok(expiry)
        });
        py.check_signals()?;
        waited.map(PyExpiry::from)
    }

    fn __iter__(this: PyRef<'_, Self>) -> PyResult<PyRef<'_, Self>> {
        let started = this.timer()?.next_ns.is_some();
        if !started {
            this.start()?;
        }
        Ok(this)
    }

    fn __next__(&self, py: Python<'_>) -> PyResult<PyExpiry> {
        self.wait(py)
    }

    /// The statistics since it was started.
    fn summary(&self) -> PyTimingSummary {
        PyTimingSummary(self.stats().summary())
    }

    /// The kernel's timer: timerfd, posix or nanosleep.
    #[getter]
    fn kind(&self) -> &'static str {
        self.kind.name()
    }

    /// Time between deadlines, s.
    #[getter]
    fn period_s(&self) -> f64 {
        self.period.as_secs_f64()
    }

    fn __repr__(&self) -> String {
        format!(
            "Timer({}, {:?})",
            self.period.as_secs_f64(),
            self.kind.name()
        )
    }
}
