//! How fast each stage of a run is, in samples or messages per second, and a whole run, for their shares in it.

#[path = "../tests/suite/support"]
mod support {
    pub mod logbook;
    pub mod ros;
    pub mod telemetry;
}

use std::{
    collections::BTreeMap,
    hint::black_box,
    io,
    path::{Path, PathBuf},
};

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use flightcam::{
    Options, Output,
    camera::Camera,
    derived::Derived,
    enrich::enrich,
    geometry::DepressionAngle,
    log::Log,
    messages::{Encoding, Format},
    sample::Sample,
    transform::{MaxGap, Transform},
    writer::{Appender, LogWriter},
};
use support::{
    logbook::request,
    telemetry::{InMemory, Kind, Language, write},
};

/// How many attitudes, and as many velocities, each log has.
const MOMENTS: u64 = 10_000;

/// Messages in memory → samples.
fn decode(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("decode");
    group.throughput(Throughput::Elements(2 * MOMENTS));
    for (kind, language) in logs() {
        let mut telemetry = InMemory::read(write(kind, language, MOMENTS), kind.profile());
        let (source, messages) = telemetry.parts();
        group.bench_function(BenchmarkId::new(kind.name(), language), |bencher| {
            bencher.iter(|| {
                for message in &messages {
                    source.read(message, |kind, sample| {
                        black_box((kind, sample.expect("a sample")));
                    });
                }
            });
        });
    }
    group.finish();
}

/// Samples → derived values.
fn transform(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("transform");
    group.throughput(Throughput::Elements(2 * MOMENTS));
    let samples = samples();
    group.bench_function("samples", |bencher| bencher.iter(|| derive(&samples)));
    group.finish();
}

/// Derived values → messages.
fn encode(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("encode");
    let derived = derive(&samples());
    group.throughput(Throughput::Elements(derived.len() as u64));
    for encoding in Encoding::ALL {
        let mut message = Vec::new();
        group.bench_function(encoding.name(), |bencher| {
            bencher.iter(|| {
                for derived in &derived {
                    message.clear();
                    encoding.encode(derived, &mut message);
                    black_box(&message);
                }
            });
        });
    }
    group.finish();
}

/// Derived values → chunks, with all that goes around them.
fn append(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("append");
    let derived = derive(&samples());
    group.throughput(Throughput::Elements(derived.len() as u64));
    let (_folder, input) = write(Kind::Px4, Language::Protobuf, MOMENTS).finish();
    let log = Log::open(&input).expect("a readable log");
    for encoding in Encoding::ALL {
        let format = Format {
            encoding,
            quality_of_service: String::new(),
            has_transforms: false,
        };
        group.bench_function(encoding.name(), |bencher| {
            bencher.iter(|| {
                let appender = Appender::begin(&log, io::sink(), PathBuf::new(), format.clone());
                let mut appender = Box::new(appender.expect("a writer"));
                for derived in &derived {
                    appender.write(derived.into()).expect("written");
                }
                appender.finish(BTreeMap::new()).expect("a result")
            });
        });
    }
    group.finish();
}

/// The samples of a log, in the order of their times.
fn samples() -> Vec<Sample> {
    let kind = Kind::Px4;
    let mut telemetry = InMemory::read(write(kind, Language::Protobuf, MOMENTS), kind.profile());
    let (source, messages) = telemetry.parts();
    let mut samples = Vec::new();
    for message in &messages {
        source.read(message, |_, sample| samples.push(sample.expect("a sample")));
    }
    samples.sort_by_key(|sample| (sample.stamp().log_time, sample.kind()));
    samples
}

fn depression() -> DepressionAngle {
    DepressionAngle::from_degrees(30.0).expect("30° is in range")
}

fn derive(samples: &[Sample]) -> Vec<Derived> {
    let camera = Camera::Stabilised {
        depression: depression(),
        yaw_offset: 0.0,
    };
    let mut transform = Transform::new(camera, MaxGap::default());
    let mut derived = Vec::new();
    for sample in samples {
        transform.push(*sample, &mut derived);
    }
    transform.finish(&mut derived);
    derived
}

/// A log's file → the result's file.
fn run(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("enrich");
    group.throughput(Throughput::Elements(2 * MOMENTS));
    group.sample_size(20);
    for (kind, language) in logs() {
        let (folder, input) = write(kind, language, MOMENTS).finish();
        let output = folder.path().join("result.mcap");
        let options = Options::new()
            .depression(depression())
            .telemetry(request(kind.profile()));
        group.bench_function(BenchmarkId::new(kind.name(), language), |bencher| {
            bencher.iter(|| {
                let report = enrich(&input, replacing(&output), &options).expect("a result");
                let used: u64 = report
                    .samples
                    .values()
                    .map(|samples| samples.tally.used)
                    .sum();
                assert_eq!(used, 2 * MOMENTS);
            });
        });
    }
    group.finish();
}

/// The output's file, whether it exists or not.
fn replacing(path: &Path) -> Output<'static> {
    Output::File {
        path: path.into(),
        overwrite: true,
    }
}

fn logs() -> impl Iterator<Item = (Kind, Language)> {
    let kinds = Kind::ALL.into_iter();
    kinds.flat_map(|kind| Language::ALL.map(|language| (kind, language)))
}

criterion_group!(benches, decode, transform, encode, append, run);
criterion_main!(benches);
