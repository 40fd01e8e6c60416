// Bindings, constants, and the structs in the GPU's memory, shared by C and GLSL. Both compilers read this file.
//
// Structs hold 32-bit scalars and vectors of four with explicit padding, so that std140, std430 and C lay them out
// alike; src/vulkan/gpu_structs.h asserts every offset.
#ifndef OCTALUX_SHARED_H
#define OCTALUX_SHARED_H

#if defined(GL_core_profile) || defined(GL_ES)
#define OLX_GPU_STRUCT(name) struct name
#define olx_gpu_uint uint
#define olx_gpu_float float
#define olx_gpu_vec4 vec4
#define olx_gpu_uvec4 uvec4
#else
#include <stdint.h>
#define OLX_GPU_STRUCT(name)                                                                                           \
  typedef struct name name;                                                                                            \
  struct name
typedef uint32_t olx_gpu_uint;
typedef float olx_gpu_float;
typedef struct olx_gpu_vec4 {
  float x, y, z, w;
} olx_gpu_vec4;
typedef struct olx_gpu_uvec4 {
  uint32_t x, y, z, w;
} olx_gpu_uvec4;
#endif

// The descriptor set of a field. A host that includes the library chooses its number by defining OLX_FIELD_SET before.
#define OLX_BINDING_FIELD 0             // uniform buffer, olx_field_constants
#define OLX_BINDING_PROBES 1            // storage buffer, olx_gpu_probe[probe_count]
#define OLX_BINDING_IRRADIANCE_PROBES 2 // storage buffer, olx_gpu_probe[irradiance_probe_count]
#define OLX_BINDING_WORDS 3             // storage buffer: pyramids, selectors, emission, lights, the volume
#define OLX_BINDING_RADIANCE 4          // combined image samplers, 2D arrays
#define OLX_BINDING_NORMAL 5
#define OLX_BINDING_DISTANCE 6 // or geometry blocks, a texel each, and then there are no normals
#define OLX_BINDING_IRRADIANCE 7
#define OLX_BINDING_MOMENTS 8
#define OLX_BINDING_INDIRECT 9
#define OLX_BINDING_DIRECT 10
#define OLX_BINDING_BASE 11     // base colour and roughness
#define OLX_BINDING_SPECULAR 12 // metallic and specular weight
#define OLX_FIELD_BINDINGS 13
#define OLX_FIELD_STORAGE_BUFFERS 3

// The buffer of classic maps (irradiance probes without visibility): a header of words with the offset of each part in
// words, then the parts as they lie in the file.
#define OLX_CLASSIC_SIZE 0 // texels along a side
#define OLX_CLASSIC_TABLE 1
#define OLX_CLASSIC_BOXES 2
#define OLX_CLASSIC_IRRADIANCE 3
#define OLX_CLASSIC_RADIANCE 4
#define OLX_CLASSIC_RADIANCE_WORDS 5 // of a probe
#define OLX_CLASSIC_HEADER_WORDS 16
#define OLX_CLASSIC_TABLE_SIDE 64u
#define OLX_CLASSIC_LEVELS 5u // of prefiltered radiance, for roughness 0, 1/4, 1/2, 3/4, 1
#define OLX_CLASSIC_LEAST_SIDE 8u

// The descriptor set of a frame: the host's images.
#define OLX_BINDING_DEPTH 0 // sampled
#define OLX_BINDING_SURFACE_NORMAL 1
#define OLX_BINDING_ALBEDO 2
#define OLX_BINDING_ROUGHNESS 3
#define OLX_BINDING_GEOMETRIC_NORMAL 4 // where the host has none of these three, another image is bound, unread
#define OLX_BINDING_VERTEX_NORMAL 5
#define OLX_BINDING_DYNAMIC 6
#define OLX_BINDING_OUT_IRRADIANCE 7 // storage, rgba16f
#define OLX_BINDING_OUT_GLOSSY 8
#define OLX_BINDING_OUT_COLOR 9
#define OLX_FRAME_BINDINGS 10

// The descriptor set of a lobe's samples, for the denoiser. Without a denoiser, the lobe's output is bound instead.
// Storage, rgba16f: light before albedo and Fresnel; alpha: 1 / distance, negative without light.
#define OLX_BINDING_SAMPLE 0
#define OLX_SAMPLE_BINDINGS 1

// The descriptor set of the denoiser's mean over frames. "Now" marks what it writes, "before" what the previous frame
// wrote.
#define OLX_BINDING_DENOISE_DEPTH 0 // sampled
#define OLX_BINDING_DENOISE_NORMAL 1
#define OLX_BINDING_DENOISE_ROUGHNESS 2
#define OLX_BINDING_GUIDE_BEFORE 3 // rgba32ui
#define OLX_BINDING_DIFFUSE_BEFORE 4
#define OLX_BINDING_GLOSSY_BEFORE 5
#define OLX_BINDING_GUIDE_NOW 6   // storage, rgba32ui
#define OLX_BINDING_DIFFUSE_NOW 7 // storage, rgba16f; holds the samples first
#define OLX_BINDING_GLOSSY_NOW 8
#define OLX_ACCUMULATE_BINDINGS 9

// The descriptor set of the denoiser's filter over pixels.
#define OLX_BINDING_GUIDE 0 // sampled
#define OLX_BINDING_LIGHT 1 // the mean over frames
#define OLX_BINDING_ROWS 2  // the result of filtering along rows
#define OLX_BINDING_FILTER_ALBEDO 3
#define OLX_BINDING_FILTER_ROUGHNESS 4
#define OLX_BINDING_OUT_ROWS 5   // storage, rgba16f
#define OLX_BINDING_OUT_TARGET 6 // storage, rgba16f: the host's
#define OLX_FILTER_BINDINGS 7

// The descriptor set of a relighter's passes; the field's set, restricted to what a pass reads, is set 1. A pass uses
// at most four storage buffers.
#define OLX_BINDING_STATE 0        // storage buffers, of words: olx_gpu_relight, then lights, tiles, light
#define OLX_BINDING_STRUCTURE 1    // surfels and their links; or sites of texels, and links of volume probes
#define OLX_BINDING_VOLUME_LIGHT 2 // the field's words, whose irradiance of the volume is written
#define OLX_RELIGHT_BINDINGS 3
#define OLX_RELIGHT_GROUP 64 // threads of a workgroup
#define OLX_LIGHT_WORDS 20u
#define OLX_LAMP_POINT_WORDS 12u // of olx_gpu_lamp_point
#define OLX_TILE_WORDS 4u // of a scheduled tile: probe, first x, first y, samples that its direct light is the mean of
#if defined(GL_core_profile) || defined(GL_ES)
#define OLX_LIGHT_SUN 0u
#define OLX_LIGHT_POINT 1u
#define OLX_LIGHT_SPOT 2u
#define OLX_LIGHT_RECT 3u
#define OLX_LIGHT_TRIANGLE 4u
#define OLX_LIGHT_SKY 5u
#endif

// Bits of olx_gpu_relight_call.flags: the dispatch is the first, or the last, for its places.
#define OLX_CALL_BEGINS 1u
#define OLX_CALL_ENDS 2u
#define OLX_CALL_SHINES 4u // of a dispatch that follows links: highlights are recomputed
#define OLX_CALL_ALL 8u    // of a dispatch that sums the light of surfels: with that of lamps close by

#define OLX_SELECT_GPU_MASK 0xBu // bits (1 << olx_select) of the stored selectors that have a twin

// Specialisation constants of pipelines whose shaders sample a field, so that a driver compiles one tracer, one
// selector and one kind of light at the end of rays. A host that uses these numbers for constants of its own defines
// others before this file.
#ifndef OLX_CONSTANT_TRACER
#define OLX_CONSTANT_TRACER 0 // OLX_TRACER_*; default OLX_TRACER_HIZ
#endif
#ifndef OLX_CONSTANT_SELECT
#define OLX_CONSTANT_SELECT 1 // OLX_SELECT_*, of which the field has what it needs; default OLX_SELECT_BRICKS
#endif
#ifndef OLX_CONSTANT_HITS
#define OLX_CONSTANT_HITS 2 // OLX_HITS_*; default OLX_HITS_SHADED
#endif
#ifndef OLX_CONSTANT_GEOMETRY
#define OLX_CONSTANT_GEOMETRY 3 // OLX_GEOMETRY_IN_*; default OLX_GEOMETRY_IN_EITHER
#endif
// How the field's geometry is stored on the device; a shader for either form reads it from the field.
#define OLX_GEOMETRY_IN_TEXELS 0
#define OLX_GEOMETRY_IN_BLOCKS 1
#define OLX_GEOMETRY_IN_EITHER 2

// In C these are enumerations, in octalux/sample.h and octalux/field.h.
#if defined(GL_core_profile) || defined(GL_ES)
#define OLX_TRACER_TEXEL 0u
#define OLX_TRACER_TWO_LEVEL 1u
#define OLX_TRACER_HIZ 2u
#define OLX_SELECT_CAGE 0u
#define OLX_SELECT_VORONOI 1u
#define OLX_SELECT_BRICKS 3u
#define OLX_SELECT_EXHAUSTIVE 4u
#define OLX_SELECT_BEST 5u
#define OLX_HITS_SHADED 0u
#define OLX_HITS_STORED 1u
#define OLX_TRACE_MISS 0u
#define OLX_TRACE_HIT 1u
#define OLX_TRACE_UNKNOWN 2u
#endif

#define OLX_PROBE_BURIED 1u // bits of a probe's flags
#define OLX_NO_PROBE 0xFFFFFFFFu

// Bits of olx_frame_constants.flags.
#define OLX_FRAME_KEEP_BURIED 1
#define OLX_FRAME_EMITTERS 2
#define OLX_FRAME_VISIBILITY 4
#define OLX_FRAME_NORMAL_UNORM 8 // normals are stored as 0..1
#define OLX_FRAME_DIFFUSE 16     // the composite pass adds this lobe
#define OLX_FRAME_GLOSSY 32
#define OLX_FRAME_SAMPLE 64             // the lobe is denoised: write samples
#define OLX_FRAME_IRRADIANCE_PROBES 128 // irradiance comes from irradiance probes alone
#define OLX_FRAME_RANK_ALL 256          // all probes, not only those nearby, are ranked for light on surfaces
#define OLX_FRAME_GEOMETRIC_NORMAL 512  // the host gives this image
#define OLX_FRAME_GEOMETRIC_UNORM 1024
#define OLX_FRAME_VERTEX_NORMAL 2048
#define OLX_FRAME_VERTEX_UNORM 4096
#define OLX_FRAME_DYNAMIC 8192

// Bits of olx_accumulate_constants.flags and olx_filter_constants.flags.
#define OLX_DENOISE_DIFFUSE 1 // the lobes to mix into their histories
#define OLX_DENOISE_GLOSSY 2  // in a filter: the lobe is the glossy one
#define OLX_DENOISE_RESTART 4
#define OLX_DENOISE_NORMAL_UNORM 8
#define OLX_DENOISE_MIRRORED 16 // the camera's frame is left-handed
#define OLX_DENOISE_MIRRORED_BEFORE 32
#define OLX_DENOISE_COLUMNS 64

// Bits that the flags of frames and those of the denoiser have in common: one pixel of each 2 x 2 traces, the one at
// the place that TURN_X and TURN_Y give.
#define OLX_TURN_SPARSE 16384
#define OLX_TURN_X 32768
#define OLX_TURN_Y 65536

#define OLX_PASS_SIZE 8 // threads along a side of a pass's workgroup

// Geometry blocks (src/block/geometry_block.h): texels along a side, the form of a block, in the two highest bits of
// its last word, and the number that turns the exponent of a coded plane into that of a float.
#define OLX_BLOCK_SIDE 4u
#define OLX_GEOMETRY_ONE 0u  // one plane, three floats
#define OLX_GEOMETRY_TWO 1u  // two coded planes, a bit a texel
#define OLX_GEOMETRY_POOL 2u // the number of the first plane in the pool, four bits a texel to add
#define OLX_PLANE_EXPONENT 45u
#define OLX_NO_PLANE 0xFFFFFFFFu

// Constants of files that have a twin: a file of C and one of shaders/lib with the same stem. Floats have their suffix,
// because C would compute in double without it.

// vec
#define OLX_PI 3.14159265358979323846f

// octahedral: the square root of 4 pi. A texel of an n x n map is about this over n wide, seen at distance 1.
#define OLX_TEXEL_ANGLE 3.5449077f
// octahedral: directions are taken to be this long at least, so that the inverse of their length is finite.
#define OLX_LEAST_LENGTH 1e-37f

// pack: the largest numbers in RGB9E5, and in a half float.
#define OLX_RGB9E5_MOST 65408.0f
#define OLX_HALF_MOST 65504.0f

// bsdf: below this roughness the lobe is a perfect mirror.
#define OLX_MIRROR_ROUGHNESS 0.03f

// harmonics: spherical harmonics of the bands from 0 on.
#define OLX_HARMONICS_MOST_BANDS 3u
#define OLX_HARMONICS_MOST (OLX_HARMONICS_MOST_BANDS * OLX_HARMONICS_MOST_BANDS)

// texels: tiles of surfaces, a word for 8 x 8 texels of a map, which names blocks in a pool. The two highest bits are
// its form; the others are the number of its first block. A word of 0 is a tile of nothing but sky.
#define OLX_TILE_SIDE 8u
#define OLX_TILE_FORM_SHIFT 30u
#define OLX_TILE_HALF 1u     // one block: a texel of it for 2 x 2 texels
#define OLX_TILE_FULL 2u     // four blocks, row by row
#define OLX_POOL_ROW_BITS 9u // an image of a pool has 512 blocks in a row, and up to 512 rows in a layer

// texels: texels along a side of a tile of emission, and the code of a specular weight of 1 (src/block/reflectance.h);
// codes above it are metalness, codes below it weights.
#define OLX_EMISSION_TILE 8u
#define OLX_REFLECTANCE_FULL 128.0f

// sight: how far behind a stored surface a place may lie and still count as on it, in footprints of the texel, and the
// least cosine at which a surfel counts as seen; flatter angles are treated like it.
#define OLX_SIGHT_START 0.5f // at a ray's start
#define OLX_SIGHT_STUCK 1.0f // where another probe lost a ray
#define OLX_SIGHT_LEAST_COSINE 0.1f
// A ray that starts less high above a surface, in footprints, must leave it: it may have begun on the other side.
#define OLX_SIGHT_ABOVE 0.25f

// bricks: cells of space that list the probes which see them (docs/format.md).
#define OLX_BRICK_SIDE 4u   // cells along the side of a brick
#define OLX_BRICK_PROBES 8u // the most in a list
// Words of a divided brick, two cells each, and of a list, two probes each.
#define OLX_BRICK_CELL_WORDS (OLX_BRICK_SIDE * OLX_BRICK_SIDE * OLX_BRICK_SIDE / 2u)
#define OLX_BRICK_LIST_WORDS (OLX_BRICK_PROBES / 2u)
#define OLX_BRICK_NO_PROBE 0xFFFFu    // fills the free places of a list
#define OLX_BRICK_DIVIDED 0x80000000u // marks a brick that has cells of its own; without it the brick has one list
#define OLX_BRICK_HEADER_WORDS 16u    // of olx_bricks_header

// voronoi
#define OLX_VORONOI_HEADER_WORDS 4u // of olx_voronoi_header
#define OLX_CHOICES 4u              // the most probes that a texel lists, or a leaf of an octree, best first
#define OLX_FEW_PROBES 64u // up to so many are searched one by one; about here the tree pays off (docs/studies.md)

// probe_trace
#define OLX_DISTANCE_PRECISION (1.0f / 2048.0f) // the largest relative error of a half float
#define OLX_NEIGHBOURHOOD_TEXELS 1.5f           // how far from its texel's centre a surfel may be hit
#define OLX_STILL_TEXELS 1e-3f // an image that moves by less over a piece is a point: rounding decides its direction
// The share of the distance of the ray's origin from the probe below which rounding decides the image of a point. The
// ray then counts as in front of everything.
#define OLX_CENTRE_SHARE 1e-4f
#define OLX_PARAMETER_ROUNDING (1.0f / 1048576.0f) // of s and of t(s), in units of the piece's largest parameter
#define OLX_NEVER 1.2676506002282294e30f           // 2^100
#define OLX_PYRAMID_FINEST 2                       // log2 of the texels along a side of a node of level 0
#define OLX_PYRAMID_STEP 2                         // log2 of the side of a node, in nodes of the level below
// A texel's verdict on a ray: the ray passes in front, meets the surface, or is behind it, where the probe cannot see.
#define OLX_VERDICT_CLEAR 0
#define OLX_VERDICT_HIT 1
#define OLX_VERDICT_HIDDEN 2

// The largest angular error of stored normals in radians. No highlight is narrower, a ray meets a surface from behind
// where it runs along the normal by more than that, and a point may be off a texel's plane by so much of the distance
// between them.
#define OLX_STORED_NORMAL_ERROR 0.0111f

// A channel that is darker than this share of the brightest may be lost in stored light, whose channels share an
// exponent.
#define OLX_STORED_LIGHT_RANGE 0.0078125f

// Smallest cosine between the shading normal and the view direction. Interpolated normals below it are bent towards the
// viewer, which sees the surface's front.
#define OLX_LEAST_VIEW_COSINE 1e-3f

// trace. A ray remembers tried probes by their numbers modulo the first constant, one bit each. That is exact in fields
// with no more probes; in larger fields a probe may count as tried because another one was. The constant is a prime, so
// that it does not align with the strides of grids.
#define OLX_REMEMBERED 127u
// The most probes that are asked beyond those near a place: through which a ray is traced after its selector's, and of
// which a point of a surface takes light where none nearby stores it. More of them lower no error of a picture
// (docs/studies/vulkan.md).
#define OLX_MOST_FAR 2u
// How many footprints before the place where one probe lost a ray the next one takes over. The place is known only to
// within a texel, and the ray must not slip through the surface that it was about to hit.
#define OLX_HAND_OVER_FOOTPRINTS 0.5f
// An unresolved ray that vanished behind a surface by at most this many footprints is taken to end there.
#define OLX_VANISHED_FOOTPRINTS 1.5f
// The cost of a first probe's squared distance from the ray's line, relative to its squared distance from the origin.
#define OLX_OFF_LINE 4.0f

// further: lobes that reflect less than this towards the eye, and lobes of rougher surfaces, receive the mean light of
// all directions.
#define OLX_LEAST_REFLECTANCE 0.15f
#define OLX_MOST_ROUGHNESS 0.5f
#define OLX_START_FOOTPRINTS 0.1f // how far from the surface the ray starts
#define OLX_SALT_FURTHER 0x46555254u

// irradiance. The least variance, as a share of r^2: moments are half floats with relative errors up to 2^-11, so
// smaller variances are rounding.
#define OLX_VARIANCE_FLOOR 1e-3f
// Weights below this are multiplied by the square of their ratio to it (after Majercik et al. 2019).
#define OLX_CRUSH_BELOW 0.2f
// How far from the surface visibility is tested, as an angle seen from the probe: a texel of a map of this size, which
// is two thirds of the standard deviation of the filter on distances (src/bake/irradiance/quadrature.h), or a texel of
// the moments' own map where that is coarser.
#define OLX_BIAS_MAP_SIZE 32.0f
// When the weights of a cage sum to less than this, a more distant probe supplies the rest.
#define OLX_TRUSTED_WEIGHT 0.01f

// volume_irradiance: the structure of the irradiance volume (docs/format.md, "Irradiance volume").
#define OLX_VOLUME_HEADER_WORDS 16u  // of olx_volume_header
#define OLX_VOLUME_SPLIT_WORDS 8u    // of olx_volume_split
#define OLX_VOLUME_CELL_WORDS 8u     // of olx_volume_cell
#define OLX_VOLUME_BLOCK_ENTRIES 64u // 4 x 4 x 4 parts of a cube, or of such a part
#define OLX_VOLUME_HALVES 28u        // half floats of a probe, two a word
#define OLX_VOLUME_LEVEL_SHIFT 27
// What an entry refers to, in its two highest bits. An entry of 0 is empty: no free space was found there.
#define OLX_VOLUME_KIND 0xC0000000u
#define OLX_VOLUME_CELL 0x40000000u   // a cell; bits 27 to 29: how often its cube was halved
#define OLX_VOLUME_BLOCK 0x80000000u  // entries for the parts
#define OLX_VOLUME_SPLIT 0xC0000000u  // a plane with an entry for either side
#define OLX_VOLUME_NUMBER 0x07FFFFFFu // of the cell, block or split
// How far in front of its surface a place is looked up, in sides of a cube: 1 / 4096 of the smallest cell.
#define OLX_VOLUME_LIFT (1.0f / 65536.0f)

// surface_irradiance
#define OLX_MOST_RANKED 128u
#define OLX_MOST_BLENDED 4u
// The relative error of a half float.
#define OLX_DISTANCE_ERROR (1.0f / 2048.0f)
// How far a texel's surface may miss the point beyond the errors of packing, in footprints.
#define OLX_SURFACE_MISS 0.05f
// Where no texel sees the point's surface: how far more a texel's surface may miss the point, in footprints.
#define OLX_NEAR_SURFACE 0.5f
// How far away along the surface a texel may be, in footprints divided by the cosine at which its probe sees it.
#define OLX_SURFACE_REACH 2.0f
#define OLX_LEAST_FACING 0.02f // surfaces that face a probe with a smaller cosine are too grazing for its texels
// Normals agree fully above the second of these cosines, and not at all below the first.
#define OLX_LEAST_AGREEMENT 0.7f
#define OLX_FULL_AGREEMENT 0.8f
#define OLX_BLEND_ABOVE 0.8f        // a probe contributes where its weight exceeds this share of the best probe's
#define OLX_LEAST_TEXEL_SHARE 1e-5f // a smaller share of texels is rounding
#define OLX_MOST_CHANGE 4.0f        // the greatest factor by which a normal map brightens a surface

// denoise. Two pixels show the same surface when the second lies off the first one's plane by less than this many pixel
// widths plus this share of their distance, since normal maps tilt planes.
#define OLX_PLANE_PIXELS 2.0f
#define OLX_PLANE_SLOPE 0.1f
#define OLX_SAME_NORMAL 0.9f     // the least cosine between two pixels' normals for history to be reused between them
#define OLX_STILL_PIXELS 1e-2f   // a point that reprojects this close to a pixel's centre counts as not moved
#define OLX_ROUGHNESS_RANGE 0.1f // glossy light is not shared between surfaces whose roughness differs by more
#define OLX_LEAST_WEIGHT 1e-6f   // a pixel whose weights sum to less has no value
#define OLX_BORROWED_COUNT 0.25f // of frames, for a pixel that has another's sample in place of its own
#define OLX_OWN_COUNT 0.5f       // less is borrowed, and the first sample of a pixel's own replaces it
#define OLX_LEAST_SHARE 0.01f    // history is not read when less of the four pixels around a point is valid

// lights: a light without area as a field stores it.
#define OLX_FIELD_LIGHT_WORDS 16u // of olx_field_light

// relight: the structure of chunk RLIT (docs/format.md, "Relighting").
#define OLX_RELIGHT_POINTS 8u           // of a surfel, at which its direct light is sampled
#define OLX_RELIGHT_SURFEL_WORDS 27u    // of olx_relight_surfel
#define OLX_RELIGHT_BLOCK 4u            // texels along a side of a block of sites
#define OLX_RELIGHT_NO_SITE 0xFFFFFFFFu // of a block that sees the sky alone
// How far rays start from a texel's surface, as a share of its distance: that distance is a half float with an error of
// up to half a unit in the last place.
#define OLX_OFF_SURFACE (1.0f / 1024.0f)
// The share of its length by which a ray to a light ends early, so that it does not hit the lamp itself.
#define OLX_END_SHARE 1e-3f
// Surfels represent surfaces of some size, and their rays some solid angle, so their lobes are widened by this alpha.
#define OLX_LINK_ALPHA 0.2f
// The greatest brightness of a lobe relative to a white matte surface: beyond that, single links would be too bright
// for the solid angle that they represent.
#define OLX_MOST_BRIGHT 2.0f
#define OLX_LIT_SIDE 4u     // texels along a side of a block whose samples of lights are stratified together
#define OLX_LAMP_SAMPLES 2u // rays from a surfel's point to surfaces near lamps
#define OLX_SALT_LIGHT 0x524C4954u
#define OLX_SALT_LAMP 0x524C4C50u
#define OLX_SALT_SURFEL 0x53464C52u
#define OLX_SALT_TEXEL 0x5445584Cu

// The random numbers of a pixel's rays: the seeds of the lobes' rays branch off the pixel's by these numbers.
#define OLX_SALT_BRANCH 0x85EBCA6Bu
#define OLX_DIFFUSE_BRANCH 2u
#define OLX_GLOSSY_BRANCH 3u

// frames of src/render, and passes: the lower bound of the factor from incident to reflected glossy light, so that
// dividing by it is safe.
#define OLX_LEAST_FRESNEL 0.01f

// A regular grid of probes.
OLX_GPU_STRUCT(olx_gpu_grid) {
  olx_gpu_vec4 origin;  // xyz
  olx_gpu_vec4 spacing; // xyz
  olx_gpu_uvec4 count;  // xyz; w: all of them
};

// A field. Maps of several probes may share a layer of an image: `maps_a_side` along each side.
OLX_GPU_STRUCT(olx_field_constants) {
  olx_gpu_grid grid; // count 0 without one
  olx_gpu_grid irradiance_grid;
  olx_gpu_vec4 scene_min, scene_max; // xyz
  olx_gpu_uint probe_count;
  olx_gpu_uint n;           // texels along a side of a light field map, without border
  olx_gpu_uint least_nodes; // in a probe's pyramid of smallest distances
  olx_gpu_uint maps_a_side; // of light field maps in a layer
  olx_gpu_uint irradiance_n;
  olx_gpu_uint irradiance_maps_a_side;
  olx_gpu_float irradiance_texel; // 1 / texels along a side of a layer
  olx_gpu_float distance_scale;
  olx_gpu_uint select_mask; // bit (1 << olx_select) for each selector that is baked in and runs on the GPU
  olx_gpu_uint pyramid_levels;
  olx_gpu_uint bricks_first, voronoi_first; // where they begin, in words; pyramids begin at word 0, two halves a word
  olx_gpu_uint emission_first, tiles_first; // emission, in words: tile_side^2 numbers of tiles a probe; the tiles
  olx_gpu_uint tile_side, tile_count;
  olx_gpu_uint lights_first, light_count; // without area; none where there are more than OLX_MOST_HIGHLIGHTS
  olx_gpu_float last_bounce;              // the share of indirect light that has all bounces behind it
  olx_gpu_uint volume_first;              // the irradiance volume, in words; 0: the field has none
  olx_gpu_uvec4 pyramid_first;            // where its levels begin, the finest first
  olx_gpu_float map_scale;                // 1 / texels along a side of a light field map with its border
  olx_gpu_uint tiled;        // 1: surfaces are tiles, whose blocks lie in images of pools; 0: maps of texels
  olx_gpu_uint compressed;   // 1: materials are packed as in blocks, whatever format their images have
  olx_gpu_uint planes_first; // of geometry blocks, in words
  olx_gpu_uint plane_count;
  olx_gpu_float geometry_scale; // stride of maps of geometry blocks over that of other maps; 0: no blocks
  olx_gpu_uint unused_1, unused_2;
  olx_gpu_uvec4 tile_words;  // where the tiles of base, specular, direct and indirect light begin, in words
  olx_gpu_uvec4 tile_blocks; // the number of blocks in the pool of each
};

OLX_GPU_STRUCT(olx_gpu_probe) {
  olx_gpu_float x, y, z;
  olx_gpu_uint flags; // OLX_PROBE_*
};

// A light, as olx_light (octalux/light.h) has it; the direction of a sun or spot is stored in edge_u.
OLX_GPU_STRUCT(olx_gpu_light) {
  olx_gpu_vec4 emission;                 // xyz; w: the radius within which surfaces are near the lamp
  olx_gpu_vec4 position, edge_u, edge_v; // xyz
  olx_gpu_uint type, both_sides;
  olx_gpu_float cosine_inner, cosine_outer;
};

// A point of a surface near a lamp (src/field/near_lamps.h). In w: the sum of the probabilities of the points before,
// the square of the least distance, and the point's probability.
OLX_GPU_STRUCT(olx_gpu_lamp_point) { olx_gpu_vec4 position, normal, intensity; };

// A relighter: the offsets of its parts, in words. A vector takes three words.
OLX_GPU_STRUCT(olx_gpu_relight) {
  olx_gpu_uint surfels, volume_probes;
  olx_gpu_uint light_samples;
  olx_gpu_uint light_count, lamp_point_count;
  olx_gpu_uint tile_side, tile_words; // texels along a side of a tile, and its words with its border
  // Parts of the state, as offsets from the end of this struct.
  olx_gpu_uint lights, tiles;                // lights, and scheduled tiles
  olx_gpu_uint direct, irradiance, values;   // vectors of surfels; until an update ends, values are sums over rays
  olx_gpu_uint beams, beam_sums, highlights; // vectors of surfels; beam_sums are sums over rays
  olx_gpu_uint close, near;                  // vectors of surfels
  olx_gpu_uint lamp_points;
  olx_gpu_uint sums;                       // change and light of each workgroup that follows links
  olx_gpu_uint tile_light;                 // vectors of scheduled tiles: sums over rays
  olx_gpu_uint tile_direct, tile_indirect; // tile_words for each of them
  // Parts of the data for relighting, in which surfels or blocks begin at word 0.
  olx_gpu_uint link_starts, links;
  olx_gpu_uint entry_starts, entries, volume_starts, volume_links;
  olx_gpu_uint volume_light; // offset in the field's words
};

// Push constants of a relighter's passes.
OLX_GPU_STRUCT(olx_gpu_relight_call) {
  olx_gpu_uint first, count;              // surfels or volume probes; threads that have something to do
  olx_gpu_uint round, before;             // the first `before` of the surfels have `round` samples, the others one more
  olx_gpu_uint light, light_sample, rays; // of every place: the first light and sample, and the rays from there on
  olx_gpu_uint flags;                     // OLX_CALL_*
};

// Push constants of the recorded passes.
OLX_GPU_STRUCT(olx_frame_constants) {
  olx_gpu_vec4 clip_to_world[4]; // columns
  olx_gpu_vec4 eye;              // xyz; w: the depth of pixels that show no surface
  olx_gpu_uint width, height;
  olx_gpu_uint flags; // OLX_FRAME_*
  olx_gpu_uint max_probes;
  olx_gpu_uint glossy_samples; // rays a pixel on glossy surfaces
  olx_gpu_uint sample_index;   // of the frame: another draw of random numbers
  olx_gpu_float dim_lobe;      // rough lobes that reflect less are not traced
  olx_gpu_uint seed;
  olx_gpu_uint diffuse_samples;    // rays a pixel on diffuse surfaces, when they are traced
  olx_gpu_float surface_tolerance; // footprints
  olx_gpu_uint padding[2];
};

// A camera; its viewing axis is perpendicular to `right` and `up`. Projections may be shifted (by a jitter): pixel (x,
// y) is seen where an unshifted picture has (x + eye.w, y + right.w).
OLX_GPU_STRUCT(olx_gpu_camera) {
  olx_gpu_vec4 eye;
  olx_gpu_vec4 right, up; // from the middle of the image plane at distance 1 to its edges
};

// Push constants of the denoiser's mean over frames.
OLX_GPU_STRUCT(olx_accumulate_constants) {
  olx_gpu_camera now, before;
  // The depth along the viewing axis is now.up.w / (depth image - before.up.w).
  olx_gpu_uint size;         // width, and in the upper half height
  olx_gpu_uint flags;        // OLX_DENOISE_*
  olx_gpu_float empty_depth; // of pixels that show no surface
  olx_gpu_float diffuse_history, diffuse_still_history;
  olx_gpu_float glossy_history, glossy_still_history;
  olx_gpu_uint padding;
};

// Push constants of the denoiser's filter over pixels.
OLX_GPU_STRUCT(olx_filter_constants) {
  olx_gpu_camera camera;
  olx_gpu_uint size, flags; // as in olx_accumulate_constants
  olx_gpu_uint radius_pixels, stride_pixels;
  olx_gpu_float reach;
  olx_gpu_float dim_lobe;
  olx_gpu_uint padding[2];
};

#endif
