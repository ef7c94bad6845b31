# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes `energy_tables.npz`: how much light GGX microfacets give back. Run as `python -m engine_core.bsdf.make_tables`.

Integrates over visible normals with the kernels of `microfacet`, on a grid of midpoints; twenty seconds.
See `energy.py` for what the tables mean and for their coordinates.
"""

import math
from pathlib import Path

import numpy as np

from ..jit import kernel
from ..linalg.vec3 import Vec3, dot, reflect
from ..tables import LOBE
from .fresnel import f0_of_ior, fresnel_dielectric, schlick
from .microfacet import refract, sample_visible_normal, stretched_length, unshadowed

PLANE_SIZE, VOLUME_SIZE = 32, 16
SMALLEST = 1e-3  # stands for 0 where a coordinate may not be 0
GRAZING = 1e-4  # the cosine that does for Cycles
LARGEST = 0.995  # stands for 1: an ior of 200


@kernel
def mirror(lobe, cos, n):
    """(albedo, mean (1 - cos)^5, mean cos (1 - cos)^6) of a mirror without Fresnel, by n x n microfacets."""
    wo = Vec3(math.sqrt(max(1.0 - cos * cos, 0.0)), 0.0, cos)
    so = stretched_length(lobe, wo)
    total, fifth, sixth = np.float64(0), np.float64(0), np.float64(0)
    for i in range(n):
        for j in range(n):
            u0, u1 = (np.float32(i) + 0.5) / np.float32(n), (np.float32(j) + 0.5) / np.float32(n)
            h = sample_visible_normal(lobe, wo, so, u0, u1)
            wi, cos_h = reflect(wo, h), dot(wo, h)
            if wi.z > 0.0:
                weight = unshadowed(lobe, wo, so, wi)
                total += weight
                fifth += weight * schlick(cos_h)
                sixth += weight * schlick(cos_h) * cos_h * (1.0 - cos_h)
    return total / (n * n), fifth / total, sixth / total


@kernel
def glass(lobe, cos, n):
    """(reflected, refracted) share of light, by n x n microfacets; `ior` of the lobe."""
    wo = Vec3(math.sqrt(max(1.0 - cos * cos, 0.0)), 0.0, cos)
    so = stretched_length(lobe, wo)
    reflected, refracted = np.float64(0), np.float64(0)
    for i in range(n):
        for j in range(n):
            u0, u1 = (np.float32(i) + 0.5) / np.float32(n), (np.float32(j) + 0.5) / np.float32(n)
            h = sample_visible_normal(lobe, wo, so, u0, u1)
            cos_h = dot(wo, h)
            reflectance, cos_t = fresnel_dielectric(cos_h, lobe.ior)
            wi = reflect(wo, h)
            if wi.z > 0.0:
                reflected += reflectance * unshadowed(lobe, wo, so, wi)
            wi = refract(wo, h, cos_h, cos_t, lobe.ior)
            if cos_t > 0.0 and wi.z < 0.0:
                refracted += (1.0 - reflectance) * unshadowed(lobe, wo, so, wi)
    return reflected / (n * n), refracted / (n * n)


@kernel
def rise(lobe, cos, n):
    """Mean of (F - F0) / (1 - F0) over n x n visible microfacets, those that reflect below the horizon taken as F0."""
    wo = Vec3(math.sqrt(max(1.0 - cos * cos, 0.0)), 0.0, cos)
    so, f0, total = stretched_length(lobe, wo), f0_of_ior(lobe.ior), np.float64(0)
    for i in range(n):
        for j in range(n):
            u0, u1 = (np.float32(i) + 0.5) / np.float32(n), (np.float32(j) + 0.5) / np.float32(n)
            h = sample_visible_normal(lobe, wo, so, u0, u1)
            if reflect(wo, h).z > 0.0:
                reflectance, _ = fresnel_dielectric(dot(wo, h), lobe.ior)
                total += max((reflectance - f0) / (1.0 - f0), 0.0)
    return total / (n * n)


def make_planes(points=400):
    """(planes, ggx_average)"""
    planes = np.zeros((3, PLANE_SIZE, PLANE_SIZE), np.float32)
    axis = np.linspace(0.0, 1.0, PLANE_SIZE)
    for i, roughness in enumerate(axis):
        lobe = lobe_of(roughness)
        for j, y in enumerate(axis):
            planes[0, i, j] = mirror(lobe, np.float32(max(y, GRAZING)), points)[0]
            planes[1:, i, j] = mirror(lobe, np.float32(max(y, SMALLEST)), points)[1:]
    planes[planes < 1e-20] = 0.0  # numbers so small that processors are slow with them
    average = [mean_over_views(lambda cos, lobe=lobe: mirror(lobe, cos, 64)[0]) for lobe in map(lobe_of, axis)]
    return planes, np.array(average, np.float32)


def make_volumes(points=128):
    """(volumes, glass_average)"""
    volumes = np.zeros((4, VOLUME_SIZE, VOLUME_SIZE, VOLUME_SIZE), np.float32)
    average = np.zeros((2, VOLUME_SIZE, VOLUME_SIZE), np.float32)
    axis = np.linspace(0.0, 1.0, VOLUME_SIZE)
    for k, index in enumerate(axis):
        r = min(max(index, 0.1 * SMALLEST**0.5), LARGEST) ** 2
        ior = (1.0 + r) / (1.0 - r)
        for i, roughness in enumerate(axis):
            outside, inside = lobe_of(roughness, ior), lobe_of(roughness, 1.0 / ior)
            for j, y in enumerate(axis):
                cos = cos_of_view(y, outside.alpha_x)
                reflected, refracted = glass(outside, cos, points)
                volumes[0, k, i, j] = reflected + refracted
                volumes[1, k, i, j] = sum(glass(inside, cos, points))
                smooth = mirror(outside, cos, points)[0] * fresnel_dielectric(cos, outside.ior)[0]
                volumes[2, k, i, j] = reflected / smooth
                volumes[3, k, i, j] = rise(outside, np.float32(max(y, GRAZING)), 2 * points)
            for side, lobe in enumerate((outside, inside)):
                average[side, k, i] = mean_over_views(lambda cos, lobe=lobe: sum(glass(lobe, cos, 32)))
    return volumes, average


def lobe_of(roughness, ior=1.0):
    lobe = np.zeros(1, LOBE).view(np.recarray)[0]
    lobe.alpha_x = lobe.alpha_y = max(roughness**2, SMALLEST**2)
    lobe.ior = ior
    return lobe


def cos_of_view(y, alpha):
    """Inverse of the coordinate y = cos (1 + alpha) / (cos + alpha)."""
    return np.float32(max(y * alpha / (1.0 + alpha - y), SMALLEST * alpha))


def mean_over_views(albedo, n=32):
    """Integral of 2 cos albedo(cos) d cos, by Gauss-Legendre points."""
    x, w = np.polynomial.legendre.leggauss(n)
    cos = 0.5 * (x + 1.0)
    return float(np.sum(w * cos * [albedo(np.float32(c)) for c in cos]))


def main():
    planes, ggx_average = make_planes()
    volumes, glass_average = make_volumes()
    path = Path(__file__).with_name("energy_tables.npz")
    np.savez(path, planes=planes, ggx_average=ggx_average, volumes=volumes, glass_average=glass_average)
    print(f"{path}: {path.stat().st_size} bytes")


if __name__ == "__main__":
    main()
