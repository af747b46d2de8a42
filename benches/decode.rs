//! How fast telemetry is decoded, in samples per second, and how long a whole run takes, for its share in that.

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;

use common::{
    logbook::request,
    options,
    telemetry::{InMemory, Kind, Language, write},
};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use flightcam::{Options, enrich::enrich, unwatched};

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

/// A log's file → the result's file.
fn run(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("enrich");
    group.throughput(Throughput::Elements(2 * MOMENTS));
    group.sample_size(20);
    for (kind, language) in logs() {
        let (folder, input) = write(kind, language, MOMENTS).finish();
        let output = folder.path().join("result.mcap");
        let options = Options {
            telemetry: request(kind.profile()),
            overwrite: true,
            ..options()
        };
        group.bench_function(BenchmarkId::new(kind.name(), language), |bencher| {
            bencher.iter(|| {
                let report = enrich(&input, &output, &options, &mut unwatched).expect("a result");
                let used = report.attitude.tally.used + report.velocity.tally.used;
                assert_eq!(used, 2 * MOMENTS);
            });
        });
    }
    group.finish();
}

fn logs() -> impl Iterator<Item = (Kind, Language)> {
    let kinds = Kind::ALL.into_iter();
    kinds.flat_map(|kind| Language::ALL.map(|language| (kind, language)))
}

criterion_group!(benches, decode, run);
criterion_main!(benches);
