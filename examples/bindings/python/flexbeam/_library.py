"""The shared library by ctypes: the functions of flexbeam_scene.h, no more."""
from __future__ import annotations

import ctypes
import os
import sys
from ctypes import POINTER, c_char_p, c_double, c_int, c_size_t, c_void_p
from pathlib import Path

PARAMETERS, INPUTS, OUTPUTS, STATES, LINEAR_INPUTS, LINEAR_OUTPUTS, POINT, MODES, MODE_NAMES, CURVES = range(10)
A, B, C, D, POINT_VALUES, MODE_VALUES, CURVE_VALUES = range(7)
INTERFACE = 1

_DOUBLES, _INTS = POINTER(c_double), POINTER(c_int)
_FUNCTIONS = {  # name: (what it returns, what it takes)
    "interface": (c_int, []),
    "version": (c_char_p, []),
    "new": (c_void_p, []),
    "free": (None, [c_void_p]),
    "open": (c_int, [c_void_p, c_char_p, c_char_p, c_int, POINTER(c_char_p), _DOUBLES]),
    "error": (c_char_p, [c_void_p]),
    "error_file": (c_char_p, [c_void_p]),
    "error_line": (c_int, [c_void_p]),
    "error_word": (c_char_p, [c_void_p]),
    "count": (c_int, [c_void_p, c_int]),
    "name": (c_char_p, [c_void_p, c_int, c_int]),
    "unit": (c_char_p, [c_void_p, c_int, c_int]),
    "set": (c_int, [c_void_p, c_int, c_int, _INTS, _DOUBLES]),
    "get": (c_int, [c_void_p, c_int, c_int, _INTS, _DOUBLES]),
    "time": (c_double, [c_void_p]),
    "duration": (c_double, [c_void_p]),
    "interval": (c_double, [c_void_p]),
    "step_to": (c_int, [c_void_p, c_double]),
    "run": (c_int, [c_void_p, c_int, _DOUBLES, _INTS]),
    "reset": (c_int, [c_void_p]),
    "save": (c_int, [c_void_p, c_char_p, c_size_t, POINTER(c_size_t)]),
    "restore": (c_int, [c_void_p, c_char_p, c_size_t]),
    "linear": (c_int, [c_void_p]),
    "modes": (c_int, [c_void_p]),
    "campbell": (c_int, [c_void_p, c_char_p, c_double, c_double, c_int]),
    "matrix": (c_int, [c_void_p, c_int, _DOUBLES, c_size_t]),
    "advice": (c_char_p, [c_void_p]),
    "advice_json": (c_char_p, [c_void_p]),
}


class Library:
    """The functions as attributes, without their prefix."""

    def __init__(self) -> None:
        name = {"win32": "flexbeam_scene.dll", "darwin": "libflexbeam_scene.dylib"}
        beside = Path(__file__).parent / name.get(sys.platform, "libflexbeam_scene.so")
        library = ctypes.CDLL(os.environ.get("FLEXBEAM_LIBRARY", str(beside)))
        for function, (returns, takes) in _FUNCTIONS.items():
            call = getattr(library, "fbs_" + function)
            call.restype, call.argtypes = returns, takes
            setattr(self, function, call)
        if self.interface() != INTERFACE:
            raise ImportError(f"{library._name} has interface {self.interface()}, this package wants {INTERFACE}")


library = Library()
version = library.version().decode()


def doubles(array):
    """The numbers of a contiguous array of float64."""
    return array.ctypes.data_as(_DOUBLES)
