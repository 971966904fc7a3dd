// What is kept over the runs: areas, alerts, days.
let records = {number: 0, alerts: {list: []}, days: {}}, fetching = false, fetchedAt = 0;

async function fetchRecords() {
  fetching = true;
  try {
    const answer = await fetch("/records", {headers});
    if (answer.ok) { records = await answer.json(); areas = records.areas; fetchedAt = Date.now(); showRecords(); draw(); }
  } catch { /* the next picture asks again */ }
  fetching = false;
}

function showRecords() { showAreas(); showAlerts(); showDays(); showSchedules(); }

function alertLine(alert) {
  const line = element("li", ""), words = element("span", "");
  words.append(element("b", t(alert.name)), document.createElement("br"), element("small", moment(alert.at) + (alert.acknowledged ? ", " + t("seen {}", moment(alert.acknowledged)) : "")));
  line.append(words);
  if (!alert.acknowledged && role !== "viewer") { const seen = element("button", t("Seen")); seen.setAttribute("aria-label", t("Seen") + ": " + t(alert.name)); seen.onclick = () => acknowledge({id: alert.id}); line.append(seen); }
  return line;
}

async function acknowledge(what) { if (await send("/acknowledge", what, t("Acknowledged."))) fetchRecords(); }

function showAlerts() {
  const all = records.alerts.list, open = all.filter(alert => !alert.acknowledged);
  $("open-alerts").textContent = open.length ? "(" + number(open.length) + ")" : "";
  list("alert-list", open.slice(0, 3), alert => alert.id, alertLine);
  list("old-alerts", [...open.slice(3), ...all.filter(alert => alert.acknowledged)].slice(0, 50), alert => alert.id + "" + alert.acknowledged, alertLine);
  $("seen-all").hidden = role === "viewer" || open.length < 2;
}

// Days that belong together, added up: seconds, metres, and what stopped and held the robot.
function summed(days) {
  const all = {on_s: 0, moving_s: 0, held_s: 0, driven_m: 0, cleaned_m2: 0, stops: {}, held_by_s: {}, held_at_s: {}};
  for (const day of days) {
    for (const name of ["on_s", "moving_s", "held_s", "driven_m"]) all[name] += day[name];
    all.cleaned_m2 += day.missions.reduce((sum, mission) => sum + mission.cleaned_m2, 0);
    for (const name of ["stops", "held_by_s", "held_at_s"]) for (const [key, value] of Object.entries(day[name])) all[name][key] = (all[name][key] || 0) + value;
  }
  return all;
}

function largest(values) { return Object.entries(values).sort((a, b) => b[1] - a[1]); }
function count(stops) { return Object.values(stops).reduce((sum, times) => sum + times, 0); }

// The Monday that a week begins with.
function mondayOf(date) { const day = new Date(date + "T00:00:00Z"); day.setUTCDate(day.getUTCDate() - (day.getUTCDay() + 6) % 7); return day.toISOString().slice(0, 10); }

function lastSevenDays() { return summed(Object.entries(records.days).reverse().slice(0, 7).map(([, day]) => day)); }

// A row for each day or each week, the newest first.
function rowsBy(span) {
  const groups = new Map();
  for (const [date, day] of Object.entries(records.days)) { const key = span === "week" ? mondayOf(date) : date; groups.set(key, [...(groups.get(key) || []), day]); }
  return [...groups].reverse().slice(0, 31).map(([date, days]) => ({date, ...summed(days)}));
}

function rate(row) { const hours = row.on_s / 3600; return hours > 0.05 ? row.cleaned_m2 / hours : 0; }

function showDays() {
  if (!$("days").open) return;
  const span = $("span").value, rows = rowsBy(span), seven = lastSevenDays();
  const key = language + span + JSON.stringify(rows.map(row => [row.date, Math.round(row.cleaned_m2 * 10), Math.round(row.on_s / 180), row.stops]));
  if ($("day-table").dataset.key === key) return;
  $("day-table").dataset.key = key;
  const table = element("table", ""), head = element("tr", "");
  table.append(element("caption", t("Last seven days: {}", measure(seven.cleaned_m2, "m²", 1) + ", " + number(seven.on_s / 3600, 1) + " h, " + number(count(seven.stops)) + " " + t("stops"))));
  for (const name of [t(span === "week" ? "week from" : "day"), ...(span === "day" ? [t("proof")] : []), unitOf("m²"), unitOf("m²/h"), "h", t("stops")]) { const cell = element("th", name); cell.scope = "col"; head.append(cell); }
  table.append(head);
  for (const row of rows) {
    const line = element("tr", "");
    line.append(element("td", row.date));
    if (span === "day") {
      const proof = element("td", ""), button = element("button", "PDF", "plain");
      button.setAttribute("aria-label", t("Proof of {} as PDF", row.date));
      button.onclick = () => download("/proof.pdf?day=" + row.date + "&language=" + language, "proof-" + row.date + ".pdf");
      proof.append(button); line.append(proof);
    }
    for (const text of [valueIn(row.cleaned_m2, "m²", 1), valueIn(rate(row), "m²/h", 1), number(row.on_s / 3600, 1), number(count(row.stops))]) line.append(element("td", text));
    table.append(line);
    const [cause] = largest(row.held_by_s), [place] = largest(row.held_at_s);
    if (cause) { const more = element("tr", ""), cell = element("td", t("held longest by: {}", t(cause[0]) + " (" + number(cause[1]) + " s)") + (place ? ", " + t("at {} m", place[0].replace(",", " / ")) : "")); cell.colSpan = 6; cell.className = "long"; more.append(cell); table.append(more); }
  }
  $("day-table").replaceChildren(table);
  // What stopped it most and held it longest in the last seven days.
  const held = cause => seven.held_by_s[cause] ? ", " + number(seven.held_by_s[cause]) + " s" : "";
  const lines = largest(seven.stops).slice(0, 5).map(([cause, times]) => { const line = element("li", ""); line.append(element("b", number(times) + " × "), t(cause), element("small", held(cause))); return line; });
  $("causes").replaceChildren(...lines);
}

// Rings where the guard held the robot in the last seven days; their area grows with the seconds.
function drawHeld(g, at) {
  if (!frame.mission) return;
  const {inOdometry} = mapFrame(), places = largest(lastSevenDays().held_at_s).slice(0, 50), most = places.length ? places[0][1] : 1;
  g.strokeStyle = colours.slow; g.lineWidth = 3;
  for (const [place, held_s] of places) {
    const [x, y] = at(inOdometry(place.split(",").map(Number)));
    g.globalAlpha = 0.35; g.fillStyle = colours.slow;
    g.beginPath(); g.arc(x, y, Math.max(4, sight.scale * Math.sqrt(held_s / most)), 0, 7); g.fill();
    g.globalAlpha = 1; g.stroke();
  }
}

async function download(address, name) {
  try {
    const answer = await fetch(address, {headers});
    if (!answer.ok) return note(t(await answer.text()));
    save(await answer.blob(), name);
  } catch { note(t("the robot's program does not answer")); }
}

function save(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob); link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

$("days").ontoggle = $("span").onchange = showDays;
$("seen-all").onclick = () => acknowledge({});
$("csv").onclick = () => {
  const span = $("span").value;
  const rows = rowsBy(span).reverse().map(row => [row.date, ...[row.cleaned_m2, row.on_s, row.moving_s, row.held_s, row.driven_m].map(value => value.toFixed(2)), count(row.stops)].join(","));
  save(new Blob([(span === "week" ? "week_from" : "date") + ",cleaned_m2,on_s,moving_s,held_s,driven_m,stops\n" + rows.join("\n") + "\n"], {type: "text/csv"}), span + "s.csv");
};
