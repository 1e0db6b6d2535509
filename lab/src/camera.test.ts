import assert from "node:assert/strict";
import { test } from "node:test";
import { axes, eyeAngles, project, unproject, type Eye, type Vector } from "./camera.ts";

const eyeAt = (position: Vector, focal: Vector): Eye => ({
  position,
  ...axes(position, focal, [0, 1, 0]),
  viewAngle: 30,
  parallelHeight: null,
  aspect: 4 / 3,
});

test("a point comes back from its place and depth", () => {
  const eye = eyeAt([4, 3, 7], [0, 0.5, 0]);
  for (const e of [eye, { ...eye, parallelHeight: 3 }]) {
    const point: Vector = [0.3, -0.2, 0.5];
    const place = project(e, point)!;
    const back = unproject(e, place.x, place.y, place.depth);
    back.forEach((v, i) => assert.ok(Math.abs(v - point[i]!) < 1e-9));
  }
});

test("what the eye looks at is in the middle, what is behind it nowhere", () => {
  const eye = eyeAt([0, 0, 5], [0, 0, 0]);
  const { x, y, depth } = project(eye, [0, 0, 0])!;
  assert.deepEqual([x, y, depth], [0.5, 0.5, 5]);
  assert.equal(project(eye, [0, 0, 6]), null);
  assert.ok(project(eye, [0, 1, 0])!.y < 0.5);
});

test("l16 angles turn the eye about x, then y, then z", () => {
  const angles: Vector = [-20, 35, 10];
  const [a, b, c] = angles.map((d) => (d * Math.PI) / 180) as Vector;
  const turn = ([x, y, z]: Vector): Vector => {
    [y, z] = [Math.cos(a) * y - Math.sin(a) * z, Math.sin(a) * y + Math.cos(a) * z];
    [x, z] = [Math.cos(b) * x + Math.sin(b) * z, -Math.sin(b) * x + Math.cos(b) * z];
    return [Math.cos(c) * x - Math.sin(c) * y, Math.sin(c) * x + Math.cos(c) * y, z];
  };
  const found = eyeAngles({ right: turn([1, 0, 0]), up: turn([0, 1, 0]), back: turn([0, 0, 1]) });
  found.forEach((v, i) => assert.ok(Math.abs(v - angles[i]!) < 1e-9));
});
