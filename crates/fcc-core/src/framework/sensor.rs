//! Sources of measurements.

use core::fmt;
use core::time::Duration;

use super::Tick;
use crate::schema;

/// The default age of a reading above which another sensor's is preferred.
pub const FALLBACK_AFTER: Duration = Duration::from_millis(100);

/// Writes its part of the measurements `M` once per tick.
///
/// The loop holds sensors as `Box<dyn Sensor<M>>`: a simulated plant and a
/// board's sensors differ only in configuration, not in the loop's code. A
/// sensor that has nothing new leaves `into` unchanged: each
/// [`Reading`](super::Reading) carries the time it was taken. Each sensor has
/// its own `into`: if there are several sensors, the loop takes each reading
/// from the most preferred one with a fresh reading.
///
/// ```
/// use core::time::Duration;
/// use fcc_core::framework::{Reading, Sensor, SensorFault, Tick};
///
/// /// A thermometer that always reads 19 °C.
/// struct Thermometer;
///
/// impl Sensor<Reading<f64>> for Thermometer {
///     fn sample(&mut self, tick: &Tick, into: &mut Reading<f64>) -> Result<(), SensorFault> {
///         *into = Reading::new(19.0, tick.woke);
///         Ok(())
///     }
///
///     fn name(&self) -> &'static str {
///         "thermometer"
///     }
/// }
///
/// let (tick, mut measured) = (Tick::default(), Reading::default());
/// assert!(Thermometer.sample(&tick, &mut measured).is_ok());
/// assert_eq!(measured.value, 19.0);
/// ```
pub trait Sensor<M>: Send {
    /// Reads what is available and returns. Never waits, allocates, locks, logs
    /// or panics.
    ///
    /// # Errors
    /// What went wrong in this tick. The loop counts it, stores it in the
    /// record and continues: the age of the readings decides about failsafe.
    fn sample(&mut self, tick: &Tick, into: &mut M) -> Result<(), SensorFault>;

    /// The age of this sensor's readings above which that of the next sensor in
    /// the loop's order of preference is taken; called once, before the first
    /// tick. It must exceed the interval between two readings.
    fn fallback_after(&self) -> Duration {
        FALLBACK_AFTER
    }

    /// Loads what the next [`sample`](Self::sample) will run and read into the
    /// caches, without effect: every value sampled later is the same to the
    /// last bit with and without it. Called shortly before a tick if there is
    /// time; the rules of a tick apply. Does nothing by default.
    fn warm_up(&self, _tick: &Tick) {}

    /// The sensor's name, for events and reports: which one it is. Constant, one line.
    fn name(&self) -> &str;
}

schema! {
    /// What can go wrong when a sensor is sampled.
    ///
    /// ```
    /// use fcc_core::framework::SensorFault;
    ///
    /// assert_ne!(SensorFault::Silent.to_string(), "");
    /// ```
    #[derive(Clone, Copy, PartialEq, Eq, Debug)]
    #[name("SensorFaultKind")]
    #[non_exhaustive]
    pub enum SensorFault {
        /// The source has been silent for too long.
        #[field(1)]
        Silent,
        /// The operating system refused a read, with its error number.
        #[field(2)]
        Io {
            /// `errno`, 0 if there was none.
            #[field(1)]
            errno: i32,
        },
        /// The data that arrived is invalid, and was left out.
        #[field(3)]
        Malformed,
    }
}

impl fmt::Display for SensorFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Silent => f.write_str("nothing arrives"),
            Self::Io { errno } => write!(f, "reading failed (errno {errno})"),
            Self::Malformed => f.write_str("the data that arrives is invalid"),
        }
    }
}

impl core::error::Error for SensorFault {}
