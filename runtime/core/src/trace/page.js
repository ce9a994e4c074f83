"use strict";
addEventListener("DOMContentLoaded", () => {
const $ = (s) => document.querySelector(s);
const canvas = $("canvas"), c = canvas.getContext("2d");
function fields(line) {
  const out = [];
  for (const m of line.matchAll(/(?:^|,)(?:"((?:[^"]|"")*)"|([^,]*))/g)) out.push(m[1] === undefined ? m[2] : m[1].replace(/""/g, '"'));
  return out;
}
const lines = $("#samples").textContent.replace(/&lt;/g, "<").split(/\r?\n/).filter((l) => l.trim());
const header = fields(lines[0] ?? ""), at = header.indexOf("time_ms");
const kept = header.map((n, i) => i).filter((i) => i !== at && header[i] !== "cycle");
// A name in quotes has any words: "Pump in use".
const heads = kept.map((i) => /^([^]*) in ([^"]*)$/.exec(header[i]) ?? [, header[i], ""]);
const units = heads.map((h) => h[2]);
const columns = heads.map((h) => h[1].replace(/ as \w+$/, ""));
// The last line may still be written.
const rows = lines.slice(1).map(fields).filter((r) => r.length === header.length).map((r) => [Number(r[at]), kept.map((i) => r[i])]);
if (!rows.length) { $("#cursors").textContent = "no samples"; return; }
const times = rows.map((r) => r[0]);
const number = (t) => {
  let m = /^16#([0-9A-F_]+)$/i.exec(t);
  if (m) { const n = parseInt(m[1].replace(/_/g, ""), 16); return m[1].length === 4 ? (n << 16) >> 16 : n; }
  m = /^(?:L?T|S5T)#(-?)(.*)$/.exec(t);
  if (m) {
    let s = 0;
    for (const [, n, u] of m[2].matchAll(/([\d.]+)(ms|us|ns|d|h|m|s)/g)) s += n * { d: 86400, h: 3600, m: 60, s: 1, ms: 1e-3, us: 1e-6, ns: 1e-9 }[u];
    return m[1] ? -s : s;
  }
  const n = Number(t);
  return t === "" || Number.isNaN(n) ? null : n;
};
const signals = columns.map((name, i) => {
  const texts = rows.map((r) => r[1][i]), values = texts.map(number);
  const bit = !units[i] && texts.every((t) => t === "0" || t === "1");
  const known = values.filter((v) => v !== null);
  let low = Infinity, high = -Infinity;
  for (const v of known) { low = Math.min(low, v); high = Math.max(high, v); }
  const unit = texts.some((t) => /^(?:L?T|S5T)#/.test(t)) ? " s" : "";
  return { name: name + (units[i] ? " in " + units[i] : ""), texts, values, bit, text: !known.length, low, high, unit };
});
// On a small screen there is less room for names.
const RIGHT = 20, TOP = 26;
let LEFT = 190;
let from = times[0], to = Math.max(times[times.length - 1], from + 1), cursors = [null, null], wanted = "";
const shown = () => signals.filter((s) => s.name.toLowerCase().includes(wanted));
const height = (s) => (s.bit || s.text ? 26 : 90);
const isDark = matchMedia("(prefers-color-scheme:dark)");
const color = (name) => getComputedStyle(document.documentElement).getPropertyValue(name);
const X = (t) => LEFT + ((t - from) / (to - from)) * (canvas.clientWidth - LEFT - RIGHT);
const T = (x) => from + ((x - LEFT) / (canvas.clientWidth - LEFT - RIGHT)) * (to - from);
const row = (t) => { let a = 0, b = times.length; while (a < b) { const m = (a + b) >> 1; if (times[m] <= t) a = m + 1; else b = m; } return Math.max(0, a - 1); };
function step(span) { const raw = span / Math.max(2, Math.min(8, (canvas.clientWidth - LEFT) / 70)), base = 10 ** Math.floor(Math.log10(raw)); return [1, 2, 5, 10].map((f) => f * base).find((s) => s >= raw); }
function draw() {
  const list = shown(), ratio = devicePixelRatio || 1;
  const total = TOP + list.reduce((h, s) => h + height(s) + 6, 0) + 10, width = canvas.clientWidth;
  LEFT = Math.min(190, Math.round(width * 0.3));
  const letters = Math.floor((LEFT - 8) / 6.5);
  canvas.style.height = total + "px";
  canvas.width = width * ratio; canvas.height = total * ratio;
  c.setTransform(ratio, 0, 0, ratio, 0, 0);
  c.clearRect(0, 0, width, total);
  c.font = "11px monospace";
  const muted = color("--muted"), ink = color("--text"), line = color("--line");
  const s = step(to - from);
  c.fillStyle = muted; c.strokeStyle = line;
  for (let t = Math.ceil(from / s) * s; t <= to; t += s) {
    c.beginPath(); c.moveTo(X(t), TOP - 8); c.lineTo(X(t), total); c.stroke();
    c.textAlign = "center"; c.fillText(+(t / 1000).toFixed(6) + " s", X(t), 12);
  }
  let y = TOP;
  const first = Math.max(0, row(from)), last = Math.min(times.length - 1, row(to) + 1);
  list.forEach((g, k) => {
    const h = height(g);
    c.fillStyle = ink; c.textAlign = "right";
    c.fillText(g.name.length > letters ? g.name.slice(0, letters - 1) + "…" : g.name, LEFT - 8, y + Math.min(h / 2, 20) + 4);
    c.save(); c.beginPath(); c.rect(LEFT, y - 2, width - LEFT - RIGHT, h + 4); c.clip();
    c.strokeStyle = c.fillStyle = `hsl(${(k * 67 + 210) % 360} 65% ${isDark.matches ? 66 : 42}%)`; c.lineWidth = 1.5;
    if (g.text) {
      c.textAlign = "left";
      for (let i = first; i <= last; i++) if (i === first || g.texts[i] !== g.texts[i - 1]) { c.fillText(g.texts[i], Math.max(X(times[i]), LEFT) + 3, y + 17); c.fillRect(X(times[i]), y + 4, 1, 18); }
    } else {
      // A number that never changes is drawn in the middle.
      const same = !g.bit && g.low === g.high, room = same ? Math.max(0.5, Math.abs(g.low) / 1e6) : 0;
      const low = g.bit ? 0 : g.low - room, high = g.bit ? 1 : g.high + room, span = high - low;
      const Y = (v) => y + h - 4 - ((v - low) / span) * (h - 8);
      c.beginPath();
      let pen = false, before = null;
      for (let i = first; i <= last; i++) {
        const v = g.values[i];
        if (v === null) { pen = false; continue; }
        const x = X(times[i]);
        if (!pen) c.moveTo(x, Y(v)); else { c.lineTo(x, Y(before)); c.lineTo(x, Y(v)); }
        pen = true; before = v;
      }
      if (pen) c.lineTo(X(to), Y(before));
      c.stroke();
      if (g.bit) { c.globalAlpha = 0.2; for (let i = first; i <= last; i++) if (g.values[i] === 1) c.fillRect(X(times[i]), y + 4, X(i + 1 < times.length ? times[i + 1] : to) - X(times[i]), h - 8); c.globalAlpha = 1; }
      else {
        const text = (v) => +v.toPrecision(6) + g.unit;
        c.fillStyle = muted; c.textAlign = "left";
        if (same) c.fillText(text(g.low), LEFT + 4, Y(g.low) - 4);
        else { c.fillText(text(g.high), LEFT + 4, y + 10); c.fillText(text(g.low), LEFT + 4, y + h - 2); }
      }
    }
    c.restore();
    y += h + 6;
  });
  cursors.forEach((t, k) => {
    if (t === null) return;
    c.strokeStyle = k ? "#d33" : "#07c"; c.beginPath(); c.moveTo(X(t), TOP - 8); c.lineTo(X(t), total); c.stroke();
    c.fillStyle = c.strokeStyle; c.textAlign = "left"; c.fillText("AB"[k], X(t) + 3, TOP);
    let yy = TOP;
    for (const g of list) { c.fillText(g.texts[row(t)], X(t) + 3, yy + height(g) / 2 + (k ? 14 : 3)); yy += height(g) + 6; }
  });
  const sec = (t) => (t / 1000).toFixed(3) + " s";
  $("#cursors").textContent = cursors.map((t, k) => (t === null ? "" : "AB"[k] + " " + sec(t))).filter(Boolean).join("   ") + (cursors.every((t) => t !== null) ? "   B − A " + sec(cursors[1] - cursors[0]) : "");
}
canvas.onwheel = (e) => {
  if (e.offsetX < LEFT) return;
  e.preventDefault();
  const t = T(e.offsetX), f = e.deltaY > 0 ? 1.25 : 0.8;
  from = t - (t - from) * f; to = t + (to - t) * f;
  draw();
};
let drag = null;
canvas.onmousedown = (e) => (drag = { x: e.offsetX, from, to, moved: false });
onmousemove = (e) => {
  if (!drag) return;
  const d = e.clientX - canvas.getBoundingClientRect().left - drag.x;
  if (Math.abs(d) > 3) drag.moved = true;
  if (drag.moved) { const dt = (d / (canvas.clientWidth - LEFT - RIGHT)) * (drag.to - drag.from); from = drag.from - dt; to = drag.to - dt; draw(); }
};
onmouseup = (e) => {
  if (drag && !drag.moved && e.target === canvas && e.offsetX >= LEFT) { cursors[e.shiftKey ? 1 : 0] = times[row(T(e.offsetX))]; draw(); }
  drag = null;
};
canvas.ondblclick = () => { from = times[0]; to = Math.max(times[times.length - 1], from + 1); cursors = [null, null]; draw(); };
$("#search").oninput = (e) => { wanted = e.target.value.toLowerCase(); draw(); };
onresize = draw;
isDark.onchange = draw;
draw();
});
