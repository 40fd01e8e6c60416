// The host's scene in its own vertex and index buffers: the Cornell box of builtin:cornell-glossy. A field contains
// light and no geometry, so the host must make sure that it was baked from the same scene.
#ifndef BOX_GEOMETRY_H
#define BOX_GEOMETRY_H

#include <octalux/base.h>

enum { BOX_QUADS = 16, BOX_VERTICES = 4 * BOX_QUADS, BOX_INDICES = 6 * BOX_QUADS };

// A vertex as surface.vert and surface.frag read it, 15 floats.
typedef struct box_vertex {
  olx_vec3 position, normal; // metres
  olx_vec3 base_color;
  olx_vec3 material; // roughness, metallic, specular weight
  olx_vec3 emission; // radiance
} box_vertex;

void box_geometry(box_vertex vertices[BOX_VERTICES], uint32_t indices[BOX_INDICES]);

#endif
