//! The health of one sensor or actuator.

/// A change of the health.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Change<F> {
    Fault(F),
    Recovered,
}

/// The present fault of one part, so that only changes are reported: a silent
/// sensor would otherwise fill a recording with the same event.
#[derive(Debug)]
pub(crate) struct Health<F> {
    present: Option<F>,
}

impl<F: Copy + PartialEq> Health<F> {
    pub(crate) const fn new() -> Self {
        Self { present: None }
    }

    /// Processes a tick's result.
    pub(crate) fn update(&mut self, result: Result<(), F>) -> Option<Change<F>> {
        let before = self.present;
        self.present = result.err();
        match (before, self.present) {
            (Some(_), None) => Some(Change::Recovered),
            (before, Some(fault)) if before != Some(fault) => Some(Change::Fault(fault)),
            _ => None,
        }
    }
}
