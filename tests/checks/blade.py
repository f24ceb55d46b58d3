# blade.py FOLDER COUNT SEED: blades of BeamDyn, HAWC2 and windIO, of our own writing, through examples/tools/blade.py into flexbeam's
# tools: tips that BeamDyn published, frequencies of closed forms, the same blade in four formats, refusals, COUNT damaged files.
import contextlib
import io
import math
import random
import re
import subprocess
import sys

sys.path.insert(0, 'examples/tools')
import blade as tool
import numpy as np

folder, count, seed = sys.argv[1] + '/', int(sys.argv[2]), int(sys.argv[3])


def near(what, value, wanted, tolerance):
    value, wanted = np.array(value, float), np.array(wanted, float)
    error = np.max(np.abs(value - wanted)) / np.max(np.abs(wanted))
    if not (value.shape == wanted.shape and error < tolerance):
        sys.exit('%s: %s, not %s: %.2g of %g' % (what, value, wanted, error, tolerance))


def write(name, text):
    with open(folder + name, 'w') as file:
        file.write(text)
    return folder + name


def run(arguments):
    said = io.StringIO()
    with contextlib.redirect_stderr(said), contextlib.redirect_stdout(said):
        try:
            status = tool.main(arguments)
        except SystemExit as end:
            status = end.code
    return status, said.getvalue()


def described(arguments, more=''):
    status, said = run(arguments + ['--out', folder + 'x.txt'])
    if status:
        sys.exit('%s: %s' % (arguments, said))
    with open(folder + 'x.txt', 'a') as file:
        file.write(more)
    word = 'analyse' if 'beam' in arguments else 'exact'
    done = subprocess.run(['build/flexbeam', word, folder + 'x.txt'], capture_output=True, text=True)
    if done.returncode or 'warning' in done.stderr:
        sys.exit('%s: %s' % (arguments, done.stderr))
    return done.stdout


def tip(arguments, more):
    return [float(x) for x in re.search('tip displacement(.*)', described(arguments, more)).group(1).split()]


def hertz(arguments):
    """Undamped: of the magnitude of the eigenvalues."""
    rows = [line.split() for line in described(arguments).splitlines() if re.match(r' +\d+ +\S+ +\S+ +\S+', line)]
    analyse = 'beam' in arguments
    return [math.hypot(float(r[1 if analyse else 2]), float(r[2 if analyse else 3])) / 2 / math.pi for r in rows]


def rows(A):
    return ''.join(' '.join('%.15g' % v for v in row) + '\n' for row in A) + '\n'


def beamdyn(name, points, stations, mu=None):
    write(name + '_blade.dat', 'blade file\nof a test\n---- BLADE PARAMETERS\n%d station_total\n%d damp_type\n---- DAMPING\nmu1 mu2 mu3 mu4 mu5 mu6\n'
          '(-) (-) (-) (-) (-) (-)\n%s\n---- DISTRIBUTED PROPERTIES\n%s' %
          (len(stations), mu is not None, ' '.join(map(str, mu or [0] * 6)), ''.join('%g\n%s%s' % (x, rows(K), rows(M)) for x, K, M in stations)))
    return write(name + '.dat', 'primary file\nof a test\n1 member_total\n%d kp_total\n1 %d\nkp_xr kp_yr kp_zr initial_twist\n(m) (m) (m) (deg)\n%s'
                 '"%s_blade.dat" BldFile\n' % (len(points), len(points), rows(points), name))


def uniform(K, M):
    return [(0, K, M), (1, K, M)]


# Beams of OpenFAST's tests of BeamDyn, deflected as far as a third of their length, with the tips of its outputs (OpenFAST/r-test,
# modules/beamdyn, bd_static_twisted_with_k1 and bd_curved_beam; its shape functions are of order 7 and 10).
M = np.diag([600.0, 600, 600, 900, 900, 1800])
twisted = np.diag([8.2604167e9, 8.2604167e9, 2.5e10, 0.520833e9, 0.130208333e9, 0.141872656e9])
name = beamdyn('twisted', [(0, 0, k, 9 * k) for k in range(11)], uniform(twisted, M))
x, y, z = tip([name], 'load 10 dead 0 4e6 0\n')
near('twisted beam', [z, -y, x], [1.71810805, -3.59245231, -1.14114462], 3e-4)
curved = np.diag([41.6667e5, 41.6667e5, 100e5, 8.333e5, 8.333e5, 8.333e5])
name = beamdyn('curved', [(0, 0, 0, 0), (7.61205, 0, 38.2683, 0), (29.2893, 0, 70.7107, 0)], uniform(curved, M))
x, y, z = tip([name], 'load 1 dead 0 -600 0\n')
near('curved beam', [z, -y, x], [-13.46, 53.35, -23.58], 3e-4)
thick = np.diag([1e9, 1e9, 2e9, 1e9, 1e9, 1e9])  # 0.7 m of 81 m, not of 1, the length by which places are fractions: no warning
described([beamdyn('thick', [(0, 0, 0, 0), (7.61205, 0, 38.2683, 0), (29.2893, 0, 70.7107, 0)], uniform(thick, M))])

# A slender section whose centers are all at one point of it, principal axes at 25 degrees: Euler and Bernoulli's cantilever.
L, m, a, b, pitch, flap, edge, J, polar = 40.0, 50.0, 0.3, -0.2, 25.0, 2e7, 9e7, 3e7, 4.0
closed = sorted([1.87510407**2 / L**2 * math.sqrt(EI / m) / 2 / math.pi for EI in (flap, edge)] +
                [4.69409113**2 / L**2 * math.sqrt(EI / m) / 2 / math.pi for EI in (flap, edge)])


def st(name, a, b, columns, center=(0.0, 0.0)):
    """One line per place; columns: 19, or 30 with the matrix. center: the mass center beside the others."""
    E, G, area = 1e10, 1e10, 1.0
    head = [m, a + center[0], b + center[1], math.sqrt(0.25 * polar / m), math.sqrt(0.75 * polar / m)]
    if columns == 19:
        tail = [a, b, E, G, flap / E, edge / E, J / G, 1.0, 1.0, area, pitch, a, b]
    else:
        K = np.diag([G, G, E, flap, edge, J])
        tail = [pitch, a, b] + list(K[np.triu_indices(6)])
    return write(name, '1 sets\n#1 a set\nr m x_cg ..\n$1 2\n' + ''.join(' '.join('%.15g' % v for v in [r] + head + tail) + '\n' for r in (0, L)))


plain = hertz([st('plain.st', 0, 0, 19)])[:4]
near('slender cantilever', plain, closed, 2e-3)
for columns in (19, 30):
    near('moved axis, %d columns' % columns, hertz([st('moved.st', a, b, columns)]), hertz([st('plain.st', 0, 0, columns)]), 1e-4)
far = hertz([st('far.st', 0, 0, 30, (0.8, 0.1))])
if max(abs(far[k] / plain[k] - 1) for k in range(4)) < 1e-4:
    sys.exit('a mass center off the elastic one changes nothing')

# One blade, bent and twisted, in four formats: the same frequencies.
T = np.kron(np.eye(2), [[0, 1, 0], [-1, 0, 0], [0, 0, 1]])  # BeamDyn's x is HAWC2's y, its y is -x
row = [0] + [float(v) for v in open(st('same.st', a, b, 30, (0.4, 0.05))).read().splitlines()[4].split()[1:]]
K, M = T @ tool.hawc2_stiffness(row) @ T.T, T @ tool.hawc2_mass(row) @ T.T
points = np.array([(0.02 * (k / 8)**2 * L, -0.03 * (k / 8)**2 * L, L * k / 8, 12 - k) for k in range(9)])
same = [hertz([beamdyn('same', points, uniform(K, M), [0.001] * 6)])]
with open(folder + 'same.htc', 'w') as file:
    file.write('begin new_htc_structure;\nbegin main_body; the blade\nname wing ;\ndamping_posdef 0 0 0 1e-3 1e-3 1e-3 ;\nbegin timoschenko_input;\n'
               'filename ./same.st ;\nset 1 1 ;\nend timoschenko_input;\nbegin c2_def;\nnsec 9;\n' +
               ''.join('sec %d %.15g %.15g %.15g %.15g ;\n' % (k + 1, -p[1], p[0], p[2], -p[3]) for k, p in enumerate(points)) +
               'end c2_def;\nend main_body;\ncontinue_in_file ./not_there.htc;\nend new_htc_structure;\n')
same.append(hertz([folder + 'same.htc', '--body', 'wing']))
upper = np.triu_indices(6)
grid = '[%s]' % ', '.join(str(k / 8) for k in range(9))
axis = ''.join('      %s: {grid: %s, values: %s}\n' % (w, grid, [float(v) for v in points[:, i]]) for i, w in enumerate('xyz'))
lists = '[%s]' % ', '.join(str([float(v) for v in A[upper]]) for A in (K, K))
masses = '[%s]' % ', '.join(str([float(v) for v in A[upper]]) for A in (M, M))
write('same.yaml', 'name: test\ncomponents:\n  blade:\n    outer_shape_bem:\n     reference_axis: &line\n%s     twist: &turn {grid: %s, values: %s}\n'
      '    elastic_properties_mb:\n      six_x_six:\n        reference_axis: *line\n        twist: *turn\n        stiff_matrix: {grid: [0.0, 1.0], values: %s}\n'
      '        inertia_matrix: {grid: [0.0, 1.0], values: %s}\n' % (axis, grid, [math.radians(t) for t in points[:, 3]], lists, masses))
two = ''.join('        K%d%d: [%.15g, %.15g]\n' % (i + 1, j + 1, K[i, j], K[i, j]) for i in range(6) for j in range(i, 6))
inertia = {'mass': M[0, 0], 'cm_x': M[1, 5] / m, 'cm_y': -M[0, 5] / m, 'i_edge': M[3, 3], 'i_flap': M[4, 4], 'i_plr': M[5, 5], 'i_cp': -M[3, 4]}
two = '      stiffness_matrix:\n        grid: [0, 1]\n' + two + '      inertia_matrix:\n        grid: [0, 1]\n' + \
      ''.join('        %s: [%.15g, %.15g]\n' % (k, v, v) for k, v in inertia.items())
write('same2.yaml', 'components:\n  blade:\n    reference_axis:\n%s    outer_shape:\n      twist: {grid: %s, values: %s}\n    elastic_properties:\n%s' %
      (axis, grid, [float(t) for t in points[:, 3]], two))
yaml = True
try:
    import yaml as _
except ImportError:
    yaml = False
for name in ['same.yaml', 'same2.yaml'] if yaml else []:
    same.append(hertz([folder + name]))
for other in same[1:]:
    near('the blade in another format', other, same[0], 2e-4)
near('as a beam of modes', hertz([folder + 'same.dat', '--form', 'beam', '--modes', '6']), same[0], 4e-3)
near('as a straight beam of modes', hertz([folder + 'same.dat', '--form', 'beam', '--straight']), hertz([folder + 'same.dat', '--straight']), 4e-3)

# Refusals: file, line, key, what would be right.
refusals = [('same.dat', 'kp_total', 'kp_', 'same_.dat: it is no primary file of BeamDyn .key kp_total.'),
            ('same.dat', 'member_total', 'member', 'same_.dat: there is no line with the key member_total'),
            ('same.dat', '9 kp_total', '8 kp_total', r'same_.dat:5: members have 9 key points, kp_total is 8'),
            ('same.dat', 'same_blade', 'no', r'no.dat: No such file'),
            ('same.htc', 'wing', 'tail', r'same_.htc: no main_body wing; there are tail; not there are the files ./not_there.htc'),
            ('same.htc', './same.st', './no.st', r'same_.htc:6: ./no.st is not there'),
            ('same.st', '$1 2', '$1 3', r'same_.st:6: the file ends where row 3 of 3'),
            ('same.st', '$1 2', '$2 2', r'same_.st:6: the file ends where set #1, then \$1'),
            ('same.st', '\n40 ', '\n40 x ', r'same_.st:6: row 2 of \$1 has 31 columns'),
            ('same.st', '\n40 ', '\n39 ', None)]
if yaml:
    refusals += [('same.yaml', 'stiff_matrix', 'stiff', r'same_.yaml:\d+: components.blade.elastic_properties_mb.six_x_six: has no stiff_matrix'),
                 ('same.yaml', 'grid: [0.0, 1.0]', 'grid: [0.0, 0.5, 1.0]', r'stiff_matrix.values: a list of 3 rows is wanted'),
                 ('same2.yaml', 'K66', 'K67', r'same2_.yaml:\d+: components.blade.elastic_properties.stiffness_matrix: has no K66'),
                 ('same.yaml', 'name: test', 'name: [', r'same_.yaml:\d+: no YAML')]
for name, old, new, pattern in refusals:
    other = name.replace('.', '_.')
    before = open(folder + name).read()
    if old not in before:
        sys.exit('%s has no %s' % (name, old))
    write(other, before.replace(old, new, 1))
    status, said = run([folder + other, '--body', 'wing', '--out', folder + 'x.txt'])
    if pattern is None and status or pattern is not None and (status != 1 or not re.search(pattern, said)):
        sys.exit('%s with %s: status %s: %s' % (name, new, status, said))
blade_file = open(folder + 'same_blade.dat').read()
for old, new, pattern in [('damp_type', 'type', 'same_blade.dat: there is no line with the key damp_type'),
                          ('\n0\n', '\n0.1\n', r'same_blade.dat:\d+: stations begin at 0'),
                          ('\n0\n%.15g ' % K[0, 0], '\n0\n-1 ', r'same_blade.dat:\d+: the stiffness matrix has -1 on its diagonal'),
                          (' %.15g' % K[2, 4], ' 1e20', r'same_blade.dat:\d+: the stiffness matrix is not symmetric')]:
    if old not in blade_file:
        sys.exit('same_blade.dat has no %r' % old)
    write('same_blade.dat', blade_file.replace(old, new, 1))
    status, said = run([folder + 'same.dat'])
    if status != 1 or not re.search(pattern, said):
        sys.exit('same_blade.dat with %r: status %s: %s' % (new, status, said))
write('same_blade.dat', blade_file)

# Polynomials of ElastoDyn: those that the NREL 5-MW blade is published with (OpenFAST/r-test, 5MW_Baseline), of modes at 12.1 rpm.
x = np.linspace(0, 1, 201)


def shapes(name, what, *options):
    done = subprocess.run(['build/flexbeam', 'elastodyn', folder + name, '--shapes', what] + list(options), capture_output=True, text=True)
    if done.returncode:
        sys.exit('%s: %s' % (name, done.stderr))
    found = {}
    for line in done.stdout.splitlines():
        value, key, power = re.match(r' *(\S+) +(\w+)\((\d)\) - ', line).groups()
        found[key] = found.get(key, 0) + float(value) * x**int(power)
    return found


table = np.loadtxt('tests/reference/nrel5mw_blade.csv', delimiter=',', skiprows=10)
beam = 'beam\nlength 61.5\nelements 40\nroot clamped\nmodes bend_y 3 bend_z 3\nstations fraction twist_deg mass EI_y EI_z\n%send\n'
write('nrel.txt', beam % ''.join('%.9g %.9g %.9g %.9g %.9g\n' % tuple(row[:5]) for row in table))
published = {'BldFl1Sh': ([0.0622, 1.7254, -3.2452, 4.7131, -2.2555], 0.005), 'BldFl2Sh': ([-0.5809, 1.2067, -15.5349, 29.7347, -13.8255], 0.016),
             'BldEdgSh': ([0.3627, 2.5337, -3.5772, 2.376, -0.6952], 0.002)}
found = shapes('nrel.txt', 'blade', '--rpm', '12.1', '--hub-radius', '1.5')
for key, (terms, tolerance) in published.items():
    near(key, found[key], sum(c * x**(k + 2) for k, c in enumerate(terms)), tolerance)
# A tower: of Euler and Bernoulli, and below a heavy rotor the cubic of a force on its tip.
column = 'beam\nlength 80\nelements 40\nroot clamped\nmodes bend_y 2 bend_z 2\nstations x mass EI_y EI_z\n0 3000 2e11 3e11\nend\n'
write('tower.txt', column)
found = shapes('tower.txt', 'tower')
for which, beta in (('1', 1.8751040687), ('2', 4.6940911330)):
    k = (math.cosh(beta) + math.cos(beta)) / (math.sinh(beta) + math.sin(beta))
    exact = np.cosh(beta * x) - np.cos(beta * x) - k * (np.sinh(beta * x) - np.sin(beta * x))
    for side in ('TwFAM%sSh', 'TwSSM%sSh'):
        near(side % which, found[side % which], exact / exact[-1], 1e-3)
write('tower.txt', column.replace('modes', 'lump 40 1e9 0 0 0 1 1 1\nmodes'))
near('a heavy rotor', shapes('tower.txt', 'tower')['TwFAM1Sh'], (3 * x**2 - x**3) / 2, 1e-3)
for old, new, pattern in [('bend_z 2', 'bend_z 1', 'there is no Fore-aft mode 2: modes bend_y 2 bend_z 2'), ('root clamped', 'root pinned', 'its root is not clamped'),
                          ('elements 40', 'elements 4', 'it has less than 8 elements')]:
    write('tower_.txt', column.replace(old, new))
    done = subprocess.run(['build/flexbeam', 'elastodyn', folder + 'tower_.txt', '--shapes', 'tower'], capture_output=True, text=True)
    if done.returncode != 2 or not re.search(r'tower_.txt: .*' + pattern, done.stderr):
        sys.exit('tower with %s: %s' % (new, done.stderr))

# What is read stays as it is.
for name, read in (('same.dat', 'same_blade.dat'), ('same.st', 'same.st')):
    before = open(folder + read).read()
    status, said = run([folder + name, '--out', folder + read])
    if status != 1 or 'is what is read' not in said or open(folder + read).read() != before:
        sys.exit('%s, --out %s: %s %s' % (name, read, status, said))

# Damaged at random: refused with the file, or a description that is written.
kinds = ['same.dat', 'same_blade.dat', 'same.st', 'same.htc'] + (['same.yaml', 'same2.yaml'] if yaml else [])
tally = {0: 0, 1: 0}
for k in range(count):
    draw, kind = random.Random(1000003 * seed + k), kinds[k % len(kinds)]
    whole = open(folder + kind).read()
    words = re.split(r'(\s+)', whole)
    for _ in range(draw.randrange(1, 4)):
        at = draw.randrange(len(words))
        words[at] = draw.choice(['', '-1', '0', 'nan', '1e40', '1e-40', 'x', '\n', '[', '7', words[draw.randrange(len(words))], words[at][:1]])
    text = ''.join(words)[:draw.choice([None, None, None, draw.randrange(len(whole))])]
    if kind == 'same_blade.dat':
        write('damaged_blade.dat', text)
        main = write('damaged.dat', open(folder + 'same.dat').read().replace('same_blade', 'damaged_blade'))
    else:
        main = write('damaged' + kind[kind.index('.'):], text)
    try:
        status, said = run([main, '--body', 'wing', '--form', draw.choice(['exact', 'beam']), '--out', folder + 'x.txt'])
    except BaseException as error:
        sys.exit('damaged %s, number %d of seed %d (%s): %s: %s' % (kind, k, seed, main, type(error).__name__, error))
    if status not in tally or (status == 1 and not re.search(r'blade\.py: \S*(damaged|same)', said)):
        sys.exit('damaged %s, number %d of seed %d (%s): status %s: %s' % (kind, k, seed, main, status, said))
    tally[status] += 1
print('BeamDyn\'s published tips to 3e-4, one blade in %d formats to 2e-4, ElastoDyn\'s polynomials to 1.6 %%; %d damaged files: %d refused, %d read' %
      (len(same), count, tally[1], tally[0]))
