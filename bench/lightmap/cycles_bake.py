"""Cycles bakes the light map of a glTF file: irradiance per texel of TEXCOORD_1, in the units and with the materials that `lightwell bake` has.

  blender -b -P cycles_bake.py -- SCENE --size N --threads N [--bounces N] [--denoise] RUN...

RUN: SAMPLES:SEED:OUT.exr, one bake each. Prints a line `baked SAMPLES SEED SECONDS` for each: of the bake operator alone, without Blender's start, the
import and the writing of the file. R, G, B: irradiance; A: covered.
"""
import argparse
import math
import sys
import time

import bpy
import numpy as np

if not hasattr(np, "bool"):  # the importer of Blender 3.4 with NumPy 1.24
    np.bool, np.int, np.float = bool, int, float

LUMENS_PER_WATT = 683.0  # the importer divides photometric units by it


def lambertian(material, node_tree):
    """Colour and emission stay, highlights go: light maps are about diffuse light."""
    principled = next((n for n in node_tree.nodes if n.type == "BSDF_PRINCIPLED"), None)
    output = next((n for n in node_tree.nodes if n.type == "OUTPUT_MATERIAL"), None)
    if principled is None or output is None:
        return

    def connect(source, target):
        if source.is_linked:
            node_tree.links.new(source.links[0].from_socket, target)
        else:
            target.default_value = source.default_value

    diffuse = node_tree.nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Roughness"].default_value = 0.0
    connect(principled.inputs["Base Color"], diffuse.inputs["Color"])
    emission = node_tree.nodes.new("ShaderNodeEmission")
    connect(principled.inputs["Emission"], emission.inputs["Color"])
    connect(principled.inputs["Emission Strength"], emission.inputs["Strength"])
    # Single-sided surfaces emit from their front only.
    if material.use_backface_culling:
        geometry = node_tree.nodes.new("ShaderNodeNewGeometry")
        dark = node_tree.nodes.new("ShaderNodeEmission")
        dark.inputs["Strength"].default_value = 0.0
        front = node_tree.nodes.new("ShaderNodeMixShader")
        node_tree.links.new(geometry.outputs["Backfacing"], front.inputs[0])
        node_tree.links.new(emission.outputs[0], front.inputs[1])
        node_tree.links.new(dark.outputs[0], front.inputs[2])
        emission = front
    total = node_tree.nodes.new("ShaderNodeAddShader")
    node_tree.links.new(diffuse.outputs[0], total.inputs[0])
    node_tree.links.new(emission.outputs[0], total.inputs[1])
    surface = total.outputs[0]
    if material.blend_method != "OPAQUE":
        through = node_tree.nodes.new("ShaderNodeBsdfTransparent")
        mix = node_tree.nodes.new("ShaderNodeMixShader")
        connect(principled.inputs["Alpha"], mix.inputs[0])
        if material.blend_method == "CLIP":
            step = node_tree.nodes.new("ShaderNodeMath")
            step.operation = "GREATER_THAN"
            step.inputs[1].default_value = material.alpha_threshold
            connect(principled.inputs["Alpha"], step.inputs[0])
            node_tree.links.new(step.outputs[0], mix.inputs[0])
        node_tree.links.new(through.outputs[0], mix.inputs[1])
        node_tree.links.new(surface, mix.inputs[2])
        surface = mix.outputs[0]
    node_tree.links.new(surface, output.inputs["Surface"])


def load(path):
    """Returns the meshes that have a place in the atlas."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=path)
    for light in bpy.data.lights:
        light.energy *= LUMENS_PER_WATT
        if light.type == "SUN":
            light.angle = 0.0
        else:
            light.shadow_soft_size = 0.0
    meshes = [o for o in bpy.data.objects if o.type == "MESH"]
    for material in {s.material for o in meshes for s in o.material_slots if s.material}:
        material.use_nodes = True
        lambertian(material, material.node_tree)
    return [o for o in meshes if len(o.data.uv_layers) > 1]


def settings(options):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.threads_mode, scene.render.threads = "FIXED", options.threads
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = options.denoise
    cycles.max_bounces = cycles.diffuse_bounces = options.bounces
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.light_sampling_threshold = 0
    bake = scene.render.bake
    bake.margin, bake.use_clear, bake.use_selected_to_active, bake.use_pass_color = 0, True, False, False
    return scene


def target(objects, size):
    image = bpy.data.images.new("irradiance", size, size, alpha=True, float_buffer=True, is_data=True)
    image.generated_color = (0, 0, 0, 0)
    bpy.ops.object.select_all(action="DESELECT")
    for o in objects:
        o.data.uv_layers.active_index = 1
        o.select_set(True)
    for nodes in {s.material.node_tree.nodes for o in objects for s in o.material_slots}:
        node = nodes.get("irradiance") or nodes.new("ShaderNodeTexImage")
        node.name, node.image, node.select = "irradiance", image, True
        nodes.active = node
    bpy.context.view_layer.objects.active = objects[0]
    return image


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("scene")
    parser.add_argument("--size", type=int, required=True)
    parser.add_argument("--threads", type=int, required=True)
    parser.add_argument("--bounces", type=int, default=64)
    parser.add_argument("--denoise", action="store_true")
    parser.add_argument("runs", nargs="+")
    options = parser.parse_args(sys.argv[sys.argv.index("--") + 1:])
    objects = load(options.scene)
    if not objects:
        sys.exit("no mesh has a TEXCOORD_1")
    scene = settings(options)
    for run in options.runs:
        samples, seed, out = run.split(":", 2)
        scene.cycles.samples, scene.cycles.seed = int(samples), int(seed)
        image = target(objects, options.size)
        begin = time.perf_counter()
        bpy.ops.object.bake(type="DIFFUSE", pass_filter={"DIRECT", "INDIRECT"}, margin=0, use_clear=True)
        seconds = time.perf_counter() - begin
        texels = np.array(image.pixels[:], np.float32).reshape(options.size, options.size, 4)
        texels[..., :3] *= math.pi  # Cycles gives radiance of a white surface
        texels[~np.isfinite(texels).all(-1)] = 0
        image.pixels = texels.ravel().tolist()
        image.filepath_raw, image.file_format = out, "OPEN_EXR"
        image.save()
        bpy.data.images.remove(image)
        print(f"baked {samples} {seed} {seconds:.3f}", flush=True)


main()
