//! Servos, by pulses of the operating system's PWM or of a PCA9685.
//!
//! Writing to a bus waits, so a thread of its own does: the loop hands over the
//! latest outputs without waiting. The same thread notices when the loop is
//! silent, and moves the servos to their failsafe positions.
//!
//! | module | contents |
//! |---|---|
//! | `channel` | [`ServoChannel`]: from a surface to a pulse |
//! | `actuator` | [`ServoActuator`]: the loop's end |
//! | `thread` | [`ServoThread`]: what is written, and when |
//! | `authority` | [`ServoAuthority`]: who has control, and how it is given back from outside |
//! | `pwm`, `pca9685` | [`SysfsPwm`], [`Pca9685`]: where it is written |

mod actuator;
mod authority;
mod channel;
mod pca9685;
mod pwm;
mod thread;

pub use actuator::ServoActuator;
pub use authority::{ReleasePulses, ServoAuthority, ServoControl};
pub use channel::{Drives, ServoChannel, ServoError};
pub use pca9685::{Pca9685, Pca9685Settings};
pub use pwm::{PwmOutput, SysfsPwm};
pub use thread::{HeartbeatLine, PulseOutputs, Released, ServoBus, ServoSettings, ServoThread};
