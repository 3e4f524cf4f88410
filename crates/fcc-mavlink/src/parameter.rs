//! Parameters (mavlink.io, "Parameter Protocol"): all are numbers, sent as `float`.

use mavlink::dialects::common::{
    MavMessage, MavParamError, MavParamType, MavSeverity, PARAM_ERROR_DATA, PARAM_VALUE_DATA,
};
use mavlink::types::CharArray;

use fcc_telemetry::Command;

use crate::effects::{Effects, Peer};
use crate::frame::{Body, Fields};
use crate::vehicle::LinkId;
use crate::vehicle::{Action, Now, Outcome};

type Error = MavParamError;

/// `PARAM_ERROR`.
fn error(peer: Peer, (param_index, param_id): (i16, CharArray<16>), error: Error) -> Body {
    Body::from(MavMessage::PARAM_ERROR(PARAM_ERROR_DATA {
        param_index,
        target_system: peer.system,
        target_component: peer.component,
        param_id,
        error,
    }))
}

/// A parameter.
#[derive(Clone, PartialEq, Debug)]
pub struct Parameter {
    /// Its name: at most 16 capital letters, digits and `_`.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// Where it is from and which values it may have: for who may not change it.
    pub origin: String,
    /// What changes it in flight, if that is possible: a set point, by its name, and how much
    /// of it one unit of the parameter is.
    pub setpoint: Option<(&'static str, f64)>,
}

/// Lists that are being sent at the same time.
const MOST_LISTS: usize = 8;
const NO_INDEX: u16 = u16::MAX;

/// The parameters, and who is reading them.
#[derive(Debug, Default)]
pub(crate) struct Parameters {
    all: Vec<Parameter>,
    /// Links that get all of them, and the next one for each.
    lists: Vec<(LinkId, usize)>,
    /// A value that the vehicle is taking.
    setting: Option<(u32, Peer, usize, f64)>,
}

impl Parameters {
    pub(crate) fn set_all(&mut self, all: Vec<Parameter>) {
        self.all = all;
    }

    /// `PARAM_REQUEST_LIST`: from the first one on, however often it is asked.
    pub(crate) fn read_all(&mut self, peer: Peer) {
        self.lists.retain(|(link, _)| *link != peer.link);
        if self.lists.len() < MOST_LISTS {
            self.lists.push((peer.link, 0));
        }
    }

    /// The next one of a list that a link is getting.
    pub(crate) fn next(&mut self, link: LinkId) -> Option<Body> {
        let at = self.lists.iter().position(|(to, _)| *to == link)?;
        let (_, next) = self.lists.get_mut(at)?;
        let index = *next;
        *next += 1;
        let body = self.body(index, index as u16);
        if body.is_none() {
            self.lists.remove(at);
        }
        body
    }

    fn body(&self, index: usize, shown_index: u16) -> Option<Body> {
        let parameter = self.all.get(index)?;
        Some(Body::from(MavMessage::PARAM_VALUE(PARAM_VALUE_DATA {
            param_value: parameter.value as f32,
            param_count: self.all.len() as u16,
            param_index: shown_index,
            param_id: CharArray::from(parameter.name),
            param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
        })))
    }

    fn by_name(&self, name: &[u8]) -> Option<usize> {
        let end = name.iter().position(|byte| *byte == 0);
        let name = name.get(..end.unwrap_or(name.len()))?;
        self.all
            .iter()
            .position(|parameter| parameter.name.as_bytes() == name)
    }

    /// `PARAM_REQUEST_READ`: by number or name.
    pub(crate) fn read(&self, peer: Peer, fields: &Fields, fx: &mut Effects) {
        let index = match usize::try_from(fields.i16(0)) {
            Ok(index) => Some(index),
            Err(_) => self.by_name(&fields.bytes::<16>(4)),
        };
        match index.and_then(|index| self.body(index, index as u16)) {
            Some(body) => fx.answer(peer, body),
            None => fx.answer(
                peer,
                error(
                    peer,
                    (fields.i16(0), CharArray::new(fields.bytes(4))),
                    Error::MAV_PARAM_ERROR_DOES_NOT_EXIST,
                ),
            ),
        }
    }

    /// `PARAM_SET`: the answer is the value that holds then.
    pub(crate) fn set(
        &mut self,
        peer: Peer,
        may: bool,
        fields: &Fields,
        now: Now,
        fx: &mut Effects,
    ) {
        let name = fields.bytes::<16>(6);
        let found = self
            .by_name(&name)
            .and_then(|index| Some((index, self.all.get(index)?)));
        let Some((index, parameter)) = found else {
            let unknown = error(
                peer,
                (-1, CharArray::new(name)),
                Error::MAV_PARAM_ERROR_DOES_NOT_EXIST,
            );
            return fx.answer(peer, unknown);
        };
        let value = f64::from(fields.f32(0));
        let refusal = match parameter.setpoint {
            _ if !may => "another station is in control",
            None => &parameter.origin,
            Some(_) if self.setting.is_some() => "another one is being set: try again",
            Some((name, unit)) => {
                let command = Command::set([(name, value * unit)]);
                let action = Action::Commands(vec![command]);
                let ticket = fx.request(peer, action, now);
                self.setting = Some((ticket, peer, index, value));
                return;
            }
        };
        let text = format!("{} is not changed: {refusal}", parameter.name);
        let code = match parameter.setpoint {
            _ if !may => Error::MAV_PARAM_ERROR_PERMISSION_DENIED,
            None => Error::MAV_PARAM_ERROR_READ_ONLY,
            Some(_) => Error::MAV_PARAM_ERROR_READ_FAIL,
        };
        self.answer(peer, index, fx);
        fx.answer(peer, error(peer, (-1, CharArray::new(name)), code));
        fx.tell(peer, MavSeverity::MAV_SEVERITY_WARNING, &text);
    }

    fn answer(&self, peer: Peer, index: usize, fx: &mut Effects) {
        if let Some(body) = self.body(index, NO_INDEX) {
            fx.answer(peer, body);
        }
    }

    /// The vehicle has taken the value, or refused it; whether the ticket was one of here.
    pub(crate) fn finish(&mut self, ticket: u32, outcome: &Outcome, fx: &mut Effects) -> bool {
        let Some((_, peer, index, value)) = self.setting.take_if(|setting| setting.0 == ticket)
        else {
            return false;
        };
        match (outcome, self.all.get_mut(index)) {
            (Ok(_), Some(parameter)) => parameter.value = value,
            (Err(why), Some(parameter)) => {
                let name = CharArray::from(parameter.name);
                let code = Error::MAV_PARAM_ERROR_VALUE_OUT_OF_RANGE;
                fx.answer(peer, error(peer, (-1, name), code));
                fx.tell(peer, MavSeverity::MAV_SEVERITY_WARNING, why);
            }
            _ => {}
        }
        self.answer(peer, index, fx);
        true
    }

    /// A link has ended.
    pub(crate) fn forget(&mut self, link: LinkId) {
        self.lists.retain(|(to, _)| *to != link);
    }
}
