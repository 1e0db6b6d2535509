// Drawings (SVG) and formulas (MathML) of the engine as elements. Only what draws is taken over:
// names inside come from files of the user.

import { translated } from "../words.ts";

const SVG = "http://www.w3.org/2000/svg";
const MATH = "http://www.w3.org/1998/Math/MathML";

const SVG_ELEMENTS = new Set(["svg", "g", "path", "rect", "line", "polyline", "polygon", "circle", "ellipse", "text", "tspan", "title", "desc", "defs", "marker"]);

const MATH_ELEMENTS = new Set(
  "math mrow mi mn mo mtext ms mspace mfrac msqrt mroot msub msup msubsup munder mover munderover mfenced mtable mtr mtd mstyle mpadded mphantom menclose semantics".split(" "),
);

const isSafeAttribute = (name: string, value: string) =>
  !/^on/i.test(name) && !/^(xlink:)?href$|^src$|^style$/i.test(name) && !/url\(\s*['"]?(?!#)|javascript:/i.test(value);

function copyOf(from: Element, namespace: string, allowed: Set<string>): Element | null {
  const name = from.localName;
  if (!allowed.has(name)) return null;
  const to = document.createElementNS(namespace, name);
  for (const { name, value } of from.attributes) {
    if (name.startsWith("xmlns")) continue;
    if (isSafeAttribute(name, value)) to.setAttribute(name, value);
  }
  for (const child of from.childNodes) {
    if (child instanceof Element) {
      const copied = copyOf(child, namespace, allowed);
      if (copied) to.append(copied);
    } else if (child.nodeType === Node.TEXT_NODE) {
      const text = child.textContent ?? "";
      to.append(name === "mtext" ? translated(text) : text);
    }
  }
  return to;
}

/** The last markup of each kind and the elements made of it, lest they be made anew at every rendering. */
const cache = new Map<string, Element | null>();

function elementOf(text: string, namespace: string, allowed: Set<string>, use: string): Element | null {
  const key = `${document.documentElement.lang} ${use} ${text}`;
  const known = cache.get(key);
  if (known !== undefined) return known;
  const whole = text.includes("xmlns") ? text : text.replace(/^\s*<(svg|math)/, `<$1 xmlns="${namespace}"`);
  const parsed = new DOMParser().parseFromString(whole, "application/xml").documentElement;
  const made = parsed.namespaceURI === namespace ? copyOf(parsed, namespace, allowed) : null;
  if (cache.size > 100) cache.clear();
  cache.set(key, made);
  return made;
}

/** A drawing; `use` tells apart where the same one is shown twice. */
export function drawing(text: string, use: string): SVGElement | null {
  return elementOf(text, SVG, SVG_ELEMENTS, use) as SVGElement | null;
}

export function formula(text: string, use: string): Element | null {
  return elementOf(text, MATH, MATH_ELEMENTS, use);
}
