// Values of `table "Scene"` as cells.

import { html } from "lit-html";
import type { Json } from "../json.ts";
import { css } from "../parts/css.ts";
import { number } from "../parts/numbers.ts";
import type { Cell } from "../parts/table.ts";
import { t } from "../words.ts";

/** Texts stand where numbers stand. */
const aligned = (text: string): Cell => html`<span .style=${css({ display: "block", "text-align": "end" })}>${text}</span>`;

/** A value of the scene: booleans are words, colours three numbers. */
export function sceneValue(value: Json | undefined): Cell {
  if (typeof value === "boolean") return aligned(value ? t("yes") : t("no"));
  if (typeof value === "number") return value;
  const parts = String(value ?? "–").split(" ");
  const isColor = parts.every((p) => p !== "" && Number.isFinite(Number(p)));
  return aligned(isColor ? parts.map((p) => number(Number(p))).join(" ") : parts.join(" "));
}
