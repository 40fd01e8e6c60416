// The reader of fields: what it finds is what the program and the reference reader find, and damaged files are refused.
// OCTALUX names the program; without it a field is made by hand alone.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { gunzipSync } from 'node:zlib';
import { FieldError, parseField } from '../dist/field_file.js';
import { decodeBlocks } from '../dist/decode_blocks.js';
import { layOutWords, mapsASide, tile } from '../dist/textures.js';

const octalux = process.env.OCTALUX;
const run = (...words) => execFileSync(octalux, words, { encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] });
const page = octalux && existsSync(join(dirname(octalux), 'web', 'index.html'));
// Returns a copy of a field in which chunks of these types have others and are flagged optional.
const renamed = (buffer, types) => {
  const copy = Buffer.from(buffer.slice(0));
  for (let at = 64; at < 64 + 64 * copy.readUInt32LE(12); at += 64) {
    const type = types[copy.latin1Slice(at, at + 4)];
    if (type) copy.writeUInt32LE(1, copy.write(type, at, 'latin1') + at);
  }
  return copy.buffer;
};
const bufferOf = (path) => new Uint8Array(readFileSync(path)).buffer;

describe('a baked field', { skip: octalux ? false : 'OCTALUX does not name the program' }, () => {
  let folder, blocks, texels;

  before(() => {
    folder = mkdtempSync(join(tmpdir(), 'octalux-web-'));
    blocks = join(folder, 'blocks.olx');
    texels = join(folder, 'texels.olx');
    const bake = (path, ...more) => run('bake', 'builtin:cornell-glossy', '-o', path, '--radiance-size', '32', '--grid', '2x2x2', '--noise', '0.2', ...more);
    bake(blocks, '--select', 'cage,voronoi');
    bake(texels, '--uncompressed');
  });
  after(() => rmSync(folder, { recursive: true }));

  test('is described as `octalux info` describes it', () => {
    const { info } = parseField(bufferOf(blocks)), said = JSON.parse(run('info', blocks, '--json'));
    assert.equal(info.probes, said.probes);
    assert.equal(info.buried, said.buried);
    assert.equal(info.radianceSize, said.radiance_size);
    assert.equal(info.volumeProbes, said.volume_probes);
    assert.equal(info.select.join(), said.select);
    assert.equal(info.fileBytes, said.file_bytes);
    assert.equal(info.sceneHash, said.scene_hash);
    assert.equal(info.compressed, said.compressed);
    assert.equal(info.bounces, said.bounces);
    assert.deepEqual(info.grid.count, said.grid.count);
    assert.equal(info.distanceScale, Math.fround(said.distance_scale_metres));
  });

  test('has parts as large as `octalux info` says', () => {
    const field = parseField(bufferOf(blocks)), { bytes } = JSON.parse(run('info', blocks, '--json'));
    const of = (...arrays) => arrays.reduce((sum, array) => sum + array.byteLength, 0);
    assert.equal(of(field.geometry, field.planes), bytes.geometry);
    const plain = parseField(bufferOf(texels)), { bytes: larger } = JSON.parse(run('info', texels, '--json'));
    assert.equal(of(plain.normals), larger.normal);
    assert.equal(of(plain.distances), larger.distance);
    const [base, specular, direct] = field.surfaceTiles;
    assert.equal(of(field.surfaces.base, field.surfaces.specular, base, specular), bytes.material);
    assert.equal(of(field.surfaces.direct, direct), bytes.direct);
    assert.equal(of(field.bricks, field.neighbours), bytes.selector);
  });

  test('has the same diffuse light on a page without reflections, whose chunks are filtered', { skip: page ? false : 'the program has no page' }, () => {
    for (const path of [blocks, texels]) {
      const out = join(folder, 'page');
      run('export', 'web', 'builtin:cornell-glossy', '--field', path, '--no-glossy', '-o', out);
      const stored = gunzipSync(readFileSync(join(out, 'field.olx.gz'))), buffer = new Uint8Array(stored).buffer;
      const whole = parseField(bufferOf(path)), diffuse = parseField(buffer), plain = ({ surfaceTiles }) => surfaceTiles?.[3] ?? null;
      for (const part of ['positions', 'flags', 'geometry', 'planes', 'normals', 'distances', 'bricks', 'volume']) assert.deepEqual(diffuse[part], whole[part], part);
      assert.deepEqual(diffuse.surfaces.indirect, whole.surfaces.indirect);
      assert.deepEqual(plain(diffuse), plain(whole));
      assert.equal(diffuse.info.glossy, false);
      const odd = new Uint8Array(buffer.slice(0)), at = [1, 2, 3, 4, 5].map((i) => 64 * i).find((entry) => odd[entry + 5] !== 0);
      odd[at + 36] = 3; // bytes of an element
      assert.throws(() => parseField(odd.buffer), /filter that this reader does not know/);
    }
  });

  test('decodes to the light that the same field has without blocks', async () => {
    const packed = parseField(bufferOf(blocks)), plain = parseField(bufferOf(texels)), n = 32;
    const pool = packed.surfaces.indirect, width = pool.length / 4, halves = await decodeBlocks('indirect', pool, width, 4);
    const half = (h) => (h & 0x7c00 ? 2 ** ((h >> 10) - 15) * (1 + (h & 1023) / 1024) : 2 ** -24 * h);
    const shared = (word) => [0, 9, 18].map((shift) => ((word >> shift) & 511) * 2 ** ((word >>> 27) - 24));
    let wrong = 0, whole = 0;
    for (let i = 0; i < packed.info.probes * n * n; i++) {
      const probe = Math.floor(i / (n * n)), x = i % n, y = Math.floor(i / n) % n;
      if ((plain.distances[(n + 2) ** 2 * probe + (y + 1) * (n + 2) + x + 1] & 0x7fff) === 0x7c00) continue;
      const word = packed.surfaceTiles[3][(n / 8) ** 2 * probe + (y >> 3) * (n / 8) + (x >> 3)], halfSize = word >>> 30 === 1;
      const block = (word & 0x3fffffff) + (halfSize ? 0 : ((y >> 2) & 1) * 2 + ((x >> 2) & 1));
      const texel = halfSize ? [(x >> 1) & 3, (y >> 1) & 3] : [x & 3, y & 3], at = texel[1] * width + 4 * block + texel[0];
      const expected = shared(plain.surfaces.indirect[(n + 2) ** 2 * probe + (y + 1) * (n + 2) + x + 1]);
      expected.forEach((value, c) => {
        wrong += (half(halves[4 * at + c]) - value) ** 2;
        whole += value ** 2;
      });
    }
    assert.ok(whole > 0 && wrong / whole < 2e-3, `relative error ${wrong / whole}`);
  });

  test('lies in words where the uniforms say', () => {
    const field = parseField(bufferOf(blocks)), { words, first } = layOutWords(field);
    const same = (at, part) => assert.deepEqual([...words.subarray(at, at + part.length)], [...part]);
    same(first.bricks, field.bricks);
    same(first.emission, field.emission);
    same(first.indirectTiles, field.surfaceTiles[3]);
    same(first.volume, field.volume.cells);
    assert.equal(first.volumeLight, first.volume + field.volume.cells.length);
    assert.equal(words[0], (field.least[0] | (field.least[1] << 16)) >>> 0);
  });

  test('keeps what diffuse light needs when it is exported without reflections', () => {
    for (const path of [blocks, texels]) {
      const page = join(folder, 'page');
      run('export', 'web', 'builtin:cornell-glossy', '--field', path, '-o', page, '--no-glossy');
      const whole = parseField(bufferOf(path)), part = parseField(new Uint8Array(gunzipSync(readFileSync(join(page, 'field.olx.gz')))).buffer);
      assert.deepEqual([whole.info.glossy, part.info.glossy], [true, false]);
      for (const name of ['positions', 'flags', 'geometry', 'planes', 'normals', 'distances', 'bricks', 'volume']) assert.deepEqual(part[name], whole[name]);
      assert.deepEqual(part.surfaces.indirect, whole.surfaces.indirect);
      assert.deepEqual(['base', 'specular', 'direct'].map((name) => part.surfaces[name].length), [0, 0, 0]);
      assert.ok(part.info.fileBytes < 0.75 * whole.info.fileBytes, `${part.info.fileBytes} of ${whole.info.fileBytes} bytes`);
    }
  });

  test('is refused once it is damaged, by a message that says where', () => {
    const whole = bufferOf(blocks), change = (at, value) => {
      const copy = whole.slice(0);
      new DataView(copy).setUint32(at, value, true);
      return copy;
    };
    const refused = (buffer, message) => assert.throws(() => parseField(buffer), (error) => error instanceof FieldError && message.test(error.message));
    refused(whole.slice(0, 40), /shorter than a header/);
    refused(whole.slice(0, whole.byteLength - 64), /cut off/);
    refused(change(0, 0), /first bytes/);
    refused(change(0, 0x5a4c4f89), /packed field/);
    refused(change(8, 3), /version 3/);
    refused(change(64, 0x58585858), /required chunk, XXXX/);
    refused(change(64, 0x5050204f), /required chunk, O PP/); // in a list of types, between INFO and PPOS
    refused(change(64 + 8, 1 << 20), /lies at/);
    const info = Number(new DataView(whole).getBigUint64(64 + 8, true));
    refused(change(info, 0), /no light field probes/);
    refused(change(info, 9), /PPOS|grid/);
    refused(change(info + 20, 48), /48 texels/);
    refused(change(info + 156, 8 + 6), /form that this reader does not know/);
    refused(renamed(whole, { VORO: 'GLOW' }), /chunk VORO is missing/);
    refused(renamed(whole, { BRIK: 'GLOW' }), /chunk BRIK is missing/);
    const selectors = new DataView(whole).getUint32(info + 32, true);
    refused(change(info + 32, selectors | 4), /chunk OCTR is missing/);
    refused(change(info + 32, selectors & ~2), /a VORO chunk, but INFO does not name its selector/);
    refused(renamed(whole, { VPOS: 'VIRR' }), /chunk VIRR comes twice/);
  });

  test('may have chunks that no reader knows yet, if they are optional', () => {
    const whole = bufferOf(blocks), strange = renamed(whole, { DMAX: 'GLOW', VPOS: 'GLOW' });
    assert.deepEqual(parseField(strange).positions, parseField(whole).positions);
  });
});

test('maps share a layer only where layers are too few', () => {
  assert.equal(mapsASide(256, 66, { layers: 256, size: 4096 }), 1);
  assert.equal(mapsASide(257, 66, { layers: 256, size: 4096 }), 2);
  assert.throws(() => mapsASide(5, 66, { layers: 1, size: 132 }), FieldError);
});

test('maps that share a layer lie side by side', () => {
  const maps = Uint8Array.from({ length: 5 * 4 }, (_, i) => i); // five maps of 2 x 2
  assert.deepEqual([...tile(maps, 5, 2, 2, 2)].slice(0, 16), [0, 1, 4, 5, 2, 3, 6, 7, 8, 9, 12, 13, 10, 11, 14, 15]);
  assert.deepEqual([...tile(maps, 5, 2, 2, 2)].slice(16, 24), [16, 17, 0, 0, 18, 19, 0, 0]);
  assert.equal(tile(maps, 5, 2, 2, 1), maps);
});

test('an empty buffer is no field', () => {
  assert.throws(() => parseField(new ArrayBuffer(0)), FieldError);
});
