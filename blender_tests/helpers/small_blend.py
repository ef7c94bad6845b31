# SPDX-License-Identifier: GPL-3.0-or-later
"""A small scene in Blender, and rendering it to numbers in one line. For tests that run where bpy is."""

import bpy
from mathutils import Vector

from .exr import read_exr, read_rgba

SIZE = (48, 32)


def small_scene(samples=4, size=SIZE):
    """An empty file with a grey ball on a plane, a lamp, a grey world and a camera; the engine is Lambent."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "LAMBENT"
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.lambent.samples = samples
    scene.world = bpy.data.worlds.new("World")
    if not scene.world.node_tree:  # Blender 4
        scene.world.use_nodes = True
    bpy.ops.mesh.primitive_uv_sphere_add(segments=16, ring_count=8, location=(0, 0, 1))
    bpy.context.object.name = "Ball"
    bpy.ops.mesh.primitive_plane_add(size=6)
    bpy.context.object.name = "Ground"
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    lamp.location, lamp.data.energy, lamp.data.shadow_soft_size = (3, -3, 5), 800, 0.3
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location = (0, -7, 3)
    camera.rotation_euler = (Vector((0, 0, 1)) - camera.location).to_track_quat("-Z", "Y").to_euler()
    for new in (lamp, camera):
        scene.collection.objects.link(new)
    scene.camera = camera
    return scene


def render(path, scene=None, layers=False):
    """Render to an OpenEXR file of 32 bits: float32 (height, width, 4), or {channel: (height, width)} of all layers."""
    save_as_exr(scene or bpy.context.scene, path, layers)
    bpy.ops.render.render(write_still=True)
    return read_exr(path)[0] if layers else read_rgba(path)


def save_as_exr(scene, path, layers=False):
    image = scene.render.image_settings
    if hasattr(image, "media_type"):  # Blender 5
        image.media_type = "MULTI_LAYER_IMAGE" if layers else "IMAGE"
    image.file_format = "OPEN_EXR_MULTILAYER" if layers else "OPEN_EXR"
    image.color_depth, image.exr_codec = "32", "NONE"
    if not layers:
        image.color_mode = "RGBA"
    elif hasattr(image, "use_exr_interleave"):  # Blender 5: one part in the file, as in Blender 4
        image.use_exr_interleave = True
    scene.render.filepath = str(path)


def enable_cycles():
    import addon_utils  # can be found only after bpy is imported

    addon_utils.enable("cycles")
