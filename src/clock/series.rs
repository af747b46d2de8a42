//! The times of a series of messages in the order of the file, and where they go back for good.
//!
//! A clock that was set back and messages that were written late look alike at first; what follows tells them apart.
//! After a step, time runs on in order from there, message after message at the usual rate, through times that the series
//! has had already: for a while it has twice as many messages as it should. Messages that a recorder or a converter wrote
//! late are those that are missing elsewhere, be they single ones, buffers, halves of the file or all of it from its end.
//! So what goes back begins a new epoch if
//!
//! - it runs on through times that the series has already, or
//! - it runs on before all of them, and apart from them, as where a recorder was restarted with an earlier time.
//!
//! Else it is late, and sorted in. In a series that goes back again and again nothing can be told, and all of it is sorted.
//!
//! Sequence numbers would tell as well, but hardly a recorder writes them: rosbag2 and most converters write 0.

use std::ops::Range;

/// A message that is earlier than one before it by no more than this is late, nanoseconds. Recorders with several
/// threads and buffers write messages in disorder, but within a fraction of a second. What keeps a clock right sets it
/// only if it is off by about as much (ntpd 0.128 s, systemd-timesyncd 0.4 s, chrony as it is usually configured 1 s);
/// otherwise it makes the clock run faster or slower.
pub const LATE: u64 = 250_000_000;

/// A longer time between two messages is a gap, however rare the messages are.
const GAP: u64 = 5_000_000_000;

/// In a series that is in order, time goes back less often than once in so many messages.
const STEADY: usize = 8;

/// A clock is not set more often than this. It bounds the work, too.
const MOST_STEPS: usize = 1000;

/// The place of a message in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// The number of its segment in the log.
    pub segment: u32,
    /// Its own number among the messages that are read from that segment.
    pub message: u32,
}

/// The times of a series of messages, in the order of the file.
#[derive(Debug, Clone, Default)]
pub struct Series(Vec<Moment>);

#[derive(Debug, Clone, Copy)]
struct Moment {
    time: u64,
    place: Place,
}

/// Where the times of a series go back for good.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    /// The last message before the step.
    pub last: Place,
    /// The first message after it.
    pub first: Place,
    /// The number of that in the series, counted from 1.
    pub message: u64,
    /// The latest time before the step.
    pub before: u64,
    /// The time after it.
    pub after: u64,
}

impl Place {
    /// Of the message with that number in a segment. A log has fewer of either than can be counted with 32 bits.
    pub fn new(segment: usize, message: usize) -> Self {
        Self {
            segment: segment as u32,
            message: message as u32,
        }
    }
}

impl Series {
    /// Takes the next message.
    pub fn push(&mut self, place: Place, time: u64) {
        self.0.push(Moment { time, place });
    }

    /// The places of its first and its last message.
    pub(super) fn range(&self) -> Option<(Place, Place)> {
        Some((self.0.first()?.place, self.0.last()?.place))
    }

    /// Whether time runs on at a place, between the message before it and the next, although a clock that is set back by
    /// `length` would be noticed.
    pub(super) fn runs_on_through(&self, place: Place, length: u64) -> bool {
        let next = self.0.partition_point(|moment| moment.place < place);
        let (before, after) = self.0.split_at(next);
        before
            .last()
            .zip(after.first())
            .is_some_and(|(before, after)| {
                after.time >= before.time.saturating_sub(LATE)
                    && length > LATE.saturating_add(reach(&self.0))
            })
    }

    /// Where its times go back for good.
    pub(super) fn steps(&self) -> Vec<Step> {
        let moments = &self.0;
        let back = moments
            .windows(2)
            .filter(|pair| pair[1].time < pair[0].time);
        let back = back.count();
        if back == 0 || back > moments.len() / STEADY {
            return Vec::new();
        }
        let starts = Order {
            moments,
            reach: reach(moments),
        }
        .epochs();
        let step = |&(start, before): &(usize, u64)| Step {
            last: moments[start - 1].place,
            first: moments[start].place,
            message: start as u64 + 1,
            before,
            after: moments[start].time,
        };
        starts.iter().map(step).collect()
    }
}

/// The longest time between two messages that still follow one another: somewhat more than it hardly ever is.
fn reach(moments: &[Moment]) -> u64 {
    let pairs = moments.windows(2);
    let times = pairs.filter_map(|pair| pair[1].time.checked_sub(pair[0].time));
    let mut times: Vec<u64> = times.filter(|time| (1..=GAP).contains(time)).collect();
    let most = times.len() * 19 / 20;
    if most == times.len() {
        return 0;
    }
    let (_, &mut long, _) = times.select_nth_unstable(most);
    long * 5 / 2
}

/// Messages that follow one another, the next never much later or earlier than the latest so far.
#[derive(Debug, Clone)]
struct Run {
    messages: Range<usize>,
    start: u64,
    earliest: u64,
    latest: u64,
}

impl Run {
    fn length(&self) -> u64 {
        self.latest - self.earliest
    }

    /// The usual time between two of its messages.
    fn interval(&self) -> u64 {
        let intervals = self.messages.len() as u64 - 1;
        (self.length() / intervals.max(1)).max(1)
    }

    /// What takes no longer than this may be late.
    fn late(&self) -> u64 {
        LATE.max(3 * self.interval())
    }
}

/// What an epoch has had so far.
struct Epoch {
    /// The number of its first message.
    start: usize,
    /// Whether it begins with a step.
    follows_step: bool,
    earliest: u64,
    latest: u64,
}

impl Epoch {
    fn new(run: &Run, follows_step: bool) -> Self {
        Self {
            start: run.messages.start,
            follows_step,
            earliest: run.earliest,
            latest: run.latest,
        }
    }

    fn add(&mut self, run: &Run) {
        self.earliest = self.earliest.min(run.earliest);
        self.latest = self.latest.max(run.latest);
    }

    fn is_ahead_of(&self, run: &Run) -> bool {
        run.start < self.latest.saturating_sub(LATE)
    }
}

/// The order of a series.
struct Order<'a> {
    moments: &'a [Moment],
    reach: u64,
}

impl Order<'_> {
    /// The first messages of epochs, from the second one on, each with the latest time before it. Epochs are told by runs
    /// that are too long to be late.
    fn epochs(&self) -> Vec<(usize, u64)> {
        let runs = self.runs().filter(|run| run.length() > run.late());
        let runs: Vec<Run> = runs.collect();
        let mut starts = Vec::new();
        let mut epoch: Option<Epoch> = None;
        let mut going_back = 0;
        for (number, run) in runs.iter().enumerate() {
            if let Some(epoch) = epoch.as_mut().filter(|epoch| !epoch.is_ahead_of(run)) {
                epoch.add(run);
                continue;
            }
            going_back += 1;
            if going_back > MOST_STEPS {
                return Vec::new();
            }
            match &mut epoch {
                Some(epoch) if !self.leaves(epoch, &runs[number..]) => epoch.add(run),
                epoch => {
                    let before = epoch.replace(Epoch::new(run, number > 0));
                    let earlier = number.checked_sub(1).map(|number| &runs[number]);
                    starts.extend(before.zip(earlier).map(|(before, earlier)| {
                        (self.start(run, earlier, before.latest), before.latest)
                    }));
                }
            }
        }
        starts
    }

    /// Whether the first of these runs, which goes back, begins a new epoch.
    fn leaves(&self, epoch: &Epoch, runs: &[Run]) -> bool {
        let run = &runs[0];
        let is_first = run.latest < epoch.earliest;
        self.repeats(epoch.start..run.messages.start, run)
            // What begins with a step has nothing before it.
            || is_first && (epoch.follows_step || self.is_apart(runs))
    }

    /// The first message of an epoch that a run is in. There may be some between that and the run before it.
    fn start(&self, run: &Run, earlier: &Run, latest: u64) -> usize {
        let between = earlier.messages.end..run.messages.start;
        let mut next = run.start;
        let belong = self.moments[between].iter().rev().take_while(|moment| {
            let belongs = moment.time <= next && moment.time < latest.saturating_sub(LATE);
            next = moment.time;
            belongs
        });
        run.messages.start - belong.count()
    }

    fn runs(&self) -> impl Iterator<Item = Run> {
        let mut next = 0;
        std::iter::from_fn(move || {
            let start = self.moments.get(next)?.time;
            let (mut earliest, mut latest, first) = (start, start, next);
            for moment in &self.moments[first..] {
                let follows = latest.saturating_sub(LATE)..=latest.saturating_add(self.reach);
                if !follows.contains(&moment.time) {
                    break;
                }
                (earliest, latest) = (earliest.min(moment.time), latest.max(moment.time));
                next += 1;
            }
            Some(Run {
                messages: first..next,
                start,
                earliest,
                latest,
            })
        })
    }

    /// Whether a run repeats times of messages before it: for a while, both have as many as is usual, or nearly so.
    fn repeats(&self, before: Range<usize>, run: &Run) -> bool {
        let sorted = |moments: &[Moment]| {
            let times = moments.iter().map(|moment| moment.time);
            let mut times: Vec<u64> = times
                .filter(|time| (run.earliest..=run.latest).contains(time))
                .collect();
            times.sort_unstable();
            times
        };
        let before = sorted(&self.moments[before]);
        let again = sorted(&self.moments[run.messages.clone()]);
        let count = |until: u64| again.partition_point(|&time| time < until) as u64;
        let (mut shared, mut first, mut second) = (0, 0, 0);
        for pair in before.windows(2) {
            let time = pair[1] - pair[0];
            if time <= self.reach {
                shared += time;
                first += 1;
                second += count(pair[1]) - count(pair[0]);
            }
        }
        let usual = shared / run.interval();
        let most_of = |one: u64, other: u64| 4 * one >= 3 * other;
        shared > run.late()
            && most_of(first, usual)
            && most_of(first, second)
            && most_of(second, first)
    }

    /// Whether what follows the first of these runs, in time without a gap, does not reach a message before it in the
    /// file. What comes after time has gone back once more is not considered.
    fn is_apart(&self, runs: &[Run]) -> bool {
        let run = &runs[0];
        let mut onward = Epoch::new(run, true);
        let mut end = run.messages.end;
        for next in &runs[1..] {
            if onward.is_ahead_of(next) {
                break;
            }
            onward.add(next);
            end = next.messages.end;
        }
        let earlier_in_file = self.moments[..run.messages.start].iter();
        let later = earlier_in_file.filter(|moment| moment.time > run.latest);
        let Some(reached) = later.map(|moment| moment.time).min() else {
            return true;
        };
        let onward = self.moments[run.messages.end..end].iter();
        let onward = onward.map(|moment| moment.time);
        let mut times: Vec<u64> = onward
            .filter(|time| (run.latest..reached).contains(time))
            .collect();
        times.extend([run.latest, reached]);
        times.sort_unstable();
        let longest = run.late().max(self.reach);
        times.windows(2).any(|pair| pair[1] - pair[0] > longest)
    }
}
