// The page's texts in four languages.
//
// English texts are the keys of the table, or stand last in the row of a short key. What the engine
// tells in English is looked up there as well.

import { inflated } from "./inflate.ts";
import type { Language } from "./link.ts";
import type { TABLE } from "./table.ts";

export type Key = keyof typeof TABLE;

/** The table, once it is read. */
let table: Record<string, readonly string[]> = {};

/** Reads the table from the page: JSON, deflated, in base64. Until then all texts are English. */
export async function readTexts() {
  const packed = document.getElementById("lab-texts")?.textContent ?? "";
  takeTexts(JSON.parse(await inflated(packed).text()) as string[][]);
}

/** Takes a list of keys, then a list of their texts for each language. */
export function takeTexts([keys = [], ...columns]: string[][]) {
  table = Object.fromEntries(keys.map((key, i) => [key, columns.map((column) => column[i] ?? "")]));
}

const COLUMNS = { ro: 0, fr: 1, pt: 2, en: 3 } as const;

let language: Language = "en";

export function setLanguage(to: Language) {
  language = to;
}

export const isEnglish = () => language === "en";

const lookUp = (text: string): string => {
  const row = Object.hasOwn(table, text) ? table[text] : undefined;
  return row?.[COLUMNS[language]] || text;
};

/** A text of the table; `{0}`, `{1}`, … stand for the parts. */
export function t(key: Key, ...parts: (string | number)[]): string {
  return lookUp(key).replace(/\{(\d)\}/g, (_, i: string) => String(parts[Number(i)] ?? ""));
}

/** A text of the engine; one that the table lacks stays as it is. */
export function translated(text: string): string {
  return lookUp(text);
}

/** A text of the engine in a tooltip: nothing where the table lacks it. */
export function tooltip(text: string): string {
  return language === "en" || Object.hasOwn(table, text) ? lookUp(text) : "";
}

/** What goes in and out of a stage: numbers with words of the table. */
export function stagePart(text: string): string {
  if (language === "en") return text;
  return text.replace(/[a-z][a-z ]*[a-z]/g, (words) => lookUp(Object.hasOwn(table, `stage ${words}`) ? `stage ${words}` : words));
}
