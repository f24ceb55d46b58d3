"""What scenes return: rows, linear models, modes."""
from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Optional

import numpy as np


class Run(Mapping):
    """Outputs of a run by name: `run["tip_y"]` is an array with a number for each time of `run.t` [s]."""

    def __init__(self, names: tuple[str, ...], units: dict[str, str], table: np.ndarray) -> None:
        self.names, self.table = names, table
        self.units = {name: units[name] for name in names}
        self._column = {name: k + 1 for k, name in enumerate(names)}

    @property
    def t(self) -> np.ndarray:
        return self.table[:, 0]

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self._column:
            raise KeyError(f"{name}: there is no such output, but {', '.join(self.names)}")
        return self.table[:, self._column[name]]

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)

    def __repr__(self) -> str:
        outputs = ", ".join(f"{name} [{unit}]" for name, unit in self.units.items())
        return f"Run of {len(self.table)} rows: {outputs}"


@dataclass(frozen=True, eq=False)
class Linear:
    """d/dt x = A x + B u, y = C x + D u about the start. `A, B, C, D = scene.linear()`, `control.ss(*scene.linear())`."""

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    state_units: tuple[str, ...]
    input_units: tuple[str, ...]
    output_units: tuple[str, ...]
    point: dict[str, float]  # the steady state that it is about

    def __iter__(self) -> Iterator[np.ndarray]:
        return iter((self.A, self.B, self.C, self.D))


@dataclass(frozen=True, eq=False)
class Modes:
    """Modes about the start, slowest first, an element for each."""

    undamped: np.ndarray  # [rad/s] modulus of the eigenvalue
    damped: np.ndarray  # [rad/s] its imaginary part
    damping: np.ndarray  # ratio
    growth: np.ndarray  # [1/s] its real part
    what: tuple[str, ...]  # moves, with shares of the kinetic energy
    names: tuple[str, ...]  # flap 1, lag 1, ..; empty: it has none

    def __len__(self) -> int:
        return len(self.what)


class Advice(str):
    """What a scene chooses: the text, and its numbers as fields of `.fields`, those of the scene also as attributes.

    >>> advice = scene.advise()
    >>> advice.integrator, advice.step, advice.steps, advice.units["step"]
    >>> advice.bodies["beam"]["modes"], advice.bodies["beam"]["error"]["modes"]
    """

    integrator: Optional[str]  # None, as the next two: a scene without duration
    step: Optional[float]  # [s] the longest
    steps: Optional[float]  # of the run
    chosen: Optional[bool]  # False: the scene gives the step
    warning: str  # the first; empty: none
    bodies: dict[str, dict]  # those that ask for advice: tolerance, effects, modes, step, deflection, error, without, ..
    units: dict[str, str]

    def __new__(cls, text: str, fields: dict) -> "Advice":
        self = super().__new__(cls, text)
        self.fields = fields
        for name in cls.__annotations__:
            setattr(self, name, fields.get(name))
        return self


@dataclass(frozen=True, eq=False)
class Campbell:
    """Modes over a parameter: a row for each value, a column for each mode, which is followed by its shape."""

    parameter: str
    values: np.ndarray
    spin: np.ndarray  # [rad/s] of what spins fastest: its multiples are the lines per revolution
    names: tuple[str, ...]  # of columns: flap 1, lag 1, ..
    damped: np.ndarray  # [rad/s] values x modes, columns by frequency; nan where a mode is not there
    growth: np.ndarray  # [1/s] values x modes

    def __getitem__(self, name: str) -> np.ndarray:
        """The damped frequencies of that name."""
        return self.damped[:, self.names.index(name)]
