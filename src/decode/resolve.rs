//! A path → the place in a schema that it leads to: the walk that all encodings share.

use super::{
    error::{Listing, SchemaError},
    field::FieldKind,
    path::{FieldPath, PathStep},
};
use crate::text::Foreign;

/// A place in a schema: a message, a list or a plain value, as one encoding describes it.
pub trait Node: Sized {
    /// How the encoding's decoder recognises a field of a message.
    type Name;

    /// What kind of value is there.
    fn kind(&self) -> FieldKind;

    /// The names of its fields, and what lists them; `None` if this is not a message.
    fn fields(&self) -> Option<(Listing, Vec<String>)>;

    /// The field with this name; `None` if this is not a message, or one without that field.
    fn field(&self, name: &str) -> Option<(Self::Name, Self)>;

    /// An element, counted from 0; `None` if this is not a list, or one that is always shorter.
    fn element(&self, index: usize) -> Option<Self>;

    /// How many elements the list always has; `None` if this is not a list, or one of varying length.
    fn length(&self) -> Option<usize> {
        None
    }
}

/// The place that a path leads to, and the way there.
#[derive(Debug)]
pub struct Resolved<N: Node> {
    pub node: N,
    pub keys: Vec<Key<N::Name>>,
}

/// A step of a path, with its name in the form that the encoding's decoder recognises.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Key<Name> {
    Name(Name),
    Index(usize),
}

/// The last place that exists on a path, and how many steps lead to it.
#[derive(Debug)]
pub struct DeadEnd<N> {
    pub node: N,
    pub depth: usize,
}

/// Follows a path from the outermost message.
///
/// # Errors
/// The schema does not have what the path leads to.
pub fn resolve<N: Node>(root: N, path: &FieldPath) -> Result<Resolved<N>, SchemaError> {
    walk(root, path).map_err(|dead_end| dead_end.explain(path))
}

/// Follows a path as far as it goes. Unlike [`resolve`] it spends nothing on saying why it ends too early.
pub fn walk<N: Node>(root: N, path: &FieldPath) -> Result<Resolved<N>, DeadEnd<N>> {
    let mut node = root;
    let mut keys = Vec::with_capacity(path.steps().len());
    for (depth, step) in path.steps().iter().enumerate() {
        let next = match step {
            PathStep::Name(name) => node.field(name).map(|(name, to)| (Key::Name(name), to)),
            &PathStep::Index(index) => node.element(index).map(|to| (Key::Index(index), to)),
        };
        let Some((key, to)) = next else {
            return Err(DeadEnd { node, depth });
        };
        keys.push(key);
        node = to;
    }
    Ok(Resolved { node, keys })
}

impl<N: Node> DeadEnd<N> {
    /// Explains why the path ends here.
    fn explain(&self, path: &FieldPath) -> SchemaError {
        let path = path.clone();
        match (
            &path.steps()[self.depth],
            self.node.fields(),
            self.node.length(),
        ) {
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
