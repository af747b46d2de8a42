// Shows every protobuf message of an MCAP file, decoded as viewers do: with protobufjs and the descriptors in the file.
// Argument: FILE. Output: that of show.py.

import { open } from "node:fs/promises";
import zstd from "@foxglove/wasm-zstd";
import { McapIndexedReader } from "@mcap/core";
import protobuf from "protobufjs";
import "protobufjs/ext/descriptor.js";

// A value as protobuf's JSON mapping has it: times with 0, 3, 6 or 9 digits beyond the second.
function mapped(_, value) {
  if (Object.keys(value ?? {}).join() !== "seconds,nanos") return value ?? undefined;
  const [second] = new Date(value.seconds * 1000).toISOString().split(".");
  const digits = String(value.nanos).padStart(9, "0").replace(/^((...)*?)(000)*$/, "$1");
  return digits === "" ? `${second}Z` : `${second}.${digits}Z`;
}

function decoder({ name, data }) {
  const type = protobuf.Root.fromDescriptor(data, { keepCase: true }).lookupType(name);
  return (message) => type.toObject(type.decode(message), { enums: String, longs: Number, defaults: true });
}

const file = await open(process.argv[2]);
const readable = {
  size: async () => BigInt((await file.stat()).size),
  read: async (offset, size) => {
    const data = new Uint8Array(Number(size));
    await file.read(data, 0, data.length, Number(offset));
    return data;
  },
};
await zstd.isLoaded;
const decompressHandlers = { zstd: (data, size) => zstd.decompress(data, Number(size)) };
const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
const decoders = new Map();
for await (const { channelId, data } of reader.readMessages()) {
  const { topic, schemaId, messageEncoding } = reader.channelsById.get(channelId);
  if (messageEncoding !== "protobuf") continue;
  if (!decoders.has(schemaId)) decoders.set(schemaId, decoder(reader.schemasById.get(schemaId)));
  console.log(JSON.stringify({ topic, message: decoders.get(schemaId)(data) }, mapped));
}
await file.close();
