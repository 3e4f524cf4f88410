//! The report on a run, the screen that watches one, and commands from other
//! programs: what is declared of the values is enough.

use std::path::Path;

use fcc_live::{
    Commandable, CommandableSetpoint, Info, PublisherOf, RecorderState, RecorderStatus,
    SentCommands, Text,
};
use fcc_record::Recording;
use fcc_report::{Report, Reported, Survey, Terms};
use fcc_runtime::{CommandSender, Message, MessageOf, Parts};
use fcc_telemetry::{Instance, describe_event};
use fcc_top::Watched;

use crate::thermostat::Thermostat;

impl Reported for Thermostat {
    type Addition = ();

    const TERMS: Terms = Terms {
        run: "run",
        plant: "Plant",
        controller: "thermostat",
    };
}

impl Watched for Thermostat {
    const PROGRAM: &'static str = "thermostat";
}

impl Commandable for Thermostat {
    const SETPOINTS: &'static [CommandableSetpoint<f64>] = &[CommandableSetpoint {
        name: "room_c",
        limits: 5.0..=30.0,
        command: |wanted_c| wanted_c,
        needs_control: false,
        alternatives: None,
    }];
}

/// Reports on a recording, and writes a page with its plots if one is wanted.
pub(crate) fn report(file: &Path, page: Option<&Path>) -> Result<Report<()>, String> {
    let recording = Recording::open(file).map_err(|error| error.to_string())?;
    let report = Survey::<Thermostat>::read(&recording, (), None, |_| {})?;
    if let Some(page) = page {
        report.write_page(page, &[file])?;
    }
    Ok(report)
}

/// Records that may wait to be published: as many as a run in lockstep has.
const WAITING: usize = 512;

/// A run that other programs watch and command.
pub(crate) struct Live {
    publisher: PublisherOf<Thermostat>,
    commands: SentCommands<Thermostat>,
}

impl Live {
    /// Publishes a run of these parts.
    pub(crate) fn begin(instance: &Instance, parts: &Parts<Thermostat>) -> Result<Self, String> {
        let publisher = PublisherOf::start_with_commands(instance, WAITING);
        let mut publisher = publisher.map_err(|error| error.to_string())?;
        publisher.describe(Info {
            software: Text::new(env!("CARGO_PKG_VERSION")),
            plant: Text::new("room"),
            rate_hz: 1.0 / parts.timer.period().as_secs_f64(),
            timer: Text::new(parts.timer.name()),
            ..Info::of_this_process()
        });
        Ok(Self {
            publisher,
            commands: SentCommands::new(Vec::new()),
        })
    }

    /// Publishes a record or an event, and answers commands by it.
    pub(crate) fn take(&mut self, message: &MessageOf<Thermostat>) {
        match message {
            Message::Tick(record) => {
                self.publisher.record(record);
                let (tick, state) = (record.tick.number, record.state.state());
                while let Some((id, verdict)) = self.commands.verdict(tick, state) {
                    self.publisher.answer(id, verdict);
                }
            }
            Message::Event(event) => {
                let words = describe_event::<Thermostat>(event, &[], &[]);
                self.publisher.event(fcc_live::Event::new(event, &words));
                self.commands.event(event);
            }
        }
    }

    /// Sends other programs' commands to the loop, and publishes what was taken.
    pub(crate) fn poll(&mut self, status: Option<RecorderStatus>, to: &mut CommandSender<f64>) {
        if let Some(status) = status {
            self.publisher.recorder(status);
        }
        while let Some(asked) = self.publisher.next_command() {
            let send = |command| to.send(command).map_err(|error| error.to_string());
            if let Some((id, verdict)) = self.commands.send(asked, send) {
                self.publisher.answer(id, verdict);
            }
        }
        self.publisher.flush();
    }
}

/// The recorder's status, for whoever watches.
pub(crate) fn recorder(now: &fcc_record::RecorderStatus) -> RecorderStatus {
    let file = now.file.as_ref().and_then(|file| file.file_name());
    let name = file.unwrap_or_default().to_string_lossy();
    RecorderStatus {
        state: match now.stopped {
            None => RecorderState::Recording,
            Some(_) => RecorderState::Stopped,
        },
        recorded: now.ticks,
        not_recorded: now.not_recorded,
        bytes: now.bytes,
        name: Text::new(now.stopped.as_ref().unwrap_or(&name.into_owned())),
    }
}

#[cfg(test)]
mod tests {
    use fcc_core::framework::State;
    use fcc_record::RecordingPace;
    use fcc_runtime::{LoopCommand, LoopConfig, Machine};
    use fcc_timer::ManualTimer;
    use fcc_top::{Picture, draw, json_of};
    use html5ever::tendril::TendrilSink as _;
    use markup5ever_rcdom::{Handle, NodeData, RcDom};
    use ratatui::Terminal;
    use ratatui::backend::TestBackend;

    use super::*;
    use crate::room::Heater;
    use crate::{PERIOD, parts, recording};

    const TICKS: u64 = 320;

    /// Heats for 8 s, of which each is 2000 s to the room, in lockstep.
    fn heated(mut take: impl FnMut(&MessageOf<Thermostat>)) {
        let timer = Box::new(ManualTimer::new(PERIOD).unwrap());
        let parts = parts(timer, &Heater::default());
        let (mut machine, mut link) = Machine::new(parts, &LoopConfig::default()).unwrap();
        machine.start().unwrap();
        link.commands.send(LoopCommand::Engage).unwrap();
        for _ in 0..TICKS {
            assert_eq!(machine.step(), State::Engaged);
            while let Some(message) = link.messages.receive() {
                take(&message);
            }
        }
    }

    fn texts(node: &Handle, found: &mut Vec<String>) {
        if let NodeData::Text { contents } = &node.data {
            found.push(contents.borrow().trim().to_owned());
        }
        for child in node.children.borrow().iter() {
            texts(child, found);
        }
    }

    /// At the wanted 20 °C the walls lose (20 - 2) K / 0.02 K/W = 900 W, which is
    /// 45 % of the heater's 2000 W.
    #[test]
    fn the_report_is_of_a_room_that_settles_where_physics_says() {
        let folder = tempfile::tempdir().unwrap();
        let timer = Box::new(ManualTimer::new(PERIOD).unwrap());
        let begun = parts(timer, &Heater::default());
        let mut recorder =
            recording::start(folder.path(), &begun, RecordingPace::Lockstep).unwrap();
        heated(|message| recorder.take(message));
        let recorded = recording::finish(recorder, "the test is over").unwrap();

        let page = folder.path().join("room.html");
        let report = report(&recorded.files[0], Some(&page)).unwrap();
        let json = serde_json::to_value(&report).unwrap();
        assert_eq!(json["continuity"]["ticks"], TICKS);
        assert!(json.get("flight").is_none(), "no flight was flown");
        let value = |quantity: &str, role: &str| {
            let mut values = report.values.iter();
            let found = values.find(|value| value.quantity == quantity && value.role == role);
            found.unwrap().clone()
        };
        let room = value("room", "measured");
        assert_eq!(room.unit, "°C");
        assert!(
            (room.last - 20.0).abs() < 0.01 && room.highest < 20.1,
            "{room:?}"
        );
        assert!(room.lowest < 12.5, "{room:?}");
        assert_eq!(value("room", "desired").last, 20.0);
        let power = value("power", "commanded");
        assert!(
            (power.last / 100.0 * 2_000.0 - 900.0).abs() < 1.0,
            "{power:?}"
        );
        assert!(report.to_text().contains("The thermostat was engaged for"));

        let page = std::fs::read_to_string(page).unwrap();
        let dom = html5ever::parse_document(RcDom::default(), html5ever::ParseOpts::default())
            .one(page.as_str());
        assert!(dom.errors.borrow().is_empty(), "{:?}", dom.errors.borrow());
        assert!(!page.contains("NaN"));
        let mut found = Vec::new();
        texts(&dom.document, &mut found);
        for words in [
            "The room's temperature",
            "room, °C",
            "desired",
            "Outputs",
            "power, %",
        ] {
            assert!(found.iter().any(|text| text == words), "{words}: {found:?}");
        }
        for words in ["autopilot", "Ground track", "Aircraft"] {
            assert!(!page.contains(words), "{words}");
        }
    }

    #[test]
    fn the_screen_shows_the_room_with_its_units() {
        let mut picture = Picture::<Thermostat>::of(&Info {
            rate_hz: 40.0,
            plant: Text::new("room"),
            ..Info::default()
        });
        heated(|message| {
            if let Message::Tick(record) = message {
                picture.record(record);
            }
        });
        let mut terminal = Terminal::new(TestBackend::new(80, 24)).unwrap();
        let instance: Instance = "thermostat".parse().unwrap();
        terminal
            .draw(|frame| draw(frame, &instance, &picture))
            .unwrap();
        let buffer = terminal.backend().buffer();
        let rows: Vec<String> = (0..24)
            .map(|y| (0..80).map(|x| buffer[(x, y)].symbol()).collect())
            .collect();
        let screen = rows.join("\n");
        let row = |name: &str| {
            let mut rows = rows.iter().filter(|row| row.starts_with(name));
            let row = rows.next().unwrap_or_else(|| panic!("{name}:\n{screen}"));
            row.split_whitespace().take(5).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(row("room"), "room 20.00 → 20.00 °C", "{screen}");
        assert!(row("power").starts_with("power 45.0"), "{screen}");
        assert!(rows[0].contains("ENGAGED"), "{screen}");
        assert!(screen.contains("the room's"), "{screen}");

        let json = json_of(&picture);
        let room_c = json["tick"]["actual"]["room_c"].as_f64().unwrap();
        assert!((room_c - 20.0).abs() < 0.01, "{room_c}");
        assert_eq!(json["tick"]["setpoints"]["room_c"], 20.0);
    }

    /// As another program would watch it.
    #[test]
    fn a_run_can_be_watched_while_it_goes_on() {
        let name = format!("test-{}-thermostat", std::process::id());
        let instance: Instance = name.parse().unwrap();
        let timer = Box::new(ManualTimer::new(PERIOD).unwrap());
        let parts = parts(timer, &Heater::default());
        let mut live = Live::begin(&instance, &parts).unwrap();
        let watcher = fcc_live::WatcherOf::<Thermostat>::open(&instance).unwrap();
        heated(|message| live.take(message));
        live.publisher.flush();
        let json = fcc_top::snapshot(watcher).unwrap();
        assert_eq!(json["tick"]["state"], "engaged");
        assert!(json["tick"]["outputs"]["power"].as_f64().unwrap() > 0.0);
        assert!(!json["events"].as_array().unwrap().is_empty());
    }
}
