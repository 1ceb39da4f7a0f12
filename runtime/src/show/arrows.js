
// ---- over the mechanism: arrows, of which each frame has both ends behind the numbers of its shapes, their scale, and names of events
const arrows = data.arrows ?? {names: []}, happened = data.events ?? [];

// An arrow in pixels; one that is cut has two tips.
function arrow([x, y], to, cut) {
  const [dx, dy] = [to[0] - x, to[1] - y], length = Math.hypot(dx, dy);
  if (!(length >= 1)) return;
  const [u, v] = [dx / length, dy / length], tip = Math.min(10, length / 2), half = 0.4 * tip, ink = colour("--ink");
  const at = (back, side) => [to[0] - back * u - side * v, to[1] - back * v + side * u];
  stroke([[x, y], at(0.9 * tip, 0)], ink, 2);
  for (const back of cut ? [0, tip] : [0]) fill([at(back, 0), at(back + tip, half), at(back + tip, -half)], ink, 1);
}

function nameOf(name, from, to) {
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]], length = Math.hypot(dx, dy);
  if (!(length >= 1)) return;
  const wide = pen.measureText(name).width, beside = dx > 0.3 * length ? 0 : dx < -0.3 * length ? wide : wide / 2;
  const x = Math.max(Math.min(to[0] + 9 * dx / length - beside, width - wide - 4), 4);      // inside of the picture
  pen.fillText(name, x, to[1] + 9 * dy / length + 4);
}

function drawOver({frame}) {
  const ends = i => [0, 1].map(end => point(frame, {first: offset, points: 2}, 2 * i + end));
  pen.fillStyle = colour("--ink");
  pen.font = "12px system-ui, Helvetica, Arial, sans-serif";
  arrows.names.forEach((name, i) => {
    const [from, to] = ends(i), cut = Math.hypot(...to.map((x, k) => x - from[k])) > 0.999 * arrows.longest;
    arrow(pixel(from), pixel(to), cut);
    pen.fillStyle = colour("--ink");
    if (arrows.names.length <= 8) nameOf(name, pixel(from), pixel(to));
  });
  if (arrows.length) {
    arrow([width - 16 - scale * arrows.length, height - 24], [width - 16, height - 24]);
    pen.fillStyle = colour("--ink");
    pen.textAlign = "right";
    pen.fillText(arrows.text, width - 16, height - 36);
  }
  const stays = 0.5 * Number(speed.value);
  const now = happened.filter(([at]) => at <= t && t < at + stays).map(([, name]) => name);
  pen.font = "15px system-ui, Helvetica, Arial, sans-serif";
  pen.fillStyle = colour("--c1");
  pen.textAlign = "center";
  pen.fillText(now.filter((name, i) => name !== now[i - 1]).join(", "), width / 2, 20);
  pen.textAlign = "left";
  document.documentElement.dataset.happened = now.join();
}

const drawAlone = drawMechanism;
drawMechanism = now => {
  drawAlone(now);
  pen.save();
  pen.beginPath();
  pen.rect(0, 0, width, height);
  pen.clip();
  drawOver(now);
  pen.restore();
};
draw();
