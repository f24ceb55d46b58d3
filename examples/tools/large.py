# large.py - what large models want of import.py: the factor of a symmetric matrix, by CHOLMOD where scikit-sparse is installed, else by
# SuperLU of SciPy, and a line of progress. [CDHR] Y. Chen, T. A. Davis, W. W. Hager, S. Rajamanickam, Algorithm 887: CHOLMOD, supernodal sparse
# Cholesky factorization and update/downdate, ACM Trans. Math. Software 35 (2008) 22.
import sys
import time

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

try:
    from sksparse import cholmod
    cholmod.analyze, cholmod.Factor.cholesky_inplace  # of versions below 0.5
except (ImportError, AttributeError):
    cholmod = None

SHIFTS = 0, 1e-12, 1e-10, 1e-8  # of the diagonal; a matrix that the last one does not make definite is indefinite by more than rounding
REFINED = 40  # corrections of a solution, at most


# ---- factors


def cholesky(A):
    """Solves with A, positive definite; and the row at which it is not, or None."""
    A = sparse.csc_matrix((A.data, A.indices, A.indptr), shape=A.shape)  # symmetric: its rows are its columns
    factor = cholmod.analyze(A, mode='supernodal', ordering_method='metis')
    try:
        factor.cholesky_inplace(A)
    except cholmod.CholmodNotPositiveDefiniteError as error:
        return None, int(factor.P()[error.column])
    return factor, None


def lower_upper(A):
    """As cholesky, by SuperLU: a pivot that is rounding counts as not positive. Those of a large factor are not looked at, as its U is a copy."""
    try:
        lu = splu(sparse.csc_array(A), permc_spec='MMD_AT_PLUS_A', diag_pivot_thresh=0.0, options={'SymmetricMode': True})
    except RuntimeError:  # exactly singular
        return None, 0
    if lu.nnz > 30000000 or not np.array_equal(lu.perm_r, lu.perm_c):
        return lu.solve, None
    pivot = lu.U.diagonal()[lu.perm_c] / A.diagonal()
    return lu.solve, int(pivot.argmin()) if pivot.min() < 1e-13 else None


def refined(A, solve, b):
    """A solution with A, or one for each column of b, by what solves with nearly A: corrections, while they fall. Where A is singular to rounding,
    as by shapes of elements that neither stiffness nor mass see, what b has of these makes corrections that do not fall."""
    x = d = solve(b)
    for _ in range(REFINED):
        last, d = abs(d).max(axis=0), solve(b - A @ x)
        if np.all(abs(d).max(axis=0) > 0.5 * last):
            break
        x = x + d
    return x


def factored(A):
    """Solves with A, symmetric, CSR, no eigenvalue of which is negative by more than rounding; else a row that it moves, or None."""
    factor, bad = cholesky if cholmod else lower_upper, None
    for shift in SHIFTS:
        B = sparse.csr_array(A + sparse.diags_array(shift * abs(A.diagonal()))) if shift else A
        try:
            solve, bad = factor(B)
        except cholmod.CholmodError if cholmod else ():
            factor = lower_upper  # CHOLMOD was built without METIS, or it is too large for its numbers or the memory
            solve, bad = factor(B)
        if bad is None:
            return (lambda b: refined(A, solve, b)) if shift else solve, None
    return None, bad


# ---- modes


def orthonormal(W, Q, M):
    """W beside Q, with W^T M W = 1 and Q^T M W = 0, without the columns that are dependent."""
    for _ in range(2):  # once leaves rounding of what was taken away
        W = W - Q @ (Q.T @ (M @ W))
        size, turn = np.linalg.eigh(W.T @ (M @ W))
        keep = size > 1e-20 * max(size[-1], 1e-300) if len(size) else []
        W = W @ (turn[:, keep] / np.sqrt(size[keep]))
    return W


def lowest(solve, M, count, progress):
    """The shapes of the lowest modes of K, with which it solves, and M: block Lanczos by K^-1 M, orthogonal to all before. A block of right-hand sides
    takes a quarter of the time of one after another. [GLS] R. G. Grimes, J. G. Lewis, H. D. Simon, SIAM J. Matrix Anal. Appl. 15 (1994) 228."""
    n, block = M.shape[0], 8
    Q, T, k = np.zeros((n, 3 * count + 4 * block), order='F'), np.zeros((3 * count + 4 * block,) * 2), 0
    W = orthonormal(solve(M @ np.random.default_rng(0).normal(size=(n, block))), Q[:, :0], M)
    while W.shape[1] > 0:
        block = W.shape[1]
        if k + block > Q.shape[1]:  # room for more
            Q, T = np.hstack([Q, np.zeros((n, Q.shape[1]))]), np.pad(T, (0, T.shape[0]))
        progress('modes: %d vectors' % k)
        Q[:, k:k + block] = W
        S = solve(M @ W)
        M_S = M @ S
        T[:k + block, k:k + block] = Q[:, :k + block].T @ M_S
        k += block
        W = orthonormal(S, Q[:, :k], M)
        if k >= count:
            theta, s = np.linalg.eigh(symmetric(T[:k, :k]))
            rest = np.linalg.norm((W.T @ M_S) @ s[k - block:, -count:], axis=0)
            if np.all(rest <= 1e-12 * theta[-count:] + 1e-15 * theta[-1]):
                break
        if k > 20 * count + 200:
            raise ValueError('%d Lanczos vectors do not hold them' % k)
    if k < count:
        raise ValueError('M has the rank %d' % k)
    return solve(M @ (Q[:, :k] @ s[:, :-count - 1:-1]))  # once more: less of the fast modes


def symmetric(T):
    """Of the upper triangle by blocks."""
    upper = np.triu(T)
    return upper + np.triu(upper, 1).T


# ---- progress


class Progress:
    """On a terminal one line: seconds, memory, what is being done."""

    def __init__(self, out=sys.stderr):
        self.out, self.start, self.last = out if out.isatty() else None, time.monotonic(), 0.0

    def __call__(self, stage, often=False):
        now = time.monotonic() - self.start
        if self.out and not (often and now < self.last + 0.2):
            self.last = now
            self.out.write('\r\x1b[K%6.1f s%s  %s' % (now, memory(), stage))
            self.out.flush()

    def clear(self):
        if self.out:
            self.out.write('\r\x1b[K')
            self.out.flush()


def memory():
    """The most that was used, where the system tells."""
    try:
        import resource
    except ImportError:  # Windows
        return ''
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return '  %.2f GB' % (most / (1e9 if sys.platform == 'darwin' else 1e6))
