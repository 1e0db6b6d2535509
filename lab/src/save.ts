// Saving to files and copying to the clipboard.

import type { App } from "./app.ts";
import { wordsOf } from "./engine.ts";
import { t } from "./words.ts";

/** The model's name without kind, hash and ending. */
export function modelName(app: App): string {
  const model = String((app.get("models") as string[] | undefined)?.[0] ?? "picture");
  return model.replace(/^(builtin|file):/, "").replace(/#.*$/, "").replace(/^.*[/\\]/, "").replace(/\.[^.]+$/, "") || "picture";
}

function download(blob: Blob, name: string) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

async function textOf(app: App, what: "state" | "command" | "drawing"): Promise<string | null> {
  try {
    const { ok } = await app.engine.ask(`save ${what}`, { want: "save", what, state: app.state, lang: app.language });
    return String(ok["text"]);
  } catch (e) {
    app.fail(wordsOf(e));
    return null;
  }
}

export async function savePicture(app: App) {
  const canvas = document.querySelector<HTMLCanvasElement>('[role="application"] canvas');
  const blob = await new Promise<Blob | null>((resolve) => (canvas ? canvas.toBlob(resolve, "image/png") : resolve(null)));
  if (blob) download(blob, `${modelName(app)}.png`);
}

export async function saveDrawing(app: App) {
  const text = await textOf(app, "drawing");
  if (text !== null) download(new Blob([text], { type: "image/svg+xml" }), `${modelName(app)}.svg`);
}

export async function saveState(app: App) {
  const text = await textOf(app, "state");
  if (text !== null) download(new Blob([text], { type: "application/json" }), `${modelName(app)}.json`);
}

async function copy(app: App, text: string, said: string) {
  try {
    await navigator.clipboard.writeText(text);
    app.say(said);
  } catch {
    // Without the permission, the selection of a field can still be copied.
    const field = document.createElement("textarea");
    field.value = text;
    field.setAttribute("aria-label", said);
    document.body.append(field);
    field.select();
    const isDone = document.execCommand("copy");
    field.remove();
    if (isDone) app.say(said);
    else app.fail(t("The browser does not let the page copy"));
  }
}

async function link(app: App, layout?: "figure"): Promise<string> {
  const situation = layout ? { ...app.situation, lab: { ...app.lab, layout } } : app.situation;
  const url = new URL(location.href);
  url.hash = await app.fragment(situation);
  return url.href;
}

export async function copyLink(app: App) {
  await app.address.settle();
  await copy(app, await link(app), t("Link copied"));
}

export async function copyCommand(app: App) {
  const text = await textOf(app, "command");
  if (text !== null) await copy(app, text, t("Command copied"));
}

export async function copyEmbed(app: App) {
  const source = (await link(app, "figure")).replaceAll("&", "&amp;").replaceAll('"', "&quot;");
  await copy(app, `<iframe src="${source}" width="800" height="620" title="vitral Lab" allow="clipboard-write"></iframe>`, t("Embed code copied"));
}
