/** What is wrong with a file that is no field, or one that this reader cannot use. */
export class FieldError extends Error {}

export interface FieldGrid {
  /** Metres. */
  origin: number[];
  spacing: number[];
  /** Probes along x, y and z. */
  count: number[];
}

export interface FieldInfo {
  probes: number;
  /** Light field probes inside geometry. */
  buried: number;
  irradianceProbes: number;
  volumeProbes: number;
  /** Texels along a side of a light field probe's map. */
  radianceSize: number;
  bounces: number;
  /** The share of indirect light that has all bounces behind it. */
  lastBounce: number;
  /** A bit for each of `select`. */
  selectMask: number;
  select: ('cage' | 'voronoi' | 'octree' | 'bricks')[];
  /** Metres. */
  distanceScale: number;
  sceneMin: number[];
  sceneMax: number[];
  grid: FieldGrid | null;
  /** 16 hexadecimal digits. */
  sceneHash: string;
  /** Whether light and material are in blocks of 4 x 4 texels. */
  compressed: boolean;
  /** Whether geometry is in blocks of 4 x 4 texels. */
  geometryBlocks: boolean;
  fileBytes: number;
}

/** A field file, its arrays as they lie there (docs/format.md). */
export interface ParsedField {
  info: FieldInfo;
  /** In scene coordinates, metres; every position is relative to it. */
  origin: number[];
  /** x, y, z of each light field probe, metres. */
  positions: Float32Array;
  /** Bit 0: inside geometry. */
  flags: Uint8Array;
  /** Of texels; undefined where geometry is in blocks. */
  normals?: Uint16Array;
  distances?: Uint16Array;
  /** Blocks of four words, and the planes that they name, of two words. */
  geometry?: Uint32Array;
  planes?: Uint32Array;
  pyramid: { levels: number; first: number[]; nodes: number };
  least: Uint16Array;
  surfaces: { base: Uint8Array; specular: Uint8Array; direct: Uint8Array | Uint32Array; indirect: Uint8Array | Uint32Array };
  emission: Uint32Array;
  tiles: Uint32Array;
  lights: Uint32Array;
  bricks: Uint32Array | null;
  neighbours: Uint8Array | null;
  volume: { cells: Uint32Array; light: Uint32Array } | null;
}

/** Reads a whole .olx file, version 2. Arrays of the result are views of the buffer. Throws a FieldError. */
export function parseField(buffer: ArrayBuffer): ParsedField;
