// Starts the page.

import { render } from "lit-html";
import type { Catalog } from "./answers.ts";
import { App } from "./app.ts";
import type { UserFile } from "./engine.ts";
import { acceptDrops, startFiles } from "./files.ts";
import { talkToParent } from "./frame.ts";
import { listenToKeys } from "./keys.ts";
import { page } from "./page.ts";
import { followPixel, listenToEscape } from "./views/chosen.ts";
import { readTexts, setLanguage, t } from "./words.ts";
import { browserLanguage } from "./app.ts";
import { onWidthChange } from "./width.ts";

/** What the browser has to have. */
function lacking(): string[] {
  // A module with one function that uses a vector of 128 bits.
  const simd = Uint8Array.of(0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11);
  const missing: string[] = [];
  if (typeof WebAssembly !== "object") missing.push("WebAssembly");
  else if (!WebAssembly.validate(simd)) missing.push("WebAssembly SIMD");
  if (typeof MathMLElement === "undefined") missing.push("MathML");
  if (typeof DecompressionStream === "undefined") missing.push("DecompressionStream");
  return missing;
}

/** Lets the keyboard into what can be scrolled, and past what need not be. */
function markScrollers(root: HTMLElement) {
  for (const e of root.querySelectorAll<HTMLElement>(".scroll[role=group]")) {
    const canScroll = e.scrollHeight > e.clientHeight + 1 || e.scrollWidth > e.clientWidth + 1;
    if (canScroll) e.tabIndex = 0;
    else if (e !== document.activeElement) e.removeAttribute("tabindex");
  }
}

async function start() {
  const root = document.getElementById("lab")!;
  const hash = new URLSearchParams(location.hash.slice(1)).get("lang");
  setLanguage(hash === "ro" || hash === "fr" || hash === "pt" || hash === "en" ? hash : browserLanguage());
  const missing = lacking();
  if (!missing.includes("DecompressionStream")) await readTexts();
  const app = new App();
  app.onRender(() => {
    followPixel(app);
    render(page(app), root);
    app.after("scrollers", 200, () => markScrollers(root));
  });
  app.changed();
  if (missing.length) return app.fail(t("This browser lacks {0}", missing.join(", ")));

  // Open what the page was made for.
  const { ok } = await app.engine.ask("catalog", { want: "catalog" });
  app.catalog = ok as unknown as Catalog;
  const given = document.getElementById("lab-start")?.textContent;
  if (given) app.opening.start = JSON.parse(given) as typeof app.opening.start;
  try {
    const files = await startFiles(app.opening.start.files ?? []);
    if (files.length) await takeStartFiles(app, files);
  } catch (e) {
    app.fail(e instanceof Error ? e.message : String(e));
  }
  listenToKeys(app);
  onWidthChange(() => app.changed());
  listenToEscape(app);
  acceptDrops(app);
  talkToParent(app);
  await app.opening.open(location.hash.slice(1));
  const reread = () => {
    if (app.address.isOwn()) return;
    void app.opening.open(location.hash.slice(1));
  };
  addEventListener("hashchange", reread);
  addEventListener("popstate", reread);
}

/** Names the models that were served by the content of their files. */
async function takeStartFiles(app: App, files: UserFile[]) {
  await app.own.give(files);
  app.opening.start.models = (app.opening.start.models ?? []).map((m) => {
    const hash = m.startsWith("file:") ? app.own.hashes.get(m.slice(5)) : undefined;
    return hash === undefined ? m : `${m}#${hash}`;
  });
}

void start();
