"""Structures, enumerators and functions of Octalux's libraries, as the public headers have them, and how the libraries are found.

Nothing here is for users of the package. Members are documented in include/octalux; tests/python_layouts.py holds every structure,
enumerator and prototype of this file to the headers.
"""

from __future__ import annotations

import ctypes
import enum
import os
import pathlib
import signal
import threading
from ctypes import (CFUNCTYPE, POINTER, c_bool, c_char, c_char_p, c_double, c_float, c_int, c_size_t, c_uint8, c_uint32, c_uint64,
                    c_void_p)
from types import SimpleNamespace
from typing import Any

# For each kind of enumerator: the prefix of its names in C, and the words of its values from 0.
ENUMERATORS = {
    "bake_light": ("OLX_LIGHT_", ("cache", "reference")),
    "bounce_gather": ("OLX_GATHER_", ("solved", "irradiance", "traced")),
    "diffuse": ("OLX_DIFFUSE_", ("surface", "irradiance", "traced")),
    "hits": ("OLX_HITS_", ("shaded", "stored")),
    "irradiance_form": ("OLX_IRRADIANCE_", ("octahedral", "sh2", "sh3")),
    "layer": ("OLX_LAYER_", ("beauty", "direct", "indirect_diffuse", "indirect_glossy", "albedo", "normal", "depth",
                             "standard_error")),
    "method": ("OLX_METHOD_", ("field", "path", "classic")),
    "place_method": ("OLX_PLACE_", ("grid", "sdf", "medial", "cover")),
    "place_optimizer": ("OLX_OPTIMIZE_", ("none", "gradient", "gibbs")),
    "place_reward": ("OLX_REWARD_", ("best", "sum")),
    "probe_origin": ("OLX_ORIGIN_", ("pinned", "grid", "skeleton", "space", "target", "moved")),
    "select": ("OLX_SELECT_", ("cage", "voronoi", "octree", "bricks", "exhaustive", "best")),
    "trace_status": ("OLX_TRACE_", ("miss", "hit", "unknown")),
    "tracer": ("OLX_TRACER_", ("texel", "two_level", "hiz")),
    "visibility": ("OLX_VISIBILITY_", ("none", "chebyshev")),
}
LAYERS = ENUMERATORS["layer"][1]
BOUNCES_INFINITE = 2**32 - 1


class Result(enum.IntEnum):
    """What a call of the library found wrong."""

    OK = 0
    ARGUMENT = 1
    MEMORY = 2
    FILE = 3
    FORMAT = 4
    VERSION = 5
    CHECKSUM = 6
    UNSUPPORTED = 7
    EMPTY = 8
    CANCELLED = 9
    GPU = 10
    INCOMPLETE = 11


class Error(Exception):
    """A call of the library failed. `result` says how (a `Result`), the message what and where."""

    def __init__(self, result: Result, message: str):
        super().__init__(message)
        self.result = result


class Struct(ctypes.Structure):
    """A structure of the headers. `enumerators` names those of its members that hold one."""

    enumerators: dict[str, str] = {}


REPORT = CFUNCTYPE(c_bool, c_void_p, c_char_p, c_float)


class Vec2(Struct):
    _fields_ = [("x", c_float), ("y", c_float)]


class Vec3(Struct):
    _fields_ = [("x", c_float), ("y", c_float), ("z", c_float)]


class Progress(Struct):
    _fields_ = [("report", REPORT), ("user", c_void_p)]


class Grid(Struct):
    _fields_ = [("origin", Vec3), ("spacing", Vec3), ("count", c_uint32 * 3)]


class ProbesInfo(Struct):
    _fields_ = [("count", c_uint32), ("buried", c_uint32), ("has_grid", c_bool), ("grid", Grid)]


class MapsInfo(Struct):
    _fields_ = [("size", c_uint32), ("samples", c_uint32), ("distance_scale_metres", c_float), ("compressed", c_bool),
                ("geometry_blocks", c_bool)]


class IrradianceInfo(Struct):
    _fields_ = [("probe_count", c_uint32), ("buried", c_uint32), ("grid", Grid), ("size", c_uint32), ("form", c_uint32)]


class ClassicInfo(Struct):
    _fields_ = [("size", c_uint32), ("cube_size", c_uint32), ("sharpness", c_float)]


class VolumeInfo(Struct):
    _fields_ = [("probe_count", c_uint32)]


class RelightInfo(Struct):
    _fields_ = [("surfels", c_uint32), ("links", c_uint32)]


class BouncesInfo(Struct):
    _fields_ = [("count", c_uint32), ("last", c_float)]


class BakedSceneInfo(Struct):
    _fields_ = [("bounds_min", Vec3), ("bounds_max", Vec3), ("light_count", c_uint32), ("hash", c_uint64)]


class BytesInfo(Struct):
    _fields_ = [(name, c_uint64) for name in
                ("file", "material", "direct", "indirect", "emission", "geometry", "normal", "distance", "pyramid", "radiance",
                 "irradiance", "moments", "classic", "volume", "relight", "selectors")] + [("select", c_uint64 * 4)]


class FieldInfo(Struct):
    _fields_ = [("probes", ProbesInfo), ("maps", MapsInfo), ("irradiance", IrradianceInfo), ("classic", ClassicInfo),
                ("volume", VolumeInfo), ("relight", RelightInfo), ("select_mask", c_uint32), ("bounces", BouncesInfo),
                ("scene", BakedSceneInfo), ("bytes", BytesInfo)]


class SampleSettings(Struct):
    _fields_ = [("tracer", c_uint32), ("select", c_uint32), ("visibility", c_uint32), ("max_probes", c_uint32),
                ("keep_buried", c_bool), ("emitters", c_bool), ("hits", c_uint32), ("surface_tolerance", c_float),
                ("visibility_only", c_bool)]


class TraceHit(Struct):
    _fields_ = [("status", c_uint32), ("distance_metres", c_float), ("position", Vec3), ("normal", Vec3),
                ("radiance", Vec3), ("lobe", Vec3), ("emission", Vec3), ("emitter", c_bool), ("probe", c_uint32),
                ("texel", c_uint32), ("footprint_metres", c_float), ("texel_steps", c_uint32),
                ("probes_tried", c_uint32)]


class LobeFilter(Struct):
    _fields_ = [("radius_pixels", c_uint32), ("stride_pixels", c_uint32), ("history", c_float),
                ("still_history", c_float), ("reach", c_float)]


class DenoiseSettings(Struct):
    _fields_ = [("diffuse", LobeFilter), ("glossy", LobeFilter), ("ray_spacing", c_uint32)]


class Camera(Struct):
    _fields_ = [("name", c_char * 64), ("eye", Vec3), ("target", Vec3), ("up", Vec3), ("fov_y_degrees", c_float)]


class SceneInfo(Struct):
    _fields_ = [("triangles", c_uint64), ("vertices", c_uint64), ("materials", c_uint32), ("textures", c_uint32),
                ("lights", c_uint32), ("cameras", c_uint32), ("warnings", c_uint32), ("origin", c_double * 3),
                ("bounds_min", Vec3), ("bounds_max", Vec3), ("has_probe_volume", c_bool), ("has_probe_count", c_bool), ("hash", c_uint64)]


class SceneLimits(Struct):
    _fields_ = [("triangles", c_uint64), ("texels", c_uint64), ("polygon_corners", c_uint32),
                ("materials", c_uint32), ("nodes", c_uint32)]


class SceneLoadSettings(Struct):
    _fields_ = [("limits", SceneLimits), ("allow_outside", c_bool), ("instructions", c_uint32)]


class PlaceSettings(Struct):
    _fields_ = [("method", c_uint32), ("count", c_uint32), ("coverage", c_float), ("budget_mb", c_double),
                ("views", c_uint32), ("grid", Grid), ("resolution", c_uint32), ("min_cosine", c_float),
                ("max_footprint", c_float), ("optimize", c_uint32), ("reward", c_uint32), ("rounds", c_uint32),
                ("surfels", c_uint32), ("candidates", c_uint32), ("voxel_size", c_float), ("voxels", c_uint32),
                ("refinements", c_uint32), ("seed", c_uint32), ("threads", c_uint32), ("marks", c_bool),
                ("field_size", c_bool)]


class PlacedProbe(Struct):
    _fields_ = [("position", Vec3), ("origin", c_uint32), ("gain", c_float), ("buried", c_bool)]


class PlaceReport(Struct):
    _fields_ = [("surfels", c_uint64), ("coverage", c_double), ("visible", c_double), ("coverage_by_area", c_double),
                ("coverable", c_double), ("grazing", c_double), ("restricted", c_double), ("missed", c_double),
                ("unreachable", c_double), ("reached_m2", c_double), ("unreached_m2", c_double), ("buried", c_uint32),
                ("rejected", c_uint32), ("candidates", c_uint32),
                ("coverage_before", c_double), ("reward_before", c_double), ("reward_after", c_double),
                ("rounds", c_uint32), ("space_voxels", c_uint64), ("tiles", c_uint32), ("field_bytes", c_uint64),
                ("voxel_metres", c_float), ("seconds", c_double)]


class PlaceMark(Struct):
    _fields_ = [("position", Vec3), ("radius", c_float), ("kind", c_uint32)]


class ProbeSet(Struct):
    _fields_ = [("count", c_uint32), ("probes", POINTER(PlacedProbe)), ("mark_count", c_uint32),
                ("marks", POINTER(PlaceMark)), ("settings", PlaceSettings), ("report", PlaceReport),
                ("origin", c_double * 3), ("scene_hash", c_uint64)]


class BakeUnit(Struct):
    _fields_ = [("stage", c_char_p), ("round", c_uint32), ("unit", c_uint32), ("count", c_uint32), ("found", c_bool),
                ("seconds", c_double), ("bytes", c_uint64), ("why", c_char_p)]


class BakeWork(Struct):
    _fields_ = [("folder", c_char_p), ("fresh", c_bool), ("keep", c_bool), ("limit_bytes", c_uint64),
                ("part", c_uint32), ("parts", c_uint32), ("done", c_void_p), ("wait", c_void_p), ("user", c_void_p)]


class BakeSettings(Struct):
    _fields_ = [("grid", Grid), ("probes", POINTER(Vec3)), ("probe_count", c_uint32), ("select_mask", c_uint32),
                ("radiance_size", c_uint32), ("probe_light", c_bool), ("irradiance_grid", Grid),
                ("irradiance_size", c_uint32), ("irradiance_form", c_uint32), ("bounce_gather", c_uint32),
                ("uncompressed", c_bool), ("samples", c_uint32), ("light_samples", c_uint32), ("bounces", c_uint32), ("light", c_uint32),
                ("noise", c_float), ("reference_paths", c_uint32), ("volume_cells", c_uint32), ("classic", c_bool),
                ("classic_size", c_uint32), ("classic_cube_size", c_uint32), ("classic_sharpness", c_uint32),
                ("relight", c_bool), ("fit", c_bool), ("seed", c_uint32), ("threads", c_uint32),
                ("measure_embree", c_bool), ("raster", c_void_p), ("memory_limit_bytes", c_uint64), ("work", BakeWork)]


class BakeStats(Struct):
    _fields_ = [("rays", c_uint64), ("primary_rays", c_uint64), ("seconds", c_double), ("light_seconds", c_double),
                ("irradiance_seconds", c_double), ("capture_seconds", c_double), ("surfels", c_uint32),
                ("noise", c_double), ("light_bytes", c_uint64), ("volume_probes", c_uint32),
                ("volume_cells", c_uint32), ("volume_bytes", c_uint64), ("volume_unserved", c_double),
                ("volume_seconds", c_double), ("write_seconds", c_double), ("classic_seconds", c_double),
                ("relight_seconds", c_double), ("embree_seconds", c_double),
                ("raster_seconds", c_double), ("raster_rays", c_uint64), ("peak_memory_bytes", c_uint64),
                ("file_bytes", c_uint64), ("buried", c_uint32), ("irradiance_buried", c_uint32), ("unseen", c_double),
                ("reused_rays", c_uint64)]


class Image(Struct):
    _fields_ = [("width", c_uint32), ("height", c_uint32), ("layers", POINTER(Vec3) * 8), ("bounces_known", c_bool),
                ("bounces", c_uint32)]


class RenderSettings(Struct):
    _fields_ = [("width", c_uint32), ("height", c_uint32), ("spp", c_uint32), ("bounces", c_uint32),
                ("method", c_uint32), ("diffuse", c_uint32), ("diffuse_samples", c_uint32),
                ("glossy_samples", c_uint32), ("seed", c_uint32), ("dim_lobe", c_float), ("centered", c_bool),
                ("denoise", DenoiseSettings), ("standard_error", c_bool), ("threads", c_uint32),
                ("sample", SampleSettings)]


class RenderStats(Struct):
    _fields_ = [("seconds", c_double), ("primary_seconds", c_double), ("direct_seconds", c_double),
                ("diffuse_seconds", c_double), ("glossy_seconds", c_double), ("denoise_seconds", c_double),
                ("rays", c_uint64), ("field_rays", c_uint64), ("field_unresolved", c_uint64),
                ("field_steps", c_uint64), ("field_probes", c_uint64)]


class Metrics(Struct):
    _fields_ = [("mse", c_double), ("relative_mse", c_double), ("psnr", c_double), ("bias", c_double),
                ("max", c_double)]


class PerceptualSettings(Struct):
    _fields_ = [("exposure", c_float), ("pixels_per_degree", c_float), ("threads", c_uint32)]


class Perceptual(Struct):
    _fields_ = [("ssim", c_double), ("flip", c_double)]


SampleSettings.enumerators = {"tracer": "tracer", "select": "select", "visibility": "visibility", "hits": "hits"}
IrradianceInfo.enumerators = {"form": "irradiance_form"}
PlaceSettings.enumerators = {"method": "place_method", "optimize": "place_optimizer", "reward": "place_reward"}
PlacedProbe.enumerators = {"origin": "probe_origin"}
BakeSettings.enumerators = {"irradiance_form": "irradiance_form", "bounce_gather": "bounce_gather", "light": "bake_light"}
RenderSettings.enumerators = {"method": "method", "diffuse": "diffuse"}


class Opaque(Struct):
    """What only the library sees the inside of."""


class FieldHandle(Opaque):
    """olx_field"""


class SceneHandle(Opaque):
    """olx_scene"""


_field, _scene, _sample = POINTER(FieldHandle), POINTER(SceneHandle), POINTER(SampleSettings)
_vectors, _progress, _image = POINTER(Vec3), POINTER(Progress), POINTER(Image)

# The result and the arguments of each function that the package calls.
RUNTIME = {
    "olx_version": (c_char_p, []),
    "olx_last_error": (c_char_p, []),
    "olx_field_open": (c_int, [c_char_p, POINTER(_field)]),
    "olx_field_close": (None, [_field]),
    "olx_field_describe": (FieldInfo, [_field]),
    "olx_field_origin": (None, [_field, POINTER(c_double)]),
    "olx_field_probe_position": (Vec3, [_field, c_uint32]),
    "olx_field_probe_buried": (c_bool, [_field, c_uint32]),
    "olx_field_verify": (c_int, [_field]),
    "olx_sample_settings_default": (SampleSettings, []),
    "olx_sample_settings_check": (c_int, [_field, _sample]),
    "olx_trace_rays": (None, [_field, _sample, c_uint32, _vectors, _vectors, c_float, POINTER(TraceHit)]),
    "olx_irradiance_points": (None, [_field, _sample, c_uint32, _vectors, _vectors, _vectors, _vectors]),
    "olx_volume_irradiance_points": (None, [_field, c_uint32, _vectors, _vectors, _vectors]),
    "olx_surface_irradiance_points": (None, [_field, _sample, c_uint32, _vectors, _vectors, _vectors, _vectors, _vectors]),
    "olx_glossy_rays": (None, [_field, _sample, c_uint32, _vectors, _vectors, _vectors, POINTER(c_float), POINTER(Vec2), _vectors,
                               POINTER(c_float), POINTER(c_float)]),
}
BAKER = {
    "olx_scene_load": (c_int, [c_char_p, POINTER(_scene)]),
    "olx_scene_free": (None, [_scene]),
    "olx_scene_describe": (SceneInfo, [_scene]),
    "olx_scene_warning": (c_char_p, [_scene, c_uint32]),
    "olx_scene_camera": (Camera, [_scene, c_uint32]),
    "olx_scene_find_camera": (c_int, [_scene, c_char_p, POINTER(Camera)]),
    "olx_scene_probe_grid": (c_int, [_scene, POINTER(c_uint32), POINTER(Grid)]),
    "olx_builtin_name": (c_char_p, [c_uint32]),
    "olx_place_settings_default": (PlaceSettings, [_scene]),
    "olx_place": (c_int, [_scene, POINTER(PlaceSettings), _progress, POINTER(ProbeSet)]),
    "olx_probe_set_free": (None, [POINTER(ProbeSet)]),
    "olx_probe_set_save": (c_int, [POINTER(ProbeSet), c_char_p]),
    "olx_bake_settings_default": (BakeSettings, [_scene]),
    "olx_bake_irradiance_grid": (Grid, [POINTER(Grid)]),
    "olx_bake_size_for_budget": (c_int, [_scene, POINTER(BakeSettings), c_double, POINTER(c_uint32)]),
    "olx_bake": (c_int, [_scene, POINTER(BakeSettings), c_char_p, _progress, POINTER(BakeStats)]),
    "olx_bake_join": (c_int, [c_char_p, c_char_p, c_bool, _progress, POINTER(BakeStats)]),
    "olx_render_settings_default": (RenderSettings, [c_uint32]),
    "olx_render": (c_int, [_scene, _field, POINTER(Camera), POINTER(RenderSettings), _progress, _image, POINTER(RenderStats)]),
    "olx_image_load": (c_int, [c_char_p, _image]),
    "olx_image_save": (c_int, [_image, c_char_p]),
    "olx_image_free": (None, [_image]),
    "olx_compare": (c_int, [_image, _image, c_uint32, POINTER(Metrics)]),
    "olx_perceptual_settings_default": (PerceptualSettings, []),
    "olx_compare_perceptual": (c_int, [_image, _image, c_uint32, POINTER(PerceptualSettings), POINTER(c_float),
                                       POINTER(Perceptual)]),
}


class Library:
    """The functions of the libraries that were found, as attributes.

    liboctalux-bake.so has all of them; where it is not there, or what it loads is not, liboctalux.so has those of the runtime.
    """

    def __init__(self) -> None:
        named = os.environ.get("OCTALUX_LIBRARIES")
        folder = pathlib.Path(named) if named else pathlib.Path(__file__).parent / "lib"
        problems = []
        for name, functions in (("liboctalux-bake.so", {**RUNTIME, **BAKER}), ("liboctalux.so", RUNTIME)):
            try:
                library = ctypes.CDLL(str(folder / name))
            except OSError as error:
                problems.append(str(error))
                continue
            for function, (result, arguments) in functions.items():
                bound = getattr(library, function)
                bound.restype, bound.argtypes = result, arguments
                setattr(self, function, bound)
            self.baker_problem = "; ".join(problems)
            return
        raise ImportError("Octalux's libraries cannot be loaded (OCTALUX_LIBRARIES may name their folder): " + "; ".join(problems))

    def __getattr__(self, name: str) -> Any:
        if name in BAKER:
            raise Error(Result.UNSUPPORTED, f"{name}: liboctalux-bake could not be loaded: {self.baker_problem}")
        raise AttributeError(name)


library = Library()


def check(result: int) -> None:
    """Raise the library's last message unless all went well."""
    if result != Result.OK:
        raise Error(Result(result), library.olx_last_error().decode(errors="replace"))


def word(kind: str, value: int) -> str:
    """The word for an enumerator's value."""
    return ENUMERATORS[kind][1][value]


def number(kind: str, value: str) -> int:
    """The value of an enumerator, by its word."""
    words = ENUMERATORS[kind][1]
    if value not in words:
        raise ValueError(f"{value!r} is not one of {', '.join(words)}")
    return words.index(value)


def vec3(value: Any) -> Vec3:
    """Three numbers as the library takes them."""
    x, y, z = (float(v) for v in value)
    return Vec3(x, y, z)


def _convert(struct: Struct, name: str, kind: Any, value: Any) -> Any:
    if name in struct.enumerators and isinstance(value, str):
        return number(struct.enumerators[name], value)
    if kind is Vec3:
        return vec3(value)
    if kind is c_char_p and value is not None:
        return os.fsencode(value)
    if kind in (c_uint32, c_uint64):
        most = 2 ** (8 * ctypes.sizeof(kind)) - 1
        whole = int(value)
        if whole != value or not 0 <= whole <= most:
            raise ValueError(f"{name}: {value!r} is not a whole number from 0 to {most}")
        return whole
    return value


def fill(struct: Struct, values: dict[str, Any]) -> None:
    """Put values into members by their names."""
    kinds = dict(struct._fields_)
    for name, value in values.items():
        if name not in kinds:
            raise TypeError(f"there is no setting {name!r}; there are {', '.join(kinds)}")
        if isinstance(value, dict):
            fill(getattr(struct, name), value)
        else:
            setattr(struct, name, _convert(struct, name, kinds[name], value))


def record(struct: Struct) -> SimpleNamespace:
    """A copy of a structure that lives by itself: vectors are tuples, enumerators words."""
    return SimpleNamespace(**{name: _plain(struct, name, getattr(struct, name)) for name, _ in struct._fields_})


def _plain(struct: Struct, name: str, value: Any) -> Any:
    if name in struct.enumerators:
        return word(struct.enumerators[name], value)
    if isinstance(value, (Vec2, Vec3)):
        return tuple(getattr(value, part) for part, _ in value._fields_)
    if isinstance(value, Struct):
        return record(value)
    if isinstance(value, ctypes.Array):
        return tuple(value)
    return value.decode(errors="replace") if isinstance(value, bytes) else value


class Watch:
    """A call with progress: a Python function hears of it, and an exception, such as that of Ctrl-C, ends it."""

    def __init__(self, function: Any = None):
        self.function, self.raised, self.before = function, None, None
        self.progress = Progress(REPORT(self._report), None)

    def _report(self, _user: Any, stage: bytes, done: float) -> bool:
        wanted = True
        try:
            wanted = self.function is None or self.function(stage.decode(), done) is not False
        except BaseException as error:  # raised again once the call has returned
            self.raised = error
        return wanted and self.raised is None

    def _interrupt(self, number: int, frame: Any) -> None:
        """Keep what the handler of before raises: Python would drop an exception at the beginning of a callback."""
        try:
            self.before(number, frame)
        except BaseException as error:
            self.raised = error

    def call(self, function: Any, *arguments: Any) -> None:
        """Call a function of the library. Raise what was raised on the way, else as `check`."""
        handles = threading.current_thread() is threading.main_thread() and callable(signal.getsignal(signal.SIGINT))
        if handles:
            self.before = signal.signal(signal.SIGINT, self._interrupt)
        try:
            result = function(*arguments)
        finally:
            if handles:
                signal.signal(signal.SIGINT, self.before)
        if self.raised is not None:
            raise self.raised
        check(result)
