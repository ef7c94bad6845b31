# SPDX-License-Identifier: GPL-3.0-or-later
"""Boxes of instances hold all of the instance, and hardly more."""

import numpy as np
import pytest

from engine_core.accel.build import build_triangles
from engine_core.accel.instances import instance_boxes


def boxes_of(triangles, matrices):
    nodes, packets = build_triangles(triangles)
    low, high = np.empty((2, len(matrices), 3), np.float32)
    instance_boxes(nodes, packets, np.zeros(len(matrices), np.int32), np.ones(len(matrices), bool), matrices, low, high)
    return low, high


@pytest.mark.parametrize("count", [1, 3, 40, 5000])
@pytest.mark.parametrize("offset", [0.0, 1000.0])
def test_boxes_hold_the_moved_corners_tightly(count, offset):
    random = np.random.default_rng(count)
    centres = random.normal(size=(count, 1, 3))
    triangles = (centres + 0.01 * random.normal(size=(count, 3, 3))).astype(np.float32)
    matrices = random.normal(size=(50, 3, 4)).astype(np.float32)
    matrices[:, :, 3] += offset
    low, high = boxes_of(triangles, matrices)
    corners = np.einsum("nij,mj->nmi", matrices[:, :, :3].astype(float), triangles.reshape(-1, 3).astype(float))
    corners += matrices[:, None, :, 3]
    true_low, true_high = corners.min(axis=1), corners.max(axis=1)
    assert (low <= true_low).all()
    assert (high >= true_high).all()
    np.testing.assert_allclose(high - low, true_high - true_low, rtol=1e-3, atol=1e-4 + 2e-5 * offset)
