//! What is a step back in time, and what is merely out of order.

use std::ops::Range;

use flightcam::{
    ClockStep,
    clock::{Epochs, Place, Series},
    text::Foreign,
};
use proptest::prelude::*;

const SECOND: u64 = 1_000_000_000;
const START: u64 = 1_760_000_000 * SECOND;
const NONE: [usize; 0] = [];

/// The steps of a series.
fn steps(times: &[u64]) -> Vec<ClockStep> {
    let mut series = Series::default();
    for (message, &time) in times.iter().enumerate() {
        series.push(Place::new(message / 100, message % 100), time);
    }
    let epochs = Epochs::of(&[(Foreign::from("/topic"), series)]);
    epochs.steps().to_vec()
}

/// The numbers, from 0, of the messages before which there is a step.
fn places(times: &[u64]) -> Vec<usize> {
    let steps = steps(times).into_iter();
    steps.map(|step| step.message as usize - 1).collect()
}

/// Messages at a steady rate, that many milliseconds apart.
fn steady(messages: u64, milliseconds: u64) -> Vec<u64> {
    (0..messages)
        .map(|n| START + n * milliseconds * 1_000_000)
        .collect()
}

/// Sets the clock back before each of the given messages, by as many milliseconds.
fn set_back(mut times: Vec<u64>, settings: &[(usize, u64)]) -> Vec<u64> {
    for &(at, milliseconds) in settings {
        times[at..]
            .iter_mut()
            .for_each(|time| *time -= milliseconds * 1_000_000);
    }
    times
}

// ---- Steps ----

#[test]
fn a_step_is_named_by_its_message_and_the_times_around_it() {
    let times = set_back(steady(200, 50), &[(80, 3000)]);
    let [step] = &steps(&times)[..] else {
        panic!("one step");
    };
    assert_eq!((step.topic.as_str(), step.message), ("/topic", 81));
    assert_eq!((step.before, step.after), (times[79], times[80]));
    assert!((step.seconds() - 2.95).abs() < 1e-9);
}

#[test]
fn a_clock_may_be_set_back_by_any_time_and_more_than_once() {
    let times = set_back(
        steady(600, 20),
        &[(150, 400), (300, 36_000_000), (450, 2500)],
    );
    assert_eq!(places(&times), [150, 300, 450]);
}

#[test]
fn a_clock_that_is_set_back_and_forth_was_set_back() {
    let mut times = steady(600, 20);
    times[200..300]
        .iter_mut()
        .for_each(|time| *time -= 3 * SECOND);
    assert_eq!(places(&times), [200]);
}

#[test]
fn a_flight_that_is_played_again_and_again_begins_anew_each_time() {
    assert_eq!(places(&steady(100, 20).repeat(4)), [100, 200, 300]);
}

#[test]
fn a_recorder_that_is_restarted_with_an_earlier_time_begins_anew() {
    // Earlier than all before, and with pauses.
    let mut times = steady(300, 20);
    times[200..].iter_mut().for_each(|time| *time += 7 * SECOND);
    let mut again = times.clone();
    again.iter_mut().for_each(|time| *time -= 7200 * SECOND);
    times.extend(again);
    assert_eq!(places(&times), [300]);
}

#[test]
fn rare_messages_show_a_step_of_six_intervals() {
    let times = set_back(steady(60, 1000), &[(30, 6000)]);
    assert_eq!(places(&times), [30]);
    assert_eq!(places(&set_back(steady(60, 1000), &[(30, 2000)])), NONE);
}

#[test]
fn messages_in_bursts_show_a_step() {
    let times = (0..600).map(|n| START + n / 5 * 100_000_000 + n % 5 * 200_000);
    let times = set_back(times.collect(), &[(300, 1500)]);
    assert_eq!(places(&times), [300]);
}

#[test]
fn a_step_among_late_messages_is_found() {
    // Of messages at 50 Hz, every tenth is written 180 ms late.
    let mut written: Vec<(u64, u64)> = (0..600)
        .map(|n| {
            let late = if n % 10 == 0 { 180 } else { 0 };
            let back = if n >= 300 { 3000 } else { 0 };
            (
                n * 20 + late,
                START + (n * 20) * 1_000_000 - back * 1_000_000,
            )
        })
        .collect();
    written.sort_by_key(|(written, _)| *written);
    let times: Vec<u64> = written.into_iter().map(|(_, time)| time).collect();
    let found = places(&times);
    assert!(found.len() == 1 && found[0].abs_diff(300) < 10, "{found:?}");
}

#[test]
fn messages_that_come_at_a_slower_rate_after_a_step_belong_to_it() {
    // It takes three slow messages until the recorder is at its rate again.
    let mut times = steady(300, 20);
    let back = times[299] - 4 * SECOND;
    times.extend([0, 300, 600].map(|late| back + late * 1_000_000));
    times.extend((0..300).map(|n| back + SECOND + n * 20_000_000));
    assert_eq!(places(&times), [300]);
}

// ---- Disorder ----

#[test]
fn a_buffer_that_was_written_late_is_no_step() {
    let mut times = steady(600, 20);
    // Half a second after the next one.
    times[200..250].rotate_left(25);
    times[300..400].rotate_left(50);
    assert_eq!(places(&times), NONE);
}

#[test]
fn parts_of_a_file_in_another_order_are_no_steps() {
    let parts: Vec<Vec<u64>> = steady(1200, 20).chunks(100).map(<[u64]>::to_vec).collect();
    // As a shell sorts their names: 0, 1, 10, 11, 2, 3, …
    let mut order: Vec<usize> = (0..parts.len()).collect();
    order.sort_by_key(|n| n.to_string());
    let by_name: Vec<u64> = order.iter().flat_map(|&n| parts[n].clone()).collect();
    assert_eq!(places(&by_name), NONE);
    let backwards: Vec<u64> = parts.iter().rev().flatten().copied().collect();
    assert_eq!(places(&backwards), NONE);
}

#[test]
fn stray_messages_with_impossible_times_are_no_steps() {
    let mut times = steady(600, 20);
    (times[100], times[200], times[300]) = (0, u64::MAX, 5);
    assert_eq!(places(&times), NONE);
    assert_eq!(places(&set_back(times, &[(450, 3000)])), [450]);
}

#[test]
fn two_sources_in_turn_are_not_taken_for_a_clock() {
    let delayed = |n: u64| START + n * 20_000_000 - n % 2 * 3 * SECOND;
    let times: Vec<u64> = (200..800).map(delayed).collect();
    assert_eq!(places(&times), NONE);
}

#[test]
fn few_messages_show_nothing() {
    assert_eq!(places(&[]), NONE);
    assert_eq!(places(&[START]), NONE);
    assert_eq!(places(&[START, START - 9 * SECOND]), NONE);
    assert_eq!(places(&[START; 100]), NONE);
}

// ---- At random ----

/// Messages at about that rate.
#[derive(Debug, Clone)]
struct Steady {
    times: Vec<u64>,
    interval: u64,
}

fn any_steady(messages: Range<usize>) -> impl Strategy<Value = Steady> {
    let interval = prop::sample::select(vec![2.5, 5.0, 20.0, 100.0, 200.0, 500.0, 1000.0]);
    let jitter = prop::collection::vec(-0.25..0.25, messages);
    (interval, jitter).prop_map(|(milliseconds, jitter)| {
        let interval = milliseconds * 1e6;
        let mut time = START;
        let mut after = |jitter: f64| {
            time += (interval * (1.0 + jitter)) as u64;
            time
        };
        let times = jitter.into_iter().map(&mut after).collect();
        let interval = interval as u64;
        Steady { times, interval }
    })
}

/// What writes messages in another order than that of their times.
#[derive(Debug, Clone)]
enum Disorder {
    /// A share of the messages is written late, by up to that many seconds.
    Late {
        share: f64,
        seconds: f64,
    },
    /// Buffers of that many seconds are written without regard to order.
    Buffers {
        seconds: f64,
    },
    /// The second half of the series is written first.
    Halves,
    Backwards,
    Shuffled,
}

fn any_disorder() -> impl Strategy<Value = Disorder> {
    let late = (0.0..1.0, 0.0..3.0).prop_map(|(share, seconds)| Disorder::Late { share, seconds });
    let buffers = (0.01..4.0).prop_map(|seconds| Disorder::Buffers { seconds });
    let others = vec![Disorder::Halves, Disorder::Backwards, Disorder::Shuffled];
    prop_oneof![3 => late, 2 => buffers, 2 => prop::sample::select(others)]
}

impl Disorder {
    /// The times in the order of the file; each message has a random number from 0 to 1.
    fn write(&self, times: &[u64], random: &[f64]) -> Vec<u64> {
        let place = |n: usize| {
            let (time, random) = ((times[n] - START) as f64 / SECOND as f64, random[n]);
            match *self {
                Self::Late { share, seconds } if random < share => {
                    (time + random / share * seconds, 0.0)
                }
                Self::Late { .. } => (time, 0.0),
                Self::Buffers { seconds } => ((time / seconds).floor(), random),
                Self::Halves => (f64::from(n < times.len() / 2), time),
                Self::Backwards => (-time, 0.0),
                Self::Shuffled => (random, 0.0),
            }
        };
        let mut written: Vec<_> = (0..times.len()).map(|n| (place(n), times[n])).collect();
        written.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
        written.into_iter().map(|(_, time)| time).collect()
    }
}

proptest! {
    #![proptest_config(crate::support::cases(1000))]

    #[test]
    fn what_is_merely_out_of_order_is_no_step(
        steady in any_steady(2..600),
        disorder in any_disorder(),
        random in prop::collection::vec(0.0..1.0, 600),
    ) {
        prop_assert_eq!(places(&disorder.write(&steady.times, &random)), NONE);
    }

    #[test]
    fn wherever_a_clock_is_set_back_there_is_a_step(
        steady in any_steady(60..600),
        at in 0.1..0.9,
        seconds in 0.5..30.0,
    ) {
        let Steady { mut times, interval } = steady;
        let at = (at * times.len() as f64) as usize;
        let back = ((seconds * SECOND as f64) as u64).max(14 * interval);
        times[at..].iter_mut().for_each(|time| *time -= back);
        let lasts = |part: &[u64]| part[part.len() - 1] - part[0] > SECOND / 2 + 6 * interval;
        // If the second part ends just where the first one begins, it may as well have been written late.
        let is_clear = times[times.len() - 1].abs_diff(times[0]) > SECOND + 4 * interval;
        if is_clear && lasts(&times[..at]) && lasts(&times[at..]) {
            prop_assert_eq!(places(&times), [at]);
        }
    }
}
