//! Prevents two daemons from controlling one plant.
//!
//! Two daemons that read the same engage switch would both take control and
//! overwrite each other's outputs. The first locks the [file](super::plant_file)
//! of the plant; the kernel unlocks it when the process ends for any reason.
//! Only daemons of one user share the file: another user's cannot prevent a
//! start, and is found by what it writes.
//!
//! The file is that of the plant, not of its configuration: a daemon that
//! follows a beacon locks after it has received the address, and takes no
//! control before.

use std::fmt;
use std::sync::Arc;

use fcc_core::framework::{ControlAuthority, PlantId};
use fcc_telemetry::RunFolder;

use super::notice::Notice;
use super::plant_file::PlantFile;
use super::release_handover;
use crate::output;

/// What became of a lock whose file, or folder, was removed.
#[derive(Debug)]
pub(super) enum Removed {
    MadeAnew(PlantId),
    /// It is tried again.
    Not(PlantId, String),
}

impl fmt::Display for Removed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::MadeAnew(plant) => write!(
                f,
                "the file that locks {plant} was removed in flight, and was made anew"
            ),
            Self::Not(plant, why) => write!(
                f,
                "the file that locks {plant} was removed in flight, and cannot be made anew: {why}"
            ),
        }
    }
}

/// The right to control a plant; released when dropped.
pub(super) struct InstanceLock {
    authority: Arc<dyn ControlAuthority>,
    folder: Option<RunFolder>,
    notice: &'static Notice,
    claim: Claim,
    /// The last attempt to make a removed file anew has failed.
    is_missing: bool,
}

enum Claim {
    /// No plant is known yet.
    NoPlant,
    /// Without a file, two daemons are not prevented.
    Locked {
        plant: PlantId,
        file: Option<PlantFile>,
    },
    /// Another daemon controls it.
    Taken(PlantId),
}

impl InstanceLock {
    /// Locks the connected plant, if it is known yet. Control is taken only of
    /// a locked plant.
    pub(super) fn of(
        authority: Arc<dyn ControlAuthority>,
        folder: Option<RunFolder>,
        notice: &'static Notice,
    ) -> Self {
        authority.require_permission();
        Self {
            authority,
            folder,
            notice,
            claim: Claim::NoPlant,
            is_missing: false,
        }
    }

    /// Locks the plant that was found since. It does not change while its
    /// controls are held, so that no plant under control is unlocked. Returns
    /// whether an earlier daemon has left its controls held.
    pub(super) fn follow(&mut self) -> bool {
        let Some(plant) = self.authority.plant() else {
            return false;
        };
        if matches!(self.claim, Claim::Locked { plant: of, .. } | Claim::Taken(of) if of == plant) {
            return false;
        }
        self.claim = self.lock(plant);
        let Claim::Locked { file, .. } = &self.claim else {
            return false;
        };
        self.authority.permit(&plant);
        file.as_ref().is_some_and(PlantFile::is_held)
    }

    fn lock(&self, plant: PlantId) -> Claim {
        let without = Claim::Locked { plant, file: None };
        let Some(folder) = &self.folder else {
            return without;
        };
        let unique = self.authority.unique(&plant);
        let Some(locked) = PlantFile::locked(folder, &unique).transpose() else {
            return Claim::Taken(plant);
        };
        // Another opening of the same file: this one's end does not unlock.
        let files = locked.and_then(|locked| Ok((locked, PlantFile::open(folder, &unique)?)));
        match files {
            Ok((locked, told)) => {
                reserve(&told, plant);
                self.notice.add_file(plant, told);
                let file = Some(locked);
                Claim::Locked { plant, file }
            }
            Err(error) => {
                output::message(format!(
                    "{plant} cannot be locked ({error}): a second fccd is not prevented"
                ));
                without
            }
        }
    }

    /// The folder of the locks.
    pub(super) const fn folder(&self) -> Option<&RunFolder> {
        self.folder.as_ref()
    }

    /// Makes the lock anew if its file or folder was removed; `held` is what is
    /// held. Says it once.
    pub(super) fn make_anew_if_removed(&mut self, held: Option<PlantId>) -> Option<Removed> {
        let Claim::Locked {
            plant,
            file: Some(file),
        } = &self.claim
        else {
            return None;
        };
        if file.is_in_place() {
            return None;
        }
        let plant = *plant;
        match self.make_anew(plant, held) {
            Ok(file) => {
                let file = Some(file);
                self.claim = Claim::Locked { plant, file };
                self.is_missing = false;
                Some(Removed::MadeAnew(plant))
            }
            Err(why) => {
                let is_new = !std::mem::replace(&mut self.is_missing, true);
                is_new.then_some(Removed::Not(plant, why))
            }
        }
    }

    fn make_anew(&mut self, plant: PlantId, held: Option<PlantId>) -> Result<PlantFile, String> {
        let mut refused = Vec::new();
        let folder = RunFolder::of_this_process(&mut |why| refused.push(why));
        let folder = folder.ok_or_else(|| refused.join("; "))?;
        let unique = self.authority.unique(&plant);
        let locked = PlantFile::locked(&folder, &unique).map_err(|error| error.to_string())?;
        let locked = locked
            .ok_or("another fccd locked it meanwhile; end one of them, or both write to it")?;
        let told = PlantFile::open(&folder, &unique).map_err(|error| error.to_string())?;
        reserve(&told, plant);
        if !self.notice.replace_file(plant, told, held) {
            return Err("it was removed too often: find the program that removes it".to_owned());
        }
        self.folder = Some(folder);
        Ok(locked)
    }

    /// The plant, if another daemon controls it.
    pub(super) const fn taken(&self) -> Option<PlantId> {
        match self.claim {
            Claim::Taken(plant) => Some(plant),
            Claim::NoPlant | Claim::Locked { .. } => None,
        }
    }

    /// The process is about to end, and its controls are released.
    pub(super) fn remove_files(&self) {
        if let Claim::Locked {
            plant,
            file: Some(file),
        } = &self.claim
        {
            file.remove_if_released();
            if let Some(folder) = &self.folder {
                release_handover::remove_file(folder, &self.authority.unique(plant));
            }
        }
    }
}

/// Before control is taken: the loop's thread does not report what it cannot
/// store.
fn reserve(file: &PlantFile, plant: PlantId) {
    if let Err(error) = file.reserve() {
        output::message(format!(
            "that {plant} is held cannot be stored ({error}): if this process and its release \
             helper are both killed, release the controls by hand"
        ));
    }
}
