//! All observers of a flight.

use fcc_core::framework::{EventKind, Message, Notice};
use fcc_fixed_wing::{Autopilot, AutopilotCommand, ITEM_REACHED, gives_up_runway, touches_ground};
use fcc_guidance::{Mode, Progress};
use fcc_runtime::CommandSender;
use fcc_telemetry::{FlightMessage, describe_event};

use super::assemble::Assembly;
use super::host::Host;
use super::monitor::Monitor;
use super::observer::{Access, Facts, Observer, Reports};
use super::outcome::Outcome;
use crate::config::NO_ACTUATOR;

/// Slower than this over the ground it stands, m/s.
const STANDS_MPS: f64 = 0.3;

/// All observers of a flight, each called in turn.
pub(super) struct Observers {
    all: Vec<Box<dyn Observer<Autopilot>>>,
    names: Names,
    pub(super) monitor: Monitor,
    /// Of the last record that was engaged.
    pub(super) flown: Progress,
    /// Why a take-off or a landing was given up since an item was reached.
    pub(super) given_up: Option<String>,
    /// Why engaging was refused last.
    pub(super) refusal: Option<String>,
    reports: Reports,
}

impl Observers {
    pub(super) fn new(all: Vec<Box<dyn Observer<Autopilot>>>, names: Names) -> Self {
        Self {
            all,
            names,
            monitor: Monitor::default(),
            flown: Progress::default(),
            given_up: None,
            refusal: None,
            reports: Reports::default(),
        }
    }

    pub(super) fn prepare(&mut self) {
        self.each(|observer, reports| observer.prepare(reports));
    }

    pub(super) fn begin(&mut self, facts: &Facts<'_>) {
        self.each(|observer, reports| observer.begin(facts, reports));
        if facts.actuators.is_empty() {
            self.remark(NO_ACTUATOR);
        }
    }

    /// Passes on a message of the loop.
    pub(super) fn take(&mut self, message: &FlightMessage) {
        let at = self.monitor.take(message);
        match message {
            Message::Tick(record) => {
                self.follow_progress(record.setpoints.guidance);
                let estimate = &record.estimate;
                let stands = estimate.north_mps.hypot(estimate.east_mps) < STANDS_MPS;
                if stands && self.flown.mode == Mode::Glide {
                    self.given_up = Some("it has glided without power, and stands".to_owned());
                }
                let ends = matches!(self.flown.mode, Mode::Takeoff | Mode::Glide);
                self.monitor.plan.gave_up |= stands && ends && self.given_up.is_some();
                for observer in &mut self.all {
                    observer.record(record, &at);
                }
            }
            Message::Event(event) => {
                let words =
                    describe_event::<Autopilot>(event, &self.names.sensors, &self.names.actuators);
                if let EventKind::Noticed(notice) = &event.kind {
                    self.follow_plan(notice, &words);
                }
                for observer in &mut self.all {
                    observer.event(event, &words, &at);
                }
                if matches!(
                    event.kind,
                    EventKind::EngageRefused { .. } | EventKind::EngageRefusedBySwitch
                ) {
                    self.refusal = Some(words);
                }
            }
        }
    }

    /// Follows what is flown: another item than the last one is to be flown first.
    fn follow_progress(&mut self, now: Progress) {
        if now.mode == Mode::None {
            return;
        }
        if now.item > 0 && now.item != self.flown.item {
            self.monitor.plan.is_flown = false;
        }
        self.flown = now;
    }

    /// Follows how far the plan is flown.
    fn follow_plan(&mut self, notice: &Notice, words: &str) {
        self.monitor.plan.touched |= touches_ground(notice);
        if gives_up_runway(notice) {
            self.given_up = Some(words.to_owned());
        }
        if notice.kind == ITEM_REACHED {
            // A landing's end is reached when the aircraft stands. The waypoint before it
            // may be reached in the tick in which the landing begins.
            let (mode, item) = (self.flown.mode, self.flown.item);
            let has_landed = mode == Mode::Land && u32::from(notice.item) == item;
            self.monitor.plan.is_flown = has_landed || notice.item == 0;
            self.given_up = None;
        }
    }

    /// Polls each observer.
    pub(super) fn poll(
        &mut self,
        commands: &mut CommandSender<AutopilotCommand>,
        host: &mut dyn Host,
    ) {
        self.each(|observer, reports| {
            observer.poll(&mut Access {
                commands,
                reports,
                before_control: &mut || host.before_control(),
            });
        });
    }

    /// Passes on a remark that is not from an observer.
    pub(super) fn remark(&mut self, words: impl Into<String>) {
        self.reports.remark(words);
        self.deliver(None);
    }

    pub(super) fn stopping(&mut self) {
        self.each(|observer, _| observer.stopping());
    }

    /// Ends each, in their order, so that the following ones receive what one
    /// reports at its end.
    pub(super) fn end(mut self, ending: &str, outcome: &mut Outcome) {
        self.each(|observer, reports| observer.end(ending, outcome, reports));
    }

    fn each(&mut self, mut act: impl FnMut(&mut dyn Observer<Autopilot>, &mut Reports)) {
        for number in 0..self.all.len() {
            if let Some(observer) = self.all.get_mut(number) {
                act(observer.as_mut(), &mut self.reports);
            }
            self.deliver(Some(number));
        }
    }

    /// Passes on what was reported, except to its reporter.
    fn deliver(&mut self, reporter: Option<usize>) {
        let at = self.monitor.at();
        for report in self.reports.take() {
            for (number, observer) in self.all.iter_mut().enumerate() {
                if Some(number) != reporter {
                    observer.report(&report, &at);
                }
            }
        }
    }
}

/// The names of sensors and actuators, which the loop identifies by their
/// index.
#[derive(Clone)]
pub(super) struct Names {
    pub(super) sensors: Vec<String>,
    pub(super) actuators: Vec<String>,
}

impl Names {
    pub(super) fn of(assembly: &Assembly) -> Self {
        Self {
            sensors: distinct(assembly.sensors.iter().map(|s| s.name())),
            actuators: distinct(assembly.actuators.iter().map(|a| a.name())),
        }
    }
}

/// Unique names: of several devices with one name, all but the first get a
/// number.
fn distinct<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut seen: Vec<&str> = Vec::new();
    names
        .map(|name| {
            seen.push(name);
            match seen.iter().filter(|other| **other == name).count() {
                1 => name.to_owned(),
                number => format!("{name} {number}"),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::assemble::assemble;
    use super::super::conformance::observer_conforms;
    use super::super::event_log::EventLog;
    #[cfg(feature = "live")]
    use super::super::live::Live;
    use super::super::recording::{FlightRecorder, RecordingRequest};
    use super::super::restart::{RestartKeeper, RestartRequest};
    use super::super::scorer::Scorer;
    use super::Names;
    use crate::config::Config;
    use fcc_fixed_wing::Autopilot;
    #[cfg(feature = "live")]
    use fcc_live::SentCommands;

    /// Files in a folder of the test's own, and a name of its own.
    fn config(folder: &tempfile::TempDir) -> Config {
        let path = folder.path().display();
        let text = format!(
            "[built-in]\n[recording]\nfolder = \"{path}\"\n[restart]\nstate_file = \
             \"{path}/test.flight\"\n[telemetry]\ninstance = \"conformance-{}\"\n",
            std::process::id()
        );
        Config::parse(&text, "test").unwrap()
    }

    #[test]
    fn devices_of_one_kind_are_told_apart_by_their_places() {
        let text = "[[sensor]]\nkind = \"bmp388\"\ni2c = \"/nowhere/i2c-1\"\n\
             [[sensor]]\nkind = \"bmp388\"\ni2c = \"/nowhere/i2c-1\"\naddress = 0x77\n\
             [[sensor]]\nkind = \"icm42688\"\nspi = \"/nowhere/spidev0.0\"\n\
             [[sensor]]\nkind = \"iio\"\ndevice = \"bmp280\"\nsysfs = \"/nowhere\"\n\
             [[sensor]]\nkind = \"gnss-serial\"\npath = \"/nowhere/ttyAMA0\"\n\
             [[sensor]]\nkind = \"gpsd\"\naddress = \"localhost:1\"\ndevice = \"/dev/ttyACM1\"\n\
             [[sensor]]\nkind = \"gpio-switch\"\nchip = \"/nowhere/gpiochip0\"\nline = 17\n\
             [[sensor]]\nkind = \"x-plane\"\n\
             [[sensor]]\nkind = \"x-plane\"\nlocal_port = 0\n\
             [[actuator]]\nkind = \"servos\"\npca9685 = \"/nowhere/i2c-2\"\n\
             [[actuator.channel]]\ndrives = \"elevator\"\noutput = 0\n\
             [[actuator.channel]]\ndrives = \"aileron\"\noutput = 1\n";
        let assembly = assemble(&Config::parse(text, "test").unwrap()).unwrap();
        let names = Names::of(&assembly);
        let expected = [
            "BMP388 at /nowhere/i2c-1 0x76",
            "BMP388 at /nowhere/i2c-1 0x77",
            "ICM-42688-P at /nowhere/spidev0.0",
            "IIO bmp280",
            "GNSS receiver at /nowhere/ttyAMA0",
            "gpsd at localhost:1 /dev/ttyACM1",
            "engage switch at /nowhere/gpiochip0 line 17",
            "X-Plane",
            "X-Plane 2",
        ];
        assert_eq!(names.sensors, expected);
        assert_eq!(names.actuators, ["servos at /nowhere/i2c-2"]);
    }

    #[test]
    fn every_observer_of_a_flight_conforms() {
        let folder = tempfile::tempdir().unwrap();
        let config = config(&folder);
        observer_conforms(|| Box::new(EventLog::default()));
        observer_conforms(|| {
            let mut assembly = assemble(&config).unwrap();
            let guidance = assembly.autopilot.config().guidance;
            Box::new(Scorer::new(&guidance, assembly.truth.take()))
        });
        observer_conforms(|| {
            let assembly = assemble(&config).unwrap();
            let guidance = assembly.autopilot.config().guidance;
            Box::new(Scorer::new(&guidance, None))
        });
        observer_conforms(|| {
            let request = RecordingRequest::of(&config, None).unwrap();
            Box::new(FlightRecorder::<Autopilot>::new(request))
        });
        observer_conforms(|| Box::new(RestartKeeper::new(RestartRequest::of(&config), None)));
        #[cfg(feature = "live")]
        observer_conforms(|| {
            let commands = SentCommands::new(vec![("airspeed_mps", Ok(30.0..=80.0))]);
            Box::new(Live::<Autopilot>::new(&config, commands, None))
        });
    }
}
