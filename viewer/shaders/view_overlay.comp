// Draws overlays on surfaces: which probes light them, which probes resolve their rays, and at what cost.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "view_pixels.glsl"

layout(local_size_x = OLX_PASS_SIZE, local_size_y = OLX_PASS_SIZE) in;

// Returns the colours of the surrounding irradiance probes, weighted by their interpolation weights. Black where no
// probe sees the point.
vec3 weights(vec3 position, vec3 normal) {
  olx_sample_settings settings = view_settings(false);
  vec3 to_eye = olx_normalize(view.eye.xyz - position);
  olx_surface_point p = olx_surface_point(position, normal, to_eye);
  olx_cage cage = olx_cage_at(olx_field.irradiance_grid, position);
  vec3 color = vec3(0.0);
  float sum = 0.0;
  for (uint corner = 0u; corner < 8u; corner++) {
    if (!olx_cage_has(cage, corner)) continue;
    uint probe = olx_cage_probe(olx_field.irradiance_grid, cage, corner);
    if (!olx_irradiance_usable(settings, probe)) continue;
    vec3 from_probe = position - olx_irradiance_probe_position(probe);
    float weight = olx_cage_weight(cage, corner) * olx_probe_weight(settings.visibility, probe, from_probe, p);
    color += probe_color(probe) * weight;
    sum += weight;
  }
  color /= max(sum, OLX_TRUSTED_WEIGHT);
  uint nearest;
  if (sum < OLX_TRUSTED_WEIGHT && olx_nearest_visible(settings, p, cage, nearest)) {
    color += probe_color(nearest) * (1.0 - sum / OLX_TRUSTED_WEIGHT);
  }
  return color;
}

vec3 paint(pixel_ray ray, vec3 shown) {
  float brightness = dot(shown, vec3(0.2126, 0.7152, 0.0722)), shade = 0.35 + 0.65 * brightness;
  if (view.overlay == VIEW_SHADE_WEIGHTS) {
    vec3 at = ray.origin, normal = ray.normal;
    if (has_flag(VIEW_FLAG_EYE_RAYS)) {
      olx_trace_hit seen = olx_trace(view_settings(true), ray.origin, ray.direction, OLX_INFINITY);
      at = seen.position;
      normal = seen.normal;
      if (seen.status == OLX_TRACE_MISS) return 0.25 * shown;
    }
    return weights(at, normal) * shade;
  }
  olx_trace_hit hit = olx_trace(view_settings(true), ray.origin, ray.direction, OLX_INFINITY);
  bool unknown = hit.status == OLX_TRACE_UNKNOWN;
  if (view.overlay == VIEW_SHADE_STEPS) {
    return heat(log2(1.0 + float(hit.texel_steps)) / log2(1.0 + VIEW_STEPS_LARGEST));
  }
  if (view.overlay == VIEW_SHADE_UNRESOLVED) return unknown ? vec3(1.0, 0.1, 0.8) : vec3(0.15 + 0.6 * brightness);
  return unknown || hit.probe == OLX_NO_PROBE ? vec3(0.0) : probe_color(hit.probe) * shade;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (pixel.x >= int(view.width) || pixel.y >= int(view.height)) return;
  vec3 shown = imageLoad(display_image, pixel).rgb;
  pixel_ray ray;
  vec3 painted = told_ray(pixel, ray) ? paint(ray, shown) : 0.25 * shown;
  imageStore(display_image, pixel, vec4(clamp(painted, vec3(0.0), vec3(1.0)), 1.0));
}
