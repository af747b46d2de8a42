//! Logs that say less of themselves than flightcam wrote, or something else, or nothing.

use std::{collections::BTreeMap, io::Cursor};

use flightcam::{Encoding, Error, LayoutError, Viewer, Watch, layout};
use mcap::MessageStream;
use serde_json::json;

use crate::support::{
    folder::Folder,
    panels::*,
    topics,
    viewing::{enriched, with_view},
};

#[test]
fn a_log_whose_metadata_record_is_lost_has_the_same_panels() {
    let titles = and(&USUAL, &["Map"]);
    for encoding in Encoding::ALL {
        let log = enriched(&survey_flight(), &in_encoding(encoding));
        let kept = panels_with(&log, &titles);
        for lost in [
            rewritten([&log], |metadata| metadata),
            rewritten([&log], |_| BTreeMap::new()),
        ] {
            let panels = panels_with(&lost, &titles);
            assert!(panels["Map"].settings.get("center").is_none());
            for plot in [TURN, RATE, VELOCITY, SIGHT, FLIGHT] {
                assert_eq!(panels[plot].settings, kept[plot].settings);
            }
        }
    }
}

#[test]
fn what_the_metadata_record_says_is_not_taken_on_trust() {
    let log = rewritten([&enriched(&survey_flight(), &with_view())], |metadata| {
        metadata
    });
    let facts = [
        ("topics", "/camera/nothing,/camera/display"),
        ("visuals_extent_m", "-1e300"),
        ("visuals_top_speed", "NaN"),
        ("visuals_centre_deg", "north"),
        ("visuals_ground_in_map_m", "inf"),
    ];
    let facts = facts.map(|(key, fact)| (key.to_owned(), fact.to_owned()));
    let mut writer = mcap::Writer::new(Cursor::new(Vec::new())).expect("a writer");
    for message in MessageStream::new(&log).expect("a readable log") {
        (writer.write(&message.expect("a message"))).expect("it is written");
    }
    let record = mcap::records::Metadata {
        name: "flightcam".to_owned(),
        metadata: facts.into(),
    };
    writer.write_metadata(&record).expect("it is written");
    writer.finish().expect("the log is finished");
    let panels = panels_with(&writer.into_inner().into_inner(), &and(&USUAL, &["Map"]));
    let scene = &panels[SCENE].settings;
    assert_eq!(scene["layers"]["ground"]["position"], json!([0, 0, 0.0]));
    assert_eq!(panels[GAUGE].settings["maxValue"], 20.0);
}

#[test]
fn a_log_that_is_not_enriched_has_no_layout() {
    for log in [
        survey_flight(),
        // Names that others use as well.
        topics::log(&[
            states(),
            topics::twice("/camera/velocity", json!({ "x": 1, "y": 2, "z": 3 })),
            topics::pose("/camera/pose"),
            topics::twice("/camera/display", json!({ "speed": 1 })),
        ]),
        topics::log(&[]),
    ] {
        let folder = Folder::with("log.mcap", log);
        let layout = layout(
            folder.path("log.mcap"),
            Viewer::Lichtblick,
            &Watch::default(),
        );
        let error = layout.expect_err("no layout");
        let is_it = matches!(&error, Error::Layout(LayoutError::NotEnriched { path }) if *path == folder.path("log.mcap"));
        assert!(is_it, "{error}");
    }
}
