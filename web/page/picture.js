// Frames, and their mean while nothing moves: drawn in linear light, added up, and shown through a tone map.
import { DataUtils, FloatType, HalfFloatType, Mesh, OrthographicCamera, PlaneGeometry, Scene, ShaderMaterial, WebGLRenderTarget } from 'three';

const VERTEX = 'varying vec2 place; void main() { place = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }';
const ADD = 'uniform sampler2D image; uniform float share; varying vec2 place; void main() { gl_FragColor = vec4(texture2D(image, place).rgb, share); }';
const SHOW = `uniform sampler2D image; varying vec2 place;
void main() {
  gl_FragColor = vec4(texture2D(image, place).rgb, 1.0);
  #include <tonemapping_fragment>
  #include <colorspace_fragment>
}`;

const MOST_FRAMES = 256, PROBE_SIZE = 48;

function pass(fragmentShader, uniforms, options) {
  const material = new ShaderMaterial({ vertexShader: VERTEX, fragmentShader, uniforms, depthTest: false, depthWrite: false, ...options });
  const scene = new Scene();
  scene.add(new Mesh(new PlaneGeometry(2, 2), material));
  scene.children[0].frustumCulled = false;
  return { scene, uniforms };
}

// Returns a number in [0, 1) of a low-discrepancy sequence.
function halton(index, base) {
  let result = 0;
  for (let share = 1 / base; index > 0; index = Math.floor(index / base), share /= base) result += share * (index % base);
  return result;
}

// Returns whether pictures of floats can be drawn and added up, which a context allows once it was asked for both.
function enableFloats(renderer) {
  return ['EXT_color_buffer_float', 'EXT_float_blend'].every((name) => renderer.extensions.has(name));
}

export class Picture {
  constructor(renderer) {
    this.renderer = renderer;
    this.camera = new OrthographicCamera();
    // All passes with a field draw to this one format, since drivers compile shaders again for another one.
    this.type = enableFloats(renderer) ? FloatType : HalfFloatType;
    this.frame = new WebGLRenderTarget(1, 1, { type: this.type });
    this.mean = new WebGLRenderTarget(1, 1, { type: this.type, depthBuffer: false });
    this.probe = new WebGLRenderTarget(PROBE_SIZE, PROBE_SIZE, { type: this.type, depthBuffer: false });
    this.adding = pass(ADD, { image: { value: this.frame.texture }, share: { value: 1 } }, { transparent: true, toneMapped: false });
    this.showing = pass(SHOW, { image: { value: this.mean.texture } }, {});
    this.count = this.rows = 0; // frames in the mean, and drawn rows of the next frame
  }

  get settled() {
    return this.count >= MOST_FRAMES;
  }

  restart() {
    this.count = this.rows = 0;
  }

  // Releases what a lost context held. Once that is restored, it refuses to delete what it had before.
  release() {
    for (const target of [this.frame, this.mean, this.probe]) target.dispose();
  }

  // Begins again in a restored context.
  restore() {
    enableFloats(this.renderer);
    this.restart();
  }

  resize(width, height) {
    if (this.frame.width === width && this.frame.height === height) return;
    this.frame.setSize(width, height);
    this.restart();
  }

  // Draws each scene over the earlier ones.
  #render(scenes, camera, target) {
    this.renderer.setRenderTarget(target);
    scenes.forEach((scene, i) => {
      this.renderer.autoClear = i === 0;
      this.renderer.render(scene, camera);
    });
    this.renderer.autoClear = true;
  }

  // Draws a share of the next frame's rows. A complete frame, shifted by a part of a pixel, joins the mean; until then
  // the previous mean is shown.
  draw(scenes, camera, field, share = 1) {
    const { width, height } = this.frame, index = this.count, end = Math.min(this.rows + Math.ceil(share * height), height);
    this.frame.scissorTest = true;
    this.frame.scissor.set(0, this.rows, width, end - this.rows);
    camera.setViewOffset(width, height, index ? halton(index, 2) - 0.5 : 0, index ? halton(index, 3) - 0.5 : 0, width, height);
    field.setFrame(index);
    this.#render(scenes, camera, this.frame);
    camera.clearViewOffset();
    this.rows = end % height;
    if (this.rows === 0) this.#show(index);
    this.renderer.setRenderTarget(null);
  }

  // Adds the frame to the earlier ones, and shows the mean.
  #show(index) {
    this.mean.setSize(this.frame.width, this.frame.height);
    this.adding.uniforms.share.value = 1 / (index + 1);
    this.renderer.autoClear = false;
    this.renderer.setRenderTarget(this.mean);
    this.renderer.render(this.adding.scene, this.camera);
    this.renderer.autoClear = true;
    this.renderer.setRenderTarget(null);
    this.renderer.render(this.showing.scene, this.camera);
    this.count++;
  }

  #readPixels(target, width, height) {
    const count = 4 * width * height, half = this.type === HalfFloatType;
    const pixels = half ? new Uint16Array(count) : new Float32Array(count);
    this.renderer.readRenderTargetPixels(target, 0, 0, width, height, pixels);
    return half ? Float32Array.from(pixels, DataUtils.fromHalfFloat) : pixels;
  }

  // Returns the geometric mean of luminance over the frame that was drawn last.
  meanLuminance() {
    this.adding.uniforms.share.value = 1;
    this.renderer.setRenderTarget(this.probe);
    this.renderer.render(this.adding.scene, this.camera);
    const pixels = this.#readPixels(this.probe, PROBE_SIZE, PROBE_SIZE);
    this.renderer.setRenderTarget(null);
    let sum = 0, count = 0;
    for (let i = 0; i < pixels.length; i += 4) {
      const luminance = 0.2126 * pixels[i] + 0.7152 * pixels[i + 1] + 0.0722 * pixels[i + 2];
      if (!(luminance > 1e-5)) continue; // darkness outside the room
      sum += Math.log(luminance);
      count++;
    }
    return count ? Math.exp(sum / count) : 1;
  }

  // Returns the mean of `frames` frames that are not shifted, in linear light: RGBA, rows from the bottom up.
  read(scenes, camera, field, width, height, frames) {
    const target = new WebGLRenderTarget(width, height, { type: this.type });
    const mean = new Float32Array(4 * width * height);
    for (let index = 0; index < frames; index++) {
      field.setFrame(index);
      this.#render(scenes, camera, target);
      this.#readPixels(target, width, height).forEach((value, i) => { mean[i] += value / frames; });
    }
    this.renderer.setRenderTarget(null);
    target.dispose();
    return mean;
  }
}
