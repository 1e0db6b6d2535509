// Trees with arrow keys: one node is a tab stop, long trees show a window of nodes.

import { html, nothing, type TemplateResult } from "lit-html";
import { ref } from "lit-html/directives/ref.js";
import type { Choice } from "./choice.ts";
import { css } from "./css.ts";

export interface Node {
  id: number;
  parent: number | null;
  text: () => string;
  choice?: () => Choice | null;
  /** The facet that the node stands for. */
  facet?: number | null;
}

export interface Tree {
  name: string;
  /** A list that is the same one is read once. */
  nodes: Node[];
  /** How many of the nodes are there. */
  count?: number;
  /** The node of the present step. */
  current?: number | null | undefined;
  /** Finds the chosen node, where it is brought into view in place of the present one. */
  isChosen?: ((facet: number) => boolean) | null;
}

interface Looks {
  closed: Set<number>;
  focus: number | null;
  offset: number;
  target: number | null;
}

const ROW = 26;
const MOST_ROWS = 200;

const looks = new Map<string, Looks>();

interface Relations {
  /** Where each node stands in the list. */
  places: Map<number, number>;
  /** The places of those below each node; of the roots below `null`. */
  below: Map<number | null, number[]>;
}

const relations = new WeakMap<Node[], Relations>();

function relationsOf(nodes: Node[]): Relations {
  let known = relations.get(nodes);
  if (known) return known;
  const places = new Map(nodes.map((n, i) => [n.id, i]));
  const below: Relations["below"] = new Map();
  nodes.forEach((node, i) => {
    const parent = node.parent !== null && places.has(node.parent) ? node.parent : null;
    const list = below.get(parent);
    if (list) list.push(i);
    else below.set(parent, [i]);
  });
  relations.set(nodes, (known = { places, below }));
  return known;
}

export function tree(t: Tree, changed: () => void): TemplateResult {
  let look = looks.get(t.name);
  if (!look) looks.set(t.name, (look = { closed: new Set(), focus: null, offset: 0, target: null }));
  const own = look;

  // Leave out nodes that are not there yet: they stand behind the others.
  const { places, below } = relationsOf(t.nodes);
  const count = t.count ?? t.nodes.length;
  const nodeOf = (id: number | null) => {
    const place = id === null ? undefined : places.get(id);
    return place !== undefined && place < count ? t.nodes[place] : undefined;
  };
  const childrenOf = (id: number | null) => {
    const all = below.get(id) ?? [];
    return all.length && all[all.length - 1]! >= count ? all.filter((place) => place < count) : all;
  };

  // Open the way to the present or chosen node when it changes.
  const current = t.current ?? null;
  const isMarked = t.isChosen;
  const marks = (n: Node | undefined) => Boolean(isMarked && n && typeof n.facet === "number" && isMarked(n.facet));
  const marked = isMarked && !marks(nodeOf(current)) ? t.nodes.findIndex((n, i) => i < count && marks(n)) : -1;
  const target = marked >= 0 ? t.nodes[marked]!.id : current;
  const isNew = nodeOf(target) !== undefined && target !== own.target;
  if (isNew) {
    for (let n = nodeOf(target)?.parent; n !== undefined && n !== null; n = nodeOf(n)?.parent) own.closed.delete(n);
    own.focus = target;
  }
  // A node that is not here yet is looked for again.
  own.target = nodeOf(target) ? target : null;

  // List the nodes that are to be seen.
  const shown: { node: Node; level: number; place: number; among: number }[] = [];
  const stack: typeof shown = [];
  const push = (id: number | null, level: number) => {
    const children = childrenOf(id);
    for (let i = children.length - 1; i >= 0; i--) stack.push({ node: t.nodes[children[i]!]!, level, place: i + 1, among: children.length });
  };
  push(null, 1);
  for (let top = stack.pop(); top; top = stack.pop()) {
    shown.push(top);
    if (!own.closed.has(top.node.id)) push(top.node.id, top.level + 1);
  }
  const focusAt = Math.max(0, shown.findIndex((s) => s.node.id === own.focus));
  const isLong = shown.length > MOST_ROWS;
  if (isNew && isLong) own.offset = Math.max(0, focusAt - 6);
  const first = isLong ? Math.max(0, Math.min(own.offset - 20, shown.length - 100)) : 0;
  const visible = isLong ? shown.slice(first, first + 100) : shown;

  const move = (index: number, box: HTMLElement) => {
    const target = shown[Math.max(0, Math.min(index, shown.length - 1))];
    if (!target) return;
    own.focus = target.node.id;
    if (isLong && (index < first + 2 || index > first + 96)) {
      own.offset = Math.max(0, index - 10);
      (box.closest(".scroll") as HTMLElement).scrollTop = own.offset * ROW;
    }
    changed();
    setTimeout(() => box.querySelector<HTMLElement>('[tabindex="0"]')?.focus(), 40);
  };
  const keys = (e: KeyboardEvent) => {
    const box = e.currentTarget as HTMLElement;
    const here = shown[focusAt];
    if (!here) return;
    const isClosed = own.closed.has(here.node.id);
    const hasChildren = childrenOf(here.node.id).length > 0;
    switch (e.key) {
      case "ArrowDown":
        move(focusAt + 1, box);
        break;
      case "ArrowUp":
        move(focusAt - 1, box);
        break;
      case "Home":
        move(0, box);
        break;
      case "End":
        move(shown.length - 1, box);
        break;
      case "ArrowRight":
        if (hasChildren && isClosed) own.closed.delete(here.node.id);
        else if (hasChildren) move(focusAt + 1, box);
        changed();
        break;
      case "ArrowLeft":
        if (hasChildren && !isClosed) own.closed.add(here.node.id);
        else move(shown.findIndex((s) => s.node.id === here.node.parent), box);
        changed();
        break;
      case "Enter":
      case " ":
        here.node.choice?.()?.choose();
        break;
      default:
        return;
    }
    e.preventDefault();
    e.stopPropagation();
  };

  const item = ({ node, level, place, among }: (typeof shown)[number], i: number) => {
    const hasChildren = childrenOf(node.id).length > 0;
    const isOpen = hasChildren && !own.closed.has(node.id);
    const choice = node.choice?.();
    const toggle = (e: Event) => {
      e.stopPropagation();
      if (isOpen) own.closed.add(node.id);
      else own.closed.delete(node.id);
      changed();
    };
    const click = () => {
      own.focus = node.id;
      choice?.choose();
      changed();
    };
    const isMarked = choice?.isChosen ?? false;
    return html`<li
      role="treeitem"
      class=${`${node.id === current ? "current" : ""}${isMarked ? " chosen" : ""}`}
      aria-current=${node.id === current ? "true" : nothing}
      aria-level=${level}
      aria-posinset=${place}
      aria-setsize=${among}
      aria-expanded=${hasChildren ? String(isOpen) : nothing}
      aria-selected=${String(node.id === current || isMarked)}
      tabindex=${first + i === focusAt ? "0" : "-1"}
      .style=${css({ "padding-inline-start": `${Math.min(level - 1, 14) * 0.6 + 0.2}rem` })}
      @click=${click}
    >
      <span class="twist" aria-hidden="true" @click=${toggle}>${hasChildren ? (isOpen ? "▾" : "▸") : "·"}</span>${node.text()}
    </li>`;
  };
  const scrolled = (e: Event) => {
    if (!isLong) return;
    const at = Math.floor((e.target as HTMLElement).scrollTop / ROW);
    if (Math.abs(at - own.offset) > 10) {
      own.offset = at;
      changed();
    }
  };
  const reveal = (e: Element | undefined) => {
    if (e && isNew && isLong) setTimeout(() => (e.scrollTop = own.offset * ROW));
  };
  return html`<div class="scroll windowed" @scroll=${scrolled} ${ref(reveal)}>
    <div .style=${css({ height: isLong ? `${shown.length * ROW}px` : "auto" })}>
      <ul role="tree" aria-label=${t.name} aria-multiselectable="true" @keydown=${keys} .style=${css({ transform: `translateY(${first * ROW}px)` })}>
        ${visible.map(item)}
      </ul>
    </div>
  </div>`;
}
