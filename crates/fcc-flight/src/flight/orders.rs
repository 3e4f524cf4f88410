//! Orders from other programs: sends them to the loop, and sees in what the
//! loop tells what became of each.

use std::collections::VecDeque;

use fcc_core::flight::Order as Command;
use fcc_core::framework::{EventKind, Order, State};
use fcc_runtime::OrderSender;
use fcc_telemetry::live::{Asked, FlightOrder, Verdict};
use fcc_telemetry::{FlightEvent, FlightRecord, event_words};

/// Orders that were sent and whose outcome is not known yet, oldest first.
#[derive(Debug, Default)]
pub(super) struct Orders {
    waiting: VecDeque<Waiting>,
}

#[derive(Debug)]
struct Waiting {
    asked: Asked,
    /// What the loop has not read of it.
    unread: VecDeque<Order<Command>>,
    /// The tick that read the last of it.
    read_in: Option<u64>,
    /// Why it was refused, if it was.
    refusal: Option<String>,
}

impl Orders {
    /// Sends an order to the loop; the verdict if it is known at once.
    pub(super) fn send(
        &mut self,
        asked: Asked,
        to: &mut OrderSender<Command>,
    ) -> Option<(u64, Verdict)> {
        let unread: VecDeque<_> = asked.order.for_the_loop().into();
        for order in &unread {
            if let Err(error) = to.send(*order) {
                return Some((asked.id, Verdict::Refused(error.to_string())));
            }
        }
        self.waiting.push_back(Waiting {
            asked,
            unread,
            read_in: None,
            refusal: None,
        });
        None
    }

    /// Takes an event of the loop; it comes before the record of its tick.
    pub(super) fn event(&mut self, event: &FlightEvent) {
        match event.kind {
            // The loop reads in the sequence of sending, and somebody else's
            // order is none that waits here.
            EventKind::Ordered(order) => {
                let first = self.waiting.iter_mut().find(|w| w.read_in.is_none());
                if let Some(waiting) = first
                    && waiting.unread.front() == Some(&order)
                {
                    waiting.unread.pop_front();
                    if waiting.unread.is_empty() {
                        waiting.read_in = Some(event.tick);
                    }
                }
            }
            EventKind::EngageRefused { .. } => {
                for waiting in self.waiting.iter_mut().filter(|w| {
                    w.read_in == Some(event.tick) && w.asked.order == FlightOrder::Engage
                }) {
                    waiting.refusal = Some(event_words(event, &[], &[]));
                }
            }
            _ => {}
        }
    }

    /// Takes the record of a tick; the next verdict that it allows. To be
    /// asked again until there is none.
    pub(super) fn verdict(&mut self, record: &FlightRecord) -> Option<(u64, Verdict)> {
        let first = self.waiting.front()?;
        let tick = first.read_in.filter(|tick| *tick <= record.tick.number)?;
        let state = record.state.state();
        let waiting = self.waiting.pop_front()?;
        let done = match waiting.asked.order {
            FlightOrder::Engage | FlightOrder::Set(_) => state == State::Engaged,
            FlightOrder::Disengage => matches!(state, State::Standby | State::Stopped),
            FlightOrder::Stop => state == State::Stopped,
        };
        let verdict = if done {
            Verdict::CarriedOut { tick }
        } else {
            Verdict::Refused(
                waiting
                    .refusal
                    .unwrap_or_else(|| match waiting.asked.order {
                        FlightOrder::Set(_) => {
                            format!("the state is {state}: set points are taken while engaged")
                        }
                        _ => format!("the state is {state}"),
                    }),
            )
        };
        Some((waiting.asked.id, verdict))
    }
}

#[cfg(test)]
mod tests {
    use fcc_core::flight::{Autopilot, flags};
    use fcc_core::framework::{Controller, Event, Record, Tick, Time};
    use fcc_telemetry::live::NewSetpoints;

    use super::*;

    const HEADING: FlightOrder = FlightOrder::Set(NewSetpoints {
        airspeed_mps: None,
        heading_rad: Some(1.0),
        altitude_m: Some(900.0),
    });

    fn waiting(orders: &mut Orders, id: u64, order: FlightOrder) {
        orders.waiting.push_back(Waiting {
            asked: Asked { id, order },
            unread: order.for_the_loop().into(),
            read_in: None,
            refusal: None,
        });
    }

    fn event(tick: u64, kind: EventKind<Command>) -> FlightEvent {
        Event {
            tick,
            time: Time::NEVER,
            kind,
        }
    }

    fn record(number: u64, state: State) -> FlightRecord {
        let tick = Tick {
            number,
            ..Tick::default()
        };
        Record::new(tick, state)
    }

    #[test]
    fn an_order_is_answered_by_the_record_of_the_tick_that_read_it() {
        let mut orders = Orders::default();
        waiting(&mut orders, 1, FlightOrder::Engage);
        assert_eq!(orders.verdict(&record(4, State::Standby)), None);
        orders.event(&event(5, EventKind::Ordered(Order::Engage)));
        assert_eq!(
            orders.verdict(&record(5, State::Engaged)),
            Some((1, Verdict::CarriedOut { tick: 5 }))
        );
        assert_eq!(orders.verdict(&record(5, State::Engaged)), None);
    }

    #[test]
    fn a_refusal_says_what_blocks() {
        let mut orders = Orders::default();
        waiting(&mut orders, 1, FlightOrder::Engage);
        orders.event(&event(5, EventKind::Ordered(Order::Engage)));
        let blockers = flags::TOO_SLOW;
        orders.event(&event(5, EventKind::EngageRefused { blockers }));
        let Some((1, Verdict::Refused(words))) = orders.verdict(&record(5, State::Standby)) else {
            panic!("not refused");
        };
        assert!(words.contains(Autopilot::flag_name(8)), "{words}");
    }

    #[test]
    fn set_points_wait_for_the_last_of_them_and_need_an_engaged_loop() {
        let mut orders = Orders::default();
        waiting(&mut orders, 1, HEADING);
        waiting(&mut orders, 2, HEADING);
        let [heading, altitude] = HEADING.for_the_loop()[..] else {
            panic!("two orders");
        };
        // Somebody else's order is not mistaken for one that waits.
        orders.event(&event(3, EventKind::Ordered(Order::Disengage)));
        orders.event(&event(3, EventKind::Ordered(heading)));
        assert_eq!(orders.verdict(&record(3, State::Engaged)), None);
        orders.event(&event(4, EventKind::Ordered(altitude)));
        let carried_out = Some((1, Verdict::CarriedOut { tick: 4 }));
        assert_eq!(orders.verdict(&record(4, State::Engaged)), carried_out);
        orders.event(&event(6, EventKind::Ordered(heading)));
        orders.event(&event(6, EventKind::Ordered(altitude)));
        let Some((2, Verdict::Refused(words))) = orders.verdict(&record(6, State::Standby)) else {
            panic!("not refused");
        };
        assert!(
            words.contains("standby") && words.contains("while engaged"),
            "{words}"
        );
    }
}
