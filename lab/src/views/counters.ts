// `region "Counters"`: what the renderer counted, as `--stats`.

import { html, type TemplateResult } from "lit-html";
import type { App } from "../app.ts";
import { valueText } from "../parts/numbers.ts";
import { table } from "../parts/table.ts";
import { t, translated } from "../words.ts";

export function counters(app: App): TemplateResult {
  const list = app.picture?.value.counters ?? [];
  const rows = list.map(({ name, value, meaning }) => [name, typeof value === "number" ? value : valueText(value), translated(meaning)]);
  return html`<section class="region" aria-labelledby="counters-title">
    <h2 id="counters-title">${t("Counters")}</h2>
    ${table({ name: t("Counters"), columns: [t("name"), t("value"), t("meaning")], rows }, () => app.changed())}
  </section>`;
}
