// A parsed field as textures and uniforms, as shaders/lib/data.glsl reads them.
//
// SPDX-License-Identifier: MIT
import {
  CompressedArrayTexture, DataArrayTexture, DataTexture, HalfFloatType, NearestFilter, RED_GREEN_RGTC2_Format, RGBAFormat,
  RGBAIntegerFormat, RGB_BPTC_UNSIGNED_Format, RGB_S3TC_DXT1_Format, RGBFormat, RGFormat, RedIntegerFormat, UnsignedByteType,
  UnsignedInt5999Type, UnsignedIntType, UnsignedShortType, Vector4,
} from 'three';
import { decodeBlocks } from './decode_blocks.js';
import { FieldError } from './field_file.js';

const ROW = 2048; // OLX_DATA_ROW of data.glsl
const POOL_ROW = 512; // 1 << OLX_POOL_ROW_BITS: blocks in a row of a pool's image, and most rows in a layer
const LIGHT_WORDS = 16, MOST_HIGHLIGHTS = 64;
const GPU_SELECTORS = 0xb; // OLX_SELECT_GPU_MASK

const BLOCKS = {
  base: { extension: 'WEBGL_compressed_texture_s3tc', format: RGB_S3TC_DXT1_Format, type: UnsignedByteType, bytes: 8 },
  specular: { extension: 'EXT_texture_compression_rgtc', format: RED_GREEN_RGTC2_Format, type: UnsignedByteType, bytes: 16 },
  direct: { extension: 'EXT_texture_compression_bptc', format: RGB_BPTC_UNSIGNED_Format, type: HalfFloatType, bytes: 16 },
  indirect: { extension: 'EXT_texture_compression_bptc', format: RGB_BPTC_UNSIGNED_Format, type: HalfFloatType, bytes: 16 },
};
const DECODED = {
  base: { format: RGBAFormat, type: UnsignedByteType, channels: 4 },
  specular: { format: RGFormat, type: UnsignedByteType, channels: 2 },
  direct: { format: RGBAFormat, type: HalfFloatType, channels: 4 },
  indirect: { format: RGBAFormat, type: HalfFloatType, channels: 4 },
};
const TEXELS = {
  base: { format: RGBAFormat, type: UnsignedByteType, channels: 4 },
  specular: { format: RGFormat, type: UnsignedByteType, channels: 2 },
  direct: { format: RGBFormat, type: UnsignedInt5999Type, channels: 1 },
  indirect: { format: RGBFormat, type: UnsignedInt5999Type, channels: 1 },
};

// Returns the number of maps beside each other in a layer that keeps the number of layers and their size within limits;
// one if possible.
export function mapsASide(maps, stride, limits) {
  for (let side = 1; side * stride <= limits.size; side++) {
    if (Math.ceil(maps / side ** 2) <= limits.layers) return side;
  }
  throw new FieldError(`${maps} maps of ${stride} x ${stride} texels do not fit into ${limits.layers} layers of ${limits.size} x ${limits.size}`);
}

// Arranges maps, each given as rows of `elements` elements one after the other, in layers of side x side maps.
export function tile(data, maps, elements, rows, side) {
  if (side === 1) return data;
  const layers = Math.ceil(maps / side ** 2), tiled = new data.constructor(layers * side ** 2 * rows * elements);
  for (let map = 0; map < maps; map++) {
    const layer = Math.floor(map / side ** 2), column = map % side, first = Math.floor((map % side ** 2) / side) * rows;
    for (let row = 0; row < rows; row++) {
      const from = (map * rows + row) * elements;
      tiled.set(data.subarray(from, from + elements), ((layer * side * rows + first + row) * side + column) * elements);
    }
  }
  return tiled;
}

function finish(texture) {
  texture.minFilter = texture.magFilter = NearestFilter;
  texture.generateMipmaps = false;
  texture.needsUpdate = true;
  return texture;
}

function texelMaps(data, maps, stride, side, { format, type, channels }) {
  const layers = Math.ceil(maps / side ** 2), tiled = tile(data, maps, stride * channels, stride, side);
  const texture = new DataArrayTexture(tiled, side * stride, side * stride, layers);
  texture.format = format;
  texture.type = type;
  return finish(texture);
}

// The image of a pool: its blocks row by row, the last row and the last layer filled up with zeros.
export function poolShape(blocks) {
  const rows = Math.max(Math.ceil(blocks / POOL_ROW), 1), layers = Math.ceil(rows / POOL_ROW);
  return { width: 4 * POOL_ROW, height: 4 * (layers > 1 ? POOL_ROW : rows), layers };
}

function padded(data, length) {
  const whole = new data.constructor(length);
  whole.set(data);
  return whole;
}

async function poolMaps(data, kind, renderer) {
  const { extension, format, type, bytes } = BLOCKS[kind], { width, height, layers } = poolShape(data.length / bytes);
  const blocks = padded(data, (width / 4) * (height / 4) * layers * bytes);
  if (renderer.extensions.has(extension)) {
    return finish(new CompressedArrayTexture([{ data: blocks, width, height }], width, height, layers, format, type));
  }
  const decoded = DECODED[kind], texture = new DataArrayTexture(await decodeBlocks(kind, blocks, width, height), width, height, layers);
  texture.format = decoded.format;
  texture.type = decoded.type;
  return finish(texture);
}

async function surfaceMaps(field, kind, side, renderer) {
  const { probes, radianceSize: n, compressed } = field.info, data = field.surfaces[kind];
  if (data.length === 0) return texelMaps(new Uint8Array(4), 1, 1, 1, DECODED.base); // nothing reads it without reflections
  return compressed ? poolMaps(data, kind, renderer) : texelMaps(data, probes, n + 2, side, TEXELS[kind]);
}

// Puts a flat array into the rows of an image.
function rowsOf(data, channels, format) {
  const rows = Math.max(Math.ceil(data.length / (ROW * channels)), 1), padded = new Uint32Array(rows * ROW * channels);
  padded.set(data);
  return finish(new DataTexture(padded, ROW, rows, format, UnsignedIntType));
}

function probeWords({ info, positions, flags }) {
  const words = new Uint32Array(4 * info.probes), floats = new Float32Array(words.buffer);
  for (let i = 0; i < info.probes; i++) {
    floats.set(positions.subarray(3 * i, 3 * i + 3), 4 * i);
    words[4 * i + 3] = flags[i];
  }
  return words;
}

// Copies an array as words, with the last word padded with zeros.
function wordsOf(array) {
  const words = new Uint32Array(Math.ceil(array.byteLength / 4));
  new Uint8Array(words.buffer).set(new Uint8Array(array.buffer, array.byteOffset, array.byteLength));
  return words;
}

// Concatenates all parts that shaders read as words, and computes where each part begins.
export function layOutWords(field) {
  const lights = field.lights.length / LIGHT_WORDS > MOST_HIGHLIGHTS ? new Uint32Array(0) : field.lights, none = new Uint32Array(0);
  const parts = {
    least: field.least, bricks: field.bricks ?? none, neighbours: field.neighbours ?? none, emission: field.emission, tiles: field.tiles,
    planes: field.planes ?? none, baseTiles: field.surfaceTiles?.[0] ?? none, specularTiles: field.surfaceTiles?.[1] ?? none,
    directTiles: field.surfaceTiles?.[2] ?? none, indirectTiles: field.surfaceTiles?.[3] ?? none, lights,
    volume: field.volume?.cells ?? none, volumeLight: field.volume?.light ?? none,
  };
  const first = {}, pieces = Object.values(parts).map(wordsOf);
  let length = 0;
  Object.keys(parts).forEach((name, i) => {
    first[name] = length;
    length += pieces[i].length;
  });
  const words = new Uint32Array(length);
  pieces.forEach((piece, i) => words.set(piece, Object.values(first)[i]));
  return { words, first, lights: lights.length / LIGHT_WORDS };
}

const vec4 = ([x, y, z]) => new Vector4(x, y, z, 0);

function gridUniform(grid) {
  if (!grid) return { origin: new Vector4(), spacing: new Vector4(), count: [0, 0, 0, 0] };
  return { origin: vec4(grid.origin), spacing: vec4(grid.spacing), count: [...grid.count, grid.count.reduce((a, b) => a * b)] };
}

// The members of olx_field_constants in shaders/octalux_shared.h.
function constants(field, { first, lights }, side) {
  const { info, pyramid } = field, n = info.radianceSize;
  return {
    grid: gridUniform(info.grid),
    irradiance_grid: gridUniform(null),
    scene_min: vec4(info.sceneMin),
    scene_max: vec4(info.sceneMax),
    probe_count: info.probes,
    n,
    least_nodes: pyramid.nodes,
    maps_a_side: side,
    irradiance_n: 0,
    irradiance_maps_a_side: 1,
    irradiance_texel: 0,
    distance_scale: info.distanceScale,
    select_mask: info.selectMask & GPU_SELECTORS,
    pyramid_levels: pyramid.levels,
    bricks_first: first.bricks,
    voronoi_first: first.neighbours,
    emission_first: first.emission,
    tiles_first: first.tiles,
    tile_side: n / 8,
    tile_count: field.tiles.length / 64,
    lights_first: first.lights,
    light_count: lights,
    last_bounce: info.lastBounce,
    volume_first: field.volume ? first.volume : 0,
    pyramid_first: pyramid.first,
    map_scale: 1 / (n + 2),
    tiled: info.compressed ? 1 : 0,
    compressed: info.compressed ? 1 : 0,
    planes_first: first.planes,
    plane_count: (field.planes?.length ?? 0) / 2,
    geometry_scale: field.geometry ? n / 4 / (n + 2) : 0,
    unused_1: 0,
    unused_2: 0,
    tile_words: [first.baseTiles, first.specularTiles, first.directTiles, first.indirectTiles],
    tile_blocks: info.compressed ? ['base', 'specular', 'direct', 'indirect'].map((kind) => field.surfaces[kind].length / BLOCKS[kind].bytes) : [0, 0, 0, 0],
  };
}

// Makes textures of distances and normals, or of geometry blocks, which replace both.
function geometryMaps(field, side) {
  const { probes, radianceSize: n } = field.info, half = { format: RedIntegerFormat, type: UnsignedShortType, channels: 1 };
  if (field.geometry) {
    const block = { format: RGBAIntegerFormat, type: UnsignedIntType, channels: 4 };
    return {
      olx_normal_maps: texelMaps(new Uint16Array(1), 1, 1, 1, half),
      olx_distance_maps: texelMaps(field.geometry, probes, n / 4, side, block),
    };
  }
  return {
    olx_normal_maps: texelMaps(field.normals, probes, n + 2, side, half),
    olx_distance_maps: texelMaps(field.distances, probes, n + 2, side, half),
  };
}

/** Uniforms for the library, by name. Textures are uploaded when three.js first draws with them. */
export async function fieldUniforms(field, renderer) {
  const gl = renderer.getContext(), { probes, radianceSize: n } = field.info;
  const limits = { layers: gl.getParameter(gl.MAX_ARRAY_TEXTURE_LAYERS), size: gl.getParameter(gl.MAX_TEXTURE_SIZE) };
  const side = mapsASide(probes, n + 2, limits), words = layOutWords(field);
  if (words.words.length > ROW * limits.size) throw new FieldError('pyramids, selectors and the volume are more than a texture holds');
  const uniforms = {
    olx_field: constants(field, words, side),
    olx_word_image: rowsOf(words.words, 1, RedIntegerFormat),
    olx_probe_image: rowsOf(probeWords(field), 4, RGBAIntegerFormat),
    ...geometryMaps(field, side),
  };
  for (const kind of ['base', 'specular', 'direct', 'indirect']) {
    uniforms[`olx_${kind}_maps`] = await surfaceMaps(field, kind, side, renderer);
  }
  return Object.fromEntries(Object.entries(uniforms).map(([name, value]) => [name, { value }]));
}
