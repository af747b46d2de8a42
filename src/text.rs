//! Text that flightcam did not write, such as names from a log, as people get to read it: with all characters escaped
//! that would not be shown as themselves but steer a terminal, break a line or turn the direction of writing.

use std::{
    fmt::{self, Display, Formatter, Write},
    ops::Deref,
    path::Path,
};

use serde::Serialize;

/// Text from a log, a profile or the command line. Displayed it is in one line, with control and format characters
/// escaped as in Rust: `\n`, `\u{1b}`. Serialised and as a `str` it is as it was found.
// Without `Borrow<str>`, with which `join` would put unescaped texts together.
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(transparent)]
pub struct Foreign(String);

impl Foreign {
    /// The text as it was found.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl From<String> for Foreign {
    fn from(text: String) -> Self {
        Self(text)
    }
}

impl From<&String> for Foreign {
    fn from(text: &String) -> Self {
        Self(text.clone())
    }
}

impl From<&str> for Foreign {
    fn from(text: &str) -> Self {
        Self(text.to_owned())
    }
}

impl Deref for Foreign {
    type Target = str;

    fn deref(&self) -> &str {
        &self.0
    }
}

impl PartialEq<str> for Foreign {
    fn eq(&self, other: &str) -> bool {
        self.0 == other
    }
}

impl PartialEq<&str> for Foreign {
    fn eq(&self, other: &&str) -> bool {
        self.0 == *other
    }
}

impl PartialEq<String> for Foreign {
    fn eq(&self, other: &String) -> bool {
        self.0 == *other
    }
}

impl Display for Foreign {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        escaped(&self.0).fmt(f)
    }
}

/// What is displayed in one line, escaped as [`Foreign`] is.
pub fn escaped(text: impl Display) -> impl Display {
    Escaped {
        text,
        keeps_lines: false,
    }
}

/// What is displayed in several lines, which it keeps, and apart from that escaped as [`Foreign`] is.
pub fn escaped_lines(text: impl Display) -> impl Display {
    Escaped {
        text,
        keeps_lines: true,
    }
}

/// A path, escaped as [`Foreign`] is: a stranger may have named the file.
pub fn path(path: &Path) -> impl Display {
    #[expect(clippy::disallowed_methods, reason = "it is escaped here")]
    escaped(path.display())
}

/// Things as they are displayed, with something between each and the next.
pub fn join<T: Display>(things: impl IntoIterator<Item = T>, between: &str) -> String {
    let mut text = String::new();
    for (place, thing) in things.into_iter().enumerate() {
        let between = if place == 0 { "" } else { between };
        let _ = write!(text, "{between}{thing}");
    }
    text
}

/// Something as JSON that people may read, too: characters that JSON allows in texts and a terminal obeys are escaped as
/// JSON does.
pub fn to_json(value: &impl Serialize) -> String {
    let json = serde_json::to_string_pretty(value).expect("all keys are texts");
    let mut text = String::with_capacity(json.len());
    for c in json.chars() {
        match c {
            '\n' => text.push(c),
            c if is_escaped(c) => {
                for unit in c.encode_utf16(&mut [0; 2]) {
                    let _ = write!(text, "\\u{unit:04x}");
                }
            }
            c => text.push(c),
        }
    }
    text
}

/// Whether a character is escaped where people read it.
pub fn is_escaped(c: char) -> bool {
    c.is_control()
        || FORMAT
            .iter()
            .any(|&(first, last)| (first..=last).contains(&c))
}

/// The separators of lines and paragraphs, and the characters of the general category Cf, among them those that
/// change the direction of writing, from
/// <https://www.unicode.org/Public/17.0.0/ucd/extracted/DerivedGeneralCategory.txt>.
const FORMAT: [(char, char); 21] = [
    ('\u{ad}', '\u{ad}'),
    ('\u{600}', '\u{605}'),
    ('\u{61c}', '\u{61c}'),
    ('\u{6dd}', '\u{6dd}'),
    ('\u{70f}', '\u{70f}'),
    ('\u{890}', '\u{891}'),
    ('\u{8e2}', '\u{8e2}'),
    ('\u{180e}', '\u{180e}'),
    ('\u{200b}', '\u{200f}'),
    ('\u{2028}', '\u{202e}'),
    ('\u{2060}', '\u{2064}'),
    ('\u{2066}', '\u{206f}'),
    ('\u{feff}', '\u{feff}'),
    ('\u{fff9}', '\u{fffb}'),
    ('\u{110bd}', '\u{110bd}'),
    ('\u{110cd}', '\u{110cd}'),
    ('\u{13430}', '\u{1343f}'),
    ('\u{1bca0}', '\u{1bca3}'),
    ('\u{1d173}', '\u{1d17a}'),
    ('\u{e0001}', '\u{e0001}'),
    ('\u{e0020}', '\u{e007f}'),
];

struct Escaped<T> {
    text: T,
    keeps_lines: bool,
}

impl<T: Display> Display for Escaped<T> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let keeps_lines = self.keeps_lines;
        write!(Escaper { to: f, keeps_lines }, "{}", self.text)
    }
}

/// Escapes what is written to it.
struct Escaper<'a, 'f> {
    to: &'a mut Formatter<'f>,
    keeps_lines: bool,
}

impl Write for Escaper<'_, '_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        text.chars().try_for_each(|c| match c {
            '\n' if self.keeps_lines => self.to.write_char(c),
            c if is_escaped(c) => write!(self.to, "{}", c.escape_debug()),
            c => self.to.write_char(c),
        })
    }
}
