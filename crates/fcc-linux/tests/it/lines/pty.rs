//! A serial line of which the test has the other end, and may pull it out.

use std::fs::{self, File};
use std::io::Write;
use std::os::unix::fs::symlink;
use std::path::PathBuf;

use fcc_linux::{DeviceError, Measured, Source};
use nix::pty::openpty;
use nix::unistd::ttyname;
use tempfile::TempDir;

use crate::lines::watched::{Clock, Watched};

/// A line, and the sensor that reads it.
pub(crate) struct Line<V> {
    pub(crate) watched: Watched<V>,
    device: Option<File>,
    folder: TempDir,
}

impl<V: Measured> Line<V> {
    pub(crate) fn new<S: Source<Value = V> + 'static>(
        open: impl Fn(PathBuf, Clock) -> Result<S, DeviceError> + Send + 'static,
    ) -> Self {
        let folder = TempDir::new().unwrap();
        let path = folder.path().join("line");
        let mut line = Self {
            watched: Watched::new(move |clock| open(path.clone(), clock)),
            device: None,
            folder,
        };
        line.plug_in();
        line
    }

    /// The line is there, under the same name, and is open.
    pub(crate) fn plug_in(&mut self) {
        let pair = openpty(None, None).unwrap();
        let path = self.folder.path().join("line");
        let _ = fs::remove_file(&path);
        symlink(ttyname(&pair.slave).unwrap(), path).unwrap();
        self.device = Some(pair.master.into());
        self.watched.settle();
    }

    /// The line is gone.
    pub(crate) fn pull_out(&mut self) {
        self.device = None;
    }

    /// The device sends, a moment before the next tick; it has been read then, if
    /// it is there.
    pub(crate) fn send(&mut self, bytes: &[u8]) {
        self.watched.next();
        if let Some(device) = &mut self.device {
            device.write_all(bytes).unwrap();
            self.watched.settle();
        }
    }
}
