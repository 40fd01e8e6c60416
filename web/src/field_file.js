// Reads field files (.olx, version 2) as docs/format.md describes them, and those of `export web --no-glossy`
// (docs/web.md). What is not wanted for drawing, such as hashes and classic maps, is not looked at. Arrays are views of
// the given buffer, or of a copy where chunks are filtered.
//
// SPDX-License-Identifier: MIT

const MAGIC = [0x89, 0x4f, 0x4c, 0x58, 0x0d, 0x0a, 0x1a, 0x0a];
const PACKED_MAGIC = [0x89, 0x4f, 0x4c, 0x5a];
const VERSION = 2;
const OPTIONAL = 1;
const FILTER_SHIFT = 8, DIFFERENCES = 2, PLANES = 4; // filters of chunks in fields that `export web --no-glossy` writes
const KNOWN_REQUIRED = (
  'INFO PPOS PFLG RADI NORM DIST GEOM PLAN DMIN DMAX IPOS IFLG IRRA IRSH MOME ' +
  'BASE SPEC DIRE INDI TBAS TREF TDIR TIND PBAS PREF PDIR PIND EMIS LITE ETIL ORIG'
).split(' ');
const KNOWN = [...KNOWN_REQUIRED, ...'VORO OCTR BRIK CLAS CIRR CRAD CBOX VOLU VPOS VIRR RLIT'.split(' ')];
const NODE_SIDES = [256, 64, 16, 4];
const SELECTORS = ['cage', 'voronoi', 'octree', 'bricks'];
const SELECTOR_CHUNKS = [null, 'VORO', 'OCTR', 'BRIK']; // of each selector; the cage needs none

/** The error for a file that is no field, or one that this reader cannot use. */
export class FieldError extends Error {
  constructor(message) {
    super(message);
    this.name = 'FieldError';
  }
}

function need(condition, message) {
  if (!condition) throw new FieldError(message);
}

const aligned = (offset) => Math.ceil(offset / 64) * 64;

function readHeader(view) {
  need(view.byteLength >= 64, 'not a field: shorter than a header');
  const magic = (bytes) => bytes.every((byte, i) => view.getUint8(i) === byte);
  need(!magic(PACKED_MAGIC), 'a packed field (.olxz): unpack it with `octalux unpack`, or let the server compress an .olx');
  need(magic(MAGIC), 'not a field: its first bytes are others');
  const version = view.getUint32(8, true);
  need(version === VERSION, `a field of version ${version}, and this reader knows version ${VERSION}`);
  const bytes = Number(view.getBigUint64(16, true));
  need(bytes === view.byteLength, `${view.byteLength} bytes of ${bytes}: cut off, or changed`);
  const chunks = view.getUint32(12, true);
  need(chunks >= 1 && chunks <= 256 && 64 + 64 * chunks <= bytes, `${chunks} chunks are not possible`);
  return chunks;
}

function readChunks(view) {
  const count = readHeader(view), chunks = new Map();
  let next = 64 + 64 * count;
  for (let at = 64; at < 64 + 64 * count; at += 64) {
    const type = String.fromCharCode(...[0, 1, 2, 3].map((i) => view.getUint8(at + i)));
    const optional = (view.getUint32(at + 4, true) & OPTIONAL) !== 0;
    const offset = Number(view.getBigUint64(at + 8, true)), size = Number(view.getBigUint64(at + 16, true));
    need(offset === next, `chunk ${type} lies at ${offset}, not at ${next}`);
    next = aligned(offset + size);
    need(next <= view.byteLength, `chunk ${type} ends behind the file`);
    need(optional || KNOWN_REQUIRED.includes(type), `a required chunk, ${type}, that this reader does not know`);
    if (!KNOWN.includes(type)) continue;
    need(!chunks.has(type), `chunk ${type} comes twice`);
    chunks.set(type, { offset, size, filter: view.getUint32(at + 4, true) >>> FILTER_SHIFT, element: view.getUint32(at + 36, true) });
  }
  return chunks;
}

// Returns the bytes before the filters of docs/format.md, "Packed fields".
function undoFilter(type, bytes, filter, element) {
  need((filter & ~(DIFFERENCES | PLANES)) === 0 && [1, 2, 4, 8, 16].includes(element), `chunk ${type} has a filter that this reader does not know`);
  const count = Math.floor(bytes.length / element), plain = bytes.slice();
  if (filter & PLANES) {
    for (let byte = 0, from = 0; byte < element; byte++) {
      for (let to = byte; to < element * count; to += element) plain[to] = bytes[from++];
    }
  }
  if (filter & DIFFERENCES) for (let i = element; i < plain.length; i++) plain[i] += plain[i - element];
  return plain;
}

// Returns the file's buffer, or a copy of it in which no chunk is filtered.
function unfiltered(buffer, chunks) {
  if (![...chunks.values()].some(({ filter }) => filter)) return buffer;
  const copy = new Uint8Array(buffer.slice(0));
  for (const [type, { offset, size, filter, element }] of chunks) {
    if (filter) copy.set(undoFilter(type, copy.subarray(offset, offset + size), filter, element), offset);
  }
  return copy.buffer;
}

const vector = (view, at) => [0, 4, 8].map((i) => view.getFloat32(at + i, true));
const counts = (view, at) => [0, 4, 8].map((i) => view.getUint32(at + i, true));
const readGrid = (view, at) => ({ origin: vector(view, at), spacing: vector(view, at + 12), count: counts(view, at + 24) });

function readInfo(view, at) {
  const word = (offset) => view.getUint32(at + offset, true), mask = word(32);
  return {
    probes: word(0),
    irradianceProbes: word(4),
    buried: word(8),
    radianceSize: word(20),
    bounces: word(36),
    selectMask: mask,
    select: SELECTORS.filter((_, i) => (mask >> i) & 1),
    distanceScale: view.getFloat32(at + 44, true),
    sceneMin: vector(view, at + 48),
    sceneMax: vector(view, at + 60),
    grid: word(16) ? readGrid(view, at + 72) : null,
    sceneHash: view.getBigUint64(at + 144, true).toString(16).padStart(16, '0'),
    lastBounce: view.getFloat32(at + 152, true),
    compressed: (word(156) & 4) !== 0,
    untiledBlocks: (word(156) & 1) !== 0,
    unknownForm: word(156) >>> 3 !== 0,
    geometryBlocks: (word(156) & 2) !== 0,
  };
}

function checkInfo(info) {
  const { probes, radianceSize: n, distanceScale } = info;
  need(probes >= 1, 'no light field probes');
  need(!info.untiledBlocks, 'surfaces in maps of blocks, which tiles have replaced: bake the scene again');
  need(!info.unknownForm, 'maps in a form that this reader does not know');
  need(n >= 8 && n <= 2048 && (n & (n - 1)) === 0, `maps of ${n} texels along a side`);
  need(distanceScale >= 1e-18 && distanceScale <= 1e18, 'a distance scale out of range');
  need([...info.sceneMin, ...info.sceneMax].every(Number.isFinite), 'bounds that are not finite');
  need(!info.grid || info.grid.count.reduce((a, b) => a * b) === probes, 'a grid of another number of probes');
}

// Computes where the levels of a probe's pyramid of smallest distances begin, the finest first, and the number of its
// nodes. Geometry blocks replace the finest level when there is another one.
function pyramidOf(n, overBlocks) {
  const sides = NODE_SIDES.filter((side) => side === 4 || n >= 4 * side), first = [];
  let nodes = 0;
  for (const side of sides) {
    const stored = side !== 4 || sides.length === 1 || !overBlocks;
    first.unshift(stored ? nodes : 0);
    if (stored) nodes += (n / side) ** 2;
  }
  return { levels: sides.length, first: [...first, 0, 0, 0].slice(0, 4), nodes };
}

// Checks that there are the chunks of the selectors that INFO names, and of no others. Rays alone read VORO and OCTR, so
// files without glossy light leave them out.
function checkSelectors({ selectMask, glossy }, chunks) {
  SELECTOR_CHUNKS.forEach((type, i) => {
    if (!type) return;
    const named = (selectMask & (1 << i)) !== 0;
    need(named || !chunks.has(type), `a ${type} chunk, but INFO does not name its selector`);
    need(!named || chunks.has(type) || (type !== 'BRIK' && !glossy), `chunk ${type} is missing`);
  });
}

/** @param {ArrayBuffer} buffer a whole .olx file; arrays of the result are views of it, or of a copy without filters. Throws a FieldError. */
export function parseField(buffer) {
  const chunks = readChunks(new DataView(buffer)), plain = unfiltered(buffer, chunks), view = new DataView(plain);
  // Returns a chunk as an array of `length` elements; with null, of as many as the chunk has, which may be 0.
  const array = (type, Kind, length) => {
    const chunk = chunks.get(type);
    need(chunk, `chunk ${type} is missing`);
    const elements = chunk.size / Kind.BYTES_PER_ELEMENT;
    need(length === null ? Number.isInteger(elements) : elements === length, `chunk ${type} has ${chunk.size} bytes`);
    return new Kind(plain, chunk.offset, elements);
  };
  need(chunks.get('INFO')?.size === 160, 'chunk INFO is missing, or not 160 bytes');
  const info = readInfo(view, chunks.get('INFO').offset);
  checkInfo(info);
  const n = info.radianceSize, probes = info.probes, pyramid = pyramidOf(n, info.geometryBlocks);
  const bordered = (n + 2) ** 2 * probes, blocks = (n * n) / 16 * probes;
  // `octalux export web --no-glossy` leaves out what reflections alone need.
  const glossy = chunks.has(info.compressed ? 'PBAS' : 'BASE');
  checkSelectors({ ...info, glossy }, chunks);
  const forGlossy = (type, Kind, length) => (glossy ? array(type, Kind, length) : new Kind(0));
  const surfaces = info.compressed
    ? {
        base: forGlossy('PBAS', Uint8Array, null),
        specular: forGlossy('PREF', Uint8Array, null),
        direct: forGlossy('PDIR', Uint8Array, null),
        indirect: array('PIND', Uint8Array, null),
      }
    : {
        base: forGlossy('BASE', Uint8Array, 4 * bordered),
        specular: forGlossy('SPEC', Uint8Array, 2 * bordered),
        direct: forGlossy('DIRE', Uint32Array, bordered),
        indirect: array('INDI', Uint32Array, bordered),
      };
  const optional = (type, Kind) => (chunks.has(type) ? array(type, Kind, null) : null);
  const volume = chunks.has('VOLU') ? { cells: array('VOLU', Uint32Array, null), light: array('VIRR', Uint32Array, null) } : null;
  const field = {
    info: { ...info, glossy, fileBytes: buffer.byteLength, volumeProbes: volume ? volume.light.byteLength / 56 : 0 },
    origin: chunks.has('ORIG') ? [...array('ORIG', Float64Array, 3)] : [0, 0, 0],
    positions: array('PPOS', Float32Array, 3 * probes),
    flags: array('PFLG', Uint8Array, probes),
    ...(info.geometryBlocks
      ? { geometry: array('GEOM', Uint32Array, 4 * blocks), planes: array('PLAN', Uint32Array, null) }
      : { normals: array('NORM', Uint16Array, bordered), distances: array('DIST', Uint16Array, bordered) }),
    pyramid,
    least: forGlossy('DMIN', Uint16Array, pyramid.nodes * probes),
    surfaces,
    surfaceTiles: info.compressed
      ? [
          forGlossy('TBAS', Uint32Array, (n / 8) ** 2 * probes),
          forGlossy('TREF', Uint32Array, (n / 8) ** 2 * probes),
          forGlossy('TDIR', Uint32Array, (n / 8) ** 2 * probes),
          array('TIND', Uint32Array, (n / 8) ** 2 * probes),
        ]
      : null,
    emission: forGlossy('EMIS', Uint32Array, (n / 8) ** 2 * probes),
    tiles: forGlossy('ETIL', Uint32Array, null),
    lights: forGlossy('LITE', Uint32Array, null),
    bricks: optional('BRIK', Uint32Array),
    neighbours: optional('VORO', Uint8Array),
    volume,
  };
  checkParts(field);
  return field;
}

// Checks counts of bricks and of the volume, which shaders trust: every list must be inside its chunk.
function checkParts({ bricks, volume, tiles, lights, planes, surfaces, info }) {
  need(!info.compressed || (surfaces.base.length % 8 === 0 && [surfaces.specular, surfaces.direct, surfaces.indirect].every((pool) => pool.length % 16 === 0)),
    'a pool of blocks is cut off');
  need(!planes || planes.length % 2 === 0, 'planes of geometry blocks are cut off');
  need(tiles.length % 64 === 0 && lights.length % 16 === 0, 'lights or tiles of emission are cut off');
  if (bricks) {
    const [x, y, z, divided, lists] = bricks.subarray(4, 9);
    need(bricks.length === 16 + x * y * z + 32 * divided + 4 * lists, 'chunk BRIK has another size than its header says');
  }
  if (volume) {
    const [x, y, z, blocks, splits, cells, probes] = volume.cells.subarray(4, 11);
    need(volume.cells.length === 16 + 8 * splits + 8 * cells + 64 * blocks + x * y * z, 'chunk VOLU has another size than its header says');
    need(volume.light.length === 14 * probes, 'chunk VIRR has another size than VOLU says');
  }
}
