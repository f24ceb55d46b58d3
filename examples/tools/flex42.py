# flex42.py - modal data of a body without a mesh, as 42 has them; for import.py. 42 is NASA's simulation of spacecraft,
# https://github.com/ericstoneking/42: a flex file (InOut/Flex_Simple.txt, read by InitFlexModes of Source/42init.c) has M, K and C
# of the modes, their momenta P and H, their shapes at nodes, and, or not, the integrals L and N of second order; a node file
# (InOut/Nodes_Simple.txt, InitNodes) the places of the nodes. Modes, nodes, joints and axes count from 0.
import numpy as np

from matrix_files import Refused


class Lines:
    """The lines that are not blank, one after the other; what stands behind the numbers of a line is a comment."""

    def __init__(self, path):
        self.path = path
        with open(path, encoding='utf-8', errors='surrogateescape') as file:
            self.rest = [(k, line.strip()) for k, line in enumerate(file, 1) if line.strip()]
        self.at = 0

    def line(self, what):
        if not self.rest:
            raise Refused('%s: ends where %s is wanted' % (self.path, what))
        self.at, text = self.rest.pop(0)
        return text

    def refuse(self, why):
        raise Refused('%s:%d: %s' % (self.path, self.at, why))

    def numbers(self, what, kinds):
        words = self.line(what).split('!')[0].split()
        try:
            out = [kind(word) for kind, word in zip(kinds, words, strict=False)]
        except ValueError:
            out = []
        if len(out) < len(kinds) or not np.all(np.isfinite(np.array(out, dtype=float))):
            self.refuse('%s: %d numbers are wanted, not %r' % (what, len(kinds), ' '.join(words)))
        return out

    def count(self, what, most):
        n, = self.numbers('number of ' + what, [int])
        if not 0 <= n <= most:
            self.refuse('number of %s: 0 to %d, not %d' % (what, most, n))
        return n

    def elements(self, what, shape, names):
        """An array from its elements that are not zero; None: it has none."""
        self.line('the heading of ' + what)
        n = self.count('elements of ' + what, 10**6)
        out = np.zeros(shape)
        there = set()
        for _ in range(n):
            *index, value = self.numbers('an element of ' + what, [int] * len(shape) + [float])
            for k, size, name in zip(index, shape, names):
                if not 0 <= k < size:
                    self.refuse('%s: %s 0 to %d, not %d' % (what, name, size - 1, k))
            if tuple(index) in there:
                self.refuse('%s: element %s is there twice' % (what, ' '.join(map(str, index))))
            there.add(tuple(index))
            out[tuple(index)] = value
        return out if n else None


class Flex:
    """M, K, C; P, H (3 x modes); L (3 x 3 x modes), N (3 x 3 x modes x modes), None where the file has no elements; psi, theta of the nodes and of the joints
    (modes x nodes x 3); start: modal coordinates and speeds."""

    def __init__(self, path, most_modes, n_node):
        t = Lines(path)
        t.line('a heading')
        t.line('the description')
        self.n = n = t.count('modes', most_modes)
        if n == 0:
            t.refuse('number of modes: 1 at least')
        t.line('the heading of the initial modal states')
        self.start = np.array([t.numbers('the initial state of mode %d' % k, [float] * 2) for k in range(n)])
        names = 'mode', 'node', 'axis'
        t.line('the heading of the joint nodes')
        self.joint_psi = t.elements('PSI of joints', (n, 1000, 3), ('mode', 'joint', 'axis'))
        self.joint_theta = t.elements('THETA of joints', (n, 1000, 3), ('mode', 'joint', 'axis'))
        t.line('the heading of the analysis nodes')
        self.psi = t.elements('PSI', (n, n_node, 3), names)
        self.theta = t.elements('THETA', (n, n_node, 3), names)
        self.M, self.K, self.C = (t.elements(what, (n, n), ('row', 'column')) for what in ('the mass matrix', 'the stiffness matrix', 'the damping matrix'))
        for name in ('M', 'K'):
            A = getattr(self, name)
            if A is None or abs(A - A.T).max() > 1e-9 * abs(A).max():
                raise Refused('%s: the %s matrix is not symmetric, or zero' % (path, 'mass' if name == 'M' else 'stiffness'))
        t.line('the heading of P')
        self.P = np.array([t.numbers('P of mode %d' % k, [float] * 3) for k in range(n)]).T
        t.line('the heading of H')
        self.H = np.array([t.numbers('H of mode %d' % k, [float] * 3) for k in range(n)]).T
        self.L = t.elements('L', (3, 3, n), ('row', 'column', 'mode'))
        self.N = t.elements('N', (3, 3, n, n), ('row', 'column', 'mode', 'mode'))

    def shapes(self, kind, k):
        """The shapes at node k, 6 x modes."""
        parts = [getattr(self, kind + name) for name in ('psi', 'theta')]
        return np.vstack([np.zeros((3, self.n)) if part is None else part[:, k].T for part in parts])

    def joints(self):
        """Numbers of the joints that have shapes."""
        parts = [part for part in (self.joint_psi, self.joint_theta) if part is not None]
        return sorted({int(k) for part in parts for k in np.nonzero(part)[1]})

    def second(self, path):
        """Integrals of products of r and psi, (3 modes) x 3: r_i psi_j, and of psi and psi: what L and N say, against H and M; None without both."""
        if self.L is None or self.N is None:
            return None
        n = self.n
        cross = np.array([self.L[1, 2] - self.L[2, 1], self.L[2, 0] - self.L[0, 2], self.L[0, 1] - self.L[1, 0]])
        size = max(abs(self.H).max(), abs(cross).max())
        if abs(cross - self.H).max() > 1e-6 * size:
            raise Refused('%s: L is not that of H: integrals of r_i psi_j give %s, H of the first mode is %s' % (path, cross[:, 0], self.H[:, 0]))
        trace = sum(self.N[i, i] for i in range(3))
        if abs(trace - self.M).max() > 1e-6 * abs(self.M).max():
            raise Refused('%s: N is not that of M: the sum of its diagonal for modes 0 and 0 is %g, M is %g' % (path, trace[0, 0], self.M[0, 0]))
        N = self.N.transpose(2, 0, 3, 1).reshape(3 * n, 3 * n)
        if abs(N - N.T).max() > 1e-9 * abs(N).max():
            raise Refused('%s: N is not symmetric: element a b m n is to be b a n m' % path)
        return self.L.transpose(0, 2, 1).reshape(3, 3 * n), N


def nodes(path):
    """Places and comments of a node file."""
    t = Lines(path)
    t.line('a heading')
    t.line('the description')
    n = t.count('nodes', 4000)
    t.line('the heading of the places')
    rows = []
    for k in range(n):
        rows.append(t.numbers('the place of node %d' % k, [float] * 3))
    return np.array(rows).reshape(-1, 3)
