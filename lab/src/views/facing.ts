// `table "V·N"`: which facets over the pixel face the viewer (P14).

import { html } from "lit-html";
import type { App } from "../app.ts";
import type { JsonObject } from "../json.ts";
import { table, type Cell } from "../parts/table.ts";
import { t } from "../words.ts";
import { objects } from "./pixel.ts";

/** Below this size V·N counts as 0: the facet is seen edge on. */
const EDGE_ON = 1e-6;

export function facing(app: App, answer: JsonObject | undefined): unknown {
  const faces = objects(answer?.["faces"]);
  if (!faces.length || !app.lab.pixel) return "";
  const verdict = (product: number) => {
    if (Math.abs(product) < EDGE_ON) return t("edge on");
    return product > 0 ? t("back face") : t("faces the viewer");
  };
  const rows = faces.map((face): Cell[] => {
    const product = Number(face["v-n"]);
    return [Number(face["facet"]), Number(face["surface"]), String(face["mesh"] ?? ""), Number(product.toFixed(4)), verdict(product)];
  });
  return html`${table({ name: "V·N", columns: [t("facet"), t("surface"), t("Mesh"), "V·N", t("verdict")], rows, caption: true })}
    <p class="note">${t("V leads from the eye to the facet, N is its normal. V·N > 0: a back face, which nobody sees on a closed body; 0: edge on. The notes print “not negative” for a back face, which would count faces seen edge on.")}</p>`;
}
