//! `enrich --visuals` on the command line: its arguments, and what it reports.

use crate::support::folder::Folder;

const ENRICH: &str = "enrich flight.mcap -o result.mcap --depression 50";

#[test]
fn the_report_says_what_is_shown_and_what_is_assumed() {
    let folder = Folder::with_flight();
    let (report, _) = folder.run(&format!("{ENRICH} --visuals --hfov 60 --vfov 40"), 0);
    for line in [
        "Visuals     30 transforms and 10 scenes a second",
        "            field of view 60.0° by 40.0°, as asked for",
        "            level ground at 535.3 m, that of the take-off, which is assumed; --ground says otherwise",
        "Written     /camera/transforms: 1,986 messages",
        "Written     /camera/footprint: 1 message",
        "Not written /camera/events: nothing happened",
    ] {
        assert!(report.contains(line), "no {line:?} in\n{report}");
    }
    assert!(report.contains("flightcam layout"), "{report}");
}

#[test]
fn the_report_names_the_options_that_would_show_more() {
    let folder = Folder::with_flight();
    let (report, _) = folder.run(&format!("{ENRICH} --visuals --ground 500"), 0);
    for line in [
        "            field of view not known; --hfov and --vfov say it",
        "            level ground at 500.0 m, as asked for",
        "Not written /camera/calibration: the field of view is not known",
        "Not written /camera/footprint: the field of view is not known",
    ] {
        assert!(report.contains(line), "no {line:?} in\n{report}");
    }
}

#[test]
fn arguments_that_make_no_sense_are_refused() {
    let folder = Folder::with_flight();
    for (arguments, message) in [
        ("--hfov 60 --vfov 40", "--visuals"),
        ("--visuals --hfov 60", "--vfov"),
        ("--visuals --hfov 60 --vfov 0", "from 0.1 to 170 degrees"),
        ("--visuals --hfov 180 --vfov 40", "from 0.1 to 170 degrees"),
        (
            "--visuals --ground low",
            "an altitude in metres, or takeoff",
        ),
        ("--visuals --reach 0.5", "from 1 to 100"),
        ("--reach 3", "--visuals"),
        ("--visuals --visual-rate 61", "from 0.1 to 60 Hz"),
        ("--visuals --visual-rate 0", "from 0.1 to 60 Hz"),
        ("--ground 3", "--visuals"),
        ("--visual-rate 3", "--visuals"),
    ] {
        let (_, complaint) = folder.run(&format!("{ENRICH} {arguments}"), 2);
        assert!(complaint.contains(message), "{arguments}: {complaint}");
    }
    for arguments in [
        "--visuals --ground -12.5",
        "--visuals --ground takeoff --visual-rate 0.1 --reach 100",
    ] {
        folder.run(&format!("{ENRICH} {arguments} --force"), 0);
    }
}
