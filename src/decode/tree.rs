//! The tree of wanted fields. A decoder walks it beside each message and skips what is not in it.

use std::vec;

use super::{
    error::SchemaError,
    field::{Shape, Wanted},
    resolve::{Key, Node, resolve},
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
        /// The list's index in [`Slots::seen`](super::value::Slots::seen).
        counter: usize,
        elements: Vec<(usize, Self)>,
    },
}

/// Resolves wanted fields against the schema of a message. `leaf` makes what reads a field of some shape into a slot,
/// the n-th field into slot n; it returns `None` if the field does not have that shape.
///
/// # Errors
/// A field is not in the schema, or not of the wanted shape; or one path leads to a value that another leads through.
pub fn tree<N: Node<Name: PartialEq> + Clone, Leaf>(
    message: &N,
    wanted: &[Wanted],
    leaf: impl Fn(&N, Shape, usize) -> Option<Leaf>,
) -> Result<Branches<N::Name, Leaf>, SchemaError> {
    let mut branches = Vec::new();
    let mut lists = 0;
    for (slot, &Wanted { ref path, shape }) in wanted.iter().enumerate() {
        let field = resolve(message.clone(), path)?;
        let leaf = leaf(&field.node, shape, slot).ok_or_else(|| SchemaError::WrongShape {
            path: path.clone(),
            wanted: shape.into(),
            kind: field.node.kind(),
        })?;
        let mut keys = field.keys.into_iter();
        let inserted = match keys.next() {
            Some(Key::Name(name)) => insert(&mut branches, name, keys, leaf, &mut lists),
            _ => Err(Overlap),
        };
        inserted.map_err(|Overlap| SchemaError::Overlap { path: path.clone() })?;
    }
    Ok(branches)
}

/// One path leads to a value that another leads through.
struct Overlap;

/// Adds the leaf at the end of a path to some branches. The path continues with `key`, which belongs to these branches,
/// and then `rest`. `lists` counts the lists in the tree.
fn insert<K: PartialEq, Name: PartialEq, Leaf>(
    branches: &mut Vec<(K, FieldTree<Name, Leaf>)>,
    key: K,
    mut rest: vec::IntoIter<Key<Name>>,
    leaf: Leaf,
    lists: &mut usize,
) -> Result<(), Overlap> {
    let known = branches.iter().position(|(other, _)| *other == key);
    let Some(next) = rest.next() else {
        branches.push((key, FieldTree::Leaf(leaf)));
        return known.map_or(Ok(()), |_| Err(Overlap));
    };
    let place = known.unwrap_or_else(|| {
        branches.push((key, FieldTree::beginning_with(&next, lists)));
        branches.len() - 1
    });
    match (&mut branches[place].1, next) {
        (FieldTree::Message(fields), Key::Name(name)) => insert(fields, name, rest, leaf, lists),
        (FieldTree::List { elements, .. }, Key::Index(index)) => {
            insert(elements, index, rest, leaf, lists)
        }
        _ => Err(Overlap),
    }
}

impl<Name, Leaf> FieldTree<Name, Leaf> {
    /// Makes the empty tree that such a key leads into.
    fn beginning_with(key: &Key<Name>, lists: &mut usize) -> Self {
        match key {
            Key::Name(_) => Self::Message(Vec::new()),
            Key::Index(_) => {
                *lists += 1;
                Self::List {
                    counter: *lists - 1,
                    elements: Vec::new(),
                }
            }
        }
    }
}
