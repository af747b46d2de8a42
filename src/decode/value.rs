//! The values of the wanted fields of one message.

use super::{field::Shape, trial::Trial};

/// A number of a message, at full precision.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Number {
    Real(f64),
    Signed(i64),
    Unsigned(u64),
}

impl Number {
    /// The number, rounded to double precision.
    pub fn to_f64(self) -> f64 {
        match self {
            Self::Real(number) => number,
            Self::Signed(number) => number as f64,
            Self::Unsigned(number) => number as f64,
        }
    }

    /// Whether it equals this integer.
    pub fn is(self, integer: i64) -> bool {
        match self {
            Self::Real(number) => number == integer as f64,
            Self::Signed(number) => number == integer,
            Self::Unsigned(number) => i64::try_from(number) == Ok(integer),
        }
    }

    /// Whether it is of an integer type or, in text, has neither a decimal point nor an exponent.
    pub fn is_integer(self) -> bool {
        self.integer().is_some()
    }

    /// Whether it equals another number: exactly, if both are integers.
    pub fn equals(self, other: Self) -> bool {
        match (self.integer(), other.integer()) {
            (Some(this), Some(other)) => this == other,
            _ => self.to_f64() == other.to_f64(),
        }
    }

    fn integer(self) -> Option<i128> {
        match self {
            Self::Real(_) => None,
            Self::Signed(number) => Some(number.into()),
            Self::Unsigned(number) => Some(number.into()),
        }
    }

    /// Parses a number, of which an integer may have 64 bits.
    pub fn in_text(text: &str) -> Option<Self> {
        let integer =
            (text.parse().map(Self::Signed)).or_else(|_| text.parse().map(Self::Unsigned));
        integer
            .or_else(|_| text.trim().parse().map(Self::Real))
            .ok()
    }

    /// Like [`in_text`](Self::in_text), for a finite number.
    pub fn finite_in(text: &str) -> Option<Self> {
        Self::in_text(text).filter(|number| number.to_f64().is_finite())
    }

    /// The bits of an integer, two's complement if negative.
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

/// What a field held in one message: a number, a list of them, text, or nothing.
///
/// Only the first [`CAPACITY`](Self::CAPACITY) numbers of a list are kept, and a text of up to
/// [`LONGEST_TEXT`](Self::LONGEST_TEXT) bytes.
#[derive(Debug, Clone, Default)]
pub struct FieldValue {
    content: Content,
    /// How many numbers there are.
    count: usize,
    numbers: [Number; Self::CAPACITY],
    /// The text. It keeps its memory from message to message.
    text: Vec<u8>,
}

/// Which part of a [`FieldValue`] counts.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Content {
    #[default]
    Nothing,
    Numbers,
    Text,
    /// A text that was too long to be kept.
    LongText,
}

impl FieldValue {
    /// No list of interest is longer.
    pub const CAPACITY: usize = 4;

    /// No text that is compared with another is longer, in bytes.
    pub const LONGEST_TEXT: usize = 256;

    /// Makes an empty value that needs no more memory for one of this shape.
    fn with_room_for(shape: Shape) -> Self {
        let text = match shape {
            Shape::Text => Vec::with_capacity(Self::LONGEST_TEXT),
            Shape::Number | Shape::List => Vec::new(),
        };
        Self {
            text,
            ..Self::default()
        }
    }

    pub fn set(&mut self, number: impl Into<Number>) {
        self.set_empty_list();
        self.push(number);
    }

    pub fn set_empty_list(&mut self) {
        self.content = Content::Numbers;
        self.count = 0;
    }

    pub fn push(&mut self, number: impl Into<Number>) {
        if let Some(slot) = self.numbers.get_mut(self.count) {
            *slot = number.into();
        }
        self.count += 1;
    }

    pub fn set_text(&mut self, text: &[u8]) {
        self.content = match text.len() {
            0..=Self::LONGEST_TEXT => Content::Text,
            _ => Content::LongText,
        };
        if self.content == Content::Text {
            self.text.clear();
            self.text.extend_from_slice(text);
        }
    }

    /// Becomes the same as another value, with the memory that it has.
    pub fn copy_from(&mut self, other: &Self) {
        self.content = other.content;
        self.count = other.count;
        self.numbers = other.numbers;
        self.text.clear();
        self.text.extend_from_slice(&other.text);
    }

    pub fn clear(&mut self) {
        self.content = Content::Nothing;
    }

    pub fn is_present(&self) -> bool {
        self.content != Content::Nothing
    }

    /// The number at full precision; `None` if the field is missing, is text, or is a list whose length is not one.
    pub fn exact(&self) -> Option<Number> {
        (self.content == Content::Numbers && self.count == 1).then_some(self.numbers[0])
    }

    /// The number; `None` if the field is missing, is text, or is a list whose length is not one.
    pub fn number(&self) -> Option<f64> {
        self.exact().map(Number::to_f64)
    }

    /// The text, which need not be UTF-8; `None` if the field is missing, is a number or a list, or is longer than
    /// [`LONGEST_TEXT`](Self::LONGEST_TEXT).
    pub fn text(&self) -> Option<&[u8]> {
        (self.content == Content::Text).then_some(&self.text)
    }

    /// How many numbers the list has.
    pub fn len(&self) -> usize {
        self.count
    }

    /// The numbers of a list that were kept.
    pub fn numbers(&self) -> impl Iterator<Item = f64> {
        let kept = self.count.min(Self::CAPACITY);
        self.numbers[..kept].iter().map(|number| number.to_f64())
    }
}

/// What one message held: a value for each wanted field, and what the decoder counts while it reads.
#[derive(Debug, Clone, Default)]
pub struct Slots {
    /// The values: first of the wanted fields, in their order, then of those that decide which element of a list is
    /// read, and of that.
    pub values: Vec<FieldValue>,
    /// How many elements were seen of each list that a path leads into, or found of those that satisfy filters.
    pub seen: Vec<usize>,
    /// What is noted of the filters by which elements are chosen.
    pub trials: Vec<Trial>,
    /// The slots of wanted fields that are those of such an element, and what counts it in [`seen`](Self::seen).
    pub picked: Vec<(usize, usize)>,
    /// The latest JSON message with a bare `NaN` or the like, with quotes around these. Empty if there was none.
    pub quoted: Vec<u8>,
}

impl Slots {
    /// Makes room for the value of another field. Returns its slot.
    pub fn add_value(&mut self, shape: Shape) -> usize {
        self.values.push(FieldValue::with_room_for(shape));
        self.values.len() - 1
    }

    /// Makes room for another count. Returns its place.
    pub fn add_count(&mut self) -> usize {
        self.seen.push(0);
        self.seen.len() - 1
    }

    /// Clears the slots for the next message.
    pub fn clear(&mut self) {
        self.values.iter_mut().for_each(FieldValue::clear);
        // An empty `Vec`'s pointer dangles, and on some processors a zero-length fill there takes longer than reading a
        // message.
        if !self.seen.is_empty() {
            self.seen.fill(0);
        }
    }
}

/// Why the fields of a message cannot be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Undecodable {
    /// Its bytes are not what its schema says.
    Malformed,
    /// It is encoded in a version of CDR that is not supported.
    Xcdr2,
    /// It is encoded as a CDR parameter list, which is not supported.
    ParameterList,
}
