//! This build's program and another build's write the same bytes and end with the same exit codes.
//!
//! These tests are ignored unless asked for. They take minutes, fewer where `TMPDIR` is in memory:
//!
//! ```sh
//! FLIGHTCAM_OTHER_BUILD=/path/to/flightcam cargo test other_build -- --ignored --nocapture
//! ```

mod logs;

use std::{
    collections::BTreeMap,
    env, fmt, fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use assert_cmd::cargo::cargo_bin;

use self::logs::Input;
use crate::support::folder::*;

/// A run of the program.
#[derive(Debug, Clone, Copy)]
struct Run {
    /// With `{}` for what belongs to the log: which camera, and where its telemetry is.
    arguments: &'static str,
    /// The file that standard input comes from.
    stdin: Option<&'static str>,
    /// The file that standard output, where that is a log, goes to.
    stdout: Option<&'static str>,
}

impl Run {
    const fn of(arguments: &'static str) -> Self {
        Self {
            arguments,
            stdin: None,
            stdout: None,
        }
    }

    const fn reading(self, file: &'static str) -> Self {
        Self {
            stdin: Some(file),
            ..self
        }
    }

    const fn writing(self, file: &'static str) -> Self {
        Self {
            stdout: Some(file),
            ..self
        }
    }
}

/// Runs in the same folder, one after the other until one fails. At first only the log is there.
const SEQUENCES: &[&[Run]] = &[
    &[
        Run::of("enrich flight.mcap --depression 30 {}"),
        Run::of("enrich flight.enriched.mcap --depression 60 {} -o again.mcap"),
        Run::of(
            "enrich flight.enriched.mcap --depression 60 {} --layout interleaved -o apart.mcap",
        ),
        Run::of("restore flight.enriched.mcap -o original.mcap"),
        Run::of("enrich - --depression 60 {} -o -")
            .reading("flight.enriched.mcap")
            .writing("piped.mcap"),
        Run::of("restore flight.enriched.mcap"),
    ],
    &[
        Run::of("enrich flight.mcap --depression 30 {} --in-place"),
        Run::of("enrich flight.mcap --depression 60 {} --in-place"),
        Run::of("restore flight.mcap"),
    ],
    &[
        Run::of("enrich flight.mcap --depression 30 {} --layout interleaved -o apart.mcap"),
        Run::of("restore apart.mcap"),
    ],
    &[
        Run::of("enrich flight.mcap --depression 30 {} --layout interleaved -o -")
            .writing("apart.mcap"),
        Run::of("enrich apart.mcap --depression 30 {} -o again.mcap"),
    ],
    &[
        Run::of("enrich - --depression 30 {} -o -")
            .reading(LOG)
            .writing("piped.mcap"),
        Run::of("restore piped.mcap"),
    ],
    &[Run::of("enrich - --depression 30 {} -o from_pipe.mcap").reading(LOG)],
    &[Run::of("enrich flight.mcap --depression 30 {} -o -").writing("to_pipe.mcap")],
    &[Run::of(
        "enrich flight.mcap --depression 30 {} --encoding protobuf",
    )],
    &[Run::of(
        "enrich flight.mcap --depression 30 {} --encoding json",
    )],
    &[Run::of(
        "enrich flight.mcap --depression 30 {} --encoding ros2",
    )],
    &[Run::of("enrich flight.mcap --mount 5,-30,10 {}")],
    &[Run::of(
        "enrich flight.mcap --depression 30 --mount 0,0,90 {}",
    )],
    &[Run::of(
        "enrich flight.mcap --depression 30 --max-gap 0.025 {}",
    )],
    &[Run::of("enrich flight.mcap {}")],
    &[Run::of(
        "enrich flight.mcap --depression 30 --time publish {}",
    )],
];

/// The two programs that are compared.
struct Builds([PathBuf; 2]);

/// How much was compared.
#[derive(Debug, Default)]
struct Count {
    logs: usize,
    runs: usize,
    failures: usize,
    files: usize,
    bytes: usize,
}

impl fmt::Display for Count {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self {
            logs,
            runs,
            failures,
            files,
            bytes,
        } = self;
        write!(
            f,
            "{logs} logs, {runs} runs of each build, of which {failures} failed in both; {files} files of {bytes} \
             bytes are the same"
        )
    }
}

impl Builds {
    fn here_and_other() -> Self {
        let other = env::var_os("FLIGHTCAM_OTHER_BUILD")
            .expect("the other build's program is given in FLIGHTCAM_OTHER_BUILD");
        let other = fs::canonicalize(other).expect("the other build's program");
        Self([cargo_bin!("flightcam").to_owned(), other])
    }

    /// Compares all that both make of some logs.
    fn compare(&self, subject: &str, inputs: impl IntoIterator<Item = Input>) {
        let mut count = Count::default();
        let mut differences = Vec::new();
        for input in inputs {
            count.logs += 1;
            for sequence in SEQUENCES {
                let difference = self.run(&input, sequence, &mut count);
                differences.extend(difference.err());
            }
        }
        println!("{subject}: {count}");
        assert!(count.failures < count.runs, "no log could be enriched");
        assert!(
            differences.is_empty(),
            "{} differences, of which the first are:\n{}",
            differences.len(),
            differences[..differences.len().min(10)].join("\n")
        );
    }

    /// Runs both builds, each in a folder of its own, and compares the folders after each run.
    fn run(&self, input: &Input, sequence: &[Run], count: &mut Count) -> Result<(), String> {
        let folders = [input.folder(), input.folder()];
        for run in sequence {
            let arguments = run.arguments.replace("{}", &input.arguments);
            let [(code, err), (other_code, other_err)] = [0, 1].map(|which| {
                let folder = &folders[which];
                run_in(folder, &self.0[which], &arguments, run)
            });
            let about = format!("{}: {arguments}", input.name);
            if code != other_code {
                return Err(format!(
                    "{about}: ends with {code}, not {other_code}:\n{err}\nnot\n{other_err}"
                ));
            }
            let [written, other_written] = folders.each_ref().map(files);
            check_same(&written, &other_written).map_err(|what| format!("{about}: {what}"))?;
            count.runs += 1;
            count.files += written.len();
            count.bytes += written.values().map(Vec::len).sum::<usize>();
            let is_done = matches!(code, 0 | 3);
            if !is_done {
                count.failures += 1;
                break;
            }
        }
        Ok(())
    }
}

/// The exit code of a run and what it says on standard error.
fn run_in(folder: &Folder, program: &Path, arguments: &str, run: &Run) -> (i32, String) {
    let mut command = Command::new(program);
    command.args(arguments.split_whitespace());
    command.current_dir(folder.path("."));
    command.stdin(match run.stdin {
        Some(file) => fs::File::open(folder.path(file)).expect("a file").into(),
        None => Stdio::null(),
    });
    command.stdout(match run.stdout {
        Some(file) => fs::File::create(folder.path(file)).expect("a file").into(),
        None => Stdio::null(),
    });
    let output = command.output().expect("it runs");
    let code = output.status.code().expect("it ends by itself");
    (code, String::from_utf8_lossy(&output.stderr).into_owned())
}

/// All that is in a folder.
fn files(folder: &Folder) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder.path(".")).expect("a folder");
    let file = |entry: fs::DirEntry| {
        let content = fs::read(entry.path()).expect("a file");
        (entry.file_name().to_string_lossy().into_owned(), content)
    };
    entries
        .map(|entry| file(entry.expect("an entry")))
        .collect()
}

fn check_same(
    files: &BTreeMap<String, Vec<u8>>,
    others: &BTreeMap<String, Vec<u8>>,
) -> Result<(), String> {
    if !files.keys().eq(others.keys()) {
        let [names, other_names] = [files, others].map(|files| files.keys().collect::<Vec<_>>());
        return Err(format!("there are {names:?}, not {other_names:?}"));
    }
    for ((name, content), other) in files.iter().zip(others.values()) {
        if content != other {
            let pairs = content.iter().zip(other);
            return Err(format!(
                "{name} has {} bytes and the other {}, of which the first {} are the same",
                content.len(),
                other.len(),
                pairs.take_while(|(byte, other)| byte == other).count()
            ));
        }
    }
    Ok(())
}

/// A test of each kind of log, so that they run side by side.
macro_rules! compare_builds {
    ($($test:ident: $logs:expr,)*) => {$(
        #[test]
        #[ignore = "it takes another build's program"]
        fn $test() {
            Builds::here_and_other().compare(stringify!($test), $logs);
        }
    )*};
}

compare_builds! {
    logs_of_any_shape_give_the_same_bytes: logs::of_any_shape(),
    torn_logs_give_the_same_bytes: logs::torn(),
    unusual_logs_give_the_same_bytes: logs::unusual(),
    logs_of_random_topics_give_the_same_bytes: logs::of_random_topics(),
    logs_of_every_publisher_give_the_same_bytes: logs::of_every_publisher(),
    logs_in_every_encoding_give_the_same_bytes: logs::in_every_encoding(),
    flown_logs_give_the_same_bytes: logs::flown(),
}
