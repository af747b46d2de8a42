//! Compiles the messages in `proto/` to Rust types, and each to the descriptor set that is embedded as its
//! schema. `protox` is a compiler written in Rust, so that building needs no `protoc`.

use std::{env, fs, path::PathBuf};

const FOLDER: &str = "proto";
const MESSAGES: [&str; 3] = ["camera_velocity", "original_tail", "relative_rpy"];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo::rerun-if-changed={FOLDER}");
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or("cargo sets OUT_DIR")?);
    let path = |message: &str| format!("flightcam/v1/{message}.proto");

    for message in MESSAGES {
        let mut compiler = protox::Compiler::new([FOLDER])?;
        // Imports go along, so that a reader can resolve the schema with nothing else at hand.
        compiler.include_imports(true).open_file(path(message))?;
        fs::write(
            out.join(message).with_extension("bin"),
            compiler.encode_file_descriptor_set(),
        )?;
    }
    prost_build::compile_fds(protox::compile(MESSAGES.map(path), [FOLDER])?)?;
    Ok(())
}
