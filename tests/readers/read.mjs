// Reads an MCAP file with the official TypeScript library, which Foxglove uses, and says what it found.
// Arguments, output and exit codes are those of read.py, where they are explained.

import { createHash } from "node:crypto";
import { fstatSync, openSync, readSync } from "node:fs";
import { crc32 } from "node:zlib";
import lz4 from "@foxglove/wasm-lz4";
import zstd from "@foxglove/wasm-zstd";
import { McapConstants, McapIndexedReader, McapStreamReader } from "@mcap/core";

const { MCAP_MAGIC, Opcode } = McapConstants;
const PIECE = 64 * 1024;

const decompressHandlers = {
  lz4: (data, size) => lz4(data, Number(size)),
  zstd: (data, size) => zstd.decompress(data, Number(size)),
};

function check(ok, message) {
  if (!ok) throw new Error(message);
}

class Log {
  constructor(path) {
    this.fd = openSync(path);
    this.length = fstatSync(this.fd).size;
  }
  // Returns fewer bytes than asked for where the file ends.
  read(offset, size) {
    const data = Buffer.alloc(Math.max(0, Math.min(size, this.length - offset)));
    for (let done = 0, count; done < data.length; done += count) {
      count = readSync(this.fd, data, done, data.length - done, offset + done);
      check(count > 0, "the file shrank while it was read");
    }
    return data;
  }
}

function checkCrc(what, expected, calculated) {
  // 0 says that no CRC was calculated.
  check(expected === 0 || expected === calculated, `${what}: CRC is ${expected}, calculated ${calculated}`);
}

// Walks over the raw records for the two CRCs that the library leaves out: it never looks at that of the data
// section, and at that of the summary only through the index. All others it checks itself.
function checkSections(log, torn) {
  const magic = log.read(0, MCAP_MAGIC.length);
  check(magic.equals(Uint8Array.from(MCAP_MAGIC)), "no MCAP magic at the start");
  let [offset, crc, dataEnd, opcode] = [magic.length, crc32(magic), undefined, undefined];
  while (opcode !== Opcode.FOOTER) {
    const head = log.read(offset, 9);
    const end = head.length < 9 ? Infinity : offset + 9 + Number(head.readBigUInt64LE(1));
    if (torn && end > log.length) return;
    check(end <= log.length, `the file breaks off in the record at ${offset}`);
    opcode = head[0];
    const body = log.read(offset + 9, end - offset - 9);
    if (opcode === Opcode.DATA_END) {
      checkCrc("data section", body.readUInt32LE(0), crc);
      [dataEnd, crc] = [end, 0]; // what follows is the summary
    } else if (opcode === Opcode.FOOTER && dataEnd) {
      const start = Number(body.readBigUInt64LE(0));
      check(start === 0 || start === dataEnd, `DataEnd ends at ${dataEnd}, the footer says summary_start ${start}`);
      checkCrc("summary", body.readUInt32LE(16), crc32(body.subarray(0, 16), crc32(head, crc)));
    } else {
      crc = crc32(body, crc32(head, crc));
    }
    offset = end;
  }
  check(torn || dataEnd, "the file has no DataEnd");
}

// Yields what the library's stream reader makes of the file.
function* stream(log, torn, includeChunks = false) {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true, includeChunks });
  for (let offset = 0; offset < log.length; offset += PIECE) {
    reader.append(log.read(offset, PIECE));
    for (let record; (record = reader.nextRecord()); ) yield record;
  }
  check(torn || reader.done(), "the file breaks off");
}

// Counts the records of the data section, those in chunks too.
function recount(log, torn) {
  const [schemas, channels, byType, byChannel] = [new Set(), new Set(), {}, new Map()];
  let [inData, start, end] = [true, undefined, undefined];
  for (const record of stream(log, torn, true)) {
    inData &&= record.type !== "DataEnd";
    if (!inData) continue; // but read on, for the sake of the reader's checks
    byType[record.type] = (byType[record.type] ?? 0) + 1;
    if (record.type === "Schema") schemas.add(record.id);
    if (record.type === "Channel") channels.add(record.id);
    if (record.type === "Message") {
      byChannel.set(record.channelId, (byChannel.get(record.channelId) ?? 0) + 1);
      if (start === undefined || record.logTime < start) start = record.logTime;
      if (end === undefined || record.logTime > end) end = record.logTime;
    }
  }
  return {
    messageCount: byType.Message ?? 0,
    schemaCount: schemas.size,
    channelCount: channels.size,
    attachmentCount: byType.Attachment ?? 0,
    metadataCount: byType.Metadata ?? 0,
    chunkCount: byType.Chunk ?? 0,
    messageStartTime: start ?? 0n,
    messageEndTime: end ?? 0n,
    channelMessageCounts: byChannel,
  };
}

function asJson(statistics) {
  const byChannel = [...statistics.channelMessageCounts].filter(([, count]) => count > 0);
  return {
    message_count: Number(statistics.messageCount),
    schema_count: statistics.schemaCount,
    channel_count: statistics.channelCount,
    attachment_count: statistics.attachmentCount,
    metadata_count: statistics.metadataCount,
    chunk_count: statistics.chunkCount,
    message_start_time: String(statistics.messageStartTime),
    message_end_time: String(statistics.messageEndTime),
    channel_message_counts: Object.fromEntries(byChannel.map(([id, count]) => [id, Number(count)])),
  };
}

// Reads the record that an attachment index or metadata index points to; returns its name.
function checkIndex(log, index, type) {
  const where = `${type} ${index.name} at ${index.offset} by its index`;
  const reader = new McapStreamReader({ noMagicPrefix: true, validateCrcs: true });
  reader.append(log.read(Number(index.offset), Number(index.length)));
  const record = reader.nextRecord();
  check(record && reader.bytesRemaining() === 0, `${where}: offset or length is wrong`);
  check(record.type === type && record.name === index.name, `${where}: found another record`);
  return record.name;
}

function show(channels, message) {
  const { channelId, logTime, publishTime, sequence, data } = message;
  check(channels.has(channelId), `the summary has no channel ${channelId}`);
  const digest = createHash("sha256").update(data).digest("hex");
  process.stdout.write(`${channels.get(channelId).topic} ${logTime} ${publishTime} ${sequence} ${digest}\n`);
}

async function readIndex(log) {
  const readable = {
    size: async () => BigInt(log.length),
    read: async (offset, size) => log.read(Number(offset), Number(size)),
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  let [channels, messages] = [reader.channelsById, reader.readMessages({ validateCrcs: true })];
  // Without these the indexed reader is of no use: it yields nothing, or messages whose topic nobody knows. Foxglove
  // then reads a stream and sorts it. (It does so, too, where the reader throws; here that is a failure.)
  const fallback = reader.chunkIndexes.length === 0 || channels.size === 0;
  if (fallback) {
    const records = [...stream(log)];
    channels = new Map(records.filter(({ type }) => type === "Channel").map((channel) => [channel.id, channel]));
    messages = records.filter(({ type }) => type === "Message");
    messages.sort((a, b) => (a.logTime < b.logTime ? -1 : a.logTime > b.logTime ? 1 : 0));
  }
  let last = 0n;
  for await (const message of messages) {
    check(message.logTime >= last, `not in log time order: ${message.logTime} follows ${last}`);
    last = message.logTime;
    show(channels, message);
  }
  const { statistics, attachmentIndexes, metadataIndexes } = reader;
  return { statistics, attachmentIndexes, metadataIndexes, fallback };
}

function readStream(log, torn) {
  const channels = new Map();
  const found = { Statistics: [], AttachmentIndex: [], MetadataIndex: [] };
  for (const record of stream(log, torn)) {
    if (record.type === "Channel") channels.set(record.id, record);
    if (record.type === "Message") show(channels, record);
    found[record.type]?.push(record);
  }
  const { Statistics, AttachmentIndex, MetadataIndex } = found;
  return {
    statistics: Statistics[0], attachmentIndexes: AttachmentIndex, metadataIndexes: MetadataIndex, fallback: false,
  }; // prettier-ignore
}

async function main(path, mode, torn) {
  await Promise.all([lz4.isLoaded, zstd.isLoaded]);
  const log = new Log(path);
  checkSections(log, torn);
  const counted = recount(log, torn);
  // The field summary_start in the footer, which by now is known to be there.
  if (mode === "index" && log.read(log.length - 28, 8).readBigUInt64LE() === 0n) {
    console.error("the file has no summary, so no index");
    process.exitCode = 3;
    return;
  }
  const found = mode === "index" ? await readIndex(log) : readStream(log, torn);
  const summary = {
    statistics: found.statistics ? asJson(found.statistics) : null,
    recount: asJson(counted),
    attachments: found.attachmentIndexes.map((index) => checkIndex(log, index, "Attachment")),
    metadata: found.metadataIndexes.map((index) => checkIndex(log, index, "Metadata")),
    fallback: found.fallback,
  };
  process.stdout.write(`summary ${JSON.stringify(summary)}\n`);
}

const [path, ...modes] = process.argv.slice(2);
try {
  check(["index", "stream", "stream --torn"].includes(modes.join(" ")), "usage: read.mjs FILE index|stream [--torn]");
  await main(path, modes[0], modes[1] === "--torn");
} catch (error) {
  console.error(`${path}: ${error.name}: ${error.message}`);
  process.exitCode = 1;
}
