# import_hostile.py - files of others that are damaged: import_hostile.py FOLDER COUNT SEED, after tests/checks/import.py and
# import_reduced.py with FOLDER.
# COUNT files of every kind that import.py and elastodyn read, each damaged at random in one to three places: what comes is a
# description that flexbeam reads, or a refusal that names a file, a node or a mode. No traceback, within seconds.
import os
import random
import subprocess
import sys

import numpy as np
import scipy.io
from pyNastran.op4.op4 import write_op4
from scipy import sparse

sys.path[:0] = ['tests/checks']
from import_damage import damaged, end_of

folder, count, seed = sys.argv[1] + '/', int(sys.argv[2]), int(sys.argv[3])

# six nodes, each joined to all others by a rod
x = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.3, 0.2, 1], [1.2, 0.9, 1.1], [0.4, 1.3, 2]])
K = np.zeros((18, 18))
for a in range(6):
    for b in range(a):
        e = (x[b] - x[a]) / np.linalg.norm(x[b] - x[a])
        rows = [3 * a, 3 * a + 1, 3 * a + 2, 3 * b, 3 * b + 1, 3 * b + 2]
        K[np.ix_(rows, rows)] += np.kron([[1, -1], [-1, 1]], 1e6 * np.outer(e, e))
M = np.kron(np.diag([1.0, 2, 3, 4, 5, 6]), np.eye(3))
for name, A in (('hK', K), ('hM', M)):
    scipy.io.mmwrite(folder + name + '.mtx', sparse.coo_matrix(A), precision=17, symmetry='general')
    sparse.save_npz(folder + name + '.npz', sparse.csr_array(A))
scipy.io.savemat(folder + 'h.mat', {'K': K, 'M': M})
write_op4(folder + 'h.op4', {'K': (2, K), 'M': (2, M)}, name_order=['K', 'M'], precision='double', is_binary=False)
with open(folder + 'h.csv', 'w') as file:
    file.write('node,x,y,z,dofs\n' + ''.join('%d,%r,%r,%r,123\n' % (k + 1, *map(float, r)) for k, r in enumerate(x)))

table = ['--nodes', folder + 'h.csv', '--frame', '1-3', '--modes', '3']
boom = ['--scale', '0.001,1000', '--frame', '1', '--mark', '25:tip']
RUNS = {  # what is damaged, and the arguments; kinds that libraries read may end in what they say
    'h.csv': (['--matrices', folder + 'hK.mtx', folder + 'hM.mtx', *table], 4),
    'hK.mtx': (['--matrices', folder + 'hK.mtx', folder + 'hM.mtx', *table], 4),
    'hM.npz': (['--matrices', folder + 'hK.npz', folder + 'hM.npz', *table], 2),
    'h.mat': (['--matrices', folder + 'h.mat:K', folder + 'h.mat:M', *table], 2),
    'h.op4': (['--matrices', folder + 'h.op4:K', folder + 'h.op4:M', *table], 2),
    'boom.bdf': ([folder + 'boom.bdf', folder + 'boom.op2', *boom], 3),
    'boom.op2': ([folder + 'boom.bdf', folder + 'boom.op2', *boom], 3),
    'MGG.op4': ([folder + 'boom.bdf', folder + 'full.op2', *boom, '--mass', folder + 'MGG.op4'], 1),
    'two.csv': (['--matrices', folder + 'r.mat', '--nodes', folder + 'two.csv'], 3),
    'grids.pch': (['--matrices', folder + 'grids.pch'], 6),
    'asm.asm': (['--matrices', folder + 'local.op4', '--nodes', folder + 'asm.asm'], 2),
    'sub.mtx': (['--matrices', folder + 'sub.mtx', '--nodes', folder + 'two.csv'], 5),
    'KAAX1.mtx': (['--matrices', folder + 'KAAX1.mtx', folder + 'MAAX1.mtx', '--nodes', folder + 'two.csv'], 3),
    'KAAX.matrix': (['--matrices', folder + 'KAAX.matrix', folder + 'MAAX.matrix', '--nodes', folder + 'two.csv'], 5),
    'blade.dat': (None, 6)}


def by_elastodyn(name):
    done = subprocess.run(['build/flexbeam', 'elastodyn', name, '--length', '60'], capture_output=True)
    text = done.stderr.decode('latin-1')
    return ('read' if done.returncode == 0 else 'refused' if done.returncode == 2 and name in text else 'status %d' % done.returncode, text)


kinds = [kind for kind, (_, weight) in RUNS.items() for _ in range(weight)]
tally = {'read': 0, 'refused': 0}
whole = {kind: open(folder + kind, 'rb').read() for kind in RUNS}
for kind, (arguments, _) in RUNS.items():
    end, text = end_of(list(arguments), 20) if arguments else by_elastodyn(folder + kind)
    if end != 'read':
        sys.exit('%s, as it was: %s: %s' % (kind, end, text))
for k in range(count):
    draw = random.Random(1000003 * seed + k)
    kind = kinds[k % len(kinds)]
    other = folder + 'damaged' + os.path.splitext(kind)[1]
    with open(other, 'wb') as file:
        file.write(damaged(whole[kind], draw))
    arguments = RUNS[kind][0]
    end, text = end_of([a.replace(folder + kind, other) for a in arguments], 20) if arguments else by_elastodyn(other)
    if end not in tally:
        sys.exit('damaged %s, number %d of seed %d (%s): %s: %s' % (kind, k, seed, other, end, text))
    tally[end] += 1
print('%d damaged files: %d refused, %d read' % (count, tally['refused'], tally['read']))
