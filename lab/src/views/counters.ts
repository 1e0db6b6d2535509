// `region "Counters"`: what the renderer counted, as `--stats`.

import { html, type TemplateResult } from "lit-html";
import type { App } from "../app.ts";
import { valueText } from "../parts/numbers.ts";
import { table } from "../parts/table.ts";
import { words } from "../parts/what.ts";
import { t, translated } from "../words.ts";
import { surfaceColors } from "./evaluations.ts";

export function counters(app: App): TemplateResult {
  const picture = app.picture?.value;
  const rows = (picture?.counters ?? []).map(({ name, value, meaning }) => [name, typeof value === "number" ? value : valueText(value), translated(meaning)]);
  const colors = surfaceColors(app);
  if (colors !== null) rows.unshift(["colors", colors, t("different colours of surfaces, with one sample a pixel")]);
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
