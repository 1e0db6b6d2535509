// The sentences about why a pixel is as it is. The engine tells them in English; other languages
// take their numbers and names over.

import { isEnglish, t } from "./words.ts";

const PATTERNS: [RegExp, (m: string[]) => string][] = [
  [/^No surface is here: the pixel shows the background\.$/, () => t("No surface is here: the pixel shows the background.")],
  [/^Surface (\d+) of (.+) is seen here\.$/, (m) => t("Surface {0} of {1} is seen here.", m[1]!, m[2]!)],
  [/^Surface (\d+) is seen here\.$/, (m) => t("Surface {0} is seen here.", m[1]!)],
  [/^Lighting is off: the surface shows its own colour\.$/, () => t("Lighting is off: the surface shows its own colour.")],
  [/^(.+) adds ambient light\.$/, (m) => t("{0} adds ambient light.", m[1]!)],
  [/^(.+) adds nothing: it is behind the surface \(N·L = (.+)\)\.$/, (m) => t("{0} adds nothing: it is behind the surface (N·L = {1}).", m[1]!, m[2]!)],
  [
    /^(.+) adds only its ambient term: it is behind the surface \(N·L = (.+)\)\.$/,
    (m) => t("{0} adds only its ambient term: it is behind the surface (N·L = {1}).", m[1]!, m[2]!),
  ],
  [/^(.+) adds (?:nothing|only its ambient term): the surface is outside of its cone\.$/, (m) => t("{0} does not reach it: the surface is outside of its cone.", m[1]!)],
  [
    /^(.+) adds (?:nothing|only its ambient term): (?:surface (\d+) of (.+)|facet (\d+)|another surface) is in the way\.$/,
    (m) => t("{0} is kept away: surface {1} is in the way.", m[1]!, m[2] ? `${m[2]} (${m[3]})` : (m[4] ?? "?")),
  ],
  [
    /^(.+) shines on the surface \(N·L = ([^)]+)\)(, with a highlight)?\.(.*)$/,
    (m) => `${t("{0} shines on the surface (N·L = {1}).", m[1]!, m[2]!)}${m[3] ? ` ${t("There is a highlight.")}` : ""}${m[4] ? ` ${t("Some of it is kept away.")}` : ""}`,
  ],
  [/^The sum is above 1 in some channel, and is clamped there\.$/, () => t("The sum is above 1 in some channel, and is clamped there.")],
];

export function whyWords(sentence: string): string {
  if (isEnglish()) return sentence;
  for (const [pattern, words] of PATTERNS) {
    const found = pattern.exec(sentence);
    if (found) return words([...found]);
  }
  return sentence;
}

const code = (text: string) => `\`${text}\``;

/** Parts of the engine's errors and warnings, which may stand beside each other in one text. */
const MESSAGES: [RegExp, (m: string[]) => string][] = [
  [/there is no step (\d+)/g, (m) => t("there is no step {0}", m[1]!)],
  [/they are counted from 1 to (\d+)/g, (m) => t("they are counted from 1 to {0}", m[1]!)],
  [/there is no pixel (\d+,\d+)/g, (m) => t("there is no pixel {0}", m[1]!)],
  [/the picture has (\d+ x \d+) pixels, counted from 0/g, (m) => t("the picture has {0} pixels, counted from 0", m[1]!)],
  [/resolution (\d+x\d+): each side must be 1 to (\d+)/g, (m) => t("resolution {0}: each side must be 1 to {1}", m[1]!, m[2]!)],
  [/(\d+) samples per pixel: 1 to 16, or 32, are possible/g, (m) => t("{0} samples per pixel: 1 to 16, or 32, are possible", m[1]!)],
  [/there is no such scene/g, () => t("there is no such scene")],
  [/there is no such model here/g, () => t("there is no such model here")],
  [/models are builtin:NAME, or files that the page was given/g, () => t("models are builtin:NAME, or files that the page was given")],
  [/there is no model(?= \()/g, () => t("there is no model")],
  [/name a file or (\S+?)(?=\)|$)/g, (m) => t("name a file or {0}", m[1]!)],
  [/No such file(?: or directory)?(?: \(os error \d+\))?/g, () => t("No such file")],
  [
    /an acceleration structure is chosen, but `([^`]+)` casts no rays, nor does anything else/g,
    (m) => t("an acceleration structure is chosen, but {0} casts no rays, nor does anything else", code(m[1]!)),
  ],
  [/there is no (?:[a-z -]+) `([^`]+)`(?=: choose)/g, (m) => t("there is no algorithm {0}", code(m[1]!))],
  [
    /choose the visibility (.+?), the shadows ray, or the global illumination ray-trace/g,
    (m) => t("choose {0} as visibility, ray as shadows, or ray-trace as global illumination", m[1]!),
  ],
  [/did you mean (`[^`]+`)\?/g, (m) => t("did you mean {0}?", m[1]!)],
  [/\bchoose ([^;)]+)/g, (m) => t("choose {0}", m[1]!)],
  [/state: line (\d+), column (\d+)/g, (m) => t("state: line {0}, column {1}", m[1]!, m[2]!)],
  [/unknown field/g, () => t("unknown field")],
  [/expected one of ((?:`[^`]*`(?:, )?)+)/g, (m) => t("expected one of {0}", m[1]!)],
  [/invalid (?:type|value): (?:string|integer|floating point|boolean) (.+?), expected ([^;)]+)/g, (m) => t("invalid value {0}, expected {1}", m[1]!, m[2]!)],
  [/expected value/g, () => t("expected value")],
  [/an angle between (\d+) and (\d+) degrees is required/g, (m) => t("an angle between {0} and {1} degrees is required", m[1]!, m[2]!)],
  [
    /mesh (?:of node )?(`[^`]*`|\d+): (\d+) boundary edges?: it is open(, so its back faces are drawn too)?/g,
    (m) => t("mesh {0}: boundary edges: {1}; it is open", m[1]!, m[2]!) + (m[3] ? `, ${t("so its back faces are drawn too")}` : ""),
  ],
  [/(\d+) such meshes/g, (m) => t("{0} such meshes", m[1]!)],
];

/** An error or a warning of the engine; what no pattern knows stays English. */
export function messageWords(text: string): string {
  if (isEnglish()) return text;
  return MESSAGES.reduce((told, [pattern, words]) => told.replace(pattern, (...m) => words(m.map(String))), text);
}
