# SPDX-License-Identifier: GPL-3.0-or-later
"""Render: Python threads that hand out tiles to kernels, and tell how far they are.

The whole frame is rendered in passes of 1, 1, 2, 4, 8 ... samples, so that a rough picture is there at once. A kernel
does not hold the GIL, so the threads run side by side. A pixel gets its samples in order from one thread at a time: the
picture depends on scene and settings alone, not on the number of threads or who was first.

    render = Render(scene, settings)
    render.start()
    while render.is_running:
        for tile in render.finished_tiles(timeout_s=0.1):
            show(render.image("Combined", tile))
    render.wait()
"""

import os
import queue
import threading
import time

from ..film import passes
from ..settings import Settings
from .render import RENDER_TILE

# A tile is small enough that stopping, and sharing the last ones among the threads, takes no time,
# and large enough that handing it out (50 us) does not matter.
TILE_SIZE = 64
LARGEST_PASS = 64  # samples; more would not be shown for a long time
LARGEST_BATCH = 8  # samples of a tile in one call of the kernel, which cannot be interrupted within a row


class Render:
    """One picture in the making.

    Parameters
    ----------
    scene : Scene
    settings : Settings
        `crop_x` ... `crop_height` say what part of the frame is rendered; the film has that size.
    threads : int
        0: as many as there are processors.
    time_limit : float
        Seconds after which no tile is begun; 0: none. The first pass is always finished, so that no pixel is empty.
    """

    def __init__(self, scene, settings, threads=0, time_limit=0.0):
        if settings.crop_width < 1 or settings.crop_height < 1 or settings.samples < 1:
            raise ValueError("a render needs at least one pixel and one sample")
        self.scene, self.settings = scene, Settings(*settings).plain()
        self.film = passes.make_film(settings.crop_width, settings.crop_height)
        self.threads = threads if threads > 0 else available_processors()
        self.time_limit = time_limit
        self.tiles = make_tiles(settings.crop_width, settings.crop_height)
        self.passes = make_passes(settings.samples)
        self.samples_done = 0  # by every pixel
        self._jobs = ((number, tile) for number in range(len(self.passes)) for tile in self.tiles)
        self._next, self._busy = next(self._jobs), set()
        self._open_tiles, self._whole_passes = [len(self.tiles)] * len(self.passes), 0
        self._pixel_samples = 0
        self._changed = threading.Condition()
        self._finished, self._workers = queue.SimpleQueue(), []
        self._error, self._running_workers = None, 0
        self._began = self._ended = None

    # ---- Driving it ----

    def start(self):
        """Begin to render on threads of our own, and return at once."""
        self._began = time.perf_counter()
        self._running_workers = self.threads
        self._workers = [
            threading.Thread(target=self._work, name=f"lambent tile {i}", daemon=True) for i in range(self.threads)
        ]
        for worker in self._workers:
            worker.start()

    def cancel(self):
        """Tell the kernels to stop at their next row of pixels. Returns at once; `wait` waits for them."""
        self.film.control["cancel"] = 1
        with self._changed:
            self._changed.notify_all()

    def wait(self):
        """Wait for the end. Raises what a thread raised."""
        for worker in self._workers:
            worker.join()
        if self._error is not None:
            raise self._error

    def run(self):
        """Start and wait, for callers that do not look on. Returns the film."""
        self.start()
        self.wait()
        return self.film

    def finished_tiles(self, timeout_s):
        """Tiles (x, y, width, height) finished since the last call; waits for the first up to `timeout_s` seconds."""
        tiles = []
        try:
            tiles.append(self._finished.get(timeout=timeout_s))
            while True:
                tiles.append(self._finished.get_nowait())
        except queue.Empty:
            return [tile for tile in dict.fromkeys(tiles) if tile is not None]

    # ---- How far it is ----

    @property
    def is_running(self):
        return self._running_workers > 0

    @property
    def is_cancelled(self):
        return bool(self.film.control["cancel"][0])

    @property
    def elapsed_s(self):
        if self._began is None:
            return 0.0
        return (self._ended or time.perf_counter()) - self._began

    @property
    def progress(self):
        """0 to 1, of the samples or of the time limit, whichever is further."""
        work = self._pixel_samples / (self.film.width * self.film.height * self.settings.samples)
        if self.time_limit > 0.0:
            work = max(work, self.elapsed_s / self.time_limit)
        return min(work, 1.0)

    @property
    def remaining_s(self):
        """Seconds to go at the speed so far; None while that is anyone's guess."""
        progress = self.progress
        if progress <= 0.0 or self.elapsed_s < 0.2:
            return None
        return self.elapsed_s * (1.0 - progress) / progress

    @property
    def error_estimate(self):
        """Relative error of the picture so far; see film.passes."""
        return passes.error_estimate(self.film)

    def image(self, name, tile=None):
        """The pass `name` as float32 (height, width, channels), bottom row first; of a tile, or of the whole film."""
        return passes.image(self.film, name, tile)

    # ---- The threads ----

    def _next_job(self):
        """The next (pass, tile), or None at the end. A tile whose last pass is still at work has to wait for it."""
        with self._changed:
            while not self._stops() and self._next is not None:
                number, tile = self._next
                if tile in self._busy:
                    self._changed.wait(0.1)
                    continue
                self._busy.add(tile)
                self._next = next(self._jobs, None)
                return number, tile
        return None

    def _stops(self):
        out_of_time = self.samples_done > 0 and 0.0 < self.time_limit <= self.elapsed_s
        return self.is_cancelled or out_of_time or self._error is not None

    def _work(self):
        try:
            while (job := self._next_job()) is not None:
                number, tile = job
                complete = self._render(tile, sum(self.passes[:number]), self.passes[number])
                with self._changed:
                    self._busy.discard(tile)
                    if complete:
                        self._finish(number, tile)
                    self._changed.notify_all()
        except BaseException as error:  # a thread has nobody to raise to: `wait` does it
            self._error = error
            self.cancel()
        finally:
            with self._changed:
                self._running_workers -= 1
                if self._running_workers == 0:
                    self._ended = time.perf_counter()
                    self._finished.put(None)  # wakes whoever waits for a tile

    def _finish(self, number, tile):
        self._finished.put(tile)
        self._pixel_samples += tile[2] * tile[3] * self.passes[number]
        self._open_tiles[number] -= 1
        while self._whole_passes < len(self.passes) and self._open_tiles[self._whole_passes] == 0:
            self.samples_done += self.passes[self._whole_passes]
            self._whole_passes += 1

    def _render(self, tile, first, count):
        """All samples of a tile in this pass, in batches. False if cancelled before the end."""
        render_tile = RENDER_TILE[self.settings.integrator]
        for begin in range(first, first + count, LARGEST_BATCH):
            batch = min(LARGEST_BATCH, first + count - begin)
            rows = render_tile(self.scene, self.settings, self.film, *tile, begin, batch)
            if rows < tile[3]:
                return False
        return True


def available_processors():
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def make_passes(samples):
    """1, 1, 2, 4, 8 ... that add up to `samples`."""
    passes, done = [], 0
    while done < samples:
        count = min(max(done, 1), LARGEST_PASS, samples - done)
        passes.append(count)
        done += count
    return passes


def make_tiles(width, height):
    """Tiles (x, y, width, height) that cover the film, from its middle outwards: that is where one looks first."""
    tiles = [
        (x, y, min(TILE_SIZE, width - x), min(TILE_SIZE, height - y))
        for y in range(0, height, TILE_SIZE)
        for x in range(0, width, TILE_SIZE)
    ]
    return sorted(tiles, key=lambda t: (t[0] + t[2] / 2 - width / 2) ** 2 + (t[1] + t[3] / 2 - height / 2) ** 2)
