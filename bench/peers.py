#!/usr/bin/env python3
# peers.py FOLDER: the scenes of bench_peers_beams by exudyn, and the ten links of bench_peers_links by drake; CSV on stdout as
# theirs. FOLDER holds what both have left: SCENE.csv and links.csv. bench/peers.sh runs it.
# exudyn  ANCFCable2D, as many elements, by the generalized-alpha method with constraints of index 3 the dense
#         solver for few elements, the sparse one for many; a base that turns holds the slope of the
#         root by a function of time in Python
# drake   MultibodyPlant, Runge-Kutta of orders 3 and 5 in fixed steps, by one call
# Exit: 0, 1 without the packages.
import importlib.metadata
import math
import os
import re
import sys
import time

try:
    import exudyn
    import numpy as np
    from exudyn import utilities as items
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.multibody.tree import FixedOffsetFrame, RevoluteJoint, RotationalInertia, SpatialInertia
    from pydrake.math import RigidTransform
    from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
except ImportError as missing:
    sys.exit('peers.py: %s: sh .ci/fetch peers' % missing)

SAMPLES, FAR, SLOW, RUNS = 160, 0.3, 1.0, 3
STIFF = 1e5  # EA by EI/L^2: stiffer beams change less than the errors shown, and Newton's method of exudyn fails


def read(path):
    """Data of a scene and the converged motion: t, x, y."""
    with open(path) as file:
        data = {name: float(x) for name, x in re.findall(r'(\w+) (\S+)', file.readline())}
        file.readline()
        return data, np.array([[float(x) for x in line.split(',')] for line in file])


def base(name, c):
    """Angle and rate of the base as functions of time: bench/case.h."""
    if name == 'spin-up':
        T, w = c['period'], c['size']
        s = T / (2 * math.pi)

        def angle(t):
            return w / T * (t * t / 2 + s * s * (math.cos(t / s) - 1)) if t < T else w * T / 2 + w * (t - T)

        def rate(t):
            return w / T * (t - s * math.sin(t / s)) if t < T else w
        return angle, rate
    size, T = c['size'], c['period']

    def turn(t):
        s = min(t / T, 1)
        return size * s ** 3 * (10 + s * (6 * s - 15))

    def turn_rate(t):
        s = min(t / T, 1)
        return size / T * 30 * s * s * (1 - s) ** 2
    return turn, turn_rate


def beam(name, c, n):
    """The beam of n elements (even) along x; sensors of root, middle and tip."""
    mbs, h = holder.AddSystem(), c['length'] / n
    node = [mbs.AddNode(items.Point2DS1(referenceCoordinates=[k * h, 0, 1, 0])) for k in range(n + 1)]
    ground = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=mbs.AddNode(items.NodePointGround()), coordinate=0))
    for k in range(n):
        cable = mbs.AddObject(items.Cable2D(length=h, massPerLength=c['mass'], bendingStiffness=c['EI'],
                                            axialStiffness=STIFF * c['EI'] / c['length'] ** 2, nodeNumbers=[node[k], node[k + 1]],
                                            useReducedOrderIntegration=0))
        if c['gravity']:
            weight = mbs.AddMarker(items.MarkerBodyMass(bodyNumber=cable))
            mbs.AddLoad(items.LoadMassProportional(markerNumber=weight, loadVector=[0, c['gravity'], 0]))
        if k == 0:
            root = cable

    def lump(at, mass, inertia):
        """Mass, and inertia by the slope, which is of length 1."""
        if mass:
            mbs.AddObject(items.ObjectGenericODE2(nodeNumbers=[at], massMatrix=np.diag([mass, mass, inertia, inertia])))
            if c['gravity']:
                mbs.AddLoad(items.LoadCoordinate(markerNumber=mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=at, coordinate=1)),
                                                 load=mass * c['gravity']))
    lump(node[0], c['hub_mass'], c['hub_inertia'])
    lump(node[n], c['payload_mass'], c['payload_inertia'])

    def hold(coordinate, **function):
        at = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node[0], coordinate=coordinate))
        mbs.AddObject(items.CoordinateConstraint(markerNumbers=[ground, at], **function))
    if name != 'slew':
        hold(0), hold(1)
    if name in ('spin-up', 'arm'):
        angle, rate = base(name, c)
        hold(2, offsetUserFunction=lambda mbs, t, i, o: math.cos(angle(t)) - 1,
             offsetUserFunction_t=lambda mbs, t, i, o: -rate(t) * math.sin(angle(t)))
        hold(3, offsetUserFunction=lambda mbs, t, i, o: math.sin(angle(t)),
             offsetUserFunction_t=lambda mbs, t, i, o: rate(t) * math.cos(angle(t)))
    elif name == 'slew':
        size, T = c['size'], c['period']
        mbs.AddLoad(items.LoadTorqueVector(
            markerNumber=mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=root, localPosition=[0, 0, 0])), loadVector=[0, 0, 1],
            loadVectorUserFunction=lambda mbs, t, load: [0, 0, size * math.sin(2 * math.pi * t / T) if t < T else 0.0]))
    see = [mbs.AddSensor(items.SensorNode(nodeNumber=node[k], storeInternal=True, outputVariableType=exudyn.OutputVariableType.Coordinates))
           for k in (0, n // 2, n)]
    mbs.Assemble()
    return mbs, see


def output(name, c, mbs, see):
    """Of the tip in axes of the root, or of the middle against the chord in its own axes: rows t, x, y."""
    L, sensed = c['length'], [np.array(mbs.GetSensorStoredData(s))[1:] for s in see]
    x, slope = [], []
    for place, rows in zip((0, L / 2, L), sensed):
        x.append(rows[:, 1:3] + [place, 0])
        slope.append(rows[:, 3:5] + [1, 0])
    chord = name == 'pendulum'
    axes = slope[1 if chord else 0]
    axes = axes / np.hypot(axes[:, 0], axes[:, 1])[:, None]
    d = x[1] - (x[0] + x[2]) / 2 if chord else x[2] - x[0]
    return np.column_stack((sensed[0][:, 0], np.sum(d * axes, 1) - (0 if chord else L), d[:, 1] * axes[:, 0] - d[:, 0] * axes[:, 1]))


def solve(name, c, want, n, steps, rho):
    """Error and seconds of processor; None: Newton's method fails."""
    mbs, see = beam(name, c, n)
    settings = exudyn.SimulationSettings()
    t = settings.timeIntegration
    t.endTime, t.numberOfSteps, t.verboseMode, t.adaptiveStep = c['duration'], SAMPLES * steps, 0, False
    t.newton.useModifiedNewton, t.newton.absoluteTolerance = True, 1e-5
    t.generalizedAlpha.spectralRadius = rho
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = c['duration'] / SAMPLES
    settings.linearSolver.solverType = exudyn.LinearSolverType.EXUdense if n < 12 else exudyn.LinearSolverType.EigenSparse
    start = time.process_time()
    try:
        mbs.SolveDynamic(settings, solverType=exudyn.DynamicSolverType.GeneralizedAlpha, showHints=False, showCausingItems=False)
    except Exception:
        return None
    taken = time.process_time() - start
    got = output(name, c, mbs, see)
    if len(got) < SAMPLES or np.max(np.abs(got[-SAMPLES:, 0] - want[:, 0])) > 1e-6 * c['duration']:
        return None
    off = got[-SAMPLES:, 1:] - want[:, 1:]
    return np.max(np.hypot(*off.T)) / np.max(np.hypot(*want[:, 1:].T)), taken


def climb_exudyn(folder, name):
    c, want = read(os.path.join(folder, name + '.csv'))
    for n in (2, 4, 8, 16):
        for rho in (0.95, 0.8, 0.5):
            before, stale, steps, taken = math.inf, 0, 1, 0
            while stale < 2 and taken < SLOW and steps < 4000:
                runs = [solve(name, c, want, n, steps, rho)]
                if runs[0] and runs[0][0] < FAR:
                    error, taken = runs[0]
                    runs += [solve(name, c, want, n, steps, rho) for k in range(RUNS - 1) if taken < 0.3]
                    print('beam,%s,exudyn,%d elements generalized-alpha %g,%.4g,%.3e,%.4g' %
                          (name, n, rho, c['duration'] / SAMPLES / steps, error, 1e6 * min(r[1] for r in runs) / c['duration']), flush=True)
                    stale = stale + 1 if error > 0.98 * before else 0
                    before = min(before, error)
                steps += (steps + 1) // 2


# ---- links


def number(text, name):
    """A macro of peers_links.h."""
    return [float(x) for x in re.search(r'#define %s ([^/\n]*)' % name, text).group(1).strip(' ()').split(',')]


def climb_drake(folder):
    text = open(os.path.join(os.path.dirname(os.path.abspath(__file__)), 'peers_links.h')).read()
    length, mass, center, angle, end = (number(text, 'LINK_' + name)[0] for name in ('LENGTH', 'MASS', 'CENTER', 'ANGLE', 'END'))
    inertia, gravity = number(text, 'LINK_INERTIA'), number(text, 'LINK_GRAVITY')[0]
    steps = [float(x) for x in re.search(r'link_steps\[\] = {([^}]*)}', text).group(1).split(',')]
    want = np.loadtxt(os.path.join(folder, 'links.csv'))
    plant = MultibodyPlant(0.0)
    plant.mutable_gravity_field().set_gravity_vector([0, 0, gravity])
    last = plant.world_frame()
    for k in range(len(want)):
        link = plant.AddRigidBody('link%d' % k, SpatialInertia.MakeFromCentralInertia(mass, [center, 0, 0], RotationalInertia(*inertia)))
        hinge = plant.AddFrame(FixedOffsetFrame('hinge%d' % k, last, RigidTransform([length if k else 0, 0, 0])))
        plant.AddJoint(RevoluteJoint('joint%d' % k, hinge, link.body_frame(), [0, 0, 1] if k % 2 else [0, 1, 0]))
        last = link.body_frame()
    plant.Finalize()
    for scheme in ('runge_kutta3', 'runge_kutta5'):
        for dt in steps:
            best = math.inf
            for _ in range(RUNS):
                simulator = Simulator(plant)
                context = simulator.get_mutable_context()
                ResetIntegratorFromFlags(simulator, scheme, dt).set_fixed_step_mode(True)
                plant.SetPositions(context, np.full(len(want), angle))
                simulator.Initialize()
                start = time.process_time()
                simulator.AdvanceTo(end)
                best = min(best, time.process_time() - start)
            error = np.max(np.abs(plant.GetPositions(context) - want))
            print('links,,drake,%s,%.4g,%.3e,%.4g' % (scheme, dt, error, 1e6 * best / end), flush=True)


holder = exudyn.SystemContainer()
if len(sys.argv) != 2:
    sys.exit('usage: peers.py FOLDER')
print('# exudyn %s, drake %s' % (importlib.metadata.version('exudyn'), importlib.metadata.version('drake')))
climb_drake(sys.argv[1])
for scene in ('spin-up', 'slew', 'arm', 'pendulum'):
    climb_exudyn(sys.argv[1], scene)
