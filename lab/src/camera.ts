// Where points of the world lie in the picture, for the handles of lights; and Lab3D's eye angles.

export type Vector = [number, number, number];

export interface Eye {
  position: Vector;
  right: Vector;
  up: Vector;
  /** Against the direction of view. */
  back: Vector;
  /** Vertical angle of view, degrees. */
  viewAngle: number;
  /** Height of the picture in a parallel projection; `null` in perspective. */
  parallelHeight: number | null;
  /** Width over height. */
  aspect: number;
}

const dot = (a: Vector, b: Vector) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const minus = (a: Vector, b: Vector): Vector => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const cross = (a: Vector, b: Vector): Vector => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

function unit(v: Vector): Vector {
  const length = Math.hypot(...v) || 1;
  return [v[0] / length, v[1] / length, v[2] / length];
}

/** The axes of a camera that looks from a point at another one. */
export function axes(position: Vector, focalPoint: Vector, viewUp: Vector): { right: Vector; up: Vector; back: Vector } {
  const back = unit(minus(position, focalPoint));
  const right = unit(cross(viewUp, back));
  return { right, up: cross(back, right), back };
}

/** The angles about x, then y, then z, degrees, that turn an eye which looks along -z. */
export function eyeAngles({ right, up, back }: { right: Vector; up: Vector; back: Vector }): Vector {
  const degrees = (radians: number) => (radians * 180) / Math.PI;
  const x = Math.atan2(up[2], back[2]);
  const y = Math.asin(Math.max(-1, Math.min(1, -right[2])));
  const z = Math.atan2(right[1], right[0]);
  return [degrees(x), degrees(y), degrees(z)];
}

/** Half the height of the picture at a depth in front of the eye. */
const halfHeight = (eye: Eye, depth: number) =>
  eye.parallelHeight === null ? depth * Math.tan((eye.viewAngle * Math.PI) / 360) : eye.parallelHeight / 2;

/** Place in the picture, 0 to 1 from the top left, and depth; `null` behind the eye. */
export function project(eye: Eye, point: Vector): { x: number; y: number; depth: number } | null {
  const from = minus(point, eye.position);
  const depth = -dot(from, eye.back);
  if (depth <= 1e-9 && eye.parallelHeight === null) return null;
  const half = halfHeight(eye, depth);
  return { x: 0.5 + dot(from, eye.right) / (2 * half * eye.aspect), y: 0.5 - dot(from, eye.up) / (2 * half), depth };
}

/**
 * Where a point outside of the picture is pointed to: the place on the picture's edge, and the direction
 * from the centre in degrees, clockwise from the right. A point behind the eye lies to the side where one
 * would turn to it.
 */
export function edgePlace(eye: Eye, point: Vector): { x: number; y: number; angle: number } {
  const from = minus(point, eye.position);
  const [u, v] = [dot(from, eye.right), -dot(from, eye.up)];
  // Straight behind the eye no side is nearer: take the lower edge.
  const [dx, dy] = Math.hypot(u, v) > 1e-9 ? [u / eye.aspect, v] : [0, 1];
  const scale = 0.5 / Math.max(Math.abs(dx), Math.abs(dy));
  return { x: 0.5 + dx * scale, y: 0.5 + dy * scale, angle: (Math.atan2(dy, dx * eye.aspect) * 180) / Math.PI };
}

/** The point at a place in the picture and a depth. */
export function unproject(eye: Eye, x: number, y: number, depth: number): Vector {
  const half = halfHeight(eye, depth);
  const [u, v] = [(x - 0.5) * 2 * half * eye.aspect, (0.5 - y) * 2 * half];
  const { position, right, up, back } = eye;
  const along = (i: 0 | 1 | 2) => position[i] + u * right[i] + v * up[i] - depth * back[i];
  return [along(0), along(1), along(2)];
}

/**
 * A place beside an eye from which a scene in a box, the eye and its view volume fill a part of the
 * picture: each corner tells how far back one must be to see it.
 */
export function frameFrom(eye: Eye, min: Vector, max: Vector, fill: number): { position: Vector; focalPoint: Vector; viewUp: Vector } {
  const corner = (i: number, a: Vector, b: Vector): Vector => [i & 1 ? b[0] : a[0], i & 2 ? b[1] : a[1], i & 4 ? b[2] : a[2]];
  const corners = (a: Vector, b: Vector) => Array.from({ length: 8 }, (_, i) => corner(i, a, b));

  // The view volume reaches from the nearest to the farthest corner of the scene.
  const scene = corners(min, max);
  const depths = scene.map((p) => -dot(minus(p, eye.position), eye.back));
  const ends = [Math.max(Math.min(...depths), eye.parallelHeight === null ? 1e-3 * Math.max(...depths) : -Infinity), Math.max(...depths)];
  const volume = ends.flatMap((depth) => [0, 1].flatMap((x) => [0, 1].map((y) => unproject(eye, x, y, depth))));
  const all = [...scene, ...volume, eye.position];
  const least = (k: 0 | 1 | 2) => Math.min(...all.map((p) => p[k]));
  const most = (k: 0 | 1 | 2) => Math.max(...all.map((p) => p[k]));
  const [a, b]: [Vector, Vector] = [
    [least(0), least(1), least(2)],
    [most(0), most(1), most(2)],
  ];
  const focalPoint = a.map((v, i) => (v + b[i]!) / 2) as Vector;

  // Look from the right, a bit above and behind.
  const towards = unit([0, 1, 2].map((i) => eye.right[i]! + eye.up[i]! * 0.5 + eye.back[i]! * 0.35) as Vector);
  const own = axes(towards, [0, 0, 0], eye.up);
  const half = Math.tan((eye.viewAngle * Math.PI) / 360) * fill;
  const needs = corners(a, b).map((p) => {
    const from = minus(p, focalPoint);
    return dot(from, own.back) + Math.max(Math.abs(dot(from, own.up)) / half, Math.abs(dot(from, own.right)) / (half * eye.aspect));
  });
  const distance = Math.max(...needs);
  return { position: focalPoint.map((v, i) => v + towards[i]! * distance) as Vector, focalPoint, viewUp: eye.up };
}
