//! Which of several ways to read one topic, by what its messages hold.

use super::*;

#[test]
fn of_two_velocities_in_one_message_the_usable_one_is_read() {
    let state = |vn: Value| json!({ "roll": 0, "pitch": 0, "yaw": 0, "vn": vn, "ve": 0, "vd": 0, "vx": 9, "vy": 0, "vz": 0 });
    for (vn, fields) in [
        (json!(1), ["vn", "ve", "vd"]),
        (json!("NaN"), ["vx", "vy", "vz"]),
    ] {
        let topics = [times(3, twice("/state", state(vn)))];
        let source = source(&topics, &Request::default());
        let velocity = source.role(Kind::Velocity).expect("a velocity");
        let read: Vec<String> = velocity.fields.iter().map(ToString::to_string).collect();
        assert_eq!(read, fields);
        let passed = source.passed_over.len();
        assert_eq!(passed, usize::from(fields[0] == "vx"));
        // And that is what is read.
        let report = enriched(&topics);
        assert_eq!(report.samples[&Kind::Velocity].tally.used, 3);
    }
}

#[test]
fn names_of_directions_precede_names_that_may_mean_others() {
    for (first, then) in [
        (["vn", "ve", "vd"], ["vx", "vy", "vz"]),
        (["v_n", "v_e", "v_d"], ["v_x", "v_y", "v_z"]),
        (["vel_n", "vel_e", "vel_d"], ["vel_x", "vel_y", "vel_z"]),
        (
            ["velocity_n", "velocity_e", "velocity_d"],
            ["velocity_x", "velocity_y", "velocity_z"],
        ),
        (
            ["velocity_north", "velocity_east", "velocity_down"],
            ["vx", "vy", "vz"],
        ),
    ] {
        let mut state = json!({ "roll": 0, "pitch": 0, "yaw": 0 });
        for name in first.into_iter().chain(then) {
            state[name] = json!(1);
        }
        for profile in ["flat", "flat-deg"] {
            let request = request(&[("--profile", profile)]);
            let source = source(&[twice("/state", state.clone())], &request);
            let velocity = source.role(Kind::Velocity).expect("a velocity");
            let read: Vec<String> = velocity.fields.iter().map(ToString::to_string).collect();
            assert_eq!(read, first, "{profile}");
        }
    }
}

/// PX4 1.16 marks positions as valid. The alternative for older logs, which have no marks, does not read them unmarked.
#[test]
fn what_is_marked_invalid_is_not_read_without_the_marks() {
    let profile = own(r#"
        name = "own"
        attitude = { topics = ["/a"], orientation.quaternion = "q", convention = "frd-ned" }
        velocity = [
            { topics = ["/v"], vector = "v", frame = "ned", valid = ["ok"] },
            { topics = ["/v"], vector = "v", frame = "ned" },
            { topics = ["/v"], vector = "w", frame = "ned", valid = ["ok"] },
        ]"#);
    let message = json!({ "v": [1, 2, 3], "w": [1, 2, 3], "ok": false });
    let topics = [attitude("/a"), twice("/v", message)];
    let source = source(&topics, &profile);
    assert_eq!(choice(&source, Kind::Velocity), ("/v", vec![]));
    let read = source.role(Kind::Velocity).expect("a velocity");
    assert_eq!(read.to_string(), "/v has v");
}

#[test]
fn alternatives_with_conditions_are_judged_together() {
    let profile = own(r#"
        name = "own"
        attitude = [
            { topics = ["/a"], when = { field = "mode", is = 1 }, orientation.quaternion = "q", convention = "frd-ned" },
            { topics = ["/a"], when = { field = "mode", is = 2 }, orientation.quaternion = "r", convention = "frd-ned" },
            { topics = ["/b"], orientation.quaternion = "q", convention = "frd-ned" },
        ]"#);
    let of_mode = |mode| json!({ "mode": mode, "q": [0, 0, 0, 0], "r": [1, 0, 0, 0] });
    // All are usable, but by the second alternative.
    let topics = [twice("/a", of_mode(2)), attitude("/b")];
    let found = source(&topics, &profile);
    assert_eq!(choice(&found, Kind::Attitude), ("/a", vec![]));
    let topics = [twice("/a", of_mode(1)), attitude("/b")];
    let found = source(&topics, &profile);
    let expected = vec![("/a", 2, 0, vec![("not_a_rotation", 2)])];
    assert_eq!(choice(&found, Kind::Attitude), ("/b", expected));
}

/// The first place is one topic with what several sources send.
#[test]
fn messages_of_other_sources_do_not_count() {
    let profile = own(r#"
        name = "own"
        attitude = [
            { orientation.quaternion = "/a{id==1}.q", convention = "frd-ned" },
            { orientation.quaternion = "/b.q", convention = "frd-ned" },
        ]"#);
    let of_id = |id| json!({ "id": id, "q": [1, 0, 0, 0] });
    let messages = |strays: usize| (0..500).map(move |n| of_id(if n < strays { 1 } else { 2 }));
    let chosen = |strays: usize| {
        let topics = [topic("/a", messages(strays)), times(1000, attitude("/b"))];
        let source = source(&topics, &profile);
        let (topic, passed_over) = choice(&source, Kind::Attitude);
        (topic.to_owned(), passed_over.len())
    };
    assert_eq!(chosen(0), ("/b".to_owned(), 1));
    assert_eq!(chosen(5), ("/b".to_owned(), 1));
    assert_eq!(chosen(250), ("/a".to_owned(), 0));
}
