//! The real gpsd, with gpsfake, which plays a receiver to it.

use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use std::{fs, io, thread};

use nix::sys::signal::{Signal, killpg};
use nix::unistd::Pid;

/// Both processes end within this, unless they have to be killed.
const ENDS_WITHIN: Duration = Duration::from_secs(2);
/// A receiver that is not there after this comes no more.
const STARTS_WITHIN: Duration = Duration::from_secs(6);
const ATTEMPTS: u32 = 5;
const PAUSE: Duration = Duration::from_millis(10);
/// Seconds in the receiver's log, which is played again and again.
const SECONDS: u32 = 60;

/// A gpsd with a receiver, until it is dropped.
#[derive(Debug)]
pub struct RealGpsd {
    gpsfake: Child,
}

impl RealGpsd {
    /// Starts it at this port of the host, until it reports a fix. Its receiver sends
    /// the NMEA sentences of a second, without `$` and checksum, for each time such as
    /// `101100.00`, and one every 20 ms. The folder is for its files.
    ///
    /// # Errors
    /// When gpsfake cannot be started (it is in Debian's package `gpsd-clients`), or no
    /// fix is reported.
    pub fn start<const N: usize>(
        folder: &Path,
        port: u16,
        second: impl Fn(&str) -> [String; N],
    ) -> io::Result<Self> {
        let mut log = "# a receiver\n".to_owned();
        for number in 0..SECONDS {
            log.extend(second(&format!("1011{number:02}.00")).map(|text| sentence(&text)));
        }
        let path = folder.join("receiver.nmea");
        fs::write(&path, log)?;
        // Of some hundred on a busy machine, one never hands its receiver to gpsd.
        for _ in 0..ATTEMPTS {
            let started = Self {
                gpsfake: gpsfake(folder, port, &path)?,
            };
            if reports_a_fix(port) {
                return Ok(started);
            }
        }
        Err(io::ErrorKind::TimedOut.into())
    }
}

fn gpsfake(folder: &Path, port: u16, log: &Path) -> io::Result<Child> {
    Command::new("gpsfake")
        .args(["--nowait", "--quiet", "--cycle", "0.02", "--port"])
        .arg(port.to_string())
        .arg(log)
        .env("TMPDIR", folder)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .process_group(0)
        .spawn()
}

/// Whether the gpsd at this port reports a fix, soon.
fn reports_a_fix(port: u16) -> bool {
    let begun = Instant::now();
    while begun.elapsed() < STARTS_WITHIN {
        let connected = TcpStream::connect(("127.0.0.1", port)).and_then(|mut stream| {
            stream.set_read_timeout(Some(STARTS_WITHIN))?;
            stream.write_all(b"?WATCH={\"enable\":true,\"json\":true};\n")?;
            Ok(stream)
        });
        if let Ok(stream) = connected {
            return BufReader::new(stream)
                .lines()
                .map_while(Result::ok)
                .take_while(|_| begun.elapsed() < STARTS_WITHIN)
                .any(|line| line.contains("\"TPV\"") && line.contains("\"mode\":3"));
        }
        thread::sleep(PAUSE);
    }
    false
}

impl Drop for RealGpsd {
    /// gpsfake 3.22 waits for ever if SIGTERM arrives while it looks whether its gpsd
    /// still runs: its handler looks too, and is answered that another does.
    fn drop(&mut self) {
        let group = Pid::from_raw(self.gpsfake.id().cast_signed());
        let _ = killpg(group, Signal::SIGTERM);
        let begun = Instant::now();
        while matches!(self.gpsfake.try_wait(), Ok(None)) && begun.elapsed() < ENDS_WITHIN {
            thread::sleep(PAUSE);
        }
        let _ = killpg(group, Signal::SIGKILL);
        let _ = self.gpsfake.wait();
    }
}

/// With its checksum, the exclusive or of what is between `$` and `*`.
fn sentence(text: &str) -> String {
    let sum = text.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${text}*{sum:02X}\r\n")
}
