//! All that viewers are shown of a flight, in order.

use super::{
    coverage::Coverage,
    flight::Flight,
    ground::footprint,
    options::VisualOptions,
    scene::{model, path, scene},
    stage::Stage,
    states::{Happening, Span, events, spans},
    terrain,
    view::{View, static_transforms},
};
use crate::{
    camera::FieldOfView,
    derived::visual::{Calibration, Footprint, Shown, Visual},
};

/// How often a place on the map is enough, per second.
const LOCATIONS: f64 = 5.0;

/// How often ticks are shown in which way: every how manieth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cadence {
    /// As a scene.
    pub scene: usize,
    /// As a place on the map.
    pub location: usize,
}

impl Cadence {
    /// For ticks at a rate per second, of which so many per second are scenes.
    pub fn new(ticks: f64, scenes: f64) -> Self {
        let every = |rate: f64| ((ticks / rate).round() as usize).max(1);
        Self {
            scene: every(scenes),
            location: every(LOCATIONS),
        }
    }
}

/// A flight, and what is the same for all of it.
#[derive(Debug)]
pub struct StagedFlight {
    /// The flight.
    pub flight: Flight,
    /// What is the same for all of it.
    pub stage: Stage,
    /// How often its ticks are shown.
    pub cadence: Cadence,
}

impl StagedFlight {
    /// Of a flight, for these options. The `calibration` that is known otherwise counts where they give no field of view,
    /// and the log's heights where they give no ground.
    pub fn new(
        mut flight: Flight,
        options: &VisualOptions,
        calibration: Option<Calibration>,
    ) -> Self {
        let terrain = terrain::settle(&mut flight.ticks, options.ground);
        let given = options.field_of_view.map(FieldOfView::calibration);
        let calibration = given.or(calibration);
        Self {
            stage: Stage::new(&flight, terrain, calibration, options.reach),
            cadence: Cadence::new(options.tick_rate(), options.scene_rate()),
            flight,
        }
    }
}

/// What is shown of a flight.
#[derive(Debug)]
pub struct Show<'a> {
    flight: &'a Flight,
    stage: &'a Stage,
    cadence: Cadence,
    spans: Vec<Span>,
}

impl<'a> Show<'a> {
    /// Of this flight.
    pub fn new(staged: &'a StagedFlight) -> Self {
        let StagedFlight {
            flight,
            stage,
            cadence,
        } = staged;
        Self {
            flight,
            stage,
            cadence: *cadence,
            spans: spans(flight, stage),
        }
    }

    /// Gives `take` all that is shown: first what is shown once, at the time of the first tick, because viewers that seek
    /// fetch the last message of each topic; then all that changes, epoch by epoch, in the order of its times.
    ///
    /// # Errors
    /// Those of `take`.
    pub fn each<E>(&self, mut take: impl FnMut(u32, Shown) -> Result<(), E>) -> Result<(), E> {
        let times = self.flight.ticks.iter().map(|tick| tick.time);
        let Some(start) = times.min() else {
            return Ok(());
        };
        let mut once = vec![Visual::StaticTransforms(static_transforms())];
        once.extend(self.stage.calibration.map(Visual::Calibration));
        once.push(Visual::Model(model(self.stage)));
        once.extend(path(self.flight, self.stage).map(Visual::Path));
        once.extend(self.coverage().map(Visual::Footprint));
        for visual in once {
            take(
                0,
                Shown {
                    time: start,
                    visual,
                },
            )?;
        }
        self.each_tick(take)
    }

    fn each_tick<E>(&self, mut take: impl FnMut(u32, Shown) -> Result<(), E>) -> Result<(), E> {
        let mut events = events(self.flight, &self.spans).into_iter().peekable();
        let mut spans = self.spans.iter().peekable();
        let mut heading = Unwrapped::default();
        let mut state = None;
        for (number, tick) in self.flight.ticks.iter().enumerate() {
            let now = (tick.epoch, tick.time);
            while let Some(one) = events.next_if(|one| (one.epoch, one.from) <= now) {
                happened(one, &mut take)?;
            }
            let mut visuals = Vec::with_capacity(8);
            let begun = spans.next_if(|span| (span.epoch, span.from) == now);
            state = begun.or(state);
            // Viewers draw a state up to the next message, so the last one is said again at the end.
            let next = self.flight.ticks.get(number + 1);
            let is_last = next.is_none_or(|next| next.epoch != tick.epoch);
            let said = begun.or(state.filter(|_| is_last));
            visuals.extend(said.map(|span| Visual::State(span.state)));
            let view = View::of(self.flight, number, self.stage);
            let is_scene = number.is_multiple_of(self.cadence.scene);
            if let Some(view) = &view {
                let unwrapped = heading.go_to(view.angles().yaw.to_degrees());
                if let Some(mut transforms) = view.transforms(self.stage) {
                    // It moves smoothly, and viewers interpolate.
                    transforms.extend(view.viewpoint(self.stage).filter(|_| is_scene));
                    visuals.push(Visual::Transforms(transforms));
                }
                visuals.extend(view.odometry().map(Visual::Odometry));
                visuals.extend(view.pose().map(Visual::Pose));
                visuals.push(Visual::Display(view.display(unwrapped)));
                let location = view.location().map(Visual::Location);
                visuals.extend(location.filter(|_| number.is_multiple_of(self.cadence.location)));
            }
            if is_scene {
                visuals.push(Visual::Scene(scene(view.as_ref(), self.stage)));
            }
            for visual in visuals {
                let time = tick.time;
                take(tick.epoch, Shown { time, visual })?;
            }
        }
        events.try_for_each(|one| happened(one, &mut take))
    }

    /// What all pictures cover.
    fn coverage(&self) -> Option<Footprint> {
        let calibration = self.stage.calibration.as_ref()?;
        let mut coverage = Coverage::default();
        for number in (0..self.flight.ticks.len()).step_by(self.cadence.scene) {
            if let Some(view) = View::of(self.flight, number, self.stage)
                && let (Some(corners), Some(place)) =
                    (footprint(&view, calibration, self.stage.reach), view.place)
            {
                coverage.add(&corners, &place);
            }
        }
        coverage.finish(self.stage)
    }
}

/// Shows something that happened, as an event and as a line of a log.
fn happened<E>(
    one: Happening,
    take: &mut impl FnMut(u32, Shown) -> Result<(), E>,
) -> Result<(), E> {
    for visual in [Visual::Event(one.event.clone()), Visual::Log(one.event)] {
        let time = one.from;
        take(one.epoch, Shown { time, visual })?;
    }
    Ok(())
}

/// An angle in degrees without steps of a full turn.
#[derive(Debug, Default)]
struct Unwrapped(Option<f64>);

impl Unwrapped {
    fn go_to(&mut self, degrees: f64) -> f64 {
        let last = self.0.unwrap_or(degrees.rem_euclid(360.0));
        let next = degrees + 360.0 * ((last - degrees) / 360.0).round();
        self.0 = Some(next);
        next
    }
}
