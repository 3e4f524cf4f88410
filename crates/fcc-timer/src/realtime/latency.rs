//! How deep the CPUs' idle states may be: `/dev/cpu_dma_latency`.
//!
//! A CPU without work enters an idle state, and leaving a deep one takes longer,
//! up to hundreds of microseconds. While a process keeps this device open with a
//! number written to it, µs, the kernel avoids states that take longer to leave (Linux, "PM Quality Of Service Interface").

use nix::errno::Errno;
use std::fs::{File, OpenOptions};
use std::io::{self, Read, Write};
use std::sync::Arc;

use super::DeniedRequest;

const DEVICE: &str = "/dev/cpu_dma_latency";

/// A limit on how long CPUs may take to leave an idle state, in force until the
/// last copy of this value is dropped.
#[derive(Clone, Debug)]
pub struct LatencyLimit {
    us: u32,
    _device: Arc<File>,
}

impl LatencyLimit {
    /// The limit, µs, as read back: that of the strictest holder.
    pub const fn us(&self) -> u32 {
        self.us
    }
}

impl PartialEq for LatencyLimit {
    fn eq(&self, other: &Self) -> bool {
        self.us == other.us
    }
}

impl Eq for LatencyLimit {}

/// Requests that no CPU takes longer than `requested_us` to leave an idle state.
pub(super) fn limit(requested_us: u32) -> Result<LatencyLimit, DeniedRequest> {
    ask(requested_us).map_err(|error| DeniedRequest {
        request: format!("CPUs awake within {requested_us} µs"),
        reason: match error.raw_os_error() {
            Some(number) => format!("{DEVICE}: {:?}", Errno::from_raw(number)),
            None => format!("{DEVICE}: {error}"),
        },
        remedy: format!(
            "let the program write to {DEVICE}: a udev rule \
             KERNEL==\"cpu_dma_latency\", GROUP=\"fccd\", MODE=\"0660\"; where the machine has \
             no such device, remove the request"
        ),
    })
}

fn ask(requested_us: u32) -> io::Result<LatencyLimit> {
    let mut device = OpenOptions::new().read(true).write(true).open(DEVICE)?;
    let requested = i32::try_from(requested_us).map_err(io::Error::other)?;
    device.write_all(&requested.to_ne_bytes())?;
    let mut granted = [0; size_of::<i32>()];
    device.read_exact(&mut granted)?;
    let granted = i32::from_ne_bytes(granted);
    if granted > requested {
        return Err(io::Error::other(format!("reads back as {granted} µs")));
    }
    Ok(LatencyLimit {
        us: granted.unsigned_abs(),
        _device: Arc::new(device),
    })
}
