// The link is the state: a fragment holds the whole situation, and only what differs from the default.

import { at, copy, differences, equal, isObject, put, type Json, type JsonObject } from "./json.ts";

export const PAGES = ["scene", "pipeline", "visibility", "illumination", "shading", "exercises"] as const;
export const COMPARISONS = ["none", "side", "swipe", "blink", "difference"] as const;
export const LAYOUTS = ["full", "figure", "slide"] as const;
export const LANGUAGES = ["en", "ro", "fr", "pt"] as const;

export type Page = (typeof PAGES)[number];
export type Comparison = (typeof COMPARISONS)[number];
export type Layout = (typeof LAYOUTS)[number];
export type Language = (typeof LANGUAGES)[number];

/** The Lab's own choices, beside the state of the picture. */
export interface Lab {
  page: Page;
  /** The step shown, from 1; `null`: the finished picture. */
  step: number | null;
  /** Which steps are shown: `all`, `pixel` or a group of the algorithm. */
  steps: string;
  pixel: [number, number] | null;
  compare: Comparison;
  /** The view from outside: off, on from its own place, or from a viewpoint. */
  second: "off" | "on" | JsonObject;
  exercise: string | null;
  layout: Layout;
  /** `null`: the browser's language. */
  lang: Language | null;
  /** Steps a second. */
  speed: number;
  play: boolean;
}

export const LAB: Lab = {
  page: "scene",
  step: null,
  steps: "all",
  pixel: null,
  compare: "none",
  second: "off",
  exercise: null,
  layout: "full",
  lang: null,
  speed: 2,
  play: false,
};

/** All that a link says. */
export interface Situation {
  /** The state file of picture A, with every field. */
  state: JsonObject;
  /** What is different in picture B: dotted paths. */
  b: Record<string, Json>;
  lab: Lab;
}

/** The longest fragment that is written out; longer ones are packed. */
const LONGEST_PLAIN = 2000;

/** The longest text that is unpacked: a link of more is refused. */
const LONGEST_UNPACKED = 4_000_000;

/** A part of a link that cannot be. */
export interface Problem {
  key: string;
  what: "unknown-field" | "bad-value" | "unreadable" | "outside";
}

/** The state of picture B. */
export function stateOfB(situation: Situation): JsonObject {
  return Object.entries(situation.b).reduce((state, [path, value]) => put(state, path, value), situation.state);
}

/** Whether a path can be set in a state: its keys are those of the default state. */
function isKnown(defaults: JsonObject, path: string): boolean {
  let here: Json | undefined = defaults;
  for (const key of path.split(".")) {
    // What is inside lists, variants and fields without a default is left to the engine.
    if (here === null || Array.isArray(here)) return key !== "";
    if (!isObject(here)) return false;
    if (!Object.hasOwn(here, key)) return false;
    here = here[key];
  }
  return true;
}

function readValue(text: string): Json {
  try {
    return JSON.parse(text) as Json;
  } catch {
    return text;
  }
}

/** The text of a value: a string as it is, unless it would be read as something else. */
function writeValue(value: Json): string {
  if (typeof value === "string" && readValue(value) === value) return value;
  return JSON.stringify(value);
}

const isOneOf = <T extends string>(list: readonly T[], text: string): text is T => (list as readonly string[]).includes(text);

/** Reads one of the Lab's own keys; `undefined`: the value cannot be. */
function readLab(key: string, text: string): Partial<Lab> | undefined {
  const whole = /^\d{1,9}$/.test(text) ? Number(text) : undefined;
  switch (key) {
    case "page":
      return isOneOf(PAGES, text) ? { page: text } : undefined;
    case "compare":
      return isOneOf(COMPARISONS, text) ? { compare: text } : undefined;
    case "layout":
      return isOneOf(LAYOUTS, text) ? { layout: text } : undefined;
    case "lang":
      return isOneOf(LANGUAGES, text) ? { lang: text } : undefined;
    case "step":
      return whole ? { step: whole } : undefined;
    case "steps":
      return /^[a-z][a-z0-9-]{0,40}$/.test(text) ? { steps: text } : undefined;
    case "pixel": {
      const found = /^(\d{1,6}),(\d{1,6})$/.exec(text);
      return found ? { pixel: [Number(found[1]), Number(found[2])] } : undefined;
    }
    case "second": {
      if (text === "off" || text === "on") return { second: text };
      const value = readValue(text);
      return isObject(value) ? { second: value } : undefined;
    }
    case "exercise":
      return /^[A-Za-z0-9.-]{1,20}$/.test(text) ? { exercise: text } : undefined;
    case "speed": {
      const speed = Number(text);
      return speed > 0 && speed <= 1000 ? { speed } : undefined;
    }
    case "play":
      return text === "1" ? { play: true } : text === "0" ? { play: false } : undefined;
    default:
      return undefined;
  }
}

/** Reads a form into a state with every field, `start`; what cannot be is told and left out. */
export function read(
  form: URLSearchParams,
  defaults: JsonObject,
  start = defaults,
): { situation: Situation; problems: Problem[] } {
  const situation: Situation = { state: copy(start), b: {}, lab: { ...LAB } };
  const problems: Problem[] = [];
  for (const [key, text] of form) {
    if (Object.hasOwn(LAB, key)) {
      const found = readLab(key, text);
      if (found) Object.assign(situation.lab, found);
      else problems.push({ key, what: "bad-value" });
      continue;
    }
    const isB = key.startsWith("b.");
    const path = isB ? key.slice(2) : key;
    if (!isKnown(defaults, path)) {
      problems.push({ key, what: "unknown-field" });
    } else if (isObject(at(defaults, path)) && !isObject(readValue(text))) {
      problems.push({ key, what: "bad-value" });
    } else if (isB) {
      situation.b[path] = readValue(text);
    } else {
      situation.state = put(situation.state, path, readValue(text));
    }
  }
  return { situation, problems };
}

/** What a reader of the link looks for first. */
const FIRST = ["models", "settings.width", "settings.height"];

const rank = (path: string) => (FIRST.includes(path) ? FIRST.indexOf(path) : FIRST.length);

/** Writes the form of a situation: only what differs from the default. */
export function write(situation: Situation, defaults: JsonObject): URLSearchParams {
  const form = new URLSearchParams();
  const different = differences(situation.state, defaults).sort(([a], [b]) => rank(a) - rank(b));
  for (const [path, value] of different) form.append(path, writeValue(value));
  for (const [path, value] of Object.entries(situation.b)) {
    if (!equal(at(situation.state, path), value)) form.append(`b.${path}`, writeValue(value));
  }
  const { lab } = situation;
  if (lab.page !== LAB.page) form.append("page", lab.page);
  if (lab.step !== null) form.append("step", String(lab.step));
  if (lab.steps !== LAB.steps) form.append("steps", lab.steps);
  if (lab.pixel) form.append("pixel", lab.pixel.join(","));
  if (lab.compare !== LAB.compare) form.append("compare", lab.compare);
  if (lab.second !== LAB.second) form.append("second", isObject(lab.second) ? JSON.stringify(lab.second) : lab.second);
  if (lab.exercise !== null) form.append("exercise", lab.exercise);
  if (lab.layout !== LAB.layout) form.append("layout", lab.layout);
  if (lab.lang !== null) form.append("lang", lab.lang);
  if (lab.speed !== LAB.speed) form.append("speed", String(lab.speed));
  if (lab.play) form.append("play", "1");
  return form;
}

/** The form as text, with the brackets, commas and colons of JSON left readable. */
export function formText(form: URLSearchParams): string {
  const readable: Record<string, string> = { "%2C": ",", "%3A": ":", "%5B": "[", "%5D": "]", "%2F": "/", "%22": '"', "%7B": "{", "%7D": "}" };
  return form.toString().replace(/%(2C|3A|5B|5D|2F|22|7B|7D)/g, (code) => readable[code] ?? code);
}

const toBase64url = (bytes: Uint8Array) => {
  let text = "";
  for (let i = 0; i < bytes.length; i += 0x8000) text += String.fromCharCode(...bytes.subarray(i, i + 0x8000));
  return btoa(text).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
};

const fromBase64url = (text: string) =>
  Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (c) => c.charCodeAt(0));

async function through(bytes: Uint8Array, stream: CompressionStream | DecompressionStream, most: number): Promise<Uint8Array> {
  const source = new Blob([bytes as BlobPart]).stream() as ReadableStream;
  const reader = source.pipeThrough(stream as unknown as ReadableWritablePair).getReader();
  const parts: Uint8Array[] = [];
  let size = 0;
  for (;;) {
    const { done, value } = (await reader.read()) as { done: boolean; value?: Uint8Array };
    if (done || !value) break;
    size += value.length;
    if (size > most) {
      await reader.cancel();
      throw new Error("too long");
    }
    parts.push(value);
  }
  const whole = new Uint8Array(size);
  let offset = 0;
  for (const part of parts) {
    whole.set(part, offset);
    offset += part.length;
  }
  return whole;
}

/** The fragment (without `#`) of a form: packed where it is long. */
export async function pack(form: URLSearchParams): Promise<string> {
  const text = formText(form);
  if (text.length <= LONGEST_PLAIN) return text;
  const packed = await through(new TextEncoder().encode(text), new CompressionStream("deflate-raw"), Infinity);
  return `z=${toBase64url(packed)}`;
}

/** The form of a fragment (without `#`). */
export async function unpack(fragment: string): Promise<{ form: URLSearchParams; problems: Problem[] }> {
  const form = new URLSearchParams(fragment);
  const packed = form.get("z");
  if (packed === null) return { form, problems: [] };
  try {
    const bytes = await through(fromBase64url(packed), new DecompressionStream("deflate-raw"), LONGEST_UNPACKED);
    return { form: new URLSearchParams(new TextDecoder("utf-8", { fatal: true }).decode(bytes)), problems: [] };
  } catch {
    form.delete("z");
    return { form, problems: [{ key: "z", what: "unreadable" }] };
  }
}
