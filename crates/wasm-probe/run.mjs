// Runs the probe in WebAssembly and prints the hash of its picture: node run.mjs MODULE.wasm
import { readFileSync } from "node:fs";

const { instance } = await WebAssembly.instantiate(readFileSync(process.argv[2]), {});
const { render, length, memory } = instance.exports;

// Draw first: drawing may grow the memory, which detaches older views of it.
const address = render();
const bytes = new Uint8Array(memory.buffer, address, length());

// FNV-1a, 64 bits, as in the probe's own program.
let hash = 0xcbf29ce484222325n;
for (const byte of bytes) {
  hash = BigInt.asUintN(64, (hash ^ BigInt(byte)) * 0x100000001b3n);
}
console.log(hash.toString(16).padStart(16, "0"));
