//! Files that are easily taken for an MCAP.

/// What to do with a file that starts like this and not like an MCAP.
pub fn advice(start: &[u8]) -> &'static str {
    let formats: [(&[u8], &str); 4] = [
        (
            b"ULog",
            "it is a PX4 ULog; convert it first, for instance by opening it in Foxglove and exporting MCAP",
        ),
        (
            b"#ROSBAG",
            "it is a ROS 1 bag; convert it first with `mcap convert INPUT OUTPUT.mcap` (https://mcap.dev)",
        ),
        (
            b"SQLite ",
            "it is an SQLite database, perhaps a ROS 2 bag; convert it first with `ros2 bag convert`",
        ),
        (
            &[0xa3, 0x95],
            "it is an ArduPilot DataFlash log; convert it to MCAP first",
        ),
    ];
    let known = formats.iter().find(|(magic, _)| start.starts_with(magic));
    known.map_or(
        "it does not begin with the magic bytes of one; check that it is the log you meant",
        |(_, advice)| advice,
    )
}
