//! Recording a flight for viewers, and making what they are shown of it, on a thread of its own while it is written.

use std::{
    iter::Peekable,
    mem,
    sync::{
        Arc,
        mpsc::{self, SyncSender},
    },
    thread::Scope,
};

use crate::{
    camera::FieldOfView,
    derived::visual::{Calibration, Shown},
    log::{Log, ReadError},
    options::Options,
    run::RunError,
    source::{
        calibration::{self, LogCalibration},
        profile::Profile,
    },
    transform::MaxGap,
    visuals::{Flight, FlightRecorder, Show, StagedFlight, VisualOptions},
};

/// How many messages are handed over at once.
const BATCH: usize = 256;

/// How many batches may wait.
const BATCHES: usize = 4;

type Batch = Vec<(u32, Shown)>;

/// How a flight is recorded and made ready to be shown.
pub struct Staging<'a> {
    log: &'a Log,
    options: &'a VisualOptions,
    max_gap: MaxGap,
    /// What the profile says that the camera sees, if the caller does not.
    of_profile: Option<FieldOfView>,
    /// The log's own calibration, if neither does.
    pub calibration: Option<LogCalibration>,
}

impl<'a> Staging<'a> {
    /// For a log whose telemetry is in `telemetry`; `None` if viewers are shown nothing.
    ///
    /// # Errors
    /// The log cannot be read.
    pub fn new(
        telemetry: &'a Log,
        options: &'a Options,
        profile: &Profile,
    ) -> Result<Option<Self>, ReadError> {
        let Some(visuals) = &options.visuals else {
            return Ok(None);
        };
        let of_profile = options.field_of_view_from(profile);
        Ok(Some(Self {
            log: telemetry,
            options: visuals,
            max_gap: options.max_gap,
            of_profile,
            calibration: match visuals.says_what_the_camera_sees() || of_profile.is_some() {
                true => None,
                false => calibration::find(telemetry)?,
            },
        }))
    }

    /// What records the flight.
    pub fn recorder(&self) -> FlightRecorder {
        FlightRecorder::new(self.options, self.max_gap)
    }

    /// Makes a flight ready to be shown.
    ///
    /// # Errors
    /// It was too long to be recorded.
    pub fn stage(&self, flight: Flight) -> Result<Arc<StagedFlight>, RunError> {
        if flight.is_cut_short {
            return Err(RunError::FlightTooLong {
                path: self.log.file.path().into(),
                moments: flight.ticks.len(),
            });
        }
        let of_profile = self.of_profile.map(FieldOfView::calibration);
        let of_log = self.calibration.as_ref().map(Calibration::from);
        let calibration = of_profile.or(of_log);
        Ok(Arc::new(StagedFlight::new(
            flight,
            self.options,
            calibration,
        )))
    }
}

/// What is shown, epoch by epoch in the order of its times.
pub struct Showing(Peekable<std::iter::Flatten<mpsc::IntoIter<Batch>>>);

impl Showing {
    /// Starts the thread. If this is dropped, it ends.
    pub fn start<'scope>(scope: &'scope Scope<'scope, '_>, flight: &Arc<StagedFlight>) -> Self {
        let flight = Arc::clone(flight);
        let (batches, shown) = mpsc::sync_channel(BATCHES);
        scope.spawn(move || show(&flight, &batches));
        Self(shown.into_iter().flatten().peekable())
    }

    /// The next message before a time in an epoch.
    pub fn next_before(&mut self, epoch: u32, time: u64) -> Option<(u32, Shown)> {
        (self.0).next_if(|(its, shown)| (*its, shown.time) < (epoch, time))
    }
}

impl Iterator for Showing {
    type Item = (u32, Shown);

    fn next(&mut self) -> Option<Self::Item> {
        self.0.next()
    }
}

/// The thread's work. Sending fails when nobody wants any more; that is no error of this thread.
fn show(flight: &StagedFlight, batches: &SyncSender<Batch>) {
    let mut batch = Vec::with_capacity(BATCH);
    let sent = Show::new(flight).each(|epoch, shown| {
        batch.push((epoch, shown));
        match batch.len() < BATCH {
            true => Ok(()),
            false => batches.send(mem::replace(&mut batch, Vec::with_capacity(BATCH))),
        }
    });
    if sent.is_ok() {
        let _ = batches.send(batch);
    }
}
