//! gpsd as a source of fixes.

use core::fmt;
use core::mem::replace;
use core::time::Duration;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::Instant;

use fcc_core::flight::GnssFix;
use fcc_core::framework::Time;
use fcc_device::{EpochOrder, REPEATED_FIX, SLOW_FIXES, VerticalSpeed};
use nix::errno::Errno;

use super::{Lines, Report};
use crate::traffic::Traffic;
use crate::{DeviceError, Sample, Source, WAIT};

const CONNECTED_WITHIN: Duration = Duration::from_secs(1);
/// With a receiver gpsd writes a `TPV` every second, even without a fix. A connection
/// that is cut without a word is noticed by this, too.
const SILENT: Duration = Duration::from_secs(10);
const PROTOCOL: u32 = 3;
/// What to do about what cannot be gpsd.
const NO_GPSD: &str = "this is no gpsd: check `address`, `ss -tlnp` on its machine shows what \
                       listens at which port";
/// Of its receivers, and characters of its words, in a message.
const MOST_LISTED: usize = 4;
const MOST_QUOTED: usize = 200;

/// Where gpsd is, and which of its receivers is used.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct GpsdSettings {
    /// Host and port, such as `localhost:2947`.
    pub address: String,
    /// The path by which gpsd knows the receiver, such as `/dev/ttyACM0`; all of
    /// them without.
    pub device: Option<String>,
}

/// A connection to gpsd: a [`Source`] of fixes.
///
/// A fix is taken when its line was read, or earlier, if by the receiver's time it is later
/// than those before; a known delay is the calibration's.
pub struct Gpsd {
    stream: TcpStream,
    settings: GpsdSettings,
    clock: Box<dyn Fn() -> Time + Send>,
    lines: Lines,
    traffic: Traffic,
    heard: Instant,
    order: EpochOrder,
    /// For receivers that give none.
    vertical_speed: VerticalSpeed,
    /// Whether the last fix has none.
    without_climb: bool,
    waits_for: Option<&'static str>,
}

impl fmt::Debug for Gpsd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Gpsd")
            .field("settings", &self.settings)
            .finish_non_exhaustive()
    }
}

/// What gpsd is asked for: its reports, as JSON.
const WATCH: &[u8] = b"?WATCH={\"enable\":true,\"json\":true};\n";

impl Gpsd {
    /// Connects, and asks for reports; `clock` is the loop's,
    /// [`monotonic`](crate::monotonic).
    ///
    /// # Errors
    /// When nothing listens there, or the host is unknown.
    pub fn open(
        settings: &GpsdSettings,
        clock: impl Fn() -> Time + Send + 'static,
    ) -> Result<Self, DeviceError> {
        let opened = connect(&settings.address).and_then(|mut stream| {
            stream.set_read_timeout(Some(WAIT))?;
            stream.set_write_timeout(Some(CONNECTED_WITHIN))?;
            stream.write_all(WATCH)?;
            Ok(stream)
        });
        Ok(Self {
            stream: opened.map_err(|source| DeviceError::Open {
                device: name(settings),
                source,
            })?,
            settings: settings.clone(),
            clock: Box::new(clock),
            lines: Lines::default(),
            traffic: Traffic::begin(),
            heard: Instant::now(),
            order: EpochOrder::of_day(),
            vertical_speed: VerticalSpeed::default(),
            without_climb: false,
            waits_for: None,
        })
    }

    /// The newest fix of what was received.
    fn parse(&mut self, bytes: &[u8], now: Time) -> Result<Option<Sample<GnssFix>>, DeviceError> {
        let (mut newest, mut trouble, mut heard) = (None, None, self.heard);
        let mut waits_for = self.waits_for;
        let (order, vertical_speed) = (&mut self.order, &mut self.vertical_speed);
        let without_climb = &mut self.without_climb;
        let device = name(&self.settings);
        let wanted = self.settings.device.as_ref();
        let refused = |what: String| DeviceError::Refused {
            device: device.clone(),
            what,
        };
        let malformed = |what| {
            let device = device.clone();
            Some(DeviceError::Malformed { device, what })
        };
        let mut take = |report| match report {
            Ok(Report::Fix {
                device,
                time_s,
                fix,
                has_vertical_speed,
            }) if wanted.is_none() || device.as_ref() == wanted => {
                let mut fix = match fix {
                    Ok(fix) => fix,
                    Err(what) => {
                        waits_for = Some(what);
                        return;
                    }
                };
                let Some(taken) = time_s.map_or(Some(now), |time_s| order.taken(time_s, now))
                else {
                    waits_for = Some(REPEATED_FIX);
                    return;
                };
                if !has_vertical_speed {
                    let time_s = time_s.unwrap_or(now.as_nanos() as f64 * 1e-9);
                    let down_mps = vertical_speed.down_mps(time_s, fix.position.altitude_m);
                    let is_second = replace(without_climb, down_mps.is_none());
                    let Some(down_mps) = down_mps else {
                        // The first has none at any rate.
                        waits_for = is_second.then_some(SLOW_FIXES);
                        return;
                    };
                    fix.velocity.down_mps = down_mps;
                }
                (newest, waits_for) = (Some(Sample::new(taken, fix)), None);
            }
            Ok(Report::Impossible { device: of }) if wanted.is_none() || of.as_ref() == wanted => {
                trouble = malformed(
                    "the position of its fix is impossible, with a latitude beyond 90° or a \
                     longitude beyond 180°: check what its receiver sends (`gpsmon`)",
                );
            }
            Ok(Report::Devices(all)) => {
                if let Some(path) = wanted.filter(|path| !all.contains(path)) {
                    trouble = Some(refused(format!(
                        "it has no receiver {path}, but {}: choose `device` of these, or start it \
                         with that one",
                        listed(&all)
                    )));
                }
            }
            Ok(Report::Version { protocol }) if protocol != PROTOCOL => {
                trouble = Some(refused(format!(
                    "it speaks version {protocol} of its protocol, not {PROTOCOL}: install \
                     another version of gpsd"
                )));
            }
            Ok(Report::Error(message)) => {
                trouble = Some(refused(format!("it reports: {}", quoted(&message))));
            }
            Ok(_) => {}
            Err(_) => {
                trouble =
                    malformed("a line is not of gpsd's JSON: check that gpsd has this address");
            }
        };
        let mut reports = 0;
        let pushed = self.lines.push(bytes, |line| {
            reports += 1;
            let report = Report::read(line);
            if let Ok(Report::Fix { .. } | Report::Impossible { .. }) = report {
                heard = Instant::now();
            }
            take(report);
        });
        (self.heard, self.waits_for) = (heard, waits_for);
        if pushed.is_err() {
            return Err(refused(format!(
                "it sends more than {} bytes without the end of a line, the most of gpsd: \
                 {NO_GPSD}",
                Lines::LONGEST
            )));
        }
        if self.traffic.is_flood(bytes.len(), reports) {
            return Err(refused(flood()));
        }
        match (newest, trouble) {
            (None, Some(trouble)) => Err(trouble),
            (newest, _) => Ok(newest),
        }
    }
}

fn flood() -> String {
    format!(
        "it sends more than {} reports or {} bytes in a second, and gpsd does not: {NO_GPSD}",
        Traffic::MOST_MESSAGES,
        Traffic::MOST_BYTES
    )
}

/// By the first of the host's addresses that answers.
fn connect(address: &str) -> io::Result<TcpStream> {
    let mut failed = Errno::EADDRNOTAVAIL.into();
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, CONNECTED_WITHIN) {
            Ok(stream) => return Ok(stream),
            Err(error) => failed = error,
        }
    }
    Err(failed)
}

/// What another program lists, for a message.
fn listed(paths: &[String]) -> String {
    if paths.is_empty() {
        return "none".to_owned();
    }
    let shown = paths.iter().take(MOST_LISTED);
    let shown: Vec<_> = shown.map(|path| quoted(path)).collect();
    shown.join(", ")
}

/// The beginning of another program's text.
fn quoted(text: &str) -> String {
    let first: String = text.chars().take(MOST_QUOTED).collect();
    first.escape_debug().to_string()
}

/// Its messages are among those of gpsd, as those of a line are.
fn name(settings: &GpsdSettings) -> String {
    settings.address.clone()
}

impl Source for Gpsd {
    type Value = GnssFix;

    fn read(&mut self) -> Result<Option<Sample<GnssFix>>, DeviceError> {
        let mut buffer = [0; 4_096];
        let failed = |source| DeviceError::Io {
            device: name(&self.settings),
            doing: "reading",
            source,
        };
        let length = match self.stream.read(&mut buffer) {
            // It ended, or was ended.
            Ok(0) => return Err(failed(Errno::ECONNRESET.into())),
            Ok(length) => length,
            Err(error) if is_nothing(&error) => 0,
            Err(error) => return Err(failed(error)),
        };
        let now = (self.clock)();
        let fix = self.parse(buffer.get(..length).unwrap_or_default(), now)?;
        if self.heard.elapsed() > SILENT {
            return Err(DeviceError::Refused {
                device: name(&self.settings),
                what:
                    "it reports no position (`TPV`): check that it has a receiver (`gpsmon` shows \
                       it)"
                    .into(),
            });
        }
        Ok(fix)
    }

    fn waits_for(&self) -> Option<&'static str> {
        self.waits_for
    }
}

fn is_nothing(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
    )
}
