// Statements that TypeScript must accept, and some that it must reject; compiled, not run.
import { Group, MeshBasicMaterial, MeshPhysicalMaterial, MeshStandardMaterial, WebGLRenderer } from 'three';
import { FieldError, OctaluxField, parseField } from '../dist/index.js';

export async function lightRoom(renderer: WebGLRenderer, room: Group): Promise<number> {
  const field = await OctaluxField.load('room.olx', renderer, { onProgress: (loaded, total) => console.log(loaded / total) });
  const physical: MeshPhysicalMaterial = field.light(new MeshPhysicalMaterial(), { moving: true });
  field.light(new MeshStandardMaterial(), { part: 'diffuse' });
  // @ts-expect-error: a material without lighting
  field.light(new MeshBasicMaterial());
  // @ts-expect-error: no such part
  field.light(physical, { part: 'specular' });
  // @ts-expect-error: fields are loaded
  new OctaluxField();
  field.offset.set(0, 1, 0);
  return field.lightAll(room) + field.info.probes;
}

export function probesOf(buffer: ArrayBuffer): number {
  try {
    return parseField(buffer).info.probes;
  } catch (error) {
    if (error instanceof FieldError) return 0;
    throw error;
  }
}
