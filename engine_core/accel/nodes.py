# SPDX-License-Identifier: GPL-3.0-or-later
"""The rows of a finished tree, NODE and PACKET: memory for them, and moving trees behind one another into one table."""

import numpy as np

from ..tables import PACKET

CORNERS = np.dtype([("p", "f4", (3, 3))])  # of a triangle, as a builder is handed them
WIDTH = PACKET["prim"].shape[0]  # triangles of a packet
CACHE_LINE = 64  # bytes; rows that start at one keep the SIMD loads of traversal from straddling two


def aligned_rows(count, dtype):
    """`count` rows of `dtype`, uninitialised, that start at a cache line."""
    size = count * np.dtype(dtype).itemsize
    memory = np.empty(size + CACHE_LINE, np.uint8)
    start = -memory.ctypes.data % CACHE_LINE
    return memory[start : start + size].view(dtype)


def rebase(nodes, node_offset, leaf_offset):
    """Move a tree with root 0 in place: its nodes to the rows from `node_offset`, its leaves' rows to `leaf_offset`."""
    child = nodes["child"]
    nodes["child"] = np.where(child >= 0, child + node_offset, child - leaf_offset)


def rebase_packets(packets, prim_offset):
    """Let packets mean triangles that stand `prim_offset` rows further on; in place."""
    packets["prim"] += np.where(packets["prim"] >= 0, np.int32(prim_offset), np.int32(0))
