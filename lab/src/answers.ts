// The engine's answers, as the page keeps it.

import type { Json, JsonObject } from "./json.ts";

export interface Named {
  name: string;
  description: string;
}

export interface Exercise {
  id: string;
  title: string;
  page: string;
  text: string;
  hint: string;
  start: JsonObject;
}

export interface Catalog {
  algorithms: Record<string, (Named & JsonObject)[]>;
  models: { name: string; about: string }[];
  defaults: JsonObject;
  exercises: Exercise[];
  channels?: { name: string; about: string }[];
  /** What the engine can be asked for, where it says so. */
  wants?: string[];
  version: string;
}

export interface Complete {
  state: JsonObject;
  /** Why a picture of the state would be refused. */
  refusal?: { message: string; hint: string } | null;
  lights: JsonObject[];
  materials: JsonObject[];
  camera: JsonObject;
  /** Rows of the view transformation, of that of all objects, of their product. */
  matrices?: { view: number[][]; objects: number[][]; product: number[][] };
  warnings: string[];
}

export interface Counter {
  name: string;
  value: Json;
  meaning: string;
}

export interface Picture {
  width: number;
  height: number;
  description: string;
  seconds: number;
  warnings: string[];
  counters: Counter[];
  facts: JsonObject;
}

/** What a canvas shows. */
export interface Plane {
  bytes: Uint8Array;
  width: number;
  height: number;
}

export interface Recording {
  steps: number;
  groups: { name: string; count: number }[];
  /** How many of them are about the pixel that was asked about. */
  "at-pixel"?: number | null;
  /** The recording ended at its limit: there are more steps. */
  more?: boolean;
  seconds: number;
}

export interface Step {
  /** Counted from 1 among the steps that are shown, and among all. */
  number: number;
  at?: number;
  total: number;
  parent?: number | null;
  group: string;
  words: string;
  fields: JsonObject;
  structure?: JsonObject;
  drawing?: string | null;
  /** What samples round the inspected pixel hold, where the algorithm compares depths. */
  depths?: JsonObject | null;
}

export interface Agreement {
  differ: number;
  largest: number;
  surfaces: number;
  first: [number, number][];
}

/** An answer of the engine and the question that it answers. */
export interface Result<T> {
  key: string;
  value: T;
}
