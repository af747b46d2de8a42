//! What makes a log of a file of another kind. docs/encodings.md has the same in a table, with the sources.

use std::path::Path;

use flightcam::log::ForeignFormat;

use super::in_shell;

/// What the user can do with a file that is not MCAP.
pub fn hint(path: &Path, format: Option<ForeignFormat>) -> String {
    use ForeignFormat::*;
    match format {
        Some(Ulog) => format!(
            "convert it first with `python convert.py {}`, \
             Foxglove's script (https://github.com/foxglove/mcap/tree/main/python/examples/ulog2mcap)",
            from_to(path, "ulg")
        ),
        Some(Ros1Bag) => convert_first(path, "bag"),
        Some(Sqlite) => format!(
            "if it is a ROS 2 bag, {}. A bag from before ROS 2 Iron lacks the message definitions: \
             `ros2 bag convert` adds them on the machine that recorded it (https://mcap.dev/guides/getting-started/ros-2)",
            convert_first(path, "db3")
        ),
        Some(BagMetadata) => format!(
            "give the .mcap file beside it; if there is a .db3 file, {}",
            convert_first(Path::new(""), "db3")
        ),
        Some(DataFlash) => format!(
            "convert it first with `arducap {}` (https://crates.io/crates/arducap; `cargo install arducap`)",
            named(path, &["bin", "BIN"])
        ),
        Some(DataFlashText) => {
            "get the log in its binary form (.bin), and convert that with `arducap flight.bin` \
             (https://crates.io/crates/arducap; `cargo install arducap`)"
                .to_owned()
        }
        Some(Tlog) => format!(
            "no tool is known that converts it. `mavlogdump.py --format json {}` (`pip install pymavlink`) prints its \
             messages as JSON, and the library mcap writes them (https://mcap.dev/guides/python). The autopilot's own \
             log has more of the flight: .bin of ArduPilot, .ulg of PX4",
            named(path, &["tlog"])
        ),
        Some(Zstd) => decompress_first("zstd", path, "zst"),
        Some(Gzip) => decompress_first("gzip", path, "gz"),
        Some(Lz4) => decompress_first("lz4", path, "lz4"),
        Some(Xz) => decompress_first("xz", path, "xz"),
        Some(Bzip2) => decompress_first("bzip2", path, "bz2"),
        Some(Zip) => format!("unpack it first: `unzip {}`", named(path, &["zip"])),
        Some(Tar) => format!("unpack it first: `tar -xf {}`", named(path, &["tar"])),
        Some(Csv | Json) => {
            "write it as MCAP first, one JSON message for each row, with the library mcap \
                             (https://mcap.dev/guides/python) or with tabular2mcap \
                             (https://pypi.org/project/tabular2mcap)"
                .to_owned()
        }
        Some(Video | Subtitles) => {
            "give the flight log; the telemetry within videos and their subtitles is not read"
                .to_owned()
        }
        Some(LfsPointer) => "fetch the file first: `git lfs pull`".to_owned(),
        Some(WebPage) => "open it in a browser: it may say why this is not the log".to_owned(),
        _ => "check that it is the log you meant".to_owned(),
    }
}

fn convert_first(path: &Path, extension: &str) -> String {
    format!(
        "convert it first with `mcap convert {}` (https://mcap.dev/guides/cli)",
        from_to(path, extension)
    )
}

fn decompress_first(program: &str, path: &Path, extension: &str) -> String {
    let names = match path.extension().is_some_and(|own| own == extension) {
        true => shell_name(path).zip(shell_name(&with_mcap(&path.with_extension("")))),
        false => None,
    };
    let (from, to) =
        names.unwrap_or((format!("flight.mcap.{extension}"), "flight.mcap".to_owned()));
    format!("decompress it first: `{program} -dc {from} > {to}`")
}

/// The names of a file and of the MCAP file that is made of it, as a shell reads them.
fn from_to(path: &Path, extension: &str) -> String {
    let name = named(path, &[extension]);
    let to = match name.starts_with("flight.") {
        true => None,
        false => shell_name(&path.with_extension("mcap")),
    };
    format!("{name} {}", to.unwrap_or_else(|| "flight.mcap".to_owned()))
}

/// The name of a file as a shell reads it; an example if it has another extension, which the tools go by.
fn named(path: &Path, extensions: &[&str]) -> String {
    let has_extension =
        (path.extension()).is_some_and(|own| extensions.iter().any(|wanted| own == *wanted));
    let name = shell_name(path).filter(|_| has_extension);
    name.unwrap_or_else(|| format!("flight.{}", extensions[0]))
}

fn shell_name(path: &Path) -> Option<String> {
    in_shell(path.to_str()?)
}

fn with_mcap(path: &Path) -> std::path::PathBuf {
    match path.extension() {
        Some(_) => path.to_owned(),
        None => path.with_extension("mcap"),
    }
}
