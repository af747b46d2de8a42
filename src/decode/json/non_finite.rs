//! Bare `NaN` and `Infinity`, which JSON does not have, and which loggers write all the same.
//!
//! Python's `json.dumps` writes `NaN`, `Infinity` and `-Infinity`
//! (<https://docs.python.org/3/library/json.html#infinite-and-nan-number-values>), C's `printf` writes `nan` and `inf`.
//! They are put in quotes before the JSON is parsed: a number that is wanted may be written as a string, and those that
//! are not wanted are skipped like any other.

use std::ops::Range;

use serde_json::Value;

/// Parses JSON in which there may be such numbers, which become strings.
pub fn parse(json: &[u8]) -> Result<Value, serde_json::Error> {
    serde_json::from_slice(json).or_else(|error| {
        let mut quoted = Vec::new();
        match quote(json, &mut quoted) {
            true => serde_json::from_slice(&quoted),
            false => Err(error),
        }
    })
}

/// Whether there are such numbers outside of strings. If so, `quoted` becomes the same JSON with quotes around them;
/// otherwise it stays as it is.
pub fn quote(json: &[u8], quoted: &mut Vec<u8>) -> bool {
    let mut copied = 0;
    for number in places(json) {
        if copied == 0 {
            quoted.clear();
        }
        quoted.extend_from_slice(&json[copied..number.start]);
        quoted.push(b'"');
        quoted.extend_from_slice(&json[number.clone()]);
        quoted.push(b'"');
        copied = number.end;
    }
    if copied > 0 {
        quoted.extend_from_slice(&json[copied..]);
    }
    copied > 0
}

/// The same JSON with zeros for such numbers and everything else where it was.
pub fn blank(json: &[u8]) -> Vec<u8> {
    let mut blanked = json.to_vec();
    for number in places(json) {
        blanked[number.clone()].fill(b' ');
        blanked[number.start] = b'0';
    }
    blanked
}

/// Where such numbers are, outside of strings.
fn places(json: &[u8]) -> impl Iterator<Item = Range<usize>> {
    let mut at = 0;
    std::iter::from_fn(move || {
        while let Some(&byte) = json.get(at) {
            if byte == b'"' {
                at = end_of_string(json, at + 1);
                continue;
            }
            let start = at;
            let word = (json[at..].iter().take_while(|byte| is_of_word(**byte))).count();
            at += word.max(1);
            if is_non_finite(&json[start..start + word]) {
                return Some(start..at);
            }
        }
        None
    })
}

/// The place after a string, of which everything before `at` was read.
pub fn end_of_string(json: &[u8], mut at: usize) -> usize {
    loop {
        match json.get(at) {
            None => return json.len(),
            Some(b'"') => return at + 1,
            Some(b'\\') => at += 2,
            Some(_) => at += 1,
        }
    }
}

fn is_of_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || matches!(byte, b'+' | b'-' | b'.' | b'_')
}

fn is_non_finite(word: &[u8]) -> bool {
    let unsigned = match word {
        [b'+' | b'-', unsigned @ ..] => unsigned,
        unsigned => unsigned,
    };
    let names: [&[u8]; 3] = [b"nan", b"infinity", b"inf"];
    names.iter().any(|name| unsigned.eq_ignore_ascii_case(name))
}
