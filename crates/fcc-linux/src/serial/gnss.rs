//! A satellite receiver on a serial line.

use core::fmt;
use core::time::Duration;

use fcc_core::flight::GnssFix;
use fcc_core::framework::Time;
use fcc_device::{EpochOrder, NO_FIX, REPEATED_FIX};

use super::{
    Epoch, Epochs, Frames, LineSettings, Nmea, SerialLine, Ubx, UbxMessage, configuration,
};
use crate::{DeviceError, Sample, Source};

/// Sentences are used if there was no message in UBX for so long: in them the
/// vertical speed is worse, and the accuracies may be missing.
const UBX_SILENT: Duration = Duration::from_secs(2);
/// How often the configuration is sent while there is no fix message in UBX: a
/// receiver that lost its power has lost it.
const CONFIGURED_EVERY: Duration = Duration::from_secs(5);
/// The times of UBX are those of a GPS week, s.
const WEEK_S: f64 = 604_800.0;
/// With less than one message in so many bytes, or in so long, they are not
/// understood: a receiver with all of its messages sends 3 kB in a second.
const NOTHING_UNDERSTOOD: (usize, Duration) = (10_000, Duration::from_secs(10));

/// A receiver, and how it is used.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct GnssSettings {
    /// Its line.
    pub line: LineSettings,
    /// Whether it is [configured](configuration) as a receiver of u-blox.
    pub configures: bool,
}

/// An open receiver: a [`Source`] of fixes, by UBX and by NMEA.
///
/// A fix is taken when its last byte was read, or earlier, if by the time of its epoch it is
/// later than those before; a known delay, of the receiver and of the line, is the
/// calibration's.
pub struct GnssReceiver {
    line: SerialLine,
    configures: bool,
    clock: Box<dyn Fn() -> Time + Send>,
    ubx: Frames<Ubx>,
    nmea: Frames<Nmea>,
    epochs: Epochs,
    order: EpochOrder,
    last_ubx: Time,
    configured: Time,
    refused: bool,
    not_understood: usize,
    understood: Time,
    waits_for: Option<&'static str>,
}

impl fmt::Debug for GnssReceiver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("GnssReceiver")
            .field("line", &self.line)
            .finish_non_exhaustive()
    }
}

/// What a piece of the stream had in it.
#[derive(Default)]
struct Found {
    by_ubx: Option<Sample<GnssFix>>,
    by_nmea: Option<Sample<GnssFix>>,
    has_ubx: bool,
    is_repeated: bool,
    messages: usize,
    refused: bool,
}

impl GnssReceiver {
    /// Opens the line; `clock` is the loop's, [`monotonic`](crate::monotonic).
    ///
    /// # Errors
    /// See [`SerialLine::open`].
    pub fn open(
        settings: &GnssSettings,
        clock: impl Fn() -> Time + Send + 'static,
    ) -> Result<Self, DeviceError> {
        Ok(Self {
            line: SerialLine::open(&settings.line)?,
            configures: settings.configures,
            clock: Box::new(clock),
            ubx: Frames::default(),
            nmea: Frames::default(),
            epochs: Epochs::default(),
            order: EpochOrder::within(WEEK_S),
            last_ubx: Time::NEVER,
            configured: Time::NEVER,
            refused: false,
            not_understood: 0,
            understood: Time::NEVER,
            waits_for: None,
        })
    }

    fn configure(&mut self, now: Time) -> Result<(), DeviceError> {
        let is_needed = now.since(self.last_ubx) > UBX_SILENT;
        if self.configures && is_needed && now.since(self.configured) >= CONFIGURED_EVERY {
            for message in configuration() {
                self.line.write(&message)?;
            }
            self.configured = now;
        }
        Ok(())
    }

    fn parse(&mut self, bytes: &[u8], now: Time) -> Found {
        let mut found = Found::default();
        let order = &mut self.order;
        self.ubx.push(bytes, |message| {
            found.messages += 1;
            match message {
                UbxMessage::NavPvt(pvt) => {
                    found.has_ubx = true;
                    if let Some(fix) = pvt.usable() {
                        let taken = order.taken(f64::from(pvt.time_of_week_ms) * 1e-3, now);
                        found.is_repeated = taken.is_none();
                        found.by_ubx = taken.map(|taken| Sample::new(taken, fix));
                    }
                }
                UbxMessage::Configured(is_accepted) => found.refused |= !is_accepted,
            }
        });
        let epochs = &mut self.epochs;
        self.nmea.push(bytes, |sentence| {
            found.messages += 1;
            match epochs.take(sentence, now) {
                Epoch::Complete(fix) => found.by_nmea = Some(fix),
                Epoch::Repeated => found.is_repeated = true,
                Epoch::Incomplete => {}
            }
        });
        found
    }

    /// What is to be said of bytes that gave no fix.
    fn trouble(
        &mut self,
        found: &Found,
        length: usize,
        damaged: u64,
        now: Time,
    ) -> Option<&'static str> {
        if found.refused && !self.refused {
            self.refused = true;
            return Some(
                "the receiver refuses a part of the configuration: u-blox 8 and older know \
                 another one, and a port may be missing; it is used as it is set",
            );
        }
        if found.messages > 0 || self.not_understood == 0 {
            (self.not_understood, self.understood) = (0, now);
        }
        if found.messages == 0 {
            self.not_understood += length;
        }
        let (most, longest) = NOTHING_UNDERSTOOD;
        if self.not_understood > most
            || (self.not_understood > 0 && now.since(self.understood) > longest)
        {
            self.not_understood = 0;
            return Some(
                "bytes arrive, but no message that is known: check `baud`, and that the receiver \
                 sends UBX-NAV-PVT, or GGA and RMC",
            );
        }
        let is_damaged = self.ubx.damaged() + self.nmea.damaged() > damaged;
        is_damaged.then_some(
            "a message arrived damaged, or says what is impossible: check the line and its length",
        )
    }
}

impl Source for GnssReceiver {
    type Value = GnssFix;

    fn read(&mut self) -> Result<Option<Sample<GnssFix>>, DeviceError> {
        self.configure((self.clock)())?;
        let mut buffer = [0; 512];
        let length = self.line.read(&mut buffer)?;
        let now = (self.clock)();
        let damaged = self.ubx.damaged() + self.nmea.damaged();
        let found = self.parse(buffer.get(..length).unwrap_or_default(), now);
        if found.has_ubx {
            self.last_ubx = now;
        }
        let has_only_nmea = now.since(self.last_ubx) > UBX_SILENT;
        let fix = found.by_ubx.or(found.by_nmea.filter(|_| has_only_nmea));
        if let Some(fix) = fix {
            (self.not_understood, self.waits_for) = (0, None);
            return Ok(Some(fix));
        }
        if found.is_repeated {
            self.waits_for = Some(REPEATED_FIX);
        } else if found.has_ubx {
            self.waits_for = Some(NO_FIX);
        } else if found.messages > 0 && has_only_nmea && self.waits_for != Some(REPEATED_FIX) {
            self.waits_for = self.epochs.waits_for();
        }
        match self.trouble(&found, length, damaged, now) {
            Some(what) => Err(DeviceError::Malformed {
                device: self.line.path().display().to_string(),
                what,
            }),
            None => Ok(None),
        }
    }

    fn waits_for(&self) -> Option<&'static str> {
        self.waits_for
    }
}
