# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene for Mitsuba 3, from what a SceneBuilder holds: the same triangles, spheres, materials, lights and camera.

    scene = MitsubaScene(builder, size=(128, 128), max_bounces=12, variant="llvm_ad_rgb")
    picture = scene.render(samples=64, seed=1)

What Mitsuba cannot express as it is, such as layered materials, raises NotExpressibleError. Its pixel filter is a box,
the only one that leaves the noise of pixels independent.
"""

import ctypes.util
import glob
import math
import os
import tempfile
from pathlib import Path

import numpy as np

from engine_core.scene.flattening import lower
from engine_core.shader.graph import Node, Part, is_constant
from engine_core.shader.opcodes import Op
from engine_core.tables import FresnelKind, LightKind, LobeKind, Visibility

FAR = 1e4  # metres to a disk that stands for the sun
LIBRARIES = ("/usr/lib/*/libLLVM*19*", "/usr/lib/llvm-19/lib/libLLVM*", "/usr/lib64/libLLVM*19*")
FLIP = np.diag([-1.0, 1.0, -1.0, 1.0])  # Mitsuba's cameras look along +z


class NotExpressibleError(Exception):
    """What the scene has that Mitsuba has not."""


def available_variants():
    """Names of variants that run here: "scalar_rgb", and "llvm_ad_rgb" where there is LLVM 19."""
    library = os.environ.get("DRJIT_LIBLLVM_PATH") or find_llvm()
    if library is None:
        return ["scalar_rgb"]
    os.environ["DRJIT_LIBLLVM_PATH"] = library  # read when a variant is chosen
    return ["scalar_rgb", "llvm_ad_rgb"]


def version():
    import mitsuba

    return mitsuba.__version__


def find_llvm():
    """Path of a library of LLVM 19, or None."""
    found = [path for pattern in LIBRARIES for path in sorted(glob.glob(pattern))]
    return found[0] if found else ctypes.util.find_library("LLVM-19")


class MitsubaScene:
    """A scene that is loaded in one variant of Mitsuba."""

    def __init__(self, builder, size, max_bounces, variant):
        import mitsuba

        mitsuba.set_variant(variant)
        mitsuba.set_log_level(mitsuba.LogLevel.Error)
        self._mitsuba, self._variant = mitsuba, variant
        with tempfile.TemporaryDirectory() as folder:
            self._scene = mitsuba.load_dict(scene_dict(mitsuba, builder, size, max_bounces, Path(folder)))

    def render(self, samples, seed):
        """Scene-linear picture, float32 (h, w, 3), bottom row first."""
        self._mitsuba.set_variant(self._variant)
        picture = np.array(self._mitsuba.render(self._scene, spp=samples, seed=seed))
        return picture[::-1, :, :3]


def scene_dict(mitsuba, builder, size, max_bounces, folder):
    """What `mitsuba.load_dict` takes; meshes are written to files in `folder`."""
    scene = {"type": "scene", "integrator": {"type": "path", "max_depth": max_bounces + 2}}
    scene["sensor"] = camera(mitsuba, builder.camera_row[0], size)
    used = {material_of(builder, placement, slot) for placement in builder.placements for slot in range(32)}
    for number in sorted(used):
        scene[f"material{number}"] = surface(builder.materials[number])
    for number, placement in enumerate(builder.placements):
        geometry = builder.geometries[placement.geometry]
        add = add_spheres if hasattr(geometry, "radii") else add_mesh
        if not hasattr(geometry, "radii") and not hasattr(geometry, "triangles"):
            raise NotExpressibleError(type(geometry).__name__)
        add(scene, builder, placement, geometry, folder / f"{number}", f"shape{number}")
    for number, light in enumerate(builder.lights):
        scene[f"light{number}"] = lamp(mitsuba, light)
    scene |= world(mitsuba, builder.world_radiance)
    return scene


def rgb(values):
    return {"type": "rgb", "value": [float(value) for value in values]}


def camera(mitsuba, row, size):
    left, right, bottom, top = (float(value) for value in row["screen"])
    if row["kind"] != 0 or abs(left + right) > 1e-5 or abs(bottom + top) > 1e-5:
        raise NotExpressibleError("a camera that is shifted or orthographic")
    matrix = np.vstack([row["to_world"], [0, 0, 0, 1]]).astype(float) @ FLIP
    sensor = {
        "type": "perspective",
        "fov": math.degrees(2.0 * math.atan((right - left) / 2.0)),
        "fov_axis": "x",
        "near_clip": 0.01,
        "far_clip": 1e5,
        "to_world": mitsuba.ScalarTransform4f(matrix),
        "film": {"type": "hdrfilm", "width": size[0], "height": size[1], "pixel_format": "rgb",
                 "component_format": "float32", "rfilter": {"type": "box"}},
        "sampler": {"type": "independent"},
    }  # fmt: skip
    if row["lens_radius"] > 0.0:
        sensor["type"] = "thinlens"
        sensor["aperture_radius"], sensor["focus_distance"] = float(row["lens_radius"]), float(row["focus_distance"])
    return sensor


# ---- Materials -------------------------------------------------------------------------------------------------------


def surface(material):
    """The BSDF of a material: of one lobe, or of two that are mixed."""
    if any(varying for _, varying in material.surface.closures):
        raise NotExpressibleError(f"{material.name}: a value that varies")
    lobes = [lobe for lobe in lower([row for row, _ in material.surface.closures])[0] if np.any(lobe["weight"])]
    if not lobes:
        return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": rgb((0, 0, 0))}}
    if len(lobes) > 2:
        raise NotExpressibleError(f"{material.name}: {len(lobes)} lobes")
    if len(lobes) == 1:
        return two_sided(scatter(material.name, lobes[0], 1.0))
    shares = np.array([lobe["weight"].max() for lobe in lobes])
    shares = shares / shares.sum()
    inner = [scatter(material.name, lobe, share) for lobe, share in zip(lobes, shares, strict=True)]
    return two_sided({"type": "blendbsdf", "weight": float(shares[1]), "a": inner[0], "b": inner[1]})


def two_sided(bsdf):
    return bsdf if "dielectric" in bsdf["type"] else {"type": "twosided", "bsdf": bsdf}


def scatter(name, lobe, share):
    """One lobe, chosen for a share of the light: its weight is divided by that."""
    weight, kind = lobe["weight"].astype(float) / share, LobeKind(int(lobe["kind"]))
    alpha = float(lobe["alpha_x"])
    if lobe["alpha_y"] != lobe["alpha_x"] or (lobe["multiscatter"] and alpha > 0.0) or lobe["layer"]:
        raise NotExpressibleError(f"{name}: anisotropic, layered or compensated")
    if kind == LobeKind.DIFFUSE:
        return {"type": "diffuse", "reflectance": rgb(weight)}
    rough = {"distribution": "ggx", "alpha": alpha} if alpha > 0.0 else {}
    if kind == LobeKind.CONDUCTOR and lobe["fresnel"] == FresnelKind.CONSTANT:
        kind = "roughconductor" if rough else "conductor"
        return {"type": kind, "material": "none", "specular_reflectance": rgb(weight * lobe["f0"]), **rough}
    if kind == LobeKind.DIELECTRIC:
        return {
            "type": "roughdielectric" if rough else "dielectric",
            "int_ior": float(lobe["ior"]),
            "ext_ior": 1.0,
            "specular_reflectance": rgb(weight * lobe["reflect_tint"]),
            "specular_transmittance": rgb(weight * lobe["refract_tint"]),
            **rough,
        }
    raise NotExpressibleError(f"{name}: {kind.name}")


def with_surface(shape, builder, number):
    """The shape with its material, and what that emits: from the front, where ours shines to both sides."""
    emission = builder.materials[number].surface.emission
    shape["bsdf"] = {"type": "ref", "id": f"material{number}"}
    if not is_constant(emission):
        shape["emitter"] = {"type": "area", "radiance": {"type": "bitmap", **bitmap(emission, Op.IMAGE)}}
    elif np.any(emission):
        shape["emitter"] = {"type": "area", "radiance": rgb(emission)}
    return shape


def bitmap(value, op):
    """Of a value that is an image, looked up by `op` with its usual coordinates, times a number."""
    import mitsuba

    if isinstance(value, Part) and value.node.op == op and value.offset == 0:
        image = value.node.data
        rows = slice(None, None, -1 if op == Op.ENVIRONMENT else 1)  # textures begin below, skies above
        pixels = image.pixels[rows, :, :3].astype(np.float32) / (255.0 if image.pixels.dtype == np.uint8 else 1.0)
        if image.is_srgb:
            pixels = np.where(pixels <= 0.04045, pixels / 12.92, ((pixels + 0.055) / 1.055) ** 2.4)
        return {"bitmap": mitsuba.Bitmap(np.ascontiguousarray(pixels, np.float32)), "raw": True}
    if isinstance(value, Node) and value.op == Op.SCALE and is_constant(value.operands[1]):
        found = bitmap(value.operands[0], op)
        pixels = np.array(found["bitmap"]) * np.float32(value.operands[1])
        return {**found, "bitmap": mitsuba.Bitmap(pixels)}
    raise NotExpressibleError("emission by more than an image")


# ---- Shapes ----------------------------------------------------------------------------------------------------------


def add_spheres(scene, builder, placement, geometry, _, name):
    matrix = np.asarray(placement.to_world, float)
    scales = np.linalg.norm(matrix[:3, :3], axis=0)
    if np.ptp(scales) > 1e-4 * scales.max():
        raise NotExpressibleError(f"{placement.name}: an ellipsoid")
    number = material_of(builder, placement, 0)
    centres = geometry.centres @ matrix[:3, :3].T + matrix[:3, 3]
    for i, (centre, radius) in enumerate(zip(centres, geometry.radii * scales[0], strict=True)):
        sphere = {"type": "sphere", "center": [float(c) for c in centre], "radius": float(radius)}
        scene[f"{name}_{i}"] = with_surface(sphere, builder, number)


def add_mesh(scene, builder, placement, geometry, path, name):
    """A file for each material slot. What Mitsuba calls instances cannot shine, so all are written out."""
    matrix = np.asarray(placement.to_world, float)
    if len(builder.placements) * len(geometry.triangles) > 5_000_000:
        raise NotExpressibleError(f"{len(builder.placements)} instances")
    slots = np.zeros(len(geometry.triangles), int) if geometry.slots is None else geometry.slots
    for slot in np.unique(slots):
        chosen = slots == slot
        corners = geometry.positions[geometry.triangles[chosen]] @ matrix[:3, :3].T + matrix[:3, 3]
        normals = None
        if geometry.normals is not None:
            normals = geometry.normals[chosen] @ np.linalg.inv(matrix[:3, :3])
            normals = normals / np.linalg.norm(normals, axis=-1, keepdims=True)
        uvs = None if geometry.uvs is None else geometry.uvs[chosen]
        if np.linalg.det(matrix[:3, :3]) < 0.0:  # mirrored: the front stays in front
            corners, normals, uvs = (None if a is None else a[:, ::-1] for a in (corners, normals, uvs))
        file = path.with_name(f"{path.name}_{slot}.ply")
        write_ply(file, corners, normals, uvs)
        mesh = {"type": "ply", "filename": str(file), "face_normals": normals is None}
        scene[f"{name}_{slot}"] = with_surface(mesh, builder, material_of(builder, placement, slot))


def material_of(builder, placement, slot):
    if not placement.materials:
        return builder.default_material
    return placement.materials[min(slot, len(placement.materials) - 1)]


def write_ply(path, corners, normals, uvs):
    """Triangles, (n, 3, 3), that share no corners."""
    count = len(corners)
    given = [(corners, ("x", "y", "z")), (normals, ("nx", "ny", "nz")), (uvs, ("u", "v"))]
    given = [(values, names) for values, names in given if values is not None]
    columns = np.hstack([values.reshape(3 * count, -1) for values, _ in given])
    names = [name for _, of_one in given for name in of_one]
    faces = np.zeros(count, [("size", "u1"), ("corners", "<i4", (3,))])
    faces["size"], faces["corners"] = 3, np.arange(3 * count).reshape(-1, 3)
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {3 * count}"]
    header += [f"property float {name}" for name in names]
    header += [f"element face {count}", "property list uchar int vertex_indices", "end_header\n"]
    with open(path, "wb") as file:
        file.write("\n".join(header).encode())
        file.write(columns.astype("<f4").tobytes() + faces.tobytes())


# ---- Lamps -----------------------------------------------------------------------------------------------------------


def world(mitsuba, radiance):
    if not is_constant(radiance):
        image = bitmap(radiance, Op.ENVIRONMENT)["bitmap"]
        # Mitsuba's pictures of all directions have y up, and z in the middle; Blender's z up, and x in the middle
        turn = mitsuba.ScalarTransform4f([[0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
        return {"world": {"type": "envmap", "bitmap": image, "to_world": turn}}
    return {"world": {"type": "constant", "radiance": rgb(radiance)}} if np.any(radiance) else {}


def lamp(mitsuba, light):
    kind, position = LightKind(int(light["kind"])), [float(c) for c in light["p"]]
    if kind == LightKind.POINT and light["is_delta"]:
        return {"type": "point", "position": position, "intensity": rgb(light["emission"])}
    if kind == LightKind.POINT and not light["visibility"] & Visibility.CAMERA.value:
        raise NotExpressibleError("a lamp that the camera does not see")
    if kind == LightKind.POINT and not light["soft"]:
        emitter = {"type": "area", "radiance": rgb(light["emission"])}
        ball = {"type": "sphere", "center": position, "radius": float(light["radius"])}
        return {**ball, "bsdf": {"type": "null"}, "emitter": emitter}  # a lamp is in nobody's way
    if kind == LightKind.SUN and not light["is_delta"]:
        n = light["n"].astype(float)
        radius = FAR * math.tan(math.acos(1.0 - float(light["height"])))
        transform = mitsuba.ScalarTransform4f
        up = [0.0, 0.0, 1.0] if abs(n[2]) < 0.9 else [1.0, 0.0, 0.0]
        place = transform().look_at(origin=list(-FAR * n), target=[0.0, 0.0, 0.0], up=up) @ transform().scale(radius)
        emitter = {"type": "area", "radiance": rgb(light["emission"])}
        return {"type": "disk", "to_world": place, "bsdf": {"type": "null"}, "emitter": emitter}
    raise NotExpressibleError(f"a lamp of kind {kind.name}")
