"""The package flexbeam against the scene program and SciPy: bits, saved states, linear models, modes, refusals, instances,
threads, the notebook.

usage: python.py FOLDER CURVE..., of files that programs in other languages have written; FLEXBEAM_SECONDS: to the first curve, at most
Prints one line of figures, or what is wrong, with exit status 1.
"""
import copy
import csv
import json
import os
import pickle
import re
import resource
import subprocess
import sys
import threading
import time
from pathlib import Path

begin = time.perf_counter()
import flexbeam  # noqa: E402

flexbeam.Scene("examples/scenes/rotor.txt").run()
first_curve = time.perf_counter() - begin

import numpy as np  # noqa: E402
from scipy.linalg import expm  # noqa: E402
from flexbeam import Description, FlexbeamError, Scene, StepRefused  # noqa: E402

folder, curves = Path(sys.argv[1]), sys.argv[2:]
scenes = Path("examples/scenes")
QUICK = "rotor spinup_rate top stops panel_slew shaft_control spacecraft momentum_wheel large_drop deployment double_pendulum star_tracker".split()
DRIVEN = """
parameter EI 900   N m^2
duration 4
interval 0.02
step 0.001
body hub rigid
  hub 50  0 0 0  5 6 7
  node 1 0 0 right
end
body boom beam
  length 4
  elements 4
  stations x mass EI_y EI_z
    0 1 900 $EI
  end
  modes bend_y 2 bend_z 2
  damping 0.01
  node tip tip
end
joint root revolute hub.right boom
  axis 0 1 0
  stiffness 40
  motor 1 constant 0
end
load boom.tip base force 0 1 0 constant 0
output spin spin hub
output bend displacement boom.tip
output angle coordinate root 1
"""


def want(condition, what):
    if not condition:
        print(what)
        sys.exit(1)


def tool(*words):
    return subprocess.run(["build/flexbeam", *map(str, words)], capture_output=True, text=True)


def run_of(file, *settings):
    """Head and rows of the scene's own run, in the digits of its file."""
    out = folder / "run.csv"
    tool("scene", file, "--out", out, "--quiet", *[w for s in settings for w in ("--set", s)])
    with open(out) as lines:
        head, *rows = csv.reader(lines)
    return head, rows


def digits(run):
    return [["%.12g" % x for x in row] for row in run.table]


def check_bits():
    """Two are open at a time, begun in the other order, and asked for modes between: none has anything of the other."""
    numbers = 0
    for one, other in zip(QUICK[::2], QUICK[1::2]):
        both = {name: Scene(scenes / f"{name}.txt") for name in (one, other)}
        half = both[one].run(both[one].duration / 2)
        for name in (other, one):
            both[name].modes()
        for name, scene in both.items():
            head, rows = run_of(scenes / f"{name}.txt")
            run = scene.run()
            mine = digits(half)[:-1] + digits(run) if name == one else digits(run)
            want(head[1:] == [f"{k} [{run.units[k]}]" for k in run], f"{name}: outputs {run}, not {head}")
            want(mine == rows, f"{name}: other rows than those of the scene program")
            numbers += run.table.size
    head, rows = run_of(scenes / "double_pendulum.txt", "modes=2")
    want(digits(Scene(scenes / "double_pendulum.txt", modes=2).run()) == rows, "a parameter: other rows")
    return numbers


def check_states():
    scene, other = Scene(DRIVEN), Scene(DRIVEN, EI=800)
    scene.set("motor.root[1]", 3.0)
    scene.step_to(1.0)
    saved = scene.save()
    after = scene.run(2.0).table
    other.restore(saved)
    want(other.get("motor.root[1]") == 3.0 and other.get("EI") == 900 and other.time == 1.0, "restored: inputs, parameters, time")
    want((other.run(2.0).table == after).all(), "a saved state goes on with other bits")
    scene.reset()
    want(scene.time == 0 and scene.get("angle") == 0 and scene.get("motor.root[1]") == 0, "reset")
    for damaged in (b"", saved[:-8], saved[:200] + b"?" + saved[201:]):
        refused(lambda: other.restore(damaged), "state")
    refused(lambda: Scene(DRIVEN + "#").restore(saved), "state")
    return len(saved)


def check_parameters():
    """A parameter that is refused leaves all but its number as it was, and what depends on one is that of its present number."""
    text = DRIVEN.replace("duration 4", "").replace("interval 0.02", "") + "duration $T\ninterval 0.1*$T\n"
    text = text.replace("force 0 1 0", "force 0 $F 0").replace("length 4", "length $L")
    text = "parameter T 4\nparameter L 4\nparameter F 1\n" + text
    known, scene = Scene(text).run(1.2).table, Scene(text)
    for name, bad, good in (("L", -1, 4), ("F", 0, 1)):
        names = [(scene._names(kind), scene._units_of(kind)) for kind in range(3)]
        scene.reset(**{name: bad})
        refused(lambda: scene.step_to(0.4), "length" if name == "L" else "other variables")
        want([(scene._names(kind), scene._units_of(kind)) for kind in range(3)] == names, f"a refused {name} renames numbers")
        want((scene.get("T"), scene.get("L"), scene.get(name)) == (4, bad if name == "L" else 4, bad), f"a refused {name}: parameters")
        want((scene.duration, scene.interval) == (4, 0.4), f"a refused {name}: duration {scene.duration}")
        scene.set(name, good)
        want((scene.run(1.2).table == known).all(), f"after a refused {name} the scene moves otherwise")
    scene.reset(T=2)
    want((scene.duration, scene.interval) == (2, 0.2), f"duration {scene.duration}, where the parameter says 2")
    want(scene.run().t.tolist() == (np.arange(11) * 0.2).tolist(), "rows are those of another parameter")
    scene.reset()
    want((scene.run(1.2).table == known).all(), "a duration of before the reset")
    (folder / "same.txt").write_text(text)
    Scene(folder / "same.txt").restore(scene.save())


def check_linear():
    for name in ("satellite_control", "rotating_beam", "panel_slew"):
        out = folder / f"{name}.json"
        told = tool("scene", scenes / f"{name}.txt", "--quiet", "--linear", out)
        want(out.exists(), f"--linear of {name}: {told.stderr}")
        file, model = json.loads(out.read_text()), Scene(scenes / f"{name}.txt").linear()
        for key, matrix in zip("ABCD", model):
            want((matrix == np.array(file[key], dtype=float).reshape(matrix.shape)).all(), f"{name}: {key} is not that of --linear")
        for key, names, units in (("states", model.states, model.state_units), ("inputs", model.inputs, model.input_units),
                                  ("outputs", model.outputs, model.output_units)):
            want([(v["name"], v["unit"]) for v in file[key]] == list(zip(names, units)), f"{name}: {key} are not those of --linear")


def check_modes():
    for name in ("satellite_control", "beck", "spacecraft"):
        told = tool("scene", scenes / f"{name}.txt", "--modes").stdout.splitlines()[1:]
        modes = Scene(scenes / f"{name}.txt").modes()
        motion = ["UNSTABLE" if g > 0 else "decays" if g < 0 else "undamped" if u > 0 else "free" for u, g in
                  zip(modes.undamped, modes.growth)]
        mine = [f"{k + 1:4}  {u / 2 / np.pi:13.6g}  {d / 2 / np.pi:11.6g}  {d:14.6g}  {z:13.4g}  {g:12.4g}  {m:8}  {n or '-':16}  {w}"
                for k, (u, d, z, g, m, n, w) in enumerate(zip(modes.undamped, modes.damped, modes.damping, modes.growth, motion,
                                                              modes.names, modes.what))]
        want(mine == told, f"{name}: modes are not those of --modes")


def check_scipy():
    """A push so small that the motion is linear to 1e-8, by the exponential of the linear model; poles beside modes."""
    scene = Scene(DRIVEN)
    scene.set("settings.step", 2e-4)
    model, modes = scene.linear(), scene.modes()
    A, B, C, D = model
    push = np.zeros(B.shape[1])
    for given, mine in (("motor.root[1]", "motor.root.1"), ("force.boom.tip", "force.boom.tip")):
        push[model.inputs.index(mine)] = 1e-6
        scene.set(given, 1e-6)
    run = scene.run(2.0)
    whole = expm(scene.interval * np.block([[A, (B @ push)[:, None]], [np.zeros((1, len(A) + 1))]]))
    x, difference = np.append(np.zeros(len(A)), 1.0), 0.0
    largest = np.abs(run.table[:, 1:]).max(axis=0)
    for row in run.table:
        y = dict(zip(model.outputs, C @ x[:-1] + D @ push))
        for k, name in enumerate(run):
            if largest[k] > 1e-3 * largest.max():
                difference = max(difference, abs(y[name] - row[1 + k]) / largest[k])
        x = whole @ x
    want(difference < 1e-6, f"the run is {difference:.2g} from SciPy's exponential of the linear model")
    poles = np.linalg.eigvals(A)
    poles = np.sort(poles.imag[poles.imag > 1e-6])
    damped = np.sort(modes.damped[modes.damped > 1e-6])
    error = np.abs(poles / damped - 1).max()
    want(error < 1e-6, f"poles of the linear model are {error:.2g} from the modes")
    try:
        import control
    except ImportError:
        return difference, "no python-control"
    mine = np.sort_complex(control.ss(*model).poles())
    want(np.abs(mine - np.sort_complex(np.linalg.eigvals(A))).max() < 1e-6 * np.abs(mine).max(), "poles of python-control")
    return difference, f"python-control {control.__version__}"


def check_campbell():
    """Bending in the plane becomes as stiff as out of it, and stiffer: both are followed through the crossing."""
    text = DRIVEN.replace("revolute hub.right boom\n  axis 0 1 0\n  stiffness 40\n  motor 1 constant 0", "rigid hub.right boom")
    text = text.replace("output angle coordinate root 1\n", "")
    scene = Scene(text)
    diagram = scene.campbell("EI", 600, 1200, 13)
    (folder / "campbell.txt").write_text(text)
    told = tool("scene", folder / "campbell.txt", "--campbell", "EI", 600, 1200, 13).stdout.splitlines()
    want(told[0].count(",") == 1 + 2 * len(diagram.names) and all(f",{name} [rad/s]," in told[0] for name in diagram.names),
         f"curves are not those of --campbell: {diagram.names}, {told[:1]}")
    for row, line in enumerate(told[1:]):
        mine = [diagram.values[row], diagram.spin[row], *np.dstack([diagram.damped[row], diagram.growth[row]]).ravel()]
        want(line == ",".join(f"{x + 0.0:.12g}" for x in mine), f"a row of curves is not that of --campbell: {line}")
    want((diagram[diagram.names[0]] == diagram.damped[:, 0]).all(), "a curve by its name")
    still = np.abs(diagram.damped[:, :2] / diagram.damped[0, :2] - 1).max(axis=0)
    want(min(still) < 1e-9 < 0.1 < max(still), f"crossing modes are not followed: {still}")
    slow = diagram.damped[:, np.argmax(still)]
    want((np.diff(slow) > 0).all() and np.diff(np.argsort(diagram.damped[[0, -1], :2])[:, 0])[0] != 0, "they do not cross")
    for value, row in zip(diagram.values[::6], diagram.damped[::6]):
        modes = Scene(text, EI=value).modes().damped
        want(np.abs(np.sort(row) - modes[modes > 0]).max() < 1e-6 * row.max(), f"modes at EI {value}: {row}")
    want(scene.time == 0 and scene.get("EI") == 900, "campbell changes the scene")
    held = DRIVEN.replace("0 1 900 $EI", "0 1 $EI 900").replace("  stiffness 40\n", "")
    for n in (2, 3, 5):  # flap over few values: each mode becomes sqrt(10) times as fast, far beyond the next one
        diagram = Scene(held.replace("revolute hub.right boom\n  axis 0 1 0\n  motor 1 constant 0", "rigid ground boom")
                        .replace("output angle coordinate root 1\n", "")).campbell("EI", 100, 1000, n)
        ratio = diagram.damped[-1] / diagram.damped[0]
        want(np.minimum(np.abs(ratio - 10**0.5), np.abs(ratio - 1)).max() < 1e-9, f"{n} values: modes are mistaken: {ratio}")


refusals = 0


def refused(call, text, file=None, line=0, word=None):
    global refusals
    try:
        call()
    except FlexbeamError as error:
        found = (error.file, error.line, error.word)
        want(text in str(error), f"not '{text}': {error}")
        want(word is None or found == (file, line, word), f"{error}: about {found}, not {(file, line, word)}")
        refusals += 1
        return error
    want(False, f"no refusal: {text}")


def check_refusals():
    rotor = str(scenes / "rotor.txt")
    refused(lambda: Scene("nothing.txt"), "No such file", "nothing.txt", 0, "")
    refused(lambda: Scene(rotor, spi=3), "no parameter has the name spi", rotor, 0, "spi")
    refused(lambda: Scene(DRIVEN, EI=float("nan")), "no finite number", None, 0, "EI")
    refused(lambda: Scene(DRIVEN.replace("length 4", "length four")), "text:11: length is not a number", "text", 11, "four")
    refused(lambda: Scene(DRIVEN.replace("step 0.001", "stop 0.001")), "no such word: stop", "text", 5, "stop")
    refused(lambda: Scene(DRIVEN.replace("step 0.001", "step 0")), "greater than 0", "text", 5, "0")
    refused(lambda: Scene(DRIVEN.replace("displacement boom.tip", "displacement boom.top")), "has no node top", "text", 27, "boom.top")
    refused(lambda: Scene(DRIVEN.replace("900 $EI", "900 900")), "nothing uses parameter EI", "text", 2, "parameter")
    refused(lambda: Scene(DRIVEN.replace("  stiffness 40\n", "  stiffness 40\nend\n")), "", "text")
    refused(lambda: Scene("duration 1\nbody b file no.txt\nend\n", folder=folder), "no.txt", str(folder / "text"), 2, "no.txt")
    (folder / "bad.txt").write_text("beam\nlength -\n")
    refused(lambda: Scene("duration 1\nbody b file bad.txt\nend\n", folder=folder), "length", str(folder / "bad.txt"), 2, "-")
    refused(lambda: Scene("duration 1\nbody b rigid\n  hub 5  0 0 0  0 0 0\nend\n").get(), "body b", "text", 2, "body")
    scene = Scene(DRIVEN)
    refused(lambda: scene.get("agle"), "agle: there is no such name, but spin_x", None, 0, "agle")
    refused(lambda: scene.set("angle", 1), "angle: there is no such name", None, 0, "angle")
    refused(lambda: scene.set({"force.boom.tip": 1, "motor.root[1]": float("inf")}), "finite", None, 0, "motor.root[1]")
    want(scene.get("force.boom.tip") == 0, "half of what was refused is set")
    scene.step_to(0.5)
    refused(lambda: scene.set(EI=800), "cannot be set after initialization", None, 0, "EI")
    refused(lambda: scene.step_to(0.4), "a step to 0.4 s, while the time is 0.5 s")
    refused(lambda: scene.step_to(float("nan")), "a step to nan")
    refused(lambda: scene.run(0.5), "a run to 0.5 s")
    refused(lambda: Scene(scenes / "beck.txt").step_to(1), "without duration")
    refused(lambda: Scene(scenes / "beck.txt").run(), "without duration")
    refused(lambda: Scene(scenes / "rotor.txt").restore(scene.save()), "no state of this model")
    refused(lambda: Scene(scenes / "whirl.txt").campbell("spi", 1, 2), "spi")
    refused(lambda: Scene(DRIVEN, EI="stiff"), "'stiff' is no number", None, 0, "EI")
    refused(lambda: scene.set("force.boom.tip"), "None is no number", None, 0, "force.boom.tip")
    refused(lambda: scene.run(float("nan")), "a run to nan")
    refused(lambda: Scene("duration 1\n\0"), "character 0")
    with Scene(DRIVEN) as closed:
        closed.step_to(0.013)
        want(closed.run(0.1).t.tolist() == [0.013, 0.02, 0.04, 0.06, 0.08, 0.1], "rows from a time that is none")
    refused(lambda: closed.get("angle"), "the scene is closed")
    for one in (copy.copy, copy.deepcopy, pickle.dumps):
        try:
            one(scene)
            want(False, f"{one.__name__} of a scene: two that give the same memory back")
        except TypeError as error:
            want("restore()" in str(error), str(error))
    error = refused(lambda: scene.get("agle"), "agle")
    want(str(pickle.loads(pickle.dumps(error))) == str(error), "an error does not go to other processes")
    before = scene.save()
    scene.set("force.boom.tip", 1e9)
    error = refused(lambda: scene.run(4), "text: at 0.5")
    want(isinstance(error, StepRefused) and scene.time < 4, "what cannot be stepped is no StepRefused")
    want(len(error.run.t) >= 1 and error.run.t[0] == 0.5, "rows before what cannot be stepped")
    scene.restore(before)
    scene.step_to(0.6)


def check_builder():
    scene = Description()
    scene.parameter("EI", 900)
    scene.duration(4)
    scene.interval(0.02)
    scene.step(0.001)
    with scene.body("hub", "rigid"):
        scene.hub(50, np.zeros(3), (5, 6, 7))
        scene.node([1, 0, 0], "right")
    with scene.body("boom", "beam"):
        scene.length(4)
        scene.elements(4)
        with scene.stations("x", "mass", "EI_y", "EI_z"):
            scene.row(0, 1, 900, "$EI")
        scene.modes("bend_y", 2, "bend_z", 2)
        scene.damping(0.01)
        scene.node("tip", "tip")
    with scene.joint("root", "revolute", "hub.right", "boom"):
        scene.axis(0, 1, 0)
        scene.stiffness(40)
        scene.motor(1, "constant", 0)
    scene.load("boom.tip", "base", "force", (0, 1, 0), "constant", 0.0)
    scene.output("spin", "spin", "hub")
    scene.output("bend", "displacement", "boom.tip")
    scene.add("output", "angle", "coordinate", "root", 1)
    (folder / "built.txt").write_text(DRIVEN)
    tables = []
    for source in (scene, DRIVEN, folder / "built.txt"):
        one = Scene(source)
        one.set("force.boom.tip", 0.1)
        tables.append(one.run(1.0).table)
    want((tables[0] == tables[1]).all() and (tables[1] == tables[2]).all(), "builder, text and file: other bits")
    want(one.units["force.boom.tip"] == "N" and one.units["bend_y"] == "m" and one.units["motor.root[1]"] == "N m", "units")
    want("900" not in one.advise() and "integrator rk4, steps of at most 0.001 s" in one.advise(), f"advice: {one.advise()}")
    text = Scene(scenes / "spinup_auto.txt").advise()
    told = tool("scene", scenes / "spinup_auto.txt").stdout
    want(text and told.startswith(text), f"advice is not what the scene program tells: {text}")
    want((one.advise().integrator, one.advise().step, one.advise().chosen, one.advise().bodies) == ("rk4", 1e-3, False, {}), "advice as fields, of none")
    beam, lines = text.bodies["beam"], told.splitlines()
    want(lines[0] == f"beam: {len(beam['modes'])} of {beam['modes_there']} modes, effects: {' '.join(beam['effects'])}", "advice as fields: modes, effects")
    want(lines[1].startswith(f"  estimated error {100 * beam['error']['all']:.2g} % of {beam['deflection']:.3g} m, allowed {100 * beam['tolerance']:.2g} %"), "advice as fields: error")
    want(all(f"{name}: {100 * value:.2g} %" in lines[1] for name, value in beam["without"].items()), "advice as fields: what is left out")
    want(lines[2] == f"integrator {text.integrator}, step at most {text.step:.3g} s, {text.steps:.10g} steps", "advice as fields: step")
    want(text.units["step"] == "s" and text.units["deflection"] == "m" and text.chosen and not text.warning, "advice as fields: units")


def check_instances():
    """A thousand are alive, each with its own parameter; each ends where it does alone."""
    alone = [Scene(DRIVEN, EI=900 + k) for k in (0, 999)]
    for scene in alone:
        scene.set("force.boom.tip", 1.0)
        scene.step_to(0.02)
    before, begun = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.perf_counter()
    many = [Scene(DRIVEN, EI=900 + k) for k in range(1000)]
    for scene in many:
        scene.set("force.boom.tip", 1.0)
        scene.step_to(0.02)
    seconds, size = time.perf_counter() - begun, (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024 / len(many)
    ends = np.array([scene.get("bend_y") for scene in many])
    want(ends[0] == alone[0].get("bend_y") and ends[-1] == alone[1].get("bend_y"), "of a thousand one ends elsewhere than alone")
    want((np.diff(ends) < 0).all(), "stiffer ones bend more")
    want(size < 4, f"an instance takes {size:.1f} MB")
    return size, seconds / len(many)


def check_threads():
    files = [scenes / "rotor.txt", scenes / "panel_slew.txt"]
    alone, together = [Scene(file).run().table for file in files], {}

    def work(k):
        for _ in range(3):
            scene = Scene(files[k])
            scene.linear()
            together.setdefault(k, []).append(scene.run().table)

    threads = [threading.Thread(target=work, args=(k,)) for k in (0, 1)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for k, table in enumerate(alone):
        want(all((table == mine).all() for mine in together[k]) and len(together[k]) == 3, f"{files[k]} in a thread: other bits")


def check_notebook():
    space = {}
    for cell in json.loads(Path("examples/bindings/satellite.ipynb").read_text())["cells"]:
        if cell["cell_type"] == "code":
            exec("".join(cell["source"]), space)
    return space["error"]


def check_documents():
    blocks = [block for file in ("README.md", "examples/bindings/README.md")
              for block in re.findall(r"^```python\n(.*?)^```", Path(file).read_text(), re.M | re.S)]
    for block in blocks:
        exec(block, {})
    return len(blocks)


def check_curves():
    scene, known = Scene(scenes / "rotor.txt"), []
    for k in range(6):
        scene.step_to(0.5 * k)
        known.append(scene.get("tip_1"))
    for curve in curves:
        mine = [float(x) for x in re.findall(r"([-+0-9.e]+) m$", Path(curve).read_text(), re.M)]
        want(len(mine) == 6 and np.allclose(mine, known, rtol=1e-11, atol=0), f"{curve}: {mine}, not {known}")


want(first_curve < float(os.environ.get("FLEXBEAM_SECONDS", 1)), f"{first_curve:.2f} s to the first curve")
check_curves()
numbers = check_bits()
saved = check_states()
check_parameters()
check_linear()
check_modes()
difference, control_is = check_scipy()
check_campbell()
check_refusals()
check_builder()
check_threads()
size, each = check_instances()
notebook = check_notebook()
blocks = check_documents()
print(f"first curve after {first_curve:.2f} s, {numbers} numbers as the scene program has them, linear motion {difference:.1e} from SciPy "
      f"({control_is}), {refusals} refusals, 1000 instances of {size:.1f} MB in {1000 * each:.1f} ms each, the notebook ends "
      f"{notebook:.1g} degrees off, {blocks} programs of documents run, the same curve by {len(curves)} other languages")
