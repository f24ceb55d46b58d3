# import.py - finite-element models through examples/tools/import.py: import.py FOLDER, with FOLDER/integrals of tests/checks/import.c.
# Trusses and beams assembled here are written as matrices and as Nastran's files; what flexbeam makes of them has the mass, inertia,
# first moments and frequencies of the model and of closed forms; spinning ones stiffen as flexbeam's own beams do.
import importlib
import json
import os
import re
import shlex
import subprocess
import sys

import numpy as np
import scipy.io
from pyNastran.bdf.bdf import BDF, CaseControlDeck
from pyNastran.op2.op2 import OP2
from pyNastran.op2.tables.lama_eigenvalues.lama_objects import RealEigenvalues
from pyNastran.op2.tables.oug.oug_eigenvectors import RealEigenvectorArray
from pyNastran.op4.op4 import write_op4
from scipy import linalg, sparse

sys.path[:0] = ['tests/checks']
from fem import (beam, bending, bending_mass, csv, folder, frequencies, integrals, meet, modes, put, refuse, refused, rigid, run, save,
                 tension, tool, truss, worst)


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
if not np.all(have['reach'] >= np.linalg.norm(phi.reshape(-1, 3, 9), axis=1).max(axis=0) * (1 - 1e-9)):
    sys.exit('a mode reaches farther')
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
told = run('--matrices', save('K.mtx', K), save('M.mtx', M), '--nodes', csv('boom.csv', x, ''), '--frame', 1, '--modes', 12, '--mark', '25:tip')
have = integrals()
sign = compare('beam, consistent masses', have, x, M, w, phi, 1e-9)
R = rigid(x, 6)
carried = re.search('effective masses: the modes carry (.*), (.*) and (.*) % of the mass along x, y and z, (.*), (.*) and (.*) % of', told).groups()
meet('effective masses', np.array(carried, dtype=float) / 100, np.sum((R.T @ M @ phi)**2, axis=1) / np.diag(R.T @ M @ R), 6e-3)
inverse = linalg.inv(K[6:, 6:])
text = run('--matrices', save('K.mtx', K), save('M.mtx', M), '--nodes', folder + 'boom.csv', '--frame', 1, '--modes', 4, '--interface', '25:tip')
whole = integrals()
S = np.vstack([whole[key].reshape(10, 3).T for key in ('psi', 'theta')])
meet('compliance of an interface', S @ linalg.solve(whole['K'].reshape(10, 10), S.T), inverse[-6:, -6:], 1e-9)
if not re.search('^# the modes have all of the static deflection of node 25 .tip. by forces and moments', text, re.M):
    sys.exit('interface: %s' % text[:1500])
lost = re.findall('^# of the static deflection of node 25 .tip. by a (?:force|moment) there the modes leave out (.*)', told, re.M)
meet('static deflection', [float(part.split()[0]) / 100 for parts in lost for part in parts.split(', ')],
     [1 - np.sum(phi[k]**2 / w**2) / inverse[k, k] for k in range(-6, 0)], 5e-3)
meet('beam, consistent masses', have['theta'].reshape(12, 3) * sign[:, None], phi[-3:].T, 1e-9)
meet('beam, closed form', have['mass'], rho * A * L, 1e-12)
meet('beam, closed form', np.sort(linalg.eigvalsh(have['J'].reshape(3, 3))), [rho * (Iy + Iz) * L, rho * A * L**3 / 3, rho * A * L**3 / 3], 1e-12)
meet('beam, closed form', w[0], 1.875104068711961**2 * np.sqrt(E * Iy / (rho * A)) / L**2, 1e-6)

consistent_boom = M
x, K, M = boom(q)  # on a hinge with a spring, whose two nodes are in one place, it turns as a rigid body
spring = np.diag([1e8, 1e8, 1e8, 1e5, 1e5, 0.5])
K, M = linalg.block_diag(0 * spring, K), linalg.block_diag(0 * spring, M)
put(K, range(12), np.kron(two, np.kron(np.eye(2), q) @ spring @ np.kron(np.eye(2), q).T))
run('--matrices', save('K.mtx', K), save('M.mtx', M), '--nodes', csv('hinge.csv', np.vstack([x[:1], x]), ''), '--frame', 1, '--modes', 4, '--word', 'base prescribed')
meet('a hinge', np.sqrt(integrals()['K'][0]), np.sqrt(0.5 / (rho * A * L**3 / 3)), 1e-3)

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
unit = np.tile([1, 1, 1, 1000, 1000, 1000], n + 1) / np.sqrt(1000)
shrunk = [save('mm_%d.mtx' % k, A_ * np.outer(unit, unit) / (1000 if k < 3 else 1)) for k, A_ in enumerate([*spins, K, M])]
run('--matrices', *shrunk[12:], '--nodes', csv('mm.csv', 1000 * x, ''), *base[5:], '--scale', '0.001,1000', '--geometric', *shrunk[:12])
have = integrals()
sign = np.sign(np.sum((have['P'] * by_matrices['P'] + have['H'] * by_matrices['H']).reshape(8, 3), axis=1))
for key in 'mass', 'J', 'K':
    meet('units of matrices', have[key], by_matrices[key], 1e-9)
for key in 'pchi', 'Gamchi':
    meet('units of matrices', have[key].reshape(8, 8, -1) * np.multiply.outer(sign, sign)[:, :, None], by_matrices[key].reshape(8, 8, -1), 1e-9)
run(*base, '--line', '1-25')
by_line = integrals()
for spin in '0', '10', '40':
    meet('beam stiffened by line', frequencies(folder + 'out.txt', '--spin', spin)[:6], frequencies(folder + 'beam.txt', '--spin', spin)[:6], 3e-3)
if not frequencies(folder + 'beam.txt', '--spin', '40')[0] > 1.5 * still[0]:
    sys.exit('the spin stiffens too little to tell')
for key in 'pchi', 'Gamchi':
    meet('line and matrices', by_matrices[key], by_line[key], 0.02)

# ---- Nastran: millimetres and tonnes, PARAM,WTMASS, coordinate systems of all kinds, masses at offsets, a scalar point

x, K, _ = boom(q)
x += [0.1, 0.2, -0.3]
origin, z_axis, x_axis = np.array([-400.0, 150, 90]), q @ [0.6, 0, 0.8], q @ [0.8, 0, -0.6]
systems = {7: 'R', 8: 'C', 9: 'S'}
of = [0] * 5 + [8] * 5 + [9] * 5 + [7] * 5 + [0] * 5  # CD of each grid


def axes(kind, r):
    """Of such a system at a place, from their definition."""
    s, along = r - origin, (r - origin) @ z_axis
    across = s - along * z_axis
    if kind == 'C':
        e = across / np.linalg.norm(across)
        return np.array([e, np.cross(z_axis, e), z_axis]).T
    if kind == 'S':
        e, round_ = s / np.linalg.norm(s), np.cross(z_axis, across) / np.linalg.norm(across)
        return np.array([e, np.cross(round_, e), round_]).T
    return np.array([x_axis, np.cross(z_axis, x_axis), z_axis]).T if kind else np.eye(3)


turn = linalg.block_diag(*[np.kron(np.eye(2), axes(systems.get(cd), 1000 * r)) for cd, r in zip(of, x)])


def offset_mass(m, c, J):
    C = np.array([[0, -c[2], c[1]], [c[2], 0, -c[0]], [-c[1], c[0], 0]])
    return np.block([[m * np.eye(3), -m * C], [m * C, J - m * C @ C]])


mass = rho * A * l * np.array([0.5] + [1.0] * (n - 1) + [0.5])
M = np.kron(np.diag(mass), np.diag([1.0, 1, 1, 0, 0, 0]))
J = np.array([[0.02, 0.003, -0.001], [0.003, 0.03, 0.002], [-0.001, 0.002, 0.025]])  # in the axes of 7
c, there = np.array([0.05, -0.02, 0.04]), np.array([1.6, 0.4, 0.1])
local = axes('R', origin)
put(M, range(6 * n, 6 * n + 6), offset_mass(0.5, local @ c, local @ J @ local.T))
put(M, range(6 * 12, 6 * 12 + 6), offset_mass(0.3, there - x[12], 0 * J))
ends = {19: local @ [0.01, 0.02, 0.005], 20: np.array([-0.01, 0.0, 0.03])}  # a bar beside its grids
for k, end in ends.items():
    put(M, range(6 * k, 6 * k + 6), offset_mass(rho * A * np.linalg.norm(x[20] - x[19]) / 2, end, 0 * J) - np.diag([rho * A * l / 2] * 3 + [0] * 3))


def nastran(name, K, M, size, moves=0.0, without=(), masses=1.0, first=None, free=False, value=1):
    """NAME.op2 of the modes, of these modal masses, the scalar point 1000 too; frequencies and shapes in SI."""
    rows = np.arange(6, len(K))
    full = np.zeros((len(K), size))
    if free:
        square, full = linalg.eigh(K, M, subset_by_index=[0, size - 1])
        w = np.sqrt(np.maximum(square, 0))
    else:
        inverse, phi = linalg.eigh(M[np.ix_(rows, rows)], K[np.ix_(rows, rows)], subset_by_index=[len(rows) - size, len(rows) - 1])
        full[rows] = phi[:, ::-1] / np.sqrt(inverse[::-1]) * np.sqrt(masses)
        w = 1 / np.sqrt(inverse[::-1])
    if first is not None:
        full[:, 0] = first
    shape = (turn.T @ full).reshape(n + 1, 6, size).transpose(2, 0, 1) * [1000, 1000, 1000, 1, 1, 1] / np.sqrt(1000) + moves
    grids = np.array([[k + 1, 1] for k in range(n + 1)] + [[1000, 2]], dtype='int32')
    shape = np.concatenate([shape, np.ones((size, 1, 6))], axis=1)
    keep = [k for k in range(n + 2) if k + 1 not in without]
    op2 = OP2(debug=None)
    op2.set_as_msc()
    table = RealEigenvectorArray.add_modal_case('OUGV1', grids[keep], shape[:, keep].astype('float32'), 1, np.arange(1, size + 1, dtype='int32'), value * w**2, w / (2 * np.pi))
    for data in table.__dict__, table.data_code:  # eigenvectors, not displacements
        data['table_code'] = data['tCode'] = 7
    op2.eigenvectors[1] = table
    op2.write_op2(folder + name + '.op2', nastran_format='msc')
    return w, full


def deck(name, norm='MASS', cbeam=None, also='DISP = ALL', taper=None):
    bdf = BDF(debug=None)
    bdf.sol, bdf.case_control_deck = 103, CaseControlDeck([also, 'METHOD = 1'])
    bdf.add_param('WTMASS', 0.5)
    for cid, kind in systems.items():
        getattr(bdf, 'add_cord2' + kind.lower())(cid, origin, origin + z_axis, origin + x_axis)
    for k, r in enumerate(1000 * x):
        s = axes('R', r).T @ (r - origin)
        cylinder = [np.hypot(s[0], s[1]), np.degrees(np.arctan2(s[1], s[0])), s[2]]
        bdf.add_grid(k + 1, cylinder if k % 3 else r, cp=8 if k % 3 else 0, cd=of[k])
    bdf.add_eigrl(1, nd=8, norm=norm)
    bdf.add_mat1(1, E / 1e6, G / 1e6, None, rho=2 * rho * 1e-12)
    bdf.add_pbar(1, 1, A * 1e6, Iz * 1e12, Iy * 1e12, 0.0, Jt * 1e12)
    if taper:
        bdf.add_pbeaml(3, 1, 'BAR', [0.0, 1.0], [[40.0, 25.0], [40.0 * taper, 25.0 * taper]])
    bdf.add_pbeam(2, 1, [0.0], ['C'], [A * 1e6], [Iz * 1e12], [Iy * 1e12], [0.0], [Jt * 1e12])
    for k in range(n):
        beside = [1000 * (local.T @ ends[19]), 1000 * ends[20]] if k == 19 else [None, None]
        if k == cbeam:
            bdf.add_cbeam(k + 1, 3 if taper else 2, [k + 1, k + 2], list(q[:, 2]), None)
            continue
        bdf.add_cbar(k + 1, 1, [k + 1, k + 2], list(q[:, 2]), None, wa=beside[0], wb=beside[1])
    bdf.add_conm2(100, 25, 2 * 0.5e-3, cid=7, X=list(1000 * c), I=[2e3 * J[0, 0], -2e3 * J[1, 0], 2e3 * J[1, 1], -2e3 * J[2, 0], -2e3 * J[2, 1], 2e3 * J[2, 2]])
    bdf.add_conm2(101, 13, 2 * 0.3e-3, cid=-1, X=list(1000 * there))
    bdf.add_spoint([1000])
    bdf.add_set1(5, [13, 20])
    bdf.write_bdf(folder + name, size=16, is_double=True)
    return folder + name


of_boom = x, K, M
w, phi = nastran('boom', K, M, 8)
files = [deck('boom.bdf'), folder + 'boom.op2']
base = ['--scale', '0.001,1000', '--frame', 1, '--mark', '25:tip,SET5']
text = run(*files, *base, '--report', folder + 'boom.html')
with open(folder + 'boom.html') as file:
    drawn = json.loads(re.search('^const data = (.*), view = ', file.read(), re.M)[1])
if sorted(map(tuple, drawn['edges'])) != [(k, k + 1) for k in range(n)] or drawn['names'][0] != [24, 'tip'] or len(drawn['modes']) != 8:
    sys.exit('page: %s' % drawn['edges'])
if re.findall('^mark .*', text, re.M) != ['mark 25 tip', 'mark 13', 'mark 20']:
    sys.exit('marks: %s' % re.findall('^mark .*', text, re.M))
plain = integrals()
sign = compare('Nastran, lumped', plain, x, M, w, phi, 1e-6)
meet('Nastran, lumped', plain['psi'].reshape(8, 3) * sign[:, None], phi[-6:-3].T, 1e-6)
meet('Nastran, lumped', plain['theta'].reshape(8, 3) * sign[:, None], phi[-3:].T, 1e-6)
run(*files, *base, '--condense')
have = integrals()
for key in 'mass', 'c', 'J', 'P', 'H', 'ups', 'Gam', 'Pi':
    meet('Nastran, condensed', have[key], plain[key], 1e-9)
run(*files, *base, '--line', '1-25')
have = integrals()
for key in 'mass', 'c', 'J', 'P', 'H', 'ups', 'Gam', 'Pi':
    meet('Nastran, line', have[key], plain[key], 1e-9)

turns = M.copy()  # a CBEAM, which has inertia about its axis
for k in 7, 8:
    put(turns, range(6 * k + 3, 6 * k + 6), rho * (Iy + Iz) * l / 2 * np.outer(q[:, 0], q[:, 0]))
w, phi = nastran('turns', K, turns, 8)
run(deck('turns.bdf', cbeam=7), folder + 'turns.op2', *base)
compare('Nastran, CBEAM', integrals(), x, turns, w, phi, 1e-6)

consistent = beam(x, q, same(rho * A * l * half), same(bending_mass(l, rho * A)), same(bending_mass(l, rho * A)), same(rho * (Iy + Iz) * l * half))
w2, phi2 = nastran('full', K, consistent, 8)
unit = np.tile([1, 1, 1, 1000, 1000, 1000], n + 1)
MGG = np.zeros((6 * n + 7, 6 * n + 7))
MGG[:-1, :-1] = turn.T @ consistent @ turn * np.outer(unit, unit) / 1000
write_op4(folder + 'MGG.op4', {'MGG': (6, MGG)}, precision='double', is_binary=False)
run(files[0], folder + 'full.op2', *base, '--mass', folder + 'MGG.op4')
compare('Nastran, mass matrix', integrals(), x, consistent, w2, phi2, 1e-6)

# modal masses of the run, where the .op2 has them (pyNastran does not write that table)
real = tool.opened


def with_masses(path, how, **more):
    out = real(path, how, **more)
    if path.endswith('.op2'):
        out.eigenvalues['modes'] = RealEigenvalues('modes', 'LAMA', 8)
        out.eigenvalues['modes'].generalized_mass[:] = [1.0] * 6 + [off, 1.0]
    return out


tool.opened, off = with_masses, 1.0
run(*files, *base)
off = 1.1
refuse('mode 7 has the modal mass 1 here, 1.1 in the .op2: .*--mass.*--tolerance 0.1', *files, *base)
tool.opened = real

# ---- what is wrong is told

x, bars, EA, rhoA = mast(2, 0.5, 0.6, 0.4, 2e-4, 1e-4)
K, M = truss(x, bars, EA, rhoA)
pair = ['--matrices', save('K.mtx', K), save('M.mtx', M)]
table = ['--nodes', csv('mast.csv', x, '')]
good = [*pair, *table, '--frame', '1-4']
run(*good, '--modes', 6)
refuse('wants MODEL.bdf MODES.op2, ', folder + 'boom.bdf')
refuse('wants MODEL.bdf MODES.op2, ', *pair)
refuse('none.mtx: no such file', '--matrices', 'none.mtx', pair[2], *table)
refuse('mast.csv: no matrix: wants .mtx', '--matrices', table[1], pair[2], *table)
scipy.io.savemat(folder + 'two.mat', {'A': K, 'B': M})
refuse('two.mat: has the matrices A, B: name one of them, .*two.mat:NAME', '--matrices', folder + 'two.mat', pair[2], *table)
refuse('KM.mat:K: 156 rows; the 12 nodes of .*mast.csv have 72 degrees of freedom at most', '--matrices', folder + 'KM.mat:K', folder + 'KM.mat:M', *table)
refuse('lumped.mtx:3: 156 rows, 156 columns; the 12 nodes of .*mast.csv have 72 degrees of freedom at most', '--matrices', pair[1], folder + 'lumped.mtx', *table)
refuse(r'skew.mtx: not symmetric: row \d+, column \d+ has .*, row \d+, column \d+ ', '--matrices', save('skew.mtx', K + np.triu(np.abs(K))), pair[2], *table)
refuse('wide.mtx: 3 rows, 36 columns', '--matrices', save('wide.mtx', K[:3]), pair[2], *table)
for text, why in (('2 2 1\n1 x 3\n', 'bad.mtx: cannot be read: .*[Ll]ine 3'),
                  ('2000000000 2000000000 1\n1 1 3\n', 'bad.mtx:2: 2000000000 rows, 2000000000 columns; the 12 nodes of .*mast.csv have 72 degrees'),
                  ('36 36 400000000\n1 1 3\n', r'bad.mtx:2: 400000000 entries are announced, the file has \d+ bytes: it is not whole'),
                  ('0 0 0\n', 'bad.mtx: 0 rows; the 12 nodes of .*mast.csv have 72 degrees of freedom at most'),
                  ('% a remark\n\n36 36\n', "bad.mtx:4: rows columns entries are wanted, not '36 36'"),
                  ('36 36 2\n7 7 3\n8 8 3\0\n', r"bad.mtx:4: b'.x00' is no character of a matrix"),
                  ('36 36 2\n7 7 3\n8 8 3e+', 'bad.mtx:4: ends within a number: it is not whole'),
                  ('36 36 1\n7 7 nan\n', 'bad.mtx: row 7, column 7: nan is not finite')):
    with open(folder + 'bad.mtx', 'w') as file:
        file.write('%%MatrixMarket matrix coordinate real general\n' + text)
    refuse(why, '--matrices', folder + 'bad.mtx', pair[2], *table)
with open(folder + 'bad.mtx', 'w') as file:
    file.write('1,1, 1,1\n')
refuse("bad.mtx:1: MatrixMarket .* or a matrix of Abaqus is wanted: .*; not '1,1, 1,1'",
       '--matrices', folder + 'bad.mtx', pair[2], *table)
refuse('turns.mtx: complex: the real part is wanted', '--matrices', save('turns.mtx', K * (1 + 0.01j)), pair[2], *table)
scipy.io.savemat(folder + 'bad.mat', {'K': {'a': 1}, 'name': 'text'})
refuse('bad.mat: has no matrix of numbers', '--matrices', folder + 'bad.mat', pair[2], *table)
refuse('6 rigid-body motions are free: --frame', *pair, *table)
refuse('3 rigid-body motions are free: --frame', *pair, *table, '--frame', 1)
refuse('--frame: the model has no node 99', *pair, *table, '--frame', '1-4,99')
refuse('--frame: node numbers .* are wanted .*not .a-b', *pair, *table, '--frame', 'a-b')
refuse('--modes: 30 wanted, there are 24 degrees of freedom with mass', *good, '--modes', 30)
refuse('--modes wants a number from 1', *good, '--modes', 0)
refuse('--mark: the model has no node 99', *good, '--mark', 99)
refuse('--mark: node 12 is there twice', *good, '--mark', '12,12:tip')
refuse('--mark: 65 nodes, a body holds 64', *good, '--mark', '1-65')
refuse('--mark: node numbers', *good, '--mark', '12-5')
refuse('--mark: node numbers', *good, '--mark', '12:a-b')
refuse('--mark: node numbers', *good, '--mark', 'SET5')
refuse('--scale wants two numbers', *good, '--scale', '0.001')
refuse('--scale wants two numbers', *good, '--scale', '0,1')
refuse('--origin: the model has no node 99', *good, '--origin', 99)
refuse('--line: node 12 has mass, moves, and is on no line', *good, *(x for c in range(1, 4) for x in ('--line', '%d,%d,%d' % (c, c + 4, c + 8))), '--line', '4,8', '--tolerance', 9)
refuse('masses lumped here, for --line: the modal masses would be off by .*: a finer mesh, no --line, or', *good, '--line', '1,5,9')
refuse('--line goes neither with --condense', *good, '--line', '1,5', '--condense')
refuse('--line 9,5,1: node 1 is held: a line goes from the frame outward', *good, '--line', '9,5,1', '--tolerance', 9)
refuse('--line 1,5,2: node 2 is held', *good, '--line', '1,5,2', '--tolerance', 9)
refuse('--line 5,9: node 5 is neither on the frame nor on a line before', *good, '--line', '5,9', '--tolerance', 9)
refuse('--tolerance wants a number from 0 on', *good, '--tolerance', 'nan')
refuse('--scale wants two numbers above 0', *good, '--scale', 'inf,1')
refuse('--mark: two nodes have the name tip', *good, '--mark', '5:tip,9:tip')
refuse('--line 12: a line has two nodes', *good, '--line', '12', '--tolerance', 9)
refuse('--out: that is what is read', *good, '--out', pair[1])
refuse('K_G0.mtx:3: 150 rows, 150 columns; the 12 nodes of .*mast.csv have 72 degrees of freedom at most', *good, '--geometric', *names)
for text, why in (('id,x,y,z\n', r'bad.csv:1: its first line has to name the columns: node,x,y,z,dofs'),
                  ('node,x,y,z,dof\n1,0,0,0,123\n', "bad.csv:1: column 'dof' is not known: node,x,y,z,dofs are"),
                  ('node,x,y,z\n', 'bad.csv: no nodes: a line 1,0,0,0 for each is wanted'),
                  ('node,x,y,z\n1,0,nan,0\n', "bad.csv:2: y: a number is wanted, not 'nan'"),
                  ('node,x,y,z\n3000000000,0,0,0\n', "bad.csv:2: node: a whole number is wanted, not '3000000000'"),
                  ('node,x,y,z\n1,\xe9,0,0\n', 'bad.csv:2: x: a number is wanted'),
                  ('node,x,y,z\n1,0,zero,0\n', r"bad.csv:2: y: a number is wanted, not 'zero'"),
                  ('node,x,y,z\n1,0,0,0\n1,0,0,0\n', 'bad.csv:3: node 1 is there twice'),
                  ('node,x,y,z,dofs\n1,0,0,0,321\n', "bad.csv:2: dofs: some of 123456 in this order .*not '321'"),
                  ('node,x,y,z,dofs\n1,0,0,0,123\n', 'K.mtx:3: 36 rows, 36 columns; the 1 nodes of .*bad.csv have 6 degrees of freedom at most')):
    with open(folder + 'bad.csv', 'w', encoding='latin-1') as file:
        file.write(text)
    refuse(why, *pair, '--nodes', folder + 'bad.csv')
loose = K.copy()
loose[35], loose[:, 35] = 0, 0
refuse('node 12, degree of freedom 3 has mass and no stiffness', '--matrices', save('loose.mtx', loose), pair[2], *table, '--frame', '1-4')
refuse(r'weak.mtx: node \d+, degree of freedom \d has the negative stiffness -', '--matrices', save('weak.mtx', -K), pair[2], *table, '--frame', '1-4')
square = [k for k, (a, b) in enumerate(bars) if b == a + 4 or b // 4 == a // 4 or a < 4]
hinged, heavy = truss(x, [bars[k] for k in square], EA[square], rhoA[square])
refuse('K is singular: a mechanism moves node|K is to be positive definite', '--matrices', save('hinged.mtx', hinged), save('heavy.mtx', heavy), *table, '--frame', '1-4')
far, bars, EA, rhoA = mast(60, 0.5, 0.6, 0.4, 2e-4, 1e-4)
hinged, heavy = truss(far, *zip(*[bar for bar in zip(bars, EA, rhoA) if not (116 <= bar[0][0] < 120 <= bar[0][1] and bar[0][1] - bar[0][0] != 4)]))
refuse('K is singular: a mechanism moves node', '--matrices', save('hinged.mtx', hinged), save('heavy.mtx', heavy), '--nodes', csv('far.csv', far, ''), '--frame', '1-4')
one_way = M.copy()
one_way[33, 33] += 1
refuse('the mass is .* along x, y and z', pair[0], pair[1], save('one_way.mtx', one_way), *table, '--frame', '1-4')

# second-order data: K_G of a truss by its rods' forces; what is not there is told by import, analyse and scene
x, bars, EA, rhoA = mast(2, 0.5, 0.6, 0.4, 2e-4, 1e-4)


def prestressed(K, M):
    """K_G under unit accelerations, angular ones and products of spins of the frame, of the mast held at nodes 1 to 4."""
    R, out = rigid(x, 3), []
    e = np.eye(3)
    spin = lambda i, j: np.concatenate([np.cross(e[i], np.cross(e[j], r)) for r in x])
    for field in [R[:, k] for k in range(6)] + [spin(i, i) for i in range(3)] + [spin(i, j) + spin(j, i) for i, j in ((0, 1), (0, 2), (1, 2))]:
        u = np.zeros(36)
        u[12:] = linalg.solve(K[12:, 12:], -(M @ field)[12:])
        K_G = np.zeros((36, 36))
        for (a, b), ea in zip(bars, EA):
            L = np.linalg.norm(x[b] - x[a])
            along = (x[b] - x[a]) / L
            N = ea / L * along @ (u[3 * b:3 * b + 3] - u[3 * a:3 * a + 3])
            put(K_G, [*range(3 * a, 3 * a + 3), *range(3 * b, 3 * b + 3)], np.kron([[1, -1], [-1, 1]], N / L * (np.eye(3) - np.outer(along, along))))
        out.append(K_G)
    return out


def effects_of(text):
    return re.search('^effects (.*)', text, re.M)[1]


def warned(*command):
    done = subprocess.run(['build/flexbeam', *command], capture_output=True, text=True)
    return done.stderr


twelve = [save('turn_%d.mtx' % k, A_) for k, A_ in enumerate(prestressed(K, M))]
text = run(*good, '--modes', 6, '--geometric', *twelve)
if effects_of(text) != 'full' or 'second-order' in text or 'warning' in warned('analyse', folder + 'out.txt', '--spin', '5'):
    sys.exit('all twelve: %s' % text)
zero = save('zero.mtx', 0 * K)
refuse(r'--geometric, spin xx .*zero.mtx.: turned as a rigid body it gives 0 of what .*say none', *good, '--modes', 6, '--geometric', *twelve[:6], zero, zero, *twelve[8:])
for k, wrong_by in ((2, -1), (8, (30 / np.pi)**2)):
    refuse('--geometric, %s .*another sign, load, origin or unit' % ('acceleration z', 'spin zz')[k > 2], *good, '--modes', 6,
           '--geometric', *twelve[:k], save('wrong.mtx', wrong_by * scipy.io.mmread(twelve[k])), *twelve[k + 1:])
text = run(*good, '--modes', 6, '--word', 'base prescribed', '--geometric', *twelve[:6], 'none', 'none', twelve[8], 'none', 'none', 'none')
if effects_of(text) != 'full' or '# no second-order data for spin xx, spin yy, spin xy, spin xz, spin yz:' not in text:
    sys.exit('none: %s' % text)
for spin, told in (('5,0,0', True), ('0,0,5', False), ('0', False)):
    if ('the component has no second-order data for this axis' in warned('analyse', folder + 'out.txt', '--spin', spin)) != told:
        sys.exit('analyse, spin %s: %s' % (spin, warned('analyse', folder + 'out.txt', '--spin', spin)))
text = run(*good, '--modes', 6, '--word', 'damping 0.01', '--geometric', *['none'] * 6, *twelve[6:])
if effects_of(text) != 'spin_coupling residual_inertia spin_stiffening damping':
    sys.exit('no accelerations: %s' % text)
refuse('--geometric has no matrix', *good, '--geometric', *['none'] * 12)
text = run(*good, '--modes', 6, '--word', 'base prescribed')
lacks = 'the component has no second-order data: spinning does not stiffen it'
with open(folder + 'scene.txt', 'w') as file:
    file.write('title turns\nduration 0.01\ninterval 0.01\nbody mast file out.txt\n  base free\nend\noutput rate spin mast y\n')
if '# no second-order data (--line, --geometric): spinning' not in text or lacks not in warned('analyse', folder + 'out.txt', '--spin', '5') or \
        'body mast: ' + lacks not in warned('scene', folder + 'scene.txt', '--out', folder + 'scene.csv'):
    sys.exit('no second-order data: %s %s' % (text, warned('scene', folder + 'scene.txt', '--out', folder + 'scene.csv')))

# tables and matrices that do not belong together: K R is zero of rigid-body motions R
def order_refused(why, K, M, x, *options):
    refuse(why, '--matrices', save('order_K.mtx', K), save('order_M.mtx', M), '--nodes', csv('order.csv', x, ''), '--modes', 6, *options)


def order_read(why, K, M, x, *options):
    text = run('--matrices', save('order_K.mtx', K), save('order_M.mtx', M), '--nodes', csv('order.csv', x, ''), '--modes', 6, *options)
    if not re.search(why, text):
        sys.exit('%s: not told: %s' % (why, text))


x, bars, EA, rhoA = mast(2, 0.5, 0.6, 0.4, 2e-4, 1e-4)
wrong = 'order.csv: these are not the places of the rows of .*order_K.mtx: turned as a rigid body it strains, node (%s) the most'
ground = 'order_K.mtx: moved as a rigid body it pulls at the ground, at node %s .*at %s of 12 nodes: .*--grounded'
swapped = x.copy()
swapped[[6, 10]] = x[[10, 6]]
order_refused(wrong % r'\d+' + '.* 12 of 12 nodes', K, M, x[::-1], '--frame', '9-12')
order_refused(wrong % '6|7|8|10|11|12', K, M, swapped, '--frame', '1-4')
order_refused(wrong % r'\d+', K, M, x * [1, -1, 1] + [0, 0.1, 0], '--frame', '1-4')  # other axes
blocks = np.arange(36).reshape(12, 3).T.ravel()  # all of x first
order_refused(ground % (r'\d+, degree of freedom \d', r'\d+'), K[np.ix_(blocks, blocks)], M[np.ix_(blocks, blocks)], x, '--frame', '1-4')
scale = np.diag(1 + 0.5 * np.sin(np.arange(36)))  # each row in another unit
order_refused(ground % (r'\d+, degree of freedom \d', '12'), scale @ K @ scale, scale @ M @ scale, x, '--frame', '1-4')
spring = K.copy()
spring[3 * 8, 3 * 8] += 1e7
order_refused(ground % ('9, degree of freedom 1', '1'), spring, M, x, '--frame', '1-4')
order_read('K holds 1 of 12 nodes to the ground, node 9', spring, M, x, '--frame', '1-4', '--grounded')
order_read('K holds 4 of 8 nodes to the ground, node 1', K[12:, 12:], M[12:, 12:], x[4:])
with open(csv('order.csv', x, '123')) as file:
    rows = file.read().split('\n')
with open(folder + 'order.csv', 'w') as file:
    file.write('\n'.join(rows[:1] + [row.replace(',123', ',0') for row in rows[1:5]] + rows[5:]))
text = run('--matrices', save('order_K.mtx', K[12:, 12:]), save('order_M.mtx', M[12:, 12:]), '--nodes', folder + 'order.csv', '--modes', 6, '--frame', '1-4')
if 'K holds 4 of 8 nodes to the ground, node 5' not in text:
    sys.exit('rows of the frame left out: %s' % text)
text = run('--matrices', save('order_K.mtx', np.vectorize(lambda a: float('%.5e' % a))(K)), pair[2], *table, '--frame', '1-4', '--modes', 6)
if not re.search('moved as a rigid body K strains a little, [1-9.]+e-06 of the forces', text):
    sys.exit('six digits: %s' % text)
other = np.roll(np.arange(36), 12)
order_refused('order_M.mtx couples nodes .* which .*order_K.mtx does not, as .*in the order of those of K', K, M[np.ix_(other, other)][::-1, ::-1], x, '--frame', '1-4')
bad = M.copy()
bad[20, 23] = bad[23, 20] = 2 * np.sqrt(M[20, 20] * M[23, 23])
order_refused('order_M.mtx: indefinite: node 7, degree of freedom 3 and node 8, degree of freedom 3 couple by', K, bad, x, '--frame', '1-4')
for a, b in (17, 20), (20, 23), (17, 23):
    bad[a, b] = bad[b, a] = -0.8 * np.sqrt(M[a, a] * M[b, b])
order_refused('order_M.mtx: indefinite as no mass is, by a shape that moves node [678], degree of freedom 3', K, bad, x, '--frame', '1-4')
def weakened(K, M):
    """K whose first mode has negative energy."""
    w, phi = modes(K, M, range(12), 1)
    load = K @ phi / w**2
    return K - 1.2 * w**2 * load @ load.T


order_refused('order_K.mtx: indefinite once the interface is clamped, by a shape that moves node (9|10|11|12)', weakened(K, M), M, x, '--frame', '1-4')
shift = M.copy()
for a, b, m in (0, 13, 0.1), (1, 12, -0.1):  # of nodes 1 and 5 along x and y
    shift[a, b] = shift[b, a] = m
order_refused('order_M.mtx: R^T M R, .* has first moments that no body has'.replace('^', '.'), K, shift, x, '--frame', '1-4')
order_read('units[?] mass 0.0059 kg, extent 1e[+]03 m, .*--scale 0.001,1000', K, M / 1000, 1000 * x, '--frame', '1-4')
rod, rods, EA_, rhoA_ = mast(40, 0.5, 0.6, 0.4, 2e-4, 1e-4)  # more than 300 rows: by the pivots of a sparse factor
Kl, Ml = truss(rod, rods, EA_, rhoA_)
order_read('frequency_hz', Kl, Ml, rod, '--frame', '1-4')
order_refused('order_K.mtx: indefinite once the interface is clamped, by a shape that moves node', weakened(Kl, Ml), Ml, rod, '--frame', '1-4')
noise = np.sin(np.arange(150 * 150)).reshape(150, 150) * 1e-14
noise = (noise + noise.T) * np.sqrt(np.outer(np.diag(of_boom[1]), np.diag(of_boom[1])))
order_read('frequency_hz', of_boom[1] + noise, consistent_boom * (1 + noise / of_boom[1].max()) , of_boom[0], '--frame', 1)
straight = beam(of_boom[0], q, same(E * A / l * two), same(bending(l, E * Iz)), same(bending(l, E * Iy)), same(G * Jt / l * two))
order_refused(wrong % r'\d+', straight, consistent_boom, 1000 * of_boom[0], '--frame', 1)  # places in mm, K in m

# 24 modes and 4096 nodes; many nodes are condensed
many = 4100
r = np.array([[0.01 * k, 0.02 * k, 1e-6 * k * k] for k in range(many)])
grounded = ['--grounded', '--matrices', folder + 'many_K.npz', folder + 'many_M.npz', '--nodes', csv('many.csv', r, '123')]
spring = 100.0 + np.arange(3 * many)
sparse.save_npz(folder + 'many_K.npz', sparse.csr_matrix(sparse.diags(spring)))
sparse.save_npz(folder + 'many_M.npz', sparse.csr_matrix(sparse.eye(3 * many)))
refuse('25 modes, a description holds 24: --modes 24', *grounded, '--modes', 25)
refuse('4100 nodes, a description holds 4096: --condense puts at most 10 points', *grounded, '--modes', 2)
text = run(*grounded, '--modes', 2, '--condense', '--report', folder + 'many.html')
with open(folder + 'many.html') as file:
    page = file.read()
if len(json.loads(re.search('^const data = (.*), view = ', page, re.M)[1])['x']) != 400 or len(page) > 60000:
    sys.exit('page of many nodes: %d characters' % len(page))
have = integrals()
meet('many nodes', have['mass'], many, 1e-12)
meet('many nodes', have['J'].reshape(3, 3), np.sum(r * r) * np.eye(3) - r.T @ r, 1e-12)
if len(re.findall('^node ', text, re.M)) > 13:
    sys.exit('not condensed')

refuse('cannot be read', table[1], files[1])
refuse('cannot be read', files[0], table[1])
refuse('--modes: 9 wanted, .*boom.op2 has 8', *files, *base, '--modes', 9)
refuse('lumped.mtx:3: 156 rows, 156 columns; the 25 grids and 1 scalar points of .*boom.bdf have 151 degrees of freedom at most', *files, *base, '--mass', folder + 'lumped.mtx')
refuse('0 tables of real normal modes .*subcase 1: normal modes.*--subcase', *files, *base, '--subcase', 3)
x, K, M = of_boom
refuse('M2GG: its mass is not that of elements', deck('m2gg.bdf', also='M2GG = MORE'), files[1], *base)
nastran('moves', K, M, 8, moves=0.01)
refuse(r'mode 1 \(.* Hz\) moves node 1 of the frame: hold it there', files[0], folder + 'moves.op2', *base)
nastran('rigid', K, M, 8, first=rigid(x, 6) @ [1, 2, 3, 0.4, 0.5, 0.6])
refuse(r'mode 1 \(.* Hz\) is a rigid-body motion: hold the interface \(SPC\) and name', files[0], folder + 'rigid.op2', '--scale', '0.001,1000')
nastran('hole', K, M, 8, without=(7,))
nastran('off', K, M, 8, masses=[1] * 6 + [1.1, 1])
refuse('mode 7 has the modal mass 1.1 here, 1 in the .op2', files[0], folder + 'off.op2', *base)
refuse('hole.op2: no displacement of grid 7, which has mass: DISP', files[0], folder + 'hole.op2', *base)
refuse('are orthogonal to .* only: .*--mass', deck('max.bdf', 'MAX'), folder + 'full.op2', *base, '--tolerance', '0.001')
held = {name: sys.modules[name] for name in list(sys.modules) if name.startswith('pyNastran')}
for name in held:
    sys.modules[name] = None
refuse('pyNastran is not installed, which files of Nastran want: python3 -m pip install pyNastran', *files, *base)
for name in held:
    del sys.modules[name]
os.makedirs(folder + 'old/pyNastran', exist_ok=True)  # one that this NumPy does not run
with open(folder + 'old/pyNastran/__init__.py', 'w') as file:
    file.write('import numpy\nnumpy.cumproduct_that_is_gone\n')
sys.path.insert(0, folder + 'old')
importlib.invalidate_caches()
refuse('pyNastran .* is installed, but does not run with NumPy .*AttributeError.*cumproduct_that_is_gone', *files, *base)
sys.path.remove(folder + 'old')
for name in [name for name in sys.modules if name.startswith('pyNastran')]:
    del sys.modules[name]
sys.modules.update(held)

# modes of other kinds; decks that are wrong
for code, kind in ((8, 'of buckling'), (9, 'complex')):
    def of_kind(path, how, **more):
        out = real(path, how, **more)
        if path.endswith('.op2'):
            out.eigenvectors[1].analysis_code = code
            del out.eigenvectors[1].eigns
        return out

    tool.opened = of_kind
    refuse('boom.op2: 0 tables of real normal modes .OUG., it has those of subcase 1: %s' % kind, *files, *base)
    tool.opened = real
text = run(files[0], folder + 'full.op2', *base, '--mass', folder + 'MGG.op4')
if not re.search('# .*MGG.op4: its mass is 0.0081, that of the elements of .*boom.bdf 0.0089', text):
    sys.exit('another mass: %s' % text)
text = run(*files, *base[2:])
if not re.search(r'boom.bdf:\d+: units[?] MAT1 1 has 2.7e-09 kg/m.3, sqrt.E/rho. 5.09e[+]06 m/s', text) or ': units?' in run(*files, *base):
    sys.exit('units: %s' % text)
nastran('bad', K, M, 8, moves=np.nan)
refuse('bad.op2: the displacement of grid 1 is not finite', files[0], folder + 'bad.op2', *base)
nastran('weak', K, M, 8, value=-1)
refuse(r'mode 1 .0 Hz. has no stiffness: a mechanism, or a part that hangs on nothing, moves node 25 the most', files[0], folder + 'weak.op2', *base)
with open(files[0]) as file:
    cards = file.read()
for old, new, why in (('GRID', 'XGRD', r'bad.bdf:\d+: cannot be read: .*CBAR'),
                      ('CONM2*               100              25', 'CONM2*               100              2x', r'bad.bdf:\d+: cannot be read'),
                      ('CBAR*                  8               1', 'CBAR*                  8              77', r'bad.bdf:\d+: cannot be read: .*CBAR +8 '),
                      ('CONM2*               101', 'CMASS2,500,1.,3,1\nCONM2*               101', r'bad.bdf:\d+: CMASS2 500: mass in one direction: export the mass matrix'),
                      ('CONM2*               101', 'NSM,1,PBAR,1,.1\nCONM2*               101', 'NSM: its mass is not that of elements')):
    if old not in cards:
        sys.exit('no %s in the deck' % old)
    with open(folder + 'bad.bdf', 'w', encoding='latin-1') as file:
        file.write(cards.replace(old, new))
    refuse(why, folder + 'bad.bdf', files[1], *base)

with open(folder + 'bad.bdf', 'w') as file:
    file.write('SOL 103\nCEND\nBEGIN BULK\nENDDATA\n')
refuse('bad.bdf: no GRID: the deck of the run is wanted', folder + 'bad.bdf', files[1], *base)
with open(folder + 'bad.bdf', 'w', encoding='latin-1') as file:
    file.write(cards.replace('$pyNastran: encoding=utf-8\n', '').replace('CONM2*               101', 'PARAM,G,.03\nTABDMP1,9,CRIT\n,0.,.01,100.,.01,ENDT\n$ Tr\xe4ger\nCONM2*               101'))
text = run(folder + 'bad.bdf', files[1], *base)
if 'bad.bdf: its damping (PARAM,G 0.03, TABDMP1 9) is not taken' not in text or 'its damping' in run(folder + 'bad.bdf', files[1], *base, '--word', 'damping 0.015'):
    sys.exit('damping of a deck: %s' % text)

# a CBEAM with PBEAML, tapered; free-free modes, whose rigid-body ones are left out
taper = M.copy()
area = lambda s: (0.04 * s) * (0.025 * s)
for k in 7, 8:
    put(taper, range(6 * k, 6 * k + 3), rho * l / 2 * (np.mean([area(1), area(0.8)]) - A) * np.eye(3))
    put(taper, range(6 * k + 3, 6 * k + 6), rho * (Iy + Iz) * (1 + 0.8**4) / 2 * l / 2 * np.outer(q[:, 0], q[:, 0]))
w, phi = nastran('taper', K, taper, 8)
run(deck('taper.bdf', cbeam=7, taper=0.8), folder + 'taper.op2', *base)
compare('Nastran, PBEAML', integrals(), x, taper, w, phi, 1e-6)

w, phi = nastran('free', K, consistent, 9, free=True)
text = run(files[0], folder + 'free.op2', '--scale', '0.001,1000', '--mass', folder + 'MGG.op4')
compare('Nastran, free-free', integrals(), x, consistent, w[6:], phi[:, 6:], 1e-5)
held = frequencies(folder + 'out.txt')
meet('Nastran, free-free', held[held > 1][:2], w[6:8], 1e-5)
if '# 6 rigid-body modes are left out' not in text or 'base free' not in text:
    sys.exit('free-free modes: %s' % text)
refuse('base: the modes are those of the free structure', files[0], folder + 'free.op2', '--scale', '0.001,1000', '--mass', folder + 'MGG.op4', '--word', 'base prescribed')
refuse('--modes: 4 wanted, .*free.op2 has 3 that are no rigid-body motion', files[0], folder + 'free.op2', '--scale', '0.001,1000', '--modes', 4)

# the example of examples/tools/README.md
with open('examples/tools/README.md') as file:
    lines = re.search(r'    (python3 examples/tools/import.py --matrices .*\n(?:      .*\n)*)', file.read())[1]
command = shlex.split(lines.replace('\\\n', ' '))[2:]
at = command.index('--out')
text = run(*command[:at], *command[at + 2:])
have = integrals()
held = frequencies(folder + 'out.txt')
meet('the example', have['M'], np.eye(6).ravel(), 1e-9)
if len(re.findall('^line ', text, re.M)) != 4 or not min(held[held > 1]) > 2 * np.pi * float(re.search('frequency_hz (\\S+)', text)[1]):
    sys.exit('the example: %s %s' % (held, text))
worst['refusals'] = len(refused)
print(json.dumps({key: float('%.2g' % value) for key, value in worst.items()}))
