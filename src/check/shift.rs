//! How far the times of two series are apart.

use nalgebra::{SMatrix, SVector, Vector3};

use super::{
    residual::{Pair, Part, median},
    verdict::Shift,
};

/// How far is searched, in seconds, and in which steps.
pub const FARTHEST: f64 = 2.0;
const COARSE: f64 = 0.25;

/// How often what remains is estimated anew, and the step by which the change with the shift is found, in seconds.
const ROUNDS: usize = 6;
const SLOPE_STEP: f64 = 0.05;

/// The last step must be smaller, in seconds.
const CONVERGED: f64 = 0.02;

/// No shift is known better than this, in seconds.
const FINEST: f64 = 0.01;

/// The motion must change with the shift by as much as this on the average, in its unit per second: a drone that flies
/// straight on shows nothing.
const LEAST_CHANGE: f64 = 0.5;

/// Errors that are so many times as large as the median count as strays.
const STRAY: f64 = 3.0;

/// Measures by how much one series is late: the shift at which the residual is least, and from there what the errors
/// still say, to first order. The resolution is three standard errors, and what a `systematic` error of each window, in the
/// unit of the motion, could make up if it always had the wrong direction.
///
/// The errors may also come from a compass that is a little wrong, from a scale that is, or from a constant error of
/// either series. These are estimated together with the shift, so that what they explain as well, as in a steady circle,
/// does not count as known.
pub fn measure(
    part: Part,
    systematic: f64,
    pairs: impl Fn(f64) -> Vec<Option<Pair>>,
) -> Option<Shift> {
    let residual = |late_by: f64| part.select(pairs(late_by)).residual();
    let steps = (FARTHEST / COARSE).round() as i32;
    let shifts = (-steps..=steps).map(|place| f64::from(place) * COARSE);
    let known = shifts.map(|shift| (shift, residual(shift)));
    let known = known.filter(|(_, residual)| residual.is_finite());
    let (mut late_by_s, _) = known.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let mut step = 0.0;
    let mut resolution_s = f64::INFINITY;
    for _ in 0..ROUNDS {
        let solved = solve_at(part, late_by_s, &pairs)?;
        step = solved.unknowns[0].clamp(-COARSE, COARSE);
        late_by_s += step;
        let statistical = 3.0 * solved.standard_error;
        resolution_s = statistical.max(solved.disagreement) + systematic * solved.amplification;
    }
    if step.abs() > CONVERGED {
        return None;
    }
    (late_by_s.is_finite() && resolution_s.is_finite()).then_some(Shift {
        late_by_s,
        resolution_s: resolution_s.max(FINEST),
    })
}

/// What the errors at a shift still say; nothing if the motion hardly changes with the shift.
fn solve_at(part: Part, late_by: f64, pairs: impl Fn(f64) -> Vec<Option<Pair>>) -> Option<Solved> {
    let [before, here, after] = [late_by - SLOPE_STEP, late_by, late_by + SLOPE_STEP].map(pairs);
    let mut equations: Vec<Equation> = Vec::new();
    for (here, (before, after)) in here.iter().zip(before.iter().zip(&after)) {
        if let (Some(here), Some(before), Some(after)) = (here, before, after) {
            let slope = (after.account - before.account) / (2.0 * SLOPE_STEP);
            equations.extend(equations_of(part, here, slope));
        }
    }
    let mut solved = solve(&equations)?;
    for _ in 0..2 {
        let errors = equations
            .iter()
            .map(|one| one.error_under(&solved.unknowns).abs());
        let middle = median(errors)?;
        equations.retain(|one| one.error_under(&solved.unknowns).abs() <= STRAY * middle);
        solved = solve(&equations)?;
    }
    let (first, last) = equations.split_at(equations.len() / 2);
    let [first, last] = [first, last].map(|half| solve(half).map(|half| half.unknowns[0]));
    solved.disagreement = (first? - last?).abs();
    let squares = equations
        .iter()
        .map(|one| one.slopes[0] * one.slopes[0])
        .sum::<f64>();
    (squares >= LEAST_CHANGE * LEAST_CHANGE * equations.len() as f64).then_some(solved)
}

/// The shift, a turn about the vertical, a scale, and constant errors along both axes.
type Unknowns = SVector<f64, 5>;

/// How well turn and scale are known beforehand: 10° and a twentieth. The others are not known.
const KNOWN: [f64; 5] = [f64::INFINITY, 0.17, 0.05, f64::INFINITY, f64::INFINITY];

/// An error, and how it changes with each of the unknowns.
struct Equation {
    error: f64,
    slopes: Unknowns,
}

struct Solved {
    unknowns: Unknowns,
    /// Of the shift.
    standard_error: f64,
    /// How far apart the shifts are that the first and the last half of the flight say.
    disagreement: f64,
    /// By how much the shift may be wrong if each error is wrong by one.
    amplification: f64,
}

impl Equation {
    fn error_under(&self, unknowns: &Unknowns) -> f64 {
        self.error - self.slopes.dot(unknowns)
    }
}

fn equations_of(part: Part, pair: &Pair, slope: Vector3<f64>) -> Vec<Equation> {
    let error = pair.witness - pair.account;
    let [x, y, z]: [f64; 3] = pair.account.into();
    let equation = |error: f64, slopes: [f64; 5]| Equation {
        error,
        slopes: slopes.into(),
    };
    match part {
        Part::Vertical { .. } | Part::Everywhere => {
            vec![equation(error.z, [slope.z, 0.0, z, 1.0, 0.0])]
        }
        Part::Horizontal { .. } | Part::EachAxis { .. } => vec![
            equation(error.x, [slope.x, -y, x, 1.0, 0.0]),
            equation(error.y, [slope.y, x, y, 0.0, 1.0]),
        ],
    }
}

/// Least squares.
fn solve(equations: &[Equation]) -> Option<Solved> {
    let mut normal = SMatrix::<f64, 5, 5>::zeros();
    let mut right = Unknowns::zeros();
    for Equation { error, slopes } in equations {
        normal += slopes * slopes.transpose();
        right += slopes * *error;
    }
    let degrees = equations
        .len()
        .checked_sub(5)
        .filter(|degrees| *degrees > 0)? as f64;
    let variance_of = |unknowns: &Unknowns| {
        let errors = equations.iter().map(|one| one.error_under(unknowns));
        errors.map(|error| error * error).sum::<f64>() / degrees
    };
    // The first time without what is known beforehand, to learn how large the errors are.
    let mut variance = 0.0;
    let mut solved = None;
    for _ in 0..2 {
        let mut bounded = normal;
        for place in 0..5 {
            // Whatever no error depends on stays zero.
            bounded[(place, place)] += variance / KNOWN[place].powi(2) + 1e-9;
        }
        let inverse = bounded.try_inverse()?;
        let unknowns = inverse * right;
        variance = variance_of(&unknowns);
        // The windows overlap by half.
        let standard_error = (2.0 * variance * inverse[(0, 0)]).sqrt();
        let weights = equations.iter().map(|one| (inverse * one.slopes)[0].abs());
        solved = Some(Solved {
            unknowns,
            standard_error,
            amplification: weights.sum(),
            disagreement: 0.0,
        });
    }
    solved
}
