//! Watches a loop whose types the program has.

use std::marker::PhantomData;
use std::ops::{Deref, DerefMut};

use fcc_core::framework::RecordOf;

use super::WatchError;
use super::row_watcher::RowWatcher;
use fcc_telemetry::schema::{RecordDescription, read_words};
use fcc_telemetry::{Instance, Telemetry};

/// Watches a flight on this machine.
#[cfg(feature = "flight")]
pub type Watcher = WatcherOf<fcc_fixed_wing::Autopilot>;

/// Watches a loop on this machine, from this or another process: events, status
/// and end as [`RowWatcher`], its records as structs.
///
/// ```no_run
/// use fcc_telemetry::Instance;
/// use fcc_live::Watcher;
///
/// let mut watcher = Watcher::open(&Instance::default())?;
/// println!("{} Hz by {}", watcher.info().rate_hz, watcher.info().timer);
/// while watcher.is_alive() {
///     if let Some(record) = watcher.latest()? {
///         println!("{} m", record.measurements.altitude_m.value);
///     }
///     std::thread::sleep(std::time::Duration::from_millis(100));
/// }
/// # Ok::<(), fcc_live::WatchError>(())
/// ```
#[derive(Debug)]
pub struct WatcherOf<C: Telemetry> {
    rows: RowWatcher,
    of: PhantomData<fn() -> C>,
}

impl<C: Telemetry> WatcherOf<C> {
    /// Starts to watch, as [`RowWatcher::open`].
    ///
    /// # Errors
    /// As there, and when the loop is of another plant.
    pub fn open(instance: &Instance) -> Result<Self, WatchError> {
        let rows = RowWatcher::open(instance)?;
        let own = RecordDescription::of::<RecordOf<C>>();
        if rows.columns().is_of_another_plant(&own) {
            return Err(WatchError::AnotherPlant {
                instance: instance.clone(),
                plant: rows.info().plant.as_str().to_owned(),
            });
        }
        if !rows.columns().has_layout_of(&own) {
            return Err(WatchError::Damaged(instance.clone()));
        }
        Ok(Self {
            rows,
            of: PhantomData,
        })
    }

    /// The newest record not returned yet; earlier ones are skipped.
    ///
    /// # Errors
    /// When it is not a valid record, or shared memory fails.
    pub fn latest(&mut self) -> Result<Option<RecordOf<C>>, WatchError> {
        let found = self.rows.newest(read_words::<RecordOf<C>>)?;
        self.valid(found)
    }

    /// The next record; none if there is none yet. A watcher that polls less
    /// often than each second at 1 kHz misses records: the ticks' numbers show
    /// it.
    ///
    /// # Errors
    /// When it is not a valid record, or shared memory fails.
    pub fn next_record(&mut self) -> Result<Option<RecordOf<C>>, WatchError> {
        let found = self.rows.next(read_words::<RecordOf<C>>)?;
        self.valid(found)
    }

    fn valid<E>(
        &self,
        found: Option<Result<RecordOf<C>, E>>,
    ) -> Result<Option<RecordOf<C>>, WatchError> {
        let found = found.transpose();
        found.map_err(|_| WatchError::Damaged(self.rows.instance().clone()))
    }
}

impl<C: Telemetry> Deref for WatcherOf<C> {
    type Target = RowWatcher;

    fn deref(&self) -> &RowWatcher {
        &self.rows
    }
}

impl<C: Telemetry> DerefMut for WatcherOf<C> {
    fn deref_mut(&mut self) -> &mut RowWatcher {
        &mut self.rows
    }
}
