//! flightcam's tests, by the modules of `src/`.

mod support;

mod camera;
mod documentation;
mod geometry;
mod other_build;
mod profiles;
mod readers;
mod real_logs;
mod restore;

mod cli {
    mod camera_and_telemetry;
    mod completions_and_manual;
    mod enrich;
    mod help;
    mod inspect;
    mod profiles;
}

mod decode {
    mod allocations;
    mod list_paths;
    mod paths;
    mod ros;
    mod ros_random;
}

mod enrich {
    mod bad_input;
    mod disk_full;
    mod durability;
    mod in_place;
    mod input;
    mod kill;
}

mod inspect {
    mod containers;
    mod telemetry;
}

mod log {
    mod journal;
    mod message_times;
    mod stream;
}

mod messages {
    mod encoding;
}

mod reader {
    mod samples;
    mod time_order;
    mod uncompressed_chunks;
}

mod source {
    mod arguments;
    mod namespaces;
    mod pitfalls;
    mod profile_text;
    mod selection;
    mod stream_filter;
    mod written_profiles;
}

mod transform {
    mod attitude_and_velocity;
    mod gimbal;
    mod reference_model;
}

mod writer {
    mod append;
    mod interleave;
}
