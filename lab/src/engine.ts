// Requests to the engine. Short ones go to one worker, long ones to another, which is stopped and
// started anew when its work is not wanted any more.

import type { Json, JsonObject } from "./json.ts";
import type { FromWorker, Source, ToWorker } from "./worker.ts";

export interface Answer {
  ok: JsonObject;
  planes: Uint8Array[];
}

/** The most characters of a reason that are told. */
const LONGEST_REASON = 300;

const short = (reason: string) => (reason.length > LONGEST_REASON ? `${reason.slice(0, LONGEST_REASON - 1)}…` : reason);

/** Why the engine refused a request. */
export class Refusal extends Error {
  readonly hint: string | null;

  constructor(message: string, hint: string | null) {
    super(short(message));
    this.hint = hint && short(hint);
  }
}

/** What to tell of an error. */
export function wordsOf(error: unknown): string {
  if (error instanceof Refusal) return error.hint ? `${error.message} (${error.hint})` : error.message;
  return error instanceof Error ? error.message : String(error);
}

/** A request was replaced by a newer one of the same name. */
export class Superseded extends Error {}

interface Job {
  name: string;
  json: JsonObject;
  planes: Uint8Array[];
  resolve(answer: Answer): void;
  reject(error: Error): void;
}

export interface UserFile {
  name: string;
  bytes: Uint8Array;
}

/** One worker with a queue: requests of the same name replace each other. */
class Line {
  private worker: Worker | undefined;
  private queue: Job[] = [];
  private running: Job | undefined;
  private isOpen = false;
  private id = 0;
  /** What a fresh module has to be told first. */
  files: UserFile[] = [];

  constructor(
    private readonly script: () => string | URL,
    private source: Source,
    private readonly opened: (module: WebAssembly.Module) => void,
    private readonly failed: (message: string) => void,
  ) {}

  start(source = this.source) {
    this.source = source;
    if (this.worker) return;
    const worker = new Worker(this.script());
    this.worker = worker;
    worker.onmessage = ({ data }: MessageEvent<FromWorker>) => this.receive(data);
    worker.onerror = (e) => this.failed(e.message || "the worker does not start");
    this.send({ open: this.source });
  }

  private send(message: ToWorker) {
    this.worker?.postMessage(message);
  }

  private receive(data: FromWorker) {
    if ("failed" in data) return this.failed(data.failed);
    if ("opened" in data) {
      this.isOpen = true;
      this.source = { kind: "module", module: data.opened };
      this.opened(data.opened);
      if (this.files.length) {
        const json = { want: "files", files: this.files.map(({ name }) => ({ name })) };
        this.send({ id: 0, json, planes: this.files.map((f) => f.bytes) });
      }
      return this.next();
    }
    const job = this.running;
    if (!job || data.id !== this.id) return;
    this.running = undefined;
    const error = data.json["error"] as JsonObject | undefined;
    if (error?.["broken"]) this.restart();
    if (error) job.reject(new Refusal(String(error["message"]), text(error["hint"])));
    else job.resolve({ ok: data.json["ok"] as JsonObject, planes: data.planes });
    this.next();
  }

  private next() {
    if (!this.isOpen || this.running) return;
    const job = this.queue.shift();
    if (!job) return;
    this.running = job;
    this.id += 1;
    this.send({ id: this.id, json: job.json, planes: job.planes });
  }

  ask(name: string, json: JsonObject, planes: Uint8Array[] = []): Promise<Answer> {
    this.start();
    return new Promise((resolve, reject) => {
      const replaced = this.queue.findIndex((job) => job.name === name);
      const job = { name, json, planes, resolve, reject };
      if (replaced >= 0) {
        this.queue[replaced]?.reject(new Superseded());
        this.queue[replaced] = job;
      } else {
        this.queue.push(job);
      }
      this.next();
    });
  }

  /** Stops what runs and forgets what waits. */
  restart() {
    this.worker?.terminate();
    this.worker = undefined;
    this.isOpen = false;
    const jobs = [...(this.running ? [this.running] : []), ...this.queue];
    this.running = undefined;
    this.queue = [];
    for (const job of jobs) job.reject(new Superseded());
  }

  get isBusy() {
    return this.running !== undefined || this.queue.length > 0;
  }
}

const text = (v: Json | undefined) => (typeof v === "string" && v !== "" ? v : null);

/** Where worker and engine come from: elements of the single file, or files beside the page. */
function sources(): { script: () => string | URL; source: Source } {
  const worker = document.getElementById("lab-worker")?.textContent;
  const wasm = document.getElementById("lab-wasm");
  let url: string | undefined;
  const script = () => {
    if (!worker) return "worker.js";
    url ??= URL.createObjectURL(new Blob([worker], { type: "text/javascript" }));
    return url;
  };
  const source: Source = wasm
    ? { kind: "text", base64: wasm.textContent ?? "", isDeflated: wasm.dataset["encoding"] === "deflate-raw" }
    : { kind: "url", url: new URL("vitral_lab.wasm", document.baseURI).href };
  return { script, source };
}

export class Engine {
  private readonly short: Line;
  private readonly long: Line;

  constructor(failed: (message: string) => void) {
    const { script, source } = sources();
    // The second worker takes the compiled module of the first.
    const opened = (module: WebAssembly.Module) => {
      this.module = module;
      document.getElementById("lab-wasm")?.remove();
      for (const wait of this.waiting.splice(0)) wait();
    };
    this.short = new Line(script, source, opened, failed);
    this.long = new Line(script, source, () => {}, failed);
    this.short.start();
  }

  private module: WebAssembly.Module | undefined;
  private readonly waiting: (() => void)[] = [];

  /** A request that is answered at once; a newer one of the same name replaces one that waits. */
  ask(name: string, json: JsonObject, planes?: Uint8Array[]): Promise<Answer> {
    return this.short.ask(name, json, planes);
  }

  /** A request that may take seconds. */
  async askLong(name: string, json: JsonObject): Promise<Answer> {
    if (!this.module) await new Promise<void>((resolve) => this.waiting.push(resolve));
    if (this.module) this.long.start({ kind: "module", module: this.module });
    return this.long.ask(name, json);
  }

  /** Stops long requests. */
  stopLong() {
    if (this.long.isBusy) this.long.restart();
  }

  /** Hands files of the user to both modules. */
  async give(files: UserFile[]): Promise<Answer> {
    const json = { want: "files", files: files.map(({ name }) => ({ name })) };
    const planes = files.map((f) => f.bytes);
    this.short.files = files;
    this.long.files = files;
    this.long.restart();
    return this.short.ask("files", json, planes);
  }
}
