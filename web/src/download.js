// Loads a file, plain or compressed by gzip.
//
// SPDX-License-Identifier: MIT
import { FieldError } from './field_file.js';

// Reads the body of a response as one buffer; `onProgress` receives the number of bytes loaded, and their total as far
// as it is known.
async function readBody(response, onProgress) {
  const total = Number(response.headers.get('content-length')) || 0, parts = [];
  let loaded = 0;
  for (const reader = response.body.getReader(); ;) {
    const { done, value } = await reader.read();
    if (done) break;
    parts.push(value);
    loaded += value.length;
    onProgress?.(loaded, Math.max(total, loaded));
  }
  const whole = new Uint8Array(loaded);
  let at = 0;
  for (const part of parts) {
    whole.set(part, at);
    at += part.length;
  }
  return whole;
}

const isGzip = (bytes) => bytes[0] === 0x1f && bytes[1] === 0x8b;

async function unzip(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Response(stream).arrayBuffer();
}

/** Returns the bytes of a file, unpacked. Throws a FieldError when the server does not send it. */
export async function download(url, { onProgress, signal } = {}) {
  const response = await fetch(url, { signal });
  if (!response.ok) throw new FieldError(`${url}: ${response.status} ${response.statusText}`);
  const bytes = await readBody(response, onProgress);
  return isGzip(bytes) ? unzip(bytes) : bytes.buffer;
}
