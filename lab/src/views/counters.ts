// `region "Counters"`: what the renderer counted, as `--stats`.

import { html, type TemplateResult } from "lit-html";
import type { Plane, Result } from "../answers.ts";
import type { App } from "../app.ts";
import { valueText } from "../parts/numbers.ts";
import { table } from "../parts/table.ts";
import { words } from "../parts/what.ts";
import { t, translated } from "../words.ts";

/** Colours of each picture, counted once. */
const counted = new WeakMap<Result<Plane>, number>();

/** How many different colours a picture has, its background's among them. */
function colorCount(picture: Result<Plane>): number {
  const known = counted.get(picture);
  if (known !== undefined) return known;
  const { bytes } = picture.value;
  // One bit for each colour of 24 bits.
  const seen = new Uint32Array(2 ** 19);
  let count = 0;
  for (let i = 0; i + 3 < bytes.length; i += 4) {
    const color = (bytes[i]! << 16) | (bytes[i + 1]! << 8) | bytes[i + 2]!;
    const bit = 1 << (color & 31);
    if (seen[color >> 5]! & bit) continue;
    seen[color >> 5]! |= bit;
    count += 1;
  }
  counted.set(picture, count);
  return count;
}

export function counters(app: App): TemplateResult {
  const picture = app.picture?.value;
  const rows = (picture?.counters ?? []).map(({ name, value, meaning }) => [name, typeof value === "number" ? value : valueText(value), translated(meaning)]);
  if (app.finished && !app.isDragging) rows.unshift(["colors", colorCount(app.finished), t("different colours in the picture")]);
  return html`<section class="region" aria-labelledby="counters-title">
    <h2 id="counters-title">${t("Counters")}</h2>
    ${table({ name: t("Counters"), columns: [t("name"), t("value"), t("meaning")], rows }, () => app.changed())}
    ${words([
      ["facet", t("facet")],
      ["polygon", t("polygon")],
      ["surface", t("surface")],
    ])}
  </section>`;
}
