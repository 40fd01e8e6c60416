// Direct light for the picture: a spot light with a shadow for each of the strongest lamps. A lamp is a connected set
// of emissive triangles.
import { Box3, Color, SpotLight, Vector3 } from 'three';

const MOST_LAMPS = 3;
const SHADOW_TEXELS = 1024, SUN_SHADOW_TEXELS = 2048;

// Finds the representative of each vertex's connected set; corners of triangles at the same position count as one
// vertex.
function connect(geometry) {
  const { index, attributes: { position } } = geometry, parent = new Map();
  const key = (corner) => [0, 1, 2].map((i) => position.getComponent(index.getX(corner), i).toFixed(5)).join();
  const find = (name) => {
    while (parent.get(name) !== name) name = parent.get(name);
    return name;
  };
  for (let corner = 0; corner < index.count; corner++) {
    const name = key(corner);
    if (!parent.has(name)) parent.set(name, name);
    if (corner % 3) parent.set(find(name), find(key(corner - 1)));
  }
  return (corner) => find(key(corner));
}

function lampsOf(mesh) {
  const { geometry, material, matrixWorld } = mesh, { index, attributes: { position } } = geometry;
  const radiance = material.emissive.clone().multiplyScalar(material.emissiveIntensity), of = connect(geometry), lamps = new Map();
  for (let first = 0; first < index.count; first += 3) {
    const [a, b, c] = [0, 1, 2].map((i) => new Vector3().fromBufferAttribute(position, index.getX(first + i)).applyMatrix4(matrixWorld));
    const normal = b.clone().sub(a).cross(c.clone().sub(a)).multiplyScalar(0.5), area = normal.length();
    const lamp = lamps.get(of(first)) ?? { middle: new Vector3(), normal: new Vector3(), area: 0, radiance };
    lamp.middle.addScaledVector(a.add(b).add(c), area / 3);
    lamp.normal.add(normal);
    lamp.area += area;
    lamps.set(of(first), lamp);
  }
  return [...lamps.values()].map((lamp) => ({ ...lamp, middle: lamp.middle.divideScalar(lamp.area) }));
}

const luminance = ({ r, g, b }) => 0.2126 * r + 0.7152 * g + 0.0722 * b;

function spotOf(lamp, size) {
  const most = Math.max(lamp.radiance.r, lamp.radiance.g, lamp.radiance.b), direction = lamp.normal.clone().normalize();
  const light = new SpotLight(new Color().copy(lamp.radiance).multiplyScalar(1 / most), most * lamp.area, 0, Math.PI / 2.02, 1, 2);
  light.position.copy(lamp.middle).addScaledVector(direction, 1e-3 * size);
  light.target.position.copy(light.position).add(direction);
  light.castShadow = true;
  light.shadow.mapSize.set(SHADOW_TEXELS, SHADOW_TEXELS);
  light.shadow.camera.near = 0.004 * size;
  light.shadow.camera.far = 2 * size;
  light.shadow.focus = 0.78; // narrower than the half space, whose map would have too few texels in the middle
  light.shadow.bias = -0.002;
  light.shadow.normalBias = 0.004 * size;
  light.shadow.radius = 6;
  return light;
}

// Fits the sun's shadow to the whole room. As in glTF, the light shines along its own -z.
function shadeSun(light, bounds) {
  const middle = bounds.getCenter(new Vector3()), radius = bounds.getSize(new Vector3()).length() / 2, { shadow } = light;
  const back = new Vector3(0, 0, 1).applyQuaternion(light.quaternion);
  light.position.copy(middle).addScaledVector(back, radius);
  light.castShadow = true;
  shadow.mapSize.set(SUN_SHADOW_TEXELS, SUN_SHADOW_TEXELS);
  Object.assign(shadow.camera, { left: -radius, right: radius, top: radius, bottom: -radius, near: 0, far: 2 * radius });
  shadow.bias = -0.0005;
  shadow.normalBias = 2 * radius / SUN_SHADOW_TEXELS;
}

/** Adds lights for what emits below `room`, which is `size` metres across. Surfaces that emit cast no shadow; its suns do. */
export function addLamps(room, scene, size) {
  const lamps = [], bounds = new Box3().setFromObject(room);
  room.traverse((light) => light.isDirectionalLight && shadeSun(light, bounds));
  room.traverse((mesh) => {
    if (!mesh.isMesh) return;
    const emits = mesh.material.emissive && luminance(mesh.material.emissive) > 0;
    mesh.castShadow = !emits;
    mesh.receiveShadow = true;
    if (emits) lamps.push(...lampsOf(mesh));
  });
  const closed = (lamp) => lamp.normal.length() < 0.05 * lamp.area;
  const power = (lamp) => lamp.area * luminance(lamp.radiance);
  const chosen = lamps.filter((lamp) => !closed(lamp)).sort((a, b) => power(b) - power(a)).slice(0, MOST_LAMPS);
  for (const lamp of chosen) {
    const light = spotOf(lamp, size);
    scene.add(light, light.target);
  }
  return chosen.length;
}
