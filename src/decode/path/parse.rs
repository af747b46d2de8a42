//! Texts → paths and filters.

use super::{Comparison, FieldPath, Filter, Literal, MessagePath, PathStep};
use crate::decode::value::{FieldValue, Number};

/// Characters that no name has outside of quotes.
const NOT_IN_NAMES: [char; 11] = ['.', '[', ']', '{', '}', '/', '"', '@', '=', '!', ' '];

/// Reads a text from front to back. Each method reads something and returns `None` if something else is there.
pub struct Parser<'a> {
    rest: &'a str,
}

impl<'a> Parser<'a> {
    /// Reads a text that is this as a whole.
    pub fn read<T>(text: &'a str, read: impl FnOnce(&mut Self) -> Option<T>) -> Option<T> {
        let mut parser = Self { rest: text };
        read(&mut parser).filter(|_| parser.rest.is_empty())
    }

    pub fn message_path(&mut self) -> Option<MessagePath> {
        let quoted = self.rest.starts_with('"');
        let topic = match quoted {
            true => self.quoted('"')?,
            false => self.take_until(|c| matches!(c, '.' | '[' | '{')).to_owned(),
        };
        let filters = self.filters()?;
        let field = match self.skip(".") {
            true => Some(self.field_path()?),
            false => None,
        };
        (!topic.is_empty()).then_some(MessagePath {
            topic,
            // Filters show where the topic ends, too.
            quoted: quoted || !filters.is_empty(),
            filters,
            field,
        })
    }

    pub fn field_path(&mut self) -> Option<FieldPath> {
        let mut steps = vec![PathStep::Name(self.name()?)];
        loop {
            steps.push(if self.skip(".") {
                PathStep::Name(self.name()?)
            } else if self.skip("[:]") {
                PathStep::First(self.filters().filter(|filters| !filters.is_empty())?)
            } else if self.skip("[") {
                let index = self.take_until(|c| !c.is_ascii_digit()).parse().ok()?;
                self.skip("]").then_some(PathStep::Index(index))?
            } else {
                return FieldPath::of_steps(steps);
            });
        }
    }

    /// Reads what is between the braces of a filter.
    pub fn filter(&mut self) -> Option<Filter> {
        self.skip_spaces();
        let field = self.field_path()?;
        self.skip_spaces();
        let comparison = if self.skip("==") {
            Comparison::Equal
        } else if self.skip("!=") {
            Comparison::Unequal
        } else {
            return None;
        };
        self.skip_spaces();
        let value = self.literal()?;
        self.skip_spaces();
        Some(Filter {
            field,
            comparison,
            value,
        })
    }

    fn filters(&mut self) -> Option<Vec<Filter>> {
        let mut filters = Vec::new();
        while self.skip("{") {
            filters.push(self.filter()?);
            self.skip("}").then_some(())?;
        }
        Some(filters)
    }

    fn literal(&mut self) -> Option<Literal> {
        for quote in ['"', '\''] {
            if self.rest.starts_with(quote) {
                let text = self.quoted(quote)?;
                return (text.len() <= FieldValue::LONGEST_TEXT).then_some(Literal::Text(text));
            }
        }
        match self.take_until(|c| matches!(c, '}' | ' ')) {
            "true" => Some(Literal::Truth(true)),
            "false" => Some(Literal::Truth(false)),
            number => Some(Literal::Number(Number::finite_in(number)?)),
        }
    }

    fn name(&mut self) -> Option<String> {
        if self.rest.starts_with('"') {
            return self.quoted('"');
        }
        let name = self.take_until(|c| NOT_IN_NAMES.contains(&c));
        (!name.is_empty()).then(|| name.to_owned())
    }

    /// Reads a text in quotes.
    fn quoted(&mut self, quote: char) -> Option<String> {
        let mut text = String::new();
        let mut characters = self.rest.strip_prefix(quote)?.chars();
        loop {
            match characters.next()? {
                c if c == quote => break,
                '\\' => {
                    let after = characters.as_str();
                    match after.starts_with(['\\', quote]) {
                        true => text.extend(characters.next()),
                        false => text.push('\\'),
                    }
                }
                c => text.push(c),
            }
        }
        self.rest = characters.as_str();
        Some(text)
    }

    fn take_until(&mut self, is_end: impl Fn(char) -> bool) -> &'a str {
        let end = self.rest.find(is_end).unwrap_or(self.rest.len());
        let (taken, rest) = self.rest.split_at(end);
        self.rest = rest;
        taken
    }

    fn skip(&mut self, text: &str) -> bool {
        let rest = self.rest.strip_prefix(text);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    fn skip_spaces(&mut self) {
        self.rest = self.rest.trim_start_matches(' ');
    }
}

/// Splits a text at a separator, but not within quotes, brackets or braces, where it is a part of a path.
pub(crate) fn split(text: &str, separator: char) -> Vec<&str> {
    let mut parts = Vec::new();
    let mut start = 0;
    let mut quote = None;
    let mut depth = 0_u32;
    let mut characters = text.char_indices();
    while let Some((at, c)) = characters.next() {
        match (quote, c) {
            (Some(_), '\\') => drop(characters.next()),
            (Some(open), c) if c == open => quote = None,
            (Some(_), _) => {}
            (None, '"') => quote = Some(c),
            (None, '\'') if depth > 0 => quote = Some(c),
            (None, '{' | '[') => depth += 1,
            (None, '}' | ']') => depth = depth.saturating_sub(1),
            (None, c) if c == separator && depth == 0 => {
                parts.push(&text[start..at]);
                start = at + c.len_utf8();
            }
            (None, _) => {}
        }
    }
    parts.push(&text[start..]);
    parts
}
