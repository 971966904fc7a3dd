const dark = matchMedia("(prefers-color-scheme:dark)");
const colours = {};
function readColours() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ["ink", "faint", "paper", "floor", "line", "wall", "off", "robot", "robot-ink", "cleaned", "assumed", "todo", "person", "other", "holder", "slow"]) colours[name] = style.getPropertyValue("--" + name).trim();
}
dark.addEventListener("change", () => { readColours(); repaint(); draw(); });

let pictures = 0;
function repaint() {
  pictures++;
  const rgb = name => { const hex = colours[name].length === 4 ? colours[name].replace(/[\da-f]/g, "$&$&") : colours[name]; return [1, 3, 5].map(i => parseInt(hex.slice(i, i + 2), 16)); };
  if (floor) {
    const table = {c: [...rgb("cleaned"), 110], a: [...rgb("assumed"), 80], d: [...rgb("todo"), 120], u: [...rgb("todo"), 120], ".": plan && plan.width ? undefined : [...rgb("off"), 255]};
    const dirt = letter => letter > "0" && letter <= "9" ? [121, 63, 20, 30 + 14 * +letter] : undefined;
    floor.pictures = {claimed: paint(floor, floor.claimed, letter => table[letter]), dirt: paint(floor, floor.dirt, dirt)};
  }
  if (plan && plan.width) {
    const table = {f: [...rgb("paper"), 255], w: [...rgb("wall"), 255]};
    plan.picture = paint(plan, plan.pixels, letter => table[letter]);
  }
}

// "3:.2:d": each letter behind the times that it comes; rows from the bottom.
function paint(grid, text, colour) {
  const canvas = document.createElement("canvas");
  canvas.width = grid.width; canvas.height = grid.height;
  const g = canvas.getContext("2d"), image = g.createImageData(grid.width, grid.height);
  let cell = 0;
  for (const [, count, letter] of text.matchAll(/(\d+):(.)/g)) {
    const rgba = colour(letter);
    for (let i = 0; i < +count; i++, cell++) {
      if (rgba) image.data.set(rgba, 4 * ((grid.height - 1 - Math.floor(cell / grid.width)) * grid.width + cell % grid.width));
    }
  }
  g.putImageData(image, 0, 0);
  return canvas;
}

// What the scanner has seen at the same place several times, away from people, stands there: walls and furniture, where there is no map.
const WALL_M = 0.1, SEEN_TIMES = 4, seenAt = new Map();
let walls = new Path2D(), wallsAt = 0;
function noteWalls(next) {
  if ((plan && plan.width) || (next.time_s < wallsAt + 0.5 && next.time_s >= wallsAt)) return;
  wallsAt = next.time_s;
  const [px, py, heading] = next.pose, c = Math.cos(heading), s = Math.sin(heading);
  const once = new Set();
  for (const [x, y] of next.scan) {
    const wx = px + c * x - s * y, wy = py + s * x + c * y;
    if (next.people.some(p => Math.hypot(p.at_m[0] - wx, p.at_m[1] - wy) < 0.7)) continue;
    once.add(Math.floor(wx / WALL_M) + ":" + Math.floor(wy / WALL_M));
  }
  for (const key of once) {
    const times = (seenAt.get(key) || 0) + 1;
    if (times <= SEEN_TIMES && seenAt.size < 60000) seenAt.set(key, times);
    if (times === SEEN_TIMES) { const [i, j] = key.split(":"); walls.rect(i * WALL_M, j * WALL_M, WALL_M, WALL_M); bounds(+i * WALL_M, +j * WALL_M); }
  }
}

// The corners of all that is known, for the whole floor at a glance.
const edge = {left: -3, right: 3, low: -3, high: 3};
function bounds(x, y) { edge.left = Math.min(edge.left, x); edge.right = Math.max(edge.right, x); edge.low = Math.min(edge.low, y); edge.high = Math.max(edge.high, y); }

// The map of the mission lies where the odometry believes it: turned and shifted.
function mapFrame() {
  const [ox, oy, turn] = frame.mission ? frame.mission.odometry_in_map : [0, 0, 0], c = Math.cos(turn), s = Math.sin(turn);
  return {turn, inOdometry: ([x, y]) => [c * (x - ox) + s * (y - oy), -s * (x - ox) + c * (y - oy)], inMap: ([x, y]) => [ox + c * x - s * y, oy + s * x + c * y]};
}

function drawGrid(g, at, grid, pictures) {
  const {turn, inOdometry} = mapFrame();
  const [x, y] = at(inOdometry([grid.corner[0], grid.corner[1] + grid.height * grid.resolution_m]));
  g.save();
  g.translate(x, y); g.rotate(turn); g.scale(sight.scale * grid.resolution_m, sight.scale * grid.resolution_m);
  g.imageSmoothingEnabled = false;
  for (const picture of pictures) g.drawImage(picture, 0, 0);
  g.restore();
}

function drawFloor(g, at) {
  if (!frame.mission) return;
  if (plan && plan.picture) drawGrid(g, at, plan, [plan.picture]);
  if (!floor || !floor.pictures) return;
  drawGrid(g, at, floor, ["claimed", "dirt"].filter(layer => shown[layer]).map(layer => floor.pictures[layer]));
  const {inOdometry} = mapFrame();
  g.setLineDash([2, 5]); g.strokeStyle = colours.faint; g.lineWidth = 1; g.beginPath();
  floor.tour.forEach((p, i) => { const [x, y] = at(inOdometry(p)); i ? g.lineTo(x, y) : g.moveTo(x, y); });
  g.stroke(); g.setLineDash([]);
}

// Grid and floor change seldom: they are kept as a picture of the window until the sight, the floor or the belief in its place changes.
const ground = {key: "", picture: document.createElement("canvas")};
function drawGround(g, [w, h, ratio]) {
  const place = frame.mission ? frame.mission.odometry_in_map.map((value, i) => value.toFixed(i < 2 ? 2 : 3)) : [];
  const key = [w, h, ratio, sight.scale, sight.x.toFixed(3), sight.y.toFixed(3), ...place, floor && floor.number, !!(floor && floor.pictures), !!(plan && plan.picture), shown.claimed, shown.dirt, dark.matches, pictures].join();
  if (ground.key !== key) {
    ground.key = key;
    ground.picture.width = Math.round(w * ratio); ground.picture.height = Math.round(h * ratio);
    const over = ground.picture.getContext("2d");
    over.setTransform(ratio, 0, 0, ratio, 0, 0);
    over.fillStyle = colours.floor; over.fillRect(0, 0, w, h);
    drawLines(over, w, h);
    drawFloor(over, onScreen);
  }
  g.drawImage(ground.picture, 0, 0, w, h);
}

function drawLines(g, w, h) {
  const scale = sight.scale, step = scale < 4 ? 20 : scale < 12 ? 5 : 1;
  const [left, right, low, high] = [sight.x - w / 2 / scale, sight.x + w / 2 / scale, sight.y - h / 2 / scale, sight.y + h / 2 / scale];
  g.strokeStyle = colours.line; g.lineWidth = 1;
  g.beginPath();
  for (let x = Math.floor(left / step) * step; x < right; x += step) { const [a] = onScreen([x, 0]); g.moveTo(a, 0); g.lineTo(a, h); }
  for (let y = Math.floor(low / step) * step; y < high; y += step) { const [, b] = onScreen([0, y]); g.moveTo(0, b); g.lineTo(w, b); }
  g.stroke();
}

function draw() {
  readExtent();
  const canvas = $("map"), ratio = devicePixelRatio || 1, {w, h} = extent;
  if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) { canvas.width = Math.round(w * ratio); canvas.height = Math.round(h * ratio); }
  const g = canvas.getContext("2d");
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  if (!frame) { g.fillStyle = colours.floor; g.fillRect(0, 0, w, h); return; }
  const [px, py, heading] = frame.pose, c = Math.cos(heading), s = Math.sin(heading);
  if (sight.follows) { sight.x = px; sight.y = py; }
  const scale = sight.scale, at = onScreen;
  const onRobot = ([x, y]) => at([px + c * x - s * y, py + s * x + c * y]);
  const trace = (points, map, close) => {
    g.beginPath();
    points.forEach((p, i) => { const [x, y] = map(p); i ? g.lineTo(x, y) : g.moveTo(x, y); });
    if (close) g.closePath();
  };
  g.lineJoin = g.lineCap = "round";
  drawGround(g, [w, h, ratio]);
  if (!(plan && plan.width)) { g.save(); g.translate(...at([0, 0])); g.scale(scale, -scale); g.fillStyle = colours.wall; g.fill(walls); g.restore(); }
  drawAreas(g, at);
  if (shown.held) drawHeld(g, at);
  // Where the brush has been; without a mission that is all there is to say about the floor.
  if (shown.track) { g.save(); g.globalAlpha = frame.mission ? 0.18 : 0.4; g.strokeStyle = colours.cleaned; g.lineWidth = 0.55 * scale; trace(path, at); g.stroke(); g.restore(); }
  g.strokeStyle = colours.robot; g.lineWidth = 1.5; trace(path, at); g.stroke();
  // A mission has a tour of its own.
  if (!frame.mission) { g.setLineDash([6, 6]); g.strokeStyle = colours.faint; trace(frame.route, at, !frame.drive); g.stroke(); g.setLineDash([]); }
  g.fillStyle = "#f4d58d99"; trace(frame.warning, onRobot, true); g.fill();
  g.fillStyle = "#f1a9a099"; trace(frame.protective, onRobot, true); g.fill();
  g.fillStyle = "#7a8793";
  dots(g, frame.lidar.map(onRobot), 1);
  g.fillStyle = colours.ink;
  dots(g, frame.scan.map(onRobot), 1.5);
  drawPeople(g, at);
  g.fillStyle = colours.robot; trace(frame.footprint, onRobot, true); g.fill();
  g.strokeStyle = colours["robot-ink"]; g.lineWidth = 2; trace([[0, 0], [0.4, 0]], onRobot); g.stroke();
  if (frame.holder) drawHolder(g, onRobot, w);
  drawScale(g);
  drawPen(g, at);
}

// All at once: a hundred people cost no more than a few.
function drawPeople(g, at) {
  const scale = sight.scale, line = points => points.forEach((p, i) => { const [x, y] = at(p); i ? g.lineTo(x, y) : g.moveTo(x, y); });
  g.strokeStyle = colours.person + "80"; g.lineWidth = 3; g.lineJoin = "bevel"; g.beginPath();
  for (const trail of trails.values()) line(trail);
  g.stroke(); g.lineJoin = "round";
  for (const isPerson of [false, true]) {
    const those = frame.people.filter(p => p.person === isPerson), radius = Math.max((isPerson ? 0.28 : 0.15) * scale, 3);
    g.fillStyle = g.strokeStyle = isPerson ? colours.person : colours.other; g.lineWidth = 2;
    g.beginPath();
    for (const p of those) { const [x, y] = at(p.at_m); g.moveTo(x + radius, y); g.arc(x, y, radius, 0, 7); }
    g.fill();
    if (!isPerson) continue;
    g.beginPath();
    const ahead = (p, s) => [p.at_m[0] + s * p.velocity_mps[0], p.at_m[1] + s * p.velocity_mps[1]];
    const walk = those.filter(p => Math.hypot(...p.velocity_mps) > 0.1);
    for (const p of walk) line([p.at_m, ahead(p, 3)]);
    g.globalAlpha = 0.45; g.stroke(); g.globalAlpha = 1;
    dots(g, [1, 2, 3].flatMap(s => walk.map(p => at(ahead(p, s)))), 2.5);
    g.fillStyle = colours.paper; g.font = "12px system-ui"; g.textAlign = "center";
    if (radius > 5) for (const p of those) { const [x, y] = at(p.at_m); g.fillText(p.id, x, y + 4); }
  }
}

function dots(g, points, half) {
  g.beginPath();
  for (const [x, y] of points) g.rect(x - half, y - half, 2 * half, 2 * half);
  g.fill();
}

// The ring around what holds the robot, and the words at it.
function drawHolder(g, onRobot, w) {
  const [x, y] = onRobot([frame.holder.x_m, frame.holder.y_m]), [rx, ry] = onRobot([0, 0]);
  g.strokeStyle = colours.holder; g.lineWidth = 2; g.setLineDash([3, 5]);
  g.beginPath(); g.moveTo(rx, ry); g.lineTo(x, y); g.stroke(); g.setLineDash([]);
  g.lineWidth = 5; g.beginPath(); g.arc(x, y, Math.max(0.42 * sight.scale, 14), 0, 7); g.stroke();
  g.font = "600 16px system-ui"; g.textAlign = x > w / 2 ? "right" : "left";
  label(g, t(frame.holder.what) + ", " + measure(frame.holder.distance_m, "m", 1), x + (x > w / 2 ? -24 : 24), y - 20, colours.holder);
}

function label(g, words, x, y, colour) {
  g.lineWidth = 4; g.strokeStyle = colours.paper; g.strokeText(words, x, y);
  g.fillStyle = colour; g.fillText(words, x, y);
}

// A bar of a round length, so that distances can be judged.
function drawScale(g) {
  const edge = inFeet ? FOOT_M : 1, length = [100, 50, 20, 10, 5, 2, 1, 0.5].find(n => n * edge * sight.scale <= 160) || 0.2;
  g.fillStyle = colours.paper; g.fillRect(6, 6, Math.max(length * edge * sight.scale, 30) + 16, 24);
  g.fillStyle = colours.ink; g.fillRect(14, 24, length * edge * sight.scale, 2);
  g.font = "12px system-ui"; g.textAlign = "left"; g.fillText(number(length, length < 1 ? 1 : 0) + " " + unitOf("m"), 14, 20);
}
