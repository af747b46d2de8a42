//! Which messages of a channel are of the source that is meant, where several share a topic.

use super::{
    Origin,
    bind::{BoundRole, Reading},
};
use crate::{
    decode::{
        path::{Comparison, FieldPath, Filter, Literal, MessagePath, PathStep},
        trial::{Trial, UnmetFilter, all_hold},
        value::Slots,
    },
    sample::DropReason,
};

/// The paths of a role's fields for one of several sources, which a field with this value tells apart: a filter for the
/// elements of the list that the field is in, if it is in one, or else for messages.
pub fn paths_of_source(origin: &Origin, id: &FieldPath, value: &Literal) -> Vec<MessagePath> {
    let filter = |field| Filter {
        field,
        comparison: Comparison::Equal,
        value: value.clone(),
    };
    let steps = id.steps();
    let in_list = steps
        .iter()
        .rposition(|step| matches!(step, PathStep::Index(_)));
    let of_elements = in_list.and_then(|place| {
        let field = FieldPath::of_steps(steps[place + 1..].to_vec())?;
        Some((place, PathStep::First(vec![filter(field)])))
    });
    let path = |field: &FieldPath| {
        let mut path = MessagePath {
            topic: origin.topic.as_str().to_owned(),
            filters: Vec::new(),
            field: Some(field.clone()),
            quoted: true,
        };
        match &of_elements {
            Some((place, first)) if field.steps().starts_with(&steps[..=*place]) => {
                let mut steps = field.steps().to_vec();
                steps[*place] = first.clone();
                path.field = FieldPath::of_steps(steps);
            }
            _ => path.filters.push(filter(id.clone())),
        }
        path
    };
    origin.fields.iter().map(path).collect()
}

/// What is noted while the messages of a role are selected.
#[derive(Debug, Clone)]
pub struct Selection {
    /// How many messages were of another source.
    unselected: u64,
    /// For each of the role's readings.
    readings: Vec<OfReading>,
}

#[derive(Debug, Clone)]
struct OfReading {
    /// What is noted of its filters.
    trials: Vec<Trial>,
    /// What counts the elements of lists whose fields it reads, in [`Slots::seen`].
    elements: Vec<usize>,
}

impl Selection {
    /// Begins to select the messages of a role, which are read into such slots.
    pub fn new(role: &BoundRole, slots: &Slots) -> Self {
        let elements_of = |reading: &Reading| {
            let fields = reading.fields.fields();
            let picked = slots
                .picked
                .iter()
                .filter(|(slot, _)| fields.contains(&slot));
            picked.map(|&(_, found)| found).collect()
        };
        let readings = role.readings.iter().map(|reading| OfReading {
            trials: reading.trials.clone(),
            elements: elements_of(reading),
        });
        Self {
            unselected: 0,
            readings: readings.collect(),
        }
    }

    /// The reading that applies to a message, by its place; `None` if the message is of another source: it does not satisfy the
    /// filters, or has no element that does.
    ///
    /// # Errors
    /// The conditions of all readings that could apply do not hold, or a field for them is missing.
    pub fn reading_for(
        &mut self,
        role: &BoundRole,
        slots: &Slots,
    ) -> Result<Option<usize>, DropReason> {
        let mut is_selected = false;
        let readings = role.readings.iter().zip(&mut self.readings);
        for (place, (reading, noted)) in readings.enumerate() {
            let is_found = |&element: &usize| slots.seen[element] > 0;
            if !all_hold(&reading.select, &slots.values, &mut noted.trials)
                || !noted.elements.iter().all(is_found)
            {
                continue;
            }
            is_selected = true;
            match &reading.condition {
                Some(condition) if !condition.holds(&slots.values)? => {}
                _ => return Ok(Some(place)),
            }
        }
        match is_selected {
            true => Err(DropReason::UnmetCondition),
            false => {
                self.unselected += 1;
                Ok(None)
            }
        }
    }

    /// How many messages were of another source.
    pub fn unselected(&self) -> u64 {
        self.unselected
    }

    /// The filters that held for no message; none if those of one of several readings did.
    pub fn unmet(&self) -> impl Iterator<Item = UnmetFilter> {
        let unmet = |reading: &OfReading| -> Vec<UnmetFilter> {
            reading.trials.iter().filter_map(Trial::unmet).collect()
        };
        let unmet: Vec<_> = self.readings.iter().map(unmet).collect();
        let is_any_met = unmet.iter().any(Vec::is_empty);
        unmet.into_iter().filter(move |_| !is_any_met).flatten()
    }

    /// Adds what a clone has noted of other messages.
    pub fn merge(&mut self, clone: &Self) {
        self.unselected += clone.unselected;
        for (reading, clone) in self.readings.iter_mut().zip(&clone.readings) {
            Trial::merge_all(&mut reading.trials, &clone.trials);
        }
    }
}
