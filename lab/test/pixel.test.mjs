import assert from "node:assert/strict";
import { after } from "node:test";
import { SMALL, close, open, test } from "./browser.mjs";

after(close);

/** The display's encoding of a channel, times 255. */
const encoded = (v, isRaw) => {
  const c = Math.min(1, Math.max(0, v));
  return 255 * (isRaw ? c : c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055);
};

/** Rows of a table as lists of texts, its heads first. */
const rowsOf = (table) => table.locator("tr").evaluateAll((rows) => rows.map((r) => [...r.cells].map((c) => c.textContent.trim())));

/** The canvas's bytes at a pixel. */
const bytesAt = (page, x, y) =>
  page
    .getByRole("application", { name: "Picture", exact: true })
    .locator("canvas")
    .evaluate((canvas, [x, y]) => [...canvas.getContext("2d").getImageData(x, y, 1, 1).data].slice(0, 3), [x, y]);

/** Checks that the rows of light add up to the canvas's bytes; gives the rows. */
async function checkSum(page, state, [x, y], isRaw = false) {
  await open(page, `${state}&pixel=${x},${y}`);
  const table = page.getByRole("table", { name: "Light at the pixel" });
  await table.waitFor();
  const [heads, ...rows] = (await rowsOf(table)).filter((r) => r.length > 1);
  const column = heads.indexOf("sum");
  const last = rows.pop();
  assert.equal(last[0], "sum");
  const three = (text) => text.split(" ").map(Number);
  const sum = rows.reduce((total, r) => total.map((v, i) => v + three(r[column])[i]), [0, 0, 0]);
  const bytes = await bytesAt(page, x, y);
  for (const i of [0, 1, 2]) {
    assert.ok(Math.abs(Math.round(encoded(sum[i], isRaw)) - bytes[i]) <= 1, `${state} ${x},${y}: ${sum} and ${bytes}`);
    assert.ok(Math.abs(three(last[column])[i] - sum[i]) < 1e-3, `${state} ${x},${y}: ${sum} and ${last[column]}`);
  }
  return { heads, rows };
}

test("the rows of light add up to the canvas's bytes", async (page) => {
  const four = SMALL.replace("samples=1", "samples=4");
  const edge = await checkSum(page, four, [94, 67]);
  assert.ok(edge.heads.includes("share"));
  assert.ok(edge.rows.some(([name]) => name.includes("surface")));
  await checkSum(page, four, [43, 56]);

  const gouraud = await checkSum(page, `${SMALL}&settings.shading=gouraud`, [107, 59]);
  assert.ok(gouraud.heads.includes("× weight"));
  assert.equal(gouraud.rows.filter(([name]) => name.includes("corner")).length % 3, 0);

  const flat = await checkSum(page, `${SMALL}&settings.shading=flat&settings.color-space=raw`, [85, 50], true);
  assert.ok(!flat.heads.includes("share"));

  // The background alone, and with four samples beside a surface.
  const background = await checkSum(page, SMALL, [2, 2]);
  assert.deepEqual(background.rows.map(([name]) => name), ["background"]);
});

test("the rows of light are no more than 24 until all are wanted", async (page) => {
  const state = `${SMALL.replace("cubs", "realism").replace("samples=1", "samples=4")}&settings.shading=gouraud`;
  const { rows } = await checkSum(page, state, [85, 70]);
  const all = page.getByRole("button", { name: /^Show all \d+ rows$/ });
  if (rows.length < 24) return assert.equal(await all.count(), 0);
  assert.equal(rows.length, 24);
  assert.match(rows.at(-1)[0], /^\d+ more rows$/);
  const count = Number(/\d+/.exec(await all.textContent())[0]);
  await all.click();
  await page.getByRole("button", { name: "Show the first 24 rows" }).waitFor();
  assert.equal(await page.getByRole("table", { name: "Light at the pixel" }).locator("tbody tr").count(), count + 1);
});

/** What can become of a surface. */
const FATE = /^(visible|hidden( by .+)?|layer|culled: back face|culled: outside|clipped away|alpha test)$/;

test("every surface at the pixel has a fate", async (page) => {
  for (const [x, y] of [[94, 67], [43, 56], [85, 50], [63, 40]]) {
    await open(page, `${SMALL}&pixel=${x},${y}`);
    const table = page.getByRole("table", { name: "Surfaces at the pixel" });
    await table.waitFor();
    const rows = (await rowsOf(table)).filter((r) => r.length > 1).slice(1);
    for (const row of rows) assert.match(row.at(-1), FATE);
  }
});

/** What region Structure holds for each algorithm, with an inspected pixel. */
const HELD = {
  "z-buffer": [["table", "Depths"]],
  "brute-force": [["table", "Depths"]],
  "scan-line": [["table", "Polygon table"], ["table", "Edge table"], ["table", "Active edge table"], ["table", "Spans"]],
  warnock: [["table", "Window"], ["tree", "Quadtree"]],
  painter: [["list", "Depth-sort list"], ["table", "Tests"]],
  bsp: [["tree", "BSP tree"], ["list", "Back to front"]],
  "weiler-atherton": [["table", "Clip polygon"], ["list", "Visible polygons"]],
  "ray-cast": [["tree", "Acceleration structure"]],
};

const structureOf = (page) => page.getByRole("region", { name: "Structure" });

test("what an algorithm holds is there at every step", async (page) => {
  for (const [algorithm, held] of Object.entries(HELD)) {
    for (const step of ["step=1&", "step=2&", "step=30&", "step=200&", ""]) {
      await open(page, `${SMALL}&page=visibility&settings.visibility=${algorithm}&${step}pixel=85,50`);
      for (const [role, name] of held) await structureOf(page).getByRole(role, { name, exact: true }).waitFor({ state: "attached" });
    }
  }
});

test("the finished picture has the last clip and the last comparison", async (page) => {
  await open(page, `${SMALL}&page=visibility&settings.visibility=weiler-atherton`);
  await structureOf(page).getByRole("table", { name: "Clip polygon" }).getByRole("rowheader", { name: "inside" }).waitFor();
  await open(page, `${SMALL}&page=visibility&settings.visibility=painter`);
  await structureOf(page).getByRole("table", { name: "Tests" }).getByText(/^decides/).waitFor();
});

test("the fields of a step are words", async (page) => {
  for (const [algorithm, step] of [["bsp", 20], ["bsp", 60], ["bsp", 100], ["weiler-atherton", 50], ["ray-cast", 100], ["brute-force", 3], ["painter", 3], ["z-buffer", 1]]) {
    for (const lang of ["en", "ro", "fr", "pt"]) {
      await open(page, `${SMALL}&page=visibility&settings.visibility=${algorithm}&step=${step}&lang=${lang}`);
      const names = { en: ["Structure", "Step in numbers"] };
      const table = lang === "en" ? structureOf(page).getByRole("table", { name: names.en[1] }) : page.locator("section.structure table").last();
      await table.waitFor();
      const text = (await rowsOf(table)).slice(1).flat().join(" | ");
      assert.doesNotMatch(text, /_|\bfield |is_hole|nowhere|depth-extent|x-extent/, `${algorithm} ${step} ${lang}`);
      if (lang !== "en") assert.doesNotMatch(text, /\b(above|coincident|side|node|corners|hole|area|count|boxes|tested|through|nodes|yes)\b/, `${algorithm} ${step} ${lang}: ${text}`);
    }
  }
});
