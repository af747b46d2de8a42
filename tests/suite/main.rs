//! flightcam's tests, by the modules of `src/`.

mod support;

mod camera;
// Logs of people who were given wrong numbers.
mod cases;
// README and docs/, against the program.
mod documentation;
// Orientation, relative rotation and interpolation, against reference vectors.
mod geometry;
// Another build of flightcam: ignored unless asked for.
mod other_build;
mod profiles;
// Other programs read the results.
mod readers;
// Real flights, against an independent implementation.
mod real_logs;
mod restore;
// Text from elsewhere, as it is shown.
mod text;

mod check {
    // Each publisher's logs, read with one convention broken.
    mod conventions;
    // What a gimbal's angles are measured from.
    mod gimbal;
    // Flights with manoeuvres, read rightly and wrongly.
    mod readings;
    // What is kept of a long flight.
    mod recorder;
    // What a series shows by itself.
    mod series;
    // Clocks that differ.
    mod times;
}

mod cli {
    mod camera_and_telemetry;
    mod check;
    mod completions_and_manual;
    mod enrich;
    // What strangers name things reaches no terminal.
    mod escapes;
    // Files that are not MCAP.
    mod foreign_files;
    mod help;
    mod inspect;
    mod layout;
    mod own_profiles;
    mod profiles;
    // What viewers have trouble with, in words.
    mod viewers;
    mod visuals;
}

mod clock {
    mod series;
}

mod decode {
    // Reading a field allocates nothing.
    mod allocations;
    // The first element of a list that satisfies filters.
    mod filtered_lists;
    // Bare NaN and Infinity.
    mod json_non_finite;
    mod list_paths;
    mod paths;
    mod ros;
    mod ros_random;
    // What is wrong with a message that cannot be decoded.
    mod undecodable;
}

mod enrich {
    // Logs that are not as they should be.
    mod bad_input;
    // Logs that another program writes to.
    mod changed_log;
    // Clocks that were set back.
    mod clock_steps;
    // Logs whose own numbers show that they were read wrongly.
    mod contradicted;
    mod disk_full;
    // The ground by heights above it.
    mod ground;
    // What reaches the disk before what.
    mod durability;
    mod in_place;
    mod input;
    // Runs that are killed.
    mod kill;
    // Numbers of any size.
    mod numbers;
    mod orientation;
    mod velocity_from_position;
    // What viewers are shown.
    mod visuals;
}

mod inspect {
    mod containers;
    mod telemetry;
    // What viewers have trouble with.
    mod viewers;
}

mod layout {
    // Those in the repository.
    mod committed;
    // What each kind of flight gets.
    mod fitting;
    // Logs that do not say how they were made.
    mod lost;
    // Pictures, flight modes.
    mod own_topics;
}

mod log {
    // Data after what is said to be its end.
    mod early_end;
    // Log times that go back.
    mod goes_back;
    // Lengths that lie.
    mod lengths;
    // Long records and lengths that lie, where there is little memory.
    #[cfg(unix)]
    mod little_memory;
    // Chunk indexes that lie.
    mod lying_index;
    // Log times from indexes.
    mod message_times;
    // Logs from a pipe.
    mod stream;
    // Bytes after the closing magic.
    mod surplus;
}

mod messages {
    mod camera_orientation;
    mod encoding;
    // What viewers are shown, in types that they know.
    mod visuals;
}

mod reader {
    mod epochs;
    mod samples;
    mod time_order;
    // Only the telemetry of uncompressed chunks is read.
    mod uncompressed_chunks;
}

mod source {
    mod arguments;
    // Which of several places is read.
    mod choosing;
    // What messages say about their axes.
    mod frames;
    // Each type that says something about them.
    mod frame_rules;
    // Messages in several forms, and of several types on one topic.
    mod forms;
    // JSON fields that are null at first.
    mod json_null;
    // `when` and `valid`.
    mod conditions;
    // What an error says that the log has instead.
    mod instead;
    mod namespaces;
    // One role is given, the rest is the profile's.
    mod overrides;
    // What flightcam wrote is no telemetry.
    mod own_channels;
    // What would silently yield wrong numbers.
    mod pitfalls;
    mod profile_toml;
    mod selection;
    mod several_sources;
    // Several sources on one topic, and names in quotes.
    mod selectors;
    mod shared_schemas;
    // Which messages of a streamed log are kept.
    mod stream_filter;
    // The text of a profile in an enriched log.
    mod written_profiles;
}

mod transform {
    mod attitude_and_velocity;
    mod from_positions;
    mod gimbal;
    // What no drone does.
    mod motion;
    // Against a model that sees all samples at once.
    mod reference_model;
}

mod writer {
    mod append;
    mod destination;
    mod interleave;
    // Recovery after an interrupted change.
    mod journal;
    // Logs that claim what was not written by flightcam as its own.
    mod original;
}

mod visuals {
    // What all pictures cover.
    mod coverage;
    // Where something is not known.
    mod gaps;
    // Places on the globe.
    mod places;
    // What viewers are shown is where the camera was, looked and went.
    mod geometry;
    // The ground by the log's heights.
    mod ground;
}
