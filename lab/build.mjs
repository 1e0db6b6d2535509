// Bundles the page into dist/: files for a server (index.html, lab.js, worker.js, lab.css) and
// single.html, the template of the self-contained file.
//
// Whoever puts the parts together replaces `<!--LAB-START-->` (what to open) in both pages and
// `<!--LAB-WASM-->` (the engine) in single.html; see README.md.

import { createHash } from "node:crypto";
import { mkdirSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { deflateRawSync } from "node:zlib";
import { build } from "esbuild";

/**
 * The keys and the texts of each language as lists in JSON, deflated, in base64: data of the page.
 * Texts of one language beside each other pack better than rows of all languages.
 */
async function packedTexts() {
  const bundled = await build({ entryPoints: ["src/table.ts"], bundle: true, write: false, format: "esm" });
  const source = Buffer.from(bundled.outputFiles[0].contents).toString("base64");
  const { TABLE } = await import(`data:text/javascript;base64,${source}`);
  const keys = Object.keys(TABLE);
  const columns = [0, 1, 2, 3].map((column) => keys.map((key) => TABLE[key][column] ?? ""));
  return deflateRawSync(JSON.stringify([keys, ...columns]), { level: 9 }).toString("base64");
}

/** Leaves out the indentation of lines, which templates would keep. */
const indentation = {
  name: "indentation",
  setup(build) {
    build.onLoad({ filter: /[\\/]src[\\/].*\.ts$/ }, ({ path }) => {
      return { contents: readFileSync(path, "utf8").replace(/\n[ \t]+/g, "\n"), loader: "ts" };
    });
  },
};

const options = { bundle: true, target: "es2022", legalComments: "none", logLevel: "warning", plugins: [indentation] };

if (process.argv.includes("--unit")) {
  const entryPoints = readdirSync("src").filter((f) => f.endsWith(".test.ts")).map((f) => `src/${f}`);
  await build({ ...options, entryPoints, outdir: "dist-unit", platform: "node", format: "esm", outExtension: { ".js": ".mjs" } });
  process.exit(0);
}

// Bundle script, worker and style.
const entryPoints = { lab: "src/main.ts", worker: "src/worker.ts" };
await build({ ...options, entryPoints, outdir: "dist", minify: true, format: "iife" });
await build({ ...options, entryPoints: { lab: "src/lab.css" }, outdir: "dist", minify: true });

const [script, worker, style] = ["lab.js", "worker.js", "lab.css"].map((f) => readFileSync(`dist/${f}`, "utf8"));
const texts = await packedTexts();
const template = readFileSync("index.html", "utf8").replace("<!--LAB-TEXTS-->", () => `<script type="text/plain" id="lab-texts">${texts}</script>`);
const fill = (text, parts) => Object.entries(parts).reduce((t, [mark, part]) => t.replace(mark, () => part), text);

// The served page: everything external, the policy comes as a header.
const served = fill(template, {
  "<!--LAB-POLICY-->": "",
  "<!--LAB-STYLE-->": '<link rel="stylesheet" href="lab.css">',
  "<!--LAB-SCRIPT-->": '<script src="lab.js"></script>',
  "<!--LAB-WASM-->": "",
});
writeFileSync("dist/index.html", served);

// The single file: script and style inside, allowed by their hashes; the worker as text for a Blob.
const hash = (text) => `'sha256-${createHash("sha256").update(text).digest("base64")}'`;
for (const text of [script, worker]) {
  if (/<\/script|<!--/i.test(text)) throw new Error("the script would end its own element");
}
const policy = [
  "default-src 'none'",
  `script-src ${hash(script)} 'wasm-unsafe-eval' blob:`,
  `style-src ${hash(style)}`,
  "worker-src blob:",
  "img-src blob: data:",
  "base-uri 'none'",
  "form-action 'none'",
].join("; ");
const single = fill(template, {
  "<!--LAB-POLICY-->": `<meta http-equiv="Content-Security-Policy" content="${policy}">`,
  "<!--LAB-STYLE-->": `<style>${style}</style>`,
  "<!--LAB-SCRIPT-->": `<script type="text/plain" id="lab-worker">${worker}</script>\n<script>${script}</script>`,
});
mkdirSync("dist", { recursive: true });
writeFileSync("dist/single.html", single);

const size = script.length + worker.length + style.length;
const LIMIT = 250_000;
console.log(`lab.js ${script.length}, worker.js ${worker.length}, lab.css ${style.length}: ${size} of ${LIMIT} bytes; texts ${texts.length}`);
if (size > LIMIT) throw new Error(`script and style are larger than ${LIMIT} bytes`);
