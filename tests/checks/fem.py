# fem.py - for tests of examples/tools/import.py: finite elements of trusses and beams, and what runs the program in FOLDER, the first argument.
import contextlib
import importlib
import io
import re
import subprocess
import sys

import numpy as np
import scipy.io
from scipy import linalg, sparse

sys.path[:0] = ['examples/tools']
tool = importlib.import_module('import')
folder = sys.argv[1] + '/'
worst, refused = {}, []


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
    said = io.StringIO()
    try:
        with contextlib.redirect_stderr(said):
            status = tool.main(['--out', folder + 'no.txt', *map(str, arguments)])
    except SystemExit as end:
        status = end.code
    refused.append(why)
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


def csv(name, x, dofs, first=1):
    with open(folder + name, 'w') as file:
        file.write('node,x,y,z%s\n' % (',dofs' if dofs else ''))
        file.writelines('%d,%r,%r,%r%s\n' % (first + k, *map(float, r), ',' + dofs if dofs else '') for k, r in enumerate(x))
    return folder + name


def save(name, A):
    scipy.io.mmwrite(folder + name, sparse.coo_matrix(A), precision=17, symmetry='general')
    return folder + name
