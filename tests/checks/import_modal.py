# import_modal.py - modal data without a mesh, flex and node files of 42, through examples/tools/import.py --modal: import_modal.py FOLDER, with
# FOLDER/integrals. Masses with shapes assembled here give M, K, C, P, H, L, N of modal coordinates that are not the natural ones. What flexbeam makes of the
# files has the integrals, spinning too, of the component with these masses, and the frequencies, damping and answer of [M_rr P; P^T M] in NumPy; without
# L and N it has those at rest. What is wrong is refused with file and line.
import json
import subprocess

import numpy as np
from scipy import linalg

from fem import folder, frequencies, integrals, meet, refuse, refused, run, worst

rng = np.random.default_rng(42)
n, count = 3, 9
x = rng.uniform(-1, 1, (count, 3)) + [0, 0, 1]
mass = rng.uniform(0.5, 2, count)
phi = rng.normal(size=(n, count, 3)) * 0.2
A = rng.normal(size=(n, n))
K = A @ A.T + 40 * np.eye(n)
M = np.einsum('k,mki,nki->mn', mass, phi, phi)
C = 0.004 * K + 0.01 * M  # of natural modes, too, a matrix with no coupling
P = np.einsum('k,mki->im', mass, phi)
H = np.einsum('k,mki->im', mass, np.cross(x, phi))
L = np.einsum('k,ki,mkj->ijm', mass, x, phi)
N = np.einsum('k,mki,nkj->ijmn', mass, phi, phi)
hub, hub_center, hub_J = 30.0, np.array([0.1, -0.2, 0.05]), np.array([[5.0, 0.3, -0.2], [0.3, 6.0, 0.1], [-0.2, 0.1, 7.0]])
whole = hub + mass.sum()
center = (hub * hub_center + mass @ x) / whole


def about(m, r, J, at):
    d = r - at
    return J + m * (d @ d * np.eye(3) - np.outer(d, d))


J = about(hub, hub_center, hub_J, center) + sum(about(m, r, np.zeros((3, 3)), center) for m, r in zip(mass, x))
body = ','.join('%.17g' % v for v in [whole, *center, J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2]])
places = np.array([[0.3, 0.2, 1.5], [-0.4, 0.1, 0.7]])
psi, theta = rng.normal(size=(n, 2, 3)), rng.normal(size=(n, 2, 3))


def elements(A):
    rows = [' '.join(map(str, index)) + ' %.17g  ! an element' % A[index] for index in np.ndindex(A.shape) if A[index]]
    return ['*** a heading ***', '%d   ! number' % len(rows), *rows]


def flex(joint=None, second=True, **other):
    data = dict(M=M, K=K, C=C, P=P, H=H, L=L, N=N, psi=psi, theta=theta) | other
    none = np.zeros(0)
    text = ['<<< flex >>>', 'of a test ! Description', '%d ! modes' % n, '*** initial ***', *['1e-3 0 ! mode'] * n, '*** joints ***', *elements(none if joint is None else joint),
            *elements(none), '*** nodes ***', *elements(data['psi']), *elements(data['theta']), *elements(data['M']), *elements(data['K']), '', *elements(data['C']),
            '*** P ***', *[' '.join('%.17g' % v for v in row) + ' ! P' for row in data['P'].T], '*** H ***',
            *[' '.join('%.17g' % v for v in row) + ' ! H' for row in data['H'].T], *elements(data['L'] if second else none), *elements(data['N'] if second else none), '[EOF]']
    with open(folder + 'flex.txt', 'w') as file:
        file.write('\n'.join(text) + '\n')
    return '--modal', folder + 'flex.txt', '--nodes', folder + 'nodes.txt', '--body', body


with open(folder + 'nodes.txt', 'w') as file:
    file.write('<<< nodes >>>\nof a test ! Description\n2 ! number\n*** places ***\n' + ''.join('%.17g %.17g %.17g "a thruster"\n' % tuple(r) for r in places))

# the natural modes, and the body with the same masses
square, shape = linalg.eigh(K, M)
text = run(*flex())
ratio = np.array(next(line for line in text.splitlines() if line.startswith('damping')).split()[1:], dtype=float)
meet('damping ratios', ratio, np.diag(shape.T @ C @ shape) / (2 * np.sqrt(square)), 1e-8)
meet('damping ratios of 0.004 K + 0.01 M', ratio, 0.002 * np.sqrt(square) + 0.005 / np.sqrt(square), 1e-8)
written = np.array([line.split()[3:] for line in text.splitlines() if line.startswith('shape') and line.split()[2] == '0'], dtype=float)
turn = np.diag(np.sign(np.sum(written * (np.hstack([psi[:, 0], theta[:, 0]]).T @ shape).T, axis=1)))
shape = shape @ turn  # the sign of a mode is free
meet('shapes at the nodes', written, (np.hstack([psi[:, 0], theta[:, 0]]).T @ shape).T, 1e-12)
own = ['component', 'modes %d' % n, 'frequency_hz ' + ' '.join('%.17g' % v for v in np.sqrt(square) / 2 / np.pi), 'effects spin damping', 'damping ' + ' '.join('%.17g' % v for v in ratio),
       'hub %.17g  %.17g %.17g %.17g  5 6 7 0.3 -0.2 0.1' % (hub, *hub_center)]
own += ['node %d %.17g %.17g %.17g %.17g' % (k + 10, *x[k], mass[k]) for k in range(count)] + ['node %d %.17g %.17g %.17g 0' % (k, *places[k]) for k in range(2)]
own += ['shape %d %d %.17g %.17g %.17g 0 0 0' % (m + 1, k + 10, *np.einsum('a,ai->i', shape[:, m], phi[:, k])) for m in range(n) for k in range(count)]
own += ['shape %d %d ' % (m + 1, k) + ' '.join('%.17g' % v for v in np.concatenate([shape[:, m] @ psi[:, k], shape[:, m] @ theta[:, k]])) for m in range(n) for k in range(2)]
own = '\n'.join(own + ['mark 0', 'mark 1']) + '\n'
have, want = integrals(), integrals(own)
for key in set(want) - {'limit'}:  # of deflections: by the size of what is written
    meet('the body with the same masses', have[key], want[key], 1e-9, size=max(abs(want[key]).max(), 1e-3))


def bodies(name, spin):
    with open(folder + name, 'w') as file:
        file.write(own)
    meet('frequencies at a spin', frequencies(folder + 'out.txt', '--modes', '12', '--spin', spin), frequencies(folder + name, '--modes', '12', '--spin', spin), 1e-6)


bodies('same.txt', '0')
bodies('same.txt', '0.3,0.5,0.9')


# at rest, with and without L and N, against the matrices
def skew(c):
    return np.array([[0, -c[2], c[1]], [c[2], 0, -c[0]], [-c[1], c[0], 0]])


rigid = np.block([[whole * np.eye(3), -whole * skew(center)], [whole * skew(center), J - whole * skew(center) @ skew(center)]])
all_M = np.block([[rigid, np.vstack([P, H])], [np.hstack([P.T, H.T]), M]])
all_K, all_C = (np.pad(A, ((6, 0), (6, 0))) for A in (K, C))
free = np.sqrt(linalg.eigh(K, M - np.vstack([P, H]).T @ np.linalg.solve(rigid, np.vstack([P, H])), eigvals_only=True))
for second in (True, False):
    text = run(*flex(second=second))
    if ('effects spin' if second else 'effects linear') not in text:
        raise SystemExit('effects of modal data: ' + text)
    undamped = text.replace(' damping\n', '\n').split('\n')
    with open(folder + 'rest.txt', 'w') as file:
        file.write('\n'.join(line for line in undamped if not line.startswith('damping')) + '\nbase free\n')
    meet('frequencies of the free body', np.sort(frequencies(folder + 'rest.txt', '--modes', '12'))[-n:], free, 1e-5)
    with open(folder + 'out.txt', 'a') as file:
        file.write('base free\n')
    subprocess.run(['build/flexbeam', 'analyse', folder + 'out.txt', '--linear', folder + 'm.json', '--inputs', 'force.0.x,torque.1.z', '--outputs', 'displacement.1.x,rate.0.y'],
                   check=True, capture_output=True)
    with open(folder + 'm.json') as file:
        line = json.load(file)
    matrices = [np.array(line[key], dtype=float) for key in 'ABCD']
    for w in (0.7, 5.0, 8.0):
        s = 1j * w
        answer = matrices[2] @ np.linalg.solve(s * np.eye(len(matrices[0])) - matrices[0], matrices[1]) + matrices[3]
        push = np.zeros((6 + n, 2))
        push[0, 0] = push[5, 1] = 1  # node 0 of analyse is the frame, node 1 the first of the file
        push[6:, 1] = theta[:, 0, 2]
        z = np.linalg.solve(s * s * all_M + s * all_C + all_K, push)
        want = np.vstack([psi[:, 0, 0] @ z[6:], s * z[4]])
        for k in range(2):
            meet('answers to force and torque', [answer[k].real, answer[k].imag], [want[k].real, want[k].imag], 1e-6)

# joints
bent = np.zeros((n, 4, 3))
bent[1, 3, 2] = 0.25
text = run(*flex(joint=bent), '--joint', '3:0.5,0.6,0.7', '--mark', '1003:arm')
if 'node 1003 0.5 0.6 0.7 0' not in text or 'mark 1003 arm' not in text or 'shape 1 1003 0 0 %s' % repr(0.25 * float(shape[1, 0]))[:8] not in text:
    raise SystemExit('joint: ' + text)
if 'shapes at joints 3 are not taken' not in run(*flex(joint=bent)):
    raise SystemExit('joint without a place')

refuse('flex.txt:16: an element of PSI: 4 numbers are wanted', *flex(psi=np.full((n, 2, 3), np.nan)))
refuse('PSI: node 0 to 1, not 2', *flex(psi=np.ones((n, 3, 3))))
refuse('the stiffness matrix is not symmetric', *flex(K=K + np.triu(A)))
refuse('indefinite stiffness', *flex(K=-K))
refuse('L is not that of H', *flex(H=2 * H))
refuse('N is not that of M', *flex(N=2 * N))
refuse('modes carry more than --body has', *flex()[:5], '1,0,0,0,1,1,1,0,0,0')
refuse('10 numbers with commas between, not', *flex()[:5], '1,0,0,nan,1,1,1,0,0,0')
refuse('10 numbers with commas between', *flex()[:5], '1,0,0,0,1,1,1')
refuse('has shapes at joints', *flex(), '--joint', '5:0,0,0')
refuse('go with it', *flex(), '--modes', '2')
refuse('--body and --joint are of --modal', 'a.bdf', 'b.op2', '--body', body)
with open(folder + 'flex.txt') as file:
    text = file.read()
with open(folder + 'flex.txt', 'w') as file:
    file.write(text[:len(text) // 2])
refuse('is wanted|are wanted', '--modal', folder + 'flex.txt', '--nodes', folder + 'nodes.txt', '--body', body)
print('modal data: %s; %d refused' % (', '.join('%s to %.1g' % pair for pair in sorted(worst.items())), len(refused)))
