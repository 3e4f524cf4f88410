//! Commands from other programs: sends them to the loop, and finds the result
//! of each in the loop's messages.

use std::collections::VecDeque;

use fcc_core::framework::{Controller, EventKind, EventOf, LoopCommand, State};
use fcc_live::{AircraftLimits, FlightCommand, InvalidCommand, PendingCommand, Verdict};
use fcc_runtime::CommandSender;
use fcc_telemetry::describe_event;

/// Commands that were sent and whose outcome is not known yet, oldest first.
pub(super) struct Commands<C: Controller> {
    /// The commands to the loop for one command from outside, in order.
    for_the_loop: fn(&FlightCommand) -> Vec<LoopCommand<C::Command>>,
    limits: AircraftLimits,
    waiting: VecDeque<Waiting<C::Command>>,
}

struct Waiting<R> {
    asked: PendingCommand,
    /// The number of its parts that the loop has not read yet.
    unread: VecDeque<LoopCommand<R>>,
    /// The tick that read the last of it.
    read_in: Option<u64>,
    /// Why it was refused, if it was.
    refusal: Option<String>,
}

impl<C: Controller<Command: PartialEq>> Commands<C> {
    /// Commands to an aircraft with these limits.
    pub(super) const fn new(
        limits: AircraftLimits,
        for_the_loop: fn(&FlightCommand) -> Vec<LoopCommand<C::Command>>,
    ) -> Self {
        Self {
            for_the_loop,
            limits,
            waiting: VecDeque::new(),
        }
    }

    /// Sends a command to the loop; returns the verdict if it is known at once.
    pub(super) fn send(
        &mut self,
        asked: PendingCommand,
        to: &mut CommandSender<C::Command>,
    ) -> Option<(u64, Verdict)> {
        if let Err(invalid) = asked.command.check_for(&self.limits) {
            let verdict = match invalid {
                InvalidCommand::Outside(outside) => Verdict::Outside(outside),
                other => Verdict::Refused(other.to_string()),
            };
            return Some((asked.id, verdict));
        }
        let unread: VecDeque<_> = (self.for_the_loop)(&asked.command).into();
        for command in &unread {
            if let Err(error) = to.send(*command) {
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

    /// Processes an event of the loop; it comes before the record of its tick.
    pub(super) fn event(&mut self, event: &EventOf<C>) {
        match event.kind {
            // The loop reads in the order of sending, and another sender's
            // command matches none that waits here.
            EventKind::CommandReceived(command) => {
                let first = self.waiting.iter_mut().find(|w| w.read_in.is_none());
                if let Some(waiting) = first
                    && waiting.unread.front() == Some(&command)
                {
                    waiting.unread.pop_front();
                    if waiting.unread.is_empty() {
                        waiting.read_in = Some(event.tick);
                    }
                }
            }
            EventKind::EngageRefused { .. } => {
                for waiting in self.waiting.iter_mut().filter(|w| {
                    w.read_in == Some(event.tick) && w.asked.command == FlightCommand::Engage
                }) {
                    waiting.refusal = Some(describe_event::<C>(event, &[], &[]));
                }
            }
            _ => {}
        }
    }

    /// Processes the state after a tick; returns the next verdict that it
    /// permits. Call it again until there is none.
    pub(super) fn verdict(&mut self, now: u64, state: State) -> Option<(u64, Verdict)> {
        let first = self.waiting.front()?;
        let tick = first.read_in.filter(|tick| *tick <= now)?;
        let waiting = self.waiting.pop_front()?;
        let done = match waiting.asked.command {
            command if command.needs_control() => state == State::Engaged,
            FlightCommand::Engage | FlightCommand::Set(_) => state != State::Stopped,
            FlightCommand::Disengage => matches!(state, State::Standby | State::Stopped),
            FlightCommand::Stop => state == State::Stopped,
        };
        let verdict = if done {
            Verdict::CarriedOut { tick }
        } else {
            Verdict::Refused(
                waiting
                    .refusal
                    .unwrap_or_else(|| match waiting.asked.command {
                        FlightCommand::Set(_) => {
                            format!(
                                "the state is {state}: set points are accepted only while engaged"
                            )
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
    use fcc_core::flight::{Autopilot, AutopilotCommand, flags};
    use fcc_core::framework::{Event, Time};
    use fcc_live::NewSetpoints;

    use super::*;

    const HEADING: FlightCommand = FlightCommand::Set(NewSetpoints {
        airspeed_mps: None,
        heading_rad: Some(1.0),
        altitude_m: Some(900.0),
        pressure_altitude_m: None,
        height_m: None,
        altimeter_setting_pa: None,
    });

    fn waiting(commands: &mut Commands<Autopilot>, id: u64, command: FlightCommand) {
        commands.waiting.push_back(Waiting {
            asked: PendingCommand { id, command },
            unread: command.for_the_loop().into(),
            read_in: None,
            refusal: None,
        });
    }

    fn event(tick: u64, kind: EventKind<AutopilotCommand>) -> EventOf<Autopilot> {
        Event {
            tick,
            time: Time::NEVER,
            kind,
        }
    }

    fn commands() -> Commands<Autopilot> {
        let limits = AircraftLimits {
            airspeeds_mps: 30.0..=60.0,
            has_field_elevation: false,
        };
        Commands::new(limits, FlightCommand::for_the_loop)
    }

    #[test]
    fn the_altimeter_is_set_in_standby_and_a_height_needs_a_field() {
        let mut commands = commands();
        let setting = FlightCommand::Set(NewSetpoints {
            altimeter_setting_pa: Some(102_000.0),
            ..NewSetpoints::default()
        });
        waiting(&mut commands, 1, setting);
        let [command] = setting.for_the_loop()[..] else {
            panic!("one command");
        };
        commands.event(&event(5, EventKind::CommandReceived(command)));
        assert_eq!(
            commands.verdict(5, State::Standby),
            Some((1, Verdict::CarriedOut { tick: 5 }))
        );
    }

    #[test]
    fn a_command_is_answered_by_the_record_of_the_tick_that_read_it() {
        let mut commands = commands();
        waiting(&mut commands, 1, FlightCommand::Engage);
        assert_eq!(commands.verdict(4, State::Standby), None);
        commands.event(&event(5, EventKind::CommandReceived(LoopCommand::Engage)));
        assert_eq!(
            commands.verdict(5, State::Engaged),
            Some((1, Verdict::CarriedOut { tick: 5 }))
        );
        assert_eq!(commands.verdict(5, State::Engaged), None);
    }

    #[test]
    fn a_refusal_names_the_engage_inhibits() {
        let mut commands = commands();
        waiting(&mut commands, 1, FlightCommand::Engage);
        commands.event(&event(5, EventKind::CommandReceived(LoopCommand::Engage)));
        let engage_inhibits = flags::TOO_SLOW;
        commands.event(&event(5, EventKind::EngageRefused { engage_inhibits }));
        let Some((1, Verdict::Refused(words))) = commands.verdict(5, State::Standby) else {
            panic!("not refused");
        };
        assert!(words.contains(Autopilot::flag_name(8)), "{words}");
    }

    #[test]
    fn set_points_wait_for_the_last_of_them_and_need_an_engaged_loop() {
        let mut commands = commands();
        waiting(&mut commands, 1, HEADING);
        waiting(&mut commands, 2, HEADING);
        let [heading, altitude] = HEADING.for_the_loop()[..] else {
            panic!("two commands");
        };
        // Another sender's command is not mistaken for one that waits.
        commands.event(&event(
            3,
            EventKind::CommandReceived(LoopCommand::Disengage),
        ));
        commands.event(&event(3, EventKind::CommandReceived(heading)));
        assert_eq!(commands.verdict(3, State::Engaged), None);
        commands.event(&event(4, EventKind::CommandReceived(altitude)));
        let carried_out = Some((1, Verdict::CarriedOut { tick: 4 }));
        assert_eq!(commands.verdict(4, State::Engaged), carried_out);
        commands.event(&event(6, EventKind::CommandReceived(heading)));
        commands.event(&event(6, EventKind::CommandReceived(altitude)));
        let Some((2, Verdict::Refused(words))) = commands.verdict(6, State::Standby) else {
            panic!("not refused");
        };
        assert!(
            words.contains("standby") && words.contains("while engaged"),
            "{words}"
        );
    }
}
