# import_reduced.py - matrices reduced by Craig and Bampton through examples/tools/import.py: import_reduced.py FOLDER, with FOLDER/integrals.
# A bent frame of beams assembled here is reduced by NumPy to two or three interface nodes and fixed-interface modes and written in every
# format. What flexbeam makes of it has the frequencies of the reduced matrices, the compliance, mass and inertia of the full model, and of
# closed forms; hinged at one interface and loaded at another it bends as the full model does.
import json
import re
import shlex
import subprocess
import sys

import numpy as np
import scipy.io
from pyNastran.op4.op4 import write_op4
from scipy import linalg, sparse

sys.path[:0] = ['tests/checks']
from fem import beam, bending, bending_mass, folder, frequencies, meet, put, refuse, refused, rigid, run, save, worst

E, G, rho, b, h = 7e10, 2.7e10, 2700.0, 0.04, 0.025
Iy, Iz, Jt, A = b * h**3 / 12, h * b**3 / 12, 0.2 * b * h**3, b * h
two, half = np.array([[1, -1], [-1, 1]]), np.array([[2, 1], [1, 2]]) / 6
q, _ = np.linalg.qr(np.array([[1, 0.2, -0.3], [0.5, 1, 0.4], [0.3, -0.6, 1]]))
q *= np.sign(linalg.det(q))


def same(block):
    return lambda k: block


def arm(start, axes, length, n):
    """Places, K and M of a straight beam."""
    x, l = start + np.outer(np.linspace(0, length, n + 1), axes[:, 0]), length / n
    return (x, beam(x, axes, same(E * A / l * two), same(bending(l, E * Iz)), same(bending(l, E * Iy)), same(G * Jt / l * two)),
            beam(x, axes, same(rho * A * l * half), same(bending_mass(l, rho * A)), same(bending_mass(l, rho * A)), same(rho * (Iy + Iz) * l * half)))


def frame():
    """Two arms at a right angle, nodes 0 to 12 and 12 to 24."""
    x, K, M = arm(np.array([0.2, -0.1, 0.3]), q, 2.0, 12)
    other = arm(x[-1], q @ np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]]), 1.5, 12)
    out = [np.zeros((6 * 25, 6 * 25)) for _ in range(2)]
    for big, first, second in zip(out, (K, M), other[1:]):
        put(big, range(6 * 13), first)
        put(big, range(6 * 12, 6 * 25), second)
    return np.vstack([x, other[0][1:]]), *out


def reduce(K, M, nodes, count):
    """[CB] of import.py: constraint modes of the nodes and so many modes with them held: K, M, and the motion of all rows."""
    held = np.concatenate([6 * k + np.arange(6) for k in nodes])
    free = np.setdiff1d(np.arange(len(K)), held)
    _, phi = linalg.eigh(K[np.ix_(free, free)], M[np.ix_(free, free)], subset_by_index=[0, max(count - 1, 0)])
    T = np.zeros((len(K), len(held) + count))
    T[held, np.arange(len(held))] = 1
    T[np.ix_(free, np.arange(len(held)))] = -linalg.solve(K[np.ix_(free, free)], K[np.ix_(free, held)])
    T[np.ix_(free, len(held) + np.arange(count))] = phi[:, :count]
    return *((B + B.T) / 2 for B in (T.T @ K @ T, T.T @ M @ T)), T


def table(name, x, nodes, count, dofs='123456'):
    with open(folder + name, 'w') as file:
        file.write('node,x,y,z,dofs\n' + ''.join('%d,%r,%r,%r,%s\n' % (k + 1, *map(float, x[k]), dofs) for k in nodes))
        file.write('101-%d,,,,q\n' % (100 + count) if count else '')
    return ['--nodes', folder + name]


def compliance(have, node):
    """6 x 6 of a node of the body (from 0) under loads at a node of the body, by the shapes and frequencies that flexbeam has."""
    n = len(have['reach'])
    S = [np.vstack([have['psi%d' % k].reshape(n, 3).T, have['theta%d' % k].reshape(n, 3).T]) for k in node]
    return S[0] @ linalg.solve(have['K'].reshape(n, n), S[1].T)


def body():
    """Integrals of FOLDER/out.txt, with psi and theta of each node."""
    done = subprocess.run([folder + 'integrals', folder + 'out.txt'], capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stdout + done.stderr)
    have, count = {}, {}
    for line in done.stdout.splitlines():
        name, *values = line.split()
        if name in ('psi', 'theta', 'r'):
            count[name] = count.get(name, -1) + 1
            name += str(count[name])
        have[name] = np.array(values, dtype=float)
    return have


def by_hand(have, x0, K, M, R, frame_rows, rows, near=1e-9):
    """Frequencies of the reduced matrices, mass, center and inertia of the full model about its frame."""
    free = np.setdiff1d(np.arange(len(K)), frame_rows)
    value = linalg.eigh(K[np.ix_(free, free)], M[np.ix_(free, free)], eigvals_only=True)
    n = len(have['reach'])
    meet('frequencies of the reduced matrices', np.sqrt(np.diag(have['K'].reshape(n, n))[:rows] / value[:rows]), np.ones(rows), near)
    shift = np.eye(6)
    shift[:3, 3:] = [[0, -x0[2], x0[1]], [x0[2], 0, -x0[0]], [-x0[1], x0[0], 0]]  # motion of the frame at x0, as of the origin
    mass = shift.T @ (R.T @ M @ R) @ shift
    meet('mass, center and inertia', have['mass'], mass[0, 0], near)
    meet('mass, center and inertia', have['c'], [mass[5, 1], mass[3, 2], mass[4, 0]], near, mass[0, 0])
    meet('mass, center and inertia', have['J'], mass[3:, 3:].ravel(), near)
    return value


x, K, M = frame()
full = linalg.inv(K[6:, 6:])  # held at node 0
at = [6 * 12 - 6 + np.arange(6), 6 * 24 - 6 + np.arange(6)]

# two interface nodes: all modes are kept, and nothing is lost
Kr, Mr, T = reduce(K, M, (0, 24), 18)
base = table('two.csv', x, (0, 24), 18)
pair = ['--matrices', save('rK.mtx', Kr), save('rM.mtx', Mr)]
text = run(*pair, *base, '--mark', '25:tip')
have = body()
R = np.vstack([rigid(x[[0, 24]], 6), np.zeros((18, 6))])
meet('R^T M R of the full model', R.T @ Mr @ R, rigid(x, 6).T @ M @ rigid(x, 6), 1e-10)
value = by_hand(have, x[0], Kr, Mr, R, range(6), 24)
meet('tip compliance', compliance(have, (0, 0)), full[np.ix_(at[1], at[1])], 1e-9)
meet('frequencies of the full model', np.sqrt(value[:6]), np.sqrt(linalg.eigh(K[6:, 6:], M[6:, 6:], eigvals_only=True)[:6]), 2e-4)
if '# held at node 1, which carries the frame' not in text or re.findall('^mark .*', text, re.M) != ['mark 25 tip'] or \
        not re.search('^# the modes have all of the static deflection of node 25 .tip. by forces and moments', text, re.M):
    sys.exit('two interfaces: %s' % text)
run(*pair, *base, '--frame', 25)
have = body()
by_hand(have, x[24], Kr, Mr, R, range(6, 12), 24)
other = linalg.inv(K[:6 * 24, :6 * 24])
meet('tip compliance', compliance(have, (0, 0)), other[:6, :6], 1e-9)

# three of them: 52 modes, of which 24 are written
Kr3, Mr3, T3 = reduce(K, M, (0, 12, 24), 40)
base3 = table('three.csv', x, (0, 12, 24), 40)
pair3 = ['--matrices', save('rK3.mtx', Kr3), save('rM3.mtx', Mr3)]
text = run(*pair3, *base3)
have = body()
by_hand(have, x[0], Kr3, Mr3, np.vstack([rigid(x[[0, 12, 24]], 6), np.zeros((40, 6))]), range(6), 12)
for a in range(2):
    for c in range(2):
        meet('compliance of 24 of 52 modes', compliance(have, (a, c)), full[np.ix_(at[a], at[c])], 1e-9)
value = linalg.eigh(Kr3[6:, 6:], Mr3[6:, 6:], eigvals_only=True)
said = re.search('^# of 52 modes the lowest 12 are kept .to (.*) Hz.; dropped are the modes of (.*) [.][.] (.*) Hz, in whose place 12 residual', text, re.M)
if len(re.findall('^# the modes have all of the static deflection of node (13|25) by forces and moments', text, re.M)) != 2:
    sys.exit('three interfaces: %s' % text)
meet('dropped frequencies', [float(f) for f in [said[1], *said[2].split(), said[3]]], np.sqrt(value[[11, *range(12, 24), 51]]) / (2 * np.pi), 1e-4)
run(*pair3, *base3, '--mark', 25, '--modes', 9)
have = body()
meet('compliance of 9 of 52 modes', compliance(have, (0, 0)), full[np.ix_(at[1], at[1])], 1e-9)
refuse('--mark: the marked nodes .without --mark all of the interface. have 12 degrees of freedom, and each wants a mode for its static deflection: of 9 modes, at most 24, mark fewer', *pair3, *base3, '--modes', 9)

# a straight cantilever against closed forms
xs, Ks, Ms = arm(np.zeros(3), np.eye(3), 3.0, 24)
Kc, Mc, _ = reduce(Ks, Ms, (0, 24), 12)
run('--matrices', save('cK.mtx', Kc), save('cM.mtx', Mc), *table('straight.csv', xs, (0, 24), 12))
have = body()
meet('closed forms of a cantilever', np.diag(compliance(have, (0, 0))),
     [3 / (E * A), 9 / (E * Iz), 9 / (E * Iy), 3 / (G * Jt), 3 / (E * Iy), 3 / (E * Iz)], 1e-9)
meet('closed form of its mass', have['mass'], rho * A * 3, 1e-12)
meet('closed form of its first frequency', np.sqrt(have['K'][0]), 1.875104068711961**2 * np.sqrt(E * Iy / (rho * A)) / 9, 1e-5)

# by flexbeam itself: static gains of the clamped body, and a hinge with a spring at the frame
run(*pair, *base, '--mark', '25:tip', '--word', 'base prescribed')
axes = 'xyz'
subprocess.run(['build/flexbeam', 'analyse', folder + 'out.txt', '--linear', folder + 'r.json', '--inputs', ','.join('%s.tip.%s' % (k, a) for k in ('force', 'torque') for a in axes),
                '--outputs', ','.join('%s.tip.%s' % (k, a) for k in ('displacement', 'rotation') for a in axes)], check=True, capture_output=True)
with open(folder + 'r.json') as file:
    plant = json.load(file)
gain = np.array(plant['D']) - np.array(plant['C']) @ linalg.solve(np.array(plant['A']), np.array(plant['B']))
meet('static gains by analyse', gain, full[np.ix_(at[1], at[1])], 1e-6)
meet('frequencies by analyse', frequencies(folder + 'out.txt')[:6], np.sqrt(linalg.eigh(Kr[6:, 6:], Mr[6:, 6:], eigvals_only=True)[:6]), 1e-5)

run(*pair, *base, '--mark', '25:tip')
spring, load = 300.0, np.array([0.03, -0.05, 0.04]) / 1000


def scene(text):
    """Measures of a scene with the body FOLDER/out.txt, the first three frequencies among them."""
    with open(folder + 'scene.txt', 'w') as file:
        file.write('title bent\nbody bent file out.txt\nend\n' + text + ''.join('measure w%d frequency %d\n' % (k, k) for k in (1, 2, 3)))
    done = subprocess.run(['build/flexbeam', 'scene', folder + 'scene.txt'], capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stdout + done.stderr)
    return {key: float(value) for key, value in re.findall(r'^(\w+) = (\S+)', done.stdout, re.M)}


said = scene('trim\njoint root revolute ground bent\n  stiffness %r\nend\nload bent.tip dead force %r %r %r\noutput u displacement bent.tip\noutput turn coordinate root 1\n'
             'measure x final u_x\nmeasure y final u_y\nmeasure z final u_z\nmeasure angle final turn\n' % (spring, *load))
lever = (x[24] - x[0])
meet('hinged and loaded', [said[k] for k in 'xyz'], full[np.ix_(at[1][:3], at[1][:3])] @ load, 1e-6)
meet('hinged and loaded', said['angle'], np.cross(lever, load)[2] / spring, 1e-6)
for what, K_, M_, near in (('hinged, frequencies of the reduced matrices', Kr, Mr, 1e-7), ('hinged, frequencies of the full model', K, M, 2e-4)):
    rows = np.arange(5, len(K_))  # rotation about z at the frame moves
    sprung = K_[np.ix_(rows, rows)].copy()
    sprung[0, 0] += spring
    want = np.sqrt(linalg.eigh(sprung, M_[np.ix_(rows, rows)], eigvals_only=True)[:3])
    meet(what, [said['w%d' % k] / w for k, w in zip((1, 2, 3), want)], np.ones(3), near)

# a body on a joint at the other interface: a mass and an inertia more in its rows
said = scene('body payload rigid\n  hub 0.5 0 0 0  0.02 0.03 0.04\nend\njoint root rigid ground bent\nend\njoint top rigid bent.tip payload\nend\n'
             'duration 0.001\ninterval 0.001\noutput u displacement bent.tip\n')
for what, K_, M_, first, near in (('payload, frequencies of the reduced matrices', Kr, Mr, 6, 1e-7), ('payload, frequencies of the full model', K, M, 144, 2e-4)):
    loaded = M_.copy()
    loaded[range(first, first + 6), range(first, first + 6)] += [0.5, 0.5, 0.5, 0.02, 0.03, 0.04]
    want = np.sqrt(linalg.eigh(K_[6:, 6:], loaded[6:, 6:], eigvals_only=True)[:3])
    meet(what, [said['w%d' % k] / w for k, w in zip((1, 2, 3), want)], np.ones(3), near)
# the same body once more on the tip of the first: two superelements are the structure of both
said = scene('body second like bent\njoint root rigid ground bent\nend\njoint top rigid bent.tip second\nend\nduration 0.001\ninterval 0.001\n'
             'output u displacement bent.tip\n')
both = [np.zeros((6 * 49, 6 * 49)) for _ in range(2)]
for big, B in zip(both, (K, M)):
    put(big, range(6 * 25), B)
    put(big, range(6 * 24, 6 * 49), B)
want = np.sqrt(linalg.eigh(both[0][6:, 6:], both[1][6:, 6:], eigvals_only=True)[:3])
meet('two superelements', [said['w%d' % k] / w for k, w in zip((1, 2, 3), want)], np.ones(3), 1e-4)


# ---- the same from every format


def dmig(name, matrices, labels, cards='', free=False):
    """A punch file of symmetric DMIG, large field as Nastran punches it, or free field with all digits."""
    with open(folder + name, 'w') as file:
        file.write('$ of an external superelement\n' + cards)
        for key, A in matrices.items():
            file.write('DMIG,%s,0,6,2,0,,,%d\n' % (key, len(A)) if free else 'DMIG    %-8s%8d%8d%8d%8d\n' % (key, 0, 6, 2, 0))
            for j, (node, dof) in enumerate(labels):
                rows = [i for i in range(j, len(A)) if A[i, j]]
                if rows and not free:
                    file.write('DMIG*   %-16s%16d%16d\n' % (key, node, dof))
                    file.writelines('*       %16d%16d%16s\n' % (*labels[i], ('%.9E' % A[i, j]).replace('E', 'D')) for i in rows)
                elif rows:
                    file.write('DMIG,%s,%d,%d' % (key, node, dof))
                    file.writelines('%s,%d,%d,%r,' % (',' if n == 0 else '\n' if n % 2 else '', *labels[i], float(A[i, j])) for n, i in enumerate(rows))
                    file.write('\n')
    return folder + name


def same_as(text, *arguments):
    other = run(*arguments)
    if re.sub('^#.*\n', '', other, flags=re.M) != re.sub('^#.*\n', '', text, flags=re.M):
        sys.exit('%s: another text than of MatrixMarket: %s' % (arguments, other[:2000]))


C = 0.4 * Mr + 2e-5 * Kr
triple = [*pair, save('rC.mtx', C)]
text = run(*triple, *base)
value = linalg.eigh(Kr[6:, 6:], Mr[6:, 6:], eigvals_only=True)
meet('damping ratios', np.array(re.search('^damping (.*)', text, re.M)[1].split(), dtype=float), 0.2 / np.sqrt(value) + 1e-5 * np.sqrt(value), 1e-8)
if not re.search('^# .*rC.mtx damps rigid-body motion', text, re.M) or not re.search('^effects spin damping', text, re.M):
    sys.exit('damping: %s' % text)
names = {'KAAX': Kr, 'MAAX': Mr, 'BAAX': C}
sparse.save_npz(folder + 'rK.npz', sparse.csr_array(Kr))
sparse.save_npz(folder + 'rM.npz', sparse.csr_array(Mr))
sparse.save_npz(folder + 'rC.npz', sparse.csr_array(C))
same_as(text, '--matrices', *(folder + 'r%s.npz' % k for k in 'KMC'), *base)
scipy.io.savemat(folder + 'r.mat', {'K': Kr, 'M': Mr, 'C': C})
same_as(text, '--matrices', folder + 'r.mat', *base)
write_op4(folder + 'r.op4', {'KXX': (6, Kr), 'MXX': (6, Mr), 'BXX1': (6, C)}, name_order=['KXX', 'MXX', 'BXX1'], precision='double', is_binary=False)
same_as(text, '--matrices', folder + 'r.op4', *base)
labels = [(1, k + 1) for k in range(6)] + [(25, k + 1) for k in range(6)] + [(101 + k, 0) for k in range(18)]
same_as(text, '--matrices', dmig('r.pch', names, labels, free=True), *base)


text_of_two = run('--matrices', dmig('k4.pch', {**names, 'K4AAX': 0.02 * Kr}, labels, free=True), *base)
if "k4.pch:K4AAX is not taken: a factor G of it is a damping ratio of G/2" not in text_of_two:
    sys.exit('structural damping: %s' % text_of_two)
text_of_two = run('--matrices', folder + 'k4.pch:KAAX', folder + 'k4.pch:MAAX', *base)
if 'k4.pch:BAAX is not taken: a third matrix' not in text_of_two or re.search('^damping', text_of_two, re.M):
    sys.exit('damping: %s' % text_of_two)


def substructure(name, matrices, extra=''):
    """As *SUBSTRUCTURE MATRIX OUTPUT writes it: the lower triangle by rows, four values in a line."""
    with open(folder + name, 'w') as file:
        file.write('**\n** GENERATION OF SUBSTRUCTURE Z1\n*USER ELEMENT, NODES=         2, LINEAR\n** ELEMENT NODES\n**          1,         25\n'
                   '          1,          2,          3,          4,          5,          6\n' + extra)
        for key, B in matrices.items():
            file.write('*MATRIX,TYPE=%s\n' % key)
            for i in range(len(B)):
                row = ['%r' % float(value) for value in B[i, :i + 1]]
                file.writelines(' ' + ', '.join(row[k:k + 4]) + (',' if len(row) > k + 4 or k == 0 else '') + '\n' for k in range(0, len(row), 4))
    return folder + name


same_as(text.replace(' damping\n', '\n').replace(re.search('^damping .*\n', text, re.M)[0], ''),
        '--matrices', substructure('sub.mtx', {'STIFFNESS': Kr, 'MASS': Mr}), *base)


def entries(name, B, five):
    """As *MATRIX OUTPUT writes it: one triangle."""
    with open(folder + name, 'w') as file:
        for j in range(len(B)):
            for i in range(j + 1):
                if B[i, j]:
                    file.write('%d,%d, %d,%d, %r\n' % (*place[i], *place[j], float(B[i, j])) if five else '%d %d %r\n' % (i + 1, j + 1, float(B[i, j])))
    return folder + name


place = [(node, dof or 1) for node, dof in labels]
for five in True, False:
    same_as(text, '--matrices', *(entries('%s%d.mtx' % (key, five), B, five) for key, B in names.items()), *base)


def boeing(name, B, kind='RSA'):
    """As HBMAT of ANSYS writes it."""
    A_ = sparse.csc_array(np.tril(B) if kind == 'RSA' else B)
    parts = [('%10d', 8, A_.indptr + 1), ('%10d', 8, A_.indices + 1), ('%25s', 3, [('%.16E' % v).replace('E', 'D') for v in A_.data])]
    text = [''.join(form % v for v in values[k:k + n]) for form, n, values in parts for k in range(0, len(values), n)]
    lines = [-(-len(values) // n) for _, n, values in parts]
    with open(folder + name, 'w') as file:
        file.write('%-72s%-8s\n%14d%14d%14d%14d%14d\n%-14s%14d%14d%14d%14d\n%-16s%-16s%-20s%-20s\n'
                   % ('stiffness', 'ansys', sum(lines), *lines, 0, kind, *B.shape, A_.nnz, 0, '(8I10)', '(8I10)', '(3D25.16)', '') + '\n'.join(text) + '\n')
    return folder + name


for kind in 'RSA', 'RUA':
    same_as(text, '--matrices', *(boeing('%s.matrix' % key, B, kind) for key, B in names.items()), *base)

# a punch file with its own grids, whose second has cylindrical axes: ten digits
origin, along, across = np.array([-0.4, 0.15, 0.09]), q @ [0.6, 0, 0.8], q @ [0.8, 0, -0.6]
away = x[24] - origin - (x[24] - origin) @ along * along
away /= np.linalg.norm(away)
B = np.eye(len(Kr))
B[6:12, 6:12] = np.kron(np.eye(2), np.array([away, np.cross(along, away), along]).T)
grids = 'CORD2C,10,0,%.12f,%.12f,%.12f,%.12f,%.12f,%.12f\n,%.12f,%.12f,%.12f\nGRID,1,,%.12f,%.12f,%.12f\nGRID,25,,%.12f,%.12f,%.12f,10\nSPOINT,101,THRU,118\n' % tuple(
    map(float, [*origin, *(origin + along), *(origin + across), *x[0], *x[24]]))
local = {key: B.T @ A_ @ B for key, A_ in names.items()}
run('--matrices', dmig('grids.pch', local, labels, grids))
have = body()
by_hand(have, x[0], Kr, Mr, R, range(6), 6, 1e-7)
meet('a punch file of ten digits', compliance(have, (0, 0)), full[np.ix_(at[1], at[1])], 1e-6)
with open(folder + 'asm.asm', 'w') as file:
    file.write('SEBULK,101,EXTOP4\nSECONCT,101,0,,NO\n,1,1,25,25\n' + grids)
write_op4(folder + 'local.op4', {'KXX': (6, local['KAAX']), 'MXX': (6, local['MAAX'])}, name_order=['KXX', 'MXX'], precision='double', is_binary=False)
run('--matrices', folder + 'local.op4', '--nodes', folder + 'asm.asm')
have = body()
by_hand(have, x[0], Kr, Mr, R, range(6), 24)
meet('op4 and its .asm', compliance(have, (0, 0)), full[np.ix_(at[1], at[1])], 1e-9)

# modal coordinates that are not those of the held interface: static and free shapes mixed
mixed = np.eye(len(Kr))
mixed[12:, :12] = np.sin(np.arange(18 * 12)).reshape(18, 12)
text = run('--matrices', save('xK.mtx', mixed.T @ Kr @ mixed), save('xM.mtx', mixed.T @ Mr @ mixed), *base)
have = body()
by_hand(have, x[0], Kr, Mr, R, range(6), 20, 1e-8)
meet('mixed modal coordinates', compliance(have, (0, 0)), full[np.ix_(at[1], at[1])], 1e-8)
if '# K couples modal coordinates with the interface' not in text:
    sys.exit('mixed: %s' % text)

# one interface: its shapes do not move, the momenta are those of the full model; statically reduced: a substructure without modes
K1, M1, T1 = reduce(K, M, (0,), 10)
run('--matrices', save('oK.mtx', K1), save('oM.mtx', M1), *table('one.csv', x, (0,), 10))
have = body()
R1 = np.vstack([rigid(x[:1], 6), np.zeros((10, 6))])
by_hand(have, x[0], K1, M1, R1, range(6), 10)
want = (R1.T @ M1[:, 6:])
sign = np.sign(np.sum(have['P'].reshape(10, 3) * want[:3].T, axis=1))
_, phi = linalg.eigh(K1[6:, 6:], M1[6:, 6:])  # where modes move is an estimate: of three, integrals of products of displacements
masses = rho * A * np.array([1 / 12] + [1 / 6] * 11 + [1 / 12 + 1 / 16] + [1 / 8] * 11 + [1 / 16])
u = (T1[:, 6:] @ phi[:, :3]).reshape(25, 6, 3)[:, :3]
moved = np.einsum('p,pik,pjk->kij', masses, u, u)
meet('estimated directions', have['Pi'].reshape(10, 10, 3, 3)[[0, 1, 2], [0, 1, 2]], np.trace(moved, axis1=1, axis2=2)[:, None, None] * np.eye(3) - moved, 0.15)
meet('momenta of one interface', have['P'].reshape(10, 3) * sign[:, None], want[:3].T, 1e-8)
K0, M0, T0 = reduce(K, M, (0, 24), 0)
run('--matrices', substructure('guyan.mtx', {'STIFFNESS': K0, 'MASS': M0}), *table('none.csv', x, (0, 24), 0))
have = body()
by_hand(have, x[0], K0, M0, rigid(x[[0, 24]], 6), range(6), 6)
meet('statically reduced', compliance(have, (0, 0)), full[np.ix_(at[1], at[1])], 1e-9)

# millimetres and tonnes
unit = np.concatenate([np.tile([1, 1, 1, 1000, 1000, 1000], 2), np.full(18, 1000.0)]) / np.sqrt(1000)
run('--matrices', save('uK.mtx', Kr * np.outer(unit, unit)), save('uM.mtx', Mr * np.outer(unit, unit)), *table('u.csv', 1000 * x, (0, 24), 18), '--scale', '0.001,1000')
have = body()
by_hand(have, x[0], Kr, Mr, R, range(6), 24)
meet('units', compliance(have, (0, 0)), full[np.ix_(at[1], at[1])], 1e-9)

# an interface node without mass behind a bushing keeps its static deflection, too
hung = [np.zeros((36, 36)) for _ in range(2)]
for big, B in zip(hung, (Kr, Mr)):
    big[:30, :30] = B
put(hung[0], [*range(6, 12), *range(30, 36)], np.kron(two, np.diag([1e6, 2e6, 3e6, 1e4, 2e4, 3e4])))
with open(folder + 'hung.csv', 'w') as file:
    file.write('node,x,y,z,dofs\n1,%r,%r,%r,123456\n25,%r,%r,%r,123456\n101-118,,,,q\n26,%r,%r,%r,123456\n' % (*map(float, x[0]), *map(float, x[24]), *map(float, x[24])))
hung = ['--matrices', save('hungK.mtx', hung[0]), save('hungM.mtx', hung[1]), '--nodes', folder + 'hung.csv'], linalg.inv(hung[0][6:, 6:])[24:, 24:]
for count in (24, 12):
    run(*hung[0], '--mark', 26, '--modes', count)
    have = body()
    by_hand(have, x[0], Kr, Mr, R, range(6), count - 8)
    meet('compliance without mass', compliance(have, (0, 0)), hung[1], 1e-9)
text = run(*hung[0])  # what of node 26 is beside node 25 has no mass, no mode has it
if not re.search('^# the modes have all of the static deflection of node 25 by', text, re.M) or \
        not re.search('^# of the static deflection of node 26 by a moment there the modes leave out (?!0 )', text, re.M):
    sys.exit('without mass: %s' % text)

# rows that are empty, masses that are not the same in all directions: told; nodes with displacements alone
hollow = [np.zeros((33, 33)) for _ in range(2)]
for big, B in zip(hollow, (Kr, Mr)):
    big[np.ix_(np.r_[0:12, 15:33], np.r_[0:12, 15:33])] = B
with open(folder + 'empty.csv', 'w') as file:
    file.write('node,x,y,z,dofs\n1,%r,%r,%r,123456\n25,%r,%r,%r,123456\n26,0,0,0,456\n101-118,,,,q\n' % (*map(float, x[0]), *map(float, x[24])))
text = run('--matrices', save('eK.mtx', hollow[0]), save('eM.mtx', hollow[1]), '--nodes', folder + 'empty.csv')
have = body()
by_hand(have, x[0], Kr, Mr, R, range(6), 24)
if '# 3 rows have neither stiffness nor mass and are left out: node 26, degree of freedom 4' not in text:
    sys.exit('empty rows: %s' % text)
heavy = Mr.copy()
heavy[0, 0] += 0.05
text = run(pair[0], pair[1], save('vM.mtx', heavy), *base)
have = body()
said = re.search('the mass is (.*), (.*) and (.*) along x, y and z, which a body has not: (.*) is taken', text)
meet('masses of directions', [float(m) for m in said.groups()[:3]], np.diag(R.T @ heavy @ R)[:3], 1e-5)
n = len(have['reach'])
meet('masses of directions, frequencies', np.sqrt(np.diag(have['K'].reshape(n, n))) / np.sqrt(linalg.eigh(Kr[6:, 6:], heavy[6:, 6:], eigvals_only=True)), np.ones(n), 1e-9)
if not 9.5 <= float(said[4]) < 9.55:
    sys.exit('masses of directions: %s' % said[0])
turns = np.r_[9:12]
rest = np.setdiff1d(np.arange(30), turns)
S = np.eye(30)[:, rest]
S[np.ix_(turns, np.arange(len(rest)))] = -linalg.solve(Kr[np.ix_(turns, turns)], Kr[np.ix_(turns, rest)])
with open(folder + 'straight.csv', 'w') as file:
    file.write('node,x,y,z,dofs\n1,%r,%r,%r,123456\n25,%r,%r,%r,123\n101-118,,,,q\n' % (*map(float, x[0]), *map(float, x[24])))
text = run('--matrices', save('tK.mtx', (S.T @ Kr @ S + (S.T @ Kr @ S).T) / 2), save('tM.mtx', (S.T @ Mr @ S + (S.T @ Mr @ S).T) / 2), '--nodes', folder + 'straight.csv')
have = body()
meet('tip compliance, forces', compliance(have, (0, 0))[:3, :3], full[np.ix_(at[1][:3], at[1][:3])], 1e-8)
if '# of node 25 the matrices have some of the six degrees of freedom only' not in text:
    sys.exit('displacements alone: %s' % text)
with open(folder + 'part.csv', 'w') as file:
    file.write('node,x,y,z\n1,%r,%r,%r\n25,%r,%r,%r\n' % (*map(float, x[0]), *map(float, x[24])))
same_as(text, '--matrices', substructure('part.mtx', {'STIFFNESS': (S.T @ Kr @ S + (S.T @ Kr @ S).T) / 2, 'MASS': (S.T @ Mr @ S + (S.T @ Mr @ S).T) / 2},
                                         '          2,          1,          2,          3\n'), '--nodes', folder + 'part.csv')

# the example of examples/tools/README.md
with open('examples/tools/README.md') as file:
    command = shlex.split(re.search('    (python3 examples/tools/import.py --matrices examples/bent/.*)', file.read())[1])[2:]
where = command.index('--out')
run(*command[:where], *command[where + 4:])
have = body()
meet('the example', compliance(have, (0, 0)), full[np.ix_(at[1], at[1])], 1e-6)
meet('the example', have['mass'], rho * A * 3.5, 1e-8)

# the report: text, and one page without network
run(*pair3, *base3, '--mark', '13:elbow,25:tip', '--report', folder + 'report')
with open(folder + 'report') as file:
    report = file.read()
value = linalg.eigh(Kr3[6:, 6:], Mr3[6:, 6:], eigvals_only=True)
meet('report', float(re.search('^mass +(.*) kg', report, re.M)[1]), rho * A * 3.5, 1e-8)
about = rigid(x - x[0], 6).T @ M @ rigid(x - x[0], 6)
center = np.array([about[5, 1], about[3, 2], about[4, 0]]) / about[0, 0]
meet('report', np.array(re.search('^center of mass +(.*) m', report, re.M)[1].split(), dtype=float), center, 1e-5)
J = about[3:, 3:] - about[0, 0] * (center @ center * np.eye(3) - np.outer(center, center))
said = [float(re.search('%s ([-0-9.e+]+)' % key, re.search('^inertia about it +(.*)', report, re.M)[1])[1]) for key in ('xx', 'yy', 'zz', 'xy', 'xz', 'yz')]
meet('report', said, [J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2]], 1e-5)
rows = re.findall(r'^ +(\d+) +(\S+) +(\S+) +(\S+) +(\S+) +(\S+) +\S+ +\S+ +\S+ +\S+$', report, re.M)
meet('report', [float(row[2]) for row in rows[:12]], np.sqrt(value[:12]) / (2 * np.pi), 1e-5)
if [row[2] for row in rows[12:]] != ['residual'] * 12 or len(re.findall('(elbow|tip)[)] +[0-9.e-]+ %', report)) != 2:
    sys.exit('report: %s' % report)
dropped = re.search('^modes dropped +(.*) Hz', report, re.M)[1].split()
meet('report', [float(hz) for hz in dropped], np.sqrt(value[12:]) / (2 * np.pi), 1e-4)
_, phi = linalg.eigh(Kr3[6:, 6:], Mr3[6:, 6:])
share = (np.vstack([rigid(x[[0, 12, 24]], 6), np.zeros((40, 6))]).T @ Mr3[:, 6:] @ phi[:, :12])[:3]**2 / about[0, 0]
meet('report', np.array([row[3:] for row in rows[:12]], dtype=float) / 100, share.T, 6e-3)
run(*pair3, *base3, '--mark', '13:elbow,25:tip', '--report', folder + 'report.html')
with open(folder + 'report.html') as file:
    page = file.read()
data = json.loads(re.search('^const data = (.*), view = ', page, re.M)[1])
meet('page', data['x'], (x - x[0])[[0, 12, 24]], 1e-4)
shape = np.array(data['modes'])[0]
want = T3[np.ix_(np.concatenate([6 * k + np.arange(6) for k in (0, 12, 24)]), np.arange(6, len(Kr3)))] @ phi[:, 0]
want = want.reshape(3, 6) / np.linalg.norm(want.reshape(3, 6)[:, :3], axis=1).max()
meet('page', shape * np.sign(np.sum(shape * want)), want, 6e-3)
if re.search('https?:|src=|@[A-Z]+@', page) or len(page) > 30000 or len(data['modes']) != 24 or [name for _, name in data['names']] != ['elbow', 'tip', 'frame']:
    sys.exit('page: %d characters, %s' % (len(page), data['names']))
refuse('--report: that is what is read or written', *pair, *base, '--report', pair[1])

# ---- what is wrong is told

refuse('wants MODEL.bdf MODES.op2, MODEL.inp, or --matrices K M --nodes FILE', *pair)
for arguments, why in (
        ([*pair, *table('short.csv', x, (0, 24), 17)], 'rK.mtx:3: 30 rows, 30 columns; the 2 nodes and 17 modal coordinates of .*short.csv have 29 degrees of freedom at most'),
        ([*pair, *table('more.csv', x, (0, 24), 19)], 'more.csv: 2 nodes and 19 modal coordinates with 31 degrees of freedom, the matrices have 30 rows'),
        ([*pair, *base, '--line', '1,25'], '--line, --geometric, --condense and --grounded are for matrices of all nodes'),
        ([*pair, *base, '--grounded'], '--line, --geometric, --condense and --grounded are for matrices of all nodes'),
        ([*pair, *base, '--frame', '7'], '--frame: the model has no node 7'),
        ([*pair, *base, '--mark', '7'], '--mark: the model has no node 7'),
        ([*pair, *base, '--modes', '25'], '--modes: 25 wanted, a description holds 24'),
        ([*pair3, *base3, '--modes', '25'], '--modes: 25 wanted, a description holds 24'),
        (['--matrices', folder + 'r.pch', *table('q.csv', x, (0, 24), 17)], 'q.csv: 17 modal coordinates, .*r.pch:KAAX.* has rows of 18'),
        (['--matrices', folder + 'r.pch', *table('third.csv', x, (0, 12, 24), 18)], 'third.csv:3: node 13 has no rows in .*r.pch:KAAX'),
        (['--matrices', folder + 'r.pch:KAAX', *base], 'r.pch:KAAX: is K and M in one'),
        (['--matrices', pair[1], *base], 'rK.mtx: is K and M in one'),
        (['--matrices', folder + 'none.pch'], 'none.pch: no such file|none.pch: No such file'),
        (['--matrices', folder + 'r.pch'], 'r.pch: no GRID: '),
        (['--matrices', folder + 'r.pch:KAAX', folder + 'r.pch:MBBX', *base], 'r.pch:MBBX: has the matrices KAAX, MAAX, BAAX: name one of them'),
        (['--matrices', *pair[1:], triple[3], triple[3], *base], '--matrices wants K M .C., or one file'),
        (['--matrices', folder + 'r.pch', *table('far.csv', x, (0, 23), 18)], 'r.pch:KAAX.*: its row of node 25, degree of freedom 1: .*far.csv has no such node .NODE,,,,q')):
    refuse(why, *arguments)
swapped = x.copy()
swapped[[0, 24]] = x[[24, 0]]
refuse('swap.csv: these are not the places of the rows of .*rK.mtx: turned as a rigid body it strains, node (1|25) the most', *pair, *table('swap.csv', swapped, (0, 24), 18))
refuse('mm.csv: these are not the places of the rows of .*rK.mtx', *pair, *table('mm.csv', 1000 * x, (0, 24), 18))
front = np.r_[12:30, 0:12]  # modal rows first
moved = ['--matrices', save('fK.mtx', Kr[np.ix_(front, front)]), save('fM.mtx', Mr[np.ix_(front, front)])]
refuse('fK.mtx: modal coordinate [0-9]+ has no stiffness of its own: .*, or rows in another order than .*two.csv says', *moved, *base)
with open(folder + 'front.csv', 'w') as file:
    file.write('node,x,y,z,dofs\n101-118,,,,q\n1,%r,%r,%r,123456\n25,%r,%r,%r,123456\n' % (*map(float, x[0]), *map(float, x[24])))
run(*moved, '--nodes', folder + 'front.csv')
by_hand(body(), x[0], Kr, Mr, R, range(6), 24)
held = slice(6, None)
refuse('hK.mtx: moved as a rigid body it pulls at the ground, at node 25', '--matrices', save('hK.mtx', Kr[held, held]), save('hM.mtx', Mr[held, held]), *table('held.csv', x, (24,), 18))
one_way = Mr.copy()
one_way[0, 0] += 1
refuse('the mass is .* along x, y and z: it has to be the same', pair[0], pair[1], save('wM.mtx', one_way), *base)
bad = Mr.copy()
bad[13, 13] = -1
refuse('nM.mtx: modal coordinate 2 has the negative mass -1 .row 14.', pair[0], pair[1], save('nM.mtx', bad), *base)
bad = Kr.copy()
bad[15, 15] = 0
refuse('zK.mtx: modal coordinate 4 has no stiffness of its own', '--matrices', save('zK.mtx', bad), pair[2], *base)
rows = np.r_[0:3, 6:9, 12:30]
K4 = Kr[np.ix_(rows, rows)] - Kr[np.ix_(rows, [3, 4, 5, 9, 10, 11])] @ linalg.solve(Kr[np.ix_([3, 4, 5, 9, 10, 11], [3, 4, 5, 9, 10, 11])], Kr[np.ix_([3, 4, 5, 9, 10, 11], rows)])
refuse('line.csv: the interface nodes have no motion for some rotation of the body', '--matrices', save('lK.mtx', (K4 + K4.T) / 2), save('lM.mtx', Mr[np.ix_(rows, rows)]), *table('line.csv', x, (0, 24), 18, '123'))
refuse('dK.mtx: mode [0-9]+ would have the damping ratio -', *pair, save('dK.mtx', -C), *base)
for text, why in (('DMIG,KAAX,0,6,2,0\nDMIG,KAAX,1,1,,1,1,1.x\n', "bad.pch:2: DMIG KAAX: a number is wanted, not '1.x'"),
                  ('DMIG,KAAX,0,6,3,0\nDMIG,KAAX,1,1,,1,1,1.,2.\n,1,2,0.,1.\nDMIG,MAAX,0,6,1,0\nDMIG,MAAX,1,1,,1,2,1.\n', 'bad.pch:KAAX: complex: the real part is wanted'),
                  ('DMIG,KAAX,0,5,2,0\n', 'bad.pch:1: DMIG KAAX: form 5: 1 .square., 6 .symmetric., 2 or 9'),
                  ('DMIG,KAAX,1,1,,1,1,1.\n', 'bad.pch:1: DMIG KAAX: its header'),
                  ('DMIG,KAAX,0,6,2,0\nDMIG,KAAX,1,7,,1,1,1.\n', 'bad.pch:2: DMIG KAAX: a point from 1 and a component 0 to 6 are wanted, not 1, 7'),
                  ('DMIG,KAAX,0,1,2,0\nDMIG,KAAX,1,1,,1,1,1.\nDMIG,KAAX,1,1,,1,1,2.\n', 'bad.pch:3: the entry of node 1, degree of freedom 1 and node 1, degree of freedom 1 is there twice'),
                  ('DMIG,KAAX,0,6,2,0\nDMIG,MAAX,0,6,2,0\n', 'bad.pch:KAAX: 0 rows')):
    with open(folder + 'bad.pch', 'w') as file:
        file.write(text)
    refuse(why, '--matrices', folder + 'bad.pch', *base)
with open(folder + 'sub.mtx') as file:
    whole = file.read()
for old, new, why in (('*MATRIX,TYPE=MASS', '*MATRIX,TYPE=STIFFNESS', 'bad.mtx:.*: a second .MATRIX, TYPE=STIFFNESS'),
                      ('**          1,         25', '**          1', 'bad.mtx: .USER ELEMENT has 2 nodes, the remark .. ELEMENT NODES has 1'),
                      (whole[-40:], '', 'bad.mtx:.*: .MATRIX, TYPE=MASS: .* values, the 12 degrees of freedom of the nodes want 78: it is not whole'),
                      ('          1,          2,', '          1,          x,', "bad.mtx:6: degree of freedom: a whole number is wanted, not 'x'")):
    with open(folder + 'bad.mtx', 'w') as file:
        file.write(whole.replace(old, new))
    refuse(why, '--matrices', folder + 'bad.mtx', *base)
with open(folder + 'KAAX.matrix') as file:
    whole = file.read()
for old, new, why in (('RUA', 'CSA', "bad.matrix:3: of type 'CSA': RSA"), ('(3D25.16)', '(3Q25.16)', 'bad.matrix:4: a format of numbers'),
                      (whole[-400:], '', 'bad.matrix:2: .* lines of numbers are announced, the file has')):
    with open(folder + 'bad.matrix', 'w') as file:
        file.write(whole.replace(old, new))
    refuse(why, '--matrices', folder + 'bad.matrix', folder + 'MAAX.matrix', *base)
for row, why in (('5-3,,,,q', "bad.csv:3: node: at most 100000 modal coordinates, from the lower number to the higher, are wanted, not '5-3'"),
                 ('1,,,,q', 'bad.csv:3: node 1 is there twice'), ('101-118,0,0,0,x', "bad.csv:3: dofs: some of 123456 in this order .*, 0, or q")):
    with open(folder + 'bad.csv', 'w') as file:
        file.write('node,x,y,z,dofs\n1,0,0,0,123456\n%s\n' % row)
    refuse(why, *pair, '--nodes', folder + 'bad.csv')
worst['refusals'] = len(refused)
print(json.dumps({key: float('%.2g' % value) for key, value in worst.items()}))
