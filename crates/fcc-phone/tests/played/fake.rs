//! The library that plays, and a phone with it.

use std::thread;
use std::time::{Duration, Instant};

use fcc_core::flight::Measurements;
use fcc_core::framework::{Sensor, SensorFault, Tick};
use fcc_device::{DeviceStatus, monotonic};
use fcc_phone::{Clocks, Kind, Phone, PhoneHandle, PhoneSensor, PhoneSettings, SensorHealth};
use serde_json::{Value, json};

/// Android's numbers of types (`android/sensor.h`).
pub(crate) const ACCELEROMETER: i32 = 35;
pub(crate) const GYROSCOPE: i32 = 16;
pub(crate) const CALIBRATED_GYROSCOPE: i32 = 4;
pub(crate) const MAGNETOMETER: i32 = 14;
pub(crate) const CALIBRATED_MAGNETOMETER: i32 = 2;
pub(crate) const BAROMETER: i32 = 6;

/// Tells the library something about a package's sensor.
pub(crate) fn tell(package: &str, of_type: i32, what: &str, value: &Value) {
    android::loaded::tell(&json!({"package": package, "type": of_type, what: value}));
}

/// A phone that is sampled every 25 ms, as by a loop.
pub(crate) struct Played {
    pub(crate) package: &'static str,
    pub(crate) sensor: PhoneSensor,
    pub(crate) handle: PhoneHandle,
    pub(crate) devices: Vec<(&'static str, DeviceStatus)>,
    pub(crate) measured: Measurements,
}

impl Played {
    /// A phone at rest on a table, its screen up, with the sensors described.
    pub(crate) fn new(package: &'static str, told: &[(i32, Value)]) -> Self {
        let settings = PhoneSettings {
            has_position: false,
            ..PhoneSettings::default()
        };
        Self::with(package, told, &settings, Clocks::default())
    }

    pub(crate) fn with(
        package: &'static str,
        told: &[(i32, Value)],
        settings: &PhoneSettings,
        clocks: Clocks,
    ) -> Self {
        let at_rest = [
            (ACCELEROMETER, json!({"values": [0.0, 0.0, 9.81]})),
            (GYROSCOPE, json!({"values": [0.01, 0.02, 0.03]})),
            (MAGNETOMETER, json!({"values": [0.0, 20.0, -45.0]})),
            (
                BAROMETER,
                json!({"values": [1013.25], "min_delay_us": 40_000}),
            ),
        ];
        for (of_type, how) in at_rest.iter().chain(told) {
            tell(package, *of_type, "sensor", how);
        }
        let phone = Phone::with_clocks(package, clocks);
        let (sensor, devices) = phone.open(settings).unwrap();
        Self {
            package,
            sensor,
            handle: phone.handle(),
            devices,
            measured: Measurements::default(),
        }
    }

    /// A tick now.
    pub(crate) fn sample(&mut self) -> Result<(), SensorFault> {
        let tick = Tick {
            woke: monotonic(),
            ..Tick::default()
        };
        let sampled = self.sensor.sample(&tick, &mut self.measured);
        for taken in self.taken() {
            assert!(taken <= tick.woke, "a reading of the future");
        }
        sampled
    }

    fn taken(&self) -> [fcc_core::framework::Time; 4] {
        let measured = &self.measured;
        [
            measured.raw_specific_force.taken,
            measured.raw_body_rates.taken,
            measured.magnetic_field.taken,
            measured.static_pressure_pa.taken,
        ]
    }

    /// Samples until something is so.
    pub(crate) fn until(
        &mut self,
        what: &str,
        mut is_so: impl FnMut(&mut Self, Result<(), SensorFault>) -> bool,
    ) {
        let patience = Instant::now() + Duration::from_secs(20);
        while Instant::now() < patience {
            let sampled = self.sample();
            if is_so(self, sampled) {
                return;
            }
            thread::sleep(Duration::from_millis(25));
        }
        panic!("not within 20 s: {what}; {:?}", self.handle.sensors());
    }

    pub(crate) fn health(&self, kind: Kind) -> SensorHealth {
        let mut all = self.handle.sensors().into_iter();
        all.find(|health| health.kind == kind).unwrap()
    }

    /// What is wrong with a sensor; empty if nothing is.
    pub(crate) fn trouble(&self, kind: Kind) -> String {
        self.health(kind).trouble.unwrap_or_default()
    }

    pub(crate) fn tell(&self, of_type: i32, how: &Value) {
        tell(self.package, of_type, "sensor", how);
    }
}
