//! Surfaces and throttle, as servos move them.

/// Where servos go.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Surfaces {
    /// -1 to 1, positive: nose up.
    pub elevator: f32,
    /// -1 to 1, positive: right wing down.
    pub aileron: f32,
    /// -1 to 1, positive: nose right.
    pub rudder: f32,
    /// 0 idle to 1 full.
    pub throttle: f32,
}
