import type { IUniform, MeshStandardMaterial, Object3D, Vector3, WebGLRenderer } from 'three';
import type { FieldInfo, ParsedField } from './field_file.js';

export { FieldError, parseField } from './field_file.js';
export type { FieldGrid, FieldInfo, ParsedField } from './field_file.js';

export interface LoadOptions {
  /** Receives the number of bytes loaded, and their total as far as it is known. */
  onProgress?: (loaded: number, total: number) => void;
  signal?: AbortSignal;
}

export interface LightOptions {
  /** Takes diffuse light from the irradiance volume, for moving objects, instead of the light stored at surfaces. Default false. */
  moving?: boolean;
  /**
   * Default 'all'. 'diffuse' leaves out glossy light, whose shader takes longer to compile. 'glossy' is glossy light alone, added to the
   * picture at the same depth: give it to a second mesh with the same geometry, best in a scene without lights that is rendered later.
   */
  part?: 'all' | 'diffuse' | 'glossy';
}

/** A baked light field on a renderer. It gives indirect light only: three.js still computes the direct light of the scene's lights. */
export class OctaluxField {
  private constructor(parsed: ParsedField, uniforms: Record<string, IUniform>);

  /** Loads an .olx file, plain or compressed by gzip. Rejects with a FieldError when it is no field, or does not fit the device. */
  static load(url: string, renderer: WebGLRenderer, options?: LoadOptions): Promise<OctaluxField>;
  /** Makes a field from the bytes of a plain .olx file. */
  static fromBuffer(buffer: ArrayBuffer, renderer: WebGLRenderer): Promise<OctaluxField>;

  readonly info: FieldInfo;
  /** In scene coordinates, in metres; positions of the field are relative to it. */
  readonly origin: number[];
  /** x, y, z of each light field probe. */
  readonly positions: Float32Array;
  /** Bit 0: the probe is inside geometry. */
  readonly flags: Uint8Array;
  /** Uniforms that all materials of this field share. */
  readonly uniforms: Record<string, IUniform>;
  /** Position of the field's origin in the world. Default (0, 0, 0). */
  readonly offset: Vector3;

  /**
   * Lights a standard or physical material, in place of a field that lit it before; returns it. Replaces its onBeforeCompile and
   * onBeforeRender. Throws a TypeError for another material, and for part 'glossy' of a field without glossy light (`info.glossy`).
   */
  light<M extends MeshStandardMaterial>(material: M, options?: LightOptions): M;
  /** Lights every standard and physical material below `root`; returns how many materials there are. */
  lightAll(root: Object3D, options?: LightOptions): number;
  /** Sets how much of the light is added: 0 adds none, 1 (the default) all of it. */
  setIndirect(diffuse: number, glossy?: number): void;
  /** Sets the number of the next frame, by which rough surfaces choose other rays. */
  setFrame(index: number): void;
  /** Frees the textures. */
  dispose(): void;
}
