"""Checks that rerun loads what `flightcam enrich --visuals` wrote into an MCAP file.

    check.py FILE protobuf|ros2

rerun converts the file with the loader that its viewer uses. Every row that it makes of the topics that flightcam wrote
is compared with their messages, which the official Python libraries decode. The exit code is 1 if rerun warns of
anything, if a topic or a frame is missing, or if a row differs.

Of the types in such a file, rerun 0.41 draws these:

    foxglove.FrameTransforms     tf2_msgs/msg/TFMessage         as Transform3D
    foxglove.PoseInFrame         geometry_msgs/msg/PoseStamped  as InstancePoses3D
    foxglove.LocationFix         sensor_msgs/msg/NavSatFix      as GeoPoints
    foxglove.CameraCalibration   sensor_msgs/msg/CameraInfo     as Pinhole
    foxglove.Log                 rcl_interfaces/msg/Log         as TextLog

All others, such as scenes, markers and odometry, it keeps field by field but does not draw. Of those, only the times are
compared.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pyarrow
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory as ProtobufDecoderFactory
from mcap_ros2.decoder import DecoderFactory as Ros2DecoderFactory
from rerun.chunk import RrdReader

TOPICS_DRAWN = {
    "protobuf": ["/camera/transforms", "/camera/transforms_static"],
    "ros2": ["/tf", "/tf_static"],
    "both": ["/camera/pose", "/camera/location", "/camera/calibration"],
}
TOPICS_KEPT = [
    "/camera/relative_rpy",
    "/camera/orientation",
    "/camera/velocity",
    "/camera/odometry",
    "/camera/model",
    "/camera/scene",
    "/camera/path",
    "/camera/footprint",
    "/camera/state",
    "/camera/display",
]
FRAMES = ["map", "ned", "drone", "camera", "camera_optical"]


def single(*numbers):
    """As rerun keeps most numbers, in single precision."""
    return [float(np.float32(number)) for number in numbers]


def vector(value):
    return single(value.x, value.y, value.z)


def quaternion(value):
    return single(value.x, value.y, value.z, value.w)


def columns_of_matrix(rows):
    return single(*(rows[row * 3 + column] for column in range(3) for row in range(3)))


# For each type that rerun draws: the columns that it makes of a message, and the rows that it should.
TRANSFORM = [f"Transform3D:{name}" for name in ["parent_frame", "child_frame", "translation", "quaternion"]]
POSE = ["CoordinateFrame:frame", "InstancePoses3D:translations", "InstancePoses3D:quaternions"]
LOCATION = ["CoordinateFrame:frame", "GeoPoints:positions"]
LOG = ["TextLog:text"]
CALIBRATION = [f"Pinhole:{name}" for name in ["parent_frame", "resolution", "image_from_camera"]]
DRAWN = {
    "foxglove.FrameTransforms": (
        TRANSFORM,
        lambda message: [
            [it.parent_frame_id, it.child_frame_id, vector(it.translation), quaternion(it.rotation)]
            for it in message.transforms
        ],
    ),
    "tf2_msgs/msg/TFMessage": (
        TRANSFORM,
        lambda message: [
            [
                it.header.frame_id,
                it.child_frame_id,
                vector(it.transform.translation),
                quaternion(it.transform.rotation),
            ]
            for it in message.transforms
        ],
    ),
    "foxglove.PoseInFrame": (
        POSE,
        lambda it: [[it.frame_id, vector(it.pose.position), quaternion(it.pose.orientation)]],
    ),
    "geometry_msgs/msg/PoseStamped": (
        POSE,
        lambda it: [[it.header.frame_id, vector(it.pose.position), quaternion(it.pose.orientation)]],
    ),
    "foxglove.LocationFix": (
        LOCATION,
        lambda it: [[it.frame_id, [it.latitude, it.longitude]]],
    ),
    "sensor_msgs/msg/NavSatFix": (
        [*LOCATION, "altitude"],
        lambda it: [[it.header.frame_id, [it.latitude, it.longitude], it.altitude]],
    ),
    "foxglove.CameraCalibration": (
        CALIBRATION,
        lambda it: [[it.frame_id, single(it.width, it.height), columns_of_matrix(it.K)]],
    ),
    "sensor_msgs/msg/CameraInfo": (
        CALIBRATION,
        lambda it: [[it.header.frame_id, single(it.width, it.height), columns_of_matrix(it.k)]],
    ),
    "foxglove.Log": (
        LOG,
        lambda it: [[it.message]],
    ),
    "rcl_interfaces/msg/Log": (
        LOG,
        lambda it: [[f"[{it.name}] {it.msg}"]],
    ),
}


def kept(type_name):
    """The same for a type that rerun does not draw: that each message is there."""
    return [f"{type_name.replace('/', '.')}:message"], lambda message: [[True]]


def expected(path):
    """Of each topic that flightcam wrote, the columns and the rows: the log time, and a value for each column."""
    tables = {}
    with open(path, "rb") as f:
        reader = make_reader(f, decoder_factories=[ProtobufDecoderFactory(), Ros2DecoderFactory()])
        ours = [it.topic for it in reader.get_summary().channels.values() if "flightcam" in it.metadata]
        for schema, channel, record, message in reader.iter_decoded_messages(topics=ours):
            names, rows = DRAWN.get(schema.name) or kept(schema.name)
            _, table = tables.setdefault(channel.topic, (names, []))
            table += [[record.log_time, *row] for row in rows(message)]
    return tables


def convert(path, rrd):
    """Has rerun convert a file, and returns what it complains of. It skips bad messages, and exits with 0."""
    # Without these, it reports progress, in colour, and its use to its makers.
    environment = {**os.environ, "RUST_LOG": "warn", "NO_COLOR": "1", "CI": "true"}
    command = [sys.executable, "-m", "rerun_cli", "mcap", "convert", path, "-o", rrd, "--application-id", "flightcam"]
    run = subprocess.run(command, env=environment, capture_output=True, text=True)
    complaints = run.stderr.splitlines()
    return complaints if run.returncode == 0 else [*complaints, f"rerun exits with {run.returncode}"]


def column(batch, name):
    # A cell is a list, of one element in all that we write, or nothing.
    known = name in batch.schema.names
    cells = batch.column(name).to_pylist() if known else [None] * batch.num_rows
    return [bool(cell) if name.endswith(":message") else cell and cell[0] for cell in cells]


def rows_of(batch, names):
    times = batch.column("message_log_time").cast(pyarrow.int64()).to_pylist()
    return [list(row) for row in zip(times, *(column(batch, name) for name in names))]


def found(chunks, topic, names):
    """The rows that rerun made of a topic, in the order of their times."""
    rows = []
    for chunk in chunks:
        if chunk.entity_path == topic and not chunk.is_static:
            rows += rows_of(chunk.to_record_batch(), names)
    return sorted(rows, key=lambda row: row[0])


def difference(rows, wanted):
    if len(rows) != len(wanted):
        return f"has {len(rows)} rows, not {len(wanted)}"
    for row, want in zip(rows, wanted):
        if row != want:
            return f"has the row {row}, not {want}"
    return None


def chain(parents, frame):
    """A frame and all that it is in."""
    frames = []
    while frame is not None and frame not in frames:
        frames.insert(0, frame)
        frame = parents.get(frame)
    return frames


def check(path, encoding):
    tables = expected(path)
    drawn = TOPICS_DRAWN[encoding] + TOPICS_DRAWN["both"]
    problems = [f"{topic} is not in the file" for topic in drawn + TOPICS_KEPT if topic not in tables]
    with tempfile.TemporaryDirectory() as folder:
        rrd = Path(folder, "converted.rrd")
        problems += convert(path, rrd)
        chunks = RrdReader(rrd).stream().to_chunks()
    parents = {}
    for topic, (names, wanted) in tables.items():
        rows = found(chunks, topic, names)
        problem = difference(rows, wanted)
        if problem:
            problems.append(f"{topic} {problem}")
        elif topic in drawn and names[0].endswith(":message"):
            problems.append(f"{topic} is not drawn, but kept as {names[0]}")
        else:
            print(f"{topic}: {len(rows)} rows of {', '.join(names)}")
            if names == TRANSFORM:
                parents |= {child: parent for _, parent, child, *_ in rows}
    frames = chain(parents, FRAMES[-1])
    print(f"frames: {' > '.join(frames)}")
    if frames != FRAMES:
        problems.append(f"the frames are {' > '.join(frames)}, not {' > '.join(FRAMES)}")
    return problems


match sys.argv[1:]:
    case [path, ("protobuf" | "ros2") as encoding]:
        sys.exit("\n".join(check(path, encoding)) or 0)
    case _:
        sys.exit("usage: check.py FILE protobuf|ros2")
