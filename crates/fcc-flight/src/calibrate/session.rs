//! The sensors of a configuration, uncalibrated, and the calibration of one.

use std::path::PathBuf;

use fcc_calibration::{
    Axes, EarthField, GuidedCalibration, GuidedKind, MountingWay, Refusal, Rotation,
};
use fcc_core::flight::Measurements;
use fcc_core::framework::{Reading, Sensor, Tick};
use fcc_sim::HandlingFault;

use super::entry::Circumstances;
use super::hands::in_hands;
use super::order::check_order;
use super::{Applied, CalibrationFileError, CalibrationKind, Entry, Extent, apply};
use crate::config::{Config, RawSource};
use crate::flight::{AssemblyError, PhoneHost, open_device};

/// For so long the sensors may take to give something, s.
const OPENING_S: f64 = 5.0;
/// Before it, another source may give it, too, s.
const LOOKING_S: f64 = 0.5;

/// Why there is no calibration session.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum SessionError {
    /// Nothing gives raw readings.
    #[error(
        "the configuration has no raw sensors to calibrate: list sensors of a board or the servo \
         board (X-Plane gives none; the built-in aircraft does with built-in.raw_sensors)"
    )]
    NoSources,
    /// There is no such source.
    #[error("there is no sensor {given}: choose of {there}")]
    NoSuchSource {
        /// What was asked for.
        given: String,
        /// What there is.
        there: String,
    },
    /// What was found before cannot be used.
    #[error("{}: {error}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        error: CalibrationFileError,
    },
    /// Another calibration comes before.
    #[error(
        "no calibration of the {kind}: calibrate the {before} of {place} first, or give its \
         numbers in the configuration{disabled}. Nothing was changed"
    )]
    Order {
        /// What was to be calibrated.
        kind: &'static str,
        /// What comes before.
        before: &'static str,
        /// The source that it is of.
        place: String,
        /// Why what was found does not count, if it does not.
        disabled: &'static str,
    },
    /// A sensor could not be opened.
    #[error(transparent)]
    Open(#[from] AssemblyError),
    /// A gyroscope is turned without an accelerometer.
    #[error(
        "no readings of an accelerometer arrived, which tells how far the gyroscope is turned: \
         calibrate its bias alone (--bias-only), or list an accelerometer"
    )]
    NoAccelerometer,
    /// Nothing arrived.
    #[error("no readings of the {0} arrived: `fccd run` says what each sensor lacks")]
    Silent(&'static str),
}

/// A source that is read.
struct Opened {
    place: String,
    sensor: Box<dyn Sensor<Measurements>>,
    measured: Measurements,
}

impl Opened {
    fn new(place: String, sensor: Box<dyn Sensor<Measurements>>) -> Self {
        Self {
            place,
            sensor,
            measured: Measurements::default(),
        }
    }
}

/// The sensors of a configuration, uncalibrated, and the calibration of one. No
/// actuator is opened.
pub struct CalibrationSession {
    kind: CalibrationKind,
    extent: Extent,
    /// As it is in its file.
    given: Config,
    /// With what was found before.
    config: Config,
    before: Applied,
    asked: Option<String>,
    opened: Vec<Opened>,
    /// Which of them is calibrated.
    chosen: Option<(usize, Box<GuidedCalibration>)>,
    accelerometer: Axes,
    since_s: f64,
    length_s: Option<f64>,
    unix_s: u64,
}

impl CalibrationSession {
    /// Opens the sensors. What was found before is put over `given`, as of a
    /// flight; `place` is one of [`Config::raw_sources`], if not the first that
    /// gives something is meant. The built-in aircraft's are in the hands of a simulated person. `unix_s`
    /// is the present time.
    ///
    /// # Errors
    /// When there are none, or none of this name, or one cannot be opened, or
    /// what was found before is damaged.
    pub fn open(
        given: &Config,
        kind: CalibrationKind,
        extent: Extent,
        place: Option<String>,
        fault: Option<HandlingFault>,
        unix_s: u64,
    ) -> Result<Self, SessionError> {
        Self::open_with(given, (kind, extent), (place, fault), unix_s, None)
    }

    /// The same on a phone, of which `phone` opens the sensors.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn open_on_phone(
        given: &Config,
        kind: CalibrationKind,
        extent: Extent,
        unix_s: u64,
        phone: &mut dyn PhoneHost,
    ) -> Result<Self, SessionError> {
        Self::open_with(given, (kind, extent), (None, None), unix_s, Some(phone))
    }

    fn open_with(
        given: &Config,
        (kind, extent): (CalibrationKind, Extent),
        (place, fault): (Option<String>, Option<HandlingFault>),
        unix_s: u64,
        mut phone: Option<&mut dyn PhoneHost>,
    ) -> Result<Self, SessionError> {
        let mut config = given.clone();
        let before = apply(&mut config, unix_s)
            .map_err(|(path, error)| SessionError::File { path, error })?;
        let sources = config.raw_sources();
        if sources.is_empty() {
            return Err(SessionError::NoSources);
        }
        if let Some(given) = &place
            && !sources.iter().any(|source| source.place == *given)
        {
            let there: Vec<_> = sources.iter().map(|source| source.place.clone()).collect();
            return Err(SessionError::NoSuchSource {
                given: given.clone(),
                there: there.join(", "),
            });
        }
        let mut length_s = None;
        let mut opened = Vec::new();
        for source in sources {
            let board = config.board_sensor_of(&source.place);
            let sensor: Box<dyn Sensor<Measurements>> = if let Some(board) = board {
                open_device(board, &mut phone)?.0
            } else if let Some(handled) = in_hands(&config, &source, (kind, extent), fault) {
                length_s = Some(handled.length_s());
                Box::new(handled)
            } else if let (true, Some(section)) = (source.is_servo_board(), &config.servo_board) {
                // Its actuator sends nothing unless it is driven.
                let (sensor, ..) =
                    fcc_servo_link::open(&section.to_link(0)).map_err(AssemblyError::from)?;
                sensor
            } else {
                continue;
            };
            opened.push(Opened::new(source.place, sensor));
        }
        // Where it is, is asked for the strength of the field alone.
        if kind == CalibrationKind::Magnetometer && config.earth_field_ut().is_none() {
            for (place, receiver) in config.receivers() {
                opened.push(Opened::new(place, open_device(receiver, &mut phone)?.0));
            }
        }
        Ok(Self {
            kind,
            extent,
            given: given.clone(),
            config,
            before,
            asked: place,
            opened,
            chosen: None,
            accelerometer: Axes::default(),
            since_s: 0.0,
            length_s,
            unix_s,
        })
    }

    /// What of earlier calibrations is used, for users.
    pub fn remarks(&self) -> &[String] {
        &self.before.remarks
    }

    /// After so many seconds a simulated person has finished, or given up; none
    /// if it is a real one.
    pub const fn length_s(&self) -> Option<f64> {
        self.length_s
    }

    /// Reads the sensors in a tick.
    ///
    /// # Errors
    /// When nothing has arrived, or another calibration comes before.
    pub fn tick(&mut self, tick: &Tick) -> Result<(), SessionError> {
        self.since_s += tick.dt_s;
        for opened in &mut self.opened {
            // A fault is seen by what does not arrive.
            let _ = opened.sensor.sample(tick, &mut opened.measured);
        }
        if self.chosen.is_none() && self.since_s >= LOOKING_S {
            self.choose()?;
        }
        let together = self.chosen.as_ref().map(|(at, _)| self.together(*at));
        match (&mut self.chosen, together) {
            (Some((_, calibration)), Some(measured)) => {
                calibration.take(&measured);
                Ok(())
            }
            _ if self.since_s < OPENING_S => Ok(()),
            _ => Err(SessionError::Silent(self.kind.name())),
        }
    }

    /// The calibration, as soon as the sensor has given something.
    pub fn guided(&self) -> Option<&GuidedCalibration> {
        self.chosen.as_ref().map(|(_, guided)| guided.as_ref())
    }

    /// The key of the source that is calibrated, and which sensor it is.
    pub fn source(&self) -> Option<RawSource> {
        let (at, _) = self.chosen.as_ref()?;
        let place = &self.opened.get(*at)?.place;
        let mut sources = self.config.raw_sources().into_iter();
        sources.find(|source| source.place == *place)
    }

    /// What was last read of the source that is calibrated.
    pub fn measured(&self) -> Option<Measurements> {
        let (at, _) = self.chosen.as_ref()?;
        Some(self.together(*at))
    }

    /// The result.
    ///
    /// # Errors
    /// When it is not complete, or would be poor: the reason.
    pub fn finish(&self) -> Result<Entry, Refusal> {
        let guided = self.guided().ok_or(Refusal::Silent)?;
        let found = guided.finish()?;
        let source = self.source().ok_or(Refusal::Silent)?;
        let at = Circumstances {
            source: &source,
            given: &self.given,
            before: &self.before.used,
            unix_s: self.unix_s,
            temperature_k: guided.temperature_k(),
            accelerometer: self.accelerometer,
        };
        Ok(Entry::new(self.kind, &found, &at))
    }

    fn choose(&mut self) -> Result<(), SessionError> {
        let is_asked = |opened: &Opened| self.asked.as_ref().is_none_or(|of| *of == opened.place);
        let gives = |opened: &Opened| is_asked(opened) && self.kind.is_in(&opened.measured);
        let Some(at) = self.opened.iter().position(gives) else {
            return Ok(());
        };
        let is_force = |opened: &&Opened| !opened.measured.raw_specific_force.is_never();
        let chosen = self.opened.get(at).filter(is_force);
        let force = chosen.or_else(|| self.opened.iter().find(is_force));
        let sources = self.config.raw_sources();
        let source = force.and_then(|force| {
            let mut sources = sources.iter();
            sources.find(|source| source.place == force.place)
        });
        let is_turned = (self.kind, self.extent) == (CalibrationKind::Gyroscope, Extent::Whole);
        match source {
            Some(source) => check_order(
                self.kind,
                self.extent,
                source,
                &self.before.used,
                &self.given,
            )?,
            None if is_turned && self.since_s < OPENING_S => return Ok(()),
            None if is_turned => return Err(SessionError::NoAccelerometer),
            None => {}
        }
        let accelerometer = source.map(|source| Axes::from(&source.calibration.accelerometer));
        let kind = match self.kind {
            CalibrationKind::Accelerometer => GuidedKind::Accelerometer,
            CalibrationKind::Gyroscope if is_turned => GuidedKind::Gyroscope {
                accelerometer: accelerometer.unwrap_or_default(),
                turn: self.turn_of_gyroscope(at),
            },
            CalibrationKind::Gyroscope => GuidedKind::GyroscopeBias,
            CalibrationKind::Airspeed => GuidedKind::Airspeed,
            CalibrationKind::Magnetometer => GuidedKind::Magnetometer {
                earth: self.earth(),
                accelerometer,
            },
            CalibrationKind::Mounting => GuidedKind::Mounting {
                way: match self.extent {
                    Extent::Whole => MountingWay::LevelAndNoseUp,
                    Extent::Part => MountingWay::LevelOnly,
                },
                accelerometer: accelerometer.unwrap_or_default(),
            },
        };
        self.accelerometer = accelerometer.unwrap_or_default();
        self.chosen = Some((at, Box::new(GuidedCalibration::new(&kind))));
        Ok(())
    }

    /// From the axes of a source's gyroscope to the body's, as far as it is known.
    fn turn_of_gyroscope(&self, at: usize) -> Rotation {
        let place = self.opened.get(at).map(|opened| &opened.place);
        let mut sources = self.config.raw_sources().into_iter();
        let source = sources.find(|source| Some(&source.place) == place);
        let axes = source.map(|source| Axes::from(&source.calibration.gyroscope));
        axes.unwrap_or_default().turn()
    }

    /// What is known of the earth's field: the configured one, or that of the
    /// model.
    fn earth(&self) -> EarthField {
        match self.config.earth_field_ut() {
            Some([north, east, down]) => EarthField::Strength(north.hypot(east).hypot(down)),
            None => EarthField::InYear(self.config.navigation.year),
        }
    }

    /// What the chosen source gives, with what only others give.
    fn together(&self, at: usize) -> Measurements {
        fn first<T: Copy>(into: &mut Reading<T>, other: &Reading<T>) {
            if into.is_never() {
                *into = *other;
            }
        }
        let chosen = self.opened.get(at).map(|opened| opened.measured);
        let mut together = chosen.unwrap_or_default();
        for Opened { measured, .. } in &self.opened {
            first(
                &mut together.raw_specific_force,
                &measured.raw_specific_force,
            );
            first(&mut together.raw_body_rates, &measured.raw_body_rates);
            first(&mut together.magnetic_field, &measured.magnetic_field);
            first(&mut together.air_temperature_k, &measured.air_temperature_k);
            first(&mut together.gnss, &measured.gnss);
        }
        together
    }
}
