//! The replay of a recorded run, by the code that replays flights.

use std::error::Error;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use fcc_replay::{Chain, Identity, Replay};
use fcc_runtime::LoopConfig;
use fcc_timer::TimerError;

use crate::thermostat::{Config, Thermostat};

/// A loop as it was recorded, with this configuration.
fn replay_of(config: &Config, period: Duration) -> Result<Replay<Thermostat>, TimerError> {
    Replay::new(Thermostat::new(config), period, &LoopConfig::default())
}

/// Replays a recording by the configuration in it, and reports whether all of
/// it was the same.
pub(crate) fn replay(files: &[PathBuf], out: &mut dyn Write) -> Result<ExitCode, Box<dyn Error>> {
    let chain = Chain::open::<Thermostat>(files)?;
    let config = toml::from_str(&chain.about().config)
        .map_err(|error| format!("{}: {error}", chain.config_name()))?;
    let period = Duration::try_from_secs_f64(1.0 / chain.about().rate_hz)?;
    let mut identity = Identity::of::<Thermostat>();
    let replayed = chain.replay(
        &mut replay_of(&config, period)?,
        |recorded, again| identity.take(recorded, again),
        |_| {},
    );
    let (text, missing) = (identity.to_text(), replayed.missing());
    writeln!(
        out,
        "{} ticks replayed\n{text}{missing}",
        replayed.run.ticks
    )?;
    let is_same = identity.is_identical() && replayed.is_complete();
    Ok(if is_same {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}

#[cfg(test)]
pub(crate) mod tests {
    use std::path::Path;

    use fcc_record::RecordingPace;
    use fcc_replay::{Deviation, run};
    use fcc_runtime::{LoopCommand, Machine, Message, MessageOf};
    use fcc_timer::ManualTimer;

    use super::*;
    use crate::room::Heater;
    use crate::{PERIOD, parts, recording};

    pub(crate) const TICKS: u64 = 400;
    /// Wanted temperature, power, length of the step, state with cause and its faults,
    /// inhibits, faults, and whether the power was sent.
    const OUTPUTS: u64 = 9;

    /// Records a run with commands; its file, and all that the loop sent.
    pub(crate) fn record(folder: &Path) -> (PathBuf, Vec<MessageOf<Thermostat>>) {
        let timer = Box::new(ManualTimer::new(PERIOD).unwrap());
        let parts = parts(timer, &Heater::default());
        let mut recorder = recording::start(folder, &parts, RecordingPace::Lockstep).unwrap();
        let (mut machine, mut link) = Machine::new(parts, &LoopConfig::default()).unwrap();
        machine.start().unwrap();
        let mut messages = Vec::new();
        for number in 1..=TICKS {
            match number {
                10 => link.commands.send(LoopCommand::Engage).unwrap(),
                200 => link.commands.send(LoopCommand::Controller(22.5)).unwrap(),
                390 => link.commands.send(LoopCommand::Disengage).unwrap(),
                _ => {}
            }
            machine.step();
            while let Some(message) = link.messages.receive() {
                recorder.take(&message);
                messages.push(message);
            }
        }
        let mut status = recording::finish(recorder, "the test is over").unwrap();
        assert_eq!(status.ticks, TICKS);
        (status.files.remove(0), messages)
    }

    fn identity(config: &Config, messages: &[MessageOf<Thermostat>]) -> Identity {
        let mut identity = Identity::of::<Thermostat>();
        let mut replay = replay_of(config, PERIOD).unwrap();
        let run = run(&mut replay, messages.iter().copied(), |recorded, again| {
            identity.take(recorded, again);
        });
        assert_eq!((run.ticks, run.unflown), (TICKS, None));
        identity
    }

    #[test]
    fn a_recording_is_replayed_with_no_difference() {
        let folder = tempfile::tempdir().unwrap();
        let (file, _) = record(folder.path());
        let mut said = Vec::new();
        let code = replay(&[file], &mut said).unwrap();
        let said = String::from_utf8(said).unwrap();
        assert_eq!(code, ExitCode::SUCCESS, "{said}");
        let expected = format!(
            "400 ticks replayed\n{} outputs compared bit for bit: 0 differ\n",
            TICKS * OUTPUTS
        );
        assert_eq!(said, expected);
    }

    /// One bit of the recorded power, or of a gain.
    #[test]
    fn one_altered_bit_is_found() {
        let folder = tempfile::tempdir().unwrap();
        let (_, mut messages) = record(folder.path());
        let altered = |number: f64| f64::from_bits(number.to_bits() ^ 1);
        let config = Config::default();
        let gain = Config {
            response_s: altered(config.response_s),
            ..config
        };
        let found = identity(&gain, &messages);
        assert_eq!(found.first.unwrap().field, "outputs.power");
        assert!(found.differing > 10, "{}", found.differing);

        for message in &mut messages {
            if let Message::Tick(record) = message
                && record.tick.number == 300
            {
                record.outputs.power = altered(record.outputs.power);
            }
        }
        let found = identity(&config, &messages);
        let first = found.first.unwrap();
        assert_eq!((found.differing, first.tick), (1, 300));
    }

    /// 2 K more are wanted until the command of tick 200, in the units of the
    /// room.
    #[test]
    fn another_configuration_deviates_by_what_it_says() {
        let folder = tempfile::tempdir().unwrap();
        let (_, messages) = record(folder.path());
        let warmer = Config {
            wanted_c: 22.0,
            ..Config::default()
        };
        let mut deviation = Deviation::of::<Thermostat>();
        let mut replay = replay_of(&warmer, PERIOD).unwrap();
        run(&mut replay, messages.iter().copied(), |recorded, other| {
            deviation.take(recorded, other);
        });
        let names = deviation.quantities.iter().map(|q| (&*q.name, q.unit));
        let expected = [("commanded power", "%"), ("desired room", "°C")];
        assert_eq!(names.collect::<Vec<_>>(), expected);
        let room = &deviation.quantities[1];
        assert_eq!((room.differing, room.largest), (190, 2.0));
    }
}
