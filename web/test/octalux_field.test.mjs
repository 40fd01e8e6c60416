// Fields that light materials: what three.js's renderer finds in a material that it compiles and draws.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { MeshStandardMaterial, ShaderLib, UniformsUtils } from 'three';
import { OctaluxField } from '../dist/octalux_field.js';

const CAGE = 1, BRICKS = 8;

function fieldWith(selectMask) {
  return new OctaluxField({ info: { selectMask, glossy: true } }, { olx_probe_image: { value: {} } });
}

// Returns the uniforms of a material's shader, which three.js keeps until the material has a shader of another key.
function compiledUniforms(material) {
  const { vertexShader, fragmentShader, uniforms } = ShaderLib.standard;
  const shader = { vertexShader, fragmentShader, uniforms: UniformsUtils.clone(uniforms) };
  material.onBeforeCompile(shader);
  return shader.uniforms;
}

function assertLitBy(field, uniforms) {
  for (const [name, uniform] of Object.entries(field.uniforms)) assert.equal(uniforms[name], uniform, name);
}

test('a material has the light of the field that lit it last, with the same shader', () => {
  const day = fieldWith(BRICKS), night = fieldWith(BRICKS), material = day.light(new MeshStandardMaterial());
  const uniforms = compiledUniforms(material), key = material.customProgramCacheKey();
  assertLitBy(day, uniforms);
  for (const field of [night, day]) {
    field.light(material);
    assert.equal(material.customProgramCacheKey(), key);
    assertLitBy(field, uniforms);
  }
});

test('shaders that a material had before have the light of the field that lit it last, too', () => {
  const day = fieldWith(BRICKS), night = fieldWith(BRICKS), material = day.light(new MeshStandardMaterial());
  const first = compiledUniforms(material);
  night.light(material, { part: 'diffuse' });
  const second = compiledUniforms(material);
  day.light(material);
  assertLitBy(day, first);
  assertLitBy(day, second);
});

test('a field leaves the materials of another field alone', () => {
  const day = fieldWith(BRICKS), night = fieldWith(BRICKS), material = day.light(new MeshStandardMaterial());
  const uniforms = compiledUniforms(material);
  night.light(new MeshStandardMaterial());
  assertLitBy(day, uniforms);
});

test('fields with different selectors, and different parts of the light, have shaders of their own', () => {
  const material = new MeshStandardMaterial();
  const keyOf = (field, options) => field.light(material, options).customProgramCacheKey();
  const keys = [keyOf(fieldWith(BRICKS)), keyOf(fieldWith(CAGE)), keyOf(fieldWith(BRICKS), { moving: true }),
                keyOf(fieldWith(BRICKS), { part: 'diffuse' })];
  assert.equal(new Set(keys).size, keys.length);
});
