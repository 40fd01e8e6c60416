// Blocks of 4 x 4 texels to texels, by the runtime's own C compiled to WebAssembly.
//
// SPDX-License-Identifier: MIT
import { DECODER } from './decoder_wasm.js';

const KINDS = {
  base: { decode: 'decode_bc1', blockBytes: 8, Texels: Uint8Array, channels: 4 },
  specular: { decode: 'decode_bc5', blockBytes: 16, Texels: Uint8Array, channels: 2 },
  direct: { decode: 'decode_bc6h', blockBytes: 16, Texels: Uint16Array, channels: 4 },
  indirect: { decode: 'decode_bc6h', blockBytes: 16, Texels: Uint16Array, channels: 4 },
};
const PAGE = 65536;

let instance;

async function load() {
  const bytes = Uint8Array.from(atob(DECODER), (c) => c.charCodeAt(0));
  return (await WebAssembly.instantiate(bytes)).instance.exports;
}

function reserve(memory, bytes) {
  const missing = bytes - memory.buffer.byteLength;
  if (missing > 0) memory.grow(Math.ceil(missing / PAGE));
}

/**
 * Decodes images of blocks: bytes of RGBA for `base`, of RG for `specular`, half floats of RGBA for light. Images follow each
 * other, with rows from the first on.
 * @param {'base'|'specular'|'direct'|'indirect'} kind
 * @param {Uint8Array} blocks of all images
 * @param {number} width of an image in texels
 * @param {number} height
 */
export async function decodeBlocks(kind, blocks, width, height) {
  instance ??= load();
  const decoder = await instance, { decode, blockBytes, Texels, channels } = KINDS[kind];
  const mapBlocks = (width * height) / 16, mapBytes = mapBlocks * blockBytes, mapTexels = width * height * channels;
  const from = Math.ceil(decoder.heap() / 16) * 16, to = from + mapBytes;
  reserve(decoder.memory, to + mapTexels * Texels.BYTES_PER_ELEMENT);
  const maps = blocks.length / mapBytes, texels = new Texels(maps * mapTexels);
  for (let map = 0; map < maps; map++) {
    new Uint8Array(decoder.memory.buffer, from, mapBytes).set(blocks.subarray(map * mapBytes, (map + 1) * mapBytes));
    decoder[decode](from, width / 4, mapBlocks, to);
    texels.set(new Texels(decoder.memory.buffer, to, mapTexels), map * mapTexels);
  }
  return texels;
}
