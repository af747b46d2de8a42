"""Checks what the contestants wrote.

    check.py LOG

Reads lines "EXPECTED FILE" from standard input and answers each with a line: "yes", or what is wrong with the file.
EXPECTED is one of:

    copy        the log's bytes
    messages    every message of the log unchanged, each topic's in the log's order; statistics that agree with a
                recount, CRCs and indexes in order
    reference   that; its derived messages are what those of later files are compared with
    derived     that, and the reference's derived messages: the same types and times, the numbers to 1e-9
    appended    that, and the log's bytes up to its DataEnd record at the start
    shown       that, and other topics under /camera/ for viewers
"""

import filecmp
import json
import subprocess
import sys
from array import array
from hashlib import sha256
from operator import attrgetter
from pathlib import Path
from struct import unpack

import numpy as np
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

# Reads a file with the official library, and checks what the library does not.
READER = Path(__file__).parents[2] / "tests/readers/read.py"
QUATERNION = [f"quaternion.{name}" for name in ("x", "y", "z", "w")]
DERIVED = {
    "/camera/relative_rpy": attrgetter("roll", "pitch", "yaw"),
    "/camera/orientation": attrgetter(*QUATERNION, "roll", "pitch", "yaw"),
    "/camera/velocity": attrgetter("x", "y", "z"),
}
TOLERANCE = 1e-9
DATA_END_LENGTH, FOOTER_LENGTH, MAGIC_LENGTH = 1 + 8 + 4, 1 + 8 + 20, 8


def check(ok, message):
    if not ok:
        raise ValueError(message)


def digests(path):
    """For each topic, a hash of its messages' times, sequence numbers and payloads in file order."""
    topics = {}
    with subprocess.Popen([sys.executable, READER, path, "stream"], stdout=subprocess.PIPE) as reader:
        for line in reader.stdout:
            topic, rest = line.split(b" ", 1)
            if topic == b"summary":
                summary = json.loads(rest)
            else:
                topics.setdefault(topic.decode(), sha256()).update(rest)
    check(reader.returncode == 0, "the official reader refuses it")
    check(summary["statistics"] == summary["recount"], "its statistics disagree with a recount")
    return {topic: digest.hexdigest() for topic, digest in topics.items()}


class Derived:
    """The derived messages of a file, in time order."""

    def __init__(self, path):
        self.kinds = set()
        self.times = {topic: array("q") for topic in DERIVED}
        self.numbers = {topic: array("d") for topic in DERIVED}
        with open(path, "rb") as f:
            reader = make_reader(f, decoder_factories=[DecoderFactory()])
            for schema, channel, record, message in reader.iter_decoded_messages(topics=DERIVED):
                topic = channel.topic
                self.kinds.add((topic, schema.name, message.frame_id))
                interval = message.interval.ToNanoseconds() if topic == "/camera/relative_rpy" else 0
                stamp = message.timestamp.ToNanoseconds()
                self.times[topic].extend((record.log_time, record.publish_time, stamp, interval))
                self.numbers[topic].extend(DERIVED[topic](message))

    def compare(self, other):
        check(self.kinds == other.kinds, f"derived messages of other types or frames: {self.kinds}")
        for topic in DERIVED:
            check(self.times[topic] == other.times[topic], f"{topic}: times differ from Python's")
            difference = np.abs(np.subtract(self.numbers[topic], other.numbers[topic]))
            check((difference <= TOLERANCE).all(), f"{topic}: {difference.max()} off Python's")


def data_end(path):
    """The offset of the DataEnd record, which the summary follows."""
    with open(path, "rb") as f:
        f.seek(-(FOOTER_LENGTH + MAGIC_LENGTH), 2)
        return unpack("<BQQ", f.read(17))[2] - DATA_END_LENGTH


def same_start(path, other, length):
    with open(path, "rb") as f, open(other, "rb") as g:
        while length:
            block = f.read(min(length, 1 << 24))
            if not block or g.read(len(block)) != block:
                return False
            length -= len(block)
    return True


class Judge:
    def __init__(self, log):
        self.log, self.digests, self.reference = log, digests(log), None

    def judge(self, expected, output):
        if expected == "copy":
            check(filecmp.cmp(self.log, output, shallow=False), "not the same bytes")
            return
        topics = digests(output)
        for topic, digest in self.digests.items():
            check(topics.pop(topic, None) == digest, f"the messages of {topic} are not those of the log")
        others = set(topics) - set(DERIVED)
        for_viewers = {topic for topic in others if topic.startswith("/camera/")}
        unexpected = others - (for_viewers if expected == "shown" else set())
        check(not unexpected, f"unexpected topics: {', '.join(unexpected)}")
        check(expected != "shown" or "/camera/scene" in for_viewers, "nothing for viewers")
        if expected == "reference":
            self.reference = Derived(output)
        if expected in ("derived", "appended", "shown"):
            Derived(output).compare(self.reference)
        if expected in ("appended", "shown"):
            check(same_start(self.log, output, data_end(self.log)), "does not begin with the log's data section")


def main(log):
    judge = Judge(log)
    for line in sys.stdin:
        try:
            judge.judge(*line.rstrip("\n").split(" ", 1))
            verdict = "yes"
        except Exception as error:  # whatever the library throws: one line
            verdict = f"NO: {' '.join(str(error).split()):.200}"
        print(verdict, flush=True)


main(*sys.argv[1:])
