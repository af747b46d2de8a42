//! The ground is where the log's heights put it or, where it has none, where it was last.

use flightcam::{
    camera::Camera,
    derived::visual::Visual,
    geometry::DepressionAngle,
    sample::{DropReason, Sample},
    visuals::{Ground, Terrain, VisualOptions},
};
use proptest::prelude::*;

use crate::support::{cases, showing::*};

fn looking_down() -> Camera {
    Camera::Stabilised {
        depression: DepressionAngle::from_degrees(90.0).expect("it is in range"),
        yaw_offset: 0.0,
    }
}

/// A moment of a flight, by what the drone's altitude and the ground below it are after so many seconds.
struct Flown {
    altitude: fn(f64) -> f64,
    ground: fn(f64) -> f64,
    /// Whether there is a valid height then.
    has_height: fn(f64) -> bool,
}

impl Flown {
    /// Ten seconds of it, ten samples a second, from log time 100 s on.
    fn samples(&self) -> Vec<Sample> {
        (0..100)
            .flat_map(|number| {
                let seconds = f64::from(number) / 10.0;
                let time = 100.0 + seconds;
                let altitude = (self.altitude)(seconds);
                let above = height(time, altitude - (self.ground)(seconds));
                [
                    attitude(time, [0.0, 0.0, 0.0]),
                    velocity(time, [10.0, 0.0, 0.0]),
                    local(time, [10.0 * seconds, 0.0, -altitude]),
                ]
                .into_iter()
                .chain((self.has_height)(seconds).then_some(above))
            })
            .collect()
    }

    fn show(&self, options: &VisualOptions) -> Showing {
        show(&self.samples(), looking_down(), options)
    }

    /// Checks all heights that viewers are shown, by how high the drone is then above another ground.
    #[track_caller]
    fn check(&self, showing: &Showing, ground: impl Fn(f64) -> f64) {
        let heights = shown_heights(showing);
        assert_eq!(heights.len(), 100);
        for (seconds, height) in heights {
            let expected = (self.altitude)(seconds) - ground(seconds);
            assert!(
                (height - expected).abs() < 1e-4,
                "{height} m after {seconds} s, not {expected} m"
            );
        }
    }
}

/// Heights above the ground, and after how many seconds.
fn shown_heights(showing: &Showing) -> Vec<(f64, f64)> {
    let heights = showing.all(|visual| match visual {
        Visual::Display(display) => display.height,
        _ => None,
    });
    let heights = heights.into_iter();
    let since = |time: u64| (time - nanoseconds(100.0)) as f64 / 1e9;
    heights
        .map(|(time, height)| (since(time), f64::from(height)))
        .collect()
}

#[track_caller]
fn terrain(showing: &Showing) -> Terrain {
    showing.flight.stage.terrain.expect("a ground by heights")
}

/// A hill of 30 m, with its top after 5 s.
fn hill(seconds: f64) -> f64 {
    30.0 - 1.2 * (seconds - 5.0).powi(2)
}

#[test]
fn over_a_hill_all_is_shown_by_the_height_above_it() {
    let flown = Flown {
        altitude: |_| 50.0,
        ground: hill,
        has_height: |_| true,
    };
    let showing = flown.show(&with_field_of_view());
    flown.check(&showing, hill);
    let Terrain {
        lowest,
        highest,
        share,
    } = terrain(&showing);
    assert!(lowest.abs() < 1e-9 && (highest - 30.0).abs() < 1e-9);
    assert_eq!(share, 1.0);
    assert_eq!(showing.flight.flight.heights.used, 100);
    // What the camera sees lies on the hill, and is larger where that is lower.
    for (time, scene) in showing.scenes() {
        let seconds = (time - nanoseconds(100.0)) as f64 / 1e9;
        let corners = outline(&scene, "footprint").expect("something is seen");
        let half = (50.0 - hill(seconds)) * 25f64.to_radians().tan();
        for corner in corners {
            assert!((corner.z - hill(seconds)).abs() < 1e-6);
            assert!(((corner.y - 10.0 * seconds).abs() - half).abs() < 1e-6);
        }
    }
}

#[test]
fn between_heights_the_ground_is_interpolated_and_not_the_height() {
    // A hop out of the sensor's range, over ground that rises evenly.
    let flown = Flown {
        altitude: |seconds| 10.0 + 30.0 * (1.0 - (seconds - 5.0).abs()).max(0.0),
        ground: |seconds| 0.5 * seconds,
        has_height: |seconds| !(4.05..5.95).contains(&seconds),
    };
    let showing = flown.show(&with_field_of_view());
    flown.check(&showing, flown.ground);
    assert_eq!(terrain(&showing).share, 1.0);
}

#[test]
fn beyond_the_sensors_range_the_ground_stays_where_it_was() {
    // Above 20 m after 4 s, and back again after 10 s.
    let flown = Flown {
        altitude: |seconds| 5.0 * seconds + 0.4,
        ground: |seconds| 0.25 * seconds.min(3.95),
        has_height: |seconds| seconds < 3.95,
    };
    let showing = flown.show(&with_field_of_view());
    flown.check(&showing, |seconds| 0.25 * seconds.min(3.9));
    let Terrain { highest, share, .. } = terrain(&showing);
    assert!((highest - 0.975).abs() < 1e-9);
    assert_eq!(share, 0.4);
}

#[test]
fn before_the_first_height_the_ground_is_where_that_puts_it() {
    let flown = Flown {
        altitude: |seconds| 60.0 - 5.0 * seconds,
        ground: |seconds| 3.0 + seconds,
        has_height: |seconds| seconds > 7.95,
    };
    let showing = flown.show(&with_field_of_view());
    flown.check(&showing, |seconds| 3.0 + seconds.max(8.0));
    assert_eq!(terrain(&showing).share, 0.2);
    let first = showing.flight.stage.ground.expect("positions");
    assert!((first - 11.0).abs() < 1e-9);
}

#[test]
fn the_ground_is_not_interpolated_across_a_gap_of_the_heights() {
    let flown = Flown {
        altitude: |_| 15.0,
        ground: |seconds| if seconds < 5.0 { 0.0 } else { 8.0 },
        has_height: |seconds| !(2.05..7.45).contains(&seconds),
    };
    let showing = flown.show(&with_field_of_view());
    flown.check(&showing, |seconds| if seconds < 7.45 { 0.0 } else { 8.0 });
}

#[test]
fn without_heights_the_take_off_is_the_ground() {
    let flown = Flown {
        altitude: |seconds| 12.0 + seconds,
        ground: hill,
        has_height: |_| false,
    };
    let showing = flown.show(&with_field_of_view());
    flown.check(&showing, |_| 12.0);
    assert_eq!(showing.flight.stage.terrain, None);
}

#[test]
fn a_ground_that_is_given_goes_before_the_heights_of_the_log() {
    let flown = Flown {
        altitude: |_| 50.0,
        ground: hill,
        has_height: |_| true,
    };
    for (ground, altitude) in [(Ground::Altitude(-4.0), -4.0), (Ground::TakeOff, 50.0)] {
        let showing = flown.show(&with_field_of_view().ground(ground));
        flown.check(&showing, |_| altitude);
        assert_eq!(showing.flight.stage.terrain, None);
    }
}

#[test]
fn a_height_where_the_position_is_not_known_does_not_count() {
    let flown = Flown {
        altitude: |_| 50.0,
        ground: |_| 20.0,
        has_height: |_| true,
    };
    let mut samples = flown.samples();
    // Positions begin after 2 s and end after 8 s.
    samples.retain(|sample| {
        let seconds = sample.stamp().log_time as f64 / 1e9 - 100.0;
        !matches!(sample, Sample::Position(_)) || (1.95..8.05).contains(&seconds)
    });
    let showing = show(&samples, looking_down(), &with_field_of_view());
    let heights = &showing.flight.flight.heights;
    assert_eq!(heights.used, 61);
    assert_eq!(heights.dropped[&DropReason::UnknownPosition], 39);
    assert!(
        shown_heights(&showing)
            .iter()
            .all(|(_, height)| (height - 30.0).abs() < 1e-4)
    );

    samples.retain(|sample| !matches!(sample, Sample::Position(_)));
    let showing = show(&samples, looking_down(), &with_field_of_view());
    assert_eq!(showing.flight.flight.heights.used, 0);
    assert_eq!(
        (showing.flight.stage.ground, showing.flight.stage.terrain),
        (None, None)
    );
}

#[test]
fn heights_between_positions_put_the_ground_where_it_is() {
    // A receiver with a position a second, repeated until the next; the drone climbs.
    let flown = Flown {
        altitude: |seconds| 5.0 + 2.0 * seconds,
        ground: |_| 1.0,
        has_height: |_| true,
    };
    let mut samples = flown.samples();
    for sample in &mut samples {
        let seconds = sample.stamp().log_time as f64 / 1e9 - 100.0;
        if matches!(sample, Sample::Position(_)) {
            let last = (seconds + 1e-6).floor();
            *sample = local(100.0 + seconds, [10.0 * last, 0.0, -(flown.altitude)(last)]);
        }
    }
    let showing = show(&samples, looking_down(), &with_field_of_view());
    for (seconds, height) in shown_heights(&showing) {
        assert!(
            (height - 4.0 - 2.0 * seconds).abs() < 1e-4,
            "{height} m after {seconds} s"
        );
    }
}

proptest! {
    #![proptest_config(cases(64))]

    #[test]
    fn whatever_is_missing_a_level_ground_is_where_it_is(
        kept in prop::collection::vec(prop::bool::weighted(0.6), 400),
    ) {
        let flown = Flown {
            altitude: |seconds| 30.0 + 8.0 * seconds.sin(),
            ground: |_| 7.0,
            has_height: |_| true,
        };
        let samples = flown.samples().into_iter().zip(kept);
        let samples: Vec<Sample> = samples
            .filter(|(sample, kept)| *kept || matches!(sample, Sample::Position(_)))
            .map(|(sample, _)| sample)
            .collect();
        prop_assume!(samples.iter().any(|sample| matches!(sample, Sample::Height(_))));
        let showing = show(&samples, looking_down(), &with_field_of_view());
        for (seconds, height) in shown_heights(&showing) {
            prop_assert!((height + 7.0 - (flown.altitude)(seconds)).abs() < 0.1);
        }
    }
}
