//! Who is in control (`development.xml`: `CONTROL_STATUS`, `REQUEST_OPERATOR_CONTROL`).
//!
//! As long as nobody has asked for control, every station may command, and so may the page.

use mavlink::dialects::common::MavResult;

use crate::command::Refusal;
use crate::effects::Peer;
use crate::frame::Body;
use crate::message::id;
use crate::vehicle::Now;

/// A station that is not heard for so long has lost control, ms.
const LOST_MS: u64 = 10_000;
/// `GCS_CONTROL_STATUS_FLAGS`.
const SYSTEM_MANAGER: u8 = 1;
const TAKEOVER_ALLOWED: u8 = 2;
/// Of `CONTROL_STATUS`.
const EXTRA_CRC: u8 = 21;

/// The owner of control.
#[derive(Debug, Default)]
pub(crate) struct Control {
    owner: Option<Owner>,
    /// Somebody has asked for it: from then on it is told.
    is_used: bool,
}

#[derive(Clone, Copy, Debug)]
struct Owner {
    system: u8,
    allows_takeover: bool,
    heard_ms: u64,
}

impl Control {
    /// Whether a station may command.
    pub(crate) fn permits(&self, peer: Peer) -> bool {
        self.owner.is_none_or(|owner| owner.system == peer.system)
    }

    /// The system number of the owner.
    pub(crate) fn owner(&self) -> Option<u8> {
        self.owner.map(|owner| owner.system)
    }

    /// `REQUEST_OPERATOR_CONTROL`.
    pub(crate) fn request(
        &mut self,
        peer: Peer,
        (takes, takeover): (bool, bool),
        now: Now,
    ) -> Result<(), Refusal> {
        self.is_used = true;
        let may_take = self.permits(peer) || self.owner.is_some_and(|owner| owner.allows_takeover);
        if !may_take {
            let why = format!(
                "station {} is in control: it has to release it",
                self.owner().unwrap_or(0)
            );
            return Err((MavResult::MAV_RESULT_FAILED, why));
        }
        if takes {
            self.owner = Some(Owner {
                system: peer.system,
                allows_takeover: takeover,
                heard_ms: now.ms,
            });
        } else if self.permits(peer) {
            self.owner = None;
        }
        Ok(())
    }

    /// A heartbeat of a station.
    pub(crate) fn hear(&mut self, peer: Peer, now: Now) {
        if let Some(owner) = self
            .owner
            .as_mut()
            .filter(|owner| owner.system == peer.system)
        {
            owner.heard_ms = now.ms;
        }
    }

    /// An owner that is not heard any more; returns it once.
    pub(crate) fn lost(&mut self, now: Now) -> Option<u8> {
        let lost = self
            .owner
            .take_if(|owner| now.ms >= owner.heard_ms + LOST_MS)?;
        Some(lost.system)
    }

    /// `CONTROL_STATUS`, once control was asked for: parsers of the dialect `common` do not
    /// know it.
    pub(crate) fn status(&self) -> Option<Body> {
        let flags = match self.owner {
            Some(owner) if !owner.allows_takeover => SYSTEM_MANAGER,
            _ => SYSTEM_MANAGER | TAKEOVER_ALLOWED,
        };
        let owner = self.owner().unwrap_or(0);
        let payload = [flags, owner];
        self.is_used
            .then(|| Body::raw(id::CONTROL_STATUS, EXTRA_CRC, &payload))
    }
}
