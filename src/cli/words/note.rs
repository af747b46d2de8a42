//! Notes in words, with what the user can do about them.

use flightcam::{
    ClockStep,
    report::{CameraReport, Note},
    text,
    writer::Layout,
};
use indicatif::HumanCount;

use super::{other_unit, plural};

pub fn note(note: &Note) -> String {
    on_the_log(note)
        .or_else(|| on_the_samples(note))
        .or_else(|| on_ros2(note))
        .unwrap_or_else(|| format!("{note:?}"))
}

fn on_the_log(note: &Note) -> Option<String> {
    Some(match note {
        Note::Recovered => "an earlier run was interrupted while it changed the log; the log was restored first"
            .to_owned(),
        Note::Replaced { earlier } => {
            format!("the log was already enriched ({earlier}); this result replaces that one")
        }
        Note::OriginalInspected { earlier } => format!(
            "the log is already enriched ({earlier}); everything here describes its original"
        ),
        Note::CannotBeUndone => {
            "`flightcam restore` cannot undo the interleaved layout".to_owned()
        }
        Note::NeverClosed => {
            "the log was never closed; all of its records were used, and the result is closed".to_owned()
        }
        Note::BreaksOff { offset, lost_bytes } => format!(
            "the log breaks off at byte {offset}; the {lost_bytes} bytes from there on are not readable"
        ),
        Note::Grew { added_bytes } => format!(
            "another program is still writing the log: it grew by {} while it was read; everything here is about what \
             was there at the start",
            plural(*added_bytes, "byte")
        ),
        Note::NotClosedButWhole => {
            "the log does not end like a closed log, but its data is whole; the result is closed".to_owned()
        }
        Note::SummaryMissing => "the log had no readable summary; the result has one".to_owned(),
        Note::SummaryIncomplete => {
            "the log's summary was incomplete or wrong; the result's is complete".to_owned()
        }
        Note::LooseMessages {
            layout: Layout::Append,
        } => "the log has messages outside chunks, which a chunk index would hide; the result has no chunk index, so \
              seeking in it takes longer"
            .to_owned(),
        Note::LooseMessages {
            layout: Layout::Interleaved,
        } => "the log has messages outside chunks; in the result they are in chunks".to_owned(),
        Note::ChecksumWrong => {
            "the log's data does not match its checksum; the result has no checksum".to_owned()
        }
        _ => return None,
    })
}

fn on_the_samples(note: &Note) -> Option<String> {
    Some(match note {
        Note::Undecodable { samples, first } => {
            let samples = plural(*samples, "sample");
            let first = match first {
                Some(message) => format!("; the first is in {message}"),
                None => String::new(),
            };
            format!("{samples} could not be decoded as the log's schemas say{first}")
        }
        Note::GimbalIgnored {
            topic,
            camera,
            by_profile,
        } => {
            let (flag, is) = match camera {
                CameraReport::Fixed { .. } => ("--mount", "bolted to the airframe"),
                _ => ("--depression", "held at that angle"),
            };
            let but = match by_profile {
                true => "the profile says how the camera is mounted".to_owned(),
                false => format!("{flag} was given"),
            };
            format!(
                "the log has the gimbal's angles on {topic}, but {but} and takes precedence: the camera is {is}"
            )
        }
        Note::ClockSteps { steps } => clock_steps(steps),
        Note::TimesOutsideLog => "the samples have times before the log's first message or after its last, so a \
                                  player shows the new topics apart from the others; --time says what the time of a \
                                  sample is"
            .to_owned(),
        Note::UnmetConditions {
            sample,
            topic,
            samples,
            conditions,
        } => format!(
            "{} of {topic} {} left out: {}",
            plural(*samples, &format!("{} sample", sample.name())),
            if *samples == 1 { "was" } else { "were" },
            text::join(conditions, "; ")
        ),
        Note::OnItsSide { share } => format!(
            "the drone leans by more than 60° in {:.0} % of the attitude samples, as a tailsitter does; or it is the \
             attitude of another thing, as of a sensor",
            share * 100.0
        ),
        Note::GimbalUp { share } => format!(
            "the gimbal points up in {:.0} % of its samples, as under a bridge; or its angles are positive downwards",
            share * 100.0
        ),
        Note::SuspiciousAngle { topic, angle, unit, .. } if *angle >= 1e9 => format!(
            "{topic} has an angle of {angle:e}, read as {} like all of its angles, which no drone turns by",
            unit.name()
        ),
        Note::SuspiciousAngle {
            sample,
            topic,
            angle,
            unit,
            asked,
        } => format!(
            "{topic} has an angle of {angle:.1}, read as {} like all of its angles; {}",
            unit.name(),
            other_unit(*sample, *unit, asked)
        ),
        Note::PassedOver(passed_over) => super::passed_over(passed_over),
        _ => return None,
    })
}

/// The first of them; there may be thousands.
fn clock_steps(steps: &[ClockStep]) -> String {
    const NAMED: usize = 3;
    let seconds = |time: u64| format!("{}.{:03} s", time / 1_000_000_000, time / 1_000_000 % 1000);
    let named = steps.iter().take(NAMED).map(|step| {
        format!(
            "by {:.3} s on {} at its message {} (from {} to {})",
            step.seconds(),
            step.topic,
            HumanCount(step.message),
            seconds(step.before),
            seconds(step.after)
        )
    });
    let named = text::join(named, ", ");
    let more = match steps.len().saturating_sub(NAMED) {
        0 => String::new(),
        more => format!(", and {more} more times"),
    };
    format!(
        "time goes back {named}{more}, as where a clock was set or a recorder was restarted; what comes after is \
         processed by itself"
    )
}

fn on_ros2(note: &Note) -> Option<String> {
    Some(match note {
        Note::NewChannelsNotRos2 => {
            "ROS 2 tools such as rosbags refuse a file in which a channel is not ROS 2, as \
                                     the new ones now are not; use --encoding ros2"
                .to_owned()
        }
        Note::ChannelNotRos2 {
            topic,
            message_encoding,
        } => format!(
            "ROS 2 tools such as rosbags refuse a file in which a channel is not ROS 2, as {topic} of the log \
             ({message_encoding}) is not"
        ),
        Note::Ros2StampOverflow => {
            "the log goes on after 2038-01-19T03:14:07Z, when ROS 2 stamps overflow: later \
                                    stamps are clamped, but log times are right"
                .to_owned()
        }
        Note::BagMetadataOutdated { path } => format!(
            "{} does not list the result with its new topics; to use the result as a ROS 2 bag, put it into a \
             folder of its own under a name that ends in _0.mcap, and run `ros2 bag reindex -s mcap FOLDER`",
            text::path(path)
        ),
        _ => return None,
    })
}
