//! A recording as a file of other programs, written while it is sent.

use std::fs::File;
use std::io::{self, BufWriter, Write};

use axum::body::Bytes;
use fcc_record::{Recording, timestamp};
use futures_util::{Stream, StreamExt as _};
use serde::Deserialize;
use tokio::sync::{OwnedSemaphorePermit, mpsc};

use super::scan::{Found, Scanner};

/// Parts that wait for the client, and their size.
const PARTS: usize = 4;
pub(super) const PART_BYTES: usize = 64 << 10;
/// A place of a track as often as this.
const TRACK_EVERY_NS: i64 = 1_000_000_000;

/// Formats.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Format {
    /// The file itself.
    Mcap,
    /// Every tick.
    Csv,
    /// The track.
    Gpx,
    /// The track.
    Kml,
}

impl Format {
    pub(super) const fn end(self) -> &'static str {
        match self {
            Self::Mcap => "mcap",
            Self::Csv => "csv",
            Self::Gpx => "gpx",
            Self::Kml => "kml",
        }
    }

    pub(super) const fn content_type(self) -> &'static str {
        match self {
            Self::Mcap => "application/octet-stream",
            Self::Csv => "text/csv; charset=utf-8",
            Self::Gpx => "application/gpx+xml",
            Self::Kml => "application/vnd.google-earth.kml+xml",
        }
    }
}

type Part = io::Result<Bytes>;

/// Sends what is written; a client that has left is an error.
struct Sender(mpsc::Sender<Part>);

impl Write for Sender {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let part = Bytes::copy_from_slice(bytes);
        let sent = self.0.blocking_send(Ok(part));
        sent.map_err(|_| io::Error::from(io::ErrorKind::BrokenPipe))?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// The parts of a file.
pub(super) fn stream(
    recording: Recording,
    format: Format,
    place: OwnedSemaphorePermit,
) -> impl Stream<Item = Part> {
    let (send, parts) = mpsc::channel(PARTS);
    tokio::task::spawn_blocking(move || {
        let _place = place;
        let failed = send.clone();
        let mut out = BufWriter::with_capacity(PART_BYTES, Sender(send));
        let written = write(&recording, format, &mut out).and_then(|()| out.flush());
        if let Err(error) = written {
            // The client sees that the file is cut off.
            let _ = failed.blocking_send(Err(error));
        }
    });
    let parts = futures_util::stream::unfold(parts, async |mut parts| {
        let part = parts.recv().await?;
        Some((part, parts))
    });
    // Compression asks again after the end.
    parts.fuse()
}

fn write(recording: &Recording, format: Format, out: &mut impl Write) -> io::Result<()> {
    if format == Format::Mcap {
        io::copy(&mut File::open(recording.path())?, out)?;
        return Ok(());
    }
    let scanner = Scanner::of(recording).map_err(|_| io::Error::other("damaged"))?;
    begin(format, &scanner, out)?;
    let mut written = Ok(());
    let (mut first_ns, mut last_ns) = (None, None);
    let read = scanner.read(recording, |found| {
        let Found::Row(woke_ns, row) = found else {
            return true;
        };
        let first_ns = *first_ns.get_or_insert(woke_ns);
        if format == Format::Csv {
            written = csv_row(&scanner, row, (woke_ns - first_ns) as f64 * 1e-9, out);
        } else if last_ns.is_none_or(|last_ns| woke_ns - last_ns >= TRACK_EVERY_NS) {
            let offset_ns = recording.about().clock_offset_ns;
            let utc_ns = offset_ns.saturating_add(woke_ns).max(0) as u64;
            match point(&scanner, row) {
                Some(point) => {
                    last_ns = Some(woke_ns);
                    written = track_point(format, point, utc_ns, out);
                }
                None => return true,
            }
        }
        written.is_ok()
    });
    read.map_err(|_| io::Error::other("the recording cannot be read"))?;
    written?;
    end(format, out)
}

fn begin(format: Format, scanner: &Scanner, out: &mut impl Write) -> io::Result<()> {
    match format {
        Format::Mcap => Ok(()),
        Format::Csv => {
            let names = scanner.columns.all.iter().map(|column| column.name.as_str());
            let names: Vec<&str> = std::iter::once("time_s").chain(names).collect();
            writeln!(out, "{}", names.join(","))
        }
        Format::Gpx => out.write_all(
            b"<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<gpx version=\"1.1\" creator=\"fccd\" \
              xmlns=\"http://www.topografix.com/GPX/1/1\">\n<trk><name>Flight</name><trkseg>\n",
        ),
        Format::Kml => out.write_all(
            b"<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\">\
              <Document><Placemark><name>Flight</name><LineString><extrude>1</extrude>\
              <altitudeMode>absolute</altitudeMode><coordinates>\n",
        ),
    }
}

fn end(format: Format, out: &mut impl Write) -> io::Result<()> {
    match format {
        Format::Mcap | Format::Csv => Ok(()),
        Format::Gpx => out.write_all(b"</trkseg></trk>\n</gpx>\n"),
        Format::Kml => out.write_all(b"</coordinates></LineString></Placemark></Document></kml>\n"),
    }
}

/// Numbers as they are read back without loss.
fn csv_row(scanner: &Scanner, row: &[u64], time_s: f64, out: &mut impl Write) -> io::Result<()> {
    write!(out, "{time_s}")?;
    for index in 0..scanner.columns.all.len() {
        match scanner.columns.integer(index, row) {
            Some(integer) => write!(out, ",{integer}")?,
            None => write!(out, ",{}", scanner.columns.value(index, row))?,
        }
    }
    writeln!(out)
}

/// Latitude, longitude in degrees and altitude above mean sea level, as the satellite
/// receiver or the simulator measured it, or else by the standard atmosphere.
fn point(scanner: &Scanner, row: &[u64]) -> Option<(f64, f64, f64)> {
    let value = |name: &str| {
        let index = scanner.columns.index(name)?;
        Some(scanner.columns.value(index, row)).filter(|value| value.is_finite())
    };
    let latitude = value("estimated_latitude_rad")?;
    let longitude = value("estimated_longitude_rad")?;
    if latitude == 0.0 && longitude == 0.0 {
        return None;
    }
    let measured = value("position_altitude_m").filter(|m| *m != 0.0);
    let altitude_m = measured.or_else(|| value("estimated_altitude_m"))?;
    Some((latitude.to_degrees(), longitude.to_degrees(), altitude_m))
}

fn track_point(
    format: Format,
    (latitude, longitude, altitude_m): (f64, f64, f64),
    utc_ns: u64,
    out: &mut impl Write,
) -> io::Result<()> {
    if format == Format::Kml {
        return writeln!(out, "{longitude:.7},{latitude:.7},{altitude_m:.1}");
    }
    let time = timestamp(utc_ns);
    writeln!(
        out,
        "<trkpt lat=\"{latitude:.7}\" lon=\"{longitude:.7}\"><ele>{altitude_m:.1}</ele><time>{time}</time></trkpt>"
    )
}
