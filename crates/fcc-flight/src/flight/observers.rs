//! The observers of an aeroplane's flight, and how far its plan is flown.

use fcc_core::framework::{EventKind, Message, Notice};
use fcc_fixed_wing::{Autopilot, ITEM_REACHED, gives_up_runway, touches_ground};
use fcc_guidance::{Mode, Progress};
use fcc_telemetry::FlightMessage;

use super::observer::Observer;
use super::observer_list::{Names, ObserverList};

/// Slower than this over the ground it stands, m/s.
const STANDS_MPS: f64 = 0.3;

/// All observers of a flight.
pub(super) struct Observers {
    pub(super) list: ObserverList<Autopilot>,
    /// Of the last record that was engaged.
    pub(super) flown: Progress,
    /// Why a take-off or a landing was given up since an item was reached.
    pub(super) given_up: Option<String>,
    /// Why engaging was refused last.
    pub(super) refusal: Option<String>,
}

impl Observers {
    pub(super) fn new(all: Vec<Box<dyn Observer<Autopilot>>>, names: Names) -> Self {
        Self {
            list: ObserverList::new(all, names),
            flown: Progress::default(),
            given_up: None,
            refusal: None,
        }
    }

    /// Passes on a message of the loop.
    pub(super) fn take(&mut self, message: &FlightMessage) {
        let words = self.list.take(message);
        match message {
            Message::Tick(record) => {
                self.follow_progress(record.setpoints.guidance);
                let estimate = &record.estimate;
                let stands = estimate.north_mps.hypot(estimate.east_mps) < STANDS_MPS;
                if stands && self.flown.mode == Mode::Glide {
                    self.given_up = Some("it has glided without power, and stands".to_owned());
                }
                let ends = matches!(self.flown.mode, Mode::Takeoff | Mode::Glide);
                self.list.monitor.plan.gave_up |= stands && ends && self.given_up.is_some();
            }
            Message::Event(event) => {
                let words = words.unwrap_or_default();
                if let EventKind::Noticed(notice) = &event.kind {
                    self.follow_plan(notice, &words);
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
            self.list.monitor.plan.is_flown = false;
        }
        self.flown = now;
    }

    /// Follows how far the plan is flown.
    fn follow_plan(&mut self, notice: &Notice, words: &str) {
        self.list.monitor.plan.touched |= touches_ground(notice);
        if gives_up_runway(notice) {
            self.given_up = Some(words.to_owned());
        }
        if notice.kind == ITEM_REACHED {
            // A landing's end is reached when the aircraft stands. The waypoint before it
            // may be reached in the tick in which the landing begins.
            let (mode, item) = (self.flown.mode, self.flown.item);
            let has_landed = mode == Mode::Land && u32::from(notice.item) == item;
            self.list.monitor.plan.is_flown = has_landed || notice.item == 0;
            self.given_up = None;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::assemble::assemble;
    use super::super::conformance::observer_conforms;
    use super::super::event_log::EventLog;
    #[cfg(feature = "live")]
    use super::super::live::{FlightPlans, Live};
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
        let names = Names::of(&assembly.sensors, &assembly.actuators);
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
            let plans = FlightPlans::new(&config);
            let (telemetry, tick) = (&config.telemetry, &config.tick);
            Box::new(Live::new(telemetry, tick, None, commands, None, plans))
        });
    }
}
