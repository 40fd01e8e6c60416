"""What fields and scenes have in common: an object of the library that is released once."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any

from .native import library

if TYPE_CHECKING:
    from typing_extensions import Self


class Handle:
    """An object of the library. Close it, or use it in a `with`; closing again does nothing."""

    _release: str  # name of the function that releases the handle
    _what: str

    def __init__(self, kind: Any):
        self._handle = ctypes.POINTER(kind)()

    def close(self) -> None:
        """Release what the library holds; arrays that came from it stay. Closing again does nothing."""
        if getattr(self, "_handle", None):
            getattr(library, self._release)(self._handle)
            self._handle = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        self.close()

    @property
    def handle(self) -> Any:
        """The library's pointer, for further ctypes calls."""
        if not self._handle:
            raise ValueError("the %s is closed" % self._what)
        return self._handle
