// Bytes that were deflated and written as base64.

/** What the text holds, as a stream that is read with `arrayBuffer` or `text`. */
export function inflated(base64: string): Response {
  return new Response(new Blob([bytesOf(base64)]).stream().pipeThrough(new DecompressionStream("deflate-raw")));
}

/** The bytes that base64 stands for; line breaks in it do not count. */
export function bytesOf(base64: string): Uint8Array<ArrayBuffer> {
  const text = atob(base64.replace(/\s+/g, ""));
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes;
}
