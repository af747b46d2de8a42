//! Samples → derived values: a state machine without input or output.
//!
//! Samples go in one at a time, in time order and at equal times in the order of their [`Kind`]; derived values
//! come out in time order, at equal times in the order of their [`Quantity`](crate::derived::Quantity). Where the clock
//! was set back, a new epoch begins, with times of its own; nothing is derived from samples of two epochs.
//!
//! The drone's attitude and, if the camera follows it, the gimbal's orientation are interpolated, so an attitude
//! or a velocity is held back until a gimbal angle and an attitude at its time or later have come. Samples are
//! settled in their order: while one waits, all later ones wait. What is held back is bounded by [`MaxGap`]
//! nevertheless: one waits only while the sample that it waits for can still come within the maximum gap of the
//! one before it, because across a longer gap nothing is interpolated. After that nothing can be derived from it,
//! whether the gap ends or not, and it is dropped at once; only the reason is left open, in a count.

mod from_positions;
mod moment;
mod motion;
mod orientation;
mod spacing;
mod track;

use std::{
    collections::{BTreeMap, VecDeque},
    mem,
};

use nalgebra::{Rotation3, Vector3};
use serde::Serialize;

use crate::{
    camera::Camera,
    derived::{Derived, Value},
    geometry::{relative_rpy, velocity_in_camera},
    sample::{
        AttitudeSample, DropReason, GimbalSample, Kind, Sample, Stamp, Tallies, Velocity,
        VelocityFrom, VelocitySample,
    },
};
use from_positions::FromPositions;
pub use moment::{Attitudes, Incident, IncidentKind, Moment};
use motion::Turn;
pub use motion::{Motion, Sighting};
use orientation::{Attitude, Gimbal};
pub use spacing::{MaxGap, MaxGapOutOfRange, MinInterval, MinIntervalOutOfRange};
use track::{Interpolate, Never, Track, Unavailable};

/// What became of the samples that the transform was given.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outcome {
    /// The samples that were used, and those that were not.
    pub tallies: Tallies,
    /// How often the chain of attitude samples broke.
    pub breaks: Breaks,
    /// Motion that no drone makes.
    pub motion: Motion,
}

/// How often the chain of attitude samples broke. Each used attitude sample but the first has a relative
/// rotation or is counted here.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Breaks {
    /// How often the time since the last sample with a known camera exceeded the maximum gap.
    pub gaps: u64,
    /// How often the log's count of attitude resets changed: the estimator jumped, the camera did not.
    pub resets: u64,
    /// How often the time of the log went back, as where a clock was set.
    pub clock_steps: u64,
}

/// A sample that something is derived from, and that is not settled yet.
#[derive(Debug, Clone, Copy)]
enum Held {
    /// An attitude's times; the rest of it is in the track of attitudes.
    Attitude(Stamp),
    Velocity(VelocitySample),
    /// A time for which the attitudes are wanted.
    Asked(u64),
}

impl Held {
    fn time(&self) -> u64 {
        match self {
            Self::Attitude(stamp) => stamp.log_time,
            Self::Velocity(sample) => sample.stamp.log_time,
            Self::Asked(time) => *time,
        }
    }
}

/// Drone and camera at one time.
#[derive(Debug, Clone, Copy)]
struct Pose {
    time: u64,
    attitude: Attitude,
    r_ned_camera: Rotation3<f64>,
}

impl Pose {
    /// A velocity in the camera's axes.
    fn see(&self, velocity: Velocity) -> Vector3<f64> {
        /// Sums of larger components may overflow on the way to a result that does not.
        const LARGE: f64 = 1e300;
        let (Velocity::Ned(vector) | Velocity::Frd(vector)) = velocity;
        // A power of two, so that no digit is lost.
        let scale = if vector.amax() > LARGE { 65536.0 } else { 1.0 };
        let vector = vector / scale;
        let velocity_ned = match velocity {
            Velocity::Ned(_) => vector,
            Velocity::Frd(_) => self.attitude.q_ned_drone * vector,
        };
        velocity_in_camera(&self.r_ned_camera, &velocity_ned) * scale
    }
}

/// Turns samples of the drone into derived values for its camera.
#[derive(Debug)]
pub struct Transform {
    camera: Camera,
    max_gap: MaxGap,
    min_interval: MinInterval,
    attitudes: Track<Attitude>,
    last_attitude_time: Option<u64>,
    gimbal: Track<Gimbal>,
    /// Makes the velocities, if they are not in messages. In a box, so that it is quickly taken out for each sample.
    from_positions: Option<Box<FromPositions>>,
    last_velocity_time: Option<u64>,
    /// Attitudes and velocities that are not settled, in their order.
    held: VecDeque<Held>,
    /// The last attitude sample of this epoch for which the camera is known.
    previous: Option<Pose>,
    /// The last velocity, and its time.
    previous_velocity: Option<(u64, Vector3<f64>)>,
    /// Whether an earlier epoch had one, and this one has not.
    is_after_clock_step: bool,
    /// What happens, if it is wanted.
    moments: Option<Vec<Moment>>,
    /// How many samples of the second kind were dropped because the last one of the first kind is out of reach.
    out_of_reach: BTreeMap<(Kind, Kind), u64>,
    outcome: Outcome,
}

impl Transform {
    /// Creates a transform that has seen no sample yet, and takes velocities from samples of them.
    pub fn new(camera: Camera, max_gap: MaxGap) -> Self {
        Self {
            camera,
            max_gap,
            min_interval: MinInterval::default(),
            attitudes: Track::new(max_gap),
            last_attitude_time: None,
            gimbal: Track::new(max_gap),
            from_positions: None,
            last_velocity_time: None,
            held: VecDeque::new(),
            previous: None,
            previous_velocity: None,
            is_after_clock_step: false,
            moments: None,
            out_of_reach: BTreeMap::new(),
            outcome: Outcome::default(),
        }
    }

    /// Leaves out attitude samples that are closer than this to the one before.
    #[must_use]
    pub fn thinned(self, min_interval: MinInterval) -> Self {
        Self {
            min_interval,
            ..self
        }
    }

    /// Takes velocities from something else, from the first sample on.
    #[must_use]
    pub fn with_velocity_from(self, source: VelocityFrom) -> Self {
        Self {
            from_positions: (source == VelocityFrom::Position)
                .then(|| Box::new(FromPositions::new(self.max_gap))),
            ..self
        }
    }

    /// Keeps all moments, to be [taken](Self::take_moments).
    #[must_use]
    pub fn with_moments(self) -> Self {
        Self {
            moments: Some(Vec::new()),
            ..self
        }
    }

    /// Asks for the attitudes at a time, in nanoseconds: not before that of the last sample, and not after that of the
    /// next.
    pub fn ask(&mut self, time: u64) {
        self.held.push_back(Held::Asked(time));
    }

    /// The moments since they were last taken, in the order of their times.
    pub fn take_moments(&mut self) -> impl Iterator<Item = Moment> {
        self.moments
            .iter_mut()
            .flat_map(|moments| moments.drain(..))
    }

    /// Takes the next sample and appends to `out` what can be derived now.
    ///
    /// Samples that nothing is derived from are ignored and not counted: those of a gimbal that the camera does not
    /// follow; heights; positions, unless velocities are taken from them, and then velocities.
    pub fn push(&mut self, sample: Sample, out: &mut Vec<Derived>) {
        match self.from_positions.take() {
            None => self.take(sample, out),
            Some(mut from_positions) => {
                from_positions.push(sample, |sample| self.take(sample, out));
                self.from_positions = Some(from_positions);
            }
        }
    }

    fn take(&mut self, sample: Sample, out: &mut Vec<Derived>) {
        if self.is_too_close(&sample) {
            return self.count_dropped(Kind::Attitude, DropReason::TooClose, 1);
        }
        let is_first_at_its_time = match sample {
            Sample::Gimbal(sample) if self.camera == Camera::Gimbal => self.push_gimbal(&sample),
            Sample::Attitude(sample) => self.push_attitude(&sample),
            Sample::Velocity(sample) => self.push_velocity(&sample),
            Sample::Gimbal(_)
            | Sample::Position(_)
            | Sample::Height(_)
            | Sample::AngularRate(_)
            | Sample::Acceleration(_) => return,
        };
        if is_first_at_its_time {
            self.settle(Some(sample.stamp().log_time), out);
        } else {
            self.count_dropped(sample.kind(), DropReason::DuplicateTime, 1);
        }
    }

    /// Begins a new epoch, and appends to `out` what can be derived of the last one: the samples that follow have times
    /// that are not related to those so far. Samples that still wait for others are dropped.
    pub fn begin_epoch(&mut self, out: &mut Vec<Derived>) {
        self.end_epoch(out);
        self.attitudes = Track::new(self.max_gap);
        self.gimbal = Track::new(self.max_gap);
        self.last_attitude_time = None;
        self.last_velocity_time = None;
        self.previous_velocity = None;
        self.is_after_clock_step |= self.previous.take().is_some();
    }

    /// Ends the run, and appends to `out` what can be derived now. Samples that still wait for others are dropped.
    pub fn finish(&mut self, out: &mut Vec<Derived>) -> Outcome {
        self.end_epoch(out);
        if let Some(from_positions) = self.from_positions.take() {
            self.outcome.tallies[Kind::Position] = from_positions.tally;
        }
        mem::take(&mut self.outcome)
    }

    fn end_epoch(&mut self, out: &mut Vec<Derived>) {
        if let Some(mut from_positions) = self.from_positions.take() {
            from_positions.end(|sample| self.take(sample, out));
            self.from_positions = Some(from_positions);
        }
        // Nothing more is derived: every held sample either waits or is later than one that does.
        self.settle(None, &mut Vec::new());
        self.settle_out_of_reach(Kind::Attitude, Attitude::OUTSIDE);
        self.settle_out_of_reach(Kind::Gimbal, Gimbal::OUTSIDE);
    }

    /// Whether this is an attitude that is left out because of the one before.
    fn is_too_close(&mut self, sample: &Sample) -> bool {
        let Sample::Attitude(AttitudeSample { stamp, .. }) = sample else {
            return false;
        };
        let last = self.last_attitude_time;
        // One at the same time is a duplicate.
        let since = last
            .and_then(|last| stamp.log_time.checked_sub(last))
            .filter(|&since| since > 0);
        let is_too_close = since.is_some_and(|since| self.min_interval.exceeds(since));
        if !is_too_close {
            self.last_attitude_time = Some(stamp.log_time);
        }
        is_too_close
    }

    fn push_gimbal(&mut self, sample: &GimbalSample) -> bool {
        let is_first = self.gimbal.push(sample.stamp.log_time, sample.into());
        if is_first {
            self.outcome.tallies[Kind::Gimbal].used += 1;
            self.settle_out_of_reach(Kind::Gimbal, Gimbal::IN_GAP);
        }
        is_first
    }

    fn push_attitude(&mut self, sample: &AttitudeSample) -> bool {
        let is_first = (self.attitudes).push(sample.stamp.log_time, sample.into());
        if is_first {
            self.settle_out_of_reach(Kind::Attitude, Attitude::IN_GAP);
            self.held.push_back(Held::Attitude(sample.stamp));
        }
        is_first
    }

    fn push_velocity(&mut self, sample: &VelocitySample) -> bool {
        let time = sample.stamp.log_time;
        let is_first = self.last_velocity_time.replace(time) != Some(time);
        if is_first {
            self.held.push_back(Held::Velocity(*sample));
        }
        is_first
    }

    /// Settles what is held, up to the first sample that must wait. No sample will come before `soonest`, or
    /// none at all.
    fn settle(&mut self, soonest: Option<u64>, out: &mut Vec<Derived>) {
        while let Some(&sample) = self.held.front() {
            let pose = match self.pose_at(sample.time(), soonest) {
                Ok(pose) => Ok(pose),
                Err(Unavailable::Forever(never)) => Err(never),
                Err(Unavailable::Yet) => break,
            };
            match (sample, pose) {
                (Held::Asked(time), pose) => self.answer(time, pose),
                (Held::Attitude(stamp), Ok(pose)) => self.derive_from_attitude(stamp, pose, out),
                (Held::Velocity(sample), Ok(pose)) => {
                    self.derive_from_velocity(&sample, pose, out);
                }
                (Held::Attitude(_), Err(never)) => self.drop_for(Kind::Attitude, never),
                (Held::Velocity(_), Err(never)) => self.drop_for(Kind::Velocity, never),
            }
            self.held.pop_front();
        }
        let oldest = self.held.front();
        let needed_from = oldest.map_or(u64::MAX, Held::time);
        self.attitudes.forget_before(needed_from);
        self.gimbal.forget_before(needed_from);
    }

    #[inline]
    fn pose_at(&self, time: u64, soonest: Option<u64>) -> Result<Pose, Unavailable> {
        let attitude = self.attitudes.at(time, soonest)?;
        let gimbal = || {
            let gimbal = self.gimbal.at(time, soonest)?;
            Ok::<_, Unavailable>((gimbal.q_reference_camera, gimbal.reference))
        };
        let r_ned_camera = self
            .camera
            .orientation(&attitude.q_ned_drone, gimbal)?
            .ok_or(DropReason::UndefinedHeading)?;
        Ok(Pose {
            time,
            attitude,
            r_ned_camera,
        })
    }

    fn derive_from_attitude(&mut self, stamp: Stamp, pose: Pose, out: &mut Vec<Derived>) {
        let turn = self.turn_to(pose);
        let values = turn
            .into_iter()
            .chain([Value::Orientation(pose.r_ned_camera)]);
        self.outcome.tallies[Kind::Attitude].used += 1;
        out.extend(values.map(|value| Derived { stamp, value }));
    }

    fn derive_from_velocity(
        &mut self,
        sample: &VelocitySample,
        pose: Pose,
        out: &mut Vec<Derived>,
    ) {
        let velocity = pose.see(sample.velocity);
        let value = Value::CameraVelocity(velocity);
        if !value.is_finite() {
            return self.count_dropped(Kind::Velocity, DropReason::TooLarge, 1);
        }
        self.note_velocity(pose.time, pose.r_ned_camera * velocity);
        self.outcome.tallies[Kind::Velocity].used += 1;
        let stamp = sample.stamp;
        out.push(Derived { stamp, value });
    }

    /// Answers what was asked for a time.
    fn answer(&mut self, time: u64, pose: Result<Pose, Never>) {
        let attitudes = pose.map(Attitudes::from).map_err(DropReason::from);
        self.note(Moment::Asked { time, attitudes });
    }

    fn note(&mut self, moment: Moment) {
        if let Some(moments) = &mut self.moments {
            moments.push(moment);
        }
    }

    fn note_incident(&mut self, from: u64, to: u64, kind: IncidentKind) {
        self.note(Moment::Incident(Incident { from, to, kind }));
    }

    /// Counts a sample for which the camera is not known.
    fn drop_for(&mut self, kind: Kind, never: Never) {
        match never {
            Never::For(reason) => self.count_dropped(kind, reason, 1),
            Never::OutOfReach(of) => {
                *self.out_of_reach.entry((of, kind)).or_default() += 1;
            }
        }
    }

    /// How the camera turned since the previous attitude sample, unless the chain broke in between.
    fn turn_to(&mut self, pose: Pose) -> Option<Value> {
        let Some(previous) = self.previous.replace(pose) else {
            if mem::take(&mut self.is_after_clock_step) {
                self.outcome.breaks.clock_steps += 1;
                self.note_incident(pose.time, pose.time, IncidentKind::ClockStep);
            }
            return None;
        };
        if !self.max_gap.spans(previous.time, pose.time) {
            self.outcome.breaks.gaps += 1;
            self.note_incident(previous.time, pose.time, IncidentKind::Gap);
            return None;
        }
        if !previous.attitude.has_same_origin(&pose.attitude) {
            self.outcome.breaks.resets += 1;
            self.note_incident(previous.time, pose.time, IncidentKind::Reset);
            return None;
        }
        let incident = self.outcome.motion.note_turn(&Turn {
            time: pose.time,
            interval: pose.time - previous.time,
            q_ned_drone: [previous, pose].map(|pose| pose.attitude.q_ned_drone),
            r_ned_camera: [previous, pose].map(|pose| pose.r_ned_camera),
        });
        if let Some(kind) = incident {
            self.note_incident(previous.time, pose.time, kind);
        }
        Some(Value::RelativeRpy {
            interval: pose.time - previous.time,
            rpy: relative_rpy(&previous.r_ned_camera, &pose.r_ned_camera),
        })
    }

    fn note_velocity(&mut self, time: u64, velocity_ned: Vector3<f64>) {
        self.note(Moment::Velocity {
            time,
            ned: velocity_ned,
        });
        let previous = self.previous_velocity.replace((time, velocity_ned));
        if let Some((earlier, before)) = previous
            && self.max_gap.spans(earlier, time)
        {
            let change = velocity_ned - before;
            let incident = (self.outcome.motion).note_change(time, time - earlier, &change);
            if let Some(kind) = incident {
                self.note_incident(earlier, time, kind);
            }
        }
    }

    /// Sets the reason for samples that were dropped because the last one of this kind is out of reach.
    fn settle_out_of_reach(&mut self, of: Kind, reason: DropReason) {
        for kind in Kind::ALL {
            if let Some(count) = self.out_of_reach.remove(&(of, kind)) {
                self.count_dropped(kind, reason, count);
            }
        }
    }

    fn count_dropped(&mut self, kind: Kind, reason: DropReason, count: u64) {
        self.outcome.tallies[kind].count_dropped(reason, count);
    }
}
