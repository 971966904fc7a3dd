// Pixels a metre, and what stands in the middle of the map, metres in the odometry frame.
const sight = {scale: innerWidth < 700 ? 30 : 45, x: 0, y: 0, follows: true};
// Size of the map on the page, CSS pixels: read once a picture. Asked for each of thousands of points it took two thirds of the time.
const extent = {w: 0, h: 0};
function readExtent() { const canvas = $("map"); extent.w = canvas.clientWidth; extent.h = canvas.clientHeight; }
new ResizeObserver(() => draw()).observe($("map"));
function onScreen([x, y]) { return [extent.w / 2 + (x - sight.x) * sight.scale, extent.h / 2 - (y - sight.y) * sight.scale]; }
function fromScreen([x, y]) { const canvas = $("map"); return [sight.x + (x - canvas.clientWidth / 2) / sight.scale, sight.y - (y - canvas.clientHeight / 2) / sight.scale]; }

function follow(yes) { sight.follows = yes; document.querySelector("[data-act=follow]").setAttribute("aria-pressed", yes); }

// Zooms; what lies under the place of the canvas stays there.
function zoom(by, x, y) {
  const canvas = $("map"), before = sight.scale;
  sight.scale = Math.min(200, Math.max(1.5, before * by));
  if (!sight.follows && x !== undefined) {
    const dx = x - canvas.clientWidth / 2, dy = y - canvas.clientHeight / 2;
    sight.x += dx / before - dx / sight.scale; sight.y -= dy / before - dy / sight.scale;
  }
  draw();
}

function pan(dx, dy) { follow(false); sight.x -= dx / sight.scale; sight.y += dy / sight.scale; draw(); }

function whole() {
  const canvas = $("map"), known = plan && plan.width ? plan : floor;
  const all = known && frame && frame.mission ? {left: Infinity, right: -Infinity, low: Infinity, high: -Infinity} : {...edge};
  const widen = ([x, y]) => { all.left = Math.min(all.left, x); all.right = Math.max(all.right, x); all.low = Math.min(all.low, y); all.high = Math.max(all.high, y); };
  path.forEach(widen);
  if (known && frame && frame.mission) {
    const {inOdometry} = mapFrame(), [x, y] = known.corner, m = known.resolution_m;
    for (const i of [0, known.width]) for (const j of [0, known.height]) widen(inOdometry([x + i * m, y + j * m]));
  }
  follow(false);
  sight.x = (all.left + all.right) / 2; sight.y = (all.low + all.high) / 2;
  sight.scale = Math.min(200, Math.max(1.5, 0.92 * Math.min(canvas.clientWidth / (all.right - all.left), canvas.clientHeight / (all.high - all.low))));
  draw();
}

const acts = {near: () => zoom(1.3), far: () => zoom(1 / 1.3), whole, follow: () => { follow(!sight.follows); draw(); }};
document.querySelectorAll("[data-act]").forEach(button => button.onclick = acts[button.dataset.act]);
const map = $("map"), fingers = new Map();
map.addEventListener("wheel", e => { e.preventDefault(); zoom(e.deltaY < 0 ? 1.15 : 0.87, e.offsetX, e.offsetY); }, {passive: false});
map.addEventListener("pointerdown", e => {
  map.setPointerCapture(e.pointerId);
  if (pen) return penDown([e.offsetX, e.offsetY]);
  fingers.set(e.pointerId, [e.offsetX, e.offsetY]);
});
map.addEventListener("pointermove", e => {
  if (pen) return penMove([e.offsetX, e.offsetY], e.buttons > 0);
  const before = fingers.get(e.pointerId);
  if (!before) return;
  const now = [e.offsetX, e.offsetY];
  const other = [...fingers].find(([id]) => id !== e.pointerId);
  fingers.set(e.pointerId, now);
  if (other) {
    const apart = p => Math.hypot(p[0] - other[1][0], p[1] - other[1][1]);
    zoom(apart(now) / Math.max(apart(before), 1), (now[0] + other[1][0]) / 2, (now[1] + other[1][1]) / 2);
  } else pan(now[0] - before[0], now[1] - before[1]);
});
for (const end of ["pointerup", "pointercancel"]) map.addEventListener(end, e => { fingers.delete(e.pointerId); if (pen && end === "pointerup") penUp([e.offsetX, e.offsetY]); });
map.addEventListener("keydown", e => {
  if (pen && penKey(e)) return e.preventDefault();
  const keys = {ArrowLeft: () => pan(60, 0), ArrowRight: () => pan(-60, 0), ArrowUp: () => pan(0, 60), ArrowDown: () => pan(0, -60),
    "+": acts.near, "=": acts.near, "-": acts.far, "0": whole, f: acts.follow};
  if (keys[e.key]) { e.preventDefault(); keys[e.key](); }
});
addEventListener("resize", draw);
