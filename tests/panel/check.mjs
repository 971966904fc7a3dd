// Drives the operator's panel in a headless browser, as a person would: by keyboard and by touch, at three widths, light and dark,
// in five languages. Prints one line for each check and ends with 1 if any failed.
//
// `cargo xtask panel-check` installs what it needs and starts it: node check.mjs PROGRAM CHROMIUM FOLDER
import {spawn} from "node:child_process";
import {Agent, get} from "node:http";
import {createRequire} from "node:module";
import {mkdirSync, readFileSync, readdirSync, writeFileSync} from "node:fs";
import {cpus, loadavg} from "node:os";
import {join} from "node:path";

const [program, chromium, folder] = process.argv.slice(2);
const need = createRequire(join(folder, "package.json"));
const {chromium: browserType} = need("playwright-core");
const axeSource = readFileSync(need.resolve("axe-core/axe.min.js"), "utf8");
const shots = join(folder, "shots");
mkdirSync(shots, {recursive: true});

let failed = 0, checks = 0;
function check(what, good, more = "") {
  checks += 1;
  if (!good) failed += 1;
  console.log((good ? "ok   " : "FAIL ") + what + (more ? ": " + more : ""));
}

// A robot among people, with its panel; nobody presses anything but this walk.
function begin(records, env = {}) {
  const words = ["simulate", "--scenario", "supermarket", "--strategy", "guarantee", "--seed", "3", "--duration", "900", "--json", "--panel", "127.0.0.1:0", "--panel-records", records];
  const child = spawn(program, words, {env: {...process.env, ...env}, stdio: ["ignore", "ignore", "pipe"]});
  const address = new Promise((found, lost) => {
    let text = "";
    child.stderr.on("data", data => { text += data; const hit = /panel: (http:\S+#\S+)\s/.exec(text); if (hit) found(hit[1]); });
    child.on("exit", code => lost(new Error("the program ended with " + code + ": " + text)));
  });
  return {child, address};
}

// How busy the computer is: figures of a busy one say little.
function load() { return "load " + loadavg()[0].toFixed(1) + " on " + cpus().length + " processors"; }

async function axe(page, what) {
  await page.evaluate(axeSource);
  const found = await page.evaluate(async () => {
    const result = await axe.run(document, {resultTypes: ["violations"]});
    return result.violations.map(v => v.id + " (" + v.nodes.map(n => n.target.join(" ") + " " + (n.any[0] ? n.any[0].message : "")).slice(0, 3).join(" | ") + ")");
  });
  check("axe finds no violation, " + what, found.length === 0, found.join("; "));
}

// Text that does not fit where it stands, and what is wider than the window.
const clipped = () => {
  const out = [];
  for (const part of document.querySelectorAll("button, summary, h2, label, p, li, td, th, b, #state, select")) {
    if (!part.offsetParent || part.closest(".unseen")) continue;
    if (part.scrollWidth > part.clientWidth + 1 && getComputedStyle(part).overflowX !== "visible" && part.id !== "title") out.push("clipped " + part.tagName + " " + part.textContent.slice(0, 40));
    const box = part.getBoundingClientRect();
    if ((box.right > innerWidth + 1 || box.left < -1) && !part.closest(".wide, .table")) out.push("outside " + part.tagName + " " + part.textContent.slice(0, 40));
  }
  if (document.documentElement.scrollWidth > innerWidth) out.push("page is " + document.documentElement.scrollWidth + " wide");
  return out;
};

// PANEL_PAGE is the file of a page that is tried in place of the program's.
async function fresh(browser, options) {
  const context = await browser.newContext(options);
  if (process.env.PANEL_PAGE) {
    const body = readFileSync(process.env.PANEL_PAGE, "utf8");
    await context.route(url => url.pathname === "/", route => route.fulfill({body, contentType: "text/html; charset=utf-8"}));
  }
  return context;
}

async function ready(page) {
  await page.waitForFunction(() => typeof frame !== "undefined" && frame && frame.mission && plan && plan.width && floor && records.number > 0, null, {timeout: 60000});
  await page.waitForTimeout(300);
}

async function openAll(page) { await page.evaluate(() => document.querySelectorAll("details").forEach(part => { part.open = true; })); await page.waitForTimeout(200); }

async function layouts(browser, address) {
  for (const width of [390, 768, 1280]) for (const theme of ["light", "dark"]) {
    const context = await fresh(browser, {viewport: {width, height: 844}, colorScheme: theme, locale: "en-GB", hasTouch: width < 1000});
    const page = await context.newPage();
    const errors = [];
    page.on("pageerror", error => errors.push(error.message));
    await page.goto(address);
    await ready(page);
    await page.click("[data-act=whole]");
    await page.screenshot({path: join(shots, "panel-" + width + "-" + theme + ".png")});
    await axe(page, width + " px, " + theme);
    await openAll(page);
    await axe(page, width + " px, " + theme + ", all open");
    if (theme === "light") for (const language of ["en", "de", "fr", "it", "es"]) {
      await page.selectOption("#language", language);
      await page.waitForTimeout(150);
      const out = await page.evaluate(clipped);
      check("no clipped text, " + width + " px, " + language, out.length === 0, out.slice(0, 4).join("; "));
      const english = await page.evaluate(() => [...document.querySelectorAll("[data-t]")].filter(part => language !== "en" && !TABLE.has(part.dataset.t)).map(part => part.dataset.t));
      check("every word is in the table, " + width + " px, " + language, english.length === 0, english.join("; "));
      if (width !== 768) await page.screenshot({path: join(shots, "panel-" + width + "-" + language + ".png"), fullPage: true});
    }
    check("no error in the page, " + width + " px, " + theme, errors.length === 0, errors.join("; "));
    await context.close();
  }
}

// Where a place of the map's frame is in the window.
const windowOf = ([x, y]) => { const box = document.getElementById("map").getBoundingClientRect(), at = onScreen(mapFrame().inOdometry([x, y])); return [box.left + at[0], box.top + at[1]]; };

// The five tasks of a stranger; counts what is pressed. `press` and `drag` are by touch, by mouse or by keyboard.
async function tasks(browser, address, how) {
  const width = how === "touch" ? 390 : 1280;
  const context = await fresh(browser, {viewport: {width, height: 900}, hasTouch: how === "touch", locale: "en-GB", acceptDownloads: true});
  const page = await context.newPage();
  await page.goto(address);
  await ready(page);
  let clicks = 0;
  const byKeyboard = async selector => { await page.focus(selector); const focused = await page.evaluate(s => document.activeElement === document.querySelector(s), selector); check("reached by keyboard: " + selector, focused); await page.keyboard.press(selector.includes("input") ? "Space" : "Enter"); };
  const press = async selector => {
    clicks += 1;
    if (how === "keyboard") return byKeyboard(selector);
    return how === "touch" ? page.tap(selector) : page.click(selector);
  };
  const drag = async (from, to) => {
    clicks += 1;
    if (how === "keyboard") {
      for (const place of [from, to]) {
        for (let i = 0; i < 200; i++) {
          const at = await page.evaluate(windowOf, place);
          const [dx, dy] = await page.evaluate(at => { const box = document.getElementById("map").getBoundingClientRect(); return [at[0] - box.left - pen.cursor[0], at[1] - box.top - pen.cursor[1]]; }, at);
          const key = Math.abs(dx) > Math.abs(dy) ? (dx > 0 ? "ArrowRight" : "ArrowLeft") : dy > 0 ? "ArrowDown" : "ArrowUp";
          const far = Math.max(Math.abs(dx), Math.abs(dy));
          if (far < 4) break;
          await page.keyboard.press(far > 15 ? key : "Shift+" + key);
        }
        await page.keyboard.press("Enter");
      }
      return;
    }
    const [a, b] = [await page.evaluate(windowOf, from), await page.evaluate(windowOf, to)];
    if (how === "touch") { await page.touchscreen.tap(...a); await page.waitForTimeout(100); await page.touchscreen.tap(...b); clicks += 1; return; }
    await page.mouse.move(...a); await page.mouse.down(); await page.mouse.move(...b, {steps: 5}); await page.mouse.up();
  };
  const counted = (task, good, more) => { check(how + ", " + task + ": " + clicks + " clicks", good && clicks <= 5, more); clicks = 0; };
  // The page's policy forbids it to evaluate text; the browser's debugger may.
  const answered = async condition => {
    for (const end = Date.now() + 240000; Date.now() < end; await page.waitForTimeout(100)) if (await page.evaluate(condition)) return true;
    return false;
  };

  // Where the robot may be told to be and where areas go: free floor of the map.
  await page.evaluate(() => { whole(); });
  // 1. A no-go area.
  await press("#areas > summary");
  await press("#draw-button");
  await drag([9, -1.5], [11, 0.5]);
  counted("draw a no-go area", await answered("areas.some(area => area.kind === 'no-go')"), await page.textContent("#note"));
  await page.screenshot({path: join(shots, "tasks-" + how + "-area.png")});
  // Prepared by the technician: an area to clean.
  await page.selectOption("#kind", "clean");
  await page.fill("#name", "Aisle");
  await press("#draw-button");
  await drag([2, -1.5], [6, 1.5]);
  await answered("areas.some(area => area.name === 'Aisle')");
  clicks = 0;
  // 2. A mission in an area.
  await page.waitForSelector("#choices input[value=Aisle]");
  await press("#choices input[value=Aisle]");
  await press("#begin-button");
  counted("start a mission in an area", await answered("frame.queue.waiting.includes('Aisle') || frame.queue.name === 'Aisle'"), await page.textContent("#note"));
  await press("#queue li:last-child button");
  clicks = 0;
  check(how + ", the mission that waits is cancelled", await answered("!frame.queue.waiting.includes('Aisle')"));
  // 3. Why it stands: paused by this operator, as the first line has it. A stop of the guard, for a person before it just then, comes first there.
  await press("[data-order=pause]");
  await answered("frame.paused");
  clicks = 0;
  const headline = await page.textContent("#headline");
  counted("find out why it stands", /^Paused by the operator$|^(Waiting|Waiting for|Stopped)\b/.test(headline), headline);
  await press("[data-order=resume]");
  await answered("!frame.paused");
  clicks = 0;
  // 4. The proof of a day.
  await press("#days > summary");
  await page.waitForSelector("#day-table button");
  const [file] = await Promise.all([page.waitForEvent("download", {timeout: 60000}), press("#day-table button")]);
  const path = join(folder, "proof-" + how + ".pdf");
  await file.saveAs(path);
  counted("get the proof of a day as PDF", readFileSync(path).subarray(0, 5).toString() === "%PDF-", file.suggestedFilename());
  // 5. The robot is here.
  const before = await page.evaluate(() => frame.queue.answered);
  const pose = await page.evaluate(() => { const {inMap, turn} = mapFrame(); return [...inMap(frame.pose), frame.pose[2] + turn]; });
  await press("#locate");
  await drag([pose[0], pose[1]], [pose[0] + 1.5 * Math.cos(pose[2]), pose[1] + 1.5 * Math.sin(pose[2])]);
  counted("put the robot where it is", await answered("frame.queue.answered > " + before), await page.textContent("#note"));
  // Afterwards nothing is left of the areas.
  await page.evaluate(() => keepAreas([]));
  await answered("areas.length === 0");
  await context.close();
}

// A tab goes through everything that can be pressed, in order, and shows where it is.
async function tabs(browser, address) {
  const context = await fresh(browser, {viewport: {width: 1280, height: 900}, locale: "en-GB"});
  const page = await context.newPage();
  await page.goto(address);
  await ready(page);
  const all = await page.evaluate(() => [...document.querySelectorAll("button, select, input, summary, canvas[tabindex]")].filter(part => part.offsetParent && !part.disabled && !part.closest("details:not([open]) > :not(summary)")).length);
  const seen = new Set(), unmarked = [];
  for (let i = 0; i < all + 10; i++) {
    await page.keyboard.press("Tab");
    const at = await page.evaluate(() => { const part = document.activeElement, style = getComputedStyle(part); part.dataset.seen ||= ++window.counted || (window.counted = 1); return part === document.body ? null : [part.dataset.seen + part.tagName + "#" + part.id + ":" + (part.getAttribute("aria-label") || part.textContent || part.value).slice(0, 20), style.outlineStyle !== "none"]; });
    if (!at) break;
    if (!at[1]) unmarked.push(at[0]);
    seen.add(at[0]);
  }
  check("Tab reaches " + seen.size + " of " + all + " controls", seen.size >= all - 2);
  check("each shows that it has the focus", unmarked.length === 0, unmarked.join("; "));
  await context.close();
}

async function viewer(browser, address) {
  const context = await fresh(browser, {viewport: {width: 1280, height: 900}, locale: "en-GB"});
  const page = await context.newPage();
  await page.goto(address.split("#")[0]);
  await ready(page);
  const live = await page.evaluate(() => [...document.querySelectorAll("button")].filter(b => b.offsetParent && !b.disabled).map(b => b.textContent || b.ariaLabel));
  check("a viewer has no live button for the robot", !live.some(name => /Pause|Resume|Reset|^Start|Seen|Cancel|Remove|Draw|here/.test(name)), live.join(", "));
  const codes = await page.evaluate(async () => {
    const bodies = {"/order": {order: "pause"}, "/mission": {do: "cancel", place: 0}, "/areas": {areas: []}, "/acknowledge": {}};
    return Promise.all(Object.entries(bodies).map(async ([path, body]) => (await fetch(path, {method: "POST", headers: {"Content-Type": "application/json"}, body: JSON.stringify(body)})).status));
  });
  check("the server refuses a viewer", codes.every(code => code === 401), codes.join(" "));
  await context.close();
}

// Processor time that the browser has taken so far, all of its processes and threads, milliseconds.
function browserTime(pid) {
  const parents = new Map();
  for (const name of readdirSync("/proc").filter(name => /^\d+$/.test(name))) {
    try {
      const fields = readFileSync("/proc/" + name + "/stat", "utf8").replace(/^.*\) /s, "").split(" ");
      parents.set(+name, {parent: +fields[1], ticks: +fields[11] + +fields[12]});
    } catch { /* it has ended meanwhile */ }
  }
  const belongs = at => { for (let i = 0; i < 20 && at; i++) { if (at === pid) return true; at = parents.get(at)?.parent; } return false; };
  return [...parents].filter(([at]) => belongs(at)).reduce((sum, [, {ticks}]) => sum + 10 * ticks, 0);
}

// How long a picture takes with 100 people and a floor of 10,000 m²: the processor time of the page's drawing, in which nothing else
// of this computer counts, and beside it the time on the clock.
async function frames(browser, address) {
  const context = await fresh(browser, {viewport: {width: 1280, height: 900}});
  const page = await context.newPage();
  await page.goto(address);
  await ready(page);
  await page.evaluate(() => {
    window.crowd = structuredClone(frame);
    const n = 1000;
    crowd.people = Array.from({length: 100}, (_, i) => ({id: i, at_m: [i % 10 * 3, Math.floor(i / 10) * 3], velocity_mps: [1, 0.5], person: true}));
    crowd.mission.layers = 0;
    floor = {...floor, number: 1e9, width: n, height: n, resolution_m: 0.1, claimed: Array.from({length: 5000}, (_, i) => "200:" + "cad."[i % 4]).join(""), dirt: n * n + ":5"};
    plan = {...plan, width: n, height: n, resolution_m: 0.1, pixels: n * n + ":f"};
    // Nothing new comes while it is measured.
    window.fetch = () => new Promise(() => {});
    repaint(); whole();
    window.pictures_of = count => {
      const all = [], g = document.getElementById("map").getContext("2d");
      for (let i = 0; i < count; i++) {
        crowd.number += 1; crowd.people.forEach((person, at) => { person.at_m[0] += at % 2 ? 0.05 : -0.05; });
        const at = performance.now(); show(crowd); g.getImageData(0, 0, 1, 1); all.push(performance.now() - at);
      }
      return all.sort((a, b) => a - b);
    };
  });
  await page.waitForTimeout(1500);
  await page.evaluate(() => pictures_of(30));
  const pid = process.pid, count = 200, idleFrom = browserTime(pid), idleAt = Date.now();
  await page.waitForTimeout(1000);
  const idle = (browserTime(pid) - idleFrom) / (Date.now() - idleAt), from = browserTime(pid), at = Date.now();
  const times = await page.evaluate(count => pictures_of(count), count);
  const each = (browserTime(pid) - from - idle * (Date.now() - at)) / count;
  const [median, late] = [times[count / 2], times[Math.floor(0.95 * count)]].map(ms => ms.toFixed(1));
  check("a picture of 100 people on 10,000 m² in 16 ms", each <= 16, each.toFixed(1) + " ms of processor time with all threads of the browser, drawn without a graphics card; on the clock of this computer median " + median + " ms, 95 % " + late + " ms; " + load());
  await context.close();
}

async function ended(words) {
  const child = spawn(program, words, {stdio: ["ignore", "ignore", "pipe"]});
  let text = "";
  child.stderr.on("data", data => { text += data; });
  const code = await new Promise(done => child.on("exit", done));
  if (code > 1) throw new Error(words[0] + " ended with " + code + ": " + text.slice(-400));
}

// The guard of a robot in real time over real lines, alone and with two hundred browsers that read as fast as they can.
async function viewers() {
  // A computer that is shared pauses for tens of milliseconds now and then, with viewers or without: three runs of each, of which the middle counts.
  const late = {0: [], 200: []};
  for (const count of [0, 200, 0, 200, 0, 200]) {
    const words = ["simulate", "--scenario", "supermarket", "--seed", "2", "--duration", "20", "--real-io", "--emergency-stop", "12..13", "--panel", "127.0.0.1:0"];
    const child = spawn(program, [...words, "--json"], {stdio: ["ignore", "pipe", "pipe"]});
    let text = "", verdict = "", pictures = 0, over = false;
    child.stdout.on("data", data => { verdict += data; });
    const address = await new Promise((found, lost) => {
      child.stderr.on("data", data => { text += data; const hit = /panel: (http:[^#\s]+)#/.exec(text); if (hit) found(hit[1]); });
      child.on("exit", () => lost(new Error(text)));
    });
    const gone = new Promise(done => child.on("exit", done)).then(() => { over = true; });
    const agent = new Agent({keepAlive: true, maxSockets: 250});
    const ask = number => new Promise(done => get(address + "state?after=" + number, {agent}, answer => {
      let body = ""; answer.on("data", data => { body += data; }); answer.on("end", () => { pictures += 1; const hit = /"number":(\d+)/.exec(body); done(hit ? +hit[1] : number); });
    }).on("error", () => setTimeout(() => done(number), 200)));
    const watch = async () => { for (let number = 0; !over;) number = await ask(number); };
    for (let i = 0; i < count; i++) watch();
    await gone;
    agent.destroy();
    const hit = /guard ring: ([\d.]+) ms late in the middle, ([\d.]+) ms in 99.9 %.* ([\d.]+) ms at most/.exec(text);
    if (!hit) throw new Error(text.slice(-500));
    late[count].push({middle: +hit[1], nearly: +hit[2], most: +hit[3], stop: JSON.parse(verdict).stop_latency_ms.max, pictures});
    console.log("     " + count + " viewers: " + JSON.stringify(late[count].at(-1)));
  }
  // The guard's deadline for the drive is 20 ms; what a stop may take in all is measured by itself.
  const middle = (count, what) => late[count].map(run => run[what]).sort((a, b) => a - b)[1];
  check("two hundred viewers do not delay the guard", middle(200, "nearly") <= 10 && middle(200, "stop") <= 40, middle(200, "pictures") + " pictures in 20 s; 99.9 % of its timers at most " + middle(200, "nearly") + " ms late (" + middle(0, "nearly") + " without viewers), emergency stop to bus " + middle(200, "stop") + " ms (" + middle(0, "stop") + "); " + load());
}

// The pages that are written: axe, and text that fits, on a phone and a wide screen, light and dark; report and explanation in five languages.
async function reports(browser) {
  const at = name => join(folder, name), scene = ["--scenario", "supermarket", "--strategy", "guarantee", "--seed", "3"];
  await ended(["simulate", ...scene, "--duration", "40", "--report", at("simulated"), "--record", at("run.mcap"), "--emergency-stop", "20..25"]);
  await ended(["mission", "--map", "plain", "--dirt", "random:20%:8-20", "--trials", "1", "--out", at("mission-maps"), "--report", at("mission")]);
  const pages = [["simulate --report", at("simulated/index.html")], ["mission --report", at("mission/index.html")]];
  for (const code of ["en", "de", "fr", "it", "es"]) {
    await ended(["report", at("run.mcap"), "--language", code, "--out", at("report-" + code + ".html")]);
    await ended(["explain", at("run.mcap"), "--at", "20", "--language", code, "--out", at("incident-" + code + ".html")]);
    pages.push(["report " + code, at("report-" + code + ".html")], ["explain " + code, at("incident-" + code + ".html")]);
  }
  for (const [what, file] of pages) for (const [width, theme] of [[390, "light"], [1280, "dark"]]) {
    const context = await browser.newContext({viewport: {width, height: 844}, colorScheme: theme, locale: "en-GB"});
    const page = await context.newPage(), errors = [];
    page.on("pageerror", error => errors.push(error.message));
    await page.goto("file://" + file);
    await page.evaluate(() => document.querySelectorAll("details").forEach(part => { part.open = true; }));
    await axe(page, what + ", " + width + " px, " + theme);
    const out = await page.evaluate(clipped);
    check(what + " fits its window, " + width + " px", out.length === 0, out.slice(0, 4).join("; "));
    const paper = await page.evaluate(() => getComputedStyle(document.body).backgroundColor.match(/\d+/g).slice(0, 3).reduce((sum, part) => sum + +part, 0) / 3);
    check(what + " is " + theme, theme === "dark" ? paper < 60 : paper > 200, "its paper is " + paper.toFixed(0) + " of 255");
    check("no error in the page, " + what, errors.length === 0, errors.join("; "));
    await page.screenshot({path: join(shots, what.replaceAll(/\W+/g, "-") + "-" + width + ".png"), fullPage: true});
    await context.close();
  }
}

const records = join(folder, "records.json");
const {child, address} = begin(records);
let browser;
try {
  const where = await address;
  browser = await browserType.launch({executablePath: chromium, args: ["--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking"]});
  const only = process.env.PANEL_CHECK || "";
  const parts = {layouts: () => layouts(browser, where), mouse: () => tasks(browser, where, "mouse"), touch: () => tasks(browser, where, "touch"), keyboard: () => tasks(browser, where, "keyboard"), tabs: () => tabs(browser, where), viewer: () => viewer(browser, where), frames: () => frames(browser, where), reports: () => reports(browser), viewers};
  for (const [name, part] of Object.entries(parts)) {
    if (only && !only.split(",").includes(name)) continue;
    try { await part(); } catch (error) { check(name + " went through", false, String(error).split("\n").slice(0, 3).join(" ")); }
  }
} finally {
  if (browser) await browser.close();
  child.kill();
}
writeFileSync(join(folder, "result.txt"), checks - failed + " of " + checks + "\n");
console.log(checks + " checks, " + failed + " failed; pictures in " + shots);
process.exit(failed ? 1 : 0);
