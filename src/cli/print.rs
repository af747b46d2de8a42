//! All that the program prints. Control and format characters are escaped here, whoever put them into a text, so that
//! no log, file name or argument can steer the terminal. A log's names do not break lines either, because
//! [`flightcam::Foreign`] displays them in one line.

use std::{
    env,
    fmt::{Display, Write as _},
    io::{self, Write},
    process,
};

use clap::error::{ContextKind, ContextValue};
pub use flightcam::text::to_json;
use flightcam::text::{escaped, escaped_lines, is_escaped};

/// A report in the making.
pub struct Page {
    text: String,
    /// How wide labels are.
    width: usize,
}

impl Default for Page {
    fn default() -> Self {
        Self::with_labels(12)
    }
}

impl Page {
    /// A page whose labels are so wide.
    pub fn with_labels(width: usize) -> Self {
        let text = String::new();
        Self { text, width }
    }

    /// Adds a line with a label, which may be empty.
    pub fn line(&mut self, label: &str, content: impl Display) {
        let _ = writeln!(
            self.text,
            "{label:<width$}{}",
            escaped(content),
            width = self.width
        );
    }

    /// Adds lines below an empty one.
    pub fn paragraph(&mut self, lines: &str) {
        let _ = writeln!(self.text, "\n{}", lines.trim_end());
    }

    /// All of it.
    pub fn text(&self) -> &str {
        self.text.trim_end()
    }
}

/// Writes a result to standard output. A reader that stops reading early is no error; any other trouble is
/// worth a warning, but what was done is done.
pub fn print_result(text: &str) {
    #[expect(clippy::disallowed_methods, reason = "it is escaped here")]
    let mut out = io::stdout().lock();
    match writeln!(out, "{}", escaped_lines(text)).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            complain("warning", &format!("cannot write the report: {error}"));
        }
        _ => {}
    }
}

/// Writes a result to standard error, where standard output has something else.
pub fn print_aside(text: &str) {
    // Not worth failing for.
    #[expect(clippy::disallowed_methods, reason = "it is escaped here")]
    let _ = writeln!(io::stderr(), "{}", escaped_lines(text));
}

/// Says on standard error that something is not as it should be.
pub fn complain(what: &str, message: &str) {
    print_aside(&format!("{what}: {message}"));
}

/// Ends the process over arguments, or where they ask for help, with what clap says to them.
pub fn exit_with(mut error: clap::Error) -> ! {
    let mut arguments = env::args_os();
    if !arguments.any(|argument| argument.to_string_lossy().contains(is_escaped)) {
        error.exit();
    }
    // What clap quotes cannot be told from its own styles and lines once they are together.
    let quotations: Vec<(ContextKind, ContextValue)> = (error.context())
        .filter_map(|(kind, value)| Some((kind, quotation(value)?)))
        .collect();
    for (kind, value) in quotations {
        error.insert(kind, value);
    }
    error.remove(ContextKind::Suggested);
    let text = error.render().to_string();
    match error.use_stderr() {
        true => print_aside(text.trim_end()),
        false => print_result(text.trim_end()),
    }
    process::exit(error.exit_code())
}

fn quotation(value: &ContextValue) -> Option<ContextValue> {
    let escape = |text: &String| escaped(text).to_string();
    match value {
        ContextValue::String(text) => Some(ContextValue::String(escape(text))),
        ContextValue::Strings(texts) => {
            Some(ContextValue::Strings(texts.iter().map(escape).collect()))
        }
        _ => None,
    }
}
