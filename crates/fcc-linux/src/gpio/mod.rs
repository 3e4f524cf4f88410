//! GPIO lines: a switch of the pilot, and the heartbeat for a multiplexer, by the
//! kernel's character device (`/dev/gpiochip0`).
//!
//! | module | contents |
//! |---|---|
//! | `line` | [`GpioLine`]: a line of a chip, read or driven |
//! | `debounce` | [`Debounce`]: the position of a contact that bounces |
//! | `switch` | [`GpioSwitch`]: a line as a source of the switch's position |

mod debounce;
mod line;
mod switch;

pub use debounce::Debounce;
pub use line::{GpioLine, GpioPin, LevelLine, Pull};
pub use switch::GpioSwitch;
