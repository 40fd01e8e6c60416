// Finds which texels of a block see the same surface.
#include "bake/capture/texel_blocks.h"

#include "core/octahedral.h"

// How far a texel may lie from the plane of another with which it shares light, in footprints, and how far their
// normals may differ.
static const float SHARED_FOOTPRINTS = 0.5f, SHARED_COSINE = 0.98f;

static olx_surface surface_of(const olx_capture *c, uint32_t texel) {
  const olx_ray_hit *hit = &c->hits[texel];
  olx_surface surface =
      olx_surface_at(c->context->scene, hit, olx_texel_direction(texel % c->size, texel / c->size, c->size));
  surface.shading_normal = olx_surface_vertex_normal(c->context->scene, hit, &surface);
  return surface;
}

void olx_block_look(const olx_capture *c, uint32_t block, olx_block_surfaces *s) {
  s->seen = 0;
  for (uint32_t i = 0; i < OLX_BLOCK_TEXELS; i++) {
    const uint32_t texel = olx_block_texel(c, block, i);
    if (c->hits[texel].triangle == OLX_NO_HIT) continue;
    s->surface[i] = surface_of(c, texel);
    s->seen |= 1u << i;
  }
}

static float footprint(const olx_capture *c, uint32_t texel) { return 2.0f * c->hits[texel].t / (float)c->size; }

bool olx_block_is_flat(const olx_capture *c, uint32_t block, const olx_block_surfaces *s) {
  if (s->seen != (1u << OLX_BLOCK_TEXELS) - 1u) return false;
  const olx_surface *first = &s->surface[0];
  const float tolerance = OLX_FLAT_FOOTPRINTS * footprint(c, olx_block_texel(c, block, 0));
  for (uint32_t i = 1; i < OLX_BLOCK_TEXELS; i++) {
    const olx_vec3 step = olx_sub(s->surface[i].position, first->position);
    if (fabsf(olx_dot(step, first->geometric_normal)) > tolerance) return false;
    if (olx_dot(s->surface[i].shading_normal, first->shading_normal) < OLX_FLAT_COSINE) return false;
    if (olx_dot(s->surface[i].geometric_normal, first->geometric_normal) < OLX_FLAT_COSINE) return false;
  }
  return true;
}

bool olx_texel_shares(const olx_capture *c, uint32_t texel, const olx_surface *point, const olx_surface *other) {
  const olx_vec3 way = olx_sub(other->position, point->position);
  return olx_dot(other->geometric_normal, point->geometric_normal) >= SHARED_COSINE &&
         olx_dot(other->shading_normal, point->shading_normal) >= SHARED_COSINE &&
         fabsf(olx_dot(way, point->geometric_normal)) <= SHARED_FOOTPRINTS * footprint(c, texel);
}
