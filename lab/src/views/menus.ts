// `menubar "Main menu"`: Lab3D's menus, with arrow keys as people know them from programs.

import { html, nothing, type TemplateResult } from "lit-html";
import type { App } from "../app.ts";
import { pickFiles } from "../files.ts";
import { equal, type Json } from "../json.ts";
import { copyCommand, copyEmbed, copyLink, saveDrawing, savePicture, saveState } from "../save.ts";
import { t, translated } from "../words.ts";
import { start } from "./exercise.ts";

interface Entry {
  label: string;
  kind: "item" | "radio" | "check" | "line";
  isChecked?: boolean;
  action?: () => void;
}

interface Menu {
  name: string;
  entries: Entry[];
}

const item = (label: string, action: () => void): Entry => ({ label, kind: "item", action });
const LINE: Entry = { label: "", kind: "line" };

/** What Lab3D's OpenGL did, and the course's usual way. */
const OPENGL: Record<string, Json> = {
  "settings.visibility": "z-buffer",
  "settings.shading": "gouraud",
  "settings.illumination": "blinn-phong",
  "settings.color-space": "raw",
};

function menus(app: App): Menu[] {
  const radio = (label: string, isChecked: boolean, action: () => void): Entry => ({ label, kind: "radio", isChecked, action });
  const check = (label: string, isChecked: boolean, action: () => void): Entry => ({ label, kind: "check", isChecked, action });
  const model = JSON.stringify(app.get("models") ?? []);
  const scene = (label: string, name: string) => radio(label, model === JSON.stringify([name]), () => app.openModels([name]));
  const works = (app.catalog?.exercises ?? []).filter((e) => /^[45]\.\d$/.test(e.id));
  const defaults = app.catalog?.defaults ?? {};
  const set = (fields: Record<string, Json>) => app.set(fields);
  const isOpenGL = Object.entries(OPENGL).every(([path, value]) => equal(app.get(path), value));
  const classical = Object.fromEntries(Object.keys(OPENGL).map((path) => [path, settingOf(defaults, path)]));
  const isClassical = Object.entries(classical).every(([path, value]) => equal(app.get(path), value));
  const lines = String(app.get("settings.lines"));
  const lineRadio = (label: string, value: string) => radio(label, lines === value, () => set({ "settings.lines": value }));
  const hasOverview = app.catalog?.wants?.includes("overview");
  return [
    {
      name: t("File"),
      entries: [
        item(t("Open model…"), () => pickFiles(app)),
        item(t("Save picture…"), () => void savePicture(app)),
        item(t("Save drawing…"), () => void saveDrawing(app)),
        item(t("Save state…"), () => void saveState(app)),
        LINE,
        item(t("Copy link"), () => void copyLink(app)),
        item(t("Copy command"), () => void copyCommand(app)),
        item(t("Copy embed code"), () => void copyEmbed(app)),
      ],
    },
    {
      name: t("Exercises"),
      entries: [
        scene("Cubs", "builtin:cubs"),
        scene("Sphere", "builtin:sphere"),
        scene("Scene 0", "builtin:scene0"),
        scene("Scene 1", "builtin:scene1"),
        LINE,
        ...works.map((e) => item(e.id.startsWith("4") ? t("Work {0}", e.id) : t("Exercise {0}", e.id), () => start(app, e))),
      ],
    },
    {
      name: t("Select"),
      entries: [
        radio("OpenGL", isOpenGL, () => set(OPENGL)),
        radio(t("Classical"), isClassical, () => set(classical)),
        LINE,
        item(t("Lights…"), () => app.dialogs.open("lights", menuButton(2))),
        item(t("Materials…"), () => app.dialogs.open("materials", menuButton(2))),
        item(t("Camera…"), () => app.dialogs.open("camera", menuButton(2))),
      ],
    },
    {
      name: t("View"),
      entries: [
        check(t("Lighting"), app.get("settings.lighting") === true, () => set({ "settings.lighting": app.get("settings.lighting") !== true })),
        check(t("Normals"), app.get("load.normals") !== "none", () =>
          set({ "load.normals": app.get("load.normals") === "none" ? "file" : "none" }),
        ),
        ...(hasOverview ? [check(t("Second view"), app.lab.second !== "off", () => app.setLab({ second: app.lab.second === "off" ? "on" : "off" }))] : []),
        LINE,
        lineRadio(t("Surfaces"), "none"),
        lineRadio(t("Edges"), "edges"),
        lineRadio(t("Wireframe"), "wireframe"),
        lineRadio(t("Hidden lines"), "wireframe-hidden-line"),
      ],
    },
    {
      name: t("Help"),
      entries: [
        item(t("Keyboard"), () => app.dialogs.open("keyboard", menuButton(4))),
        item(t("Language"), () => app.dialogs.open("language", menuButton(4))),
        item(t("About"), () => app.dialogs.open("about", menuButton(4))),
      ],
    },
  ];
}

const settingOf = (defaults: Record<string, Json>, path: string): Json => {
  const [, field = ""] = path.split(".");
  return (defaults["settings"] as Record<string, Json> | undefined)?.[field] ?? null;
};

/** The open menu and the tab stop of the bar. */
let open: number | null = null;
let stop = 0;

const bar = () => document.querySelector<HTMLElement>('[role="menubar"]');
const menuButton = (i: number) => bar()?.querySelectorAll<HTMLElement>(":scope > div > button")[i] ?? null;
const entryButtons = (i: number) => [...(menuButton(i)?.parentElement?.querySelectorAll<HTMLElement>('[role^="menuitem"]:not([aria-haspopup])') ?? [])];

/** Whether the focus moves between menus: an entry that is taken away loses it to nothing. */
let isMoving = false;

function focusEntry(menu: number, entry: number) {
  const all = entryButtons(menu);
  all[(entry + all.length) % all.length]?.focus();
}

function setOpen(app: App, menu: number | null, entry = 0) {
  const wasOpen = open;
  open = menu;
  if (menu !== null) stop = menu;
  isMoving = true;
  app.render();
  if (menu !== null) focusEntry(menu, entry);
  else if (wasOpen !== null) menuButton(wasOpen)?.focus();
  isMoving = false;
}

/** Closes the menu that is open, if there is one; its button gets the focus. */
export function closeMenu(app: App): boolean {
  if (open === null) return false;
  setOpen(app, null);
  return true;
}

/** Closes the menu where the focus goes elsewhere. */
function focusOut(app: App, e: FocusEvent) {
  const to = e.relatedTarget as Element | null;
  if (open === null || isMoving || (to && (e.currentTarget as Element).contains(to))) return;
  open = null;
  app.changed();
}

/** Goes to a button of the bar. */
function focusButton(app: App, menu: number) {
  stop = menu;
  app.render();
  menuButton(menu)?.focus();
}

function barKeys(app: App, e: KeyboardEvent, menu: number, count: number) {
  const to = (i: number) => (i + count) % count;
  switch (e.key) {
    case "ArrowRight":
    case "ArrowLeft": {
      const next = to(menu + (e.key === "ArrowRight" ? 1 : -1));
      if (open !== null) setOpen(app, next);
      else focusButton(app, next);
      break;
    }
    case "Home":
    case "End":
      focusButton(app, e.key === "Home" ? 0 : count - 1);
      break;
    case "ArrowDown":
    case "Enter":
    case " ":
      setOpen(app, menu);
      break;
    case "ArrowUp":
      setOpen(app, menu, -1);
      break;
    default:
      return;
  }
  e.preventDefault();
}

function entryKeys(app: App, e: KeyboardEvent, menu: number, count: number) {
  const all = entryButtons(menu);
  const at = all.indexOf(e.target as HTMLElement);
  switch (e.key) {
    case "ArrowDown":
      focusEntry(menu, at + 1);
      break;
    case "ArrowUp":
      focusEntry(menu, at - 1);
      break;
    case "Home":
      focusEntry(menu, 0);
      break;
    case "End":
      focusEntry(menu, -1);
      break;
    case "ArrowRight":
    case "ArrowLeft":
      setOpen(app, (menu + (e.key === "ArrowRight" ? 1 : -1) + count) % count);
      break;
    case "Tab":
      open = null;
      app.changed();
      return;
    default: {
      // A letter goes to the next entry that begins with it.
      if (e.key.length !== 1 || e.key === " ") return;
      const letter = e.key.toLowerCase();
      const next = [...all.slice(at + 1), ...all.slice(0, at + 1)].find((b) => b.textContent?.trim().toLowerCase().startsWith(letter));
      next?.focus();
    }
  }
  e.preventDefault();
  e.stopPropagation();
}

const ROLES = { item: "menuitem", radio: "menuitemradio", check: "menuitemcheckbox", line: "separator" } as const;

export function menubar(app: App): TemplateResult {
  const all = menus(app);
  const entry = (menu: number) => (e: Entry) => {
    if (e.kind === "line") return html`<div role="separator"></div>`;
    const act = () => {
      setOpen(app, null);
      e.action?.();
    };
    const mark = e.kind === "item" ? nothing : html`<span class="mark" aria-hidden="true">${e.isChecked ? (e.kind === "radio" ? "●" : "✓") : ""}</span>`;
    return html`<button
      type="button"
      role=${ROLES[e.kind]}
      tabindex="-1"
      aria-checked=${e.kind === "item" ? nothing : String(e.isChecked)}
      @click=${act}
      @keydown=${(k: KeyboardEvent) => entryKeys(app, k, menu, all.length)}
    >
      ${mark}${translated(e.label)}
    </button>`;
  };
  return html`<div role="menubar" aria-label=${t("Main menu")} @focusout=${(e: FocusEvent) => focusOut(app, e)}>
    ${all.map(
      ({ name, entries }, i) => html`<div role="none" class="menu">
        <button
          type="button"
          role="menuitem"
          aria-haspopup="menu"
          aria-expanded=${String(open === i)}
          tabindex=${i === stop ? "0" : "-1"}
          @click=${() => setOpen(app, open === i ? null : i)}
          @pointerenter=${() => open !== null && open !== i && setOpen(app, i)}
          @keydown=${(e: KeyboardEvent) => barKeys(app, e, i, all.length)}
        >
          ${name}
        </button>
        ${open === i ? html`<div role="menu" aria-label=${name}>${entries.map(entry(i))}</div>` : nothing}
      </div>`,
    )}
  </div>`;
}
