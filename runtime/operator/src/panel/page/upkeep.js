// What is looked after: schedules, battery and parts that wear out, the camera's picture, the other robots of the site.
const WEEKDAYS = [1, 2, 3, 4, 5, 6, 7];
function weekday(day) { return new Intl.DateTimeFormat(language, {weekday: "short", timeZone: "UTC"}).format(new Date(Date.UTC(2024, 0, day))); }
function clock(minute) { return String(Math.floor(minute / 60)).padStart(2, "0") + ":" + String(minute % 60).padStart(2, "0"); }

function showSchedules() {
  const kept = records.schedules || [], canPlan = role !== "viewer";
  $("schedules").hidden = !(frame && frame.mission) || (!canPlan && !kept.length);
  $("schedule-form").hidden = !canPlan;
  list("schedule-list", kept, plan => JSON.stringify(plan), plan => {
    const line = element("li", ""), words = element("span", "");
    const days = plan.weekdays.length === 7 ? t("every day") : plan.weekdays.map(weekday).join(", ");
    words.append(element("b", plan.name), document.createElement("br"), element("small", days + ", " + clock(plan.minute) + ": " + (plan.areas.join(", ") || t("whole floor"))));
    line.append(words);
    if (canPlan) { const remove = element("button", t("Remove")); remove.setAttribute("aria-label", t("Remove: {}", plan.name)); remove.onclick = () => keepSchedules(kept.filter(other => other !== plan), t("The schedule {} is gone.", plan.name)); line.append(remove); }
    return line;
  });
  list("weekdays", WEEKDAYS, day => day, day => {
    const line = element("label", ""), box = document.createElement("input");
    box.type = "checkbox"; box.value = day; box.checked = day < 6;
    line.append(box, " ", weekday(day));
    return line;
  });
  list("schedule-area", [{name: ""}, ...areas.filter(area => area.kind === "clean")], area => area.name, area => { const choice = element("option", area.name || t("whole floor")); choice.value = area.name; return choice; });
}

async function keepSchedules(schedules, words) { if (await send("/schedules", {schedules}, words)) fetchRecords(); }

$("schedule-form").onsubmit = e => {
  e.preventDefault();
  const kept = records.schedules || [], [hour, minute] = $("schedule-time").value.split(":").map(Number);
  const weekdays = [...document.querySelectorAll("#weekdays input:checked")].map(box => +box.value);
  let name = $("schedule-name").value.trim();
  for (let i = 1; !name; i++) if (!kept.some(plan => plan.name === t("Schedule {}", i))) name = t("Schedule {}", i);
  const area = $("schedule-area").value;
  keepSchedules([...kept, {name, weekdays, minute: hour * 60 + minute, areas: area ? [area] : []}], t("The schedule {} is kept.", name));
  $("schedule-name").value = "";
};

function showSupplies(next) {
  const supplies = next.supplies;
  $("supplies").hidden = !supplies;
  if (!supplies) return;
  const unknown = t("nothing heard lately"), rows = [];
  if (supplies.has_battery) rows.push({name: t("battery"), words: supplies.charge_percent === null ? unknown : number(supplies.charge_percent) + " %", good: supplies.charge_percent > 20});
  for (const level of supplies.levels) rows.push({name: t(level.name), words: level.reported === null ? unknown : t(level.reported ? "yes" : "no"), good: level.reported === false});
  for (const part of supplies.parts) rows.push({name: part.name, part: part.name, words: t("{} h driven", number(part.used_h, 1)) + " " + t("of {} h", number(part.life_h)) + (part.changed ? ", " + t("new since {}", moment(part.changed)) : ""), good: part.used_h < part.life_h});
  list("supply-list", rows, row => row.name + row.words + row.good, row => {
    const line = element("li", "", row.good ? "good" : ""), words = element("span", "");
    words.append(element("span", "", "dot"), row.name + ": ", element("small", row.words));
    line.append(words);
    if (row.part && role === "technician") { const changed = element("button", t("Changed")); changed.setAttribute("aria-label", t("Changed") + ": " + row.part); changed.onclick = () => send("/changed", {part: row.part}, t("{} is new.", row.part)).then(fetchRecords); line.append(changed); }
    return line;
  });
}

// A picture a second at most, and only while somebody has it open.
let pictured = 0, picturing = false;
async function showCamera(next) {
  $("camera").hidden = !next.camera;
  if (!$("camera").open || picturing || pictured === next.camera) return;
  picturing = true; pictured = next.camera;
  try {
    const answer = await fetch("/camera.jpg", {headers});
    if (answer.ok) { const before = $("camera-picture").src; $("camera-picture").src = URL.createObjectURL(await answer.blob()); if (before) URL.revokeObjectURL(before); }
  } catch { /* the next picture asks again */ }
  picturing = false;
}

let robotsAt = 0;
async function showRobots(next) {
  $("robots").hidden = !next.robots;
  if (!next.robots || Date.now() - robotsAt < 2000) return;
  robotsAt = Date.now();
  let robots = [];
  try { const answer = await fetch("/robots", {headers}); if (answer.ok) robots = await answer.json(); } catch { return; }
  list("robot-list", robots, robot => JSON.stringify([robot.name, robot.brief, robot.problem]), robot => {
    const line = element("li", ""), link = element("a", robot.name), brief = robot.brief;
    link.href = robot.address; link.rel = "noreferrer";
    line.append(link);
    if (!brief) { line.append(": ", element("small", t(String(robot.problem || "no picture yet")))); return line; }
    const parts = brief.headline_parts || {}, holder = brief.holder;
    const gap = parts.cause ? t(String(parts.cause)) : holder ? t(String(holder.what)) + " (" + t(String(holder.direction)) + ", " + measure(+holder.distance_m || 0, "m", 1) + ")" : "";
    const words = [t(String(parts.key || ""), gap)];
    if (brief.mission) words.push(measure(+brief.mission.to_do_m2 || 0, "m²", 1) + " " + t("to do"));
    if (brief.charge_percent !== null && brief.charge_percent !== undefined) words.push(t("battery") + " " + number(+brief.charge_percent || 0) + " %");
    if (+brief.alerts) words.push(t("Alerts") + ": " + number(+brief.alerts));
    line.append(": ", element("small", words.join(", ")));
    return line;
  });
}
$("camera").ontoggle = () => { pictured = 0; if (frame) showCamera(frame); };
document.addEventListener("language", () => { robotsAt = 0; });
