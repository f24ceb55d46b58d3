# mesh.py - meshes of CalculiX and Abaqus for import.py: reads nodes, sets and supports of an .inp, writes decks of it, runs CalculiX (ccx), and
# takes K and M with the nodes of their rows (MATRIXSTORAGE), and K under a load: a static step, then *STEP, PERTURBATION ([D] *FREQUENCY).
# [D]  G. Dhondt, CalculiX CrunchiX User's Manual
import os
import re
import shutil
import subprocess
import sys
import tempfile

import numpy as np
from scipy import sparse
from scipy.linalg import null_space, orth, qr

from matrix_files import Refused, number, text_lines

LEFT = {'BOUNDARY', 'PREPRINT', 'RESTART', 'HEADING'}  # written anew, or no part of the model
INSTANCES = {'PART', 'ASSEMBLY', 'INSTANCE'}
TOLD = {  # left out, and told
    'DAMPING': "damping: --word 'damping RATIO'", 'MODAL DAMPING': "damping: --word 'damping RATIO'", 'DASHPOT': "damping: --word 'damping RATIO'",
    'CONTACT PAIR': 'contact: *TIE joins surfaces', 'TRANSFORM': 'axes of supports', 'INITIAL CONDITIONS': 'stress and temperature at the start'}
HELD = {'ENCASTRE': (1, 6), 'PINNED': (1, 3)}  # words of Abaqus
SOLID, LUMPED = re.compile('C3D'), re.compile('MASS|SPRING|GAP|DASHPOT')
THIN = {'S3', 'S4', 'S4R', 'S6', 'S8', 'S8R', 'B21', 'B31', 'B31R', 'B32', 'B32R'}  # elements that CalculiX expands into solids
SOLIDS = 'SOLIDS_OF_IMPORT'
WIDE = 1e3  # thickness in place of 1 where places are read, of which the .frd has six digits


def keyword(line):
    """Name and parameters of a line such as *NODE, NSET=ALL, in capitals."""
    words = [' '.join(word.split()).upper() for word in line.strip()[1:].split(',')]
    return words[0], {key.strip(): value.strip() for key, _, value in (word.partition('=') for word in words[1:])}


class Block:
    """A keyword and its lines of data, each a pair of text and FILE:LINE."""

    def __init__(self, line, where):
        self.line, self.where, self.data = line, where, []
        self.name, self.options = keyword(line)

    def words(self):
        """Of each line of data the words, and where it stands."""
        for text, where in self.data:
            yield [word.strip() for word in text.split(',')], where


def blocks_of(path, depth=0):
    """Keywords of a file and of those that it includes."""
    if depth > 10:
        raise Refused('%s: *INCLUDE of itself, or 10 deep' % path)
    block = None
    for k, line in text_lines(path):
        line, where = line.strip(), '%s:%d' % (path, k)
        if not line or line.startswith('**'):
            continue
        if not line.startswith('*'):
            if block is None or block.name == 'INCLUDE':
                raise Refused('%s: a keyword such as *NODE is wanted, not %r' % (where, line[:60]))
            block.data.append((line, where))
            continue
        block = Block(line, where)
        if block.name in INSTANCES:
            raise Refused('%s: *%s: a flat model is wanted, which Abaqus writes with noPartsInputFile=ON' % (where, block.name))
        if block.name != 'INCLUDE':
            yield block
            continue
        name = re.search(r'INPUT\s*=\s*"?([^",]+)', line, re.IGNORECASE)
        if not name:
            raise Refused('%s: *INCLUDE, INPUT=FILE is wanted' % where)
        yield from blocks_of(os.path.join(os.path.dirname(path), name[1].strip()), depth + 1)


def at(kind, word, where, what):
    """A number, which has to be there."""
    path, line = where.rsplit(':', 1)
    return number(kind, word or 'nothing', path, int(line), what)


def real(value):
    """CalculiX reads 20 characters of a number."""
    return '%.13e' % value


class Deck:
    """The model of an .inp: its blocks before the first step; x, places of nodes; sets of nodes; supports, (node, first and last degree of
    freedom); rotation: of the reference node of a rigid body the node whose displacements are its rotations; thin: elements that are
    expanded, and their nodes; stand: for each of these nodes the nodes of solids that stand for it; notes."""

    def __init__(self, path):
        self.path, self.blocks, self.notes, self.x, self.sets, self.supports, self.rotation = path, [], [], {}, {}, [], {}
        self.thin, self.stand = {}, {}
        held, steps, turned = [], 0, ''
        for block in blocks_of(path):
            steps += block.name == 'STEP'
            if block.name == 'BOUNDARY' and steps < 2:
                held.append(block)
            elif block.name in TOLD and (not steps or 'DAMPING' in block.name):
                self.notes.append('%s: *%s is not taken (%s)' % (block.where, block.name, TOLD[block.name]))
                if block.name == 'DASHPOT':  # its elements want it, K and M have nothing of it
                    self.blocks.append(block)
                turned = turned or block.where * (block.name == 'TRANSFORM')
            elif not steps and block.name not in LEFT:
                self.blocks.append(block)
            if turned and block.name in ('EQUATION', 'MPC') and not steps:
                raise Refused('%s: *%s beside *TRANSFORM (%s): equations in basic axes, without it, are wanted' % (block.where, block.name, turned))
        for block in self.blocks:
            self.take(block)
        if not self.x:
            raise Refused('%s: no *NODE: the .inp of a model is wanted' % path)
        for block in held:
            self.support(block)
        self.couplings()
        for block in [block for block in self.blocks if block.name == 'RIGID BODY']:
            self.rigid_body(block)

    def take(self, block):
        if block.name == 'NODE':
            for words, where in block.words():
                node = at(int, words[0], where, 'node')
                self.x[node] = np.array([at(float, word or '0', where, 'coordinate') for word in (words[1:4] + ['', '', ''])[:3]])
                if 'NSET' in block.options:
                    self.sets.setdefault(block.options['NSET'], []).append(node)
        elif block.name == 'NSET':
            self.sets.setdefault(block.options.get('NSET', ''), []).extend(node for words, where in block.words() for node in self.members(block, words, where))
        elif block.name == 'ELEMENT':
            self.elements(block)

    def elements(self, block):
        kind = block.options.get('TYPE', '')
        if kind in THIN:
            for words, where in block.words():
                numbers = [at(int, word, where, 'element or node') for word in words if word]
                if numbers:
                    self.thin[numbers[0]] = numbers[1:]
        elif not SOLID.match(kind) and not LUMPED.match(kind):
            raise Refused('%s: elements of type %s: solids C3D.., shells and beams (%s), MASS and SPRING are taken'
                          % (block.where, kind or '(none)', ', '.join(sorted(THIN))))

    def members(self, block, words, where):
        if 'GENERATE' not in block.options:
            return [node for word in words if word for node in self.nodes(word, where)]
        ends = [at(int, word, where, 'node') for word in words if word]
        if len(ends) not in (2, 3) or ends[2:] and ends[2] < 1 or not 0 <= ends[1] - ends[0] < 10000000:
            raise Refused('%s: first, last, step are wanted, not %s' % (where, ', '.join(words)))
        return [node for node in range(ends[0], ends[1] + 1, *ends[2:]) if node in self.x]

    def nodes(self, word, where):
        """The nodes of a number or of the name of a set."""
        if re.fullmatch(r'\d{1,10}', word):
            if int(word) not in self.x:
                raise Refused('%s: the model has no node %s' % (where, word))
            return [int(word)]
        if not self.sets.get(word.upper()):
            raise Refused('%s: the model has no set of nodes %r%s' % (where, word, ', but ' + ', '.join(sorted(self.sets)[:10]) if self.sets else ''))
        return self.sets[word.upper()]

    def support(self, block):
        for words, where in block.words():
            ends = HELD.get(words[1].upper() if words[1:] else '')
            if not ends:
                first = at(int, words[1] if words[1:] else '', where, 'degree of freedom')
                ends = first, at(int, words[2], where, 'degree of freedom') if words[2:] and words[2] else first
            if not 1 <= ends[0] <= ends[1] <= 6:
                raise Refused('%s: degrees of freedom 1 to 6 are wanted, not %d to %d' % (where, *ends))
            self.supports += [(node, *ends) for node in self.nodes(words[0], where)]

    def new(self, x):
        """The number of a new node."""
        node = max(self.x) + 1
        self.x[node] = np.array(x)
        block = Block('*NODE', self.path)
        block.data.append((self.place(node), self.path))
        self.blocks.insert(0, block)
        return node

    def equation(self, terms):
        """A sum of displacements that is zero; the first depends on the others."""
        card = Block('*EQUATION', self.path)
        card.data = [('%d' % len(terms), self.path)] + [('%d, %s, %s' % (node, way, real(value)), self.path) for node, way, value in terms]
        self.blocks.append(card)

    def place(self, node):
        return ', '.join(['%d' % node] + [real(x) for x in self.x[node]])

    def rigid_body(self, block):
        """The rotations of a rigid body are the displacements of a node: one of its own, where the deck names none."""
        ref = self.nodes(block.options.get('REF NODE', ''), block.where)[0]
        if 'ROT NODE' in block.options:
            self.rotation[ref] = self.nodes(block.options['ROT NODE'], block.where)[0]
        else:
            self.rotation[ref] = self.new(self.x[ref])
            block.line += ', ROT NODE=%d' % self.rotation[ref]

    def couplings(self):
        """Writes a kinematic coupling of all displacements of a surface of nodes as the rigid body that it is."""
        for k, block in enumerate(self.blocks[:-1]):
            after = self.blocks[k + 1]
            surface = next((other for other in self.blocks if other.name == 'SURFACE' and other.options.get('NAME') == block.options.get('SURFACE')
                            and other.options.get('TYPE') == 'NODE'), None)
            if block.name == 'COUPLING' and after.name == 'KINEMATIC' and surface and {words[0] for words, _ in after.words()} <= {'1'} and \
                    {words[1] for words, _ in after.words() if words[1:]} <= {'3', '6'}:
                card = Block('*NSET, NSET=%s_OF_COUPLING' % block.options['SURFACE'], surface.where)
                card.data = surface.data
                self.sets[card.options['NSET']] = [node for words, where in card.words() for word in words if word for node in self.nodes(word, where)]
                self.blocks[k] = card
                self.blocks[k + 1] = Block('*RIGID BODY, NSET=%s, REF NODE=%s' % (card.options['NSET'], block.options.get('REF NODE', '')), block.where)

    def rigid(self, nodes, ref):
        """Ties nodes to a reference node as a rigid body."""
        name = 'RIGID_%d' % ref
        card = Block('*NSET, NSET=' + name, self.path)
        card.data = [('%d,' % other, self.path) for node in nodes for other in self.stand.get(node, [node])]
        self.blocks += [card, Block('*RIGID BODY, NSET=%s, REF NODE=%d' % (name, ref), self.path)]
        self.rigid_body(self.blocks[-1])

    def interface(self, nodes):
        """One node that moves with all of these, as a rigid body."""
        ref = self.new(np.mean([self.x[node] for node in nodes], axis=0))
        self.rigid(nodes, ref)
        return ref

    def directions(self, node):
        """Of the six directions of a node those that CalculiX has, each with its node and number there."""
        yield from ((way, (node, way + 1)) for way in range(3))
        if node in self.rotation:
            yield from ((way, (self.rotation[node], way - 2)) for way in range(3, 6))

    def solids_set(self):
        """A set of all solids, whose stresses are wanted."""
        card = Block('*ELSET, ELSET=' + SOLIDS, self.path)
        for block in self.blocks:
            if block.name == 'ELEMENT' and SOLID.match(block.options.get('TYPE', '')):
                ends = [True] + [text.endswith(',') is False for text, _ in block.data]
                card.data += [('%d,' % at(int, text.split(',')[0], where, 'element'), self.path) for (text, where), new in zip(block.data, ends) if new]
        if SOLIDS not in [block.options.get('ELSET') for block in self.blocks if block.name == 'ELSET']:
            self.blocks.append(card)

    def lines(self):
        return [text for block in self.blocks for text in [block.line] + [text for text, _ in block.data]]

    def where(self, said):
        """Where the line stands that CalculiX shows."""
        bare = {re.sub(r'\s', '', text).upper(): where for block in self.blocks for text, where in [(block.line, block.where)] + block.data}
        return next((bare[key] for key in (re.sub(r'\s', '', line).upper() for line in said) if key in bare), self.path)


# ---- runs of CalculiX


def ccx(deck, folder, lines, allowed='none'):
    """Runs CalculiX on the model and these lines; what it refuses is told with the line of the deck. The beginning of the names of its files. allowed: of an
    error that is none."""
    program = shutil.which(os.environ.get('CCX', 'ccx'))
    if not program:
        raise Refused('%s: CalculiX, which solves meshes, is not installed: apt-get install calculix-ccx, or CCX=PROGRAM in the environment' % deck.path)
    name = os.path.join(folder, 'run')
    for old in os.listdir(folder):
        os.remove(os.path.join(folder, old))
    with open(name + '.inp', 'w', encoding='latin-1') as file:
        file.write('\n'.join(deck.lines() + lines) + '\n')
    done = subprocess.run([program, 'run'], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    said = [line.strip() for line in done.stdout.decode('latin-1').splitlines()]
    for k, line in enumerate(said):
        if ('*ERROR' in line or 'cannot be inter' in line) and allowed not in line:
            part = [text for text in said[k:k + 6] if text]
            raise Refused('%s: CalculiX: %s' % (deck.where(part), re.sub(r'\s+', ' ', ' '.join(part))[:300]))
    if done.returncode not in (0, 201):  # 201: an error, or *NO ANALYSIS
        raise Refused('%s: CalculiX ended with status %d: %s' % (deck.path, done.returncode, ' '.join(said[-3:])[:300]))
    return name


def stored(deck, name, ending):
    """A matrix of MATRIXSTORAGE, of which one half is written, and the (node, direction) of its rows."""
    try:
        with open(name + '.dof') as file:
            labels = [tuple(map(int, line.split('.'))) for line in file if line.strip()]
        row, column, value = np.fromfile(name + ending, sep=' ').reshape(-1, 3).T
    except (OSError, ValueError):
        raise Refused('%s: CalculiX has written no matrices: version 2.10 or a later one is wanted' % deck.path)
    A = sparse.coo_array((value, (row.astype(int) - 1, column.astype(int) - 1)), shape=(len(labels),) * 2).tocsr()
    return sparse.csr_array(A + A.T - sparse.diags_array(A.diagonal())), labels


def held(deck, supports):
    """Cards that hold these; the rotations of a rigid body are at its own node."""
    cards = ['%d, %d, %d' % (node, first, min(last, 3)) for node, first, last in supports if first <= 3]
    return ['*BOUNDARY'] + cards + ['%d, %d, %d' % (deck.rotation[node], max(first - 3, 1), last - 3) for node, first, last in supports if last > 3 and node in deck.rotation]


def matrices(deck, folder, supports=(), mass=True):
    """K, freed of supports of a static step before, M or None, and the labels of their rows."""
    static = ['*STEP', '*STATIC', *supports, '*END STEP'] if supports else []
    name = ccx(deck, folder, static + ['*STEP, PERTURBATION' if supports else '*STEP', '*FREQUENCY, SOLVER=MATRIXSTORAGE', *(['*BOUNDARY, OP=NEW'] if supports else []),
                                       '*END STEP'])
    K, labels = stored(deck, name, '.sti')
    return K, stored(deck, name, '.mas')[0] if mass else None, labels


# ---- shells and beams: the solids that CalculiX makes of them ([D] Shells, Beams) are written in their place, so each row has a node


def thickened(block, factor):
    """A section of so many times its thickness."""
    out = Block(block.line, block.where)
    out.data = list(block.data)
    for k, (words, where) in enumerate(block.words()):
        if k == 0:
            out.data[0] = ', '.join(real(factor * at(float, word, where, 'thickness')) for word in words if word), where
    return out


def section_check(block):
    if block.name == 'BEAM SECTION' and block.options.get('SECTION') != 'RECT' or 'COMPOSITE' in block.options or 'NODAL THICKNESS' in block.options:
        raise Refused('%s: of sections of shells and beams those of constant thickness, and RECT, are taken: others are to be meshed by solids' % block.where)


def expanded(deck, name):
    """Solids of the thin elements (.12d), by element type and nodes, and the places of their nodes (.frd)."""
    words, solids, x = [], {}, {}
    for _, line in text_lines(name + '.12d'):
        words += line.replace('"', ' ').split()
    for k in [k for k, word in enumerate(words) if word == 'ELEMENT']:
        element, into = int(words[k + 1]), words.index('into', k)
        end = next((j for j in range(into, len(words)) if words[j] in ('ELEMENT', 'a') and j > into + 2), len(words))
        start = words.index('topology:', into) + 1
        nodes = [int(word) for word in words[start:end] if word.isdigit() and word != '0']
        solids[element] = re.match(r'C3D\d+[RI]?', words[into + 2])[0], nodes
    for _, line in text_lines(name + '.frd'):
        if line.startswith(' -1') and len(line.rstrip()) >= 49:
            x[int(line[3:13])] = np.array([float(line[13 + 12 * k:25 + 12 * k]) for k in range(3)])
        elif line.startswith(' -3'):
            break
    return solids, x


def parents(deck, element, kind, nodes):
    """Of each node of a thin element the nodes of the solid that stand for it."""
    own, corner = deck.thin[element], {'C3D6': 3, 'C3D15': 3}.get(kind.rstrip('RI'), 4)
    n = corner
    quadratic = len(nodes) > 2 * corner
    if len(own) in (2, 3) and kind.startswith(('C3D8', 'C3D20')) and n == 4:  # a beam: nodes 1 4 5 8 and 2 3 6 7 are its ends
        ends = [[0, 3, 4, 7], [1, 2, 5, 6]]
        if quadratic:
            ends = [[0, 3, 4, 7, 11, 15, 16, 19], [8, 10, 12, 14], [1, 2, 5, 6, 9, 13, 17, 18]]
        return [[nodes[k] for k in end] for end in ends]
    out = [[nodes[k], nodes[n + k]] + ([nodes[4 * n + k]] if quadratic else []) for k in range(n)]
    return out + ([[nodes[2 * n + k], nodes[3 * n + k]] for k in range(n)] if quadratic else [])


def as_solids(deck, folder, named):
    """Writes solids in place of shells and beams. Their nodes that supports or the interface name are tied to those
    that stand for them."""
    sections = [block for block in deck.blocks if block.name in ('SHELL SECTION', 'BEAM SECTION')]
    blocks = deck.blocks
    for block in sections:
        section_check(block)
    deck.blocks = [thickened(block, WIDE) if block in sections else block for block in blocks]
    solids, x = expanded(deck, ccx(deck, folder, ['*STEP', '*NO ANALYSIS', '*END STEP'], 'jacobian'))  # so thick they meet
    if set(solids) != set(deck.thin):
        raise Refused('%s: CalculiX has expanded %d of %d shells and beams (.12d)' % (deck.path, len(solids), len(deck.thin)))
    stand, several, first = {}, set(), max(deck.x)
    for element, (kind, nodes) in solids.items():
        for node, those in zip(deck.thin[element], parents(deck, element, kind, nodes)):
            if stand.setdefault(node, set(those)) != set(those):
                several.add(node)  # elements at an angle, or of unequal thickness, meet in a rigid body, as CalculiX has it
                stand[node] |= set(those)
    deck.stand = {node: [first + other for other in sorted(those)] for node, those in stand.items()}
    places = Block('*NODE', deck.path)
    for node, those in deck.stand.items():
        for other in those:
            deck.x[other] = deck.x[node] + (x[other - first] - deck.x[node]) / WIDE
            places.data.append((deck.place(other), deck.path))
    deck.blocks = [places] + [part for block in blocks for part in solid_blocks(deck, block, solids, first)]
    held_nodes = {node for node, *_ in deck.supports}
    special = (several | named | held_nodes) & set(stand)
    for node in sorted(used_nodes(blocks) & set(stand) - special):  # what hangs there moves with the mean of them, as CalculiX has it
        those = deck.stand[node]
        for way in '123':
            deck.equation([(node, way, 1.0)] + [(other, way, -1 / len(those)) for other in those])
    for node in sorted(special):
        if node in several:
            deck.rigid([node], node)
        else:
            section(deck, node, node in held_nodes)
        if node not in held_nodes:
            drilling(deck, node, special)


def section(deck, node, held):
    """Ties the points that stand for a node of shells and beams to it. R, rigid-body motion of the points by that of the node. Held, they move as
    a section that stretches freely along its own directions only, as by Poisson's ratio, which is how CalculiX clamps; else the node has their
    mean motion, a least-squares fit, and they are free beside it. In both B u = B R (motion of the node), normal to what is free."""
    those = deck.stand[node]
    r = np.array([deck.x[other] for other in those]) - deck.x[node]
    R = np.vstack([np.hstack([np.eye(3), -np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])]) for x, y, z in r])
    B = orth(R, rcond=1e-9).T
    if held:
        size, axes = np.linalg.svd(r)[1:]
        own = axes[:len(size)][size > 1e-6 * size[0]]  # one of a shell, two of a beam
        B = null_space(np.array([(np.outer(r @ a, b) + np.outer(r @ b, a)).ravel() for k, a in enumerate(own) for b in own[k:]])).T
    pivot = qr(B, pivoting=True, mode='r')[1][:len(B)]
    solved = np.linalg.solve(B[:, pivot], np.hstack([B, -B @ R]))
    deck.rotation[node] = deck.new(deck.x[node])
    names = [(other, way) for other in those for way in (1, 2, 3)] + [(part, way) for part in (node, deck.rotation[node]) for way in (1, 2, 3)]
    for k, row in zip(pivot, solved):
        deck.equation([(*names[at], row[at]) for at in [k, *np.setdiff1d(np.arange(len(row)), pivot)] if abs(row[at]) > 1e-12 * abs(row).max()])


def drilling(deck, node, special):
    """The rotation of a node of a shell about the normal is that of the way to another node of the element, as no stiffness is against it."""
    those = np.array([deck.x[other] for other in deck.stand[node]]) - deck.x[node]
    size, axes = np.linalg.svd(those)[1:]
    if size[1] > 1e-6 * size[0]:
        return
    near = [other for nodes in deck.thin.values() if node in nodes for other in nodes if other not in special]
    if not near:
        raise Refused('%s: node %d: all other nodes of its shells are held, named or constrained, too: a finer mesh there' % (deck.path, node))
    end = deck.stand[max(near, key=lambda other: np.linalg.norm(np.cross(axes[0], deck.x[other] - deck.x[node])))][0]
    r = deck.x[end] - deck.x[node]
    t = np.cross(axes[0], r)
    terms = [(end, k + 1, t[k]) for k in np.argsort(-abs(t))] + [(node, k + 1, -t[k]) for k in range(3)] + [(deck.rotation[node], k + 1, -np.cross(r, t)[k]) for k in range(3)]
    terms = [(other, k, value) for other, k, value in terms if abs(value) > 1e-12 * np.linalg.norm(t) * max(1, np.linalg.norm(r))]
    deck.equation(terms)


def solid_blocks(deck, block, solids, first):
    """The block, or what stands for it once shells and beams are solids."""
    if block.name in ('SHELL SECTION', 'BEAM SECTION'):
        keep = ['%s=%s' % (key, block.options[key]) for key in ('ELSET', 'MATERIAL', 'ORIENTATION') if key in block.options]
        return [Block(', '.join(['*SOLID SECTION'] + keep), block.where)]
    if block.name == 'NORMAL':
        return []
    if block.name == 'RIGID BODY' and set(deck.sets.get(block.options.get('NSET', ''), [])) & set(deck.stand):
        card = Block('*NSET, NSET=%s_OF_SOLIDS' % block.options['NSET'], block.where)
        card.data = [('%d,' % other, block.where) for node in deck.sets[block.options['NSET']] for other in deck.stand.get(node, [node])]
        return [card, Block(re.sub(r'(NSET\s*=)[^,]*', r'\g<1>' + card.options['NSET'], block.line, flags=re.IGNORECASE), block.where)]
    if block.name == 'SURFACE':
        raise Refused('%s: *SURFACE beside shells or beams: mesh them by solids, or tie nodes by *RIGID BODY or *EQUATION' % block.where)
    if block.name != 'ELEMENT' or block.options.get('TYPE') not in THIN:
        return [block]
    out = {}
    for words, where in block.words():
        element = int(words[0])
        kind, nodes = solids[element]
        line = [str(number) for number in [element] + [first + node for node in nodes]]
        part = out.setdefault(kind, Block('*ELEMENT, TYPE=%s%s' % (kind, ', ELSET=' + block.options['ELSET'] if 'ELSET' in block.options else ''), block.where))
        part.data += [(', '.join(line[k:k + 10]) + (',' if k + 10 < len(line) else ''), where) for k in range(0, len(line), 10)]
    return list(out.values())


def used_nodes(blocks):
    """Nodes that lumped elements and equations name."""
    out = set()
    for block in blocks:
        if block.name == 'ELEMENT' and LUMPED.match(block.options.get('TYPE', '')) or block.name in ('EQUATION', 'MPC'):
            out |= {int(word) for words, _ in block.words() for word in words[block.name == 'ELEMENT':] if word.isdigit()}
    return out


# ---- rows


def block_inverse(A):
    """Of a matrix of many small blocks."""
    count, group = sparse.csgraph.connected_components(A, directed=False)
    order = np.argsort(group, kind='stable')
    size = np.bincount(group, minlength=count)
    start, out = np.cumsum(size) - size, []
    for n in np.unique(size):
        rows = order[start[size == n][:, None] + np.arange(n)]
        at = rows[:, :, None] + 0 * rows[:, None, :], rows[:, None, :] + 0 * rows[:, :, None]
        values = np.linalg.inv(np.asarray(A[at[0].ravel(), at[1].ravel()]).reshape(-1, n, n))
        out.append((values.ravel(), at[0].ravel(), at[1].ravel()))
    value, row, column = (np.concatenate(parts) for parts in zip(*out))
    return sparse.csr_array((value, (row, column)), shape=A.shape)


class Rows:
    """K and M of a mesh with rows of its nodes: ids, places, of each row its place among six per node. What has no place and no part in
    rigid-body motion (incompatible modes of elements) is condensed by K."""

    def __init__(self, deck, folder):
        K, M, self.labels = matrices(deck, folder)
        again = {label for label in self.labels if label[0] in deck.x}
        of_rotation = {rot: ref for ref, rot in deck.rotation.items()}
        known = np.array([node in deck.x for node, _ in self.labels])
        if len(again) < known.sum() or not known.any():
            raise Refused('%s: CalculiX gives rows that belong to no node of the model, or twice to one' % deck.path)
        self.known, unknown = np.flatnonzero(known), np.flatnonzero(~known)
        full = [(of_rotation[node], 3 + way) if node in of_rotation else (node, way) for node, way in (self.labels[k] for k in self.known)]
        self.ids = sorted({node for node, _ in full})
        index = {node: k for k, node in enumerate(self.ids)}
        self.x = np.array([deck.x[node] for node in self.ids])
        self.place = np.array([6 * index[node] + way - 1 for node, way in full])
        self.move = None
        if len(unknown):
            follow = -block_inverse(K[unknown][:, unknown]) @ K[unknown][:, self.known]
            moves = abs(follow @ np.array([np.cross(np.eye(3), self.x[p // 6])[:, p % 6] if p % 6 < 3 else np.eye(3)[p % 6 - 3] for p in self.place])).max(axis=1)
            for k in np.flatnonzero(moves > 1e-3):
                raise Refused('%s: CalculiX gives rows of a node %d that it has added, which turns with the model: a *COUPLING of a surface of faces, or a '
                              'node with a knot? *RIGID BODY, NSET=.., REF NODE=.. is wanted there' % (deck.path, self.labels[unknown[k]][0]))
            self.move = sparse.vstack([sparse.eye_array(len(self.known)), follow])
            self.order = np.concatenate([self.known, unknown])
        self.K, self.M = self.of(K), self.of(M)

    def of(self, A):
        if self.move is None:
            return A
        return sparse.csr_array(self.move.T @ A[self.order][:, self.order] @ self.move)


def clamped(deck, rows):
    """The nodes that are held in all that they have; one that is held in part is refused."""
    dofs, have = {}, {}
    for node, first, last in deck.supports:
        dofs.setdefault(node, set()).update(range(first, last + 1))
    for p in rows.place:
        have.setdefault(rows.ids[p // 6], set()).add(p % 6 + 1)
    for node, those in dofs.items():
        if node in have and not have[node] <= those:
            raise Refused('%s: *BOUNDARY holds node %d in some of its degrees of freedom only (%s of %s): a frame is held in all: --frame NODES, or a set'
                          % (deck.path, node, ''.join(map(str, sorted(those))), ''.join(map(str, sorted(have[node])))))
    return sorted(set(dofs) & set(have))


def determinate(rows, R):
    """Cards that hold the rows of a free structure, R its rigid-body motions, such that loads in equilibrium give no forces there."""
    size = abs(R).max(axis=0)
    return ['*BOUNDARY'] + ['%d, %d, %d' % (node, way, way) for node, way in (rows.labels[rows.known[k]] for k in qr((R / size).T, pivoting=True, mode='r')[1][:6])]


def stresses(deck, folder, rows, forces, supports):
    """Stresses at the points of integration by loads on the supported model, each as lines of element, point, six components."""
    text, out = [], []
    for force in forces:
        cards = ['%d, %d, %s' % (node, way, real(row[k])) for node, row in zip(rows.ids, force) for k, (node, way) in deck.directions(node) if row[k]]
        text += ['*STEP', '*STATIC', *supports, '*CLOAD, OP=NEW', *cards, '*EL PRINT, ELSET=%s, GLOBAL=YES' % SOLIDS, 'S', '*END STEP']
    name = ccx(deck, folder, text)
    for _, line in text_lines(name + '.dat'):
        words = line.split()
        if words[:1] == ['stresses']:
            out.append([])
        elif len(words) == 8 and out:
            out[-1].append([float(word) for word in words])
    if len(out) != len(forces):
        raise Refused('%s: CalculiX has computed the stresses of %d of %d inertia loads' % (deck.path, len(out), len(forces)))
    return [np.array(stress) for stress in out]


def preloaded(deck, folder, rows, forces, R):
    """K_G of unit loads, forces by load, node and six directions: of their stresses alone, at points that have not moved, as K of a model that
    a load has deformed has the change of its places, too."""
    deck.solids_set()
    out, nodes = [], ['%d, %d, %d' % (node, way, way) for node, way in rows.labels if node in deck.x]
    for stress in stresses(deck, folder, rows, forces, held(deck, deck.supports) if deck.supports else determinate(rows, R)):
        most = abs(stress[:, 2:]).max()
        if not most > 0:
            out.append(0 * rows.K)
            continue
        scale = rows.K.diagonal().max() / np.ptp(rows.x, axis=0).max() / most  # as much as K, for many digits
        block = Block('*INITIAL CONDITIONS, TYPE=STRESS', deck.path)
        block.data = [('%d, %d, %s' % (at[0], at[1], ', '.join(real(scale * value) for value in at[2:])), deck.path) for at in stress]
        deck.blocks.append(block)
        if sys.stderr.isatty():
            print('\r%s: load %d of %d' % (deck.path, len(out) + 1, len(forces)), end='\n' * (len(out) + 1 == len(forces)), file=sys.stderr, flush=True)
        K, _, labels = matrices(deck, folder, ['*BOUNDARY', *nodes], mass=False)
        deck.blocks.pop()
        if labels != rows.labels:
            raise Refused('%s: CalculiX numbers the rows of the preloaded model in another way' % deck.path)
        out.append(sparse.csr_array((rows.of(K) - rows.K) / scale))
    return out


def frequencies(path):
    """[Hz] of the modes of an .frd, zero ones left out."""
    found = {}
    for k, line in text_lines(path):
        if line.startswith('  100CL') and 'MODAL' in line:
            found.setdefault(line[58:63] + line.split('MODAL')[1].split()[0], number(float, line[12:24], path, k, 'frequency'))
    hz = np.array([value for value in found.values() if value > 1e-3 * max(found.values())])
    if not len(hz):
        raise Refused('%s: no modes: *FREQUENCY with *NODE FILE, U writes them' % path)
    return hz


def folder():
    return tempfile.TemporaryDirectory(prefix='import_mesh_')
