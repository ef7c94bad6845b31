# SPDX-License-Identifier: GPL-3.0-or-later
"""Which media a path is in: a list that changes where it crosses their boundaries.

A path enters by a face's front and leaves by its back, whatever the shape is, convex or not. Several media in one place
add up. The list names the object by which each was entered, so that two objects of one material are told apart.
"""

from ..jit import kernel
from ..linalg.vec3 import BLACK, load3, store3
from ..medium_tables import MAX_MEDIA


@kernel
def nowhere(scene, media):
    """Begin in the open: only the world's medium, if it has one, is everywhere."""
    media.count = media.crossings = 0
    if scene.world[0].medium >= 0:
        media.instance[0], media.medium[0], media.count = -1, scene.world[0].medium, 1
    add_up(scene, media)


@kernel
def cross(scene, media, instance, medium, leaves):
    """Go through the boundary of the row of MEDIUM that belongs to the row of INSTANCE."""
    place = place_of(media, instance, medium)
    is_inside = place < media.count
    if leaves and is_inside:
        media.count -= 1
        media.instance[place], media.medium[place] = media.instance[media.count], media.medium[media.count]
    elif not leaves and not is_inside and place < MAX_MEDIA:
        media.instance[place], media.medium[place] = instance, medium
        media.count += 1
    add_up(scene, media)


@kernel
def place_of(media, instance, medium):
    """Where in the list it is; the list's length if it is not."""
    place = 0
    while place < media.count and (media.instance[place] != instance or media.medium[place] != medium):
        place += 1
    return place


@kernel
def contains(media, instance, medium):
    return place_of(media, instance, medium) < media.count


@kernel
def add_up(scene, media):
    sigma_t, sigma_s, emission = BLACK, BLACK, BLACK
    for i in range(media.count):
        medium = scene.media[media.medium[i]]
        sigma_t = sigma_t + load3(medium, "sigma_t")
        sigma_s = sigma_s + load3(medium, "sigma_s")
        emission = emission + load3(medium, "emission")
    store3(media, "sigma_t", sigma_t)
    store3(media, "sigma_s", sigma_s)
    store3(media, "emission", emission)
