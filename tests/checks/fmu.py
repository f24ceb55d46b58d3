"""FMUs of bodies in FMPy: validation, motion bit for bit as the library's, saved states, derivatives, refusals.

usage: fmu.py FOLDER REFERENCE, where FOLDER has satellite2.fmu, satellite3.fmu, ... and REFERENCE is tests/checks/fmu.c
Prints one line of figures, or what is wrong, with exit status 1.
"""
import ctypes
import math
import shutil
import subprocess
import sys
import time
import xml.etree.ElementTree
import zipfile
import zlib
from pathlib import Path

import fmpy
import numpy as np
from fmpy import fmi2, fmi3
from fmpy.validation import validate_fmu

folder, reference = Path(sys.argv[1]), sys.argv[2]
MODELS = ["satellite", "two_booms", "panel"]
START = {"start.velocity": [1, 0, -0.5], "start.rate": [0.01, 0.02, -0.03], "start.attitude": [0.8, 0, 0.6, 0],
         "start.position": [0, 2, 0]}
refusals = 0


def want(true, what):
    if not true:
        print(what)
        sys.exit(1)


class Instance:
    """One FMU of FMI 2 or 3 with its variables by name; vectors in both, as lists of value references."""

    def __init__(self, file, initialize=True, stop=None, beside=None, early=False, events=False, **settings):
        """beside: an instance whose library it shares. early, events: early return, event mode of FMI 3."""
        self.file, self.asks = file, {"earlyReturnAllowed": early, "eventModeUsed": events}
        self.description = fmpy.read_model_description(str(file))
        self.two = self.description.fmiVersion == "2.0"
        self.folder, self.owns = (beside.folder, False) if beside else (fmpy.extract(str(file)), True)
        self.variables, self.role, self.first = {}, {}, {}
        for v in self.description.modelVariables:
            name = v.name.split("[")[0]
            count = 1 if self.two else math.prod(d.start and int(d.start) or 1 for d in v.dimensions)
            self.variables[name] = self.variables.get(name, 0) + count
            self.role[name] = v.causality
            self.first.setdefault(name, v.valueReference)
        self.log = []
        kind = fmi2.FMU2Slave if self.two else fmi3.FMU3Slave
        self.fmu = kind(guid=self.description.guid, unzipDirectory=self.folder, instanceName="one",
                        modelIdentifier=self.description.coSimulation.modelIdentifier)
        try:
            self.instantiate()
        except Exception:
            self.clean()
            raise
        if initialize:
            self.initialize(stop=stop, **settings)

    def instantiate(self):
        if self.two:
            self.logger = fmi2.fmi2CallbackLoggerTYPE(lambda e, n, s, c, message: self.log.append(message.decode()))
            self.calls = fmi2.fmi2CallbackFunctions()
            self.calls.logger = self.logger
            self.calls.allocateMemory = fmi2.defaultCallbacks.allocateMemory
            self.calls.freeMemory = fmi2.defaultCallbacks.freeMemory
            self.fmu.instantiate(callbacks=self.calls)
        else:
            self.fmu.instantiate(logMessage=lambda e, s, c, message: self.log.append(message.decode()), **self.asks)

    def enter(self, stop=None):
        if self.two:
            self.fmu.setupExperiment(startTime=0.0, stopTime=stop)
            self.fmu.enterInitializationMode()
        else:
            self.fmu.enterInitializationMode(startTime=0.0, stopTime=stop)

    def initialize(self, stop=None, integrator=None, effects=None, **settings):
        self.enter(stop)
        for name, choice in ("integrator", integrator), ("effects", effects):
            if choice:
                (self.fmu.setInteger if self.two else self.fmu.setInt64)([self.first[f"settings.{name}"]], [choice])
        for name, value in settings.items():
            self.set(name, value)
        self.fmu.exitInitializationMode()
        self.time = 0.0

    def references(self, name):
        return [self.first[name] + i for i in range(self.variables[name])] if self.two else [self.first[name]]

    def set(self, name, value):
        value = list(value) if np.ndim(value) else [value]
        if self.two:
            self.fmu.setReal(self.references(name)[:len(value)], value)
        else:
            self.fmu.setFloat64(self.references(name), value)

    def get(self, *names):
        of = [r for name in names for r in self.references(name)]
        if self.two:
            return self.fmu.getReal(of)
        return self.fmu.getFloat64(of, sum(self.variables[name] for name in names))

    def names(self, role):
        return [name for name in self.variables if self.role[name] == role]

    def outputs(self):
        return self.get(*self.names("output"))

    def nodes(self):
        return [name[:-6] for name in self.variables if name.endswith(".force")]

    def step(self, length):
        self.fmu.doStep(self.time, length)
        self.time += length

    def step_to(self, end):
        """As importers count: lengths differ by rounding."""
        self.fmu.doStep(self.time, end - self.time)
        self.time = end

    def load(self, k):
        """The loads of communication step k, as tests/checks/fmu.c has them."""
        last = self.nodes()[-1]
        self.set("hub.force", [0.5 * ((k + i) % 3 - 1) for i in range(3)])
        self.set("hub.torque", [0.25 * ((k + 2 * i) % 7 - 3) for i in range(3)])
        self.set(last + ".force", [0.125 * ((k + i) % 5 - 2) for i in range(3)])
        self.set("gravity", [0.125 * ((k + i) % 4 - 1) for i in range(3)])
        if "base.rate" in self.variables:
            self.set("base.velocity", [((k + i) % 3 - 1) / 64 for i in range(3)])
            self.set("base.rate", [((k + 2 * i) % 5 - 2) / 64 for i in range(3)])
            self.set("base.acceleration", [0.25 * ((k + i) % 4 - 1) for i in range(3)])
            self.set("base.angular_acceleration", [0.125 * ((k + i) % 5 - 2) for i in range(3)])

    def run(self, count, length, first=0, rounds=True):
        rows = []
        for k in range(first, first + count):
            self.load(k)
            if rounds:
                self.step_to((k + 1) * length)
            else:
                self.step(length)
            rows.append(self.outputs())
        return rows

    def clean(self):
        if self.owns:
            shutil.rmtree(self.folder)

    def free(self):
        """The instance goes, its library stays."""
        (self.fmu.fmi2FreeInstance if self.two else self.fmu.fmi3FreeInstance)(self.fmu.component)

    def close(self):
        self.fmu.freeInstance()
        self.clean()


def start(file, **settings):
    one = Instance(file, initialize=False)
    q = [0.01] + [0.0] * (one.variables["start.q"] - 1)
    one.initialize(**{**{name: value for name, value in START.items() if name in one.variables}, "start.q": q, **settings})
    return one


def library(model, dt, steps, integrator, count):
    text = subprocess.run([reference, model, float(dt).hex(), str(steps), str(integrator), str(count)],
                          check=True, capture_output=True, text=True).stdout
    return [[float.fromhex(x) for x in line.split()] for line in text.splitlines()]


def refused(one, what, call, *words):
    """The call fails, its log has these words, and the outputs are the same before and after."""
    global refusals
    before = one.outputs()
    n = len(one.log)
    try:
        call()
    except Exception:
        told = " ".join(one.log[n:])
        want(len(one.log) > n, f"{one.file}: {what} is refused without a word")
        for word in words:
            want(word in told, f"{one.file}: {what}: the log does not have '{word}': {told}")
        one.set("gravity", one.get("gravity"))  # outputs are computed anew
        want(one.outputs() == before, f"{one.file}: {what} is refused and changes something")
        refusals += 1
        return
    want(False, f"{one.file}: {what} is not refused")


def check_motion(model):
    """Both versions move as the library does, bit for bit; simulate_fmu, too, whose clock rounds."""
    text = folder / f"{model}.txt"
    rows = {}
    for version in 2, 3:
        file = folder / f"{model}{version}.fmu"
        problems = validate_fmu(str(file))
        want(not problems, f"{file}: FMPy finds {problems}")
        one = start(file)
        step = one.get("settings.step")[0]
        rows[version] = one.run(50, 4 * step)
        one.close()
        simple = fmpy.simulate_fmu(str(file), stop_time=1.0, step_size=0.01, output_interval=0.01)
        want(len(simple) >= 100, f"{file}: simulate_fmu stops early")
    expected = library(text, step, 4, 1, 50)
    for version in 2, 3:
        want(rows[version] == expected, f"{model}, FMI {version}: not the bits of the library, but {worst(rows[version], expected)}")
    return len(expected) * len(expected[0])


def worst(a, b):
    return f"{max(abs(x - y) for p, q in zip(a, b) for x, y in zip(p, q)):g} apart"


def check_icon(version):
    """Where the standard has it, a picture with something on it and something left free; a page of documentation."""
    with zipfile.ZipFile(folder / f"satellite{version}.fmu") as packed:
        names = packed.namelist()
        icon = packed.read("model.png" if version == 2 else "terminalsAndIcons/icon.png")
        want("documentation/index.html" in names and "documentation/licenses/license.txt" in names, f"FMI {version}: documentation: {names}")
        if version == 3:
            lines = xml.etree.ElementTree.fromstring(packed.read("terminalsAndIcons/icon.svg"))
            want(lines.tag.endswith("svg") and len(lines) == 3, "icon.svg")
    chunks, at = {}, 8
    want(icon[:8] == b"\x89PNG\r\n\x1a\n", "the icon is no PNG")
    while at < len(icon):
        n, kind = int.from_bytes(icon[at:at + 4], "big"), icon[at + 4:at + 8]
        chunks[kind] = icon[at + 8:at + 8 + n]
        want(zlib.crc32(kind + chunks[kind]) == int.from_bytes(icon[at + 8 + n:at + 12 + n], "big"), "a check word of the icon")
        at += 12 + n
    pixels = np.frombuffer(zlib.decompress(chunks[b"IDAT"]), np.uint8).reshape(128, 257)
    alpha = pixels[:, 2::2]
    want(chunks[b"IHDR"] == bytes([0, 0, 0, 128, 0, 0, 0, 128, 8, 4, 0, 0, 0]) and not pixels[:, :2].any() and
         0.05 < np.mean(alpha == 255) < 0.3 and np.mean(alpha == 0) > 0.6 and (alpha == alpha[:, ::-1]).all(), "the icon")


def check_integrators():
    """All integrators; a step that is no multiple of the internal one is divided into equal ones."""
    for version in 2, 3:
        for integrator in 1, 2, 3, 4:
            one = start(folder / f"satellite{version}.fmu", integrator=integrator, **{"settings.step": 0.002})
            rows = one.run(20, 0.005, rounds=False)
            want(rows == library(folder / "satellite.txt", 0.005 / 3, 3, integrator, 20),
                 f"satellite, FMI {version}, integrator {integrator}: not the bits of the library")
            one.close()


def check_damping(damped):
    """Twice the damping by settings.damping_scale is the description with twice the damping."""
    one = start(folder / "satellite2.fmu", **{"settings.damping_scale": 2.0, "settings.step": 0.002})
    rows, expected = one.run(50, 0.01), library(damped, 0.002, 5, 1, 50)
    want(np.allclose(rows, expected, rtol=1e-10, atol=1e-12), f"damping_scale 2: {worst(rows, expected)}")
    one.close()


def scaled(model, mass=1, stiffness=1, hub_mass=1, hub_inertia=1, effects=None):
    """The description of a model with other numbers."""
    lines, row = [], False
    for line in (folder / f"{model}.txt").read_text().splitlines():
        words = line.split("#")[0].split()
        numbers = words[1:]
        if row and words != ["end"]:
            words = [words[0], float(words[1]) * mass] + [float(x) * stiffness for x in words[2:]]
        elif words[:1] == ["lump"]:
            words = ["lump", words[1], float(words[2]) * mass] + words[3:6] + [float(x) * mass for x in words[6:]]
        elif words[:1] == ["node"] and "component" in lines:
            words = words[:5] + [float(x) * mass for x in words[5:]]
        elif words[:1] == ["frequency_hz"]:
            words = ["frequency_hz"] + [float(x) * math.sqrt(stiffness / mass) for x in numbers]
        elif words[:1] == ["hub"]:
            words = ["hub", float(words[1]) * hub_mass] + words[2:5] + [float(x) * hub_inertia for x in words[5:]]
        elif words[:1] == ["effects"] and effects:
            words = ["effects", effects, "damping"]
        row = words[:1] == ["stations"] or row and words != ["end"]
        lines.append(" ".join(repr(x) if isinstance(x, float) else x for x in words))
    file = folder / "scaled.txt"
    file.write_text("\n".join(lines) + "\n")
    return file


def check_parameters():
    """Masses, stiffness and effects as parameters: the motion of the description that has those numbers, whose modes have
    the same shapes. Factors of 4, and others; each alone changes it. A saved state has them with it."""
    most, names = 0.0, ("mass", "stiffness", "hub_mass", "hub_inertia")
    cases = [(4.0, 1.0, 1.0, 1.0), (1.0, 4.0, 1.0, 1.0), (1.0, 1.0, 1.7, 1.0), (1.0, 1.0, 1.0, 0.8), (1.3, 0.6, 0.9, 1.2)]
    for model in MODELS + ["large"]:
        plain = library(folder / f"{model}.txt", 0.001, 4, 1, 50)
        for version in 2, 3:
            saved = []
            for case in cases[1:4] if model == "large" else cases:
                factors = {name: factor for name, factor in zip(names, case) if factor != 1}
                effects = "spin" if case == cases[-1] else None
                one = start(folder / f"{model}{version}.fmu", effects=3 if effects else None,
                            **{"settings.step": 0.001, **{f"settings.{name}_scale": factor for name, factor in factors.items()}})
                rows = one.run(50, 0.004)
                expected = library(scaled(model, **factors, effects=effects), 0.001, 4, 1, 50)
                size = np.max(np.abs(expected), axis=0) + 1e-3
                off = np.max(np.abs(np.array(rows) - expected) / size)
                want(off < 1e-9, f"{model}, FMI {version}, {factors}: {off:g} off the description of these numbers")
                want(np.max(np.abs(np.array(plain) - expected) / size) > 1e-5, f"{model}: {factors} change nothing")
                most = max(most, off)
                saved.append((one.fmu.serializeFMUState(one.fmu.getFMUState()), one.run(5, 0.004, 50)))
                one.close()
            other = start(folder / f"{model}{version}.fmu")
            other.run(3, 0.004)
            for state, rest in saved:  # built anew for each
                other.fmu.setFMUState(other.fmu.deserializeFMUState(state))
                other.time = 0.2
                want(other.run(5, 0.004, 50) == rest, f"{model}: a saved state forgets its parameters")
            other.close()
    return most


def check_parameter_refusals(version):
    """What is no factor, and effects that the description has not."""
    one = Instance(folder / f"linear{version}.fmu", initialize=False)
    for name in "mass", "stiffness", "hub_mass", "hub_inertia":
        want(broken_start(one, f"settings.{name}_scale", 0.0, "1e-06 to 1e+06"), f"{name} 0 is taken")
    for effects, word in (5, "1 to 4"), (4, "fb_body_init: effects"):
        want(broken_start(one, "effects", effects, word), f"effects {effects}: {one.log[-1:]}")
    one.initialize(effects=2, **{"settings.stiffness_scale": 1.0})
    one.close()
    items = [t for t in one.description.typeDefinitions if t.name == "Effects"][0].items
    want([i.name for i in items] == ["as_described", "linear"], f"effects of the linear body: {[i.name for i in items]}")
    names = set(Instance(folder / f"names{version}.fmu", initialize=False).variables)
    want(not [n for n in names if "effects" in n or "stiffness" in n or "settings.mass" in n] and "settings.hub_mass_scale" in names,
         f"parameters of a rigid body: {sorted(names)}")


def check_base():
    """A base that inputs move: with a constant acceleration one communication step is many; what is set goes on. With a
    rate that changes smoothly, linear between communication steps, the error falls with their square."""
    for version in 2, 3:
        file = folder / f"held{version}.fmu"
        ends = []
        for count in 1, 8:
            one = start(file, **{"settings.step": 0.0025, "base.acceleration": [0.5, 0, 0], "base.angular_acceleration": [0, 0.1, 0.2]})
            for _ in range(count):
                one.step(0.4 / count)
            want(np.allclose(one.get("base.velocity", "base.rate"), [0.2, 0, 0, 0, 0.04, 0.08], rtol=1e-13, atol=0), "the base does not go on")
            want(one.get("hub.rate") == one.get("base.rate"), "the rate of the hub is not that of the base")
            ends.append(one.outputs())
            one.close()
        want(np.allclose(ends[0], ends[1], rtol=1e-11, atol=1e-13), f"{file}: {worst(ends[:1], ends[1:])}")
    for version in 2, 3: # outputs that are read on the way to it leave the start as it is
        first = []
        for looks in 0, 1, 2:
            one = Instance(folder / f"held{version}.fmu", initialize=False)
            one.enter()
            for look in range(looks):
                one.set("base.rate", [0, 0, 0.25 * look])
                one.outputs()
            one.set("base.rate", [0, 0, 0.5])
            one.fmu.exitInitializationMode()
            first.append(one.outputs())
            want(not np.any(one.get("modes.q_dot")) and first[-1] == first[0], f"FMI {version}: outputs read before the end of initialization change the start")
            one.close()
    errors, rows = [], []
    for length in 0.04, 0.02, 0.005:
        one = start(folder / "held2.fmu", **{"settings.step": 0.0025, "start.q": [0.0] * 6})
        for k in range(round(2 / length)):
            now, then = (0.5 * (1 - math.cos(math.pi * t * length / 2)) for t in (k, k + 1))
            one.set("base.rate", [0, 0, now])
            one.set("base.angular_acceleration", [0, 0, (then - now) / length])
            one.step(length)
        rows.append(np.array(one.get("hub.attitude", "node1.deflection", "modes.q")))
        one.close()
    errors = [np.max(np.abs(row - rows[-1])) for row in rows[:-1]]
    want(np.max(np.abs(rows[-1][4:])) > 1e-4 and 3 < errors[0] / errors[1] < 5.5, f"a base of smooth rate: errors {errors}")
    return errors[1]


def check_states(version):
    """10,000 times saved and set again: the same bits. Serialized into another instance: the same motion."""
    file = folder / f"satellite{version}.fmu"
    through = start(file).run(40, 0.01)
    one = start(file, **{"settings.damping_scale": 1.0})
    first = one.run(20, 0.01)
    state = one.fmu.getFMUState()
    saved = one.fmu.serializeFMUState(state)
    for _ in range(10000):
        again = one.fmu.getFMUState()
        one.fmu.setFMUState(again)
        one.fmu.freeFMUState(again)
    rest = one.run(20, 0.01, 20)
    want(first + rest == through, f"{file}: 10,000 saved states change the motion")
    one.time = 0.2
    one.fmu.setFMUState(state)
    want(one.run(20, 0.01, 20) == rest, f"{file}: the motion from a saved state is another one")
    for other in start(file, integrator=4, **{"settings.damping_scale": 3.0}), Instance(file, initialize=False):
        back = other.fmu.deserializeFMUState(saved)
        other.fmu.setFMUState(back)
        other.time = 0.2
        want(other.run(20, 0.01, 20) == rest, f"{file}: the motion after a restart is another one")
        want(other.fmu.serializeFMUState(back) == saved, f"{file}: a state serialized again is another one")
        other.fmu.freeFMUState(back)
        other.close()
    one.fmu.freeFMUState(state)
    one.close()
    return saved


def check_derivatives(version, model):
    """Directional derivatives are differences of outputs; outputs without dependencies do not follow inputs."""
    one = start(folder / f"{model}{version}.fmu")
    one.run(10, 0.02)
    outputs, base = one.names("output"), np.array(one.outputs())
    most = 0.0
    for name in one.names("input"):
        direct = np.concatenate([[depends(one, output, name)] * one.variables[output] for output in outputs]).astype(bool)
        of = [r for output in outputs for r in one.references(output)]
        was, by = np.array(one.get(name)), np.array([0.5, -1.0, 2.0])
        slope = np.array(one.fmu.getDirectionalDerivative(of, one.references(name), by, **({} if one.two else {"nSensitivity": len(base)})))
        want(np.array_equal(one.outputs(), base), "a derivative changes the outputs")
        one.set(name, was + by)
        change = 0.5 * np.array(one.outputs())
        one.set(name, was - by)
        change -= 0.5 * np.array(one.outputs())
        one.set(name, was)
        want(not change[~direct].any() and not slope[~direct].any(), f"FMI {version}: an output follows {name} without a dependency")
        want(abs(change[direct]).max() > 0, f"FMI {version}: no output follows {name}")
        most = max(most, abs(slope - change).max() / abs(change).max())
    want(most < 1e-9, f"FMI {version}: derivatives are {most:g} off")
    if not one.two:
        check_adjoint(one)
    one.close()
    return most


def rates(one, names):
    """Derivatives by time, of all numbers of outputs."""
    of = [r for name in names for r in one.references(name)]
    count = sum(one.variables[name] for name in names)
    value = (ctypes.c_double * count)()
    order = (ctypes.c_int32 * len(of))(*[1] * len(of))
    references = (ctypes.c_uint * len(of))(*of)
    if one.two:
        one.fmu.fmi2GetRealOutputDerivatives(one.fmu.component, references, len(of), order, value)
    else:
        one.fmu.fmi3GetOutputDerivatives(one.fmu.component, references, len(of), order, value, count)
    return np.array(value)


def central(one, h):
    """Derivatives at a time h ahead, by two steps of h: fourth order from a state that is set again."""
    state, rows = one.fmu.getFMUState(), [one.outputs()]
    begin = one.time
    for _ in range(4):
        one.step(h)
        rows.append(one.outputs())
        if len(rows) == 3:
            middle = rates(one, one.names("output"))
            again = one.outputs()
            want(again == rows[-1], "derivatives by time change the outputs")
    one.fmu.setFMUState(state)
    one.fmu.freeFMUState(state)
    one.time = begin
    y = np.array(rows)
    size = 1e-5 + np.abs(middle) + np.max(np.abs(y), axis=0)
    return middle, (y[0] - 8 * y[1] + 8 * y[3] - y[4]) / (12 * h), size


def check_rates(version):
    """Derivatives of outputs by time: those of the motion around; velocity of position, acceleration of velocity, and so
    on, to the digits; quaternions by rates."""
    most = 0.0
    for model in MODELS + ["held"]:
        file = folder / f"{model}{version}.fmu"
        one = start(file)
        want(one.description.coSimulation.maxOutputDerivativeOrder == 1, f"{file}: no derivatives")
        one.run(5, 0.05)
        names = one.names("output")
        mine, moved, size = central(one, one.get("settings.step")[0] / 8)
        off = np.max(np.abs(mine - moved) / size)
        want(off < 1e-5, f"{file}: derivatives by time are {off:g} off")
        for node in one.nodes():
            for of, by in ("position", "velocity"), ("velocity", "acceleration"), ("rate", "angular_acceleration"):
                known = np.array(one.get(f"{node}.{by}"))
                error = np.max(np.abs(rates(one, [f"{node}.{of}"]) - known)) / (1e-3 + np.max(np.abs(known)))
                most = max(most, error)
        if "modes.q" in names:
            known = np.array(one.get("modes.q_dot"))
            most = max(most, np.max(np.abs(rates(one, ["modes.q"]) - known)) / np.max(np.abs(known)))
        refused(one, "a derivative of an input", lambda: rates(one, ["hub.force"]), "hub.force[1] is no output")
        one.close()
    want(most < 1e-8, f"FMI {version}: velocities as derivatives are {most:g} off")
    return most


def adjoint(one, outputs, inputs, seed):
    """J^T seed, FMI 3."""
    of = [r for name in outputs for r in one.references(name)]
    by = [r for name in inputs for r in one.references(name)]
    count = sum(one.variables[name] for name in inputs)
    change = (ctypes.c_double * count)()
    one.fmu.fmi3GetAdjointDerivative(one.fmu.component, (ctypes.c_uint * len(of))(*of), len(of), (ctypes.c_uint * len(by))(*by),
                                     len(by), (ctypes.c_double * len(seed))(*seed), len(seed), change, count)
    return np.array(change)


def check_adjoint(one):
    """<v, J u> = <J^T v, u> for every input, and all of them at once."""
    outputs, inputs = one.names("output"), one.names("input")
    n_out, n_in = (sum(one.variables[name] for name in names) for names in (outputs, inputs))
    u, v = np.cos(1 + np.arange(n_in)), np.sin(2 + 3 * np.arange(n_out))
    Ju = np.array(one.fmu.getDirectionalDerivative([r for name in outputs for r in one.references(name)],
                                                   [r for name in inputs for r in one.references(name)], u, nSensitivity=n_out))
    off = abs(v @ Ju - adjoint(one, outputs, inputs, v) @ u) / (np.linalg.norm(v) * np.linalg.norm(Ju))
    want(np.linalg.norm(Ju) > 0 and off < 1e-12, f"{one.file}: the adjoint derivative is {off:g} off")
    return off


def depends(one, name, source):
    for unknown in one.description.outputs:
        if unknown.variable.name.split("[")[0] == name:
            return source in [v.name.split("[")[0] for v in unknown.dependencies]
    want(False, f"{name} is not in the ModelStructure")


def check_refusals(version, saved, foreign):
    file = folder / f"satellite{version}.fmu"
    one = start(file, stop=1.0)
    one.run(3, 0.01)
    step = one.fmu.doStep
    nan, inf = math.nan, math.inf
    refused(one, "NaN", lambda: one.set("hub.force", [0, nan, 0]), "hub.force[2]", "finite")
    refused(one, "infinity", lambda: one.set("gravity", [0, 0, inf]), "gravity[3]")
    refused(one, "an output", lambda: one.set("hub.position", [0, 0, 0]), "hub.position[1]", "computed")
    refused(one, "a parameter", lambda: one.set("settings.step", 0.001), "settings.step", "parameter")
    refused(one, "a step of 0", lambda: step(one.time, 0.0), "above 0")
    refused(one, "a step back", lambda: step(one.time, -0.01), "above 0")
    refused(one, "a step of NaN", lambda: step(one.time, nan), "above 0")
    refused(one, "a step without end", lambda: step(one.time, inf), "above 0")
    refused(one, "a step that the clock does not resolve", lambda: step(one.time, 1e-20), "step of 1e-20 s", "0.03 s")
    refused(one, "a step from elsewhere", lambda: step(0.7, 0.01), "while the time is 0.03")
    refused(one, "a step too far", lambda: step(one.time, 2.0), "stop time 1")
    refused(one, "a long list", lambda: (one.fmu.setReal([999], [0.0]) if one.two else one.fmu.setFloat64([999], [0.0])), "999")
    if not one.two:
        refused(one, "a wrong size", lambda: one.fmu.setFloat64(one.references("hub.force"), [1.0, 2.0]), "3 numbers, not 2")
        inside = [one.first["hub.force"] + 1]
        refused(one, "an element", lambda: one.fmu.getFloat64(inside), "vector")
    refused(one, "a short state", lambda: one.fmu.deserializeFMUState(saved[:-8]), "bytes")
    refused(one, "a state of another model", lambda: one.fmu.deserializeFMUState(foreign), "bytes" if len(foreign) != len(saved) else "of another one or nothing")
    alien = bytearray(saved)
    alien[4] ^= 1
    refused(one, "a state of another FMU", lambda: one.fmu.deserializeFMUState(bytes(alien)), "of another one or nothing")
    for at in 16, len(saved) // 2, len(saved) - 1:
        broken = bytearray(saved)
        broken[at] ^= 4
        refused(one, "a damaged state", lambda: one.fmu.deserializeFMUState(bytes(broken)), "damaged")
    refused(one, "initialization twice", one.fmu.enterInitializationMode, "before initialization")
    want(len(one.run(3, 0.01, 3)) == 3, "no step after refusals")
    one.close()

    one = start(file)
    refused(one, "a step of 1e12 s", lambda: one.fmu.doStep(0.0, 1e12), "step of 1e+12 s", "10000000")
    one.set("hub.torque", [0, 0, 4e4])
    refused(one, "a motion that becomes too fast", lambda: one.fmu.doStep(0.0, 2.0), "fb_rk4_step", "in a step of 0.002 s at")
    want(" at 0 s" not in one.log[-1], f"{file}: the first step fails: {one.log[-1]}")
    one.close()
    one = start(file, **{"settings.step": 0.5})
    refused(one, "a step that is too long", lambda: step_of(one)(0.0, 0.5), "fb_rk4_step", "0.5 s")
    one.close()
    one = Instance(file, initialize=False)
    want(broken_start(one, "settings.step", 0.0, "above 0") and broken_start(one, "start.attitude", [0, 0, 0, 0], "initialization"),
         f"{file}: a start that is none")
    one.close()
    shown = Instance(file, initialize=False)
    shown.fmu.guid = "{0}"
    shown.log.clear()
    try:
        shown.instantiate()
        want(False, f"{file}: another token is taken")
    except Exception:
        want("token" in " ".join(shown.log), f"{file}: another token is refused without a word")


def step_of(one):
    return one.fmu.doStep


def broken_start(one, name, value, word):
    global refusals
    n = len(one.log)
    try:
        one.initialize(**{name: value})
    except Exception:
        refusals += 1
        one.fmu.reset()
        return word in " ".join(one.log[n:])
    return False


def check_static():
    """Without a heap: one instance at a time, the same motion."""
    expected = start(folder / "satellite2.fmu").run(20, 0.01)
    one = start(folder / "static2.fmu")
    want(one.description.coSimulation.canBeInstantiatedOnlyOncePerProcess, "the static FMU does not say that it is one")
    want(one.run(20, 0.01) == expected, "the static FMU moves otherwise")
    first, n, again = (one.fmu.component, one.fmu.callbacks, one.logger, one.calls), len(one.log), None
    try:
        one.instantiate()
        again = one.fmu.component
    except Exception:
        pass
    want(again is None and "no memory" in " ".join(one.log[n:]), "a second instance of the static FMU is taken")
    one.fmu.component, one.fmu.callbacks, one.logger, one.calls = first
    states = [one.fmu.getFMUState() for _ in range(8)]
    refused(one, "a ninth saved state", one.fmu.getFMUState, "no memory")
    for state in states:
        one.fmu.freeFMUState(state)
    one.close()


def check_speed():
    """A step of 1 ms and a reading of the rate, with what Python costs."""
    one = start(folder / "satellite2.fmu")
    of = (ctypes.c_uint * 3)(*one.references("hub.rate"))
    value = (ctypes.c_double * 3)()
    step, get, component = one.fmu.dll.fmi2DoStep, one.fmu.dll.fmi2GetReal, ctypes.c_void_p(one.fmu.component)
    step.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_int]
    most = 1e9
    for _ in range(5):
        begin = time.process_time()
        for k in range(1000):
            failed = step(component, one.time + 0.001 * k, 0.001, 1) or get(component, of, 3, value)
            want(failed == 0, "a step of 1 ms fails")
        one.time += 1
        most = min(most, time.process_time() - begin)
    one.close()
    want(most < 1 / 50, f"1 s at 1 kHz takes {most:.3g} s")
    return 1 / most


def main():
    numbers = sum(check_motion(model) for model in MODELS + ["held"])
    check_integrators()
    varied, base = check_parameters(), check_base()
    check_damping(str(folder / "damped.txt"))
    slopes, slower = [], []
    for version in 2, 3:
        check_icon(version)
        other = start(folder / f"two_booms{version}.fmu")
        foreign = other.fmu.serializeFMUState(other.fmu.getFMUState())
        saved = check_states(version)
        check_refusals(version, saved, foreign)
        check_parameter_refusals(version)
        slopes += [check_derivatives(version, model) for model in ("two_booms", "held")]
        slower.append(check_rates(version))
    check_static()
    speed = check_speed()
    print(f"FMPy {fmpy.__version__}: {len(MODELS)} bodies, and one on a base that inputs move, valid in FMI 2.0 and 3.0, {numbers} outputs of each with the library's bits, "
          f"masses, stiffness and effects as parameters to {varied:.1g}, "
          f"derivatives by inputs to {max(slopes):.1g}, by time to {max(slower):.1g}, {refusals} refusals, 1 kHz with {speed:.0f} times to spare")


if __name__ == "__main__":
    main()
