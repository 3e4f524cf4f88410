//! What the altimeter is compared with.

use super::vertical::VerticalState;

/// One tick's inputs.
#[derive(Clone, Copy, Debug)]
pub(super) struct AltitudeInput {
    /// The altimeter's, m, if it is current, and the step of a coarse one.
    pub(super) altitude_m: Option<f64>,
    pub(super) step_m: f64,
    /// It has just stepped, and the filter has adopted its altitude.
    pub(super) has_stepped: bool,
    /// The filter's state with the altimeter, and its bias, m/s².
    pub(super) followed: VerticalState,
    pub(super) bias_mps2: f64,
    /// The vertical acceleration with the bias, up, m/s².
    pub(super) felt_mps2: f64,
    /// Climb rates by pitch and lift, and over the ground, m/s.
    pub(super) path_mps: Option<f64>,
    pub(super) ground_mps: Option<f64>,
    /// The range finder's height above the ground, m.
    pub(super) range_m: Option<f64>,
    pub(super) tan_bank: f64,
    pub(super) gusts_mps: f64,
    /// Whether the altimeter may be doubted: while engaged.
    pub(super) may_doubt: bool,
}
