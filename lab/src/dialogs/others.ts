// The dialogs Camera, Keyboard, Language and About.

import { html, mathml, nothing, type TemplateResult } from "lit-html";
import type { App } from "../app.ts";
import { axes, eyeAngles, type Vector } from "../camera.ts";
import { LANGUAGES, type Language } from "../link.ts";
import { check, group, radio, spin } from "../parts/fields.ts";
import { t, type Key } from "../words.ts";
import { dialog } from "./dialog.ts";

/** Lab3D's eye and objects: eyeU, eyeT, allU, allT. */
export function cameraDialog(app: App): TemplateResult {
  const camera = app.complete?.value.camera ?? {};
  const vector = (name: string) => camera[name] as Vector | undefined;
  const [position, focal, up] = [vector("position"), vector("focal-point"), vector("view-up")];
  const rotation = (app.get("viewpoint.eye-rotation") as Vector | null) ?? (position && focal && up ? eyeAngles(axes(position, focal, up)) : [0, 0, 0]);
  const translation = (app.get("viewpoint.eye-translation") as Vector | null) ?? position ?? [0, 0, 0];

  // The eye is given whole: nothing else moves it then.
  const fixedEye = (changed: Partial<Record<"eye-rotation" | "eye-translation", number[]>>) => {
    const angle = app.get("viewpoint.view-angle") ?? camera["view-angle"] ?? null;
    return {
      ...Object.fromEntries(["view", "camera-index", "position", "focal-point", "view-up", "direction"].map((k) => [`viewpoint.${k}`, null])),
      "viewpoint.azimuth-angle": 0,
      "viewpoint.elevation-angle": 0,
      "viewpoint.zoom-factor": 1,
      "viewpoint.view-angle": typeof angle === "number" ? round(angle) : null,
      "viewpoint.eye-rotation": changed["eye-rotation"] ?? rotation.map(round),
      "viewpoint.eye-translation": changed["eye-translation"] ?? translation.map(round),
    };
  };
  const setEye = (field: "eye-rotation" | "eye-translation", i: number) => (v: number) => {
    const to = (field === "eye-rotation" ? rotation : translation).map(round);
    to[i] = v;
    app.set(fixedEye({ [field]: to }));
  };
  const round = (v: number) => Number(v.toFixed(4));
  const objects = (field: "rotation" | "translation") => (app.get(`objects.${field}`) as Vector | undefined) ?? [0, 0, 0];
  const setObjects = (field: "rotation" | "translation", i: number) => (v: number) => {
    const to = [...objects(field)];
    to[i] = v;
    // The eye stays where it is: a framed one would follow the objects.
    app.set({ ...fixedEye({}), [`objects.${field}`]: to });
  };
  const three = (legend: Key, prefix: "eyeU" | "eyeT" | "allU" | "allT", values: readonly number[], set: (i: number) => (v: number) => void, step: number) =>
    group(
      t(legend),
      ["x", "y", "z"].map((axis, i) => spin(`${prefix}${axis}`, round(values[i] ?? 0), set(i), { step })),
      "in-row",
      prefix,
      prefix,
    );
  const angle = app.get("viewpoint.view-angle") ?? camera["view-angle"] ?? 30;
  const isParallel = app.get("viewpoint.orthographic") === true;
  return dialog(
    app,
    "camera",
    t("Camera"),
    html`${three("Rotation of the eye, degrees", "eyeU", rotation, (i) => setEye("eye-rotation", i), 5)}
    ${three("Place of the eye", "eyeT", translation, (i) => setEye("eye-translation", i), 0.5)}
    ${three("Rotation of all objects, degrees", "allU", objects("rotation"), (i) => setObjects("rotation", i), 5)}
    ${three("Move of all objects", "allT", objects("translation"), (i) => setObjects("translation", i), 0.5)}
    <div class="row-of-fields">
      ${spin(t("View angle"), typeof angle === "number" ? angle : 30, (v) => app.set({ "viewpoint.view-angle": v }), {
        min: 1,
        max: 179,
        step: 1,
        reason: isParallel ? t("A parallel projection has no angle") : null,
        term: "View angle",
      })}
      ${check(t("Parallel"), isParallel, (on) => app.set({ "viewpoint.orthographic": on }), { term: "Parallel" })}
    </div>
    ${matrices(app)}`,
  );
}

/** The product of the view transformation and that of all objects, written out. */
function matrices(app: App): unknown {
  const all = app.complete?.value.matrices;
  if (!all) return nothing;
  const rows = (m: number[][]) => m.map((row) => row.map((v) => String(Number(v.toFixed(4)) || 0)));
  const matrix = (m: number[][], name: string) => html`<div role="group" aria-label=${name}>
    <span class="label">${name}</span>
    <math><mtable>${rows(m).map((row) => mathml`<mtr>${row.map((v) => mathml`<mtd><mn>${v}</mn></mtd>`)}</mtr>`)}</mtable></math>
  </div>`;
  return html`<section class="matrices" role="group" aria-label=${t("Matrices")}>
    <p class="label">${t("Matrices")}: ${t("view")} · ${t("objects")} = ${t("product")}</p>
    ${matrix(all.view, t("view"))} ${matrix(all.objects, t("objects"))} ${matrix(all.product, t("product"))}
  </section>`;
}

const KEYS: [string[], Key][] = [
  [["Space"], "play, pause"],
  [[",", "."], "step back, step on"],
  [["Home", "End"], "first step, last step"],
  [["c"], "compare"],
  [["p"], "inspect the pixel under the cross"],
  [["l"], "dialog Lights"],
  [["r"], "reset the view"],
  [["?"], "this dialog"],
  [["← ↑ → ↓"], "in the picture: move the cross by one pixel"],
  [["Enter"], "in the picture: inspect the pixel"],
  [["Shift + ← ↑ → ↓"], "in the picture: turn the camera"],
  [["+", "-"], "in the picture: zoom"],
  [["Escape"], "close a dialog or a menu, or leave the steps for the finished picture"],
];

export function keyboardDialog(app: App): TemplateResult {
  const set = (on: boolean) => {
    app.hasKeys = on;
    app.changed();
  };
  return dialog(
    app,
    "keyboard",
    t("Keyboard"),
    html`<p class="note">${t("The keys act while the picture, the steps or the structure has the focus.")}</p>
      <table aria-label=${t("Keyboard")}>
        <thead>
          <tr>
            <th scope="col">${t("key")}</th>
            <th scope="col">${t("does")}</th>
          </tr>
        </thead>
        <tbody>
          ${KEYS.map(
            ([keys, does]) => html`<tr>
              <th scope="row">${keys.map((k) => html`<kbd>${k}</kbd> `)}</th>
              <td>${t(does)}</td>
            </tr>`,
          )}
        </tbody>
      </table>
      ${check(t("Single keys are on"), app.hasKeys, set)}`,
  );
}

const LANGUAGE_NAMES: Record<Language, string> = { en: "English", ro: "Română", fr: "Français", pt: "Português" };

export function languageDialog(app: App): TemplateResult {
  return dialog(
    app,
    "language",
    t("Language"),
    group(
      t("Language"),
      LANGUAGES.map((l) => html`<div lang=${l}>${radio(LANGUAGE_NAMES[l], "language", l === app.language, () => app.setLab({ lang: l }))}</div>`),
    ),
  );
}

export function aboutDialog(app: App): TemplateResult {
  return dialog(
    app,
    "about",
    t("About"),
    html`<p>${t("vitral Lab shows the classical algorithms of computer graphics step by step, on built-in scenes and on your own models.")}</p>
      <p>${t("Everything is computed in this page; nothing is sent anywhere.")}</p>
      <p class="note">vitral ${app.catalog?.version}</p>`,
  );
}
