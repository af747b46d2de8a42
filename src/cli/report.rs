//! The report on an enriched log, as text.

use std::fmt::Write as _;

use flightcam::{Report, messages::Encoding, report::SampleReport, transform::Breaks};
use indicatif::HumanCount;

use super::plural;

/// The report in the order in which the data flows.
pub fn describe(report: &Report) -> String {
    let mut text = String::new();
    let mut line = |label: &str, content: &str| {
        let _ = writeln!(text, "{label:<12}{content}");
    };
    line("Log", &report.input.display().to_string());
    line(
        "Profile",
        &format!("{}, {}", report.profile.name, report.profile.reason),
    );
    line("Camera", &report.camera.to_string());
    describe_samples(&mut line, "Attitude", &report.attitude);
    let Breaks { gaps, resets } = report.breaks;
    if gaps > 0 {
        let gaps = plural(gaps, "gap");
        let max_gap = report.max_gap_s;
        line(
            "",
            &format!("no rotation across {gaps} longer than {max_gap} s"),
        );
    }
    if resets > 0 {
        let resets = plural(resets, "reset");
        line(
            "",
            &format!("no rotation across {resets} of the attitude estimator"),
        );
    }
    describe_samples(&mut line, "Velocity", &report.velocity);
    if let Some(gimbal) = &report.gimbal {
        describe_samples(&mut line, "Gimbal", gimbal);
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
        line("Note", note);
    }
    line("Result", &report.output.display().to_string());
    let paths: Vec<String> = (report.written.iter())
        .map(|topic| {
            format!(
                "{}{}",
                topic.topic,
                telling_field(topic.topic, report.encoding.name)
            )
        })
        .collect();
    let _ = write!(
        text,
        "\nTo look at it, open the result in Foxglove (https://foxglove.dev), add a Plot panel, and plot {}.",
        paths.join(" and ")
    );
    text
}

/// The field of a topic's messages that shows most at a glance, as Foxglove writes its path.
fn telling_field(topic: &str, encoding: Encoding) -> &'static str {
    let is_velocity = topic == "/camera/velocity";
    match (is_velocity, encoding) {
        (false, Encoding::Protobuf | Encoding::Json) => ".yaw",
        (false, Encoding::Ros2) => ".vector.z",
        (true, Encoding::Protobuf | Encoding::Json) => ".x",
        (true, Encoding::Ros2) => ".vector.x",
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
        line(
            "",
            &format!("{} dropped: {}", HumanCount(*count), reason.describe()),
        );
    }
}
