//! Characters that steer a terminal, break lines or turn the direction of writing.

/// Some of each sort, and what the tests put in the place of each for a harmless text of the same width.
const STEERING: [(char, char); 22] = [
    ('\u{1b}', 'α'),
    ('\u{7}', 'β'),
    ('\r', 'γ'),
    ('\n', 'δ'),
    ('\t', 'ε'),
    ('\u{7f}', 'ζ'),
    ('\u{85}', 'η'),
    ('\u{9b}', 'θ'),
    ('\u{2028}', 'ι'),
    ('\u{2029}', 'κ'),
    ('\u{202a}', 'λ'),
    ('\u{202e}', 'μ'),
    ('\u{2066}', 'ν'),
    ('\u{2069}', 'ξ'),
    ('\u{200e}', 'ο'),
    ('\u{200f}', 'π'),
    ('\u{61c}', 'ρ'),
    ('\u{200b}', 'σ'),
    ('\u{feff}', 'τ'),
    ('\u{ad}', 'υ'),
    ('\u{e0041}', 'φ'),
    ('\0', 'χ'),
];

/// What a stranger may name things, to have it printed.
pub const NASTY: &str =
    "/a\u{1b}[31m\u{7}\0\r\nAttitude    /fake\u{9b}\u{2028}\u{202e}\u{200b}\u{feff}\u{61c}";

/// [`NASTY`] as it is printed.
pub const PRINTED: &str =
    r"/a\u{1b}[31m\u{7}\0\r\nAttitude    /fake\u{9b}\u{2028}\u{202e}\u{200b}\u{feff}\u{61c}";

/// All characters of [`STEERING`] but the last, which names of files cannot have.
pub fn alphabet() -> Vec<char> {
    let all = STEERING.iter().map(|&(steering, _)| steering);
    all.take(STEERING.len() - 1).collect()
}

/// With a letter instead of each character that steers.
pub fn harmless(text: &str) -> String {
    let other = |c| STEERING.iter().find(|&&(steering, _)| steering == c);
    text.chars()
        .map(|c| other(c).map_or(c, |&(_, letter)| letter))
        .collect()
}

/// Whether a character may do more than show itself.
pub fn steers(c: char) -> bool {
    c.is_control()
        || STEERING.iter().any(|&(steering, _)| steering == c)
        || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{206f}' | '\u{200b}'..='\u{200f}')
}

/// Checks that nothing but the ends of lines steers a terminal.
#[track_caller]
pub fn assert_shown(text: &str) {
    let found = text.chars().find(|&c| c != '\n' && steers(c));
    assert_eq!(found, None, "in {text:?}");
}
