# import.py - finite-element models through examples/tools/import.py: import.py FOLDER, with FOLDER/integrals of tests/checks/import.c.
# Trusses and beams assembled here are written as matrices and as Nastran's files; what flexbeam makes of them has the mass, inertia,
# first moments and frequencies of the model and of closed forms; spinning ones stiffen as flexbeam's own beams do.
import contextlib
import importlib
import io
import json
import re
import subprocess
import sys

import numpy as np
import scipy.io
from pyNastran.bdf.bdf import BDF
from pyNastran.op2.op2 import OP2
from pyNastran.op2.tables.lama_eigenvalues.lama_objects import RealEigenvalues
from pyNastran.op2.tables.oug.oug_eigenvectors import RealEigenvectorArray
from pyNastran.op4.op4 import write_op4
from scipy import linalg, sparse

sys.path[:0] = ['examples/tools']
tool = importlib.import_module('import')
folder = sys.argv[1] + '/'
worst, refusals = {}, 0


def meet(what, have, want, near, size=None):
    """Difference relative to the largest of what is wanted."""
    have, want = np.asarray(have, dtype=float), np.asarray(want, dtype=float)
    off = float(np.max(abs(have - want)) / (size or np.max(abs(want))))
    worst[what] = max(worst.get(what, 0), off)
    if not off <= near:
        sys.exit('%s: %.3g off, of %g: %s, not %s' % (what, off, near, have, want))


def run(*arguments):
    """import.py with these arguments; the text of FOLDER/out.txt."""
    said = io.StringIO()
    with contextlib.redirect_stderr(said), contextlib.redirect_stdout(said):
        status = tool.main([*map(str, arguments), '--out', folder + 'out.txt'])
    if status:
        sys.exit('%s: %s' % (arguments, said.getvalue()))
    with open(folder + 'out.txt') as file:
        return file.read()


def refuse(why, *arguments):
    global refusals
    said = io.StringIO()
    try:
        with contextlib.redirect_stderr(said):
            status = tool.main([*map(str, arguments), '--out', folder + 'no.txt'])
    except SystemExit as end:
        status = end.code
    refusals += 1
    if status not in (1, 2) or not re.search(why, said.getvalue()):
        sys.exit('%s: not refused by "%s": %s %s' % (arguments, why, status, said.getvalue()))


def integrals(text=None):
    """What flexbeam makes of a description (FOLDER/out.txt): names and numbers."""
    name = folder + 'out.txt'
    if text is not None:
        name = folder + 'own.txt'
        with open(name, 'w') as file:
            file.write(text)
    done = subprocess.run([folder + 'integrals', name], capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stdout + done.stderr)
    return {line.split()[0]: np.array(line.split()[1:], dtype=float) for line in done.stdout.splitlines()}


def frequencies(name, *options):
    """[rad/s] by build/flexbeam analyse."""
    done = subprocess.run(['build/flexbeam', 'analyse', name, *options], capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stdout + done.stderr)
    return np.array([float(row.split()[2]) for row in done.stdout.splitlines() if re.match(r' +\d+ +\S+ +\S+ +\S+ +\S+$', row)])


# ---- finite elements


def chain(n):
    return [(k, k + 1) for k in range(n)]


def put(A, rows, block):
    A[np.ix_(rows, rows)] += block


def truss(x, bars, EA, rhoA):
    """K and consistent M of bars, three rows per node."""
    K, M = np.zeros((2, 3 * len(x), 3 * len(x)))
    for (a, b), ea, ra in zip(bars, EA, rhoA):
        L = np.linalg.norm(x[b] - x[a])
        e = (x[b] - x[a]) / L
        rows = [*range(3 * a, 3 * a + 3), *range(3 * b, 3 * b + 3)]
        put(K, rows, np.kron([[1, -1], [-1, 1]], ea / L * np.outer(e, e)))
        put(M, rows, np.kron([[2, 1], [1, 2]], ra * L / 6 * np.eye(3)))
    return K, M


def bending(L, EI):
    return EI / L**3 * np.array([[12, 6 * L, -12, 6 * L], [6 * L, 4 * L * L, -6 * L, 2 * L * L], [-12, -6 * L, 12, -6 * L], [6 * L, 2 * L * L, -6 * L, 4 * L * L]])


def bending_mass(L, m):
    return m * L / 420 * np.array([[156, 22 * L, 54, -13 * L], [22 * L, 4 * L * L, 13 * L, -3 * L * L],
                                   [54, 13 * L, 156, -22 * L], [-13 * L, -3 * L * L, -22 * L, 4 * L * L]])


def tension(L, N):
    return N / (30 * L) * np.array([[36, 3 * L, -36, 3 * L], [3 * L, 4 * L * L, -3 * L, -L * L], [-36, -3 * L, 36, -3 * L], [3 * L, -L * L, -3 * L, 4 * L * L]])


def beam(x, R, axial, lag, flap, torsion):
    """Sum of 4 x 4 matrices in the planes x y and x z, 2 x 2 along and about the axis, for each element; axes R."""
    A = np.zeros((6 * len(x), 6 * len(x)))
    sign = np.array([1, -1, 1, -1])  # rotation about y is minus the slope of z
    for k in range(len(x) - 1):
        a, b = 6 * k, 6 * k + 6
        local = np.zeros((12, 12))
        put(local, [1, 5, 7, 11], lag(k))
        put(local, [2, 4, 8, 10], flap(k) * np.outer(sign, sign))
        put(local, [0, 6], axial(k))
        put(local, [3, 9], torsion(k))
        turn = np.kron(np.eye(4), R)
        put(A, [*range(a, a + 6), *range(b, b + 6)], turn @ local @ turn.T)
    return A


def modes(K, M, held, n):
    """Frequencies [rad/s] and shapes, zero where held."""
    free = np.setdiff1d(np.arange(len(K)), held)
    value, phi = linalg.eigh(K[np.ix_(free, free)], M[np.ix_(free, free)], subset_by_index=[0, n - 1])
    full = np.zeros((len(K), n))
    full[free] = phi
    return np.sqrt(value), full


def rigid(x, dofs):
    """Displacements (and rotations) by unit motions of the frame, brute force."""
    R = np.zeros((dofs * len(x), 6))
    for k, r in enumerate(x):
        for i in range(3):
            R[dofs * k + i, i] = 1
            R[dofs * k:dofs * k + 3, 3 + i] = np.cross(np.eye(3)[i], r)
            if dofs == 6:
                R[dofs * k + 3 + i, 3 + i] = 1
    return R


def compare(what, have, x, M, w, phi, near):
    """Integrals of a component against K, M and the shapes of a model."""
    dofs = len(M) // len(x)
    R = rigid(x, dofs)
    rigid_mass, coupled = R.T @ M @ R, R.T @ M @ phi
    n = len(w)
    sign = np.sign(np.sum(have['P'].reshape(n, 3) * coupled[:3].T + have['H'].reshape(n, 3) * coupled[3:].T, axis=1))
    size = np.sqrt(rigid_mass[0, 0]), np.sqrt(np.trace(rigid_mass[3:, 3:]) / 2)
    meet(what, have['mass'], rigid_mass[0, 0], near)
    meet(what, have['c'], [rigid_mass[5, 1], rigid_mass[3, 2], rigid_mass[4, 0]], near, size[0] * size[1])
    meet(what, have['J'], rigid_mass[3:, 3:].ravel(), near)
    meet(what, have['P'].reshape(n, 3) * sign[:, None], coupled[:3].T, near, size[0])
    meet(what, have['H'].reshape(n, 3) * sign[:, None], coupled[3:].T, near, size[1])
    meet(what, have['M'], np.eye(n).ravel(), near)
    meet(what, np.sqrt(np.diag(have['K'].reshape(n, n))), w, near)
    return sign


def csv(name, x, dofs, first=1):
    with open(folder + name, 'w') as file:
        file.write('node,x,y,z%s\n' % (',dofs' if dofs else ''))
        file.writelines('%d,%r,%r,%r%s\n' % (first + k, *map(float, r), ',' + dofs if dofs else '') for k, r in enumerate(x))
    return folder + name


def save(name, A):
    scipy.io.mmwrite(folder + name, sparse.coo_matrix(A), precision=17, symmetry='general')
    return folder + name


# ---- a lattice mast of rods: 2 x 2 longerons, battens, diagonals; 16 bays along a skew axis


def mast(bays, bay, width, height, A_long, A_cross):
    x, bars = [], []
    for k in range(bays + 1):
        x += [(k * bay, y * width / 2, z * height / 2) for y, z in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        for c in range(4):
            bars.append((4 * k + c, 4 * k + (c + 1) % 4))
            if k < bays:
                bars.append((4 * k + c, 4 * k + 4 + c))
                bars.append((4 * k + c, 4 * k + 4 + (c + 1) % 4) if (k + c) % 2 else (4 * k + (c + 1) % 4, 4 * k + 4 + c))
        if k % 2 == 0:
            bars.append((4 * k, 4 * k + 2))
        else:
            bars.append((4 * k + 1, 4 * k + 3))
    area = np.array([A_long if b == a + 4 else A_cross for a, b in bars])
    return np.array(x), bars, 7e10 * area, 2700 * area


q, _ = np.linalg.qr(np.array([[1, 0.2, -0.3], [0.5, 1, 0.4], [0.3, -0.6, 1]]))
q *= np.sign(linalg.det(q))
x, bars, EA, rhoA = mast(12, 0.5, 0.6, 0.4, 2e-4, 1e-4)
x = x @ q.T + [0.3, -0.2, 0.5]
K, M = truss(x, bars, EA, rhoA)
put(M, range(3 * 51, 3 * 52), 0.7 * np.eye(3))  # a body at one corner of the tip
w, phi = modes(K, M, range(12), 9)
base = ['--nodes', csv('mast.csv', x, ''), '--frame', '1-4', '--modes', 9, '--mark', '52:tip,50', '--word', 'damping 0.005', '--word', 'effects spin damping']
text = run('--matrices', save('K.mtx', K), save('M.mtx', M), *base)
have = integrals()
sign = compare('truss, consistent masses', have, x, M, w, phi, 1e-9)
meet('truss, consistent masses', have['psi'].reshape(9, 3) * sign[:, None], phi[3 * 51:].T, 1e-9)
meet('limit of deflection', have['limit'], np.max(np.linalg.norm(x, axis=1)) / 2, 1e-12)

# rods: their masses by Simpson's rule, which is exact; closed form of mass and inertia
mid = np.array([(x[a] + x[b]) / 2 for a, b in bars])
mass = rhoA * np.array([np.linalg.norm(x[b] - x[a]) for a, b in bars])
J = sum(m * ((r @ r) * np.eye(3) - np.outer(r, r)) for m, (a, b) in zip(mass, bars) for r, m in ((x[a], m / 6), (x[b], m / 6), ((x[a] + x[b]) / 2, m * 2 / 3)))
r = x[51]
meet('truss, closed form', have['mass'], sum(mass) + 0.7, 1e-12)
meet('truss, closed form', have['J'], (J + 0.7 * ((r @ r) * np.eye(3) - np.outer(r, r))).ravel(), 1e-12)
own = ['component', 'modes 9', 'frequency_hz ' + ' '.join(repr(f / (2 * np.pi)) for f in w), 'effects spin']
u = phi.reshape(-1, 3, 9)
ends = np.zeros(len(x))
for m, (a, b) in zip(mass, bars):
    ends[[a, b]] += m / 6
ends[51] += 0.7
places = [(x[k], ends[k], u[k]) for k in range(len(x))] + [(mid[k], mass[k] * 2 / 3, (u[a] + u[b]) / 2) for k, (a, b) in enumerate(bars)]
own += ['node %d %r %r %r %r' % (k, *map(float, r), m) for k, (r, m, _) in enumerate(places)]
own += ['shape %d %d %r %r %r 0 0 0' % (a + 1, k, *map(float, s[:, a] * sign[a])) for k, (_, _, s) in enumerate(places) for a in range(9)]
own = integrals('\n'.join(own) + '\n')
for key in 'ups', 'Gam', 'Pi':  # of second degree, too
    meet('truss, Simpson', have[key], own[key], 1e-9)

# the other formats say the same
sparse.save_npz(folder + 'K.npz', sparse.csr_array(K))
sparse.save_npz(folder + 'M.npz', sparse.csr_array(M))
scipy.io.savemat(folder + 'KM.mat', {'K': K, 'M': M})
write_op4(folder + 'KM.op4', {'K': (2, K), 'M': (2, M)}, name_order=['K', 'M'], precision='double', is_binary=False)
for pair in (('K.npz', 'M.npz'), ('KM.mat:K', 'KM.mat:M')):
    other = run('--matrices', folder + pair[0], folder + pair[1], *base)
    if other.splitlines()[1:] != text.splitlines()[1:]:
        sys.exit('%s: another text than of MatrixMarket' % (pair,))
run('--matrices', folder + 'KM.op4:K', folder + 'KM.op4:M', *base)
compare('truss, op4', integrals(), x, M, w, phi, 1e-9)

# lumped masses: node by node, and condensed
lumped = np.diag(M.sum(axis=1))
w, phi = modes(K, lumped, range(12), 9)
text = run('--matrices', folder + 'K.mtx', save('lumped.mtx', lumped), *base)
if len(re.findall('^node ', text, re.M)) != 52:
    sys.exit('a lumped mass: %s' % text)
plain = integrals()
compare('truss, lumped masses', plain, x, lumped, w, phi, 1e-9)
run('--matrices', folder + 'K.mtx', folder + 'lumped.mtx', *base, '--condense', '--origin', '0,0,0')
have = integrals()
compare('truss, condensed', have, x, lumped, w, phi, 1e-9)
for key in 'ups', 'Gam', 'Pi', 'psi', 'limit':
    meet('truss, condensed', have[key], plain[key], 1e-9)
run('--matrices', folder + 'K.mtx', folder + 'lumped.mtx', *base, '--origin', '3', '--scale', '0.001,1000')
have = integrals()
compare('units and origin', have, (x - x[2]) / 1000, 1000 * lumped, w, phi / np.sqrt(1000), 1e-9)

# a slender one, as flexbeam's beam with shear; at rest and spinning, its longerons as lines
n, side, A_long, A_cross = 60, 0.4, 2e-4, 1e-5
x, bars, EA, rhoA = mast(n, side, side, side, A_long, A_cross)
K, M = truss(x, bars, EA, rhoA)
d = side * np.sqrt(2)
GA = 2 * 7e10 * A_cross * side * side**2 / d**3
line = sum(rhoA * np.array([np.linalg.norm(x[b] - x[a]) for a, b in bars])) / (n * side)
with open(folder + 'beam.txt', 'w') as file:
    file.write('beam\nlength %r\nelements 30\nmodes bend_y 3 bend_z 3\nbase prescribed\nstations x mass EI_y EI_z GA_y GA_z\n0 %r %r %r %r %r\nend\n'
               % (n * side, line, *[7e10 * 4 * A_long * (side / 2)**2] * 2, GA, GA))
base = ['--matrices', save('K.mtx', K), save('M.mtx', np.diag(M.sum(axis=1))), '--nodes', csv('mast.csv', x, '123'), '--frame', '1-4', '--word', 'base prescribed']
longerons = [option for c in range(1, 5) for option in ('--line', ','.join(map(str, range(c, 4 * n + 5, 4))))]
run(*base, '--modes', 8, *longerons)
for spin, near in (('0', 0.01), ('10', 0.01)):
    have, want = (frequencies(folder + name, '--spin', spin) for name in ('out.txt', 'beam.txt'))
    meet('slender truss as a beam', [min(have, key=lambda f: abs(f - g)) / g for g in want[:4]], np.ones(4), near)  # torsion is between

# ---- a beam with rotations: closed forms, then spinning

E, G, rho, b, h, L, n = 7e10, 2.7e10, 2700.0, 0.04, 0.025, 3.0, 24
Iy, Iz, Jt, A, l = b * h**3 / 12, h * b**3 / 12, 0.2 * b * h**3, b * h, 3.0 / 24
two, half = np.array([[1, -1], [-1, 1]]), np.array([[2, 1], [1, 2]]) / 6
same = lambda block: lambda k: block


def boom(R):
    x = np.outer(np.linspace(0, L, n + 1), R[:, 0])
    K = beam(x, R, same(E * A / l * two), same(bending(l, E * Iz)), same(bending(l, E * Iy)), same(G * Jt / l * two))
    M = beam(x, R, same(rho * A * l * half), same(bending_mass(l, rho * A)), same(bending_mass(l, rho * A)), same(rho * (Iy + Iz) * l * half))
    return x, K, M


x, K, M = boom(q)
w, phi = modes(K, M, range(6), 12)
run('--matrices', save('K.mtx', K), save('M.mtx', M), '--nodes', csv('boom.csv', x, ''), '--frame', 1, '--modes', 12, '--mark', '25:tip')
have = integrals()
sign = compare('beam, consistent masses', have, x, M, w, phi, 1e-9)
meet('beam, consistent masses', have['theta'].reshape(12, 3) * sign[:, None], phi[-3:].T, 1e-9)
meet('beam, closed form', have['mass'], rho * A * L, 1e-12)
meet('beam, closed form', np.sort(linalg.eigvalsh(have['J'].reshape(3, 3))), [rho * (Iy + Iz) * L, rho * A * L**3 / 3, rho * A * L**3 / 3], 1e-12)
meet('beam, closed form', w[0], 1.875104068711961**2 * np.sqrt(E * Iy / (rho * A)) / L**2, 1e-6)

x, K, M = boom(np.eye(3))
spins = np.zeros((12,) + K.shape)
middle = (np.arange(n) + 0.5) * l


def stretched(N):
    return beam(x, np.eye(3), same(0 * two), lambda k: tension(l, N[k]), lambda k: tension(l, N[k]), same(0 * two))


spins[0] = stretched(-rho * A * (L - middle))
spins[6 + 1] = spins[6 + 2] = stretched(rho * A * (L**2 - middle**2) / 2)
names = [save('K_G%d.mtx' % k, A_) for k, A_ in enumerate(spins)]
with open(folder + 'beam.txt', 'w') as file:
    file.write('beam\nlength %r\nelements 24\nmodes bend_y 4 bend_z 4\nbase prescribed\nstations x mass EI_y EI_z\n0 %r %r %r\nend\n' % (L, rho * A, E * Iy, E * Iz))
base = ['--matrices', save('K.mtx', K), save('M.mtx', M), '--nodes', csv('boom.csv', x, '123456'), '--frame', 1, '--modes', 8, '--word', 'base prescribed']
run(*base, '--geometric', *names)
by_matrices = integrals()
still = frequencies(folder + 'beam.txt')[:6]
for spin in '0', '10', '40':
    meet('beam stiffened by matrices', frequencies(folder + 'out.txt', '--spin', spin)[:6], frequencies(folder + 'beam.txt', '--spin', spin)[:6], 1e-3)
run(*base, '--line', '1-25')
by_line = integrals()
for spin in '0', '10', '40':
    meet('beam stiffened by line', frequencies(folder + 'out.txt', '--spin', spin)[:6], frequencies(folder + 'beam.txt', '--spin', spin)[:6], 3e-3)
if not frequencies(folder + 'beam.txt', '--spin', '40')[0] > 1.5 * still[0]:
    sys.exit('the spin stiffens too little to tell')
for key in 'pchi', 'Gamchi':
    meet('line and matrices', by_matrices[key], by_line[key], 0.02)
print(json.dumps({key: float('%.2g' % value) for key, value in worst.items()}))
