"""Shows every message of an MCAP file, whatever its type.

    show.py FILE mcap       with mcap-protobuf-support, mcap-ros2-support, or json and the JSON Schema
    show.py FILE rosbags    with rosbags, which reads files that are ROS 2 and nothing else

One line a message: JSON with its topic and its fields, which are those of protobuf's JSON mapping or of the
definition; NaN is null. With rosbags also the durability that the topic's publisher offered, if it is known.
"""

import json
import math
import sys
from dataclasses import fields, is_dataclass
from pathlib import Path


def plain(value):
    """A ROS message of either library, or a field of one, as what JSON knows."""
    if isinstance(value, float):
        return None if math.isnan(value) else value
    if isinstance(value, (bool, int, str)):
        return value
    if isinstance(value, bytes):
        return list(value)
    if hasattr(value, "tolist"):  # numpy's arrays and numbers
        return plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [plain(element) for element in value]
    names = [field.name for field in fields(value)] if is_dataclass(value) else value.__slots__
    # rosbags also counts the constants and the type's name among the fields.
    names = [name for name in names if not name.isupper() and name != "__msgtype__"]
    return {name: plain(getattr(value, name)) for name in names}


def show(topic, message, **more):
    print(json.dumps({"topic": topic, "message": message, **more}, allow_nan=False))


class JsonDecoderFactory:
    """Refuses messages that are not as their schema says, and schemas that leave out a field."""

    def decoder_for(self, message_encoding, schema):
        if message_encoding != "json":
            return None
        import fastjsonschema

        definition = json.loads(schema.data)
        definition["additionalProperties"] = False
        validate = fastjsonschema.compile(definition)
        return lambda data: validate(json.loads(data))


def with_mcap(path):
    from google.protobuf.json_format import MessageToDict
    from mcap.reader import make_reader
    from mcap_protobuf.decoder import DecoderFactory as ProtobufDecoderFactory
    from mcap_ros2.decoder import DecoderFactory as Ros2DecoderFactory

    factories = [ProtobufDecoderFactory(), Ros2DecoderFactory(), JsonDecoderFactory()]
    with open(path, "rb") as f:
        reader = make_reader(f, validate_crcs=True, decoder_factories=factories)
        for _, channel, _, message in reader.iter_decoded_messages():
            match channel.message_encoding:
                case "protobuf":
                    message = MessageToDict(
                        message, preserving_proto_field_name=True, always_print_fields_with_no_presence=True
                    )
                case "cdr":
                    message = plain(message)
            show(channel.topic, message)


def with_rosbags(path):
    from rosbags.highlevel import AnyReader

    with AnyReader([Path(path)]) as reader:
        for connection, _, data in reader.messages():
            offered = connection.ext.offered_qos_profiles
            durability = offered[0].durability.name if offered else None
            message = reader.deserialize(data, connection.msgtype)
            show(connection.topic, plain(message), durability=durability)


match sys.argv[2:]:
    case ["mcap"]:
        with_mcap(sys.argv[1])
    case ["rosbags"]:
        with_rosbags(sys.argv[1])
    case _:
        sys.exit("usage: show.py FILE mcap|rosbags")
