"""Reads an MCAP file with the official Python library and says what it found.

    read.py FILE index            through the summary's chunk indexes, in log time order
    read.py FILE stream           from the start, in the order of the file
    read.py FILE stream --torn    the same for a file that breaks off: up to its last whole record

One line a message: topic log_time publish_time sequence sha256-of-payload (a topic may contain spaces).
Last line: "summary " and JSON, where `statistics` is the file's own Statistics record and `recount` the
same counted from the raw records. read.mjs prints the same, read with the TypeScript library.

Exits with 1 and a message for a file that is not in order, with 3 in index mode if there is no summary.
"""

import hashlib
import io
import json
import mmap
import sys
import zlib
from collections import Counter
from struct import unpack_from

from mcap.data_stream import ReadDataStream
from mcap.exceptions import EndOfFile
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.records import Attachment, AttachmentIndex, Channel, Chunk, Message, Metadata, MetadataIndex, Statistics
from mcap.stream_reader import StreamReader, get_chunk_data_stream

MAGIC = b"\x89MCAP0\r\n"
COUNTS = ["message_count", "schema_count", "channel_count", "attachment_count", "metadata_count", "chunk_count"]


def check(ok, message):
    if not ok:
        raise ValueError(message)


def check_crc(where, expected, calculated):
    # 0 says that no CRC was calculated.
    check(expected in (0, calculated), f"{where}: CRC is {expected:08x}, calculated {calculated:08x}")


def check_attachment_crc(where, body):
    check_crc(where, unpack_from("<I", body, len(body) - 4)[0], zlib.crc32(body[:-4]))


def split(data, offset, where, torn=False):
    """Yields the records from `offset` to the end of `data`, or to the Footer: offset, opcode, content."""
    opcode = None
    while offset < len(data) and opcode != Opcode.FOOTER:
        opcode, length = unpack_from("<BQ", data, offset) if offset + 9 <= len(data) else (None, 0)
        end = offset + 9 + length
        if end > len(data):
            check(torn, f"{where} breaks off in the record at {offset}")
            return
        yield offset, opcode, data[offset + 9 : end]
        offset = end


class Recount:
    def __init__(self):
        self.records, self.messages = Counter(), Counter()
        self.schemas, self.channels, self.times = set(), set(), []

    def add(self, where, opcode, body):
        self.records[opcode] += 1
        if opcode == Opcode.SCHEMA:
            self.schemas.update(unpack_from("<H", body))
        elif opcode == Opcode.CHANNEL:
            channel, schema = unpack_from("<HH", body)
            check(schema == 0 or schema in self.schemas, f"{where}: channel {channel} precedes its schema {schema}")
            self.channels.add(channel)
        elif opcode == Opcode.MESSAGE:
            channel, _, time = unpack_from("<HIQ", body)
            check(channel in self.channels, f"{where}: message precedes its channel {channel}")
            self.messages[channel] += 1
            self.times = [min(self.times + [time]), max(self.times + [time])]
        elif opcode == Opcode.ATTACHMENT:
            check_attachment_crc(where, body)
        elif opcode == Opcode.CHUNK:
            chunk = Chunk.read(ReadDataStream(io.BytesIO(body)))
            # The library takes a chunk whose compression it does not know for an uncompressed one.
            check(chunk.compression in ("", "lz4", "zstd"), f"{where}: compression {chunk.compression}")
            stream, length = get_chunk_data_stream(chunk)
            data = stream.read(length)
            check_crc(where, chunk.uncompressed_crc, zlib.crc32(data))
            check(length == chunk.uncompressed_size, f"{where}: {length} bytes, not {chunk.uncompressed_size}")
            for _, inner, content in split(data, 0, where):
                allowed = inner in (Opcode.SCHEMA, Opcode.CHANNEL, Opcode.MESSAGE) or inner > max(Opcode)
                check(allowed, f"{where}: a record {inner} inside")
                self.add(where, inner, content)

    def statistics(self):
        of, (start, end) = self.records, self.times or (0, 0)
        return Statistics(
            message_count=sum(self.messages.values()), schema_count=len(self.schemas), channel_count=len(self.channels),
            attachment_count=of[Opcode.ATTACHMENT], metadata_count=of[Opcode.METADATA], chunk_count=of[Opcode.CHUNK],
            message_start_time=start, message_end_time=end, channel_message_counts=self.messages,
        )  # fmt: skip


def audit(data, torn):
    """Recounts the records and checks framing and every CRC. The library leaves gaps there: it never looks at the
    CRCs of summary and attachments; at the data section's only in a stream; at a chunk's not where it falls back
    on a stream; and through an index not at the magic at the end. Returns the recount and the last record's end.
    """
    check(data[:8] == MAGIC, "no MCAP magic at the start")
    recount, end, opcode, data_end = Recount(), 8, None, None
    for offset, opcode, body in split(data, 8, "the file", torn):
        end = offset + 9 + len(body)
        if opcode == Opcode.DATA_END:
            check_crc("data section", unpack_from("<I", body)[0], zlib.crc32(memoryview(data)[:offset]))
            data_end = end
        elif opcode == Opcode.FOOTER and data_end:
            start, _, crc = unpack_from("<QQI", body)
            check(start in (0, data_end), f"DataEnd ends at {data_end}, the footer says summary_start {start}")
            check_crc("summary", crc, zlib.crc32(memoryview(data)[data_end : offset + 9 + 16]))
        elif not data_end:
            recount.add(f"record {opcode} at {offset}", opcode, body)
    check(torn or opcode == Opcode.FOOTER and data_end, "the file ends without DataEnd and Footer")
    if opcode == Opcode.FOOTER:
        rest = data[end : end + 9]
        check(rest == MAGIC or torn and MAGIC.startswith(rest), "after the Footer there is not just the MCAP magic")
    return recount.statistics(), end


def check_index(f, index, kind):
    """Reads the record that an attachment index or metadata index points to; returns its name."""
    where = f"{kind.__name__} {index.name!r} at {index.offset} by its index"
    f.seek(index.offset)
    raw = f.read(index.length)
    check(len(raw) > 9 and unpack_from("<Q", raw, 1)[0] + 9 == index.length, f"{where}: offset or length is wrong")
    record = next(StreamReader(io.BytesIO(raw), skip_magic=True).records)
    check(isinstance(record, kind) and record.name == index.name, f"{where}: found another record")
    if kind is Attachment:
        check_attachment_crc(where, raw[9:])
    return record.name


def show(channel, message):
    digest = hashlib.sha256(message.data).hexdigest()
    print(channel.topic, message.log_time, message.publish_time, message.sequence, digest)


def read_index(f):
    reader = make_reader(f, validate_crcs=True)
    summary, last = reader.get_summary(), 0
    if summary is None:
        print("the file has no summary, so no index", file=sys.stderr)
        sys.exit(3)
    try:
        for _, channel, message in reader.iter_messages(log_time_order=True):
            check(message.log_time >= last, f"not in log time order: {message.log_time} follows {last}")
            last = message.log_time
            show(channel, message)
    except KeyError as missing:
        raise ValueError(f"the summary has no channel, or no schema, {missing}") from None
    # Without chunk indexes the library has, on its own, read the file as a stream and sorted it.
    return summary.statistics, summary.attachment_indexes, summary.metadata_indexes, not summary.chunk_indexes


def read_stream(f, torn, end):
    if torn:  # cut it after the last whole record, so that the library meets the end between two records
        f = io.BytesIO(f.read(end))
    channels, found = {}, {Statistics: [], AttachmentIndex: [], MetadataIndex: []}
    try:
        for record in StreamReader(f, validate_crcs=True).records:
            if isinstance(record, Channel):
                channels[record.id] = record
            elif isinstance(record, Message):
                show(channels[record.channel_id], record)
            elif type(record) in found:
                found[type(record)].append(record)
    except EndOfFile:
        check(torn, "the file breaks off")
    return next(iter(found[Statistics]), None), found[AttachmentIndex], found[MetadataIndex], False


def as_json(statistics):
    by_channel = sorted(statistics.channel_message_counts.items())
    return {
        **{name: getattr(statistics, name) for name in COUNTS},
        "message_start_time": str(statistics.message_start_time),
        "message_end_time": str(statistics.message_end_time),
        "channel_message_counts": {str(id): count for id, count in by_channel if count},
    }


def main(path, mode, torn=None):
    with open(path, "rb") as f:
        with mmap.mmap(f.fileno(), 0, access=mmap.ACCESS_READ) as data:
            recount, end = audit(data, torn)
        statistics, attachments, metadata, fallback = read_index(f) if mode == "index" else read_stream(f, torn, end)
        summary = {
            "statistics": statistics and as_json(statistics),
            "recount": as_json(recount),
            "attachments": [check_index(f, index, Attachment) for index in attachments],
            "metadata": [check_index(f, index, Metadata) for index in metadata],
            "fallback": fallback,
        }
    print("summary", json.dumps(summary, ensure_ascii=False, separators=(",", ":")))


if sys.argv[2:] not in (["index"], ["stream"], ["stream", "--torn"]):
    sys.exit("usage: read.py FILE index|stream [--torn]")
sys.stdout.reconfigure(encoding="utf-8")
try:
    main(*sys.argv[1:])
except Exception as error:  # whatever the library throws: one line and a failure
    sys.exit(f"{sys.argv[1]}: {type(error).__name__}: {error}")
