//! A path → the place in a schema that it leads to: the walk that all encodings share.

use std::fmt::Debug;

use super::{
    error::{Listing, SchemaError},
    field::FieldKind,
    path::{FieldPath, Filter, PathStep},
};
use crate::text::Foreign;

/// A place in a schema: a message, a list or a plain value, as one encoding describes it.
pub trait Node: Clone {
    /// How the encoding's decoder recognises a field of a message.
    type Name: Debug;

    /// What kind of value is there.
    fn kind(&self) -> FieldKind;

    /// The names of its fields, and what lists them; `None` if this is not a message.
    fn fields(&self) -> Option<(Listing, Vec<String>)>;

    /// The field with this name; `None` if this is not a message, or one without that field.
    fn field(&self, name: &str) -> Option<(Self::Name, Self)>;

    /// An element, counted from 0; `None` if this is not a list, or one that is always shorter.
    fn element(&self, index: usize) -> Option<Self>;

    /// An element that may be the first to satisfy filters; `None` if this is not a list, or one that is always empty.
    fn first(&self, _filters: &[Filter]) -> Option<Self> {
        self.element(0)
    }

    /// How many elements the list always has; `None` if this is not a list, or one of varying length.
    fn length(&self) -> Option<usize> {
        None
    }
}

/// The place that a path leads to, and the way there.
#[derive(Debug)]
pub struct Resolved<N: Node> {
    pub node: N,
    pub keys: Vec<Key<N>>,
}

/// A step of a path, with its name in the form that the encoding's decoder recognises.
#[derive(Debug)]
pub enum Key<N: Node> {
    Name(N::Name),
    Index(usize),
    /// The first element that satisfies these filters, each with the place of its field in the element.
    First(Vec<(Filter, Resolved<N>)>),
}

/// The last place that exists on a path, and how many steps lead to it.
#[derive(Debug)]
pub struct DeadEnd<'p, N> {
    pub node: N,
    pub depth: usize,
    /// The path, or that of a filter on it.
    path: &'p FieldPath,
}

/// Follows a path from the outermost message.
///
/// # Errors
/// The schema does not have what the path leads to.
pub fn resolve<N: Node>(root: N, path: &FieldPath) -> Result<Resolved<N>, SchemaError> {
    walk(root, path).map_err(|dead_end| dead_end.explain())
}

/// Follows a path as far as it goes. Unlike [`resolve`] it spends nothing on saying why it ends too early.
pub fn walk<N: Node>(root: N, path: &FieldPath) -> Result<Resolved<N>, DeadEnd<'_, N>> {
    let mut node = root;
    let mut keys = Vec::with_capacity(path.steps().len());
    for (depth, step) in path.steps().iter().enumerate() {
        let next = match step {
            PathStep::Name(name) => node.field(name).map(|(name, to)| (Key::Name(name), to)),
            &PathStep::Index(index) => node.element(index).map(|to| (Key::Index(index), to)),
            PathStep::First(filters) => match node.first(filters) {
                Some(to) => Some((Key::First(walk_filters(&to, filters)?), to)),
                None => None,
            },
        };
        let Some((key, to)) = next else {
            return Err(DeadEnd { node, depth, path });
        };
        keys.push(key);
        node = to;
    }
    Ok(Resolved { node, keys })
}

/// Follows the paths of filters from an element.
fn walk_filters<'p, N: Node>(
    element: &N,
    filters: &'p [Filter],
) -> Result<Vec<(Filter, Resolved<N>)>, DeadEnd<'p, N>> {
    (filters.iter())
        .map(|filter| Ok((filter.clone(), walk(element.clone(), &filter.field)?)))
        .collect()
}

impl<N: Node> DeadEnd<'_, N> {
    /// The step that leads nowhere.
    pub fn step(&self) -> &PathStep {
        &self.path.steps()[self.depth]
    }

    /// Explains why the path ends here.
    fn explain(&self) -> SchemaError {
        let path = self.path.clone();
        match (self.step(), self.node.fields(), self.node.length()) {
            (PathStep::Name(_), Some((place, available)), _) => SchemaError::NoSuchField {
                missing: vec![path],
                place,
                available: available.into_iter().map(Foreign::from).collect(),
            },
            (PathStep::Index(_), _, Some(length)) => SchemaError::OutOfRange { path, length },
            _ => SchemaError::NotThere {
                through: path.first(self.depth),
                kind: self.node.kind(),
                path,
            },
        }
    }
}
