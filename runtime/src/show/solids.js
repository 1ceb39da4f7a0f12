
// ---- shapes in space: what is seen of them from far away, as lines and faces, and what is in front of what
const corners = 96;                        // of what stands for a circle: round to 0.3 px at a radius of 500 px
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const plus = (a, s, b) => a.map((x, k) => x + s * b[k]);
const scaledBy = (s, a) => a.map(x => s * x);
const norm = a => Math.hypot(...a);

// Two unit vectors that make a right-handed system with a direction, from the ground's axis that is farthest from it.
function across(direction) {
  const axis = scaledBy(1 / norm(direction), direction);
  const farthest = [0, 1, 2].reduce((best, k) => Math.abs(axis[k]) < Math.abs(axis[best]) ? k : best);
  const first = plus([0, 1, 2].map(k => k === farthest ? 1 : 0), -axis[farthest], axis);
  const unit = scaledBy(1 / norm(first), first);
  return [unit, cross(axis, unit)];
}

// Points of c + u cos + v sin from an angle on, so many steps of a whole turn; a whole turn ends where it begins.
const arc = (c, [u, v], from, steps) => Array.from({length: steps + 1}, (_, i) => {
  const angle = from + 2 * Math.PI * (i % corners) / corners;
  return plus(plus(c, Math.cos(angle), u), Math.sin(angle), v);
});
const rim = (c, axis) => arc(c, across(axis).map(v => scaledBy(norm(axis), v)), 0, corners);
const quad = (c, a, b) => [[1, 1], [-1, 1], [-1, -1], [1, -1], [1, 1]].map(([s, t]) => plus(plus(c, s, a), t, b));

// The side between the near halves of both rims, and the end that is seen.
function cylinder(from, to, radius, towards) {
  const [far, near] = dot(plus(to, -1, from), towards) > 0 ? [from, to] : [to, from];
  const axis = plus(near, -1, far), [u, v] = across(axis).map(x => scaledBy(radius, x));
  const begin = Math.atan2(dot(towards, v), dot(towards, u)) - Math.PI / 2;
  const side = [...arc(far, [u, v], begin, corners / 2), ...arc(near, [u, v], begin, corners / 2).reverse()];
  return [[...side, side[0]], rim(near, scaledBy(radius / norm(axis), axis))];
}

function boxFaces(c, half, towards) {
  const handed = dot(cross(half[0], half[1]), half[2]) < 0 ? -1 : 1;
  return [0, 1, 2].flatMap(k => {
    const [a, b] = [half[(k + 1) % 3], half[(k + 2) % 3]], facing = handed * dot(cross(a, b), towards);
    return facing ? [quad(plus(c, Math.sign(facing), half[k]), a, b)] : [];
  });
}

// The edge as it is seen, and the near halves of the principal sections.
function ellipsoid(c, half, towards) {
  const w = half.map(a => dot(a, towards) / dot(a, a));
  const image = u => half.reduce((sum, a, k) => plus(sum, u[k], a), [0, 0, 0]);
  const section = (i, j) => arc(c, [half[i], half[j]], Math.atan2(w[j], w[i]) - Math.PI / 2, corners / 2);
  return [arc(c, across(w).map(image), 0, corners), section(1, 2), section(2, 0), section(0, 1)];
}

// Lines and faces [points, whether it is filled] of a shape with these points and this radius.
function outlines(kind, p, r, towards) {
  const face = points => [points, true], line = points => [points, false];
  const found = {
    ring: () => [line(rim(p[0], p[1]))],
    disc: () => [face(rim(p[0], p[1]))],
    cylinder: () => cylinder(p[0], p[1], r, towards).map(face),
    sphere: () => [face(rim(p[0], scaledBy(r / norm(towards), towards)))],
    box: () => boxFaces(p[0], p.slice(1), towards).map(face),
    ellipsoid: () => ellipsoid(p[0], p.slice(1), towards).map((points, k) => [points, k === 0]),
    plane: () => [face(quad(p[0], ...across(p[1]).map(v => scaledBy(norm(p[1]) / 2, v))))],
    axes: () => p.slice(1).map(v => line([p[0], plus(p[0], 1, v)])),
  }[kind]?.() ?? [];
  return found.filter(([points]) => points.flat().every(Number.isFinite));
}

// At one depth: what lies below what.  From `disc` on shapes are filled: they hide what is behind them.
const layers = ["plane", "curve", "trace", "spring", "line", "circle", "ring", "axes", "disc", "cylinder", "sphere", "box", "ellipsoid"];
const filled = kind => layers.indexOf(kind) >= layers.indexOf("disc");

// The parts {shape, line, joint, tip} of shapes [{kind, points, radius}] from the farthest to the nearest.  A filled shape is as far away
// as its middle; lines are cut where they pass one; planes, curves and traces are behind everything.
function ordered(all, towards, near) {
  const middle = ({kind, points: p}) => kind === "cylinder" ? scaledBy(0.5, plus(p[0], 1, p[1])) : p[0];
  const depths = all.filter(({kind}) => filled(kind)).map(shape => dot(middle(shape), towards)).filter(Number.isFinite).sort((a, b) => a - b);
  const behind = depth => depths.filter(other => other < depth - near).length;
  const depth = points => points.reduce((sum, p) => sum + dot(p, towards), 0) / points.length;
  const parts = [];
  all.forEach((shape, place) => {
    const add = (depth, part) => parts.push({...part, shape, key: [behind(depth), filled(shape.kind), layers.indexOf(shape.kind), place]});
    const pieces = (points, which) => {
      let piece = [];
      const finish = () => {
        if (piece.length > 1) add(depth(piece), {line: piece, which});
        piece = [];
      };
      for (const p of points) {
        if (!p.every(Number.isFinite)) { finish(); continue; }
        for (const cut of piece.length ? cuts(piece[piece.length - 1], p) : []) {
          piece.push(cut);
          finish();
          piece.push(cut);
        }
        piece.push(p);
      }
      finish();
    };
    const cuts = (from, to) => {
      const [start, end] = [dot(from, towards), dot(to, towards)];
      const passed = depths.filter(d => d > Math.min(start, end) + near && d < Math.max(start, end) - near);
      const found = passed.map(d => plus(from, (d - start) / (end - start), plus(to, -1, from)));
      return end < start ? found.reverse() : found;
    };
    switch (shape.kind) {
      case "line":
        pieces(shape.points, 0);
        for (const joint of shape.points) add(dot(joint, towards), {joint});
        break;
      case "ring": case "axes":
        outlines(shape.kind, shape.points, 0, towards).forEach(([points], which) => {
          pieces(points, which);
          if (shape.kind === "axes") add(dot(points[1], towards), {tip: points, which});
        });
        break;
      case "plane": case "curve": case "trace": add(-Infinity, {}); break;
      case "spring": case "circle": add(depth(shape.points), {}); break;
      default: add(dot(middle(shape), towards) + near, {});
    }
  });
  const before = (a, b) => a.key.reduce((found, x, k) => found || x - b.key[k], 0);
  return parts.sort(before);
}

// A disc and a plane are seen through, solids are not.
function drawSolid(now, shape, paint) {
  const pane = shape.kind === "plane", own = pane ? colour("--quiet") : paint;
  for (const [points, face] of outlines(shape.kind, pointsOf(now.frame, shape), radius(now.frame, shape), towards())) {
    const pixels = points.map(pixel);
    if (face && !pane && shape.kind !== "disc") fill(pixels, colour("--paper"), 1);
    if (face) fill(pixels, own, pane ? 0.12 : 0.25);
    stroke(pixels, own, pane ? 1 : 2);
  }
}

// The shadow is what is seen from above.
function shade(now, shape, paint) {
  if (shape.kind === "plane" || shape.kind === "axes") return;
  for (const [points, face] of outlines(shape.kind, pointsOf(now.frame, shape), radius(now.frame, shape), [0, 0, 1])) {
    if (face) fill(points.map(shadow), paint, 0.5); else stroke(points.map(shadow), paint, 2);
  }
}

// All shapes of a motion in space, from the farthest to the nearest.
function drawSpace(now) {
  shapes.forEach(shape => drawShape(now, shape, shadow, colour("--shadow")));
  const all = shapes.map(shape => ({...shape, whole: shape, points: pointsOf(now.frame, shape)}));
  for (const {shape, line, joint: at, tip, which} of ordered(all, towards(), 1e-6 * reach)) {
    const paint = colour(shape.kind === "axes" ? ["--c1", "--c2", "--c0"][which] : shape.colour);
    if (line) stroke(line.map(pixel), paint, shape.kind === "line" ? 5 : 2);
    else if (at) joint(pixel(at), paint);
    else if (tip) letter(tip.map(pixel), "xyz"[which], paint);
    else drawShape(now, shape.whole, pixel);
  }
}

function letter([[ax, ay], [x, y]], text, paint) {
  const beyond = 9 / Math.max(1, Math.hypot(x - ax, y - ay));
  pen.fillStyle = paint;
  pen.font = "12px system-ui, Helvetica, Arial, sans-serif";
  pen.fillText(text, x + beyond * (x - ax) - 3, y + beyond * (y - ay) + 4);
}
