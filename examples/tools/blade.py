#!/usr/bin/env python3
# blade.py - a blade or tower of a wind-energy code as a description of flexbeam (examples/tools/README.md, Blades):
#   blade.py BeamDyn.dat --out blade.txt                  BeamDyn of OpenFAST: primary file, which names the blade file
#   blade.py turbine.htc --body blade1 --out blade.txt    HAWC2: center line, damping, and the st file that it names
#   blade.py blade.st --set 1,1 --out blade.txt           HAWC2's st file alone: a straight blade without twist
#   blade.py turbine.yaml --out blade.txt                 windIO (WISDEM, IEA Task 37): 6x6 matrices of the blade
# Wants NumPy; for .yaml also PyYAML. Exit: 0 well, 1 the file cannot be read, 2 bad options.
# Axes of what is written: x along the span, y toward the leading edge, z downwind. A rotor that turns clockwise, seen in the
# direction of the wind, spins about +z.
import argparse
import math
import os
import sys

try:
    import numpy as np
except ImportError as missing:
    sys.exit('blade.py: %s: python3 -m pip install numpy' % missing)

STATIONS, POINTS, ELEMENTS = 200, 200, {'exact': 400, 'beam': 40}  # what a description holds
STEPS, HUGE = 2000, 1e30  # of the tables along a line; what no quantity of a blade reaches
BEAMDYN = np.array([[0, 0, 1], [0, -1, 0], [1, 0, 0]], float)  # x to the suction side, y to the trailing edge, z along the span
HAWC2 = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]], float)  # x to the leading edge, y to the suction side, z along the span
NAMES = ('stretch', 'shear y', 'shear z', 'torsion', 'bending y', 'bending z')


class Refused(Exception):
    """What is wrong, where, and what would be right."""


class Blade:
    """line: points [m]; s, twist [rad]: about x, at fractions of the line; x, K, M: stations at fractions, section axes;
    damping: stiffness-proportional [s], six, or None; places: FILE:LINE of the stations."""

    def __init__(self, source, line):
        self.source, self.line, self.damping, self.notes = source, np.array(line, float), None, []


# ---- files


FILES = []  # that were read


class Lines:
    """The lines of a text file that are not empty, with their numbers."""

    def __init__(self, path):
        self.path, self.at = path, 0
        FILES.append(path)
        try:
            with open(path, encoding='latin-1') as file:
                self.lines = [(k, text.strip()) for k, text in enumerate(file, 1) if text.strip()]
        except OSError as error:
            raise Refused('%s: %s' % (path, error.strerror))

    def place(self):
        return '%s:%d' % (self.path, self.lines[min(self.at, len(self.lines)) - 1][0] if self.lines else 0)

    def next(self, what):
        if self.at == len(self.lines):
            raise Refused('%s: the file ends where %s should be' % (self.place(), what))
        self.at += 1
        return self.lines[self.at - 1][1]

    def fail(self, text):
        raise Refused('%s: %s' % (self.place(), text))

    def numbers(self, what, n, more=False):
        """The first n numbers of the next line; more: words may follow."""
        words = self.next(what).replace(',', ' ').replace(';', ' ; ').split()
        words = words[:words.index(';')] if ';' in words else words
        if len(words) < n or (len(words) > n and not more):
            self.fail('%s: %d numbers are wanted, %d are there' % (what, n, len(words)))
        return [self.number(word, what) for word in words[:n]]

    def number(self, word, what):
        try:
            value = float(word.upper().replace('D', 'E'))
        except ValueError:
            value = math.nan
        if not abs(value) < HUGE:
            self.fail('%s: a number is wanted, not %r' % (what, word[:40]))
        return value

    def whole(self, word, what, low, high):
        value = self.number(word, what)
        if value != int(value) or not low <= value <= high:
            self.fail('%s is a whole number from %d to %d, not %s' % (what, low, high, word[:40]))
        return int(value)

    def key(self, name):
        """The value of `value KEY - text`, from here on."""
        for self.at in range(self.at + 1, len(self.lines) + 1):
            words = self.lines[self.at - 1][1].split()
            if len(words) > 1 and name in words[1:8]:
                return words[0].strip('"\'')
        raise Refused('%s: there is no line with the key %s' % (self.path, name))


def turned(A, axes):
    """A 6x6 matrix of forces and moments, in other axes."""
    T = np.kron(np.eye(2), axes)
    return T @ A @ T.T


def checked(A, place, what):
    """The symmetric part of a section's matrix that may be one."""
    size = np.sqrt(np.abs(np.outer(np.diag(A), np.diag(A)))) + 1e-30 * np.abs(A).max()
    wrong = np.abs(A - A.T) > 1e-3 * size
    if wrong.any():
        i, j = np.argwhere(wrong)[0]
        raise Refused('%s: the %s matrix is not symmetric: %d,%d is %g, %d,%d is %g' %
                      (place, what, i + 1, j + 1, A[i, j], j + 1, i + 1, A[j, i]))
    A = 0.5 * (A + A.T)
    stiff = what == 'stiffness'
    if (np.diag(A) <= 0).any() if stiff else (np.diag(A) < 0).any():
        i = int(np.argmin(np.diag(A)))
        raise Refused('%s: the %s matrix has %g on its diagonal, row %d: %s is wanted' %
                      (place, what, A[i, i], i + 1, 'more than 0' if stiff else '0 or more'))
    d = np.sqrt(np.diag(A) + (0 if stiff else 1e-30))
    least = np.linalg.eigvalsh(A / np.outer(d, d))[0]
    if least < (1e-9 if stiff else -1e-6):
        raise Refused('%s: the %s matrix is not positive definite' % (place, what))
    return A


# ---- BeamDyn


def beamdyn_section(lines, what):
    A = np.array([lines.numbers('row %d of the %s matrix' % (k + 1, what), 6) for k in range(6)])
    return checked(turned(A, BEAMDYN), lines.place(), what)


def beamdyn_line(lines, rows, counts):
    """More points, and their twist, on the natural splines over kp_zr that BeamDyn draws through those of a member."""
    if (np.diff(rows[:, 2]) <= 0).any():
        k = int(np.argmax(np.diff(rows[:, 2]) <= 0)) + 1
        lines.at -= len(rows) - k - 1
        lines.fail('kp_zr of key point %d, %g, is not above that of the one before' % (k + 1, rows[k, 2]))
    each, first, out = max(1, (POINTS // 2 - 1) // (len(rows) - 1)), 0, [rows[:1]]
    for n in counts:
        own = rows[first:first + n]
        at = np.interp(np.arange(1, (n - 1) * each + 1) / each, np.arange(n), own[:, 2])
        out.append(spline(own[:, 2], own, at, True)[0])
        first += n - 1
    return np.concatenate(out)


def beamdyn_read(path):
    """Key points and twist of the primary file; matrices and damping of the blade file that it names."""
    lines = Lines(path)
    members = lines.whole(lines.key('member_total'), 'member_total', 1, 100)
    n = lines.whole(lines.key('kp_total'), 'kp_total', 3, POINTS)
    counts = [int(lines.numbers('member and number of its key points', 2, True)[1]) for _ in range(members)]
    if min(counts) < 2 or sum(counts) - members + 1 != n:
        lines.fail('members have %s key points, kp_total is %d: neighbors share one' % (', '.join(map(str, counts)), n))
    lines.next('the names of the columns kp_xr, kp_yr, kp_zr, initial_twist')
    lines.next('their units')
    rows = np.array([lines.numbers('key point %d of %d' % (k + 1, n), 4, True) for k in range(n)])
    blade = Blade(path, [])
    rows = beamdyn_line(lines, rows, counts)
    blade.line = rows[:, :3] @ BEAMDYN.T
    blade.twist = -np.radians(rows[:, 3])  # initial_twist is about -z of BeamDyn
    if members > 1:
        blade.notes.append('%d members are one smooth line here' % members)
    name = lines.key('BldFile')
    lines = Lines(os.path.join(os.path.dirname(path), name.replace('\\', '/')))
    n = lines.whole(lines.key('station_total'), 'station_total', 2, STATIONS - 1)
    kind = lines.whole(lines.key('damp_type'), 'damp_type', 0, 2)
    while lines.next('a line that begins with mu1').split()[0] != 'mu1':
        pass
    lines.next('units of damping')
    mu = lines.numbers('mu1 to mu6', 6)
    if kind == 1:
        blade.damping = [mu[2], mu[1], mu[0], mu[5], mu[4], mu[3]]
    elif kind == 2:
        blade.notes.append('%s: modal damping (damp_type 2) is not taken' % lines.path)
    while 'distributed prop' not in lines.next('the heading DISTRIBUTED PROPERTIES').lower():
        pass
    blade.x, blade.K, blade.M, blade.places = [], [], [], []
    for k in range(n):
        blade.x += lines.numbers('eta of station %d of %d' % (k + 1, n), 1)
        blade.places.append(lines.place())
        blade.K.append(beamdyn_section(lines, 'stiffness'))
        blade.M.append(beamdyn_section(lines, 'mass'))
    return blade


# ---- HAWC2


def moved(x, y):
    """Strains at x, y of the section by those of the line."""
    T = np.eye(6)
    T[0, 5], T[1, 5], T[2, 3], T[2, 4] = -y, x, y, -x
    return T


def rotation(angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def hawc2_stiffness(row):
    """Of a row of an st file, axes of HAWC2. 30 columns: the matrix at the elastic center, principal axes."""
    full = len(row) == 30
    pitch, xe, ye = row[6:9] if full else row[16:19]
    Re = rotation(math.radians(pitch))
    if full:
        A = np.zeros((6, 6))
        A[np.triu_indices(6)] = row[9:]
        A = A + np.triu(A, 1).T
        return moved(xe, ye).T @ turned(A, Re) @ moved(xe, ye)
    xs, ys, E, G, Ix, Iy, J, kx, ky, area = row[6:16]
    center, shear = np.diag([0, 0, E * area, E * Ix, E * Iy, 0]), np.diag([kx * G * area, ky * G * area, 0, 0, 0, G * J])
    return moved(xe, ye).T @ turned(center, Re) @ moved(xe, ye) + moved(xs, ys).T @ turned(shear, Re) @ moved(xs, ys)


def hawc2_mass(row):
    """Radii of gyration are taken about the mass center along the principal axes: those of the IEA 15-MW blade are so, beside
    BeamDyn's matrices of the same blade, though HAWC2's manual relates them to the elastic center."""
    m, x, y, rx, ry = row[1:6]
    A = turned(np.diag([m, m, m, m * rx**2, m * ry**2, m * (rx**2 + ry**2)]), rotation(math.radians(row[6] if len(row) == 30 else row[16])))
    return moved(x, y).T @ A @ moved(x, y)


def hawc2_table(path, main, sub):
    """The rows of a set, each with its place."""
    lines = Lines(path)
    begun = False
    while True:
        word = lines.next('set #%d, then $%d' % (main, sub)).split()[0]
        if word.startswith('#') and word[1:].isdigit():
            begun = int(word[1:]) == main
        if begun and word.startswith('$') and word[1:].isdigit() and int(word[1:]) == sub:
            break
    words = lines.lines[lines.at - 1][1].split()
    n = lines.whole(words[1] if len(words) > 1 else 'nothing', 'number of rows of $%d' % sub, 2, STATIONS - 1)
    rows, places = [], []
    for k in range(n):
        row = lines.next('row %d of %d of $%d' % (k + 1, n, sub)).split(';')[0].split()
        if len(row) not in (19, 30):
            lines.fail('row %d of $%d has %d columns: 19 are those of a beam, 30 those with a full matrix' % (k + 1, sub, len(row)))
        rows.append([lines.number(word, 'column %d' % (c + 1)) for c, word in enumerate(row)])
        places.append(lines.place())
        if len(rows[k]) != len(rows[0]):
            lines.fail('row %d of $%d has %d columns, the first %d' % (k + 1, sub, len(rows[k]), len(rows[0])))
    return rows, places


def hawc2_sections(blade, path, main, sub, length):
    rows, blade.places = hawc2_table(path, main, sub)
    blade.K = [checked(turned(hawc2_stiffness(row), HAWC2), place, 'stiffness') for row, place in zip(rows, blade.places)]
    blade.M = [checked(turned(hawc2_mass(row), HAWC2), place, 'mass') for row, place in zip(rows, blade.places)]
    r = np.array([row[0] for row in rows])
    if abs(r[0]) > 1e-9:
        raise Refused('%s: the first r is 0, not %g' % (blade.places[0], r[0]))
    if length and abs(r[-1] - length) > 0.02 * length:
        raise Refused('%s: r ends at %g m, the center line is %g m long' % (blade.places[-1], r[-1], length))
    blade.x = list(r / (r[-1] or 1))  # HAWC2 takes r along the center line, too


def htc_lines(path, root, missing, deep=0):
    """Commands of an htc file and of those that it continues in, with where they are; missing: those that are not there."""
    lines = Lines(path)
    while lines.at < len(lines.lines):
        words = lines.next('a command').split(';')[0].split()
        if words and words[0].lower() == 'continue_in_file' and len(words) > 1 and deep < 8:
            found = htc_file(words[1], root)
            if found:
                yield from htc_lines(found, root, missing, deep + 1)
            else:
                missing.append(words[1])
        elif words and words[0].lower() == 'exit':
            return
        elif words:
            yield lines, words


def htc_file(name, root):
    """Names begin in the folder where HAWC2 runs: that of the htc file, or the model's above it. None: it is not there."""
    names = [os.path.join(folder, name.replace('\\', '/')) for folder in (root, os.path.join(root, '..'))]
    return next((found for found in names if os.path.isfile(found)), None)


def htc_read(path, body):
    """One main body: center line with twist, st file. Damping of HAWC2 is that of strains at the elastic center."""
    inside, at, found, names, missing, root = [], None, None, [], [], os.path.dirname(path)
    for lines, words in htc_lines(path, root, missing):
        word = words[0].lower()
        if word == 'begin' and len(words) > 1:
            inside.append(words[1].lower())
            if inside[-1] == 'main_body':
                at = {'sec': [], 'damping': None, 'set': [1, 1], 'st': None, 'name': ''}
        elif word == 'end' and inside:
            if inside.pop() == 'main_body':
                names.append(at['name'])
                found = at if at['name'] == body else found
        elif at and 'main_body' in inside:
            if word == 'name' and inside[-1] == 'main_body' and len(words) > 1:
                at['name'] = words[1]
            elif word == 'sec' and inside[-1] == 'c2_def':
                if len(words) < 6:
                    lines.fail('sec wants number, x, y, z, twist')
                at['sec'].append([lines.number(w, 'sec') for w in words[2:6]])
            elif word == 'filename' and len(words) > 1:
                at['st'] = words[1], lines.place()
            elif word == 'set' and len(words) > 2:
                at['set'] = [lines.whole(w, 'set', 1, 1000) for w in words[1:3]]
            elif word in ('damping_posdef', 'damping_aniso', 'damping') and len(words) > 6:
                at['damping'] = word
    if not found:
        raise Refused('%s: no main_body %s; there are %s%s' %
                      (path, body, ', '.join(n for n in names if n) or 'none',
                       '; not there are the files ' + ', '.join(missing) if missing else ''))
    if len(found['sec']) < 2 or not found['st']:
        raise Refused('%s: main_body %s wants two sec of c2_def or more, and the filename of its timoschenko_input' % (path, body))
    name, place = found['st']
    st = htc_file(name, root)
    if not st:
        raise Refused('%s: %s is not there: names begin in the folder of %s or in that above' % (place, name, path))
    rows = np.array(found['sec'])
    blade = Blade(path, rows[:, :3] @ HAWC2.T)
    blade.twist = np.radians(rows[:, 3])
    if found['damping']:
        blade.notes.append('%s is not taken: lines `damping` and `damping_ratio` have damping in proportion to stiffness' % found['damping'])
    hawc2_sections(blade, st, *found['set'], table(blade.line, path).s[-1])
    return blade


def st_read(path, main, sub):
    """An st file alone."""
    rows, _ = hawc2_table(path, main, sub)
    blade = Blade(path, [[0, 0, 0], [rows[-1][0], 0, 0]])
    if not rows[-1][0] > 0:
        raise Refused('%s: r ascends from 0 to the length' % path)
    blade.twist = np.zeros(2)
    hawc2_sections(blade, path, main, sub, None)
    blade.notes.append('an st file has no center line: the blade is straight and without twist; its .htc has one (--body)')
    return blade


# ---- windIO


class Yaml:
    """A node of a YAML file that knows its place and its name."""

    def __init__(self, path, node, name=''):
        self.path, self.node, self.name = path, node, name

    def fail(self, text):
        raise Refused('%s:%d: %s: %s' % (self.path, self.node.start_mark.line + 1, self.name or 'file', text))

    def get(self, *names):
        """The child of the first of these names that is there; None without."""
        pairs = self.node.value if self.node.id == 'mapping' else []
        for name in names:
            for key, value in pairs:
                if key.value == name:
                    return Yaml(self.path, value, (self.name + '.' if self.name else '') + name)
        return None

    def want(self, *names):
        child = self.get(*names)
        if child is None:
            there = [str(key.value) for key, _ in self.node.value] if self.node.id == 'mapping' else []
            self.fail('has no %s; there are %s' % (' or '.join(names), ', '.join(there[:12]) or 'no keys'))
        return child

    def numbers(self, n=None):
        if self.node.id != 'sequence':
            self.fail('a list of numbers is wanted')
        values = []
        for node in self.node.value:
            try:
                values.append(float(node.value))
            except (TypeError, ValueError):
                values.append(math.nan)
            if not abs(values[-1]) < HUGE:
                Yaml(self.path, node, self.name).fail('a number is wanted, not %.40r' % (node.value,))
        if len(values) != n and n is not None:
            self.fail('%d numbers are wanted, %d are there' % (n, len(values)))
        return np.array(values)

    def rows(self, n, width):
        if self.node.id != 'sequence' or len(self.node.value) != n:
            self.fail('a list of %d rows is wanted, one per place of grid' % n)
        return [Yaml(self.path, node, '%s[%d]' % (self.name, k)).numbers(width) for k, node in enumerate(self.node.value)]


def curve(node, values='values'):
    grid = node.want('grid').numbers()
    if len(grid) < 2 or (np.diff(grid) <= 0).any() or abs(grid[0]) > 1e-9 or abs(grid[-1] - 1) > 1e-9:
        node.want('grid').fail('ascends from 0 to 1')
    return grid, node.want(values).numbers(len(grid))


def symmetric(upper):
    A = np.zeros((6, 6))
    A[np.triu_indices(6)] = upper
    return A + np.triu(A, 1).T


def windio_matrices(node, mass):
    """Grid and matrices, BeamDyn's axes: 21 numbers a row, or columns by name."""
    grid = node.want('grid').numbers()
    if node.get('values'):
        rows = node.want('values')
        return grid, [symmetric(row) for row in rows.rows(len(grid), 21)]
    if mass:
        m, x, y, edge, flap, polar, cross = (node.want(name).numbers(len(grid)) for name in
                                             ('mass', 'cm_x', 'cm_y', 'i_edge', 'i_flap', 'i_plr', 'i_cp'))
        zero = 0 * m
        columns = [m, zero, zero, zero, zero, -m * y, m, zero, zero, zero, m * x, m, m * y, -m * x, zero, edge, -cross, zero, flap, zero, polar]
    else:
        columns = [node.want('K%d%d' % (i + 1, j + 1)).numbers(len(grid)) for i in range(6) for j in range(i, 6)]
    return grid, [symmetric(row) for row in np.array(columns).T]


def windio_read(path):
    """components.blade: reference axis, twist, matrices."""
    try:
        import yaml
    except ImportError as missing:
        raise Refused('%s: %s: python3 -m pip install pyyaml' % (path, missing))
    FILES.append(path)
    try:
        with open(path, encoding='utf-8') as file:
            top = yaml.compose(file, Loader=getattr(yaml, 'CSafeLoader', yaml.SafeLoader))
    except OSError as error:
        raise Refused('%s: %s' % (path, error.strerror))
    except (yaml.YAMLError, UnicodeDecodeError, RecursionError) as error:
        mark = getattr(error, 'problem_mark', None)
        raise Refused('%s:%d: no YAML: %s' % (path, mark.line + 1 if mark else 0, getattr(error, 'problem', None) or error))
    if top is None:
        raise Refused('%s: the file is empty' % path)
    top = Yaml(path, top)
    body = top.want('components').want('blade')
    new = body.get('elastic_properties') or (body.get('structure') and body.get('structure').get('elastic_properties'))
    elastic = new or body.want('elastic_properties_mb').want('six_x_six')
    shape = body.get('outer_shape', 'outer_shape_bem') or body
    axis = elastic.get('reference_axis') or body.get('reference_axis') or shape.want('reference_axis')
    line = [curve(axis.want(name)) for name in 'xyz']
    s = np.unique(np.concatenate([grid for grid, _ in line]))
    if len(s) > POINTS:
        axis.fail('has %d points, at most %d' % (len(s), POINTS))
    blade = Blade(path, np.array([np.interp(s, *pair) for pair in line]).T @ BEAMDYN.T)
    grid, twist = curve(elastic.get('twist') or shape.want('twist'))
    degrees = new is not None  # windIO 2 has degrees, windIO 1 radians
    if np.abs(twist).max() > (180 if degrees else math.pi):
        (elastic.get('twist') or shape.want('twist')).fail('%g is no angle in %s' % (np.abs(twist).max(), 'degrees' if degrees else 'radians'))
    blade.twist = -np.interp(s, grid, np.radians(twist) if degrees else twist)
    stiff, mass = elastic.want('stiff_matrix', 'stiffness_matrix'), elastic.want('inertia_matrix')
    x, K = windio_matrices(stiff, False)
    at, M = windio_matrices(mass, True)
    if len(x) != len(at) or np.abs(x - at).max() > 1e-9:
        mass.fail('grid is another than that of the stiffness')
    place = lambda node, k: '%s:%d: %s, place %d of grid' % (path, node.node.start_mark.line + 1, node.name, k + 1)
    blade.x, blade.places = list(x), [place(stiff, k) for k in range(len(x))]
    blade.K = [checked(turned(A, BEAMDYN), place(stiff, k), 'stiffness') for k, A in enumerate(K)]
    blade.M = [checked(turned(A, BEAMDYN), place(mass, k), 'mass') for k, A in enumerate(M)]
    return blade


# ---- the line


class Line:
    """Tables along a line: u the parameter, s [m], place, tangent t."""


def spline(u, x, at, natural=False):
    """A cubic spline as exact_curve.h has it, not a knot at the second and the last but one point, or natural: value and slope."""
    n, h = len(u), np.diff(u)
    A, b = np.eye(n), np.zeros((n, x.shape[1]))
    for k in range(1, n - 1):
        A[k, k - 1:k + 2] = h[k - 1], 2 * (h[k - 1] + h[k]), h[k]
        b[k] = 6 * ((x[k + 1] - x[k]) / h[k] - (x[k] - x[k - 1]) / h[k - 1])
    if n == 3 and not natural:
        A[0, 1] = A[2, 1] = -1
    elif n > 3 and not natural:
        A[0, :3] = h[1], -h[0] - h[1], h[0]
        A[-1, -3:] = h[-1], -h[-2] - h[-1], h[-2]
    bend = np.linalg.solve(A, b)
    k = np.clip(np.searchsorted(u, at, side='left') - 1, 0, n - 2)
    hk, p = h[k, None], ((at - u[k]) / h[k])[:, None]
    q = 1 - p
    place = q * x[k] + p * x[k + 1] + hk**2 / 6 * ((q**3 - q) * bend[k] + (p**3 - p) * bend[k + 1])
    slope = (x[k + 1] - x[k]) / hk + hk / 6 * ((3 * p**2 - 1) * bend[k + 1] - (3 * q**2 - 1) * bend[k])
    return place, slope


def table(points, source):
    """Of the line through points."""
    line, chord = Line(), np.linalg.norm(np.diff(points, axis=0), axis=1)
    if (chord <= 0).any():
        raise Refused('%s: two points of the line that follow each other are the same' % source)
    u = np.concatenate([[0], np.cumsum(chord)])
    line.u = np.linspace(0, u[-1], STEPS + 1)
    line.place, slope = spline(u, points, line.u)
    speed = np.linalg.norm(slope, axis=1)
    if speed.min() < 0.1:
        raise Refused('%s: the line turns back between two of its points' % source)
    line.t = slope / speed[:, None]
    middle = np.linalg.norm(spline(u, points, 0.5 * (line.u[1:] + line.u[:-1]))[1], axis=1)
    line.s = np.concatenate([[0], np.cumsum((speed[:-1] + 4 * middle + speed[1:]) * np.diff(line.u) / 6)])
    line.points = np.interp(u, line.u, line.s)  # lengths at the points
    return line


def across(y, t):
    y = y - (y @ t) * t
    return y / np.linalg.norm(y)


def carried(tangents, first):
    """y axes that do not rotate about the line, from the first on."""
    out = [first]
    for a, b in zip(tangents[:-1], tangents[1:]):
        y = out[-1]
        out.append(across(y - (y @ b) / (1 + a @ b) * (a + b), b))
    return np.array(out)


def angle(t, a, b):
    """About t, from a to b."""
    return math.atan2(np.cross(a, b) @ t, a @ b)


def turn_of(line, y):
    """Angles from carried y axes to those of the codes, whose sections without twist have y nearest to that of the root."""
    base = np.array([0.0, 1.0, 0.0])
    return np.unwrap([angle(t, a, across(base, t)) for t, a in zip(line.t, y)])


def resampled(blade, straight):
    """Stations where the file has some and at the points of its line: x, K, M, twist; the table of the line; the length if it is straight, else 0."""
    line = table(blade.line, blade.source)
    bow = np.linalg.norm(line.place - np.outer(line.s, line.t[0]) - line.place[0], axis=1).max()
    straight = straight or (bow < 1e-9 * line.s[-1] and line.t[0, 0] > 1 - 1e-12)
    x = np.array(blade.x)
    for k in range(1, len(x)):
        if not x[k] > x[k - 1]:
            raise Refused('%s: stations ascend: %g follows %g' % (blade.places[k], x[k], x[k - 1]))
    if abs(x[0]) > 1e-9 or abs(x[-1] - 1) > 1e-6:
        raise Refused('%s: stations begin at 0 and end at 1, not at %g and %g' % (blade.places[-1], x[0], x[-1]))
    x[-1] = 1
    at = line.points / line.s[-1]
    at[-1] = 1
    grid = np.unique(np.concatenate([x, at]).round(9))
    if len(grid) > STATIONS - 1:
        grid = np.unique(np.concatenate([x, np.linspace(0, 1, STATIONS - len(x))]).round(9))
    K, M = (np.array([[np.interp(grid, x, [A[i, j] for A in B]) for j in range(6)] for i in range(6)]).transpose(2, 0, 1)
            for B in (blade.K, blade.M))
    twist = np.interp(grid, at, blade.twist)
    length = blade.line[-1, 0] - blade.line[0, 0] if straight else line.s[-1]
    if not length > 0:
        raise Refused('%s: the line ends %g m along the span: more than 0 is wanted' % (blade.source, length))
    return grid, K, M, twist, line, 0 if not straight else length


# ---- descriptions


def text(values):
    return ' '.join('%.12g' % (v + 0.0) for v in np.ravel(values))


def head(blade):
    yield '# from %s by blade.py; SI; x along the span, y toward the leading edge, z downwind' % blade.source
    for note in blade.notes:
        yield '# ' + note


def exact_text(blade, options):
    """The geometrically exact beam: every entry of the matrices."""
    x, K, M, twist, line, straight = resampled(blade, options.straight)
    yield from head(blade)
    origin = np.array([options.hub_radius, 0, 0])
    if straight:
        yield 'length %s' % text(straight)
        yield 'position %s' % text(origin)
    else:
        yield 'length 1 # places are fractions of the line through the points'
        yield from ('point %s' % text(point + origin) for point in blade.line)
        twist = twist + np.interp(x, line.s / line.s[-1], turn_of(line, carried(line.t, across(np.array([0.0, 1, 0]), line.t[0]))))
    yield 'elements %d' % options.elements
    if blade.damping:
        yield 'damping %s # [s] %s' % (text(blade.damping), ', '.join(NAMES))
    if options.rpm:
        yield 'spin 0 0 %s' % text(options.rpm * math.pi / 30)
    yield 'modes %d' % min(options.modes, 24)
    upper = np.triu_indices(6)
    for k in range(len(x)):
        yield 'station %s' % text(x[k] * (straight or 1))
        yield '  twist %s' % text(math.degrees(twist[k]))
        yield '  stiffness %s' % text(K[k][upper])
        yield '  inertia %s' % text(M[k][upper])


COLUMNS = 'mass EA GJ EI_y EI_z GA_y GA_z i_y i_z mass_y mass_z tension_y tension_z shear_y shear_z twist_deg'


def section(K, M):
    """Centers, principal stiffness and mass of a section, the angle of its principal axes, and the largest entry that these
    do not hold, beside the square root of the product of its diagonal entries."""
    EA = K[0, 0]
    yt, zt = -K[0, 5] / EA, K[0, 4] / EA
    D = K[4:, 4:] - EA * np.array([[zt * zt, -yt * zt], [-yt * zt, yt * yt]])
    turn = 0.5 * math.atan2(2 * D[0, 1], D[0, 0] - D[1, 1])
    turn -= math.pi / 2 * round(turn / (math.pi / 2))  # y and z keep their names
    c, s = math.cos(turn), math.sin(turn)
    R = np.array([[1, 0, 0], [0, c, s], [0, -s, c]])  # to principal axes
    A, B = turned(K, R), turned(M, R)
    yt, zt = -A[0, 5] / EA, A[0, 4] / EA
    GAy, GAz, m = A[1, 1], A[2, 2], B[0, 0]
    ys, zs = A[2, 3] / GAz, -A[1, 3] / GAy
    ym, zm = -B[0, 5] / m, B[0, 4] / m
    values = [m, EA, A[3, 3] - GAy * zs**2 - GAz * ys**2, A[4, 4] - EA * zt**2, A[5, 5] - EA * yt**2, GAy, GAz,
              B[4, 4] - m * zm**2, B[5, 5] - m * ym**2, ym, zm, yt, zt, ys, zs]
    held = np.diag(np.diag(A))
    for i, j, v in ((0, 4, EA * zt), (0, 5, -EA * yt), (4, 5, -EA * yt * zt), (1, 3, -GAy * zs), (2, 3, GAz * ys)):
        held[i, j] = held[j, i] = v
    lost = np.abs(A - held) / np.sqrt(np.outer(np.diag(A), np.diag(A)))
    return values, turn, lost


def beam_text(blade, options):
    """A beam of `reduce`: modes or element functions of sections with centers; entries that these do not hold are told."""
    x, K, M, twist, line, straight = resampled(blade, options.straight)
    rows, lost = [], np.zeros((6, 6))
    for k in range(len(x)):
        if not M[k][0, 0] > 0:
            raise Refused('%s: a body of modes wants mass' % blade.places[0])
        values, turn, left = section(K[k], M[k])
        if min(values[2], values[3], values[4]) <= 0 or min(values[7], values[8]) < 0:
            raise Refused('%s: about its centers the section has GJ %g, EI_y %g, EI_z %g, i_y %g, i_z %g: none may be negative' %
                          (blade.places[0], *values[2:5], *values[7:9]))
        rows.append(values + [twist[k] + turn])
        lost = np.maximum(lost, left)
    i, j = np.unravel_index(np.argmax(lost), (6, 6))
    if lost[i, j] > 1e-6:
        blade.notes.append('left out: couplings of %s and %s, at most %.2g of the root of the product of their stiffnesses; '
                           'an exact beam (--form exact) has them' % (NAMES[i], NAMES[j], lost[i, j]))
    if blade.damping:
        blade.notes.append('left out: damping in proportion to stiffness; a line `damping` has ratios of modes')
    yield from head(blade)
    origin = np.array([options.hub_radius, 0, 0])
    yield 'beam\nname %s' % options.name
    turns = [row[-1] for row in rows]
    if straight:
        yield 'length %s' % text(straight)
        yield 'elements %d\nposition %s' % (options.elements, text(origin))
    else:
        at = np.linspace(0, line.s[-1], options.elements + 1)
        nodes = np.array([np.interp(at, line.s, line.place[:, i]) for i in range(3)]).T
        yield 'position %s' % text(nodes[0] + origin)
        yield from ('point %s' % text(node - nodes[0]) for node in nodes)
        t = np.diff(nodes, axis=0)
        t /= np.linalg.norm(t, axis=1)[:, None]
        e = carried(np.vstack([[1.0, 0, 0], t]), np.array([0.0, 1, 0]))[1:]  # y axes of the elements
        for k, row in enumerate(turns):
            element = min(int(x[k] * options.elements), options.elements - 1)
            own = np.array([np.interp(x[k] * line.s[-1], line.s, line.t[:, i]) for i in range(3)])
            turns[k] = row + angle(t[element], e[element], across(across(np.array([0.0, 1, 0]), own), t[element]))
    yield 'root clamped\nbase prescribed\nmodes lowest %d' % min(options.modes, 24)
    if options.rpm:
        yield 'spin %s %s' % (text(options.rpm * math.pi / 30), text(options.hub_radius))
    yield 'effects full\nnode tip\nstations fraction %s' % COLUMNS
    for k in range(len(x)):
        yield '%s %s' % (text(x[k]), text(rows[k][:-1] + [math.degrees(turns[k])]))
    yield 'end'


# ---- command line


def read(options):
    path, low = options.file, options.file.lower()
    if low.endswith(('.yaml', '.yml')):
        return windio_read(path)
    if low.endswith('.htc'):
        return htc_read(path, options.body)
    lines = Lines(path)
    if any('kp_total' in line for _, line in lines.lines):
        return beamdyn_read(path)
    if any(line.startswith('$') for _, line in lines.lines):
        return st_read(path, *options.set)
    raise Refused('%s: it is no primary file of BeamDyn (key kp_total), no st file of HAWC2 (lines $1 N), and is not called .htc or '
                  '.yaml; ElastoDyn\'s blades are read by flexbeam elastodyn' % path)


def pair(word):
    main, sub = word.split(',')
    return int(main), int(sub)


def main(arguments):
    parser = argparse.ArgumentParser(prog='blade.py', description='A blade or tower of BeamDyn, HAWC2 or windIO as a description of flexbeam.')
    parser.add_argument('file', help='primary file of BeamDyn, .htc or st file of HAWC2, .yaml of windIO')
    parser.add_argument('--form', choices=['exact', 'beam'], default='exact', help='exact beam with 6x6 matrices, or beam of reduce (exact)')
    parser.add_argument('--body', default='blade1', help='main_body of an .htc (blade1)')
    parser.add_argument('--set', type=pair, default=(1, 1), help='set and subset of an st file (1,1)')
    parser.add_argument('--straight', action='store_true', help='the line is straight, as long as its end is along the span')
    parser.add_argument('--elements', type=int, help='of equal length (exact 100, beam 20)')
    parser.add_argument('--modes', type=int, default=6, help='slowest ones, at most 24 (6)')
    parser.add_argument('--hub-radius', type=float, default=0.0, help='[m] of the root (0)')
    parser.add_argument('--rpm', type=float, default=0.0, help='[rev/min] spin about z (0)')
    parser.add_argument('--name', default='blade', help='of a beam (blade)')
    parser.add_argument('--out', help='file to write (stdout)')
    options = parser.parse_args(arguments)
    options.elements = options.elements or {'exact': 100, 'beam': 20}[options.form]
    if not 1 <= options.elements <= ELEMENTS[options.form]:
        parser.error('--elements is 1 to %d' % ELEMENTS[options.form])
    try:
        blade = read(options)
        lines = list((exact_text if options.form == 'exact' else beam_text)(blade, options))
        if options.out and os.path.exists(options.out) and any(os.path.exists(path) and os.path.samefile(options.out, path) for path in FILES):
            raise Refused('--out: %s is what is read' % options.out)
    except Refused as error:
        print('blade.py: %s' % error, file=sys.stderr)
        return 1
    for note in blade.notes:
        print('blade.py: %s' % note, file=sys.stderr)
    try:
        with open(options.out, 'w', encoding='utf-8') if options.out else os.fdopen(os.dup(1), 'w') as file:
            file.write('\n'.join(lines) + '\n')
    except OSError as error:
        print('blade.py: %s: %s' % (options.out, error.strerror), file=sys.stderr)
        return 1
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
