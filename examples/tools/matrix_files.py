# matrix_files.py - matrices of finite-element programs whose files SciPy does not read, for import.py: DMIG cards of Nastran, .mtx of
# Abaqus, Harwell-Boeing as ANSYS writes it. Each reader gives matrices by name, with the (node, degree of freedom) of each row, or None
# where the file has not that; degree 0: a scalar point, a modal coordinate.
import math
import re

import numpy as np
from scipy import sparse


class Refused(Exception):
    """What is wrong, where, and what would be right."""


def number(kind, word, path, line, what):
    """A number as Fortran writes it: 1.5D+3, and of Nastran 1.5+3; nothing is 0."""
    word = word.strip()
    try:
        if kind is int:
            value = int(word or 0)
        else:
            value = float(re.sub(r'(?<=[\d.])([+-]\d+)$', r'e\1', word.upper().replace('D', 'E')) if word else 0)
        if not math.isfinite(value) or abs(value) > (2000000000 if kind is int else 1e300):
            raise ValueError
        return value
    except ValueError:
        raise Refused('%s:%d: %s: a %snumber is wanted, not %r' % (path, line, what, 'whole ' if kind is int else '', word))


def text_lines(path):
    """Number and text of each line; files may have remarks in any code."""
    try:
        with open(path, encoding='latin-1') as file:
            yield from enumerate(file, 1)
    except OSError as error:
        raise Refused('%s: %s' % (path, error.strerror))


# ---- Nastran


def cards(path):
    """Bulk data cards of a deck or punch file: name, fields (a continuation follows in whole lines of 8, or of 4 with *), line of each field."""
    name, fields, lines = '', [], []
    for k, line in text_lines(path):
        line = line.split('$')[0].rstrip().expandtabs(8)
        if not line:
            continue
        if ',' in line:
            words = [word.strip() for word in line.split(',')]
            head, large = words[0], words[0].endswith('*')
            part = words[1:5] if large else words[1:9]
        else:
            head, large = line[:8].strip(), line[:8].rstrip().endswith('*')
            part = [line[8 + 16 * j:24 + 16 * j] for j in range(4)] if large else [line[8 + 8 * j:16 + 8 * j] for j in range(8)]
        part += [''] * ((4 if large else 8) - len(part))
        if re.match(r'[A-Za-z]', head):
            if name:
                yield name, fields, lines
            name, fields, lines = head.rstrip('*').strip().upper(), [], []
        fields += [word.strip() for word in part]
        lines += [k] * len(part)
    if name:
        yield name, fields, lines


def of_labels(entries, symmetric, path):
    """Labels in their order, and the matrix, of (label, label, value, line); of a symmetric one each entry stands once."""
    labels = sorted({label for entry in entries for label in entry[:2]})
    at = {label: k for k, label in enumerate(labels)}
    rows, columns = (np.array([at[entry[k]] for entry in entries], dtype=int) for k in (0, 1))
    value = np.array([entry[2] for entry in entries])
    key = np.minimum(rows, columns) * len(labels) + np.maximum(rows, columns) if symmetric else rows * len(labels) + columns
    order = np.argsort(key, kind='stable')
    again = np.flatnonzero((np.diff(key[order]) == 0) & (not symmetric or np.diff(value[order]) != 0))
    for k in order[again[:1] + 1]:
        raise Refused('%s:%d: the entry of node %d, degree of freedom %d and node %d, degree of freedom %d is there twice'
                      % (path, entries[k][3], *entries[k][0], *entries[k][1]))
    if symmetric:
        once = order[np.concatenate([[True], np.diff(key[order]) != 0])] if len(order) else order
        rows, columns, value = rows[once], columns[once], value[once]
        off = rows != columns
        rows, columns, value = np.concatenate([rows, columns[off]]), np.concatenate([columns, rows[off]]), np.concatenate([value, value[off]])
    return sparse.csr_array((value, (rows, columns)), shape=(len(labels), len(labels))), labels


def dmig(path):
    """Matrices of DMIG cards (MSC Nastran Quick Reference Guide, DMIG); rectangular ones, which are loads, are left out."""
    forms, entries = {}, {}
    for name, fields, lines in cards(path):
        if name != 'DMIG':
            continue
        matrix = fields[0].upper()
        if fields[1] == '0' and not fields[2].isdigit():
            raise Refused('%s:%d: DMIG %s: its form (1 square, 6 symmetric, 2 and 9 rectangular) is wanted, not %r' % (path, lines[2], matrix, fields[2]))
        if fields[1] == '0':
            forms[matrix] = int(fields[2]), number(int, fields[3], path, lines[3], 'DMIG %s: its type' % matrix)
            if forms[matrix][0] not in (1, 2, 6, 9):
                raise Refused('%s:%d: DMIG %s: form %d: 1 (square), 6 (symmetric), 2 or 9 (rectangular) are known' % (path, lines[2], matrix, forms[matrix][0]))
            continue
        if matrix not in forms:
            raise Refused('%s:%d: DMIG %s: its header (DMIG, %s, 0, form, ..) has to come first' % (path, lines[0], matrix, matrix))
        column = label_of(fields[1:3], path, lines[1], matrix)
        for k in range(4, len(fields) - 3, 4):
            if any(fields[k:k + 4]):
                parts = [number(float, word, path, lines[k], 'DMIG %s' % matrix) for word in fields[k + 2:k + 4]]
                entries.setdefault(matrix, []).append((label_of(fields[k:k + 2], path, lines[k], matrix), column,
                                                       complex(*parts) if forms[matrix][1] > 2 else parts[0], lines[k]))
    return {matrix: of_labels(entries.get(matrix, []), form == 6, path) for matrix, (form, _) in forms.items() if form in (1, 6)}


def label_of(words, path, line, matrix):
    node, dof = (number(int, word, path, line, 'DMIG %s: %s' % (matrix, what)) for word, what in zip(words, ('point', 'component')))
    if node < 1 or not 0 <= dof <= 6:
        raise Refused('%s:%d: DMIG %s: a point from 1 and a component 0 to 6 are wanted, not %s, %s' % (path, line, matrix, *words))
    return node, dof


# ---- Abaqus


def abaqus(path, most):
    """Matrices of an Abaqus .mtx: of a substructure (*USER ELEMENT, *MATRIX), or of *MATRIX OUTPUT as node, degree, node, degree, value or as row,
    column, value (Abaqus Keywords Guide, *SUBSTRUCTURE MATRIX OUTPUT, *MATRIX OUTPUT)."""
    for _, line in text_lines(path):
        if line.strip() and not line.startswith('**'):
            return abaqus_substructure(path) if line.startswith('*') else abaqus_entries(path, most)
    raise Refused('%s: has no matrix: it is empty' % path)


def abaqus_entries(path, most):
    entries, width = [], None
    for k, line in text_lines(path):
        words = line.replace(',', ' ').split()
        if not words or line.startswith('**'):
            continue
        width = width or len(words)
        if len(words) != width or width not in (3, 5):
            raise Refused('%s:%d: MatrixMarket (%%%%MatrixMarket matrix ..) or a matrix of Abaqus is wanted: *USER ELEMENT, lines of node, degree of freedom, '
                          'node, degree of freedom, value, or lines of row, column, value; not %r' % (path, k, line.strip()[:60]))
        place = [number(int, word, path, k, 'row') for word in words[:-1]]
        a, b = ((0, place[0]), (0, place[1])) if width == 3 else (tuple(place[:2]), tuple(place[2:]))
        if width == 3 and not 0 < min(place) <= max(place) <= most[0]:
            raise Refused('%s:%d: row %d, column %d; %s have %d degrees of freedom at most' % (path, k, *place, most[1], most[0]))
        entries.append((a, b, number(float, words[-1], path, k, 'value'), k))
    both = {(entry[0] > entry[1]) - (entry[0] < entry[1]) for entry in entries}
    A, labels = of_labels(entries, len(both - {0}) < 2, path)
    if width == 5:
        return {'': (A, labels)}
    at = np.array([label[1] - 1 for label in labels])  # rows without an entry are there, too
    A = A.tocoo()
    return {'': (sparse.csr_array((A.data, (at[A.row], at[A.col])), shape=(at.max() + 1,) * 2), None)}


def abaqus_substructure(path):
    nodes, dofs, values, name, section, unsymmetric, start, wanted = [], {}, {}, None, '', False, {}, 0
    for k, line in text_lines(path):
        if line.startswith('**'):
            words = line[2:].replace(',', ' ').split()
            if section == '*USER ELEMENT' and words and all(word.isdigit() for word in words):
                nodes += [number(int, word, path, k, 'node') for word in words]
            continue
        if line.startswith('*'):
            words = [word.strip().upper() for word in line.split(',')]
            section, unsymmetric = words[0], unsymmetric or 'UNSYM' in words
            wanted = next((number(int, word.split('=')[1], path, k, 'NODES') for word in words if re.match(r'NODES\s*=', word)), wanted)
            name = next((word.split('=')[1].strip() for word in words if re.match(r'TYPE\s*=', word)), None) if section == '*MATRIX' else None
            if name in values:
                raise Refused('%s:%d: a second *MATRIX, TYPE=%s: one substructure in a file is wanted' % (path, k, name))
            if name:
                values[name], start[name] = [], k
            continue
        words = [word for word in line.replace(',', ' ').split()]
        if section == '*USER ELEMENT':
            numbers = [number(int, word, path, k, 'degree of freedom') for word in words]
            first, numbers = (numbers[0], numbers[1:]) if dofs else (1, numbers)  # the position of the node from which on they hold
            if not 1 <= first <= len(nodes):
                raise Refused('%s:%d: the %d nodes of the remark ** ELEMENT NODES have none at position %d' % (path, k, len(nodes), first))
            dofs[first] = numbers
        elif name:
            values[name] += [number(float, word, path, k, 'value') for word in words]
    if len(nodes) != wanted:
        raise Refused('%s: *USER ELEMENT has %d nodes, the remark ** ELEMENT NODES has %d: both are wanted, as *SUBSTRUCTURE MATRIX OUTPUT writes them'
                      % (path, wanted, len(nodes)))
    labels, now = [], []
    for k, node in enumerate(nodes, 1):
        now = dofs.get(k, now)
        labels += [(node, dof if 1 <= dof <= 6 else 0) for dof in now]
    out = {}
    for name, value in values.items():
        n = math.isqrt(len(value)) if unsymmetric and name == 'STIFFNESS' else (math.isqrt(1 + 8 * len(value)) - 1) // 2
        if len(value) not in (n * n, n * (n + 1) // 2) or n < max(len(labels), 1):
            raise Refused('%s:%d: *MATRIX, TYPE=%s: %d values, the %d degrees of freedom of the nodes want %d: it is not whole'
                          % (path, start[name], name, len(value), len(labels), len(labels) * (len(labels) + 1) // 2))
        A = np.zeros((n, n))
        if len(value) == n * n and n > 1:
            A = np.array(value).reshape(n, n)
        else:
            A[np.tril_indices(n)] = value
            A = A + np.tril(A, -1).T
        out[name] = sparse.csr_array(A), labels + [(0, 0)] * (n - len(labels))  # what comes after the nodes is modal
    return out


# ---- Harwell-Boeing


def harwell_boeing(path, most):
    """An assembled real matrix ([Duff, Grimes, Lewis 1992], Users' guide for the Harwell-Boeing sparse matrix collection); SciPy reads no
    symmetric one. A right-hand side is left alone."""
    lines = [line.rstrip('\n') for _, line in text_lines(path)]
    if len(lines) < 4:
        raise Refused('%s:1: a Harwell-Boeing file begins with four lines of its head: it is not whole' % path)
    count = [number(int, lines[1][14 * k:14 * k + 14], path, 2, 'number of lines') for k in range(5)]
    kind, size = lines[2][:3].upper(), [number(int, lines[2][14 * k:14 * k + 14], path, 3, 'rows, columns or entries') for k in (1, 2, 3)]
    if kind not in ('RSA', 'RUA', 'ISA', 'IUA'):
        raise Refused('%s:3: of type %r: RSA (real, symmetric, assembled) or RUA is wanted, in ASCII' % (path, lines[2][:3]))
    if max(size[:2]) > most[0]:
        raise Refused('%s:3: %d rows, %d columns; %s have %d degrees of freedom at most' % (path, *size[:2], most[1], most[0]))
    if min(count[:4] + size) < 0 or len(lines) < 4 + sum(count[1:4]):
        raise Refused('%s:2: %d lines of numbers are announced, the file has %d: it is not whole' % (path, sum(count[1:4]), len(lines) - 4))
    at, parts = 4 + (count[4] > 0), []
    for k, form in enumerate(form for form in (lines[3][:16], lines[3][16:32], lines[3][32:52])):
        width = re.search(r'\(\s*(?:\d+P\s*,?\s*)?(\d*)\s*[IEFDGefdgi](\d+)', form)
        if not width or not 0 < int(width[2]) < 100:
            raise Refused('%s:4: a format of numbers such as (8I10) or (4E20.12) is wanted, not %r' % (path, form.strip()))
        step, much = int(width[2]), int(width[1] or 1)
        part = []
        for row in range(at, at + count[1 + k]):
            line = lines[row] if row < len(lines) else ''
            part += [number(int if k < 2 else float, line[step * j:step * j + step], path, row + 1, 'entry') for j in range(much) if line[step * j:step * j + step].strip()]
        parts.append(np.array(part, dtype=int if k < 2 else float))
        at += count[1 + k]
    start, rows, value = parts
    if len(start) != size[1] + 1 or len(rows) != size[2] or len(value) != size[2]:
        raise Refused('%s:2: %d columns and %d entries are announced, there are %d pointers, %d rows and %d values: it is not whole, or its pointers are wrong'
                      % (path, *size[1:], len(start), len(rows), len(value)))
    if start[0] != 1 or start[-1] != size[2] + 1 or np.any(np.diff(start) < 0) or np.any((rows < 1) | (rows > size[0])):
        raise Refused('%s:5: its pointers to columns do not go from 1 to %d, or a row is none of 1 to %d' % (path, size[2] + 1, size[0]))
    A = sparse.csr_array(sparse.csc_array((value, rows - 1, start - 1), shape=size[:2]))
    if kind[1] == 'S' and size[0] == size[1] and (sparse.triu(A, 1).nnz == 0 or sparse.tril(A, -1).nnz == 0):  # ANSYS writes all of some
        A = sparse.csr_array(A + A.T - sparse.diags_array(A.diagonal()))
    return {'': (A, None)}
