// The engine in a worker: one WebAssembly module, one request at a time.

import { bytesOf, inflated } from "./inflate.ts";
import type { JsonObject } from "./json.ts";
import { decode, encode } from "./message.ts";

/** Where the engine comes from. */
export type Source =
  | { kind: "url"; url: string }
  | { kind: "text"; base64: string; isDeflated: boolean }
  | { kind: "module"; module: WebAssembly.Module };

export type ToWorker = { open: Source } | { id: number; json: JsonObject; planes: Uint8Array[] };

export type FromWorker =
  | { opened: WebAssembly.Module }
  | { failed: string }
  | { id: number; json: JsonObject; planes: Uint8Array[] };

interface Engine {
  memory: WebAssembly.Memory;
  lab_alloc(length: number): number;
  /** Reads the message from where `lab_alloc` said, and says where the answer lies. */
  lab_request(): number;
}

// The page's types know `self` as a window.
const post = self.postMessage as unknown as (message: FromWorker, transfer?: Transferable[]) => void;

let engine: Engine | undefined;

async function compile(source: Source): Promise<WebAssembly.Module> {
  switch (source.kind) {
    case "module":
      return source.module;
    case "url": {
      const answer = await fetch(source.url);
      if (!answer.ok) throw new Error(`${source.url}: ${answer.status} ${answer.statusText}`);
      return WebAssembly.compile(await answer.arrayBuffer());
    }
    case "text": {
      if (!source.isDeflated) return WebAssembly.compile(bytesOf(source.base64));
      return WebAssembly.compile(await inflated(source.base64).arrayBuffer());
    }
  }
}

async function open(source: Source) {
  const module = await compile(source);
  const imports = { env: { lab_now: () => performance.now() } };
  const instance = await WebAssembly.instantiate(module, imports);
  engine = instance.exports as unknown as Engine;
  post({ opened: module });
}

function request(json: JsonObject, planes: Uint8Array[]): { json: JsonObject; planes: Uint8Array[] } {
  if (!engine) return { json: { error: { message: "the engine is not open", hint: null } }, planes: [] };
  const message = encode(json, planes);
  const pointer = engine.lab_alloc(message.length) >>> 0;
  new Uint8Array(engine.memory.buffer, pointer, message.length).set(message);
  const answer = engine.lab_request() >>> 0;
  const length = new DataView(engine.memory.buffer).getUint32(answer, true);
  return decode(new Uint8Array(engine.memory.buffer, answer + 4, length));
}

self.onmessage = ({ data }: MessageEvent<ToWorker>) => {
  if ("open" in data) {
    open(data.open).catch((e: unknown) => post({ failed: String(e) }));
    return;
  }
  try {
    const { json, planes } = request(data.json, data.planes);
    post({ id: data.id, json, planes }, planes.map((plane) => plane.buffer));
  } catch (e) {
    // A trap leaves the module in an unknown state: it has to be opened anew.
    engine = undefined;
    post({ id: data.id, json: { error: { message: String(e), hint: null, broken: true } }, planes: [] });
  }
};
