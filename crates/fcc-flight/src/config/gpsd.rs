//! `[[sensor]]` of the kind `gpsd`.

use std::net::IpAddr;

use fcc_linux::gpsd::GpsdSettings;
use serde::{Deserialize, Serialize};

use super::CalibrationSection;

/// A satellite receiver that gpsd reads.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct GpsdSection {
    /// Where gpsd listens: host and port.
    pub address: String,
    /// The path of one of its receivers; all of them without.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub device: Option<String>,
    /// It counts as silent after this long without a fix.
    pub silent_after_ms: u64,
    /// After this long without a fix, that of the next sensor is used.
    pub fallback_after_ms: u64,
    /// The calibration of its readings: its delay.
    #[serde(skip_serializing_if = "CalibrationSection::is_default")]
    pub calibration: CalibrationSection,
}

impl Default for GpsdSection {
    /// gpsd's own port, and times for a fix in a second.
    fn default() -> Self {
        Self {
            address: "localhost:2947".to_owned(),
            device: None,
            silent_after_ms: 3_000,
            fallback_after_ms: 1_500,
            calibration: CalibrationSection::default(),
        }
    }
}

impl GpsdSection {
    /// What opens it.
    pub fn to_linux(&self) -> GpsdSettings {
        GpsdSettings {
            address: self.address.clone(),
            device: self.device.clone(),
        }
    }

    /// Whose fixes it reads, the same for each spelling of this machine; other names
    /// are not looked up.
    pub(super) fn source(&self) -> String {
        let (host, port) = self.address.rsplit_once(':').unwrap_or_default();
        let number = host.trim_matches(['[', ']']).parse::<IpAddr>();
        let host = match number {
            Ok(number) if number.is_loopback() => "localhost".to_owned(),
            _ => host.to_ascii_lowercase(),
        };
        let device = self.device.as_deref().unwrap_or("all its receivers");
        format!("gpsd at {host}:{port}, {device}")
    }

    /// Why the address is none, if it is not.
    pub(super) fn wrong_address(&self) -> Option<&'static str> {
        let is_host = |host: &str| {
            let fits = |byte: u8| byte.is_ascii_alphanumeric() || b"-._:[]%".contains(&byte);
            !host.is_empty() && host.bytes().all(fits)
        };
        let parts = self.address.rsplit_once(':');
        let is_one = parts.is_some_and(|(host, port)| {
            is_host(host) && port.parse::<u16>().is_ok_and(|port| port > 0)
        });
        (!is_one).then_some("is no address: give host and port, such as \"localhost:2947\"")
    }
}
