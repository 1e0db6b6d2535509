// A tree as nodes and links: round the present node, as far as there is room.

import { nothing, svg, type TemplateResult } from "lit-html";
import { t } from "../../words.ts";
import { short, WIDTH } from "./sheet.ts";

export interface LinkedNode {
  id: number;
  parent: number | null;
  /** Where it hangs below its parent: 0 left, 1 right. */
  side?: 0 | 1;
  look: () => Look;
}

export interface Look {
  text: string;
  /** What the node says in more words. */
  title: string;
  style?: string;
  facet?: number | null;
  at?: number | null;
  /** A word below the node. */
  below?: string;
}

/** Ends of branches that fit beside each other. */
const MOST_ENDS = 11;
const LEVEL = 44;

/** Levels above the present node that are drawn, and levels in all. */
const MOST_ABOVE = 4;
const MOST_LEVELS = 9;

export interface Links {
  content: TemplateResult;
  height: number;
  /** Levels above and nodes that are left out. */
  above: number;
  leftOut: number;
}

/** Draws the tree round a node: the present one, or `center`. */
export function links(nodes: LinkedNode[], current: number | null, center = current): Links {
  const byId = new Map(nodes.map((n) => [n.id, n]));
  const children = new Map<number, LinkedNode[]>();
  for (const n of nodes) {
    const list = n.parent === null ? undefined : children.get(n.parent);
    if (list) list.push(n);
    else if (n.parent !== null && byId.has(n.parent)) children.set(n.parent, [n]);
  }
  const below = (id: number) => (children.get(id) ?? []).sort((a, b) => (a.side ?? 0) - (b.side ?? 0));

  // Go up from that node, or begin at the root.
  const parentOf = (id: number) => {
    const parent = byId.get(id)?.parent ?? null;
    return parent !== null && byId.has(parent) ? parent : null;
  };
  const way: number[] = [];
  for (let at = center !== null && byId.has(center) ? center : (nodes[0]?.id ?? null); at !== null; at = parentOf(at)) way.unshift(at);
  const above = way.length <= MOST_LEVELS ? 0 : way.length - 1 - MOST_ABOVE;
  const root = way[above];
  if (root === undefined) return { content: svg``, height: 0, above: 0, leftOut: 0 };

  // Open the way to it, then level by level while the ends fit.
  const opened = new Set<number>();
  let ends = 1;
  const open = (id: number) => {
    const count = below(id).length;
    if (count === 0 || opened.has(id)) return;
    opened.add(id);
    ends += count - 1;
  };
  for (const id of way.slice(above, -1)) open(id);
  const queue: { id: number; level: number }[] = [
    { id: way[way.length - 1]!, level: way.length - 1 - above },
    { id: root, level: 0 },
  ];
  for (let i = 0; i < queue.length && i < 200; i++) {
    const { id, level } = queue[i]!;
    const own = below(id);
    if (!opened.has(id) && (ends + own.length - 1 > MOST_ENDS || level + 1 >= MOST_LEVELS)) continue;
    open(id);
    for (const child of own) if (!queue.some((q) => q.id === child.id)) queue.push({ id: child.id, level: level + 1 });
  }

  // Give each end a column, and each other node the middle of those below it.
  const places = new Map<number, [number, number]>();
  let column = 0;
  let deepest = 0;
  const gap = WIDTH / Math.max(1, ends);
  const place = (id: number, level: number): number => {
    deepest = Math.max(deepest, level);
    const own = opened.has(id) ? below(id) : [];
    const xs = own.map((child) => place(child.id, level + 1));
    const x = xs.length ? (xs[0]! + xs[xs.length - 1]!) / 2 : (column++ + 0.5) * gap;
    places.set(id, [x, 22 + level * LEVEL]);
    return x;
  };
  place(root, 0);
  const radius = Math.min(13, gap / 2 - 1.5);

  const isDrawn = (n: LinkedNode) => places.has(n.id);
  const link = (n: LinkedNode) => {
    const [from, to] = [n.parent === null ? undefined : places.get(n.parent), places.get(n.id)!];
    return from ? svg`<path class="tree-link" d=${`M${short(from[0])} ${from[1]}L${short(to[0])} ${to[1]}`} />` : nothing;
  };
  const node = (n: LinkedNode) => {
    const [x, y] = places.get(n.id)!;
    const hidden = opened.has(n.id) ? 0 : below(n.id).length;
    const look = n.look();
    const style = `node ${look.style ?? ""}${n.id === current ? " present" : ""}`;
    return svg`<g class=${style} data-facet=${String(look.facet ?? "")} data-step=${String(look.at ?? "")}><title>${look.title}</title>
      ${hidden ? svg`<path class="more" d=${`M${short(x)} ${y}l-7 ${LEVEL - 17}h14z`} />` : nothing}
      <circle cx=${short(x)} cy=${y} r=${short(radius)} />
      <text class=${look.text.length > 4 ? "name long" : "name"} x=${short(x)} y=${y + 3.5} text-anchor="middle">${look.text}</text>
      ${look.below && !hidden ? svg`<text class="below" x=${short(x)} y=${y + radius + 11} text-anchor="middle">${look.below}</text>` : nothing}</g>`;
  };
  const drawn = nodes.filter(isDrawn);
  const stem = above > 0 ? svg`<path class="tree-link dashed" d=${`M${short(places.get(root)![0])} 0V20`} />` : nothing;
  return {
    content: svg`<g class="links">${stem}${drawn.map(link)}${drawn.map(node)}</g>`,
    height: 22 + deepest * LEVEL + 34,
    above,
    leftOut: nodes.length - drawn.length,
  };
}

/** What a drawing leaves out of a tree, in words. */
export const leftOutOf = (l: Links): string => (l.leftOut > 0 ? t("left out: {0} nodes, {1} levels above", l.leftOut, l.above) : "");
