# import_report.py - the report of an import, for import.py: text, or a page of one file whose modes move. The page wants no network.
import html
import json

import numpy as np

DRAWN = 400  # nodes


def text(report):
    """Figures, modes, static deflections and warnings in lines of text."""
    lines = [report['title'], ''] + ['%-22s %s' % pair for pair in report['figures']]
    for head, rows in report['tables']:
        width = [max(len(cell) for cell in column) for column in zip(head, *rows)]
        lines += [''] + ['  '.join(cell.rjust(size) for cell, size in zip(row, width)) for row in [head] + rows]
    return '\n'.join(lines + [''] + ['- ' + note for note in report['notes']]) + '\n'


def drawn(x):
    """Numbers of nodes that show the shape: all, or those far from each other."""
    if len(x) <= DRAWN:
        return np.arange(len(x))
    chosen, away = [int(np.linalg.norm(x - x.mean(axis=0), axis=1).argmax())], np.full(len(x), np.inf)
    for _ in range(DRAWN - 1):
        away = np.minimum(away, np.linalg.norm(x - x[chosen[-1]], axis=1))
        chosen.append(int(away.argmax()))
    return np.array(sorted(chosen))


def neighbors(x):
    """Pairs of nodes that are near each other."""
    from scipy.spatial import cKDTree
    near = cKDTree(x).query(x, min(4, len(x)))[1].reshape(len(x), -1)
    return sorted({(min(k, int(other)), max(k, int(other))) for k, row in enumerate(near) for other in row if other != k})


def geometry(x, shape, pairs, names, curved):
    """What is drawn: places, edges, displacements and rotations of each mode, the largest displacement 1; names of marked nodes and the frame."""
    chosen = drawn(x)
    at = {int(k): n for n, k in enumerate(chosen)}
    edges = [(at[a], at[b]) for a, b in pairs if a in at and b in at] if len(chosen) == len(x) and pairs else neighbors(x[chosen])
    modes = []
    for k in range(shape.shape[2]):
        u = shape[chosen, :, k]
        most = np.linalg.norm(u[:, :3], axis=1).max(initial=0)
        u = u / most if most > 0 else u * 0
        modes.append([[float('%.3g' % value) for value in row[:6 if curved else 3]] for row in u])
    return {'x': [[float('%.5g' % value) for value in row] for row in x[chosen]], 'edges': edges, 'modes': modes, 'curved': curved,
            'names': [[at[k], name] for k, name in names if k in at]}


def page(report, drawing):
    """One HTML file."""
    cells = lambda kind, row: '<tr>' + ''.join('<%s>%s</%s>' % (kind, html.escape(cell), kind) for cell in row) + '</tr>'
    tables = ''.join('<table class="%s"><thead>%s</thead><tbody>%s</tbody></table>' % ('' if k else 'modes', cells('th', head), ''.join(cells('td', row) for row in rows))
                     for k, (head, rows) in enumerate(report['tables']))
    figures = ''.join('<dt>%s</dt><dd>%s</dd>' % tuple(map(html.escape, pair)) for pair in report['figures'])
    notes = ''.join('<li>%s</li>' % html.escape(note) for note in report['notes'])
    title = html.escape(report['title'])
    parts = {'TITLE': title, 'FIGURES': figures, 'TABLES': tables, 'NOTES': notes, 'DATA': json.dumps(drawing, separators=(',', ':')).replace('</', '<\\/')}
    out = PAGE
    for key, value in parts.items():
        out = out.replace('@%s@' % key, value)
    return out


PAGE = '''<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>@TITLE@</title>
<style>
:root { color-scheme: light dark; }
.line { color: light-dark(#1b5fa8, #7fb6ee); } .still { color: light-dark(#aaa, #777); } .mark { color: light-dark(#c1440e, #ff9a66); }
body { font: 15px/1.45 system-ui, sans-serif; margin: 1.5em auto; max-width: 72em; padding: 0 1em; }
h1 { font-size: 1.3em; } h2 { font-size: 1.05em; margin-top: 1.6em; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 0 1em; } dd { margin: 0; font-variant-numeric: tabular-nums; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; margin: 1em 0; display: block; overflow-x: auto; }
td, th { padding: 1px 9px; text-align: right; white-space: nowrap; } th { border-bottom: 1px solid; }
.modes tbody tr { cursor: pointer; } .modes tbody tr:hover, tr.shown { background: light-dark(#dcebfa, #24384d); }
canvas { width: 100%; height: 26em; border: 1px solid #8888; touch-action: none; cursor: grab; }
label, button, p span { margin-right: 1em; }
</style></head><body>
<h1>@TITLE@</h1><dl>@FIGURES@</dl>
<h2>Modes</h2>
<canvas id="view" aria-label="the shown mode, moving"></canvas>
<p><button id="play">Pause</button><label>deflection <input id="size" type="range" min="0" max="40" value="15"></label><span id="told"></span><span class="line">deflected</span><span class="still">at rest</span><span class="mark">marked nodes and frame</span></p>
@TABLES@
<h2>Notes</h2><ul>@NOTES@</ul>
<script>
'use strict';
const data = @DATA@, view = document.getElementById('view'), told = document.getElementById('told'), size = document.getElementById('size');
const rows = [...document.querySelectorAll('.modes tbody tr')], x = data.x, range = [0, 1, 2].map(i => [Math.min(...x.map(p => p[i])), Math.max(...x.map(p => p[i]))]);
const middle = range.map(r => (r[0] + r[1]) / 2), extent = Math.hypot(...range.map(r => r[1] - r[0])) || 1;
let mode = 0, phase = Math.PI / 2, last = 0, playing = !matchMedia('(prefers-reduced-motion: reduce)').matches, turn = 0.6, tilt = 0.5;
const color = name => getComputedStyle(document.querySelector('p .' + name)).color;

function place(p, u, k) { // on the screen, x to the right, z up, seen from turn and tilt
  const [a, b, c] = p.map((v, i) => (v - middle[i]) / extent + k * (u ? u[i] : 0)), s = view.height * 0.85;
  const right = -a * Math.sin(turn) + b * Math.cos(turn), away = a * Math.cos(turn) + b * Math.sin(turn);
  return [view.width / 2 + s * right, view.height / 2 - s * (c * Math.cos(tilt) - away * Math.sin(tilt))];
}

function path(a, b, shape, k) { // an edge; between interface nodes a curve that keeps their rotations
  if (!shape || !data.curved) { return [place(x[a], shape && shape[a], k), place(x[b], shape && shape[b], k)]; }
  const d = x[b].map((v, i) => v - x[a][i]), out = [];
  const slope = u => [u[4] * d[2] - u[5] * d[1], u[5] * d[0] - u[3] * d[2], u[3] * d[1] - u[4] * d[0]];
  const from = slope(shape[a]), to = slope(shape[b]);
  for (let n = 0; n <= 16; n++) {
    const s = n / 16, h = [1 - 3 * s * s + 2 * s ** 3, s - 2 * s * s + s ** 3, 3 * s * s - 2 * s ** 3, s ** 3 - s * s];
    out.push(place(d.map((v, i) => x[a][i] + s * v), d.map((v, i) => h[0] * shape[a][i] + h[1] * from[i] + h[2] * shape[b][i] + h[3] * to[i]), k));
  }
  return out;
}

function draw(time) {
  if (playing) { phase += (time - last) / 300; }
  last = time;
  const ratio = devicePixelRatio || 1, pen = view.getContext('2d');
  view.width = view.clientWidth * ratio;
  view.height = view.clientHeight * ratio;
  const lines = (shape, k, name, wide) => {
    pen.strokeStyle = color(name);
    pen.lineWidth = wide * ratio;
    pen.beginPath();
    for (const [a, b] of data.edges) { path(a, b, shape, k).forEach((p, n) => n ? pen.lineTo(...p) : pen.moveTo(...p)); }
    pen.stroke();
  };
  const shape = data.modes[mode], k = size.value / 100 * Math.sin(phase);
  lines(null, 0, 'still', 1);
  lines(shape, k, 'line', 2);
  pen.fillStyle = color('line');
  if (x.length < 60) { x.forEach((p, n) => { pen.beginPath(); pen.arc(...place(p, shape && shape[n], k), 3 * ratio, 0, 7); pen.fill(); }); }
  pen.fillStyle = color('mark');
  pen.font = 13 * ratio + 'px system-ui';
  for (const [n, name] of data.names) {
    const p = place(x[n], shape && shape[n], k);
    pen.fillRect(p[0] - 4 * ratio, p[1] - 4 * ratio, 8 * ratio, 8 * ratio);
    pen.fillText(name, p[0] + 8 * ratio, p[1] - 6 * ratio);
  }
  requestAnimationFrame(draw);
}

function show(number) {
  mode = number;
  rows.forEach((row, n) => row.classList.toggle('shown', n === number));
  const still = !data.modes[mode] || data.modes[mode].every(u => u.every(v => v === 0));
  told.textContent = 'mode ' + (number + 1) + ', ' + rows[number].cells[1].textContent + ' Hz' + (still ? ': it does not move these nodes' : '');
}

rows.forEach((row, n) => row.addEventListener('click', () => show(n)));
const play = document.getElementById('play');
const name = () => { play.textContent = playing ? 'Pause' : 'Play'; };
play.addEventListener('click', () => { playing = !playing; name(); });
view.addEventListener('pointermove', e => { if (e.buttons) { turn -= e.movementX / 150; tilt = Math.max(-1.5, Math.min(1.5, tilt + e.movementY / 150)); } });
name();
show(0);
requestAnimationFrame(t => { last = t; draw(t); });
</script></body></html>
'''
