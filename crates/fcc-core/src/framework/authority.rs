//! Who has control of a plant, as it is seen from outside the loop's thread.

use core::fmt;
use core::time::Duration;

use super::{ActuatorFault, PlantId};

/// Watches who has control of a plant, and gives control back by a way of its
/// own: an [`Actuator`](super::Actuator) is in the hands of the loop, which may
/// hang or be dead.
///
/// Any thread may call it but the loop's: here waiting is allowed.
pub trait ControlAuthority: Send + Sync {
    /// The plant that is, or would be, controlled; none while that is not
    /// known.
    fn plant(&self) -> Option<PlantId>;

    /// The plant that this program controls, or that does not show yet that it
    /// has its controls back.
    fn held(&self) -> Option<PlantId>;

    /// From now on the actuator takes control of no plant but the one that is
    /// [permitted](Self::permit): for a program that has to find out first
    /// whether another one controls it.
    fn require_permission(&self);

    /// The actuator may take control of this plant, and of no other.
    fn permit(&self, plant: &PlantId);

    /// One name for a plant that is reached by several: two programs that
    /// control the same plant get the same.
    fn unique(&self, plant: &PlantId) -> PlantId {
        *plant
    }

    /// Reports what has changed since the last call, in words for people: what
    /// is wrong and what to do about it, and when it is right again.
    fn report(&self, report: &mut dyn FnMut(fmt::Arguments<'_>));

    /// Gives the controls of a plant back, whoever took them, until the plant
    /// shows that it has them or `within` is over. `is_called_off` is asked
    /// several times a second, and before anything is sent.
    ///
    /// # Errors
    /// When nothing can be sent to this plant at all.
    fn release(
        &self,
        plant: &PlantId,
        within: Duration,
        is_called_off: &mut dyn FnMut() -> bool,
    ) -> Result<Released, ActuatorFault>;

    /// What a person does at the plant to take control back by hand.
    fn by_hand(&self) -> &'static str;
}

/// How a release that was waited for ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Released {
    /// The plant shows that it has its controls back.
    Confirmed,
    /// The plant is gone: there is nothing left to control.
    Gone,
    /// The plant did not answer, or goes on showing that its controls are held:
    /// it hangs, cannot be reached, or somebody else holds them.
    Unconfirmed,
    /// The release was called off before the plant showed it.
    CalledOff,
}

impl Released {
    /// Whether nobody holds the plant's controls any more.
    pub const fn is_over(self) -> bool {
        matches!(self, Self::Confirmed | Self::Gone)
    }
}
