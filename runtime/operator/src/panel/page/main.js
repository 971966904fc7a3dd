function note(words) { $("note").textContent = words; }

// Sends an order; says what came of it.
async function send(address, what, words) {
  try {
    const answer = await fetch(address, {method: "POST", headers: {...headers, "Content-Type": "application/json"}, body: JSON.stringify(what)});
    note(answer.ok ? "" : t(await answer.text()));
    if (answer.ok && words) $("live").textContent = words;
    return answer.ok;
  } catch { note(t("the robot's program does not answer")); return false; }
}

document.querySelectorAll("[data-layer]").forEach(box => box.onchange = () => { shown[box.dataset.layer] = box.checked; draw(); });
document.querySelectorAll("[data-order]").forEach(button => button.onclick = () => send("/order", {order: button.dataset.order}));
$("language").onchange = () => { try { localStorage.setItem("language", $("language").value); } catch { /* this browser keeps nothing */ } speak($("language").value); };
document.addEventListener("language", () => { if (frame) show(frame); showRecords(); });

function kept() { try { return localStorage.getItem("language"); } catch { return null; } }

(async () => {
  readColours();
  speak(kept() || (navigator.language || "en").slice(0, 2));
  try { const answer = await fetch("/role", {headers}); if (answer.ok) role = await answer.json(); } catch { /* it stays a viewer */ }
  $("orders").hidden = role === "viewer"; $("viewer").hidden = role !== "viewer";
  for (;;) {
    try {
      const answer = await fetch("/state?after=" + (frame ? frame.number : 0), {headers});
      if (!answer.ok) throw new Error(await answer.text());
      const next = await answer.json();
      const isFirst = !frame || !frame.mission;
      if (next.number) show(next);
      // Seconds that are counted are fetched seldom, everything else with the next picture.
      if (frame && !fetching && frame.records !== records.number && Date.now() - fetchedAt > 2000) fetchRecords();
      else if (isFirst && frame) showRecords();
    } catch (error) {
      $("state").textContent = t("no connection"); $("state").className = "";
      await new Promise(done => setTimeout(done, 1000));
    }
  }
})();
