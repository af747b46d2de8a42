//! The wanted fields of a message type → a program that reads them from a message's bytes.

use super::{
    layout::{Extent, Length, Skip},
    message::{RosElement, RosField, RosType},
    wire::{Cursor, Dialect, RosScalar},
};
use crate::decode::{
    error::SchemaError,
    field::Shape,
    pick::Picks,
    tree::{FieldTree, First},
    value::{Slots, Undecodable},
};

/// Wanted fields by their indexes in messages, each with the operation that reads it.
type Fields = FieldTree<usize, Op>;

/// Operations, in the order in which they are done.
#[derive(Debug)]
pub struct Program(Vec<Op>);

#[derive(Debug)]
pub enum Op {
    Skip(Skip),
    Number {
        scalar: RosScalar,
        slot: usize,
    },
    Numbers {
        scalar: RosScalar,
        length: Length,
        slot: usize,
    },
    Text {
        slot: usize,
    },
    /// A list from which some elements are wanted.
    Elements {
        length: Length,
        element: Extent,
        /// Programs for the wanted elements, by index in ascending order.
        wanted: Vec<(usize, Program)>,
    },
    /// A list of which the first elements are wanted that satisfy filters.
    First {
        length: Length,
        element: Extent,
        /// Reads an element.
        program: Program,
        picks: Picks,
    },
}

impl Op {
    /// Makes the operation that reads a field into a slot; `None` if the field does not have this shape.
    pub fn read(field: &RosType, shape: Shape, slot: usize) -> Option<Self> {
        match (shape, &field.element, field.list) {
            (Shape::Number, &RosElement::Number(scalar), None) => {
                Some(Self::Number { scalar, slot })
            }
            (Shape::List, &RosElement::Number(scalar), Some(length)) => Some(Self::Numbers {
                scalar,
                length,
                slot,
            }),
            (Shape::Text, RosElement::Text, None) => Some(Self::Text { slot }),
            _ => None,
        }
    }

    #[inline]
    fn run(&self, cursor: &mut Cursor, slots: &mut Slots) -> Result<(), Undecodable> {
        match self {
            Self::Skip(skip) => cursor.skip(std::slice::from_ref(skip))?,
            Self::Number { scalar, slot } => slots.values[*slot].set(cursor.number(*scalar)?),
            Self::Numbers {
                scalar,
                length,
                slot,
            } => {
                slots.values[*slot].set_empty_list();
                for _ in 0..cursor.length(*length)? {
                    slots.values[*slot].push(cursor.number(*scalar)?);
                }
            }
            Self::Text { slot } => slots.values[*slot].set_text(cursor.text()?),
            Self::Elements {
                length,
                element,
                wanted,
            } => {
                let length = cursor.length(*length)?;
                let mut passed = 0;
                for (place, program) in wanted.iter().take_while(|(place, _)| *place < length) {
                    cursor.skip_elements(element, place - passed)?;
                    program.run(cursor, slots)?;
                    passed = place + 1;
                }
                cursor.skip_elements(element, length - passed)?;
            }
            Self::First {
                length,
                element,
                program,
                picks,
            } => {
                let mut left = cursor.length(*length)?;
                while left > 0 && !picks.are_found(slots) {
                    program.run(cursor, slots)?;
                    picks.take(slots);
                    left -= 1;
                }
                cursor.skip_elements(element, left)?;
            }
        }
        Ok(())
    }

    /// The first of the slots that it reads into.
    fn first_slot(&self) -> Option<usize> {
        match self {
            Self::Skip(_) => None,
            Self::Number { slot, .. } | Self::Numbers { slot, .. } | Self::Text { slot } => {
                Some(*slot)
            }
            Self::Elements { wanted, .. } => {
                let mut programs = wanted.iter();
                programs.find_map(|(_, program)| program.0.iter().find_map(Self::first_slot))
            }
            Self::First { picks, .. } => picks.first_slot(),
        }
    }
}

impl Program {
    /// Makes a program that reads these fields, all of which were resolved against the message type.
    pub fn new(message: &RosType, wanted: Fields, dialect: Dialect) -> Result<Self, SchemaError> {
        let mut compiler = Compiler::new(dialect);
        compiler.value(message, wanted)?;
        // Whatever is left to skip comes after the last of them.
        Ok(Self(compiler.ops))
    }

    pub fn run(&self, cursor: &mut Cursor, slots: &mut Slots) -> Result<(), Undecodable> {
        self.0.iter().try_for_each(|op| op.run(cursor, slots))
    }

    /// The slot of the first field that is not in a message as a whole.
    pub fn first_unreadable(&self, cursor: &mut Cursor, slots: &mut Slots) -> Option<usize> {
        let mut ops = self.0.iter();
        let failed = ops.position(|op| op.run(cursor, slots).is_err())?;
        self.0[failed..].iter().find_map(Op::first_slot)
    }
}

/// A program under construction.
struct Compiler {
    dialect: Dialect,
    ops: Vec<Op>,
    /// What lies between the last of these operations and the current field.
    to_pass: Vec<Skip>,
    /// A field in between that cannot be skipped.
    barrier: Option<String>,
}

impl Compiler {
    fn new(dialect: Dialect) -> Self {
        Self {
            dialect,
            ops: Vec::new(),
            to_pass: Vec::new(),
            barrier: None,
        }
    }

    fn value(&mut self, value: &RosType, wanted: Fields) -> Result<(), SchemaError> {
        match (wanted, value.list, &value.element) {
            (Fields::Leaf(op), ..) => {
                self.pass()?;
                self.ops.push(op);
            }
            (Fields::Message(mut wanted), None, RosElement::Message(message)) => {
                for (place, field) in message.fields.iter().enumerate() {
                    match wanted.iter().position(|(other, _)| *other == place) {
                        Some(found) => self.value(&field.value, wanted.swap_remove(found).1)?,
                        None => self.leave_out(field),
                    }
                }
            }
            (Fields::List { elements, .. }, Some(length), element) => {
                self.pass()?;
                let op = self.elements(length, element, elements)?;
                self.ops.push(op);
            }
            (Fields::First(first), Some(length), element) => {
                self.pass()?;
                let op = self.first(length, element, first)?;
                self.ops.push(op);
            }
            _ => unreachable!("each path was resolved against the type"),
        }
        Ok(())
    }

    fn elements(
        &self,
        length: Length,
        element: &RosElement,
        mut wanted: Vec<(usize, Fields)>,
    ) -> Result<Op, SchemaError> {
        wanted.sort_unstable_by_key(|(place, _)| *place);
        let program = |(place, wanted)| Ok((place, self.element(element, wanted)?));
        let wanted = wanted.into_iter().map(program);
        Ok(Op::Elements {
            length,
            element: self.extent(element),
            wanted: wanted.collect::<Result<_, SchemaError>>()?,
        })
    }

    fn first(
        &self,
        length: Length,
        element: &RosElement,
        first: First<usize, Op>,
    ) -> Result<Op, SchemaError> {
        Ok(Op::First {
            length,
            element: self.extent(element),
            program: self.element(element, Fields::Message(first.element))?,
            picks: first.picks,
        })
    }

    /// The program that reads an element of a list to its end, because the next one comes after it.
    fn element(&self, element: &RosElement, wanted: Fields) -> Result<Program, SchemaError> {
        let mut compiler = Self::new(self.dialect);
        compiler.value(&element.clone().into(), wanted)?;
        compiler.pass()?;
        Ok(Program(compiler.ops))
    }

    /// How to skip an element. There is no wide string in it: that would have been a barrier.
    fn extent(&self, element: &RosElement) -> Extent {
        element.extent(self.dialect).unwrap_or_default()
    }

    fn leave_out(&mut self, field: &RosField) {
        match field.value.skip(self.dialect) {
            Some(skip) => skip.append_to(&mut self.to_pass),
            None => {
                self.barrier.get_or_insert_with(|| field.name.clone());
            }
        }
    }

    /// Skips to the current field.
    fn pass(&mut self) -> Result<(), SchemaError> {
        match self.barrier.take() {
            Some(field) => Err(SchemaError::AfterWideText {
                field: field.into(),
            }),
            None => {
                self.ops.extend(self.to_pass.drain(..).map(Op::Skip));
                Ok(())
            }
        }
    }
}
