
// ---- data: integers in units of `unit` (lengths) and `tick` (time); null where a value is absent
const data = JSON.parse(document.getElementById("data").textContent);
const spatial = data.dimension === 3;
const times = data.time.map(k => k * data.tick);
const number = k => k === null ? NaN : k * data.unit;
const frames = data.frames.map(changes => {        // of each frame only the numbers that ever change are there
  const frame = data.first.map(number);
  data.moving.forEach((place, i) => frame[place] = number(changes[i]));
  return frame;
});
const charts = data.charts.map(readChart);
const known = times.length ? times : charts.flatMap(chart => chart.series.flatMap(series => series.t)).sort((a, b) => a - b);
const [start, end] = [known[0] ?? 0, known[known.length - 1] ?? 0];

// Each shape knows where its numbers begin and how many points it has.
let offset = 0;
const shapes = data.shapes.map(([kind, points], index) => {
  const shape = {kind, first: offset, points, colour: `--c${index % 6}`};
  offset += points * data.dimension + (["circle", "cylinder", "sphere"].includes(kind) ? 1 : 0);
  return shape;
});

function point(frame, shape, i) {
  const at = shape.first + i * data.dimension;
  return [frame[at], frame[at + 1], spatial ? frame[at + 2] : 0];
}
const radius = (frame, shape) => Math.abs(frame[shape.first + shape.points * data.dimension]);
const pointsOf = (frame, shape) => Array.from({length: shape.points}, (_, i) => point(frame, shape, i));

// The drawing at a time, linear between frames; of two frames at one time the later counts.
function drawing(t) {
  let low = 0, high = times.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle; else high = middle;
  }
  if (high <= 0) return {index: 0, frame: frames[0] ?? []};
  if (t >= times[high]) return {index: high, frame: frames[high]};
  const part = (t - times[low]) / (times[high] - times[low]);
  return {index: low, frame: frames[low].map((x, i) => x + part * (frames[high][i] - x))};
}

// ---- bounds of everything that is ever drawn
const {low, high, reach} = data;
for (const shape of shapes.filter(shape => shape.kind === "spring")) {
  const length = frame => Math.hypot(...point(frame, shape, 0).map((x, k) => x - point(frame, shape, 1)[k]));
  shape.longest = frames.reduce((most, frame) => Math.max(most, length(frame) || 0), 0);
}
const centre = low.map((x, k) => (x + high[k]) / 2);
const size = spatial ? [2 * reach, 2 * reach] : [high[0] - low[0], high[1] - low[1]];
const floor = low[2] >= 0 && low[2] < 0.3 * reach ? 0 : low[2];

// ---- the view: pixels from space
const canvas = document.getElementById("view"), pen = canvas.getContext("2d");
let azimuth = -1.1, elevation = 0.35, zoom = 1, shift = [0, 0];
let width = 1, height = 1, scale = 1;

function resize() {
  const ratio = window.devicePixelRatio || 1;
  const whole = [canvas.clientWidth || 1, canvas.clientHeight || 1];
  [canvas.width, canvas.height] = whole.map(length => length * ratio);
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  [width, height] = whole;
  if (charts.length) placeCharts(whole);
  const [w, h] = [Math.max(width - 80, 20), Math.max(height - 60, 20)];
  scale = zoom * Math.min(w / (size[0] || 1e-9 * reach), h / (size[1] || 1e-9 * reach));
}

// Charts stand right of the mechanism, or below it in a narrow window; where nothing is drawn they have it all.
function placeCharts([w, h]) {
  const beside = w >= 700 && w >= h;
  if (!shapes.length) [width, height] = beside ? [0, h] : [w, 0];
  else if (beside) width = Math.round(0.52 * w);
  else height = Math.round((charts.length > 1 ? 0.42 : 0.5) * h);
  const area = beside ? [width, 0, w - width, h] : [0, height, w, h - height];
  const each = area[3] / charts.length;
  charts.forEach((chart, i) => placeChart(chart, area[0], area[1] + i * each, area[2], each));
}

function pixel(p) {
  let [x, y, z] = p.map((x, k) => x - centre[k]);
  if (spatial) {
    const [s, c] = [Math.sin(azimuth), Math.cos(azimuth)];
    [x, y] = [c * y - s * x, z * Math.cos(elevation) - (c * x + s * y) * Math.sin(elevation)];
  }
  return [width / 2 + shift[0] + scale * x, height / 2 + shift[1] - scale * y];
}
const shadow = p => pixel([p[0], p[1], floor]);
const towards = () => [Math.cos(azimuth) * Math.cos(elevation), Math.sin(azimuth) * Math.cos(elevation), Math.sin(elevation)];

// ---- drawing
const colour = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

function stroke(pixels, style, thickness) {
  pen.strokeStyle = style;
  pen.lineWidth = thickness;
  pen.lineJoin = pen.lineCap = "round";
  pen.beginPath();
  let drawn = false;                       // false after a gap
  for (const [x, y] of pixels) {
    const there = Number.isFinite(x) && Number.isFinite(y);
    if (there) drawn ? pen.lineTo(x, y) : pen.moveTo(x, y);
    drawn = there;
  }
  pen.stroke();
}

function disc([x, y], r, fill, edge) {
  if (!Number.isFinite(x) || !Number.isFinite(y) || !Number.isFinite(r)) return;
  pen.beginPath();
  pen.arc(x, y, r, 0, 2 * Math.PI);
  if (fill) { pen.fillStyle = fill; pen.fill(); }
  if (edge) { pen.strokeStyle = edge; pen.lineWidth = 2; pen.stroke(); }
}

function fill(pixels, style, alpha) {
  if (!pixels.flat().every(Number.isFinite)) return;
  pen.globalAlpha = alpha;
  pen.fillStyle = style;
  pen.beginPath();
  for (const [x, y] of pixels) pen.lineTo(x, y);
  pen.fill();
  pen.globalAlpha = 1;
}

// A spring keeps its width, which follows from its greatest length.
function zigzag([ax, ay], [bx, by], longest) {
  const [dx, dy] = [bx - ax, by - ay], length = Math.hypot(dx, dy) || 1;
  const half = Math.min(Math.max(0.06 * scale * longest, 1.5), 8);
  const [nx, ny] = [-half * dy / length, half * dx / length];
  const pixels = [[ax, ay]];
  for (let i = 0; i <= 16; i++) {
    const along = 0.12 + 0.76 * i / 16, side = i === 0 || i === 16 ? 0 : i % 2 ? 1 : -1;
    pixels.push([ax + along * dx + side * nx, ay + along * dy + side * ny]);
  }
  return [...pixels, [bx, by]];
}

// The path of a trace up to now; a motion that repeats shows all of it.
function path({index, frame}, shape, project) {
  const past = data.repeat ? frames : frames.slice(0, index + 1);
  const pixels = past.map(f => project(point(f, shape, 0)));
  return data.repeat ? pixels : [...pixels, project(point(frame, shape, 0))];
}

function drawShape(now, shape, project, flat) {
  const paint = flat ?? colour(shape.colour);
  const points = pointsOf(now.frame, shape).map(project);
  switch (shape.kind) {
    case "line":
      stroke(points, paint, flat ? 3 : 5);
      if (!flat) points.forEach(p => joint(p, paint));
      break;
    case "circle": {
      const r = Math.max(3, scale * radius(now.frame, shape));
      pen.globalAlpha = flat ? 0.5 : 0.25;
      disc(points[0], r, paint);
      pen.globalAlpha = 1;
      if (!flat) disc(points[0], r, null, paint);
      break;
    }
    case "spring": stroke(flat ? points : zigzag(...points, shape.longest), paint, 2); break;
    case "curve": stroke(points, flat ?? colour("--quiet"), 2); break;
    case "trace":
      if (flat) break;
      pen.globalAlpha = 0.7;
      stroke(path(now, shape, project), paint, 1.5);
      pen.globalAlpha = 1;
      disc(points[0], 3, paint);
      break;
    default: if (flat) shade(now, shape, flat); else drawSolid(now, shape, paint);
  }
}
const joint = (p, paint) => disc(p, 4, colour("--paper"), paint);

function roundStep(raw) {
  const decade = 10 ** Math.floor(Math.log10(raw));
  return [1, 2, 5, 10].map(d => d * decade).find(step => step >= 0.999 * raw) ?? raw;
}
const multiples = (from, to, step) =>
  Array.from({length: Math.max(0, Math.floor(to / step) - Math.ceil(from / step) + 1)}, (_, i) => (Math.ceil(from / step) + i) * step);
const short = x => String(Number(x.toPrecision(6))).replaceAll("-", "−");

function plane() {
  const step = roundStep(70 / scale);
  const [w, h] = [width / 2 / scale, height / 2 / scale];
  pen.fillStyle = colour("--quiet");
  pen.font = "11px system-ui, Helvetica, Arial, sans-serif";
  for (const x of multiples(centre[0] - w, centre[0] + w, step)) {
    const [at] = pixel([x, 0, 0]);
    stroke([[at, 0], [at, height]], colour(x === 0 ? "--zero" : "--grid"), 1);
    pen.fillText(short(x) + data.units[0], at + 3, height - 4);
  }
  for (const y of multiples(centre[1] - h, centre[1] + h, step)) {
    const at = pixel([0, y, 0])[1];
    stroke([[0, at], [width, at]], colour(y === 0 ? "--zero" : "--grid"), 1);
    if (at < height - 20) pen.fillText(short(y) + data.units[0], 4, at - 3);
  }
}

function ground() {
  const step = roundStep(reach / 5);
  const ends = k => [Math.floor(low[k] / step) * step, Math.ceil(high[k] / step) * step];
  const [[x0, x1], [y0, y1]] = [ends(0), ends(1)];
  for (const x of multiples(x0, x1 + step / 2, step)) stroke([[x, y0, floor], [x, y1, floor]].map(pixel), colour("--grid"), 1);
  for (const y of multiples(y0, y1 + step / 2, step)) stroke([[x0, y, floor], [x1, y, floor]].map(pixel), colour("--grid"), 1);
  pen.fillStyle = colour("--quiet");
  pen.font = "13px system-ui, Helvetica, Arial, sans-serif";
  pen.fillText(`grid ${short(step)}${data.units[0]}`, 16, height - 10);
  const [x, y] = pixel(centre);
  ["x", "y", "z"].forEach((name, k) => {   // which way the axes point, in a corner of the picture
    const tip = pixel(plus(centre, 1 / scale, data.axes[k]));
    const away = length => [60 + length * (tip[0] - x), height - 70 + length * (tip[1] - y)];
    stroke([away(0), away(32)], colour("--quiet"), 2);
    pen.fillText(name, away(44)[0] - 4, away(44)[1] + 4);
  });
}

// ---- time
const slider = document.getElementById("slider"), button = document.getElementById("play");
const clock = document.getElementById("clock"), speed = document.getElementById("speed");
let t = start, playing = false, before = 0, frameRequest, timer;

function drawMechanism(now) {
  pen.save();
  pen.beginPath();
  pen.rect(0, 0, width, height);
  pen.clip();
  spatial ? ground() : plane();
  if (spatial) drawSpace(now);
  else {
    const order = kind => ["curve", "trace", "spring", "line", "circle"].indexOf(kind);
    [...shapes].sort((a, b) => order(a.kind) - order(b.kind)).forEach(shape => drawShape(now, shape, pixel));
  }
  pen.restore();
}

function draw() {
  const now = drawing(t);
  pen.clearRect(0, 0, canvas.width, canvas.height);
  if (shapes.length || !charts.length) drawMechanism(now);
  const markers = charts.map(drawChart);
  slider.value = end > start ? (t - start) / (end - start) : 0;
  const digits = Math.max(0, Math.min(12, 3 - Math.floor(Math.log10((end - start) || 1))));
  clock.value = `t = ${t.toFixed(digits)}${data.units[1]}`;
  button.textContent = playing ? "Pause" : "Play";
  // What a test, or another script, can read: the time, where the last point of the first shape is, and the first marker.
  const first = shapes[0];
  const seen = first ? pixel(point(now.frame, first, first.points - 1)) : [];
  const written = pixels => (pixels ?? []).map(x => x.toFixed(2)).join();
  Object.assign(document.documentElement.dataset, {t: t.toFixed(digits), playing, point: written(seen), marker: written(markers[0]?.[0])});
}

// Wherever frames are shown they set the pace; where none are (a headless browser), a timer does.
function next() {
  cancelAnimationFrame(frameRequest);
  clearTimeout(timer);
  if (!playing) return;
  frameRequest = requestAnimationFrame(tick);
  timer = setTimeout(tick, 100);
}

function tick() {
  const now = performance.now();
  t += Math.min(now - before, 250) / 1000 * Number(speed.value);
  before = now;
  if (t >= end) {
    if (data.repeat && end > start) t = start + (t - start) % (end - start);
    else { t = end; playing = false; }
  }
  draw();
  next();
}

function play(wanted) {
  if (wanted && !playing) {
    if (t >= end) t = start;
    before = performance.now();
  }
  playing = wanted;
  draw();
  next();
}

function seek(to) {
  t = Math.min(Math.max(to, start), end);
  draw();
}

// A run of a second to a minute is shown as it is, others in about ten seconds.
const natural = end - start >= 1 && end - start <= 60 || end <= start ? 1 : roundStep((end - start) / 10);
for (const factor of [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100]) {
  const value = String(Number((factor * natural).toPrecision(6)));
  speed.add(new Option(`${value}×`, value, factor === 1, factor === 1));
}

// ---- controls
button.onclick = () => { play(!playing); button.blur(); };
slider.oninput = () => seek(start + slider.value * (end - start));
document.onkeydown = event => {
  const step = (end - start) / 100;
  const turned = spatial && {ArrowLeft: () => turn(0.1, 0), ArrowRight: () => turn(-0.1, 0), ArrowUp: () => turn(0, -0.1), ArrowDown: () => turn(0, 0.1)};
  const timed = {ArrowLeft: () => seek(t - step), ArrowRight: () => seek(t + step), " ": () => play(!playing), Home: () => seek(start), End: () => seek(end)};
  const zoomed = spatial && {"+": () => magnify(1.25), "-": () => magnify(0.8), 0: restore};
  const action = ((event.shiftKey && turned) || timed)[event.key] ?? zoomed?.[event.key];
  if (!action || event.target === speed || event.ctrlKey || event.metaKey || event.altKey) return;
  event.preventDefault();
  action();
};
// The view of a motion in space: dragging and Shift with an arrow turn it, the wheel, + and - make it larger and smaller, 0 restores it.
function turn(right, down) {
  azimuth += right;
  elevation = Math.min(Math.max(elevation + down, -Math.PI / 2), Math.PI / 2);
  draw();
}
// What is at a place of the picture stays there.
function magnify(factor, [x, y] = [width / 2 + shift[0], height / 2 + shift[1]]) {
  const before = scale;
  zoom = Math.min(Math.max(factor * zoom, 0.1), 100);
  resize();
  const about = [x - width / 2, y - height / 2];
  shift = shift.map((s, k) => about[k] + (s - about[k]) * scale / before);
  draw();
}
function restore() {
  [azimuth, elevation, zoom, shift] = [-1.1, 0.35, 1, [0, 0]];
  resize();
  draw();
}
canvas.onwheel = event => {
  if (!spatial || under(event)) return;
  event.preventDefault();
  const pixels = event.deltaY * (event.deltaMode ? 30 : 1);                // a wheel may count lines, of about 30 px
  magnify(Math.exp(-0.001 * pixels), [event.offsetX, event.offsetY]);
};
if (spatial) canvas.title = "drag, or Shift and an arrow: turn; wheel, + or -: zoom; 0: as before";
let held = null;                           // the chart in which a drag began
const under = event => charts.find(chart => inFrame(chart.area, [event.offsetX, event.offsetY]));
canvas.onpointerdown = event => {
  held = under(event) ?? null;
  if (!spatial && !held) return;
  canvas.setPointerCapture(event.pointerId);
  if (held) seek(timeAt(held, [event.offsetX, event.offsetY]));
};
canvas.onpointerup = canvas.onpointercancel = () => held = null;
canvas.onpointermove = event => {
  if (held) { seek(timeAt(held, [event.offsetX, event.offsetY])); return; }
  canvas.style.cursor = under(event) ? "crosshair" : spatial ? "grab" : "";
  if (!spatial || !event.buttons) return;
  turn(-0.008 * event.movementX, 0.008 * event.movementY);
};

// page.html#t=1.5&play&speed=2&azimuth=0.3&zoom=2
function followAddress() {
  const wanted = new URLSearchParams(location.hash.slice(1));
  const value = name => wanted.has(name) && Number.isFinite(Number(wanted.get(name))) ? Number(wanted.get(name)) : null;
  azimuth = value("azimuth") ?? azimuth;
  elevation = value("elevation") ?? elevation;
  if (value("zoom") > 0) { zoom = value("zoom"); resize(); }
  const rate = value("speed");
  if (rate !== null && rate > 0) speed.add(new Option(`${short(rate)}×`, rate, true, true));
  seek(value("t") ?? t);
  if (wanted.has("play")) play(true);
}

document.title = document.getElementById("title").textContent = data.title;
document.querySelector("header").title = document.getElementById("about").textContent = shapes.length || charts.length ? data.about : "Nothing is drawn: the model has no `draw`.";
window.onresize = () => { resize(); draw(); };
window.onhashchange = followAddress;
matchMedia("(prefers-color-scheme: dark)").onchange = draw;
resize();
followAddress();
