"use strict";
/* Controls, jobs and pictures. page.c computes; its functions and what they return stand at its top. */

const BODY = 0, EXACT = 1;
const LEAST = 2, MOST = 10; // [ms] of a frame for computing
const LARGE = 287, ELASTIC = 1, LARGE_ALONE = 256; // of fb_effect
const $ = id => document.getElementById(id);
const dark = matchMedia("(prefers-color-scheme: dark)");

let lib, memory, samples, points;
let refusal = ""; // of bench/check.h
const run = {}; // both models, as far as they have come
const view = {time: 0, playing: !matchMedia("(prefers-reduced-motion: reduce)").matches, last: 0, fps: 60, frames: 0, budget: MOST, curves: document.createElement("canvas")};
let tried = []; // settings of the present scene, drive and stiffness
let asked = 0; // frame that was asked for

// ---- the library

const text = at => {
  const bytes = new Uint8Array(memory.buffer);
  let end = at;
  while (bytes[end]) end++;
  return new TextDecoder().decode(bytes.subarray(at, end));
};
const numbers = (at, n) => new Float64Array(memory.buffer, at, n);

async function load() {
  const bytes = Uint8Array.from(atob($("wasm").textContent), c => c.charCodeAt(0));
  const refused = (what, why) => {
    refusal = text(what) + ": " + text(why);
    throw new Error(refusal);
  };
  const env = {sin: Math.sin, cos: Math.cos, atan2: Math.atan2, exp: Math.exp, page_refused: refused};
  lib = (await WebAssembly.instantiate(bytes, {env})).instance.exports;
  memory = lib.memory;
  samples = lib.page_samples();
  points = lib.page_points();
}

/* What a status says; a refusal with what was refused. */
const why = status => text(lib.page_status_text(status)) +
  (lib.page_refused_what() && text(lib.page_refused_what()) ? " (" + text(lib.page_refused_what()) + ": " +
    lib.page_refused_have().toPrecision(3) + ")" : "");

// ---- settings

const drive = () => +$("drive").value;
const stiffness = () => 10 ** +$("stiffness").value;
const share = () => 2 ** +$("share").value;
const boxes = () => [...$("switches").querySelectorAll("input")];

function effects() {
  const mask = boxes().reduce((sum, box) => sum + (box.checked ? +box.value : 0), 0);
  return !(mask & ELASTIC) ? 0 : mask & LARGE_ALONE ? LARGE : mask;
}

/* Rigid: nothing else matters; large deflection wants all. */
function settleSwitches() {
  const [elastic] = boxes(), large = boxes().find(box => +box.value === LARGE_ALONE);
  for (const box of boxes()) {
    const bound = box !== elastic && (!elastic.checked || (large.checked && box !== large));
    box.disabled = bound;
    if (bound && elastic.checked) box.checked = true;
  }
  const status = lib.page_effects_check(effects());
  $("half").textContent = status ? "Half an effect is worse than none: the library refuses this set unless told not to." : "";
}

function option(list, value, label) {
  const o = document.createElement("option");
  o.value = value;
  o.textContent = label;
  list.append(o);
}

function makeControls() {
  for (let k = 0; k < lib.page_scenes(); k++) option($("scene"), k, text(lib.page_text(k, 0)));
  for (let k = 0; text(lib.page_integrator_name(k)); k++) option($("integrator"), k, text(lib.page_integrator_name(k)));
  for (const s of [0.05, 0.1, 0.2, 0.5, 1, 2, 5]) option($("speed"), s, s === 1 ? "real time" : s + " \u00d7");
  for (let k = 0; text(lib.page_effect_name(k)); k++) {
    const label = document.createElement("label"), box = document.createElement("input");
    box.type = "checkbox";
    box.id = "effect" + k;
    box.value = lib.page_effect_mask(k);
    box.checked = !(box.value & LARGE_ALONE);
    label.append(box, text(lib.page_effect_name(k)));
    $("switches").append(label);
  }
}

function takeScene() {
  const scene = +$("scene").value;
  const [least, most, usual] = [0, 1, 2].map(k => lib.page_drive(scene, k));
  $("what").textContent = text(lib.page_text(scene, 1));
  $("drive_label").textContent = text(lib.page_text(scene, 2)).replace(/^./, c => c.toUpperCase());
  Object.assign($("drive"), {min: least, max: most, value: usual});
  $("stiffness").value = 0;
  lib.page_take(scene, usual, 1);
  const wanted = lib.page_number(0) / 12; // a run takes some 12 s
  $("speed").value = [...$("speed").options].reduce((a, b) =>
    Math.abs(Math.log(b.value / wanted)) < Math.abs(Math.log(a.value / wanted)) ? b : a).value;
  view.time = 0;
}

function showSettings() {
  const unit = text(lib.page_text(+$("scene").value, 3));
  const say = (id, value) => {
    $(id + "_value").textContent = value;
    $(id).setAttribute("aria-valuetext", value);
  };
  say("drive", drive().toPrecision(3) + " " + unit);
  say("stiffness", "\u00d7 " + stiffness().toPrecision(2));
  say("modes", $("modes").value);
  say("share", "\u00d7 " + share().toPrecision(2));
}

// ---- jobs: a body's run, the judge's two, the body's again for its time

function beginJudge() {
  lib.page_take(+$("scene").value, drive(), stiffness());
  Object.assign(run, {judge: 0, judgeNs: Infinity, judgeSlice: 1, judgeStatus: lib.page_judge_begin()});
  run.planes = lib.page_number(2);
  run.duration = lib.page_number(0);
  run.component = run.planes & 2 ? 2 : 1;
  run.of = lib.page_number(3) ? "middle, off the line of the ends" : "tip";
  tried = [];
}

function beginBody() {
  Object.assign(run, {body: 0, slice: 1, timeSlice: 1, timed: 0, ns: Infinity, recorded: NaN});
  run.serial = (run.serial || 0) + 1;
  run.status = lib.page_body_begin(+$("modes").value, effects(), +$("integrator").value, share());
  run.dt = run.status ? NaN : run.duration / samples / lib.page_body_steps();
  $("code").textContent = program();
}

/* Calls advance(n), n samples in some milliseconds; returns [status, ms, the next n]. */
function slice(advance, n) {
  const start = performance.now(), status = advance(n), ms = performance.now() - start;
  return [status, ms, Math.max(1, Math.min(2 * n, Math.round(n * 4 / Math.max(ms, 0.1))))];
}

function advanceBody() {
  const [status, , next] = slice(lib.page_body_advance, Math.min(run.slice, samples - run.body));
  run.body = lib.page_body_done();
  run.slice = next;
  run.status = status;
}

/* The steps of the same run again, alone: the least of 40 slices, and of those that follow while it plays: the browser's
   compiler takes its time. */
function timeBody() {
  const n = run.timeSlice, [status, ms, next] = slice(lib.page_body_time, n);
  run.status = status;
  run.timeSlice = next;
  if (ms >= 3) {
    run.ns = Math.min(run.ns, 1e6 * ms / (n * lib.page_body_steps()));
    run.timed++;
  }
}

function advanceJudge() {
  const n = Math.min(run.judgeSlice, samples - run.judge % samples);
  const [status, ms, next] = slice(lib.page_judge_advance, n);
  run.judge = lib.page_judge_done();
  run.judgeStatus = status;
  run.judgeSlice = next;
  if (run.judge > samples && (ms >= 3 || run.judge === 2 * samples && run.judgeNs === Infinity)) {
    run.judgeNs = Math.min(run.judgeNs, 1e6 * ms / (n * lib.page_judge_steps()));
  }
}

const bodyGoes = () => !run.status && run.body < samples;
const judgeGoes = () => !run.judgeStatus && run.judge < 2 * samples;
const timeGoes = () => !run.status && run.timed < 40;
const busy = () => bodyGoes() || judgeGoes() || timeGoes();

/* Works for some milliseconds. */
function work() {
  const until = performance.now() + view.budget;
  while (busy() && performance.now() < until) {
    if (bodyGoes()) {
      advanceBody();
    } else if (judgeGoes()) {
      advanceJudge();
    } else {
      timeBody();
    }
  }
  if (!busy() && view.playing && !run.status && ++view.frames % 12 === 0) timeBody();
  if (!busy() && (isNaN(run.recorded) || run.ns < 0.95 * run.recorded)) {
    run.recorded = run.ns;
    record();
  }
}

/* The exact beam's samples: of its second run. */
const exactDone = () => Math.max(0, run.judge - samples);
const judgeDt = () => run.duration / samples / lib.page_judge_steps();

// ---- figures

const short = x => +x.toPrecision(3) + "";
const percent = x => !(x >= 0) ? "" : x < 1e-7 ? "0 %" : short(100 * x) + " %";
const time = ns => !(ns < Infinity) ? "" : ns < 1e3 ? ns.toFixed(0) + " ns" : ns < 1e6 ? short(ns / 1e3) +
  " \u00b5s" : ns < 1e9 ? short(ns / 1e6) + " ms" : short(ns / 1e9) + " s";
const factor = x => !(x < Infinity) ? "" : x < 10 ? x.toPrecision(2) + " \u00d7" : (+x.toPrecision(3)).toFixed(0) + " \u00d7";

function setName() {
  const mask = effects();
  const known = {0: "rigid", 1: "linear", 3: "spin coupling", 31: "full", [LARGE]: "large"};
  return mask ? $("modes").value + " modes, " + (known[mask] || "set " + mask) : "rigid";
}

function showFigures(k) {
  const both = Math.min(run.body, exactDone()), judged = run.judge === 2 * samples;
  const cost = run.ns / run.dt, judge = run.judgeNs / judgeDt();
  const show = (id, value) => {
    if ($(id).textContent !== value) $(id).textContent = value;
  };
  show("error_now", k < both ? percent(lib.page_error_at(k)) : "");
  show("error", both ? percent(lib.page_error(both)) : "");
  show("off", judged ? "\u2248 " + percent(+lib.page_judge_off().toPrecision(1)) : "");
  show("ns", time(run.ns));
  show("judge_ns", judged ? time(run.judgeNs) : "");
  show("dt", time(1e9 * run.dt));
  show("judge_dt", time(1e9 * judgeDt()));
  show("cost", time(cost));
  show("judge_cost", judged ? time(judge) : "");
  show("real", factor(1e9 / cost));
  show("judge_real", judged ? factor(1e9 / judge) : "");
  $("progress").value = (run.body + run.judge) / (3 * samples);
}

/* A run has come to its end: its point, and a sentence. */
function record() {
  if (run.status || run.judgeStatus) {
    $("says").textContent = run.judgeStatus ? "The exact beam stops: " + why(run.judgeStatus)
      : "The modal body stops after " + (run.body * run.duration / samples).toPrecision(3) + " s: " + why(run.status);
    return;
  }
  const p = {name: setName() + ", " + text(lib.page_integrator_name(+$("integrator").value)) + ", " + time(1e9 * run.dt),
             error: lib.page_error(samples), ns: run.ns, cost: run.ns / run.dt};
  tried = tried.filter(q => q.name !== p.name).concat(p);
  $("says").textContent = text(lib.page_text(+$("scene").value, 0)) + ", " + p.name + ": error " + percent(p.error) +
    ", " + time(p.ns) + " per step; the exact beam " + time(run.judgeNs) + " per step.";
  const rows = tried.map(q => {
    const row = document.createElement("tr");
    for (const value of [q.name, percent(q.error), time(q.ns)]) {
      row.append(Object.assign(document.createElement("td"), {textContent: value}));
    }
    return row;
  });
  $("tried").tBodies[0].replaceChildren(...rows);
}

// ---- pictures

/* A canvas for drawing in CSS pixels, empty. */
function canvas(id) {
  const c = $(id), ratio = devicePixelRatio || 1, w = c.clientWidth, h = c.clientHeight;
  if (c.width !== Math.round(w * ratio) || c.height !== Math.round(h * ratio)) {
    c.width = Math.round(w * ratio);
    c.height = Math.round(h * ratio);
  }
  const g = c.getContext("2d");
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.clearRect(0, 0, w, h);
  g.font = "12px system-ui, Arial, sans-serif";
  g.lineJoin = g.lineCap = "round";
  return [g, w, h];
}

let colors = {};
function readColors() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ["ink", "quiet", "line", "body", "exact", "rigid"]) colors[name] = style.getPropertyValue("--" + name).trim();
}

function stroke(g, color, width, line, dash = []) {
  g.strokeStyle = color;
  g.lineWidth = width;
  g.setLineDash(dash);
  g.beginPath();
  line.forEach(([x, y], i) => i ? g.lineTo(x, y) : g.moveTo(x, y));
  g.stroke();
}

/* The plane that is looked at: of the bending; where both planes bend, from above and aside. */
const project = ([x, y, z]) => run.planes === 1 ? [x, y] : run.planes === 2 ? [x, z]
  : [0.87 * x - 0.5 * y, 0.25 * x + 0.43 * y + 0.87 * z];

/* Points of a model at sample k (between samples: root's pose and shape by themselves), `straight`: undeformed. */
function line(model, k, straight) {
  const a = Math.max(0, Math.floor(k)), done = model === BODY ? run.body : exactDone();
  const b = Math.min(a + 1, done - 1), s = b > a ? k - a : 0;
  const pose = numbers(lib.page_pose(model), 7 * samples), at = numbers(lib.page_line(model), 3 * points * samples);
  const mix = (v, n, i) => v[n * a + i] + s * (v[n * b + i] - v[n * a + i]);
  const same = [0, 1, 2, 3].reduce((sum, i) => sum + pose[7 * a + i] * pose[7 * b + i], 0) < 0 ? -1 : 1;
  let q = [0, 1, 2, 3].map(i => (1 - s) * pose[7 * a + i] + s * same * pose[7 * b + i]);
  const size = Math.hypot(...q);
  const [w, x, y, z] = q.map(v => v / size), root = [4, 5, 6].map(i => mix(pose, 7, i));
  const R = [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z), 1 - 2 * (x * x + z * z),
             2 * (y * z - w * x), 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)];
  const out = [];
  for (let p = 0; p < points; p++) {
    const d = straight ? [lib.page_number(1) * p / (points - 1), 0, 0] : [0, 1, 2].map(i => mix(at, 3 * points, 3 * p + i));
    out.push(project([0, 1, 2].map(i => root[i] + R[3 * i] * d[0] + R[3 * i + 1] * d[1] + R[3 * i + 2] * d[2])));
  }
  return out;
}

/* What the picture holds: both ends of every sample. */
function bounds() {
  const box = [0, 0, 0, 0];
  for (const [model, done] of [[BODY, run.body], [EXACT, exactDone()]]) {
    for (let k = 0; k < done; k += 2) {
      const l = line(model, k);
      for (const [x, y] of [l[0], l[points - 1]]) {
        box[0] = Math.min(box[0], x);
        box[1] = Math.min(box[1], y);
        box[2] = Math.max(box[2], x);
        box[3] = Math.max(box[3], y);
      }
    }
  }
  const L = lib.page_number(1);
  return [box[0] - 0.06 * L, box[1] - 0.06 * L, box[2] + 0.06 * L, box[3] + 0.06 * L];
}

/* A round number of at most x; of at least x. */
const rounds = x => [1, 2, 5, 10].map(m => m * 10 ** Math.floor(Math.log10(x)));
const roundDown = x => Math.max(...rounds(x).filter(v => v <= x));
const roundUp = x => Math.min(...rounds(x).filter(v => v >= x));

function drawPicture(k) {
  const [g, w, h] = canvas("picture");
  if (!run.body) return;
  if (run.boxed !== run.body + exactDone()) {
    run.boxed = run.body + exactDone();
    run.box = bounds();
  }
  const [x0, y0, x1, y1] = run.box, scale = Math.min(w / (x1 - x0), (h - 24) / (y1 - y0));
  const put = ([x, y]) => [w / 2 + (x - (x0 + x1) / 2) * scale, (h - 24) / 2 - (y - (y0 + y1) / 2) * scale];
  const body = line(BODY, Math.min(k, run.body - 1)).map(put);
  stroke(g, colors.rigid, 1.2, line(BODY, Math.min(k, run.body - 1), true).map(put), [5, 4]);
  if (k < exactDone()) {
    g.globalAlpha = 0.55;
    stroke(g, colors.exact, 8, line(EXACT, k).map(put));
    g.globalAlpha = 1;
  }
  stroke(g, colors.body, 2.5, body);
  g.fillStyle = colors.ink;
  g.beginPath();
  g.arc(...body[0], 4.5, 0, 7);
  g.fill();
  const bar = roundDown(w / 4 / scale);
  stroke(g, colors.quiet, 1.5, [[8, h - 8], [8 + bar * scale, h - 8]]);
  g.fillStyle = colors.quiet;
  g.fillText(bar + " m", 14 + bar * scale, h - 4);
}

/* Frame and scales of a diagram; returns where x and y go. */
function axes(g, [left, top, right, bottom], [x0, x1], [y0, y1], xs, ys, title) {
  const X = x => left + (x - x0) / (x1 - x0) * (right - left), Y = y => bottom - (y - y0) / (y1 - y0) * (bottom - top);
  g.fillStyle = colors.quiet;
  for (const [x, label] of xs) {
    stroke(g, colors.line, 1, [[X(x), top], [X(x), bottom]]);
    g.textAlign = "center";
    g.fillText(label, X(x), bottom + 15);
  }
  for (const [y, label] of ys) {
    stroke(g, colors.line, 1, [[left, Y(y)], [right, Y(y)]]);
    g.textAlign = "right";
    g.fillText(label, left - 6, Y(y) + 4);
  }
  g.textAlign = "left";
  g.fillText(title, left, top - 7);
  return [X, Y];
}

function ticks(least, most, n) {
  const step = roundUp((most - least) / n) || 1, out = [];
  for (let k = Math.ceil(least / step); k * step <= most + 1e-9 * step; k++) out.push([k * step, +(k * step).toPrecision(6) + ""]);
  return out;
}

/* What is drawn once for many frames: whether it is to be drawn again. */
function stale(id, ...depends) {
  const now = [$(id).clientWidth, $(id).clientHeight, devicePixelRatio, colors.ink, run.body, run.judge, run.recorded, ...depends].join();
  if (view[id + "Stamp"] === now) return false;
  view[id + "Stamp"] = now;
  return true;
}

/* The curves, and on a copy of them where time is. */
function drawCurves(k) {
  if (stale("curves", run.serial)) drawCurvesAnew();
  const [g, w, h] = canvas("curves"), x = 52 + (w - 68) * (k + 1) / samples;
  if (w && h) g.drawImage(view.curves, 0, 0, w, h);
  stroke(g, colors.ink, 1, [[x, 20], [x, h - 20]]);
}

function drawCurvesAnew() {
  const [g, w, h] = canvas("curves"), dt = run.duration / samples, c = run.component, middle = 0.62 * h, done = exactDone();
  const outputs = [BODY, EXACT].map(m => numbers(lib.page_output(m), 3 * samples));
  const at = (m, i) => outputs[m][3 * i + c];
  let least = 0, most = 0, worst = 0;
  const errors = [];
  for (let i = 0; i < Math.max(run.body, done); i++) {
    for (const [m, n] of [[BODY, run.body], [EXACT, done]]) {
      if (i < n) {
        least = Math.min(least, at(m, i));
        most = Math.max(most, at(m, i));
      }
    }
    if (i < Math.min(run.body, done)) {
      errors.push(100 * lib.page_error_at(i));
      worst = Math.max(worst, errors[i]);
    }
  }
  const pad = 0.06 * (most - least) || 1;
  const seconds = ticks(0, run.duration, w < 450 ? 4 : 8);
  const [X, Y] = axes(g, [52, 20, w - 16, middle - 22], [0, run.duration], [least - pad, most + pad], seconds.map(s => [s[0], ""]),
                      ticks(least - pad, most + pad, 4), "deflection of the " + run.of + " [m]");
  const curve = (m, n) => Array.from({length: n}, (_, i) => [X((i + 1) * dt), Y(at(m, i))]);
  g.globalAlpha = 0.55;
  stroke(g, colors.exact, 5, curve(EXACT, done));
  g.globalAlpha = 1;
  stroke(g, colors.body, 1.8, curve(BODY, run.body));
  const top = worst > 0 ? 1.1 * worst : 1;
  const [, E] = axes(g, [52, middle + 14, w - 16, h - 20], [0, run.duration], [0, top], seconds.map(s => [s[0], s[1] + " s"]),
                     ticks(0, top, 2), "error [%]");
  stroke(g, colors.body, 1.8, errors.map((e, i) => [X((i + 1) * dt), E(Math.min(e, top))]));
  Object.assign(view.curves, {width: $("curves").width, height: $("curves").height});
  if (w && h) view.curves.getContext("2d").drawImage($("curves"), 0, 0);
}

function drawPoints() {
  if (!stale("points", run.serial, tried.length, $("axis").value)) return;
  const [g, w, h] = canvas("points"), axis = $("axis").value;
  const all = tried.map(p => ({x: p[axis], y: 100 * p.error, now: false}));
  if (all.length && run.recorded > 0 && !run.status) all[all.length - 1].now = true;
  const exact = run.judge === 2 * samples ? {x: axis === "ns" ? run.judgeNs : run.judgeNs / judgeDt(), y: 100 * lib.page_judge_off()} : null;
  const shown = all.concat(exact || []).filter(p => p.x > 0 && p.y > 0).map(p => ({...p, x: Math.log10(p.x), y: Math.log10(p.y)}));
  const span = (key, least, most) => [Math.floor(Math.min(least, ...shown.map(p => p[key] - 0.1))),
                                      Math.ceil(Math.max(most, ...shown.map(p => p[key] + 0.1)))];
  const xs = span("x", ...(shown.length ? [Infinity, -Infinity] : [2, 5])), ys = span("y", ...(shown.length ? [Infinity, -Infinity] : [-2, 2]));
  const decades = ([a, b], name) => Array.from({length: b - a + 1}, (_, k) => [a + k, name(10 ** (a + k))]);
  const [X, Y] = axes(g, [58, 20, w - 22, h - 22], xs, ys, decades(xs, time), decades(ys, x => +x.toPrecision(1) + " %"),
                      "error against time " + (axis === "ns" ? "per step" : "per simulated second"));
  for (const p of shown) {
    g.beginPath();
    if (exact && p === shown[shown.length - 1]) {
      g.fillStyle = colors.exact;
      g.rect(X(p.x) - 6, Y(p.y) - 6, 12, 12);
    } else {
      g.fillStyle = colors.body;
      g.arc(X(p.x), Y(p.y), p.now ? 7 : 4.5, 0, 7);
    }
    g.globalAlpha = p.now || g.fillStyle === colors.exact ? 1 : 0.7;
    g.fill();
    g.globalAlpha = 1;
    if (p.now) stroke(g, colors.ink, 1.5, Array.from({length: 41}, (_, i) => [X(p.x) + 10 * Math.cos(i / 20 * Math.PI), Y(p.y) + 10 * Math.sin(i / 20 * Math.PI)]));
  }
  $("points").setAttribute("aria-label", "Error against time of " + all.length + " settings tried; the table below has them");
}

// ---- the setting as C

function program() {
  const [L, , , m, EIy, EIz, iy, iz, hub, J, load, Jl, gx, gy, gz, root, base, spin] =
    Array.from({length: 18}, (_, k) => lib.page_number(k + 1));
  const n = v => +v.toPrecision(6) + "", real = v => Number.isInteger(+n(v)) ? n(v) : "FB_R(" + n(v) + ")";
  const some = (condition, line) => condition ? [line] : [];
  const modes = +$("modes").value, name = text(lib.page_integrator_name(+$("integrator").value)), mask = effects();
  const masks = {0: "FB_EFFECTS_RIGID", 1: "FB_EFFECTS_LINEAR", 3: "FB_EFFECTS_SPIN", 31: "FB_EFFECTS_FULL", [LARGE]: "FB_EFFECTS_LARGE"};
  const gravity = gx || gy || gz;
  const step = {rk4: "fb_rk4_step(&body, &state, &work, &in[0], &in[1], &in[2], dt)",
                midpoint: "fb_midpoint_step(&body, &state, &work, &in[1], dt, 0)",
                sdirk: "fb_sdirk_step(&body, &state, &work, &in[0], &in[2], dt, 0)",
                exponential: "fb_exponential_step(&body, &scheme, &state, &work, &in[0], &in[1], &in[2])"}[name];
  return [
    "#define FLEXBEAM_IMPLEMENTATION",
    '#include "flexbeam.h"',
    "static fb_body body;",
    "static fb_build_work build_work;",
    "static fb_" + ({rk4: "rk4", exponential: "exponential"}[name] || "implicit") + "_work work;",
    ...some(name === "exponential", "static fb_exponential scheme;\nstatic fb_body_work scheme_work;"),
    "",
    "int main(void)",
    "{",
    "  const fb_section section = {.mass = " + real(m) + ", .EI_y = " + real(EIy) + ", .EI_z = " + real(EIz) +
      (iy || iz ? ", .i_y = " + real(iy) + ", .i_z = " + real(iz) : "") + "}; // [kg/m], [N m^2]",
    "  const fb_beam_desc beam = {.length = " + real(L) + ", .n_element = 8, .n_station = 1, .station = {section}" +
      (root ? ", .root = " + ["", "FB_ROOT_PINNED", "FB_ROOT_FREE"][root] : "") +
      (root === 2 ? ",\n                             .position = {" + real(-L / 2) + "}" : "") +
      (load ? ",\n                             .n_lump = 1, .lump = {{.node = 8, .mass = " + real(load) + ", .inertia = {" +
        [Jl, Jl, Jl].map(real).join(", ") + "}}}" : "") + "};",
    "  const fb_modes_desc keep = {.count = {" + (run.planes & 1 ? modes : 0) + ", " + (run.planes & 2 ? modes : 0) + "}" +
      (spin ? ", .spin = " + real(spin) : "") + "}; // along y, along z",
    "  const fb_build_desc model = {" + (hub ? ".mass = " + real(hub) + ", .inertia = {" + [J, J, J].map(real).join(", ") + "},\n      " : "") +
      ".n_part = 1, .part = {{.n_node = 1, .node = {" + real(L) + "}}},",
    "      .body = {.effects = " + (masks[mask] || mask) + (gravity ? " | FB_EFFECT_GRAVITY, .gravity = {" + [gx, gy, gz].map(real).join(", ") + "}" : "") +
      ", .base = " + ["FB_BASE_FREE", "FB_BASE_PRESCRIBED", "FB_BASE_HINGED"][base] +
      (lib.page_effects_check(mask) ? ", .allow_split_effects = 1" : "") + "}};",
    "  const fb_real dt = FB_R(" + (run.dt > 0 ? run.dt : run.duration / samples).toPrecision(6) + "); // [s]",
    "  fb_input in[3] = {{.n_load = 0}}; // loads, motion of the base: at the start, the middle and the end of a step",
    "  fb_state state;",
    "  fb_status status = fb_body_build(&body, &build_work, &model, &beam, &keep, 1);",
    "  status = status ? status : fb_state_init(&body, &state);",
    ...some(name === "exponential", "  status = status ? status : fb_exponential_init(&scheme, &scheme_work, &body, dt);"),
    "  for (int k = 0; k < " + Math.round(run.duration / (run.dt > 0 ? run.dt : run.duration / samples)) + " && status == FB_OK; k++) {",
    "    status = " + step + "; // set in[] before",
    "  }",
    "  return status != FB_OK;",
    "}"].join("\n");
}

// ---- a frame

function frame(now) {
  asked = 0;
  const passed = Math.min(now - view.last, 100);
  view.last = now;
  view.budget = passed > 22 ? Math.max(LEAST, view.budget - 1) : Math.min(MOST, view.budget + 0.1); // late: less
  try {
    work();
  } catch (error) {
    trouble(error);
    return;
  }
  if (view.playing && run.body) {
    view.time += passed / 1000 * +$("speed").value;
    if (view.time > run.duration) view.time = 0;
    view.fps += 0.05 * (1000 / Math.max(passed, 1) - view.fps);
    $("fps").textContent = view.fps.toFixed(0);
  }
  draw();
  if (view.playing || busy()) ask();
}

function ask() {
  if (!asked) asked = requestAnimationFrame(frame);
}

function draw() {
  const k = Math.max(0, Math.min(view.time / run.duration * samples - 1, samples - 1)), whole = Math.floor(k);
  drawPicture(k);
  if (run.body) {
    drawCurves(k);
    drawPoints();
  }
  showFigures(whole);
  if (document.activeElement !== $("time") || view.playing) $("time").value = 1000 * view.time / run.duration;
  const seconds = view.time.toFixed(run.duration < 10 ? 2 : 1) + " s";
  $("time_value").textContent = seconds;
  $("time").setAttribute("aria-valuetext", seconds);
}

/* A model was refused where bench/check.h ends a program: the library begins anew. */
async function trouble(error) {
  $("trouble").textContent = "Refused: " + (refusal || error.message);
  $("trouble").hidden = false;
  if (!refusal) throw error;
  refusal = "";
  await load();
  run.status = run.judgeStatus = -1;
}

function begin(judge) {
  $("trouble").hidden = true;
  try {
    showSettings();
    settleSwitches();
    if (judge) beginJudge();
    beginBody();
  } catch (error) {
    trouble(error);
  }
  ask();
}

function play(on) {
  view.playing = on;
  $("play").textContent = on ? "Pause" : "Play";
  ask();
}

async function start() {
  await load();
  readColors();
  makeControls();
  $("scene").addEventListener("change", () => { takeScene(); begin(true); });
  for (const id of ["drive", "stiffness"]) $(id).addEventListener("input", () => begin(true));
  for (const id of ["modes", "share", "switches"]) $(id).addEventListener("input", () => begin(false));
  $("integrator").addEventListener("change", () => begin(false));
  $("play").addEventListener("click", () => play(!view.playing));
  $("time").addEventListener("input", () => { view.time = $("time").value / 1000 * run.duration; play(false); });
  $("axis").addEventListener("change", ask);
  addEventListener("resize", ask);
  dark.addEventListener("change", () => { readColors(); ask(); });
  takeScene();
  begin(true);
  play(view.playing);
}

start();
