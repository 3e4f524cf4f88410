//! Reads and checks plans for commands, in a thread of its own: a disk may hang.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};
use std::thread;
use std::time::{SystemTime, UNIX_EPOCH};

use fcc_live::{PendingCommand, Verdict};
use fcc_timer::not_started;

use crate::config::{Config, PreparedPlan, refusal};

/// With locked memory, all of a stack is resident.
const STACK_BYTES: usize = 512 << 10;

type Read = Result<PreparedPlan, String>;

/// Reads plans, one at a time.
pub(super) struct PlanReader {
    config: Arc<Config>,
    reading: Option<(PendingCommand, Receiver<Read>)>,
}

impl PlanReader {
    pub(super) fn new(config: &Config) -> Self {
        Self {
            config: Arc::new(config.clone()),
            reading: None,
        }
    }

    /// Begins to read; an answer if that is not possible now.
    pub(super) fn begin(
        &mut self,
        asked: PendingCommand,
        file: PathBuf,
        item: u16,
    ) -> Option<(u64, Verdict)> {
        let refused = |why: String| Some((asked.id, Verdict::Refused(why)));
        if self.reading.is_some() {
            return refused("another plan is being read: send it again".to_owned());
        }
        let (done, read) = sync_channel(1);
        let config = Arc::clone(&self.config);
        let work = move || {
            let now = SystemTime::now().duration_since(UNIX_EPOCH);
            let uploaded_s = now.map_or(0, |since| since.as_secs());
            let prepared = config.prepare_plan(&file, item, uploaded_s);
            let _ = done.send(prepared.map_err(|error| refusal(&error)));
        };
        let thread = thread::Builder::new()
            .name("fcc-plan".to_owned())
            .stack_size(STACK_BYTES)
            .spawn(work);
        if let Err(error) = thread {
            return refused(format!("no thread to read it: {}", not_started(error)));
        }
        self.reading = Some((asked, read));
        None
    }

    /// The plan that was read, and its command; none while there is none.
    pub(super) fn take(&mut self) -> Option<(PendingCommand, Read)> {
        let (asked, read) = self.reading.take()?;
        match read.try_recv() {
            Ok(prepared) => Some((asked, prepared)),
            Err(TryRecvError::Empty) => {
                self.reading = Some((asked, read));
                None
            }
            Err(TryRecvError::Disconnected) => Some((
                asked,
                Err("its reading was interrupted: send it again".to_owned()),
            )),
        }
    }
}
