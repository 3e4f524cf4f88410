//! The state file: the state of the flight, for the next start.
//!
//! A [sealed](crate::sealed) file of JSON.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::Path;

use super::saved::Saved;
use super::state_page::Page;
use crate::sealed::{self, Unsealed, sync_folder};

/// The beginning of every state file.
const NAME: &str = "fccd-flight";
/// A state file has a hundredth of it.
const MOST_BYTES: u64 = 100_000;
/// The version of the layout.
const VERSION: u32 = 2;

/// Why a file cannot be used.
#[derive(thiserror::Error, Debug)]
pub(super) enum StateFileError {
    #[error("cannot be read: {0}")]
    Unreadable(#[from] io::Error),
    /// Not a state file; never overwritten.
    #[error("is not a state file of fccd: choose another restart.state_file")]
    Foreign,
    #[error("is of another version of fccd ({0}, and this one writes {VERSION})")]
    Version(u32),
    #[error("is damaged")]
    Damaged,
}

impl From<Unsealed> for StateFileError {
    fn from(unsealed: Unsealed) -> Self {
        match unsealed {
            Unsealed::Foreign => Self::Foreign,
            Unsealed::Version(version) => Self::Version(version),
            Unsealed::Damaged => Self::Damaged,
        }
    }
}

/// Reads a file; none if it does not exist.
pub(super) fn read(path: &Path) -> Result<Option<Saved>, StateFileError> {
    match fcc_record::read_own_file(path, MOST_BYTES) {
        Ok(bytes) => decode(&bytes).map(Some),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error.into()),
    }
}

/// Writes a file; when this returns, it is on the disk.
pub(super) fn write(path: &Path, saved: &Saved) -> io::Result<()> {
    sealed::replace(path, "flight.new", &encode(saved)?)
}

/// Removes a file; when this returns, the removal is on the disk.
pub(super) fn remove(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        Err(error) => Err(error),
        Ok(()) => sync_folder(path),
    }
}

fn encode(saved: &Saved) -> io::Result<Vec<u8>> {
    let body = serde_json::to_vec(&Page::of(saved))?;
    Ok(sealed::seal(NAME, VERSION, &body))
}

fn decode(bytes: &[u8]) -> Result<Saved, StateFileError> {
    let body = sealed::open(NAME, VERSION, bytes)?;
    let page: Page = serde_json::from_slice(body).map_err(|_| StateFileError::Damaged)?;
    page.saved().ok_or(StateFileError::Damaged)
}

/// Whether what a state file with this body contains is written so that it is
/// read again; `None` if it is refused.
#[cfg(fuzzing)]
pub fn read_state(body: &[u8]) -> Option<bool> {
    let _ = decode(body);
    let saved = decode(&sealed::seal(NAME, VERSION, body)).ok()?;
    let again = encode(&saved).ok()?;
    Some(decode(&again).is_ok_and(|again| again == saved))
}

#[cfg(test)]
mod tests {
    use fcc_core::flight::{AltitudeReference, Position, Surfaces};
    use fcc_fixed_wing::Resume;
    use fcc_guidance::route::TookOff;
    use fcc_guidance::{Mode, Progress, Targets};
    use proptest::prelude::*;

    use super::super::boot_clock::BootInstant;
    use super::super::saved::{SavedCommands, SavedPlan, SavedSwitch};
    use super::*;

    fn saved(mode: Mode, elapsed_s: f64) -> Saved {
        Saved {
            at: BootInstant {
                boot: "e8a5f3f2-6a62-4b1c-9a57-0f2d5b1c0c11".to_owned(),
                ns: 12_345_678_901,
            },
            config: 0xfedc_ba98,
            switch: SavedSwitch {
                on: true,
                source: 1,
            },
            recoveries: 2,
            plan: SavedPlan {
                hash: u64::MAX - 1,
                uploaded_unix_s: 1_790_000_000,
            },
            resume: Resume {
                progress: Progress {
                    mode,
                    item: 3,
                    elapsed_s,
                    captured: Targets {
                        airspeed_mps: 51.4,
                        heading_rad: 6.1,
                        altitude_m: 914.4,
                    },
                },
                surfaces: Surfaces {
                    throttle: 0.7,
                    elevator: -0.1,
                    aileron: 0.02,
                    rudder: 0.0,
                    ..Surfaces::IDLE
                },
                altimeter_setting_pa: Some(102_340.0),
                altitude_reference: AltitudeReference::SeaLevel,
                took_off: TookOff {
                    latitude_rad: 0.82,
                    longitude_rad: 0.14,
                    course_rad: -2.6,
                    elevation_m: 431.5,
                },
            },
            commanded: SavedCommands {
                go_to: Some(Position {
                    latitude_rad: 0.83,
                    longitude_rad: 0.149,
                    altitude_m: 1_000.5,
                }),
                promised_s: Some(2.5),
            },
        }
    }

    #[test]
    fn a_written_state_is_restored() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fccd.flight");
        assert!(read(&path).unwrap().is_none());
        for flown in [saved(Mode::Hold, 3.5), saved(Mode::TimedPattern, 65.25)] {
            write(&path, &flown).unwrap();
            assert_eq!(read(&path).unwrap(), Some(flown));
        }
        remove(&path).unwrap();
        assert!(read(&path).unwrap().is_none());
        remove(&path).unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    /// Seventeen digits that a parser may round to the next number.
    #[test]
    fn numbers_are_restored_to_the_last_bit() {
        for n in 0..20_000_u32 {
            let mut flown = saved(Mode::Hold, 3.5);
            flown.resume.surfaces.aileron = f64::from(n).sqrt() / 142.0;
            let again = decode(&encode(&flown).unwrap()).unwrap();
            assert_eq!(again, flown, "{n}");
        }
    }

    #[test]
    fn a_device_and_a_large_file_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let large = folder.path().join("large");
        fs::write(&large, vec![b'#'; 100_001]).unwrap();
        let said = |path: &Path| read(path).unwrap_err().to_string();
        assert!(said(&large).contains("more than 100000 bytes"));
        assert!(said(Path::new("/dev/zero")).contains("a pipe or a device"));
    }

    #[test]
    fn neither_a_link_nor_a_pipe_is_followed() {
        let folder = tempfile::tempdir().unwrap();
        let [path, victim] = ["fccd.flight", "victim"].map(|name| folder.path().join(name));
        fs::write(&victim, "kept").unwrap();
        // Another user of the folder waits for the file's next writing.
        std::os::unix::fs::symlink(&victim, path.with_extension("flight.new")).unwrap();
        write(&path, &saved(Mode::Hold, 3.5)).unwrap();
        assert_eq!(read(&path).unwrap(), Some(saved(Mode::Hold, 3.5)));
        assert_eq!(fs::read(&victim).unwrap(), b"kept");
        let [moved, link] = ["moved", "link"].map(|name| folder.path().join(name));
        fs::rename(&path, &moved).unwrap();
        std::os::unix::fs::symlink(&moved, &link).unwrap();
        let why = read(&link).unwrap_err().to_string();
        assert!(why.contains("symbolic link"), "{why}");
    }

    /// Of a file whose checksum is right.
    #[test]
    fn what_no_aircraft_flies_is_damaged() {
        type Change = fn(&mut Saved);
        let changes: [Change; 16] = [
            |saved| saved.resume.progress.captured.heading_rad = 1e300,
            |saved| saved.resume.progress.captured.altitude_m = 1e6,
            |saved| saved.resume.progress.captured.altitude_m = 1e308,
            |saved| saved.resume.altimeter_setting_pa = Some(1e308),
            |saved| saved.resume.altimeter_setting_pa = Some(0.0),
            |saved| saved.resume.surfaces.throttle = 2.0,
            |saved| saved.resume.surfaces.elevator = -1e308,
            |saved| saved.resume.progress.captured.altitude_m = -5_000.0,
            |saved| saved.resume.progress.captured.airspeed_mps = 1e9,
            |saved| saved.resume.progress.elapsed_s = 1e300,
            |saved| saved.resume.progress.elapsed_s = f64::NAN,
            |saved| saved.commanded.promised_s = Some(-1.0),
            |saved| saved.resume.took_off.latitude_rad = 2.0,
            |saved| saved.resume.took_off.course_rad = 4.0,
            |saved| saved.resume.took_off.elevation_m = 1e5,
            |saved| {
                let place = saved.commanded.go_to.as_mut();
                place.unwrap().latitude_rad = 2.0;
            },
        ];
        for (n, change) in changes.into_iter().enumerate() {
            let mut changed = saved(Mode::Hold, 3.5);
            change(&mut changed);
            let bytes = encode(&changed).unwrap();
            assert!(
                matches!(decode(&bytes), Err(StateFileError::Damaged)),
                "{n}"
            );
        }
    }

    #[test]
    fn foreign_files_are_distinguished_from_damaged_ones() {
        let good = encode(&saved(Mode::Hold, 3.5)).unwrap();
        let said = |bytes: &[u8]| decode(bytes).unwrap_err().to_string();
        assert!(said(b"root:x:0:0:root:/root:/bin/bash\n").contains("not a state file of fccd"));
        assert!(said(&[0xff; 40]).contains("not a state file of fccd"));
        assert!(said(b"fccd-flight 3 00000000\n{}").contains("another version"));
        assert!(said(b"").contains("damaged"), "a disk that lost it");
        assert!(said(&good[..good.len() - 1]).contains("damaged"));
        assert!(said(b"fccd-flight 2 00000000\n").contains("damaged"));
    }

    proptest! {
        /// CRC-32 detects every burst of up to 32 bits (Peterson and Brown
        /// 1961); a change in the header line makes it invalid.
        #[test]
        fn one_changed_byte_is_detected(place in any::<prop::sample::Index>(), by in 1_u8..) {
            let mut bytes = encode(&saved(Mode::TimedPattern, 3.0)).unwrap();
            let place = place.index(bytes.len());
            bytes[place] ^= by;
            match decode(&bytes) {
                Err(_) => {}
                // Upper and lower case are the same number.
                Ok(read) => prop_assert_eq!(read, saved(Mode::TimedPattern, 3.0)),
            }
        }

        #[test]
        fn any_content_of_a_state_file_is_handled(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
            let _ = decode(&bytes);
        }
    }
}
