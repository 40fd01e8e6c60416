"""A baked field, and light sampled from it."""

from __future__ import annotations

import ctypes
import os
from types import SimpleNamespace
from typing import Any, Callable, NamedTuple

import numpy as np

from . import arrays, native
from .handles import Handle
from .native import library

_FORMATS = {ctypes.c_uint32: np.uint32, ctypes.c_float: np.float32, ctypes.c_bool: np.bool_, native.Vec3: (np.float32, 3)}

#: What a ray found (`Field.trace`); include/octalux/sample.h says what each member means.
HIT = np.dtype({
    "names": [name for name, _ in native.TraceHit._fields_],
    "formats": [_FORMATS[kind] for _, kind in native.TraceHit._fields_],
    "offsets": [getattr(native.TraceHit, name).offset for name, _ in native.TraceHit._fields_],
    "itemsize": ctypes.sizeof(native.TraceHit),
})

#: Values of `status` in HIT.
MISS, FOUND, UNKNOWN = range(3)


class Glossy(NamedTuple):
    """What `Field.glossy` finds; `...` are the axes of the points."""

    radiance: np.ndarray  #: (..., 3), W/(sr m^2)
    weight: np.ndarray  #: (...), BRDF times cosine over the pdf for a Fresnel reflectance of 1; 0: no ray was traced
    half_cosine: np.ndarray  #: (...), cosine between view and half vector, for Fresnel


class Field(Handle):
    """A field file, mapped into memory; immutable. Any number of threads may sample it. Close it, or use it in a `with`.

    Positions are in metres, relative to `origin`, which is 0 unless the scene lies far from 0. Vectors lie along the last axis of
    arrays, other axes are free and come back as they are. Light is linear Rec.709.

    Settings that every method of sampling takes by keyword, with their defaults:

    - tracer="hiz": "texel", "two_level" or "hiz"; the answers are the same
    - select="best": how probes are found: "cage", "voronoi", "octree", "bricks", "exhaustive"
    - visibility="chebyshev", or "none", for irradiance probes
    - max_probes=16: that a ray may query
    - visibility_only=False: whether traced rays leave out the light of what they hit
    - keep_buried=False: whether probes inside geometry are queried
    - emitters=False: whether light straight from emitters and the sky counts
    - hits="shaded", or "stored", which needs a field with probe light
    - surface_tolerance=0.0: 0 to 16 footprints of a texel by which a surface may have moved since the bake
    """

    _release = "olx_field_close"
    _what = "field"

    def __init__(self, path: str | os.PathLike[str]):
        """Open a field. Raises Error (FILE, FORMAT, VERSION, CHECKSUM, UNSUPPORTED, MEMORY)."""
        super().__init__(native.FieldHandle)
        native.check(library.olx_field_open(os.fsencode(path), ctypes.byref(self._handle)))

    @property
    def info(self) -> SimpleNamespace:
        """What is in the field: the members of olx_field_info (probes.count, maps.size, scene.bounds_min, bytes.file, ...)."""
        return native.record(library.olx_field_describe(self.handle))

    @property
    def origin(self) -> tuple[float, float, float]:
        """Scene coordinates, in metres, that positions are relative to."""
        origin = (ctypes.c_double * 3)()
        library.olx_field_origin(self.handle, origin)
        return tuple(origin)

    @property
    def positions(self) -> np.ndarray:
        """Where light field probes stand: float32 (probes.count, 3), metres."""
        number = library.olx_field_describe(self.handle).probes.count
        places = [library.olx_field_probe_position(self.handle, i) for i in range(number)]
        return np.array([(p.x, p.y, p.z) for p in places], np.float32)

    @property
    def buried(self) -> np.ndarray:
        """Which light field probes were found inside geometry: bool (probes.count,)."""
        number = library.olx_field_describe(self.handle).probes.count
        return np.array([library.olx_field_probe_buried(self.handle, i) for i in range(number)], np.bool_)

    def verify(self) -> None:
        """Read every byte and raise Error when a checksum or a value is wrong."""
        native.check(library.olx_field_verify(self.handle))

    def _settings(self, values: dict[str, Any]) -> native.SampleSettings:
        settings = library.olx_sample_settings_default()
        native.fill(settings, values)
        native.check(library.olx_sample_settings_check(self.handle, settings))
        return settings

    def trace(self, origins: Any, directions: Any, t_max: float = np.inf, *, out: np.ndarray | None = None,
              **settings: Any) -> np.ndarray:
        """What rays see first, within t_max metres, above 0.

        origins (..., 3): metres. directions (..., 3): unit. One origin or direction may stand for all. The result has dtype HIT and
        shape (...): "status" is MISS, FOUND or UNKNOWN, "distance_metres" is infinite for the sky, "radiance" is what the surface
        reflects along the ray, in W/(sr m^2). `out`, an array of that dtype and shape, is filled and returned instead.
        """
        directions = arrays.units("directions", directions)
        origins = arrays.vectors("origins", origins)
        shape = np.broadcast_shapes(origins.shape, directions.shape)[:-1]
        origins, directions = (arrays.vectors(n, v, shape) for n, v in (("origins", origins), ("directions", directions)))
        if np.isnan(t_max):
            raise ValueError("t_max is not a number")
        if out is None:
            out = np.empty(shape, HIT)
        elif out.dtype != HIT or out.shape != shape or not out.flags.c_contiguous or not out.flags.writeable:
            raise ValueError(f"out: not a writeable contiguous array of HIT of shape {shape}")
        library.olx_trace_rays(self.handle, self._settings(settings), arrays.count(origins), arrays.pointer(origins),
                               arrays.pointer(directions), t_max, arrays.pointer(out, native.TraceHit))
        return out

    def irradiance(self, positions: Any, normals: Any, shading_normals: Any = None, views: Any = None,
                   **settings: Any) -> np.ndarray:
        """Indirect irradiance on static surfaces, from light that is stored where surfaces are: float32 (..., 3), W/m^2.

        positions (..., 3): metres, on the surface. normals (..., 3): unit, of the triangle, on the side that is looked at.
        shading_normals: unit, where a normal map bends them; default: normals. views: unit, to the eye; default: normals. Light that
        leaves a diffuse surface is albedo * irradiance / pi. Positions that are not finite give 0.
        """
        positions = arrays.vectors("positions", positions)
        shape = positions.shape[:-1]
        normals = arrays.units("normals", normals, shape)
        shading = normals if shading_normals is None else arrays.units("shading_normals", shading_normals, shape)
        views = normals if views is None else arrays.units("views", views, shape)
        light = np.empty((*shape, 3), np.float32)
        library.olx_surface_irradiance_points(self.handle, self._settings(settings), arrays.count(positions),
                                              *(arrays.pointer(a) for a in (positions, normals, shading, views, light)))
        return light

    def volume_irradiance(self, positions: Any, normals: Any) -> np.ndarray:
        """Indirect irradiance in free space, for moving objects, from the irradiance volume: float32 (..., 3), W/m^2.

        positions (..., 3): metres. normals (..., 3): unit, of the objects' surfaces. 0 where the volume has no cell.
        """
        positions = arrays.vectors("positions", positions)
        shape = positions.shape[:-1]
        normals = arrays.units("normals", normals, shape)
        light = np.empty((*shape, 3), np.float32)
        library.olx_volume_irradiance_points(self.handle, arrays.count(positions),
                                             *(arrays.pointer(a) for a in (positions, normals, light)))
        return light

    def glossy(self, positions: Any, normals: Any, views: Any, roughness: Any, random: Any, **settings: Any) -> Glossy:
        """An estimate, by one ray or two where it meets a glossy surface, of the light that a GGX lobe gathers at each point.

        positions, normals, views (..., 3): metres, unit, unit (towards the eye). roughness (...): perceptual, 0 (a mirror) to 1.
        random (..., 2): in [0, 1), draws the ray. radiance * weight * Fresnel(half_cosine) is the estimate of what is reflected.
        """
        positions = arrays.vectors("positions", positions)
        shape = positions.shape[:-1]
        normals, views = arrays.units("normals", normals, shape), arrays.units("views", views, shape)
        roughness, random = arrays.spread("roughness", roughness, shape), arrays.spread("random", random, (*shape, 2))
        for name, values, open_end in (("roughness", roughness, False), ("random", random, True)):
            if not ((values >= 0) & ((values < 1) if open_end else (values <= 1))).all():
                raise ValueError(f"{name}: numbers that are not from 0 to 1{', or are 1' if open_end else ''}")
        found = Glossy(np.empty((*shape, 3), np.float32), np.zeros(shape, np.float32), np.zeros(shape, np.float32))
        number = ctypes.c_float
        library.olx_glossy_rays(self.handle, self._settings(settings), arrays.count(positions), arrays.pointer(positions),
                                arrays.pointer(normals), arrays.pointer(views), arrays.pointer(roughness, number),
                                arrays.pointer(random, native.Vec2), arrays.pointer(found.radiance),
                                arrays.pointer(found.weight, number), arrays.pointer(found.half_cosine, number))
        return found


#: A function that hears of progress: a stage's name and the share of all work that is done. False ends the work.
Progress = Callable[[str, float], Any]
