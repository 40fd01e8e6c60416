/** The error for a file that is no field, or one that this reader cannot use. */
export class FieldError extends Error {}

export interface FieldGrid {
  /** In metres. */
  origin: number[];
  spacing: number[];
  /** Number of probes along x, y and z. */
  count: number[];
}

export interface FieldInfo {
  probes: number;
  /** Number of light field probes inside geometry. */
  buried: number;
  irradianceProbes: number;
  volumeProbes: number;
  /** Texels along a side of a light field probe's map. */
  radianceSize: number;
  bounces: number;
  /** The share of indirect light that has all bounces behind it. */
  lastBounce: number;
  /** A bit for each selector of `select`. */
  selectMask: number;
  select: ('cage' | 'voronoi' | 'octree' | 'bricks')[];
  /** In metres. */
  distanceScale: number;
  sceneMin: number[];
  sceneMax: number[];
  grid: FieldGrid | null;
  /** 16 hexadecimal digits. */
  sceneHash: string;
  /** Whether light and material are in tiles of blocks of 4 x 4 texels. */
  compressed: boolean;
  /** Whether geometry is in blocks of 4 x 4 texels. */
  geometryBlocks: boolean;
  /** Whether the file has what glossy light needs: `octalux export web --no-glossy` leaves that out. */
  glossy: boolean;
  fileBytes: number;
}

/** A field file, with its arrays as they are stored (docs/format.md). */
export interface ParsedField {
  info: FieldInfo;
  /** In scene coordinates, in metres; every position is relative to it. */
  origin: number[];
  /** x, y, z of each light field probe, in metres. */
  positions: Float32Array;
  /** Bit 0: inside geometry. */
  flags: Uint8Array;
  /** Normals of texels; undefined where geometry is in blocks. */
  normals?: Uint16Array;
  distances?: Uint16Array;
  /** Blocks of four words; `planes` holds the planes that they name, of two words. */
  geometry?: Uint32Array;
  planes?: Uint32Array;
  pyramid: { levels: number; first: number[]; nodes: number };
  least: Uint16Array;
  /** Maps of texels, or the pools of blocks that `surfaceTiles` names. */
  surfaces: { base: Uint8Array; specular: Uint8Array; direct: Uint8Array | Uint32Array; indirect: Uint8Array | Uint32Array };
  /** The words of tiles of base, specular, direct and indirect light; null where these are texels. */
  surfaceTiles: Uint32Array[] | null;
  emission: Uint32Array;
  tiles: Uint32Array;
  lights: Uint32Array;
  bricks: Uint32Array | null;
  neighbours: Uint8Array | null;
  volume: { cells: Uint32Array; light: Uint32Array } | null;
}

/** Reads a whole .olx file, version 2. Arrays of the result are views of the buffer, or of a copy where chunks are filtered. Throws a FieldError. */
export function parseField(buffer: ArrayBuffer): ParsedField;
