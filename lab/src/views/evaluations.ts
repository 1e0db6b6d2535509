// How often each way of shading evaluates the formula of illumination (L6 to L8), and how many colours
// the surfaces have (L1).

import { html, nothing } from "lit-html";
import type { App } from "../app.ts";
import { isObject, type JsonObject } from "../json.ts";
import { table, type Cell } from "../parts/table.ts";
import { t } from "../words.ts";

/** What the engine counted; `null` until it is here. */
function tally(app: App): JsonObject | null {
  return app.answerTo("tally")?.ok ?? null;
}

/** The number of colours that surfaces have; `null` while it is not known. */
export function surfaceColors(app: App): number | null {
  const colors = tally(app)?.["colors"];
  return typeof colors === "number" ? colors : null;
}

export function evaluations(app: App): unknown {
  const counts = tally(app)?.["evaluations"];
  if (!isObject(counts ?? undefined)) return nothing;
  const of = (name: string) => Number((counts as JsonObject)[name]);
  const rows: Cell[][] = [
    ["flat", of("flat"), t("once for each visible facet")],
    ["gouraud", of("gouraud"), t("once for each vertex of a visible facet")],
    ["phong", of("phong"), t("once for each covered pixel")],
  ];
  const current = rows.findIndex(([name]) => name === app.get("settings.shading"));
  return html`<section class="region" aria-labelledby="evaluations-title">
    <h2 id="evaluations-title">${t("Evaluations of the formula")}</h2>
    ${table({ name: t("Evaluations of the formula"), columns: [t("Shading"), t("count"), t("meaning")], rows, current })}
  </section>`;
}
