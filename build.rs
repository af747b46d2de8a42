//! Compiles the messages in `proto/` to Rust types and to the schemas that are embedded, and lists the profiles in
//! `profiles/`.

use std::{
    env,
    error::Error,
    fs, io,
    path::{Path, PathBuf},
};

const PROTO: &str = "proto";
const MESSAGES: [&str; 3] = ["camera_velocity", "original_tail", "relative_rpy"];
const PROFILES: &str = "profiles";

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed={PROTO}");
    println!("cargo::rerun-if-changed={PROFILES}");
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or("cargo sets OUT_DIR")?);
    compile_messages(&out)?;
    list_profiles(&out)?;
    Ok(())
}

/// Compiles each message to a Rust type, and to a descriptor set that is its schema. `protox` is a compiler written
/// in Rust, so that building needs no `protoc`.
fn compile_messages(out: &Path) -> Result<(), Box<dyn Error>> {
    let path = |message: &str| format!("flightcam/v1/{message}.proto");
    for message in MESSAGES {
        let mut compiler = protox::Compiler::new([PROTO])?;
        // With its imports, so that a reader can resolve the schema by itself.
        compiler.include_imports(true).open_file(path(message))?;
        fs::write(
            out.join(message).with_extension("bin"),
            compiler.encode_file_descriptor_set(),
        )?;
    }
    prost_build::compile_fds(protox::compile(MESSAGES.map(path), [PROTO])?)?;
    Ok(())
}

/// Writes a Rust slice of the profiles' texts. Their file names begin with a number, which gives their order.
fn list_profiles(out: &Path) -> io::Result<()> {
    let folder = env::current_dir()?.join(PROFILES);
    let files: io::Result<Vec<PathBuf>> = fs::read_dir(folder)?
        .map(|entry| Ok(entry?.path()))
        .collect();
    let mut files = files?;
    files.retain(|file| {
        file.extension()
            .is_some_and(|extension| extension == "toml")
    });
    files.sort();
    let texts: Vec<String> = files
        .iter()
        .map(|file| format!("include_str!({file:?})"))
        .collect();
    fs::write(out.join("profiles.rs"), format!("&[{}]", texts.join(", ")))
}
