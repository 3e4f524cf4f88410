//! Commands that are prepared before they are sent: another flight plan.

use fcc_core::framework::{Event, EventKind, EventOf, LoopCommand, Notice, State, Time};
use fcc_fixed_wing::{Autopilot, AutopilotCommand, COMMAND_ANSWER, PlanReplacement};
use fcc_telemetry::{Command, PendingCommand, SentCommands, Verdict};

fn event(tick: u64, kind: EventKind<AutopilotCommand>) -> EventOf<Autopilot> {
    Event {
        tick,
        time: Time::NEVER,
        kind,
    }
}

/// The loop refuses it by a notice of the tick that read it.
#[test]
fn a_prepared_command_is_answered_by_the_notice_of_its_tick() {
    let command = AutopilotCommand::ReplacePlan(PlanReplacement::default());
    let replace = || Command::ReplacePlan {
        file: "/a.plan".to_owned(),
        item: 1,
    };
    let read = EventKind::CommandReceived(LoopCommand::Controller(command));
    for (amount_permille, is_refused) in [(0, false), (6_000, true)] {
        let mut commands = SentCommands::<Autopilot>::new(Vec::new());
        let asked = PendingCommand {
            sender: String::new(),
            id: 1,
            command: replace(),
        };
        assert_eq!(commands.send_prepared(asked, command, |_| Ok(())), None);
        commands.event(&event(5, read));
        let notice = Notice {
            kind: COMMAND_ANSWER,
            amount_permille,
            item: 1,
            ..Notice::default()
        };
        commands.event(&event(5, EventKind::Noticed(notice)));
        match commands.verdict(5, State::Engaged) {
            Some((1, Verdict::CarriedOut { tick: 5 })) => assert!(!is_refused),
            Some((1, Verdict::Refused(why))) => {
                assert!(
                    is_refused && why.contains("the aircraft is landing"),
                    "{why}"
                );
            }
            other => panic!("{other:?}"),
        }
        // Not engaged it is not sent, and never unprepared.
        assert_eq!(commands.verdict(6, State::Standby), None);
        let asked = || PendingCommand {
            sender: String::new(),
            id: 2,
            command: replace(),
        };
        let sent = commands.send_prepared(asked(), command, |_| panic!("not to be sent"));
        assert!(matches!(sent, Some((2, Verdict::Refused(_)))), "{sent:?}");
        let sent = commands.send(asked(), |_| panic!("not to be sent"));
        assert!(matches!(sent, Some((2, Verdict::Refused(_)))), "{sent:?}");
    }
}

/// So are set points and modes; what does not change what is flown is carried out.
#[test]
fn a_refused_mode_is_answered_with_the_reason() {
    for (name, value, is_refused) in [("go_around", 1.0, true), ("heartbeat_s", 5.0, false)] {
        let mut commands = SentCommands::<Autopilot>::new(Vec::new());
        let command = Command::set([(name, value)]);
        let parts = command.for_the_loop::<Autopilot>(&Vec::new()).unwrap();
        let asked = PendingCommand {
            id: 1,
            sender: String::new(),
            command,
        };
        assert_eq!(commands.send(asked, |_| Ok(())), None);
        for part in parts {
            commands.event(&event(5, EventKind::CommandReceived(part)));
        }
        let notice = Notice {
            kind: COMMAND_ANSWER,
            amount_permille: 9_000,
            ..Notice::default()
        };
        commands.event(&event(5, EventKind::Noticed(notice)));
        match commands.verdict(5, State::Engaged) {
            Some((1, Verdict::CarriedOut { .. })) => assert!(!is_refused),
            Some((1, Verdict::Refused(why))) => {
                assert!(
                    is_refused && why.contains("the aircraft is not landing"),
                    "{why}"
                );
            }
            other => panic!("{other:?}"),
        }
    }
}
