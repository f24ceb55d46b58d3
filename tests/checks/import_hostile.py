# import_hostile.py - files of others that are damaged: import_hostile.py FOLDER COUNT SEED, after tests/checks/import.py and
# import_reduced.py with FOLDER.
# COUNT files of every kind that import.py and elastodyn read, each damaged at random in one to three places: what comes is a
# description that flexbeam reads, or a refusal that names a file, a node or a mode. No traceback, within seconds.
import contextlib
import importlib
import io
import os
import random
import re
import resource
import signal
import subprocess
import sys

import numpy as np
import scipy.io
from pyNastran.op4.op4 import write_op4
from scipy import sparse

sys.path[:0] = ['examples/tools']
tool = importlib.import_module('import')
folder, count, seed = sys.argv[1] + '/', int(sys.argv[2]), int(sys.argv[3])
resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))

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
TOKENS = [b'nan', b'-1', b'1e400', b'0', b'99999999999', b'\xff\xfe', b',', b'\n', b'\0', b'"', b'%', b' ', b'inf', b'1e-320', b'2', b'-', b'*', b'\xe9', b'']


def damaged(data, draw):
    data = bytearray(data)
    for _ in range(draw.randint(1, 3)):
        at, n = draw.randrange(len(data) + 1), draw.choice((1, 1, 4, 8, 80, 800))
        how = draw.randrange(7)
        if how == 0 and at < len(data):
            data[at] ^= 1 << draw.randrange(8)
        elif how == 1:
            del data[at:at + n]
        elif how == 2:
            data[at:at] = data[at:at + n]
        elif how == 3:
            del data[at:len(data) if draw.random() < 0.3 else at + 1]
        elif how == 4:
            data[at:at] = draw.choice(TOKENS)
        elif how == 5:  # a number becomes another
            found = list(re.finditer(rb'[-+]?\d[\d.eE+-]*', bytes(data)))
            if found:
                span = draw.choice(found).span()
                data[span[0]:span[1]] = draw.choice(TOKENS)
        else:
            lines = bytes(data).split(b'\n')
            a, b = draw.randrange(len(lines)), draw.randrange(len(lines))
            lines[a], lines[b] = lines[b], lines[a]
            data = bytearray(b'\n'.join(lines))
    return bytes(data)


def late(*_):
    raise KeyboardInterrupt


def by_python(arguments):
    said = io.StringIO()
    with contextlib.redirect_stderr(said), contextlib.redirect_stdout(said):
        try:
            status = tool.main(arguments + ['--out', folder + 'h.txt'])
        except SystemExit as end:
            status = end.code
    if status == 0:
        done = subprocess.run([folder + 'integrals', folder + 'h.txt'], capture_output=True, text=True)
        return ('read', '') if done.returncode == 0 else ('a description that flexbeam does not read', said.getvalue() + done.stdout[-300:] + done.stderr)
    text = said.getvalue()
    named = re.search(r'import\.py: .*(\.(csv|mtx|npz|mat|op4|bdf|op2|pch|asm|matrix)\b|node \d|mode \d|--\w)', text)
    understood = 'not understood' not in text
    return ('refused' if status == 1 and named and understood else 'a refusal without file, node or mode, or %s' % status, text)


def by_elastodyn(name):
    done = subprocess.run(['build/flexbeam', 'elastodyn', name, '--length', '60'], capture_output=True)
    text = done.stderr.decode('latin-1')
    return ('read' if done.returncode == 0 else 'refused' if done.returncode == 2 and name in text else 'status %d' % done.returncode, text)


signal.signal(signal.SIGALRM, late)
kinds = [kind for kind, (_, weight) in RUNS.items() for _ in range(weight)]
tally = {'read': 0, 'refused': 0}
whole = {kind: open(folder + kind, 'rb').read() for kind in RUNS}
for kind, (arguments, _) in RUNS.items():
    end, text = by_python(list(arguments)) if arguments else by_elastodyn(folder + kind)
    if end != 'read':
        sys.exit('%s, as it was: %s: %s' % (kind, end, text))
for k in range(count):
    draw = random.Random(1000003 * seed + k)
    kind = kinds[k % len(kinds)]
    other = folder + 'damaged' + os.path.splitext(kind)[1]
    with open(other, 'wb') as file:
        file.write(damaged(whole[kind], draw))
    arguments = RUNS[kind][0]
    signal.alarm(20)
    try:
        end, text = by_python([a.replace(folder + kind, other) for a in arguments]) if arguments else by_elastodyn(other)
    except BaseException as error:
        end, text = '%s: %s' % (type(error).__name__, error), ''
    signal.alarm(0)
    if end not in tally:
        sys.exit('damaged %s, number %d of seed %d (%s): %s: %s' % (kind, k, seed, other, end, text))
    tally[end] += 1
print('%d damaged files: %d refused, %d read' % (count, tally['refused'], tally['read']))
