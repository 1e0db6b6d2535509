// Files of the user: chosen or dropped, several at once. Nothing leaves the page.

import type { App } from "./app.ts";
import type { UserFile } from "./engine.ts";

async function readAll(files: File[]): Promise<UserFile[]> {
  return Promise.all(files.map(async (f) => ({ name: f.name, bytes: new Uint8Array(await f.arrayBuffer()) })));
}

export function pickFiles(app: App) {
  const input = document.createElement("input");
  input.type = "file";
  input.multiple = true;
  input.onchange = async () => app.own.open(await readAll([...(input.files ?? [])]));
  input.click();
}

export function acceptDrops(app: App) {
  addEventListener("dragover", (e) => {
    if (!e.dataTransfer?.types.includes("Files")) return;
    e.preventDefault();
    document.body.classList.add("dropping");
  });
  addEventListener("dragleave", (e) => {
    if (!e.relatedTarget) document.body.classList.remove("dropping");
  });
  addEventListener("drop", (e) => {
    document.body.classList.remove("dropping");
    const files = [...(e.dataTransfer?.files ?? [])];
    if (!files.length) return;
    e.preventDefault();
    void readAll(files).then((list) => app.own.open(list));
  });
}

/** Files that were served or put in with the page. */
export async function startFiles(served: { name: string; url: string }[]): Promise<UserFile[]> {
  const fetched = served.map(async ({ name, url }) => {
    const answer = await fetch(url);
    if (!answer.ok) throw new Error(`${name}: ${answer.status} ${answer.statusText}`);
    return { name, bytes: new Uint8Array(await answer.arrayBuffer()) };
  });
  const inside = [...document.querySelectorAll<HTMLScriptElement>("script.lab-file")].map((e) => ({
    name: e.dataset["name"] ?? "",
    bytes: Uint8Array.from(atob((e.textContent ?? "").replace(/\s+/g, "")), (c) => c.charCodeAt(0)),
  }));
  return [...inside, ...(await Promise.all(fetched))];
}
