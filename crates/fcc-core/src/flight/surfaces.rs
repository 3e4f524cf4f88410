//! What the autopilot commands.

/// What the autopilot commands: throttle and control surfaces.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
#[repr(C)]
pub struct Surfaces {
    /// 0 idle ..= 1 full.
    pub throttle: f64,
    /// -1..=1; positive raises the nose.
    pub elevator: f64,
    /// -1..=1; positive rolls right.
    pub aileron: f64,
    /// -1..=1; positive yaws right.
    pub rudder: f64,
}

impl Surfaces {
    /// Whether every value is finite and in its range.
    pub fn is_valid(&self) -> bool {
        (0.0..=1.0).contains(&self.throttle)
            && [self.elevator, self.aileron, self.rudder]
                .iter()
                .all(|surface| (-1.0..=1.0).contains(surface))
    }
}
