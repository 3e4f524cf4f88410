//! What is known of a flight before it begins.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use fcc_telemetry::{Denial, Realtime};
use sha2::{Digest, Sha256};

use super::document::Document;

/// What is known of a flight before it begins. Every file of its recording
/// starts with it.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct About {
    /// The recording program: `fccd 0.1.0`.
    pub software: String,
    /// The commit that it was built from, or `unknown`.
    pub git_hash: String,
    /// The machine's name.
    pub host: String,
    /// Its kernel: `Linux 6.18.44 #1 SMP PREEMPT_RT aarch64`.
    pub kernel: String,
    /// The plant.
    pub plant: String,
    /// Nominal ticks per second.
    pub rate_hz: f64,
    /// The timer that woke the loop.
    pub timer: String,
    /// Names of the sensors, by their index in the loop.
    pub sensors: Vec<String>,
    /// Names of the actuators, by their index in the loop.
    pub actuators: Vec<String>,
    /// What the kernel granted the loop's thread.
    pub realtime: Realtime,
    /// Wall clock at the start, ns since 1970 in UTC.
    pub started_unix_ns: u64,
    /// Added to a time of the loop's clock, gives ns since 1970 in UTC, by the
    /// wall clock at the start.
    pub clock_offset_ns: i64,
    /// The configuration file, exactly as given; none if there was none.
    pub config_as_given: Option<String>,
    /// The whole configuration, defaults and command line included, as TOML. A
    /// replay uses it.
    pub config: String,
    /// The same, key by key.
    pub parameters: BTreeMap<String, String>,
    /// What came during the flight, in its order.
    pub documents: Vec<Document>,
    /// Which part of the recording this file is, from 1.
    pub part: u32,
}

/// Names of the metadata records and of the attachments of a file.
pub(super) const RECORDING: &str = "fcc.recording";
pub(super) const REALTIME: &str = "fcc.realtime";
pub(super) const PARAMETERS: &str = "fcc.parameters";
pub(super) const CONFIG: &str = "config.toml";
pub(super) const CONFIG_AS_GIVEN: &str = "config-as-given.toml";
/// The attachment with the [columns](fcc_telemetry::schema::RecordDescription)
/// of a record.
pub(super) const COLUMNS: &str = "columns.json";

/// Separates the entries of a list: no name contains it.
const SEPARATOR: &str = "\n";

type Fields = BTreeMap<String, String>;

impl About {
    /// SHA-256 of the configuration file as given, or of the whole
    /// configuration if none was given: 64 hexadecimal digits.
    pub fn config_sha256(&self) -> String {
        let text = self.config_as_given.as_ref().unwrap_or(&self.config);
        let mut digits = String::new();
        for byte in Sha256::digest(text.as_bytes()) {
            let _ = write!(digits, "{byte:02x}");
        }
        digits
    }

    /// When it began: `2026-11-20T04:21:33Z`, or `unknown`.
    pub fn started(&self) -> String {
        match self.started_unix_ns {
            0 => "unknown".to_owned(),
            unix_ns => super::utc::timestamp(unix_ns),
        }
    }

    /// The metadata records with these fields; attachments carry the rest.
    pub(super) fn to_metadata(&self) -> [(&'static str, Fields); 3] {
        let recording = [
            ("format", "1".to_owned()),
            ("software", self.software.clone()),
            ("git_hash", self.git_hash.clone()),
            ("host", self.host.clone()),
            ("kernel", self.kernel.clone()),
            ("plant", self.plant.clone()),
            ("rate_hz", self.rate_hz.to_string()),
            ("timer", self.timer.clone()),
            ("sensors", self.sensors.join(SEPARATOR)),
            ("actuators", self.actuators.join(SEPARATOR)),
            ("started", self.started()),
            ("started_unix_ns", self.started_unix_ns.to_string()),
            ("clock_offset_ns", self.clock_offset_ns.to_string()),
            ("config_sha256", self.config_sha256()),
            ("part", self.part.to_string()),
        ];
        let denied = self.realtime.refused.iter();
        let denied: Vec<_> = denied.map(ToString::to_string).collect();
        let realtime = [
            ("policy", self.realtime.policy.clone()),
            ("priority", self.realtime.priority.to_string()),
            ("cpu", known(self.realtime.cpu)),
            ("cpu_because", self.realtime.cpu_because.clone()),
            ("memory_locked", self.realtime.memory_locked.to_string()),
            (
                "stack_prefaulted",
                self.realtime.stack_prefaulted.to_string(),
            ),
            ("timer_slack_ns", known(self.realtime.timer_slack_ns)),
            (
                "cpu_dma_latency_us",
                known(self.realtime.cpu_dma_latency_us),
            ),
            ("refused", denied.join(SEPARATOR)),
        ];
        [
            (RECORDING, fields(recording)),
            (REALTIME, fields(realtime)),
            (PARAMETERS, self.parameters.clone()),
        ]
    }

    /// Takes a metadata record; true if it was one of these.
    pub(super) fn take_metadata(&mut self, name: &str, fields: Fields) -> bool {
        let text = |key: &str| fields.get(key).cloned().unwrap_or_default();
        let list = |key: &str| {
            let lines = text(key);
            lines.lines().map(str::to_owned).collect::<Vec<_>>()
        };
        match name {
            RECORDING => {
                self.software = text("software");
                self.git_hash = text("git_hash");
                self.host = text("host");
                self.kernel = text("kernel");
                self.plant = text("plant");
                self.rate_hz = number(&fields, "rate_hz");
                self.timer = text("timer");
                self.sensors = list("sensors");
                self.actuators = list("actuators");
                self.started_unix_ns = number(&fields, "started_unix_ns");
                self.clock_offset_ns = number(&fields, "clock_offset_ns");
                self.part = number(&fields, "part");
            }
            REALTIME => {
                self.realtime = Realtime {
                    policy: text("policy"),
                    priority: number(&fields, "priority"),
                    cpu: text("cpu").parse().ok(),
                    cpu_because: text("cpu_because"),
                    memory_locked: text("memory_locked") == "true",
                    stack_prefaulted: text("stack_prefaulted") == "true",
                    timer_slack_ns: text("timer_slack_ns").parse().ok(),
                    cpu_dma_latency_us: text("cpu_dma_latency_us").parse().ok(),
                    refused: list("refused").into_iter().map(in_words).collect(),
                }
            }
            PARAMETERS => self.parameters = fields,
            _ => return false,
        }
        true
    }

    /// Takes an attachment, if it is one of these.
    pub(super) fn take_attachment(&mut self, name: &str, data: &[u8]) {
        let text = || String::from_utf8_lossy(data).into_owned();
        match name {
            CONFIG => self.config = text(),
            CONFIG_AS_GIVEN => self.config_as_given = Some(text()),
            name => self.documents.extend(document(name, data)),
        }
    }
}

/// The document in an attachment; none if it is what every file begins with.
pub(super) fn document(name: &str, data: &[u8]) -> Option<Document> {
    let is_own = [CONFIG, CONFIG_AS_GIVEN, COLUMNS].contains(&name);
    (!is_own).then(|| Document {
        name: name.to_owned(),
        text: String::from_utf8_lossy(data).into_owned(),
    })
}

/// A denied request, of which a file holds only the text.
fn in_words(request: String) -> Denial {
    Denial {
        request,
        ..Denial::default()
    }
}

pub(super) fn fields<const N: usize>(pairs: [(&str, String); N]) -> Fields {
    pairs
        .into_iter()
        .map(|(key, value)| (key.to_owned(), value))
        .collect()
}

/// A number, or nothing if it is not known.
fn known(number: Option<impl ToString>) -> String {
    number.map_or_else(String::new, |number| number.to_string())
}

/// A field as a number; 0 if it is missing or not a number.
pub(super) fn number<T: std::str::FromStr + Default>(fields: &Fields, key: &str) -> T {
    fields
        .get(key)
        .and_then(|text| text.parse().ok())
        .unwrap_or_default()
}
