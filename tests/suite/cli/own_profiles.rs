//! Profiles of the user's own, in the folder where the program looks for them, and the camera that they may carry.

use flightcam::source::profile::Profile;
use serde_json::Value;

use crate::support::{folder::*, topics};

/// A built-in profile under another name, with something after it.
fn own(built_in: &str, name: &str, more: &str) -> String {
    let text = Profile::built_in_text(built_in).expect("built in");
    let renamed = text.replace(
        &format!("name = \"{built_in}\""),
        &format!("name = \"{name}\""),
    );
    format!("{renamed}\n{more}\n")
}

fn add(folder: &Folder, file: &str, text: &str) {
    folder.add(&format!("{CONFIGURATION}/flightcam/profiles/{file}"), text);
}

const CAMERA: &str = "[camera]\ndepression = 35";

fn camera(folder: &Folder, arguments: &str) -> Value {
    folder.reports(&format!("enrich {LOG} --force {arguments}"), 0)["camera"].clone()
}

#[test]
fn one_that_fits_as_well_as_a_built_in_one_is_preferred() {
    let folder = Folder::with_flight();
    add(&folder, "mine.toml", &own("flat", "our-rig", CAMERA));
    let report = folder.reports(&format!("enrich {LOG}"), 0);
    assert_eq!(report["profile"]["name"], "our-rig");
    assert_eq!(report["profile"]["chosen"], "automatically");
    assert_eq!(report["profile"]["gives_camera"], true);
    assert_eq!(report["camera"]["depression_deg"], 35.0);
}

#[test]
fn one_that_fits_less_well_is_not() {
    let folder = Folder::with(
        LOG,
        topics::log(&[topics::attitude("/fmu/out/vehicle_attitude")]),
    );
    add(&folder, "mine.toml", &own("nav-msgs", "mine", CAMERA));
    let report = folder.reports(&format!("enrich {LOG} --depression 30"), 0);
    assert_eq!(report["profile"]["name"], "px4-ros2");
    assert_eq!(report["profile"]["gives_camera"], Value::Null);
}

#[test]
fn one_with_the_name_of_a_built_in_one_takes_its_place() {
    let folder = Folder::with_flight();
    add(&folder, "any.toml", &own("flat", "flat", CAMERA));
    for arguments in ["", "--profile flat"] {
        assert_eq!(camera(&folder, arguments)["depression_deg"], 35.0);
    }
    let (list, _) = folder.run("profiles", 0);
    let flat = list.lines().filter(|line| line.starts_with("flat "));
    assert_eq!(flat.count(), 1);
    assert!(list.contains("any.toml"), "{list}");
    let (text, _) = folder.run("profiles flat", 0);
    assert!(text.ends_with("depression = 35\n"), "{text}");
}

#[test]
fn it_is_used_by_its_name() {
    let folder = Folder::with_flight();
    let by_name = own("flat", "mine", &format!("{CAMERA}\n"))
        .replace("name = \"mine\"", "name = \"mine\"\nautomatic = false");
    add(&folder, "mine.toml", &by_name);
    folder.refuses(
        &format!("enrich {LOG}"),
        2,
        "…does not say where the camera looks…",
    );
    assert_eq!(camera(&folder, "--profile mine")["depression_deg"], 35.0);
}

/// A mistake must not lead to another profile without a word.
#[test]
fn one_with_a_mistake_is_an_error() {
    let folder = Folder::with_flight();
    let text = own("flat", "mine", "[camera]\ndepresion = 35");
    add(&folder, "mine.toml", &text);
    folder.refuses(
        &format!("enrich {LOG} --depression 30"),
        2,
        "error: …mine.toml: not a profile: line …: unknown …`depresion`…`depression`…",
    );
    // A profile from a file has nothing to do with those in the folder.
    folder.add("other.toml", own("flat", "other", ""));
    folder.reports(
        &format!("enrich {LOG} --depression 30 --profile ./other.toml"),
        0,
    );
}

#[test]
fn two_of_the_same_name_are_an_error() {
    let folder = Folder::with_flight();
    for file in ["a.toml", "b.toml"] {
        add(&folder, file, &own("flat", "mine", CAMERA));
    }
    folder.refuses(
        &format!("inspect {LOG}"),
        2,
        "error: …a.toml and …b.toml are both called `mine`; give one of them another name…",
    );
}

#[test]
fn the_camera_of_a_profile_is_that_of_the_options() {
    let folder = Folder::with_flight();
    for (camera, arguments) in [
        ("depression = 35", "--depression 35"),
        ("mount = [0, -30, 0]", "--mount 0,-30,0"),
        (
            "depression = 10\nmount = [0, 0, 90]",
            "--depression 10 --mount 0,0,90",
        ),
        (
            "depression = 10\nhfov = 84\nvfov = 54",
            "--depression 10 --hfov 84 --vfov 54",
        ),
    ] {
        folder.add(
            "mine.toml",
            own("flat", "mine", &format!("[camera]\n{camera}")),
        );
        let run = |arguments: &str| {
            let arguments = format!("enrich {LOG} --force --visuals {arguments}");
            let report = folder.reports(&arguments, 0);
            let values = ["camera", "written", "not_written"].map(|key| report[key].clone());
            (
                values,
                report["visuals"]["field_of_view"]["degrees"].clone(),
            )
        };
        assert_eq!(run("--profile mine.toml"), run(arguments), "{camera}");
    }
}

#[test]
fn the_options_take_precedence_over_the_profiles_camera() {
    let folder = Folder::with_flight();
    let text = own(
        "flat",
        "mine",
        "[camera]\ndepression = 35\nhfov = 84\nvfov = 54",
    );
    folder.add("mine.toml", text);
    let by_depression = camera(&folder, "--profile mine.toml --depression 20");
    assert_eq!(by_depression["depression_deg"], 20.0);
    let by_mount = camera(&folder, "--profile mine.toml --mount 0,-30,0");
    assert_eq!(by_mount["kind"], "fixed");
    let arguments = "--profile mine.toml --visuals --hfov 60 --vfov 40";
    let report = folder.reports(&format!("enrich {LOG} --force {arguments}"), 0);
    let seen = &report["visuals"]["field_of_view"];
    assert_eq!(seen["by_profile"], Value::Null);
    let [wide, high] = [0, 1].map(|index| seen["degrees"][index].as_f64().expect("a number"));
    assert!((wide - 60.0).abs() < 0.1 && (high - 40.0).abs() < 0.1);
}

#[test]
fn the_report_says_that_the_profile_says_it() {
    let folder = Folder::with_flight();
    folder.add("mine.toml", own("flat", "mine", CAMERA));
    let (out, _) = folder.run(&format!("enrich {LOG} --profile mine.toml"), 0);
    assert_reads(
        &out,
        "…Camera      looks 35° below the horizon, as the profile says…",
    );
    let (out, _) = folder.run(&format!("inspect {LOG} --profile mine.toml"), 0);
    assert_reads(
        &out,
        "…Camera      looks 35° below the horizon, as the profile says…",
    );
}
