// In place of the robot's program: every question has one answer, kept in a file; orders are refused. The language stands in the
// address, the clock stands still.
const ANSWERS = /*answers*/;
const wanted = new URLSearchParams(location.search);
Object.defineProperty(navigator, "language", {get: () => wanted.get("language") || "en"});
Object.defineProperty(window, "localStorage", {get: () => { throw new Error("nothing is kept"); }});
let answeredStates = 0;
window.fetch = address => {
  const path = address.split("?")[0], answer = ANSWERS[path];
  if (path === "/state" && answeredStates++) return new Promise(() => {});
  return Promise.resolve({ok: answer !== undefined, text: () => Promise.resolve("no"), json: () => Promise.resolve(structuredClone(answer))});
};
// Text that does not fit where it stands, and what is wider than the window.
function misfits() {
  const out = [];
  for (const part of document.querySelectorAll("button, summary, h2, label, legend, p, li, td, th, b, a, small, #state, select, input")) {
    if (!part.offsetParent || part.closest(".unseen")) continue;
    const what = part.tagName + " " + (part.textContent || part.id).slice(0, 40);
    if (part.scrollWidth > part.clientWidth + 1 && getComputedStyle(part).overflowX !== "visible" && part.id !== "title") out.push("clipped " + what);
    const box = part.getBoundingClientRect();
    if ((box.right > innerWidth + 1 || box.left < -1) && !part.closest(".wide")) out.push("outside " + what);
  }
  if (document.documentElement.scrollWidth > innerWidth) out.push("page is " + document.documentElement.scrollWidth + " wide");
  // Words and numbers that go on in the next line.
  const range = document.createRange();
  for (const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT); walker.nextNode();) {
    const text = walker.currentNode;
    if (!text.parentElement.offsetParent || text.parentElement.closest(".unseen, script, style, option")) continue;
    for (const hit of text.data.matchAll(/[^\s\-\/]+/g)) {
      range.setStart(text, hit.index); range.setEnd(text, hit.index + hit[0].length);
      if (new Set([...range.getClientRects()].map(box => Math.round(box.top))).size > 1) out.push("broken " + hit[0]);
    }
  }
  const english = [...document.querySelectorAll("[data-t]")].filter(part => language !== "en" && !TABLE.has(part.dataset.t));
  return [...out, ...english.map(part => "not translated: " + part.dataset.t)];
}
addEventListener("load", () => setTimeout(() => {
  if (wanted.get("open")) document.querySelectorAll("details").forEach(part => { part.open = true; });
  acts.whole();
  setTimeout(() => parent.postMessage({name: location.search, out: frame ? misfits() : ["no picture was shown"]}, "*"), 150);
}, 300));
