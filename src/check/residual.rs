//! How well two accounts of the same motion agree: the residual as a share of the motion, on the windows that move most.

use std::cmp::Ordering;

use nalgebra::Vector3;

/// The share of windows that is judged: those that move most.
const SHARE: f64 = 0.4;

/// Fewer windows than this decide nothing.
const FEWEST_WINDOWS: usize = 5;

/// Fewer windows than this condemn nothing, and with fewer than that many a reading must fit so much better to condemn
/// another one: the fewer there are, the more readings fit by chance.
const ENOUGH_TO_CONDEMN: usize = 12;
const MANY: usize = 32;

/// Up to this share of the motion, an account fits at all. Axes that are turned by 30° from the true ones, as by a
/// compass that is wrong, are at 0.52.
pub const FITS: f64 = 0.5;

/// Up to this share, a reading is good enough to condemn another one.
const CONDEMNS: f64 = 0.35;

/// Whether a reading can be told from the best one: it is one and a half times as bad, and a little more.
pub fn is_worse(residual: f64, best: f64) -> bool {
    residual >= 1.5 * best + 0.05
}

/// Whether a reading that fits condemns the one that was claimed.
fn condemns(claimed: &Residual, other: &Residual) -> bool {
    let enough = (claimed.windows as f64 / MANY as f64).min(1.0);
    claimed.windows >= ENOUGH_TO_CONDEMN
        && other.all < CONDEMNS * enough
        && claimed.all >= FITS
        && is_worse(claimed.all, 2.0 * other.all)
}

/// What a witness says about the motion in one window, and what is to be judged says about it.
#[derive(Debug, Clone, Copy)]
pub struct Pair {
    pub witness: Vector3<f64>,
    pub account: Vector3<f64>,
}

impl Pair {
    /// With the difference between its error and the other's as its error.
    pub fn less(&self, other: &Self) -> Self {
        let error = (self.witness - self.account) - (other.witness - other.account);
        Self {
            witness: self.witness,
            account: self.witness - error,
        }
    }

    /// The same, with what is to be judged as the witness.
    pub fn swapped(self) -> Self {
        Self {
            witness: self.account,
            account: self.witness,
        }
    }
}

/// Which part of the motion is judged, and the least that is needed of it.
#[derive(Debug, Clone, Copy)]
pub enum Part {
    /// North and east.
    Horizontal { least: f64 },
    /// Down.
    Vertical { least: f64 },
    /// Down, in all windows alike: something that is always there.
    Everywhere,
    /// All three axes, each on the windows in which the motion is mostly about it.
    EachAxis { least: f64 },
}

/// Windows that are judged together.
#[derive(Debug)]
struct Group {
    /// Each with its place in time.
    pairs: Vec<(usize, Pair)>,
    motion: f64,
}

/// The windows of a comparison that are judged.
#[derive(Debug)]
pub struct Judged {
    groups: Vec<Group>,
    /// The place in time that has as many windows before as after.
    middle: usize,
    /// The largest motion of a group, whether it is enough or not.
    pub motion: f64,
}

impl Part {
    pub fn least(self) -> f64 {
        match self {
            Self::Horizontal { least } | Self::Vertical { least } | Self::EachAxis { least } => {
                least
            }
            Self::Everywhere => 0.0,
        }
    }

    /// The part of a vector that is judged.
    pub fn of(self, vector: Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Horizontal { .. } => Vector3::new(vector.x, vector.y, 0.0),
            Self::Vertical { .. } | Self::Everywhere => Vector3::new(0.0, 0.0, vector.z),
            Self::EachAxis { .. } => vector,
        }
    }

    /// Selects the windows that are judged: in each group those that move most. Only groups that move enough are judged.
    pub fn select(self, windows: impl IntoIterator<Item = Option<Pair>>) -> Judged {
        let pairs = windows.into_iter().flatten().map(|pair| Pair {
            witness: self.of(pair.witness),
            account: self.of(pair.account),
        });
        let pairs = pairs.filter(|pair| pair.witness.norm().is_finite());
        let pairs: Vec<(usize, Pair)> = pairs.enumerate().collect();
        let middle = pairs.len() / 2;
        let groups = match self {
            Self::Vertical { .. } | Self::Everywhere => vec![pairs],
            Self::Horizontal { .. } => along_and_across(pairs),
            Self::EachAxis { .. } => {
                let mut groups = vec![Vec::new(); 3];
                for pair in pairs {
                    groups[pair.1.witness.iamax()].push(pair);
                }
                groups
            }
        };
        let share = match self {
            Self::Everywhere => 1.0,
            _ => SHARE,
        };
        let groups = groups.into_iter();
        let groups: Vec<Group> = groups
            .filter_map(|group| most_moving(group, share))
            .collect();
        let motion = groups.iter().map(|group| group.motion);
        Judged {
            middle,
            motion: motion.fold(0.0, f64::max),
            groups: (groups.into_iter())
                .filter(|group| group.motion >= self.least())
                .collect(),
        }
    }
}

/// The windows that move mostly along the direction in which the drone moved most, and those across it. Both must fit, so
/// a drone that flies to and fro along a line and turns at its ends shows which way is right.
fn along_and_across(pairs: Vec<(usize, Pair)>) -> Vec<Vec<(usize, Pair)>> {
    let (mut difference, mut product) = (0.0, 0.0);
    for (_, Pair { witness, .. }) in &pairs {
        // Not their squares, so that one window does not decide alone.
        let size = witness.norm().max(f64::MIN_POSITIVE);
        difference += (witness.x * witness.x - witness.y * witness.y) / size;
        product += witness.x * witness.y / size;
    }
    let (sin, cos) = (0.5 * f64::atan2(2.0 * product, difference)).sin_cos();
    let is_along = |(_, pair): &(usize, Pair)| {
        let along = pair.witness.x * cos + pair.witness.y * sin;
        let across = pair.witness.y * cos - pair.witness.x * sin;
        along.abs() >= across.abs()
    };
    let (along, across) = pairs.into_iter().partition(is_along);
    vec![along, across]
}

fn most_moving(pairs: Vec<(usize, Pair)>, share: f64) -> Option<Group> {
    let count = (pairs.len() as f64 * share).ceil() as usize;
    let sized = pairs.into_iter().map(|pair| (pair.1.witness.norm(), pair));
    let mut sized: Vec<(f64, (usize, Pair))> = sized.collect();
    sized.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    sized.truncate(count.max(FEWEST_WINDOWS));
    let motion = median(sized.iter().map(|(size, _)| *size))?;
    let pairs: Vec<(usize, Pair)> = sized.into_iter().map(|(_, pair)| pair).collect();
    (pairs.len() >= FEWEST_WINDOWS).then_some(Group { pairs, motion })
}

/// The median, if there are numbers.
pub fn median(numbers: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut numbers: Vec<f64> = numbers.into_iter().collect();
    let middle = numbers.len() / 2;
    let by_size = |a: &f64, b: &f64| a.partial_cmp(b).unwrap_or(Ordering::Equal);
    (!numbers.is_empty()).then(|| *numbers.select_nth_unstable_by(middle, by_size).1)
}

impl Judged {
    /// Whether there is enough motion to judge.
    pub fn moves(&self) -> bool {
        !self.groups.is_empty()
    }

    /// How many windows are judged.
    pub fn windows(&self) -> usize {
        self.groups.iter().map(|group| group.pairs.len()).sum()
    }

    /// The largest of the groups' residuals: the median error of the windows as a share of the motion.
    pub fn residual(&self) -> f64 {
        self.residual_of(|_| true)
    }

    /// The residuals of the windows before and after the middle.
    pub fn of_halves(&self) -> [f64; 2] {
        [true, false].map(|is_first| self.residual_of(|place| (place < self.middle) == is_first))
    }

    fn residual_of(&self, is_judged: impl Fn(usize) -> bool) -> f64 {
        let shares = self.groups.iter().filter_map(|group| {
            let pairs = group.pairs.iter().filter(|(place, _)| is_judged(*place));
            let errors = pairs.map(|(_, pair)| (pair.witness - pair.account).norm());
            Some(median(errors)? / group.motion)
        });
        shares.fold(f64::NAN, f64::max)
    }
}

/// What residuals say about the claimed reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Decision {
    /// It fits, and no other does.
    Fits,
    /// Others fit nearly as well as it does.
    Tied,
    /// Another one certainly fits better.
    Condemned,
    /// Another one fits better, but that is not certain.
    Doubtful,
    /// None fits.
    NothingFits,
}

/// The residual of one reading.
#[derive(Debug, Clone, Copy)]
pub struct Residual {
    pub all: f64,
    /// Of the first and the last half of the flight.
    pub halves: [f64; 2],
    pub windows: usize,
}

impl From<&Judged> for Residual {
    fn from(judged: &Judged) -> Self {
        Self {
            all: judged.residual(),
            halves: judged.of_halves(),
            windows: judged.windows(),
        }
    }
}

/// Decides between the claimed reading and the best of the others. Among so many others, one may fit a few windows by
/// chance, so it must fit in both halves of the flight to condemn.
pub fn decide(claimed: Residual, other: Residual) -> Decision {
    let is_condemned = condemns(&claimed, &other)
        && (0..2).all(|half| {
            let [claimed, other] = [claimed, other].map(|residual| residual.halves[half]);
            other < FITS && is_worse(claimed, other)
        });
    if claimed.all < FITS && !is_worse(claimed.all, other.all) {
        return match is_worse(other.all, claimed.all) {
            true => Decision::Fits,
            false => Decision::Tied,
        };
    }
    match is_condemned {
        true => Decision::Condemned,
        false if other.all < FITS => Decision::Doubtful,
        false if claimed.all < FITS => Decision::Tied,
        false => Decision::NothingFits,
    }
}
