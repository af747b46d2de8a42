//! The documentation's pages, and what is in them: tables, fenced blocks, code.

use std::{collections::BTreeMap, fs};

use super::repository;

pub fn read(page: &str) -> String {
    let text = fs::read_to_string(repository(page));
    text.unwrap_or_else(|error| panic!("{page}: {error}"))
}

/// All pages, by their paths in the repository.
pub fn pages() -> BTreeMap<String, String> {
    let docs = fs::read_dir(repository("docs")).expect("the folder");
    let docs = docs.map(|entry| {
        let name = entry.expect("a page").file_name();
        format!("docs/{}", name.to_string_lossy())
    });
    let top = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(str::to_owned);
    docs.chain(top)
        .map(|page| (page.clone(), read(&page)))
        .collect()
}

/// The fenced blocks in a language.
pub fn blocks(text: &str, language: &str) -> Vec<String> {
    let fences = text.split("```").skip(1).step_by(2);
    fences
        .filter_map(|block| block.split_once('\n'))
        .filter(|(first, _)| *first == language)
        .map(|(_, content)| content.to_owned())
        .collect()
}

/// A row of a table.
#[derive(Debug)]
pub struct Row {
    pub heading: String,
    pub cells: Vec<String>,
}

/// The rows of all tables, without their headers.
pub fn rows(text: &str) -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::new();
    let mut heading = String::new();
    for line in text.lines() {
        if let Some(title) = line.strip_prefix('#') {
            heading = title.trim_matches(['#', ' ']).to_owned();
        } else if line.starts_with("| ---") {
            rows.pop();
        } else if line.starts_with('|') {
            let line = line.replace("\\|", "\0");
            let cells = line.trim_matches('|').split('|');
            rows.push(Row {
                heading: heading.clone(),
                cells: cells.map(|cell| cell.trim().replace('\0', "|")).collect(),
            });
        }
    }
    rows
}

/// What is in backticks.
pub fn codes(text: &str) -> Vec<&str> {
    text.split('`').skip(1).step_by(2).collect()
}

/// The anchor that a heading gets.
pub fn anchor(heading: &str) -> String {
    let kept = heading
        .trim_matches(['#', ' '])
        .chars()
        .filter_map(|character| match character {
            ' ' => Some('-'),
            '-' | '_' => Some(character),
            letter if letter.is_alphanumeric() => Some(letter.to_ascii_lowercase()),
            _ => None,
        });
    kept.collect()
}
