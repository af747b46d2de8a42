//! Fields of messages: what is wanted of them, what they held, and where a decoder looks for them.

use super::{
    error::SchemaError,
    path::{FieldPath, Step},
};

/// A field that a role is made of.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Wanted {
    pub path: FieldPath,
    pub shape: Shape,
}

/// What a field is wanted as.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Shape {
    /// One number. A truth value counts as 0 or 1.
    Number,
    /// A list of numbers.
    List,
    /// Text, as its place among these words; another word's place is behind the last.
    Word(Vec<String>),
}

impl Shape {
    /// As a complaint names it.
    pub fn describe(&self) -> &'static str {
        match self {
            Self::Number => "a number",
            Self::List => "a list of numbers",
            Self::Word(_) => "text",
        }
    }
}

/// What a schema says that a path leads to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FieldKind {
    /// A number or a truth value.
    Number,
    /// Text.
    Text,
    /// A list of numbers.
    List,
    /// A message with these fields.
    Message(Vec<String>),
    /// Something else, as a complaint names it.
    Other(&'static str),
    /// Whatever a message holds: the schema does not say.
    Unknown,
}

impl FieldKind {
    /// As a complaint names it.
    pub fn describe(&self) -> &'static str {
        match self {
            Self::Number => "a single number",
            Self::Text => "text",
            Self::List => "a list",
            Self::Message(_) => "a message",
            Self::Other(what) => what,
            Self::Unknown => "of no known kind",
        }
    }

    /// Whether a field of this kind can be read as what is wanted.
    pub fn is_a(&self, shape: &Shape) -> bool {
        matches!(
            (self, shape),
            (Self::Number, Shape::Number)
                | (Self::List, Shape::List)
                | (Self::Text, Shape::Word(_))
                | (Self::Unknown, _)
        )
    }
}

/// A number of a message, with all of its digits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Number {
    Real(f64),
    Signed(i64),
    Unsigned(u64),
}

impl Number {
    /// Rounded to double precision.
    pub fn to_f64(self) -> f64 {
        match self {
            Self::Real(number) => number,
            Self::Signed(number) => number as f64,
            Self::Unsigned(number) => number as f64,
        }
    }
}

impl Number {
    /// Whether it is this integer.
    pub fn is(self, integer: i64) -> bool {
        match self {
            Self::Real(number) => number == integer as f64,
            Self::Signed(number) => number == integer,
            Self::Unsigned(number) => i64::try_from(number) == Ok(integer),
        }
    }

    /// The bits of an integer, of a negative one in two's complement.
    pub fn bits(self) -> u64 {
        match self {
            Self::Real(number) => number as i64 as u64,
            Self::Signed(number) => number as u64,
            Self::Unsigned(number) => number,
        }
    }
}

impl Default for Number {
    fn default() -> Self {
        Self::Real(0.0)
    }
}

impl From<f64> for Number {
    fn from(number: f64) -> Self {
        Self::Real(number)
    }
}

impl From<i64> for Number {
    fn from(number: i64) -> Self {
        Self::Signed(number)
    }
}

impl From<u64> for Number {
    fn from(number: u64) -> Self {
        Self::Unsigned(number)
    }
}

impl From<bool> for Number {
    fn from(truth: bool) -> Self {
        Self::Unsigned(truth.into())
    }
}

/// What a field held in one message: a number, a list of them, or nothing.
///
/// Of a list the first [`CAPACITY`](Self::CAPACITY) numbers are kept.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FieldValue {
    present: bool,
    count: usize,
    numbers: [Number; Self::CAPACITY],
}

impl FieldValue {
    /// As many numbers as any field of interest has: a quaternion's.
    pub const CAPACITY: usize = 4;

    pub fn set(&mut self, number: impl Into<Number>) {
        self.set_empty_list();
        self.push(number);
    }

    pub fn set_empty_list(&mut self) {
        self.present = true;
        self.count = 0;
    }

    pub fn push(&mut self, number: impl Into<Number>) {
        if let Some(slot) = self.numbers.get_mut(self.count) {
            *slot = number.into();
        }
        self.count += 1;
    }

    /// Sets the place of a text among the wanted words.
    pub fn set_word(&mut self, words: &[String], text: &[u8]) {
        let place = words.iter().position(|word| word.as_bytes() == text);
        self.set(place.unwrap_or(words.len()) as u64);
    }

    pub fn clear(&mut self) {
        self.present = false;
    }

    pub fn is_present(&self) -> bool {
        self.present
    }

    /// The number with all of its digits; `None` where the field is missing or is a list of another length
    /// than one.
    pub fn exact(&self) -> Option<Number> {
        (self.present && self.count == 1).then_some(self.numbers[0])
    }

    /// The number; `None` where the field is missing or is a list of another length than one.
    pub fn number(&self) -> Option<f64> {
        self.exact().map(Number::to_f64)
    }

    /// How many numbers the list has.
    pub fn len(&self) -> usize {
        self.count
    }

    /// The numbers that were kept of a list.
    pub fn numbers(&self) -> impl Iterator<Item = f64> {
        let kept = self.count.min(Self::CAPACITY);
        self.numbers[..kept].iter().map(|number| number.to_f64())
    }
}

/// What one message held: a value for each wanted field, and what a decoder counts meanwhile.
#[derive(Debug, Clone, Default)]
pub struct Slots {
    /// In the order in which the fields were wanted.
    pub values: Vec<FieldValue>,
    /// How many elements were seen of each list that a path leads into; as many as paths have indexes, which
    /// is enough.
    pub seen: Vec<usize>,
}

impl Slots {
    /// For the values of these fields.
    pub fn new(wanted: &[Wanted]) -> Self {
        let steps = wanted.iter().flat_map(|field| field.path.steps());
        let lists = steps.filter(|step| matches!(step, Step::Index(_))).count();
        Self {
            values: vec![FieldValue::default(); wanted.len()],
            seen: vec![0; lists],
        }
    }

    /// Before the next message.
    pub fn clear(&mut self) {
        self.values.iter_mut().for_each(FieldValue::clear);
        // An empty list has no valid address, and filling nothing there takes some processors longer than
        // reading a message.
        if !self.seen.is_empty() {
            self.seen.fill(0);
        }
    }
}

/// Why the fields of a message cannot be had.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Undecodable {
    /// Its bytes are not what its schema says.
    Malformed,
    /// It is encoded in a version of CDR that is not supported.
    Xcdr2,
    /// It is encoded as a CDR parameter list, which is not supported.
    ParameterList,
}

impl From<prost::DecodeError> for Undecodable {
    fn from(_: prost::DecodeError) -> Self {
        Self::Malformed
    }
}

impl From<serde_json::Error> for Undecodable {
    fn from(_: serde_json::Error) -> Self {
        Self::Malformed
    }
}

/// The wanted fields of a message, by the names that lead to them.
pub type Branches<Name, Leaf> = Vec<(Name, FieldTree<Name, Leaf>)>;

/// The wanted fields under one step of a path.
#[derive(Debug)]
pub enum FieldTree<Name, Leaf> {
    /// A wanted field.
    Leaf(Leaf),
    /// A message that holds wanted fields.
    Message(Branches<Name, Leaf>),
    /// A list that holds wanted elements, and its place in [`Slots::seen`].
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

impl From<&Step> for Key<String> {
    fn from(step: &Step) -> Self {
        match step {
            Step::Name(name) => Self::Name(name.clone()),
            Step::Index(index) => Self::Index(*index),
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
