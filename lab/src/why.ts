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
