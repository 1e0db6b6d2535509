// Drawing of a BSP tree: its nodes as they are built, and their numbers from back to front.

import { nothing, type TemplateResult } from "lit-html";
import type { App } from "../../app.ts";
import type { JsonObject } from "../../json.ts";
import { t } from "../../words.ts";
import { chosenFinder, isChosen } from "../chosen.ts";
import { doneOf } from "../recorded.ts";
import { leftOutOf, links, type LinkedNode } from "./links.ts";
import { sheet } from "./sheet.ts";

export function bspDrawing(app: App, present: JsonObject): TemplateResult | typeof nothing {
  const built = doneOf(app, "tree-node");
  const all = built.length ? built : present["step"] === "tree-node" ? [present] : [];
  if (!all.length) return nothing;
  const visits = new Map(doneOf(app, "tree-visit").map((s) => [s["node"], Number(s["order"])]));
  const nodes = all.map((s): LinkedNode => ({
    id: Number(s["node"]),
    parent: typeof s["above"] === "number" ? s["above"] : null,
    side: s["side"] === "front" ? 1 : 0,
    look: () => {
      const order = visits.get(s["node"]);
      const splitter = typeof s["splitter"] === "number" ? s["splitter"] : null;
      return {
        text: String(s["node"]),
        title: t("node {0}: divides along facet {1}", String(s["node"]), String(splitter ?? "–")),
        style: `${order === undefined ? "" : "visited"}${isChosen(app, splitter) ? " chosen" : ""}`,
        facet: splitter,
        at: typeof s["at"] === "number" ? s["at"] : null,
        below: order === undefined ? "" : `${order + 1}.`,
      };
    },
  }));
  const current = typeof present["node"] === "number" ? present["node"] : null;
  const finder = chosenFinder(app);
  const chosen = finder ? all.find((s) => typeof s["splitter"] === "number" && finder(s["splitter"])) : undefined;
  const drawn = links(nodes, current, chosen ? Number(chosen["node"]) : current);
  return sheet(app, {
    name: t("Drawing of the BSP tree"),
    height: drawn.height,
    content: drawn.content,
    legend: [
      ["d-node", t("node; left: back, right: front")],
      ["d-visited", t("visited; below: its place from the back")],
      ["d-present", t("the present node")],
      ...(drawn.leftOut > 0 ? [["d-more", t("more below")] as [string, string]] : []),
    ],
    note: leftOutOf(drawn),
  });
}
