// Red, green and blue as three numbers that can be set.

import { t } from "../words.ts";
import { spin } from "./fields.ts";

/** The channels with their labels. */
const CHANNELS = [
  ["red", "Red"],
  ["green", "Green"],
  ["blue", "Blue"],
] as const;

type Channel = (typeof CHANNELS)[number];

/** `name` is the accessible name of a channel's number; `set` takes the channel's place and its value. */
export function colorSpins(values: readonly number[], name: (channel: Channel[0], label: Channel[1]) => string, set: (i: number, value: number) => void) {
  return CHANNELS.map(([channel, label], i) => spin(t(label), values[i] ?? 0, (v) => set(i, v), { name: name(channel, label), min: 0, step: 0.05 }));
}

/** Sets a colour as a whole. */
export const wholeColor = (values: readonly number[], set: (values: number[]) => void) => (i: number, value: number) =>
  set(values.map((v, k) => (k === i ? value : v)));
