// A model file, what is wrong with it, sliders for its parameters, and its motion.  All answers come from a worker (`worker.js`); this only asks and shows.

const at = id => document.getElementById(id);
const told = document.documentElement.dataset;     // what a test, or another script, can read
const files = JSON.parse(at("files").textContent);

// ---- the library, in a worker that can be stopped
const PATIENCE = 1500;                              // ms that a question may take when another waits
const compiled = unpacked(at("library").textContent).then(bytes => WebAssembly.compile(bytes));
const source = URL.createObjectURL(new Blob([at("worker").textContent], {type: "text/javascript"}));
at("library").remove();                             // some megabytes that nobody needs twice
let worker = null, asked = null, number = 0;

async function unpacked(text) {
  const packed = Uint8Array.from(atob(text), letter => letter.charCodeAt(0));
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer();
}

// What the library answers; it fails where it is stopped before.
async function ask(question) {
  const module = await compiled;
  if (!worker) {
    worker = new Worker(source);
    worker.postMessage(module);
    worker.onmessage = ({data}) => { if (data.number === number) asked?.answered(data.answer); };
    worker.onerror = event => asked?.answered({error: `error: ${event.message}`});
  }
  const answer = new Promise((answered, stopped) => asked = {answered, stopped});
  worker.postMessage({number: ++number, ...question});
  return answer;
}

function halt() {
  worker?.terminate();
  worker = null;
  asked?.stopped(new Error("stopped"));
}

// ---- one thing at a time, and of what waits only the last
let busy = false, waiting = false, patience;

async function refresh() {
  waiting = true;
  if (busy) {
    patience ??= setTimeout(halt, PATIENCE);
    return;
  }
  busy = true;
  while (waiting) {
    waiting = false;
    clearTimeout(patience);
    patience = undefined;
    try {
      await show();
    } catch (problem) {
      say(problem.message, "wrong");
    }
  }
  busy = false;
}

function say(text, outcome) {
  at("state").textContent = text;
  at("stop").disabled = outcome !== "busy";
  told.state = outcome;
}

// ---- what is shown
let file = "", loaded = null;                       // the file of the menu; the model that the controls are for
let fresh = true;                                   // whether its first motion is still to come
const moved = new Map();                            // values of parameters that are not the scene's

async function show() {
  const model = {name: file, text: at("text").value};
  if (loaded?.model.name !== model.name || loaded.model.text !== model.text) {
    say("deriving …", "busy");
    const found = await ask({what: "load", model});
    if (found.error) {
      at("problems").textContent = found.error;
      at("warnings").textContent = "";
      return say("", "wrong");
    }
    describe(model, found);
  }
  at("problems").textContent = "";
  at("warnings").textContent = loaded.warnings;
  say("running …", "busy");
  const run = await ask({what: "run", model, options: options()});
  at("failed").textContent = run.error ?? run.failed ?? "";
  at("words").textContent = run.words ?? "";
  at("chart").innerHTML = run.chart ?? "";
  if (run.animation) animate(run.animation);
  if (waiting) return;
  const small = await ask({what: "modes", model, options: changes()});
  at("small").textContent = small.words ?? small.error;
  told.end = JSON.stringify(run.end ?? null);
  told.runs = Number(told.runs ?? 0) + 1;
  say("", run.error || run.failed ? "failed" : "done");
}

// The animation of a new model plays; of another motion of the same it goes on where the last one was, and rests if that was stopped.
const playback = {there: false, along: 0, rests: false};
function animate(page) {
  const frame = at("animation"), inside = id => frame.contentDocument.getElementById(id);
  if (playback.there) {
    playback.along = Number(inside("slider").value);
    playback.rests = frame.contentDocument.documentElement.dataset.playing === "false";
  }
  if (fresh || playback.along >= 1) Object.assign(playback, {along: 0, rests: false});
  playback.there = fresh = false;
  frame.onload = () => {
    inside("slider").value = playback.along;
    inside("slider").dispatchEvent(new Event("input"));
    if (!playback.rests) inside("play").click();
    playback.there = true;
  };
  frame.srcdoc = page;
}

// ---- the controls: scene, until, tolerance, and a slider a parameter
const scene = () => loaded.scenes[at("scene").selectedIndex];
const value = parameter => moved.get(parameter.name) ?? scene().parameters[parameter.name] ?? parameter.value;
const written = x => String(Number(x.toPrecision(6)));

function describe(model, found) {
  const before = loaded?.model.name === model.name ? at("scene").value : "";
  fresh = loaded?.model.name !== model.name;
  loaded = {model, ...found};
  at("scene").replaceChildren(...loaded.scenes.map(scene => new Option(scene.name)));
  if (loaded.scenes.some(scene => scene.name === before)) at("scene").value = before;
  const known = new Set(loaded.parameters.map(parameter => parameter.name));
  for (const name of moved.keys()) if (!known.has(name)) moved.delete(name);
  place();
}

// Shows the values of the scene, but for what was moved.
function place() {
  at("until").value = written(scene().until);
  at("tolerance").value = written(scene().tolerance);
  at("sliders").replaceChildren(...loaded.parameters.map(slider));
}

function slider(parameter) {
  const unmoved = scene().parameters[parameter.name] ?? parameter.value;
  const [low, high] = unmoved === 0 ? [-1, 1] : [Math.min(0, 2 * unmoved), Math.max(0, 2 * unmoved)];
  const range = Object.assign(document.createElement("input"), {type: "range", min: low, max: high, step: "any"});
  const box = Object.assign(document.createElement("input"), {type: "number", step: "any"});
  const label = document.createElement("label");
  const [text, unit] = [parameter.name, parameter.unit].map(text => Object.assign(document.createElement("span"), {textContent: text, title: text}));
  unit.className = "quiet";
  range.value = value(parameter);
  box.value = written(value(parameter));
  const move = to => {
    if (Number.isFinite(to)) moved.set(parameter.name, to);
    refresh();
  };
  range.oninput = () => { box.value = written(range.valueAsNumber); move(Number(box.value)); };
  box.oninput = () => { range.value = box.value; move(box.valueAsNumber); };
  label.append(text, range, box, unit);
  return label;
}

// What the program's commands are told.
const changes = () => [`--scene=${scene().name}`, ...[...moved].map(([name, value]) => `--set=${name}=${value}`)];
const options = () => [...changes(), ...["until", "tolerance"].flatMap(name => at(name).value.trim() ? [`--${name}=${at(name).value}`] : [])];

function take(name) {
  file = name;
  moved.clear();
  at("text").value = files[name];
  refresh();
}

let typing;
at("text").oninput = () => {
  clearTimeout(typing);
  typing = setTimeout(refresh, 300);
};
at("models").onchange = () => take(at("models").value);
at("scene").onchange = () => { place(); refresh(); };
at("until").onchange = at("tolerance").onchange = refresh;
at("reset").onclick = () => { moved.clear(); place(); refresh(); };
at("stop").onclick = halt;
at("models").replaceChildren(...Object.keys(files).map(name => new Option(name)));
take(Object.keys(files)[0]);
