# linear.py - linear models as files, by SciPy and Octave: linear.py FOLDER, whose files tests/checks/linear.sh has made.
# Files agree with each other to the last bit; poles, gains and margins with those of the library, the scenes and Octave to 1e-9.
# Writes FOLDER/known.txt: the satellite's scene with the margins by SciPy as what is expected.
import csv
import json
import sys

import numpy as np
from scipy import io, linalg

sys.path[:0] = ['examples/tools', 'tests/reference']
import linear  # noqa: E402
import p13_margins  # noqa: E402

folder = sys.argv[1] + '/'
NEAR = 1e-9
worst = {}


def meet(what, have, want, size=None):
    """Relative difference, of complex numbers by their modulus."""
    off = float(np.max(np.abs(np.asarray(have) - np.asarray(want)) / (np.abs(want) if size is None else size)))
    worst[what] = max(worst.get(what, 0), off)
    if not off <= NEAR:
        sys.exit('%s: %r is %.3g from %r' % (what, have, off, want))


def demand(holds, what):
    if not holds:
        sys.exit(what)


def moving(poles):
    """Those with a rate, each pair once: motions at the root of rounding, as double eigenvalues at zero come out, do not count."""
    poles = np.asarray(poles)
    poles = poles[(np.abs(poles) > 1e-6 * np.max(np.abs(poles))) & (poles.imag >= 0)]
    return poles[np.lexsort((poles.imag, np.round(np.abs(poles), 6)))]


def same_poles(what, have, want):
    have, want = moving(have), moving(want)
    demand(len(have) == len(want), '%s: %d, not %d' % (what, len(have), len(want)))
    for pole in want:
        meet(what, have[np.argmin(np.abs(have - pole))], pole)


def same_bits(name, model, other):
    for key, value in model.items():
        text = [str(x) for x in other[key].ravel()] if isinstance(value, list) else other[key]
        if isinstance(value, list) and name.endswith('mat'):  # a cell is an array with one text
            text = [str(x.item()) for x in other[key].ravel()]
        demand(np.array_equal(np.atleast_1d(np.squeeze(value)), np.atleast_1d(np.squeeze(text))), '%s: other %s' % (name, key))


def same_table(name, model):
    """CSV: [A B; C D] with names and units."""
    with open(name) as file:
        rows = list(csv.reader(line for line in file if line[0] != '#'))
    n = len(model['states'])
    demand(rows[0][2:] == model['states'] + model['inputs'], name + ': names of columns')
    demand(rows[1][2:] == model['states_units'] + model['inputs_units'], name + ': units of columns')
    demand([row[0] for row in rows[2:]] == ['d/dt ' + x for x in model['states']] + model['outputs'], name + ': names of rows')
    demand([row[1] for row in rows[2:]] == [x + '/s' for x in model['states_units']] + model['outputs_units'], name + ': units')
    table = np.array([[float(x) for x in row[2:]] for row in rows[2:]])
    demand(np.array_equal(table, np.block([[model['A'], model['B']], [model['C'], model['D']]])), name + ': other matrices')
    demand(table.shape[0] == n + len(model['outputs']), name + ': rows')


def response(m, w):
    return m['C'] @ np.linalg.solve(1j * w * np.eye(len(m['A'])) - m['A'], m['B']) + m['D']


models = {}
for name in 'spinning', 'system', 'satellite', 'shaft', 'spun', 'exact', 'bent', 'arc':
    models[name] = m = linear.read(folder + name + '.json')
    with np.load(folder + name + '.npz') as file:
        same_bits(name + '.npz', m, file)
    same_bits(name + '.mat', m, io.loadmat(folder + name + '.mat'))
    demand(len(set(m['states'])) == len(m['A']) and len(set(m['steady_state'])) == len(m['steady_state']), name + ': a name twice')
for name in 'spinning', 'satellite', 'spun', 'exact', 'bent':
    same_table(folder + name + '.csv', models[name])
spinning, system, satellite, shaft, spun, exact, bent, arc = models.values()

# names, units and order of states, by what they have to mean
demand(spinning['model'] == 'spinning "beam", \\ with a rotor', 'quotes and backslashes of a name')
demand(spinning['states'][-1] == 'p_rotor0' and spinning['states_units'][-1] == 'N m s', 'the state of a rotor')
meet('states', spinning['A'][-1, -1], -0.1 / 0.2)  # friction over inertia
demand(('slide.1' in system['states']) != ('joint2.1' in system['states']), 'with a loop one of two slides is a state')
slide = 'slide.1' if 'slide.1' in system['states'] else 'joint2.1'
at = {x: k for k, x in enumerate(system['states'])}
demand(dict(zip(system['states'], system['states_units'])) == {slide: 'm', 'hinge.1': 'rad', 'p_' + slide: 'N s', 'p_hinge.1': 'N m s',
       **{'boom.q%d' % k: 'sqrt(kg) m' for k in range(1, 5)}, **{'p_boom.q%d' % k: 'sqrt(kg) m/s' for k in range(1, 5)}}, 'units')
meet('states', -system['A'][at['p_' + slide], at[slide]], 500)  # the spring of the slide
meet('states', -system['A'][at['p_hinge.1'], at['hinge.1']], 800)
meet('states', system['C'][0, at[slide]], 1)
meet('states', system['A'][at['hinge.1']], system['C'][1], 1)
demand(system['outputs'] == ['coordinate.0.1', 'speed.1.1', 'displacement.1.1.y'], 'outputs')
demand(system['inputs_units'] == ['N', 'N m'] and system['outputs_units'] == ['m', 'rad/s', 'm'], 'units of ports')
demand(satellite['inputs'] == ['motor.axle.1'] and satellite['outputs'] == ['turn', 'rate', 'bend', 'wheel'], 'ports of a scene')
at = {x: k for k, x in enumerate(satellite['states'])}
meet('states', satellite['A'][at['hub.attitude_z']], satellite['C'][1], 1)  # a gyro at rest is the rate of the attitude
meet('states', satellite['A'][at['axle.1']], satellite['C'][3], 1)
meet('states', satellite['B'][at['p_axle.1']], 1)
at = {x: k for k, x in enumerate(spun['states'])}
meet('states', 1 / spun['A'][at['position_x'], at['p_position_x']], 613.02, 613.02e3)
meet('states', dict(zip(spun['steady_state'], spun['steady_state_values']))['spin_z'], 0.1)
meet('states', spun['A'][at['attitude_y'], at['attitude_x']], -0.1)  # seen from a frame that spins on
with open('%scrc.txt' % folder) as file:
    demand(spun['crc'] == file.read().split()[-1], 'the check word is not that of the ROM')

demand(exact['states'] == ['mode%d_%s' % (k, part) for k in range(1, 7) for part in 'ab'] and set(exact['states_units']) == {'-'}, 'modes')
demand(exact['inputs'] == ['force.12.y', 'base_rate.z'] and exact['outputs'] == ['displacement.12.y', 'moment_strain.0.z'], 'ports of C')
demand(exact['inputs_units'] == ['N', 'rad/s'] and exact['outputs_units'] == ['m', '1/m'], 'units of an exact beam')
demand(bent['inputs'][2] == 'force.tip.z' and bent['outputs'][3:] == ['internal_moment.root.' + x for x in 'xyz'], 'ports as given')

# static response of the bent arc: by the difference of two steady states; base axes are those of the file
tips = [linear.read('%sbent_%s.json' % (folder, force)) for force in ('600.5', '599.5')]
tips = [dict(zip(m['steady_state'], m['steady_state_values'])) for m in tips]
moved = {x: tips[0]['tip.position_' + x] - tips[1]['tip.position_' + x] for x in 'xyz'}
gain = response(bent, 0.0)[:3, 2].real
off = float(np.max(np.abs(gain - [moved[x] for x in 'xyz'])) / np.max(np.abs(gain)))
demand(off < 1e-5, 'the static response is %.3g from the difference of steady states' % off)

# a beam of EI = 10 and length 1, 1e6 in shear, with a hinge of 3 N m/rad in the middle: closed form
hinged = linear.read(folder + 'hinged.json')
demand(hinged['inputs'] == ['drive.0', 'force.tip.z'] and hinged['inputs_units'] == ['N m', 'N'], 'motor of a joint')
demand(hinged['outputs'][:2] == ['coordinate.0', 'speed.0'] and hinged['outputs_units'] == ['rad', 'rad/s', 'm'], 'angle of a joint')
meet('a hinge in an exact beam', response(hinged, 0.0).real, np.array([[1 / 3, -1 / 6], [0, 0], [-1 / 6, 1 / 30 + 1 / 12 + 1e-6]]), 1)

# a blade on a flap hinge, EI = 1, spinning at 6: flap at the rate of the spin, lag of tests/reference/p02_rotating_uniform.csv
poles = np.linalg.eigvals(linear.read(folder + 'flap.json')['A']).imag
demand(abs(np.min(abs(poles)) - 4.2632254) < 1e-3 and np.min(abs(poles - 6)) < 1e-6, 'lag and flap of a hinged blade: %r' % sorted(poles))

# the same arc as a scene, whose load is counted by its vector
demand(arc['inputs'] == ['force.arc.tip'] and arc['outputs'] == ['move_x', 'move_y', 'move_z', 'turn'] and arc['states'] == bent['states'], 'an arc')
demand(arc['inputs_units'] == ['600 N'] and arc['outputs_units'] == ['m', 'm', 'm', 'rad/s'] and np.array_equal(arc['A'], bent['A']), 'the arc of the scene')
for w in 0.0, 0.5, 2.0:
    meet('an exact beam as a scene', response(arc, w)[:3, 0] / 600, response(bent, w)[:3, 2], np.max(np.abs(response(bent, w)[:3, 2])))

# poles: of the library, of Octave; gains of Octave
for name in 'spinning', 'system', 'exact':
    with open(folder + 'modes.txt') as file:
        modes = [complex(float(line[1]), float(line[2])) for line in (text.split() for text in file) if line[0] == name]
    same_poles('poles of the library', modes, linalg.eigvals(models[name]['A']))
octave = {}
with open(folder + 'octave.txt') as file:
    for line in (text.split() for text in file):
        octave.setdefault((line[0], ' '.join(line[1:-2])) if line[0] != 'margins' else line[1], []).append(line[-2:])
for name in 'spinning', 'system', 'satellite', 'shaft', 'exact', 'bent':
    poles = [complex(float(re), float(im)) for re, im in octave[name, 'pole']]
    same_poles('poles of Octave', poles, linalg.eigvals(models[name]['A']))
    for w in '0.3', '2', '7', '40':
        gains = np.array([complex(float(re), float(im)) for re, im in octave[name, 'gain ' + w]])
        want = response(models[name], float(w)).ravel(order='F')
        meet('gains of Octave', gains, want, np.max(np.abs(want)))

# loops: margins, and the response of the scene over frequency
T = 0.01


def loop_of(model, inputs, sensors):
    row = sum(gain * model['C'][model['outputs'].index(name)] for name, gain in sensors)
    return model['A'], model['B'][:, [model['inputs'].index(inputs)]], row[None, :]


turned = loop_of(satellite, 'motor.axle.1', [('turn', 2), ('rate', 5)])
twisted = loop_of(shaft, 'motor.turn.1', [('angle', 1)])
loops = {'satellite': (turned, [(np.array([-40.0]), np.array([1.0]))], T, 0.005),
         'shaft': (twisted, [p13_margins.pid(40, 4, 150, 0.02, T), p13_margins.notch(3.5, 0.1, 0.7, T),
                             p13_margins.lowpass(20, 0.7, T)], T, 0.005)}
for name, loop in loops.items():
    L = p13_margins.opened(*loop)[0]
    with open(folder + name + '_loop.csv') as file:
        rows = [[float(x) for x in row[1:]] for row in list(csv.reader(file))[1:]]
    # a body that turns freely is two poles at z = 1, which the rounding of a sample moves by its root: near them nobody has 1e-9;
    # nor far below the circle of radius 1, where a response is a difference of larger numbers
    for omega, _, _, re, im, _ in [row for row in rows if row[0] > 0.1][::4]:
        meet('response of ' + name, complex(re, im), L(omega), max(abs(L(omega)), 0.01))
    gain, reduction, phase, late, radius = p13_margins.margins(*loop)
    with open('examples/scenes/%s_control.txt' % name) as file:
        lines = [line for line in file if not line.startswith(('measure', 'expect'))]
    known = {'gain_margin': gain, 'phase_margin': phase, 'delay_margin': late}
    if name == 'shaft':  # the satellite has poles at 1 twice and no reduction
        known.update(gain_reduction=reduction, pole_radius=radius)
    for measure, value in known.items():
        lines += ['measure %s %s attitude\n' % (measure, measure), 'expect %s %.17g tolerance %g relative\n' % (measure, value, NEAR)]
    with open(folder + name + '_known.txt', 'w') as file:
        file.writelines(lines)
    if name == 'satellite':
        meet('margins of Octave', [float(octave[key][0][-1]) for key in ('gain', 'phase')], [gain, phase])
print(json.dumps({key: float('%.2g' % value) for key, value in worst.items()}))
