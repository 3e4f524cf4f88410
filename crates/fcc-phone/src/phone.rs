//! All of a phone's sensors as one sensor.

use core::time::Duration;
use std::ffi::CString;
use std::io;
use std::sync::{Arc, OnceLock};

use fcc_core::flight::{GnssFix, Measurements};
use fcc_core::framework::{FALLBACK_AFTER, Sensor, SensorFault, Tick};
use fcc_device::{DeviceSensor, DeviceStatus, DeviceThread, RawValues};

use crate::health::{Health, SensorHealth};
use crate::position::{POSITION, PositionSender, PositionSource, Positions, positions};
use crate::source::Opening;
use crate::{Clocks, Kind};

/// After so long without a position there is a fault: they come about once a second.
const POSITION_SILENT_AFTER: Duration = Duration::from_secs(3);

/// Which sensors are used, and how.
#[derive(Clone, PartialEq, Debug)]
pub struct PhoneSettings {
    /// Events in a second that are asked for; each sensor gives as many as it can.
    pub rate_hz: f64,
    /// The kinds that are used.
    pub kinds: Vec<Kind>,
    /// Whether the app hands positions in.
    pub has_position: bool,
    /// Whether the bias that the phone has estimated, as it is at first, is subtracted.
    pub uses_own_bias: bool,
    /// After how long without an event silence is a fault.
    pub silent_after: Duration,
    /// See [`Sensor::fallback_after`].
    pub fallback_after: Duration,
}

impl Default for PhoneSettings {
    fn default() -> Self {
        Self {
            rate_hz: 100.0,
            kinds: vec![
                Kind::Accelerometer,
                Kind::Gyroscope,
                Kind::Magnetometer,
                Kind::Barometer,
            ],
            has_position: true,
            uses_own_bias: true,
            silent_after: Duration::from_millis(500),
            fallback_after: FALLBACK_AFTER,
        }
    }
}

/// The sensors of a phone for one flight, not yet open.
pub struct Phone {
    package: CString,
    clocks: Clocks,
    positions: Positions,
    handle: PhoneHandle,
}

/// The app's end of it.
#[derive(Clone, Debug)]
pub struct PhoneHandle {
    positions: PositionSender,
    clocks: Clocks,
    health: Arc<OnceLock<Vec<Health>>>,
}

impl Phone {
    /// The sensors that Android gives to the app with this package's name.
    pub fn new(package: &str) -> Self {
        Self::with_clocks(package, Clocks::default())
    }

    /// The same with other clocks.
    pub fn with_clocks(package: &str, clocks: Clocks) -> Self {
        let (sender, positions) = positions();
        Self {
            // A name with a 0 is that of no app, as none is.
            package: CString::new(package).unwrap_or_default(),
            clocks: clocks.clone(),
            positions,
            handle: PhoneHandle {
                positions: sender,
                clocks,
                health: Arc::default(),
            },
        }
    }

    /// The app's end.
    pub fn handle(&self) -> PhoneHandle {
        self.handle.clone()
    }

    /// Starts the threads of the sensors. One that the phone lacks, or that does not do,
    /// is a fault of the sensor, not an error. With it, the state of each device.
    ///
    /// # Errors
    /// When a thread cannot be started.
    pub fn open(
        &self,
        settings: &PhoneSettings,
    ) -> io::Result<(PhoneSensor, Vec<(&'static str, DeviceStatus)>)> {
        let thread = |name, silent_after| {
            DeviceThread::new(name)
                .silent_after(silent_after)
                .fallback_after(settings.fallback_after)
        };
        let (mut sensors, mut devices, mut health) = (Vec::new(), Vec::new(), Vec::new());
        for kind in &settings.kinds {
            let thread = thread(kind.name(), settings.silent_after);
            let shown = Health::new(*kind, thread.status());
            devices.push((kind.name(), thread.status()));
            health.push(shown.clone());
            let opening = Opening {
                kind: *kind,
                package: self.package.clone(),
                rate_hz: settings.rate_hz,
                uses_own_bias: settings.uses_own_bias,
                clocks: self.clocks.clone(),
                health: shown,
                bias: Arc::default(),
            };
            sensors.push(thread.start(move || opening.open())?);
        }
        let mut position = None;
        if settings.has_position {
            let thread = thread(POSITION, POSITION_SILENT_AFTER);
            devices.push((POSITION, thread.status()));
            let (positions, clocks) = (self.positions.clone(), self.clocks.clone());
            position = Some(
                thread.start(move || Ok(PositionSource::new(positions.clone(), clocks.clone())))?,
            );
        }
        // A phone is opened once.
        let _ = self.handle.health.set(health);
        let sensor = PhoneSensor {
            sensors,
            position,
            fallback_after: settings.fallback_after,
            given: Measurements::default(),
            is_complete: false,
        };
        Ok((sensor, devices))
    }
}

impl PhoneHandle {
    /// Hands a position in, without waiting.
    pub fn positions(&self) -> &PositionSender {
        &self.positions
    }

    /// The sensors, as the screens show them; none before they are opened.
    pub fn sensors(&self) -> Vec<SensorHealth> {
        let now = self.clocks.monotonic.now();
        let all = self.health.get().map(Vec::as_slice).unwrap_or_default();
        all.iter().map(|health| health.shown(now)).collect()
    }
}

/// All of them as one sensor.
///
/// It gives nothing until each of its sensors, positions aside, has given something: so
/// one that is missing inhibits engaging, whichever it is. In flight each stands for
/// itself. The fault is that of the first that has one.
pub struct PhoneSensor {
    sensors: Vec<DeviceSensor<RawValues>>,
    position: Option<DeviceSensor<GnssFix>>,
    fallback_after: Duration,
    given: Measurements,
    is_complete: bool,
}

impl PhoneSensor {
    /// How much its sensors handed over since the last tick, samples and faults.
    pub fn waiting(&self) -> usize {
        self.sensors.iter().map(DeviceSensor::waiting).sum()
    }
}

impl Sensor<Measurements> for PhoneSensor {
    fn sample(&mut self, tick: &Tick, into: &mut Measurements) -> Result<(), SensorFault> {
        let mut sampled = Ok(());
        let mut is_complete = true;
        for sensor in &mut self.sensors {
            let of_one = sensor.sample(tick, &mut self.given);
            is_complete &= sensor.has_delivered();
            sampled = sampled.and(of_one);
        }
        self.is_complete |= is_complete;
        if let Some(position) = &mut self.position {
            sampled = sampled.and(position.sample(tick, &mut self.given));
        }
        if self.is_complete {
            *into = self.given;
        }
        sampled
    }

    fn fallback_after(&self) -> Duration {
        self.fallback_after
    }

    fn name(&self) -> &'static str {
        "phone"
    }
}
