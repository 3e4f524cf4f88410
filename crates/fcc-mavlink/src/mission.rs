//! Missions, fences and rally points: transactions of whole lists (mavlink.io, "Mission
//! Protocol").
//!
//! One list is received at a time. When it is complete and can be read, the vehicle gets the
//! plan that it makes with the other two lists; only when the vehicle has that plan, the
//! list counts. Until then, and after any error, everything is as it was.

use std::sync::Arc;

use fcc_plan::{Home, Place, Plan, limits};
use mavlink::dialects::common::{MavMissionResult, MavSeverity, MissionState};

use crate::effects::{Effects, Peer};
use crate::frame::Body;
use crate::item::{MissionItem, Part, Refused, lists, opaque_id, put};
use crate::vehicle::{Action, LinkId, Now, Outcome, Position, VehicleState};

type Code = MavMissionResult;
type Items = Arc<[MissionItem]>;

/// An item that did not come is asked for again after this time, ms (mavlink.io).
const ITEM_MS: u64 = 250;
/// While the vehicle takes a plan, the last item is asked for again, ms: stations wait 1.5 s
/// for an answer.
const ALIVE_MS: u64 = 1_000;
/// A sender that is silent for so long has given up, ms.
const SILENT_MS: u64 = 10_000;
/// Stations that read a list at the same time.
const MOST_READERS: usize = 8;
/// `MAV_MISSION_TYPE_ALL`.
const ALL: u8 = 255;
/// The home of a plan is used for the next one within this distance, m.
const SAME_FIELD_M: f64 = 2_000.0;
/// Mean radius of the earth (IUGG), m.
const EARTH_M: f64 = 6_371_009.0;

#[derive(Clone, Debug, Default)]
struct List {
    items: Items,
    opaque_id: u32,
}

/// The lists of the vehicle, and transfers of them.
#[derive(Debug, Default)]
pub(crate) struct Missions {
    lists: [List; 3],
    /// The vehicle's plan, and its hash.
    plan: Plan,
    hash: u64,
    /// The vehicle has a plan, and its content is not known.
    is_unknown: bool,
    /// The item that is flown first when control is taken, from 0, and the last one that was
    /// flown: another mode goes on with it.
    start: u16,
    last: u16,
    upload: Option<Upload>,
    /// The end of the last upload, in case its answer is lost.
    ended: Option<(Peer, Part, u16, Code)>,
    readers: Vec<Reader>,
}

/// A list that is being received.
#[derive(Debug)]
struct Upload {
    peer: Peer,
    part: Part,
    /// All that are known: of a partial list, the others, too.
    items: Vec<MissionItem>,
    /// The item that is expected, and the first that is not.
    next: u16,
    end: u16,
    asked_ms: u64,
    heard_ms: u64,
    /// It is complete, and the vehicle takes it.
    taken: Option<Taken>,
}

#[derive(Debug)]
struct Taken {
    ticket: u32,
    plan: Plan,
}

/// A station that reads a list sees it as it was when it began.
#[derive(Debug)]
struct Reader {
    peer: Peer,
    part: Part,
    items: Items,
    heard_ms: u64,
}

impl Missions {
    /// The vehicle has another plan than this one knows; none: its content is not known.
    pub(crate) fn set_plan(&mut self, hash: u64, plan: Option<&Plan>) {
        let is_unknown = hash != 0 && plan.is_none();
        let plan = plan.cloned().unwrap_or_default();
        let items = lists(&plan).map(Items::from);
        self.keep(hash, plan, items);
        self.is_unknown = is_unknown;
    }

    /// The newest state of the vehicle.
    pub(crate) const fn note(&mut self, state: &VehicleState) {
        self.last = match state.flight.item.checked_sub(1) {
            _ if !state.flight.is_engaged => self.start,
            Some(item) => item,
            None => self.last,
        };
    }

    /// Why there is no mission here.
    pub(crate) const fn why_none(&self) -> &'static str {
        if self.is_unknown {
            "the vehicle's plan was not uploaded here, and is not known: upload one"
        } else {
            "there is no mission: upload one"
        }
    }

    pub(crate) const fn hash(&self) -> u64 {
        self.hash
    }

    fn keep(&mut self, hash: u64, plan: Plan, items: [Items; 3]) {
        for ((list, items), part) in self.lists.iter_mut().zip(items).zip(Part::ALL) {
            *list = List {
                opaque_id: if items.is_empty() {
                    0
                } else {
                    opaque_id(&plan, part)
                },
                items,
            };
        }
        (self.start, self.last) = (0, 0);
        self.is_unknown = false;
        self.hash = hash;
        self.plan = plan;
    }

    pub(crate) fn opaque_ids(&self) -> [u32; 3] {
        self.lists.each_ref().map(|list| list.opaque_id)
    }

    pub(crate) fn total(&self) -> u16 {
        let [mission, ..] = &self.lists;
        mission.items.len() as u16
    }

    /// The item that is flown, or would be first, from 0.
    pub(crate) const fn current(&self, state: &VehicleState) -> u16 {
        match state.flight.item.checked_sub(1) {
            Some(item) if state.flight.is_engaged => item,
            _ if state.flight.is_engaged => self.last,
            _ => self.start,
        }
    }

    /// Chooses the item that is flown first.
    pub(crate) const fn set_start(&mut self, item: u16) {
        self.start = item;
    }

    pub(crate) fn state(&self, state: &VehicleState) -> MissionState {
        if self.is_unknown {
            MissionState::MISSION_STATE_UNKNOWN
        } else if self.total() == 0 {
            MissionState::MISSION_STATE_NO_MISSION
        } else if !state.flight.is_engaged {
            MissionState::MISSION_STATE_NOT_STARTED
        } else if state.flies_mission() {
            MissionState::MISSION_STATE_ACTIVE
        } else {
            MissionState::MISSION_STATE_PAUSED
        }
    }

    fn list(&self, part: Part) -> &List {
        let [mission, fence, rally] = &self.lists;
        match part {
            Part::Mission => mission,
            Part::Fence => fence,
            Part::Rally => rally,
        }
    }

    /// The part of a message; one that is not known is answered.
    fn part(peer: Peer, number: u8, fx: &mut Effects) -> Option<Part> {
        let part = Part::of(number);
        if part.is_none() {
            fx.answer(peer, ack(peer, number, Code::MAV_MISSION_UNSUPPORTED, 0));
        }
        part
    }

    /// `MISSION_REQUEST_LIST`.
    pub(crate) fn read_list(&mut self, peer: Peer, number: u8, now: Now, fx: &mut Effects) {
        let Some(part) = Self::part(peer, number, fx) else {
            return;
        };
        if self.is_unknown {
            let why = self.why_none().to_owned();
            return refuse(peer, number, &(Code::MAV_MISSION_ERROR, why), fx);
        }
        let list = self.list(part).clone();
        self.readers
            .retain(|reader| reader.peer != peer && now.ms < reader.heard_ms + SILENT_MS);
        if self.readers.len() >= MOST_READERS {
            self.readers.remove(0);
        }
        fx.answer(peer, count(peer, part, &list));
        self.readers.push(Reader {
            peer,
            part,
            items: list.items,
            heard_ms: now.ms,
        });
    }

    /// `MISSION_REQUEST_INT`, and `MISSION_REQUEST`, which is answered the same.
    pub(crate) fn read_item(
        &mut self,
        peer: Peer,
        (number, seq): (u8, u16),
        state: &VehicleState,
        now: Now,
        fx: &mut Effects,
    ) {
        let Some(part) = Self::part(peer, number, fx) else {
            return;
        };
        let held = Arc::clone(&self.list(part).items);
        let is_its = |reader: &&mut Reader| reader.peer == peer && reader.part == part;
        let items = self.readers.iter_mut().find(is_its).map_or(held, |reader| {
            reader.heard_ms = now.ms;
            Arc::clone(&reader.items)
        });
        let is_current = part == Part::Mission && seq == self.current(state);
        match items.get(usize::from(seq)) {
            Some(item) => fx.answer(peer, item.body(peer, seq, is_current, part)),
            None => fx.answer(
                peer,
                ack(peer, number, Code::MAV_MISSION_INVALID_SEQUENCE, 0),
            ),
        }
    }

    /// `MISSION_ACK`: the end of a list that was read, or a sender gives up.
    pub(crate) fn acknowledged(&mut self, peer: Peer) {
        self.readers.retain(|reader| reader.peer != peer);
        self.upload
            .take_if(|upload| upload.peer == peer && upload.taken.is_none());
    }

    /// A link has ended: what it was sending does not come any more.
    pub(crate) fn close(&mut self, link: LinkId) {
        self.readers.retain(|reader| reader.peer.link != link);
        self.upload
            .take_if(|upload| upload.peer.link == link && upload.taken.is_none());
    }

    /// `MISSION_COUNT`.
    pub(crate) fn begin(
        &mut self,
        peer: Peer,
        (number, count): (u8, u16),
        state: &VehicleState,
        now: Now,
        fx: &mut Effects,
    ) {
        let Some(part) = Self::part(peer, number, fx) else {
            return;
        };
        if !self.may_begin(peer, number, fx) {
            return;
        }
        if usize::from(count) > limits::ITEMS {
            let text = format!("{count} items: at most {} are stored", limits::ITEMS);
            return refuse(peer, number, &(Code::MAV_MISSION_NO_SPACE, text), fx);
        }
        self.receive(peer, part, (Vec::new(), 0, count), now, fx);
        if count == 0 {
            self.complete(state, now, fx);
        }
    }

    /// `MISSION_WRITE_PARTIAL_LIST`: some items of the list that the vehicle has.
    pub(crate) fn begin_partial(
        &mut self,
        peer: Peer,
        (number, start, last): (u8, i16, i16),
        now: Now,
        fx: &mut Effects,
    ) {
        let Some(part) = Self::part(peer, number, fx) else {
            return;
        };
        if !self.may_begin(peer, number, fx) {
            return;
        }
        let items = self.list(part).items.to_vec();
        let count = items.len() as u16;
        let range = u16::try_from(start).ok().zip(u16::try_from(last).ok());
        match range {
            // MAVProxy counts one too many.
            Some((start, last)) if start <= last && last <= count && start < count => {
                self.receive(peer, part, (items, start, count.min(last + 1)), now, fx);
            }
            _ => {
                let text = format!("items {start} to {last}: the list has {}", items.len());
                refuse(
                    peer,
                    number,
                    &(Code::MAV_MISSION_INVALID_SEQUENCE, text),
                    fx,
                );
            }
        }
    }

    /// `MISSION_CLEAR_ALL`.
    pub(crate) fn clear(
        &mut self,
        peer: Peer,
        number: u8,
        state: &VehicleState,
        now: Now,
        fx: &mut Effects,
    ) {
        // Sent again while the vehicle clears it.
        let is_its = |upload: &Upload| {
            let is_clear = upload.end == 0 && upload.taken.is_some();
            is_clear && upload.peer == peer && upload.part as u8 == number
        };
        if self.upload.as_ref().is_some_and(is_its) {
            return;
        }
        if number != ALL {
            return self.begin(peer, (number, 0), state, now, fx);
        }
        if !self.may_begin(peer, number, fx) {
            return;
        }
        let done = self.forget(state);
        match done {
            Ok(()) => fx.answer(peer, ack(peer, number, Code::MAV_MISSION_ACCEPTED, 0)),
            Err(refused) => refuse(peer, number, &refused, fx),
        }
    }

    /// Without any list: nothing of the plan before is flown any more.
    fn forget(&mut self, state: &VehicleState) -> Result<(), Refused> {
        if state.flight.is_engaged {
            let text = "in flight a mission is not cleared: upload another one".to_owned();
            return Err((Code::MAV_MISSION_DENIED, text));
        }
        self.keep(self.hash, self.plan.clone(), Default::default());
        Ok(())
    }

    /// Whether another list may be received now.
    fn may_begin(&mut self, peer: Peer, number: u8, fx: &mut Effects) -> bool {
        let is_busy = self
            .upload
            .as_ref()
            .is_some_and(|upload| upload.peer != peer || upload.taken.is_some());
        if is_busy {
            let text = "another plan is being received: try again".to_owned();
            refuse(peer, number, &(Code::MAV_MISSION_DENIED, text), fx);
        }
        !is_busy
    }

    fn receive(
        &mut self,
        peer: Peer,
        part: Part,
        (items, next, end): (Vec<MissionItem>, u16, u16),
        now: Now,
        fx: &mut Effects,
    ) {
        self.ended = None;
        let upload = Upload {
            peer,
            part,
            items,
            next,
            end,
            asked_ms: now.ms,
            heard_ms: now.ms,
            taken: None,
        };
        if next < end {
            fx.answer(peer, upload.request(next));
        }
        self.upload = Some(upload);
    }

    /// `MISSION_ITEM_INT`.
    pub(crate) fn item(
        &mut self,
        peer: Peer,
        number: u8,
        (seq, item): (u16, MissionItem),
        state: &VehicleState,
        now: Now,
        fx: &mut Effects,
    ) {
        let Some(upload) = self.upload.as_mut().filter(|upload| upload.peer == peer) else {
            return self.answer_again(peer, number, seq, fx);
        };
        upload.heard_ms = now.ms;
        if upload.taken.is_some() || upload.part as u8 != number || seq < upload.next {
            return;
        }
        if seq == upload.next {
            match upload.items.get_mut(usize::from(seq)) {
                Some(old) => *old = item,
                None => upload.items.push(item),
            }
            upload.next += 1;
        }
        if upload.next == upload.end {
            return self.complete(state, now, fx);
        }
        upload.asked_ms = now.ms;
        let request = upload.request(upload.next);
        fx.answer(peer, request);
    }

    /// The answer to the last item was lost.
    fn answer_again(&self, peer: Peer, number: u8, seq: u16, fx: &mut Effects) {
        let Some((to, part, end, code)) = self.ended else {
            return;
        };
        if to == peer && part as u8 == number && seq.checked_add(1) == Some(end) {
            fx.answer(peer, ack(peer, number, code, self.list(part).opaque_id));
        }
    }

    /// All items are here: the vehicle is to take them.
    fn complete(&mut self, state: &VehicleState, now: Now, fx: &mut Effects) {
        let Some(upload) = self.upload.take() else {
            return;
        };
        match self.plan_with(&upload, state) {
            Err(refused) => self.end(&upload, Err(refused), fx),
            Ok(None) => self.end(&upload, Ok(None), fx),
            Ok(Some(plan)) => {
                let action = Action::Plan {
                    plan: Box::new(plan.clone()),
                    item: self.first_item(&plan, state),
                };
                let ticket = fx.request(upload.peer, action, now);
                self.upload = Some(Upload {
                    taken: Some(Taken { ticket, plan }),
                    asked_ms: now.ms,
                    ..upload
                });
            }
        }
    }

    /// The vehicle's next plan; none: there is nothing that it has to know.
    fn plan_with(&self, upload: &Upload, state: &VehicleState) -> Result<Option<Plan>, Refused> {
        let mut plan = Plan {
            home: self.home(state),
            ..self.plan.clone()
        };
        for part in Part::ALL {
            let held = &self.list(part).items;
            let list: &[MissionItem] = if part == upload.part {
                &upload.items
            } else {
                held
            };
            // Of a list that is as the vehicle has it, nothing is lost.
            if part == upload.part || list.is_empty() {
                put(&mut plan, part, list)?;
            }
        }
        if upload.part == Part::Mission {
            plan.cruise_mps = None;
        }
        if plan.items.is_empty() {
            if state.flight.is_engaged {
                let text = if self.is_unknown {
                    self.why_none()
                } else {
                    "in flight a mission is not cleared: upload another one"
                };
                return Err((Code::MAV_MISSION_DENIED, text.to_owned()));
            }
            return Ok(None);
        }
        if !state.is_connected {
            let text = "there is no fccd that could take it: start it".to_owned();
            return Err((Code::MAV_MISSION_ERROR, text));
        }
        let is_held = self.list(upload.part).items[..] == upload.items[..];
        // In standby the same mission begins anew, on its runway.
        let is_begun = upload.part != Part::Mission || state.flight.is_engaged;
        let is_flown_now = self.total() > 0 && is_held && is_begun;
        Ok((!is_flown_now).then_some(plan))
    }

    /// That of the plan before, if the aircraft is near it; or where it stands.
    fn home(&self, state: &VehicleState) -> Option<Home> {
        let place_of = |position: Position| Place {
            latitude_deg: position.latitude_rad.to_degrees(),
            longitude_deg: position.longitude_rad.to_degrees(),
        };
        // Of a plan that is not known here, too.
        let shown = state.home.map(|home| Home {
            place: place_of(home),
            altitude_m: home.altitude_m,
        });
        let known = self.plan.home.or(shown);
        let stands = !state.flight.is_engaged && !state.flight.is_airborne;
        let Some(position) = state.motion.position.filter(|_| stands) else {
            return known;
        };
        let place = place_of(position);
        let is_near = |home: &Home| distance_m(home.place, place) < SAME_FIELD_M;
        if known.as_ref().is_some_and(is_near) {
            return known;
        }
        Some(Home {
            place,
            altitude_m: position.altitude_m,
        })
    }

    /// Another fence does not begin the mission anew.
    fn first_item(&self, plan: &Plan, state: &VehicleState) -> u16 {
        let is_same = plan.items == self.plan.items;
        if is_same && state.flight.is_engaged {
            state.flight.item.max(1)
        } else {
            1
        }
    }

    /// The vehicle has taken the plan, or refused it; whether the ticket was one of here.
    pub(crate) fn finish(&mut self, ticket: u32, outcome: &Outcome, fx: &mut Effects) -> bool {
        let is_its = |upload: &mut Upload| {
            let taken = upload.taken.as_ref();
            taken.is_some_and(|taken| taken.ticket == ticket)
        };
        let Some(mut upload) = self.upload.take_if(is_its) else {
            return false;
        };
        let plan = upload.taken.take().map(|taken| taken.plan);
        let result = match outcome {
            Ok(hash) => Ok(plan.map(|plan| (*hash, plan))),
            Err(why) => Err((Code::MAV_MISSION_DENIED, why.clone())),
        };
        self.end(&upload, result, fx);
        true
    }

    /// The transaction ends: with its list, or as before.
    fn end(
        &mut self,
        upload: &Upload,
        result: Result<Option<(u64, Plan)>, Refused>,
        fx: &mut Effects,
    ) {
        let (peer, part) = (upload.peer, upload.part);
        let code = match result {
            Ok(taken) => {
                let mut items = self.lists.each_ref().map(|list| Arc::clone(&list.items));
                if let Some(list) = items.get_mut(part as usize) {
                    *list = upload.items.clone().into();
                }
                let (hash, plan) = taken.unwrap_or_else(|| self.without_vehicle(upload));
                self.keep(hash, plan, items);
                let opaque_id = self.list(part).opaque_id;
                fx.answer(
                    peer,
                    ack(peer, part as u8, Code::MAV_MISSION_ACCEPTED, opaque_id),
                );
                Code::MAV_MISSION_ACCEPTED
            }
            Err(refused) => {
                refuse(peer, part as u8, &refused, fx);
                refused.0
            }
        };
        self.ended = Some((peer, part, upload.end, code));
    }

    /// The plan of lists that the vehicle gets with the next mission.
    fn without_vehicle(&self, upload: &Upload) -> (u64, Plan) {
        let mut plan = self.plan.clone();
        // It was read before without a problem.
        let _ = put(&mut plan, upload.part, &upload.items);
        (self.hash, plan)
    }

    /// Asks again for what did not come, and gives up.
    pub(crate) fn step(&mut self, now: Now, fx: &mut Effects) {
        let Some(upload) = &mut self.upload else {
            return;
        };
        let is_taken = upload.taken.is_some();
        if !is_taken && now.ms >= upload.heard_ms + SILENT_MS {
            let (peer, part) = (upload.peer, upload.part as u8);
            self.upload = None;
            let text = "the items did not arrive: the plan is as before".to_owned();
            return refuse(
                peer,
                part,
                &(Code::MAV_MISSION_OPERATION_CANCELLED, text),
                fx,
            );
        }
        let (every_ms, seq) = if is_taken {
            (ALIVE_MS, upload.end.saturating_sub(1))
        } else {
            (ITEM_MS, upload.next)
        };
        if now.ms >= upload.asked_ms + every_ms && upload.end > 0 {
            upload.asked_ms = now.ms;
            fx.answer(upload.peer, upload.request(seq));
        }
    }
}

impl Upload {
    /// `MISSION_REQUEST_INT`.
    fn request(&self, seq: u16) -> Body {
        let mut payload = seq.to_le_bytes().to_vec();
        payload.extend(self.peer.address());
        payload.push(self.part as u8);
        Body::raw(51, 196, &payload)
    }
}

/// `MISSION_COUNT`.
fn count(peer: Peer, part: Part, list: &List) -> Body {
    let mut payload = (list.items.len() as u16).to_le_bytes().to_vec();
    payload.extend(peer.address());
    payload.push(part as u8);
    payload.extend(list.opaque_id.to_le_bytes());
    Body::raw(44, 221, &payload)
}

/// `MISSION_ACK`.
fn ack(peer: Peer, number: u8, code: Code, opaque_id: u32) -> Body {
    let mut payload = peer.address().to_vec();
    payload.extend([code as u8, number]);
    payload.extend(opaque_id.to_le_bytes());
    Body::raw(47, 153, &payload)
}

/// Another station is in control.
pub(crate) fn denied(peer: Peer, number: u8) -> Body {
    ack(peer, number, Code::MAV_MISSION_DENIED, 0)
}

fn refuse(peer: Peer, number: u8, (code, why): &Refused, fx: &mut Effects) {
    fx.answer(peer, ack(peer, number, *code, 0));
    fx.tell(peer, MavSeverity::MAV_SEVERITY_WARNING, why);
}

/// On a sphere, which is enough to tell fields apart.
fn distance_m(a: Place, b: Place) -> f64 {
    let north = (b.latitude_deg - a.latitude_deg).to_radians();
    let east = (b.longitude_deg - a.longitude_deg).to_radians() * a.latitude_deg.to_radians().cos();
    EARTH_M * north.hypot(east)
}
