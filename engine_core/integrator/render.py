# SPDX-License-Identifier: GPL-3.0-or-later
"""The kernels that render a tile: samples of pixels, added to the film. One for each integrator.

Each is compiled when it is first called, so that nobody waits for integrators that nobody has chosen.
"""

import math

import numpy as np

from ..camera.dispatch import generate_ray
from ..camera.lens import is_pinhole
from ..film.filter import sample_filter
from ..film.sharing import area_of, give
from ..jit import kernel, variant
from ..linalg.transform import transform_point, transform_vector
from ..linalg.vec3 import BLACK, Vec3, dot, load3, store3
from ..motion import camera_at, new_camera, shutter_time
from ..sampling.sobol import make_sampler, make_sequence, sample_1d, sample_2d
from ..settings import IntegratorKind
from . import media, mixture, path, uniform
from .path import trace

ZERO = np.float32(0.0)
NO_DEPTH = np.float32(1e10)  # what Blender's depth pass says where nothing was hit
TOO_MUCH = np.float32(1e18)  # radiance that is an overflow or leads to one: its square is near what float32 can hold
Z_AXIS = Vec3(0.0, 0.0, 1.0)


@kernel
def depth_along_axis(camera, p):
    """Distance of `p` from the camera along the direction that it looks, as Blender's Depth pass has it."""
    back = transform_vector(camera, "to_world", Z_AXIS)
    eye = transform_point(camera, "to_world", BLACK)
    return dot(eye - p, back)


def render_tile(scene, settings, film, x0, y0, width, height, most):
    """Add to each pixel of a tile the samples that it still misses, but no more than `most`, by the paths of `trace`.

    `x0`, `y0`: the tile's lower left pixel on the film. Between two rows the kernel looks whether it was cancelled;
    returns the number of rows that it finished.
    """
    moving, scratch = scene.world[0].pose_count > 0, new_camera()
    scale_x, scale_y = 1.0 / np.float32(settings.width), 1.0 / np.float32(settings.height)
    for row in range(height):
        if film.control[0].cancel != 0:
            return row
        y = y0 + row
        for x in range(x0, x0 + width):
            pixel = film.pixels[y * settings.crop_width + x]
            count = min(pixel.target - pixel.samples, most)
            if count <= 0:
                continue
            frame_x, frame_y = x + settings.crop_x, y + settings.crop_y
            sequence, area = make_sequence(settings, frame_x, frame_y), area_of(settings, x, y)
            radiance, normal, albedo = BLACK, BLACK, BLACK
            alpha = np.float32(0.0)
            for index in range(pixel.samples, pixel.samples + count):
                sampler = make_sampler(sequence, index)
                u0, u1 = sample_2d(sampler, 0)
                if settings.share_samples != 0:
                    dx, dy = area.x + u0 * area.width - 0.5, area.y + u1 * area.height - 0.5
                else:
                    dx, dy = sample_filter(settings, u0, u1)
                time = shutter_time(scene.camera[0], sample_1d(sampler, 2)) if moving else ZERO
                camera = camera_at(scene, time, scratch)
                u0, u1 = (ZERO, ZERO) if is_pinhole(camera) else sample_2d(sampler, 1)
                ray = generate_ray(
                    camera,
                    (np.float32(frame_x) + 0.5 + dx) * scale_x,
                    (np.float32(frame_y) + 0.5 + dy) * scale_y,
                    u0,
                    u1,
                )
                s = trace(scene, settings, film, sampler, ray, time)
                L = s.L * settings.exposure
                if not abs(L.x) + abs(L.y) + abs(L.z) < TOO_MUCH:
                    L = BLACK  # one overflow in a million samples must not cost the pixel
                if settings.share_samples != 0:
                    give(film, settings, y * settings.crop_width + x, area, dx, dy, L, s.alpha)
                radiance = radiance + L
                alpha += s.alpha
                scattered = s.scattered * settings.exposure if math.isfinite(s.scattered) else np.float32(0.0)
                pixel.scattered += scattered
                pixel.scattered_square += scattered * scattered
                normal = normal + s.normal
                albedo = albedo + s.albedo
                if index == 0:
                    store3(pixel, "position", s.p)
                    pixel.depth = depth_along_axis(camera, s.p) if s.hit else NO_DEPTH
            store3(pixel, "radiance", load3(pixel, "radiance") + radiance)
            store3(pixel, "normal", load3(pixel, "normal") + normal)
            store3(pixel, "albedo", load3(pixel, "albedo") + albedo)
            pixel.alpha += alpha
            pixel.samples += count
    return height


RENDER_TILE = {  # in scenes without media
    IntegratorKind.BRUTE_FORCE: kernel(variant(render_tile, "by_brute_force", trace=uniform.trace)),
    IntegratorKind.MIXTURE: kernel(variant(render_tile, "by_mixture", trace=mixture.trace)),
    IntegratorKind.PATH: kernel(variant(render_tile, "by_path", trace=path.trace)),
}
RENDER_TILE_IN_MEDIA = {
    IntegratorKind.BRUTE_FORCE: kernel(variant(render_tile, "by_brute_force_in_media", trace=media.trace_uniform)),
    IntegratorKind.MIXTURE: kernel(variant(render_tile, "by_mixture_in_media", trace=media.trace_mixture)),
    IntegratorKind.PATH: kernel(variant(render_tile, "by_path_in_media", trace=media.trace_path)),
}
