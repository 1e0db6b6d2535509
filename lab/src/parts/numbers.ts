// Numbers as text: a decimal point in every language, six digits.

import type { Json } from "../json.ts";

export function number(value: number): string {
  if (!Number.isFinite(value)) return String(value);
  if (Number.isInteger(value) && Math.abs(value) < 1e15) return String(value);
  const size = Math.abs(value);
  if (size < 1e-4 || size >= 1e7) return value.toExponential(3);
  return String(Number(value.toPrecision(6)));
}

/** Any value as text: lists as numbers with commas. */
export function valueText(value: Json | undefined): string {
  if (value === null || value === undefined) return "–";
  if (typeof value === "number") return number(value);
  if (typeof value === "string") return value;
  if (typeof value === "boolean") return value ? "✓" : "–";
  if (Array.isArray(value)) return value.map(valueText).join(", ");
  return Object.entries(value)
    .map(([k, v]) => `${k} ${valueText(v)}`)
    .join(", ");
}
