//! Finding the first element of a list that satisfies filters, while the elements are read one after the other.
//!
//! Every element is read into slots that are there for that. If it is the first that satisfies some filters, what is
//! wanted of it is copied from there to the slots where it is wanted. So an element is read only once, whatever is
//! wanted of it, and nothing is allocated.

use std::{mem, ops::Range};

use super::{
    path::Filter,
    trial::{Trial, all_hold},
    value::Slots,
};

/// Which elements of a list are wanted, and what of each.
#[derive(Debug, Default)]
pub struct Picks {
    picks: Vec<Pick>,
    /// The slots into which every element is read.
    values: Vec<usize>,
    /// The counts of lists within every element.
    counts: Vec<usize>,
}

/// One of these elements.
#[derive(Debug)]
struct Pick {
    filters: Vec<Filter<usize>>,
    /// What is noted of the filters, in [`Slots::trials`].
    trials: Range<usize>,
    /// Counts the element in [`Slots::seen`] when it is found.
    found: usize,
    /// From which slots its values are copied to which.
    copies: Vec<(usize, usize)>,
}

impl Picks {
    /// Adds a slot into which every element is read, and counts of lists within it.
    pub fn read_of_each(&mut self, slot: usize, counts: Range<usize>) {
        self.values.push(slot);
        self.counts.extend(counts);
    }

    /// Adds a value of the first element that satisfies these filters, which is copied from one slot to another.
    pub fn add(
        &mut self,
        filters: Vec<Filter<usize>>,
        trials: Vec<Trial>,
        from: usize,
        to: usize,
        slots: &mut Slots,
    ) {
        let known = self.picks.iter().position(|pick| pick.filters == filters);
        let place = known.unwrap_or_else(|| {
            let first = slots.trials.len();
            slots.trials.extend(trials);
            self.picks.push(Pick {
                filters,
                trials: first..slots.trials.len(),
                found: slots.add_count(),
                copies: Vec::new(),
            });
            self.picks.len() - 1
        });
        let pick = &mut self.picks[place];
        pick.copies.push((from, to));
        slots.picked.push((to, pick.found));
    }

    /// The first of the slots to which something is copied.
    pub fn first_slot(&self) -> Option<usize> {
        let mut copies = self.picks.iter().flat_map(|pick| &pick.copies);
        copies.next().map(|&(_, to)| to)
    }

    /// Whether no more elements need to be read.
    pub fn are_found(&self, slots: &Slots) -> bool {
        self.picks.iter().all(|pick| slots.seen[pick.found] > 0)
    }

    /// Uses an element that was read, if it is wanted, and makes room for the next.
    pub fn take(&self, slots: &mut Slots) {
        for pick in &self.picks {
            let trials = &mut slots.trials[pick.trials.clone()];
            if slots.seen[pick.found] > 0 || !all_hold(&pick.filters, &slots.values, trials) {
                continue;
            }
            slots.seen[pick.found] = 1;
            for &(from, to) in &pick.copies {
                let value = mem::take(&mut slots.values[from]);
                slots.values[to].copy_from(&value);
                slots.values[from] = value;
            }
        }
        self.values
            .iter()
            .for_each(|&slot| slots.values[slot].clear());
        self.counts.iter().for_each(|&count| slots.seen[count] = 0);
    }
}
