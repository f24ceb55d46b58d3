"""What scenes return: rows, linear models, modes."""
from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

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

    def __len__(self) -> int:
        return len(self.what)


@dataclass(frozen=True, eq=False)
class Campbell:
    """Modes over a parameter: a row for each value, a column for each mode, which is followed."""

    parameter: str
    values: np.ndarray
    damped: np.ndarray  # [rad/s] values x modes, columns by their frequency at the first value
    growth: np.ndarray  # [1/s] values x modes


def _oscillating(model: Linear) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues above the real axis, slowest first, and what joints, bodies and outputs see of them, by columns. Elastic
    coordinates are left out: which of them is the first may change with the parameter."""
    value, vector = np.linalg.eig(model.A)
    keep = np.flatnonzero(value.imag > 1e-7 * np.abs(value).max(initial=0))
    keep = keep[np.argsort(np.abs(value[keep]))]
    plain = [k for k, name in enumerate(model.states) if not re.search(r"(^|[._])q\d+$|^mode\d", name)]
    seen = np.vstack([vector[plain], model.C @ vector])[:, keep]
    seen = seen / np.maximum(np.abs(seen).max(axis=1, keepdims=True, initial=0), 1e-300)
    return value[keep], seen / np.maximum(np.linalg.norm(seen, axis=0), 1e-300)


def far(one: Linear, other: Linear) -> bool:
    """Do frequencies change so much between them that modes of like shapes would be mistaken for each other?"""
    moduli = [np.abs(_oscillating(model)[0]) for model in (one, other)]
    return len(moduli[0]) == len(moduli[1]) and bool((np.abs(np.log(moduli[1] / moduli[0])) > 0.15).any())


def track(models: list[Linear], places: list[float]) -> np.ndarray:
    """Eigenvalues of models at values of a parameter, each near the one before: a row for each, a column for each oscillation
    of the first. It is followed by what is seen of it and by where it was going."""
    value, seen = _oscillating(models[0])
    table = np.full((len(models), len(value)), np.nan, dtype=complex)
    table[0], expected = value, value
    for row, model in enumerate(models[1:], start=1):
        value, now = _oscillating(model)
        apart = np.abs(value[None, :] - expected[:, None]) / np.abs(expected[:, None])
        apart = apart + 1 - np.abs(seen.conj().T @ now)
        for _ in range(min(apart.shape)):
            k, at = np.unravel_index(np.nanargmin(apart), apart.shape)
            table[row, k], seen[:, k] = value[at], now[:, at]
            apart[k, :] = apart[:, at] = np.inf
        last, here, there = places[row - 1], places[row], places[min(row + 1, len(places) - 1)]
        ahead = min((there - here) / (here - last), 2) if here != last else 0
        expected = np.where(np.isnan(table[row]), expected, table[row] + ahead * (table[row] - table[row - 1]))
        expected = np.where(np.isnan(expected), table[row], expected)
    return table
