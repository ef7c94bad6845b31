# SPDX-License-Identifier: GPL-3.0-or-later
"""Render: Python threads that hand out tiles to kernels, and tell how far they are.

The whole film is rendered in passes that double its samples: 1, 2, 4, 8 ..., so that a rough picture is there at once.
After each pass all threads meet: the picture's error is estimated, and half-way the rest of the samples is distributed
over the pixels. A kernel does not hold the GIL, so the threads run side by side. A pixel gets its samples in order from
one thread at a time: the picture depends on scene and settings alone, not on the number of threads or who was first.

    render = Render(scene, settings)
    render.start()
    while render.is_running:
        for tile in render.finished_tiles(timeout_s=0.1):
            show(render.image("Combined", tile))
    render.wait()
"""

import math
import os
import queue
import threading
import time

import numpy as np

from ..film import adaptive, passes, sharing
from ..film.noise import Noise
from ..guiding.guide import FEWEST_PATHS, FEWEST_SAMPLES, Guide
from ..sampling.sobol import index_bits
from ..settings import UNIFORM_SAMPLES, IntegratorKind, Settings
from .render import RENDER_TILE, RENDER_TILE_IN_MEDIA

# A tile is small enough that stopping, and sharing the last ones among the threads, takes no time,
# and large enough that handing it out (50 us) does not matter.
TILE_SIZE = 64
FEW_TILES = 64  # with fewer, smaller ones are made: at the end of a pass no thread shall wait for long
LARGEST_JOB = 64  # samples of a pixel; more would not be shown for a long time
LARGEST_BATCH = 8  # samples of a pixel in one call of the kernel, which cannot be interrupted within a row
SHARING_IS_JUDGED = 8  # samples of a pixel after which it is known whether pixels should share theirs
LEAST_PASS = 1.125  # times the samples so far: what a pass has at least


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

    It ends with `settings.samples`, at `settings.noise_target` or at the time limit, whichever comes first.
    """

    def __init__(self, scene, settings, threads=0, time_limit=0.0):
        if settings.crop_width < 1 or settings.crop_height < 1 or settings.samples < 1:
            raise ValueError("a render needs at least one pixel and one sample")
        shares = int(settings.share_samples != 0 and sharing.can_share(settings))
        self.scene, self.settings = scene, Settings(*settings)._replace(share_samples=shares)
        self.guide = make_guide(scene, self.settings)
        if self.guide is not None:
            self.scene = self.guide.scene
        self.film, self._earlier_film = self._empty_film(), None
        self.threads = threads if threads > 0 else available_processors()
        self.time_limit = time_limit
        self.tiles = make_tiles(settings.crop_width, settings.crop_height)
        self.noise = Noise(self.film)
        self._pixel_samples, self._busy = 0, set()
        self._done = 0  # samples of a pixel on average, when all pixels last were where they should be ...
        self._budget, self._goal, self._importance = 1, 1, None  # ... and what they are on their way to
        self._first_pass_s = 0.0
        self._begin_pass(self._goal)
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
        with self._changed:
            self.film.control["cancel"] = 1
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
    def _average(self):
        # adaptive sampling leaves the rest of a budget that does not suffice for a pixel's next power of two
        return max(self._pixel_samples / (self.film.width * self.film.height), float(self._done))

    @property
    def samples_done(self):
        """Of a pixel on average; 0 until every pixel has one."""
        return int(self._average)

    @property
    def progress(self):
        """0 to 1, of the samples, the time limit or the way to the noise target, whichever is furthest."""
        work = self._average / self.settings.samples
        if self.time_limit > 0.0:
            work = max(work, self.elapsed_s / self.time_limit)
        if self.settings.noise_target > 0.0 and not math.isnan(self.error_estimate):
            work = max(work, self._average / max(self.noise.samples_for(self.settings.noise_target), 1.0))
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
        """Relative error of the picture so far, as in film.noise; NaN while nothing is known."""
        return self.noise.error_at(self._average)

    @property
    def is_guided(self):
        """Whether paths follow what earlier ones have learned."""
        return self.guide is not None and self.guide.is_guiding

    def image(self, name, tile=None):
        """The pass `name` as float32 (height, width, channels), bottom row first; of a tile, or of the whole film."""
        return passes.image(self._earlier_film or self.film, name, tile)

    # ---- Passes ----

    def _empty_film(self):
        settings, lessons = self.settings, self.guide and self.guide.lessons
        return passes.make_film(settings.crop_width, settings.crop_height, lessons, settings.share_samples != 0)

    def _next_pass(self):
        """All threads have finished a pass: begin the next, if there is one."""
        samples = passes.pixels(self.film)["samples"]
        self.noise.update(is_steady=not self.is_guided)
        if self.guide is not None:
            self.guide.after_pass(passes.pixels(self.film), self.noise)
        if (samples >= self._goal).all():
            self._done = self._budget
            self._first_pass_s = self._first_pass_s or self.elapsed_s  # it may have compiled kernels
            if self._done >= SHARING_IS_JUDGED:
                self._earlier_film = None
            if self._done == SHARING_IS_JUDGED and self.noise.kept > 1.0 and self._expected_end() >= 2 * self._done:
                self._begin_anew_apart()
                samples = passes.pixels(self.film)["samples"]
            self._budget, self._goal = self._next_goal(samples) if self._done else (1, 1)
        targets = np.minimum(
            self._goal, np.maximum(2 * samples, 1)
        )  # how far pixels move in a doubling is what tells the error
        with self._changed:
            self._begin_pass(targets)
            self._changed.notify_all()

    def _begin_anew_apart(self):
        """Let samples count for one pixel each from the first on: light is so even that they leave less noise so.

        The picture so far is shown until there is one as good.
        """
        with self._changed:
            self.settings = self.settings._replace(share_samples=0)
            film = self._empty_film()
            film.control["cancel"] = self.film.control["cancel"]
            self.film, self._earlier_film, self.noise = film, self.film, Noise(film)
            self._pixel_samples = self._done = 0

    def _next_goal(self, samples):
        """(samples of a pixel on average, samples of each pixel: a number or an array) to reach; as now at the end.

        Adaptive sampling gives one half to all pixels alike, and the other where that half has shown the most noise.
        """
        done, end = self._done, self._expected_end()
        if end <= done:
            return done, samples.copy()
        if not self.settings.adaptive or end <= UNIFORM_SAMPLES or 4 * done <= end:
            goal = min(2 * done, end)
            return goal, goal
        if self._importance is None:
            self._importance = self.noise.importance()
        return end, adaptive.distribute(self._importance, samples, end, 1 << index_bits(self.settings.row()))

    def _expected_end(self):
        """Samples of a pixel on average when the first of the three limits will be reached, as far as one knows yet."""
        settings, done, end = self.settings, self._done, float(self.settings.samples)
        if settings.noise_target > 0.0 and done >= UNIFORM_SAMPLES:
            needed = self.noise.samples_for(settings.noise_target)
            end = min(end, done if needed <= done else max(needed, LEAST_PASS * done))
        if self.time_limit > 0.0 and done > 1:
            speed = (done - 1.0) / (self.elapsed_s - self._first_pass_s)
            end = min(end, max(done + speed * (self.time_limit - self.elapsed_s), LEAST_PASS * done))
        return math.ceil(end)

    def _begin_pass(self, targets):
        """Give the pixels their targets, a number or an array, and make jobs of the tiles that have some way to go."""
        grid = passes.pixels(self.film)
        grid["target"] = targets
        missing = grid["target"] - grid["samples"]
        most = [int(missing[y : y + h, x : x + w].max()) for x, y, w, h in self.tiles]
        jobs = [
            tile
            for begun in range(0, max(most), LARGEST_JOB)
            for tile, samples in zip(self.tiles, most, strict=True)
            if samples > begun
        ]
        self._jobs, self._open_jobs = iter(jobs), len(jobs)
        self._next = next(self._jobs, None)

    # ---- The threads ----

    def _next_job(self):
        """The next tile, or None at the end. One whose last job is still at work has to wait for it."""
        with self._changed:
            while not self._stops() and self._open_jobs > 0:
                tile = self._next
                if tile is None or tile in self._busy:
                    self._changed.wait(0.1)
                    continue
                self._busy.add(tile)
                self._next = next(self._jobs, None)
                return tile
        return None

    def _stops(self):
        out_of_time = self.samples_done > 0 and 0.0 < self.time_limit <= self.elapsed_s
        return self.is_cancelled or out_of_time or self._error is not None

    def _work(self):
        try:
            while (tile := self._next_job()) is not None:
                before = self._samples_of(tile)
                complete = self._render(tile)
                with self._changed:
                    self._busy.discard(tile)
                    self._pixel_samples += self._samples_of(tile) - before
                    is_last = complete and self._open_jobs == 1
                    if complete:
                        self._finished.put(tile)
                    if complete and not is_last:
                        self._open_jobs -= 1
                    self._changed.notify_all()
                if is_last:  # the others wait meanwhile, since a job is open and none is left
                    self._next_pass()
        except BaseException as error:  # a thread has nobody to raise to: `wait` does it
            self._error = error
            self.cancel()
        finally:
            with self._changed:
                is_alone = self._running_workers == 1
                if is_alone and self._open_jobs > 0 and not self.is_cancelled:
                    self.noise.update(is_steady=not self.is_guided)  # out of time in the midst of a pass
                self._running_workers -= 1
                if is_alone:
                    self._ended = time.perf_counter()
                    self._finished.put(None)  # wakes whoever waits for a tile

    def _samples_of(self, tile):
        return int(passes.pixels(self.film, tile)["samples"].sum())

    def _render(self, tile):
        """A job: up to LARGEST_JOB samples for the pixels of a tile, in batches. False if cancelled before the end."""
        kernels = RENDER_TILE_IN_MEDIA if self.scene.world["has_media"][0] else RENDER_TILE
        render_tile = kernels[self.settings.integrator]
        for _ in range(0, LARGEST_JOB, LARGEST_BATCH):
            if render_tile(self.scene, self.settings.row(), self.film, *tile, LARGEST_BATCH) < tile[3]:
                return False
        return True


def make_guide(scene, settings):
    """A Guide if one is wanted, and there will be paths enough to teach it and to follow it."""
    pixels = settings.crop_width * settings.crop_height
    enough = settings.samples >= 2 * FEWEST_SAMPLES and pixels * settings.samples >= 2 * FEWEST_PATHS
    is_wanted = settings.guiding != 0 and settings.integrator == IntegratorKind.PATH
    return Guide(scene) if is_wanted and enough else None


def available_processors():
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def make_tiles(width, height):
    """Tiles (x, y, width, height) that cover the film, from its middle outwards: that is where one looks first."""
    size = TILE_SIZE if width * height > FEW_TILES * TILE_SIZE**2 else TILE_SIZE // 2
    tiles = [
        (x, y, min(size, width - x), min(size, height - y))
        for y in range(0, height, size)
        for x in range(0, width, size)
    ]
    return sorted(tiles, key=lambda t: (t[0] + t[2] / 2 - width / 2) ** 2 + (t[1] + t[3] / 2 - height / 2) ** 2)
