//! Where outputs go.

use core::fmt;

use super::Tick;
use crate::schema;

/// Carries the outputs `A` of a tick to the plant.
///
/// ```
/// use fcc_core::framework::{Actuator, ActuatorFault, Tick};
///
/// /// A heater that nobody has plugged in.
/// struct Unplugged;
///
/// impl Actuator<f64> for Unplugged {
///     fn apply(&mut self, _: &Tick, _: &f64) -> Result<(), ActuatorFault> {
///         Err(ActuatorFault::NotConnected)
///     }
///
///     fn release(&mut self) -> Result<(), ActuatorFault> {
///         Ok(())
///     }
///
///     fn name(&self) -> &'static str {
///         "heater"
///     }
/// }
///
/// let mut heater = Unplugged;
/// assert!(heater.apply(&Tick::default(), &0.5).is_err());
/// // Released twice is released.
/// assert!(heater.release().is_ok() && heater.release().is_ok());
/// ```
pub trait Actuator<A>: Send {
    /// Whether it could take control now; if not, the loop does not engage. The
    /// rules of a tick apply. True by default: what only a write can show is shown
    /// by the first one.
    ///
    /// # Errors
    /// What is wrong.
    fn ready(&self) -> Result<(), ActuatorFault> {
        Ok(())
    }

    /// Sends the outputs and returns. Never waits, allocates, locks, logs or
    /// panics. The first call after a release takes control.
    ///
    /// # Errors
    /// What went wrong in this tick; the loop counts it and continues.
    fn apply(&mut self, tick: &Tick, outputs: &A) -> Result<(), ActuatorFault>;

    /// Releases control: centres, then releases. Called on every exit path
    /// (disengagement, end of failsafe, stop, signal, panic), possibly more
    /// than once, and possibly without an `apply` before, in which case it does
    /// nothing.
    ///
    /// # Errors
    /// The reason, when control may still be held.
    fn release(&mut self) -> Result<(), ActuatorFault>;

    /// Loads what the next [`apply`](Self::apply) will run and read into the
    /// caches, without effect: the plant receives nothing, and what is applied
    /// later is the same to the last bit with and without it. Called shortly
    /// before a tick in which the loop will probably hold control, with the
    /// last outputs; the rules of a tick apply. Does nothing by default.
    fn warm_up(&self, _tick: &Tick, _outputs: &A) {}

    /// The actuator's name, for events and reports: which one it is. Constant, one line.
    fn name(&self) -> &str;
}

schema! {
    /// What can go wrong when an actuator is driven.
    ///
    /// ```
    /// use fcc_core::framework::ActuatorFault;
    ///
    /// assert_ne!(ActuatorFault::NotConnected.to_string(), "");
    /// ```
    #[derive(Clone, Copy, PartialEq, Eq, Debug)]
    #[name("ActuatorFaultKind")]
    #[non_exhaustive]
    pub enum ActuatorFault {
        /// The operating system refused a write, with its error number.
        #[field(2)]
        Io {
            /// `errno`, 0 if there was none.
            #[field(1)]
            errno: i32,
        },
        /// Writes are sent but have no effect on the plant.
        #[field(4)]
        Unconfirmed,
        /// The plant's address is not known yet.
        #[field(5)]
        NotConnected,
    }
}

impl fmt::Display for ActuatorFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io { errno } => write!(f, "writing failed (errno {errno})"),
            Self::Unconfirmed => f.write_str("writes are sent but do not take effect"),
            Self::NotConnected => f.write_str("the address is not known yet"),
        }
    }
}

impl core::error::Error for ActuatorFault {}
