// Areas of the map, and the pen that draws them or shows where the robot is: by touch, by mouse, or with arrow keys and Enter.
let areas = [], pen = null;
const AREA_COLOURS = {"no-go": "holder", slow: "slow", clean: "cleaned"};

function drawAreas(g, at) {
  if (!frame.mission) return;
  const {inOdometry} = mapFrame();
  for (const area of areas) {
    const corners = area.corners_m.map(corner => at(inOdometry(corner)));
    const colour = colours[AREA_COLOURS[area.kind]];
    g.beginPath(); corners.forEach(([x, y], i) => i ? g.lineTo(x, y) : g.moveTo(x, y)); g.closePath();
    g.fillStyle = colour + "22"; g.fill(); g.setLineDash([8, 5]); g.strokeStyle = colour; g.lineWidth = 2; g.stroke(); g.setLineDash([]);
    g.font = "600 13px system-ui"; g.textAlign = "left";
    const [x, y] = corners.reduce((a, b) => a[1] < b[1] || (a[1] === b[1] && a[0] < b[0]) ? a : b);
    label(g, area.name, x + 5, y + 16, colour);
  }
}

// What the pen has so far, and its cross.
function drawPen(g, at) {
  if (!pen) return;
  g.strokeStyle = g.fillStyle = colours.person; g.lineWidth = 2;
  const [x, y] = pen.cursor;
  g.beginPath(); g.moveTo(x - 12, y); g.lineTo(x + 12, y); g.moveTo(x, y - 12); g.lineTo(x, y + 12); g.stroke();
  if (!pen.first) return;
  const [fx, fy] = at(pen.first);
  g.beginPath();
  if (pen.kind) g.rect(Math.min(fx, x), Math.min(fy, y), Math.abs(x - fx), Math.abs(y - fy));
  else { g.arc(fx, fy, 8, 0, 7); g.moveTo(fx, fy); g.lineTo(x, y); }
  g.stroke();
}

function take(what) {
  const canvas = $("map");
  follow(false);
  pen = {...what, cursor: [canvas.clientWidth / 2, canvas.clientHeight / 2], first: null, wasDown: null};
  map.classList.add("draws");
  $("hint").hidden = false;
  hint();
  canvas.focus();
  canvas.scrollIntoView({block: "nearest"});
  draw();
}

function hint() {
  const words = pen.kind
    ? pen.first ? "Now the opposite corner: drag, touch it, or arrow keys and Enter." : "Draw a rectangle: drag, touch two corners, or arrow keys and Enter."
    : pen.first ? "Now where its front points: touch it, or arrow keys and Enter." : "Show where the robot stands: touch and drag to where its front points, or arrow keys and Enter.";
  $("hint-text").textContent = t(words);
  $("live").textContent = t(words);
}

function drop() { pen = null; map.classList.remove("draws"); $("hint").hidden = true; draw(); }

function penDown(place) { pen.wasDown = place; pen.cursor = place; if (!pen.first) { pen.first = fromScreen(place); hint(); pen.began = place; } draw(); }
function penMove(place, isDown) { if (isDown || pen.first) { pen.cursor = place; draw(); } }
function penUp(place) {
  pen.cursor = place;
  const far = pen.first && Math.hypot(onScreen(pen.first)[0] - place[0], onScreen(pen.first)[1] - place[1]) > 12;
  if (far) finish(); else draw();
}
function penKey(e) {
  const step = e.shiftKey ? 5 : 25, moves = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};
  if (moves[e.key]) { pen.cursor = pen.cursor.map((value, i) => value + step * moves[e.key][i]); draw(); return true; }
  if (e.key === "Escape") { drop(); return true; }
  if (e.key !== "Enter" && e.key !== " ") return false;
  if (!pen.first) { pen.first = fromScreen(pen.cursor); hint(); draw(); } else finish();
  return true;
}

function finish() {
  const {inMap, turn} = mapFrame(), done = pen, a = done.first, b = fromScreen(done.cursor);
  drop();
  if (done.kind) {
    const corners = [[a[0], a[1]], [b[0], a[1]], [b[0], b[1]], [a[0], b[1]]].map(inMap);
    keepAreas([...areas, {name: done.name, kind: done.kind, corners_m: corners.map(corner => corner.map(m => +m.toFixed(3)))}], t("The area {} is kept.", done.name));
  } else {
    const [x_m, y_m] = inMap(a);
    send("/mission", {do: "locate", x_m, y_m, heading_rad: Math.atan2(b[1] - a[1], b[0] - a[0]) + turn}, t("The robot looks around whether it is there."));
  }
}

async function keepAreas(next, words) { if (await send("/areas", {areas: next}, words)) fetchRecords(); }

function nameFor(kind) {
  const words = t({"no-go": "no-go", slow: "slow", clean: "to clean"}[kind]);
  let i = 1;
  while (areas.some(area => area.name === words + " " + i)) i++;
  return words + " " + i;
}

function showAreas() {
  const canDraw = role === "technician";
  $("areas").hidden = !(frame && frame.mission) || (!canDraw && !areas.length);
  $("draw").hidden = !canDraw;
  list("area-list", areas, area => area.name + area.kind, area => {
    const line = element("li", "");
    line.append(element("span", area.name + ": " + t({"no-go": "no-go", slow: "slow", clean: "to clean"}[area.kind])));
    if (canDraw) { const remove = element("button", t("Remove")); remove.setAttribute("aria-label", t("Remove: {}", area.name)); remove.onclick = () => keepAreas(areas.filter(other => other !== area), t("The area {} is gone.", area.name)); line.append(remove); }
    return line;
  });
  const choices = areas.filter(area => area.kind === "clean");
  list("choices", choices.length ? choices : [{name: ""}], area => area.name, area => {
    const line = element("label", ""), box = document.createElement("input");
    box.type = "checkbox"; box.value = area.name; box.checked = box.disabled = !area.name;
    line.append(box, " ", area.name || t("whole floor"));
    return line;
  });
  $("begin").hidden = role === "viewer";
}

$("draw").onsubmit = e => { e.preventDefault(); $("draw-button").click(); };
$("draw-button").onclick = () => { const kind = $("kind").value; take({kind, name: $("name").value.trim() || nameFor(kind)}); $("name").value = ""; };
$("locate").onclick = () => take({});
$("relocate").onclick = () => {
  const {inMap, turn} = mapFrame(), [x_m, y_m] = inMap(frame.pose);
  send("/mission", {do: "locate", x_m, y_m, heading_rad: frame.pose[2] + turn}, t("The robot looks around whether it is there."));
};
$("hint-cancel").onclick = drop;
$("begin-button").onclick = () => {
  const chosen = [...document.querySelectorAll("#choices input:checked:not(:disabled)")].map(box => box.value);
  send("/mission", {do: "begin", areas: chosen}, t("The robot cleans {} next.", chosen.join(", ") || t("whole floor")));
};
