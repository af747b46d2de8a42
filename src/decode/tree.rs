//! The tree of wanted fields. A decoder walks it beside each message and skips what is not in it.

use std::vec;

use super::{
    error::SchemaError,
    field::{Shape, Wanted},
    path::{FieldPath, Filter, PathStep},
    pick::Picks,
    resolve::{Key, Node, Resolved, resolve},
    trial::Trial,
    value::Slots,
};

/// The wanted fields of a message.
pub type Branches<Name, Leaf> = Vec<(Name, FieldTree<Name, Leaf>)>;

/// What is wanted of a field or an element.
#[derive(Debug)]
pub enum FieldTree<Name, Leaf> {
    /// All of it.
    Leaf(Leaf),
    /// Fields of it, which is a message.
    Message(Branches<Name, Leaf>),
    /// Elements of it, which is a list.
    List {
        /// The list's index in [`Slots::seen`].
        counter: usize,
        elements: Vec<(usize, Self)>,
    },
    /// Elements of it, which is a list of messages: those that are the first to satisfy some filters.
    First(First<Name, Leaf>),
}

/// Elements of a list that are the first to satisfy some filters.
#[derive(Debug)]
pub struct First<Name, Leaf> {
    /// What is read of every element, until all are found.
    pub element: Branches<Name, Leaf>,
    /// What becomes of it.
    pub picks: Picks,
    /// The paths of what is read, within an element, and the slots.
    fields: Vec<((Vec<PathStep>, Shape), usize)>,
}

impl<Name, Leaf> Default for First<Name, Leaf> {
    fn default() -> Self {
        Self {
            element: Vec::new(),
            picks: Picks::default(),
            fields: Vec::new(),
        }
    }
}

/// Resolves wanted fields against the schema of a message. `leaf` makes what reads a field of some shape into a slot,
/// the n-th field into slot n; it returns `None` if the field does not have that shape. Returns the tree, and slots for
/// all that it reads.
///
/// # Errors
/// A field is not in the schema, or not of the wanted shape; or one path leads to a value that another leads through.
pub fn tree<N: Node<Name: PartialEq>, Leaf>(
    message: &N,
    wanted: &[Wanted],
    leaf: impl Fn(&N, Shape, usize) -> Option<Leaf>,
) -> Result<(Branches<N::Name, Leaf>, Slots), SchemaError> {
    let mut builder = Builder {
        slots: Slots::default(),
        leaf: |goal: &Goal<N>, slot| leaf(&goal.node, goal.shape, slot),
    };
    let slots: Vec<usize> = (wanted.iter())
        .map(|field| builder.slots.add_value(field.shape))
        .collect();
    let mut fields = Vec::new();
    for (Wanted { path, shape }, slot) in wanted.iter().zip(slots) {
        let goal = Goal::new(path, resolve(message.clone(), path)?, *shape);
        builder.grow_fields(&mut fields, goal, slot)?;
    }
    Ok((fields, builder.slots))
}

/// A value that is wanted, and the rest of the way to it.
struct Goal<'p, N: Node> {
    path: &'p FieldPath,
    /// The steps that are left, as the path has them.
    steps: &'p [PathStep],
    /// The same, as the decoder recognises them.
    keys: vec::IntoIter<Key<N>>,
    node: N,
    shape: Shape,
}

impl<'p, N: Node> Goal<'p, N> {
    fn new(path: &'p FieldPath, place: Resolved<N>, shape: Shape) -> Self {
        Self {
            path,
            steps: path.steps(),
            keys: place.keys.into_iter(),
            node: place.node,
            shape,
        }
    }

    /// Takes the next step.
    fn next(&mut self) -> Option<Key<N>> {
        self.steps = self.steps.get(1..).unwrap_or_default();
        self.keys.next()
    }

    /// What is there does not have the wanted shape.
    fn wrong_shape(&self) -> SchemaError {
        SchemaError::WrongShape {
            path: self.path.clone(),
            wanted: self.shape.into(),
            kind: self.node.kind(),
        }
    }
}

struct Builder<F> {
    leaf: F,
    slots: Slots,
}

impl<F> Builder<F> {
    /// Adds a field within a message.
    fn grow_fields<N: Node<Name: PartialEq>, Leaf>(
        &mut self,
        fields: &mut Branches<N::Name, Leaf>,
        mut goal: Goal<N>,
        slot: usize,
    ) -> Result<(), SchemaError>
    where
        F: Fn(&Goal<N>, usize) -> Option<Leaf>,
    {
        match goal.next() {
            Some(Key::Name(name)) => self.grow_at(fields, name, goal, slot),
            _ => Err(goal.wrong_shape()),
        }
    }

    /// Adds something within the field or the element with this key.
    fn grow_at<K: PartialEq, N: Node<Name: PartialEq>, Leaf>(
        &mut self,
        branches: &mut Vec<(K, FieldTree<N::Name, Leaf>)>,
        key: K,
        goal: Goal<N>,
        slot: usize,
    ) -> Result<(), SchemaError>
    where
        F: Fn(&Goal<N>, usize) -> Option<Leaf>,
    {
        let known = branches.iter().position(|(other, _)| *other == key);
        let place = known.unwrap_or(branches.len());
        let known = known.map(|place| branches.remove(place).1);
        branches.insert(place, (key, self.grow(known, goal, slot)?));
        Ok(())
    }

    /// Adds something to what is wanted of a place.
    fn grow<N: Node<Name: PartialEq>, Leaf>(
        &mut self,
        known: Option<FieldTree<N::Name, Leaf>>,
        mut goal: Goal<N>,
        slot: usize,
    ) -> Result<FieldTree<N::Name, Leaf>, SchemaError>
    where
        F: Fn(&Goal<N>, usize) -> Option<Leaf>,
    {
        let path = goal.path.clone();
        let Some(key) = goal.next() else {
            return match known {
                None => (self.leaf)(&goal, slot)
                    .map(FieldTree::Leaf)
                    .ok_or_else(|| goal.wrong_shape()),
                Some(_) => Err(SchemaError::Overlap { path }),
            };
        };
        let known = known.unwrap_or_else(|| self.beginning_with(&key));
        match (key, known) {
            (Key::Name(name), FieldTree::Message(mut fields)) => {
                self.grow_at(&mut fields, name, goal, slot)?;
                Ok(FieldTree::Message(fields))
            }
            (
                Key::Index(index),
                FieldTree::List {
                    counter,
                    mut elements,
                },
            ) => {
                self.grow_at(&mut elements, index, goal, slot)?;
                Ok(FieldTree::List { counter, elements })
            }
            (Key::First(filters), FieldTree::First(mut first)) => {
                self.grow_first(&mut first, filters, goal, slot)?;
                Ok(FieldTree::First(first))
            }
            (Key::Index(_), FieldTree::First(_)) | (Key::First(_), FieldTree::List { .. }) => {
                Err(SchemaError::PlaceAndFilter { path })
            }
            _ => Err(SchemaError::Overlap { path }),
        }
    }

    /// The empty tree that such a key leads into.
    fn beginning_with<N: Node, Leaf>(&mut self, key: &Key<N>) -> FieldTree<N::Name, Leaf> {
        match key {
            Key::Name(_) => FieldTree::Message(Vec::new()),
            Key::Index(_) => FieldTree::List {
                counter: self.slots.add_count(),
                elements: Vec::new(),
            },
            Key::First(_) => FieldTree::First(First::default()),
        }
    }

    /// Adds something within the first element that satisfies some filters.
    fn grow_first<N: Node<Name: PartialEq>, Leaf>(
        &mut self,
        first: &mut First<N::Name, Leaf>,
        filters: Vec<(Filter, Resolved<N>)>,
        goal: Goal<N>,
        slot: usize,
    ) -> Result<(), SchemaError>
    where
        F: Fn(&Goal<N>, usize) -> Option<Leaf>,
    {
        let value = self.read_of_each(first, goal)?;
        let mut bound = Vec::new();
        let mut trials = Vec::new();
        for (filter, place) in filters {
            let goal = Goal::new(&filter.field, place, filter.value.shape());
            if !goal.node.kind().is_a(goal.shape) {
                return Err(goal.wrong_shape());
            }
            let field = self.read_of_each(first, goal)?;
            bound.push(filter.with_field(field));
            trials.push(Trial::of(&filter));
        }
        first.picks.add(bound, trials, value, slot, &mut self.slots);
        Ok(())
    }

    /// Adds a field that is read of each element. Returns the slot that it has for itself.
    fn read_of_each<N: Node<Name: PartialEq>, Leaf>(
        &mut self,
        first: &mut First<N::Name, Leaf>,
        goal: Goal<N>,
    ) -> Result<usize, SchemaError>
    where
        F: Fn(&Goal<N>, usize) -> Option<Leaf>,
    {
        let field = (goal.steps.to_vec(), goal.shape);
        let known = first.fields.iter().find(|(other, _)| *other == field);
        if let Some((_, slot)) = known {
            return Ok(*slot);
        }
        let slot = self.slots.add_value(goal.shape);
        let counts = self.slots.seen.len();
        self.grow_fields(&mut first.element, goal, slot)?;
        first
            .picks
            .read_of_each(slot, counts..self.slots.seen.len());
        first.fields.push((field, slot));
        Ok(slot)
    }
}
