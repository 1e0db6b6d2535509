import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { after } from "node:test";
import { SMALL, close, open, test } from "./browser.mjs";

after(close);

const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const TAGS = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"];

async function violations(page) {
  await page.evaluate(AXE);
  const { violations } = await page.evaluate((tags) => axe.run(document, { runOnly: { type: "tag", values: tags } }), TAGS);
  return violations.map((v) => `${v.id}: ${v.nodes.slice(0, 3).map((n) => n.html.slice(0, 160)).join(" | ")}`);
}

const PAGES = ["scene", "pipeline", "visibility", "illumination", "shading", "exercises"];

for (const colorScheme of ["light", "dark"]) {
  test(`no page has a violation, ${colorScheme}`, async (page) => {
    for (const id of PAGES) {
      await open(page, `${SMALL}&page=${id}&pixel=80,60&exercise=5.1&settings.visibility=warnock`);
      await page.waitForTimeout(800);
      assert.deepEqual(await violations(page), [], id);
    }
  }, { colorScheme, bypassCSP: true });
}

test("no language, layout, comparison has a violation", async (page) => {
  for (const more of ["lang=ro", "lang=fr", "lang=pt", "layout=figure&step=3", "layout=slide&step=3", "compare=side", "compare=swipe", "compare=blink", "compare=difference", "wrong=1"]) {
    await open(page, `${SMALL}&settings.visibility=painter&page=visibility&${more}`);
    await page.waitForTimeout(500);
    assert.deepEqual(await violations(page), [], more);
  }
}, { bypassCSP: true });

test("no menu and no dialog has a violation", async (page) => {
  await open(page, SMALL);
  for (const [menu, entry] of [["Select", "Lights…"], ["Select", "Materials…"], ["Select", "Camera…"], ["Help", "Keyboard"], ["Help", "Language"], ["Help", "About"]]) {
    await page.getByRole("menuitem", { name: menu }).click();
    assert.deepEqual(await violations(page), [], menu);
    await page.getByRole("menuitem", { name: entry }).click();
    await page.getByRole("dialog").waitFor();
    assert.deepEqual(await violations(page), [], entry);
    await page.getByRole("dialog").getByRole("button", { name: "Close" }).click();
  }
}, { bypassCSP: true });
