//! Commands from other programs: sends them to the loop, and finds the result
//! of each in the loop's messages.

use std::collections::VecDeque;
use std::ops::RangeInclusive;

use crate::describe_event;
use fcc_core::framework::{EventKind, EventOf, LoopCommand, State};

use super::{Command, Commandable, InvalidCommand, PendingCommand, PlantLimits, Verdict};

/// Commands that were sent and whose outcome is not known yet, oldest first.
#[derive(Debug)]
pub struct SentCommands<C: Commandable> {
    limits: PlantLimits,
    waiting: VecDeque<Waiting<C::Command>>,
    /// After the last tick; none before the first.
    state: Option<State>,
}

#[derive(Debug)]
struct Waiting<R> {
    asked: PendingCommand,
    /// The number of its parts that the loop has not read yet.
    unread: VecDeque<LoopCommand<R>>,
    /// Whether the controller may refuse it.
    may_be_refused: bool,
    /// The tick that read the last of it.
    read_in: Option<u64>,
    /// Why it was refused, if it was.
    refusal: Option<String>,
}

impl<C: Commandable> SentCommands<C> {
    /// None yet, for a plant with these limits.
    pub const fn new(limits: PlantLimits) -> Self {
        Self {
            limits,
            waiting: VecDeque::new(),
            state: None,
        }
    }

    /// Sends a command to the loop by `send`, which returns why it could not;
    /// returns the verdict if it is known at once.
    pub fn send(
        &mut self,
        asked: PendingCommand,
        send: impl FnMut(LoopCommand<C::Command>) -> Result<(), String>,
    ) -> Option<(u64, Verdict)> {
        let unread = match asked.command.for_the_loop::<C>(&self.limits) {
            Ok(commands) => VecDeque::from(commands),
            Err(InvalidCommand::Outside(outside)) => {
                return Some((asked.id, Verdict::Outside(outside)));
            }
            Err(invalid) => return Some((asked.id, Verdict::Refused(invalid.to_string()))),
        };
        self.dispatch(asked, unread, send)
    }

    /// As [`send`](Self::send), of a command that was prepared: read and checked.
    pub fn send_prepared(
        &mut self,
        asked: PendingCommand,
        command: C::Command,
        send: impl FnMut(LoopCommand<C::Command>) -> Result<(), String>,
    ) -> Option<(u64, Verdict)> {
        let unread = VecDeque::from([LoopCommand::Controller(command)]);
        self.dispatch(asked, unread, send)
    }

    /// Other limits of a set point from now on.
    pub fn limit(&mut self, name: &'static str, limits: RangeInclusive<f64>) {
        self.limits.retain(|(known, _)| *known != name);
        self.limits.push((name, Ok(limits)));
    }

    fn dispatch(
        &mut self,
        asked: PendingCommand,
        unread: VecDeque<LoopCommand<C::Command>>,
        mut send: impl FnMut(LoopCommand<C::Command>) -> Result<(), String>,
    ) -> Option<(u64, Verdict)> {
        let ends_flight = matches!(asked.command, Command::Disengage | Command::Stop);
        if self.is_stopping() && !ends_flight {
            return Some((asked.id, Verdict::Refused("it is stopping".to_owned())));
        }
        // Before any part of it is carried out.
        if let Some(state) = self.state.filter(|state| *state != State::Engaged)
            && matches!(asked.command, Command::Set(_) | Command::ReplacePlan { .. })
            && asked.command.needs_control::<C>()
            && !self.is_to_be_engaged()
        {
            return Some((asked.id, Verdict::Refused(only_engaged(state))));
        }
        for command in &unread {
            if let Err(why) = send(*command) {
                return Some((asked.id, Verdict::Refused(why)));
            }
        }
        let may_be_refused = unread.iter().any(|command| match command {
            LoopCommand::Controller(command) => C::may_refuse(command),
            _ => false,
        });
        self.waiting.push_back(Waiting {
            asked,
            unread,
            may_be_refused,
            read_in: None,
            refusal: None,
        });
        None
    }

    /// Whether a command to engage was sent whose outcome is not known yet.
    fn is_to_be_engaged(&self) -> bool {
        let mut waiting = self.waiting.iter();
        waiting.any(|waiting| waiting.asked.command == Command::Engage)
    }

    /// Whether a stop was sent: it waits here until the loop has stopped.
    fn is_stopping(&self) -> bool {
        let mut waiting = self.waiting.iter();
        waiting.any(|waiting| waiting.asked.command == Command::Stop)
    }

    /// Processes an event of the loop; it comes before the record of its tick.
    pub fn event(&mut self, event: &EventOf<C>) {
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
            EventKind::EngageRefused { .. } | EventKind::EngageRefusedBySwitch => {
                for waiting in self
                    .waiting
                    .iter_mut()
                    .filter(|w| w.read_in == Some(event.tick) && w.asked.command == Command::Engage)
                {
                    waiting.refusal = Some(describe_event::<C>(event, &[], &[]));
                }
            }
            EventKind::Noticed(notice) => {
                let Some(refusal) = C::refusal(&notice) else {
                    return;
                };
                for waiting in self
                    .waiting
                    .iter_mut()
                    .filter(|waiting| waiting.read_in == Some(event.tick) && waiting.may_be_refused)
                {
                    waiting.refusal = Some(refusal.to_owned());
                }
            }
            _ => {}
        }
    }

    /// Processes the state after a tick; returns the next verdict that it
    /// permits. Call it again until there is none.
    pub fn verdict(&mut self, now: u64, state: State) -> Option<(u64, Verdict)> {
        self.state = Some(state);
        // The loop may prepare the plant for its release before it stops;
        // commands that were sent later are answered meanwhile.
        let at = self.waiting.iter().position(|waiting| {
            waiting.read_in.is_some_and(|tick| tick <= now)
                && (waiting.asked.command != Command::Stop || state == State::Stopped)
        })?;
        let waiting = self.waiting.remove(at)?;
        let tick = match waiting.asked.command {
            Command::Stop => now,
            _ => waiting.read_in?,
        };
        let is_refused = waiting.refusal.is_some();
        let done = match &waiting.asked.command {
            Command::Set(_) | Command::ReplacePlan { .. } if is_refused => false,
            command if command.needs_control::<C>() => state == State::Engaged,
            Command::Engage | Command::Set(_) | Command::ReplacePlan { .. } => {
                state != State::Stopped
            }
            Command::Disengage => matches!(state, State::Standby | State::Stopped),
            Command::Stop => true,
        };
        let verdict = if done {
            Verdict::CarriedOut { tick }
        } else {
            Verdict::Refused(
                waiting
                    .refusal
                    .unwrap_or_else(|| match waiting.asked.command {
                        Command::Set(_) => only_engaged(state),
                        _ => format!("the state is {state}"),
                    }),
            )
        };
        Some((waiting.asked.id, verdict))
    }
}

fn only_engaged(state: State) -> String {
    format!("the state is {state}: this command is accepted only while engaged")
}

#[cfg(all(test, feature = "flight"))]
mod tests {
    use fcc_core::framework::{Cause, Controller, Event, Time};
    use fcc_fixed_wing::{Autopilot, AutopilotCommand, flags};

    use super::*;

    fn heading() -> Command {
        Command::set([("heading_rad", 1.0), ("altitude_m", 900.0)])
    }

    fn waiting(commands: &mut SentCommands<Autopilot>, id: u64, command: Command) {
        let known = commands.send(
            PendingCommand {
                id,
                sender: String::new(),
                command,
            },
            |_| Ok(()),
        );
        assert_eq!(known, None);
    }

    fn event(tick: u64, kind: EventKind<AutopilotCommand>) -> EventOf<Autopilot> {
        Event {
            tick,
            time: Time::NEVER,
            kind,
        }
    }

    fn commands() -> SentCommands<Autopilot> {
        SentCommands::new(vec![("airspeed_mps", Ok(30.0..=60.0))])
    }

    #[test]
    fn the_altimeter_is_set_in_standby() {
        let mut commands = commands();
        let setting = Command::set([("altimeter_setting_pa", 102_000.0)]);
        waiting(&mut commands, 1, setting);
        let command = LoopCommand::Controller(AutopilotCommand::AltimeterSetting(102_000.0));
        commands.event(&event(5, EventKind::CommandReceived(command)));
        assert_eq!(
            commands.verdict(5, State::Standby),
            Some((1, Verdict::CarriedOut { tick: 5 }))
        );
    }

    #[test]
    fn a_command_is_answered_by_the_record_of_the_tick_that_read_it() {
        let mut commands = commands();
        waiting(&mut commands, 1, Command::Engage);
        assert_eq!(commands.verdict(4, State::Standby), None);
        commands.event(&event(5, EventKind::CommandReceived(LoopCommand::Engage)));
        assert_eq!(
            commands.verdict(5, State::Engaged),
            Some((1, Verdict::CarriedOut { tick: 5 }))
        );
        assert_eq!(commands.verdict(5, State::Engaged), None);
    }

    #[test]
    fn a_stop_is_answered_when_the_loop_has_stopped_and_nothing_begins_before() {
        for state in [State::Engaged, State::Failsafe(Cause::Overrun)] {
            let mut commands = commands();
            assert_eq!(commands.verdict(1, state), None);
            waiting(&mut commands, 1, Command::Stop);
            let stop = EventKind::CommandReceived(LoopCommand::Stop);
            commands.event(&event(5, stop));
            // It levels and trims.
            assert_eq!(commands.verdict(5, state), None);
            for command in [Command::Engage, heading()] {
                let sent = commands.send(
                    PendingCommand {
                        id: 2,
                        sender: String::new(),
                        command,
                    },
                    |_| panic!("not to be sent"),
                );
                let refused = Verdict::Refused("it is stopping".to_owned());
                assert_eq!(sent, Some((2, refused)));
            }
            // What gives control back earlier is not made to wait.
            waiting(&mut commands, 3, Command::Disengage);
            let disengage = EventKind::CommandReceived(LoopCommand::Disengage);
            commands.event(&event(9, disengage));
            let carried_out = |id, tick| Some((id, Verdict::CarriedOut { tick }));
            assert_eq!(commands.verdict(9, State::Standby), carried_out(3, 9));
            assert_eq!(commands.verdict(10, State::Stopped), carried_out(1, 10));
            assert_eq!(commands.verdict(10, State::Stopped), None);
        }
    }

    #[test]
    fn a_refusal_names_the_engage_inhibits() {
        let mut commands = commands();
        waiting(&mut commands, 1, Command::Engage);
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
        waiting(&mut commands, 1, heading());
        waiting(&mut commands, 2, heading());
        let both = heading().for_the_loop::<Autopilot>(&Vec::new()).unwrap();
        let [heading, altitude] = both[..] else {
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

    #[test]
    fn an_altimeter_setting_may_be_refused_and_a_heartbeat_not() {
        use fcc_core::framework::Notice;
        use fcc_fixed_wing::COMMAND_ANSWER;

        let mut commands = commands();
        let setting = Command::set([("altimeter_setting_pa", 95_000.0)]);
        waiting(&mut commands, 1, setting);
        waiting(&mut commands, 2, Command::set([("heartbeat_s", 5.0)]));
        for command in [
            AutopilotCommand::AltimeterSetting(95_000.0),
            AutopilotCommand::Heartbeat(5.0),
        ] {
            let read = EventKind::CommandReceived(LoopCommand::Controller(command));
            commands.event(&event(3, read));
        }
        let answer = Notice {
            kind: COMMAND_ANSWER,
            amount_permille: 1_000,
            ..Notice::default()
        };
        commands.event(&event(3, EventKind::Noticed(answer)));
        let first = commands.verdict(3, State::Engaged);
        assert!(matches!(first, Some((1, Verdict::Refused(_)))), "{first:?}");
        let carried_out = Some((2, Verdict::CarriedOut { tick: 3 }));
        assert_eq!(commands.verdict(3, State::Engaged), carried_out);
    }

    #[test]
    fn of_a_command_that_is_refused_no_part_is_sent() {
        let mut commands = commands();
        let both = || Command::set([("altimeter_setting_pa", 103_300.0), ("altitude_m", 900.0)]);
        assert_eq!(commands.verdict(1, State::Standby), None);
        let mut parts = 0;
        let mut ask = |commands: &mut SentCommands<Autopilot>, id, command| {
            let sent = commands.send(
                PendingCommand {
                    id,
                    sender: String::new(),
                    command,
                },
                |_| {
                    parts += 1;
                    Ok(())
                },
            );
            (sent, parts)
        };
        let (Some((1, Verdict::Refused(words))), 0) = ask(&mut commands, 1, both()) else {
            panic!("not refused, or sent");
        };
        assert!(words.contains("while engaged"), "{words}");
        // Once a command to engage was sent, or the loop is engaged, it is sent.
        assert_eq!(ask(&mut commands, 2, Command::Engage), (None, 1));
        assert_eq!(ask(&mut commands, 3, both()), (None, 3));
        commands.event(&event(5, EventKind::CommandReceived(LoopCommand::Engage)));
        let engaged = Some((2, Verdict::CarriedOut { tick: 5 }));
        assert_eq!(commands.verdict(5, State::Engaged), engaged);
        assert_eq!(ask(&mut commands, 4, both()), (None, 5));
    }

    #[test]
    fn what_cannot_be_sent_is_refused_at_once() {
        let mut commands = commands();
        let mut known = |command, sent: Result<(), String>| {
            commands.send(
                PendingCommand {
                    id: 1,
                    sender: String::new(),
                    command,
                },
                |_| sent.clone(),
            )
        };
        let full = Err("full".to_owned());
        let refused = Some((1, Verdict::Refused("full".to_owned())));
        assert_eq!(known(Command::Stop, full), refused);
        let fast = known(Command::set([("airspeed_mps", 61.0)]), Ok(()));
        let Some((1, Verdict::Outside(outside))) = fast else {
            panic!("not refused");
        };
        assert_eq!((outside.value, outside.most), (61.0, 60.0));
        let other = known(Command::set([("room_c", 21.0)]), Ok(()));
        assert!(matches!(other, Some((1, Verdict::Refused(_)))));
    }
}
