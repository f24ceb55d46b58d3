# mesh.py - meshes through examples/tools/import.py, which CalculiX solves: mesh.py FOLDER COUNT SEED, with FOLDER/integrals. What flexbeam makes
# of them against CalculiX's own frequencies (*FREQUENCY), static deflections (*STATIC) and frequencies at a spin (*FREQUENCY in a step
# PERTURBATION after centrifugal load), and closed forms; COUNT damaged decks.
import os
import random
import re
import subprocess
import sys

import numpy as np
from scipy import linalg

sys.path[:0] = ['tests/checks']
from fem import folder, frequencies, integrals, meet, refuse, refused, run, worst
from import_damage import damaged, end_of

count, seed = int(sys.argv[2]), int(sys.argv[3])
ALUMINIUM = '*MATERIAL, NAME=AL\n*ELASTIC\n7e10, 0.33\n*DENSITY\n2700\n'
HEX = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2), (1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0),
       (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2), (0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)]


def solids(size, place):
    """C3D20R on a grid of elements; place: of a node, from its numbers in half elements. Text of the deck, and nodes by number."""
    node, cells, text = {}, [], ''
    for at in np.ndindex(*size):
        corner = 2 * np.array(at)
        if place(*(corner + 1)) is not None:
            cells.append([node.setdefault(tuple(corner + step), len(node) + 1) for step in HEX])
    text += '*NODE\n' + ''.join('%d, %r, %r, %r\n' % (k, *map(float, place(*at))) for at, k in node.items())
    text += '*ELEMENT, TYPE=C3D20R, ELSET=ALL\n'
    for k, cell in enumerate(cells, 1):
        text += '%d, %s,\n%s\n' % (k, ', '.join(map(str, cell[:11])), ', '.join(map(str, cell[11:])))
    return text + ALUMINIUM + '*SOLID SECTION, ELSET=ALL, MATERIAL=AL\n', node


def nset(name, nodes):
    return '*NSET, NSET=%s\n' % name + ''.join('%d,\n' % node for node in nodes)


def deck(name, *parts):
    with open(folder + name, 'w') as file:
        file.write(''.join(parts))
    return folder + name


def ccx(*parts):
    """Lines of the .dat of CalculiX."""
    deck('own.inp', *parts)
    subprocess.run(['ccx', 'own'], cwd=folder, capture_output=True)
    with open(folder + 'own.dat') as file:
        return [line.split() for line in file]


def own_frequencies(model, step='*STEP\n', n=10):
    """[rad/s] by CalculiX."""
    rows = [row for row in ccx(model, step + '*FREQUENCY\n%d\n*END STEP\n' % n) if len(row) == 5 and row[0].isdigit()]
    return np.array([float(row[2]) for row in rows[:n]])


STEP = '*STEP\n*FREQUENCY\n10\n*NODE FILE\nU\n*END STEP\n'
CLAMPED = '*BOUNDARY\nROOT, 1, 3\n'

# a plate of solids: ten frequencies, and at a spin about z those that move along z
plate, node = solids((8, 2, 1), lambda i, j, k: (0.1 + i / 16, 0.05 * (j - 2), 0.005 * (k - 1)))
plate += nset('ROOT', [k for at, k in node.items() if at[0] == 0]) + nset('TIP', [k for at, k in node.items() if at[0] == 16]) + CLAMPED
tip = node[16, 2, 0]
name = deck('plate.inp', plate, STEP)
text = run(deck('told.inp', plate.replace('*BOUNDARY', '*TRANSFORM, NSET=TIP\n0, 1, 0, -1, 0, 0\n*DAMPING, ALPHA=3\n*BOUNDARY'), STEP), '--modes', 10,
           '--mark', '%d:tip' % tip, '--word', 'base prescribed')  # loads by CalculiX are in basic axes
if len(re.findall(r'^# \S*told\.inp:\d+: \*(?:TRANSFORM|DAMPING) is not taken', text, re.M)) != 2:
    sys.exit('told: %s' % text[:2000])
rest = own_frequencies(plate)
meet('frequencies of a plate', np.sqrt(np.diag(integrals()['K'].reshape(10, 10))) / rest, np.ones(10), 2e-5)
if not re.search('^effects full', text, re.M) or text.count('\ngeometric ') != 55 or not re.search('^mark %d tip$' % tip, text, re.M):
    sys.exit('plate: %s' % text[:2000])
modes = [k for k in range(3)]  # bending out of plane, the second one, torsion
for spin in 60, 120:
    own = own_frequencies(plate, '*STEP\n*STATIC\n*DLOAD\nALL, CENTRIF, %d, 0, 0, 0, 0, 0, 1\n*END STEP\n*STEP, PERTURBATION\n' % spin**2)
    have = frequencies(folder + 'out.txt', '--spin', str(spin))
    for k in modes:
        meet('stiffening of a plate at a spin', have[k]**2 - rest[k]**2, own[k]**2 - rest[k]**2, 1e-2)

# the same plate free: rigid-body modes are left out by themselves, and it stiffens as it spins about its center
free, corner = plate.replace(CLAMPED, ''), [node[0, 0, 0], node[16, 0, 0], node[0, 4, 0]]
own = own_frequencies(free, n=14)[6:]
run(deck('free.inp', free, STEP), '--modes', 8, '--origin', '0.6,0,0')
meet('frequencies of a free plate', np.sqrt(np.diag(integrals()['K'].reshape(8, 8))) / own, np.ones(8), 1e-5)
hold = '*BOUNDARY\n%d, 1, 3\n%d, 2, 3\n%d, 3, 3\n' % tuple(corner)
spun = own_frequencies(free, '*STEP\n*STATIC\n%s*DLOAD\nALL, CENTRIF, 10000, 0.6, 0, 0, 0, 0, 1\n*END STEP\n*STEP, PERTURBATION\n*BOUNDARY, OP=NEW\n' % hold, n=14)
have = frequencies(folder + 'out.txt', '--spin', '100')
at = np.argmin(abs(spun - have[have > 250][0]))
meet('stiffening of a free plate at a spin', have[have > 250][0]**2 - own[0]**2, spun[at]**2 - own[0]**2, 1e-3)

# its compliance with the tip as an interface, which is a rigid body for CalculiX, too
alone = run(name, '--modes', 10, '--interface', 'TIP:tip')  # a free base without a hub is told of
if 'by itself it wants --word' not in alone or 'by itself' in text:
    sys.exit('a plate without a hub: %s' % alone[:2000])
have = integrals()
n = len(have['reach'])
S = np.vstack([have['psi'].reshape(n, 3).T, have['theta'].reshape(n, 3).T])
ends = '*NODE\n8001, 1.1, 0, 0\n8002, 1.1, 0, 0\n*RIGID BODY, NSET=TIP, REF NODE=8001, ROT NODE=8002\n*NSET, NSET=END\n8001, 8002\n'
loads = ''.join('*STEP\n*STATIC\n*CLOAD, OP=NEW\n%d, %d, 1.\n*NODE PRINT, NSET=END\nU\n*END STEP\n' % (8001 + k // 3, k % 3 + 1) for k in range(6))
rows = [[float(word) for word in row[1:]] for row in ccx(plate, ends, loads) if len(row) == 4 and row[0] in ('8001', '8002')]
want = np.array(rows).reshape(6, 6)
meet('tip compliance', S @ linalg.solve(have['K'].reshape(n, n), S.T), want, 1e-4)
meet('tip compliance', np.diag(S @ linalg.solve(have['K'].reshape(n, n), S.T)) / np.diag(want), np.ones(6), 1e-3)

# an L-bracket, a lump off its end on a rigid body, in millimetres and tonnes
bracket, node = solids((6, 1, 6), lambda i, j, k: None if i > 2 and k > 2 else (15.0 * i, 10.0 * j, 15.0 * k) if max(i, k) > 2 else (4.0 * i, 10.0 * j, 4.0 * k))
bracket = bracket.replace('7e10, 0.33\n*DENSITY\n2700', '7e4, 0.33\n*DENSITY\n2.7e-9')
bracket += nset('ROOT', [k for at, k in node.items() if at[2] == 12]) + nset('TIP', [k for at, k in node.items() if at[0] == 12])
bracket += '*NODE\n9000, 200, 15, 5\n*ELEMENT, TYPE=MASS, ELSET=LUMP\n900, 9000\n*MASS, ELSET=LUMP\n2e-4\n'
bracket += '*SURFACE, NAME=END, TYPE=NODE\nTIP\n*COUPLING, REF NODE=9000, SURFACE=END, CONSTRAINT NAME=C\n*KINEMATIC\n1, 3\n' + CLAMPED
ccx(bracket, STEP)
run(deck('bracket.inp', bracket, STEP), folder + 'own.frd', '--modes', 10, '--report', folder + 'report.txt', '--scale', '0.001,1000', '--interface', '9000:lump')
meet('frequencies of a bracket with a lump', np.sqrt(np.diag(integrals()['K'].reshape(16, 16)))[:10] / own_frequencies(bracket), np.ones(10), 1e-5)

with open(folder + 'report.txt') as file:
    text = file.read()
rows = [row.split() for row in text.splitlines() if re.match(' *[0-9]+ +[0-9.]+ +[0-9.]+ ', row)]
if not re.search('^- frequencies are those of .*own[.]frd to [0-9.]+e-(0[6-9]|1[0-9])$', text, re.M) or len(rows) != 10:
    sys.exit('report: %s' % text)
meet('frequencies beside those of an .frd', [float(row[2]) for row in rows], own_frequencies(bracket) / (2 * np.pi), 1e-5)

# shells, S8R, as CalculiX expands them, held at their nodes, on axes that are turned
turn, _ = np.linalg.qr(np.array([[1, 0.2, -0.3], [0.5, 1, 0.4], [0.3, -0.6, 1]]))
node = {at: k for k, at in enumerate((at for at in np.ndindex(13, 5) if at[0] % 2 == 0 or at[1] % 2 == 0), 1)}
shell = '*NODE\n' + ''.join('%d, %r, %r, %r\n' % (k, *map(float, turn @ [i / 12, j / 10, 0])) for (i, j), k in node.items()) + '*ELEMENT, TYPE=S8R, ELSET=ALL\n'
for k, (i, j) in enumerate(np.ndindex(6, 2), 1):
    shell += '%d, %s\n' % (k, ', '.join(str(node[2 * i + a, 2 * j + b]) for a, b in [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]))
shell += ALUMINIUM + '*SHELL SECTION, ELSET=ALL, MATERIAL=AL\n0.01\n' + nset('ROOT', [node[0, j] for j in range(5)]) + '*BOUNDARY\nROOT, 1, 6\n'
run(deck('shell.inp', shell, STEP), '--modes', 10, '--mark', '%d:tip' % node[12, 2])
have = integrals()
meet('frequencies of shells', np.sqrt(np.diag(have['K'].reshape(10, 10))) / own_frequencies(shell), np.ones(10), 1e-5)
psi, theta = (turn.T @ have[key].reshape(10, 3).T for key in ('psi', 'theta'))
rows = ccx(shell, nset('END', [node[12, 2]]), '*STEP\n*FREQUENCY\n10\n*NODE PRINT, NSET=END\nU\n*END STEP\n')
own = np.array([[float(word) for word in row[1:]] for row in rows if len(row) == 4 and row[0] == str(node[12, 2])])  # of modal mass 1, too
meet('modes of shells at their end', abs(psi.T), abs(own @ turn), 1e-3)
meet('slope of the first mode of a cantilever', theta[1, 0] / psi[2, 0], -1.3765, 4e-2)

# a beam of 20 elements, held at one end: closed forms
L, EI = 2.0, 7e10 * np.array([0.04 * 0.02**3, 0.02 * 0.04**3]) / 12
beam = '*NODE\n' + ''.join('%d, 0, %r, 0\n' % (k + 1, L * k / 40) for k in range(41)) + '*ELEMENT, TYPE=B32R, ELSET=ALL\n'
beam += ''.join('%d, %d, %d, %d\n' % (k + 1, 2 * k + 1, 2 * k + 2, 2 * k + 3) for k in range(20)) + ALUMINIUM
beam += '*BEAM SECTION, ELSET=ALL, MATERIAL=AL, SECTION=RECT\n0.02, 0.04\n1, 0, 0\n'
run(deck('beam.inp', beam, STEP), '--frame', 1, '--modes', 4, '--mark', '41:tip')
want = np.array([1.875104068711961, 4.694091132974174])[:, None]**2 * np.sqrt(EI / (2700 * 8e-4)) / L**2
have = np.sqrt(np.diag(integrals()['K'].reshape(4, 4)))
meet('frequencies of a beam', have / own_frequencies(beam + '*BOUNDARY\n1, 1, 6\n', n=4), np.ones(4), 1e-3)
meet('closed forms of a beam', have / np.sort(want.ravel()), np.ones(4), 1e-2)

# what is refused
refuse(r"the model has no set of nodes 'TOP', but ROOT, TIP", name, '--interface', 'TOP')
refuse('--mark: the model has no node 99999', name, '--mark', 99999)
refuse(r'plate\.inp: node %d has no degrees of freedom of its own' % tip, name, '--mark', tip, '--interface', 'TIP')
refuse('--interface: 20 modes and 6 more for static deflections, a description holds 24', name, '--modes', 20, '--interface', 'TIP')
refuse('wants MODEL.bdf MODES.op2, or MODEL.inp .MODEL.frd. without', folder + 'model.bdf')
refuse(r'plate\.inp: no modes: \*FREQUENCY with \*NODE FILE', name, name)
refuse(r'none\.inp: No such file', folder + 'none.inp')
for why, old, new in ((r'bad\.inp:\d+: elements of type C3E20R: solids C3D\.\., shells and beams', 'C3D20R', 'C3E20R'),
                      (r"bad\.inp:\d+: CalculiX: .*DENSITEE", '*DENSITY', '*DENSITEE'),
                      (r'bad\.inp:\d+: \*PART: a flat model is wanted', '*NODE\n', '*PART, NAME=P\n*NODE\n'),
                      (r"bad\.inp:2: coordinate: a number is wanted, not '0\.O'", ', -0.1,', ', 0.O,'),
                      (r"bad\.inp:\d+: the model has no set of nodes 'RUUT'", 'ROOT, 1, 3', 'RUUT, 1, 3'),
                      (r'bad\.inp: \*BOUNDARY holds node \d+ in some of its degrees of freedom only \(12 of 123\)', 'ROOT, 1, 3', 'ROOT, 1, 2'),
                      (r'bad\.inp:\d+: degrees of freedom 1 to 6 are wanted, not 1 to 9', 'ROOT, 1, 3', 'ROOT, 1, 9'),
                      (r'bad\.inp:1: \*INCLUDE of itself|bad\.inp: \*INCLUDE of itself', '*NODE\n', '*INCLUDE, INPUT=bad.inp\n*NODE\n'),
                      (r'bad\.inp:\d+: \*EQUATION beside \*TRANSFORM \(\S*bad\.inp:\d+\): equations in basic axes', '*BOUNDARY', '*TRANSFORM, NSET=TIP\n0, 1, 0, 0, 0, 1\n*EQUATION\n1\n5, 1, 1\n*BOUNDARY'),
                      (r'bad\.inp', '*DENSITY\n2700\n', '')):
    refuse(why, deck('bad.inp', plate.replace(old, new, 1), STEP))
refuse(r'bad\.inp:\d+: of sections of shells and beams those of constant thickness, and RECT', deck('bad.inp', beam.replace('=RECT', '=CIRC'), STEP), '--frame', 1)
os.environ['CCX'] = 'no-such-ccx'
refuse(r'plate\.inp: CalculiX, which solves meshes, is not installed: apt-get install calculix-ccx', name)
del os.environ['CCX']

# decks that are damaged
small, node = solids((1, 1, 1), lambda i, j, k: (0.1 * i, 0.05 * j, 0.05 * k))
small += nset('ROOT', [k for at, k in node.items() if at[0] == 0]) + '*NODE\n90, 0.3, 0.05, 0.05\n*ELEMENT, TYPE=MASS, ELSET=LUMP\n9, 90\n*MASS, ELSET=LUMP\n2.\n'
small += nset('TIP', [k for at, k in node.items() if at[0] == 2]) + '*RIGID BODY, NSET=TIP, REF NODE=90\n' + CLAMPED
small = small.encode()
tally = {'read': 0, 'refused': 0}
for k in range(-1, count):
    with open(folder + 'damaged.inp', 'wb') as file:
        file.write(small if k < 0 else damaged(small, random.Random(1000003 * seed + k)))
    end, said = end_of([folder + 'damaged.inp', '--modes', '3', '--mark', '90:lump'], 60)
    if end not in tally or k < 0 and end != 'read':
        sys.exit('damaged deck, number %d of seed %d (%sdamaged.inp): %s: %s' % (k, seed, folder, end, said))
    tally[end] += 1
print('%s; %d refusals; %d damaged decks: %d refused, %d read' % (', '.join('%s %.1g' % pair for pair in worst.items()), len(refused), count, tally['refused'], tally['read'] - 1))
