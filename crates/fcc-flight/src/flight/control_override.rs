//! What may replace the outputs of the autopilot: an experiment, or a test.

use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::Tick;
use fcc_fixed_wing::Autopilot;

/// Replaces the outputs of the autopilot while it is engaged. Navigation,
/// guidance, states and failsafe remain the autopilot's.
pub trait ControlOverride: Send {
    /// The autopilot engages.
    fn engage(&mut self, _tick: &Tick) {}

    /// The outputs to send in place of the autopilot's.
    fn control(
        &mut self,
        autopilot: &Autopilot,
        tick: &Tick,
        measurements: &Measurements,
        surfaces: Surfaces,
    ) -> Surfaces;
}
