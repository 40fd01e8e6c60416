// A baked light field that lights materials of three.js.
//
// SPDX-License-Identifier: MIT
import { AddEquation, CustomBlending, EqualDepth, OneFactor, Vector2, Vector3, Vector4 } from 'three';
import { download } from './download.js';
import { parseField } from './field_file.js';
import { patchShader } from './shading.js';
import { fieldUniforms } from './textures.js';

const PARTS = ['all', 'diffuse', 'glossy'];
// Material settings that add glossy light alone to the drawn picture, in one pass, since separate passes for back and
// front would need two shaders.
const ADDED = {
  transparent: true, forceSinglePass: true, blending: CustomBlending, blendEquation: AddEquation, blendSrc: OneFactor, blendDst: OneFactor,
  depthWrite: false, depthFunc: EqualDepth,
};
const CAGE = 1, VORONOI = 2, BRICKS = 8; // bits of select_mask
const lightings = new WeakMap(); // by material, an object whose `field` is the one that lit the material last

// Returns the selector of a field, as OLX_SELECT_BEST in octalux/sample.h.
function selectorOf(mask) {
  if (mask & BRICKS) return 'OLX_SELECT_BRICKS';
  if (mask & CAGE) return 'OLX_SELECT_CAGE';
  return mask & VORONOI ? 'OLX_SELECT_VORONOI' : 'OLX_SELECT_EXHAUSTIVE';
}

export class OctaluxField {
  #textures;

  /** Use `OctaluxField.load` or `OctaluxField.fromBuffer`. */
  constructor(parsed, uniforms) {
    this.info = parsed.info;
    this.origin = parsed.origin;
    this.positions = parsed.positions;
    this.flags = parsed.flags;
    this.uniforms = {
      ...uniforms,
      olx_offset: { value: new Vector3() },
      olx_strength: { value: new Vector2(1, 1) },
      olx_left: { value: 0 },
      olx_viewport: { value: new Vector4(0, 0, 1, 1) },
      olx_sample_index: { value: 0 },
      olx_emitters: { value: false },
      olx_layer: { value: 0 },
    };
    this.#textures = Object.values(uniforms).map(({ value }) => value).filter((value) => value.isTexture);
    this.defines = `#define OLX_WEB_SELECT ${selectorOf(parsed.info.selectMask)}\n`;
  }

  static async load(url, renderer, { onProgress, signal } = {}) {
    return OctaluxField.fromBuffer(await download(url, { onProgress, signal }), renderer);
  }

  static async fromBuffer(buffer, renderer) {
    const parsed = parseField(buffer);
    return new OctaluxField(parsed, await fieldUniforms(parsed, renderer));
  }

  /** Position of the field's origin in the world. */
  get offset() {
    return this.uniforms.olx_offset.value;
  }

  light(material, { moving = false, part = 'all' } = {}) {
    if (!material.isMeshStandardMaterial) throw new TypeError('a field lights MeshStandardMaterial and MeshPhysicalMaterial');
    if (!PARTS.includes(part)) throw new TypeError(`part is '${part}', not one of ${PARTS.join(', ')}`);
    const choice = { defines: this.defines, moving, part: this.#partOf(part) };
    const lighting = lightings.get(material) ?? {};
    lighting.field = this;
    lightings.set(material, lighting);
    material.onBeforeCompile = (shader) => patchShader(shader, lighting, choice);
    material.onBeforeRender = (renderer) => renderer.getCurrentViewport(this.uniforms.olx_viewport.value);
    material.customProgramCacheKey = () => `octalux ${this.defines} ${moving} ${choice.part}`;
    if (part === 'glossy') Object.assign(material, ADDED);
    material.needsUpdate = true;
    return material;
  }

  // A field without data for reflections gives diffuse light alone.
  #partOf(part) {
    if (this.info.glossy) return part;
    if (part === 'glossy') throw new TypeError('this field has no data for glossy light (export web --no-glossy)');
    return 'diffuse';
  }

  lightAll(root, options) {
    const materials = new Set();
    root.traverse((object) => [object.material ?? []].flat().forEach((material) => materials.add(material)));
    for (const material of materials) if (material.isMeshStandardMaterial) this.light(material, options);
    return materials.size;
  }

  setIndirect(diffuse, glossy = diffuse) {
    this.uniforms.olx_strength.value.set(diffuse, glossy);
  }

  setFrame(index) {
    this.uniforms.olx_sample_index.value = index;
  }

  dispose() {
    for (const texture of this.#textures) texture.dispose();
  }
}
