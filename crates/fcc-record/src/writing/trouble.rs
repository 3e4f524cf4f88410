//! What happens when the disk fails, and how it is reported.

use std::fmt::Write as _;
use std::io;
use std::time::Instant;

use super::super::lost::Lost;
use super::super::part::Abandoned;
use super::super::status::Notice;
use super::Writing;
use super::files::is_full;
use crate::recorded::Recorded;

/// The most remarks kept for the next file while there is none.
const MAX_REMARKS_KEPT: usize = 100;

impl<C: Recorded> Writing<C> {
    /// The disk failed: makes room if permitted, or stops for now. The file
    /// stays as it was when last committed.
    pub(super) fn fail(&mut self, error: &io::Error) {
        let Some(part) = self.part.take() else {
            return;
        };
        let Abandoned {
            path,
            kept,
            ticks,
            bytes,
            gaps,
            lost,
            remarks,
        } = part.abandon();
        self.ticks_before += ticks;
        self.bytes_before += bytes;
        self.lost.join(gaps);
        self.lost.join(lost);
        for text in remarks {
            self.note(text);
        }
        if !kept {
            self.about.part -= 1;
        }
        self.board.update(|status| {
            status.file = None;
            status.not_recorded += lost.count;
            status.files.retain(|file| kept || *file != path);
        });
        let what = format!("{}: {error}", path.display());
        if is_full(error) && self.make_room() {
            self.report(
                format!("{what}; {}", self.lost.description(self.has_gaps)),
                true,
            );
            self.begin();
        } else {
            self.stop(what);
        }
    }

    /// Another program deleted or changed the file: begins the next part, which
    /// reports the gap.
    pub(super) fn lose_file(&mut self, what: &str, lost: Lost) {
        let Some(part) = self.part.take() else {
            return;
        };
        self.lost.join(lost);
        self.board.update(|status| {
            status.not_recorded += lost.count;
            status.files.retain(|file| file != part.path());
        });
        let lost = self.lost.description(self.has_gaps);
        self.has_gaps = true;
        let text = format!("{}: {what} in flight; {lost}", part.path().display());
        self.report(text, true);
        self.begin();
    }

    /// Records nothing until the next attempt. Reported once, however many
    /// attempts fail.
    pub(super) fn stop(&mut self, why: String) {
        let is_new = self.trouble.replace(why).is_none();
        if is_new {
            let mut text = format!("recording stopped: {}", self.trouble_text());
            if !self.ended {
                let every_s = self.settings.retry_every.as_secs_f64();
                let _ = write!(
                    text,
                    ". The flight continues unrecorded; recording is tried again every {every_s} s"
                );
            }
            self.report(text, true);
        }
        self.post_trouble();
        self.acted = Instant::now();
    }

    pub(super) fn post_trouble(&self) {
        let text = self.trouble_text();
        self.board.update(|status| status.stopped = Some(text));
    }

    fn trouble_text(&self) -> String {
        let why = self.trouble.as_deref().unwrap_or_default();
        if self.lost.is_none() {
            why.to_owned()
        } else {
            format!("{why}; {}", self.lost.description(self.has_gaps))
        }
    }

    /// Reports that the disk works again, if it had failed.
    pub(super) fn end_trouble(&mut self, gaps: Lost) {
        if let (Some(part), Some(_)) = (&self.part, self.trouble.take()) {
            let mut lost = gaps;
            lost.join(self.lost);
            let path = part.path().display();
            let text = format!(
                "recording continues in {path}: {}",
                lost.description(self.has_gaps)
            );
            self.report(text, true);
            self.board.update(|status| status.stopped = None);
        }
    }

    /// Reports to the user and in the file.
    pub(super) fn report(&mut self, text: String, is_trouble: bool) {
        self.announce(text.clone(), is_trouble);
        self.note(text);
    }

    pub(super) fn announce(&self, text: String, is_trouble: bool) {
        // The flight may have ended already.
        let _ = self.notices.send(Notice { text, is_trouble });
    }

    /// Writes a remark to the file, or keeps it for the next one.
    pub(super) fn note(&mut self, text: String) {
        if self.part.is_some() {
            self.attempt(|part| part.remark(text));
        } else if self.remarks.len() < MAX_REMARKS_KEPT {
            self.remarks.push(text);
        }
    }
}
