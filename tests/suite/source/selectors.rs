//! Several sources on one topic, told apart by what their messages say, and fields whose names need quotes.

use flightcam::{
    Note,
    log::{Log, ReadError},
    profile::{Alternative, Profile},
    reader::Reader,
    sample::{Kind, Sample, Tallies},
    source::{Source, request::Request},
};
use serde_json::{Value, json};

use crate::support::{
    folder::{Folder, LOG, assert_reads},
    logbook::{Logbook, request as request_of_profile},
    piping::check,
    selecting::{request, select_with},
    small_logs::dropped,
    topics::*,
};

/// Angles of two gimbals in turn, of which only the first is still.
fn gimbals(count: u32) -> Topic {
    topic(
        "/gimbal",
        (0..count).map(|i| {
            let device = i % 2 + 2;
            let pitch = if device == 2 { -0.5 } else { -1.5 };
            json!({ "device_id": device, "name": format!("gimbal {device}"), "pitch": pitch })
        }),
    )
}

fn read(topics: &[Topic], request: &Request) -> (Source, Vec<Sample>, Tallies) {
    check(&log(topics), request, 4096);
    let folder = Folder::with(LOG, log(topics));
    let log = Log::open(&folder.path(LOG)).expect("a log");
    let source = Source::select(&log, request).expect("a source");
    let mut samples = Vec::new();
    let reader = Reader::new(&log, source).expect("a readable log");
    let read = reader.for_each(|arrival| {
        samples.push(arrival.sample);
        Ok::<_, ReadError>(())
    });
    let read = read.expect("a readable log");
    (read.source, samples, read.dropped)
}

fn pitches(samples: &[Sample]) -> Vec<f64> {
    let pitch = |sample: &Sample| match sample {
        Sample::Gimbal(gimbal) => Some((gimbal.orientation.euler_angles().1 * 1e9).round() / 1e9),
        _ => None,
    };
    samples.iter().filter_map(pitch).collect()
}

#[test]
fn a_filter_after_the_topic_selects_the_messages_of_one_source() {
    for (filters, expected) in [
        ("{device_id==2}", -0.5),
        ("{device_id==3}", -1.5),
        ("{device_id!=2}", -1.5),
        (r#"{name=="gimbal 3"}"#, -1.5),
        (r#"{device_id==3}{name!='gimbal 2'}"#, -1.5),
    ] {
        let argument = format!("/gimbal{filters}.pitch:radians");
        let request = request(&[("--gimbal", &argument)]);
        let (source, samples, tallies) = read(&[flat("/state"), gimbals(20)], &request);
        assert_eq!(pitches(&samples), vec![expected; 10], "{filters}");
        assert_eq!(tallies[Kind::Gimbal].unselected, 10);
        assert_eq!(dropped(&tallies[Kind::Gimbal]), []);
        assert_eq!(source.unmet_filters(Kind::Gimbal), []);
        let origin = source.role(Kind::Gimbal).expect("a gimbal").to_string();
        assert_eq!(
            origin,
            format!("/gimbal{} has pitch", filters.replace('\'', "\""))
        );
    }
}

#[test]
fn a_topic_alone_may_have_a_filter_too() {
    let profile = r#"
        name = "own"
        [attitude]
        topics = ["/state"]
        orientation.euler = { roll = "roll", pitch = "pitch", yaw = "yaw", unit = "radians" }
        [gimbal]
        topics = ["/gimbal"]
        orientation.pitch = { field = "pitch", unit = "radians" }
        reference = "heading"
    "#;
    let mut asked = request_of_profile(profile);
    let (_, samples, tallies) = read(&[flat("/state"), gimbals(20)], &asked);
    assert_eq!(
        (pitches(&samples).len(), tallies[Kind::Gimbal].unselected),
        (20, 0)
    );
    asked.roles = request(&[("--gimbal", "/gimbal{device_id==3}")]).roles;
    let (_, samples, _) = read(&[flat("/state"), gimbals(20)], &asked);
    assert_eq!(pitches(&samples), [-1.5; 10]);
}

/// The first alternative whose filters hold, and whose condition holds, is used.
#[test]
fn alternatives_may_select_different_sources() {
    let of = |id: u32, unit: &str| {
        format!(
            "[[gimbal]]\ntopics = [\"/gimbal\"]\nselect = [\"device_id=={id}\"]\n\
             orientation.pitch = {{ field = \"pitch\", unit = \"{unit}\" }}\nreference = \"heading\"\n"
        )
    };
    let attitude = "name = \"own\"\n[attitude]\ntopics = [\"/state\"]\n\
                    orientation.euler = { roll = \"roll\", pitch = \"pitch\", yaw = \"yaw\", unit = \"radians\" }\n";
    let both = format!("{attitude}{}{}", of(2, "radians"), of(3, "degrees"));
    // Which of several alternatives is used is decided by the first that fits; the others are for other messages.
    let (_, samples, tallies) = read(&[flat("/state"), gimbals(4)], &request_of_profile(&both));
    let degrees = |angle: f64| (angle.to_radians() * 1e9).round() / 1e9;
    assert_eq!(
        pitches(&samples),
        [-0.5, degrees(-1.5), -0.5, degrees(-1.5)]
    );
    assert_eq!(tallies[Kind::Gimbal].unselected, 0);
    let one = format!("{attitude}{}{}", of(7, "radians"), of(3, "degrees"));
    let (_, samples, tallies) = read(&[flat("/state"), gimbals(4)], &request_of_profile(&one));
    assert_eq!(pitches(&samples), [degrees(-1.5); 2]);
    assert_eq!(tallies[Kind::Gimbal].unselected, 2);
}

fn profile_toml(role: &str) -> Result<Profile, String> {
    let attitude = "orientation.euler = { roll = \"/s.r\", pitch = \"/s.p\", yaw = \"/s.y\", unit = \"degrees\" }";
    let text = format!(
        "name = \"own\"\nattitude = {{ {attitude} }}\n[gimbal]\nreference = \"heading\"\n{role}"
    );
    Profile::parse(&text).map_err(|problem| problem.to_string())
}

#[test]
fn in_a_profile_a_filter_is_in_the_paths_or_a_key_of_its_own() {
    let pitch =
        |path: &str| format!("orientation.pitch = {{ field = '{path}', unit = \"degrees\" }}\n");
    let in_path = profile_toml(&pitch(r#"/g{id==1}{a.b!="x"}.pitch"#)).expect("a profile");
    let key = r#"select = ["id==1", 'a.b != "x"']"#;
    let of_key = profile_toml(&format!("topics = [\"/g\"]\n{key}\n{}", pitch("pitch")));
    assert_eq!(of_key.as_ref(), Ok(&in_path));
    let of_both = profile_toml(&format!("{key}\n{}", pitch("/g.pitch")));
    assert_eq!(of_both.as_ref(), Ok(&in_path));
    let [Alternative { location, .. }] = in_path.alternatives(Kind::Gimbal) else {
        panic!("one alternative");
    };
    let select: Vec<String> = location
        .select
        .iter()
        .map(|filter| filter.to_string())
        .collect();
    assert_eq!(select, ["id==1", r#"a.b!="x""#]);
    let written = toml::to_string(&in_path).expect("TOML");
    assert_reads(&written, r#"select = ["id==1", 'a.b!="x"']"#);
    assert_eq!(Profile::parse(&written), Ok(in_path));

    for (role, words) in [
        (
            format!("{key}\n{}", pitch("/g{id==2}.pitch")),
            "a path has the filter `id==2`, and there is `select` as well … in `gimbal`",
        ),
        (
            format!("valid = [\"/g.ok\"]\n{}", pitch("/g{id==2}.pitch")),
            "not all of the paths on /g have the same filter",
        ),
        (
            format!("topics = [\"/g\"]\nselect = [\"id>1\"]\n{}", pitch("pitch")),
            "`id>1` is not a filter",
        ),
        (
            format!("topics = [\"/g\"]\nselect = \"id==1\"\n{}", pitch("pitch")),
            "invalid type: string",
        ),
    ] {
        assert_reads(&profile_toml(&role).expect_err("a wrong profile"), words);
    }
}

#[test]
fn a_field_for_a_filter_that_is_not_there_is_an_error() {
    let topics = [flat("/state"), gimbals(4)];
    let select = |argument| select_with(&topics, &request(&[("--gimbal", argument)]));
    let problem = select("/gimbal{device==1}.pitch:radians").expect_err("no such field");
    assert_reads(
        &problem.to_string(),
        "/gimbal: it has no field `device`; … has device_id, name, pitch",
    );
    let problem = select("/gimbal{name==1}.pitch:radians").expect_err("a text");
    assert_reads(
        &problem.to_string(),
        "/gimbal: its field `name` is not a number but text",
    );
}

/// A drone on `/state`, and others with other numbers there too, in several chunks.
fn drones(ids: &[i64]) -> Folder {
    let mut book = Logbook::with_chunks_of(60_000);
    let channel = book.json("/state");
    let padding = "x".repeat(10_000);
    for time in 0..400 {
        let id = ids[time as usize % ids.len()];
        let state = format!(
            r#"{{"id":{id},"roll":0,"pitch":0,"yaw":0.{time:03},"vx":1,"vy":0,"vz":0,"padding":"{padding}"}}"#
        );
        book.put(channel, time * 20, state.as_bytes());
    }
    let (_folder, path) = book.finish();
    Folder::with(LOG, std::fs::read(path).expect("the log"))
}

const ATTITUDE: &str = "enrich flight.mcap --depression 30 --attitude";

fn of_id(id: i64) -> String {
    format!(
        "{ATTITUDE} /state{{id=={id}}}.roll,/state{{id=={id}}}.pitch,/state{{id=={id}}}.yaw:radians"
    )
}

/// The segments are read by several threads, if there are that many processors.
#[test]
fn the_report_counts_messages_of_other_sources_apart() {
    let folder = drones(&[1, 2, 3, 2]);
    let (report, _) = folder.run(&of_id(2), 0);
    assert_reads(
        &report,
        "Attitude    /state: 200 of 200 samples used … 200 messages of another source left out",
    );
    std::fs::remove_file(folder.path("flight.enriched.mcap")).expect("removed");
    let (json, _) = folder.run(&format!("{} --json", of_id(2)), 0);
    let json: Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["attitude"]["used"], 200);
    assert_eq!(json["attitude"]["unselected"], 200);
    assert_eq!(json["attitude"]["dropped"], json!({}));
    assert_eq!(json["profile"]["attitude"]["select"], json!(["id==2"]));
    let inspected = of_id(2).replace("enrich", "inspect");
    let (text, _) = folder.run(&inspected, 0);
    assert_reads(&text, "Attitude … 200 of another source");
}

#[test]
fn if_no_message_is_of_the_source_the_error_says_which_sources_there_are() {
    let folder = drones(&[2, 3]);
    let message = "nothing can be derived … /state has 0 of 0 usable; 400 messages are of another source: `id` is 2 or 3, \
                   never 1";
    folder.refuses(&of_id(1), 1, message);
    let (text, _) = folder.run(&of_id(1).replace("enrich", "inspect"), 1);
    assert_reads(
        &text,
        "enrich would fail … 400 messages are of another source: `id` is 2 or 3, never 1",
    );
    let many: Vec<i64> = (2..40).collect();
    let (_, problem) = drones(&many).run(&of_id(1), 1);
    assert_reads(&problem, "`id` is … or something else, never 1");
    let values = problem.split("`id` is ").nth(1).expect("values");
    let (values, _) = values.split_once(" or something else").expect("more");
    assert_eq!(values.split(", ").count(), 10, "{problem}");
}

#[test]
fn the_values_that_an_error_lists_are_escaped() {
    let mut book = Logbook::new();
    let channel = book.json("/state");
    for time in 0..3 {
        let state = "{\"id\":\"\\u001b[31m\\n\",\"q\":[1,0,0,0]}";
        book.put(channel, time, state.as_bytes());
    }
    let (_folder, path) = book.finish();
    let folder = Folder::with(LOG, std::fs::read(path).expect("the log"));
    let arguments = format!("{ATTITUDE} /state{{id==\"a\"}}.q:frd-ned");
    folder.refuses(&arguments, 1, "`id` is \"\\u{1b}[31m\\n\", never \"a\"");
}

#[test]
fn what_cannot_be_decoded_is_no_other_sources() {
    let mut book = Logbook::new();
    let channel = book.json("/state");
    for (time, state) in [
        r#"{"id":1,"roll":0,"pitch":0,"yaw":0}"#,
        r#"{"id":2,"roll":0,"pitch":0,"yaw":0}"#,
        r#"{"id":1,"roll":0,"pitch":0,"yaw":0}"#,
        r#"{"id":2,"roll":"#,
    ]
    .iter()
    .enumerate()
    {
        book.put(channel, 20 * time as u64, state.as_bytes());
    }
    let (_folder, path) = book.finish();
    let folder = Folder::with(LOG, std::fs::read(path).expect("the log"));
    let json = folder.reports(&of_id(1), 3);
    assert_eq!(json["attitude"]["used"], 2);
    assert_eq!(json["attitude"]["unselected"], 1);
    assert_eq!(json["attitude"]["dropped"], json!({ "undecodable": 1 }));
    let is_note = |note: &&Value| note["kind"] == "undecodable";
    let note = json["notes"]
        .as_array()
        .expect("notes")
        .iter()
        .find(is_note);
    assert_reads(
        &note.expect("a note")["first"]["problem"].to_string(),
        "it is not JSON in its field `roll`",
    );
    let _ = Note::ChecksumWrong;
}

// ---- Names in quotes ----

fn osd() -> Topic {
    topic(
        "/fc.osd",
        (0..5).map(|i| {
            json!({
                "OSD.roll": 0, "OSD.pitch": 0.01 * f64::from(i), "OSD": { "yaw [deg]": i, "a/b": { "\"q\"": 0 } }
            })
        }),
    )
}

#[test]
fn a_key_with_a_dot_in_it_is_named_in_quotes() {
    let paths = [r#""OSD.roll""#, r#""OSD.pitch""#, r#"OSD."yaw [deg]""#];
    let argument = paths.map(|path| format!("\"/fc.osd\".{path}")).join(",") + ":degrees";
    let source = select_with(&[osd()], &request(&[("--attitude", &argument)])).expect("a source");
    assert_eq!(
        source.attitude().to_string(),
        format!("/fc.osd has {}", paths.join(", "))
    );
    let argument = argument.replace(r#"OSD."yaw [deg]""#, r#"OSD."a/b"."\"q\"""#);
    let source = select_with(&[osd()], &request(&[("--attitude", &argument)])).expect("a source");
    assert_reads(&source.attitude().to_string(), r#"OSD."a/b"."\"q\"""#);
}

#[test]
fn in_a_profile_such_a_key_is_named_with_its_topic_or_without() {
    let profile = |prefix: &str| {
        format!(
            "name = \"own\"\nattitude.orientation.euler = {{ roll = '{prefix}\"OSD.roll\"', \
             pitch = '{prefix}\"OSD.pitch\"', yaw = '{prefix}OSD.\"yaw [deg]\"', unit = \"degrees\" }}"
        )
    };
    for prefix in ["", "\"/fc.osd\"."] {
        let request = request_of_profile(&profile(prefix));
        let source = select_with(&[osd()], &request).expect("a source");
        assert_eq!(source.attitude().topic, "/fc.osd");
        let toml = toml::to_string(&source.profile).expect("TOML");
        assert_eq!(Profile::parse(&toml), Ok(source.profile.clone()));
    }
}

/// So that they can be copied from there.
#[test]
fn an_error_lists_names_as_paths_have_them() {
    let argument = "\"/fc.osd\".OSD.roll,\"/fc.osd\".OSD.pitch,\"/fc.osd\".OSD.yaw:degrees";
    let problem =
        select_with(&[osd()], &request(&[("--attitude", argument)])).expect_err("no field");
    assert_reads(&problem.to_string(), r#"has OSD, "OSD.pitch", "OSD.roll""#);
}
