// The controls of the page, as HTML elements. All text from files goes through textContent.

const SWITCHES = [
  ['axes', 'Axes', 'A'],
  ['bones', 'Bones', 'J'],
  ['triangles', 'Triangles', 'T'],
  ['controls', 'Controls', 'C'],
  ['names', 'Names', 'N'],
];
const VIEWS = [
  ['front', 'Front', '1'],
  ['side', 'Side', '2'],
  ['top', 'Top', '3'],
  ['three-quarter', '¾', '4'],
];
const KEYS = [
  ['Space', 'play, pause'],
  ['← →', 'scrub; with Shift by a second'],
  ['Home, End', 'start, end of the clip'],
  ['[ ]', 'clip before, clip after'],
  ['B', 'before, after, both'],
  ['A J T C N', 'axes, bones, triangles, controls, names'],
  ['M', 'mesh solid, see-through, hidden'],
  ['1 2 3 4', 'front, side, top, three-quarter'],
  ['Q E + −', 'turn, come nearer, go away'],
  ['Esc', 'no joint chosen'],
];
const find = (id) => document.getElementById(id);

// Characters that move a line, or turn what follows round; names are to do neither.
const UNSEEN = /[\u0000-\u001f\u007f-\u009f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]/g;

/** Text of a file as it may be seen: such characters as the escapes that they have. */
function plain(text) {
  return text.replace(UNSEEN, (one) => `\\u${one.charCodeAt(0).toString(16).padStart(4, '0')}`);
}

export function element(name, text = '', attributes = {}) {
  const made = document.createElement(name);
  made.textContent = plain(text);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

/** The elements of the page; `act` has what they do, `state` what is shown. */
export class Panel {
  constructor(state, act) {
    Object.assign(this, { state, act });
    for (const [key, word, letter] of SWITCHES) this.#addSwitch(key, word, letter);
    for (const [key, word, letter] of VIEWS) {
      const name = key === 'three-quarter' ? 'Three-quarter' : word;
      const button = element('button', word, { type: 'button', 'aria-label': name, 'aria-keyshortcuts': letter });
      button.addEventListener('click', () => act.look(key));
      find('views').append(button);
    }
    for (const [keys, what] of KEYS) {
      const term = element('dt');
      term.append(element('kbd', keys));
      find('keys').querySelector('dl').append(term, element('dd', what));
    }
    this.#wire();
  }

  #addSwitch(key, word, letter) {
    const label = element('label');
    const box = element('input', '', { type: 'checkbox', id: `show-${key}`, 'aria-keyshortcuts': letter });
    box.addEventListener('change', () => this.act.set(key, box.checked));
    label.append(box, element('span', word), element('kbd', letter));
    find('switches').append(label);
  }

  #wire() {
    const { act } = this;
    find('play').addEventListener('click', () => act.play());
    find('clip').addEventListener('change', () => act.clip(Number(find('clip').value)));
    find('time').addEventListener('input', () => act.time(Number(find('time').value)));
    find('speed').addEventListener('change', () => act.set('speed', Number(find('speed').value)));
    find('mesh').addEventListener('change', () => act.set('mesh', find('mesh').value));
    find('search').addEventListener('input', () => this.#search(find('search').value));
    find('player').addEventListener('submit', (event) => event.preventDefault());
    for (const radio of document.getElementsByName('side')) {
      radio.addEventListener('change', () => act.set('side', radio.value));
    }
  }

  /** Fill in what the files are. */
  fill(page, models) {
    const [model] = models;
    find('title').textContent = page.title;
    find('counts').textContent = counts(model);
    find('clip').append(element('option', 'Rest pose', { value: -1 }));
    model.clips.forEach((clip, k) => {
      find('clip').append(element('option', clip.name || `#${k}`, { value: k }));
    });
    find('sides').hidden = models.length < 2;
    this.#list(model);
  }

  /** Say what cannot be shown, or what went wrong. */
  tell(text) {
    const list = find('messages').querySelector('ul');
    if ([...list.children].some((line) => line.textContent === text)) return;
    list.append(element('li', text));
    find('messages').hidden = false;
    const count = list.children.length;
    find('messages').querySelector('summary').textContent = count === 1 ? '1 message' : `${count} messages`;
    if (count === 1) find('messages').open = true;
  }

  #list(model) {
    const { nodes } = model.facts;
    const depth = [];
    for (const [k, node] of nodes.entries()) {
      const above = node.parent;
      depth[k] = above >= 0 ? depth[above] + (nodes[above].joint || !node.joint ? 1 : 0) : 0;
    }
    this.rows = model.listed.map((node) => {
      const button = element('button', nodes[node].name, { type: 'button', 'aria-pressed': 'false' });
      button.style.paddingLeft = `${0.5 + 0.7 * Math.min(depth[node], 12)}rem`;
      button.addEventListener('click', () => this.act.select(nodes[node].path));
      const row = element('li');
      row.append(button);
      return { path: nodes[node].path, row, button, word: `${nodes[node].name}\n${nodes[node].path}`.toLowerCase() };
    });
    find('joints').append(...this.rows.map(({ row }) => row));
  }

  #search(text) {
    const word = text.trim().toLowerCase();
    for (const { row, word: own } of this.rows) row.hidden = !own.includes(word);
  }

  /** Show the state: what is on, what is chosen. */
  update() {
    const { state } = this;
    for (const [key] of SWITCHES) find(`show-${key}`).checked = state[key];
    find('mesh').value = state.mesh;
    find('clip').value = String(state.clip);
    const radio = [...document.getElementsByName('side')].find((one) => one.value === state.side);
    radio.checked = true;
    const none = state.clip < 0;
    for (const id of ['play', 'time']) find(id).disabled = none;
    find('play').textContent = state.playing ? 'Pause' : 'Play';
    find('time').max = String(state.duration || 1);
    for (const { path, button } of this.rows ?? []) {
      const chosen = path === state.selected;
      if ((button.getAttribute('aria-pressed') === 'true') === chosen) continue;
      button.setAttribute('aria-pressed', String(chosen));
      if (chosen) button.scrollIntoView({ block: 'nearest' });
    }
  }

  clock() {
    const { state } = this;
    find('time').value = String(state.time);
    find('time').setAttribute('aria-valuetext', `${state.time.toFixed(2)} seconds`);
    find('clock').textContent = `${state.time.toFixed(2)} / ${state.duration.toFixed(2)} s`;
  }

  deviation(now, largest) {
    find('deviation').textContent = now;
    find('largest').textContent = largest;
  }

  measure(text) {
    find('measure').textContent = text;
  }

  status(text) {
    find('status').textContent = text;
  }

  /** Say a name beside the pointer; null for none. */
  hint(text, x = 0, y = 0) {
    const hint = find('hint');
    hint.hidden = text === null;
    if (text === null) return;
    hint.textContent = text;
    hint.style.transform = `translate(${Math.round(x + 14)}px, ${Math.round(y + 10)}px)`;
  }

  /** What is known of the chosen joint, as pairs of words; null for none. */
  joint(name, pairs) {
    const section = find('joint');
    section.hidden = name === null;
    if (name === null) return;
    section.querySelector('h2').textContent = name;
    section.querySelector('dl').replaceChildren(
      ...pairs.flatMap(([term, text]) => [element('dt', term), element('dd', text)]),
    );
  }
}

function counts(model) {
  const { facts, points, clips } = model;
  // Number and word stay on one line.
  const many = (count, word) => `${count.toLocaleString('en')}\u00a0${word}${count === 1 ? '' : 's'}`;
  const joints = model.joints.length;
  const what = joints ? many(joints, 'joint') : `no joints, ${many(facts.nodes.length, 'node')}`;
  const words = [what, points.count === 1 ? '1\u00a0vertex' : `${points.count.toLocaleString('en')}\u00a0vertices`, many(clips.length, 'clip')];
  if (facts.limbs.length) words.push(many(facts.limbs.length, 'limb'));
  if (facts.controls) words.push(many(facts.controls, 'control'));
  return words.join(' · ');
}
