import assert from "node:assert/strict";
import { after } from "node:test";
import { SMALL, close, eventually, fragment, open, ready, test } from "./browser.mjs";

after(close);

/** A pixel of the small picture that shows a surface. */
const PIXEL = "pixel=85,50";

const structureOf = (page) => page.getByRole("region", { name: "Structure" });

/** Opens an algorithm at a step among all. */
async function openStep(page, algorithm, step, more = PIXEL) {
  await open(page, `${SMALL}&page=visibility&settings.visibility=${algorithm}&step=${step}&${more}`);
  await structureOf(page).locator("p.told").filter({ hasNotText: "Recording" }).waitFor();
}

const pressed = (page) => page.getByRole("button", { pressed: true });

test("every algorithm has a drawing of its structure", async (page) => {
  for (const [algorithm, step, name] of [
    ["z-buffer", 20, "Drawing of the depths"],
    ["brute-force", 3, "Drawing of the depths"],
    ["scan-line", 60, "Drawing of the edges"],
    ["warnock", 200, "Drawing of the quadtree"],
    ["painter", 100, "Drawing of the depth-sort list"],
    ["bsp", 40, "Drawing of the BSP tree"],
    ["weiler-atherton", 20, "Drawing of the clip"],
    ["ray-cast", 100, "Drawing of the acceleration structure"],
  ]) {
    await openStep(page, algorithm, step);
    const drawing = structureOf(page).getByRole("img", { name, exact: true });
    await drawing.waitFor();
    // The drawing goes on with the steps.
    if (!["scan-line", "warnock", "painter", "bsp", "weiler-atherton"].includes(algorithm)) continue;
    await page.waitForTimeout(500);
    const before = await drawing.innerHTML();
    const slider = page.getByRole("slider", { name: "Step" });
    await slider.fill(String(step + 25));
    await eventually(async () => (await drawing.innerHTML()) !== before, true, algorithm);
  }
});

test("a facet that is chosen in one place is chosen in all", async (page) => {
  await openStep(page, "painter", 100);
  // The visible surface of the inspected pixel is chosen.
  const surfaces = page.getByRole("table", { name: "Surfaces at the pixel" });
  await surfaces.getByRole("button", { pressed: true }).waitFor();
  const structure = structureOf(page);
  await structure.getByText(/^Facet \d+: surface \d+ of .+, material .+/).waitFor();
  await page.keyboard.press("Escape");
  await eventually(() => pressed(page).count(), 0);

  // A row of the list chooses the facet, and choosing it once more takes that back.
  const list = structure.getByRole("list", { name: "Depth-sort list" });
  const row = list.getByRole("button", { name: /waits/ }).first();
  await row.click();
  await eventually(() => row.getAttribute("aria-pressed"), "true");
  const facet = /facet (\d+)/.exec(await row.textContent())[1];
  await structure.getByText(new RegExp(`^Facet ${facet}`)).waitFor();
  await page.locator(".chosen-outline path").first().waitFor({ state: "attached" });
  await row.click();
  await eventually(() => pressed(page).count(), 0);

  // A shape of the drawing does the same.
  const shape = structure.getByRole("img", { name: "Drawing of the depth-sort list" }).locator(`[data-facet="${facet}"]`).last();
  await shape.click();
  await eventually(() => row.getAttribute("aria-pressed"), "true");
});

test("a row that stands for a step goes there", async (page) => {
  await openStep(page, "bsp", 60, "");
  const node = structureOf(page).getByRole("tree", { name: "BSP tree" }).getByRole("treeitem").nth(3);
  await node.click();
  await eventually(() => node.getAttribute("aria-current"), "true");
  await structureOf(page).getByText(/^node \d+, in/).waitFor();
});

test("facets are marked in tables, trees and entries of every algorithm", async (page) => {
  for (const [algorithm, step, role, name] of [
    ["scan-line", 60, "table", "Polygon table"],
    ["warnock", 2126, "tree", "Quadtree"],
    ["bsp", 105, "tree", "BSP tree"],
    ["weiler-atherton", 49, "list", "Visible polygons"],
    ["ray-cast", 100, "tree", "Acceleration structure"],
  ]) {
    await openStep(page, algorithm, step);
    // What is chosen last is brought into view.
    const surface = page.getByRole("table", { name: "Surfaces at the pixel" }).locator("tbody").getByRole("button").first();
    await eventually(() => surface.getAttribute("aria-pressed"), "true");
    await surface.click();
    await surface.click();
    const holder = structureOf(page).getByRole(role, { name, exact: true });
    await holder.locator(".chosen").first().waitFor({ state: "attached" });
  }
});

test("ray casting tells what the ray of the pixel opened", async (page) => {
  for (const [acceleration, role] of [["bvh", "tree"], ["grid", "table"]]) {
    await openStep(page, "ray-cast", 50, `settings.acceleration=${acceleration}&${PIXEL}`);
    const structure = structureOf(page);
    await structure.getByRole(role, { name: "Acceleration structure", exact: true }).waitFor();
    await structure.getByText(/^The ray hits facet \d+\.$/).waitFor();
    await structure.getByText(/^Opened: \d+ of \d+ parts; tests of boxes: \d+, of facets: \d+$/).waitFor();
  }
  await openStep(page, "ray-cast", 50, "");
  await structureOf(page).getByText("Inspect a pixel to see what its ray opens").waitFor();
});

test("the increments of all lines and the normals at the corners are told", async (page) => {
  await open(page, `${SMALL}&page=shading&settings.shading=gouraud&${PIXEL}`);
  const increments = page.getByRole("table", { name: "Increments" });
  await increments.locator("tr[aria-current]").waitFor();
  const rows = increments.locator("tbody tr");
  assert.ok((await rows.count()) > 1);
  assert.equal(await increments.locator("tr[aria-current]").getByRole("rowheader").textContent(), "50");
  const normals = page.getByRole("table", { name: "Normals at the corners" });
  await normals.getByRole("rowheader", { name: "result" }).waitFor();
  const corner = page.getByRole("combobox", { name: "Corner", exact: true });
  assert.equal(await corner.getByRole("option").count(), 3);
  await corner.selectOption({ index: 2 });
  await normals.getByRole("rowheader", { name: "mean of the faces" }).waitFor();
});

test("the second view is turned, enlarged and reset, and the link has it", async (page) => {
  await open(page, `${SMALL}&page=pipeline&second=on&${PIXEL}`);
  const second = page.getByRole("application", { name: "Second view" });
  await second.locator("svg .ray").first().waitFor({ state: "attached" });
  await page.getByText("ray of the pixel").waitFor();
  const viewpoint = async () => {
    const text = (await fragment(page)).get("second");
    return text === "on" ? text : JSON.parse(text);
  };
  await second.focus();
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("+");
  const turned = await viewpoint();
  assert.equal(turned["azimuth-angle"], 5);
  assert.equal(turned["zoom-factor"], 1.2);
  const { x, y, width, height } = await second.boundingBox();
  await page.mouse.move(x + width / 2, y + height / 2);
  await page.mouse.down();
  await page.mouse.move(x + width / 2 - 60, y + height / 2, { steps: 3 });
  await page.mouse.up();
  assert.ok((await viewpoint())["azimuth-angle"] > 10);

  // The same link shows the same view.
  const link = (await fragment(page)).toString();
  await open(page, link);
  assert.equal((await fragment(page)).toString(), link);
  await second.focus();
  await page.keyboard.press("r");
  assert.equal(await viewpoint(), "on");
  await page.getByRole("alert").filter({ hasText: /./ }).waitFor({ state: "detached" });
});

test("the plane of a node is drawn in the second view", async (page) => {
  await openStep(page, "bsp", 10, "second=on");
  await page.getByRole("application", { name: "Second view" }).locator("svg .plane").waitFor({ state: "attached" });
});

test("the camera dialog writes the product of the matrices out", async (page) => {
  await open(page, `${SMALL}&objects.translation=[1,0,0]`);
  await page.getByRole("menuitem", { name: "Select" }).click();
  await page.getByRole("menuitem", { name: "Camera…" }).click();
  const matrices = page.getByRole("dialog", { name: "Camera" }).getByRole("group", { name: "Matrices" });
  await matrices.waitFor();
  const read = (name) =>
    matrices.getByRole("group", { name, exact: true }).locator("mtr").evaluateAll((rows) => rows.map((r) => [...r.querySelectorAll("mn")].map((n) => Number(n.textContent))));
  const [view, objects, product] = [await read("view"), await read("objects"), await read("product")];
  const rows = [0, 1, 2, 3];
  const times = rows.map((i) => rows.map((j) => rows.reduce((sum, k) => sum + view[i][k] * objects[k][j], 0)));
  for (const i of rows) for (const j of rows) assert.ok(Math.abs(times[i][j] - product[i][j]) < 1e-3, `${i} ${j}`);
  assert.equal(objects[0][3], 1);
});

test("a shape over the picture is chosen by a click", async (page) => {
  await openStep(page, "painter", 100, "");
  await ready(page);
  const shape = page.locator(".overlay [data-facet]").first();
  await shape.waitFor({ state: "attached" });
  const { x, y, width, height } = await shape.boundingBox();
  await page.mouse.click(x + width / 2, y + height / 2);
  await structureOf(page).getByText(/^Facet \d+/).waitFor();
});
