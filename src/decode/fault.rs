//! What is wrong with a message that cannot be decoded, for people.
//!
//! Decoders say only that a message cannot be read. Of the first such message of a channel they are asked what is wrong,
//! so that reading costs no more for it.

use std::fmt;

use super::path::FieldPath;
use crate::text::Foreign;

/// What is wrong with a message that cannot be decoded.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
// Each variant's message explains it and its fields.
#[allow(missing_docs)]
pub enum Fault {
    #[error(
        "its messages are compressed one by one (zstd), as rosbag2 does with `compression_mode: message`; flightcam \
         does not read that"
    )]
    Compressed,

    #[error(
        "it is not JSON{}: {problem} at byte {offset}, `{text}`",
        within(field)
    )]
    NotJson {
        /// The field whose value it is.
        field: Option<FieldPath>,
        problem: Foreign,
        offset: usize,
        /// What is there.
        text: Foreign,
    },

    #[error("it is not JSON{}: it ends after {length} bytes", within(field))]
    JsonEnds {
        /// The field whose value it is.
        field: Option<FieldPath>,
        length: usize,
    },

    #[error("its field `{field}` is `{value}`, not {wanted}")]
    Value {
        field: FieldPath,
        value: Foreign,
        wanted: Content,
    },

    #[error("it is `{value}`, not an object")]
    NotAnObject { value: Foreign },

    #[error("it ends after {length} bytes, before its field `{field}` does")]
    EndsEarly { field: FieldPath, length: usize },

    #[error("its field `{field}`, at byte {offset}, is not encoded as its type says")]
    OtherType { field: FieldPath, offset: usize },

    #[error("at byte {offset} of {length} there is no field")]
    NoField { offset: usize, length: usize },

    #[error("it begins with the bytes {:02x} {:02x}, which name no version of CDR", .0[0], .0[1])]
    Encapsulation([u8; 2]),

    #[error("it has {length} bytes, too few to name the version of CDR")]
    NoEncapsulation { length: usize },

    #[error("it is encoded as XCDR2, which flightcam does not read (it reads XCDR1)")]
    Xcdr2,

    #[error("it is encoded as a CDR parameter list (PL_CDR), which flightcam does not read")]
    ParameterList,
}

/// What a field of a JSON message should be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Content {
    Number,
    Text,
    Object,
    List,
}

impl Fault {
    /// What is wrong with the bytes of a message, whatever should be in them.
    pub(super) fn of_bytes(message: &[u8]) -> Option<Self> {
        /// A zstd frame begins with it (RFC 8878, section 3.1.1).
        const ZSTD: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];
        message.starts_with(&ZSTD).then_some(Self::Compressed)
    }
}

/// The beginning of a text from a message.
pub(super) fn beginning(text: &str) -> Foreign {
    const LONGEST: usize = 60;
    match text.char_indices().nth(LONGEST) {
        None => text.into(),
        Some((end, _)) => format!("{}…", &text[..end]).into(),
    }
}

fn within(field: &Option<FieldPath>) -> String {
    match field {
        Some(field) => format!(" in its field `{field}`"),
        None => String::new(),
    }
}

impl fmt::Display for Content {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Number => "a number",
            Self::Text => "text",
            Self::Object => "an object",
            Self::List => "a list",
        })
    }
}
