import assert from "node:assert/strict";
import { test } from "node:test";
import { TABLE } from "./table.ts";
import { setLanguage, t, takeTexts, translated } from "./words.ts";

test("every text has its parts in every language", () => {
  const parts = (text: string) => [...new Set(text.match(/\{\d\}/g) ?? [])].sort();
  for (const [english, others] of Object.entries(TABLE)) {
    for (const other of others) {
      assert.ok(other.length > 0, english);
      assert.deepEqual(parts(other), parts(others[3] ?? english), english);
    }
  }
});

test("texts follow the language, unknown ones stay", () => {
  takeTexts([Object.keys(TABLE), ...[0, 1, 2].map((column) => Object.values(TABLE).map((row) => row[column] as string))]);
  setLanguage("ro");
  assert.equal(t("Shading"), "Umbrire");
  assert.equal(t("Pixel {0}, {1}", 3, 4), "Pixelul 3, 4");
  assert.equal(translated("z-buffer"), "z-buffer");
  setLanguage("en");
  assert.equal(t("Shading"), "Shading");
});
