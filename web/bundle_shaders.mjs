// shaders/lib as one text of ESSL 3.00: includes resolved, each file once, without comments and without what C alone
// reads.
import { readFileSync, realpathSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const INCLUDE = /^\s*#include\s+"([^"]+)"/;

// The lines of a file and of those that it includes, none twice.
function lines_of(path, seen) {
  if (seen.has(path)) return [];
  seen.add(path);
  const text = readFileSync(path, 'utf8');
  return text.split('\n').flatMap((line) => {
    const included = line.match(INCLUDE);
    return included ? lines_of(resolve(dirname(path), included[1]), seen) : [line];
  });
}

function without_comments(text) {
  return text.replace(/\/\*[\s\S]*?\*\//g, '').replace(/\/\/[^\n]*/g, '');
}

// The library from `name` in shaders/lib on, to stand in a shader behind its version.
export function bundle(shaders, name = 'octalux.glsl') {
  const text = without_comments(lines_of(resolve(join(shaders, 'lib', name)), new Set()).join('\n'));
  const lines = text.split('\n').map((line) => line.trim());
  return lines.filter((line) => line !== '' && line !== '#include <stdint.h>').join('\n') + '\n';
}

// A fragment shader that calls all of it, to be compiled by a test.
export function whole_shader(shaders) {
  return `#version 300 es
${bundle(shaders)}
in vec3 position, normal, view;
layout(location = 0) out vec3 color;
void main() {
  olx_sample_settings settings = olx_sample_settings_default();
  float weight, half_cosine;
  olx_trace_hit hit;
  color = olx_surface_irradiance(settings, position, normal, normal, view) + olx_volume_irradiance(position, normal);
  color += olx_glossy(settings, position, normal, view, 0.5, olx_stratified2(1u, 2u), weight, half_cosine, hit);
}
`;
}

const [, program, shaders] = process.argv;
if (program && realpathSync(program) === fileURLToPath(import.meta.url)) process.stdout.write(whole_shader(shaders));
