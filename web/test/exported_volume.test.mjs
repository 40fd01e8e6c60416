// Exported irradiance volumes, as the package ktx-parse reads KTX 2.0 files: every part is where the file says, and the
// format is described. OCTALUX names the program.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import * as ktx from 'ktx-parse';

const octalux = process.env.OCTALUX;
const run = (...words) => execFileSync(octalux, words, { encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] });

describe('an exported irradiance volume', { skip: octalux ? false : 'OCTALUX does not name the program' }, () => {
  let folder;
  const exported = (...words) => {
    const path = join(folder, 'volume.ktx2');
    const said = JSON.parse(run('export', 'ktx2', join(folder, 'a.olx'), '-o', path, '--size', '5x4x3', '--json', ...words));
    const bytes = new Uint8Array(readFileSync(path));
    assert.equal(said.file_bytes, bytes.length);
    return { said, bytes, file: ktx.read(bytes) };
  };

  before(() => {
    folder = mkdtempSync(join(tmpdir(), 'octalux-ktx-'));
    run('bake', 'builtin:cornell', '-o', join(folder, 'a.olx'), '--radiance-size', '16', '--grid', '2x1x2', '--noise', '0.5');
  });
  after(() => rmSync(folder, { recursive: true }));

  test('is a 3D texture of shared exponents in three thirds of two halves', () => {
    const { file } = exported();
    assert.equal(file.vkFormat, ktx.VK_FORMAT_E5B9G9R9_UFLOAT_PACK32);
    assert.deepEqual([file.pixelWidth, file.pixelHeight, file.pixelDepth], [5, 8, 9]);
    assert.deepEqual([file.typeSize, file.layerCount, file.faceCount, file.levels.length], [4, 0, 1, 1]);
    assert.equal(file.supercompressionScheme, ktx.KHR_SUPERCOMPRESSION_NONE);
    assert.equal(file.levels[0].levelData.length, 4 * 5 * 8 * 9);
    assert.equal(file.levels[0].uncompressedByteLength, 4 * 5 * 8 * 9);
  });

  test('describes its format as the specification does', () => {
    const [format] = exported().file.dataFormatDescriptor;
    assert.equal(format.colorModel, ktx.KHR_DF_MODEL_RGBSDA);
    assert.equal(format.colorPrimaries, ktx.KHR_DF_PRIMARIES_BT709);
    assert.equal(format.transferFunction, ktx.KHR_DF_TRANSFER_LINEAR);
    assert.equal(format.bytesPlane[0], 4);
    const samples = format.samples.map((s) => [s.bitOffset, s.bitLength, s.channelType, s.sampleLower, s.sampleUpper]);
    for (let channel = 0; channel < 3; channel++) {
      assert.deepEqual(samples[2 * channel], [9 * channel, 8, channel, 0, 8448]);
      assert.deepEqual(samples[2 * channel + 1], [27, 4, channel | ktx.KHR_DF_SAMPLE_DATATYPE_EXPONENT, 15, 31]);
    }
  });

  test('names its transform and its unit', () => {
    const { said, file } = exported();
    const text = new TextDecoder().decode(file.keyValue['octalux.volume']); // ends in a zero
    const volume = JSON.parse(text.slice(0, -1));
    assert.deepEqual(volume, { translation: said.translation, scale: said.scale, unit: 'irradiance / pi, W/(sr m^2)' });
    assert.equal(file.keyValue.KTXwriter, 'octalux');
  });

  test('is the same texture when it is compressed', () => {
    const plain = exported().file.levels[0].levelData, { file } = exported('--zstd');
    assert.equal(file.supercompressionScheme, ktx.KHR_SUPERCOMPRESSION_ZSTD);
    assert.equal(file.levels[0].uncompressedByteLength, plain.length);
    assert.ok(file.levels[0].levelData.length < plain.length);
  });

  test('is written again by the package to what it was', () => {
    const { file } = exported(), again = ktx.read(ktx.write(file, { keepWriter: true }));
    assert.deepEqual(again.dataFormatDescriptor, file.dataFormatDescriptor);
    assert.deepEqual(again.keyValue, file.keyValue);
    assert.deepEqual(again.levels[0].levelData, file.levels[0].levelData);
  });
});
