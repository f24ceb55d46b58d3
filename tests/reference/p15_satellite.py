#!/usr/bin/env python3
# The satellite of examples/scenes/satellite.txt in hybrid coordinates after Likins (NASA SP-8016; JPL TR 32-1329): hub and
# tank rigid, of each appendage clamped modes in closed form. For p15_satellite.csv: python3 p15_satellite.py > p15_satellite.csv
# Frequencies of the free satellite by NumPy, damped ones; a pulse of torque by the exponential of the state; margins by python-control, the
# controller as matrices written down here, and the singular values of the return difference by NumPy.
import control
import numpy as np
from scipy import linalg, optimize

from p13_margins import crossings

POINTS, WEIGHTS = np.polynomial.legendre.leggauss(400)


def turn(axis, angle):
    """Rotation about a coordinate axis."""
    c, s = np.cos(angle), np.sin(angle)
    i, j = {'x': (1, 2), 'y': (2, 0), 'z': (0, 1)}[axis]
    R = np.eye(3)
    R[i, i] = R[j, j] = c
    R[i, j], R[j, i] = -s, s
    return R


def skew(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


class Cantilever:
    """A clamped uniform beam with a rigid tip in closed form, w = A (cosh - cos) + B (sinh - sin), modal mass 1."""

    def __init__(self, length, mass, EI, count, tip_mass=0.0, tip_inertia=0.0):
        L = length

        def ends(b):
            # EI w'' = w^2 J w', EI w''' = -w^2 m w at the tip, of A and B; b^4 = w^2 mass/EI
            x = b * L
            q, p = tip_mass * b / mass, tip_inertia * b ** 3 / mass
            ch, sh, c, s = np.cosh(x), np.sinh(x), np.cos(x), np.sin(x)
            return np.array([[ch + c - p * (sh + s), sh + s - p * (ch - c)],
                             [sh - s + q * (ch - c), ch + c + q * (sh - s)]]) / np.cosh(x)

        grid = np.linspace(0.2, (count + 1) * np.pi, 4000) / L
        value = [np.linalg.det(ends(b)) for b in grid]
        roots = [optimize.brentq(lambda b: np.linalg.det(ends(b)), grid[k], grid[k + 1], xtol=1e-15, rtol=1e-15)
                 for k in range(len(grid) - 1) if value[k] * value[k + 1] < 0][:count]
        self.omega = [b * b * np.sqrt(EI / mass) for b in roots]
        self.x = 0.5 * L * (POINTS + 1)
        self.dm = 0.5 * L * WEIGHTS * mass
        self.w, self.tip, self.slope = [], [], []
        for b in roots:
            M = ends(b)
            A, B = M[0, 1], -M[0, 0]

            def shape(x):
                return A * (np.cosh(b * x) - np.cos(b * x)) + B * (np.sinh(b * x) - np.sin(b * x))

            w = shape(self.x)
            tip = shape(L)
            slope = b * (A * (np.sinh(b * L) + np.sin(b * L)) + B * (np.cosh(b * L) - np.cos(b * L)))
            size = np.sqrt(self.dm @ w ** 2 + tip_mass * tip ** 2 + tip_inertia * slope ** 2)
            size *= np.sign(tip)
            self.w.append(w / size)
            self.tip.append(tip / size)
            self.slope.append(slope / size)


# coordinates: velocity and rate of the hub, two drives, four modes of each array, two of the mast, two of the tank
N = 20
LEFT, RIGHT, MAST, SLOSH = 8, 12, 16, 18


class Satellite:
    def __init__(self, drive):
        self.M, self.K, self.C = np.zeros((N, N)), np.zeros((N, N)), np.zeros((N, N))
        self.rigid(900, [0.12, -0.05, 0.3], [[420, 15, -22], [15, 380, 9], [-22, 9, 350]])
        self.array(np.array([0.1, 0.9, 0]), turn('z', np.pi / 2) @ turn('x', drive), 6, LEFT)
        self.tips = [self.tip]
        self.array(np.array([0.1, -0.9, 0]), turn('z', -np.pi / 2) @ turn('x', -drive), 7, RIGHT)
        self.mast()
        self.tank()

    def add(self, mass, J, inertia=None, T=None):
        """A particle or a rigid body: its mass, the Jacobian of its velocity, inertia and Jacobian of its rate."""
        self.M += mass * J.T @ J
        if inertia is not None:
            self.M += T.T @ inertia @ T

    def at(self, r):
        """Jacobian of the velocity of a point of the hub."""
        J = np.zeros((3, N))
        J[:, :3], J[:, 3:6] = np.eye(3), -skew(r)
        return J

    def rate(self):
        T = np.zeros((3, N))
        T[:, 3:6] = np.eye(3)
        return T

    def rigid(self, mass, center, inertia):
        self.add(mass, self.at(np.array(center)), np.array(inertia, float), self.rate())

    def array(self, root, R, drive, first):
        """Along its own x from the root; the drive turns it about x."""
        axis = R[:, 0]
        T = self.rate()
        T[:, drive] = axis
        self.add(6, self.at(root), R @ np.diag([1.5, 0.8, 0.8]) @ R.T, T)
        modes = [(Cantilever(7, 4, EI, 2), R[:, k]) for EI, k in ((60000, 1), (2400, 2))]
        for point, dm in zip(range(len(POINTS)), modes[0][0].dm):
            J = self.at(root + axis * modes[0][0].x[point])
            for k, (beam, along) in enumerate(modes):
                for i in range(2):
                    J[:, first + 2 * k + i] = along * beam.w[i][point]
            self.add(dm, J)
        for k, (beam, _) in enumerate(modes):
            for i in range(2):
                self.spring(first + 2 * k + i, beam.omega[i] ** 2, 2 * 0.005 * beam.omega[i])
        self.spring(drive, 1500, 4)
        self.tip = np.zeros(N)
        self.tip[first + 2:first + 4] = modes[1][0].tip

    def mast(self):
        R = turn('y', -np.pi / 2)
        beam = Cantilever(3, 1.2, 5500, 1, 4, 0.05)
        root = np.array([0.1, 0.2, 0.9])
        for point, dm in enumerate(beam.dm):
            J = self.at(root + R[:, 0] * beam.x[point])
            J[:, MAST], J[:, MAST + 1] = R[:, 1] * beam.w[0][point], R[:, 2] * beam.w[0][point]
            self.add(dm, J)
        J, T = self.at(root + 3 * R[:, 0]), self.rate()
        J[:, MAST], J[:, MAST + 1] = R[:, 1] * beam.tip[0], R[:, 2] * beam.tip[0]
        T[:, MAST], T[:, MAST + 1] = R[:, 2] * beam.slope[0], -R[:, 1] * beam.slope[0]
        self.add(4, J, R @ np.diag([0.02, 0.05, 0.05]) @ R.T, T)
        self.tracker = T
        for k in (MAST, MAST + 1):
            self.spring(k, beam.omega[0] ** 2, 2 * 0.004 * beam.omega[0])

    def tank(self):
        T = self.rate()
        T[1, SLOSH] = T[0, SLOSH + 1] = 1
        J = self.at(np.array([-0.2, 0.1, -0.4])) - skew([0, 0, -0.35]) @ T
        self.add(60, J, 0.5 * np.eye(3), T)
        self.spring(SLOSH, 2.8, 0.1)
        self.spring(SLOSH + 1, 2.8, 0.1)

    def spring(self, k, stiffness, damping):
        self.K[k, k] += stiffness
        self.C[k, k] += damping

    def frequencies(self):
        A, _, _ = self.state()
        poles = np.linalg.eigvals(A)
        poles = poles[poles.imag > 0.1]
        return poles.imag[np.argsort(abs(poles))]  # [rad/s], damped

    def state(self):
        """Turn of the hub and all but its place and velocity: x = (turn, q, rates), by a torque on the hub."""
        keep = list(range(3, N))
        inverse = np.linalg.inv(self.M)
        n = len(keep)
        A = np.zeros((2 * n, 2 * n))
        A[:n, n:] = np.eye(n)
        A[n:, :n] = -(inverse @ self.K)[np.ix_(keep, keep)]
        A[n:, n:] = -(inverse @ self.C)[np.ix_(keep, keep)]
        B = np.zeros((2 * n, 3))
        B[n:] = inverse[np.ix_(keep, range(3, 6))]
        return A, B, n


def hold(A, B, t):
    n, m = B.shape
    E = np.zeros((n + m, n + m))
    E[:n, :n], E[:n, n:] = A, B
    E = linalg.expm(E * t)
    return E[:n, :n], E[:n, n:]


def pulse(satellite, T, times):
    """1 N m about each axis from 1 s to 3 s: deflection out of plane of the left tip, rate of the hub about x."""
    A, B, n = satellite.state()
    x = np.zeros(2 * n)
    out = []
    for k in range(int(round(max(times) / T))):
        F, G = hold(A, B, T) if k == 0 else (F, G)
        x = F @ x + (G @ np.ones(3) if 1 <= (k + 0.5) * T < 3 else 0)
        out.append([satellite.tips[0][3:] @ x[:n], x[n]])
    return [out[int(round(t / T)) - 1] for t in times]


def lowpass(hz, zeta, T):
    """Bilinear and exact at hz, as a system of one signal."""
    w = 2 * np.pi * hz
    s = control.tf([w * w], [1, 2 * zeta * w, w * w])
    return control.ss(control.sample_system(s, T, method='bilinear', prewarp_frequency=w))


def loops(satellite):
    """From a command (torque on the hub) to what the controller makes of it, broken at the commands of both controllers."""
    T, delay = 0.1, 0.05
    A, B, n = satellite.state()
    # the wheels: torque on the hub by their motors, -1 times gains and axes; momentum of each [rad/s]
    axes = np.array([[0.8, 0, 0.6], [0, 0.8, 0.6], [-0.8, 0, 0.6], [0, -0.8, 0.6]]).T
    gains = -np.linalg.pinv(axes)
    inertia = 0.06
    order = 2 * n + 4
    full, into = np.zeros((order, order)), np.zeros((order, 6))
    full[:2 * n, :2 * n] = A
    into[:2 * n, :3] = -B @ axes @ gains
    into[:2 * n, 3:] = B
    # relative speed of a wheel: motor torque over inertia less the rate of the hub along its axis
    full[2 * n:, :2 * n] = -axes.T @ A[n:n + 3]
    into[2 * n:] = -axes.T @ into[n:n + 3]
    into[2 * n:, :3] += gains / inertia
    # one sample: wheels half a sample late, thrusters at once
    F, whole = hold(full, into, T)
    rest, early = hold(full, into, T - delay)[0], hold(full, into, delay)[1]
    _, late = hold(full, into, T - delay)
    F_part = hold(full, into, delay)[0]
    before, after = F_part @ late[:, :3], early[:, :3]
    # state: plant, last command to the wheels
    size = order + 3
    P = np.zeros((size, size))
    P[:order, :order] = F
    P[:order, order:] = before
    Q = np.zeros((size, 6))
    Q[:order, :3], Q[:order, 3:] = after, whole[:, 3:]
    Q[order:, :3] = np.eye(3)
    see = np.zeros((6 + 4, size))
    see[:3, :n] = satellite.tracker[:, 3:]
    see[3:6, n:n + 3] = np.eye(3)
    see[6:, 2 * n:order] = np.eye(4)
    plant = control.ss(P, Q, see, 0, T)
    law = np.hstack([np.diag([38.0, 12, 36]), np.diag([360.0, 110, 340]), np.zeros((3, 4))])
    unload = 0.02 * inertia * axes
    gain = np.vstack([law, np.hstack([np.zeros((3, 6)), unload])])
    filters = control.append(*([lowpass(1.5, 0.7, T)] * 3 + [control.ss([], [], [], 1, T)] * 3))
    return filters * control.ss([], [], [], gain, T) * plant, T


def opened(L, commands):
    """The loop broken at these commands alone, with all others closed by the feedback -1."""
    others = [k for k in range(6) if k not in commands]
    A, B, C = L.A, L.B, L.C
    closed = A - B[:, others] @ C[others]
    return control.ss(closed, B[:, commands], C[commands], 0, L.dt)


def margins(L, k):
    one = opened(L, [k])
    return crossings(lambda w: complex(one(np.exp(1j * w * L.dt))), L.dt)


def difference(L, commands):
    """The least singular value of 1 + L over frequency, and where."""
    some = opened(L, commands)
    n, T = len(commands), L.dt

    def least(w):
        z = np.exp(1j * w * T)
        return np.linalg.svd(np.eye(n) + some.C @ np.linalg.solve(z * np.eye(len(some.A)) - some.A, some.B))[1][-1]

    grid = np.unique(np.concatenate([np.logspace(-3, np.log10(np.pi / T), 3000)] +
                                    [np.abs(np.angle(p)) / T * (1 + np.linspace(-0.02, 0.02, 161))
                                     for p in np.linalg.eigvals(some.A)]))
    grid = grid[(grid > 1e-3) & (grid < np.pi / T)]
    value = [least(w) for w in grid]
    k = int(np.argmin(value))
    best = optimize.minimize_scalar(least, bounds=(grid[max(k - 1, 0)], grid[min(k + 1, len(grid) - 1)]),
                                    method='bounded', options={'xatol': 1e-12})
    return min(best.fun, value[k]), best.x


def main():
    print('# examples/scenes/satellite.txt in hybrid coordinates, by tests/reference/p15_satellite.py (NumPy, python-control)')
    print('case,values')
    for drive in (0, 0.7):
        satellite = Satellite(drive)
        print('frequencies_%g,%s' % (drive, ','.join('%.12g' % w for w in satellite.frequencies())))
        for t, (tip, rate) in zip((2, 3.6, 8, 20), pulse(satellite, 0.1, (2, 3.6, 8, 20))):
            print('pulse_%g_%gs,%.12g,%.12g' % (drive, t, tip, rate))
        L, _ = loops(satellite)
        for k in range(6):
            print('margins_%g_%s.%d,%s' % (drive, ('pointing', 'unload')[k // 3], k % 3 + 1,
                                           ','.join('%.12g' % x for x in margins(L, k))))
        for name, commands in ('pointing', [0, 1, 2]), ('unload', [3, 4, 5]):
            print('difference_%g_%s,%.12g,%.12g' % ((drive, name) + difference(L, commands)))


if __name__ == '__main__':
    main()
