"""Decodes the camera's messages of an MCAP file, and says what they say.

    decode.py FILE mcap       with mcap-protobuf-support, mcap-ros2-support, or json and the JSON Schema
    decode.py FILE rosbags    with rosbags, which reads files that are ROS 2 and nothing else

One line a message, in log time order: topic log_time stamp frame_id and the numbers, with as many digits as they
need. `stamp` is the time that the message itself says, in nanoseconds.
"""

import json
import sys
from pathlib import Path

QUATERNION = ["x", "y", "z", "w"]
NUMBERS = {
    "/camera/relative_rpy": ["roll", "pitch", "yaw"],
    "/camera/orientation": [*(f"quaternion.{name}" for name in QUATERNION), "roll", "pitch", "yaw"],
    "/camera/velocity": ["x", "y", "z"],
}
TOPICS = list(NUMBERS)


def nanoseconds(time):
    """Of a time as protobuf, ROS 2 or JSON say it."""
    if isinstance(time, dict):
        return time["sec"] * 10**9 + time["nsec"]
    if hasattr(time, "seconds"):
        return time.seconds * 10**9 + time.nanos
    return time.sec * 10**9 + time.nanosec


def field(message, path):
    """Of a message as protobuf or JSON say it."""
    for name in path.split("."):
        message = message[name] if isinstance(message, dict) else getattr(message, name)
    return message


def show(topic, log_time, stamp, frame_id, numbers):
    print(topic, log_time, nanoseconds(stamp), frame_id, *map(repr, numbers))


def show_ros2(topic, log_time, message):
    header = message.header
    if topic == "/camera/orientation":
        numbers = [getattr(message.quaternion, name) for name in QUATERNION]
    else:
        numbers = [message.vector.x, message.vector.y, message.vector.z]
    show(topic, log_time, header.stamp, header.frame_id, numbers)


def show_own(topic, log_time, message):
    """Of flightcam's own types."""
    numbers = [float(field(message, path)) for path in NUMBERS[topic]]
    show(topic, log_time, field(message, "timestamp"), field(message, "frame_id"), numbers)


def refuse_more(schema):
    """Makes a schema refuse fields that it does not have."""
    if schema["type"] == "object":
        schema["additionalProperties"] = False
        for part in schema["properties"].values():
            refuse_more(part)


class JsonDecoderFactory:
    """Refuses messages that are not as their schema says, and schemas that leave out a field."""

    def __init__(self):
        self.validators = {}

    def decoder_for(self, message_encoding, schema):
        if message_encoding != "json":
            return None
        if schema.id not in self.validators:
            import fastjsonschema

            definition = json.loads(schema.data)
            if definition["title"] != schema.name:
                raise ValueError(f"the schema of {schema.name} is titled {definition['title']}")
            refuse_more(definition)
            self.validators[schema.id] = fastjsonschema.compile(definition)
        return lambda data: self.validators[schema.id](json.loads(data))


def with_mcap(path):
    from mcap.reader import make_reader
    from mcap_protobuf.decoder import DecoderFactory as ProtobufDecoderFactory
    from mcap_ros2.decoder import DecoderFactory as Ros2DecoderFactory

    factories = [ProtobufDecoderFactory(), Ros2DecoderFactory(), JsonDecoderFactory()]
    with open(path, "rb") as f:
        reader = make_reader(f, validate_crcs=True, decoder_factories=factories)
        for _, channel, record, message in reader.iter_decoded_messages(topics=TOPICS):
            topic, time = channel.topic, record.log_time
            if channel.message_encoding == "cdr":
                show_ros2(topic, time, message)
            else:
                show_own(topic, time, message)


def with_rosbags(path):
    from rosbags.highlevel import AnyReader

    with AnyReader([Path(path)]) as reader:
        connections = [connection for connection in reader.connections if connection.topic in TOPICS]
        for connection, time, data in reader.messages(connections=connections):
            show_ros2(connection.topic, time, reader.deserialize(data, connection.msgtype))


match sys.argv[2:]:
    case ["mcap"]:
        with_mcap(sys.argv[1])
    case ["rosbags"]:
        with_rosbags(sys.argv[1])
    case _:
        sys.exit("usage: decode.py FILE mcap|rosbags")
