//! A small disk, where this machine allows a test to mount one.

use std::process::{Command, Output};

use assert_cmd::cargo::cargo_bin;

use super::folder::Folder;

/// Runs a shell script that may mount, invisibly to other processes. In it `$flightcam` is the program. `None`, with a
/// message, where mounting is not allowed.
pub fn run_mounting(folder: &Folder, script: &str) -> Option<Output> {
    let run = |script| {
        let mut command = Command::new("unshare");
        command.args(["--map-root-user", "--mount", "sh", "-c", script]);
        command.env("flightcam", cargo_bin!("flightcam"));
        command.current_dir(folder.path(".")).output()
    };
    let may_mount = run("mount -t tmpfs tmpfs . && umount .");
    if may_mount.is_ok_and(|output| output.status.success()) {
        return Some(run(script).expect("it runs"));
    }
    eprintln!("skipped: this machine does not let a test mount a disk");
    None
}
