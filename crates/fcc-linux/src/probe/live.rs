//! What is measured now.

use core::time::Duration;
use std::time::Instant;

use super::Found;
use crate::chip::ChipConfig;
use crate::iio::{Iio, IioConfig, Roots};
use crate::{Clock, DeviceError, Measured, RawValues, Sample, Source};

/// A mean of so many samples, or of what there is in so long.
const SAMPLES: u32 = 20;
const AT_MOST: Duration = Duration::from_secs(2);
const IIO_RATE_HZ: f64 = 50.0;

impl Found {
    /// The mean of some samples, in the axes of the sensor; none if it cannot be
    /// read. A chip is reset and set up for it, as for a flight: not while another
    /// program reads it. Of a driver of the kernel only files are read.
    ///
    /// # Errors
    /// When it does not answer, or gives nothing that is valid.
    pub fn values(&self, roots: &Roots) -> Option<Result<RawValues, DeviceError>> {
        match self {
            Self::Chip { kind, wiring, .. } => {
                let config = ChipConfig::new(*kind, wiring.clone());
                Some(config.open().and_then(mean))
            }
            Self::Iio { node, .. } => {
                let config = IioConfig {
                    roots: roots.clone(),
                    device: node.clone(),
                    rate_hz: IIO_RATE_HZ,
                    buffered: false,
                    is_differential: false,
                    clock: Clock::default(),
                };
                Some(Iio::open(&config).and_then(mean))
            }
            Self::Taken { .. } | Self::Unreadable { .. } => None,
        }
    }
}

fn mean(mut source: impl Source<Value = RawValues>) -> Result<RawValues, DeviceError> {
    let begun = Instant::now();
    let mut all: Option<Sample<RawValues>> = None;
    let mut failed = None;
    while begun.elapsed() < AT_MOST && all.is_none_or(|all| all.value.samples < SAMPLES) {
        match source.read() {
            Ok(Some(sample)) => {
                let merged = all.and_then(|all| RawValues::merged(&all, &sample));
                all = Some(merged.unwrap_or(sample));
            }
            Ok(None) => {}
            Err(error @ DeviceError::Malformed { .. }) => failed = Some(error),
            Err(error) => return Err(error),
        }
    }
    match (all, failed) {
        (Some(all), _) => Ok(all.value),
        (None, Some(error)) => Err(error),
        (None, None) => Err(DeviceError::Refused {
            device: "it".to_owned(),
            what: "gives no sample: check its supply and the wires".to_owned(),
        }),
    }
}
