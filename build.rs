//! Compiles the messages in `proto/` to Rust types and to the schemas that are embedded, and lists the profiles in
//! `profiles/`.

use std::{
    env,
    error::Error,
    fs, io,
    path::{Path, PathBuf},
};

const PROTO: &str = "proto";
const PACKAGE: &str = "flightcam/v1";
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
    let package = Path::new(PROTO).join(PACKAGE);
    let mut paths = Vec::new();
    for file in files(&package, "proto")? {
        let path = file.strip_prefix(PROTO)?.to_owned();
        let mut compiler = protox::Compiler::new([PROTO])?;
        // With its imports, so that a reader can resolve the schema by itself.
        compiler.include_imports(true).open_file(&path)?;
        let name = file.file_stem().unwrap_or_default();
        fs::write(
            out.join(name).with_extension("bin"),
            compiler.encode_file_descriptor_set(),
        )?;
        paths.push(path);
    }
    prost_build::compile_fds(protox::compile(paths, [PROTO])?)?;
    Ok(())
}

/// Writes a Rust slice of the profiles' texts. Their file names begin with a number, which gives their order.
fn list_profiles(out: &Path) -> io::Result<()> {
    let folder = env::current_dir()?.join(PROFILES);
    let texts: Vec<String> = files(&folder, "toml")?
        .iter()
        .map(|file| format!("include_str!({file:?})"))
        .collect();
    fs::write(out.join("profiles.rs"), format!("&[{}]", texts.join(", ")))
}

/// The files of a folder that have an extension, sorted by name.
fn files(folder: &Path, extension: &str) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        files.push(entry?.path());
    }
    files.retain(|file| file.extension().is_some_and(|known| known == extension));
    files.sort();
    Ok(files)
}
