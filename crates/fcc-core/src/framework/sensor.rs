//! Where measurements come from.

use core::fmt;
use core::time::Duration;

use super::Tick;
use crate::schema;

/// How old a reading may be by default before another sensor's is preferred.
pub const FALLBACK_AFTER: Duration = Duration::from_millis(100);

/// Writes its part of the measurements `M` once a tick.
///
/// The loop holds sensors as `Box<dyn Sensor<M>>`: a simulated plant and a
/// board's own sensors differ in configuration and in no line of the loop. A sensor
/// that has nothing new leaves `into` as it is: each
/// [`Reading`](super::Reading) carries its own time, and grows old by itself.
/// `into` is this sensor's own: where there are several, the loop takes each
/// reading from the most preferred that has a fresh one.
///
/// ```
/// use core::time::Duration;
/// use fcc_core::framework::{Reading, Sensor, SensorFault, Tick};
///
/// /// A thermometer that always says 19 °C.
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
    /// Takes what is there and returns. Never waits, allocates, locks, logs or
    /// panics.
    ///
    /// # Errors
    /// What went wrong in this tick. The loop counts it, shows it in the
    /// record and goes on: what decides about failsafe is the readings' age.
    fn sample(&mut self, tick: &Tick, into: &mut M) -> Result<(), SensorFault>;

    /// How old a reading of this sensor may be before that of the next sensor
    /// in the loop's order of preference is taken; asked once, before the first
    /// tick. Longer than the time between two of them.
    fn fallback_after(&self) -> Duration {
        FALLBACK_AFTER
    }

    /// Loads what the next [`sample`](Self::sample) will run and read into the
    /// caches, without effect: every value sampled later is the same to the
    /// last bit with and without it. Called shortly before a tick if there is
    /// time; the rules of a tick apply. Does nothing by default.
    fn warm_up(&self, _tick: &Tick) {}

    /// What people call this sensor; for events and reports.
    fn name(&self) -> &'static str;
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
        /// The source has been silent for longer than it should be.
        #[field(1)]
        Silent,
        /// The operating system refused a read, with its error number.
        #[field(2)]
        Io {
            /// `errno`, 0 if there was none.
            #[field(1)]
            errno: i32,
        },
        /// What came could not be understood, and was left out.
        #[field(3)]
        Malformed,
    }
}

impl fmt::Display for SensorFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Silent => f.write_str("nothing arrives"),
            Self::Io { errno } => write!(f, "reading failed (errno {errno})"),
            Self::Malformed => f.write_str("what arrives cannot be understood"),
        }
    }
}

impl core::error::Error for SensorFault {}
