//! An event as a message.

use fcc_core::flight::guidance::Targets;
use fcc_core::flight::{Order as Command, Resume, Surfaces};
use fcc_core::framework::{
    ActuatorFault, Event, EventKind, Flags, Order, SensorFault, Stage, Time,
};

use super::fcc::event::Kind;
use super::fcc::fault::Kind as FaultKind;
use super::fcc::order::Order as WireOrder;
use super::record::{state_in, state_out};
use super::{Unknown, fcc};
use crate::FlightEvent;

/// An event as a message, with its words for people.
pub(crate) fn encode(event: &FlightEvent, text: String) -> fcc::Event {
    fcc::Event {
        tick: event.tick,
        time_ns: event.time.as_nanos(),
        text,
        kind: kind_out(&event.kind),
    }
}

/// The event in a message.
pub(crate) fn decode(event: &fcc::Event) -> Result<FlightEvent, Unknown> {
    Ok(Event {
        tick: event.tick,
        time: Time::from_nanos(event.time_ns),
        kind: kind_in(event.kind.ok_or(Unknown("the kind of an event"))?)?,
    })
}

/// None for a kind that came to the loop and not to the schema.
fn kind_out(kind: &EventKind<Command>) -> Option<Kind> {
    let gap = |count, first, last| fcc::Gap { count, first, last };
    Some(match *kind {
        EventKind::StateChanged { from, to } => Kind::StateChanged(fcc::StateChanged {
            from: Some(state_out(from.into())),
            to: Some(state_out(to.into())),
        }),
        EventKind::Ordered(order) => Kind::Ordered(fcc::Order {
            order: Some(order_out(order)?),
        }),
        EventKind::ToldToStop => Kind::ToldToStop(fcc::ToldToStop {}),
        EventKind::EngageRefused { blockers } => Kind::EngageRefused(fcc::EngageRefused {
            blockers: blockers.bits(),
        }),
        EventKind::SensorFault { index, fault } => {
            let (kind, errno) = match fault {
                SensorFault::Silent => (FaultKind::Silent, 0),
                SensorFault::Io { errno } => (FaultKind::Io, errno),
                SensorFault::Malformed => (FaultKind::Malformed, 0),
                _ => return None,
            };
            Kind::SensorFault(fault_out(index, kind, errno))
        }
        EventKind::ActuatorFault { index, fault } => {
            let (kind, errno) = match fault {
                ActuatorFault::Io { errno } => (FaultKind::Io, errno),
                ActuatorFault::Unconfirmed => (FaultKind::Unconfirmed, 0),
                ActuatorFault::NotConnected => (FaultKind::NotConnected, 0),
                _ => return None,
            };
            Kind::ActuatorFault(fault_out(index, kind, errno))
        }
        EventKind::SensorRecovered { index } => Kind::SensorRecovered(fcc::Recovered {
            index: index.into(),
        }),
        EventKind::ActuatorRecovered { index } => Kind::ActuatorRecovered(fcc::Recovered {
            index: index.into(),
        }),
        EventKind::RecordsDropped { count, first, last } => {
            Kind::RecordsDropped(gap(count, first, last))
        }
        EventKind::EventsDropped { count, first, last } => {
            Kind::EventsDropped(gap(count, first, last))
        }
        EventKind::NotRecorded { count, first, last } => Kind::NotRecorded(gap(count, first, last)),
        EventKind::Released { ok } => Kind::Released(fcc::Released { ok }),
        EventKind::Panicked => Kind::Panicked(fcc::Panicked {}),
        EventKind::TimerFailed => Kind::TimerFailed(fcc::TimerFailed {}),
        EventKind::Overrun {
            of,
            took_ns,
            budget_ns,
            longest,
        } => Kind::Overrun(fcc::Overrun {
            of: i32::from(of as u8),
            took_ns,
            budget_ns,
            longest: i32::from(longest as u8),
        }),
        EventKind::OverrunsOver { count, first, last } => {
            Kind::OverrunsOver(gap(count, first, last))
        }
        EventKind::Hung { silent_ns } => Kind::Hung(fcc::Hung { silent_ns }),
        _ => return None,
    })
}

fn kind_in(kind: Kind) -> Result<EventKind<Command>, Unknown> {
    Ok(match kind {
        Kind::StateChanged(changed) => EventKind::StateChanged {
            from: state_in(changed.from.unwrap_or_default())?.state(),
            to: state_in(changed.to.unwrap_or_default())?.state(),
        },
        Kind::Ordered(order) => EventKind::Ordered(order_in(order)?),
        Kind::ToldToStop(_) => EventKind::ToldToStop,
        Kind::EngageRefused(refused) => EventKind::EngageRefused {
            blockers: Flags::from_bits(refused.blockers),
        },
        Kind::SensorFault(fault) => EventKind::SensorFault {
            index: index_in(fault.index)?,
            fault: match fault.kind() {
                FaultKind::Silent => SensorFault::Silent,
                FaultKind::Io => SensorFault::Io { errno: fault.errno },
                FaultKind::Malformed => SensorFault::Malformed,
                _ => return Err(Unknown("a sensor's fault")),
            },
        },
        Kind::ActuatorFault(fault) => EventKind::ActuatorFault {
            index: index_in(fault.index)?,
            fault: match fault.kind() {
                FaultKind::Io => ActuatorFault::Io { errno: fault.errno },
                FaultKind::Unconfirmed => ActuatorFault::Unconfirmed,
                FaultKind::NotConnected => ActuatorFault::NotConnected,
                _ => return Err(Unknown("an actuator's fault")),
            },
        },
        Kind::SensorRecovered(recovered) => EventKind::SensorRecovered {
            index: index_in(recovered.index)?,
        },
        Kind::ActuatorRecovered(recovered) => EventKind::ActuatorRecovered {
            index: index_in(recovered.index)?,
        },
        Kind::RecordsDropped(fcc::Gap { count, first, last }) => {
            EventKind::RecordsDropped { count, first, last }
        }
        Kind::EventsDropped(fcc::Gap { count, first, last }) => {
            EventKind::EventsDropped { count, first, last }
        }
        Kind::NotRecorded(fcc::Gap { count, first, last }) => {
            EventKind::NotRecorded { count, first, last }
        }
        Kind::Released(released) => EventKind::Released { ok: released.ok },
        Kind::Panicked(_) => EventKind::Panicked,
        Kind::TimerFailed(_) => EventKind::TimerFailed,
        Kind::Overrun(overrun) => EventKind::Overrun {
            of: stage_in(overrun.of)?,
            took_ns: overrun.took_ns,
            budget_ns: overrun.budget_ns,
            longest: stage_in(overrun.longest)?,
        },
        Kind::OverrunsOver(fcc::Gap { count, first, last }) => {
            EventKind::OverrunsOver { count, first, last }
        }
        Kind::Hung(fcc::Hung { silent_ns }) => EventKind::Hung { silent_ns },
    })
}

fn fault_out(index: u16, kind: FaultKind, errno: i32) -> fcc::Fault {
    fcc::Fault {
        index: index.into(),
        kind: kind.into(),
        errno,
    }
}

fn index_in(index: u32) -> Result<u16, Unknown> {
    u16::try_from(index).map_err(|_| Unknown("a sensor's or an actuator's place"))
}

fn stage_in(number: i32) -> Result<Stage, Unknown> {
    u8::try_from(number)
        .ok()
        .and_then(Stage::from_number)
        .ok_or(Unknown("a stage of a tick"))
}

fn order_out(order: Order<Command>) -> Option<WireOrder> {
    Some(match order {
        Order::Engage => WireOrder::Engage(fcc::Engage {}),
        Order::Disengage => WireOrder::Disengage(fcc::Disengage {}),
        Order::Stop => WireOrder::Stop(fcc::Stop {}),
        Order::Controller(Command::Airspeed(mps)) => WireOrder::AirspeedMps(mps),
        Order::Controller(Command::Heading(rad)) => WireOrder::HeadingRad(rad),
        Order::Controller(Command::Altitude(m)) => WireOrder::AltitudeM(m),
        Order::Controller(Command::Resume(resume)) => WireOrder::Resume(resume_out(&resume)),
        Order::Controller(_) => return None,
    })
}

fn order_in(order: fcc::Order) -> Result<Order<Command>, Unknown> {
    Ok(match order.order.ok_or(Unknown("an order"))? {
        WireOrder::Engage(_) => Order::Engage,
        WireOrder::Disengage(_) => Order::Disengage,
        WireOrder::Stop(_) => Order::Stop,
        WireOrder::AirspeedMps(mps) => Order::Controller(Command::Airspeed(mps)),
        WireOrder::HeadingRad(rad) => Order::Controller(Command::Heading(rad)),
        WireOrder::AltitudeM(m) => Order::Controller(Command::Altitude(m)),
        WireOrder::Resume(resume) => Order::Controller(Command::Resume(resume_in(&resume))),
    })
}

fn resume_out(resume: &Resume) -> fcc::Resume {
    fcc::Resume {
        airspeed_mps: resume.targets.airspeed_mps,
        heading_rad: resume.targets.heading_rad,
        altitude_m: resume.targets.altitude_m,
        pattern_s: resume.pattern_s,
        throttle: resume.surfaces.throttle,
        elevator: resume.surfaces.elevator,
        aileron: resume.surfaces.aileron,
        rudder: resume.surfaces.rudder,
    }
}

fn resume_in(resume: &fcc::Resume) -> Resume {
    Resume {
        targets: Targets {
            airspeed_mps: resume.airspeed_mps,
            heading_rad: resume.heading_rad,
            altitude_m: resume.altitude_m,
        },
        pattern_s: resume.pattern_s,
        surfaces: Surfaces {
            throttle: resume.throttle,
            elevator: resume.elevator,
            aileron: resume.aileron,
            rudder: resume.rudder,
        },
    }
}
