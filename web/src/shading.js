// How a field's light enters the shaders of three.js's standard and physical materials.
//
// SPDX-License-Identifier: MIT
import { LIBRARY } from './library.js';

// Glossy light is added where depths are equal, although another shader drew them, so positions must be invariant.
const VERTEX_DECLARATIONS = 'invariant gl_Position;\nvarying vec3 olx_world_position;\n';

const VERTEX = `
#include <project_vertex>
{
  vec4 olx_place = vec4(transformed, 1.0);
  #ifdef USE_BATCHING
  olx_place = batchingMatrix * olx_place;
  #endif
  #ifdef USE_INSTANCING
  olx_place = instanceMatrix * olx_place;
  #endif
  olx_world_position = (modelMatrix * olx_place).xyz;
}
`;

const FRAGMENT_DECLARATIONS = `
varying vec3 olx_world_position;
uniform vec3 olx_offset;       // of the field in the world
uniform vec2 olx_strength;     // of diffuse and of glossy light
uniform float olx_left;        // pixels left of this column have none
uniform vec4 olx_viewport;     // where the picture begins, and its width and height: pixels
uniform uint olx_sample_index; // of the frame: another draw of them
uniform bool olx_emitters;     // rays find lamps, in place of highlights of lights
uniform int olx_layer;         // what is shown, and computed: 0 the picture, 1 diffuse, 2 glossy indirect light alone,
                               // 3 rays, 4 depth, 5 normals
#ifndef USE_TRANSMISSION // with which three.js declares it
uniform mat4 projectionMatrix;
#endif
// Least cosines of a shading normal: to the triangle's normal, and to the direction of the eye.
const float OLX_LEAST_NORMAL_COSINE = 0.01;
vec3 olx_shown = vec3(0.0);

// The point of a sequence that a pixel draws, as \`octalux render\` draws it.
vec2 olx_pixel_random() {
  vec2 at = gl_FragCoord.xy - olx_viewport.xy;
  uvec2 pixel = uvec2(at.x, olx_viewport.w - at.y);
  return olx_stratified2(olx_sample_index, olx_hash2(olx_hash2(pixel.x, pixel.y), OLX_SALT_BRANCH + OLX_GLOSSY_BRANCH));
}

// The middle of the pixel, from -1 to 1 over the picture.
vec2 olx_pixel_middle() { return (gl_FragCoord.xy - olx_viewport.xy) / olx_viewport.zw * 2.0 - 1.0; }

// Where the ray through the middle of the pixel meets the plane of the triangle. What is interpolated lies on that
// plane, but beside that point: devices first move corners to parts of a pixel, a sixteenth or less.
vec3 olx_pixel_position() {
  vec3 drawn = olx_world_position, x = dFdx(drawn), y = dFdy(drawn), plane = cross(x, y);
  vec2 across = (olx_pixel_middle() + projectionMatrix[2].xy) / vec2(projectionMatrix[0].x, projectionMatrix[1].y);
  vec3 ray = vec3(across, -1.0) * mat3(viewMatrix);
  vec3 moved = cameraPosition + ray * (olx_dot(drawn - cameraPosition, plane) / olx_dot(ray, plane)), by = moved - drawn;
  bool near = olx_dot(by, by) <= olx_dot(x, x) + olx_dot(y, y); // false also where the plane is seen from its side
  return near && !isOrthographic ? moved : drawn;
}

// Returns the change of an interpolated value from the point that was drawn to the middle of the pixel.
vec3 olx_pixel_change(vec3 value) {
  vec4 drawn = projectionMatrix * (viewMatrix * vec4(olx_world_position, 1.0));
  vec2 pixels = (olx_pixel_middle() - drawn.xy / drawn.w) * 0.5 * olx_viewport.zw;
  vec3 change = dFdx(value) * pixels.x + dFdy(value) * pixels.y;
  return all(lessThanEqual(abs(pixels), vec2(1.0))) ? change : vec3(0.0);
}

// Returns a vector turned towards a unit vector \`to\` until their cosine is \`least\` or nearly so.
vec3 olx_turned(vec3 normal, vec3 to, float least) {
  float cosine = olx_dot(normal, to);
  return cosine < least ? olx_normalize(normal + to * (least - cosine)) : normal;
}

// The normals of a surface, all on the side of the triangle that the eye sees, as those of \`octalux render\`.
struct olx_normals {
  vec3 geometric, vertex, shading; // of the triangle, interpolated over it, and bent by a normal map
};

// Takes three.js's normals in the space of the eye. They lie where the triangle's winding says, which those of a model
// may contradict, and at outlines interpolated ones may face away from the triangle's visible side.
olx_normals olx_normals_from(vec3 vertex, vec3 shading, vec3 view) {
  vec3 drawn = vertex;
  #ifndef FLAT_SHADED
  vertex = olx_normalize(vNormal + olx_pixel_change(vNormal));
  if (olx_dot(vertex, drawn) < 0.0) vertex = -vertex;
  #endif
  shading = inverseTransformDirection(shading + vertex - drawn, viewMatrix);
  vertex = inverseTransformDirection(vertex, viewMatrix);
  vec3 across = cross(dFdx(olx_world_position), dFdy(olx_world_position));
  vec3 geometric = olx_normalize(olx_dot(across, view) < 0.0 ? -across : across);
  if (olx_dot(vertex, geometric) < 0.0) {
    shading -= vertex * (2.0 * olx_dot(shading, vertex));
    vertex = -vertex;
  }
  return olx_normals(geometric, olx_turned(vertex, geometric, OLX_LEAST_NORMAL_COSINE),
                     olx_turned(shading, geometric, OLX_LEAST_NORMAL_COSINE));
}
`;

const FRAGMENT = `
#include <lights_fragment_end>
{
  vec3 olx_place = olx_pixel_position(), olx_position = olx_place - olx_offset, olx_view = normalize(cameraPosition - olx_place);
  if (isOrthographic) olx_view = vec3(viewMatrix[0][2], viewMatrix[1][2], viewMatrix[2][2]);
  olx_normals olx_sides = olx_normals_from(nonPerturbedNormal, normal, olx_view);
  vec3 olx_normal = olx_turned(olx_sides.shading, olx_view, OLX_LEAST_VIEW_COSINE); // towards the eye
  float olx_specular = 1.0;
  #ifdef USE_SPECULAR
  olx_specular = specularIntensityFactor;
  #endif
  olx_bsdf olx_lobes = olx_bsdf_make(diffuseColor.rgb, metalnessFactor, roughnessFactor, olx_specular);
  olx_sample_settings olx_settings = olx_sample_settings_default();
  olx_settings.emitters = olx_emitters;
  vec3 olx_diffuse = vec3(0.0), olx_glossy_light = vec3(0.0), olx_rays = vec3(0.0); // traced, unresolved
  #ifdef OLX_DIFFUSE
  olx_diffuse = olx_bsdf_diffuse(olx_lobes, olx_dot(olx_normal, olx_view)) * (1.0 / OLX_PI);
  #ifdef OLX_MOVING
  olx_diffuse *= olx_volume_irradiance(olx_position, olx_normal);
  #else
  if (olx_layer < 2) {
    olx_diffuse *= olx_surface_light_at(olx_settings, olx_position, olx_sides.geometric, olx_sides.vertex, olx_sides.shading,
                                        olx_view).irradiance;
  }
  #endif
  #endif
  #ifdef OLX_GLOSSY
  if (olx_layer != 1 && olx_layer < 4 && olx_bsdf_has_specular(olx_lobes)) {
    vec3 olx_direction;
    vec2 olx_random = olx_pixel_random();
    float olx_weight, olx_half_cosine;
    bool olx_leaves = olx_glossy_draw(olx_normal, olx_view, roughnessFactor, olx_random, olx_direction, olx_weight, olx_half_cosine);
    // A reflection about a shading normal may lead into the surface, where there is no light.
    if (olx_leaves && olx_dot(olx_direction, olx_sides.geometric) > 0.0) {
      olx_trace_hit olx_hit;
      olx_glossy_light = olx_glossy(olx_settings, olx_position, olx_normal, olx_view, roughnessFactor, olx_random, olx_weight,
                                    olx_half_cosine, olx_hit);
      olx_glossy_light *= olx_fresnel(olx_lobes, olx_half_cosine) * olx_weight;
      olx_rays = vec3(1.0, olx_hit.status == OLX_TRACE_UNKNOWN, 0.0);
    }
  }
  #endif
  bool olx_lit = gl_FragCoord.x >= olx_left;
  if (olx_lit) {
    reflectedLight.indirectDiffuse += olx_diffuse * olx_strength.x;
    reflectedLight.indirectSpecular += olx_glossy_light * olx_strength.y;
  }
  if (olx_lit && olx_emitters) reflectedLight.directSpecular *= 1.0 - olx_strength.y;
  olx_shown = olx_layer == 1 ? olx_diffuse : olx_layer == 3 ? olx_rays : olx_glossy_light;
  #ifdef OLX_DIFFUSE
  if (olx_layer == 4) olx_shown = vec3(-(viewMatrix * vec4(olx_place, 1.0)).z);
  if (olx_layer == 5) olx_shown = olx_sides.shading;
  #else
  if (olx_layer == 0) olx_shown = olx_lit ? olx_glossy_light * olx_strength.y : vec3(0.0);
  #endif
}
`;

const SHOWN = `
#include <opaque_fragment>
#ifdef OLX_DIFFUSE
if (olx_layer != 0)
#endif
gl_FragColor = vec4(olx_shown, 1.0);
`;

function replaceOnce(text, chunk, replacement) {
  const parts = text.split(chunk);
  if (parts.length !== 2) throw new Error(`octalux: three.js's shader has no single ${chunk}`);
  return parts.join(replacement);
}

// Adds the uniforms of the field that lights the material when it is drawn. three.js keeps a shader's uniforms for as
// long as it keeps the shader, so each looks up the field.
function addUniforms(uniforms, lighting) {
  for (const name of Object.keys(lighting.field.uniforms)) {
    Object.defineProperty(uniforms, name, { get: () => lighting.field.uniforms[name], enumerable: true });
  }
}

/** Changes the shader of a standard or physical material, which onBeforeCompile receives; lit by `lighting.field`. */
export function patchShader(shader, lighting, { defines, moving, part }) {
  addUniforms(shader.uniforms, lighting);
  const define = (name, wanted) => (wanted ? `#define ${name}\n` : '');
  const chosen = defines + define('OLX_MOVING', moving) + define('OLX_DIFFUSE', part !== 'glossy') + define('OLX_GLOSSY', part !== 'diffuse');
  shader.vertexShader = replaceOnce(VERTEX_DECLARATIONS + shader.vertexShader, '#include <project_vertex>', VERTEX);
  let fragment = shader.fragmentShader;
  fragment = replaceOnce(fragment, '#include <clipping_planes_pars_fragment>',
                         `#include <clipping_planes_pars_fragment>\n${chosen}${LIBRARY}${FRAGMENT_DECLARATIONS}`);
  fragment = replaceOnce(fragment, '#include <lights_fragment_end>', FRAGMENT);
  shader.fragmentShader = replaceOnce(fragment, '#include <opaque_fragment>', SHOWN);
}
