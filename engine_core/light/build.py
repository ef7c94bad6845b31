# SPDX-License-Identifier: GPL-3.0-or-later
"""Build the tree of lights: halve top down by binned costs, join bounds bottom up, open halves until nodes are full.

The cost is the surface area orientation heuristic of Conty Estevez and Kulla (2018, section 4.4): power, times surface
of the bounds, times the measure of the directions they shine into, summed over both sides of a split. Here in what
sampling looks at: intensity for power, and the surface of the ball around the box, so that lights in a row or in a
plane, whose boxes have none, are told apart as well.
"""

import math

import numpy as np

from ..jit import kernel
from ..linalg.records import Tables, copy_record
from ..linalg.vec3 import BLACK, Vec3, cross, dot, length, load3, normalize, store3
from ..tables import LIGHT_NODE, LIGHT_WIDTH
from .bounds import CLUSTER, ROUNDING

MAX_BINS = 16
# Below SAH_DEPTH nodes are halved, so that no input makes a tree deeper than MAX_DEPTH: 30 more do for 2 ** 30 lights.
SAH_DEPTH = 40
MAX_DEPTH = SAH_DEPTH + 30
PI = np.float32(math.pi)
INFINITY = np.float32(np.inf)
HALF, ROUNDED = np.float32(0.5 * (1.0 + ROUNDING)), np.float32(ROUNDING)

ORDER = np.dtype([("number", "i4")])
TASK = np.dtype([("start", "i4"), ("end", "i4"), ("depth", "i4"), ("parent", "i4")])  # parent: of a second half, or -1
GROUP = np.dtype(
    [  # lights, added up
        ("lo", "f4", (3,)),
        ("hi", "f4", (3,)),
        ("axis", "f4", (3,)),  # sum of normals times intensity
        ("intensity", "f4"),
        ("count", "i4"),
        ("cost", "f4"),  # of all groups from here on
    ]
)


class BinaryWork(Tables):
    lights = CLUSTER
    order = ORDER  # of lights, sorted so that each cluster owns a run of it
    clusters = CLUSTER
    tasks = TASK
    groups = GROUP  # MAX_BINS for each axis, and one to add up


class WideWork(Tables):
    clusters = CLUSTER
    tasks = TASK  # start: the cluster; parent: where its node hangs
    open = ORDER  # clusters that become the children of a node
    nodes = LIGHT_NODE


def build_tree(lights):
    """Rows of LIGHT_NODE, root first, over clusters of one light; none without lights."""
    clusters = build_binary(lights)
    nodes = np.zeros(max(len(lights) - 1, min(len(lights), 1)), LIGHT_NODE)
    if len(lights):
        tasks, children = np.empty(LIGHT_WIDTH * MAX_DEPTH, TASK), np.empty(LIGHT_WIDTH, ORDER)
        made = collapse(WideWork(clusters=clusters, tasks=tasks, open=children, nodes=nodes))
        nodes = nodes[:made].copy()
    return nodes


def build_binary(lights):
    """The binary tree over clusters of one light: rows of CLUSTER, parents before their children."""
    count = len(lights)
    clusters = np.empty(max(2 * count - 1, 0), CLUSTER)
    if count:
        work = BinaryWork(
            lights=lights,
            order=np.arange(count, dtype=np.int32).view(ORDER),
            clusters=clusters,
            tasks=np.empty(MAX_DEPTH + 2, TASK),
            groups=np.empty(3 * MAX_BINS + 1, GROUP),
        )
        halve(work, count)
        join_all(work, len(clusters))
    return clusters


# ---- Top down --------------------------------------------------------------------------------------------------------


@kernel
def halve(work, count):
    """Put all clusters in their places: those of one light whole, of others the child alone."""
    push(work, 0, 0, count, 0, -1)
    top, made = 1, 0
    while top > 0:
        top -= 1
        task = work.tasks[top]
        start, end, depth, parent = task.start, task.end, task.depth, task.parent
        row = made
        made += 1
        if parent >= 0:
            work.clusters[parent].child = row
        if end - start == 1:
            copy_record(work.clusters[row], work.lights[work.order[start].number])
            continue
        middle = start
        if depth < SAH_DEPTH and end - start > 2:
            middle = split(work, start, end)
        if middle in (start, end):  # too deep, or nothing tells the lights apart
            middle = (start + end) >> 1
        push(work, top, middle, end, depth + 1, row)
        push(work, top + 1, start, middle, depth + 1, -1)  # comes next, and so stands right behind its parent
        top += 2


@kernel
def push(work, top, start, end, depth, parent):
    task = work.tasks[top]
    task.start, task.end, task.depth, task.parent = start, end, depth, parent


@kernel
def split(work, start, end):
    """Sort the lights from `start` to `end` into two runs; returns where the second starts."""
    lo, hi = Vec3(INFINITY, INFINITY, INFINITY), Vec3(-INFINITY, -INFINITY, -INFINITY)
    for i in range(start, end):
        centre = load3(work.lights[work.order[i].number], "centre")
        lo, hi = lower(lo, centre), upper(hi, centre)
    bins = min(MAX_BINS, 4 + ((end - start) >> 1))
    extent = hi - lo
    scale = Vec3(bin_scale(extent.x, bins), bin_scale(extent.y, bins), bin_scale(extent.z, bins))
    for axis in range(3):
        for k in range(axis * MAX_BINS, axis * MAX_BINS + bins):
            clear(work.groups[k])
    last = np.int32(bins - 1)
    for i in range(start, end):
        light = work.lights[work.order[i].number]
        place = (load3(light, "centre") - lo) * scale
        add_light(work.groups[min(np.int32(place.x), last)], light)
        add_light(work.groups[MAX_BINS + min(np.int32(place.y), last)], light)
        add_light(work.groups[2 * MAX_BINS + min(np.int32(place.z), last)], light)

    best, best_axis, best_bin = INFINITY, 0, bins
    for axis in range(3):
        first = axis * MAX_BINS
        total = work.groups[3 * MAX_BINS]
        clear(total)
        for k in range(first + bins - 1, first, -1):
            add_group(total, work.groups[k])
            work.groups[k].cost = cost(total)
        clear(total)
        for k in range(bins - 1):
            add_group(total, work.groups[first + k])
            if 0 < total.count < end - start:
                both = cost(total) + work.groups[first + k + 1].cost
                if both < best:
                    best, best_axis, best_bin = both, axis, k

    i, j = start, end - 1
    while i <= j:
        number = work.order[i].number
        place = (load3(work.lights[number], "centre") - lo) * scale
        along = place.x if best_axis == 0 else (place.y if best_axis == 1 else place.z)
        if min(np.int32(along), last) <= best_bin:
            i += 1
        else:
            work.order[i].number = work.order[j].number
            work.order[j].number = number
            j -= 1
    return i


@kernel
def bin_scale(extent, bins):
    """Bins for each metre; 0 along an axis on which the centres do not differ."""
    return np.float32(bins) / extent if extent > 1e-30 else np.float32(0.0)


@kernel
def clear(group):
    store3(group, "lo", Vec3(INFINITY, INFINITY, INFINITY))
    store3(group, "hi", Vec3(-INFINITY, -INFINITY, -INFINITY))
    store3(group, "axis", BLACK)
    group.intensity, group.count = 0.0, 0


@kernel
def add_light(group, light):
    """Add a light. The mean of directions spread evenly over a cone is shorter than they, by (1 + cos theta_o) / 2."""
    centre, half = load3(light, "centre"), load3(light, "half")
    store3(group, "lo", lower(load3(group, "lo"), centre - half))
    store3(group, "hi", upper(load3(group, "hi"), centre + half))
    mean = load3(light, "axis") * (light.intensity * (0.5 + 0.5 * math.cos(light.theta_o)))
    store3(group, "axis", load3(group, "axis") + mean)
    group.intensity += light.intensity
    group.count += 1


@kernel
def add_group(group, other):
    store3(group, "lo", lower(load3(group, "lo"), load3(other, "lo")))
    store3(group, "hi", upper(load3(group, "hi"), load3(other, "hi")))
    store3(group, "axis", load3(group, "axis") + load3(other, "axis"))
    group.intensity += other.intensity
    group.count += other.count


@kernel
def cost(group):
    """Intensity x surface x directions.

    Lambertian emitters whose normals fill a cone shine into a measure of directions (their equation 1) from pi, where
    all are parallel, to 4 pi. Over the length of the mean normal, from 1 to 0, it is about pi + 3 pi sqrt(1 - length).
    """
    if group.count == 0:
        return np.float32(0.0)
    diagonal = load3(group, "hi") - load3(group, "lo")
    spread = max(1.0 - length(load3(group, "axis")) / group.intensity, 0.0)
    return group.intensity * dot(diagonal, diagonal) * (1.0 + 3.0 * math.sqrt(spread))


# ---- Bottom up -------------------------------------------------------------------------------------------------------


@kernel
def join_all(work, count):
    for row in range(count - 1, -1, -1):
        cluster = work.clusters[row]
        if cluster.child > 0:
            join(cluster, work.clusters[row + 1], work.clusters[cluster.child])
            join_cones(cluster, work.clusters[row + 1], work.clusters[cluster.child])


@kernel
def join(cluster, a, b):
    """Make `cluster` bound what `a` and `b` bound."""
    centre_a, half_a, centre_b, half_b = load3(a, "centre"), load3(a, "half"), load3(b, "centre"), load3(b, "half")
    lo, hi = lower(centre_a - half_a, centre_b - half_b), upper(centre_a + half_a, centre_b + half_b)
    centre = (lo + hi) * 0.5
    store3(cluster, "centre", centre)
    store3(cluster, "half", (hi - lo) * HALF + upper(centre, -centre) * ROUNDED)
    cluster.intensity = a.intensity + b.intensity
    largest = a.intensity * a.closest * a.closest + b.intensity * b.closest * b.closest  # irradiance
    cluster.closest = math.sqrt(largest / cluster.intensity)


@kernel
def join_cones(cluster, a, b):
    """The smallest cone around two; if one of them counts on both sides, its axis may be turned around."""
    axis, axis_b = load3(a, "axis"), load3(b, "axis")
    theta, theta_b = a.theta_o, b.theta_o
    two_sided = a.two_sided != 0 or b.two_sided != 0
    if two_sided and dot(axis, axis_b) < 0.0:
        axis_b = -axis_b
    cosine = dot(axis, axis_b)
    between = math.atan2(length(cross(axis, axis_b)), cosine)
    if between + theta <= theta_b:
        axis, theta = axis_b, theta_b
    elif between + theta_b > theta:
        turn = 0.5 * (theta_b + between - theta)
        theta += turn
        if cosine > -0.999:
            axis = normalize(axis * math.cos(turn) + normalize(axis_b - axis * cosine) * math.sin(turn))
        else:  # in which plane to turn is not to be told
            theta = PI
    if theta >= (0.5 * PI if two_sided else PI):
        axis, theta, two_sided = Vec3(0.0, 0.0, 1.0), PI, False
    store3(cluster, "axis", axis)
    cluster.theta_o, cluster.theta_e = theta, max(a.theta_e, b.theta_e)
    cluster.two_sided = 1 if two_sided else 0


@kernel
def lower(a, b):
    return Vec3(min(a.x, b.x), min(a.y, b.y), min(a.z, b.z))


@kernel
def upper(a, b):
    return Vec3(max(a.x, b.x), max(a.y, b.y), max(a.z, b.z))


# ---- From two children to many ---------------------------------------------------------------------------------------


@kernel
def collapse(work):
    """Make nodes of clusters; returns how many."""
    push(work, 0, 0, 0, 0, -1)
    top, made = 1, 0
    while top > 0:
        top -= 1
        task = work.tasks[top]
        parent = task.parent
        if parent >= 0:
            work.nodes[parent // LIGHT_WIDTH].child[parent % LIGHT_WIDTH] = made
        count = open_children(work, task.start)
        node = work.nodes[made]
        node.parent = parent
        for k in range(count):
            row = work.open[k].number
            cluster = work.clusters[row]
            set_child(node, k, cluster)
            if cluster.child > 0:
                push(work, top, row, 0, 0, made * LIGHT_WIDTH + k)
                top += 1
        made += 1
    return made


@kernel
def open_children(work, row):
    """Halve clusters, always the one that is strongest for its size, until they fill a node; returns their number.

    They stay in their order in space, so that random numbers that are near each other choose lights that are.
    """
    count = 1
    work.open[0].number = row
    while count < LIGHT_WIDTH:
        best, largest = -1, np.float32(-1.0)
        for k in range(count):
            cluster = work.clusters[work.open[k].number]
            half = load3(cluster, "half")
            size = cluster.intensity * dot(half, half)
            if cluster.child > 0 and size > largest:
                best, largest = k, size
        if best < 0:
            return count
        for k in range(count, best + 1, -1):
            work.open[k].number = work.open[k - 1].number
        opened = work.open[best].number
        work.open[best].number, work.open[best + 1].number = opened + 1, work.clusters[opened].child
        count += 1
    return count


@kernel
def set_child(node, k, cluster):
    """Child `k`; a node among them gets its row when it is made."""
    half = load3(cluster, "half")
    for axis in range(3):
        node.centre[axis, k], node.half[axis, k] = cluster.centre[axis], cluster.half[axis]
        node.axis[axis, k] = cluster.axis[axis]
    everywhere = cluster.theta_o >= PI
    node.radius[k] = length(half)
    node.cos_o[k] = -1.0 if everywhere else math.cos(cluster.theta_o)
    node.sin_o[k] = 0.0 if everywhere else math.sin(cluster.theta_o)
    node.cos_oe[k] = math.cos(min(cluster.theta_o + cluster.theta_e, PI))
    node.two_sided[k] = 1.0 if cluster.two_sided != 0 else -1.0
    node.intensity[k], node.closest[k], node.child[k] = cluster.intensity, cluster.closest, cluster.child
