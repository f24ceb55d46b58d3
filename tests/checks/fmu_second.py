"""FMUs in a second importer, Ecos: two instances of each, the one drives the other through a connection; the numbers are
those that FMPy gets.

usage: fmu_second.py FOLDER REFERENCE, as tests/checks/fmu.py, where tests/checks/fmu.py and fmu_scene.py have left their FMUs
Prints one line of figures, or what is wrong, with exit status 1.
"""
import ctypes
import sys
from importlib.metadata import version
from pathlib import Path

from fmu import Instance, want

ctypes.CDLL(next(Path(sys.prefix, "lib").glob("libtbb.so.12")), ctypes.RTLD_GLOBAL)  # Ecos looks for it by name
from ecospy import EcosSimulation, EcosSimulationStructure  # noqa: E402

folder = Path(sys.argv[1])
CASES = {  # output of the first that drives an input of the second, times 1; parameter of both
    "body2": ("hub.rate[3]", "hub.torque[1]", "start.rate[3]", 0.25),
    "body3": ("energy.strain", "", "settings.damping_scale", 0.5),
    "driven2": ("output.drive", "motor.root[1]", "parameter.push", 2.0),
    "driven3": ("output.drive", "motor.root[1]", "parameter.push", 2.0),
}
STEP, COUNT = 0.02, 50


def by_ecos(file, source, sink, parameter, value):
    with EcosSimulationStructure() as structure:
        for name in "first", "second":
            structure.add_model(name, str(file))
        if sink:
            structure.make_real_connection(f"first::{source}", f"second::{sink}")
        structure.add_parameter_set("start", {f"{name}::{parameter}": value for name in ("first", "second")})
        simulation = EcosSimulation(structure=structure, step_size=STEP)
        simulation.init(parameter_set="start")
        simulation.step(COUNT)
        rows = [{name: simulation.get_real(f"{one}::{name}") for name in watched(file)} for one in ("first", "second")]
        simulation.terminate()
        simulation.free()
    return rows


def watched(file):
    """Outputs that are one number: Ecos has no vectors."""
    return SCALARS[file.stem]


def by_fmpy(file, source, sink, parameter, value):
    first = Instance(file, initialize=False)
    second = Instance(file, initialize=False, beside=first)
    at = {v.name: v.valueReference for v in first.description.modelVariables}
    for one in first, second:
        put(one, at[parameter], value)
        one.initialize()
    SCALARS[file.stem] = [v.name for v in first.description.modelVariables if v.causality == "output" and not v.dimensions]
    for k in range(COUNT + 1):
        for one in (first, second) if k > 0 else ():
            one.step(STEP)
        if sink:
            put(second, at[sink], take(first, at[source]))
    rows = [{name: take(one, at[name]) for name in watched(file)} for one in (first, second)]
    second.free()
    first.close()
    return rows


def put(one, reference, value):
    (one.fmu.setReal if one.two else one.fmu.setFloat64)([reference], [value])


def take(one, reference):
    return (one.fmu.getReal if one.two else one.fmu.getFloat64)([reference])[0]


SCALARS, numbers = {}, 0
for name, case in CASES.items():
    expected = by_fmpy(folder / f"{name}.fmu", *case)
    rows = by_ecos(folder / f"{name}.fmu", *case)
    want(rows == expected, f"{name}: Ecos gets {rows}, FMPy {expected}")
    want(not case[1] or rows[0] != rows[1], f"{name}: the connection does nothing")
    numbers += sum(len(row) for row in rows)
print(f"Ecos {version('ecospy')}: {len(CASES)} FMUs of FMI 2.0 and 3.0, two instances of each, {numbers} outputs with the bits of FMPy")
