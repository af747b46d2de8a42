//! A flight as one publisher recorded it.

use super::{flight::Flight, recorder::Recorder, simulated::Simulated};
use crate::support::manoeuvres::Manoeuvre;

/// A flight, and how it is written down.
pub struct Recording {
    /// What is special about it.
    pub name: String,
    /// The profile that should understand it.
    pub profile: &'static str,
    pub flight: Flight,
    /// How exact the numbers of attitude, velocity and gimbal are.
    pub precision: Precision,
    /// What the gimbal's angles are measured from, where the log has them.
    pub gimbal: Option<Reference>,
    /// What the log has of the position.
    pub position: Option<Position>,
    /// How exact the heights above the ground are in metres, where the log has them.
    pub height: Option<f64>,
    write: Write,
}

type Write = Box<dyn Fn(&Flight, &mut Recorder)>;

/// How exact numbers are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Precision {
    /// float64, or JSON.
    Double,
    /// float32.
    Single,
}

impl Precision {
    /// How far derived angles (rad) and velocities (m/s) may be from those of the same flight in doubles:
    /// 1e-9, and for float32 what its 24 bits leave of velocities below 20 m/s, turned by angles of 24 bits.
    pub fn tolerance(self) -> f64 {
        match self {
            Self::Double => 1e-9,
            Self::Single => 5e-6,
        }
    }
}

/// What a gimbal's angles are measured from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reference {
    Earth,
    Heading,
    Airframe,
}

/// What a log has of the position, and how exactly in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Position {
    Geodetic { tolerance: f64 },
    Local { tolerance: f64 },
}

impl Recording {
    /// In doubles, without gimbal and position.
    pub fn new(
        profile: &'static str,
        name: &str,
        flight: Flight,
        write: impl Fn(&Flight, &mut Recorder) + 'static,
    ) -> Self {
        Self {
            name: format!("{profile}: {name}"),
            profile,
            flight,
            precision: Precision::Double,
            gimbal: None,
            position: None,
            height: None,
            write: Box::new(write),
        }
    }

    pub fn with_floats(self) -> Self {
        let precision = Precision::Single;
        Self { precision, ..self }
    }

    pub fn with_gimbal(self, reference: Reference) -> Self {
        let gimbal = Some(reference);
        Self { gimbal, ..self }
    }

    pub fn with_geodetic(self, tolerance: f64) -> Self {
        let position = Some(Position::Geodetic { tolerance });
        Self { position, ..self }
    }

    pub fn with_local(self, tolerance: f64) -> Self {
        let position = Some(Position::Local { tolerance });
        Self { position, ..self }
    }

    /// With heights at the times of positions.
    pub fn with_heights(self, tolerance: f64) -> Self {
        let height = Some(tolerance);
        Self { height, ..self }
    }

    /// The same recording of a flight of other times.
    pub fn flying(self, change: impl FnOnce(Flight) -> Flight) -> Self {
        let flight = change(self.flight);
        Self { flight, ..self }
    }

    /// The same recording of a simulated flight.
    pub fn of_manoeuvre(self, manoeuvre: Manoeuvre, seconds: f64) -> Self {
        let reference = self.gimbal.unwrap_or(Reference::Heading);
        self.flying(|flight| flight.simulated(Simulated::new(manoeuvre, seconds, reference)))
    }

    /// Adds the flight to a log.
    pub fn write(&self, log: &mut Recorder) {
        (self.write)(&self.flight, log);
    }

    /// The flight in a log of its own.
    pub fn log(&self) -> Vec<u8> {
        let mut log = Recorder::new();
        self.write(&mut log);
        log.finish()
    }

    /// The topics that it has.
    pub fn topics(&self) -> Vec<String> {
        let mut log = Recorder::new();
        self.write(&mut log);
        log.topics().to_vec()
    }
}
