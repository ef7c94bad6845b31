# SPDX-License-Identifier: GPL-3.0-or-later
"""Tight boxes around instances.

The box of a turned box is up to twice as large as what is in it, and each needless box is a walk into an instance's
tree: among 10,000 turned monkeys that touch each other, rays enter 1.4 instead of 2.6 instances. So the tree of the
mesh is asked how far its corners reach along each axis of the world; that takes a few dozen of its nodes, whatever its
size.
"""

from concurrent.futures import ThreadPoolExecutor

import numpy as np

from ..jit import kernel
from .binary import MAX_DEPTH
from .build import THREADS
from .nodes import WIDTH

STACK = MAX_DEPTH * 8
INFINITY = np.float32(np.inf)
# Transforms are rounded, here and where rays go through them; boxes are widened by some units in the last place.
MARGIN = np.float32(4e-6)


def instance_boxes(nodes, packets, *rows):
    """As `fill_boxes`, on all cores."""
    count = len(rows[0])
    step = max(count // (8 * THREADS), 1024)
    parts = [[array[i : i + step] for array in rows] for i in range(0, count, step)]
    fill_boxes(nodes, packets, *parts[0])  # in this thread, which compiles
    with ThreadPoolExecutor(THREADS) as threads:
        list(threads.map(lambda part: fill_boxes(nodes, packets, *part), parts[1:]))


@kernel
def fill_boxes(nodes, packets, roots, has_packets, to_world, lo, hi):
    """Fill boxes lo, hi, float32 (n, 3), around the trees at `roots` (n,) moved by `to_world`, float32 (n, 3, 4).

    `has_packets` (n,): whether its leaves are triangles; otherwise their boxes are taken.
    """
    stack, reach = np.empty(STACK, np.int32), np.empty(STACK, np.float32)
    for i in range(roots.shape[0]):
        for axis in range(3):
            a, b, c = to_world[i, axis, 0], to_world[i, axis, 1], to_world[i, axis, 2]
            t = to_world[i, axis, 3]
            up = furthest(nodes, packets, roots[i], has_packets[i], a, b, c, stack, reach)
            down = furthest(nodes, packets, roots[i], has_packets[i], -a, -b, -c, stack, reach)
            margin = MARGIN * max(max(abs(up), abs(down)), abs(t))
            lo[i, axis], hi[i, axis] = t - down - margin, t + up + margin


@kernel
def furthest(nodes, packets, root, has_packets, a, b, c, stack, reach):
    """How far the leaves of a tree reach along the direction (a, b, c): the largest a x + b y + c z in them."""
    best = -INFINITY
    stack[0], reach[0] = root, INFINITY
    top = 1
    while top > 0:
        top -= 1
        if reach[top] <= best:
            continue
        node = nodes[stack[top]]
        bottom = top
        for k in range(8):
            bounds = node.bounds
            if bounds[0, k] > bounds[3, k]:
                continue  # no child here
            extent = (
                max(a * bounds[0, k], a * bounds[3, k])
                + max(b * bounds[1, k], b * bounds[4, k])
                + max(c * bounds[2, k], c * bounds[5, k])
            )
            if extent <= best:
                continue
            if node.child[k] < 0:
                best = max(best, furthest_corner(packets[~node.child[k]], a, b, c)) if has_packets else extent
                continue
            stack[top], reach[top] = node.child[k], extent
            if extent > reach[bottom]:  # the most promising one is looked at first: swap it down, then up
                stack[bottom], stack[top] = stack[top], stack[bottom]
                reach[bottom], reach[top] = reach[top], reach[bottom]
            top += 1
        if top > bottom:
            last = top - 1
            stack[bottom], stack[last] = stack[last], stack[bottom]
            reach[bottom], reach[last] = reach[last], reach[bottom]
    return best


@kernel
def furthest_corner(packet, a, b, c):
    """The same for the corners of a packet; missing triangles lie in a corner of another one."""
    p, best = packet.p, -INFINITY
    for corner in range(3):
        for k in range(WIDTH):
            best = max(best, a * p[corner, 0, k] + b * p[corner, 1, k] + c * p[corner, 2, k])
    return best
