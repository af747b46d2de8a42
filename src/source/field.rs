//! Fields of messages: how they are named, what they held, and where a decoder looks for them.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A field of a message, or of a message within it: `roll`, `velocity.x`.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, Serialize)]
#[serde(try_from = "String", into = "String")]
pub struct FieldPath {
    names: Vec<String>,
}

impl FieldPath {
    /// The names from the outermost message to the field, at least one.
    pub fn names(&self) -> &[String] {
        &self.names
    }
}

impl TryFrom<String> for FieldPath {
    type Error = String;

    fn try_from(path: String) -> Result<Self, String> {
        let names: Vec<String> = path.split('.').map(str::to_owned).collect();
        if names.iter().any(String::is_empty) {
            return Err(format!(
                "`{path}` is not the path of a field: write names joined by dots, as in `velocity.x`"
            ));
        }
        Ok(Self { names })
    }
}

impl From<FieldPath> for String {
    fn from(path: FieldPath) -> Self {
        path.to_string()
    }
}

impl fmt::Display for FieldPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.names.join("."))
    }
}

/// A field that a role is made of.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Wanted {
    pub path: FieldPath,
    pub shape: Shape,
}

/// What a field holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    Number,
    List,
}

/// What a field held in one message: a number, a list of them, or nothing.
///
/// Booleans count as 0 and 1. Of a list the first [`CAPACITY`](Self::CAPACITY) numbers are kept.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FieldValue {
    present: bool,
    count: usize,
    numbers: [f64; Self::CAPACITY],
}

impl FieldValue {
    /// As many numbers as any field of interest has: a quaternion's.
    pub const CAPACITY: usize = 4;

    pub fn set(&mut self, number: f64) {
        self.set_empty_list();
        self.push(number);
    }

    pub fn set_empty_list(&mut self) {
        self.present = true;
        self.count = 0;
    }

    pub fn push(&mut self, number: f64) {
        if let Some(slot) = self.numbers.get_mut(self.count) {
            *slot = number;
        }
        self.count += 1;
    }

    pub fn clear(&mut self) {
        self.present = false;
    }

    pub fn is_present(&self) -> bool {
        self.present
    }

    /// The number; `None` where the field is missing or is a list of another length than one.
    pub fn number(&self) -> Option<f64> {
        (self.present && self.count == 1).then_some(self.numbers[0])
    }

    /// The numbers that were kept of a list.
    pub fn numbers(&self) -> &[f64] {
        &self.numbers[..self.count.min(Self::CAPACITY)]
    }

    /// The list, if it has exactly four numbers.
    pub fn four(&self) -> Option<[f64; 4]> {
        (self.count == 4).then_some(self.numbers)
    }
}

/// A message whose bytes are not what its schema says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Undecodable;

impl From<prost::DecodeError> for Undecodable {
    fn from(_: prost::DecodeError) -> Self {
        Self
    }
}

impl From<serde_json::Error> for Undecodable {
    fn from(_: serde_json::Error) -> Self {
        Self
    }
}

/// The wanted fields of a message, as a tree of the keys that lead to them.
#[derive(Debug)]
pub struct FieldTree<Key, Leaf> {
    pub branches: Vec<(Key, Node<Key, Leaf>)>,
}

#[derive(Debug)]
pub enum Node<Key, Leaf> {
    /// A wanted field.
    Leaf(Leaf),
    /// A message that holds wanted fields.
    Message(FieldTree<Key, Leaf>),
}

impl<Key: PartialEq, Leaf> FieldTree<Key, Leaf> {
    pub fn new() -> Self {
        Self {
            branches: Vec::new(),
        }
    }

    /// What a key leads to, if that is wanted.
    pub fn get<Q: PartialEq + ?Sized>(&self, key: &Q) -> Option<&Node<Key, Leaf>>
    where
        Key: std::borrow::Borrow<Q>,
    {
        self.branches
            .iter()
            .find_map(|(other, node)| (other.borrow() == key).then_some(node))
    }

    /// Adds a field at the end of a path of keys. A path that is there already, or that leads through a
    /// field, changes nothing: paths that were resolved against a schema are neither.
    pub fn insert(&mut self, path: &[Key], leaf: Leaf)
    where
        Key: Clone,
    {
        let Some((key, rest)) = path.split_first() else {
            return;
        };
        let known = self.branches.iter().position(|(other, _)| other == key);
        let index = known.unwrap_or_else(|| {
            let node = Node::Message(Self::new());
            self.branches.push((key.clone(), node));
            self.branches.len() - 1
        });
        match &mut self.branches[index].1 {
            node if rest.is_empty() && known.is_none() => *node = Node::Leaf(leaf),
            Node::Message(tree) => tree.insert(rest, leaf),
            Node::Leaf(_) => {}
        }
    }
}
