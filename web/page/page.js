// The page that `octalux export web` writes: a room, its field, and controls for both.
import {
  ACESFilmicToneMapping, Box3, Color, DataTexture, InstancedMesh, LinearFilter, LinearMipmapLinearFilter, Matrix4, Mesh,
  MeshBasicMaterial, MeshStandardMaterial, PerspectiveCamera, Raycaster, Scene, SphereGeometry, Vector3, WebGLRenderer, PCFShadowMap,
} from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { OctaluxField } from 'octalux';
import { download } from './download.js';
import { addLamps } from './lamps.js';
import { Picture } from './picture.js';
import { Walk } from './walk.js';

const MOST_PIXEL_RATIO = 2, FIRST_PIXELS = 5000, LEAST_SCALE = 0.3, LEAST_SHARE = 1 / 32, KEY = 0.2;
const SLOWEST_FRAME = 1 / 20, TOO_SLOW = 0.25, STILL_SECONDS = 0.25;
const PATIENCE_MS = 200; // within this time glossy light comes before larger pictures, which slow devices draw for long
const LAYERS = ['picture', 'diffuse', 'glossy', 'rays', 'depth', 'normal']; // olx_layer of shading.js

const AXES = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]].map((axis) => new Vector3(...axis));

const byId = (id) => document.getElementById(id);
const seconds = () => performance.now() / 1000;

// State that the page shows to tests, and to users of the console.
const state = { stage: 'loading', diffuseSeconds: null, glossySeconds: null, frames: 0 };
window.octalux = {
  state, readLayer, get camera() { return camera; }, get field() { return field; }, get ball() { return ball; },
};

const renderer = makeRenderer();
renderer.toneMapping = ACESFilmicToneMapping;
renderer.shadowMap.enabled = true;
renderer.shadowMap.type = PCFShadowMap;
renderer.shadowMap.autoUpdate = false; // shadows change with the ball alone
// The scenes of `scenes` are drawn one after the other.
const depth = new Scene(), scene = new Scene(), shine = new Scene(), scenes = [depth, scene];
const picture = new Picture(renderer), shadowed = new Vector3(NaN); // position of the ball when shadows were last drawn
let room, field, camera, ball, walk, probes, carried = null, scale = LEAST_SCALE, share = LEAST_SHARE, lastChange = 0, lastFrame = 0;
let answered = 0; // the last change that a small picture has shown
let glossyMoves = true; // whether reflections are drawn while things move
let isDrawn = () => true, begun = 0; // whether the device has drawn the last frame, and its start
let drawing = false; // whether frames are drawn
let restored = 0; // how often a lost context was restored

function changed() {
  lastChange = seconds();
  picture.restart();
}

// ---- Loading

function showProgress(stage, share) {
  byId('stage').textContent = stage;
  if (share === null) byId('progress').removeAttribute('value');
  else byId('progress').value = share;
}

function fail(error) {
  state.stage = 'failed';
  byId('loading').className = '';
  byId('loading').hidden = false;
  byId('progress').hidden = true;
  byId('stage').textContent = `This room cannot be shown: ${error.message}`;
  throw error;
}

function makeRenderer() {
  try {
    return new WebGLRenderer({ canvas: byId('view'), antialias: false, powerPreference: 'high-performance' });
  } catch (cause) {
    fail(new Error('this browser has no WebGL 2, or it is turned off', { cause }));
  }
}

async function load() {
  const parts = { model: [0, 1], field: [0, 1] };
  const hear = (part) => (loaded, total) => {
    parts[part] = [loaded, total];
    const sum = (i) => parts.model[i] + parts.field[i];
    showProgress('Loading the room', sum(0) / sum(1));
  };
  const model = download('scene.glb.gz', { onProgress: hear('model') }).then((bytes) => new GLTFLoader().parseAsync(bytes, ''));
  return Promise.all([model, OctaluxField.load('field.olx.gz', renderer, { onProgress: hear('field') })]);
}

// ---- The room

function sizeOf(root) {
  return new Box3().setFromObject(root).getSize(new Vector3()).length();
}

// Makes a camera like the scene's own, or one in the middle of the field that looks along -z.
function makeCamera(gltf, size) {
  const given = gltf.cameras[0], made = new PerspectiveCamera(given?.fov ?? 60, 1, 0.001 * size, 4 * size);
  if (given) given.getWorldPosition(made.position), given.getWorldQuaternion(made.quaternion);
  else made.position.fromArray(field.info.sceneMin).add(new Vector3(...field.info.sceneMax)).multiplyScalar(0.5);
  made.userData.fov = made.fov;
  return made;
}

// Returns a place for a ball before the camera, right of and below the middle of the picture, that is not in furniture.
function placeBefore(radius) {
  const ray = new Raycaster(), way = new Vector3(0.3, -0.22, -1).applyQuaternion(camera.quaternion).normalize();
  const firstHit = (from, direction, far) => {
    ray.set(from, direction);
    ray.far = far;
    return ray.intersectObject(room)[0]?.distance ?? far;
  };
  const away = firstHit(camera.position, way, 16 * radius);
  const isFree = (place) => AXES.every((axis) => firstHit(place, axis, 1.2 * radius) >= 1.2 * radius);
  const places = [0.75, 0.6, 0.45, 0.3].map((share) => camera.position.clone().addScaledVector(way, share * away));
  return places.find(isFree) ?? places[0];
}

function makeBall() {
  const sides = [0, 1, 2].map((i) => field.info.sceneMax[i] - field.info.sceneMin[i]), radius = 0.06 * Math.min(...sides);
  const material = field.light(new MeshStandardMaterial({ color: 0xd8d8d8, roughness: 0.85 }), { moving: true, part: 'diffuse' });
  const made = new Mesh(new SphereGeometry(radius, 48, 32), material);
  made.castShadow = made.receiveShadow = true;
  const corner = (of, away) => new Vector3(...of).addScalar(away);
  made.userData.bounds = [corner(field.info.sceneMin, radius), corner(field.info.sceneMax, -radius)];
  made.position.copy(placeBefore(radius)).clamp(...made.userData.bounds);
  made.userData.home = made.position.clone();
  return made;
}

function makeProbes(size) {
  const count = field.info.probes, at = new Matrix4(), buried = new Color(0xd01010), whole = new Color(0xf5a623);
  const made = new InstancedMesh(new SphereGeometry(0.006 * size, 12, 8), new MeshBasicMaterial({ toneMapped: false }), count);
  for (let i = 0; i < count; i++) {
    made.setMatrixAt(i, at.makeTranslation(...field.positions.subarray(3 * i, 3 * i + 3)));
    made.setColorAt(i, field.flags[i] & 1 ? buried : whole);
  }
  made.visible = false;
  return made;
}

// ---- Drawing

function resize() {
  const width = innerWidth, height = innerHeight, ratio = Math.min(devicePixelRatio, MOST_PIXEL_RATIO);
  renderer.setPixelRatio(ratio);
  renderer.setSize(width, height, false);
  camera.aspect = width / height;
  // Upright screens show as much to the sides as square ones do.
  const tangent = Math.tan((camera.userData.fov * Math.PI) / 360) / Math.min(camera.aspect, 1) ** 0.6;
  camera.fov = (Math.atan(tangent) * 360) / Math.PI;
  camera.updateProjectionMatrix();
  changed();
}

function resizePicture(by) {
  const ratio = renderer.getPixelRatio() * by;
  picture.resize(Math.max(1, Math.round(innerWidth * ratio)), Math.max(1, Math.round(innerHeight * ratio)));
}

const isMoving = () => seconds() - lastChange < STILL_SECONDS;

// While things move, pictures are as large as this length of a frame allows, and have no reflections where even the
// smallest pictures are too slow. When all is still, pictures have full size, and as many rows at a time are drawn as
// that length allows.
function chooseSize(frameSeconds, moving) {
  const more = SLOWEST_FRAME / Math.max(frameSeconds, 1e-3);
  if (moving && scale === LEAST_SCALE && frameSeconds > TOO_SLOW) glossyMoves = false;
  if (moving) scale = Math.max(LEAST_SCALE, Math.min(1, scale * Math.sqrt(more)));
  else share = Math.max(LEAST_SHARE, Math.min(1, share * more));
  resizePicture(moving ? scale : 1);
  return moving ? 1 : share;
}

function place() {
  if (carried !== null) ball.position.copy(camera.position).addScaledVector(camera.getWorldDirection(new Vector3()), carried);
  ball.position.clamp(...ball.userData.bounds); // outside these bounds the field has no light
  if (!shadowed.equals(ball.position)) renderer.shadowMap.needsUpdate = true;
  shadowed.copy(ball.position);
  const split = byId('split');
  field.uniforms.olx_left.value = split.hidden ? 0 : (split.value / 1000) * picture.frame.width;
  byId('line').style.left = `${split.value / 10}%`;
}

// Returns a function that tells whether the device has done all that was called until now. Calls return long before it
// is done, so only this shows how long a frame takes, and without it frames would queue up. A lost context does nothing
// until it is restored, and has then forgotten the fence.
function submit() {
  const gl = renderer.getContext(), fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0), before = restored;
  gl.flush();
  return () => {
    if (restored !== before) return true;
    if (gl.isContextLost()) return false;
    const done = gl.getSyncParameter(fence, gl.SYNC_STATUS) === gl.SIGNALED;
    if (done) gl.deleteSync(fence);
    return done;
  };
}

function draw() {
  requestAnimationFrame(draw);
  const now = seconds();
  walk.advance(Math.min(now - lastFrame, 0.2));
  lastFrame = now;
  if (!isDrawn()) return;
  isDrawn = () => true;
  // On slow devices a change can end before the last frame does. It is shown by a small picture even then.
  const moving = isMoving() || answered !== lastChange, rows = chooseSize(begun ? now - begun : SLOWEST_FRAME, moving);
  begun = 0;
  if (picture.settled) return;
  place();
  picture.draw(moving && !glossyMoves ? [depth, scene] : scenes, camera, field, rows);
  if (moving) answered = lastChange;
  isDrawn = submit();
  begun = seconds();
  state.frames++;
}

// Waits with drawing until a lost context is restored.
function lose() {
  isDrawn = () => !renderer.getContext().isContextLost();
  picture.release();
}

// Draws everything again, shadows included. three.js makes textures and shaders for a restored context by itself.
function restore() {
  restored++;
  begun = 0;
  renderer.shadowMap.needsUpdate = true;
  picture.restore();
  changed();
}

// ---- Stages: diffuse light first; then glossy light, drawn over it by shaders of its own, which compile while the
// user looks around.

// Draws a small picture, and waits until the device has drawn it; once more where the context was lost meanwhile.
async function drawFirst() {
  const before = restored;
  place();
  resizePicture(Math.min(LEAST_SCALE, Math.sqrt(FIRST_PIXELS / (innerWidth * innerHeight)) / renderer.getPixelRatio()));
  picture.draw(scenes, camera, field);
  const isDone = submit();
  while (!isDone()) await new Promise(requestAnimationFrame);
  if (restored !== before) await drawFirst();
}

function beginDrawing() {
  if (!drawing) requestAnimationFrame(draw);
  drawing = true;
}

// Gives every material the same set of textures, white ones where it has none: each set needs a shader of its own, and
// compiling one takes long.
function fillTextures() {
  const materials = new Set(), white = new DataTexture(new Uint8Array(4).fill(255), 1, 1);
  white.needsUpdate = true;
  room.traverse((mesh) => mesh.isMesh && materials.add(mesh.material));
  for (const material of materials) if (!material.map && material.opacity >= material.alphaTest) material.alphaTest = 0;
  for (const kind of ['map', 'roughnessMap', 'metalnessMap']) {
    if ([...materials].some((material) => material[kind])) materials.forEach((material) => { material[kind] ??= white; });
  }
}

// Draws depth before light, so that hidden surfaces are not lit. It is slightly behind the surfaces, which are drawn by
// other shaders.
function addDepth() {
  const made = new Map();
  room.updateMatrixWorld();
  room.traverse((mesh) => {
    if (!mesh.isMesh || mesh.material.alphaTest > 0 || mesh.material.transparent) return;
    const { side } = mesh.material;
    if (!made.has(side)) {
      made.set(side, new MeshBasicMaterial({ side, colorWrite: false, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 4 }));
    }
    addOver(depth, mesh, made.get(side));
  });
}

// Adds a mesh to `target` with the triangles and the position of `mesh`, and another material.
function addOver(target, mesh, material) {
  const over = new Mesh(mesh.geometry, material);
  over.matrixAutoUpdate = false;
  over.matrix.copy(mesh.matrixWorld);
  target.add(over);
}

// Lights take more time in a shader than the field does, so glossy light has a scene without lights.
function addDiffuseLight() {
  const lit = new Map();
  room.traverse((mesh) => {
    if (mesh.isMesh && !lit.has(mesh.material)) lit.set(mesh.material, field.light(mesh.material, { part: 'diffuse' }));
  });
}

function addGlossyLight() {
  const made = new Map();
  room.updateMatrixWorld();
  room.traverse((mesh) => {
    const reflects = mesh.isMesh && (mesh.material.metalness > 0 || (mesh.material.specularIntensity ?? 1) > 0);
    if (!reflects) return;
    if (!made.has(mesh.material)) {
      // Depth decides which parts are cut out, and the diffuse scene has the emission.
      const shiny = Object.assign(mesh.material.clone(), { alphaTest: 0, emissiveMap: null });
      made.set(mesh.material, field.light(shiny, { part: 'glossy' }));
    }
    addOver(shine, mesh, made.get(mesh.material));
  });
}

// Compiles shaders for the target that is drawn to, on which their text depends. Without the extension three.js would
// print a warning.
async function compile(what) {
  if (!renderer.extensions.has('KHR_parallel_shader_compile')) return;
  renderer.setRenderTarget(picture.frame);
  const compiled = renderer.compileAsync(what, camera);
  renderer.setRenderTarget(null);
  await compiled;
}

function haveTools() {
  const pressed = (id, value) => byId(id).setAttribute('aria-pressed', value);
  const actions = {
    indirect() {
      const on = field.uniforms.olx_strength.value.x === 0;
      field.setIndirect(on ? 1 : 0);
      pressed('indirect', on);
    },
    compare() {
      const on = byId('split').hidden;
      byId('split').hidden = byId('line').hidden = !on;
      pressed('compare', on);
    },
    carry() {
      carried = carried === null ? 5 * ball.geometry.parameters.radius : null;
      pressed('carry', carried !== null);
    },
    probes() {
      probes.visible = !probes.visible;
      pressed('probes', probes.visible);
    },
    reset() {
      if (carried === null) ball.position.copy(ball.userData.home);
      walk.reset();
    },
    help() {
      byId('keys').hidden = !byId('keys').hidden;
      pressed('help', !byId('keys').hidden);
    },
  };
  const keys = { KeyI: 'indirect', KeyB: 'compare', KeyC: 'carry', KeyP: 'probes', KeyR: 'reset', KeyH: 'help' };
  const run = (name) => {
    actions[name]();
    changed();
  };
  for (const name of Object.keys(actions)) byId(name).addEventListener('click', () => run(name));
  addEventListener('keydown', (event) => {
    if (keys[event.code] && !event.repeat && !event.ctrlKey && !event.metaKey && !event.altKey) run(keys[event.code]);
  });
  byId('split').addEventListener('input', changed);
  byId('tools').hidden = false;
}

async function start() {
  showProgress('Loading the room', 0);
  byId('view').addEventListener('webglcontextlost', lose);
  byId('view').addEventListener('webglcontextrestored', restore);
  const [gltf, loaded] = await load();
  field = loaded;
  room = gltf.scene;
  room.updateMatrixWorld(true);
  const size = sizeOf(room);
  camera = makeCamera(gltf, size);
  const hasLights = room.getObjectsByProperty('isLight', true).length > 0;
  ball = makeBall();
  probes = makeProbes(size);
  scene.add(room, ball, probes);
  depth.background = new Color(...(gltf.scene.userData.sky ?? [0, 0, 0]));
  addLamps(room, scene, size);
  walk = new Walk(byId('view'), camera, 0.12 * size, ball, changed);
  addEventListener('resize', resize);
  resize();
  showProgress('Preparing diffuse light', null);
  fillTextures();
  addDepth();
  addDiffuseLight();
  await compile(scene);
  await drawFirst();
  renderer.toneMappingExposure = KEY / picture.meanLuminance();
  haveTools();
  state.diffuseSeconds = seconds();
  state.stage = 'diffuse';
  byId('loading').hidden = !field.info.glossy;
  if (!field.info.glossy) {
    beginDrawing();
    return;
  }
  byId('loading').className = 'small';
  showProgress('Preparing glossy light', null);
  await new Promise((shown) => setTimeout(shown, 50));
  addGlossyLight();
  setTimeout(beginDrawing, PATIENCE_MS);
  await compile(shine);
  scenes.push(shine);
  field.uniforms.olx_emitters.value = !hasLights;
  changed();
  await drawFirst();
  beginDrawing();
  state.glossySeconds = seconds();
  state.stage = 'whole';
  byId('loading').hidden = true;
}

function base64Of(bytes) {
  let text = '';
  for (let i = 0; i < bytes.length; i += 32768) text += String.fromCharCode(...bytes.subarray(i, i + 32768));
  return btoa(text);
}

// Sets how textures are read where they are shown smaller than they are.
function filterTextures(minFilter) {
  room.traverse((mesh) => {
    for (const texture of Object.values(mesh.material ?? {})) {
      if (!texture?.isTexture || !texture.generateMipmaps || texture.minFilter === minFilter) continue;
      Object.assign(texture, { minFilter, needsUpdate: true });
    }
  });
}

// Returns one layer as `octalux render --centered` renders it with so many glossy samples, or for 'rays' the shares of
// samples that trace a ray and that stay unresolved: RGBA floats in base64.
function readLayer(layer, width, height, samples) {
  const { uniforms } = field, before = { emitters: uniforms.olx_emitters.value, left: uniforms.olx_left.value };
  const shot = camera.clone();
  shot.fov = camera.userData.fov;
  shot.aspect = width / height;
  shot.updateProjectionMatrix();
  uniforms.olx_layer.value = LAYERS.indexOf(layer);
  uniforms.olx_emitters.value = false;
  uniforms.olx_left.value = 0;
  ball.visible = false;
  filterTextures(LinearFilter); // as octalux render, which averages texels by more rays a pixel
  const pixels = picture.read(scenes, shot, field, width, height, samples);
  filterTextures(LinearMipmapLinearFilter);
  ball.visible = true;
  uniforms.olx_layer.value = 0;
  uniforms.olx_emitters.value = before.emitters;
  uniforms.olx_left.value = before.left;
  return base64Of(new Uint8Array(pixels.buffer));
}

start().catch(fail);
