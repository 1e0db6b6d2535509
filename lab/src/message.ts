// Messages to and from the engine: JSON with planes of bytes beside it, little-endian.
//
// `u32 length`, JSON, zero bytes up to a multiple of 4, `u32 count of planes`, then each plane like
// the JSON. See docs of crates/lab.

import type { JsonObject } from "./json.ts";

const padded = (length: number) => (length + 3) & ~3;

export function encode(json: JsonObject, planes: Uint8Array[] = []): Uint8Array {
  const text = new TextEncoder().encode(JSON.stringify(json));
  const size = planes.reduce((sum, plane) => sum + 4 + padded(plane.length), 8 + padded(text.length));
  const bytes = new Uint8Array(size);
  const view = new DataView(bytes.buffer);
  let offset = 0;
  const write = (part: Uint8Array) => {
    view.setUint32(offset, part.length, true);
    bytes.set(part, offset + 4);
    offset += 4 + padded(part.length);
  };
  write(text);
  view.setUint32(offset, planes.length, true);
  offset += 4;
  planes.forEach(write);
  return bytes;
}

/** Reads a message; the planes are copies. */
export function decode(bytes: Uint8Array): { json: JsonObject; planes: Uint8Array[] } {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  let offset = 0;
  const read = () => {
    const length = view.getUint32(offset, true);
    const part = bytes.slice(offset + 4, offset + 4 + length);
    offset += 4 + padded(length);
    return part;
  };
  const json = JSON.parse(new TextDecoder().decode(read())) as JsonObject;
  const count = view.getUint32(offset, true);
  offset += 4;
  const planes = Array.from({ length: count }, read);
  return { json, planes };
}
