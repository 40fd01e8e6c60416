// Adds specular reflections of direct light between surfels. Links carry what surfaces reflect equally in all
// directions, but a sunlit floor lights the wall beyond it more than the wall on the sun's side.
#include "core/bsdf.h"
#include "core/pack.h"
#include "relight/relit_surfels.h"

static float share_of(uint8_t byte) { return (float)byte * (1.0f / 255.0f); }

// Returns the brightness of a specular lobe in light from one direction, relative to a white matte surface.
static float brightness(const olx_relight_surfel *s, olx_vec3 view, olx_vec3 light) {
  const olx_vec3 normal = olx_normal_unpack((uint16_t)s->normal);
  const float to_view = olx_dot(view, normal), to_light = olx_dot(light, normal);
  if (to_view <= 0.0f || to_light <= 0.0f) return 0.0f;
  const olx_vec3 half = olx_normalize(olx_add(view, light));
  const float cosine = olx_min(olx_dot(half, normal), 1.0f), a = share_of(s->alpha);
  const float alpha = sqrtf(a * a + OLX_LINK_ALPHA * OLX_LINK_ALPHA), f0 = share_of(s->f0);
  const float fresnel = f0 + (1.0f - f0) * olx_pow5(olx_clamp(1.0f - olx_dot(view, half), 0.0f, 1.0f));
  const float a2 = alpha * alpha, c2 = cosine * cosine, d = 1.0f - c2 + c2 * a2, lobe = a2 / (OLX_PI * d * d);
  const float seen = 1.0f / (1.0f + olx_ggx_lambda(alpha, to_view) + olx_ggx_lambda(alpha, to_light));
  return olx_min(OLX_PI * fresnel * lobe * seen / (4.0f * to_view * to_light), OLX_MOST_BRIGHT);
}

// Returns the luminance of light that a surfel's specular lobe sends to a place, as the irradiance that would make a
// white matte surface in its place as bright.
static float specular_light(const olx_relit_surfels *r, uint32_t surfel, olx_vec3 place) {
  const olx_relight_surfel *s = &r->data->surfels[surfel];
  const float beam = olx_length(r->beams[surfel]), rest = olx_max(olx_luminance(r->direct[surfel]) - beam, 0.0f);
  const float everywhere = share_of(s->specular) * rest;
  if (beam <= 0.0f || s->specular == 0) return everywhere;
  const olx_vec3 away = olx_sub(place, olx_load3(s->points[0]));
  const float length = olx_length(away);
  if (!(length > 0.0f)) return everywhere;
  return everywhere + beam * brightness(s, olx_scale(away, 1.0f / length), olx_scale(r->beams[surfel], 1.0f / beam));
}

olx_vec3 olx_relit_highlights(const olx_relit_surfels *r, uint32_t surfel) {
  const olx_relight_data *d = r->data;
  const olx_vec3 place = olx_load3(d->surfels[surfel].points[0]);
  olx_vec3 sum = {0};
  for (uint32_t i = d->link_starts[surfel]; i < d->link_starts[surfel + 1]; i++) {
    const uint32_t from = olx_relight_link_from(&d->links[i]), straight = d->links[i].from_straight >> 24;
    const float light = olx_luminance(r->direct[from]), diffuse = share_of(d->surfels[from].diffuse);
    if (straight == 0 || light <= 0.0f || diffuse <= 0.0f) continue;
    const float weight = olx_luminance(olx_rgb9e5_unpack(d->links[i].weight)) * share_of((uint8_t)straight) / diffuse;
    sum = olx_madd(sum, r->direct[from], weight * specular_light(r, from, place) / light);
  }
  return sum;
}
