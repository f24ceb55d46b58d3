"""A scene that runs."""
from __future__ import annotations

import ctypes
import json
import os
import threading
from collections.abc import Iterable, Mapping
from typing import Optional, Union

import numpy as np

from . import _library as c
from .description import Description
from .results import Advice, Campbell, Linear, Modes, Run

CHUNK = 256  # rows of a call, between which Python takes signals


class FlexbeamError(ValueError):
    """What was refused. `file` (None: of no file), `line` (0: about the whole) and `word` tell what it is about."""

    def __init__(self, text: str, file: Optional[str], line: int, word: str) -> None:
        super().__init__(text, file, line, word)
        self.file, self.line, self.word = file, line, word

    def __str__(self) -> str:
        return str(self.args[0])


class StepRefused(FlexbeamError):
    """The motion cannot be stepped so; the state is as before. `run`: rows up to there, of Scene.run."""

    run: Optional[Run] = None


def _number(name: str, value: object) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        raise FlexbeamError(f"{name}: {value!r} is no number", None, 0, str(name)) from None


class Scene:
    """A scene of examples/scenes/README.md.

    source: the name of a file; or the text itself, of more than one line; or a Description. Files that a text names are
    looked for in `folder`. Parameters of the scene have other values by keyword, or in a mapping:

    >>> run = Scene("examples/scenes/rotor.txt", rate=40).run()
    >>> run.t, run["tip_1"], run.units["tip_1"]

    Units are SI and radians. A scene is used by one thread at a time; several run in as many threads as wanted.
    """

    def __init__(self, source: Union[str, os.PathLike, Description], parameters: Optional[Mapping[str, float]] = None, /,
                 *, folder: Union[str, os.PathLike] = "", **more: float) -> None:
        given = {**(parameters or {}), **more}
        is_text = isinstance(source, Description) or (isinstance(source, str) and "\n" in source)
        name = os.path.join(folder, "text") if is_text else os.fspath(source)
        values = np.array([_number(*one) for one in given.items()])
        if "\0" in str(source):
            raise FlexbeamError("a text has no character 0", None, 0, "")
        self._handle = c.library.new()
        if not self._handle:
            raise MemoryError("no memory for one more scene")
        self._lock = threading.RLock()
        self._source, self._folder = source, folder
        keys = (ctypes.c_char_p * max(1, len(given)))(*[key.encode() for key in given])
        self._check(c.library.open(self._handle, os.fsencode(name), str(source).encode() if is_text else None, len(given),
                                   keys, c.doubles(values)))
        self._given = given
        self._units: dict[str, str] = {"time": "s"}
        self._index: dict[int, dict[str, int]] = {}
        for kind in (c.OUTPUTS, c.INPUTS, c.PARAMETERS):
            names = self._names(kind)
            self._index[kind] = {name: k for k, name in enumerate(names)}
            self._units.update(zip(names, self._units_of(kind)))

    def close(self) -> None:
        """Gives its memory back; without it that is done when nobody uses the scene any more."""
        handle, self._handle = getattr(self, "_handle", None), None
        if handle:
            c.library.free(handle)

    __del__ = close

    def __reduce__(self) -> str:
        raise TypeError("a Scene is not copied or pickled: open it again, its save() goes to restore() there")

    @property
    def _scene(self) -> int:
        if self._handle is None:
            raise FlexbeamError("the scene is closed", None, 0, "")
        return self._handle

    def __enter__(self) -> Scene:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"Scene at {self.time:g} s: outputs {', '.join(self.outputs)}"

    def _check(self, status: int, run: Optional[Run] = None) -> None:
        if status != 0:
            text, file, word = (f(self._scene).decode(errors="replace")
                                for f in (c.library.error, c.library.error_file, c.library.error_word))
            kind = StepRefused if status == 2 else FlexbeamError
            error = kind(text, file or None, c.library.error_line(self._scene), word)
            if isinstance(error, StepRefused):
                error.run = run
            raise error

    def _names(self, kind: int) -> tuple[str, ...]:
        return tuple(c.library.name(self._scene, kind, k).decode() for k in range(c.library.count(self._scene, kind)))

    def _units_of(self, kind: int) -> tuple[str, ...]:
        return tuple(c.library.unit(self._scene, kind, k).decode() for k in range(c.library.count(self._scene, kind)))

    def _find(self, name: str, *kinds: int) -> tuple[int, int]:
        for kind in kinds:
            if name in self._index[kind]:
                return kind, self._index[kind][name]
        all_names = ", ".join(name for kind in kinds for name in self._index[kind])
        raise FlexbeamError(f"{name}: there is no such name, but {all_names}", None, 0, str(name))

    # what there is

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of its parameters, and settings.step [s], the longest step (0: as the scene says)."""
        return tuple(self._index[c.PARAMETERS])

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of what adds to its loads, motors, actuators, rotors, references and motions; they begin at 0."""
        return tuple(self._index[c.INPUTS])

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of its outputs, the columns of its CSV file."""
        return tuple(self._index[c.OUTPUTS])

    @property
    def units(self) -> dict[str, str]:
        """Of all those by name."""
        return dict(self._units)

    @property
    def time(self) -> float:
        """[s]"""
        return c.library.time(self._scene)

    @property
    def duration(self) -> float:
        """[s] as the scene says; 0: it computes its start alone."""
        with self._lock:
            return c.library.duration(self._scene)

    @property
    def interval(self) -> float:
        """[s] between its rows."""
        with self._lock:
            return c.library.interval(self._scene)

    # numbers

    def set(self, name: Union[str, Mapping[str, float], None] = None, value: Optional[float] = None, /,
            **more: float) -> None:
        """An input, which holds until it is set again, or before the first step a parameter: set("torque.hub", 3),
        set({"torque.hub": 3, "force.tip": 0}), set(spin=6)."""
        given = dict(name) if isinstance(name, Mapping) else {} if name is None else {name: value}
        given.update(more)
        found = [self._find(key, c.INPUTS, c.PARAMETERS) for key in given]
        with self._lock:
            for kind in (c.INPUTS, c.PARAMETERS):
                values = np.array([_number(*one) for one, (of, _) in zip(given.items(), found) if of == kind])
                index = [at for of, at in found if of == kind]
                self._check(c.library.set(self._scene, kind, len(index), (ctypes.c_int * max(1, len(index)))(*index),
                                          c.doubles(values)))

    def get(self, name: Union[str, Iterable[str], None] = None) -> Union[float, np.ndarray, dict[str, float]]:
        """The present number of an output, input or parameter; an array of several names; a dict of all outputs."""
        if name is None:
            return dict(zip(self.outputs, self._read(c.OUTPUTS).tolist()))
        if not isinstance(name, str):
            return np.array([self.get(one) for one in name])
        kind, index = self._find(name, c.OUTPUTS, c.INPUTS, c.PARAMETERS)
        value = ctypes.c_double()
        with self._lock:
            self._check(c.library.get(self._scene, kind, 1, ctypes.c_int(index), value))
        return value.value

    def _read(self, kind: int) -> np.ndarray:
        values = np.zeros(len(self._index[kind]))
        with self._lock:
            self._check(c.library.get(self._scene, kind, len(values), None, c.doubles(values)))
        return values

    # motion

    def step_to(self, time: float) -> None:
        """Up to that time [s], in steps of the scene's own; between rows of the scene with the bits of its run."""
        time = _number("step_to", time)
        with self._lock:
            if not time >= self.time:
                raise FlexbeamError(f"a step to {time} s, while the time is {self.time} s", None, 0, str(time))
            self._check(c.library.step_to(self._scene, time))

    def run(self, until: Optional[float] = None) -> Run:
        """From the present time to the row nearest to `until` [s] (the duration of the scene): a row now and at each
        interval of the scene."""
        until = self.duration if until is None else _number("until", until)
        if self.duration == 0:
            raise FlexbeamError("a run of a scene without duration: get() has its start", None, 0, "")
        if not until > self.time:
            raise FlexbeamError(f"a run to {until} s, while the time is {self.time} s", None, 0, str(until))
        rows = round(until / self.interval) - int(self.time / self.interval + 1e-6) if self.interval > 0 else 1
        table = np.zeros((1 + rows, 1 + len(self.outputs)))
        made = 1
        with self._lock:
            table[0] = [self.time, *self._read(c.OUTPUTS)]
            while made <= rows:
                now = ctypes.c_int()
                status = c.library.run(self._scene, min(CHUNK, rows + 1 - made), c.doubles(table[made:]), now)
                made += now.value
                self._check(status, Run(self.outputs, self._units, table[:made]))
        return Run(self.outputs, self._units, table)

    def reset(self, **parameters: float) -> None:
        """As it was opened: time 0, no inputs; with other values of parameters, if they are given."""
        with self._lock:
            self._check(c.library.reset(self._scene))
            self.set(**parameters)

    def save(self) -> bytes:
        """All that changes, for `restore` of this scene or of another one of the same text."""
        size = ctypes.c_size_t()
        with self._lock:
            self._check(c.library.save(self._scene, None, 0, size))
            saved = ctypes.create_string_buffer(size.value)
            self._check(c.library.save(self._scene, saved, size.value, size))
        return saved.raw

    def restore(self, saved: bytes) -> None:
        """The state that was saved: what follows has the same bits."""
        with self._lock:
            self._check(c.library.restore(self._scene, saved, len(saved)))

    # about the start

    def _matrix(self, which: int, *shape: int) -> np.ndarray:
        matrix = np.zeros(shape)
        self._check(c.library.matrix(self._scene, which, c.doubles(matrix), matrix.size))
        return matrix

    def linear(self) -> Linear:
        """The linear model about the start: inputs are loads, motors, actuators and rotors, those of controllers too, by names
        of their own (motor.axle.1 is motor.axle[1] of `set`); a load in multiples of its vector, as its unit says."""
        kinds = (c.STATES, c.LINEAR_INPUTS, c.LINEAR_OUTPUTS)
        with self._lock:
            self._check(c.library.linear(self._scene))
            names = [self._names(kind) for kind in kinds]
            n, inputs, outputs = map(len, names)
            at = self._names(c.POINT)
            point = dict(zip(at, self._matrix(c.POINT_VALUES, len(at)).tolist()))
            return Linear(self._matrix(c.A, n, n), self._matrix(c.B, n, inputs), self._matrix(c.C, outputs, n),
                          self._matrix(c.D, outputs, inputs), *names, *map(self._units_of, kinds), point)

    def modes(self) -> Modes:
        """Every mode about the start, slowest first; of an exact beam the twelve slowest."""
        with self._lock:
            self._check(c.library.modes(self._scene))
            what = self._names(c.MODES)
            return Modes(*self._matrix(c.MODE_VALUES, len(what), 4).T.copy(), what, self._names(c.MODE_NAMES))

    def campbell(self, parameter: str, first: float, last: float, n: int = 21) -> Campbell:
        """Modes over n values of a parameter, followed through crossings by their complex shapes, weighted by mass, as
        `scene --campbell` does. This scene stays as it is."""
        with self._lock:
            self._check(c.library.campbell(self._scene, parameter.encode(), _number(parameter, first), _number(parameter, last), n))
            names = self._names(c.CURVES)
            table = self._matrix(c.CURVE_VALUES, n, 2 + 2 * len(names))
        return Campbell(parameter, *table[:, :2].T.copy(), names, table[:, 2::2].copy(), table[:, 3::2].copy())

    def advise(self) -> Advice:
        """What the scene chooses where it leaves the choice: effects, modes, integrator, step; what may be wrong."""
        with self._lock:
            text = c.library.advice(self._scene)
            self._check(3 if text is None else 0)
            return Advice(text.decode(), json.loads(c.library.advice_json(self._scene)))
