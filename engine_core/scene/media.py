# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of the media of a scene, and where they are."""

import numpy as np

from ..medium_tables import MAX_PHASES, MEDIUM, PHASE
from ..shape.dispatch import bounds
from ..tables import BOUNDARY_SHIFT, PLAIN_SHIFT, CameraKind
from .shading import has_no_surface, holds_media
from .shapes import Shapes


class MediaTables:
    """Rows of MEDIUM and PHASE; sets `medium` in the rows of MATERIAL of `builder`, what WORLD says of media, and in
    the rows of INSTANCE which have no surface and which no medium.

    `matrices`: of the placements, float64 (n, 3, 4). `instances`: their rows, and after them those of lamps.
    """

    def __init__(self, builder, geometries, materials, world, placements, matrices, instances):
        self.phases, self._media, self._medium_rows = [], [], {}
        self.builder, self.geometries, self.materials = builder, geometries, materials
        materials["medium"] = [self._add(material.name, material.medium) for material in builder.materials]
        self.world_medium = self._add("World", builder.world_medium)
        bare = np.array([has_no_surface(materials, p.materials) for p in placements], bool)
        holders = np.array([holds_media(materials, p.materials) for p in placements], bool)
        self._fill_world(world, placements, matrices, holders, bare)
        instances["visibility"][np.flatnonzero(bare)] <<= BOUNDARY_SHIFT
        if world["has_media"]:
            plain = np.flatnonzero(~bare & ~holders)
            instances["visibility"][plain] |= instances["visibility"][plain] << PLAIN_SHIFT

    def tables(self):
        phases = np.array(self.phases, PHASE) if self.phases else np.zeros(0, PHASE)
        return {"media": np.array(self._media, MEDIUM), "phases": phases}

    def _fill_world(self, world, placements, matrices, holders, bare):
        world["medium"] = self.world_medium
        world["has_media"] = self.world_medium >= 0 or bool(holders.any())
        about = zip(holders, placements, matrices, strict=True)
        around = np.array([holds and self._may_hold_camera(*place) for holds, *place in about], bool)
        world["camera_in_media"] = bool((around & ~bare).any())
        world["camera_in_boundary"] = bool((around & bare).any())

    def _add(self, name, medium):
        """Row of MEDIUM."""
        if medium is None:
            return -1
        row = np.zeros(1, MEDIUM)[0]
        kept = medium.phases[:MAX_PHASES]
        if len(medium.phases) > len(kept):
            self.builder._warn(name, f"its volume has more than {MAX_PHASES} ways to scatter; the first are rendered")
        row["phases"], row["phase_count"] = len(self.phases), len(kept)
        row["sigma_s"] = sum((phase["weight"] for phase in kept), np.zeros(3, np.float32))
        row["sigma_t"], row["emission"] = row["sigma_s"] + medium.absorption, medium.emission
        self.phases.extend(kept)
        self._media.append(row)
        return len(self._media) - 1

    def _may_hold_camera(self, placement, matrix):
        """Whether a ray of the camera may begin in the box around a geometry."""
        camera, geometry = self.builder.camera_row[0], self.geometries[placement.geometry]
        moves = placement.motion is not None or self.builder.camera_motion is not None
        if camera["kind"] != CameraKind.PERSPECTIVE or moves:
            return True
        low, high = bounds(geometry.rows) if isinstance(geometry, Shapes) else (geometry.positions,) * 2
        corners = np.concatenate([low, high]).astype(np.float64)
        low, high = corners.min(axis=0), corners.max(axis=0)
        corners = np.array([np.where(choice, high, low) for choice in np.ndindex(2, 2, 2)])
        corners = corners @ matrix[:, :3].T + matrix[:, 3]
        reach = 2.0 * camera["clip_start"] + camera["lens_radius"]
        eye = camera["to_world"][:, 3]
        return bool((corners.min(axis=0) - reach <= eye).all() and (eye <= corners.max(axis=0) + reach).all())
