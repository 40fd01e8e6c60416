// Evaluates the surface that a ray hits: position, normals, textures and emission, and origins of further rays that do
// not hit the same surface again.
#include "scene/surface.h"

#include "core/sampling.h"
#include "scene/texture.h"

#include <string.h>

// Smallest cosine between shading and geometric normal.
#define OLX_MIN_NORMAL_COSINE 0.01f

typedef struct olx_corners {
  olx_vec3 p0, p1, p2;
  uint32_t i0, i1, i2;
} olx_corners;

static olx_corners corners_of(const olx_scene *scene, uint32_t triangle) {
  const uint32_t *i = scene->indices + 3 * (size_t)triangle;
  return (olx_corners){scene->positions[i[0]], scene->positions[i[1]], scene->positions[i[2]], i[0], i[1], i[2]};
}

static olx_vec3 interpolate(olx_vec3 a, olx_vec3 b, olx_vec3 c, float u, float v) {
  return olx_add(olx_add(olx_scale(a, 1.0f - u - v), olx_scale(b, u)), olx_scale(c, v));
}

static olx_vec2 interpolate_uv(const olx_vec2 *uvs, const olx_corners *corners, float u, float v) {
  const olx_vec2 a = uvs[corners->i0], b = uvs[corners->i1], c = uvs[corners->i2];
  const float w = 1.0f - u - v;
  return (olx_vec2){a.x * w + b.x * u + c.x * v, a.y * w + b.y * u + c.y * v};
}

// Texture coordinates at a hit: the set that most textures use, and the second set, which the others use.
typedef struct olx_place_uvs {
  olx_vec2 first, second;
} olx_place_uvs;

static inline olx_place_uvs uvs_at(const olx_scene *scene, const olx_material *material, const olx_corners *corners,
                                   float u, float v) {
  const uint32_t textures = material->base_color_texture & material->alpha_texture & material->emission_texture &
                            material->metallic_roughness_texture & material->normal_texture;
  olx_place_uvs uvs = {{0.0f, 0.0f}, {0.0f, 0.0f}};
  if (textures == OLX_NO_TEXTURE) return uvs; // the material has no textures
  uvs.first = interpolate_uv(scene->uvs, corners, u, v);
  if (material->second_uvs) uvs.second = interpolate_uv(scene->second_uvs, corners, u, v);
  return uvs;
}

static olx_vec2 uv_for(const olx_material *material, olx_texture_slot slot, olx_place_uvs uvs) {
  return material->second_uvs & slot ? uvs.second : uvs.first;
}

static olx_texel look_up(const olx_scene *scene, const olx_material *material, uint32_t texture, olx_texture_slot slot,
                         olx_place_uvs uvs) {
  return olx_texture_sample(&scene->textures[texture], uv_for(material, slot, uvs));
}

// Interpolates an attribute of the vertices at a hit.
static olx_vec4 interpolate_four(const olx_vec4 *numbers, const olx_corners *corners, float u, float v) {
  const olx_vec4 a = numbers[corners->i0], b = numbers[corners->i1], c = numbers[corners->i2];
  const float w = 1.0f - u - v;
  return (olx_vec4){a.x * w + b.x * u + c.x * v, a.y * w + b.y * u + c.y * v, a.z * w + b.z * u + c.z * v,
                    a.w * w + b.w * u + c.w * v};
}

// Returns the interpolated vertex colour, which multiplies the base colour.
static olx_vec3 tint_at(const olx_scene *scene, const olx_material *material, const olx_corners *corners, float u,
                        float v) {
  if (!material->vertex_colors) return olx_splat(1.0f);
  const olx_vec4 c = interpolate_four(scene->colors, corners, u, v);
  return olx_v3(c.x, c.y, c.z);
}

static float largest_coordinate(olx_vec3 p) { return olx_max3(olx_v3(fabsf(p.x), fabsf(p.y), fabsf(p.z))); }

// Returns the error bound of what has coordinates up to `largest`.
static float epsilon_of(const olx_scene *scene, float largest) {
  const float of_scene = olx_max(largest_coordinate(scene->bounds_min), largest_coordinate(scene->bounds_max));
  // 2^-18 is about sixty rounding errors. A small triangle near the origin may have large neighbours, whose planes are
  // only as precise as their own coordinates: hence the share of the scene's.
  return 0x1p-18f * olx_max(largest, of_scene * 0x1p-4f);
}

float olx_surface_epsilon(const olx_scene *scene, uint32_t triangle) {
  const olx_corners c = corners_of(scene, triangle);
  const float of_two = olx_max(largest_coordinate(c.p1), largest_coordinate(c.p2));
  return epsilon_of(scene, olx_max(largest_coordinate(c.p0), of_two));
}

float olx_place_epsilon(const olx_scene *scene, olx_vec3 place) { return epsilon_of(scene, largest_coordinate(place)); }

static bool has_texture(uint32_t texture) { return texture != OLX_NO_TEXTURE; }

static float alpha_at(const olx_scene *scene, const olx_material *material, const olx_corners *corners, float u,
                      float v) {
  const olx_place_uvs uvs = uvs_at(scene, material, corners, u, v);
  float alpha = material->alpha;
  if (has_texture(material->base_color_texture)) {
    const olx_texture *texture = &scene->textures[material->base_color_texture];
    alpha *= olx_texture_alpha(texture, uv_for(material, OLX_SLOT_BASE_COLOR, uvs));
  }
  if (has_texture(material->alpha_texture)) {
    alpha *= look_up(scene, material, material->alpha_texture, OLX_SLOT_ALPHA, uvs).color.x;
  }
  if (scene->colors) alpha *= interpolate_four(scene->colors, corners, u, v).w;
  return alpha;
}

bool olx_surface_present(const olx_scene *scene, uint32_t triangle, float u, float v) {
  const olx_material *material = &scene->materials[scene->material_index[triangle]];
  if (material->alpha_cutoff <= 0.0f) return true;
  const olx_corners corners = corners_of(scene, triangle);
  return alpha_at(scene, material, &corners, u, v) >= material->alpha_cutoff;
}

static uint32_t bits_of(float x) {
  uint32_t bits;
  memcpy(&bits, &x, sizeof bits);
  return bits;
}

// Returns a number from 0 to 1 for one of 2^16 by 2^16 parts of a triangle. It depends on the triangle's place, not on
// its index, so that it stays when other triangles are added.
static float random_at(const olx_corners *c, float u, float v) {
  const uint32_t column = (uint32_t)(u * 0x1p16f), row = (uint32_t)(v * 0x1p16f);
  const uint32_t place = olx_hash3(bits_of(c->p0.x), bits_of(c->p1.y), bits_of(c->p2.z));
  return olx_unit_float(olx_hash3(place, column, row));
}

bool olx_surface_stops_light(const olx_scene *scene, uint32_t triangle, float u, float v) {
  const olx_material *material = &scene->materials[scene->material_index[triangle]];
  if (!material->blended) return olx_surface_present(scene, triangle, u, v);
  const olx_corners corners = corners_of(scene, triangle);
  return random_at(&corners, u, v) < alpha_at(scene, material, &corners, u, v);
}

float olx_surface_opacity(const olx_scene *scene, uint32_t triangle, float u, float v) {
  const olx_material *material = &scene->materials[scene->material_index[triangle]];
  if (!material->blended) return olx_surface_present(scene, triangle, u, v) ? 1.0f : 0.0f;
  const olx_corners corners = corners_of(scene, triangle);
  return olx_clamp(alpha_at(scene, material, &corners, u, v), 0.0f, 1.0f);
}

static olx_vec3 emission_at_uvs(const olx_scene *scene, const olx_material *material, olx_place_uvs uvs) {
  if (!has_texture(material->emission_texture)) return material->emission;
  return olx_mul(material->emission,
                 look_up(scene, material, material->emission_texture, OLX_SLOT_EMISSION, uvs).color);
}

olx_vec3 olx_surface_emission(const olx_scene *scene, uint32_t triangle, float u, float v) {
  const olx_material *material = &scene->materials[scene->material_index[triangle]];
  const olx_corners corners = corners_of(scene, triangle);
  return emission_at_uvs(scene, material, uvs_at(scene, material, &corners, u, v));
}

// Returns the normal that a normal or height map holds, in the tangent frame: x along increasing u, y along decreasing
// v.
static olx_vec3 mapped_normal(const olx_material *material, const olx_texture *texture, olx_vec2 uv) {
  if (!material->normal_is_height) {
    const olx_vec3 n = olx_add(olx_scale(olx_texture_sample(texture, uv).color, 2.0f), olx_splat(-1.0f));
    return olx_v3(n.x * material->normal_scale, n.y * material->normal_scale, n.z);
  }
  // Heights are in texels, so that the slope is the difference of neighbours and does not depend on the scene's units.
  const float du = 0.5f / (float)texture->width, dv = 0.5f / (float)texture->height;
  const float along_u = olx_texture_sample(texture, (olx_vec2){uv.x + du, uv.y}).color.x -
                        olx_texture_sample(texture, (olx_vec2){uv.x - du, uv.y}).color.x;
  const float along_v = olx_texture_sample(texture, (olx_vec2){uv.x, uv.y + dv}).color.x -
                        olx_texture_sample(texture, (olx_vec2){uv.x, uv.y - dv}).color.x;
  return olx_v3(-along_u * material->normal_scale, along_v * material->normal_scale, 1.0f);
}

// The directions of a normal map's x and y, perpendicular to a normal.
typedef struct tangent_frame {
  olx_vec3 tangent, bitangent;
} tangent_frame;

// Computes the frame of a normal map from the triangle's texture coordinates; false where they are degenerate.
static bool frame_by_uvs(const olx_scene *scene, const olx_material *material, const olx_corners *c, olx_vec3 normal,
                         tangent_frame *frame) {
  const olx_vec2 *uvs = material->second_uvs & OLX_SLOT_NORMAL ? scene->second_uvs : scene->uvs;
  const olx_vec2 t0 = uvs[c->i0], t1 = uvs[c->i1], t2 = uvs[c->i2];
  const float du1 = t1.x - t0.x, dv1 = t1.y - t0.y, du2 = t2.x - t0.x, dv2 = t2.y - t0.y;
  const float determinant = du1 * dv2 - du2 * dv1;
  if (determinant == 0.0f) return false;
  const float orientation = determinant > 0.0f ? 1.0f : -1.0f;
  const olx_vec3 e1 = olx_sub(c->p1, c->p0), e2 = olx_sub(c->p2, c->p0);
  const olx_vec3 along_u = olx_scale(olx_sub(olx_scale(e1, dv2), olx_scale(e2, dv1)), orientation);
  const olx_vec3 along_v = olx_scale(olx_sub(olx_scale(e2, du1), olx_scale(e1, du2)), orientation);
  frame->tangent = olx_normalize(olx_madd(along_u, normal, -olx_dot(along_u, normal)));
  const olx_vec3 across = olx_cross(normal, frame->tangent);
  frame->bitangent = olx_dot(across, along_v) > 0.0f ? olx_negate(across) : across;
  return true;
}

// Computes the frame of a normal map from the vertices' tangents; false where they have none. Their handedness is for
// normals that are not flipped.
static bool frame_by_tangents(const olx_scene *scene, const olx_corners *c, float u, float v, olx_vec3 normal,
                              tangent_frame *frame) {
  if (!scene->tangents) return false;
  const olx_vec4 t = interpolate_four(scene->tangents, c, u, v);
  const olx_vec3 given = olx_v3(t.x, t.y, t.z), flat = olx_madd(given, normal, -olx_dot(given, normal));
  if (t.w == 0.0f || !(olx_length(flat) > 1e-3f)) return false;
  const bool turned =
      olx_dot(interpolate(scene->normals[c->i0], scene->normals[c->i1], scene->normals[c->i2], u, v), normal) < 0.0f;
  frame->tangent = olx_normalize(flat);
  frame->bitangent = olx_scale(olx_cross(normal, frame->tangent), (t.w < 0.0f) != turned ? -1.0f : 1.0f);
  return true;
}

// Perturbs `normal` by the normal map. Where neither tangents nor texture coordinates give a frame, it is unchanged.
static olx_vec3 bend_normal(const olx_scene *scene, const olx_material *material, const olx_corners *c, float u,
                            float v, olx_place_uvs uvs, olx_vec3 normal) {
  tangent_frame frame;
  if (!frame_by_tangents(scene, c, u, v, normal, &frame) && !frame_by_uvs(scene, material, c, normal, &frame)) {
    return normal;
  }
  const olx_vec3 n =
      mapped_normal(material, &scene->textures[material->normal_texture], uv_for(material, OLX_SLOT_NORMAL, uvs));
  const olx_vec3 bent =
      olx_add(olx_add(olx_scale(frame.tangent, n.x), olx_scale(frame.bitangent, n.y)), olx_scale(normal, n.z));
  const float length = olx_length(bent);
  return length > 0.0f ? olx_scale(bent, 1.0f / length) : normal;
}

// Returns the interpolated vertex normal, on the side of `outward`, the unit normal of the triangle's winding.
static olx_vec3 vertex_normal(const olx_scene *scene, const olx_corners *c, float u, float v, olx_vec3 outward) {
  const olx_vec3 n =
      olx_normalize(interpolate(scene->normals[c->i0], scene->normals[c->i1], scene->normals[c->i2], u, v));
  const float agreement = olx_dot(n, outward);
  if (!(fabsf(agreement) > 0.0f)) return outward;
  return agreement < 0.0f ? olx_negate(n) : n;
}

// Returns a shading normal that is never quite perpendicular to the triangle's normal, and on the side that the ray
// came from.
static olx_vec3 face(olx_vec3 n, olx_vec3 outward, bool back_face) {
  const float cosine = olx_dot(n, outward);
  if (cosine < OLX_MIN_NORMAL_COSINE) n = olx_normalize(olx_madd(n, outward, OLX_MIN_NORMAL_COSINE - cosine));
  return back_face ? olx_negate(n) : n;
}

static olx_vec3 shading_normal(const olx_scene *scene, const olx_material *material, const olx_corners *c, float u,
                               float v, olx_place_uvs uvs, olx_vec3 outward, bool back_face) {
  olx_vec3 n = vertex_normal(scene, c, u, v, outward);
  if (has_texture(material->normal_texture)) n = bend_normal(scene, material, c, u, v, uvs, n);
  return face(n, outward, back_face);
}

olx_vec3 olx_surface_vertex_normal(const olx_scene *scene, const olx_ray_hit *hit, const olx_surface *surface) {
  if (!has_texture(scene->materials[surface->material].normal_texture)) return surface->shading_normal;
  const olx_corners c = corners_of(scene, hit->triangle);
  const olx_vec3 n = surface->geometric_normal, outward = surface->back_face ? olx_negate(n) : n;
  return face(vertex_normal(scene, &c, hit->u, hit->v, outward), outward, surface->back_face);
}

// Returns the base colour at a hit, multiplied by the vertex colour `tint` and clamped.
static inline olx_vec3 base_color_at(const olx_scene *scene, const olx_material *material, olx_place_uvs uvs,
                                     olx_vec3 tint) {
  olx_vec3 base_color = olx_mul(material->base_color, tint);
  if (has_texture(material->base_color_texture)) {
    base_color =
        olx_mul(base_color, look_up(scene, material, material->base_color_texture, OLX_SLOT_BASE_COLOR, uvs).color);
  }
  return olx_min_each(base_color, olx_splat(OLX_MOST_ALBEDO));
}

static void look_up_material(const olx_scene *scene, const olx_material *material, olx_place_uvs uvs, olx_vec3 tint,
                             olx_surface *surface) {
  const olx_vec3 base_color = base_color_at(scene, material, uvs, tint);
  float metallic = material->metallic, roughness = material->roughness, weight = material->specular_weight;
  if (has_texture(material->metallic_roughness_texture)) {
    const olx_texel t =
        look_up(scene, material, material->metallic_roughness_texture, OLX_SLOT_METALLIC_ROUGHNESS, uvs);
    metallic *= t.color.z;
    roughness *= t.color.y;
    if (material->specular_in_alpha) weight *= t.alpha;
  }
  surface->base_color = base_color;
  surface->metallic = metallic;
  surface->roughness = roughness;
  surface->bsdf = olx_bsdf_make(base_color, metallic, roughness, weight);
  surface->emission =
      surface->back_face && !material->emits_both_sides ? olx_splat(0.0f) : emission_at_uvs(scene, material, uvs);
}

// Returns the offset from `position` towards the triangle's centre, no longer than `length`.
static olx_vec3 step_inward(const olx_corners *c, olx_vec3 position, float length) {
  const olx_vec3 middle = interpolate(c->p0, c->p1, c->p2, 1.0f / 3.0f, 1.0f / 3.0f);
  const olx_vec3 way = olx_sub(middle, position);
  const float distance = olx_length(way);
  return distance > length ? olx_scale(way, length / distance) : way;
}

static bool varies_over_triangle(const olx_material *material) {
  return has_texture(material->base_color_texture) || has_texture(material->metallic_roughness_texture) ||
         has_texture(material->emission_texture) || material->vertex_colors;
}

olx_surface olx_surface_near(const olx_scene *scene, const olx_ray_hit *hit, olx_vec3 direction,
                             const olx_surface *previous) {
  const bool again = previous && previous->triangle == hit->triangle;
  const olx_corners c = corners_of(scene, hit->triangle);
  const uint32_t material_index = scene->material_index[hit->triangle];
  const olx_material *material = &scene->materials[material_index];
  const olx_place_uvs uvs = uvs_at(scene, material, &c, hit->u, hit->v);
  olx_vec3 outward;
  if (again) {
    outward = previous->back_face ? olx_negate(previous->geometric_normal) : previous->geometric_normal;
  } else {
    outward = olx_normalize(olx_cross(olx_sub(c.p1, c.p0), olx_sub(c.p2, c.p0)));
  }
  const bool back_face = olx_dot(outward, direction) > 0.0f;
  olx_surface surface = {
      .position = interpolate(c.p0, c.p1, c.p2, hit->u, hit->v),
      .geometric_normal = back_face ? olx_negate(outward) : outward,
      .shading_normal = shading_normal(scene, material, &c, hit->u, hit->v, uvs, outward, back_face),
      .back_face = back_face,
      .epsilon = again ? previous->epsilon : olx_surface_epsilon(scene, hit->triangle),
      .triangle = hit->triangle,
      .material = material_index,
  };
  surface.inward = step_inward(&c, surface.position, surface.epsilon);
  if (again && back_face == previous->back_face && !varies_over_triangle(material)) {
    surface.base_color = previous->base_color;
    surface.metallic = previous->metallic;
    surface.bsdf = previous->bsdf;
    surface.roughness = previous->roughness;
    surface.emission = previous->emission;
  } else {
    look_up_material(scene, material, uvs, tint_at(scene, material, &c, hit->u, hit->v), &surface);
  }
  return surface;
}

static void prefetch_vertices(const olx_scene *scene, uint32_t triangle) {
  for (uint32_t k = 0; k < 3; k++) {
    const uint32_t vertex = scene->indices[3 * (size_t)triangle + k];
    __builtin_prefetch(&scene->positions[vertex]);
    __builtin_prefetch(&scene->normals[vertex]);
    if (scene->uvs) __builtin_prefetch(&scene->uvs[vertex]);
  }
}

static void prefetch_texels(const olx_scene *scene, const olx_ray_hit *hit) {
  const olx_material *material = &scene->materials[scene->material_index[hit->triangle]];
  const olx_corners c = corners_of(scene, hit->triangle);
  const olx_place_uvs uvs = uvs_at(scene, material, &c, hit->u, hit->v);
  const uint32_t textures[] = {material->base_color_texture, material->metallic_roughness_texture,
                               material->normal_texture, material->emission_texture};
  const olx_texture_slot slots[] = {OLX_SLOT_BASE_COLOR, OLX_SLOT_METALLIC_ROUGHNESS, OLX_SLOT_NORMAL,
                                    OLX_SLOT_EMISSION};
  for (uint32_t i = 0; i < 4; i++) {
    if (has_texture(textures[i])) {
      olx_texture_prefetch(&scene->textures[textures[i]], uv_for(material, slots[i], uvs));
    }
  }
}

void olx_surfaces_prefetch(const olx_scene *scene, const olx_ray_hit *hits, uint32_t count) {
  for (uint32_t i = 0; i < count; i++) {
    if (hits[i].triangle == OLX_NO_HIT) continue;
    __builtin_prefetch(&scene->indices[3 * (size_t)hits[i].triangle]);
    __builtin_prefetch(&scene->material_index[hits[i].triangle]);
  }
  for (uint32_t i = 0; i < count; i++) {
    if (hits[i].triangle != OLX_NO_HIT) prefetch_vertices(scene, hits[i].triangle);
  }
  for (uint32_t i = 0; i < count; i++) {
    if (hits[i].triangle != OLX_NO_HIT) prefetch_texels(scene, &hits[i]);
  }
}

olx_surface olx_surface_at(const olx_scene *scene, const olx_ray_hit *hit, olx_vec3 direction) {
  return olx_surface_near(scene, hit, direction, NULL);
}

// Returns the point slightly off the surface, on the side that `direction` points to.
static olx_vec3 offset_origin(const olx_surface *surface, olx_vec3 direction) {
  const float side = olx_dot(direction, surface->geometric_normal) >= 0.0f ? 1.0f : -1.0f;
  return olx_madd(olx_add(surface->position, surface->inward), surface->geometric_normal, side * surface->epsilon);
}

olx_ray olx_surface_ray(const olx_surface *surface, olx_vec3 direction, float t_max) {
  return (olx_ray){offset_origin(surface, direction), direction, 0.0f, t_max};
}

olx_ray olx_surface_ray_to(const olx_surface *surface, olx_vec3 point, float epsilon_end) {
  const olx_vec3 origin = offset_origin(surface, olx_sub(point, surface->position));
  const olx_vec3 way = olx_sub(point, origin);
  const float length = olx_length(way);
  return (olx_ray){origin, olx_normalize(way), 0.0f, olx_max(length - epsilon_end, 0.0f)};
}
