//! Wherever a log comes from and its result goes, the result is the same; and values can be had without one.

use std::{
    fs::{self, File},
    io::Cursor,
    ops::ControlFlow,
};

use flightcam::{
    Error, Input, Output, Watch, derive,
    derived::{Derived, Quantity},
    enrich, inspect, restore,
    run::RunError,
};

use crate::support::{folder::*, layout::*, *};

fn flight() -> Vec<u8> {
    fs::read(repository("fixtures/survey_flight.mcap")).expect("the fixture")
}

/// The inputs that a log can be, by position and as a stream.
fn inputs(log: &[u8]) -> [Input<'_>; 2] {
    [
        Input::bytes("memory", log.to_vec()),
        Input::stream("stream", Cursor::new(log)),
    ]
}

#[test]
fn a_log_in_memory_gives_the_same_result_as_one_in_a_file() {
    for log in [flight(), mixed_log(), shapes::with_zeros_at_the_end()] {
        for options in [options(), interleaved()] {
            let (expected, _) = enrich_bytes_with(&log, &options).expect("a result");
            let folder = tempfile::tempdir().expect("a folder");
            let path = folder.path().join("result.mcap");
            let input = || Input::bytes("memory", log.clone());
            let report = enrich(input(), &path, &options).expect("a result");
            assert_eq!(report.input.to_str(), Some("memory"));
            assert!(fs::read(&path).expect("the result") == expected);

            let mut streamed = Vec::new();
            let output = Output::stream("stream", &mut streamed);
            enrich(input(), output, &options).expect("a result");
            assert!(streamed == expected);

            let file = File::create(&path).expect("a file");
            enrich(input(), Output::handle("open file", file), &options).expect("a result");
            assert!(fs::read(&path).expect("the result") == expected);
        }
    }
}

#[test]
fn an_enriched_log_in_memory_is_enriched_anew() {
    let (enriched, _) = enrich_bytes_with(&flight(), &options_at(60.0)).expect("a result");
    let (expected, _) = enrich_bytes(&flight()).expect("a result");
    let mut result = Vec::new();
    let output = Output::stream("stream", &mut result);
    enrich(Input::bytes("memory", enriched), output, &options()).expect("a result");
    assert!(result == expected);
}

#[test]
fn only_a_file_is_changed_in_place() {
    for input in inputs(&flight()) {
        let error = enrich(input, Output::InPlace, &options()).expect_err("it is refused");
        let refused = matches!(error, Error::Run(RunError::NotAFileInPlace));
        assert!(refused, "{error}");
    }
}

#[test]
fn an_original_is_restored_to_a_stream() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("result.mcap");
    let (enriched, _) = enrich_bytes(&flight()).expect("a result");
    fs::write(&path, enriched).expect("written");
    let mut original = Vec::new();
    let output = Output::stream("stream", &mut original);
    restore(&path, output, &Watch::default()).expect("the original");
    assert!(original == flight());
}

#[test]
fn values_are_derived_without_writing_a_log() {
    let log = flight();
    for input in inputs(&log) {
        let mut values: Vec<Derived> = Vec::new();
        let outcome = derive(input, &options(), |batch| {
            values.extend(batch);
            ControlFlow::Continue(())
        });
        let outcome = outcome.expect("a readable log").expect("its end");
        assert_eq!(
            outcome.tallies[flightcam::sample::Kind::Attitude].used,
            3310
        );
        let count = |quantity| {
            let of_quantity = values.iter().filter(|value| value.quantity() == quantity);
            of_quantity.count()
        };
        assert_eq!(count(Quantity::RelativeRpy), 3309);
        assert_eq!(count(Quantity::Orientation), 3310);
        assert_eq!(count(Quantity::CameraVelocity), 3310);
        assert!(values.is_sorted_by_key(|value| value.stamp.log_time));
    }
}

#[test]
fn whoever_takes_the_values_may_stop() {
    for input in inputs(&flight()) {
        let mut batches = 0;
        let outcome = derive(input, &options(), |_| {
            batches += 1;
            ControlFlow::Break(())
        });
        assert!(outcome.expect("a readable log").is_none());
        assert_eq!(batches, 1);
    }
}

#[test]
fn a_derivation_can_be_interrupted() {
    let watched = options().watch(|_| ControlFlow::Break(()));
    for input in inputs(&flight()) {
        let error = derive(input, &watched, |_| ControlFlow::Continue(())).expect_err("an error");
        let interrupted = matches!(error, Error::Run(RunError::Interrupted { .. }));
        assert!(interrupted, "{error}");
    }
}

#[test]
fn a_log_in_memory_is_inspected_and_restored_like_one_in_a_file() {
    let log = flight();
    let (enriched, _) = enrich_bytes(&log).expect("a result");
    let folder = Folder::with(LOG, &enriched);
    let in_file = inspect(folder.path(LOG), &options()).expect("a finding");
    let mut in_memory =
        inspect(Input::bytes("memory", enriched.clone()), &options()).expect("a finding");
    assert_eq!(in_memory.input.to_str(), Some("memory"));
    in_memory.input = folder.path(LOG);
    assert_eq!(in_memory, in_file);

    let mut original = Vec::new();
    let output = Output::stream("stream", &mut original);
    restore(
        Input::bytes("memory", enriched.clone()),
        output,
        &Watch::default(),
    )
    .expect("the original");
    assert!(original == log);

    let in_place = restore(
        Input::bytes("memory", enriched),
        Output::InPlace,
        &Watch::default(),
    );
    assert!(matches!(
        in_place,
        Err(Error::Run(RunError::NotAFileInPlace))
    ));
}
