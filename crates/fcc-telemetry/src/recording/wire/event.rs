//! An event as a message.

use fcc_core::flight::guidance::Targets;
use fcc_core::flight::{AutopilotCommand, Resume, Surfaces};
use fcc_core::framework::{
    ActuatorFault, Event, EventKind, Flags, LoopCommand, SensorFault, Stage, Time,
};

use super::fcc::command::Command as WireCommand;
use super::fcc::event::Kind;
use super::fcc::fault::Kind as FaultKind;
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
fn kind_out(kind: &EventKind<AutopilotCommand>) -> Option<Kind> {
    let gap = |count, first, last| fcc::Gap { count, first, last };
    Some(match *kind {
        EventKind::StateChanged { from, to } => Kind::StateChanged(fcc::StateChanged {
            from: Some(state_out(from.into())),
            to: Some(state_out(to.into())),
        }),
        EventKind::CommandReceived(command) => Kind::Ordered(fcc::Command {
            command: Some(command_out(command)?),
        }),
        EventKind::StopRequested => Kind::StopRequested(fcc::StopRequested {}),
        EventKind::EngageRefused { engage_inhibits } => Kind::EngageRefused(fcc::EngageRefused {
            engage_inhibits: engage_inhibits.bits(),
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

fn kind_in(kind: Kind) -> Result<EventKind<AutopilotCommand>, Unknown> {
    Ok(match kind {
        Kind::StateChanged(changed) => EventKind::StateChanged {
            from: state_in(changed.from.unwrap_or_default())?.state(),
            to: state_in(changed.to.unwrap_or_default())?.state(),
        },
        Kind::Ordered(command) => EventKind::CommandReceived(command_in(command)?),
        Kind::StopRequested(_) => EventKind::StopRequested,
        Kind::EngageRefused(refused) => EventKind::EngageRefused {
            engage_inhibits: Flags::from_bits(refused.engage_inhibits),
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

fn command_out(command: LoopCommand<AutopilotCommand>) -> Option<WireCommand> {
    Some(match command {
        LoopCommand::Engage => WireCommand::Engage(fcc::Engage {}),
        LoopCommand::Disengage => WireCommand::Disengage(fcc::Disengage {}),
        LoopCommand::Stop => WireCommand::Stop(fcc::Stop {}),
        LoopCommand::Controller(AutopilotCommand::Airspeed(mps)) => WireCommand::AirspeedMps(mps),
        LoopCommand::Controller(AutopilotCommand::Heading(rad)) => WireCommand::HeadingRad(rad),
        LoopCommand::Controller(AutopilotCommand::Altitude(m)) => WireCommand::AltitudeM(m),
        LoopCommand::Controller(AutopilotCommand::Resume(resume)) => {
            WireCommand::Resume(resume_out(&resume))
        }
        LoopCommand::Controller(_) => return None,
    })
}

fn command_in(command: fcc::Command) -> Result<LoopCommand<AutopilotCommand>, Unknown> {
    Ok(match command.command.ok_or(Unknown("a command"))? {
        WireCommand::Engage(_) => LoopCommand::Engage,
        WireCommand::Disengage(_) => LoopCommand::Disengage,
        WireCommand::Stop(_) => LoopCommand::Stop,
        WireCommand::AirspeedMps(mps) => LoopCommand::Controller(AutopilotCommand::Airspeed(mps)),
        WireCommand::HeadingRad(rad) => LoopCommand::Controller(AutopilotCommand::Heading(rad)),
        WireCommand::AltitudeM(m) => LoopCommand::Controller(AutopilotCommand::Altitude(m)),
        WireCommand::Resume(resume) => {
            LoopCommand::Controller(AutopilotCommand::Resume(resume_in(&resume)))
        }
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
