
const slide = document.querySelector(".slide input"), shown = document.querySelector(".slide output"), now = document.getElementById("now");
const number = (value, digits) => value.toLocaleString(document.documentElement.lang, {minimumFractionDigits: digits, maximumFractionDigits: digits});
const LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._";
// Metres ahead and to the left, in pixels of the moment's picture: five metres to each side, the robot's front is up.
const near = (x, y) => (150 - 30 * y).toFixed(1) + " " + (195 - 30 * x).toFixed(1);
function area(corners, fill) {
  let path = "";
  for (let k = 0; k < corners.length; k += 2) path += (k ? "L" : "M") + near(corners[k] / 100, corners[k + 1] / 100);
  return corners.length > 4 ? `<path d="${path}z" fill="${fill}" opacity=".7"/>` : "";
}
function around([, x, y, turn, , people, fields, seen]) {
  let svg = '<rect width="100%" height="100%" fill="#fff" stroke="#d8dee5"/>', dots = "";
  if (fields >= 0) svg += area(FIELDS[fields][1], "#f4d58d") + area(FIELDS[fields][0], "#f1a9a0");
  svg += BODY.length ? area(BODY, "#0b5394") : `<path d="M${near(0.4, 0)}L${near(-0.3, 0.25)}L${near(-0.3, -0.25)}z" fill="#0b5394"/>`;
  for (let k = 0; k < seen.length; k++) if (seen[k] !== "-") {
    const far = LETTERS.indexOf(seen[k]) / 10, angle = ((k + 0.5) / seen.length - 0.5) * 2 * Math.PI;
    dots += "M" + near(far * Math.cos(angle), far * Math.sin(angle)) + "h0";
  }
  svg += `<path d="${dots}" stroke="#1c2733" stroke-width="4" stroke-linecap="round"/>`;
  const heading = -turn * Math.PI / 180, c = Math.cos(heading), s = Math.sin(heading);
  for (let k = 0; k < people.length; k += 3) {
    const dx = (people[k] - x) / PX, dy = (y - people[k + 1]) / PX, ahead = c * dx + s * dy, left = c * dy - s * dx;
    if (Math.abs(ahead) > 7 || Math.abs(left) > 5.5) continue;
    const [px, py] = near(ahead, left).split(" ");
    svg += `<circle cx="${px}" cy="${py}" r="9" fill="#b34700"/><text x="${px}" y="${+py + 4}" font-size="10" fill="#fff" text-anchor="middle">${people[k + 2]}</text>`;
  }
  document.getElementById("close").innerHTML = svg + '<path d="M10 290h60" stroke="#1c2733" stroke-width="2"/><text x="10" y="283" font-size="12">2 m</text>';
}
function at(i) {
  const moment = MOMENTS[i], [t, x, y, turn, v, people] = moment;
  let svg = `<g transform="translate(${x} ${y}) rotate(${turn})"><path d="M-12 -9H8L18 0L8 9H-12z" fill="#0b5394" stroke="#fff" stroke-width="2"/></g>`;
  for (let k = 0; k < people.length; k += 3) svg += `<circle cx="${people[k]}" cy="${people[k + 1]}" r="9" fill="#b34700" stroke="#fff" stroke-width="2"/>`;
  now.innerHTML = svg;
  around(moment);
  let held = "";
  for (const [from, cause] of STOPS) if (from <= t) held = cause;
  shown.textContent = number(t, 1) + " s, " + number(v, 2) + " m/s" + (Math.abs(v) < 0.02 && held ? ", " + LAST.replace("{}", held) : "");
  slide.setAttribute("aria-valuetext", shown.textContent);
}
slide.max = MOMENTS.length - 1;
slide.oninput = () => at(+slide.value);
at(0);
