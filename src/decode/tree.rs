//! The tree of wanted fields, which a decoder walks beside a message.

use super::{
    error::SchemaError,
    path::{FieldPath, PathStep},
};

/// The wanted fields of a message, by the names that lead to them.
pub type Branches<Name, Leaf> = Vec<(Name, FieldTree<Name, Leaf>)>;

/// The wanted fields under one step of a path.
#[derive(Debug)]
pub enum FieldTree<Name, Leaf> {
    /// A wanted field.
    Leaf(Leaf),
    /// A message that holds wanted fields.
    Message(Branches<Name, Leaf>),
    /// A list that holds wanted elements, and its place in [`Slots::seen`](super::value::Slots::seen).
    List {
        counter: usize,
        elements: Vec<(usize, Self)>,
    },
}

/// A step of a path, its name in whatever form the encoding knows it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Key<Name> {
    Name(Name),
    Index(usize),
}

impl From<&PathStep> for Key<String> {
    fn from(step: &PathStep) -> Self {
        match step {
            PathStep::Name(name) => Self::Name(name.clone()),
            PathStep::Index(index) => Self::Index(*index),
        }
    }
}

/// A path that leads to what another path leads through.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Overlap;

/// The tree of wanted fields, each a path, the keys that lead there, and what is to be done there: the branches
/// of its root.
pub fn tree<Name: PartialEq + Clone, Leaf>(
    wanted: Vec<(&FieldPath, Vec<Key<Name>>, Leaf)>,
) -> Result<Branches<Name, Leaf>, SchemaError> {
    let mut root = Vec::new();
    let mut lists = 0;
    for (path, keys, leaf) in wanted {
        let path = path.clone();
        insert(&mut root, &keys, leaf, &mut lists)
            .map_err(|Overlap| SchemaError::Overlap { path })?;
    }
    Ok(root)
}

/// Adds a field at the end of a path to the branches of a message. `lists` counts the lists that paths lead
/// into.
fn insert<Name: PartialEq + Clone, Leaf>(
    branches: &mut Branches<Name, Leaf>,
    path: &[Key<Name>],
    leaf: Leaf,
    lists: &mut usize,
) -> Result<(), Overlap> {
    match path.split_first() {
        Some((Key::Name(name), rest)) => insert_under(branches, name, rest, leaf, lists),
        _ => Err(Overlap),
    }
}

/// Adds a field at the end of what is left of a path, under the key that comes before that.
fn insert_under<K: PartialEq + Clone, Name: PartialEq + Clone, Leaf>(
    branches: &mut Vec<(K, FieldTree<Name, Leaf>)>,
    key: &K,
    rest: &[Key<Name>],
    leaf: Leaf,
    lists: &mut usize,
) -> Result<(), Overlap> {
    let known = branches.iter().position(|(other, _)| other == key);
    let Some((next, after)) = rest.split_first() else {
        return match known {
            Some(_) => Err(Overlap),
            None => {
                branches.push((key.clone(), FieldTree::Leaf(leaf)));
                Ok(())
            }
        };
    };
    let place = known.unwrap_or_else(|| {
        let node = match next {
            Key::Name(_) => FieldTree::Message(Vec::new()),
            Key::Index(_) => {
                *lists += 1;
                FieldTree::List {
                    counter: *lists - 1,
                    elements: Vec::new(),
                }
            }
        };
        branches.push((key.clone(), node));
        branches.len() - 1
    });
    match (&mut branches[place].1, next) {
        (FieldTree::Message(branches), Key::Name(name)) => {
            insert_under(branches, name, after, leaf, lists)
        }
        (FieldTree::List { elements, .. }, Key::Index(index)) => {
            insert_under(elements, index, after, leaf, lists)
        }
        _ => Err(Overlap),
    }
}
