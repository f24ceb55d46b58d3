"""attitude.py - attitude control of a flexible satellite: its FMU in FMPy, gains by SciPy, curves if matplotlib is there.

usage: python3 examples/fmu/attitude.py [build/satellite.fmu]

A step of 2 degrees about z, which excites the wing in its plane. The controller is proportional-derivative on quaternion
and rate; its gains are linear-quadratic ones of a rigid body, whose inertia the FMU itself tells: its directional derivative of
the angular acceleration by the torque is the inverse. The last line is the error
at the end; exit status 1 if it is above 0.01 degrees.
"""
import shutil
import sys

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave
from scipy.linalg import solve_continuous_are

FILE = sys.argv[1] if len(sys.argv) > 1 else "build/satellite.fmu"
STEP, END, ANGLE = 0.02, 60.0, np.radians(2.0)

description = fmpy.read_model_description(FILE)
reference = {v.name: v.valueReference for v in description.modelVariables}
folder = fmpy.extract(FILE)
fmu = FMU2Slave(guid=description.guid, unzipDirectory=folder, instanceName="satellite",
                modelIdentifier=description.coSimulation.modelIdentifier)


def of(name, count=3):
    return [reference[f"{name}[{i + 1}]"] for i in range(count)]


fmu.instantiate()
fmu.setupExperiment(startTime=0.0)
fmu.enterInitializationMode()
fmu.exitInitializationMode()

# The inertia that a torque meets at once, before the modes follow: below that of the rigid body.
inverse = np.array([fmu.getDirectionalDerivative(of("hub.angular_acceleration"), of("hub.torque"), column)
                    for column in np.eye(3)]).T
inertia = np.linalg.inv(inverse)
A, B = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0 / inertia[2, 2]]])
P = solve_continuous_are(A, B, np.diag([1.0, 4.0]), np.array([[1e-4]]))
kp, kd = (B.T @ P / 1e-4)[0]

goal = np.array([np.cos(ANGLE / 2), 0.0, 0.0, np.sin(ANGLE / 2)])
rows = []
for k in range(round(END / STEP)):
    w, x, y, z = fmu.getReal(of("hub.attitude", 4))
    rate = np.array(fmu.getReal(of("hub.rate")))
    error = 2.0 * np.array([goal[0] * x - goal[3] * y, goal[0] * y + goal[3] * x, goal[0] * z - goal[3] * w])
    torque = -kp * error - kd * rate
    fmu.setReal(of("hub.torque"), torque)
    rows.append([k * STEP, 2 * np.degrees(np.arctan2(z, w)), torque[2], fmu.getReal(of("node1.deflection"))[1]])
    fmu.doStep(k * STEP, STEP)
fmu.terminate()
fmu.freeInstance()
shutil.rmtree(folder)

rows = np.array(rows)
left = abs(rows[-1, 1] - np.degrees(ANGLE))
try:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(3, 1, sharex=True, figsize=(7, 7), constrained_layout=True)
    for axis, column, label in zip(axes, (1, 2, 3), ("angle [deg]", "torque [N m]", "wing tip in plane [m]")):
        axis.plot(rows[:, 0], rows[:, column])
        axis.set_ylabel(label)
        axis.grid(True)
    axes[-1].set_xlabel("time [s]")
    picture = FILE.removesuffix(".fmu") + "_attitude.svg"
    figure.savefig(picture)
    print(f"picture {picture}")
except ImportError:
    print("no picture: matplotlib is not installed")
print(f"inertia about z {inertia[2, 2]:.1f} kg m^2, gains {kp:.4g} N m/rad and {kd:.4g} N m s/rad, "
      f"largest tip deflection {1000 * abs(rows[:, 3]).max():.3g} mm, error at the end {left:.2g} deg")
sys.exit(int(left > 0.01))
