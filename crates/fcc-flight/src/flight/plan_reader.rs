//! Reads and checks plans for commands, in a thread of its own: a disk may hang.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};
use std::thread;
use std::time::{SystemTime, UNIX_EPOCH};

use fcc_live::{PendingCommand, Verdict};
use fcc_plan::FileError;
use fcc_timer::not_started;

use crate::config::{Config, PreparedPlan};

/// With locked memory, all of a stack is resident.
const STACK_BYTES: usize = 512 << 10;
/// The longest list of problems in an answer, in bytes.
const LONGEST_LIST: usize = 7_000;
/// So many remarks on a plan are told in flight.
const MOST_REMARKS: usize = 5;

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
            let mut prepared = config.prepare_plan(&file, item, uploaded_s);
            for remark in prepared.iter_mut().flat_map(|plan| &mut plan.remarks) {
                *remark = format!("{}: {remark}", file.display());
            }
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

/// The first remarks on a plan, as a flight has room for them.
pub(super) fn first_of(remarks: &[String]) -> Vec<String> {
    let mut first: Vec<_> = remarks.iter().take(MOST_REMARKS).cloned().collect();
    if let Some(left) = remarks.len().checked_sub(MOST_REMARKS + 1) {
        let left = left + 1;
        first.push(format!(
            "the plan has {left} more remarks, which fccd plan check lists"
        ));
    }
    first
}

/// Why a plan is refused, as an answer has room for it.
fn refusal(error: &FileError) -> String {
    let FileError::Invalid { file, problems } = error else {
        return error.to_string();
    };
    let mut text = format!("{file}: ");
    for (n, problem) in problems.iter().enumerate() {
        let line = problem.to_string();
        if text.len() + line.len() > LONGEST_LIST {
            let left = problems.len() - n;
            let _ = write!(text, "; and {left} more, which fccd plan check lists");
            break;
        }
        text.push_str(if n == 0 { "" } else { "; " });
        text.push_str(&line);
    }
    text
}

#[cfg(test)]
mod tests {
    use fcc_plan::Problem;

    use super::*;

    fn plan(north_deg: f64) -> String {
        format!("QGC WPL 110\n0 0 0 16 0 0 0 0 47 8 900 1\n1 0 0 16 0 0 0 0 {north_deg} 8 900 1\n")
    }

    #[test]
    fn a_flight_is_told_the_first_remarks_and_how_many_are_left() {
        let remarks: Vec<_> = (1..=7).map(|n| format!("item {n}")).collect();
        let [.., fifth, last] = &first_of(&remarks)[..] else {
            panic!("remarks");
        };
        assert_eq!(fifth, "item 5");
        assert!(last.starts_with("the plan has 2 more remarks"), "{last}");
        assert_eq!(first_of(&remarks[..5]), remarks[..5]);
    }

    #[test]
    fn a_refusal_names_every_problem_and_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("bad.waypoints");
        let text = plan(47.25).replace(" 16 0 0 0 0 47.25", " 82 0 0 0 0 147.25");
        std::fs::write(&file, text).unwrap();
        let refused = |item| refusal(&Config::default().prepare_plan(&file, item, 0).unwrap_err());
        let why = refused(1);
        assert!(
            why.contains("bad.waypoints: item 1: line 3: command: 82"),
            "{why}"
        );
        std::fs::write(&file, plan(47.25)).unwrap();
        let why = refused(2);
        assert!(
            why.ends_with("item to begin with: 2: there is no such item: give 1 to 1"),
            "{why}"
        );
        std::fs::write(&file, "QGC WPL 110\n0 0 0 16 0 0 0 0 47 8 900 1\n").unwrap();
        let why = refused(1);
        assert!(
            why.ends_with("bad.waypoints: items: there are none: give at least one"),
            "{why}"
        );
        let missing = Config::default().prepare_plan(&folder.path().join("no.plan"), 1, 0);
        assert!(refusal(&missing.unwrap_err()).contains("no.plan: cannot be read"));
    }

    #[test]
    fn a_long_refusal_says_how_many_problems_are_left_out() {
        let problems = vec![Problem::of_item(7, "command", "x".repeat(90)); 200];
        let file = "long.plan".to_owned();
        let why = refusal(&FileError::Invalid { file, problems });
        assert!(why.len() < 7_100 && why.ends_with(" more, which fccd plan check lists"));
    }
}
