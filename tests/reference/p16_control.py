#!/usr/bin/env python3
# Controllers of several signals, by python-control and SciPy, for p16_control.csv: python3 p16_control.py > p16_control.csv
# lqg: two disks on a shaft, a torque on the first one, the angle of each seen; the gains of a Kalman filter and of a regulator
# by control.dlqe and dlqr, its table [A B; C D] in examples/scenes/lqg_control.csv (written with the argument --table).
# attitude: a rigid body turned by the law of a quaternion, every sample by scipy.integrate.solve_ivp at 1e-12.
# loops: its loops about that start, far from what is wanted, by differences of the same law.
import sys

import control
import numpy as np
from scipy import integrate, linalg, optimize
from scipy.spatial.transform import Rotation

from p13_margins import crossings

T = 0.01


def shaft():
    """Disks of 100 and 20 kg m^2, 8000 N m/rad and 4 N m s/rad between them, held over a sample; both angles."""
    A = np.zeros((4, 4))
    A[:2, 2:] = np.eye(2)
    A[2] = np.array([-8000, 8000, -4, 4]) / 100
    A[3] = np.array([8000, -8000, 4, -4]) / 20
    E = linalg.expm(np.block([[A, np.array([[0], [0], [0.01], [0]])], [np.zeros((1, 5))]]) * T)
    return E[:4, :4], E[:4, 4:], np.eye(2, 4)


def lqg():
    """Of v = r - y the compensator z+ = (F - G K - L C) z - L v, u = -K z: x is guessed by z, which follows y."""
    F, G, C = shaft()
    K = control.dlqr(F, G, np.diag([4e5, 4e5, 1e3, 1e3]), np.array([[1.0]]))[0]
    L = control.dlqe(F, G, C, np.array([[1.0]]), np.diag([1e-9, 4e-9]))[0]
    L = np.asarray(L)
    return F, G, C, np.asarray(K), L, np.block([[F - G @ K - L @ C, -L], [-K, np.zeros((1, 2))]])


def closed_lqg():
    F, G, C, K, L, table = lqg()
    A, B, Cc = table[:4, :4], table[:4, 4:], table[4:, :4]

    def response(w):
        z = np.exp(1j * w * T)
        y = C @ np.linalg.solve(z * np.eye(4) - F, G)
        return (Cc @ np.linalg.solve(z * np.eye(4) - A, B @ y)).item()

    closed = np.block([[F, G @ Cc], [-B @ C, A]])
    x, z = np.array([0.1, 0.12, 0, 0]), np.zeros(4)
    for _ in range(300):
        u = Cc @ z
        x, z = F @ x + G @ u, A @ z + B @ (-C @ x)
    return crossings(response, T) + (max(abs(np.linalg.eigvals(closed))), x[0], x[1])


def attitude(P, D, ki):
    """J = tensor of the scene's body, sample 0.1 s; wanted z 50 x -30, then a turn of 0.6 rad about y of its own from 0 to 8 s."""
    J = np.array([[3, 0.2, -0.4], [0.2, 4, 0.3], [-0.4, 0.3, 5]])
    inverse, sample = np.linalg.inv(J), 0.1
    q, w, s, last = Rotation.from_euler('XYZ', [70, -40, 200], degrees=True), np.array([0.1, -0.05, 0.08]), 0, None
    fixed = Rotation.from_euler('ZX', [50, -30], degrees=True)

    def rates(_, x, u):
        a, b, c, d, w = x[0], x[1], x[2], x[3], x[4:]
        spin = 0.5 * np.array([-b * w[0] - c * w[1] - d * w[2], a * w[0] + c * w[2] - d * w[1],
                               a * w[1] + d * w[0] - b * w[2], a * w[2] + b * w[1] - c * w[0]])
        return np.concatenate([spin, inverse @ (u - np.cross(w, J @ w))])

    for k in range(120):
        t = k * sample
        part = min(t / 8, 1)
        angle = 0.6 * (part - np.sin(2 * np.pi * part) / (2 * np.pi))
        rate = 0.6 * (1 - np.cos(2 * np.pi * part)) / 8 if t < 8 else 0
        off = q.inv() * fixed * Rotation.from_rotvec([0, angle, 0])
        e = off.as_quat(canonical=True)[:3] * 2
        r = off.apply([0, rate, 0]) - w
        s = s + sample / 2 * (e + (0 if last is None else last))
        last = e
        u = P @ e + ki * s + D @ r
        x = np.concatenate([np.roll(q.as_quat(), 1), w])
        x = integrate.solve_ivp(rates, (0, sample), x, 'DOP853', args=(u,), rtol=1e-12, atol=1e-14).y[:, -1]
        q, w = Rotation.from_quat(np.roll(x[:4], -1)), x[4:]
    x = q.as_quat()
    return tuple(np.roll(x, 1)) + tuple(w)


def loops_of_attitude(P, D, rate):
    """Return difference and phase margins of that body about its start, where what is wanted turns at `rate` rad/s about y of its
    own: the errors of attitude and rate and the motion by central differences, in axes that turn on as at the start."""
    J = np.array([[3, 0.2, -0.4], [0.2, 4, 0.3], [-0.4, 0.3, 5]])
    start, wanted = (Rotation.from_euler('XYZ', [70, -40, 200], degrees=True),
                     Rotation.from_euler('ZX', [50, -30], degrees=True))
    spin, sample, late = np.array([0.1, -0.05, 0.08]), 0.1, 0.03

    def motion(x):
        turn, w = x[:3], spin + x[3:]
        return np.concatenate([w - spin - np.cross(spin, turn), -np.linalg.solve(J, np.cross(w, J @ w))])

    def command(x):
        off = (start * Rotation.from_rotvec(x[:3])).inv() * wanted
        return P @ off.as_quat(canonical=True)[:3] * 2 + D @ (off.apply([0, rate, 0]) - spin - x[3:])

    def slope(f):
        return np.array([(f(1e-5 * x) - f(-1e-5 * x)) / 2e-5 for x in np.eye(6)]).T

    def hold(t):
        E = linalg.expm(np.block([[slope(motion), np.vstack([np.zeros((3, 3)), np.linalg.inv(J)])],
                                  [np.zeros((3, 9))]]) * t)
        return E[:6, :6], E[:6, 6:]

    K = slope(command)
    before, after = hold(sample - late)[0] @ hold(late)[1], hold(sample - late)[1]
    one = np.block([[hold(sample)[0], before], [np.zeros((3, 9))]])

    def gain(w):
        return -np.hstack([K, np.zeros((3, 3))]) @ np.linalg.solve(np.exp(1j * w * sample) * np.eye(9) - one,
                                                                   np.vstack([after, np.eye(3)]))

    def difference(w):
        return np.linalg.svd(np.eye(3) + gain(w), compute_uv=False)[-1]

    def loop(k):
        rest = [i for i in range(3) if i != k]

        def response(w):
            L = gain(w)
            return L[k, k] - L[k, rest] @ np.linalg.solve(np.eye(2) + L[np.ix_(rest, rest)], L[rest, k])
        return crossings(response, sample)[2]

    w = np.geomspace(0.01, 30, 3000)
    at = w[np.argmin([difference(x) for x in w])]
    least = optimize.minimize_scalar(difference, (at / 1.01, at, at * 1.01), tol=1e-10).fun
    return (least, loop(0), loop(1), loop(2))


def line(name, values):
    print(','.join([name] + ['%.12g' % x for x in values]))


def main():
    if '--table' in sys.argv[1:]:
        np.savetxt(sys.stdout, lqg()[5], fmt='%.17g', delimiter=',')
        return
    print('# Controllers of several signals, by tests/reference/p16_control.py (python-control, SciPy)')
    print('case,values')
    line('lqg', closed_lqg())
    line('attitude_1', attitude(2 * np.eye(3), 5 * np.eye(3), 0))
    line('attitude_3', attitude(np.diag([2.0, 3, 4]), np.diag([4.0, 6, 7]), 0.1))
    P = np.array([[2, 0.3, -0.1], [-0.2, 3, 0.4], [0.1, -0.3, 4.0]])
    D = np.array([[4, 0.5, 0.2], [0.3, 6, -0.4], [-0.1, 0.2, 7.0]])
    line('attitude_9', attitude(P, D, 0))
    line('loops_still', loops_of_attitude(P, D, 0))
    line('loops_turning', loops_of_attitude(P, D, 0.05))


if __name__ == '__main__':
    main()
