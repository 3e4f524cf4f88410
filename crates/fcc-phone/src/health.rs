//! What the screens show of a sensor.

use core::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use fcc_core::framework::Time;
use fcc_device::DeviceStatus;
use serde::Serialize;

use crate::{Kind, StampClock};

/// How much the phone trusts a sensor that it calibrates itself
/// (`ASENSOR_STATUS_...`).
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Accuracy {
    /// It touches nothing, of a sensor that has to.
    NoContact,
    /// It needs calibration, or its surroundings permit no reading.
    Unreliable,
    /// Calibration with the surroundings is needed.
    Low,
    /// It may be better.
    Medium,
    /// As good as it can be.
    High,
}

impl Accuracy {
    /// That of Android's number.
    pub(crate) const fn of(status: i8) -> Option<Self> {
        Some(match status {
            -1 => Self::NoContact,
            0 => Self::Unreliable,
            1 => Self::Low,
            2 => Self::Medium,
            3 => Self::High,
            _ => return None,
        })
    }
}

impl fmt::Display for Accuracy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NoContact => "no contact",
            Self::Unreliable => "unreliable",
            Self::Low => "low",
            Self::Medium => "medium",
            Self::High => "high",
        })
    }
}

/// A sensor of the phone, as the screens show it.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct SensorHealth {
    /// Which it is.
    pub kind: Kind,
    /// What the phone calls it; empty before it is open.
    pub name: String,
    /// Whether the phone subtracts nothing from what it measures.
    pub is_uncalibrated: bool,
    /// Events in a second that were asked for.
    pub asked_hz: Option<f64>,
    /// Events in a second by their time stamps, over the last second.
    pub measured_hz: Option<f64>,
    /// Which clock has stamped them.
    pub clock: Option<StampClock>,
    /// How much the phone trusts it, if it says so.
    pub accuracy: Option<Accuracy>,
    /// Time since the newest event.
    pub age_ms: Option<f64>,
    /// What is wrong with it, and what to do.
    pub trouble: Option<String>,
    #[serde(skip)]
    pub(crate) newest: Time,
}

/// What a sensor's thread writes, and the screens read.
#[derive(Clone, Debug)]
pub(crate) struct Health {
    shown: Arc<Mutex<SensorHealth>>,
    pub(crate) status: DeviceStatus,
}

impl Health {
    pub(crate) fn new(kind: Kind, status: DeviceStatus) -> Self {
        let shown = SensorHealth {
            kind,
            name: String::new(),
            is_uncalibrated: false,
            asked_hz: None,
            measured_hz: None,
            clock: None,
            accuracy: None,
            age_ms: None,
            trouble: None,
            newest: Time::NEVER,
        };
        Self {
            shown: Arc::new(Mutex::new(shown)),
            status,
        }
    }

    pub(crate) fn write(&self) -> MutexGuard<'_, SensorHealth> {
        self.shown.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What is shown at this time.
    pub(crate) fn shown(&self, now: Time) -> SensorHealth {
        let mut shown = self.write().clone();
        shown.trouble = self.status.trouble();
        shown.age_ms =
            (!shown.newest.is_never()).then(|| now.since(shown.newest).as_secs_f64() * 1e3);
        shown
    }
}
