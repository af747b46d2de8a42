//! The report on an enriched log, as text.

use std::fmt::Write as _;

use flightcam::{Report, report::SampleReport, sample::Kind, transform::Breaks};
use indicatif::HumanCount;

use super::words::{self, plural};

/// Describes a report in the order in which the data flows.
pub fn describe(report: &Report) -> String {
    let mut text = String::new();
    let mut line = |label: &str, content: &str| {
        let _ = writeln!(text, "{label:<12}{content}");
    };
    line("Log", &report.input.display().to_string());
    line("Profile", &words::profile(&report.profile));
    line("Camera", &words::camera(&report.camera));
    for kind in Kind::LISTED {
        if let Some(samples) = report.samples.get(&kind) {
            describe_samples(&mut line, &words::label(kind), samples);
        }
        if kind == Kind::Attitude {
            describe_breaks(&mut line, report.breaks, report.max_gap_s);
        }
    }
    for topic in &report.written {
        let messages = plural(topic.messages, "message");
        line("Written", &format!("{}: {messages}", topic.topic));
    }
    for topic in &report.not_written {
        line("Not written", &format!("{}: {}", topic.topic, topic.reason));
    }
    line(
        "Bytes",
        &format!(
            "{} unchanged, {} added",
            HumanCount(report.bytes_kept),
            HumanCount(report.bytes_added)
        ),
    );
    for note in &report.notes {
        line("Note", &words::note(note));
    }
    line("Result", &report.output.display().to_string());
    let to_plot: Vec<String> = (report.written.iter())
        .map(|topic| format!("{}.{}", topic.topic, topic.field_to_plot))
        .collect();
    let _ = write!(
        text,
        "\nTo look at it, open the result in Foxglove (https://foxglove.dev), add a Plot panel, and plot {}.",
        to_plot.join(" and ")
    );
    text
}

fn describe_breaks(line: &mut impl FnMut(&str, &str), breaks: Breaks, max_gap_s: f64) {
    let Breaks { gaps, resets } = breaks;
    if gaps > 0 {
        let gaps = plural(gaps, "gap");
        line(
            "",
            &format!("no rotation across {gaps} longer than {max_gap_s} s"),
        );
    }
    if resets > 0 {
        let resets = plural(resets, "reset");
        line(
            "",
            &format!("no rotation across {resets} of the attitude estimator"),
        );
    }
}

fn describe_samples(line: &mut impl FnMut(&str, &str), label: &str, samples: &SampleReport) {
    let Some(topic) = &samples.topic else {
        return;
    };
    let (used, total) = (samples.tally.used, samples.tally.total());
    line(
        label,
        &format!(
            "{topic}: {} of {} samples used",
            HumanCount(used),
            HumanCount(total)
        ),
    );
    for (reason, count) in &samples.tally.dropped {
        line("", &format!("{} dropped: {reason}", HumanCount(*count)));
    }
}
