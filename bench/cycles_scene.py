"""Runs inside Blender: makes a scene of the arrays that octalux-bench scene-arrays wrote, and renders it with Cycles.

    blender -b --factory-startup -P bench/cycles_scene.py -- SETTINGS.json

bench/cycles.py writes the settings and starts Blender. Blender's world is given the scene's own coordinates (Y up),
metres and linear Rec.709, in which Cycles computes, so that nothing is converted. Materials are rebuilt from Octalux's
parameters:

- the diffuse lobe is Lambert's, albedo times 1 - w F(normal . view), exactly;
- the specular lobe is Cycles' GGX with the same alpha, F0 and F90. Cycles uses the separable Smith term and the
  Fresnel equations where Octalux has the height-correlated term and Schlick's formula, which gives as much on the
  whole: glossy light agrees to some percent only;
- textures of specular weights (KHR_materials_specular) are left out;
- alpha masks, one-sided emission, base colours clamped to 0.95 and bilinear texture look-ups are the same.
"""
import json
import math
import os
import sys

import bpy
import mathutils
import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import cycles_import  # noqa: E402
import exr_picture  # noqa: E402

LARGEST_ALBEDO = 0.95
MIRROR_ROUGHNESS = 0.03
# Blender's metals rise from F0 to 1 as the Fresnel equations of some index of refraction do, and this index is set
# here. At 1.345 the mean over the hemisphere is that of Schlick's (1 - cosine)^5, 1 / 21.
FRESNEL_SPECULAR = 0.27


class Nodes:
    """Builds a node tree; every method returns an output socket. Inputs are sockets, numbers or colours."""

    def __init__(self, tree):
        self.tree = tree
        tree.nodes.clear()

    def node(self, kind, inputs=(), **properties):
        node = self.tree.nodes.new(kind)
        for key, value in properties.items():
            setattr(node, key, value)
        for key, value in dict(inputs).items():
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, node.inputs[key])
            else:
                node.inputs[key].default_value = value
        return node

    def math(self, operation, a, b=0.0):
        return self.node("ShaderNodeMath", {0: a, 1: b}, operation=operation).outputs[0]

    def vector(self, operation, a, b=(0, 0, 0)):
        node = self.node("ShaderNodeVectorMath", {0: a, 1: b}, operation=operation)
        return node.outputs["Value" if operation == "DOT_PRODUCT" else "Vector"]

    def scale(self, color, factor):
        node = self.node("ShaderNodeVectorMath", {0: color}, operation="SCALE")
        if isinstance(factor, bpy.types.NodeSocket):
            self.tree.links.new(factor, node.inputs["Scale"])
        else:
            node.inputs["Scale"].default_value = factor
        return node.outputs["Vector"]

    def add(self, a, b):
        return self.node("ShaderNodeAddShader", {0: a, 1: b}).outputs[0]

    def mix(self, factor, a, b):
        return self.node("ShaderNodeMixShader", {0: factor, 1: a, 2: b}).outputs[0]

    def geometry(self, name):
        return self.node("ShaderNodeNewGeometry").outputs[name]


def rgba(color):
    return (*color, 1.0)


class Textures:
    """Images by texture and use. `bytes` leaves colours as they are in the file, which Cycles filters before it decodes
    them; `float` decodes them first, as Octalux does; `closest` does not filter."""

    def __init__(self, folder, described, how):
        self.folder, self.described, self.how = folder, described, how
        self.images = {}

    def texels(self, index):
        t = self.described[index]
        path = os.path.join(self.folder, "texture%d.u8" % index)
        return numpy.fromfile(path, dtype=numpy.uint8).reshape(t["height"], t["width"], 4)

    def make(self, name, values, srgb_bytes=False):
        """Rows of `values` begin at v = 0, as Blender's do."""
        image = bpy.data.images.new(name, values.shape[1], values.shape[0], alpha=True, float_buffer=not srgb_bytes)
        image.colorspace_settings.name = "sRGB" if srgb_bytes else "Non-Color"
        image.alpha_mode = "CHANNEL_PACKED"
        image.pixels.foreach_set(numpy.ascontiguousarray(values, dtype=numpy.float32).ravel())
        image.pack()
        return image

    def image(self, index, use, make):
        if (index, use) not in self.images:
            name = "texture %d %s" % (index, use)
            self.images[index, use] = make(name, self.texels(index).astype(numpy.float32) / 255)
        return self.images[index, use]

    def color(self, name, values):
        srgb = self.described[int(name.split()[1])]["srgb"]
        if self.how == "bytes" and srgb:
            values[..., 3] = 1
            return self.make(name, values, srgb_bytes=True)
        if srgb:
            c = values[..., :3]
            values[..., :3] = numpy.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
        values[..., 3] = 1
        return self.make(name, values)

    def alpha(self, name, values):
        values[..., :3] = values[..., 3:]
        values[..., 3] = 1
        return self.make(name, values)

    def normal(self, name, values):
        """Octalux's normal maps have y along decreasing v, Blender's along increasing v."""
        values[..., 1] = 1 - values[..., 1]
        values[..., 3] = 1
        return self.make(name, values)

    def height(self, scale):
        def make(name, values):
            h = values[..., 0]
            along_u = (numpy.roll(h, -1, 1) - numpy.roll(h, 1, 1)) / 2 * scale
            along_v = (numpy.roll(h, -1, 0) - numpy.roll(h, 1, 0)) / 2 * scale
            n = numpy.stack([-along_u, -along_v, numpy.ones_like(h)], axis=-1)
            values[..., :3] = n / numpy.linalg.norm(n, axis=-1, keepdims=True) / 2 + 0.5
            values[..., 3] = 1
            return self.make(name, values)
        return make

    def look_up(self, nodes, index, use, make):
        interpolation = "Closest" if self.how == "closest" else "Linear"
        node = nodes.node("ShaderNodeTexImage", image=self.image(index, use, make), interpolation=interpolation)
        return node.outputs["Color"]


def presence(nodes, textures, m):
    """The share of rays that find the surface, 0 or 1 by its alpha test; None where it is there for certain."""
    if m["alpha_cutoff"] <= 0:
        return None
    alpha = m["alpha"]
    if "base_color_texture" in m:
        found = textures.look_up(nodes, m["base_color_texture"], "alpha", textures.alpha)
        alpha = nodes.math("MULTIPLY", found, alpha)
    if "alpha_texture" in m:
        found = textures.look_up(nodes, m["alpha_texture"], "color", textures.color)
        red = nodes.node("ShaderNodeSeparateRGB", {0: found}).outputs[0]
        alpha = nodes.math("MULTIPLY", red, alpha)
    if m["blended"]:
        return alpha
    absent = nodes.math("LESS_THAN", alpha, m["alpha_cutoff"])
    return nodes.math("SUBTRACT", 1.0, absent)


def base_color(nodes, textures, m):
    color = m["base_color"]
    if "base_color_texture" in m:
        found = textures.look_up(nodes, m["base_color_texture"], "color", textures.color)
        color = nodes.vector("MULTIPLY", found, color)
        color = nodes.vector("MINIMUM", color, [LARGEST_ALBEDO] * 3)
    else:
        color = nodes.node("ShaderNodeCombineXYZ", dict(enumerate(min(c, LARGEST_ALBEDO) for c in color))).outputs[0]
    return color


def bent_normal(nodes, textures, m):
    if "normal_texture" not in m:
        return None
    height, scale = m["normal_is_height"], m["normal_scale"]
    use = ("height %g" % scale, textures.height(scale)) if height else ("normal", textures.normal)
    found = textures.look_up(nodes, m["normal_texture"], *use)
    return nodes.node("ShaderNodeNormalMap", {"Strength": 1.0 if height else scale, "Color": found}).outputs[0]


def reflection(nodes, textures, m):
    color, normal = base_color(nodes, textures, m), bent_normal(nodes, textures, m)
    turned = {"Normal": normal} if normal else {}
    w, metallic, roughness = m["specular_weight"], m["metallic"], m["roughness"]
    if "metallic_roughness_texture" in m:
        found = textures.look_up(nodes, m["metallic_roughness_texture"], "color", textures.color)
        split = nodes.node("ShaderNodeSeparateRGB", {0: found})
        roughness = nodes.math("MULTIPLY", split.outputs[1], roughness)
        metallic = nodes.math("MULTIPLY", split.outputs[2], metallic)
    varies = isinstance(metallic, bpy.types.NodeSocket)
    diffuse = nodes.scale(color, nodes.math("SUBTRACT", 1.0, metallic))
    if w > 0:
        facing = normal or nodes.geometry("Normal")
        cosine = nodes.math("MAXIMUM", nodes.vector("DOT_PRODUCT", facing, nodes.geometry("Incoming")), 0.0)
        grazing = nodes.math("POWER", nodes.math("MAXIMUM", nodes.math("SUBTRACT", 1.0, cosine), 0.0), 5.0)
        kept = nodes.math("SUBTRACT", 1 - 0.04 * w, nodes.math("MULTIPLY", grazing, 0.96 * w))
        diffuse = nodes.scale(diffuse, kept)
    lobes = nodes.node("ShaderNodeBsdfDiffuse", {"Color": diffuse, "Roughness": 0.0, **turned}).outputs[0]
    if w <= 0 and not varies and metallic <= 0:
        return lobes
    if not isinstance(roughness, bpy.types.NodeSocket) and roughness < MIRROR_ROUGHNESS:
        roughness = 0.0

    def lobe(f0):
        inputs = {"Base Color": f0, "Metallic": 1.0, "Roughness": roughness, "Specular": FRESNEL_SPECULAR, **turned}
        return nodes.node("ShaderNodeBsdfPrincipled", inputs).outputs[0]

    glazed, metal = lobe(rgba([0.04] * 3)), lobe(color)
    nothing = nodes.node("ShaderNodeBsdfDiffuse", {"Color": rgba([0, 0, 0])}).outputs[0]
    specular = nodes.mix(metallic, nodes.mix(w, nothing, glazed), metal)
    return nodes.add(lobes, specular)


def emission(nodes, textures, m):
    if max(m["emission"]) <= 0:
        return None
    color = m["emission"]
    if "emission_texture" in m:
        found = textures.look_up(nodes, m["emission_texture"], "color", textures.color)
        color = nodes.vector("MULTIPLY", found, color)
    else:
        color = nodes.node("ShaderNodeCombineXYZ", dict(enumerate(color))).outputs[0]
    strength = 1.0
    if not m["emits_both_sides"]:
        strength = nodes.math("SUBTRACT", 1.0, nodes.geometry("Backfacing"))
    return nodes.node("ShaderNodeEmission", {"Color": color, "Strength": strength}).outputs[0]


def make_material(textures, m, index, emitters):
    material = bpy.data.materials.new("%d" % index)
    material.cycles.sample_as_light = emitters == "sampled"
    material.use_nodes = True
    nodes = Nodes(material.node_tree)
    shader = reflection(nodes, textures, m)
    light = emission(nodes, textures, m)
    if light:
        shader = nodes.add(shader, light)
    there = presence(nodes, textures, m)
    if there:
        shader = nodes.mix(there, nodes.node("ShaderNodeBsdfTransparent").outputs[0], shader)
    nodes.node("ShaderNodeOutputMaterial", {"Surface": shader})
    return material


def turn_to_normals(positions, normals, indices, keep):
    """Octalux turns interpolated normals to the side of the triangle's winding; Cycles believes them. Triangles whose
    normals all point to the other side are wound the other way here, but those that emit (`keep`)."""
    corner = positions[indices]
    outward = numpy.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    agreement = numpy.einsum("ijk,ik->ij", normals[indices], outward)
    turned = (agreement < 0).all(axis=1) & ~keep
    indices[turned] = indices[turned][:, [0, 2, 1]]
    mixed = ((agreement < 0).any(axis=1) & ~(agreement < 0).all(axis=1)).sum()
    print("normals: %d triangles wound the other way, %d with normals on both sides" % (turned.sum(), mixed))


def without_twins(positions, indices):
    """Which triangles to keep: of several with the same corners the first. Cycles lets such twins shadow each other in
    blotches, because rays begin on one and meet the other; Octalux begins them off both."""
    _, place = numpy.unique(positions, axis=0, return_inverse=True)
    corners = numpy.sort(place.reshape(-1)[indices], axis=1)
    _, first = numpy.unique(corners, axis=0, return_index=True)
    print("twins: %d of %d triangles left out" % (len(indices) - len(first), len(indices)))
    return numpy.sort(first)


def make_mesh(folder, described, textures, settings):
    def load(name, dtype, width):
        return numpy.fromfile(os.path.join(folder, name), dtype=dtype).reshape(-1, width)

    positions, normals = load("positions.f32", numpy.float32, 3), load("normals.f32", numpy.float32, 3)
    uvs, indices = load("uvs.f32", numpy.float32, 2), load("indices.u32", numpy.int32, 3)
    material_index = load("material_index.u32", numpy.int32, 1).ravel()
    if settings["import"]:
        lamps = numpy.array([m["rectangle_light"] for m in described["materials"]])[material_index]
        indices, material_index = indices[lamps], material_index[lamps]
    kept = without_twins(positions, indices)
    indices, material_index = indices[kept], material_index[kept]
    emits = numpy.array([max(m["emission"]) > 0 for m in described["materials"]])
    turn_to_normals(positions, normals, indices, emits[material_index])
    mesh = bpy.data.meshes.new("scene")
    mesh.vertices.add(len(positions))
    mesh.vertices.foreach_set("co", positions.ravel())
    mesh.loops.add(indices.size)
    mesh.loops.foreach_set("vertex_index", indices.ravel())
    mesh.polygons.add(len(indices))
    mesh.polygons.foreach_set("loop_start", numpy.arange(0, indices.size, 3, dtype=numpy.int32))
    mesh.polygons.foreach_set("loop_total", numpy.full(len(indices), 3, dtype=numpy.int32))
    mesh.polygons.foreach_set("use_smooth", numpy.full(len(indices), settings["normals"] == "smooth"))
    mesh.uv_layers.new(name="uv").data.foreach_set("uv", uvs[indices.ravel()].ravel())
    for i, m in enumerate(described["materials"]):
        mesh.materials.append(make_material(textures, m, i, settings["emitters"]))
    mesh.polygons.foreach_set("material_index", material_index)
    mesh.update(calc_edges=True)
    if settings["normals"] == "smooth":
        mesh.use_auto_smooth = True
        mesh.normals_split_custom_set(normals[indices.ravel()])
    thing = bpy.data.objects.new("scene", mesh)
    thing.cycles.shadow_terminator_geometry_offset = settings["shadow_terminator"]
    bpy.context.scene.collection.objects.link(thing)


def axes(forward, up):
    """A rotation whose -Z is `forward` and whose +Y is as near to `up` as may be."""
    forward = mathutils.Vector(forward).normalized()
    right = forward.cross(mathutils.Vector(up))
    if right.length < 1e-4:
        right = forward.orthogonal()
    right.normalize()
    above = right.cross(forward)
    return mathutils.Matrix((right, above, -forward)).transposed().to_4x4()


def add_object(name, data, matrix, position):
    thing = bpy.data.objects.new(name, data)
    thing.matrix_world = mathutils.Matrix.Translation(position) @ matrix
    bpy.context.scene.collection.objects.link(thing)
    return thing


def make_camera(c):
    data = bpy.data.cameras.new(c["name"])
    data.sensor_fit = "VERTICAL"
    data.angle = math.radians(c["fov_y_degrees"])
    data.clip_start, data.clip_end = 1e-5, 1e6
    forward = [t - e for t, e in zip(c["target"], c["eye"])]
    bpy.context.scene.camera = add_object("camera", data, axes(forward, c["up"]), c["eye"])


def spot_falloff(nodes, light):
    """The square of the share of the cosine's way from the outer to the inner cone."""
    cosine = nodes.vector("DOT_PRODUCT", nodes.geometry("Incoming"), light["direction"])
    inner, outer = light["cosine_inner"], light["cosine_outer"]
    share = nodes.math("DIVIDE", nodes.math("SUBTRACT", cosine, outer), max(inner - outer, 1e-6))
    share = nodes.math("MINIMUM", nodes.math("MAXIMUM", share, 0.0), 1.0)
    return nodes.math("MULTIPLY", share, share)


def make_light(light):
    """A sun's strength is irradiance; a point light of 4 pi watts has a radiant intensity of 1 W/sr."""
    sun = light["type"] == "sun"
    data = bpy.data.lights.new(light["type"], "SUN" if sun else "POINT")
    data.energy = 1.0 if sun else 4 * math.pi
    data.use_shadow = True
    data.use_nodes = True
    nodes = Nodes(data.node_tree)
    color = nodes.node("ShaderNodeCombineXYZ", dict(enumerate(light["emission"]))).outputs[0]
    strength = spot_falloff(nodes, light) if light["type"] == "spot" else 1.0
    shader = nodes.node("ShaderNodeEmission", {"Color": color, "Strength": strength}).outputs[0]
    nodes.node("ShaderNodeOutputLight", {"Surface": shader})
    if sun:
        data.angle = 0
    else:
        data.shadow_soft_size = 0
    add_object(light["type"], data, axes(light["direction"] if sun else (0, -1, 0), (0, 0, 1)), light["position"])


def make_world(folder, e):
    world = bpy.data.worlds.new("world")
    bpy.context.scene.world = world
    world.use_nodes = True
    nodes = Nodes(world.node_tree)
    color = nodes.node("ShaderNodeCombineXYZ", dict(enumerate(e["radiance"]))).outputs[0]
    if e["width"]:
        rows = numpy.fromfile(os.path.join(folder, "environment.f32"), dtype=numpy.float32)
        rows = rows.reshape(e["height"], e["width"], 3)[::-1]
        image = bpy.data.images.new("environment", e["width"], e["height"], alpha=True, float_buffer=True)
        image.colorspace_settings.name = "Non-Color"
        image.pixels.foreach_set(numpy.dstack([rows, numpy.ones_like(rows[..., :1])]).ravel())
        image.pack()
        # Blender's images of an environment have Z up, and run against the azimuth.
        direction = nodes.node("ShaderNodeTexCoord").outputs["Generated"]
        for axis, angle in (("X_AXIS", math.pi / 2), ("Z_AXIS", -e["rotation_radians"])):
            turn = nodes.node("ShaderNodeVectorRotate", {"Vector": direction, "Angle": angle}, rotation_type=axis)
            direction = turn.outputs[0]
        found = nodes.node("ShaderNodeTexEnvironment", {"Vector": direction}, image=image).outputs["Color"]
        color = nodes.vector("MULTIPLY", found, color)
    shader = nodes.node("ShaderNodeBackground", {"Color": color, "Strength": 1.0}).outputs[0]
    nodes.node("ShaderNodeOutputWorld", {"Surface": shader})
    world.cycles.sampling_method = "AUTOMATIC" if e["width"] else "MANUAL"
    world.cycles.sample_map_resolution = 1024


def configure(settings):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = settings["size"]
    scene.render.resolution_percentage = 100
    scene.render.threads_mode, scene.render.threads = "FIXED", settings["threads"]
    scene.render.film_transparent = False
    scene.render.dither_intensity = 0
    scene.render.use_compositing = scene.render.use_sequencer = False
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples, cycles.seed = settings["spp"], settings["seed"]
    cycles.use_adaptive_sampling = cycles.use_denoising = cycles.use_fast_gi = False
    cycles.pixel_filter_type = "BOX"
    for limit in ("max_bounces", "diffuse_bounces", "glossy_bounces"):
        setattr(cycles, limit, settings["bounces"])
    cycles.transmission_bounces = cycles.volume_bounces = 0
    cycles.transparent_max_bounces = 1024
    cycles.caustics_reflective = cycles.caustics_refractive = True
    # Blender's means against noise lose light, so all of them are off unless an experiment turns one on.
    cycles.blur_glossy = cycles.sample_clamp_direct = 0.0
    cycles.sample_clamp_indirect = settings["clamp_indirect"]
    cycles.light_sampling_threshold = settings["light_threshold"]
    layer = scene.view_layers[0]
    for name in ("diffuse_direct", "diffuse_indirect", "diffuse_color", "glossy_direct", "glossy_indirect",
                 "glossy_color", "emit", "environment"):
        setattr(layer, "use_pass_" + name, True)
    picture = scene.render.image_settings
    picture.file_format, picture.color_depth, picture.exr_codec = "OPEN_EXR_MULTILAYER", "32", "NONE"
    scene.render.filepath = settings["passes"]


def write_layers(settings):
    """Octalux's layers from Cycles' passes, which hold light before colour."""
    width, height, channels = exr_picture.read(settings["passes"])

    def color(name):
        return numpy.array([channels["ViewLayer.%s.%s" % (name, c)] for c in "RGB"], dtype=numpy.float32)

    seen = color("Emit") + color("Env")
    direct = color("DiffDir") * color("DiffCol") + color("GlossDir") * color("GlossCol")
    layers = {
        "direct": direct,
        "indirect_diffuse": color("DiffInd") * color("DiffCol"),
        "indirect_glossy": color("GlossInd") * color("GlossCol"),
        "albedo": color("DiffCol"),
    }
    layers["beauty"] = seen + direct + layers["indirect_diffuse"] + layers["indirect_glossy"]
    out = {}
    for layer, values in layers.items():
        for i, c in enumerate("RGB"):
            out[c if layer == "beauty" else "%s.%s" % (layer, c)] = values[i]
    exr_picture.write(settings["output"], width, height, out)


def main():
    settings = json.load(open(sys.argv[sys.argv.index("--") + 1]))
    folder = settings["folder"]
    described = json.load(open(os.path.join(folder, "scene.json")))
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    if settings["import"]:
        cycles_import.import_model(settings, LARGEST_ALBEDO)
    textures = Textures(folder, described["textures"], settings["textures"])
    make_mesh(folder, described, textures, settings)
    make_camera(described["camera"])
    for light in described["lights"]:
        make_light(light)
    make_world(folder, described["environment"])
    configure(settings)
    bpy.ops.render.render(write_still=True)
    write_layers(settings)
    print("cycles: done")


if __name__ == "__main__":
    try:
        main()
    except Exception:  # Blender would continue, and exit with 0.
        import traceback
        traceback.print_exc()
        sys.exit(1)
