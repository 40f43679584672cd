// The page: loads what it carries, and keeps what is shown in step with what is asked for.

import { setConsoleFunction, Vector3 } from 'three';

import { facts } from './carried.js';
import { Model } from './model.js';
import { Overlay } from './overlay.js';
import { Panel } from './panel.js';
import { Stage } from './stage.js';

const html = document.documentElement;
const state = {
  side: 'after', mesh: 'solid', axes: true, bones: true, triangles: true, controls: true, names: false,
  clip: -1, time: 0, duration: 0, playing: false, speed: 1, selected: null, hover: null, // paths of nodes
};
const SIDES = ['before', 'after', 'both'];
const MESHES = ['solid', 'faint', 'none'];
// Seconds of an arrow key, and the share of time that measuring may take while a clip plays.
const STEP = 1 / 30;
const SHARE = 0.25;
// Nodes from which on lines are drawn otherwise. What a key turns the camera by, in radians, and what it brings it nearer by.
const CROWD = 1000;
const TURN = Math.PI / 12;
const ZOOM = 1.2;

const act = {
  set(key, value) {
    state[key] = value;
    changed();
  },
  look(name) {
    stage.look(name);
  },
  play() {
    if (state.clip < 0) return;
    state.playing = !state.playing;
    if (state.playing && state.time >= state.duration) state.time = 0;
    last = performance.now();
    changed();
  },
  clip(number) {
    state.clip = number;
    state.duration = number < 0 ? 0 : Math.max(...models.map((model) => model.clips[number]?.duration ?? 0));
    state.time = 0;
    state.playing &&= number >= 0;
    stage.frame(models.flatMap((model) => model.sweep(number, 0, state.duration)));
    moved();
    changed();
  },
  time(seconds) {
    state.time = Math.min(Math.max(seconds, 0), state.duration);
    state.playing = false;
    moved();
    changed();
  },
  select(path) {
    state.selected = path === state.selected ? null : path;
    changed();
  },
};
const panel = new Panel(state, act);
let stage;
let overlay;
let models = [];
let errors = 0;
let last = 0;
let stale = true;
let measured = { due: 0, largest: 0, pending: true };

/** Count an error, and tell it. */
function wrong(text) {
  errors += 1;
  html.dataset.errors = String(errors);
  panel.tell(String(text));
}

function listen() {
  html.dataset.errors = '0';
  window.addEventListener('error', (event) => wrong(event.message));
  window.addEventListener('unhandledrejection', (event) => wrong(event.reason?.message ?? event.reason));
  document.addEventListener('securitypolicyviolation', (event) => {
    wrong(`${event.violatedDirective} forbids ${event.blockedURI}`);
  });
  setConsoleFunction((kind, message, ...more) => {
    const text = [message, ...more].map((word) => word?.message ?? word).join(' ');
    if (kind === 'error') wrong(text);
    else if (kind === 'warn') panel.tell(text);
  });
}

async function start() {
  listen();
  const page = facts();
  for (const text of page.notices) panel.tell(text);
  const canvas = document.getElementById('lines');
  try {
    stage = new Stage(document.getElementById('picture'), canvas);
  } catch {
    throw new Error('This browser shows no WebGL 2; another one, or another setting of it, may');
  }
  overlay = new Overlay(canvas, page.models.some((model) => model.nodes.length > CROWD));
  models = [];
  for (const model of page.models) models.push(await Model.load(model, wrong));
  stage.fit();
  stage.show(models);
  panel.fill(page, models);
  compareOrSay();
  pointers(canvas);
  document.addEventListener('keydown', pressed);
  overlay.dark.addEventListener('change', changed);
  begin(page);
  html.dataset.bones = String(models[0].joints.length);
  html.dataset.clips = String(models[0].clips.length);
  html.dataset.points = String(models[0].points.count);
  window.rigtri = { state, act, models, worlds, spots: () => overlay.spots };
  frame(performance.now());
  panel.status('');
  html.dataset.state = 'ready';
}

/** Take up the clip and the time that the page was made for. */
function begin(page) {
  const { clip, time } = page.start;
  act.clip(models[0].clips[clip] ? clip : -1);
  if (time !== null) act.time(time);
  else if (state.clip >= 0 && !window.matchMedia('(prefers-reduced-motion: reduce)').matches) act.play();
}

/** Whether the points of two models can be compared; what is said where they cannot. */
function compareOrSay() {
  if (models.length < 2) return;
  const [after, before] = models;
  measured.unlike = after.points.unlike(before.points);
  const { count } = after.points;
  panel.measure(measured.unlike
    ? `Not measured: ${measured.unlike}`
    : `Farthest of ${count.toLocaleString('en')} vertices at the time shown, as a share of the size`);
  if (measured.unlike) panel.deviation('–', '–');
}

/** Where all nodes are now in the file's own space, by path: 16 numbers of a row-vector matrix, row by row. */
function worlds(model = models[0]) {
  // The scene of three stands upright and in metres, which of USD need not be so.
  const back = model.root.children[0].matrixWorld.clone().invert();
  const place = (node) => back.clone().multiply(node.matrixWorld).toArray();
  return Object.fromEntries(model.facts.nodes.map(({ path }, k) => [path, place(model.nodes[k])]));
}

function changed() {
  stale = true;
  panel.update();
}

/** Pose all models at the time of the state. */
function moved() {
  for (const model of models) model.seek(state.clip, state.time);
  measured.pending = true;
  stale = true;
}

function frame(now) {
  if (state.playing) {
    const next = state.time + ((now - last) / 1000) * state.speed;
    state.time = next > state.duration ? next % (state.duration || 1) : Math.max(next, 0);
    moved();
  }
  last = now;
  if (stage.fit() || stage.stale || stale) {
    stage.stale = stale = false;
    const shown = stage.draw(models, state);
    overlay.draw(stage, shown, state);
    panel.clock();
    tellJoint(shown[0]);
  }
  if (measured.pending && now >= measured.due) measure(now);
  requestAnimationFrame(frame);
}

/** Measure how far the models are apart now. */
function measure(now) {
  measured.pending = false;
  if (models.length < 2 || measured.unlike) return;
  const began = performance.now();
  const [after, before] = models;
  const share = after.points.farthest(before.points) / before.size;
  measured.largest = Math.max(measured.largest, share);
  html.dataset.deviation = String(share);
  html.dataset.largest = String(measured.largest);
  panel.deviation(share.toExponential(1), measured.largest.toExponential(1));
  const took = performance.now() - began;
  measured.due = state.playing ? now + Math.max(100, took / SHARE) : 0;
}

function tellJoint(model) {
  const node = model.facts.nodes.findIndex(({ path }) => path === state.selected);
  if (node < 0) return panel.joint(null);
  const { matrixWorld } = model.nodes[node];
  const words = (vector) => [...vector].map((x) => (Math.abs(x) < 5e-4 ? 0 : x).toFixed(3)).join(' ');
  const pairs = [['path', model.facts.nodes[node].path], ['at', words(model.place(node))]];
  ['x', 'y', 'z'].forEach((axis, k) => {
    pairs.push([axis, words(new Vector3().setFromMatrixColumn(matrixWorld, k).normalize())]);
  });
  const { aim } = model.facts.nodes[node];
  if (aim) pairs.push(['bone', `${aim.axis.replace('-', '−')} is ${aim.off.toFixed(1)}° off ${model.facts.nodes[aim.child].name}`]);
  if (model.facts.nodes[node].note) pairs.push(['is', model.facts.nodes[node].note]);
  return panel.joint(model.facts.nodes[node].name, pairs);
}

/** Names under the pointer; a click or a tap chooses. */
function pointers(canvas) {
  let pressedAt = null;
  const spot = (event, reach) => {
    const { left, top } = canvas.getBoundingClientRect();
    const [x, y] = [event.clientX - left, event.clientY - top];
    return { x, y, found: overlay.near(x, y, reach) };
  };
  const hover = (found, x, y) => {
    panel.hint(found?.name ?? null, x, y);
    const path = found?.path ?? null;
    if (path !== state.hover) act.set('hover', path);
  };
  canvas.addEventListener('pointermove', (event) => {
    if (event.pointerType === 'touch' || event.buttons) return hover(null);
    const { x, y, found } = spot(event, 12);
    return hover(found, x, y);
  });
  canvas.addEventListener('pointerleave', () => hover(null));
  canvas.addEventListener('pointerdown', (event) => { pressedAt = [event.clientX, event.clientY]; });
  canvas.addEventListener('pointerup', (event) => {
    const still = pressedAt && Math.hypot(event.clientX - pressedAt[0], event.clientY - pressedAt[1]) < 5;
    const { found } = spot(event, event.pointerType === 'touch' ? 24 : 12);
    if (still && found) act.select(found.path);
  });
}

const turn = (list, value) => list[(list.indexOf(value) + 1) % list.length];
const flip = (key) => () => act.set(key, !state[key]);
const SHORTCUTS = {
  ' ': () => act.play(),
  ArrowLeft: (event) => act.time(state.time - (event.shiftKey ? 1 : STEP)),
  ArrowRight: (event) => act.time(state.time + (event.shiftKey ? 1 : STEP)),
  Home: () => act.time(0),
  End: () => act.time(state.duration),
  '[': () => act.clip(Math.max(state.clip - 1, -1)),
  ']': () => act.clip(Math.min(state.clip + 1, models[0].clips.length - 1)),
  b: () => models.length > 1 && act.set('side', turn(SIDES, state.side)),
  m: () => act.set('mesh', turn(MESHES, state.mesh)),
  a: flip('axes'), j: flip('bones'), t: flip('triangles'), c: flip('controls'), n: flip('names'),
  q: () => stage.turn(-TURN), e: () => stage.turn(TURN), '+': () => stage.zoom(1 / ZOOM), '-': () => stage.zoom(ZOOM),
  1: () => act.look('front'), 2: () => act.look('side'), 3: () => act.look('top'), 4: () => act.look('three-quarter'),
  Escape: () => act.set('selected', null),
};

// Elements that letters, Space, and arrows have a meaning for.
const TYPED = 'input[type=search], select';
const PRESSED = `${TYPED}, button, summary, input[type=checkbox], input[type=radio]`;
const MOVED = `${TYPED}, input[type=range], input[type=radio]`;

/** A key of the page, where no element in focus has a use of its own for it. */
function pressed(event) {
  const { target, key } = event;
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const does = SHORTCUTS[key.length === 1 ? key.toLowerCase() : key];
  const own = key.length > 1 ? MOVED : key === ' ' ? PRESSED : TYPED;
  if (!does || (key !== 'Escape' && target.matches?.(own))) return;
  event.preventDefault();
  does(event);
}

start().catch((error) => {
  console.error(error);
  wrong(error.message);
  panel.status(error.message);
  html.dataset.state = 'failed';
});
