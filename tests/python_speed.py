"""How much longer a million rays take through Python than through C: python_speed.py FIELD.olx [RAYS [TURNS]].

olx_trace_rays is called from C, by a library that is compiled here, and through octalux.Field.trace, in turns, in one process, with the
same rays; processor time of the thread. Python's first row makes a new array for what was hit, as users do; C and the second row fill one
that is there. Fails when the fastest turn of either takes more than 1.3 times that of C.
"""

import ctypes
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np

import octalux
from octalux import arrays, native

MOST = 1.3
SOURCE = """
#include <octalux/sample.h>
typedef void (*trace_rays)(const olx_field *, const olx_sample_settings *, uint32_t, const olx_vec3 *, const olx_vec3 *, float, olx_trace_hit *);
void trace(trace_rays function, const olx_field *field, const olx_sample_settings *settings, uint32_t count, const olx_vec3 *origins,
           const olx_vec3 *directions, olx_trace_hit *hits) {
  function(field, settings, count, origins, directions, 1e30f, hits);
}
"""


def compiled(include):
    with tempfile.TemporaryDirectory() as folder:
        pathlib.Path(folder, "trace.c").write_text(SOURCE)
        subprocess.run(["cc", "-std=c17", "-O2", "-shared", "-fPIC", "-I", include, f"{folder}/trace.c", "-o", f"{folder}/trace.so"],
                       check=True)
        return ctypes.CDLL(f"{folder}/trace.so").trace


def rays(field, count):
    """Fans from points of the scene, as a picture's are: neighbours run alike."""
    random = np.random.default_rng(1)
    starts = field.positions[random.integers(0, len(field.positions), count // 1000 + 1)].repeat(1000, axis=0)[:count]
    around = random.normal(size=(count // 1000 + 1, 3)).repeat(1000, axis=0)[:count] + 0.1 * random.normal(size=(count, 3))
    directions = (around / np.linalg.norm(around, axis=1, keepdims=True)).astype(np.float32)
    return np.ascontiguousarray(starts, np.float32), directions


def main():
    field = octalux.open(sys.argv[1])
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 1_000_000
    turns = int(sys.argv[3]) if len(sys.argv) > 3 else 5
    trace = compiled(pathlib.Path(__file__).parent.parent / "include")
    trace.restype = None
    origins, directions = rays(field, count)
    settings, hits = native.library.olx_sample_settings_default(), np.zeros(count, octalux.HIT)
    seconds = {"C": [], "Python": [], "Python, out=": []}
    again = np.zeros(count, octalux.HIT)
    for _ in range(turns):
        begin = time.thread_time()
        trace(ctypes.cast(native.library.olx_trace_rays, ctypes.c_void_p), field.handle, ctypes.byref(settings), count,
              arrays.pointer(origins), arrays.pointer(directions), arrays.pointer(hits, native.TraceHit))
        seconds["C"].append(time.thread_time() - begin)
        for way, out in (("Python", None), ("Python, out=", again)):
            begin = time.thread_time()
            found = field.trace(origins, directions, t_max=1e30, out=out)
            seconds[way].append(time.thread_time() - begin)
            for name in octalux.HIT.names:  # bytes between members are undefined
                np.testing.assert_array_equal(found[name], hits[name])
    best = {way: min(times) for way, times in seconds.items()}
    ratio = max(best.values()) / best["C"]
    print(f"{count} rays, {turns} turns:", ", ".join(f"{way} {time_taken:.3f} s" for way, time_taken in best.items()), f"ratio {ratio:.3f}")
    return 0 if ratio <= MOST else 1


if __name__ == "__main__":
    sys.exit(main())
