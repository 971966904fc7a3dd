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

function dayRow(date, day) {
  const cleaned = day.missions.reduce((sum, mission) => sum + mission.cleaned_m2, 0), hours = day.on_s / 3600;
  const stops = Object.values(day.stops).reduce((sum, count) => sum + count, 0);
  const longest = held => Object.entries(held).sort((a, b) => b[1] - a[1])[0];
  return {date, cleaned, hours, rate: hours > 0.05 ? cleaned / hours : 0, stops, driven: day.driven_m, cause: longest(day.held_by_s), place: longest(day.held_at_s)};
}

function showDays() {
  if (!$("days").open) return;
  const rows = Object.entries(records.days).reverse().slice(0, 31).map(([date, day]) => dayRow(date, day));
  const week = rows.slice(0, 7), sum = name => week.reduce((all, row) => all + row[name], 0);
  const table = element("table", ""), head = element("tr", "");
  table.append(element("caption", t("Last seven days: {}", number(sum("cleaned"), 1) + " m², " + number(sum("hours"), 1) + " h, " + number(sum("stops")) + " " + t("stops"))));
  for (const name of ["day", "proof", "m²", "m²/h", "h", "stops"]) { const cell = element("th", t(name)); cell.scope = "col"; head.append(cell); }
  table.append(head);
  for (const row of rows) {
    const line = element("tr", "");
    const proof = element("td", ""), button = element("button", "PDF", "plain");
    button.setAttribute("aria-label", t("Proof of {} as PDF", row.date));
    button.onclick = () => download("/proof.pdf?day=" + row.date + "&language=" + language, "proof-" + row.date + ".pdf");
    proof.append(button); line.append(element("td", row.date), proof);
    for (const text of [number(row.cleaned, 1), number(row.rate, 1), number(row.hours, 1), number(row.stops)]) line.append(element("td", text));
    table.append(line);
    if (row.cause) { const more = element("tr", ""), cell = element("td", t("held longest by: {}", t(row.cause[0]) + " (" + number(row.cause[1]) + " s)") + (row.place ? ", " + t("at {} m", row.place[0].replace(",", " / ")) : "")); cell.colSpan = 6; cell.className = "long"; more.append(cell); table.append(more); }
  }
  const key = language + JSON.stringify(rows.map(row => [row.date, Math.round(row.cleaned * 10), Math.round(row.hours * 20), row.stops, row.cause && row.cause[0]]));
  if ($("day-table").dataset.key === key) return;
  $("day-table").dataset.key = key;
  $("day-table").replaceChildren(table);
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

$("days").ontoggle = showDays;
$("seen-all").onclick = () => acknowledge({});
$("csv").onclick = () => {
  const rows = Object.entries(records.days).map(([date, day]) => [date, ...[dayRow(date, day).cleaned, day.on_s, day.moving_s, day.held_s, day.driven_m].map(value => value.toFixed(2)), dayRow(date, day).stops].join(","));
  save(new Blob(["date,cleaned_m2,on_s,moving_s,held_s,driven_m,stops\n" + rows.join("\n") + "\n"], {type: "text/csv"}), "days.csv");
};
