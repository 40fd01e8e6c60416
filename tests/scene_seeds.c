// Makes the small valid files that fuzzers of scenes begin from, which together have every feature that the importers
// read.
#include "scene_seeds.h"

#include "draco_maker.h"
#include "gltf_maker.h"
#include "scene_files.h"

#include <meshoptimizer.h>
#include <webp/encode.h>

#include <stdlib.h>
#include <string.h>

static const char description_text[] =
    "{\"model\": \"square.obj\", \"scale\": 1.5, \"models\": [{\"path\": \"square.gltf\", \"scale\": 2, \"translate\": "
    "[0, 0, 1], \"rotate_degrees\": [10, 20, 30]}],\n\"cameras\": [{\"name\": \"a\", \"eye\": [0, 0, 5], \"target\": "
    "[0, 1, "
    "0], \"up\": [0, 1, 0], \"fov_y_degrees\": 60}],\n\"lights\": [{\"type\": \"sun\", \"direction\": [0, -1, 0.2], "
    "\"irradiance\": [10, 9, 8]}, {\"type\": \"rect\", \"center\": [0, 2, 0], \"edge_u\": [1, 0, 0], \"edge_v\": [0, "
    "0, 1], "
    "\"radiance\": [17, 12, 4]}, {\"type\": \"point\", \"position\": [0, 2, 0], \"intensity\": [5, 5, 5]}, {\"type\": "
    "\"spot\", \"position\": [0, 2, 0], \"direction\": [0, -1, 0], \"intensity\": [9, 9, 9], \"cone_degrees\": [20, "
    "30]}],\n"
    "\"environment\": {\"image\": \"sky.hdr\", \"rotation_degrees\": 30, \"gain\": 2},\n\"materials\": {\"square\": "
    "{\"base_color\": [0.7, 0.7, 0.7], \"roughness\": 0.2, \"metallic\": 0.5, \"emission\": [0, 1, 0]}, \"*\": "
    "{\"specular\": "
    "0.5}},\n\"probes\": {\"min\": [-1, -1, -1], \"max\": [1, 1, 1], \"grid\": [4, 4, 4]}}";

static const char obj_text[] =
    "mtllib square.mtl\no thing\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 2\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "vn 0 0 1\nvn 0 1 0\ng quad\nusemtl square\ns 1\nf 1/1/1 2/2/1 3/3/1 4/4/1\nusemtl other\nf -1 -2 -3\nf 1//2 2//2 "
    "5//2\n"
    "f 1/1 2/2 5/3\nf 1 2 3 4 5\nl 1 2\n";

static const char mtl_text[] =
    "newmtl square\nNs 100.5\nKa 0 0 0\nKd 0.5 0.25 0.125\nKs 0.1 0.1 0.1\nKe 1 2 3\nNi 1.5\nd 0.9\nillum 2\n"
    "map_Kd four.tga\nmap_d four.tga\nmap_bump -bm 0.5 four.tga\n\nnewmtl other\nKd 1 1 1\nTr 0.1\nPr 0.3\nPm 0.7\n";

static const char gltf_materials[] =
    "[{\"name\": \"square\", \"doubleSided\": true, \"alphaMode\": \"MASK\", \"alphaCutoff\": 0.25, "
    "\"pbrMetallicRoughness\": "
    "{\"baseColorFactor\": [0.1, 0.2, 0.3, 0.9], \"metallicFactor\": 0.25, \"roughnessFactor\": 0.5, "
    "\"baseColorTexture\": "
    "{\"index\": 0}, \"metallicRoughnessTexture\": {\"index\": 0}}, \"normalTexture\": {\"index\": 0, \"scale\": 0.5}, "
    "\"emissiveFactor\": [1, 0.5, 0], \"extensions\": {\"KHR_materials_emissive_strength\": {\"emissiveStrength\": "
    "40}, "
    "\"KHR_materials_specular\": {\"specularFactor\": 0.25}}}, {\"name\": \"spare\", \"alphaMode\": \"BLEND\"}]";

static const char gltf_nodes[] = "[{\"children\": [1, 2, 3], \"translation\": [1, 0, 0]}, {\"mesh\": 0, \"rotation\": "
                                 "[0, 0.7071, 0, 0.7071], \"scale\": "
                                 "[1, 2, 3]}, {\"name\": \"eye\", \"camera\": 0, \"matrix\": [1, 0, 0, 0, 0, 1, 0, 0, "
                                 "0, 0, 1, 0, 4, 5, 6, 1]}, {\"mesh\": 0, "
                                 "\"extensions\": {\"KHR_lights_punctual\": {\"light\": 0}}}]";

static const char gltf_more[] =
    ",\n\"textures\": [{\"source\": 0, \"sampler\": 0}], \"samplers\": [{\"wrapS\": 10497}], \"images\": [{\"uri\": "
    "\"four.tga\"}],\n\"cameras\": [{\"type\": \"perspective\", \"perspective\": {\"yfov\": 1, \"znear\": 0.1}}],\n"
    "\"extensionsUsed\": [\"KHR_lights_punctual\"], \"extensions\": {\"KHR_lights_punctual\": {\"lights\": [{\"type\": "
    "\"spot\", \"color\": [1, 1, 0.5], \"intensity\": 7, \"spot\": {\"innerConeAngle\": 0.1, \"outerConeAngle\": "
    "0.5}}]}}";

static size_t make_hdr(uint8_t *bytes) {
  const char header[] = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 4\n";
  const size_t length = sizeof header - 1;
  memcpy(bytes, header, length);
  for (uint32_t i = 0; i < 64; ++i) bytes[length + i] = (uint8_t)(i % 4 == 3 ? 130 : i * 4);
  return length + 64;
}

static seed_file text_seed(const char *name, const char *opened, const char *text) {
  return (seed_file){.name = name, .opened = opened, .bytes = (uint8_t *)strdup(text), .size_bytes = strlen(text)};
}

static const float square_positions[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};

// Makes quantised, sparse and interleaved vertices with every attribute, strips and fans, and joints.
static void make_rich(gltf_maker *m) {
  const int16_t corners[16] = {0, 0, 0, 0, 1000, 0, 0, 0, 1000, 1000, 0, 0, 0, 1000, 0, 0};
  const int8_t normals[16] = {0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0};
  const uint16_t uvs[8] = {0, 65535, 65535, 65535, 65535, 0, 0, 0}, moved = 2;
  const uint8_t colors[16] = {255, 0, 0, 255, 255, 255, 0, 255, 0, 255, 0, 128, 0, 0, 255, 255},
                strip[4] = {0, 1, 3, 2};
  const float tangents[16] = {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, -1}, corner[3] = {2, 2, 1};
  gltf_add_view(m, corners, sizeof corners, ", \"byteStride\": 8");
  gltf_add_view(m, normals, sizeof normals, ", \"byteStride\": 4");
  gltf_add_accessor(m, "\"bufferView\": 0, ", 4, GLTF_INT16, "VEC3");
  gltf_add_accessor(m, "\"bufferView\": 1, \"normalized\": true, ", 4, GLTF_INT8, "VEC3");
  gltf_add(m, uvs, sizeof uvs, 4, GLTF_UINT16, "VEC2", true);
  gltf_add(m, colors, sizeof colors, 4, GLTF_UINT8, "VEC4", true);
  gltf_add(m, tangents, sizeof tangents, 4, GLTF_FLOAT, "VEC4", false);
  gltf_add(m, strip, sizeof strip, 4, GLTF_UINT8, "SCALAR", false);
  gltf_add(m, square_positions, sizeof square_positions, 4, GLTF_FLOAT, "VEC3", false);
  gltf_add_view(m, &moved, sizeof moved, "");
  gltf_add_view(m, corner, sizeof corner, "");
  gltf_add_accessor(m,
                    "\"bufferView\": 6, \"sparse\": {\"count\": 1, \"indices\": {\"bufferView\": 7, "
                    "\"componentType\": 5123}, \"values\": {\"bufferView\": 8}}, ",
                    4, GLTF_FLOAT, "VEC3");
  const uint8_t joints[16] = {0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0};
  const uint8_t weights[16] = {255, 0, 0, 0, 255, 0, 0, 0, 128, 127, 0, 0, 200, 55, 0, 0};
  const float matrices[32] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1,
                              1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1};
  gltf_add(m, joints, sizeof joints, 4, GLTF_UINT8, "VEC4", false);
  gltf_add(m, weights, sizeof weights, 4, GLTF_UINT8, "VEC4", true);
  gltf_add(m, matrices, sizeof matrices, 2, GLTF_FLOAT, "MAT4", false);
}

static const char rich_primitives[] =
    "{\"attributes\": {\"POSITION\": 0, \"NORMAL\": 1, \"TEXCOORD_0\": 2, \"TEXCOORD_1\": 2, \"COLOR_0\": 3, "
    "\"TANGENT\": 4, \"JOINTS_0\": 8, \"WEIGHTS_0\": 9}, \"indices\": 5, \"mode\": 5, \"material\": 0}, "
    "{\"attributes\": {\"POSITION\": 7}, \"mode\": 6}";
static const char rich_nodes[] = "[{\"children\": [1], \"scale\": [0.001, 0.001, 0.001]}, {\"mesh\": 0, \"skin\": 0}]";
static const char rich_more[] =
    ", \"scene\": 0, \"skins\": [{\"joints\": [0, 1], \"inverseBindMatrices\": 10}], \"materials\": [{\"alphaMode\": "
    "\"MASK\", \"pbrMetallicRoughness\": {\"baseColorTexture\": "
    "{\"index\": "
    "0}}, \"normalTexture\": {\"index\": 0, \"texCoord\": 1, \"extensions\": {\"KHR_texture_transform\": {\"offset\": "
    "[0.5, "
    "0], \"rotation\": 1, \"scale\": [2, 3], \"texCoord\": 1}}}, \"emissiveTexture\": {\"index\": 0}, "
    "\"emissiveFactor\": [1, "
    "1, 1]}], \"textures\": [{\"source\": 0}], \"images\": [{\"uri\": "
    "\"data:image/png;base64,AAACAAAAAAAAAAAAAgACACAoAAD//wD/AP//AAD/////AA==\"}], \"extensionsUsed\": "
    "[\"KHR_mesh_quantization\", \"KHR_texture_transform\"]";

static void make_packed(gltf_maker *m) {
  const char *name = "EXT_meshopt_compression";
  const float up[16] = {0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
  float positions[12];
  int8_t normals[16];
  meshopt_encodeFilterExp(positions, 4, 12, 15, square_positions);
  meshopt_encodeFilterOct(normals, 4, 4, 8, up);
  gltf_add_vertices(m, name, positions, 12, ", \"filter\": \"EXPONENTIAL\"", "", GLTF_FLOAT);
  gltf_add_vertices(m, name, normals, 4, ", \"filter\": \"OCTAHEDRAL\"", "\"normalized\": true, ", GLTF_INT8);
  gltf_add_indices(m, name, true);
  gltf_add_indices(m, name, false);
}

static const char packed_primitives[] = "{\"attributes\": {\"POSITION\": 0, \"NORMAL\": 1}, \"indices\": 2}, "
                                        "{\"attributes\": {\"POSITION\": 0}, \"indices\": 3}";

// Makes a square that Draco compressed and that stands in two places, and an image in WebP.
static void make_squeezed(gltf_maker *m) {
  const float up[12] = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, uvs[8] = {0, 1, 1, 1, 1, 0, 0, 0};
  const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
  const uint8_t texels[16] = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 0};
  const draco_mesh mesh = {
      .positions = square_positions, .normals = up, .uvs = uvs, .points = 4, .indices = indices, .faces = 2};
  uint8_t stream[1024], *image = NULL;
  const size_t stream_bytes = draco_encode(&mesh, stream, sizeof stream);
  const size_t image_bytes = WebPEncodeLosslessRGBA(texels, 2, 2, 8, &image);
  gltf_add_view(m, stream, stream_bytes, "");
  gltf_add_view(m, image, image_bytes, "");
  WebPFree(image);
  gltf_add_accessor(m, "", 4, GLTF_FLOAT, "VEC3");
  gltf_add_accessor(m, "", 4, GLTF_FLOAT, "VEC3");
  gltf_add_accessor(m, "", 4, GLTF_FLOAT, "VEC2");
  gltf_add_accessor(m, "", 6, GLTF_UINT16, "SCALAR");
  const float places[6] = {0, 0, 0, 0, 0, 1};
  gltf_add(m, places, sizeof places, 2, GLTF_FLOAT, "VEC3", false);
}

static const char squeezed_nodes[] =
    "[{\"mesh\": 0, \"extensions\": {\"EXT_mesh_gpu_instancing\": {\"attributes\": {\"TRANSLATION\": 4}}}}]";
static const char squeezed_primitives[] =
    "{\"attributes\": {\"POSITION\": 0, \"NORMAL\": 1, \"TEXCOORD_0\": 2}, \"indices\": 3, \"material\": 0, "
    "\"extensions\": {\"KHR_draco_mesh_compression\": {\"bufferView\": 0, \"attributes\": {\"POSITION\": 0, "
    "\"NORMAL\": 1, \"TEXCOORD_0\": 2}}}}";
static const char squeezed_more[] =
    ", \"materials\": [{\"pbrMetallicRoughness\": {\"metallicFactor\": 0.5, \"baseColorTexture\": {\"index\": 0}}, "
    "\"extensions\": {\"KHR_materials_transmission\": {\"transmissionFactor\": 0.75}}}], \"textures\": "
    "[{\"extensions\": {\"EXT_texture_webp\": {\"source\": 0}}}], \"images\": [{\"bufferView\": 1, "
    "\"mimeType\": \"image/webp\"}], \"extensionsRequired\": [\"KHR_draco_mesh_compression\", "
    "\"EXT_texture_webp\"]";

// Makes two seeds of a made file: as text and as .glb.
static void make_gltf_seeds(const gltf_maker *m, const char *primitives, const char *nodes, const char *more,
                            const char *const names[2], seed_file seeds[2]) {
  char *text = gltf_maker_text(m, primitives, nodes, more, true);
  seeds[0] = (seed_file){.name = names[0], .opened = names[0]};
  seeds[0].bytes = (uint8_t *)gltf_maker_text(m, primitives, nodes, more, false);
  seeds[0].size_bytes = strlen((char *)seeds[0].bytes);
  seeds[1] = (seed_file){.name = names[1], .opened = names[1]};
  seeds[1].size_bytes = gltf_make_glb(text, strlen(text), m->bytes, m->size_bytes, &seeds[1].bytes);
  free(text);
}

void scene_seeds_make(seed_file seeds[SEED_COUNT]) {
  seeds[0] = text_seed("scene.json", "scene.json", description_text);
  seeds[1] = text_seed("square.obj", "square.obj", obj_text);
  seeds[2] = text_seed("square.mtl", "square.obj", mtl_text);
  seeds[3] = (seed_file){.name = "square.gltf", .opened = "square.gltf"};
  seeds[3].bytes = (uint8_t *)scene_files_gltf(gltf_materials, 0, gltf_nodes, gltf_more, false);
  seeds[3].size_bytes = strlen((char *)seeds[3].bytes);
  seeds[4] = (seed_file){.name = "square.glb", .opened = "square.glb"};
  seeds[4].size_bytes = scene_files_glb(gltf_materials, 0, gltf_nodes, gltf_more, &seeds[4].bytes);
  seeds[5] = (seed_file){.name = "four.tga", .opened = "square.obj", .bytes = malloc(34)};
  seeds[5].size_bytes = scene_files_tga(seeds[5].bytes);
  seeds[6] = (seed_file){.name = "sky.hdr", .opened = "scene.json", .bytes = malloc(256)};
  seeds[6].size_bytes = make_hdr(seeds[6].bytes);
  gltf_maker rich = {0}, packed = {0}, squeezed = {0};
  make_rich(&rich);
  make_gltf_seeds(&rich, rich_primitives, rich_nodes, rich_more, (const char *const[]){"rich.gltf", "rich.glb"},
                  seeds + 7);
  make_squeezed(&squeezed);
  make_gltf_seeds(&squeezed, squeezed_primitives, squeezed_nodes, squeezed_more,
                  (const char *const[]){"squeezed.gltf", "squeezed.glb"}, seeds + 11);
  make_packed(&packed);
  make_gltf_seeds(&packed, packed_primitives, "[{\"mesh\": 0}]", "", (const char *const[]){"packed.gltf", "packed.glb"},
                  seeds + 9);
}

void scene_seeds_free(seed_file seeds[SEED_COUNT]) {
  for (uint32_t i = 0; i < SEED_COUNT; ++i) free(seeds[i].bytes);
}
