//! A folder in which the program is run as a user would, and what must hold of every run.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
    time::SystemTime,
};

use assert_cmd::cargo::cargo_bin;
use serde_json::Value;
use tempfile::TempDir;

/// The log in most tests, and where its result goes by default.
pub const LOG: &str = "flight.mcap";
pub const RESULT: &str = "flight.enriched.mcap";

/// Where the program looks for its configuration.
pub const CONFIGURATION: &str = "configuration";

/// A folder in which the program is run, and which shows what it left there.
pub struct Folder(TempDir);

/// A file's time of modification, length and checksum; nothing for a folder.
type Fingerprint = Option<(SystemTime, u64, u32)>;

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn with(name: &str, content: impl AsRef<[u8]>) -> Self {
        let folder = Self::new();
        folder.add(name, content);
        folder
    }

    /// With the demonstration flight as [`LOG`].
    pub fn with_flight() -> Self {
        Self::with(
            LOG,
            fs::read(super::repository("fixtures/survey_flight.mcap")).unwrap(),
        )
    }

    /// With a copy of all files in another folder.
    pub fn copy_of(other: &Path) -> Self {
        let folder = Self::new();
        for entry in fs::read_dir(other).unwrap().flatten() {
            fs::copy(entry.path(), folder.0.path().join(entry.file_name())).unwrap();
        }
        folder
    }

    pub fn add(&self, name: &str, content: impl AsRef<[u8]>) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, content).unwrap();
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }

    /// The content of the one file that is there.
    #[track_caller]
    pub fn read_only_one(&self, name: &str) -> Vec<u8> {
        let found: Vec<PathBuf> = self.contents().into_keys().collect();
        assert_eq!(found, [self.path(name)], "nothing else is in the folder");
        self.read(name)
    }

    /// Everything in the folder and below, hidden files too.
    pub fn contents(&self) -> BTreeMap<PathBuf, Fingerprint> {
        let mut contents = BTreeMap::new();
        let mut folders = vec![self.0.path().to_owned()];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                let metadata = fs::metadata(&path).unwrap();
                if metadata.is_dir() {
                    folders.push(path.clone());
                    contents.insert(path, None);
                } else {
                    let checksum = crc32fast::hash(&fs::read(&path).unwrap());
                    let modified = metadata.modified().unwrap();
                    contents.insert(path, Some((modified, metadata.len(), checksum)));
                }
            }
        }
        contents
    }

    /// Everything in the folder and below by its checksum, whenever it was written.
    pub fn checksums(&self) -> BTreeMap<PathBuf, Option<u32>> {
        let checksum = |(path, print): (_, Fingerprint)| (path, print.map(|(_, _, crc)| crc));
        self.contents().into_iter().map(checksum).collect()
    }

    /// Runs the program with arguments separated by spaces, and expects an exit code. Returns standard output and
    /// standard error.
    #[track_caller]
    pub fn run(&self, arguments: &str, code: i32) -> (String, String) {
        let mut command = Command::new(cargo_bin!("flightcam"));
        command.args(arguments.split_whitespace());
        let output = self.output(command);
        let (out, err) = (text(output.stdout), text(output.stderr));
        assert_eq!(output.status.code(), Some(code), "{arguments}\n{out}{err}");
        (out, err)
    }

    /// Runs the program with arguments of any text. Returns the exit code, standard output and standard error.
    pub fn run_with(&self, arguments: &[&str]) -> (i32, String, String) {
        let mut command = Command::new(cargo_bin!("flightcam"));
        command.args(arguments);
        let output = self.output(command);
        let code = output.status.code().expect("it ends by itself");
        (code, text(output.stdout), text(output.stderr))
    }

    /// Runs the program where no file may become longer than that many blocks of 512 bytes. Returns the exit code,
    /// standard output and standard error.
    #[cfg(unix)]
    pub fn run_limited(&self, blocks: usize, arguments: &str) -> (i32, String, String) {
        let mut command = Command::new("sh");
        let script = format!("ulimit -f {blocks} && exec \"$0\" {arguments}");
        command.arg("-c").arg(script).arg(cargo_bin!("flightcam"));
        let output = self.output(command);
        let code = output.status.code().expect("it ends by itself");
        (code, text(output.stdout), text(output.stderr))
    }

    /// Runs the program with that many KiB of address space and an input. Returns the exit code, standard output and
    /// standard error.
    #[cfg(unix)]
    #[track_caller]
    pub fn run_within(&self, memory: u64, arguments: &str, input: &str) -> (i32, Vec<u8>, String) {
        let mut command = Command::new("sh");
        let script = format!("ulimit -v {memory} && exec \"$0\" {arguments} < {input}");
        command.arg("-c").arg(script).arg(cargo_bin!("flightcam"));
        let output = self.output(command);
        let err = text(output.stderr);
        let code = output.status.code();
        let code = code.unwrap_or_else(|| panic!("{arguments}: {}: {err}", output.status));
        (code, output.stdout, err)
    }

    fn output(&self, mut command: Command) -> Output {
        command.current_dir(&self.0).env_remove("CLICOLOR_FORCE");
        // Profiles of whoever runs the tests do not count.
        command.env("XDG_CONFIG_HOME", self.path(CONFIGURATION));
        command.output().unwrap()
    }

    /// Runs the program, which must refuse: with this exit code and this message on standard error, nothing on
    /// standard output, and the folder as it was to the last byte.
    #[track_caller]
    pub fn refuses(&self, arguments: &str, code: i32, message: &str) {
        let before = self.contents();
        let (out, err) = self.run(arguments, code);
        assert!(err.starts_with("error: "), "{err}");
        assert_reads(&err, message);
        assert_eq!(out, "", "standard output of `{arguments}`");
        assert_eq!(self.contents(), before, "the folder after `{arguments}`");
    }

    /// Runs the program, which must write a result: with this exit code, nothing on standard error, nothing on
    /// standard output that is meant for a terminal, and all other files as they were. Returns what it printed.
    #[track_caller]
    pub fn writes(&self, result: &str, arguments: &str, code: i32) -> String {
        let mut before = self.contents();
        let (out, err) = self.run(arguments, code);
        // Where the report is not for people, warnings go to standard error.
        let warns = code == 3 && (arguments.contains("--json") || arguments.contains("--quiet"));
        assert_eq!(
            !err.is_empty(),
            warns,
            "standard error of `{arguments}`: {err}"
        );
        assert!(
            err.lines()
                .all(|line| line.starts_with("warning: flight.mcap: "))
        );
        assert!(!out.contains(['\x1b', '\r']), "{out:?}");

        let mut after = self.contents();
        let old = before.remove(&self.path(result)).flatten();
        let new = after.remove(&self.path(result)).flatten();
        assert!(new.is_some() && new != old, "`{arguments}`: no {result}");
        assert_eq!(after, before, "the folder after `{arguments}`");
        out
    }

    /// As [`writes`](Self::writes) to [`RESULT`], with the report in JSON.
    #[track_caller]
    pub fn reports(&self, arguments: &str, code: i32) -> Value {
        let json = self.writes(RESULT, &format!("{arguments} --json"), code);
        serde_json::from_str(&json).expect("standard output is one JSON document")
    }
}

fn text(output: Vec<u8>) -> String {
    String::from_utf8(output).unwrap()
}

/// Checks that a text has all parts of an abridged one, in which `…` stands for anything.
#[track_caller]
pub fn assert_reads(text: &str, abridged: &str) {
    let mut rest = text;
    for part in abridged.split('…').map(str::trim) {
        let Some((_, after)) = rest.split_once(part) else {
            panic!("`{part}` of `{abridged}` is not where it should be in:\n{text}");
        };
        rest = after;
    }
}
