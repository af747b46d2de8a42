//! Where something is not known, viewers are shown that it is not, and nothing is left over from before.

use flightcam::{
    camera::Camera,
    derived::visual::{Frame, Visual},
    geometry::DepressionAngle,
    sample::{AttitudeSample, Sample},
    visuals::{Ground, VisualOptions},
};
use nalgebra::Vector3;
use proptest::prelude::*;

use crate::support::{cases, showing::*};

fn camera() -> Camera {
    Camera::Stabilised {
        depression: DepressionAngle::from_degrees(45.0).expect("it is in range"),
        yaw_offset: 0.0,
    }
}

/// A level flight north at 10 m/s and 50 m above the take-off, ten samples a second, from a second to another.
fn level(from: f64, to: f64) -> Vec<Sample> {
    let count = ((to - from) * 10.0).round() as i32;
    (0..count)
        .flat_map(|number| {
            let time = from + f64::from(number) / 10.0;
            let north = 10.0 * (time - 100.0);
            let down = if time > 100.0 { -50.0 } else { 0.0 };
            [
                attitude(time, [0.0, 0.0, 0.0]),
                velocity(time, [10.0, 0.0, 0.0]),
                local(time, [north, 0.0, down]),
            ]
        })
        .collect()
}

fn without(samples: Vec<Sample>, left_out: impl Fn(&Sample, f64) -> bool) -> Vec<Sample> {
    let seconds = |sample: &Sample| sample.stamp().log_time as f64 / 1e9;
    let mut samples = samples;
    samples.retain(|sample| !left_out(sample, seconds(sample)));
    samples
}

#[test]
fn a_whole_flight_is_ok_from_the_first_sample_to_the_last() {
    let showing = show(&level(100.0, 110.0), camera(), &with_field_of_view());
    assert_eq!(showing.states(), [(nanoseconds(100.0), "ok")]);
    let said = showing.all(|visual| matches!(visual, Visual::State(_)).then_some(()));
    let times: Vec<u64> = said.into_iter().map(|(time, ())| time).collect();
    assert_eq!(times, [nanoseconds(100.0), nanoseconds(109.9)]);
    let events = showing.all(|visual| matches!(visual, Visual::Event(_)).then_some(()));
    assert!(events.is_empty());
}

#[test]
fn in_a_gap_of_everything_nothing_is_shown_but_that_there_is_one() {
    let samples = without(level(100.0, 130.0), |_, time| {
        (110.0..120.0).contains(&time)
    });
    let showing = show(&samples, camera(), &with_field_of_view());
    let states: Vec<&str> = showing
        .states()
        .into_iter()
        .map(|(_, state)| state)
        .collect();
    assert_eq!(states, ["ok", "gap", "ok"]);
    let in_gap = |time: u64| (nanoseconds(110.0)..nanoseconds(119.9)).contains(&time);
    let transforms = showing.all(|visual| matches!(visual, Visual::Transforms(_)).then_some(()));
    assert!(transforms.iter().all(|(time, ())| !in_gap(*time)));
    // One scene takes away what was drawn before.
    let scenes = showing.scenes();
    let in_gap: Vec<_> = scenes.iter().filter(|(time, _)| in_gap(*time)).collect();
    assert_eq!(in_gap.len(), 1);
    let (_, scene) = in_gap[0];
    assert!(scene.entities.is_empty());
    assert_eq!(
        scene.removed,
        ["line of sight", "footprint", "velocity", "label"]
    );
    let events = showing.all(|visual| match visual {
        Visual::Event(event) => Some(event.clone()),
        _ => None,
    });
    let [(from, event)] = &events[..] else {
        panic!("{events:?}")
    };
    assert_eq!(
        (event.kind, *from, event.end),
        ("gap", nanoseconds(109.9), nanoseconds(120.0))
    );
    assert_eq!(event.text, "no attitude for 10.1 s");
    let logged = showing.all(|visual| match visual {
        Visual::Log(event) => Some(event.clone()),
        _ => None,
    });
    assert_eq!(logged, events);
}

#[test]
fn a_velocity_that_is_missing_for_long_is_a_state_and_an_event() {
    let is_velocity = |sample: &Sample| matches!(sample, Sample::Velocity(_));
    let samples = without(level(100.0, 130.0), |sample, time| {
        is_velocity(sample) && (105.0..118.0).contains(&time)
    });
    let showing = show(&samples, camera(), &with_field_of_view());
    let states: Vec<&str> = showing
        .states()
        .into_iter()
        .map(|(_, state)| state)
        .collect();
    assert_eq!(states, ["ok", "velocity invalid", "ok"]);
    let odometries = showing.all(|visual| matches!(visual, Visual::Odometry(_)).then_some(()));
    let without = nanoseconds(105.0)..nanoseconds(117.95);
    assert!(odometries.iter().all(|(time, ())| !without.contains(time)));
    for (time, scene) in showing.scenes() {
        let is_drawn = scene.entities.iter().any(|entity| entity.id == "velocity");
        assert_eq!(is_drawn, !without.contains(&time), "at {time}");
        assert_eq!(scene.removed.contains(&"velocity"), !is_drawn);
    }
}

#[test]
fn topics_that_begin_a_little_later_are_no_event() {
    let samples = without(level(100.0, 110.0), |sample, time| {
        !matches!(sample, Sample::Attitude(_)) && time < 100.4
    });
    let showing = show(&samples, camera(), &with_field_of_view());
    assert_eq!(showing.states(), [(nanoseconds(100.0), "ok")]);
}

#[test]
fn an_undefined_heading_and_a_late_attitude_are_states() {
    let mut samples = Vec::new();
    for sample in level(100.0, 110.0) {
        let time = sample.stamp().log_time as f64 / 1e9;
        samples.push(match sample {
            Sample::Attitude(_) if (103.0..105.0).contains(&time) => {
                attitude(time, [0.0, 90.0, 0.0])
            }
            other => other,
        });
    }
    let samples = without(samples, |sample, time| {
        matches!(sample, Sample::Attitude(_)) && time < 101.5
    });
    let showing = show(&samples, camera(), &with_field_of_view());
    let states: Vec<&str> = showing
        .states()
        .into_iter()
        .map(|(_, state)| state)
        .collect();
    assert_eq!(states, ["no attitude", "ok", "heading undefined", "ok"]);
    let kinds = showing.all(|visual| match visual {
        Visual::Event(event) => Some(event.kind),
        _ => None,
    });
    let kinds: Vec<&str> = kinds.into_iter().map(|(_, kind)| kind).collect();
    assert_eq!(kinds, ["no attitude", "heading undefined"]);
}

#[test]
fn a_reset_of_the_estimator_is_an_event_and_not_a_rate() {
    let mut samples = Vec::new();
    for number in 0..40 {
        let time = 100.0 + f64::from(number) / 10.0;
        let (yaw, resets) = if number < 20 { (0.0, 1) } else { (170.0, 2) };
        let Sample::Attitude(sample) = attitude(time, [0.0, 0.0, yaw]) else {
            unreachable!()
        };
        samples.push(Sample::Attitude(AttitudeSample {
            reset_counter: Some(resets),
            ..sample
        }));
    }
    let showing = show(&samples, camera(), &with_field_of_view());
    let rates = showing.all(|visual| match visual {
        Visual::Display(display) => Some(display.rates),
        _ => None,
    });
    assert_eq!(rates.len(), 40);
    for (_, rate) in rates {
        let [roll, pitch, yaw] = rate.expect("it is known from one side");
        assert!([roll, pitch, yaw].iter().all(|rate| rate.abs() < 1e-3));
    }
    let events = showing.all(|visual| match visual {
        Visual::Event(event) => Some((event.kind, event.end)),
        _ => None,
    });
    assert_eq!(
        events,
        [(nanoseconds(101.9), ("estimator reset", nanoseconds(102.0)))]
    );
}

#[test]
fn without_positions_the_drone_turns_at_the_origin_and_no_place_is_shown() {
    let samples = without(level(100.0, 103.0), |sample, _| {
        matches!(sample, Sample::Position(_))
    });
    let showing = show(&samples, camera(), &with_field_of_view());
    let drone = showing.map_from(Frame::Drone, u64::MAX).expect("a chain");
    assert_eq!(drone.translation.vector, Vector3::zeros());
    for one in &showing.shown {
        let needs_a_place = matches!(
            one.visual,
            Visual::Odometry(_)
                | Visual::Pose(_)
                | Visual::Location(_)
                | Visual::Path(_)
                | Visual::Footprint(_)
        );
        assert!(!needs_a_place, "{one:?}");
    }
}

#[test]
fn a_drone_whose_place_is_not_known_stays_where_it_was() {
    let samples = without(level(100.0, 120.0), |sample, time| {
        matches!(sample, Sample::Position(_)) && time > 105.0
    });
    let showing = show(&samples, camera(), &with_field_of_view());
    let drone = showing.map_from(Frame::Drone, u64::MAX).expect("a chain");
    let expected = Vector3::new(0.0, 50.0, 50.0);
    assert!((drone.translation.vector - expected).norm() < 1e-9);
    let states: Vec<&str> = showing
        .states()
        .into_iter()
        .map(|(_, state)| state)
        .collect();
    assert_eq!(states, ["ok", "position invalid"]);
}

#[test]
fn a_receiver_that_repeats_its_position_does_not_make_the_drone_jump() {
    // A new position once a second, repeated ten times; the drone flies at 10 m/s.
    let mut samples = level(100.0, 110.0);
    for sample in &mut samples {
        let time = sample.stamp().log_time as f64 / 1e9;
        if matches!(sample, Sample::Position(_)) {
            *sample = local(time, [10.0 * (time - 100.0 + 1e-6).floor(), 0.0, -50.0]);
        }
    }
    let showing = show(&samples, camera(), &with_field_of_view());
    let places = showing.all(|visual| match visual {
        Visual::Pose(pose) => Some(pose.position),
        _ => None,
    });
    // From the take-off to the last new position it moves evenly; then it hovers.
    for pair in places
        .windows(2)
        .filter(|pair| pair[1].0 <= nanoseconds(109.0))
    {
        let step = (pair[1].1 - pair[0].1).norm();
        assert!((step - 1.0).abs() < 1e-6, "{step} at {}", pair[1].0);
    }
    assert_eq!(places.len(), 100);
}

#[test]
fn the_ground_is_where_it_is_said_to_be() {
    let samples = level(100.0, 103.0);
    let heights = |options: &VisualOptions| -> Vec<f32> {
        let showing = show(&samples, camera(), options);
        let heights = showing.all(|visual| match visual {
            Visual::Display(display) => display.height,
            _ => None,
        });
        heights.into_iter().map(|(_, height)| height).collect()
    };
    let by_default = heights(&with_field_of_view());
    assert_eq!((by_default[0], by_default[20]), (0.0, 50.0));
    assert_eq!(
        by_default,
        heights(&with_field_of_view().ground(Ground::TakeOff))
    );
    let lower = heights(&with_field_of_view().ground(Ground::Altitude(-30.0)));
    assert_eq!((lower[0], lower[20]), (30.0, 80.0));
}

#[test]
fn samples_that_are_years_apart_cost_no_ticks() {
    let mut samples = level(1.0, 2.0);
    samples.extend(level(1.7e9, 1.7e9 + 1.0));
    let showing = show(&samples, camera(), &with_field_of_view());
    assert!(showing.shown.len() < 500);
    let states: Vec<&str> = showing
        .states()
        .into_iter()
        .map(|(_, state)| state)
        .collect();
    assert_eq!(states, ["ok", "gap", "ok"]);
    let last = samples.last().expect("a sample").stamp().log_time;
    let ends = showing.shown.iter().map(|one| one.time).max();
    assert!(last - ends.expect("something") < 200_000_000);
}

#[test]
fn where_the_clock_was_set_back_each_part_is_shown_in_its_own_order() {
    let (first, second) = (level(200.0, 205.0), level(100.0, 105.0));
    let showing = show_epochs(&[&first, &second], camera(), &with_field_of_view());
    let transforms = showing.all(|visual| matches!(visual, Visual::Transforms(_)).then_some(()));
    let times: Vec<u64> = transforms.into_iter().map(|(time, ())| time).collect();
    let (before, after) = times.split_at(50);
    assert!(before.is_sorted() && after.is_sorted());
    assert!(before[0] == nanoseconds(200.0) && after[0] == nanoseconds(100.0));
    // What is shown once is there from the earliest time on.
    assert_eq!(showing.shown[0].time, nanoseconds(100.0));
}

proptest! {
    #![proptest_config(cases(64))]

    #[test]
    fn whatever_is_missing_times_are_in_order_and_what_is_drawn_is_drawn_or_removed(
        seed in prop::collection::vec(prop::bool::weighted(0.8), 600),
    ) {
        let all = level(100.0, 120.0);
        let kept = all.into_iter().zip(seed).filter(|(_, keep)| *keep);
        let samples: Vec<Sample> = kept.map(|(sample, _)| sample).collect();
        let showing = show(&samples, camera(), &with_field_of_view());
        prop_assert!(showing.shown.is_sorted_by_key(|one| one.time));
        for (_, scene) in showing.scenes() {
            for id in ["line of sight", "footprint", "velocity", "label"] {
                let drawn = scene.entities.iter().filter(|entity| entity.id == id).count();
                prop_assert_eq!(drawn + usize::from(scene.removed.contains(&id)), 1);
            }
        }
        for pair in showing.states().windows(2) {
            prop_assert_ne!(pair[0].1, pair[1].1);
        }
    }
}
