"""Octalux: real-time global illumination from precomputed light field probes.

    import octalux
    with octalux.Scene("builtin:cornell") as scene:
        octalux.bake(scene, "cornell.olx", radiance_size=128)
        with octalux.open("cornell.olx") as field:
            hits = field.trace(field.positions[0], [0, -1, 0])
            picture = octalux.render(scene, field, width=320, height=240)

Arrays of NumPy go in and come out; failures raise `octalux.Error` with the library's message. Long calls release Python's lock.
"""

import os as _os

from .fields import FOUND, HIT, MISS, UNKNOWN, Field, Glossy, Progress
from .images import Image, compare, load_image, render
from .native import Error, Result, library as _library
from .scenes import Probes, Scene, bake, builtin_scenes, join, place

__version__ = _library.olx_version().decode()
__all__ = ["Error", "FOUND", "Field", "Glossy", "HIT", "Image", "MISS", "Probes", "Progress", "Result", "Scene", "UNKNOWN", "bake",
           "builtin_scenes", "compare", "join", "load_image", "open", "place", "render"]


def open(path: "str | _os.PathLike[str]") -> Field:  # hides Python's open in this module alone
    """Open a field file. Raises Error."""
    return Field(path)
