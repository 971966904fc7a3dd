const $ = id => document.getElementById(id);
// Languages in the order of the columns of WORDS.
const LANGUAGES = ["en", "de", "fr", "it", "es"];
const TABLE = new Map(WORDS.map(row => [row[0], row]));
let language = "en";
let numbers = new Map();

// The words in the language of the page; what the table does not have stays English.
function t(words, gap) {
  const row = TABLE.get(words), spoken = row && row[LANGUAGES.indexOf(language)] || words;
  return gap === undefined ? spoken : spoken.replace("{}", gap);
}

// A number as people of this language write it.
function number(value, digits = 0) {
  if (!numbers.has(digits)) numbers.set(digits, new Intl.NumberFormat(language, {minimumFractionDigits: digits, maximumFractionDigits: digits}));
  return numbers.get(digits).format(value);
}

// Feet where the browser's country measures in them, metres everywhere else; what is kept and sent is metric.
const FOOT_M = 0.3048, inFeet = (tag => { try { return ["US", "LR"].includes(new Intl.Locale(tag).region); } catch { return false; } })(navigator.language || "en");
// The value that is shown, its digits, and its unit.
const UNITS = {m: [FOOT_M, "ft"], "m/s": [FOOT_M, "ft/s"], "m²": [FOOT_M ** 2, "ft²"], "m²/h": [FOOT_M ** 2, "ft²/h"]};
function unitOf(unit) { return inFeet && UNITS[unit] ? UNITS[unit][1] : unit; }
function valueIn(value, unit, digits = 0) { return inFeet && UNITS[unit] ? number(value / UNITS[unit][0], Math.max(digits - 1, 0)) : number(value, digits); }
function measure(value, unit, digits = 0) { return valueIn(value, unit, digits) + "\u00a0" + unitOf(unit); }

function moment(iso) { return new Intl.DateTimeFormat(language, {dateStyle: "short", timeStyle: "short"}).format(new Date(iso)); }

function element(name, text, kind) {
  const made = document.createElement(name);
  made.textContent = text;
  if (kind) made.className = kind;
  return made;
}

// Text and labels of the page itself: the English stands in the page, the others in the table.
function speak(wanted) {
  language = LANGUAGES.includes(wanted) ? wanted : "en";
  numbers = new Map();
  document.documentElement.lang = language;
  $("language").value = language;
  for (const part of document.querySelectorAll("[data-t]")) { part.dataset.t ||= part.textContent; part.textContent = t(part.dataset.t); }
  for (const part of document.querySelectorAll("[data-label]")) part.setAttribute("aria-label", t(part.dataset.label));
  document.dispatchEvent(new Event("language"));
}
