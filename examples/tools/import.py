#!/usr/bin/env python3
# import.py - a finite-element model as a component of flexbeam (examples/tools/README.md, Import):
#   import.py MODEL.bdf MODES.op2 --out truss.txt                       grids and normal modes (SOL 103) of Nastran
#   import.py --matrices K.mtx M.mtx --nodes nodes.csv --out truss.txt  matrices of any program; import.py solves for the modes
#   import.py plate.inp --interface TIP:tip --out plate.txt             a mesh of CalculiX or Abaqus, which CalculiX solves
#   import.py --matrices boom.pch --out boom.txt                        reduced ones, by Craig and Bampton: KAAX, MAAX and grids
#   import.py --modal FLEX.txt --nodes NODES.txt --body 40,... --out b.txt  modal data without a mesh, flex files of 42
# Wants NumPy and SciPy; for .bdf, .op2 and .op4 also pyNastran, for .inp CalculiX. Exit: 0 well, 1 the model cannot be imported, 2 bad options.
import argparse
import contextlib
import csv
import functools
import importlib
import importlib.metadata
import importlib.util
import io
import math
import os
import re
import sys
import warnings

try:
    import numpy as np
    import scipy.io
    import scipy.sparse as sparse
    from scipy import fft, linalg
except ImportError as missing:
    sys.exit('import.py: %s: python3 -m pip install numpy scipy' % missing)

import flex42
import import_report
import large
import matrix_files
import mesh
from matrix_files import Refused

MODES, NODES = 24, 4096  # what a description holds
FIRST, LAST = 0, 2000000000  # numbers of nodes
MARKS = 64  # nodes of a body beside its frame
FEW = 12  # nodes of matrices that are reduced without modal coordinates, at most
LARGE = 30000  # rows, from which on scikit-sparse is named
SMALL = 1e-9  # what counts as zero beside the largest
AXES = np.eye(3)
progress = large.Progress()


class Model:
    """ids; x, the places; M and list K_G, sparse, six rows per node, basic axes; phi: shapes, such rows; hz; rotations: are there any."""

    def __init__(self, ids, x):
        self.ids, self.x = list(ids), np.array(x, dtype=float).reshape(-1, 3)
        self.at = {node: k for k, node in enumerate(self.ids)}
        self.K_G, self.modal_mass, self.digits, self.notes, self.static, self.reduced = [], None, 17, [], None, None
        self.pairs, self.exact, self.dropped = [], None, []  # nodes that are joined; number of modes that are not residual; frequencies
        self.free = False  # its modes are those of the free structure, without interface
        self.source = []  # frequencies of the run that the model is of
        self.tied = []  # nodes that depend on others, whose forces are theirs
        self.preload = None  # geometric stiffness about an origin, by the code that has the mesh
        self.losses = []  # marked nodes, their names, and the most that is left out of their static deflection
        self.second = self.effects = None  # of modal data: integrals of second order, mode by mode and x y z; what they allow

    def find(self, node, what):
        if node not in self.at:
            raise Refused('%s: the model has no node %d' % (what, node))
        return self.at[node]


# ---- files


def told(error):
    """What a library says, in one line."""
    text = ' '.join(str(error).split())[:300]
    return text if text and isinstance(error, (OSError, ValueError)) else '%s: %s' % (type(error).__name__, text)


def card_at(path, name, number):
    """Where a card stands in a deck, if it is not in an included file: FILE:LINE."""
    wanted = re.compile(r'\s*%s\*?[\s,]+%s(?![\w.])' % (re.escape(name), re.escape(str(number))), re.IGNORECASE)
    try:
        with open(path, encoding='latin-1') as file:
            return next(('%s:%d' % (path, k) for k, line in enumerate(file, 1) if wanted.match(line)), path)
    except OSError:
        return path


def deck_read(path):
    """A deck by pyNastran; of what is wrong in it the line, where the card is known."""
    from cpylog import SimpleLogger  # comes with pyNastran
    read_bdf, quiet = nastran('bdf.bdf').read_bdf, SimpleLogger('critical')

    def how(name):
        with contextlib.suppress(ImportError):  # where an INCLUDE is missing it would leave a file in the working directory
            importlib.import_module('pyNastran.bdf.bdf_interface.pybdf').BDFInputPy._dump_file = lambda *rest: None
        try:
            bdf = read_bdf(name, xref=False, log=quiet)
        except UnicodeDecodeError:  # remarks in an older code; its first look at a file takes that of the system
            module = nastran('bdf.bdf')
            module.open = functools.partial(open, encoding='latin-1')
            try:
                bdf = read_bdf(name, xref=False, log=quiet, encoding='latin1')
            finally:
                del module.open
        bdf.cross_reference(xref_loads=False, xref_constraints=False, xref_aero=False, xref_sets=False, xref_optimization=False)
        return bdf
    try:
        return opened(path, how)
    except Refused as error:
        text = str(error)
        card = re.search(r"card=\['(\w+)\*?', '([\w.+-]+)'|required by (\w+)[ ;](?:[a-z]+=)?(\d+)|cannot be read: \w+: '?(\w+) +(\d+)", text)
        name, number = [word for word in card.groups() if word] if card else (None, None)
        where = card_at(path, name, number) if card else path
        raise Refused(where + text[len(path):])


def nastran(package):
    """A module of pyNastran."""
    try:
        return importlib.import_module('pyNastran.' + package)
    except Exception as error:  # of one older than NumPy anything
        if importlib.util.find_spec('pyNastran') is None:
            raise Refused('pyNastran is not installed, which files of Nastran want: python3 -m pip install pyNastran')
        try:
            version = importlib.metadata.version('pyNastran')
        except importlib.metadata.PackageNotFoundError:
            version = 'of no known version'
        raise Refused('pyNastran %s is installed, but does not run with NumPy %s (%s): python3 -m pip install -U pyNastran, or an older NumPy'
                      % (version, np.__version__, told(error)))


DECKS, BOEING = ('.pch', '.dmig', '.bdf', '.dat', '.nas', '.blk', '.asm'), ('.matrix', '.hb', '.rsa', '.rua', '.hbmat')
USUAL = {  # names of matrices: of Nastran (external superelements, the sets a, x and g), of Abaqus, of users
    'K': ('KAAX', 'KAA', 'KXX', 'KGG', 'STIFFNESS', 'K'), 'M': ('MAAX', 'MAA', 'MXX', 'MGG', 'MASS', 'M'),
    'C': ('BAAX', 'BAA', 'BXX', 'BXX1', 'BGG', 'VISCOUSDAMPING', 'C'), 'structural': ('K4AAX', 'K4AA', 'K4XX', 'K4XX1', 'K4GG', 'STRUCTURALDAMPING')}
RIGHT = {'.op2': 'SOL 103 with PARAM,POST,-1 writes one', '.op4': 'OUTPUT4 writes one', '.mat': 'save -v7 of MATLAB or Octave writes one',
         '.npz': 'scipy.sparse.save_npz writes one', '.mtx': 'MatrixMarket is wanted'}


def opened(path, how, **more):
    """What a library reads from a file."""
    if not os.path.exists(path):
        raise Refused('%s: no such file' % path)
    try:
        with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()):  # of a card it says there what it then raises
            warnings.simplefilter('ignore')
            return how(path, **more)
    except (Exception, SystemExit) as error:  # each library has its own
        raise Refused('%s: cannot be read: %s (%s)' % (path, told(error), RIGHT.get(os.path.splitext(path)[1].lower(), 'a deck that Nastran runs is wanted')))


TEXT = bytes(range(32, 127)) + b'\t\r\n'  # SciPy crashes by a 0 among them, and by an end within an exponent


def market_check(path, most):
    """The head of a MatrixMarket file, which SciPy believes: it may announce more than the file, or the model, has."""
    with open(path, 'rb') as file:
        first = file.readline(1000).split()
        if len(first) != 5 or first[0].lower() != b'%%matrixmarket' or first[1].lower() != b'matrix':
            raise Refused('%s:1: %%%%MatrixMarket matrix coordinate real symmetric, or another such head, is wanted, not %r'
                          % (path, b' '.join(first)[:60].decode('latin-1')))
        number, line = 1, b'%'
        while line and (line.startswith(b'%') or not line.strip()):
            number, line = number + 1, file.readline(10000)
        at, tail = number + 1, b''
        for block in iter(lambda: file.read(1 << 20), b''):
            strange = block.translate(None, TEXT)[:1]
            at += (block[:block.index(strange)] if strange else block).count(b'\n')
            if strange:
                raise Refused('%s:%d: %r is no character of a matrix: a text is wanted' % (path, at, strange))
            tail = (tail + block)[-8:]
        if re.search(rb'[eEdD][-+]?$', tail):
            raise Refused('%s:%d: ends within a number: it is not whole' % (path, at))
    entry = 'rows columns entries' if first[2].lower() == b'coordinate' else 'rows columns'
    try:
        size = [int(word) for word in line.split()]
        if len(size) != len(entry.split()) or min(size) < 0:
            raise ValueError
    except ValueError:
        raise Refused('%s:%d: %s are wanted, not %r' % (path, number, entry, line[:60].decode('latin-1').strip()))
    if max(size[:2]) > most[0]:
        raise Refused('%s:%d: %d rows, %d columns; %s have %d degrees of freedom at most' % (path, number, *size[:2], most[1], most[0]))
    entries = size[2] if len(size) > 2 else size[0] * (size[1] + 1) // 2 if b'symmetric' in first[4].lower() else size[0] * size[1]
    if 2 * entries > os.path.getsize(path):
        raise Refused('%s:%d: %d entries are announced, the file has %d bytes: it is not whole' % (path, number, entries, os.path.getsize(path)))


def is_market(path):
    with open(path, 'rb') as file:
        return file.read(2) == b'%%'


@functools.lru_cache(maxsize=8)
def arrays(path, most):
    """Matrices of a file by name, each with the labels of its rows (node, degree of freedom), or None."""
    kind = os.path.splitext(path)[1].lower()
    if not os.path.exists(path):
        raise Refused('%s: no such file' % path)
    if kind in DECKS:
        return matrix_files.dmig(path)
    if kind in BOEING:
        return matrix_files.harwell_boeing(path, most)
    if kind == '.mtx' and not is_market(path):
        return matrix_files.abaqus(path, most)
    if kind == '.mat':
        found = {key: value for key, value in opened(path, scipy.io.loadmat).items() if not key.startswith('__')}
    elif kind == '.op4':
        found = {key: value.data for key, value in opened(path, nastran('op4.op4').read_op4, debug=None).items()}
    elif kind == '.mtx':
        market_check(path, most)
        found = {'': opened(path, scipy.io.mmread)}
    elif kind == '.npz':
        found = {'': opened(path, sparse.load_npz)}
    else:
        raise Refused('%s: no matrix: wants .mtx (MatrixMarket, Abaqus), .npz (SciPy), .mat, .op4, .pch (DMIG) or .matrix (Harwell-Boeing) at its end' % path)
    return {key: (value, None) for key, value in found.items()
            if getattr(value, 'ndim', 0) == 2 and getattr(value, 'dtype', np.dtype('O')).kind in 'biufc'}


def named(text, most, role='', wanted=True):
    """FILE:NAME of a matrix of FILE; of several without a name that which programs call so in this role (None: there is none)."""
    path, name = (text, '') if os.path.exists(text) or ':' not in text else text.rsplit(':', 1)
    found = arrays(path, most)
    if not name and len(found) > 1 or not wanted:
        usual = [key for key in found if key.upper() in USUAL.get(role, ()) and found[key][0].shape[0] != 1]  # 1 by 1: there is none
        if not wanted and (len(usual) != 1 or abs(found[usual[0]][0]).sum() == 0):
            return None
        name = usual[0] if len(usual) == 1 else name
    if name not in found and (name or len(found) != 1):
        raise Refused('%s: has the matrices %s: name one of them, %s:NAME' % (text, ', '.join(found), path) if found
                      else '%s: has no matrix of numbers' % text)
    name = name if name in found else next(iter(found))
    return path + ':' + name if name else path


def matrix(text, most):
    """A square sparse matrix from FILE or FILE:NAME; most: how many rows it may have, and what has them."""
    return labelled(text, most)[0]


def labelled(text, most):
    """That matrix, and the labels of its rows, or None."""
    text = named(text, most)
    path, name = (text, '') if os.path.exists(text) else text.rsplit(':', 1)
    progress('reading ' + text)
    A, labels = arrays(path, most)[name]
    if A.shape[0] != A.shape[1]:
        raise Refused('%s: %d rows, %d columns: it has to be square' % (text, *A.shape))
    if A.shape[0] == 0 or labels is None and A.shape[0] > most[0]:
        raise Refused('%s: %d rows; %s have %d degrees of freedom at most' % (text, A.shape[0], most[1], most[0]))
    try:
        A = sparse.csr_array(A)
        A.sum_duplicates()
    except (ValueError, IndexError) as error:  # of an .npz whose parts do not fit
        raise Refused('%s: is no matrix: %s' % (text, told(error)))
    if np.iscomplexobj(A.data):
        raise Refused('%s: complex: the real part is wanted, without structural damping' % text)
    A = A.astype(float)
    rows = np.repeat(np.arange(A.shape[0]), np.diff(A.indptr))
    for at in np.flatnonzero(~np.isfinite(A.data))[:1]:
        raise Refused('%s: row %d, column %d: %r is not finite' % (text, rows[at] + 1, A.indices[at] + 1, float(A.data[at])))
    off = abs(A - A.T).tocoo()
    if A.nnz and off.nnz and off.max() > SMALL * abs(A).max():
        at = off.data.argmax()
        i, j = sorted((int(off.row[at]), int(off.col[at])), reverse=True)
        raise Refused('%s: not symmetric: row %d, column %d has %.9g, row %d, column %d %.9g. Export all of it, or say symmetric in its '
                      'MatrixMarket header' % (text, i + 1, j + 1, A[i, j], j + 1, i + 1, A[j, i]))
    return A, labels


def number_of(kind, row, key, where):
    try:
        value = kind(row[key])
        if not abs(value) < 1e300 or kind is int and not FIRST <= value <= LAST:
            raise ValueError
        return value
    except (TypeError, ValueError):
        raise Refused('%s: %s: a %snumber is wanted, not %r' % (where, key, 'whole ' if kind is int else '', row[key]))


class Table:
    """A table of nodes: places, dofs (None: not said), and where each stands; modal: numbers of modal coordinates, one row each; axes of the
    displacements of each node, None: basic; order: of rows of a matrix without labels, the nodes and the modal coordinates."""

    def __init__(self, path):
        self.path, self.x, self.dofs, self.ids, self.modal, self.order, self.axes = path, [], [], {}, {}, [], None

    def node(self, number, where, x, dofs):
        if number in self.ids or number in self.modal:
            raise Refused('%s: node %d is there twice' % (where, number))
        self.order.append(number)
        if dofs == 'q':
            self.modal[number] = where
        else:
            self.ids[number] = where
            self.x.append(x)
            self.dofs.append(dofs)

    def place(self, rows, labels, name):
        """Per row of a matrix the row of six per node, and behind those of all nodes the modal ones."""
        at, n = {node: k for k, node in enumerate(self.ids)}, 6 * len(self.ids)
        if labels is not None:
            return self.place_of(labels, at, n, name)
        usual = {6 * len(self.x) + len(self.modal): '123456', 3 * len(self.x) + len(self.modal): '123'}.get(rows, '')
        modal, place = {node: n + k for k, node in enumerate(self.modal)}, []
        for number in self.order:
            if number in modal:
                place.append(modal[number])
            else:
                dofs = self.dofs[at[number]]
                place += [6 * at[number] + int(dof) - 1 for dof in (usual if dofs is None else dofs) if dof != '0']
        if len(place) != rows:
            raise Refused('%s: %d nodes%s with %d degrees of freedom, the matrices have %d rows: a column dofs says which each node has'
                          % (self.path, len(self.x), ' and %d modal coordinates' % len(modal) if modal else '', len(place), rows))
        return np.array(place, dtype=int)

    def place_of(self, labels, at, n, name):
        place, modal = [], 0
        for node, dof in labels:
            if node in at and dof > 0:
                place.append(6 * at[node] + dof - 1)
            elif dof == 0 or node in self.modal:
                place.append(n + modal)
                modal += 1
            else:
                raise Refused('%s: its row of node %d, degree of freedom %d: %s has no such node (NODE,,,,q: it is a modal coordinate)'
                              % (name, node, dof, self.path))
        if self.modal and modal != len(self.modal):
            raise Refused('%s: %d modal coordinates, %s has rows of %d' % (self.path, len(self.modal), name, modal))
        there = {p // 6 for p in place}
        for node, k in at.items():
            if not self.axes and self.dofs[k] != '0' and k not in there:
                raise Refused('%s: node %d has no rows in %s (dofs 0 says so)' % (self.ids[node], node, name))
        return np.array(place, dtype=int)


def csv_table(path):
    """node,x,y,z,dofs; dofs q: modal coordinates, 101-120,,,,q."""
    out = Table(path)
    try:
        with open(path, newline='', encoding='utf-8-sig', errors='surrogateescape') as file:  # of what is no UTF-8 nothing is used
            table = csv.DictReader(file, skipinitialspace=True)
            columns = [str(key).strip() for key in table.fieldnames or []]
            if not {'node', 'x', 'y', 'z'} <= set(columns) or len(set(columns)) < len(columns):
                raise Refused('%s:1: its first line has to name the columns: node,x,y,z,dofs' % path)
            for key in set(columns) - {'node', 'x', 'y', 'z', 'dofs', ''}:
                raise Refused('%s:1: column %r is not known: node,x,y,z,dofs are' % (path, key))
            table.fieldnames = columns
            lines = [('%s:%d' % (path, table.line_num), row) for row in table]
    except csv.Error as error:
        raise Refused('%s:%d: %s' % (path, table.line_num, error))
    for where, row in lines:
        dofs = row.get('dofs') if row.get('dofs') is None else row['dofs'].strip()
        if dofs is not None and list(dofs) != sorted(set(dofs) & set('123456')) and dofs not in ('0', 'q'):
            raise Refused('%s: dofs: some of 123456 in this order (x y z, rotations about them), 0, or q of a modal coordinate are wanted, not %r' % (where, dofs))
        ends = re.fullmatch(r'\s*(\d{1,10})\s*-\s*(\d{1,10})\s*', row['node'] or '') if dofs == 'q' else None
        first, last = (int(end) for end in ends.groups()) if ends else [number_of(int, row, 'node', where)] * 2
        if not first <= last < first + 100000:
            raise Refused('%s: node: at most 100000 modal coordinates, from the lower number to the higher, are wanted, not %r' % (where, row['node']))
        for node in range(first, last + 1):
            out.node(node, where, None if dofs == 'q' else [number_of(float, row, key, where) for key in 'xyz'], dofs)
    if not out.ids:
        raise Refused('%s: no nodes: a line 1,0,0,0 for each is wanted' % path)
    return out


def deck_table(path):
    """GRID, CORD, SPOINT and ASET cards of a deck of Nastran, such as the .asm of an external superelement; rows are in the order of numbers."""
    bdf, known, aset = nastran('bdf.bdf').BDF(debug=None), ('GRID', 'SPOINT', 'ASET', 'ASET1', 'CORD1R', 'CORD1C', 'CORD1S', 'CORD2R', 'CORD2C', 'CORD2S'), {}
    for name, fields, lines in matrix_files.cards(path):
        if name in known:
            try:
                bdf.add_card([name] + fields, name, is_list=True)
            except Exception as error:  # pyNastran has its own
                raise Refused('%s:%d: %s: cannot be read: %s' % (path, lines[0], name, told(error)))
    try:
        bdf.cross_reference()
        for card in bdf.asets:
            for node, dofs in zip(card.ids, card.components if isinstance(card.components, list) else [card.components] * len(card.ids)):
                aset[node] = ''.join(sorted(set(aset.get(node, '') + str(dofs).strip('0'))))
        out = Table(path)
        for node in sorted([*bdf.nodes, *bdf.spoints]):
            if node in bdf.nodes:
                out.node(node, path, bdf.nodes[node].get_position(), aset.get(node, '0' if aset else None))
            else:
                out.node(node, path, None, 'q')
        out.axes = [axes_at(bdf.nodes[node].cd_ref, x) for node, x in zip(out.ids, out.x)]
    except Refused:
        raise
    except Exception as error:
        raise Refused('%s: its grids cannot be read: %s' % (path, told(error)))
    if not out.ids:
        raise Refused('%s: no GRID: %s' % (path, '--nodes wants the file that has the interface nodes' if aset or bdf.spoints else 'a table node,x,y,z,dofs, or the .asm of the superelement, is wanted'))
    for node, x in zip(out.ids, out.x):
        if not np.all(np.isfinite(x)):
            raise Refused('%s: the place of grid %d is not finite' % (path, node))
    return out


def basic_by(place, axes):
    """Makes of a matrix of the model one of six rows per node, in basic axes; place: of each row, -1: it has none."""
    rows = np.flatnonzero(place >= 0)
    move = axes @ sparse.csr_array((np.ones(len(rows)), (place[rows], rows)), shape=(axes.shape[1], len(place)))

    def basic(A, name):
        if A.shape[0] != len(place):
            raise Refused('%s has %d rows, the model %d' % (name, A.shape[0], len(place)))
        return sparse.csr_array(move @ A @ move.T)
    return basic


# ---- modes from matrices


def rigid(x):
    """Rigid-body motion: displacements and rotations, six rows per node, by translations and rotations of the frame."""
    R = np.zeros((len(x), 6, 6))
    R[:, :3, :3] = R[:, 3:, 3:] = AXES
    R[:, :3, 3:] = -np.cross(x[:, None, :], AXES[None, :, :], axisa=2, axisb=2).transpose(0, 2, 1)
    return R.reshape(-1, 6)


def held_check(K, R):
    """K lets the structure move as a rigid body?"""
    norm = np.linalg.norm(R, axis=0)
    U, size, _ = np.linalg.svd(R / np.where(norm > 0, norm, 1), full_matrices=False)
    U = U[:, size > 1e-6]  # motions that the degrees of freedom have
    most = np.sqrt(np.einsum('ik,ik->k', abs(U), abs(K) @ abs(U)))
    free = int(np.sum(abs(linalg.eigvalsh((U / most).T @ (K @ (U / most)))) < 1e-12))
    if free:
        raise Refused('%d rigid-body motions are free: --frame wants the nodes of the interface, which are clamped '
                      '(or the structure hangs on a mechanism)' % free)


def row_name(model, p):
    return 'node %d, degree of freedom %d' % (model.ids[p // 6], p % 6 + 1)


def moved(x, A, place):
    """What K gives per row for unit translations, and for rotations about the row's own node, beside the sums of the sizes: 0 where the
    structure is free, and K and the places are of one order and one system of units. Columns of motions that the model cannot do are 0."""
    root, n = np.sqrt(np.maximum(A.diagonal(), 0)), len(place)
    out, sizes, first = np.zeros((2, 3, n)), np.zeros((2, n)), 0
    while first < n:  # in parts of a million entries
        last = max(first + 1, int(np.searchsorted(A.indptr, A.indptr[first] + 1000000)) - 1)
        last = min(last, n)
        moved_rows(x, A, place, root, slice(first, last), out, sizes)
        first = last
    return [abs(values).max(axis=0) / np.where(size > 0, size, 1) for values, size in zip(out, sizes)]


def moved_rows(x, A, place, root, rows, out, sizes):
    """moved, of some rows."""
    count = np.diff(A.indptr[rows.start:rows.stop + 1])
    entries = slice(A.indptr[rows.start], A.indptr[rows.stop])
    data, col, row = A.data[entries], A.indices[entries], np.repeat(np.arange(rows.stop - rows.start), count)
    own, dof = rows.start + row, place[col] % 6
    sums = lambda values: np.bincount(row, values, rows.stop - rows.start)
    d = (x[place[col] // 6] - x[place[own] // 6]).T
    size = abs(data) + 1e-8 * root[own] * root[col]  # of entries that are rounding alone that is what counts
    sizes[:, rows] = sums(size), sums(size * np.where(dof < 3, np.sqrt(np.sum(d * d, axis=0)), 1))
    has = np.isin(np.arange(3), place % 6)
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3  # turned about k, i moves by -d_j and j by d_i
        out[0, k, rows] = sums(data * (dof == k)) * has[k]
        out[1, k, rows] = sums(data * ((dof == j) * d[i] - (dof == i) * d[j] + (dof == 3 + k))) * (has[i] and has[j])


def order_check(model, K, place, options, hint=', which --grounded allows'):
    """K lets rigid-body motion go free of forces, but where it holds the structure to the ground? hint: what may be done about that."""
    pulled, turned = moved(model.x, K, place)
    limit = options.tolerance
    ground = np.unique(place[pulled > limit] // 6)
    wrong = np.flatnonzero((turned > limit) & (pulled <= 1e-6) & (place % 6 < 3))
    nodes = len(np.unique(place // 6))
    if len(wrong) > 0:
        at = wrong[turned[wrong].argmax()]
        raise Refused('%s: these are not the places of the rows of %s: turned as a rigid body it strains, node %d the most (%.2g of its forces '
                      'remain, of rounding 1e-16), %d of %d nodes. The nodes have to stand in the order of the rows, in the units of K and its axes%s'
                      % (options.nodes, options.matrices[0], model.ids[place[at] // 6], turned[at], len(np.unique(place[wrong] // 6)), nodes,
                         '; where elements do so, --tolerance %.2g' % (1.1 * turned[at]) if turned[at] < 0.1 else ''))
    count = np.bincount(place // 6, minlength=len(model.ids))
    whole = all(count[model.at[node]] == count.max() for node in options.frame)  # else rows of the frame were left out
    if len(ground) > (0 if options.frame and whole else nodes // 2) and not options.grounded:
        at = pulled.argmax()
        raise Refused('%s: moved as a rigid body it pulls at the ground, at %s the most (%.2g of its forces remain, of rounding 1e-16), at %d of %d nodes: '
                      'rows in another order than %s says (x y z of a node follow each other), rows that were left out (export K before '
                      'constraints), or springs to the ground%s'
                      % (options.matrices[0], row_name(model, place[at]), pulled[at], len(ground), nodes, options.nodes, hint))
    if len(ground) > 0:
        model.notes.append('K holds %d of %d nodes to the ground, node %d among them: this ground is the frame' % (len(ground), nodes, model.ids[ground[0]]))
    off = max(turned[(pulled <= 1e-6) & (place % 6 < 3)].max(initial=0), pulled[pulled <= limit].max(initial=0))
    if off > 1e-6:
        model.notes.append('moved as a rigid body K strains a little, %.2g of the forces of a node: digits of the file, elements that do so, or soft springs' % off)


def definite_check(rows, A, name, what):
    """Diagonals, and pairs of rows, which have these names, of a matrix that is not negative."""
    diagonal = A.diagonal()
    rounding = 1e-10 * abs(A).max()
    if diagonal.min() < -rounding:
        at = diagonal.argmin()
        raise Refused('%s: %s has the negative %s %.6g (row %d)' % (name, rows[at], what, diagonal[at], at + 1))
    coo, root = A.tocoo(), np.sqrt(np.maximum(diagonal, 0))
    over = abs(coo.data) - root[coo.row] * root[coo.col] * (1 + SMALL) - rounding
    if over.max(initial=0) > 0:
        at = over.argmax()
        raise Refused('%s: indefinite: %s and %s couple by %.6g, more than the root of the product of their own, %.6g and %.6g (rows %d and %d)'
                      % (name, rows[coo.row[at]], rows[coo.col[at]], coo.data[at],
                         diagonal[coo.row[at]], diagonal[coo.col[at]], coo.row[at] + 1, coo.col[at] + 1))


def coupled_check(model, K, M, place, options):
    """Nodes that M couples are such that K couples, as those of one element are: else the rows of M may have another order."""
    def pairs(A):
        coo, root = A.tocoo(), np.sqrt(np.maximum(A.diagonal(), 0))
        a, b = place[coo.row] // 6, place[coo.col] // 6
        return np.unique((a * len(model.ids) + b)[(a < b) & (abs(coo.data) > SMALL * root[coo.row] * root[coo.col])])
    of_mass = pairs(M)
    alone = np.setdiff1d(of_mass, pairs(K))
    if len(alone) > 0:
        a, b = (model.ids[k] for k in divmod(int(alone[0]), len(model.ids)))
        text = '%s couples nodes %d and %d, which %s does not, as %d of %d pairs' % (options.matrices[1], a, b, options.matrices[0], len(alone), len(of_mass))
        if 10 * len(alone) > len(of_mass):
            raise Refused(text + ': its rows have to be in the order of those of K')
        model.notes.append(text)


def most_negative(A):
    """Where the shape of the most negative eigenvalue of a small matrix moves most, or None."""
    size = np.sqrt(np.maximum(A.diagonal(), 1e-300))
    value, shape = linalg.eigh(A.toarray() / np.outer(size, size), subset_by_index=[0, 0])
    return int(abs(shape[:, 0]).argmax()) if value[0] < -1e-9 else None


def indefinite(model, A, place, name, what):
    """Refuses a matrix that has a negative eigenvalue; what solves with it, or None where it is small or singular."""
    progress('factor of %s, %d rows' % (name, A.shape[0]))
    heavy = np.flatnonzero(A.diagonal() > 0)
    part, solver, bad = A[heavy][:, heavy], None, None
    with contextlib.suppress(linalg.LinAlgError):  # singular, of which the modes tell more
        if len(heavy) <= 300:
            bad = most_negative(part)
        elif part.nnz > len(heavy):
            solver, bad = large.factored(part)
    if bad is not None:
        raise Refused('%s: indefinite %s, by a shape that moves %s' % (name, what, row_name(model, place[heavy[bad]])))
    return solver if len(heavy) == A.shape[0] else None


def solve(model, matrices, place, clamped, options):
    """Modes of K and M on the clamped interface, by shift and invert; takes the matrices out of the list, as memory counts."""
    K, M = matrices[:2]
    matrices.clear()
    n_mode = options.modes or min(6, K.shape[0])
    k_row, m_row = abs(K).max(axis=1).toarray().ravel(), abs(M).max(axis=1).toarray().ravel()
    for row in np.flatnonzero((k_row == 0) & (m_row > 0) & ~clamped[place // 6]):
        raise Refused('%s has mass and no stiffness: hold it, or leave it out (column dofs)' % row_name(model, place[row]))
    rows = row_names(model, place)
    progress('checks')
    definite_check(rows, K, options.matrices[0], 'stiffness')
    definite_check(rows, M, options.matrices[1], 'mass')
    order_check(model, K, place, options)
    coupled_check(model, K, M, place, options)
    if len(model.ids) <= import_report.DRAWN:
        coo, at = K.tocoo(), place // 6
        model.pairs = sorted({(int(a), int(b)) for a, b in zip(at[coo.row], at[coo.col]) if a < b})
    keep = np.flatnonzero((k_row > 0) & ~clamped[place // 6])
    K, M, R = K[keep][:, keep], M[keep][:, keep], rigid(model.x)[place[keep]]
    n = len(keep)
    heavy = int(np.sum(m_row[keep] > 0))
    if n == 0 or n_mode > heavy:
        raise Refused('--modes: %d wanted, there are %d degrees of freedom with mass' % (n_mode, heavy))
    held_check(K, R)
    small = n <= 300 or n_mode > n // 3
    solver = indefinite(model, K, place[keep], options.matrices[0], 'once the interface is clamped')
    indefinite(model, M, place[keep], options.matrices[1], 'as no mass is')
    try:
        solver = solver or large.factored(K)[0]
        if small:
            phi = linalg.eigh(M.toarray(), K.toarray(), subset_by_index=[n - n_mode, n - 1])[1]  # M may be singular
        else:
            phi = large.lowest(solver, M, n_mode, progress)
        phi /= np.sqrt(np.einsum('ik,ik->k', phi, M @ phi))
        value, turn = linalg.eigh(phi.T @ (K @ phi), phi.T @ (M @ phi))  # orthogonal to rounding
    except (linalg.LinAlgError, RuntimeError, ValueError) as error:
        raise Refused('%s, %s have no modes (%s): K is to be positive definite once the interface is clamped, M not negative' % (*options.matrices, told(error)))
    phi = phi @ turn
    phi *= np.sign(phi[abs(phi).argmax(axis=0), np.arange(n_mode)])
    share = value / np.einsum('ik,ik->k', abs(phi), abs(K) @ abs(phi))
    off = np.max(abs(K @ phi - M @ phi * value), axis=0) / np.max(abs(K) @ abs(phi), axis=0)
    if share[0] < 1e-14 or np.max(off) > 1e-7:
        at = abs(phi[:, 0]).argmax()
        raise Refused('K is singular: a mechanism moves %s the most' % row_name(model, place[keep[at]]))
    model.hz = np.sqrt(value) / (2 * np.pi)
    model.phi = np.zeros((6 * len(model.ids), n_mode))
    model.phi[place[keep]] = phi
    if len(keep) > LARGE and not large.cholmod:
        model.notes.append("%d rows were factored by SciPy's SuperLU, which takes several times the time and memory of CHOLMOD: python3 -m pip install "
                           "'scikit-sparse<0.5' (Debian: libsuitesparse-dev)" % len(keep))
    model.static = solver, place[keep], value, phi


def attached(model, M, options):
    """Adds the residual attachment modes [Ru] of the interface nodes to the modes: what these leave out of the static deflections by forces and
    moments there, orthogonal to them, so that static deflections of these nodes are whole."""
    if not model.static:
        raise Refused('--interface: wants K, which is not known here: --mark')
    solver, rows, value, phi = model.static
    nodes = [node for text in options.interface for node, _ in listed(text, '--interface')]
    at = np.flatnonzero(np.isin(rows // 6, [model.find(node, '--interface') for node in nodes]))
    F = np.zeros((len(rows), len(at)))
    F[at, np.arange(len(at))] = 1
    U, by = solver(F), phi[at]
    size = np.sqrt(np.einsum('ik,ik->k', U[at].T, np.eye(len(at))))
    rest, turn = linalg.eigh((U[at] - by / value @ by.T) / np.outer(size, size))  # static deflection that is left out
    if rest[0] < -1e-7:
        raise Refused('--interface: static deflections of these nodes are less than those of the modes alone (by %.2g of them): K is singular to rounding' % -rest[0])
    U = (U - phi / value @ by.T) / size @ turn[:, rest > 1e-9] / np.sqrt(rest[rest > 1e-9])  # of stiffness 1
    M = M[rows][:, rows]
    U -= phi @ (phi.T @ (M @ U))  # what rounding has left
    mass, turn = linalg.eigh(U.T @ (M @ U))
    if mass[0] < 1e-12 / value[0]:
        raise Refused('--interface: a load at these nodes moves no mass, so no mode carries its deflection: --mark, or mass there')
    extra, model.exact = (U @ turn / np.sqrt(mass))[:, ::-1], len(value)
    if len(value) + len(mass) > MODES:
        raise Refused('--interface: %d modes and %d more for static deflections, a description holds %d: fewer --modes or nodes' % (len(value), len(mass), MODES))
    model.static = solver, rows, np.concatenate([value, 1 / mass[::-1]]), np.hstack([phi, extra])
    model.hz = np.sqrt(model.static[2]) / (2 * np.pi)
    model.phi = np.zeros((len(model.phi), len(model.hz)))
    model.phi[rows] = model.static[3]
    model.notes.append('%d residual attachment modes (%.5g to %.5g Hz) keep the static deflection of the interface nodes' % (len(mass), model.hz[-len(mass)], model.hz[-1]))


def from_matrices(options):
    """Of matrices of all nodes, or of reduced ones, the model, its mass matrix, and what makes of a matrix one of six basic rows per node."""
    table = (deck_table if os.path.splitext(options.nodes)[1].lower() in DECKS else csv_table)(options.nodes)
    more = ' and %d modal coordinates' % len(table.modal) if table.modal else ''
    most = 6 * len(table.x) + len(table.modal), 'the %d nodes%s of %s' % (len(table.x), more, options.nodes)
    alone = len(options.matrices) == 1
    K_name, M_name = (named(options.matrices[0 if alone else k], most, role) for k, role in enumerate('KM'))
    if K_name == M_name:
        raise Refused('%s: is K and M in one: --matrices wants K M [C], or one file that has K and M' % K_name)
    C_name = named(options.matrices[-1], most, 'C', not alone) if alone or len(options.matrices) == 3 else None
    options.matrices = [name for name in (K_name, M_name, C_name) if name]
    files = [labelled(name, most) for name in options.matrices]
    model = Model(table.ids, table.x)
    for role, what in (('C', 'a third matrix of --matrices takes it'), ('structural', "a factor G of it is a damping ratio of G/2 at resonance, --word 'damping G/2'")):
        name = named(K_name, most, role, False)
        if name and name != C_name:
            model.notes.append('%s is not taken: %s' % (name, what))
    matrices, place = placed(table, files, options)
    del files
    arrays.cache_clear()
    few = len(np.unique(place // 6)) <= FEW  # statically reduced, without modal coordinates
    if np.any(place >= 6 * len(model.ids)) or few and K_name.rsplit(':', 1)[-1].upper() in ('KAAX', 'KAA', 'KXX', 'STIFFNESS'):
        return reduced(model, matrices, place, table, options, most)
    if C_name:
        model.notes.append('%s is not taken: of matrices of all nodes damping is modal, --word \'damping RATIO\'' % C_name)
    if table.axes and any(abs(turn - AXES).max() > SMALL for turn in table.axes):
        raise Refused('%s: displacements of its grids are in axes of their own (CD): of matrices of all nodes basic ones are wanted' % options.nodes)
    basic = basic_by(place, sparse.csr_array(sparse.eye(6 * len(model.ids))))
    M_basic = basic(matrices[1], options.matrices[1])
    clamped = np.zeros(len(model.ids), dtype=bool)
    for node in options.frame:
        clamped[model.find(node, '--frame')] = True
    solve(model, matrices, place, clamped, options)
    return model, M_basic, basic, most


def mesh_items(deck, text, what):
    """Nodes by commas, numbers or names of sets, each with its own name: lists of nodes that move as one, and names."""
    for item in text.split(','):
        word, _, name = item.strip().partition(':')
        if re.fullmatch(r'[\d/ -]+', word):
            yield from (([node], called) for node, called in listed(item, what) for node in deck.nodes(str(node), what))
        else:
            yield deck.nodes(word, what), name or re.sub(r'\W', '_', word)


def free_modes(model, K, M, place, options):
    """Modes of a structure that nothing holds, by K + mu M, without the rigid-body ones; its static deflections are those by inertia relief:
    loads and the inertia forces of the rigid-body motion that they give."""
    R = rigid(model.x)[place]
    mass = R.T @ (M @ R)
    mu = 1e-10 * K.diagonal().max() / M.diagonal().max()
    kept, options.modes = options.modes, (options.modes or 6) + 6
    solve(model, [sparse.csr_array(K + mu * M), M], place, np.zeros(len(model.ids), dtype=bool), options)
    options.modes = kept
    shifted, rows, value, phi = model.static
    n = int(np.sum(value - mu < 1e-3 * mu))
    if n > 6:
        raise Refused('%s: %d motions have no stiffness, a rigid body has 6: a mechanism, or parts that are not joined' % (options.matrices[0], n))
    place = list(place)
    order = [place.index(row) for row in rows]
    R, M = R[order], M[order][:, order]

    def solver(load):
        load = load - M @ (R @ linalg.solve(mass, R.T @ load))
        x = shifted(load)
        for _ in range(12):  # mu is small beside the squares of elastic frequencies
            x = shifted(load + mu * (M @ x))
            x -= R @ linalg.solve(mass, R.T @ (M @ x))
        return x
    model.static, model.free = (solver, rows, value[n:] - mu, phi[:, n:]), True
    model.hz, model.phi = np.sqrt(model.static[2]) / (2 * np.pi), model.phi[:, n:]
    model.notes.append('%d rigid-body modes are left out: such motion is that of the frame. It stiffens as it spins freely; what loads at nodes do to its stiffness is not in it' % n)


def from_mesh(options):
    """Of a mesh, by CalculiX."""
    path = options.files[0]
    deck = mesh.Deck(path)
    if options.frame:
        deck.supports = [(node, 1, 6) for nodes, _ in mesh_items(deck, options.frame, '--frame') for node in nodes]
    marks = [[item for text in texts for item in mesh_items(deck, text, what)] for texts, what in ((options.mark, '--mark'), (options.interface, '--interface'))]
    with mesh.folder() as folder:
        if deck.thin:
            mesh.as_solids(deck, folder, {nodes[0] for items in marks for nodes, _ in items if len(nodes) == 1})
        ends = [[(nodes[0] if len(nodes) == 1 else deck.interface(nodes), name) for nodes, name in items] for items in marks]
        rows = mesh.Rows(deck, folder)
    for node, _ in ends[0] + ends[1]:
        if node not in rows.ids:
            raise Refused('%s: node %d has no degrees of freedom of its own: others move it, or it is held by a rigid body. Name its reference node' % (path, node))
    options.mark, options.interface = [['%d:%s' % end if end[1] else str(end[0]) for end in part] for part in ends]
    options.mark = options.mark + options.interface
    options.frame = mesh.clamped(deck, rows)
    options.matrices, options.nodes = [path, path], path
    model = Model(rows.ids, rows.x)
    model.notes += deck.notes
    model.tied = [other for node in deck.rotation for other in [node, *deck.stand.get(node, [])]]
    basic = basic_by(rows.place, sparse.csr_array(sparse.eye(6 * len(model.ids))))
    if options.frame:
        solve(model, [rows.K, rows.M], rows.place, np.isin(model.ids, options.frame), options)
    else:
        free_modes(model, rows.K, rows.M, rows.place, options)
    if len(options.files) == 2:
        model.source = mesh.frequencies(options.files[1])
        have, want = (hz[:min(len(model.hz), len(model.source))] for hz in (model.hz, model.source))
        off = abs(have / want - 1)
        at = off.argmax()
        model.notes.append('frequencies are those of %s to %.2g%s' % (options.files[1], off[at], '' if off[at] < 1e-3 else
                           ' (mode %d: %.6g Hz, there %.6g): other supports, or a set that is a rigid body here' % (at + 1, have[at], want[at])))

    def preload(origin):
        about, M = Model(model.ids, model.x - origin), basic(rows.M, path)
        about.free = model.free
        with mesh.folder() as folder:
            return [basic(A, path) for A in mesh.preloaded(deck, folder, rows, inertia_loads(about, M), rigid(about.x)[rows.place])]
    model.preload = preload
    return model, basic(rows.M, path), basic, None


def placed(table, files, options):
    """The matrices with the same rows, and the place of each row."""
    names = options.matrices
    labels = sorted({label for _, of in files for label in of or []})
    if any((of is None) != (files[0][1] is None) for _, of in files):
        raise Refused('%s: one names its rows, another does not: files of one kind are wanted' % ', '.join(names))
    if files[0][1] is None or all(of == files[0][1] for _, of in files):
        for (A, _), name in zip(files[1:], names[1:]):
            if A.shape != files[0][0].shape:
                raise Refused('%s has %d rows, the model %d' % (name, A.shape[0], files[0][0].shape[0]))
        return [A for A, _ in files], table.place(files[0][0].shape[0], files[0][1], names[0])
    at = {label: k for k, label in enumerate(labels)}  # rows that are zero are not written
    out = []
    for A, of in files:
        to = np.array([at[label] for label in of], dtype=int)
        A = A.tocoo()
        out.append(sparse.csr_array((A.data, (to[A.row], to[A.col])), shape=(len(labels),) * 2))
    return out, table.place(len(labels), labels, ', '.join(names))


# ---- reduced matrices: rows of interface nodes and of modal coordinates
# [CB]  R. R. Craig, M. C. C. Bampton, Coupling of substructures for dynamic analyses, AIAA Journal 6 (1968) 1313-1319
# [Ru]  S. Rubin, Improved component-mode representation for structural dynamic analysis, AIAA Journal 13 (1975) 995-1006

ROWS = 4000  # of reduced matrices, which are dense


def row_names(model, place):
    """What a row of reduced matrices is called."""
    n = 6 * len(model.ids)
    return [row_name(model, p) if p < n else 'modal coordinate %d' % (p - n + 1) for p in place]


def local_axes(table, model, place):
    """Turns rows to basic axes: a matrix next to the unit one."""
    turn = np.eye(len(place))
    for k, axes in enumerate(table.axes or []):
        if abs(axes - AXES).max() <= SMALL:
            continue
        for first in 0, 3:
            rows = [np.flatnonzero(place == 6 * k + first + i) for i in range(3)]
            have = [len(row) for row in rows]
            if any(have) and not all(have):
                raise Refused('%s: node %d has some of its directions only, in axes of its own (CD): all three, or basic axes, are wanted'
                              % (table.path, model.ids[k]))
            if all(have):
                at = np.concatenate(rows)
                turn[np.ix_(at, at)] = axes
    return turn


def uncoupled(model, matrices, place, names, table):
    """The modal coordinates as motions with the interface held: K has then no entries between the two, as fixed-interface modes have none."""
    modal = np.flatnonzero(place >= 6 * len(model.ids))
    interface = np.flatnonzero(place < 6 * len(model.ids))
    K = matrices[0]
    if len(modal) == 0:
        return matrices
    own, cross = K[np.ix_(modal, modal)], K[np.ix_(modal, interface)]
    size = np.sqrt(np.maximum(np.diag(own), 1e-300))
    value, shape = linalg.eigh(own / np.outer(size, size))
    if value[0] < 1e-12:
        raise Refused('%s: %s has no stiffness of its own: rigid-body or free-interface modes, where modes with the interface held are wanted, or rows '
                      'in another order than %s says' % (names[0], row_names(model, place)[modal[abs(shape[:, 0]).argmax()]], table))
    if abs(cross).max() <= 1e-12 * np.sqrt(abs(K).max() * np.diag(own).max()):
        return matrices
    model.notes.append('K couples modal coordinates with the interface: they are taken beside the static motion of the interface')
    T = np.eye(len(place))
    T[np.ix_(modal, interface)] = -linalg.solve(own, cross, assume_a='pos')
    return [T.T @ A @ T for A in matrices]


def rounding_only(K, M, interface):
    """K of one interface node alone, whose motion is rigid, is rounding beside the slowest modal coordinate?"""
    modal = np.setdiff1d(np.arange(len(K)), interface)
    if len(modal) == 0:
        return False
    slow = min(K[k, k] / max(M[k, k], 1e-300) for k in modal)
    fast = max(abs(K[k, k]) / max(M[k, k], 1e-300) for k in interface)
    return fast < 1e-6 * slow


def own_inertia(M, held, R):
    """The least share of mass or inertia that stays at the held rows while all other coordinates move freely: 0, and a free base is singular."""
    rest = M[np.ix_(held, held)] - M[np.ix_(held, ~held)] @ np.linalg.lstsq(M[np.ix_(~held, ~held)], M[np.ix_(~held, held)], rcond=1e-14)[0]
    size = np.sqrt(np.maximum(np.diag(R.T @ M @ R), 1e-300))
    return np.linalg.eigvalsh(R[held].T @ rest @ R[held] / np.outer(size, size))[0]


def default_frame(model, place, M, R):
    """The node that is held unless --frame says another: the first that has all degrees of freedom, and inertia of its own if one has."""
    whole = [node for node, k in model.at.items() if np.sum(place // 6 == k) == 6]
    if not whole:
        raise Refused('no interface node has all six degrees of freedom: --frame wants the nodes that carry the frame of the body')
    return [next((node for node in whole if own_inertia(M, place // 6 == model.at[node], R) > 1e-9), whole[0])]


def without_empty(model, matrices, place):
    """Rows that have neither stiffness nor mass, which no element reaches, are left out."""
    empty = np.flatnonzero(sum(abs(A).max(axis=1).toarray().ravel() for A in matrices[:2]) == 0)
    if len(empty) == 0:
        return matrices, place
    rows = row_names(model, place[empty])
    model.notes.append('%d rows have neither stiffness nor mass and are left out: %s%s' % (len(rows), '; '.join(rows[:3]), '; ..' if len(rows) > 3 else ''))
    keep = np.setdiff1d(np.arange(len(place)), empty)
    return [A[keep][:, keep] for A in matrices], place[keep]


def reduced_check(model, matrices, place, options):
    """What is refused before anything is computed."""
    names = options.matrices
    if options.line or options.geometric or options.condense or options.grounded:
        raise Refused('--line, --geometric, --condense and --grounded are for matrices of all nodes: reduced ones have no places of masses')
    if len(place) > ROWS:
        raise Refused('%s: %d rows: reduced matrices of at most %d are wanted; those of all nodes have no modal rows' % (names[0], len(place), ROWS))
    if not np.any(place < 6 * len(model.ids)):
        raise Refused('%s: all rows are modal coordinates: those of an interface node are wanted, too' % options.nodes)
    if len(set(place)) < len(place):
        raise Refused('%s: node %d has a degree of freedom twice' % (names[0], model.ids[min(p for p in place if np.sum(place == p) > 1) // 6]))
    for what, texts in (('--frame', map(str, options.frame)), ('--mark', options.mark)):
        for node, _ in [item for text in texts for item in listed(text, what)]:
            if not np.any(place // 6 == model.find(node, what)):
                raise Refused('%s: node %d has no rows in %s' % (what, node, names[0]))
    for A, name, what in zip(matrices, names, ('stiffness', 'mass')):
        definite_check(row_names(model, place), A, name, what)


def interface_motion(model, place, options):
    """Rigid-body motion of the rows; modal coordinates, which are motions with the interface held, have none."""
    interface = np.flatnonzero(place < 6 * len(model.ids))
    about = rigid(model.x - model.x[np.unique(place[interface] // 6)].mean(axis=0))[place[interface]]
    norm = np.linalg.norm(about, axis=0)
    if np.linalg.svd(about / np.where(norm > 0, norm, 1), compute_uv=False)[-1] < 1e-6:
        raise Refused('%s: the interface nodes have no motion for some rotation of the body: its inertia is not in the matrices. A node with all six '
                      'degrees of freedom, or three nodes off one line, are wanted' % options.nodes)
    R = np.zeros((len(place), 6))
    R[interface] = rigid(model.x)[place[interface]]
    return R


def held_rows(model, place, M, R, options):
    """The rows of the frame, which are held; the other interface nodes are marked unless --mark says which."""
    there = [node for node, k in model.at.items() if np.any(place // 6 == k)]
    if not options.frame:
        options.frame = default_frame(model, place, M, R)
        others = ', '.join(str(node) for node in there if node not in options.frame)
        if others:
            model.notes.append('held at node %d, which carries the frame of the body (--frame takes another: %s)' % (options.frame[0], others))
    if options.origin is None:
        options.origin = str(options.frame[0])
    options.mark = options.mark or [str(node) for node in there if node not in options.frame or str(node) != options.origin]
    held = np.isin(place // 6, [model.at[node] for node in options.frame])
    if np.all(held):
        raise Refused('--frame: all interface nodes are held, and there are no modal coordinates: nothing moves')
    if own_inertia(M, held, R) < 1e-9:
        model.notes.append('node %s has no inertia of its own in some direction: a free base, or a joint that lets it move so, wants a hub on the frame '
                           '(--word \'hub ..\'), or another --frame' % ', '.join(map(str, options.frame)))
    return held


def dense_check(A, rows, name, what):
    """Refuses a dense matrix that has a negative eigenvalue."""
    size = np.sqrt(np.maximum(np.diag(A), 1e-300))
    value, shape = linalg.eigh(A / np.outer(size, size), subset_by_index=[0, 0])
    if value[0] < -1e-9:
        raise Refused('%s: indefinite %s, by a shape that moves %s' % (name, what, rows[abs(shape[:, 0]).argmax()]))


def reduced(model, matrices, place, table, options, most):
    """Modes of reduced matrices with one interface held; they keep the static deflections at the other interface nodes."""
    names = options.matrices
    matrices, place = without_empty(model, matrices, place)
    reduced_check(model, matrices, place, options)
    turn = local_axes(table, model, place)
    K, M, *C = uncoupled(model, [turn @ ((A + A.T) / 2).toarray() @ turn.T for A in matrices], place, names, options.nodes)
    interface = np.flatnonzero(place < 6 * len(model.ids))
    if np.ptp(place[interface] // 6) == 0 and rounding_only(K, M, interface):
        K[np.ix_(interface, interface)] = 0
    R = interface_motion(model, place, options)
    held = held_rows(model, place, M, R, options)
    order_check(model, sparse.csr_array(K[np.ix_(interface, interface)]), place[interface], options,
                ', which a body has not: they belong to the scene; where elements pull so, --tolerance')
    keep = np.flatnonzero(~held)
    held_check(sparse.csr_array(K[np.ix_(keep, keep)]), R[keep])
    rows = row_names(model, place)
    dense_check(K[np.ix_(keep, keep)], [rows[k] for k in keep], names[0], 'once the interface is held')
    dense_check(M, rows, names[1], 'as no mass is')

    mass, shape, massive = all_modes(K[np.ix_(keep, keep)], M[np.ix_(keep, keep)], names)
    nodes = [node for text in options.mark for node, _ in listed(text, '--mark')]
    value, phi = second_reduction(model, options, mass, shape, massive, shape[np.isin(place[keep] // 6, [model.at[node] for node in nodes])])
    model.hz = np.sqrt(value) / (2 * np.pi)
    whole = np.zeros((len(place), len(value)))
    whole[keep] = phi
    model.phi = np.zeros((6 * len(model.ids), len(value)))
    model.phi[place[interface]] = whole[interface]
    model.static = functools.partial(linalg.cho_solve, linalg.cho_factor(K[np.ix_(keep, keep)])), place[keep], value, phi
    model.reduced = place, M, whole
    partial = [str(node) for node in nodes if np.sum(place // 6 == model.at[node]) < 6]
    if partial:
        model.notes.append('of node %s the matrices have some of the six degrees of freedom only: what a load does along the others, and a sensor of them, is zero'
                           % ', '.join(partial))
    model.notes.append('the matrices have no places of masses: Coriolis coupling of modes with each other, centrifugal loads that stretch, and inertia that '
                       'grows with the square of deflection are estimates')
    if C:
        damped(model, C[0], whole, value, R, options)
    return model, None, None, most


def all_modes(K, M, names):
    """Shapes of all coordinates, orthogonal and of stiffness 1, and their masses in falling order, with relative accuracy by their quotients."""
    try:
        mass, shape = linalg.eigh(M, K)
    except linalg.LinAlgError as error:
        raise Refused('%s, %s have no modes (%s): K is to be positive definite once the interface is held, M not negative' % (*names[:2], told(error)))
    shape = shape[:, ::-1]
    shape = shape * np.sign(shape[abs(shape).argmax(axis=0), np.arange(len(mass))])
    return np.einsum('ik,ik->k', shape, M @ shape) / np.einsum('ik,ik->k', shape, K @ shape), shape, int(np.sum(mass > 1e-15 * mass[-1]))


def residual_modes(mass, shape, at, low):
    """Masses, and shapes of modal mass 1, of what all coordinates but the lowest give under each load at these rows, and how many have no mass."""
    basis, size, _ = np.linalg.svd(at[:, low:].T, full_matrices=False)  # in the other coordinates, in which K is 1
    basis = basis[:, size > 1e-12 * size.max(initial=0)]
    if basis.shape[1] == 0:
        return np.zeros(0), np.zeros((len(shape), 0)), 0
    own, turn = linalg.eigh(basis.T @ (basis * mass[low:, None]))
    heavy = np.flatnonzero(own > 1e-15 * mass[0])[::-1]
    return own[heavy], shape[:, low:] @ basis @ turn[:, heavy] / np.sqrt(own[heavy]), len(own) - len(heavy)


def second_reduction(model, options, mass, shape, massive, at):
    """At most so many modes as a description holds: the lowest, and residual attachment modes by loads at the marked nodes, which keep their
    static deflections [Ru]: what all others, massless ones among them, give under each load, orthogonal to all. at: rows of the marked nodes.
    Squares of frequencies, and shapes of modal mass 1."""
    keep = options.modes or min(massive, MODES)
    if keep > MODES:
        raise Refused('--modes: %d wanted, a description holds %d' % (keep, MODES))
    if keep > massive:
        raise Refused('--modes: %d wanted, there are %d coordinates with mass once the interface is held' % (keep, massive))
    if keep == massive and abs(at[:, massive:]).max(initial=0) <= 1e-9 * abs(at).max(initial=0):
        return 1 / mass[:keep], shape[:, :keep] / np.sqrt(mass[:keep])
    if len(at) > keep < massive:
        raise Refused('--mark: the marked nodes (without --mark all of the interface) have %d degrees of freedom, and each wants a mode for its static '
                      'deflection: of %d modes%s mark fewer nodes' % (len(at), keep, '' if keep == MODES else ', at most %d,' % MODES))
    least = max(keep - len(at), 0)
    own, _, weightless = residual_modes(mass, shape, at, least)
    most = keep - len(own) - weightless  # some loads may give the same
    for low in [*range(most, -1, -1), keep - len(own)]:  # fewer of the lowest, until what each load gives has mass; where none has it, as before
        own, extra, weightless = residual_modes(mass, shape, at, low)
        if not weightless:
            break
    own, extra = own[:keep - low], extra[:, :keep - low]
    hz, residual = 1 / np.sqrt(mass[:massive]) / (2 * np.pi), 1 / np.sqrt(own) / (2 * np.pi)
    model.dropped, model.exact = hz[low:], low
    model.notes.append('of %d modes the lowest %d are kept%s; dropped are the modes of %s Hz%s'
                       % (massive, low, ' (to %.6g Hz)' % hz[low - 1] if low else '', ' '.join('%.5g' % f for f in hz[low:][:12]) + (' .. %.5g' % hz[-1] if massive - low > 12 else ''),
                          ', in whose place %d residual attachment modes (%.5g to %.5g Hz) keep the static deflection of the marked nodes'
                          % (len(own), residual[0], residual[-1]) if len(own) else ''))
    return np.concatenate([1 / mass[:low], 1 / own]), np.hstack([shape[:, :low] / np.sqrt(mass[:low]), extra])


def damped(model, C, whole, value, R, options):
    """Modal damping ratios of C."""
    by = whole.T @ C @ whole
    ratio = np.diag(by) / (2 * np.sqrt(value))
    if ratio.min() < -1e-9:
        raise Refused('%s: mode %d would have the damping ratio %.4g: damping is not negative' % (options.matrices[2], ratio.argmin() + 1, ratio.min()))
    if any(word.split()[0] == 'damping' for word in options.word):
        model.notes.append('%s is not taken: --word gives the damping' % options.matrices[2])
        return
    options.word = options.word + ['damping ' + numbers(np.maximum(ratio, 0), 9)]
    size = np.sqrt(np.outer(np.maximum(np.diag(by), 1e-300), np.maximum(np.diag(by), 1e-300)))
    off = abs(by - np.diag(np.diag(by))) / size
    if off.max() > 0.01:
        model.notes.append('%s couples modes, up to %.2g of the root of the product of their own damping, which is left out: damping is modal'
                           % (options.matrices[2], off.max()))
    ground = np.linalg.norm(C @ R) / max(np.linalg.norm(C) * np.linalg.norm(R), 1e-300)
    if ground > 1e-6:
        model.notes.append('%s damps rigid-body motion (%.2g of its size), which a body does not: that is left out' % (options.matrices[2], ground))


def momenta(model, M):
    """Mass matrix of rigid-body motion and modes."""
    S = np.hstack([rigid(model.x), model.phi])
    if not model.reduced:
        return S.T @ (M @ S)
    place, M, whole = model.reduced
    S = np.vstack([S, np.zeros((place.max(initial=0) + 1, S.shape[1]))])[place]
    modal = place >= 6 * len(model.ids)
    S[modal] = 0
    S[modal, 6:] = whole[modal]
    return S.T @ M @ S


def directions(model, motion, F, places):
    """Per mode the shares of the directions in what it has beyond a rigid-body motion, as 3 x 3 matrices of trace 1, an estimate: those of the
    interface nodes beside that motion, else of the motion itself, F by 1, x, y, z, else the same in all directions."""
    n = len(model.hz)
    own = (model.phi - rigid(model.x) @ motion).reshape(-1, 6, n)[:, :3] * (abs(model.phi).reshape(-1, 6 * n).max(axis=1) > 0)[:, None, None]
    F = F.reshape(4, n, 3).transpose(1, 0, 2)
    shares = np.einsum('pik,pjk->kij', own, own), F.transpose(0, 2, 1) @ places @ F
    out = np.tile(AXES / 3, (n, 1, 1))
    for share, least in zip(shares[::-1], (1e-3, 1e-18 * max(np.max(abs(shares[0])), 1e-300))):
        trace = np.einsum('kii->k', share)
        out = np.where((trace > least)[:, None, None], share / np.where(trace > least, trace, 1)[:, None, None], out)
    return out


def spread(model, want):
    """Points that stand for the masses of reduced matrices, exact in mass, center, inertia, first moments and modal masses."""
    n = len(model.hz)
    motion = np.linalg.pinv(want[:6, :6], rcond=1e-12, hermitian=True) @ want[:6, 6:]
    places, cross = np.zeros((4, 4)), want[3:6, :3]
    places[0, 0] = want[0, 0]
    places[0, 1:] = places[1:, 0] = [cross[2, 1], cross[0, 2], cross[1, 0]]
    places[1:, 1:] = moments(want[3:6, 3:6])
    F = np.hstack([np.eye(4), np.zeros((4, 3 * n))])  # by 1, x, y, z: of each direction of a mode its rigid-body motion
    for i in range(3):
        F[0, 4 + i::3], F[1:, 4 + i::3] = motion[i], skew(AXES[i]) @ motion[3:]

    rest = root(want[6:, 6:] - want[:6, 6:].T @ motion)  # beyond it; each direction has its share
    half = np.concatenate([root(share) for share in directions(model, motion, F[:, 4:], places)])
    Q = half @ half.T * np.kron(rest @ rest, np.ones((3, 3)))
    have = sum(Q[i::3, i::3] for i in range(3))
    size = np.sqrt(np.maximum(np.diag(have), 1e-30))
    unit = np.outer(size, size)
    C = np.kron(change(have / unit, rest @ rest / unit) * size[:, None] / size, AXES)
    S = F.T @ places @ F
    S[4:, 4:] += C @ Q @ C.T
    return points(S, max(model.ids) + 1)


# ---- modal data without a mesh: the frame of the body and modal coordinates, as of reduced matrices


def body_of(text):
    """MASS,X,Y,Z,XX,YY,ZZ,XY,XZ,YZ: mass matrix of a rigid body about the origin."""
    try:
        mass, *center = (value := [float(word) for word in text.split(',')])[:4]
        xx, yy, zz, xy, xz, yz = value[4:]
    except ValueError:
        value = [math.nan]
    if not all(map(math.isfinite, value)):
        raise Refused('--body: mass, mass center x y z and inertia about it xx yy zz xy xz yz are wanted, 10 numbers with commas between, not %r' % text)
    return body_block(mass, np.array(center), np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))


def places_of(flex, options):
    """Numbers and places of the nodes, then of the joints that --joint places, 1000 + their numbers, and the shapes there."""
    x, joints = list(flex42.nodes(options.nodes)), flex.joints()
    ids, shape = list(range(len(x))), [flex.shapes('', k) for k in range(len(x))]
    for text in options.joint:
        found = re.fullmatch(r'(\d+):([^,]+),([^,]+),([^,]+)', text)
        try:
            number, place = int(found[1]), [float(word) for word in found.groups()[1:]]
        except (TypeError, ValueError):
            raise Refused('--joint: NUMBER:X,Y,Z is wanted, not %r' % text)
        if number not in joints or 1000 + number in ids:
            raise Refused('--joint %s: %s has shapes at joints %s, each once' % (text, options.modal, ', '.join(map(str, joints)) or '(none)'))
        ids.append(1000 + number)
        x.append(place)
        shape.append(flex.shapes('joint_', number))
    return ids, x, np.array(shape).reshape(-1, flex.n), [k for k in joints if 1000 + k not in ids]


def from_modal(options):
    """The model of modal data, as of reduced matrices with one interface node at the origin that the modes do not move."""
    flex = flex42.Flex(options.modal, MODES, len(flex42.nodes(options.nodes)))
    ids, x, shape, lost = places_of(flex, options)
    model, n, frame = Model([*ids, 2000], [*x, [0, 0, 0]]), flex.n, 6 * len(ids)
    place = np.concatenate([frame + np.arange(6), 6 * len(model.ids) + np.arange(n)])
    M = np.block([[body_of(options.body), np.vstack([flex.P, flex.H])], [np.hstack([flex.P.T, flex.H.T]), flex.M]])
    dense_check(flex.K, ['mode %d' % k for k in range(n)], options.modal, 'stiffness')
    dense_check(M, ['the body along x', 'y', 'z', 'about x', 'y', 'z', *('mode %d' % k for k in range(n))], options.modal,
                'as no mass is: modes carry more than --body has')
    mass, phi, _ = all_modes(flex.K, flex.M, [options.modal, options.modal])
    phi = phi / np.sqrt(mass)
    model.hz, model.exact = 1 / np.sqrt(mass) / (2 * np.pi), n
    whole = np.vstack([np.zeros((6, n)), phi])
    model.phi = np.vstack([shape @ phi, np.zeros((6, n))])
    model.reduced, model.static = (place, M, whole), None
    options.mark = options.mark or [str(node) for node in ids]
    options.origin = options.origin or '0,0,0'
    options.frame, options.matrices = [2000], [options.modal] * 3
    model.notes.append('--body is taken for the whole body, its modes at rest')
    if flex.start.any():
        model.notes.append('the initial modal states are not taken: start_mode of a scene')
    if lost:
        model.notes.append('shapes at joints %s are not taken: the file has no places of joints, --joint %d:X,Y,Z has' % (', '.join(map(str, lost)), lost[0]))
    model.second, model.effects = flex.second(options.modal), 'spin'
    if model.second:
        by = np.kron(phi, AXES)
        model.second = model.second[0] @ by, by.T @ model.second[1] @ by
    else:
        model.effects = 'linear'
        model.notes.append('without elements of both L and N the modes have no places of masses: effects linear, what 42 computes without second-order flex terms')
    if flex.C is not None:
        damped(model, M * 0 + np.pad(flex.C, ((6, 0), (6, 0))), whole, (2 * np.pi * model.hz)**2, np.eye(len(place), 6), options)
    return model, None, None, None


def modal_points(model, want):
    """Points with the integrals of second order that the data have."""
    cross, (L, N) = want[3:6, :3], model.second
    S = np.zeros((4 + len(N), 4 + len(N)))
    S[0, 0], S[0, 1:4], S[0, 4:] = want[0, 0], [cross[2, 1], cross[0, 2], cross[1, 0]], want[:3, 6:].T.ravel()
    S[1:4, 1:4], S[1:4, 4:], S[4:, 4:] = np.trace(want[3:6, 3:6]) / 2 * AXES - want[3:6, 3:6], L, N
    return points(np.triu(S) + np.triu(S, 1).T, max(model.ids) + 1)


# ---- Nastran


def damping_of(bdf):
    """What of a deck is damping, which real modes do not have."""
    if 'G' in bdf.params and bdf.params['G'].values[0]:
        yield 'PARAM,G %g' % bdf.params['G'].values[0]
    for number in sorted(bdf.tables_sdamping):
        yield 'TABDMP1 %d' % number
    for number, card in sorted(bdf.materials.items()):
        if getattr(card, 'ge', None):
            yield '%s %d GE %g' % (card.type, number, card.ge)
    for name in ('CDAMP1', 'CDAMP2', 'CDAMP3', 'CDAMP4', 'CDAMP5', 'CVISC', 'CBUSH1D'):
        if bdf.card_count.get(name):
            yield '%d %s' % (bdf.card_count[name], name)
    if 'B2GG' in ' '.join(bdf.case_control_lines).upper():
        yield 'B2GG'


def axes_at(coord, x):
    """Axes, as columns, of a coordinate system of Nastran at a place; None: a point of a fluid has none."""
    beta = coord.beta().T if coord else AXES
    if not coord or coord.type[-1] not in 'CS':
        return beta
    local = beta.T @ (x - coord.origin)
    phi, theta = np.arctan2(local[1], local[0]), np.arctan2(np.hypot(local[0], local[1]), local[2])
    c, s, ct, st = np.cos(phi), np.sin(phi), np.cos(theta), np.sin(theta)
    about_z = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    if coord.type[-1] == 'C':
        return beta @ about_z
    return beta @ about_z @ np.array([[st, ct, 0], [0, 0, 1], [ct, -st, 0]])


def skew(c):
    return np.array([[0, -c[2], c[1]], [c[2], 0, -c[0]], [-c[1], c[0], 0]])


def body_block(mass, center, J):
    """Mass matrix of a rigid body about a point: center from there, J about the center."""
    cross = skew(center)
    return np.block([[mass * AXES, -mass * cross], [mass * cross, J - mass * cross @ cross]])


def point_mass(card, x):
    """Mass matrix about its grid of a CONM1 or CONM2, basic axes."""
    if card.type == 'CONM1':
        turn = np.kron(np.eye(2), card.cid_ref.beta().T if card.cid_ref else AXES)
        return turn @ card.mass_matrix @ turn.T
    I11, I21, I22, I31, I32, I33 = card.I
    turn = card.cid_ref.beta().T if card.cid > 0 else AXES
    center = card.X - x if card.cid == -1 else turn @ card.X
    return body_block(card.mass, center, turn @ np.array([[I11, -I21, -I31], [-I21, I22, -I32], [-I31, -I32, I33]]) @ turn.T)


def offsets_of(card, where, model, grids):
    """From the grids to the ends of a bar, basic axes; of other elements zero."""
    ends = [np.array(end) for end in (getattr(card, 'wa', None), getattr(card, 'wb', None)) if end is not None]
    if not np.any(ends):
        return np.zeros((len(grids), 3))
    if getattr(card, 'offt', 'GGG')[1:] != 'GG':
        raise Refused('%s: offsets in its own axes (%s): export the mass matrix (--mass)' % (where, card.offt))
    return [axes_at(node.cd_ref, model.x[model.at[node.nid]]) @ end for node, end in zip(card.nodes_ref, ends)]


def asked(where, card, what):
    """A figure that pyNastran computes."""
    try:
        return float(getattr(card, what)())
    except Exception as error:  # for some kinds of a section it has no formula
        raise Refused('%s (%s %s): pyNastran has no %s of it (%s): export the mass matrix (--mass)'
                      % (where, card.type, getattr(card, 'pid', ''), what, told(error).split('$')[0]))


def polar(where, beam):
    """Mass moment of inertia of a CBEAM about its axis, per length; a tapered one has the mean of its stations."""
    if beam.type == 'PBEAML':
        try:
            section = getattr(importlib.import_module('pyNastran.bdf.cards.properties.bars'), beam.beam_type.lower() + '_section')
            I = np.mean([np.sum(section(beam.type, beam.beam_type, dim, beam)[1:3]) for dim in beam.dim])
        except Exception as error:  # some kinds of a section have no formula there
            raise Refused('%s (PBEAML %d, %s): pyNastran has no moment of inertia of it (%s): export the mass matrix (--mass)'
                          % (where, beam.pid, beam.beam_type, told(error).split('$')[0]))
    else:
        I = asked(where, beam, 'I11') + asked(where, beam, 'I22')
    return asked(where, beam, 'Rho') * I


def masses_of(bdf, model):
    """The mass of each element in equal parts at its grids, and what is lumped there; basic axes, PARAM,WTMASS included."""
    blocks = np.zeros((len(model.ids), 6, 6))
    for card in list(bdf.elements.values()) + list(bdf.masses.values()):
        where = '%s %d' % (card.type, card.eid)
        if card.type in ('CONM1', 'CONM2'):
            at = model.find(card.nid, where)
            blocks[at] += point_mass(card, model.x[at])
            continue
        mass = asked(where, card, 'Mass') if hasattr(card, 'Mass') else 0.0
        if not mass:
            continue
        if card.type.startswith('CMASS'):
            raise Refused('%s: mass in one direction: export the mass matrix (--mass)' % where)
        grids = [node for node in dict.fromkeys(card.node_ids) if node]
        offsets = offsets_of(card, where, model, grids)
        for node, offset in zip(grids, offsets):
            blocks[model.find(node, where)] += body_block(mass / len(grids), offset, np.zeros((3, 3)))
        if card.type == 'CBEAM':  # turns about its axis, too
            axis = model.x[model.at[grids[1]]] + offsets[1] - model.x[model.at[grids[0]]] - offsets[0]
            turns = polar(where, card.pid_ref) / 2 * np.outer(axis, axis) / np.linalg.norm(axis)
            for node in grids[:2]:
                blocks[model.at[node], 3:, 3:] += turns
    for card in [name for name, is_there in (('NSM', bdf.nsms), ('M2GG', 'M2GG' in ' '.join(bdf.case_control_lines).upper())) if is_there]:
        raise Refused('%s: its mass is not that of elements: export the mass matrix (--mass)' % card)
    unit = bdf.params['WTMASS'].values[0] if 'WTMASS' in bdf.params else 1.0
    return sparse.csr_array(sparse.block_diag(list(unit * blocks), format='csr'))


def table_of(op2, path, subcase):
    """The table of the real normal modes of SOL 103."""
    kinds = {2: 'normal modes', 7: 'of buckling, before it', 8: 'of buckling', 9: 'complex'}  # analysis codes of the OUG table
    found = [(table, kinds.get(table.analysis_code, 'of analysis code %s' % table.analysis_code)) for table in op2.eigenvectors.values()]
    real = [table for table, kind in found if kind == kinds[2] and not np.iscomplexobj(table.data)
            and (subcase is None or table.isubcase == subcase)]
    if len(real) != 1:
        other = sorted({'subcase %d: %s' % (table.isubcase, kind) for table, kind in found})
        raise Refused('%s: %d tables of real normal modes (OUG)%s: SOL 103 with DISP(PLOT) = ALL and PARAM,POST,-1 writes one; --subcase chooses'
                      % (path, len(real), ', it has those of ' + ', '.join(other) if other else ', it has no modes at all'))
    return real[0]


def shapes_of(op2, path, subcase, norms, model, axes):
    """Frequencies and shapes of SOL 103, in basic axes; which grids have them."""
    table = table_of(op2, path, subcase)
    value = np.array(table.eigns, dtype=float)
    if table.data.shape[0] != len(value) or len(value) == 0 or not np.all(np.isfinite(value)):
        raise Refused('%s: %d modes, %d eigenvalues, of which %d are finite' % (path, table.data.shape[0], len(value), np.isfinite(value).sum()))
    model.digits = 9 if table.data.dtype == np.float32 else 17
    model.phi = np.zeros((6 * len(model.ids), len(value)))
    seen = np.zeros(len(model.ids), dtype=bool)
    for k, (node, kind) in enumerate(table.node_gridtype):
        if kind == 1:  # a grid
            at = model.find(int(node), path)
            seen[at] = True
            model.phi[6 * at:6 * at + 6] = table.data[:, k, :].T
            if not np.all(np.isfinite(model.phi[6 * at:6 * at + 6])):
                raise Refused('%s: the displacement of grid %d is not finite' % (path, node))
    if not table.table_name.startswith('BOUG'):  # those of PARAM,OUGCORD,BASIC are in basic axes
        model.phi = axes @ model.phi
    model.hz = np.sqrt(np.maximum(value, 0)) / (2 * np.pi)
    for head in op2.eigenvalues.values():
        mass = getattr(head, 'generalized_mass', None)
        if len(op2.eigenvalues) == 1 and mass is not None and len(mass) == len(value):
            model.modal_mass = np.array(mass, dtype=float)
    if model.modal_mass is None and norms == {'MASS'}:
        model.modal_mass = np.ones(len(value))
    return seen


def from_nastran(options):
    path, modes = options.files
    read_op2 = nastran('op2.op2').read_op2
    from cpylog import SimpleLogger  # comes with pyNastran
    bdf = deck_read(path)
    if not bdf.nodes:
        raise Refused('%s: no GRID: the deck of the run is wanted, with its bulk data' % path)
    op2 = opened(modes, read_op2, log=SimpleLogger('critical'), build_dataframe=False)
    ids = sorted(bdf.nodes)
    model = Model(ids, [bdf.nodes[node].get_position() for node in ids])
    for at in np.flatnonzero(~np.isfinite(model.x).all(axis=1))[:1]:
        raise Refused('%s: the place of grid %d is not finite' % (path, ids[at]))
    model.sets = {key: card.ids for key, card in bdf.sets.items() if card.type == 'SET1'}
    axes = sparse.csr_array(sparse.block_diag(
        [np.kron(np.eye(2), axes_at(bdf.nodes[node].cd_ref, model.x[k])) for k, node in enumerate(ids)], format='csr'))
    norms = {getattr(card, 'norm', None) or 'MASS' for card in bdf.methods.values()}  # of EIGRL
    seen = shapes_of(op2, modes, options.subcase, norms, model, axes)
    place = grid_rows(bdf, ids)
    most = len(place), 'the %d grids and %d scalar points of %s' % (len(ids), len(place) - 6 * len(ids), path)
    if options.mass is None and 'MGG' in op2.matrices:
        M = sparse.csr_array(op2.matrices['MGG'].data)
    else:
        M = matrix(options.mass, most) if options.mass else None
    basic = basic_by(place, axes)
    try:
        own = masses_of(bdf, model)
    except Refused as error:
        own = None
        if M is None:
            name, number = str(error).split()[:2]
            raise Refused('%s: %s' % (card_at(path, name, number.rstrip(':')), error))
    if M is None:
        M = own
    else:
        M = basic(M, options.mass or 'MGG')
        if own is not None:
            have, want = straight(M).sum(), straight(own).sum()
            if abs(have - want) > options.tolerance * want > 0:
                model.notes.append('%s: its mass is %.6g, that of the elements of %s %.6g (units of the model)' % (options.mass or 'MGG of ' + modes, have, path, want))
    model.notes += materials_doubt(bdf, path, options.scale)
    for card in bdf.elements.values():
        ends = [model.at[node] for node in getattr(card, 'node_ids', []) if node in model.at]
        model.pairs += list(zip(ends, ends[1:] + ends[:1] * (len(ends) > 2)))
    damping = ', '.join(damping_of(bdf))
    if damping and not any(word.split()[0] == 'damping' for word in options.word):
        model.notes.append("%s: its damping (%s) is not taken, the component has none: --word 'damping RATIO'" % (path, damping))
    heavy = np.array(abs(M).max(axis=1).toarray()).reshape(-1, 6).max(axis=1) > 0
    for at in np.flatnonzero(heavy & ~seen):
        raise Refused('%s: no displacement of grid %d, which has mass: DISP(PLOT) = ALL in the case control' % (modes, ids[at]))
    return model, M, basic, most


def grid_rows(bdf, ids):
    """Per row of a matrix of the g-set the row of six per grid; scalar points, one row each, have none: -1."""
    at = {node: k for k, node in enumerate(ids)}
    points = sorted(list(ids) + list(bdf.spoints) + list(bdf.epoints))
    return np.concatenate([6 * at[p] + np.arange(6) if p in at else [-1] for p in points]).astype(int)


# ---- masses at nodes


class Mass:
    """A node that is written: mass, inertia about it, shape (6 x n)."""

    def __init__(self, node, x, mass, J, shape):
        self.node, self.x, self.mass, self.J, self.shape = node, x, mass, J, shape
        self.grid = node  # of the model: the node that carries it


def moments(J):
    """Second moments of mass of an inertia tensor, those of no body (negative) left out."""
    value, axes = np.linalg.eigh(np.trace(J) / 2 * AXES - J)
    return axes @ np.diag(np.where(value > 1e-14 * abs(value).max(), value, 0)) @ axes.T


def possible(J):
    E = moments(J)
    return np.trace(E) * AXES - E


def lumps(model, M):
    """Masses of a matrix by nodes, at offsets where it says so; does it consist of them? If not, none."""
    n = len(model.ids)
    shape = model.phi.reshape(n, 6, -1)
    coo, extent = M.tocoo(), np.ptp(model.x, axis=0).max()
    blocks = np.zeros((n, 6, 6))
    own = coo.row // 6 == coo.col // 6
    np.add.at(blocks, (coo.row[own] // 6, coo.row[own] % 6, coo.col[own] % 6), coo.data[own])
    size = np.sqrt(np.maximum(M.diagonal(), 1e-300))
    rest = (abs(coo.data) / size[coo.row] / size[coo.col])[~own].max(initial=0)
    heavy = np.flatnonzero(abs(blocks).max(axis=(1, 2)) > 0)
    B, size = blocks[heavy], size.reshape(-1, 6)[heavy]
    mass = np.trace(B[:, :3, :3], axis1=1, axis2=2) / 3
    cross = B[:, 3:, :3] / np.where(mass > 0, mass, np.inf)[:, None, None]
    center = np.stack([cross[:, 2, 1] - cross[:, 1, 2], cross[:, 0, 2] - cross[:, 2, 0], cross[:, 1, 0] - cross[:, 0, 1]], axis=1) / 2
    about = np.array([[0, 0, 0], [0, 0, -1], [0, 1, 0]]), np.array([[0, 0, 1], [0, 0, 0], [-1, 0, 0]]), np.array([[0, -1, 0], [1, 0, 0], [0, 0, 0]])
    arm = np.einsum('ni,ijk->njk', center, np.array(about))  # the matrices of center x
    J = B[:, 3:, 3:] + mass[:, None, None] * arm @ arm
    body = np.zeros_like(B)  # body_block of each
    body[:, :3, :3], body[:, 3:, 3:] = mass[:, None, None] * AXES, B[:, 3:, 3:]
    body[:, :3, 3:], body[:, 3:, :3] = -mass[:, None, None] * arm, mass[:, None, None] * arm
    rest = max(rest, (abs(body - B) / (size[:, :, None] * size[:, None, :])).max(initial=0))
    if rest > SMALL:
        return [], False
    out, free = [], max(model.ids) + 1
    for n, k in enumerate(heavy):
        at = Mass(model.ids[k], model.x[k], mass[n], J[n], shape[k])
        if np.linalg.norm(center[n]) > SMALL * extent:
            at = Mass(free, model.x[k] + center[n], mass[n], J[n], np.vstack([shape[k, :3] - skew(center[n]) @ shape[k, 3:], shape[k, 3:]]))
            at.grid, free = model.ids[k], free + 1
        out.append(at)
    return out, True


def straight(M):
    """Masses of displacements, by nodes: the mean of the three directions."""
    return sum(M[i::6, i::6] for i in range(3)) / 3


def turning(M):
    """Inertia at each node: sums of the rows of rotations."""
    J = np.array([[M[3 + i::6, 3 + j::6].sum(axis=1) for j in range(3)] for i in range(3)])
    return (J + J.transpose(1, 0, 2)).transpose(2, 0, 1) / 2


def row_sums(model, M):
    """Masses of a consistent matrix at its own nodes, for lines."""
    n = len(model.ids)
    shape = model.phi.reshape(n, 6, -1)
    mass = straight(M).sum(axis=1)
    if np.min(mass) < -SMALL * np.max(mass):
        raise Refused('--line: node %d has a negative lumped mass (elements of higher degree): mesh lines by linear ones'
                      % model.ids[int(np.argmin(mass))])
    J = turning(M)
    return [Mass(model.ids[k], model.x[k], mass[k], J[k], shape[k])
            for k in range(n) if mass[k] > 0 or abs(J[k]).max() > 0]


def integrals(masses, n_mode):
    """Mass matrix of rigid-body motion, its coupling with the modes, that of the modes."""
    out = np.zeros((6 + n_mode, 6 + n_mode))
    for at in masses:
        S = np.hstack([rigid(at.x[None, :]), at.shape])
        out += S.T @ body_block(at.mass, np.zeros(3), at.J) @ S
    return out


def differences(have, want, size):
    """Largest relative differences of what the masses give from what the mass matrix gives."""
    scale = np.sqrt(np.concatenate([[want[0, 0]] * 3, [np.trace(want[3:6, 3:6]) / 2 + 1e-300] * 3, np.diag(want)[6:]]))
    off = abs(have - want) / np.outer(scale, scale)
    return {'mass': off[:3, :3].max(), 'center of mass': abs(have - want)[:3, 3:6].max() / (want[0, 0] * size),
            'inertia': off[3:6, 3:6].max(), 'first moments': off[:6, 6:].max(), 'modal masses': off[6:, 6:].max()}


# ---- condensed masses: a few points with the integrals of all


def root(A):
    value, axes = np.linalg.eigh(A)
    value = np.where(value > 1e-13 * abs(value).max(), value, 0)
    return axes @ np.diag(np.sqrt(value)) @ axes.T


def change(A, B):
    """C, symmetric, with C A C = B."""
    half = root(A)
    back = np.linalg.pinv(half, rcond=1e-6, hermitian=True)
    return back @ root(half @ B @ half) @ back


def gram(m, F, J, theta):
    """Integrals of products of 1, x, y, z and the displacements by modes x, y, z, from masses at points (m: a matrix) that rotate."""
    S = F.T @ (m @ F)
    n = theta.shape[2]
    for k in np.flatnonzero(abs(J).max(axis=(1, 2)) > 0):
        G = np.zeros((3, F.shape[1]))  # the fields at s from the point: G^T s more
        G[:, 1:4] = AXES
        G[:, 4:] = np.cross(theta[k].T[:, None, :], AXES[None, :, :]).transpose(1, 0, 2).reshape(3, 3 * n)
        S += G.T @ moments(J[k]) @ G
    return S


def fields(x, shape):
    n = shape.shape[2]
    return np.hstack([np.ones((len(x), 1)), x, shape[:, :3].transpose(0, 2, 1).reshape(len(x), 3 * n)])


def fitted(S, want):
    """S with the mass, center and inertia, first moments and modal masses that are wanted: places by an affine map, modes by
    a rigid-body motion and a matrix next to the unit one."""
    n = (len(S) - 4) // 3
    S = S * want[0, 0] / S[0, 0]
    cross = want[3:6, :3] / want[0, 0]
    center = np.array([cross[2, 1], cross[0, 2], cross[1, 0]])
    J = want[3:6, 3:6]
    T = np.eye(len(S))
    old = S[0, 1:4] / S[0, 0]
    B = change(S[1:4, 1:4] - S[0, 0] * np.outer(old, old), np.trace(J) / 2 * AXES - J - want[0, 0] * np.outer(center, center))
    T[1:4, 1:4], T[0, 1:4] = B, center - B @ old
    S = T.T @ S @ T

    field = np.zeros((3, len(S), 6 + n))  # by direction: what of 1, x, y, z and the modes each motion has there
    for i in range(3):
        field[i, 0, i] = 1
        field[i, 1:4, 3:6] = skew(AXES[i])  # (e_k x r)_i, by r and k
        field[i, 4 + i::3, 6:] = np.eye(n)
    have = sum(f.T @ S @ f for f in field)
    unit = np.sqrt(np.diag(want)[:6])
    unit = np.outer(unit, unit) + (np.outer(unit, unit) == 0)
    back = np.linalg.pinv(want[:6, :6] / unit, rcond=1e-12, hermitian=True) / unit
    part, whole = back @ have[:6, 6:], back @ want[:6, 6:]
    C = change(have[6:, 6:] - have[:6, 6:].T @ part, want[6:, 6:] - want[:6, 6:].T @ whole)
    motion = np.vstack([whole - part @ C, C])
    T = np.eye(len(S))
    for i in range(3):
        T[:, 4 + i::3] = field[i] @ motion
    return T.T @ S @ T


def points(S, free):
    """Equal masses with these integrals: S = sum of m f f^T, f = (1, x, y, z, displacements)."""
    size = np.sqrt(np.maximum(np.diag(S), 0))
    live = size > 0
    scaled = (S / np.where(live, size, 1))[:, live][live] / size[live][:, None]
    value, axes = np.linalg.eigh(scaled)
    if value[0] < -1e-9 * value[-1]:
        raise Refused('the masses cannot be condensed: rotations carry inertia as no body has it (--line, or a lumped mass matrix)')
    keep = value > 1e-14 * value[-1]
    upper = np.linalg.qr(np.sqrt(value[keep])[:, None] * axes[:, keep].T, mode='r')
    upper *= np.sign(upper[0, 0])
    count = len(upper)
    F = np.zeros((count, len(S)))
    F[:, live] = np.sqrt(count / S[0, 0]) * (fft.idct(np.eye(count), axis=0, norm='ortho') @ upper) * size[live]
    return [Mass(free + k, f[1:4], S[0, 0] / count, np.zeros((3, 3)), np.vstack([f[4:].reshape(-1, 3).T, np.zeros((3, (len(f) - 4) // 3))]))
            for k, f in enumerate(F)]


def condensed(model, M, lumped, want):
    """At most 4 + 3 n points that stand for all masses: exact where masses are lumped or the same in all directions, else exact in
    mass, center, inertia, first moments and modal masses."""
    n = len(model.hz)
    if lumped:
        x, shape = np.array([at.x for at in lumped]), np.array([at.shape for at in lumped])
        m, J = sparse.csr_array(sparse.diags([at.mass for at in lumped])), np.array([at.J for at in lumped])
    else:
        x, shape = model.x, model.phi.reshape(len(model.ids), 6, n)
        m, J = straight(M), turning(M)
    S = gram(m, fields(x, shape), J, shape[:, 3:])
    return points(fitted(S, want), max(model.ids) + 1)


# ---- the description


def listed(text, what, sets=None):
    """12, 3-7, 1-33/4 (each fourth), SET5 (of sets) with commas between; 12:tip has a name: pairs of number and name."""
    out = []
    for item in text.split(','):
        item, _, name = item.strip().partition(':')
        found = re.fullmatch(r'(\d+)(?:-(\d+)(?:/([1-9]\d*))?)?', item)
        if re.fullmatch(r'SET\d+', item) and sets is not None and int(item[3:]) in sets:
            out += [(node, '') for node in sets[int(item[3:])]]
        elif found and int(found[2] or found[1]) >= int(found[1]) and re.fullmatch(r'([A-Za-z_]\w*)?', name, re.ASCII):
            out += [(node, name) for node in range(int(found[1]), int(found[2] or found[1]) + 1, int(found[3] or 1))]
        else:
            raise Refused('%s: node numbers with commas between are wanted (12,20-25,30:tip; 1-33/4; SET5 of a SET1 card), not %r'
                          % (what, item))
    return out


def scaled(model, M, length, mass):
    """To SI; K_G, by accelerations, angular ones and spins, too."""
    n = len(model.ids)
    model.x *= length
    model.phi *= np.tile([length] * 3 + [1.0] * 3, n)[:, None]
    unit = sparse.csr_array(sparse.diags(np.tile([1.0] * 3 + [length] * 3, n) * np.sqrt(mass)))
    model.K_G = [unit @ A @ unit / (length if k < 3 else 1) for k, A in enumerate(model.K_G)]
    if model.reduced:
        place, M, whole = model.reduced
        root = np.where((place < 6 * n) & (place % 6 < 3), 1.0, length) * np.sqrt(mass)
        model.reduced = place, M * np.outer(root, root), whole
        return None
    return sparse.csr_array(unit @ M @ unit)


def bending(model):
    """Which shapes are no rigid-body motions, and the frequency below which one is none of a body on a soft spring."""
    most = abs(model.phi.reshape(len(model.ids), 6, -1)[:, :3]).max(axis=(0, 1))
    R = rigid(model.x)
    rows = np.flatnonzero(np.tile([1, 1, 1, 0, 0, 0], len(model.ids)))
    rest = model.phi[rows] - R[rows] @ np.linalg.lstsq(R[rows], model.phi[rows], rcond=None)[0]
    bends = abs(rest).max(axis=0) > 1e-4 * most
    return bends, 1e-3 * model.hz[bends].min(initial=np.inf)


def rigid_left_out(model):
    """Rigid-body modes of a free structure: such motion is that of the frame."""
    bends, soft = bending(model)
    out = ~bends & (model.hz <= soft)
    if 0 < out.sum() < len(out):
        model.notes.append('%d rigid-body modes are left out (0 to %.2g Hz): such motion is that of the frame' % (out.sum(), model.hz[out].max()))
        model.hz, model.phi = model.hz[~out], model.phi[:, ~out]
        model.modal_mass = None if model.modal_mass is None else model.modal_mass[~out]
    return int(out.sum()) if 0 < out.sum() < len(out) else 0


def still_check(model, frame, left_out):
    """Shapes that are rigid-body motions, or move the frame, are no component's."""
    shape = model.phi.reshape(len(model.ids), 6, -1)
    most = abs(shape[:, :3]).max(axis=(0, 1))
    bends, soft = bending(model)  # on a hinge with a spring a body turns as a rigid one, but faster than that
    for k in range(len(model.hz)):
        where = 'mode %d (%.4g Hz)' % (left_out + k + 1, model.hz[k])
        if model.hz[k] <= 0 and bends[k]:
            raise Refused('%s has no stiffness: a mechanism, or a part that hangs on nothing, moves node %d the most'
                          % (where, model.ids[int(np.linalg.norm(shape[:, :3, k], axis=1).argmax())]))
        if model.hz[k] <= 0 or not bends[k] and (not frame or model.hz[k] < soft):
            raise Refused('%s is a rigid-body motion: hold the interface (SPC) and name its nodes (--frame); such motion is that of the frame' % where)
        for node in frame:
            if abs(shape[model.find(node, '--frame'), :3, k]).max() > 1e-5 * most[k]:
                raise Refused('%s moves node %d of the frame: hold it there (SPC)' % (where, node))


def mass_check(model, want, size, name, tolerance):
    """R^T M R is the mass matrix of a rigid body?"""
    mass, moment = want[0, 0], want[:3, 3:6]
    off = max(abs(want[:3, :3] - mass * AXES).max(), abs(moment + moment.T).max() / max(size, 1e-300)) / max(mass, 1e-300)
    if model.reduced and 1e-6 < off <= tolerance:
        body = want[:6, :6].copy()
        body[:3, :3], body[:3, 3:] = np.trace(want[:3, :3]) / 3 * AXES, (moment - moment.T) / 2
        body[3:, :3] = body[:3, 3:].T
        body *= max(linalg.eigh(want[:6, :6], body, eigvals_only=True)[-1], 1)  # not less than the modes carry: they keep their masses
        if body[0, 0] < (1 + tolerance) * mass:
            model.notes.append('the mass is %.6g, %.6g and %.6g along x, y and z, which a body has not: %.6g is taken' % (*np.diag(want)[:3], body[0, 0]))
            want[:6, :6], mass, moment = body, body[0, 0], body[:3, 3:]
    if not mass > 0 or abs(want[:3, :3] - mass * AXES).max() > 1e-6 * mass:
        raise Refused('%s: the mass is %.6g, %.6g and %.6g along x, y and z: it has to be the same (rows may be missing, or masses of one direction)'
                      % (name, *np.diag(want)[:3]))
    if abs(moment + moment.T).max() > 1e-6 * mass * size:
        raise Refused('%s: R^T M R, of rigid-body motions R, has first moments that no body has (%.3g of mass and extent): rows of M in another order, '
                      'or rotations in other units' % (name, abs(moment + moment.T).max() / (mass * size)))
    center = np.array([moment[2, 1], moment[0, 2], moment[1, 0]]) / mass  # of -mass center x
    J = np.linalg.eigvalsh(want[3:6, 3:6] + mass * skew(center) @ skew(center))
    if J[0] < -1e-9 * max(J[2], mass * size**2):
        raise Refused('%s: the inertia about the mass center is negative, %.6g kg m^2: rows of M in another order, or masses that are' % (name, J[0]))
    if J[2] > (J[0] + J[1]) * (1 + 1e-6) + 1e-12 * mass * size**2:
        model.notes.append('the inertia about the mass center, %.6g %.6g %.6g kg m^2, is no body\'s: each is at most the sum of the others' % tuple(J))


def units_doubt(model, mass, size):
    """Figures that no structure has in SI."""
    dense = mass / size**3 if size > 0 else 1.0
    speed = model.hz[0] * size
    if not 1e-7 < dense < 3e4 or speed > 2e4:
        model.notes.append('units? mass %.3g kg, extent %.3g m, first mode %.3g Hz: %.2g kg/m^3 of a cube of this extent, %.2g m/s of frequency times '
                           'extent (--scale 0.001,1000 is of mm and t, 0.001,1 of mm and kg)' % (mass, size, model.hz[0], dense, speed))


def materials_doubt(bdf, path, scale):
    """MAT1 cards that no material has in SI: density, and the speed of waves sqrt(E/rho)."""
    weight = bdf.params['WTMASS'].values[0] if 'WTMASS' in bdf.params else 1.0
    for mid, card in sorted(bdf.materials.items()):
        if card.type == 'MAT1' and (card.rho or 0) > 0 and (card.e or 0) > 0:
            rho, speed = card.rho * weight * scale[1] / scale[0]**3, np.sqrt(card.e / (card.rho * weight)) * scale[0]
            if not 1 < rho < 3e4 or not 50 < speed < 2e4:
                yield ('%s: units? MAT1 %d has %.3g kg/m^3, sqrt(E/rho) %.3g m/s (--scale 0.001,1000 is of mm and t; PARAM,WTMASS of weights)'
                       % (card_at(path, 'MAT1', mid), mid, rho, speed))


def mean_axes(model, want, words):
    """Modes of a free structure have no momentum; their frame follows its mean motion."""
    off = abs(want[:6, 6:]) / np.sqrt(np.maximum(np.diag(want)[:6], 1e-300))[:, None]
    if off.max(initial=0) < 1e-3:
        if any(word.split()[0] == 'base' and word.split()[1:] != ['free'] for word in words):
            raise Refused('--word base: the modes are those of the free structure, which move its frame: base free, or hold the interface (SPC, --frame)')
        model.notes.append('the modes are those of the free structure, whose frame follows its mean motion: base free, and static loads at nodes '
                           'deform it less than they should')


def numbers(values, digits=17):
    """To the last digit."""
    return ' '.join('%.9g' % v if digits == 9 else repr(v).removesuffix('.0') for v in (np.ravel(values) + 0.0).tolist())


def lines_of(model, texts, masses):
    """The words line, and the nodes that they want beside those with mass."""
    shape = model.phi.reshape(len(model.ids), 6, -1)
    words, used = [], []
    for text in texts:
        straight = text.startswith('straight:')
        chain = [model.find(node, '--line') for node, _ in listed(text.removeprefix('straight:'), '--line')]
        if len(chain) < 2:
            raise Refused('--line %s: a line has two nodes at least' % text)
        held = [k for k in range(len(model.ids)) if not abs(shape[k]).max() > 0]
        for k in chain[1:]:
            if k in held:
                raise Refused('--line %s: node %d is held: a line goes from the frame outward, to an end that is free to move in as it bends'
                              % (text, model.ids[k]))
        if held and chain[0] not in held and model.ids[chain[0]] not in used:
            raise Refused('--line %s: node %d is neither on the frame nor on a line before: a line begins there' % (text, model.ids[chain[0]]))
        word = 'line straight' if straight or not abs(shape[chain, 3:]).max() > 0 else 'line'
        root = ''
        if model.ids[chain[0]] not in used and not abs(shape[chain[0]]).max() > 0:
            root = ' frame ' + numbers(model.x[chain[0]])
            chain = chain[1:]
        chain = [model.ids[k] for k in chain]
        for part in range(0, len(chain), 50):  # a line of text holds no more; the next goes on from its last node
            words.append(word + root + ''.join(' %d' % node for node in chain[max(part - 1, 0):part + 50]))
            root = ''
        used += chain
    for at in masses:
        if at.grid in used and at.grid != at.node:  # a mass that a node carries at an offset
            words.append('line %d %d' % (at.grid, at.node))
        elif at.grid not in used and abs(at.shape).max() > 0:
            raise Refused('--line: node %d has mass, moves, and is on no line' % at.grid)
    return words, set(used) - {at.node for at in masses}


def effective(model, want):
    """Shares of mass and inertia, about the origin, that the modes carry: (R^T M phi)^2, of modal mass 1, over R^T M R."""
    share = 100 * np.sum(want[:6, 6:]**2, axis=1) / np.maximum(np.diag(want)[:6], 1e-300)
    model.notes.append('effective masses: the modes carry %.3g, %.3g and %.3g %% of the mass along x, y and z, %.3g, %.3g and %.3g %% of the inertia '
                       'about them' % tuple(np.round(share, 9)))


def light(model, want, words):
    """A frame that the modes leave (almost) nothing to: by itself the body can hardly be stepped."""
    scale = 1 / np.sqrt(np.maximum(np.diag(want)[:6], 1e-300))
    left = np.linalg.eigvalsh((want[:6, :6] - want[:6, 6:] @ want[:6, 6:].T) * np.outer(scale, scale))[0]
    if left < 1e-3 and not any(word.split()[0] in ('hub', 'base') for word in words):
        model.notes.append('the modes carry all of its mass but %.1g %% in some direction: by itself it wants --word "base prescribed" or a hub, on a '
                           'joint of a scene neither' % (100 * max(left, 0)))


def static_loss(model, marks):
    """What the modes leave out of the deflection of a node under a force or moment there: 1 - sum of phi^2 / w^2 over that of K."""
    if not model.static:
        model.notes.append('what the modes leave out of static deflections is not known without K')
        return
    solver, rows, value, phi = model.static
    for node, name in marks:
        lost, most = (['force', 'moment'], [], []), 0.0
        for row in np.flatnonzero(rows // 6 == model.at[node]):
            load = np.zeros(len(rows))
            load[row] = 1
            part = 1 - np.sum(phi[row]**2 / value) / solver(load)[row]
            most = max(most, part)
            lost[1 + rows[row] % 6 // 3].append('%.3g %% %s' % (100 * max(part, 0), 'xyz'[rows[row] % 3]))
        called = '%d%s' % (node, ' (%s)' % name if name else '')
        model.losses.append((node, called, max(most, 0)))
        if most < 1e-6 and lost[1] + lost[2]:
            model.notes.append('the modes have all of the static deflection of node %s by forces%s there (%.1g is left out)'
                               % (called, ' and moments' if lost[2] else '', max(most, 0)))
            continue
        for kind, parts in zip(lost[0], lost[1:]):
            if parts:
                model.notes.append('of the static deflection of node %s by a %s there the modes leave out %s' % (called, kind, ', '.join(parts)))


def extremes(model):
    """Nodes that are the farthest, or move most by a mode: the limit of deflections goes by them."""
    shape = model.phi.reshape(len(model.ids), 6, -1)
    reach = np.linalg.norm(shape[:, :3], axis=1).argmax(axis=0)
    return {model.ids[k] for k in (np.linalg.norm(model.x, axis=1).argmax(), *reach)}


LOADS = ['acceleration %s' % a for a in 'xyz'] + ['angular acceleration %s' % a for a in 'xyz'] + ['spin %s' % a for a in ('xx', 'yy', 'zz', 'xy', 'xz', 'yz')]


def inertia_loads(model, M):
    """Forces and moments on the nodes by unit accelerations, angular ones and products of spins of the frame: 12 x nodes x 6."""
    R = rigid(model.x)
    fields = [R[:, k] for k in range(6)]
    for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)):
        by = np.cross(AXES[i], np.cross(AXES[j], model.x))
        by = by if i == j else by + np.cross(AXES[j], np.cross(AXES[i], model.x))
        fields.append(np.hstack([by, 0 * by]).ravel())
    F = -(M @ np.array(fields).T)
    if model.free:  # what would accelerate it as a whole is in equilibrium with that motion
        F -= M @ (R @ linalg.solve(R.T @ (M @ R), R.T @ F))
        F[:, :6] = 0
    return F.T.reshape(12, -1, 6)


def along(model, A):
    """Per node the projector on the directions to the nodes that a matrix couples it with: along a beam, in a plate, all in a solid."""
    coo = A.tocoo()
    a, b = coo.row // 6, coo.col // 6
    d = model.x[b] - model.x[a]
    length = np.linalg.norm(d, axis=1)
    a, d = a[length > 0], d[length > 0] / length[length > 0][:, None]
    S = np.zeros((len(model.ids), 3, 3))
    np.add.at(S, a, d[:, :, None] * d[:, None, :])
    value, axes = np.linalg.eigh(S)
    axes = axes * (value > 1e-6 * value[:, 2:])[:, None, :] * (value[:, 2] > 0)[:, None, None]
    return axes @ axes.transpose(0, 2, 1)


def geometric_check(options, model, M):
    """K_G of a load f in equilibrium, turned as a rigid body, gives theta x f. That of a load that stretches the structure cannot be zero."""
    absent = [k for k, name in enumerate(options.geometric) if name == 'none']
    f, projector = inertia_loads(model, M)[:, :, :3], along(model, abs(sum(abs(A) for A in model.K_G)) + abs(M))
    moves = (abs(model.phi.reshape(len(model.ids), 6, -1)[:, :3]).max(axis=(1, 2)) > 0) & ~np.isin(model.ids, model.tied)
    turned = rigid(model.x)[:, 3:]
    for k, load in enumerate(LOADS):
        pull = np.einsum('nij,nj->ni', projector, f[k])[moves]
        size = np.linalg.norm(f[k][moves])
        if k in absent or size <= 1e-9 * abs(M.diagonal()).max() or np.linalg.norm(pull) <= 0.01 * size:
            continue
        want = np.array([np.cross(AXES[j], f[k]) for j in range(3)])[:, moves]
        have = (model.K_G[k] @ turned).T.reshape(3, -1, 6)[:, moves, :3]
        share = np.sum(have * want) / np.sum(want * want)
        zero = abs(have).max() <= SMALL * abs(want).max()
        if zero or np.linalg.norm(pull) > 0.9 * size and not 0.5 < share < 1.5:
            raise Refused('--geometric, %s (%s): turned as a rigid body it gives %.3g of what its inertia load does, 1 is right: %s'
                          % (load, options.geometric[k], share, 'that load stretches the structure, so it is not zero; where it was not computed say none '
                             'in place of the file' if zero else 'another sign, load, origin or unit'))
    if absent:
        model.notes.append('no second-order data for %s: under it the structure does not stiffen' % ', '.join(LOADS[k] for k in absent))


def geometric_words(model):
    by = np.array([model.phi.T @ (A @ model.phi) for A in model.K_G])
    return ['geometric %d %d %s' % (a + 1, b + 1, numbers(by[:, a, b])) for a in range(len(model.hz)) for b in range(a + 1)]


def written(options, model, masses, lines, extra, marks, figures):
    """The text of the description."""
    shape = model.phi.reshape(len(model.ids), 6, -1)
    none = np.zeros((3, 3))
    ids = {at.node for at in masses}
    masses = masses + [Mass(node, model.x[model.at[node]], 0.0, none, shape[model.at[node]]) for node in ({node for node, _ in marks} | extra) - ids]
    masses.sort(key=lambda at: at.node)
    if len(masses) > NODES:
        raise Refused('%d nodes, a description holds %d: --condense puts at most %d points in place of all masses%s'
                      % (len(masses), NODES, 4 + 3 * len(model.hz), ' (not with --line: mesh it more coarsely)' if lines else ''))
    words = [word.split()[0] for word in options.word]
    text = ['# From %s by import.py: %s' % (', '.join(os.path.basename(name) for name in options.files or dict.fromkeys(options.matrices)), figures),
            *('# ' + note for note in model.notes), 'component', 'modes %d' % len(model.hz), 'frequency_hz ' + numbers(model.hz, model.digits)] + options.word
    more = [word for word in ('damping', 'gravity') if word in words]
    level = model.effects or ('full' if lines or model.K_G else 'spin')
    if set((options.geometric or [])[:6]) == {'none'}:
        level = 'spin_coupling residual_inertia spin_stiffening'
    text += [' '.join(['effects', level] + more)] if 'effects' not in words else []
    for at in masses:
        J = numbers([at.J[0, 0], at.J[1, 1], at.J[2, 2], at.J[0, 1], at.J[0, 2], at.J[1, 2]])
        text.append('node %d %s %s%s' % (at.node, numbers(at.x), numbers([at.mass]), ' ' + J if np.any(at.J) else ''))
    for at in masses:
        text += ['shape %d %d %s' % (k + 1, at.node, numbers(at.shape[:, k], model.digits if at.node in model.at else 17))
                 for k in range(len(model.hz))]
    text += [('mark %d %s' % mark).rstrip() for mark in marks] + lines + (geometric_words(model) if model.K_G else [])
    return '\n'.join(text) + '\n'


def masses_for(options, model, M, want):
    """The masses that are written, and how."""
    if model.reduced:
        return (modal_points if model.second else spread)(model, want), 'condensed'
    lumped, exact = lumps(model, M)
    masses = row_sums(model, M) if options.line and not exact else lumped
    real = [possible(at.J) for at in masses]  # the inertia of a bar about its axis alone is no body's
    plain = exact and all(abs(J - at.J).max() <= SMALL * abs(at.J).max() for J, at in zip(real, masses))
    if options.condense or not (options.line or plain):
        return condensed(model, M, lumped if exact else None, want), 'condensed'
    for J, at in zip(real, masses):
        at.J = J
    return masses, 'lumped' if exact else 'lumped here, for --line'


def modal_check(model, have, tolerance):
    """Shapes are orthogonal with the mass matrix, and have the modal masses of the run that they are of?"""
    own = np.sqrt(np.diag(have))
    cross = abs(have / np.outer(own, own) - np.eye(len(have)))
    a, b = np.unravel_index(cross.argmax(), cross.shape)
    off = 0 * own if model.modal_mass is None else abs(own**2 / model.modal_mass - 1)
    why = ('the masses are not those of the run (elements without mass here, PARAM,COUPMASS, a coarse mesh?): export its mass matrix '
           '(--mass), or --tolerance %.2g' % (1.1 * max(off.max(), cross.max())))
    if off.max() > tolerance:
        raise Refused('mode %d has the modal mass %.6g here, %.6g in the .op2: %s'
                      % (off.argmax() + 1, own[off.argmax()]**2, model.modal_mass[off.argmax()], why))
    if cross.max() > tolerance:
        raise Refused('modes %d and %d are orthogonal to %.2g only: %s' % (a + 1, b + 1, cross.max(), why))


def convert(options):
    """Text of the description, and what is told about it."""
    arrays.cache_clear()
    model, M, basic, most = (from_modal if options.modal else from_mesh if is_mesh(options) else from_matrices if options.matrices else from_nastran)(options)
    arrays.cache_clear()
    left_out = 0 if options.frame else rigid_left_out(model)
    if options.modes and options.modes > len(model.hz) and not model.reduced:
        raise Refused('--modes: %d wanted, %s has %d%s' % (options.modes, options.files[-1], len(model.hz), ' that are no rigid-body motion' if left_out else ''))
    keep = min(options.modes or len(model.hz), len(model.hz))
    if keep > MODES:
        raise Refused('%d modes, a description holds %d: --modes %d takes the lowest' % (keep, MODES, MODES))
    model.hz, model.phi = model.hz[:keep], model.phi[:, :keep]
    model.modal_mass = None if model.modal_mass is None else model.modal_mass[:keep]
    if options.interface and not model.reduced:
        attached(model, M, options)
        keep = len(model.hz)
    model.K_G = [basic(matrix(name, most), name) if name != 'none' else 0 * M for name in options.geometric or []]
    progress('masses')
    origin = (options.origin or '0,0,0').split(',')
    if model.preload and not options.line:
        model.K_G = model.preload(model.x[model.find(int(origin[0]), '--origin')] if len(origin) == 1 else np.array(origin, dtype=float) / options.scale[0])
        options.geometric = ['by CalculiX'] * len(model.K_G)
    M = scaled(model, M, *options.scale)
    model.x = model.x - (model.x[model.find(int(origin[0]), '--origin')] if len(origin) == 1 else np.array(origin, dtype=float))
    if not model.reduced:
        still_check(model, options.frame, left_out)
    if model.K_G:
        geometric_check(options, model, M)
    elif not options.line:
        model.notes.append('no second-order data (%s): spinning or accelerated it does not stiffen, its frequencies at speed are too '
                           'low, and it may seem unstable' % ('modal data have none' if options.modal else 'reduced matrices have none' if model.reduced else '--line, --geometric'))
    want = momenta(model, M)
    size = np.ptp(model.x, axis=0).max()
    if model.reduced:  # one interface node has no extent
        size = max(size, np.sqrt(max(np.trace(want[3:6, 3:6]), 0) / max(want[0, 0], 1e-300)))
    mass_check(model, want, size, options.matrices[1] if options.matrices else options.mass or options.files[0], options.tolerance)
    units_doubt(model, want[0, 0], size)
    modal_check(model, want[6:, 6:] / options.scale[1] / options.scale[0]**2, options.tolerance)  # in the units of the run
    unit = np.concatenate([np.ones(6), 1 / np.sqrt(np.diag(want)[6:])])  # shapes of modal mass 1
    model.phi, want = model.phi * unit[6:], want * np.outer(unit, unit)
    mean_axes(model, want, options.word)
    masses, how = masses_for(options, model, M, want)
    off = differences(integrals(masses, keep), want, size)
    worst = max(off, key=off.get)
    if off[worst] > (1e-6 if how == 'condensed' else options.tolerance):
        raise Refused('masses %s: the %s would be off by %.2g: a finer mesh%s, or --tolerance %.2g'
                      % (how, worst, off[worst], ', no --line' if options.line else ', --condense' if how == 'lumped' else '', 1.1 * off[worst]))
    marks = [mark for text in options.mark for mark in listed(text, '--mark', getattr(model, 'sets', None))]
    if len(marks) > MARKS:
        raise Refused('--mark: %d nodes, a body holds %d' % (len(marks), MARKS))
    for k, (node, _) in enumerate(marks):
        model.find(node, '--mark')
        if node in [other for other, _ in marks[:k]]:
            raise Refused('--mark: node %d is there twice' % node)
    for k, (node, name) in enumerate(marks):
        if name and name in [other for _, other in marks[:k]]:
            raise Refused('--mark: two nodes have the name %s' % name)
    effective(model, want)
    light(model, want, options.word)
    static_loss(model, marks)
    lines, extra = lines_of(model, options.line, masses) if options.line else ([], extremes(model))
    progress('writing')
    figures = 'mass %.9g kg, masses %s (%s off by %.1g)' % (want[0, 0], how, worst, off[worst])
    return written(options, model, masses, lines, extra, marks, figures), figures, model, report_of(options, model, want, marks, how, off) if options.report else None


def report_of(options, model, want, marks, how, off):
    """Figures, modes, static deflections and notes of an import."""
    mass, moment = want[0, 0], want[:3, 3:6]
    center = np.array([moment[1, 2], moment[2, 0], moment[0, 1]]) / mass
    J = want[3:6, 3:6] + mass * skew(center) @ skew(center)
    J = np.where(abs(J) > 1e-12 * abs(J).max(), J, 0)
    center = np.where(abs(center) > 1e-12 * abs(center).max(), center, 0)
    axes = 'x', 'y', 'z', 'about x', 'about y', 'about z'
    share = 100 * want[:6, 6:]**2 / np.maximum(np.diag(want)[:6], 1e-300)[:, None]
    cross = abs(want[6:, 6:] - np.diag(np.diag(want)[6:]))
    exact = len(model.hz) if model.exact is None else model.exact
    head = ['mode', 'Hz', 'Hz of the source', *('%s %%' % axis for axis in axes), 'orthogonality']
    rows = [['%d' % (k + 1), '%.6g' % model.hz[k], ('%.6g' % (model.source[k] if k < len(model.source) else model.hz[k])) if k < exact else 'residual', *('%.3g' % value for value in np.round(share[:, k], 6)), '%.1g' % cross[k].max()]
            for k in range(len(model.hz))]
    tables = [(head, rows)]
    if model.losses:
        tables.append((['node', 'static deflection left out'], [[called, '%.2g %%' % (100 * most)] for _, called, most in model.losses]))
    files = options.files or list(dict.fromkeys(options.matrices))
    second = 'geometric stiffness, 12 loads' if model.K_G else 'stiffening by %d lines' % len(options.line) if options.line else 'none: spinning or accelerated it does not stiffen'
    figures = [('mass', '%.9g kg' % mass), ('center of mass', '%.6g %.6g %.6g m' % tuple(center)),
               ('inertia about it', 'xx %.6g, yy %.6g, zz %.6g, xy %.6g, xz %.6g, yz %.6g kg m^2' % (J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2])),
               ('masses written', '%s; off by %s' % (how, ', '.join('%.1g in %s' % (value, key) for key, value in off.items()))),
               ('modes carry', ', '.join('%.4g %% %s' % pair for pair in zip(np.round(share.sum(axis=1), 6), axes))), ('second-order data', second)]
    if len(model.dropped):
        figures.append(('modes dropped', ' '.join('%.5g' % hz for hz in model.dropped) + ' Hz'))
    shape = model.phi.reshape(len(model.ids), 6, -1)
    names = [(model.at[node], name or str(node)) for node, name in marks] + [(model.at[node], '' if k else 'frame') for k, node in enumerate(options.frame)]
    pairs = [(model.at[options.frame[0]], k) for k in range(len(model.ids)) if model.ids[k] not in options.frame] if model.reduced else model.pairs
    report = {'title': '%s from %s' % (os.path.basename(options.out), ', '.join(os.path.basename(name) for name in files)), 'figures': figures, 'tables': tables, 'notes': model.notes}
    if os.path.splitext(options.report)[1].lower() not in ('.html', '.htm'):
        return import_report.text(report)
    return import_report.page(report, import_report.geometry(model.x, shape, pairs, names, bool(model.reduced)))


def is_mesh(options):
    return bool(options.files) and os.path.splitext(options.files[0])[1].lower() == '.inp'


def options_of(arguments):
    parser = argparse.ArgumentParser(prog='import.py', description='a finite-element model as a component of flexbeam',
                                     epilog='examples/tools/README.md, Import')
    add = parser.add_argument
    add('files', nargs='*', metavar='MODEL.bdf MODES.op2 | MODEL.inp [MODEL.frd]', help='grids and masses; normal modes (SOL 103). Or a mesh of CalculiX or Abaqus, which CalculiX solves; '
        'modes to compare with')
    add('--matrices', nargs='+', metavar='FILE', help='K M [C], or one file that has them: .mtx (MatrixMarket, Abaqus), .npz, .mat, .op4, .pch (DMIG), .matrix '
        '(Harwell-Boeing); FILE:NAME where it has several')
    add('--nodes', metavar='FILE', help='.csv: node,x,y,z,dofs of the rows of the matrices, in their order; dofs: some of 123456, or q of modal coordinates '
        '(101-120,,,,q); .asm, .bdf: grids of Nastran (of the .pch)')
    add('--modal', metavar='FLEX.txt', help='modal data without a mesh, a flex file of 42: M, K, C, P, H, shapes at the nodes of its node file, --nodes')
    add('--body', metavar='MASS,X,..', help='of modal data: mass, mass center x y z, inertia about it xx yy zz xy xz yz (elements of the tensor: 42 has the products with the other sign)')
    add('--joint', action='append', default=[], metavar='N:X,Y,Z', help='of modal data: place of joint N, which becomes node 1000 + N')
    add('--out', required=True, metavar='FILE', help='the description')
    add('--modes', type=int, metavar='N', help='the lowest (all of an .op2; 6; of reduced matrices all, 24 at most)')
    add('--frame', default='', metavar='NODES', help='those of the interface: clamped (of reduced matrices the first node); of an .op2, checked to stand still')
    add('--origin', metavar='X,Y,Z|NODE', help='of the component, in SI and the axes of the model (0,0,0; of reduced matrices the node of the frame); --origin=-1,0,0')
    add('--mark', action='append', default=[], metavar='NODES', help='become nodes of the body: 12:tip,20-25,SET5 (of reduced matrices the interface beside the frame)')
    add('--interface', action='append', default=[], metavar='NODES', help='marked nodes, or sets of a mesh that move as one, whose static deflections are kept whole: '
        'attachment modes beside --modes')
    add('--line', action='append', default=[], metavar='NODES',
        help='follow each other along a line, which gives the stiffening: 1-33/4; straight:NODES from displacements alone')
    add('--geometric', nargs=12, metavar='K_G', help='geometric stiffness under accelerations x y z, angular ones x y z, spins xx yy zz xy xz yz; none: not computed')
    add('--mass', metavar='FILE', help='mass matrix of all grids (MGG) beside a .bdf (that of the .op2, or lumped elements)')
    add('--subcase', type=int, metavar='N', help='of the .op2, where it has several')
    add('--scale', default='1,1', metavar='LENGTH,MASS', help='units of the model in m and kg: 0.001,1000 of mm and t (1,1)')
    add('--condense', action='store_true', help='a few points in place of all masses, with the same integrals')
    add('--grounded', action='store_true', help='K holds nodes to the ground on purpose, beside those of --frame')
    add('--tolerance', type=float, default=0.02, metavar='E', help='how far integrals of masses may be off (0.02)')
    add('--report', metavar='FILE', help='figures, modes, static deflections and notes: .html, a page whose modes move, or text')
    add('--word', action='append', default=[], type=str.strip, metavar='LINE', help="a line of the description: 'damping 0.005'")
    options = parser.parse_args(arguments)
    if options.matrices and not options.nodes and os.path.splitext(options.matrices[0].rsplit(':', 1)[0])[1].lower() in DECKS:
        options.nodes = options.matrices[0] if os.path.exists(options.matrices[0]) else options.matrices[0].rsplit(':', 1)[0]
    if options.modal:
        if options.files or options.matrices or not options.nodes or not options.body:
            parser.error('--modal wants --nodes FILE and --body MASS,X,Y,Z,XX,YY,ZZ,XY,XZ,YZ, and no other model')
        if options.line or options.geometric or options.condense or options.grounded or options.frame or options.modes or options.scale != '1,1' or options.mass:
            parser.error('--modal: of its options --nodes, --body, --joint, --mark, --origin, --word, --report, --tolerance go with it')
    elif options.body or options.joint:
        parser.error('--body and --joint are of --modal')
    if len(options.matrices or []) > 3:
        parser.error('--matrices wants K M [C], or one file')
    if options.modal:
        pass
    elif bool(options.matrices) == bool(options.files) or len(options.files) not in (0, 1, 2) or bool(options.matrices) != bool(options.nodes):
        parser.error('wants MODEL.bdf MODES.op2, MODEL.inp, or --matrices K M --nodes FILE')
    if is_mesh(options) or len(options.files) == 1:
        if not is_mesh(options) or options.geometric or options.mass:
            parser.error('wants MODEL.bdf MODES.op2, or MODEL.inp [MODEL.frd] without --mass and --geometric')
    else:
        options.mark += options.interface
        options.frame = [node for node, _ in listed(options.frame, '--frame')] if options.frame else []
    try:
        options.scale = [float(x) for x in options.scale.split(',')]
        origin = [float(x) for x in (options.origin or '0,0,0').split(',')]
        if len(options.scale) != 2 or not 0 < min(options.scale) <= max(options.scale) < math.inf or len(origin) not in (1, 3) or not all(map(math.isfinite, origin)):
            raise ValueError
    except ValueError:
        parser.error('--scale wants two numbers above 0, --origin three numbers or a node')
    if options.line and (options.condense or options.geometric):
        parser.error('--line goes neither with --condense, as masses on lines stay where they are, nor with --geometric')
    if options.geometric and set(options.geometric) == {'none'}:
        parser.error('--geometric has no matrix')
    read = [*options.files, *(options.matrices or []), options.modal or '', options.nodes or '', options.mass or '', *(options.geometric or [])]
    for what, target in (('--out', options.out), ('--report', options.report)):
        if target and os.path.exists(target) and any(os.path.exists(name) and os.path.samefile(target, name) for name in read + [options.out] * (what == '--report')):
            parser.error('%s: that is what is %s' % (what, 'read' if what == '--out' else 'read or written'))
    if not 0 <= options.tolerance < math.inf:
        parser.error('--tolerance wants a number from 0 on')
    if not all(options.word):
        parser.error('--word wants a line of the description')
    if options.modes is not None and options.modes < 1:
        parser.error('--modes wants a number from 1')
    return options


def main(arguments):
    try:
        options = options_of(arguments)
        try:
            text, figures, model, report = convert(options)
        finally:
            progress.clear()
        with open(options.out, 'w', encoding='utf-8') as file:
            file.write(text)
        if report:
            with open(options.report, 'w', encoding='utf-8') as file:
                file.write(report)
    except (OSError, UnicodeError, Refused) as error:
        print('import.py:', error, file=sys.stderr)
        return 1
    except MemoryError:
        print('import.py: %s: too large for the memory of this machine' % ' '.join(options.matrices or options.files or [options.modal]), file=sys.stderr)
        return 1
    except Exception as error:  # of a library, on what no check above has told
        at = error.__traceback__
        while at.tb_next and at.tb_next.tb_frame.f_code.co_filename == __file__:
            at = at.tb_next
        print('import.py: %s: not understood, in %s: %s' % (' '.join(options.matrices or options.files or [options.modal]), at.tb_frame.f_code.co_name, told(error)), file=sys.stderr)
        return 1
    print('%s: %d modes, %.6g to %.6g Hz, %s' % (options.out, len(model.hz), model.hz[0], model.hz[-1], figures))
    for note in model.notes:
        print('  ' + note)
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
