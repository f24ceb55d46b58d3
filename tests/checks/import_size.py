# import_size.py OUT: large models through examples/tools/import.py. Time and memory per degree of freedom are bounded, the modes are those of
# SciPy's ARPACK, double ones too, and CHOLMOD and SuperLU give the same; on a terminal a line tells what is being done.
import itertools
import os
import pty
import re
import resource
import subprocess
import sys

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import eigsh

out = sys.argv[1]
TOOL = 'examples/tools/import.py'
WITHOUT = "import sys, runpy; sys.modules['sksparse'] = None; sys.path.insert(0, 'examples/tools'); sys.argv = sys.argv[1:]; runpy.run_path(sys.argv[0], run_name='__main__')"


def element(size):
    """Stiffness and mass of a brick of 8 nodes of aluminum, 2 x 2 x 2 points (T. J. R. Hughes, The Finite Element Method, 1987, 3.5)."""
    corner = np.array(list(itertools.product((-1, 1), repeat=3)))
    E, nu, rho = 70e9, 0.3, 2700.0
    D = np.diag([E / (1 + nu)] * 3 + [E / (2 + 2 * nu)] * 3)
    D[:3, :3] += E * nu / (1 + nu) / (1 - 2 * nu)
    K, M = np.zeros((24, 24)), np.zeros((8, 8))
    for s in corner / np.sqrt(3):
        part = 1 + corner * s
        N = part.prod(axis=1) / 8
        slope = np.stack([corner[:, k] * part[:, k - 1] * part[:, k - 2] / 8 * 2 / size[k] for k in range(3)])
        B = np.zeros((6, 24))
        for k in range(3):
            B[k, k::3] = slope[k]
            i, j = (k + 1) % 3, (k + 2) % 3
            B[3 + k, i::3], B[3 + k, j::3] = slope[j], slope[i]
        K += B.T @ D @ B * np.prod(size) / 8
        M += rho * np.outer(N, N) * np.prod(size) / 8
    return (K + K.T) / 2, np.kron(M, np.eye(3))


def mesh(name, count, size):
    """A block of bricks as files; K, M, which rows are held (x = 0), and the options that import it."""
    count, size = np.array(count), np.array(size, dtype=float)
    corner = np.array(list(itertools.product((0, 1), repeat=3)))
    nodes = np.ravel_multi_index((np.indices(count).reshape(3, -1).T[:, None] + corner).reshape(-1, 3).T, count + 1).reshape(-1, 8)
    x = np.indices(count + 1).reshape(3, -1).T * size / count
    rows = (3 * nodes[:, :, None] + np.arange(3)).reshape(-1, 24)
    place = np.repeat(rows, 24, axis=1).ravel(), np.tile(rows, (1, 24)).ravel()
    K, M = (sparse.csr_array(sparse.coo_array((np.tile(A.ravel(), len(rows)), place), shape=(3 * len(x),) * 2)) for A in element(size / count))
    K, M = (K + K.T) / 2, (M + M.T) / 2
    M.data[abs(M.data) < 1e-12 * M.data.max()] = 0
    M.eliminate_zeros()
    base = os.path.join(out, name)
    for A, kind in ((K, 'K'), (M, 'M')):
        sparse.save_npz('%s_%s.npz' % (base, kind), A, compressed=False)
    with open(base + '.csv', 'w') as file:
        file.write('node,x,y,z,dofs\n' + ''.join('%d,%r,%r,%r,123\n' % (k + 1, *map(float, p)) for k, p in enumerate(x)))
    held = int(np.sum(x[:, 0] == 0))
    return K, M, np.repeat(x[:, 0] == 0, 3), ['--matrices', base + '_K.npz', base + '_M.npz', '--nodes', base + '.csv', '--frame', '1-%d' % held,
                                             '--mark', '%d:tip' % len(x), '--out', base + '.txt']


def run(arguments, before=(TOOL,), **more):
    done = subprocess.run([sys.executable, *before, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **more)
    if done.returncode:
        sys.exit('%s: %s' % (' '.join(arguments), done.stderr))
    with open(arguments[-1]) as file:
        text = file.read()
    numbers = lambda word: np.array([[float(value) for value in line.split()[1:]] for line in text.splitlines() if line.startswith(word + ' ')])
    shape = numbers('shape')
    return numbers('frequency_hz')[0], shape[shape[:, 1] == numbers('node')[:, 0].min()][:, 2:5]


# double frequencies, against ARPACK and SuperLU
K, M, held, options = mesh('square', (24, 6, 6), (2, 0.1, 0.1))
free = np.flatnonzero(~held)
K, M = (sparse.csc_array(A[free][:, free]) for A in (K, M))
want = np.sqrt(np.sort(eigsh(K, 24, M, sigma=0, return_eigenvectors=False))) / (2 * np.pi)
have, _ = run(['--modes', '24'] + options)
worst = np.max(abs(have / want - 1))
if worst > 1e-9 or abs(have[1] / have[0] - 1) > 1e-9:
    sys.exit('square: frequencies %s, ARPACK has %s' % (have, want))

# one solver as the other
_, _, _, options = mesh('strip', (30, 12, 3), (1.3, 0.5, 0.04))
with_it, moves = run(['--modes', '24'] + options)
fallback, also = run(['--modes', '24'] + options, ('-c', WITHOUT, TOOL))
off = max(np.max(abs(with_it / fallback - 1)), np.max(abs(abs(moves) - abs(also))) / np.max(abs(also)))
if off > 1e-9:
    sys.exit('strip: CHOLMOD and SuperLU differ by %.2g' % off)

# a mechanism, and a matrix that is indefinite, by either
for name, change, say in (('loose', 0.0, 'singular|stiffness'), ('negative', -0.4, 'indefinite')):
    A = sparse.load_npz(os.path.join(out, 'strip_K.npz')).tolil()
    last = A.shape[0] - 3 + np.arange(3)
    if name == 'loose':
        A[last, :] = 0
        A[:, last] = 0
        A[last[0], last[0]] = 1e-9 * A.diagonal().max()
    else:
        A[last[0], last[0]] *= 0.3
    sparse.save_npz(os.path.join(out, 'bad_K.npz'), sparse.csr_array(A))
    for before in ((TOOL,), ('-c', WITHOUT, TOOL)):
        bad = [part.replace('strip_K', 'bad_K') for part in options]
        done = subprocess.run([sys.executable, *before, '--grounded', '--tolerance', '1', *bad], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        if done.returncode != 1 or 'Traceback' in done.stderr or not re.search(say + '|mass and no', done.stderr) or 'node' not in done.stderr:
            sys.exit('%s: %d %s' % (name, done.returncode, done.stderr))

# time and memory: half of the bounds; SuperLU takes 1360 us and 45 kB
K, M, held, options = mesh('block', (36, 22, 14), (1.6, 0.9, 0.5))
before = resource.getrusage(resource.RUSAGE_CHILDREN)
screen, terminal = pty.openpty()
child = subprocess.Popen([sys.executable, TOOL, '--modes', '24'] + options, stdout=subprocess.PIPE, stderr=terminal, text=True)
os.close(terminal)
shown = b''
try:
    while part := os.read(screen, 4096):
        shown += part
except OSError:  # its end, on Linux
    pass
printed = child.communicate()[0]
status, usage = child.returncode, resource.getrusage(resource.RUSAGE_CHILDREN)
seconds = usage.ru_utime + usage.ru_stime - before.ru_utime - before.ru_stime
n = K.shape[0]
each, memory = 1e6 * seconds / n, usage.ru_maxrss / n
if status:
    sys.exit('block: %s' % shown.decode())
stages = re.findall(r'([\d.]+) s  ([\d.]+) GB  ([^\r\x1b]*)', shown.decode())
if not all(any(stage.startswith(want) for _, _, stage in stages) for want in ('reading', 'checks', 'factor of', 'modes:', 'masses', 'writing')) or not shown.endswith(b'\r\x1b[K'):
    sys.exit('block: the line of progress: %r' % shown)
cholmod = subprocess.run([sys.executable, '-c', "import sys; sys.path.insert(0, 'examples/tools'); import large; sys.exit(not large.cholmod)"]).returncode == 0
if cholmod and (each > 500 or memory > 30):
    sys.exit('block: %.0f us and %.1f kB per degree of freedom, of 500 and 30 at most' % (each, memory))
if cholmod == ('scikit-sparse' in printed):
    sys.exit('block: %s' % printed)
print('large models by %s: ARPACK %.1g, SuperLU %.1g, %.0f us and %.1f kB per degree of freedom'
      % ('CHOLMOD' if cholmod else 'SuperLU, as scikit-sparse is not there', worst, off, each, memory))
