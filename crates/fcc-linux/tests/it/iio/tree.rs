//! A stand-in for the kernel's folders: files for the values of an MPU-6050, and
//! a pipe in place of its buffer.

use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

use fcc_linux::Clock;
use fcc_linux::iio::{IioConfig, Roots};
use nix::sys::stat::Mode;
use nix::unistd::mkfifo;
use tempfile::TempDir;

/// As `inv_mpu6050` gives them for ±2 g and ±1000 °/s (Linux,
/// `drivers/iio/imu/inv_mpu6050/inv_mpu_core.c`).
const ACCELERATION_SCALE: &str = "0.000598";
const RATE_SCALE: &str = "0.000532362";

pub(crate) struct Tree {
    folder: TempDir,
    buffer: Option<File>,
}

impl Tree {
    pub(crate) fn new() -> Self {
        let folder = TempDir::new().unwrap();
        for name in ["sys", "dev"] {
            fs::create_dir(folder.path().join(name)).unwrap();
        }
        Self {
            folder,
            buffer: None,
        }
    }

    pub(crate) fn config(&self, device: &str, buffered: bool) -> IioConfig {
        IioConfig {
            roots: Roots {
                sysfs: self.folder.path().join("sys"),
                dev: self.folder.path().join("dev"),
            },
            device: device.into(),
            rate_hz: 200.0,
            buffered,
            is_differential: false,
            clock: Clock::default(),
        }
    }

    /// A file of a device, such as `iio:device0/name`.
    pub(crate) fn put(&self, file: &str, text: &str) {
        let path = self.sysfs(file);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, format!("{text}\n")).unwrap();
    }

    /// What was written to a file.
    pub(crate) fn got(&self, file: &str) -> String {
        fs::read_to_string(self.sysfs(file)).unwrap()
    }

    pub(crate) fn sysfs(&self, file: &str) -> PathBuf {
        self.folder.path().join("sys").join(file)
    }

    fn node(&self) -> PathBuf {
        self.folder.path().join("dev/iio:device0")
    }

    /// An MPU-6050 at rest, with its z axis upwards, that turns by 10 °/s about x.
    pub(crate) fn mpu6050(&mut self) {
        self.put("iio:device0/name", "mpu6050");
        for (axis, force, rate) in [("x", "0", "328"), ("y", "0", "0"), ("z", "16384", "0")] {
            self.put(&format!("iio:device0/in_accel_{axis}_raw"), force);
            self.put(&format!("iio:device0/in_anglvel_{axis}_raw"), rate);
        }
        self.put("iio:device0/in_accel_scale", ACCELERATION_SCALE);
        self.put("iio:device0/in_anglvel_scale", RATE_SCALE);
        self.put("iio:device0/in_temp_raw", "-2000");
        self.put("iio:device0/sampling_frequency", "50");
        self.put("iio:device0/current_timestamp_clock", "realtime");
        self.put("iio:device0/trigger/current_trigger", "");
        self.put("trigger3/name", "mpu6050-dev0");
        self.put("iio:device0/buffer/enable", "0");
        self.put("iio:device0/buffer/length", "2");
        let accelerations = ["x", "y", "z"].map(|axis| format!("in_accel_{axis}"));
        let rates = ["x", "y", "z"].map(|axis| format!("in_anglvel_{axis}"));
        let names = accelerations
            .into_iter()
            .chain(["in_temp".into()])
            .chain(rates);
        for (index, name) in names.enumerate() {
            self.element(&name, index, "be:s16/16>>0");
        }
        self.element("in_timestamp", 7, "le:s64/64>>0");
        mkfifo(&self.node(), Mode::from_bits_truncate(0o600)).unwrap();
        let both = OpenOptions::new().read(true).write(true).open(self.node());
        self.buffer = Some(both.unwrap());
    }

    fn element(&self, name: &str, index: usize, stored: &str) {
        let at = |what: &str| format!("iio:device0/scan_elements/{name}_{what}");
        self.put(&at("en"), "1");
        self.put(&at("index"), &index.to_string());
        self.put(&at("type"), stored);
    }

    /// A scan of what the files have, as the driver packs it without the
    /// temperature: six numbers of two bytes, four of padding, the time.
    pub(crate) fn scan(taken_ns: i64) -> [u8; 24] {
        let mut scan = [0; 24];
        for (place, number) in scan.chunks_exact_mut(2).zip([0_i16, 0, 16_384, 328, 0, 0]) {
            place.copy_from_slice(&number.to_be_bytes());
        }
        scan[16..].copy_from_slice(&taken_ns.to_le_bytes());
        scan
    }

    pub(crate) fn write(&mut self, bytes: &[u8]) {
        if let Some(buffer) = &mut self.buffer {
            buffer.write_all(bytes).unwrap();
        }
    }

    /// The chip is pulled out: its folder and its node are gone.
    pub(crate) fn pull_out(&mut self) {
        let is_there = |path: &Path| path.exists();
        if is_there(&self.node()) {
            fs::rename(self.sysfs("iio:device0"), self.folder.path().join("gone")).unwrap();
            fs::rename(self.node(), self.folder.path().join("gone-node")).unwrap();
        }
        self.buffer = None;
    }

    pub(crate) fn put_back(&mut self) {
        let node = self.folder.path().join("gone-node");
        let both = OpenOptions::new().read(true).write(true).open(&node);
        self.buffer = Some(both.unwrap());
        fs::rename(node, self.node()).unwrap();
        fs::rename(self.folder.path().join("gone"), self.sysfs("iio:device0")).unwrap();
    }
}
