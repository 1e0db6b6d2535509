import assert from "node:assert/strict";
import { test } from "node:test";
import { differences, equal, put, type JsonObject } from "./json.ts";
import { formText, pack, read, stateOfB, unpack, write } from "./link.ts";
import { decode, encode } from "./message.ts";

const DEFAULTS: JsonObject = {
  models: [],
  lights: null,
  viewpoint: { "azimuth-angle": 0, view: null },
  settings: { width: 1024, visibility: "z-buffer", background: { type: "gradient", top: [1, 1, 1] }, "depth-cue": null },
};

const from = (text: string) => read(new URLSearchParams(text), DEFAULTS);

test("an empty form is the default", () => {
  const { situation, problems } = from("");
  assert.deepEqual(situation.state, DEFAULTS);
  assert.deepEqual(problems, []);
  assert.equal(write(situation, DEFAULTS).toString(), "");
});

test("a form comes back", () => {
  const text =
    'models=["builtin:teapot"]&viewpoint.azimuth-angle=30&settings.visibility=warnock&b.settings.visibility=painter' +
    "&page=visibility&step=12&steps=window&pixel=3,4&compare=side&second=on&exercise=5.1&layout=slide&lang=ro&speed=10&play=1";
  const { situation, problems } = from(text);
  assert.deepEqual(problems, []);
  assert.equal(formText(write(situation, DEFAULTS)), text);
  assert.equal((stateOfB(situation)["settings"] as JsonObject)["visibility"], "painter");
});

test("model and size come first", () => {
  const { situation } = from('lights=[]&settings.visibility=bsp&settings.width=640&models=["builtin:teapot"]');
  assert.deepEqual([...write(situation, DEFAULTS).keys()], ["models", "settings.width", "lights", "settings.visibility"]);
});

test("variants are written as wholes, strings that look like JSON are quoted", () => {
  let { situation } = from("");
  situation = { ...situation, state: put(situation.state, "settings.background", { type: "color", color: [0, 0, 0] }) };
  situation.state = put(situation.state, "viewpoint.view", "12");
  const form = write(situation, DEFAULTS);
  assert.equal(form.get("settings.background"), '{"type":"color","color":[0,0,0]}');
  assert.equal(form.get("viewpoint.view"), '"12"');
  assert.ok(equal(read(form, DEFAULTS).situation.state, situation.state));
});

test("what cannot be is told, the rest is used", () => {
  const { situation, problems } = from(
    "settings.visiblity=warnock&settings.width=64&page=nowhere&step=-1&pixel=a,b&foo=1&settings=3&__proto__.x=1&b.lights.0.kind=1",
  );
  assert.deepEqual(
    problems.map((p) => `${p.key} ${p.what}`),
    ["settings.visiblity unknown-field", "page bad-value", "step bad-value", "pixel bad-value", "foo unknown-field", "settings bad-value", "__proto__.x unknown-field"],
  );
  assert.equal((situation.state["settings"] as JsonObject)["width"], 64);
  assert.equal(({} as Record<string, unknown>)["x"], undefined);
});

test("long forms are packed and come back", async () => {
  const lights = JSON.stringify(Array.from({ length: 99 }, (_, i) => ({ name: `LIGHT${i}`, diffuse: [i / 7, 0, 0] })));
  const form = new URLSearchParams({ lights });
  const packed = await pack(form);
  assert.match(packed, /^z=[A-Za-z0-9_-]+$/);
  const { form: back, problems } = await unpack(packed);
  assert.deepEqual(problems, []);
  assert.equal(back.get("lights"), lights);
  for (const wrong of ["z=!!!", "z=AAAA", `z=${packed.slice(2, 40)}`]) {
    assert.equal((await unpack(wrong)).problems.length, 1, wrong);
  }
});

test("differences follow paths", () => {
  assert.deepEqual(differences({ a: { b: 1, c: 2 }, d: [1] }, { a: { b: 1, c: 3 }, d: [] }), [["a.c", 2], ["d", [1]]]);
});

test("messages come back", () => {
  const planes = [Uint8Array.of(1, 2, 3), Uint8Array.of(), Uint8Array.of(4)];
  const bytes = encode({ want: "picture", text: "é" }, planes);
  assert.equal(bytes.length % 4, 0);
  const { json, planes: back } = decode(bytes);
  assert.deepEqual(json, { want: "picture", text: "é" });
  assert.deepEqual(back, planes);
});
