"use strict";

// ---- curves: charts beside the mechanism or below it, on the same canvas, with a marker at the time that is shown
const column = ({unit, values}) => values.map(k => k === null ? NaN : k * unit);
const readChart = chart => ({...chart, series: chart.series.map(series => {
  const x = column(series.x), t = series.t ? column(series.t) : x;
  return {...series, x, y: column(series.y), t, timed: !series.t};
})});

const scaled = (axis, value) => axis.log ? Math.log10(value) : value;

// Ends of an axis, fitted to its data in the measure of its scale.
function ends(axis, values, pad) {
  if (axis.range) return axis.range.map(x => scaled(axis, x));
  let low = Infinity, high = -Infinity;
  for (const value of values) {
    const x = scaled(axis, value);
    if (Number.isFinite(x)) { low = Math.min(low, x); high = Math.max(high, x); }
  }
  if (low > high) return [0, 1];
  if (!(high - low > 1e-9 * Math.max(Math.abs(low), Math.abs(high)))) {
    const half = 0.1 * Math.abs(low) || 1;
    return [low - half, high + half];
  }
  return [low - pad * (high - low), high + pad * (high - low)];
}

// Puts a chart into a rectangle of the canvas: the frame inside, and how values become pixels.
function placeChart(chart, left, top, w, h) {
  chart.area = {left, top, width: w, height: h};
  chart.columns = Math.max(1, Math.min(chart.series.length, Math.floor((w - 74) / 150)));
  const rows = chart.series.some(series => series.name) ? Math.ceil(chart.series.length / chart.columns) : 0;
  const shown = Math.min(rows, Math.max(1, Math.floor(h / 60)));
  chart.listed = shown * chart.columns;
  const above = 12 + 16 * shown + (chart.title ? 18 : 0);
  const frame = chart.frame = {left: left + 62, top: top + above, width: Math.max(w - 76, 10), height: Math.max(h - above - 40, 10)};
  const all = key => chart.series.flatMap(series => series[key]);
  const timed = chart.series.every(series => series.timed);
  const [x, y] = [ends(chart.x, all("x"), timed ? 0 : 0.05), ends(chart.y, all("y"), 0.06)];
  if (chart.equal) {
    const unit = Math.max((x[1] - x[0]) / frame.width, (y[1] - y[0]) / frame.height);
    for (const [pair, length] of [[x, frame.width], [y, frame.height]]) {
      const middle = (pair[0] + pair[1]) / 2;
      [pair[0], pair[1]] = [middle - unit * length / 2, middle + unit * length / 2];
    }
  }
  Object.assign(chart, {ends: [x, y]});
  const part = (axis, [low, high], value) => {
    const fraction = (scaled(axis, value) - low) / (high - low);
    return axis.reversed ? 1 - fraction : fraction;
  };
  chart.across = value => frame.left + frame.width * part(chart.x, x, value);
  chart.up = value => frame.top + frame.height * (1 - part(chart.y, y, value));
}

// What stands at the marks of an axis: [value, text].
function marksOf(axis, [low, high], count) {
  if (axis.log && high - low > 1.5) {
    const step = Math.ceil((high - low) / count);
    return multiples(low, high, step).map(k => [10 ** k, `1e${k}`]);
  }
  if (axis.log) [low, high] = [10 ** low, 10 ** high];
  return multiples(low, high, roundStep((high - low) / count)).map(x => [x, short(x)]);
}

const inFrame = ({left, top, width, height}, [x, y]) => x >= left && x <= left + width && y >= top && y <= top + height;

function drawAxes(chart) {
  const {frame} = chart, [right, bottom] = [frame.left + frame.width, frame.top + frame.height];
  const quiet = colour("--quiet");
  pen.font = "11px system-ui, Helvetica, Arial, sans-serif";
  pen.textAlign = "center";
  for (const [x, text] of marksOf(chart.x, chart.ends[0], Math.max(2, frame.width / 80))) {
    const at = chart.across(x);
    stroke([[at, frame.top], [at, bottom]], colour(x === 0 ? "--zero" : "--grid"), 1);
    pen.fillStyle = quiet;
    pen.fillText(text, at, bottom + 14);
  }
  pen.textAlign = "right";
  for (const [y, text] of marksOf(chart.y, chart.ends[1], Math.max(2, frame.height / 40))) {
    const at = chart.up(y);
    stroke([[frame.left, at], [right, at]], colour(y === 0 ? "--zero" : "--grid"), 1);
    pen.fillStyle = quiet;
    pen.fillText(text, frame.left - 6, at + 4);
  }
  pen.textAlign = "center";
  pen.fillStyle = colour("--ink");
  pen.font = "12px system-ui, Helvetica, Arial, sans-serif";
  pen.fillText(chart.x.text, frame.left + frame.width / 2, bottom + 32, frame.width);
  pen.save();
  pen.translate(chart.area.left + 14, frame.top + frame.height / 2);
  pen.rotate(-Math.PI / 2);
  const long = pen.measureText(chart.y.text).width > frame.height && chart.y.unit;
  pen.fillText(long ? `(${chart.y.unit})` : chart.y.text, 0, 0, frame.height);
  pen.restore();
  if (chart.title) pen.fillText(chart.title, frame.left + frame.width / 2, chart.area.top + 18, frame.width);
  pen.textAlign = "left";
}

// The last point of a series that is not after a time, and how far on the way to the next one that time is.
function placeIn(times, t) {
  let low = 0, high = times.length - 1;
  if (!(times[0] <= t)) return [0, 0];
  if (t >= times[high]) return [high, 0];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle; else high = middle;
  }
  return [low, (t - times[low]) / (times[high] - times[low])];
}

// Where a series is at a time; points that are only marked are not joined.
function valueAt(series, t) {
  const [index, part] = placeIn(series.t, t);
  if (!series.line || part === 0) return [series.x[index], series.y[index]];
  return ["x", "y"].map(key => series[key][index] + part * (series[key][index + 1] - series[key][index]));
}

function drawSeries(chart, series) {
  const paint = colour(`--c${series.colour % 6}`), [index] = placeIn(series.t, t);
  const now = valueAt(series, t), marker = [chart.across(now[0]), chart.up(now[1])];
  const points = series.x.map((x, i) => [chart.across(x), chart.up(series.y[i])]);
  if (series.line) {
    if (series.dashed) pen.setLineDash([7, 6]);
    pen.globalAlpha = 0.35;                // what is to come
    stroke(points, paint, 1.5);
    pen.globalAlpha = 1;
    stroke([...points.slice(0, index + 1), marker], paint, 2);
    pen.setLineDash([]);
  }
  if (series.marks) points.forEach((p, i) => {
    pen.globalAlpha = i <= index ? 1 : 0.35;
    disc(p, 2.5, paint);
  });
  pen.globalAlpha = 1;
  return marker;
}

// Names with the values of now, above the frame.
function drawNames(chart) {
  const w = chart.frame.width / chart.columns, first = chart.area.top + (chart.title ? 38 : 20);
  pen.font = "12px system-ui, Helvetica, Arial, sans-serif";
  chart.series.slice(0, chart.listed).filter(series => series.name).forEach((series, i) => {
    const [x, y] = [chart.frame.left + (i % chart.columns) * w, first + 16 * Math.floor(i / chart.columns)];
    const value = valueAt(series, t)[1];
    const text = Number.isFinite(value) ? ` = ${Number(value.toPrecision(4))} ${chart.y.unit}`.replace("-", "−") : "";
    disc([x + 5, y - 4], 4, colour(`--c${series.colour % 6}`));
    pen.fillStyle = colour("--ink");
    pen.fillText(series.name + text, x + 14, y, w - 20);
  });
}

function drawChart(chart) {
  const {frame} = chart;
  drawAxes(chart);
  drawNames(chart);
  pen.save();
  pen.beginPath();
  pen.rect(frame.left - 6, frame.top - 6, frame.width + 12, frame.height + 12);
  pen.clip();
  if (chart.series.length && chart.series.every(series => series.timed)) {
    const at = chart.across(t);
    stroke([[at, frame.top], [at, frame.top + frame.height]], colour("--quiet"), 1);
  }
  const markers = chart.series.map(series => drawSeries(chart, series));
  markers.forEach((at, i) => disc(at, 5, colour(`--c${chart.series[i].colour % 6}`), colour("--paper")));
  pen.restore();
  return markers;
}

// The time that a place in a chart stands for: that of the axis, or of the nearest point.
function timeAt(chart, [px, py]) {
  if (chart.series.every(series => series.timed)) {
    const [low, high] = chart.ends[0], part = (px - chart.frame.left) / chart.frame.width;
    const value = low + (chart.x.reversed ? 1 - part : part) * (high - low);
    return chart.x.log ? 10 ** value : value;
  }
  let best = [Infinity, t];
  for (const series of chart.series) series.x.forEach((x, i) => {
    const away = Math.hypot(chart.across(x) - px, chart.up(series.y[i]) - py);
    if (away < best[0]) best = [away, series.t[i]];
  });
  return best[1];
}
