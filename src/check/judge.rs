//! Judging a flight: each comparison that its series allow.

mod attitude;
mod body_velocity;
mod explain;
mod gimbal;
mod time;
mod velocity;

use nalgebra::{UnitQuaternion, Vector3};

use super::{
    claims::Claims,
    displacement::Displacement,
    gravity::Gravity,
    inertia::Inertia,
    lean::Lean,
    oddity::ON_ITS_SIDE,
    reading::{Reread, VectorReading},
    recorder::Recorder,
    residual::{Decision, Judged, Pair, Part},
    track::Timed,
    turning::Turning,
    verdict::{
        Candidate, Findings, Motion, Outcome, Reading, Subject, Undecided, Verdict, Witness,
    },
};

/// The least median displacement in two seconds, in metres: half a metre, a quarter of a metre per second.
const DISPLACEMENT: [Part; 2] = [
    Part::Horizontal { least: 1.0 },
    Part::Vertical { least: 0.5 },
];

/// The least median change of the velocity in two seconds, in m/s.
const CHANGE: [Part; 2] = [
    Part::Horizontal { least: 1.0 },
    Part::Vertical { least: 0.8 },
];

/// The least median lean, as the acceleration that it gives in m/s²: four degrees.
const LEAN: Part = Part::Horizontal { least: 0.7 };

/// The least median turn in 0.4 s, in radians: three degrees.
const TURN: Part = Part::EachAxis { least: 0.05 };

/// Gravity is always there.
const GRAVITY: Part = Part::Everywhere;

/// Shifts of the times, in seconds, that are not held against a reading: receivers are late by as much.
const SMALL_SHIFTS: [f64; 5] = [0.0, -0.15, 0.15, -0.3, 0.3];

/// How many of the other readings are shown.
const MOST_SHOWN: usize = 4;

/// How thoroughly a flight is judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Depth {
    /// Everything is found out.
    Full,
    /// Only what is certainly wrong: what fits is left at that.
    Contradictions,
}

impl Recorder {
    /// Everything that the flight's numbers say about the readings.
    pub fn judge(&self, claims: &Claims) -> Findings {
        self.findings(claims, Depth::Full)
    }

    /// What the flight's numbers certainly contradict, and what is odd. If nothing is contradicted, this takes little
    /// time.
    pub fn certain(&self, claims: &Claims) -> Findings {
        let mut findings = self.findings(claims, Depth::Contradictions);
        findings.verdicts.retain(Verdict::is_contradicted);
        findings
    }

    fn findings(&self, claims: &Claims, depth: Depth) -> Findings {
        let verdicts = Flight::new(self, claims, claims, depth).verdicts();
        Findings {
            oddities: self.oddities(claims),
            explanations: self.explanations(claims, &verdicts),
            verdicts,
        }
    }
}

/// The series of a flight under some readings, with vectors as the log's own numbers.
struct Flight<'a> {
    recorder: &'a Recorder,
    readings: &'a Claims,
    depth: Depth,
    velocities: Vec<Timed<Vector3<f64>>>,
    attitudes: Vec<Timed<UnitQuaternion<f64>>>,
    rates: Vec<Timed<Vector3<f64>>>,
    accelerations: Vec<Timed<Vector3<f64>>>,
}

impl<'a> Flight<'a> {
    /// The series of a flight whose samples were read as claimed, under other readings.
    fn new(recorder: &'a Recorder, claims: &Claims, readings: &'a Claims, depth: Depth) -> Self {
        let is_claimed =
            |is_body: bool| (claims.velocity).is_some_and(|velocity| velocity.is_body() == is_body);
        let velocities = recorder.velocities.samples.iter();
        let velocities = velocities.filter(|sample| is_claimed(sample.value.is_body));
        let velocities = velocities.map(|sample| Timed {
            time: sample.time - readings.velocity_late_by_s,
            value: sample.value.vector,
        });
        let reread = (readings.attitude.zip(claims.attitude))
            .filter(|(reading, claimed)| reading != claimed)
            .and_then(|(reading, claimed)| reading.instead_of(&claimed));
        let attitudes = recorder.attitudes.samples.iter().map(|sample| Timed {
            time: sample.time,
            value: reread.map_or(sample.value, |reread| reread.apply(sample.value)),
        });
        Self {
            recorder,
            readings,
            depth,
            velocities: numbers(velocities, claims.velocity),
            attitudes: attitudes.filter(|_| claims.attitude.is_some()).collect(),
            rates: numbers(
                recorder.rates.means.samples.iter().copied(),
                claims.angular_rate,
            ),
            accelerations: numbers(
                recorder.accelerations.means.samples.iter().copied(),
                claims.acceleration,
            ),
        }
    }

    fn verdicts(&self) -> Vec<Verdict> {
        let mut verdicts = Vec::new();
        for is_geodetic in [true, false] {
            verdicts.extend(self.by_positions(is_geodetic));
        }
        verdicts.extend(self.by_inertia());
        verdicts.extend(self.by_lean());
        verdicts.extend(self.by_rates());
        verdicts.extend(self.by_gravity());
        verdicts.extend(self.of_the_gimbal());
        moderate(&mut verdicts);
        verdicts
    }

    /// Whether the drone's own down axis is nearly level most of the time.
    fn is_on_its_side(&self) -> bool {
        let down = |sample: &&Timed<UnitQuaternion<f64>>| (sample.value * Vector3::z()).z;
        let attitudes = self.attitudes.iter();
        let level = attitudes.filter(|sample| down(sample).abs() < ON_ITS_SIDE.cos());
        2 * level.count() > self.attitudes.len()
    }

    /// The velocity, by the positions.
    fn by_positions(&self, is_geodetic: bool) -> Vec<Verdict> {
        let positions = self.recorder.positions.samples.iter();
        let positions = positions.filter(|sample| sample.value.is_geodetic == is_geodetic);
        let positions = positions.map(|sample| Timed {
            time: sample.time,
            value: sample.value.metres,
        });
        let positions: Vec<_> = positions.collect();
        let Some(claimed) = self.readings.velocity.filter(|_| !positions.is_empty()) else {
            return Vec::new();
        };
        let witness = match is_geodetic {
            true => Witness::GeodeticPosition,
            false => Witness::LocalPosition,
        };
        let moved = Displacement::new(&positions, &self.velocities, &self.attitudes);
        let pairs = |velocity: &VectorReading, late_by: f64| moved.pairs(velocity, late_by);
        let mut verdicts = self.of_the_velocity(witness, DISPLACEMENT, claimed, &pairs);
        if is_geodetic && claimed.is_body() {
            self.blame_the_attitude(&positions, claimed, &mut verdicts);
        }
        verdicts
    }

    /// The velocity and the attitude, by the accelerations.
    fn by_inertia(&self) -> Vec<Verdict> {
        let (Some(velocity), Some(acceleration)) =
            (self.readings.velocity, self.readings.acceleration)
        else {
            return Vec::new();
        };
        if self.velocities.is_empty() || self.accelerations.is_empty() || self.attitudes.is_empty()
        {
            return Vec::new();
        }
        let inertia = Inertia::new(&self.velocities, &self.attitudes, &self.accelerations);
        let of_attitude = self.of_the_attitude(
            Subject::AttitudeAndVelocity,
            Witness::Inertia,
            CHANGE[0],
            self.other_accelerations(acceleration),
            |change, late_by| {
                let (acceleration, attitude) = change.of(&acceleration);
                let pairs = inertia.pairs(&velocity, acceleration, attitude, late_by);
                // What the velocity does is what the attitude must explain.
                let pairs = pairs.into_iter();
                pairs.map(|pair| pair.map(Pair::swapped)).collect()
            },
        );
        let pairs = |velocity: &VectorReading, late_by: f64| {
            inertia.pairs(velocity, &acceleration, None, late_by)
        };
        let mut verdicts = self.of_the_velocity(Witness::Inertia, CHANGE, velocity, &pairs);
        if of_attitude.as_ref().is_some_and(Verdict::is_contradicted) {
            // What an attitude that is misread says about times is worth nothing.
            verdicts.retain(|verdict| verdict.subject != Subject::VelocityTime);
        }
        verdicts.extend(of_attitude);
        verdicts
    }

    /// The attitude and the velocity, by each other.
    fn by_lean(&self) -> Option<Verdict> {
        let velocity = self.readings.velocity?;
        if self.velocities.is_empty() || self.attitudes.is_empty() {
            return None;
        }
        let lean = Lean::new(&self.velocities, &self.attitudes);
        let others = self
            .other_velocities(velocity)
            .into_iter()
            .map(Reading::Velocity);
        self.of_the_attitude(
            Subject::AttitudeAndVelocity,
            Witness::Lean,
            LEAN,
            others.collect(),
            |change, late_by| {
                let (velocity, attitude) = change.of(&velocity);
                lean.pairs(velocity, attitude, late_by)
            },
        )
    }

    /// How the attitude turns, by the angular rates.
    fn by_rates(&self) -> Option<Verdict> {
        let rate = self.readings.angular_rate?;
        if self.rates.is_empty() || self.attitudes.is_empty() {
            return None;
        }
        let turning = Turning::new(&self.attitudes, &self.rates);
        self.of_the_attitude(
            Subject::AttitudeTurns,
            Witness::AngularRates,
            TURN,
            self.other_rates(rate),
            |change, _| {
                let (rate, attitude) = change.of(&rate);
                turning.pairs(rate, attitude)
            },
        )
    }

    /// Where the attitude has up and down, by gravity.
    fn by_gravity(&self) -> Option<Verdict> {
        let acceleration = self.readings.acceleration?;
        if self.accelerations.is_empty() || self.attitudes.is_empty() {
            return None;
        }
        let gravity = Gravity::new(&self.attitudes, &self.accelerations);
        self.of_the_attitude(
            Subject::AttitudeTilt,
            Witness::Gravity,
            GRAVITY,
            self.other_accelerations(acceleration),
            |change, _| {
                let (acceleration, attitude) = change.of(&acceleration);
                gravity.pairs(acceleration, attitude)
            },
        )
    }
}

/// What is read in another way.
#[derive(Clone, Copy)]
enum Change<'a> {
    None,
    Attitude(&'a Reread),
    Vector(&'a VectorReading),
}

impl<'a> Change<'a> {
    /// How the vector that was claimed to be read so is read now, and the attitude, if it is read in another way.
    fn of(self, claimed: &'a VectorReading) -> (&'a VectorReading, Option<&'a Reread>) {
        match self {
            Self::None => (claimed, None),
            Self::Attitude(attitude) => (claimed, Some(attitude)),
            Self::Vector(vector) => (vector, None),
        }
    }
}

fn numbers(
    track: impl Iterator<Item = Timed<Vector3<f64>>>,
    reading: Option<VectorReading>,
) -> Vec<Timed<Vector3<f64>>> {
    let Some(reading) = reading else {
        return Vec::new();
    };
    let numbers = track.map(|sample| Timed {
        time: sample.time,
        value: reading.numbers(sample.value),
    });
    numbers.collect()
}

/// Takes back what a stronger verdict denies.
fn moderate(verdicts: &mut [Verdict]) {
    let condemned_by_position = |subject: Subject, verdicts: &[Verdict]| {
        verdicts.iter().any(|verdict| {
            verdict.subject == subject
                && verdict.witness == Witness::GeodeticPosition
                && verdict.is_contradicted()
        })
    };
    for subject in [Subject::VelocityHorizontal, Subject::VelocityVertical] {
        // Attitude and velocity may be misread in the same way.
        if condemned_by_position(subject, verdicts) {
            for verdict in verdicts.iter_mut() {
                if verdict.subject == subject && verdict.outcome == Outcome::Proven {
                    verdict.outcome = Outcome::Consistent;
                }
            }
        }
    }
}

/// A verdict that is open yet.
fn open(subject: Subject, witness: Witness, judged: &Judged, part: Part) -> Verdict {
    let why = match judged.motion > 0.0 {
        true => Undecided::HardlyMoved {
            needed: part.least(),
        },
        false => Undecided::FewSamples,
    };
    Verdict {
        subject,
        witness,
        outcome: Outcome::Undecidable { why },
        motion: Some(Motion {
            median: judged.motion,
            unit: witness.unit_of_motion(),
            windows: judged.windows(),
        }),
        candidates: Vec::new(),
        shift: None,
    }
}

fn outcome(
    decision: Decision,
    witness: Witness,
    nearly_best: impl FnOnce() -> Vec<Reading>,
) -> Outcome {
    let why = match decision {
        Decision::Fits if witness.has_own_axes() => return Outcome::Proven,
        Decision::Fits => return Outcome::Consistent,
        Decision::Condemned => {
            return Outcome::Contradicted {
                fits: nearly_best(),
            };
        }
        Decision::Tied => Undecided::Tied {
            with: nearly_best(),
        },
        Decision::Doubtful => Undecided::Doubtful {
            better: nearly_best(),
        },
        Decision::NothingFits => Undecided::NothingFits,
    };
    Outcome::Undecidable { why }
}

/// The claimed reading, and the best of the others.
fn candidates(
    claimed: (Reading, f64),
    others: impl IntoIterator<Item = (Reading, f64)>,
) -> Vec<Candidate> {
    let all = [claimed].into_iter().chain(others).take(1 + MOST_SHOWN);
    let all = all.map(|(reading, residual)| Candidate { reading, residual });
    all.collect()
}

/// Of several shifts the one with the least residual.
fn best_of(shifts: &[f64], judged: impl Fn(f64) -> Judged) -> Judged {
    let residual = |judged: &Judged| match judged.residual() {
        residual if residual.is_nan() => f64::INFINITY,
        residual => residual,
    };
    let mut best = judged(shifts[0]);
    for &shift in &shifts[1..] {
        let other = judged(shift);
        if residual(&other) < residual(&best) {
            best = other;
        }
    }
    best
}
