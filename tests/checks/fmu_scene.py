"""FMUs of scenes in FMPy: every scene of examples/scenes that moves, row by row as the scene's own run; parameters, inputs,
saved states, odd steps, derivatives, refusals.

usage: fmu_scene.py FOLDER REFERENCE, where FOLDER has scene2.fmu and scene3.fmu, whose binaries are those of all scenes
Prints one line of figures, or what is wrong, with exit status 1.
"""
import csv
import ctypes
import functools
import json
import math
import re
import shutil
import subprocess
import sys
import threading
import time
import zipfile
from pathlib import Path

import fmpy
import numpy as np
from fmpy.validation import validate_fmu

from fmu import Instance, central, check_adjoint, rates, want

folder = Path(sys.argv[1])
scenes = Path("examples/scenes")
ROWS = {2: 300, 3: 50}  # at most, of FMI 2.0 and 3.0
DRIVEN = """
parameter force 3
parameter torque 3
parameter pull 3
parameter motor 3
parameter turn 3
parameter modes 2
parameter push 1
duration 2
interval 0.1
step 0.005
body hub rigid
  hub 50  0 0 0  5 6 7
  node 1 0 0 right
end
body boom beam
  length 4
  elements 4
  stations x mass EI_y EI_z
    0 1 900 900
  end
  modes bend_z $modes
  node tip tip
end
joint root revolute hub.right boom
  axis 0 1 0
  stiffness 40
  motor 1 constant $torque
end
spring cable hub boom.tip
  position 0 0 1  0 0 0
  stiffness 2
  pull constant $pull
end
rotor wheel hub
  axis 0 0 1
  inertia 0.1
  motor constant $motor
end
load boom.tip dead force 0 1.2*$push 1.6*$push constant $force
output spin spin hub z
output bend mode_rate boom 1
output angle coordinate root 1
output shake specific_force boom.tip
output drive drive root 1
output tension tension cable
output power power
output wheel rotor_speed wheel
control hold
  sample 0.02
  delay 0.01
  input spin 2
  reference constant $turn
  pid 3 1 0
  output load hub base torque 0 1 0
end
"""
MOVED = """
parameter turn 0.5
parameter fly 0.25
parameter rise 0
duration 2
interval 0.1
step 0.005
body boom beam
  length 4
  elements 4
  stations x mass EI_y EI_z
    0 1 900 900
  end
  modes bend_y 2 bend_z 2
  effects full
  base prescribed
  node tip tip
end
motion rate 0 0 2 constant $turn
motion velocity 1 0 0 constant $fly
motion rate 0 0 1 ramp $rise 0 2
output tip position boom.tip
output swift velocity boom.tip
output bend displacement boom.tip
output shake acceleration boom.tip
output spin spin boom z
output mode mode_rate boom 1
output hold reaction_torque boom
output energy energy
"""
HINGED = """
duration 2
interval 0.05
step 0.005
gravity 0 0 -9.81
body beam exact
  length 4
  elements 16
  station 0
  stiffness 1e5 1e5 1e5 200 150 300
  inertia 1.2 1.2 1.2 0.02 0.01 0.01
  support 3 x y z
  joint 1 0 1 0 angle 5 stiffness 50 damping 0.5
  damping 0.002
  node 3 held
  node 4 tip
end
motion displacement beam.held 0 0 0.1 smooth 1 0.1 1
output bend displacement beam.tip
control hold
  sample 0.02
  delay 0.013
  input bend_z 20
  pid 3 2 0.1 0.01
  saturate 4
  output load beam.tip follower force 0 0 1
end
"""
numbers = refusals = 0


def tool(*words):
    return subprocess.run(["build/flexbeam", *map(str, words)], capture_output=True, text=True)


def binary(version):
    return folder / f"binary{version}.so"


def export(file, version, name=None, *more):
    out = folder / f"{name or file.stem}{version}.fmu"
    made = tool("fmu", file, "--version", version, "--binary", binary(version), "--out", out, *more)
    want(made.returncode == 0, f"{file}: no FMU: {made.stderr}")
    return out


@functools.lru_cache(maxsize=None)
def run_of(file, *settings):
    """Rows of the scene's own run, in the digits of its file."""
    out = folder / "run.csv"
    made = tool("scene", file, "--out", out, "--quiet", *[w for s in settings for w in ("--set", s)])
    want(out.exists(), f"{file}: it does not run: {made.stderr}")
    with open(out) as lines:
        rows = list(csv.reader(lines))[1:]
    out.unlink()
    return rows


def outputs(one):
    return [f"{x:.12g}" for x in one.outputs()]


def rows_of(one, count, length, first=0):
    """As the rows of a run, from that of the present time on."""
    rows = [outputs(one)]
    for k in range(first, first + count):
        one.step_to((k + 1) * length)
        rows.append(outputs(one))
    return rows


def compare(what, rows, expected):
    """expected: with their times; both end where the shorter does."""
    global numbers
    for k, (a, b) in enumerate(zip(rows, expected)):
        want(a == b[1:], f"{what}: row {k}: {a}, the scene: {b[1:]}")
        numbers += len(a)


def interval(one):
    return float(one.description.defaultExperiment.stepSize)


def check_all():
    """All that move are valid and move as the scene does; the others are refused."""
    moved = still = 0
    for file in sorted(scenes.glob("*.txt")):
        if not re.search(r"^duration ", file.read_text(), re.M):
            made = tool("fmu", file, "--binary", binary(2), "--out", folder / "still.fmu")
            want(made.returncode == 2 and "without duration" in made.stderr, f"{file}: {made.stderr}")
            still += 1
            continue
        expected = run_of(file)
        for version in (2,) if re.match("spinup_(first|second)_", file.stem) else (2, 3):  # variants of one
            fmu = export(file, version)
            problems = validate_fmu(str(fmu))
            want(not problems, f"{fmu}: FMPy finds {problems}")
            one = Instance(fmu)
            compare(fmu, rows_of(one, min(ROWS[version], len(expected) - 1), interval(one)), expected)
            one.close()
        moved += 1
    return moved, still


def check_simulate():
    """By FMPy's own master, with its clock."""
    file = scenes / "satellite_control.txt"
    expected = run_of(file)
    for version in 2, 3:
        rows = fmpy.simulate_fmu(str(folder / f"satellite_control{version}.fmu"))
        compare(f"simulate_fmu, FMI {version}", [[f"{x:.12g}" for x in list(row)[1:]] for row in rows], expected)
        want(len(rows) == len(expected), f"simulate_fmu, FMI {version}: {len(rows)} rows")


def check_parameters():
    """As --set: a number, and one that makes the beam exact. The step, as --step."""
    for name, parameter, value, count in ("satellite_control", "angle", 0.3, 100), ("spinup_rate", "exact", 20, 50):
        expected = run_of(scenes / f"{name}.txt", f"{parameter}={value}")
        for version in 2, 3:
            one = Instance(folder / f"{name}{version}.fmu", **{f"parameter.{parameter}": value})
            first = rows_of(one, count, interval(one))
            compare(f"{name}, {parameter} {value}", first, expected)
            one.fmu.reset()
            one.initialize(**{f"parameter.{parameter}": value})
            want(rows_of(one, count, interval(one)) == first, f"{name}: after a reset it moves otherwise")
            one.fmu.reset()
            one.initialize()
            compare(f"{name}, after a reset", rows_of(one, 5, interval(one)), run_of(scenes / f"{name}.txt"))
            one.close()
    text = (scenes / "satellite_control.txt").read_text()
    slow = folder / "slow.txt"
    slow.write_text(text.replace("step 0.001", "step 0.005"))
    one = Instance(folder / "satellite_control2.fmu", **{"settings.step": 0.005})
    two = Instance(export(scenes / "satellite_control.txt", 2, "stepped", "--step", 0.005))
    expected = run_of(slow)
    compare("settings.step", rows_of(one, 100, 0.1), expected)
    compare("--step", rows_of(two, 100, 0.1), expected)
    want(two.get("settings.step") == [0.005], "--step is not the start of settings.step")
    one.close()
    two.close()


def check_inputs():
    """What inputs add is what the scene could say itself: bit for bit, for each kind of them."""
    adds = {"motor.root": ("torque", 2.0), "pull.cable": ("pull", 2.0), "rotor.wheel": ("motor", 2.0),
            "force.boom.tip": ("force", 4.0), "reference.hold": ("turn", 2.0)}
    file = folder / "driven.txt"
    file.write_text(DRIVEN)
    ones = {f"parameter.{parameter}": 1.0 for parameter, _ in adds.values()}
    expected = run_of(file)
    for version in 2, 3:
        fmu = export(file, version)
        want(not validate_fmu(str(fmu)), f"{fmu} is not valid")
        one = Instance(fmu, **ones, **{name: value for name, (_, value) in adds.items()})
        want(sorted(one.names("input")) == sorted(adds), f"inputs: {one.names('input')}")
        compare("inputs", rows_of(one, 20, 0.1), expected)
        one.close()
        for name in adds:  # none of them does nothing
            one = Instance(fmu)
            one.set(name, 0.5)
            want(rows_of(one, 3, 0.1)[-1] != expected[3][1:], f"{name} does nothing")
            one.close()
    units = {v.name: v.unit for v in Instance(folder / "driven2.fmu", initialize=False).description.modelVariables}
    want(units["motor.root[1]"] == "N.m" and units["pull.cable"] == "N" and units["output.shake_x"] == "m/s2" and
         units["output.power"] == "W" and units["settings.step"] == "s", f"units: {units}")


def check_base():
    """Inputs move a prescribed base: constants as the scene could say them, bit for bit; a rate that its own rate moves on,
    in one step and in many, as a ramp of the scene; derivatives, by inputs and by time."""
    file = folder / "moved.txt"
    file.write_text(MOVED)
    constant, most = run_of(file, "turn=0.75", "fly=1"), 0.0
    ramp = [[float(x) for x in row] for row in run_of(file, "rise=0.8")]
    for version in 2, 3:
        fmu = export(file, version)
        want(not validate_fmu(str(fmu)), f"{fmu} is not valid")
        one = Instance(fmu, **{"rate.base": 0.5, "velocity.base": 0.75})
        want(sorted(one.names("input")) == ["acceleration.base", "angular_acceleration.base", "angular_acceleration_2.base", "rate.base",
                                            "rate_2.base", "velocity.base"], f"inputs: {one.names('input')}")
        compare("inputs of a base", rows_of(one, 20, 0.1), constant)
        one.close()
        for count, length in (10, 0.1), (5, 0.2), (16, 0.0625):
            one = Instance(fmu, **{"angular_acceleration.base": 0.4})
            for _ in range(count):
                one.step(length)
            want(abs(one.get("rate.base")[0] - 0.4) < 1e-12, f"the rate of the base goes on to {one.get('rate.base')}")
            off = max(abs(a - b) / (1e-3 + abs(b)) for a, b in zip(one.outputs(), ramp[10][1:]) if abs(b) < 1e3)
            want(off < (1e-9 if length > 0.07 else 2e-5), f"{fmu}: a rate that goes on, {count} steps: {off:g} off the ramp")
            one.close()
        one = Instance(fmu, **{"angular_acceleration.base": 0.4})
        one.step(0.05)
        state, names, n = one.fmu.getFMUState(), one.names("output"), len(one.outputs())
        direct = np.array([bool(u.dependencies) for u in one.description.outputs])
        of = [r for output in names for r in one.references(output)]
        for name in one.names("input"):
            was, sides = one.get(name)[0], []
            slope = np.array(one.fmu.getDirectionalDerivative(of, one.references(name), [1.0], **({} if one.two else {"nSensitivity": n})))
            for by in -1, 1:
                one.set(name, was + by)
                sides.append(np.array(one.outputs()))
            one.set(name, was)
            change = (sides[1] - sides[0]) / 2
            want(abs(change).max() > 0.1 and not slope[~direct].any() and not change[~direct].any(), f"{name}: dependencies")
            most = max(most, abs(slope - change).max() / abs(change).max())
        mine, moving, size = central(one, 1e-4)
        want(np.max(np.abs(mine - moving) / size) < 1e-6, f"{fmu}: derivatives by time")
        one.fmu.setFMUState(state)
        want(abs(one.get("rate.base")[0] - 0.02) < 1e-12, "a saved state forgets how the base moves")
        one.close()
    want(most < 1e-9, f"derivatives by the motion of a base are {most:g} off")


def check_odd_steps():
    """A length that is no multiple of the rows is one of its own: as a scene with such rows. Any other is near to it."""
    text = (scenes / "satellite_control.txt").read_text()
    file = folder / "odd.txt"
    file.write_text(text.replace("interval 0.1", "interval 0.03"))
    expected = run_of(file)
    one = Instance(folder / "satellite_control2.fmu")
    compare("rows of 0.03 s", rows_of(one, 300, 0.03), expected)
    one.close()
    one = Instance(folder / "satellite_control3.fmu")
    for k in range(90):
        one.step([0.1, 0.0317, 0.0683, 0.3, 0.0001, 0.0999][k % 6])
    want(abs(one.time - 9) < 1e-9, "the steps of this check")
    row = [float(x) for x in expected[300][1:]]
    off = max(abs(a - b) / (1 + abs(b)) for a, b in zip(one.outputs(), row))
    want(off < 1e-4, f"odd steps: {off:g} apart")
    one.close()


def check_states():
    """10,000 times saved and set again: the same bits. Serialized into another instance: the same motion, after it moved
    elsewhere with other parameters. With controllers and delays, latches, exact beams with joints and supports, loops, rotors."""
    (folder / "hinged.txt").write_text(HINGED)
    export(folder / "hinged.txt", 2)
    cases = {"satellite_control": 100, "deployment": 20, "whirl": 20, "squeezer": 20, "momentum_wheel": 20, "functions": 20, "hinged": 20,
             "spacecraft": 20}
    for k, (name, count) in enumerate(cases.items()):
        file = folder / f"{name}{2 + k % 2}.fmu"
        one = Instance(file)
        length = interval(one)
        rows_of(one, count, length)
        one.step(0.37 * length)
        state = one.fmu.getFMUState()
        bytes_of = one.fmu.serializeFMUState(state)
        begin = one.time
        for _ in range(10000 if k == 0 else 10):
            again = one.fmu.getFMUState()
            one.fmu.setFMUState(again)
            one.fmu.freeFMUState(again)
        rest = steps(one, begin, length)
        for _ in range(2):
            one.fmu.setFMUState(state)
            want(steps(one, begin, length) == rest, f"{file}: the motion from a saved state is another one")
        other = Instance(file)
        rows_of(other, 3, 0.7 * length)
        back = other.fmu.deserializeFMUState(bytes_of)
        other.fmu.setFMUState(back)
        want(steps(other, begin, length) == rest, f"{file}: the motion after a restart is another one")
        want(other.fmu.serializeFMUState(back) == bytes_of, f"{file}: a state serialized again is another one")
        through = Instance(file)
        rows_of(through, count, length)
        through.step(0.37 * length)
        want(steps(through, begin, length) == rest, f"{file}: saved states change the motion")
        for each in one, other, through:
            each.close()
    return len(cases)


def steps(one, begin, length):
    one.time = begin
    rows = [one.outputs()]
    for _ in range(12):
        one.step(0.63 * length)
        rows.append(one.outputs())
    return rows


def check_several():
    """Instances of one library, with other parameters: in turns and in threads of their own they move as each alone, one
    is built while others move, and a saved state goes from one to the other."""
    angles = 0.1, 0.2, 0.3, 0.4
    for version in 2, 3:
        file = folder / f"satellite_control{version}.fmu"
        alone = []
        for angle in angles:
            one = Instance(file, **{"parameter.angle": angle})
            alone.append(rows_of(one, 40, 0.1))
            one.close()
        first = Instance(file, **{"parameter.angle": angles[0]})
        ones = [first] + [Instance(file, beside=first, **{"parameter.angle": angle}) for angle in angles[1:]]
        rows = [[outputs(one)] for one in ones]
        for k in range(20):
            for one, of in zip(ones, rows):
                of += rows_of(one, 1, 0.1, k)[1:]
        want(rows == [of[:21] for of in alone], f"{file}: instances in turns disturb each other")
        state = ones[1].fmu.getFMUState()
        bytes_of = ones[1].fmu.serializeFMUState(state)
        threads = [threading.Thread(target=lambda one=one, of=of: of.extend(rows_of(one, 20, 0.1, 20)[1:])) for one, of in zip(ones, rows)]
        for thread in threads:
            thread.start()
        late = Instance(file, beside=first, **{"parameter.angle": angles[2]})
        early = rows_of(late, 5, 0.1)
        for thread in threads:
            thread.join()
        want(rows == alone and early == alone[2][:6], f"{file}: instances in threads disturb each other")
        back = late.fmu.deserializeFMUState(bytes_of)
        late.fmu.setFMUState(back)
        late.time = ones[1].time = 2.0
        ones[1].fmu.setFMUState(state)
        for one in late, ones[1]:
            want(rows_of(one, 20, 0.1, 20) == alone[1][20:], f"{file}: the motion after the state of another instance is another one")
        for one in [late] + ones[1:]:
            one.free()
        first.close()


def check_size():
    """[kB] of a saved state and of an instance: what the process has more after five more, each. The latter is what the
    system likes to give, once 18 MB instead of 8: no bound."""
    sizes = []
    for name in "satellite_control", "spacecraft", "whirl":
        first = Instance(folder / f"{name}3.fmu")
        state = first.fmu.getFMUState()
        begin = resident()
        more = [Instance(folder / f"{name}3.fmu", beside=first) for _ in range(5)]
        for one in more:
            rows_of(one, 3, interval(one))
        sizes.append((name, len(first.fmu.serializeFMUState(state)) / 1000, (resident() - begin) / 5000))
        want(sizes[-1][1] < 10, f"{name}: a state of {sizes[-1][1]} kB")
        for one in more:
            one.free()
        first.close()
    return sizes


def resident():
    """Bytes of this process in memory."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096


def check_derivatives():
    """Directional derivatives are differences of outputs, and the D of --linear; outputs without dependencies do not
    follow inputs."""
    most = 0.0
    for k, name in enumerate(["driven", "spacecraft", "momentum_wheel", "rotor", "spinup_torque", "double_pendulum"]):
        one = Instance(folder / f"{name}{2 + k % 2}.fmu")
        one.run_first = rows_of(one, 3, interval(one))
        names, base = one.names("output"), np.array(one.outputs())
        direct = np.array([bool(u.dependencies) for u in one.description.outputs])
        of = [r for output in names for r in one.references(output)]
        for name_in in one.names("input"):
            more = {} if one.two else {"nSensitivity": len(base)}
            slope = np.array(one.fmu.getDirectionalDerivative(of, one.references(name_in), [2.0], **more))
            one.set(name_in, 2.0)
            change = np.array(one.outputs()) - base
            one.set(name_in, 0.0)
            want(not change[~direct].any() and not slope[~direct].any(), f"{name}: an output follows {name_in} without a dependency")
            most = max(most, abs(slope - change).max() / max(1e-3, abs(change).max()))
        one.close()
    want(most < 1e-8, f"derivatives are {most:g} off")
    tool("scene", folder / "driven.txt", "--linear", folder / "driven.json", "--quiet")
    linear = json.loads((folder / "driven.json").read_text())
    one = Instance(folder / "driven2.fmu")
    compared = 0
    for i, out in enumerate(linear["outputs"]):
        for j, known in enumerate(linear["inputs"]):
            mine = known["name"].replace(".1", "")
            if mine not in one.first or f"output.{out['name']}" not in one.first:
                continue
            slope = one.fmu.getDirectionalDerivative(one.references(f"output.{out['name']}"), one.references(mine), [1.0])[0]
            size = float(known["unit"].split()[0]) if known["unit"][0].isdigit() else 1.0
            want(abs(slope * size - linear["D"][i][j]) < 1e-7, f"d {out['name']} / d {mine}: {slope * size}, --linear: {linear['D'][i][j]}")
            compared += linear["D"][i][j] != 0
    want(compared >= 6, f"{compared} numbers of D are compared")
    one.close()
    return most


def check_rates():
    """Derivatives by time are those of the motion around, with motors, rotors, controllers and loops; the adjoint ones
    those by inputs, transposed. An exact beam has none by time."""
    most = 0.0
    for k, name in enumerate(["driven", "spacecraft", "momentum_wheel", "double_pendulum", "squeezer", "satellite_control"]):
        one = Instance(folder / f"{name}{3 - k % 2}.fmu")
        rows_of(one, 3, interval(one))
        one.step(0.031 * interval(one))
        mine, moved, size = central(one, min(1e-4, interval(one) / 100))
        most = max(most, np.max(np.abs(mine - moved) / size))
        if k == 0:
            check_adjoint(one)
        one.close()
    want(most < 1e-6, f"derivatives by time are {most:g} off")
    one = Instance(folder / "whirl2.fmu")
    want(one.description.coSimulation.maxOutputDerivativeOrder == 0, "an exact beam has derivatives by time")
    refuses("a derivative of an exact beam", lambda: rates(one, one.names("output")), one.log, "no derivatives of outputs")
    one.close()
    return most


def check_events():
    """A step ends at a latch, where the importer allows it, and tells its time; from there the rows are those of the run.
    In event mode the latch acts when it is told to: what it holds stands still, the momentum stays, the next step is the
    same. Left alone a step goes through."""
    latch, early = 7.733, {"settings.early_return": 1.0}
    expected = run_of(scenes / "deployment.txt", f"latch={latch}")
    for what, version, asks in (("FMI 2", 2, {}), ("FMI 3", 3, {"early": True}), ("event mode", 3, {"early": True, "events": True})):
        one = Instance(folder / f"deployment{version}.fmu", **{"parameter.latch": latch}, **(early if version == 2 else {}), **asks)
        if "events" in asks:
            want(one.fmu.updateDiscreteStates()[-2:] == (True, 1.0), "the first event is at 1 s")
            one.fmu.enterStepMode()
        met, rows, k = [], [outputs(one)], 0
        while len(rows) < 420:
            step_early(one, k * 0.02 + 0.02, met)
            if abs(one.time - (k + 1) * 0.02) < 1e-9:
                rows.append(outputs(one))
                k += 1
            if met and met[-1] == one.time:
                at_event(one, asks, latch)
        want(met == ([1.0, latch] if "events" in asks else [latch]), f"{what}: events at {met}")
        compare(f"{what}, a step ends at the latch", rows, expected)
        one.close()
    for name, asks, words in (("deployment3", {}, "not asked for"), ("driven3", {"events": True}, "instantiate")):
        log = []
        refuses(f"event mode of {name}", lambda: enter_events(name, asks, log), log, words)
    through = Instance(folder / "deployment2.fmu", **{"parameter.latch": latch})
    compare("through the latch", rows_of(through, 420, 0.02), expected)
    through.close()
    rows = fmpy.simulate_fmu(str(folder / "deployment3.fmu"), early_return_allowed=True, use_event_mode=True, stop_time=9)
    compare("event mode of FMPy", [[f"{x:.12g}" for x in list(row)[1:]] for k, row in enumerate(rows[:380]) if k == 0 or row[0] > rows[k - 1][0]],
            run_of(scenes / "deployment.txt"))


def step_early(one, end, met):
    """To end, or to an event before it, the time of which becomes the last of met."""
    if one.two:
        try:
            one.step_to(end)
        except fmpy.fmi1.FMICallException as refusal:
            want(refusal.status == 2 and "event" in one.log[-1], f"FMI 2: {refusal}")
            one.time = one.fmu.getRealStatus(2)
            met.append(one.time)
        return
    needed, terminate, stopped, one.time = one.fmu.doStep(one.time, end - one.time)
    want(not terminate and (not needed or one.asks["eventModeUsed"]), "a step tells of what was not asked for")
    if needed or stopped:
        met.append(round(one.time, 9))
        one.time = met[-1] if abs(one.time - met[-1]) < 1e-12 else one.time


def at_event(one, asks, latch):
    if "events" not in asks:
        return
    before = dict(zip(one.names("output"), one.outputs()))
    one.fmu.enterEventMode()
    told = one.fmu.updateDiscreteStates()
    after = dict(zip(one.names("output"), one.outputs()))
    one.fmu.enterStepMode()
    want(told == ((False, False, False, False, True, latch) if one.time < 2 else (False, False, False, False, False, told[-1])),
         f"an update tells {told}")
    want(after["output.angle"] == before["output.angle"] and abs(after["output.momentum"] - before["output.momentum"]) < 1e-9,
         "an event moves what it should not")
    if one.time > 2:
        spin = rates(one, ["output.angle"])[0]
        want(abs(spin) < 1e-9 and abs(after["output.hub_rate"] - before["output.hub_rate"]) > 1e-4, "the latch does not act")


def enter_events(name, asks, log):
    one = Instance(folder / f"{name}.fmu", **asks)
    try:
        one.fmu.enterEventMode()
    finally:
        log += one.log
        one.close()


def refuses(what, call, log, *words):
    global refusals
    n = len(log)
    try:
        call()
    except Exception as error:
        told = " ".join(log[n:]) or str(error)
        want(all(word in told for word in words), f"{what}: no word of {words}: {told}")
        refusals += 1
        return
    want(False, f"{what} is not refused")


def forget(one):
    one.free()
    one.log.clear()


def damaged(name, change):
    """An instance of an FMU of which a file is another one; not instantiated yet."""
    one = Instance(folder / f"{name}2.fmu", initialize=False)
    forget(one)
    change(Path(one.folder) / "resources")
    return one


def check_refusals():
    global refusals
    for change, words in ((lambda at: (at / "driven.txt").unlink(), ["driven.txt", "No such file"]),
                          (lambda at: (at / "flexbeam.txt").unlink(), ["flexbeam.txt", "No such file"]),
                          (lambda at: (at / "driven.txt").write_text(DRIVEN.replace("900 900", "901 900")), ["token"]),
                          (lambda at: (at / "flexbeam.txt").write_text("scene driven.txt\nfile\n"), ["flexbeam.txt:2", "missing"]),
                          (lambda at: (at / "driven.txt").write_text("duration 1\nbox\n"), ["driven.txt:2", "no such word: box"])):
        other = damaged("driven", change)
        refuses("other resources", other.instantiate, other.log, *words)
    for name, value, words in (("parameter.push", 0.0, ["other variables", "force.boom.tip"]),
                               ("parameter.modes", 1.5, ["driven.txt:", "whole number"]),
                               ("settings.step", -1.0, ["settings.step", "at least 0"]),
                               ("settings.step", 1e-11, ["steps of", "at most"]),
                               ("motor.root", math.nan, ["motor.root", "finite"])):
        other = Instance(folder / "driven3.fmu", initialize=False)
        refuses(f"{name} {value}", lambda: other.initialize(**{name: value}), other.log, *words)
        other.fmu.reset()
        other.initialize()
        want(len(rows_of(other, 3, 0.1)) == 4, f"after {name} {value} it does not run")
        other.close()
    for name in "driven3", "satellite_control2", "spinup_torque3":  # steps that are given, of controllers, chosen ones
        other = Instance(folder / f"{name}.fmu")
        other.step(0.1)
        before = other.outputs()
        for length, words in ((1e12, ["step of 1e+12 s", "10000000 at most"]), (1e8, ["step of 1e+08 s", "10000000 at most"]),
                              (math.inf, ["above 0"]), (math.nan, ["above 0"]), (-0.1, ["above 0"]), (1e-20, ["step of 1e-20 s", "0.1 s"])):
            refuses(f"{name}: a step of {length} s", lambda: other.step(length), other.log, *words)
            want(other.outputs() == before, "a step that is refused changes something")
        other.step(0.1)
        other.close()
    other = Instance(folder / "spinup_torque3.fmu", **{"settings.step": 10})
    before = other.outputs()
    refuses("a step beyond the limit", lambda: other.step(0.1), other.log, "spinup_torque.txt", "step of 0.05 s", "fb_rk4_step")
    other.set(other.names("input")[0], 0.0)
    want(other.outputs() == before, "a step that is refused changes something")
    other.close()
    for text, words in (("duration 1\nbox 3\n", [":2: no such word: box"]),
                        ("duration 1\n", ["bod"]),
                        ("duration 1\nbody a file none.txt\nend\n", ["none.txt", "No such file"]),
                        (DRIVEN.replace("duration 2", ""), ["wants a duration"]),
                        (DRIVEN + f"reference {Path('tests/reference/p07C_second_order.csv').resolve()} t GE_u2 output spin tolerance 1\n", ["from the folder of the scene"])):
        file = folder / "bad.txt"
        file.write_text(text)
        made = tool("fmu", file, "--binary", binary(2), "--out", folder / "bad.fmu")
        want(made.returncode in (1, 2) and all(word in made.stderr for word in words), f"a scene that is none: {made.stderr}")
        want(not list(folder.glob("bad.fmu*")), "a folder is left behind")
        refusals += 1
    made = tool("fmu", "examples/satellite.txt", "--binary", binary(2), "--out", folder / "bad.fmu")
    want(made.returncode == 2 and "--binary" in made.stderr, f"--binary of a body: {made.stderr}")
    (folder / "packed.fmu").write_bytes(b"PK\3\4")
    made = tool("fmu", "examples/scenes/top.txt", "--binary", folder / "packed.fmu", "--out", folder / "bad.fmu")
    want(made.returncode == 2 and "not the FMU" in made.stderr, f"--binary of an FMU: {made.stderr}")


def check_folders():
    """A file of the scene is where the scene says, from a place with blanks."""
    place = folder / "a place"
    place.mkdir()
    (place / "data").mkdir()
    (place / "scenes").mkdir()
    (place / "data" / "force.csv").write_text("t,f\n0,0\n1,2\n")
    file = place / "scenes" / "a driven one.txt"
    file.write_text(DRIVEN.replace("constant $force", "file ../data/force.csv t f").replace("parameter force 3\n", ""))
    expected = run_of(file)
    for version in 2, 3:
        fmu = export(file, version, "placed")
        held = zipfile.ZipFile(fmu).namelist()
        want("resources/data/force.csv" in held and "resources/d/a_driven_one.txt" in held, f"{fmu} holds {held}")
        one = Instance(fmu)
        far = Path(one.folder).rename((folder / f"far away {version}").resolve())
        forget(one)
        one.fmu.unzipDirectory = str(far)
        one.instantiate()
        one.initialize()
        compare(fmu, rows_of(one, 20, 0.1), expected)
        one.fmu.freeInstance()
        shutil.rmtree(far)


def check_speed():
    """1 kHz: a step and a reading of all outputs, with what Python costs."""
    speeds = []
    for name in "spacecraft", "satellite_control":
        one = Instance(folder / f"{name}2.fmu")
        references = [r for output in one.names("output") for r in one.references(output)]
        of, value = (ctypes.c_uint * len(references))(*references), (ctypes.c_double * len(references))()
        step, get, component = one.fmu.dll.fmi2DoStep, one.fmu.dll.fmi2GetReal, ctypes.c_void_p(one.fmu.component)
        step.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_int]
        most = 1e9
        for _ in range(5):
            begin = time.process_time()
            for k in range(1000):
                want(step(component, one.time + 0.001 * k, 0.001, 1) == 0 and get(component, of, len(of), value) == 0, "a step of 1 ms fails")
            one.time += 1
            most = min(most, time.process_time() - begin)
        one.close()
        speeds.append(1 / most)
    want(speeds[0] > 25, f"1 kHz: {speeds}")  # 50 by -O2 on a machine that does nothing else
    return speeds


for version in 2, 3:
    with zipfile.ZipFile(folder / f"scene{version}.fmu") as packed:
        name = [n for n in packed.namelist() if n.startswith("binaries/") and n.endswith((".so", ".dylib"))][0]
        binary(version).write_bytes(packed.read(name))
times = [time.time()]


def timed(call):
    result = call()
    times.append(time.time())
    return result


moved, still = timed(check_all)
timed(check_simulate)
timed(check_parameters)
timed(check_inputs)
timed(check_base)
timed(check_odd_steps)
saved = timed(check_states)
timed(check_several)
sizes = timed(check_size)
slope = timed(check_derivatives)
slower = timed(check_rates)
timed(check_events)
timed(check_refusals)
timed(check_folders)
speeds = timed(check_speed)
if "--times" in sys.argv:
    print(" ".join(f"{b - a:.1f}" for a, b in zip(times, times[1:])))
print(f"{moved} scenes valid in FMI 2.0 and 3.0, {numbers} outputs as their runs have them, {still} without motion refused, states of {saved}, "
      f"of a state and an instance {', '.join(f'{name} {state:.1f} kB and {whole / 1000:.1f} MB' for name, state, whole in sizes)}, "
      f"derivatives by inputs to {slope:.1g}, by time to {slower:.1g}, {refusals} refusals, 1 kHz with {speeds[0]:.0f} and {speeds[1]:.0f} times to spare")
