// Trees with arrow keys: one node is a tab stop, long trees show a window of nodes.

import { html, nothing, type TemplateResult } from "lit-html";
import { ref } from "lit-html/directives/ref.js";
import type { Choice } from "./choice.ts";
import { css } from "./css.ts";

export interface Node {
  id: number;
  parent: number | null;
  text: string;
  choice?: Choice | null;
}

export interface Tree {
  name: string;
  nodes: Node[];
  /** The node of the present step. */
  current?: number | null | undefined;
  /** Whether a node that was chosen is brought into view in place of the present one. */
  followsChoice?: boolean;
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

export function tree(t: Tree, changed: () => void): TemplateResult {
  let look = looks.get(t.name);
  if (!look) looks.set(t.name, (look = { closed: new Set(), focus: null, offset: 0, target: null }));
  const own = look;

  // Put children below their parents.
  const ids = new Set(t.nodes.map((n) => n.id));
  const children = new Map<number | null, Node[]>();
  for (const node of t.nodes) {
    const parent = node.parent !== null && ids.has(node.parent) ? node.parent : null;
    const list = children.get(parent);
    if (list) list.push(node);
    else children.set(parent, [node]);
  }

  // Open the way to the present or chosen node when it changes.
  const byId = new Map(t.nodes.map((n) => [n.id, n]));
  const current = t.current ?? null;
  const marked = t.followsChoice ? t.nodes.filter((n) => n.choice?.isChosen).map((n) => n.id) : [];
  const target = marked.length === 0 || (current !== null && marked.includes(current)) ? current : marked[0]!;
  const isNew = target !== null && byId.has(target) && target !== own.target;
  if (isNew) {
    for (let n = byId.get(target)?.parent ?? null; n !== null; n = byId.get(n)?.parent ?? null) own.closed.delete(n);
    own.focus = target;
  }
  // A node that is not here yet is looked for again.
  own.target = target !== null && byId.has(target) ? target : null;

  // List the nodes that are to be seen.
  const shown: { node: Node; level: number; place: number; among: number }[] = [];
  const stack = [...(children.get(null) ?? [])].reverse().map((node, i, all) => ({ node, level: 1, place: all.length - i, among: all.length }));
  for (let top = stack.pop(); top; top = stack.pop()) {
    shown.push(top);
    const below = children.get(top.node.id) ?? [];
    if (own.closed.has(top.node.id)) continue;
    for (let i = below.length - 1; i >= 0; i--) stack.push({ node: below[i]!, level: top.level + 1, place: i + 1, among: below.length });
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
    const hasChildren = children.has(here.node.id);
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
        here.node.choice?.choose();
        break;
      default:
        return;
    }
    e.preventDefault();
    e.stopPropagation();
  };

  const item = ({ node, level, place, among }: (typeof shown)[number], i: number) => {
    const hasChildren = children.has(node.id);
    const isOpen = hasChildren && !own.closed.has(node.id);
    const toggle = (e: Event) => {
      e.stopPropagation();
      if (isOpen) own.closed.add(node.id);
      else own.closed.delete(node.id);
      changed();
    };
    const click = () => {
      own.focus = node.id;
      node.choice?.choose();
      changed();
    };
    const isMarked = node.choice?.isChosen ?? false;
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
      <span class="twist" aria-hidden="true" @click=${toggle}>${hasChildren ? (isOpen ? "▾" : "▸") : "·"}</span>${node.text}
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
