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
/// Within this time a command is promised to an engaged vehicle while a station is in
/// control, s, and so often the promise is renewed, ms. It ends with this program, too.
const PROMISE_S: f64 = 60.0;
const RENEW_MS: u64 = 30_000;
/// The promise of a station that is lost, s: it is not kept.
const BROKEN_S: f64 = 0.1;
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
    /// For whom the vehicle was promised a command, and when.
    promised: Option<(Peer, u64)>,
    /// The owner did not release control, but is not heard.
    is_lost: bool,
}

#[derive(Clone, Copy, Debug)]
struct Owner {
    peer: Peer,
    allows_takeover: bool,
    heard_ms: u64,
}

impl Control {
    /// Whether a station may command.
    pub(crate) fn permits(&self, peer: Peer) -> bool {
        self.owner
            .is_none_or(|owner| owner.peer.system == peer.system)
    }

    /// The system number of the owner.
    pub(crate) fn owner(&self) -> Option<u8> {
        self.owner.map(|owner| owner.peer.system)
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
            self.is_lost = false;
            self.owner = Some(Owner {
                peer,
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
            .filter(|owner| owner.peer.system == peer.system)
        {
            owner.heard_ms = now.ms;
        }
    }

    /// An owner that is not heard any more; returns it once.
    pub(crate) fn lost(&mut self, now: Now) -> Option<u8> {
        let lost = self
            .owner
            .take_if(|owner| now.ms >= owner.heard_ms + LOST_MS)?;
        self.is_lost = true;
        Some(lost.peer.system)
    }

    /// Within which time, s, the vehicle is to get a command from now on, and for whom; 0: no
    /// more. What it does if none comes is its contingency.
    pub(crate) fn promise(&mut self, is_engaged: bool, now: Now) -> Option<(Peer, f64)> {
        let owner = self.owner.filter(|_| is_engaged);
        match (owner, self.promised) {
            (Some(_), Some((_, at_ms))) if now.ms < at_ms + RENEW_MS => None,
            (Some(owner), _) => {
                self.promised = Some((owner.peer, now.ms));
                Some((owner.peer, PROMISE_S))
            }
            (None, Some((peer, _))) => {
                self.promised = None;
                let is_broken = is_engaged && self.is_lost;
                Some((peer, if is_broken { BROKEN_S } else { 0.0 }))
            }
            (None, None) => None,
        }
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
