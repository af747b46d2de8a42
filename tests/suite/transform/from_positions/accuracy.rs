//! How right velocities are that are taken from positions.

use nalgebra::Matrix3;

use super::*;

/// How a coordinate changes with time: `place + rate t + acceleration t²/2`.
#[derive(Debug, Clone, Copy)]
struct Parabola {
    place: f64,
    rate: f64,
    acceleration: f64,
}

impl Parabola {
    fn at(&self, t: f64) -> f64 {
        self.place + t * (self.rate + 0.5 * self.acceleration * t)
    }

    fn rate_at(&self, t: f64) -> f64 {
        self.rate + self.acceleration * t
    }
}

fn parabola(place: f64, rate: f64, acceleration: f64) -> impl Strategy<Value = Parabola> {
    (-place..place, -rate..rate, -acceleration..acceleration).prop_map(
        |(place, rate, acceleration)| Parabola {
            place,
            rate,
            acceleration,
        },
    )
}

/// Times of positions with any spacing from 10 ms to 4 s.
fn any_times() -> impl Strategy<Value = Vec<f64>> {
    let spacing = prop_oneof![0.01..0.2, 0.01..4.0];
    prop::collection::vec(spacing, 3..20).prop_map(|spacings| {
        let times = spacings.iter().scan(1.0, |time: &mut f64, spacing| {
            *time += spacing;
            Some((*time * 1e9).round() / 1e9)
        });
        times.collect()
    })
}

proptest! {
    #![proptest_config(crate::support::cases(100))]

    #[test]
    fn a_parabola_has_its_exact_velocity_however_it_is_sampled(
        times in any_times(),
        path in prop::array::uniform3(parabola(1000.0, 30.0, 5.0)),
    ) {
        let samples: Vec<Sample> =
            times.iter().map(|&t| local(t, path.map(|coordinate| coordinate.at(t)))).collect();
        let run = run(&samples);
        prop_assert_eq!(run.times(), &times[1..times.len() - 1]);
        for (time, velocity) in run.velocities() {
            let truth = Vector3::from(path.map(|coordinate| coordinate.rate_at(time)));
            prop_assert!((velocity - truth).norm() < 1e-9, "{velocity} at {time}, not {truth}");
        }
    }

    /// Against earth-centred coordinates, which know no radii of curvature.
    #[test]
    fn a_velocity_over_the_globe_is_right_to_a_millionth(
        latitude in -89.0..89.0f64,
        longitude in -180.0..180.0f64,
        altitude in -400.0..9000.0f64,
        speeds in prop::array::uniform3(parabola(0.001, 40.0, 5.0)),
        middle in 10.0..11.0f64,
        spacing in prop::array::uniform2(0.1..0.4f64),
    ) {
        // Roughly as many degrees as metres: how fast exactly is what is to be found out.
        let east = 1e5 * latitude.to_radians().cos();
        let place = |t: f64| {
            let [x, y, z] = speeds.map(|speed| speed.at(t - middle));
            [latitude + x / 1e5, longitude + y / east, altitude + z]
        };
        let samples = [middle - spacing[0], middle, middle + spacing[1]];
        let run = run(&samples.map(|t| geodetic(t, place(t))));
        let [(_, velocity)] = run.velocities()[..] else { panic!("one velocity") };
        let truth = globe::velocity_ned(place, middle);
        let error = (velocity - truth).norm();
        prop_assert!(error < 1e-6 * truth.norm() + 1e-5, "{velocity}, not {truth}");
    }
}

/// Places and velocities in earth-centred, earth-fixed coordinates.
mod globe {
    use super::*;

    fn earth_centred([latitude, longitude, altitude]: [f64; 3]) -> Vector3<f64> {
        let (a, f) = (6_378_137.0, 1.0 / 298.257223563);
        let b = a * (1.0 - f);
        let [latitude, longitude] = [latitude, longitude].map(f64::to_radians);
        // The point of the ellipse where it has this direction, and from there upwards.
        let length = (a * latitude.cos()).hypot(b * latitude.sin());
        let from_axis = a * a * latitude.cos() / length + altitude * latitude.cos();
        Vector3::new(
            from_axis * longitude.cos(),
            from_axis * longitude.sin(),
            b * b * latitude.sin() / length + altitude * latitude.sin(),
        )
    }

    /// The velocity of something that is at these places, in degrees and metres, by a difference of the fourth order.
    pub fn velocity_ned(place: impl Fn(f64) -> [f64; 3], time: f64) -> Vector3<f64> {
        let step = 0.01;
        let at = |steps: f64| earth_centred(place(time + steps * step));
        let velocity = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * step);
        let [latitude, longitude, _] = place(time);
        let [latitude, longitude] = [latitude, longitude].map(f64::to_radians);
        let (s, c) = latitude.sin_cos();
        let (sl, cl) = longitude.sin_cos();
        let axes = Matrix3::new(-s * cl, -s * sl, c, -sl, cl, 0.0, -c * cl, -c * sl, -s);
        axes * velocity
    }
}

#[test]
fn a_curved_path_is_followed_to_the_second_order() {
    let worst = |spacing: f64| {
        // The second interval is three times as long as the first.
        let times: Vec<f64> = (0..40)
            .map(|n| 1.0 + spacing * f64::from(n / 2 * 4 + n % 2))
            .collect();
        let samples = times
            .iter()
            .map(|&t| local(t, [10.0 * t.sin(), 10.0 * t.cos(), 0.0]));
        let run = run(&samples.collect::<Vec<_>>());
        let errors = run.velocities().into_iter().map(|(t, velocity)| {
            (velocity - Vector3::new(10.0 * t.cos(), -10.0 * t.sin(), 0.0)).norm()
        });
        errors.fold(0.0, f64::max)
    };
    let (coarse, fine) = (worst(0.1), worst(0.05));
    assert!(coarse < 0.06, "{coarse}");
    assert!((3.8..4.2).contains(&(coarse / fine)), "{coarse} and {fine}");
}

#[test]
fn the_date_line_is_crossed_like_any_meridian() {
    let across = |longitudes: [f64; 3]| {
        let samples = [1.0, 1.5, 2.0].into_iter().zip(longitudes);
        let samples = samples.map(|(t, longitude)| geodetic(t, [-17.0, longitude, 10.0]));
        run(&samples.collect::<Vec<_>>()).velocities()[0].1
    };
    let usual = across([10.0, 10.0001, 10.0002]);
    assert!((usual.y - 21.29).abs() < 0.01, "{usual}");
    for longitudes in [
        [179.9999, -180.0, -179.9999],
        [179.9998, 179.9999, -180.0],
        [179.99995, -179.99995, -179.99985],
        [359.9999, 0.0, 0.0001],
        [-0.0001, 360.0, 0.0001],
    ] {
        let velocity = across(longitudes);
        assert!(
            (velocity - usual).norm() < 1e-6,
            "{longitudes:?}: {velocity}"
        );
    }
    let west = across([-179.9999, 180.0, 179.9999]);
    assert!((west + usual).norm() < 1e-6, "{west}");
}
