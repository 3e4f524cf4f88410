//! Who has control of a plant, seen from outside the loop's thread.

use core::fmt;
use core::time::Duration;

use super::{ActuatorFault, PlantId};

/// Monitors who has control of a plant, and releases it independently of the
/// loop: an [`Actuator`](super::Actuator) is owned by the loop, which may hang
/// or have ended.
///
/// May be called by any thread except the loop's, since it may wait.
pub trait ControlAuthority: Send + Sync {
    /// The plant that is, or would be, controlled; none while it is not known.
    fn plant(&self) -> Option<PlantId>;

    /// The plant that this program controls, or whose release is not yet
    /// confirmed.
    fn held(&self) -> Option<PlantId>;

    /// From now on the actuator takes control only of the plant that is
    /// [permitted](Self::permit): for a program that has to check first whether
    /// another one controls it.
    fn require_permission(&self);

    /// Permits the actuator to take control of this plant only.
    fn permit(&self, plant: &PlantId);

    /// From now on this is called directly before control is taken.
    fn notify(&self, _notice: &'static dyn TakeoverNotice) {}

    /// A unique name for a plant that can be addressed by several names: two
    /// programs that control the same plant get the same name.
    fn unique(&self, plant: &PlantId) -> PlantId {
        *plant
    }

    /// By what the answers of the plant are told from others', for
    /// [`expect`](Self::expect) in another process; none while it is not known, or
    /// if there is nothing of the kind. Of X-Plane it is the UDP port that they
    /// come from.
    fn answers_from(&self) -> Option<u16> {
        None
    }

    /// From now on a [`release`](Self::release) of this plant is confirmed only by
    /// answers from there, unless that is gone.
    fn expect(&self, _plant: &PlantId, _answers_from: u16) {}

    /// Opens what a [`release`](Self::release) of this plant needs, while it can be
    /// had: later, other programs may have taken it.
    fn prepare_release(&self, _plant: &PlantId) {}

    /// Reports what has changed since the last call, as text for users: what is
    /// wrong and what to do about it, and when it is resolved.
    fn report(&self, report: &mut dyn FnMut(fmt::Arguments<'_>));

    /// Releases the controls of a plant, whichever program took them, until the
    /// plant confirms it or `within` has passed. `is_cancelled` is called
    /// several times a second, and before anything is sent.
    ///
    /// # Errors
    /// When nothing can be sent to this plant.
    fn release(
        &self,
        plant: &PlantId,
        within: Duration,
        is_cancelled: &mut dyn FnMut() -> bool,
    ) -> Result<Released, ActuatorFault>;

    /// Controls that a program that has ended left held are released by the
    /// loop's own sensors, as after a flight, until the plant confirms it:
    /// nothing is sent unless they are held. No effect while this program
    /// controls the plant.
    fn release_left(&self) {}

    /// What a user does at the plant to take control back manually.
    fn by_hand(&self) -> &'static str;
}

/// Learns that control is being taken, for what outlives the program.
pub trait TakeoverNotice: fmt::Debug + Send + Sync {
    /// Control of this plant is taken next: [`held`](ControlAuthority::held)
    /// reports it already, and nothing has been written yet. Called in a tick:
    /// must not wait or allocate.
    fn taking(&self, plant: &PlantId);
}

/// The result of waiting for a release.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Released {
    /// The plant confirmed the release of its controls.
    Confirmed,
    /// The plant no longer exists: there is nothing left to control.
    Unreachable,
    /// The plant's machine reports that no program is there, as a firewall does,
    /// too: the plant has ended, or its controls are still held.
    Refused,
    /// The plant did not answer, or reports that its controls are still held:
    /// it hangs, cannot be reached, or another program holds them.
    Unconfirmed,
    /// The release was cancelled before the plant confirmed it.
    Cancelled,
}

impl Released {
    /// Whether the plant's controls are no longer held.
    pub const fn is_over(self) -> bool {
        matches!(self, Self::Confirmed | Self::Unreachable)
    }
}
