// A token in the address opens the buttons: after the # it does not go over the line by itself.
const token = location.hash.slice(1);
const headers = token ? {Authorization: "Bearer " + token} : {};
// Where people were in the last seconds, a place every so often: a hundred of them are drawn in each picture.
const TRAIL_S = 6, TRAIL_STEP_M = 0.3, TRAIL_MAX = 24;
const trails = new Map(), path = [];
let frame = null, floor = null, plan = null, role = "viewer", asking = false;
const shown = {claimed: true, track: true, dirt: false, held: false};

// The person or object that holds the robot, as one would say it beside the robot.
function holderWords(holder) { return t(holder.what) + " (" + t(holder.direction) + ", " + measure(holder.distance_m, "m", 1) + ")"; }

// What the guard says, piece by piece.
function spokenPieces(pieces) {
  const gap = piece => piece.number !== null ? measure(piece.number, piece.unit, piece.digits) : piece.word ? t(piece.word) : piece.text ?? undefined;
  return pieces.map(piece => t(piece.key, gap(piece))).join(", ");
}

function headlineOf(next) {
  const parts = next.headline_parts;
  return t(parts.key, parts.cause ? t(parts.cause) : next.holder ? holderWords(next.holder) : "");
}

function show(next) {
  frame = next;
  $("title").textContent = next.title;
  $("time").textContent = number(next.time_s, 1) + " s";
  const state = t(next.state);
  $("state").textContent = next.paused ? t("{} (paused)", state) : state;
  $("state").className = next.state;
  $("speed").textContent = measure(Math.abs(next.speed_mps), "m/s", 2);
  $("limit").textContent = measure(next.limit_mps, "m/s", 2);
  $("people").textContent = next.people.filter(p => p.person).length;
  $("driven").textContent = measure(next.driven_m, "m", 1);
  showCause(next);
  const enable = (order, yes) => { document.querySelector("[data-order=" + order + "]").disabled = !yes; };
  enable("pause", !next.paused); enable("resume", next.paused); enable("reset", next.reset_allowed); enable("start", next.start_allowed);
  list("sources", next.sources, source => source.name + source.health + source.good, source => {
    const line = element("li", "", source.good ? "good" : "");
    line.append(element("span", "", "dot"), t(source.name) + ": ", element("small", t(source.health)));
    return line;
  });
  list("stops", next.stops, stop => stop.at_s + stop.text, stop => {
    const line = element("li", "");
    line.append(element("b", number(stop.at_s, 1) + " s "), t(stop.name), document.createElement("br"), element("small", spokenPieces(stop.pieces.filter(piece => piece.key !== stop.name))));
    return line;
  });
  showMission(next);
  showSupplies(next); showCamera(next); showRobots(next);
  const last = path[path.length - 1];
  if (!last || Math.hypot(last[0] - next.pose[0], last[1] - next.pose[1]) > 0.05) path.push(next.pose.slice(0, 2));
  if (path.length > 20000) path.splice(0, 5000);
  const seen = new Set();
  for (const person of next.people.filter(p => p.person)) {
    seen.add(person.id);
    const trail = trails.get(person.id) || [];
    const before = trail[trail.length - 1];
    if (!before || Math.hypot(before[0] - person.at_m[0], before[1] - person.at_m[1]) > TRAIL_STEP_M) trail.push([...person.at_m, next.time_s]);
    while (trail.length > TRAIL_MAX || (trail.length && next.time_s - trail[0][2] > TRAIL_S)) trail.shift();
    trails.set(person.id, trail);
  }
  for (const id of trails.keys()) if (!seen.has(id)) { const trail = trails.get(id); trail.shift(); if (!trail.length) trails.delete(id); }
  noteWalls(next);
  draw();
}

// Lists are rebuilt only when they say something else: what is under a finger or a reader stays there.
const MAY_BE_EMPTY = ["stops", "old-alerts"];
function list(id, items, key, make) {
  const keys = language + role + JSON.stringify(items.map(key));
  if ($(id).dataset.key === keys) return;
  $(id).dataset.key = keys;
  const lines = items.map(make);
  if (!lines.length && MAY_BE_EMPTY.includes(id)) lines.push(element("li", t("none yet"), "small"));
  $(id).replaceChildren(...lines);
}

// The headline changes with each picture; a screen reader hears it only when it tells of something else.
let announced = "";
function showCause(next) {
  const headline = headlineOf(next);
  $("headline").textContent = headline;
  $("cause").className = !next.cause ? "clear" : next.limit_mps > 0 ? "" : "stop";
  const why = [];
  if (next.cause) why.push(element("p", t(next.cause.remedy)));
  if (next.reset_refused) { const line = element("p", ""); line.append(element("b", t("reset refused") + ": "), spokenPieces(next.reset_refused_pieces)); why.push(line); }
  if (next.cause) {
    const more = element("details", "");
    more.open = !!$("why").querySelector("details[open]");
    more.append(element("summary", t("Cause in full")), element("small", spokenPieces(next.cause.pieces)));
    if (next.first_cause) more.append(document.createElement("br"), element("small", t("It stopped first for: {}", t(next.first_cause.name))));
    why.push(more);
  }
  const key = JSON.stringify([language, next.cause && next.cause.text.replace(/[\d.]+/g, ""), next.first_cause && next.first_cause.name, next.reset_refused]);
  if ($("why").dataset.key !== key) { $("why").dataset.key = key; $("why").replaceChildren(...why); }
  const words = headline.replace(/,? ?[\d.,]+\s(m|ft)\b/g, "");
  if (words !== announced) { announced = words; $("live").textContent = headline + ". " + (next.cause ? t(next.cause.remedy) : ""); }
}

function showMission(next) {
  const mission = next.mission;
  $("mission").hidden = !mission;
  if (!mission) return;
  const name = next.queue && next.queue.name;
  $("phase").textContent = t(mission.phase) + (name ? " (" + name + ")" : "");
  const areas = {c: mission.cleaned_m2, a: mission.assumed_m2, d: mission.remaining_m2};
  const all = Math.max(areas.c + areas.a + areas.d, 0.01);
  for (const letter of "cad") {
    document.querySelector("#bar ." + letter).style.width = 100 * areas[letter] / all + "%";
    $("m2" + letter).textContent = measure(areas[letter], "m²", 1);
  }
  $("bar").setAttribute("aria-label", t("cleaned by me") + " " + measure(areas.c, "m²") + ", " + t("assumed clean") + " " + measure(areas.a, "m²") + ", " + t("to do") + " " + measure(areas.d, "m²"));
  $("doubts").textContent = [[mission.completion_percent, "{} % of the dirty floor claimed clean"], [mission.claimed_percent, "{} % of all floor"], [mission.dirt_percent, "{} % of the dirt still expected"],
    [mission.uncertain_cells, "{} cells not claimed"], [mission.unreachable_cells, "{} cells out of reach"], [mission.waited_s, "waited {} s"]].map(([value, words]) => t(words, number(value))).join("; ");
  const queue = next.queue, runs = !["done", "cancelled"].includes(mission.phase);
  const waiting = queue ? [...(runs ? [queue.name || t("whole floor")] : []), ...queue.waiting.map(name => name || t("whole floor"))] : [];
  list("queue", waiting, name => name + runs, (name) => {
    const place = waiting.indexOf(name) + (runs ? 0 : 1), line = element("li", "");
    line.append(element("span", (place ? t("then: {}", name) : t("now: {}", name))));
    if (role !== "viewer") { const stop = element("button", t("Cancel")); stop.setAttribute("aria-label", t("Cancel: {}", name)); stop.onclick = () => send("/mission", {do: "cancel", place}); line.append(stop); }
    return line;
  });
  if (queue && queue.answered !== answered) { if (queue.refused) note(t("The mission refuses: {}", queue.refused)); answered = queue.answered; }
  if (!asking && (!floor || floor.number < mission.layers)) fetchFloor();
  if (!plan) fetchPlan();
}
let answered = null;

async function fetchFloor() {
  asking = true;
  try {
    const answer = await fetch("/layers?after=" + (floor ? floor.number : 0), {headers});
    const next = answer.ok ? await answer.json() : {};
    if (next.number) { floor = next; repaint(); }
  } catch { /* the next picture asks again */ }
  asking = false;
}

async function fetchPlan() {
  plan = {};
  try {
    const answer = await fetch("/map", {headers});
    const next = answer.ok ? await answer.json() : {};
    if (next.width) { plan = next; repaint(); }
  } catch { plan = null; }
}
