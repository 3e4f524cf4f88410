//! Requests values from X-Plane, and repeats requests for values that do not
//! arrive.
//!
//! Requests get lost, and a restarted X-Plane has lost its subscriptions, so
//! each dataref that does not arrive is requested again. While the simulator is
//! silent, everything is requested each second, and once more as soon as it is
//! heard again. While it answers, a dataref that
//! does not arrive is requested again after one second a few times, since a
//! single request was lost, and then (it may not have it) every
//! [`XPlaneConfig::resubscribe`](crate::XPlaneConfig::resubscribe).
//!
//! Requests are sent in portions (`traffic`), so that X-Plane takes them all.
//! Each value is requested at a rate above X-Plane's usual ones, so that every
//! frame has all of them.

use core::hint::black_box;
use core::time::Duration;

use fcc_core::framework::Time;

use crate::config::{Input, PlantKind, XPlaneConfig};
use crate::engage_switch::{self, NONEXISTENT_DATAREF, NONEXISTENT_INDEX};
use crate::inbox::Inbox;
use crate::missing::{Expected, MissingValues, ValueSet};
use crate::port::Errno;
use crate::protocol::{PathError, rpos, rref};
use crate::quantity::Quantity;
use crate::rows::row_of;
use crate::traffic::{REQUESTS_PER_PORTION, RequestPace};

/// A lost request is repeated after this long, this many times.
const LOST_AFTER: Duration = Duration::from_secs(1);
const LOST_TIMES: u8 = 5;

/// For [`Subscriptions::without_effect`]: no subscription has this index.
const UNUSED_INDEX: i32 = 9_003;
const ANY_DATAREF: &str = "sim/time/paused";

/// The position is for navigation, which does not need it every frame.
const POSITION_RATE_HZ: u16 = 20;

#[derive(Debug)]
enum Request {
    /// A dataref that does not exist: whether X-Plane answers nevertheless.
    Nonexistent(Box<[u8; rref::REQUEST_BYTES]>),
    Value(Quantity, Box<[u8; rref::REQUEST_BYTES]>),
    Position([u8; rpos::REQUEST_BYTES], usize),
}

impl Request {
    fn datagram(&self) -> &[u8] {
        match self {
            Self::Nonexistent(request) | Self::Value(_, request) => request.as_slice(),
            Self::Position(request, length) => request.get(..*length).unwrap_or_default(),
        }
    }

    /// None if no answer is expected.
    const fn expected(&self) -> Option<Expected> {
        match self {
            Self::Nonexistent(_) => None,
            Self::Value(quantity, _) => Some(Expected::Value(*quantity)),
            Self::Position(..) => Some(Expected::Position),
        }
    }
}

/// When an expected value last arrived.
fn arrived(inbox: &Inbox, expected: Expected) -> Time {
    match expected {
        Expected::Value(quantity) => inbox.arrived(quantity),
        Expected::Position => inbox.position_arrived(),
    }
}

#[derive(Debug)]
struct Subscription {
    request: Request,
    asked: Time,
    /// The number of requests since it last arrived.
    unanswered: u8,
    /// To be requested in any case: the simulator is a new one.
    anew: bool,
}

/// The subscriptions, and when each was last requested.
#[derive(Debug)]
pub(crate) struct Subscriptions {
    list: Vec<Subscription>,
    resubscribe: Duration,
    /// After this long a silence, everything is requested again.
    lost_after: Duration,
    restarted: Time,
    /// Whether everything was requested in vain: then some of the requests that
    /// are on their way when the simulator starts again are lost.
    in_vain: bool,
    without_effect: Box<[u8; rref::REQUEST_BYTES]>,
    pace: RequestPace,
    missing_values: MissingValues,
}

impl Subscriptions {
    pub(crate) fn new(config: &XPlaneConfig) -> Result<Self, PathError> {
        let rows = match config.input {
            Input::Rref => None,
            Input::Data(rows) => Some(rows),
        };
        let mut list = Vec::new();
        let mut expected = Vec::new();
        for quantity in Quantity::all() {
            if !quantity.is_asked_of(config.plant) || quantity.is_pilots() && !config.pilot_controls
            {
                continue;
            }
            if let Some(rows) = rows.filter(|_| quantity.comes_in_rows()) {
                let comes = row_of(rows, quantity).map(|_| Expected::Value(quantity));
                expected.extend(comes.filter(|_| quantity.is_needed()));
                continue;
            }
            let Some(path) = quantity.path(&config.engage_switch) else {
                continue;
            };
            let mut request = Box::new([0; rref::REQUEST_BYTES]);
            rref::request(&mut request, config.rate_hz, quantity.index(), &path)?;
            list.push(Subscription::to(Request::Value(quantity, request)));
        }
        let is_board = config.plant == PlantKind::ServoBoard;
        if rows.is_none() && !is_board {
            list.push(Subscription::to(position_request(POSITION_RATE_HZ)));
        }
        let mut without_effect = Box::new([0; rref::REQUEST_BYTES]);
        rref::request(&mut without_effect, 0, UNUSED_INDEX, ANY_DATAREF)?;
        if !is_board && engage_switch::generic_light(&config.engage_switch).is_none() {
            let mut request = Box::new([0; rref::REQUEST_BYTES]);
            rref::request(&mut request, 1, NONEXISTENT_INDEX, NONEXISTENT_DATAREF)?;
            list.push(Subscription::to(Request::Nonexistent(request)));
        }
        let asked = list.iter().filter_map(|asked| asked.request.expected());
        expected.extend(asked.filter(|asked| asked.is_needed_of(config.plant)));
        Ok(Self {
            list,
            resubscribe: config.resubscribe,
            lost_after: config.plant.lost_after(),
            restarted: Time::NEVER,
            in_vain: false,
            without_effect,
            pace: RequestPace::begin(),
            missing_values: MissingValues::new(expected, config.resubscribe),
        })
    }

    /// The values that do not arrive although others do, checked once a second.
    pub(crate) fn missing(&mut self, now: Time, inbox: &Inbox) -> Option<ValueSet> {
        self.missing_values
            .check(now, inbox.last_received(), |expected| {
                arrived(inbox, expected)
            })
    }

    /// Reads the data that [`send_due`](Self::send_due) reads.
    pub(crate) fn warm_up(&self) {
        black_box(
            self.list
                .iter()
                .any(|subscription| subscription.unanswered == u8::MAX && subscription.anew),
        );
    }

    /// Requests everything again, at most once in the time after which it is lost.
    fn restart(&mut self, now: Time) {
        if now.since(self.restarted) >= self.lost_after {
            self.in_vain = !self.restarted.is_never();
            self.restarted = now;
            for subscription in &mut self.list {
                subscription.anew = true;
                subscription.unanswered = 0;
            }
        }
    }

    /// Whether everything was requested again in this tick.
    pub(crate) fn restarted(&self, now: Time) -> bool {
        self.restarted == now
    }

    /// A request that ends a subscription which does not exist.
    pub(crate) fn without_effect(&self) -> &[u8] {
        self.without_effect.as_slice()
    }

    /// Sends the requests that are due, at most a portion. A request that could
    /// not be sent counts as sent and lost.
    pub(crate) fn send_due(
        &mut self,
        now: Time,
        inbox: &Inbox,
        mut send: impl FnMut(&[u8]) -> Result<(), Errno>,
    ) -> Result<(), Errno> {
        let resubscribe = self.resubscribe;
        if now.since(inbox.last_received()) >= self.lost_after {
            self.restart(now);
        } else if self.in_vain {
            self.in_vain = false;
            for subscription in &mut self.list {
                subscription.anew = true;
            }
        }
        let mut outcome = Ok(());
        if !self.pace.is_due(now) {
            return outcome;
        }
        let mut budget = REQUESTS_PER_PORTION;
        for subscription in &mut self.list {
            if budget == 0 {
                break;
            }
            let expected = subscription.request.expected();
            let arrived_at = expected.map_or(Time::NEVER, |expected| arrived(inbox, expected));
            let answered = arrived_at > self.restarted && now.since(arrived_at) < resubscribe;
            if answered && !subscription.anew {
                subscription.unanswered = 0;
                continue;
            }
            let wait = if subscription.unanswered <= LOST_TIMES {
                resubscribe.min(LOST_AFTER)
            } else if expected.is_some() {
                resubscribe
            } else {
                Duration::MAX
            };
            if subscription.anew || now.since(subscription.asked) >= wait {
                subscription.anew = false;
                subscription.asked = now;
                subscription.unanswered = subscription.unanswered.saturating_add(1);
                outcome = outcome.and(send(subscription.request.datagram()));
                budget -= 1;
            }
        }
        if budget < REQUESTS_PER_PORTION {
            self.pace.sent(now);
        }
        outcome
    }

    /// Ends all subscriptions.
    pub(crate) fn end(&self, mut send: impl FnMut(&[u8])) {
        for subscription in &self.list {
            match &subscription.request {
                Request::Nonexistent(request) | Request::Value(_, request) => {
                    let mut request = **request;
                    rref::set_frequency(&mut request, 0);
                    send(request.as_slice());
                }
                Request::Position(..) => send(position_request(0).datagram()),
            }
        }
    }
}

impl Subscription {
    fn to(request: Request) -> Self {
        Self {
            request,
            asked: Time::NEVER,
            unanswered: 0,
            anew: false,
        }
    }
}

fn position_request(frequency_hz: u16) -> Request {
    let mut request = [0; rpos::REQUEST_BYTES];
    let length = rpos::request(&mut request, frequency_hz).len();
    Request::Position(request, length)
}
