"""Scenes, where probes go in them, and their fields."""

from __future__ import annotations

import ctypes
import os
import warnings
from types import SimpleNamespace
from typing import Any

import numpy as np

from . import arrays, native
from .fields import Progress
from .handles import Handle
from .native import Error, library


class Scene(Handle):
    """A scene: "builtin:NAME" (`builtin_scenes`), or a .gltf, .glb, .obj, .json or .olxs file. Close it, or use it in a `with`."""

    _release = "olx_scene_free"
    _what = "scene"

    def __init__(self, name: str | os.PathLike[str]):
        """Load a scene. Raises Error."""
        super().__init__(native.SceneHandle)
        native.check(library.olx_scene_load(os.fsencode(name), ctypes.byref(self._handle)))

    @property
    def info(self) -> SimpleNamespace:
        """The members of olx_scene_info: triangles, materials, lights, cameras, origin, bounds_min, bounds_max, hash, ..."""
        return native.record(library.olx_scene_describe(self.handle))

    @property
    def warnings(self) -> list[str]:
        """What was skipped or clamped at import."""
        number = library.olx_scene_describe(self.handle).warnings
        return [library.olx_scene_warning(self.handle, i).decode(errors="replace") for i in range(number)]

    @property
    def cameras(self) -> list[SimpleNamespace]:
        """The cameras: name, eye, target, up, fov_y_degrees."""
        number = library.olx_scene_describe(self.handle).cameras
        return [native.record(library.olx_scene_camera(self.handle, i)) for i in range(number)]


def builtin_scenes() -> list[str]:
    """Names of the scenes that need no file."""
    names = []
    while (name := library.olx_builtin_name(len(names))) is not None:
        names.append("builtin:" + name.decode())
    return names


class Probes:
    """Probes that `place` set, and how well they do."""

    def __init__(self, probe_set: native.ProbeSet):
        self._set = probe_set
        placed = [probe_set.probes[i] for i in range(probe_set.count)]
        #: float32 (count, 3), metres, relative to the scene's origin
        self.positions = np.array([(p.position.x, p.position.y, p.position.z) for p in placed], np.float32).reshape(-1, 3)
        #: float32 (count,): share of what can be seen that this probe covers and none before it does
        self.gains = np.array([p.gain for p in placed], np.float32)
        #: bool (count,): inside geometry
        self.buried = np.array([p.buried for p in placed], np.bool_)
        #: where each position came from: "pinned", "grid", "skeleton", "space", "target", "moved"
        self.origins = [native.word("probe_origin", p.origin) for p in placed]
        #: the members of olx_place_report: coverage, visible, missed, ...
        self.report = native.record(probe_set.report)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the .json that `octalux bake --probes` reads."""
        native.check(library.olx_probe_set_save(self._set, os.fsencode(path)))

    def __len__(self) -> int:
        return len(self.positions)

    def __del__(self) -> None:
        library.olx_probe_set_free(self._set)


def _grid(scene: Scene, value: Any) -> native.Grid:
    """A grid by its counts along x, y and z, in the scene's volume of probes."""
    counts = tuple(int(v) for v in value)
    if len(counts) != 3 or any(not 1 <= c <= 2**20 for c in counts):
        raise ValueError(f"grid: {value!r} is not three counts from 1 to 2^20")
    grid = native.Grid()
    native.check(library.olx_scene_probe_grid(scene.handle, (ctypes.c_uint32 * 3)(*counts), grid))
    return grid


def place(scene: Scene, method: str = "cover", *, grid: Any = None, progress: Progress | None = None, **settings: Any) -> Probes:
    """Find positions from which a scene's surfaces are seen.

    method: "grid", "sdf", "medial" or "cover". grid: three counts, for "grid" and "cover"; default: the scene's. Further settings are the members
    of olx_place_settings (include/octalux/place.h): count, coverage, budget_mb, views, resolution=512, optimize="none" or "gradient"
    or "gibbs", rounds, surfels, candidates, voxel_size, voxels, seed, threads, ... The same scene and settings give the same probes. Raises Error.
    """
    chosen = library.olx_place_settings_default(scene.handle)
    native.fill(chosen, {"method": method, **settings})
    if grid is not None:
        chosen.grid = _grid(scene, grid)
    watch, probes = native.Watch(progress), native.ProbeSet()
    watch.call(library.olx_place, scene.handle, chosen, watch.progress, probes)
    return Probes(probes)


def join(folder: str | os.PathLike[str], path: str | os.PathLike[str], *, keep: bool = False,
         progress: Progress | None = None) -> SimpleNamespace:
    """Write the field whose parts lie in a work folder to `path`, without the scene. The folder goes away unless `keep`. Returns the
    members of olx_bake_stats that are known. Raises Error.
    """
    watch, stats = native.Watch(progress), native.BakeStats()
    watch.call(library.olx_bake_join, os.fsencode(folder), os.fsencode(path), keep, watch.progress, stats)
    return native.record(stats)


def _size_for_budget(scene: Scene, chosen: native.BakeSettings, budget_mb: float) -> int:
    size = ctypes.c_uint32()
    native.check(library.olx_bake_size_for_budget(scene.handle, chosen, budget_mb, size))
    return size.value


def _open_probes(scene: Scene, chosen: native.BakeSettings, progress: Progress | None) -> Probes | None:
    """Probes for a scene that does not say where they are; None where it does, and where there is nowhere to place any."""
    info = library.olx_scene_describe(scene.handle)
    needs_grid = chosen.select_mask & 1 << native.number("select", "cage")
    if info.has_probe_volume or info.has_probe_count or needs_grid:
        return None
    if chosen.work.parts > 1:
        raise ValueError("a bake in parts needs probes or grid here, because every call would place probes anew")
    try:
        return place(scene, resolution=chosen.radiance_size, threads=chosen.threads, progress=progress)
    except Error as error:
        if error.result != native.Result.EMPTY:
            raise
        warnings.warn(f"{error}; probes are on a grid over the bounds instead", stacklevel=3)
        return None


def bake(scene: Scene, path: str | os.PathLike[str], *, grid: Any = None, probes: Any = None, irradiance_grid: Any = None,
         select: Any = (), budget_mb: float | None = None, progress: Progress | None = None, **settings: Any) -> SimpleNamespace:
    """Bake a scene's light into the field file `path`, which is whole or not there.

    grid: three counts of light field probes in the scene's volume. probes: a `Probes`, or positions (count, 3) in metres, instead of a grid.
    Without either: the scene's own grid, or else where `place` puts them. irradiance_grid: three counts of irradiance probes (with
    probe_light=True). select: words for structures to bake in, of "cage", "voronoi", "octree", "bricks"; default: what fits best.
    budget_mb: megabytes (10^6 bytes) that the file may take; then radiance_size
    is the largest whose field is expected to fit, and cannot be given. Further settings are the members of olx_bake_settings
    (include/octalux/bake.h): radiance_size=512, probe_light=False, irradiance_size=128, samples=2, light_samples=1, bounces=128,
    noise=0.02, volume_cells=32, classic=False, relight=False, seed=0, threads=0, ... Bytes depend on scene and settings alone. Returns
    the members of olx_bake_stats. Raises Error.

    work={"folder": PATH} keeps results there while it bakes, goes on from what is there, and takes the folder away at the end; with
    "part" and "parts" it makes a share of the units and no field, and raises an Error whose result is INCOMPLETE while units of others
    are missing.
    """
    chosen = library.olx_bake_settings_default(scene.handle)
    if grid is not None:
        chosen.grid = _grid(scene, grid)
        chosen.irradiance_grid = library.olx_bake_irradiance_grid(chosen.grid)
    if irradiance_grid is not None:
        chosen.irradiance_grid = _grid(scene, irradiance_grid)
    native.fill(chosen, settings)
    for name in (select,) if isinstance(select, str) else select:
        chosen.select_mask |= 1 << native.number("select", name)
    if budget_mb is not None and "radiance_size" in settings:
        raise ValueError("budget_mb and radiance_size exclude each other")
    if probes is None and grid is None:
        probes = _open_probes(scene, chosen, progress)
    if probes is not None:
        positions = arrays.vectors("probes", probes.positions if isinstance(probes, Probes) else probes)
        if positions.ndim != 2 or not len(positions):
            raise ValueError(f"probes: an array of shape {positions.shape} where (count, 3) is wanted")
        chosen.probes, chosen.probe_count = arrays.pointer(positions), len(positions)
    watch, stats = native.Watch(progress), native.BakeStats()
    if budget_mb is not None:
        chosen.radiance_size = _size_for_budget(scene, chosen, budget_mb)
    watch.call(library.olx_bake, scene.handle, chosen, os.fsencode(path), watch.progress, stats)
    return native.record(stats)
