"""Runs inside Blender: a glTF model read by Blender's own importer instead of Octalux's, every surface Lambertian.

It checks what octalux-bench scene-arrays cannot: that Octalux understood the file. The importer turns Y up into Z up, which is
undone.
"""
import math

import bpy
import mathutils
import numpy

# Debian's importer is older than its numpy, which no longer has this name.
numpy.bool = bool


def decoded(image):
    """The same texels, decoded from sRGB before anything filters them."""
    values = numpy.empty(len(image.pixels), dtype=numpy.float32)
    image.pixels.foreach_get(values)
    values = values.reshape(-1, 4)
    c = values[:, :3]
    values[:, :3] = numpy.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    made = bpy.data.images.new(image.name + " decoded", *image.size, alpha=True, float_buffer=True)
    made.colorspace_settings.name = "Non-Color"
    made.alpha_mode = "CHANNEL_PACKED"
    made.pixels.foreach_set(values.ravel())
    made.pack()
    return made


def decode_textures(how):
    """Colours of 8 bits are decoded first; the importer marks maps that are no colours as Non-Color."""
    made = {}
    for material in bpy.data.materials:
        for node in material.node_tree.nodes if material.node_tree else ():
            if node.type != "TEX_IMAGE" or not node.image:
                continue
            image = node.image
            image.alpha_mode = "CHANNEL_PACKED"
            node.interpolation = "Closest" if how == "closest" else "Linear"
            if how == "bytes" or image.colorspace_settings.name != "sRGB":
                continue
            if image.name not in made:
                made[image.name] = decoded(image)
            node.image = made[image.name]


def connect(tree, source, target):
    """What feeds one input feeds the other."""
    if source.is_linked:
        tree.links.new(source.links[0].from_socket, target)
    elif target.type == "RGBA" or source.type != "RGBA":
        target.default_value = source.default_value


def make_matte(material, largest_albedo):
    tree = material.node_tree
    glossy = next((n for n in tree.nodes if n.type == "BSDF_PRINCIPLED"), None)
    output = next((n for n in tree.nodes if n.type == "OUTPUT_MATERIAL"), None)
    if not glossy or not output:
        raise RuntimeError("material %s: made in a way that is not known" % material.name)

    def node(kind, operation=None):
        made = tree.nodes.new(kind)
        if operation:
            made.operation = operation
        return made

    clamp = node("ShaderNodeVectorMath", "MINIMUM")
    clamp.inputs[1].default_value = [largest_albedo] * 3
    color = glossy.inputs["Base Color"]
    if color.is_linked:
        tree.links.new(color.links[0].from_socket, clamp.inputs[0])
    else:
        clamp.inputs[0].default_value = color.default_value[:3]
    shader = node("ShaderNodeBsdfDiffuse")
    tree.links.new(clamp.outputs["Vector"], shader.inputs["Color"])
    emission, front = node("ShaderNodeEmission"), node("ShaderNodeMath", "SUBTRACT")
    connect(tree, glossy.inputs["Emission"], emission.inputs["Color"])
    front.inputs[0].default_value = glossy.inputs["Emission Strength"].default_value
    if material.use_backface_culling:
        scaled = node("ShaderNodeMath", "MULTIPLY")
        tree.links.new(node("ShaderNodeNewGeometry").outputs["Backfacing"], scaled.inputs[0])
        scaled.inputs[1].default_value = front.inputs[0].default_value
        tree.links.new(scaled.outputs[0], front.inputs[1])
    else:
        front.inputs[1].default_value = 0
    tree.links.new(front.outputs[0], emission.inputs["Strength"])
    both, mix, there = node("ShaderNodeAddShader"), node("ShaderNodeMixShader"), node("ShaderNodeMath", "LESS_THAN")
    tree.links.new(shader.outputs[0], both.inputs[0])
    tree.links.new(emission.outputs[0], both.inputs[1])
    connect(tree, glossy.inputs["Alpha"], there.inputs[0])
    there.inputs[1].default_value = 0.5
    tree.links.new(there.outputs[0], mix.inputs[0])
    tree.links.new(both.outputs[0], mix.inputs[1])
    tree.links.new(node("ShaderNodeBsdfTransparent").outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], output.inputs["Surface"])


def import_model(settings, largest_albedo):
    bpy.ops.import_scene.gltf(filepath=settings["import"])
    for thing in list(bpy.data.objects):
        if thing.type in ("LIGHT", "CAMERA"):
            bpy.data.objects.remove(thing)
    upright = mathutils.Matrix.Rotation(-math.pi / 2, 4, "X")
    for thing in bpy.data.objects:
        if not thing.parent:
            thing.matrix_world = upright @ thing.matrix_world
        if thing.type == "MESH":
            thing.cycles.shadow_terminator_geometry_offset = settings["shadow_terminator"]
    decode_textures(settings["textures"])
    used = {slot.material for thing in bpy.data.objects if thing.type == "MESH" for slot in thing.material_slots}
    for material in used - {None}:
        make_matte(material, largest_albedo)
