#!/usr/bin/env python3
# Margins of sampled loops and poles of the closed ones, by SciPy, for p13_margins.csv: python3 p13_margins.py > p13_margins.csv
# Plants are written down from their masses and springs. Samples are exact by the exponential of the plant together with the
# input that is held (scipy.linalg.expm), the delay in fractions of a sample; controllers are transfer functions in z, as
# filters of scipy.signal; L is the product of the responses. Crossings are bracketed on a grid and found by brentq.
import numpy as np
from scipy import linalg, optimize, signal


def held(A, B, C, T, delay):
    """Numerator over denominator as a response: y at samples by a command that is held and `delay` late."""
    n = len(A)
    late = int(np.ceil(delay / T - 1e-9))
    part = late * T - delay

    def hold(t):
        M = np.zeros((n + 1, n + 1))
        M[:n, :n], M[:n, n:] = A, B
        E = linalg.expm(M * t)
        return E[:n, :n], E[:n, n:]

    F = hold(T)[0]
    rest, after = hold(part)
    before = rest @ hold(T - part)[1]

    def response(z):
        x = np.linalg.solve(z * np.eye(n) - F, before * z ** -late + after * z ** (1 - late))
        return (C @ x).item()

    # x, u[k-1], .., u[k-late] for the poles
    order = n + late
    full, into = np.zeros((order, order)), np.zeros((order, 1))
    full[:n, :n] = F
    if late == 0:
        into[:n] = before
    else:
        full[:n, n + late - 1:n + late] += before
        if late == 1:
            into[:n] = after
        else:
            full[:n, n + late - 2:n + late - 1] += after
        into[n] = 1
        full[n + 1:, n:-1] = np.eye(late - 1)
    return response, full, into, np.hstack([C, np.zeros((1, late))])


def pid(kp, ki, kd, tau, T):
    s = signal.TransferFunction([ki * T / 2, ki * T / 2], [1, -1], dt=T)
    d = signal.TransferFunction([kd, -kd], [tau + T, -tau], dt=T)
    num = np.polyadd(kp * np.polymul(s.den, d.den), np.polyadd(np.polymul(s.num, d.den), np.polymul(d.num, s.den)))
    den = np.polymul(s.den, d.den)
    return num, den


def prewarped(num, den, hz, T):
    """The bilinear transform that is exact at hz: that of a sample at which the warped frequency is the own one."""
    w = 2 * np.pi * hz
    return signal.bilinear(num, den, fs=w / (2 * np.tan(w * T / 2)))


def notch(hz, zero, pole, T):
    w = 2 * np.pi * hz
    return prewarped([1, 2 * zero * w, w * w], [1, 2 * pole * w, w * w], hz, T)


def lowpass(hz, zeta, T):
    w = 2 * np.pi * hz
    return prewarped([w * w], [1, 2 * zeta * w, w * w], hz, T)


def opened(plant, controller, T, delay):
    """The response L of the loop over frequency, and the matrix of the closed loop."""
    response, F, G, C = held(*plant, T, delay)
    num, den = np.array([1.0]), np.array([1.0])
    for n, d in controller:
        num, den = np.polymul(num, n), np.polymul(den, d)

    def L(w):
        z = np.exp(1j * w * T)
        return response(z) * np.prod([np.polyval(n, z) / np.polyval(d, z) for n, d in controller])

    K = signal.tf2ss(num, den)
    return L, np.block([[F - G @ K[3] @ C, G @ K[2]], [-K[1] @ C, K[0]]])


def crossings(L, T):
    """Gain margin, gain reduction, phase margin [rad] and delay margin [s] of a response over frequency [rad/s]."""
    top = np.pi / T
    grid = top * np.logspace(-5, 0, 40001)[:-1]
    values = np.array([L(w) for w in grid])
    gain, reduction, phase, late = np.inf, 0, np.pi, np.inf
    for k in np.nonzero(np.diff(np.sign(values.imag)))[0]:
        w = optimize.brentq(lambda w: L(w).imag / abs(L(w)), grid[k], grid[k + 1], xtol=1e-15, rtol=1e-15)
        at = L(w)
        if at.real < 0 and abs(at.imag) < 1e-6 * abs(at):
            gain = min(gain, 1 / abs(at)) if abs(at) <= 1 else gain
            reduction = max(reduction, 1 / abs(at)) if abs(at) > 1 else reduction
    for k in np.nonzero(np.diff(np.sign(np.abs(values) - 1)))[0]:
        w = optimize.brentq(lambda w: abs(L(w)) - 1, grid[k], grid[k + 1], xtol=1e-15, rtol=1e-15)
        angle = np.angle(-L(w))
        phase, late = min(phase, abs(angle)), min(late, (angle % (2 * np.pi)) / w)
    at = L(top)
    if at.real < 0:
        gain = min(gain, 1 / abs(at)) if abs(at) <= 1 else gain
        reduction = max(reduction, 1 / abs(at)) if abs(at) > 1 else reduction
    return gain, reduction, phase, late


def margins(plant, controller, T, delay):
    L, closed = opened(plant, controller, T, delay)
    return crossings(L, T) + (max(abs(np.linalg.eigvals(closed))),)


def two_disks(inertia, other, stiffness, damping, other_angle, rate_gain):
    """Two disks on a shaft that twists; torque on the first; angle of one, and rate of the first times its gain."""
    A = np.zeros((4, 4))
    A[:2, 2:] = np.eye(2)
    A[2] = np.array([-stiffness, stiffness, -damping, damping]) / inertia
    A[3] = np.array([stiffness, -stiffness, damping, -damping]) / other
    C = np.array([[0.0, 1, 0, 0]]) if other_angle else np.array([[1.0, 0, rate_gain, 0]])
    return A, np.array([[0], [0], [1 / inertia], [0]]), C


def line(name, *loop):
    print(','.join([name] + ['%.12g' % x for x in margins(*loop)]))


def main():
    print('# Margins of sampled loops about a rigid disk and two disks on a shaft, by tests/reference/p13_margins.py (SciPy)')
    print('case,gain_margin,gain_reduction,phase_margin,delay_margin,pole_radius')
    T = 0.01
    rigid = (np.array([[0, 1], [0, 0.0]]), np.array([[0], [0.01]]), np.array([[1, 3.0]]))
    line('rigid', rigid, [(np.array([40.0]), np.array([1.0]))], T, 0.005)
    disks = two_disks(100, 20, 8000, 4, False, 0)
    for name, delay in ('disks', 0), ('disks_5ms', 0.005), ('disks_10ms', 0.01), ('disks_27ms', 0.027):
        line(name, disks, [pid(40, 4, 150, 0.02, T), notch(3.5, 0.1, 0.7, T), lowpass(20, 0.7, T)], T, delay)
    far = two_disks(100, 20, 8000, 4, True, 0)
    line('far', far, [pid(40, 4, 150, 0.02, T), notch(3.5588, 0.02, 0.7, T), lowpass(5, 0.7, T)], T, 0.005)


if __name__ == '__main__':
    main()
