//! Control blocks: filters, limiters, profiles, PID. They are independent of
//! the plant.
//!
//! Every block takes the time since its last step, `dt_s`, because a
//! coefficient per sample is valid at one rate only. A step of zero seconds
//! changes nothing, so a paused plant does not affect a filter.

mod angle;
mod complementary;
mod high_pass;
mod limit;
mod low_pass;
mod pid;
mod profile;
mod rate_limit;

pub use angle::{wrap_pi, wrap_two_pi};
pub use complementary::Complementary;
pub use high_pass::HighPass;
pub use limit::{limit, limit_abs};
pub use low_pass::{LowPass, smoothing_factor, time_constant};
pub use pid::{AntiWindup, Pid, PidConfig};
pub use profile::SquareRootProfile;
pub use rate_limit::RateLimit;
