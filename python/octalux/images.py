"""Pictures of a scene, and how two of them differ."""

from __future__ import annotations

import ctypes
import os
from types import SimpleNamespace
from typing import Any, Mapping

import numpy as np

from . import arrays, native
from .fields import Field, Progress
from .native import LAYERS, library
from .scenes import Scene


class Image:
    """Layers of 32-bit floats by their names: "beauty", "direct", "indirect_diffuse", "indirect_glossy", "albedo", "normal" and
    "standard_error" of shape (height, width, 3), "depth" of shape (height, width); row 0 is at the top. Light layers are radiance
    in W/(sr m^2), linear Rec.709; depth is in metres along the viewing axis, infinite for the sky.
    A layer may be replaced by an array of the same shape; `save` and `compare` raise ValueError for another shape.
    """

    def __init__(self, layers: Mapping[str, Any], bounces: int | None = None):
        """Layers of one size. bounces: how often indirect light left a surface before the one that is seen, where it is known."""
        self.layers: dict[str, np.ndarray] = {}
        self.bounces = bounces
        for name, values in layers.items():
            self.layers[name] = _layer(name, values)
        sizes = {array.shape[:2] for array in self.layers.values()}
        if len(sizes) != 1 or 0 in min(sizes):
            raise ValueError(f"layers of sizes {sorted(sizes)} where one is wanted")
        #: pixels
        self.height, self.width = sizes.pop()

    def __getitem__(self, layer: str) -> np.ndarray:
        return self.layers[layer]

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write an .exr (all layers, linear) or a .png (beauty, tone-mapped). Raises Error."""
        with _Borrowed(self) as image:
            native.check(library.olx_image_save(image, os.fsencode(path)))


def _layer(name: str, values: Any, size: tuple[int, int] | None = None) -> np.ndarray:
    """A layer as the library reads it, of that height and width where they are given."""
    native.number("layer", name)
    array = np.ascontiguousarray(values, dtype=np.float32)
    if array.ndim != (2 if name == "depth" else 3) or (name != "depth" and array.shape[2] != 3):
        raise ValueError(f"{name}: an array of shape {array.shape} is no layer of an image")
    if size is not None and array.shape[:2] != size:
        raise ValueError(f"{name}: an array of shape {array.shape} in an image of height {size[0]} and width {size[1]}")
    return array


class _Borrowed:
    """An olx_image whose layers are those of an `Image`, where callers may have put other arrays since it was made."""

    def __init__(self, image: Image):
        self.struct = native.Image(width=image.width, height=image.height)
        self.struct.bounces_known = image.bounces is not None
        self.struct.bounces = image.bounces or 0
        self.kept = []
        for name, values in image.layers.items():
            array = _layer(name, values, (image.height, image.width))
            if name == "depth":
                array = np.ascontiguousarray(np.stack([array, np.zeros_like(array), np.zeros_like(array)], -1))
            self.kept.append(array)
            self.struct.layers[LAYERS.index(name)] = arrays.pointer(array)

    def __enter__(self) -> native.Image:
        return self.struct

    def __exit__(self, *_: object) -> None:
        self.kept.clear()


def _taken(image: native.Image) -> Image:
    """A copy of what the library made, which is released."""
    shape, layers = (image.height, image.width, 3), {}
    for i, name in enumerate(LAYERS):
        if image.layers[i]:
            floats = ctypes.cast(image.layers[i], ctypes.POINTER(ctypes.c_float))
            array = np.ctypeslib.as_array(floats, shape)
            layers[name] = array[..., 0].copy() if name == "depth" else array.copy()
    bounces = image.bounces if image.bounces_known else None
    library.olx_image_free(image)
    return Image(layers, bounces)


def load_image(path: str | os.PathLike[str]) -> Image:
    """Read an .exr: one that Octalux wrote, or any with scanlines and channels R, G and B. Raises Error."""
    image = native.Image()
    native.check(library.olx_image_load(os.fsencode(path), image))
    return _taken(image)


def _camera(scene: Scene, value: Any) -> native.Camera:
    camera = native.Camera()
    if value is None or isinstance(value, str):
        native.check(library.olx_scene_find_camera(scene.handle, value.encode() if value else None, camera))
        return camera
    camera.name = value.name.encode()[:63]
    camera.eye, camera.target, camera.up = native.vec3(value.eye), native.vec3(value.target), native.vec3(value.up)
    camera.fov_y_degrees = value.fov_y_degrees
    return camera


def render(scene: Scene, field: Field | None = None, camera: Any = None, *, method: str | None = None,
           sample: Mapping[str, Any] | None = None, progress: Progress | None = None, **settings: Any) -> Image:
    """Render a picture of a scene.

    method: "field" (indirect light from the field), "path" (path tracing, the reference) or "classic"; default "field" with a
    field, else "path". camera: a name, or an object with name, eye, target, up and fov_y_degrees, as `Scene.cameras` has;
    default: the first, or one that sees the whole scene where there is none.
    sample: settings of `Field` for its rays. Further settings are the members of olx_render_settings (include/octalux/render.h):
    width=1280, height=720, spp=4 (path: 64), bounces (path: a count, default all), diffuse="surface", "irradiance" or "traced",
    diffuse_samples, glossy_samples=4, seed=0, standard_error=False, threads=0, ... Raises Error.
    """
    method = method or ("field" if field else "path")
    if field is None and method != "path":
        raise ValueError(f"method {method!r} needs a field")
    chosen = library.olx_render_settings_default(native.number("method", method))
    native.fill(chosen, {**settings, **({"sample": dict(sample)} if sample else {})})
    watch, image = native.Watch(progress), native.Image()
    watch.call(library.olx_render, scene.handle, field.handle if field else None, _camera(scene, camera), chosen, watch.progress,
               image, None)
    return _taken(image)


def compare(image: Image, reference: Image, layer: str = "beauty", *, exposure: float = 1.0) -> SimpleNamespace:
    """The error of a layer against a reference: mse, relative_mse, psnr (dB), bias, max, and for layers that are colours
    ssim (1: equal) and flip (0: equal) of both tone-mapped at `exposure`. Raises Error for sizes or layers that differ.
    """
    number, metrics, perceptual = native.number("layer", layer), native.Metrics(), native.Perceptual()
    with _Borrowed(image) as a, _Borrowed(reference) as b:
        native.check(library.olx_compare(a, b, number, metrics))
        if layer in ("normal", "depth"):
            return native.record(metrics)
        settings = library.olx_perceptual_settings_default()
        settings.exposure = exposure
        native.check(library.olx_compare_perceptual(a, b, number, settings, None, perceptual))
    return SimpleNamespace(**vars(native.record(metrics)), **vars(native.record(perceptual)))
