# SPDX-License-Identifier: GPL-3.0-or-later
"""Trees: everything is in them once, inside all boxes on the way to it, and no input makes them too deep."""

import numpy as np
import pytest

from engine_core.accel import build
from engine_core.accel.binary import MAX_DEPTH
from engine_core.accel.boxes import STACK
from engine_core.accel.build import build_boxes, build_triangles, rebase, rebase_packets

RANDOM = np.random.default_rng(7)


def soup(count, size=0.1):
    return (RANDOM.random((count, 1, 3)) + size * RANDOM.random((count, 3, 3))).astype(np.float32)


def geometric_progression():
    """Triangles that halve in distance: any split by area takes off a few only."""
    scale = 2.0 ** -np.arange(0, 120, 0.125)
    return (np.array([[1, 0, 0], [1, 0.1, 0], [1, 0, 0.1]]) * scale[:, None, None]).astype(np.float32)


TRIANGLES = {
    "one": soup(1),
    "three": soup(3),
    "nine": soup(9),
    "thousand": soup(1000),
    "identical": np.repeat(soup(1), 1000, axis=0),
    "points": np.repeat(soup(500)[:, :1], 3, axis=1),
    "slivers": soup(500) * np.float32([1, 1e-6, 1]),
    "in a plane": soup(500) * np.float32([1, 0, 1]),
    "on a line": soup(500) * np.float32([0, 0, 1]),
    "huge": soup(500) * np.float32(1e30),
    "largest": (soup(500) - np.float32(0.5)) * np.float32(3e38),
    "tiny": soup(500) * np.float32(1e-40),
    "far away": soup(500) + np.float32(1e7),
    "geometric progression": geometric_progression(),
    # on a line all areas are 0, and any split as good as the next: without a limit each would take off a few triangles
    "chain": geometric_progression() * np.float32([-1, 0, 0]),
}


def leaves(nodes):
    """(row, path of (node, child)) of all leaves."""
    found, todo = [], [(0, ())]
    while todo:
        n, path = todo.pop()
        node = nodes[n]
        for c in range(8):
            if node["bounds"][0, c] > node["bounds"][3, c]:
                continue
            child = int(node["child"][c])
            here = (*path, (n, c))
            if child >= 0:
                todo.append((child, here))
            else:
                found.append((~child, here))
    return found


@pytest.mark.parametrize("name", TRIANGLES)
def test_triangles_are_in_the_tree_once_and_inside_its_boxes(name):
    p = TRIANGLES[name]
    nodes, packets = build_triangles(p)
    seen = []
    for row, path in leaves(nodes):
        held = packets[row]["prim"]
        held = held[held >= 0]
        seen.extend(held)
        for n, c in path:
            assert (p[held] >= nodes[n]["bounds"][:3, c]).all()
            assert (p[held] <= nodes[n]["bounds"][3:, c]).all()
    assert sorted(seen) == list(range(len(p)))


@pytest.mark.parametrize("name", TRIANGLES)
def test_packets_hold_the_corners_and_fill_up_with_triangles_without_area(name):
    p = TRIANGLES[name]
    _, packets = build_triangles(p)
    corners = packets["p"].transpose(0, 3, 1, 2).reshape(-1, 3, 3)
    prim = packets["prim"].ravel()
    np.testing.assert_array_equal(corners[prim >= 0], p[prim[prim >= 0]])
    assert (corners[prim < 0] == corners[prim < 0][:, :1]).all()


@pytest.mark.parametrize("name", TRIANGLES)
def test_the_stack_of_traversal_holds_any_tree(name):
    nodes, _ = build_triangles(TRIANGLES[name])
    needed = {0: 1}
    deepest = 0
    todo = [(0, 1, 1)]
    while todo:
        n, depth, below = todo.pop()
        child = nodes[n]["child"][nodes[n]["bounds"][0] <= nodes[n]["bounds"][3]]
        deepest, needed[0] = max(deepest, depth), max(needed[0], below + len(child))
        todo += [(c, depth + 1, below + len(child) - 1) for c in child if c >= 0]
    assert deepest <= MAX_DEPTH
    assert needed[0] <= STACK["keys"].shape[0]


def test_what_stands_together_is_together_in_the_tree():
    """Eight heaps of eight triangles far apart, in any order: one node, and a packet for each heap."""
    heap = np.arange(64) % 8
    corner = np.array([[x, y, z] for x in (0, 10) for y in (0, 13) for z in (0, 17)], np.float32)
    p = soup(64, 0.5) + corner[heap, None]
    nodes, packets = build_triangles(p)
    assert len(nodes) == 1
    assert len(packets) == 8
    assert (heap[packets["prim"]] == heap[packets["prim"]][:, :1]).all()


def test_boxes_are_in_the_order_of_their_leaves():
    lo = RANDOM.normal(size=(1000, 3))  # float64, so that rounding them to the nearest would cut off something
    hi = lo + RANDOM.random((1000, 3)) * 0.1
    nodes, order = build_boxes(lo, hi)
    found = leaves(nodes)
    assert sorted(row for row, _ in found) == list(range(1000))
    for first, path in found:
        for n, c in path:
            bounds = nodes[n]["bounds"][:, c].astype(np.float64)
            assert (lo[order[first]] >= bounds[:3]).all()
            assert (hi[order[first]] <= bounds[3:]).all()


def test_nothing_makes_no_tree():
    with pytest.raises(ValueError, match="not 0"):
        build_triangles(np.zeros((0, 3, 3), np.float32))
    with pytest.raises(ValueError, match="not 0"):
        build_boxes(np.zeros((0, 3)), np.zeros((0, 3)))


def test_rebased_trees_say_the_same_of_other_rows():
    nodes, packets = build_triangles(soup(300))
    before = leaves(nodes)
    moved = np.concatenate([nodes[:3], nodes])
    own = moved[3:].copy()
    rebase(own, 3, 1000)
    moved[3:] = own
    inner = nodes["child"] > 0
    np.testing.assert_array_equal(own["child"][inner], nodes["child"][inner] + 3)
    leaf = nodes["child"] < 0
    np.testing.assert_array_equal(~own["child"][leaf], ~nodes["child"][leaf] + 1000)
    assert before
    prim = packets["prim"].copy()
    rebase_packets(packets, 77)
    np.testing.assert_array_equal(packets["prim"], np.where(prim >= 0, prim + 77, -1))


@pytest.fixture(scope="module")
def large():
    """More than one thread is put to; half of it in one place, so that the upper part of the tree is lopsided."""
    p = soup(2 * build.WORTH_THREADS, 0.01)
    p[::2] *= np.float32(0.01)
    return p


def test_a_tree_is_the_same_on_any_number_of_threads(large, monkeypatch):
    trees = []
    for threads in (1, 2, 5):
        monkeypatch.setattr(build, "THREADS", threads)
        trees.append(build_triangles(large))
    for nodes, packets in trees[1:]:
        np.testing.assert_array_equal(nodes, trees[0][0])
        np.testing.assert_array_equal(packets, trees[0][1])


def test_what_threads_build_is_in_the_tree_once_and_inside_its_boxes(large):
    nodes, packets = build_triangles(large)
    found = leaves(nodes)
    assert sorted(row for row, _ in found) == list(range(len(packets)))
    prim = packets["prim"].ravel()
    assert sorted(prim[prim >= 0]) == list(range(len(large)))
    assert len(large) / len(packets) > 6.0  # of eight
    for row, path in found[::50]:
        held = packets[row]["prim"][packets[row]["prim"] >= 0]
        for n, c in path:
            assert (large[held] >= nodes[n]["bounds"][:3, c]).all()
            assert (large[held] <= nodes[n]["bounds"][3:, c]).all()


def test_building_twice_gives_the_same_tree():
    p = soup(2000)
    for first, second in zip(build_triangles(p), build_triangles(p), strict=True):
        np.testing.assert_array_equal(first, second)
