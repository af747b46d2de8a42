"""The same job in Python: rewrites a log with the camera's motion, using the official libraries and numpy.

    baseline.py INPUT OUTPUT DEPRESSION

PYTHONPATH must have what protoc generates from flightcam's proto/. Attachments and metadata are not copied: the
benchmark's logs have none.
"""

import sys

import numpy as np
from flightcam.v1.camera_orientation_pb2 import CameraOrientation
from flightcam.v1.camera_velocity_pb2 import CameraVelocity
from flightcam.v1.relative_rpy_pb2 import RelativeRpy
from google.protobuf.duration_pb2 import Duration
from google.protobuf.timestamp_pb2 import Timestamp
from mcap.reader import make_reader
from mcap.writer import Writer
from mcap_protobuf.decoder import DecoderFactory
from mcap_protobuf.schema import register_schema

STATE = "/drone/state"
FIELDS = ["roll", "pitch", "yaw", "vx", "vy", "vz"]
BLOCK = 4096  # samples: numpy is slow on single ones, and all those of a long flight do not fit into memory


def camera_axes(pitch, yaw, depression):
    """R_ned_camera: the nose projected onto the ground and tilted down, the image's right, the image's down."""
    north, east = np.cos(pitch) * np.cos(yaw), np.cos(pitch) * np.sin(yaw)
    ground = np.hypot(north, east)
    ahead = np.stack([north, east, ground * np.tan(depression)], axis=-1)
    ahead /= np.linalg.norm(ahead, axis=-1, keepdims=True)
    right = np.stack([-east / ground, north / ground, np.zeros_like(ground)], axis=-1)
    return np.stack([ahead, right, np.cross(ahead, right)], axis=-1)


def roll_pitch_yaw(r):
    roll = np.arctan2(r[:, 2, 1], r[:, 2, 2])
    pitch = np.arctan2(-r[:, 2, 0], np.hypot(r[:, 2, 1], r[:, 2, 2]))
    yaw = np.arctan2(r[:, 1, 0], r[:, 0, 0])
    return np.stack([roll, pitch, yaw], axis=-1)


def quaternions(angles):
    """x, y, z, w of rotations as roll, pitch, yaw; of the two that are the same, the one with w >= 0."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(angles / 2).T, np.sin(angles / 2).T
    x, y = sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy
    z, w = cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy
    return np.where(w < 0, -1, 1)[:, None] * np.stack([x, y, z, w], axis=-1)


class Derived:
    """Collects samples, and writes what is derived from them a block at a time."""

    def __init__(self, writer, depression):
        self.writer, self.depression = writer, depression
        self.rpy_channel = self.register("/camera/relative_rpy", RelativeRpy)
        self.orientation_channel = self.register("/camera/orientation", CameraOrientation)
        self.velocity_channel = self.register("/camera/velocity", CameraVelocity)
        self.times, self.states = [], []
        self.last_time, self.last_camera = None, None
        self.sequence = 0

    def register(self, topic, message):
        return self.writer.register_channel(topic, "protobuf", register_schema(self.writer, message))

    def add(self, message, state):
        self.times.append((message.log_time, message.publish_time))
        self.states.append([getattr(state, name) for name in FIELDS])
        if len(self.times) == BLOCK:
            self.flush()

    def flush(self):
        if not self.times:
            return
        states = np.array(self.states)
        cameras = camera_axes(states[:, 1], states[:, 2], self.depression)
        velocities = np.einsum("nji,nj->ni", cameras, states[:, 3:])
        first = cameras[:1] if self.last_camera is None else self.last_camera
        previous = np.concatenate([first, cameras[:-1]])
        rotations = roll_pitch_yaw(previous.transpose(0, 2, 1) @ cameras)
        angles = roll_pitch_yaw(cameras)
        orientations = np.concatenate([quaternions(angles), angles], axis=1)
        derived = (rotations.tolist(), orientations.tolist(), velocities.tolist())
        for times, rotation, orientation, velocity in zip(self.times, *derived):
            if self.last_time is not None:
                self.write_rotation(times, *rotation)
            self.write_orientation(times, *orientation)
            self.write_velocity(times, *velocity)
            self.last_time = times[0]
            self.sequence += 1
        self.last_camera = cameras[-1:]
        self.times, self.states = [], []

    def write_rotation(self, times, roll, pitch, yaw):
        timestamp, interval = Timestamp(), Duration()
        timestamp.FromNanoseconds(times[0])
        interval.FromNanoseconds(times[0] - self.last_time)
        message = RelativeRpy(
            timestamp=timestamp, frame_id="previous_camera", interval=interval, roll=roll, pitch=pitch, yaw=yaw
        )
        # One less than the others': the first sample has no rotation.
        self.write(self.rpy_channel, times, message, self.sequence - 1)

    def write_orientation(self, times, x, y, z, w, roll, pitch, yaw):
        timestamp = Timestamp()
        timestamp.FromNanoseconds(times[0])
        quaternion = CameraOrientation.Quaternion(x=x, y=y, z=z, w=w)
        message = CameraOrientation(
            timestamp=timestamp, frame_id="ned", quaternion=quaternion, roll=roll, pitch=pitch, yaw=yaw
        )
        self.write(self.orientation_channel, times, message, self.sequence)

    def write_velocity(self, times, x, y, z):
        timestamp = Timestamp()
        timestamp.FromNanoseconds(times[0])
        message = CameraVelocity(timestamp=timestamp, frame_id="camera", x=x, y=y, z=z)
        self.write(self.velocity_channel, times, message, self.sequence)

    def write(self, channel, times, message, sequence):
        self.writer.add_message(channel, times[0], message.SerializeToString(), times[1], sequence)


def main(source, target, depression):
    with open(source, "rb") as log, open(target, "wb") as output:
        writer = Writer(output)
        writer.start()
        derived = Derived(writer, np.radians(float(depression)))
        schemas, channels, decode = {}, {}, None
        # In time order, which the job needs: the chunks of a log may overlap.
        for schema, channel, message in make_reader(log).iter_messages():
            if channel.id not in channels:
                if schema.id not in schemas:
                    schemas[schema.id] = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.id] = writer.register_channel(
                    channel.topic, channel.message_encoding, schemas[schema.id], channel.metadata
                )
            writer.add_message(
                channels[channel.id], message.log_time, message.data, message.publish_time, message.sequence
            )
            if channel.topic == STATE:
                decode = decode or DecoderFactory().decoder_for(channel.message_encoding, schema)
                derived.add(message, decode(message.data))
        derived.flush()
        writer.finish()


main(*sys.argv[1:])
