//! The report on an enriched log, as text.

use flightcam::{
    Report,
    report::{FieldOfViewReport, GroundBecause, GroundReport, SampleReport, VisualsReport},
    sample::Kind,
    text,
    transform::{Breaks, Motion, Sighting},
};
use indicatif::HumanCount;

use super::{
    print::Page,
    words::{self, plural},
};

/// Describes a report in the order in which the data flows.
pub fn describe(report: &Report) -> Page {
    let mut page = Page::default();
    page.line("Log", text::path(&report.input));
    page.line("Profile", words::profile(&report.profile));
    page.line("Camera", words::camera(&report.camera, &report.profile));
    for kind in Kind::LISTED {
        if let Some(samples) = report.samples.get(&kind) {
            describe_samples(&mut page, &words::label(kind), samples);
        }
        if kind == Kind::Attitude {
            describe_breaks(&mut page, report.breaks, report.max_gap_s);
            describe_motion(&mut page, &report.motion);
        }
    }
    if let Some(visuals) = &report.visuals {
        describe_visuals(&mut page, visuals);
    }
    for topic in &report.written {
        let messages = plural(topic.messages, "message");
        page.line("Written", format!("{}: {messages}", topic.topic));
    }
    for topic in &report.not_written {
        page.line("Not written", words::missing(topic));
    }
    page.line("Bytes", describe_bytes(report));
    for note in &report.notes {
        page.line("Note", words::note(note));
    }
    page.line("Result", text::path(&report.output));
    page.paragraph(&match report.visuals {
        None => how_to_plot(report),
        Some(_) => how_to_look(),
    });
    page
}

fn how_to_plot(report: &Report) -> String {
    let to_plot: Vec<String> = (report.written.iter())
        .filter_map(|topic| Some(format!("{}.{}", topic.topic, topic.field_to_plot?)))
        .collect();
    format!(
        "To look at it, open the result in Foxglove (https://foxglove.dev), add a Plot panel, and plot {}.",
        words::list(&to_plot)
    )
}

fn how_to_look() -> String {
    "To look at it, open the result in Foxglove (https://foxglove.dev) or Lichtblick \
     (https://github.com/lichtblick-suite/lichtblick), and import the layout there that `flightcam layout` writes for it."
        .to_owned()
}

fn describe_field_of_view(seen: &FieldOfViewReport) -> String {
    let [wide, high] = seen.degrees;
    let why = match (&seen.calibration, seen.others) {
        (None, _) if seen.by_profile => ", as the profile says".to_owned(),
        (None, _) => ", as asked for".to_owned(),
        (Some(topic), 0) => format!(", as {topic} says, without its distortion"),
        (Some(topic), others) => {
            let others = plural(others as u64, "other calibration");
            format!(", as {topic} says, without its distortion; the log has {others} that differ")
        }
    };
    format!("field of view {wide:.1}° by {high:.1}°{why}")
}

/// Says what viewers are shown, and what was taken for granted.
fn describe_visuals(page: &mut Page, visuals: &VisualsReport) {
    let VisualsReport {
        transforms_hz,
        scenes_hz,
        ground,
        field_of_view,
        ..
    } = visuals;
    page.line(
        "Visuals",
        format!("{transforms_hz} transforms and {scenes_hz} scenes a second"),
    );
    page.line(
        "",
        match field_of_view {
            Some(seen) => describe_field_of_view(seen),
            None => "field of view not known; --hfov and --vfov say it".to_owned(),
        },
    );
    if let Some(ground) = ground {
        page.line("", describe_ground(ground));
    }
}

fn describe_ground(ground: &GroundReport) -> String {
    let why = match &ground.because {
        GroundBecause::Measured {
            topic,
            samples,
            lowest_m,
            highest_m,
            share,
        } => {
            let heights = plural(*samples, "height");
            let rest = match (100.0 * (1.0 - share)).round() {
                0.0 => String::new(),
                rest => format!("; where there are none ({rest} % of the flight), as it was last"),
            };
            return format!(
                "ground from {lowest_m:.1} to {highest_m:.1} m by {heights} of {topic}{rest}"
            );
        }
        GroundBecause::Given => "as asked for",
        GroundBecause::TakeOff => "that of the take-off, as asked for",
        _ => "that of the take-off, which is assumed; --ground says otherwise",
    };
    format!("level ground at {:.1} m, {why}", ground.altitude_m)
}

fn describe_bytes(report: &Report) -> String {
    let kept = HumanCount(report.bytes_kept);
    let grown_by = HumanCount(report.bytes_added.unsigned_abs());
    match report.bytes_added {
        ..0 => format!(
            "{kept} unchanged, and {grown_by} less than the log had with its earlier result"
        ),
        0.. => format!("{kept} unchanged, {grown_by} added"),
    }
}

fn describe_breaks(page: &mut Page, breaks: Breaks, max_gap_s: f64) {
    let Breaks {
        gaps,
        resets,
        clock_steps,
    } = breaks;
    if gaps > 0 {
        let gaps = plural(gaps, "gap");
        page.line(
            "",
            format!("no rotation across {gaps} longer than {max_gap_s} s"),
        );
    }
    if resets > 0 {
        let resets = plural(resets, "reset");
        page.line(
            "",
            format!("no rotation across {resets} of the attitude estimator"),
        );
    }
    if clock_steps > 0 {
        let steps = plural(clock_steps, "step");
        page.line("", format!("no rotation across {steps} back in time"));
    }
}

/// Says which motion is none of a drone.
fn describe_motion(page: &mut Page, motion: &Motion) {
    let degrees = f64::to_degrees;
    let mut line =
        |seen: Option<Sighting>, thing: &str, of: &str, largest: &dyn Fn(f64) -> String| {
            if let Some(seen) = seen {
                let (count, largest) = (plural(seen.count, thing), largest(seen.largest));
                let first = seen.first as f64 / 1e9;
                let text =
                    format!("{count} {of}, the first at {first:.3} s in log time; {largest}");
                page.line("", text);
            }
        };
    line(
        motion.bursts,
        "rotation",
        "within less than a millisecond",
        &|turn| {
            let turn = degrees(turn);
            format!("the largest is {turn:.2}°; --min-interval leaves such out")
        },
    );
    line(
        motion.flips,
        "turn",
        "of the camera that the drone does not make",
        &|turn| {
            let turn = degrees(turn);
            format!("the largest is {turn:.0}°: its nose passes the vertical")
        },
    );
    line(motion.spins, "turn", "faster than 2,000 °/s", &|rate| {
        format!("the fastest is {:.0} °/s", degrees(rate))
    });
    line(
        motion.leaps,
        "change",
        "of the velocity faster than 100 m/s²",
        &|acceleration| format!("the fastest is {acceleration:.0} m/s²"),
    );
}

fn describe_samples(page: &mut Page, label: &str, samples: &SampleReport) {
    let source = match (&samples.topic, samples.derived_from) {
        (_, Some(kind)) => format!("from the {}", kind.name()),
        (Some(topic), None) => topic.to_string(),
        (None, None) => return,
    };
    let (used, total) = (samples.tally.used, samples.tally.total());
    page.line(
        label,
        format!(
            "{source}: {} of {} samples used",
            HumanCount(used),
            HumanCount(total)
        ),
    );
    for read_as in &samples.read_as {
        page.line("", words::read_as(read_as));
    }
    for refused in &samples.refused_frames {
        page.line("", words::refused_frames(refused));
    }
    for (reason, count) in &samples.tally.dropped {
        page.line("", format!("{} dropped: {reason}", HumanCount(*count)));
    }
    if samples.tally.unselected > 0 {
        let messages = plural(samples.tally.unselected, "message");
        page.line("", format!("{messages} of another source left out"));
    }
}
