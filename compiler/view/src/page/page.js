"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const $ = (s) => document.querySelector(s);
const main = $("main"), list = $("#list");
const esc = (t) => String(t).replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c]);
const fold = (t) => String(t).toLowerCase().replace(/["#%\s]/g, "");
const byName = new Map();
data.pages.forEach((p, i) => [p.id, p.name].forEach((n) => n && !byName.has(fold(n)) && byName.set(fold(n), i)));
const symbolOf = new Map(data.symbols), addressOf = new Map(data.symbols.map(([a, n]) => [fold(n), a]));
// Reference data, as `plcc xref` has them; a program with errors has none.
const xref = data.xref, cross = new Map((xref?.operands ?? []).map((o) => [o.address, o]));
const called = new Map((xref?.structure.blocks ?? []).map((b) => [b.block, b]));
const pageOf = (block, name) => byName.get(fold(block)) ?? (name ? byName.get(fold(name)) : undefined);
// A link to a network of a block.
function linkTo(text, block, name, network) {
  const i = pageOf(block, name);
  if (i === undefined) return `<span>${text}</span>`;
  const k = network ? data.pages[i].secs.findIndex((s) => s.n === network) : -1;
  return `<a href="#" data-page="${i}"${k < 0 ? "" : ` data-sec="${k}"`}>${text}</a>`;
}
$("h1").textContent = data.title;
// The symbol of a block, beside its number. A data type without a number has its name already: `UDT Recipe`.
const symbolBeside = (p) => (p.id === p.name || p.id === `UDT ${p.name}` ? "" : p.name);

// Code as coloured text.
const WORDS = { scl: /^(IF|THEN|ELSIF|ELSE|END_IF|CASE|OF|END_CASE|FOR|TO|BY|DO|END_FOR|WHILE|END_WHILE|REPEAT|UNTIL|END_REPEAT|RETURN|EXIT|CONTINUE|GOTO|AND|OR|XOR|NOT|MOD|DIV|TRUE|FALSE|REGION|END_REGION|CALL)$/i };
const TOKEN = /(\/\/.*|\(\*[\s\S]*?\*\))|("[^"\n]*"(?:\.(?:"[^"\n]*"|[\w\[\]]+))*|#[\w"][\w."\[\]]*)|('[^'\n]*')|([A-Z_]+#[\w.#:+-]+|\b\d[\w.#]*)|(%?(?:P[IQEA]|[IQEAM])[BWD]?[ \t]+\d+(?:\.[0-7])?)|(%?[A-Za-z_]\w*(?:\.\w+)*)/g;
// An address of STL as the reference data have it: without blanks, in the international mnemonics.
const plainAddress = (text) => text.replace(/[\s%]/g, "").replace(/^(P?)E/, "$1I").replace(/^(P?)A/, "$1Q");
function coloured(text, kind) {
  let out = "", at = 0, first = true;
  for (const m of text.matchAll(TOKEN)) {
    const gap = text.slice(at, m.index);
    if (gap.includes("\n")) first = true;
    // A mnemonic of signs, `=` or `==`, is followed by its operand; in `+I` the letter belongs to it.
    if (kind === "stl" && /[=+*/<>-]\s+$/.test(gap)) first = false;
    out += esc(gap);
    at = m.index + m[0].length;
    const t = esc(m[0]);
    if (m[1]) out += `<span class="cm">${t}</span>`;
    else if (m[2]) out += `<span class="id" data-k="${t}">${t}</span>`;
    else if (m[3]) out += `<span class="st">${t}</span>`;
    else if (m[4]) out += `<span class="nu">${t}</span>`;
    else if (m[5]) out += `<span class="id" data-k="${plainAddress(t)}">${t}</span>`;
    else if (kind === "stl" ? first && !/^\s*:/.test(text.slice(at, at + 40)) : WORDS.scl.test(m[0])) out += `<span class="kw">${t}</span>`;
    else out += `<span class="id" data-k="${t}">${t}</span>`;
    if (!m[1] && !(kind === "stl" && text[at] === ":")) first = false;
  }
  return out + esc(text.slice(at));
}

// One block. Networks are drawn when they come into sight.
const seen = new IntersectionObserver((entries) => {
  for (const e of entries) if (e.isIntersecting) { fill(e.target); seen.unobserve(e.target); }
}, { root: main, rootMargin: "600px" });
function fill(div) {
  if (div.done) return;
  div.done = true;
  const s = data.pages[div.dataset.page].secs[div.dataset.sec];
  div.parts = div.steps = div.rows = null;
  if (isWatched(div) && (s.svg === undefined || s.code)) fillLines(div, s);
  else if (s.svg !== undefined) div.innerHTML = s.svg;
  else div.innerHTML = `<pre>${coloured(s.text, s.kind)}</pre>`;
  div.style.minHeight = "";
  link(div);
  if (forced.length) markForced(div);
  if (isWatched(div)) look(div);
  else if (shown) paint(div, s);
  marked(div);
}
function link(div) {
  for (const t of div.querySelectorAll("text.t")) if (byName.has(fold(t.textContent))) t.classList.add("go");
}
function callers(i) {
  const list = data.pages[i].callers;
  return list ? "called by " + list.map((c) => `<span class="go" data-page="${c}">${esc(data.pages[c].id)}</span>`).join(", ") : "";
}
function html(i) {
  const p = data.pages[i];
  let h = `<div class="page"><h2>${esc(p.id)} ${esc(symbolBeside(p))} <small>${p.lang} ${esc(p.title)}</small></h2>`;
  if (p.comment) h += `<div class="comment">${esc(p.comment)}</div>`;
  h += `<div class="reason callers">${callers(i)}</div>`;
  if (p.rows.length) {
    const code = p.rows.some((r) => r[0]);
    h += `<details ${code && p.secs.length ? "" : "open"}><summary>${code ? "Interface" : "Components"} (${p.rows.length})</summary><table><thead><tr>${code ? "<th></th>" : ""}<th>Name</th><th>Type</th><th>Address</th><th>Initial value</th><th>Comment</th></tr></thead>`;
    let last = "";
    for (const [sec, name, ty, init, com, addr, depth] of p.rows) {
      h += `<tr>${code ? `<td>${sec === last ? "" : sec}</td>` : ""}<td style="padding-left:${8 + depth * 14}px">${esc(name)}</td><td>${esc(ty)}</td><td${addr && addr[0] !== "L" ? ` data-k="${esc(addr)}"` : ""}>${esc(addr)}</td><td>${esc(init)}</td><td>${esc(com)}</td></tr>`;
      last = sec;
    }
    h += "</table></details>";
  }
  p.secs.forEach((s, k) => {
    h += `<section id="s${i}-${k}">`;
    if (s.n || s.title) h += `<h3>${s.n ? `Network ${s.n}` : ""}${s.n && s.title ? ": " : ""}${esc(s.title)}</h3>`;
    if (s.labels.length) h += `<div class="reason">${s.labels.map(esc).join(", ")}:</div>`;
    if (s.comment) h += `<div class="comment">${esc(s.comment)}</div>`;
    if (s.reason) h += `<div class="reason">${esc(s.reason)}</div>`;
    h += `<div class="draw" data-page="${i}" data-sec="${k}" style="min-height:${s.h || 17 * (1 + (s.text || "").split("\n").length)}px"></div></section>`;
  });
  return h + "</div>";
}
let here = -1;
function go(i, k) {
  here = i;
  main.innerHTML = html(i);
  main.scrollTop = 0;
  for (const d of main.querySelectorAll(".draw")) seen.observe(d);
  for (const a of list.querySelectorAll("a[data-page]")) a.classList.toggle("here", +a.dataset.page === i && a.dataset.sec === undefined);
  if (k !== undefined) {
    const s = document.getElementById(`s${i}-${k}`);
    if (s) { fill(s.querySelector(".draw")); s.scrollIntoView(); s.classList.add("found"); setTimeout(() => s.classList.remove("found"), 1500); }
  }
  const hash = "#" + data.pages[i].id.replace(/ /g, "") + (k !== undefined ? "/" + k : "");
  if (location.hash !== hash) history.pushState(null, "", hash);
}
function fromHash() {
  const [id, k] = decodeURIComponent(location.hash.slice(1)).split("/");
  const i = byName.get(fold(id));
  if (i !== undefined) go(i, k === undefined ? undefined : +k);
  else if (Object.hasOwn(VIEWS, id)) VIEWS[id][1]();
  return i !== undefined || Object.hasOwn(VIEWS, id);
}
addEventListener("popstate", fromHash);

// The list, and the search.
const plain = (s) => (s.plain ??= (s.text ?? s.svg.replace(/<text[^>]*>([^<]*)<\/text>/g, "\u0001$1\u0001").replace(/(^|\u0001)[^\u0001]*(\u0001|$)/g, (m) => m)
  .split("\u0001").filter((t, i) => i % 2).join(" ").replace(/&lt;/g, "<").replace(/&gt;/g, ">").replace(/&quot;/g, '"').replace(/&amp;/g, "&")) + " " + s.title + " " + s.comment);
const low = (s) => (s.low ??= plain(s).toLowerCase());
let query = "";
function show(text) {
  query = text.trim().toLowerCase();
  let h = "";
  if (!query) h += `<h4>Program</h4>${Object.entries(VIEWS).map(([view, [title]]) => `<a href="#${view}" data-view="${view}">${title}</a>`).join("")}<h4>Blocks</h4>`;
  let hits = 0;
  data.pages.forEach((p, i) => {
    const own = (p.id + " " + p.id.replace(/ /g, "") + " " + p.name + " " + p.title).toLowerCase().includes(query);
    let inner = "";
    if (query) p.secs.forEach((s, k) => {
      if (hits > 400) return;
      const at = low(s).indexOf(query);
      if (at < 0) return;
      hits++;
      inner += `<a class="hit" href="#" data-page="${i}" data-sec="${k}">${s.n ? "Network " + s.n + ": " : ""}${esc(plain(s).slice(Math.max(0, at - 12), at + 40))}</a>`;
    });
    if (query && p.rows.some((r) => (r[1] + " " + r[4]).toLowerCase().includes(query))) inner += `<a class="hit" href="#" data-page="${i}">in its declarations</a>`;
    if (own || inner) h += `<a href="#" data-page="${i}" title="${esc(p.title)}"><b>${esc(p.id)}</b>${esc(symbolBeside(p))}<i>${p.lang}</i></a>${inner}`;
  });
  list.innerHTML = h || "<h4>nothing found</h4>";
}
function marked(div) {
  if (!query) return;
  for (const t of div.querySelectorAll("text,span")) if (t.textContent.toLowerCase().includes(query)) t.style.textDecoration = "underline 2px #e0a800";
}
let pause;
$("#search").oninput = (e) => { clearTimeout(pause); pause = setTimeout(() => show(e.target.value), 80); };
addEventListener("keydown", (e) => {
  if (e.key === "/" && e.target.tagName !== "INPUT") { e.preventDefault(); $("#search").focus(); }
  if (e.key === "Escape") $("#uses").hidden = true;
});

// Uses of an operand, also of addresses that overlap.
function range(key) {
  let m = /^(DB\d+)\.DB([XBWDL])(\d+)(?:\.(\d))?$/.exec(key) ?? /^(P?[IQ]|SM|A[IQ]|[MVLS])([BWDL]?)(\d+)(?:\.(\d))?$/.exec(key);
  if (!m) return null;
  const bits = { X: 1, "": 1, B: 8, W: 16, D: 32, L: 64 }[m[2]];
  const from = m[3] * 8 + (bits === 1 ? +(m[4] ?? 0) : 0);
  return [m[1], from, from + bits];
}
const isUsed = (k) => cross.has(k) || data.uses[k] !== undefined;
const ranges = [...cross.keys(), ...Object.keys(data.uses)].map((k) => [k, range(k)]).filter((r) => r[1]);
// Addresses by names of components of data blocks: those that the program uses, and those on the pages of the blocks.
const memberOf = new Map();
// The variables that an address of a data block is, as the uses of their function blocks have them: "FB 1#n". The data block may be an
// instance, and have instances in it.
const variablesOf = new Map();
const blockOf = (type) => { const p = data.pages[byName.get(fold(type))]; return p && /^FB /.test(p.id) ? p.id : undefined; };
// By address, the name with which a value is shown in its type.
const typedName = new Map(data.symbols.map(([address, name]) => [address, `"${name}"`]));
for (const p of data.pages) if (/^DB \d+$/.test(p.id)) {
  const path = [], blocks = [], own = blockOf(/^Type: (.*)$/m.exec(p.comment)?.[1]);
  p.rows.forEach(([, name, type, , , address, depth], i) => {
    path.length = blocks.length = depth;
    path.push(name);
    const variables = [own, ...blocks].flatMap((block, at) => (block ? [`${block}#${path.slice(at).join(".")}`] : []));
    if (address && variables.length) variablesOf.set(address, [...(variablesOf.get(address) ?? []), ...variables]);
    blocks.push(blockOf(type));
    for (const db of [p.name, p.id]) if (db && address) memberOf.set(fold(`${db}.${path.join(".")}`), address);
    const hasParts = p.rows[i + 1]?.[6] > depth || /^ARRAY/.test(type);
    if (address && !hasParts) typedName.set(address, [p.name ? `"${p.name}"` : p.id.replace(" ", ""), ...path.map((part) => `"${part}"`)].join("."));
  });
}
for (const o of xref?.operands ?? []) if (o.symbol) memberOf.set(fold(o.symbol), o.address);
function keyOf(text) {
  const t = text.replace(/^%/, "");
  if (isUsed(t)) return t;
  const upper = t.replace(/\s/g, "").toUpperCase();
  if (isUsed(upper)) return upper;
  const address = addressOf.get(fold(t));
  if (address) return address;
  // An index that is a variable may mean any element of an array.
  const member = memberOf.get(fold(t)) ?? memberOf.get(fold(t).replace(/\[[^\]]*\]/g, "[*]"));
  if (member) return member;
  const local = here >= 0 ? data.pages[here].id + (t.startsWith("#") ? t : "#" + t) : t;
  return data.uses[local] ? local : t;
}
const HOW = { r: "reads", w: "writes", c: "calls", R: "reads", W: "writes", RW: "reads and writes", "?": "passes on", call: "calls", open: "opens" };
const idOf = (u) => data.pages[pageOf(u.block, u.block_name)]?.id ?? u.block;
const crossUse = (u) => linkTo(`${esc(idOf(u))}${u.network ? ", network " + u.network : ""}: ${HOW[u.access]}${u.statement ? ` <code>${esc(u.statement)}</code>` : ""}`, u.block, u.block_name, u.network);
function uses(text, name = text) {
  // A slice uses its variable.
  text = text.replace(/^([TC]\d+)\.VALUE$/, "$1").replace(/\.(%[XBWD]\d+)?$/i, "");
  const i = byName.get(fold(text));
  if (i !== undefined) return go(i);
  const key = keyOf(text), r = range(key), how = HOW;
  const rows = (k) => (cross.get(k)?.uses ?? []).map(crossUse).join("") + (data.uses[k] ?? []).map(([p, s, h]) => `<a data-page="${p}" data-sec="${s}">${esc(data.pages[p].id)}${data.pages[p].secs[s].n ? ", network " + data.pages[p].secs[s].n : ""}: ${how[h]}</a>`).join("");
  let h = `<span class="x">✕</span><b>${esc(symbolOf.get(key) || cross.get(key)?.symbol || name)}</b> ${esc(key.replace(/^[A-Z]+ \d+#/, "#"))}${rows(key)}`;
  const variables = (variablesOf.get(key) ?? []).filter((k) => data.uses[k]);
  h += variables.map(rows).join("");
  if (r) for (const [k, o] of ranges) if (k !== key && o[0] === r[0] && o[1] < r[2] && r[1] < o[2]) h += `<br><b>overlaps ${esc(k)}</b> ${esc(symbolOf.get(k) ?? "")}${rows(k)}`;
  if (!isUsed(key) && !variables.length) h += "<br>no uses";
  $("#uses").innerHTML = h;
  $("#uses").hidden = false;
}
addEventListener("click", (e) => {
  const t = e.target.closest("[data-page],[data-view],[data-k],.go,.x");
  if (!t || t.classList.contains("draw")) return;
  if (t.classList.contains("x") && t.closest("aside")) return void ($("#uses").hidden = true);
  if (t.dataset.view) { e.preventDefault(); return VIEWS[t.dataset.view][1](); }
  if (t.dataset.page !== undefined) { e.preventDefault(); return go(+t.dataset.page, t.dataset.sec === undefined ? undefined : +t.dataset.sec); }
  if (t.dataset.k) return uses(t.dataset.k, t.textContent.startsWith("#") ? t.textContent : t.dataset.k);
  if (t.classList.contains("go")) return go(byName.get(fold(t.textContent)));
});

// Views of the whole program.
function head(title, hash) { here = -1; if (location.hash !== hash) history.pushState(null, "", hash); main.scrollTop = 0; return `<div class="page"><h2>${title}</h2>`; }
function addresses() {
  if (xref) return references();
  const keys = new Set([...data.symbols.map((s) => s[0]), ...Object.keys(data.uses).filter((k) => range(k) || /^[TC]\d+$/.test(k))]);
  const order = (k) => { const r = range(k); return r ? [r[0], r[1]] : [k.replace(/\d+/, ""), +(/\d+/.exec(k) ?? 0)]; };
  const rows = [...keys].map((k) => [order(k), k]).sort((a, b) => (a[0][0] < b[0][0] ? -1 : a[0][0] > b[0][0] ? 1 : a[0][1] - b[0][1]));
  main.innerHTML = head("Addresses and symbols", "#addresses") + "<table><tr><th>Address</th><th>Symbol</th><th>Uses</th></tr>" +
    rows.map(([, k]) => `<tr><td data-k="${esc(k)}">${esc(k)}</td><td>${esc(symbolOf.get(k) ?? "")}</td><td>${(data.uses[k] ?? []).length || ""}</td></tr>`).join("") + "</table></div>";
}
// The cross references of all operands.
function references() {
  const rows = xref.operands.map((o) => `<tr><td data-k="${esc(o.address)}">${esc(o.address)}</td><td>${esc(o.symbol)}</td><td>${o.uses.map((u) => linkTo(`${esc(u.block)}${u.network ? "/" + u.network : ""} ${u.access}`, u.block, u.block_name, u.network)).join(", ")}</td></tr>`);
  main.innerHTML = head("Cross references", "#addresses") + `<table><tr><th>Address</th><th>Symbol</th><th>Block / network, R reads, W writes, ? passes on</th></tr>${rows.join("")}</table></div>`;
}
// Which bits of I, Q, M, which timers and counters are taken.
function assignment() {
  const { bytes, timers, counters } = xref.assignment, bits = [7, 6, 5, 4, 3, 2, 1, 0];
  const rows = bytes.map((b) => `<tr><td>${esc(b.address)}</td>${bits.map((n) => `<td>${b.bits >> n & 1 ? "X" : ""}</td>`).join("")}${[b.byte, b.word, b.dword, b.other].map((on) => `<td>${on ? "#" : ""}</td>`).join("")}</tr>`);
  const numbers = (title, letter, list) => `<p>${title}: ${list.length ? list.map((n) => `<span class="id" data-k="${letter}${n}">${letter}${n}</span>`).join(" ") : "none"}</p>`;
  main.innerHTML = head("Assignment of memory", "#assignment") + `<table><tr><th></th>${bits.map((n) => `<th>${n}</th>`).join("")}<th>B</th><th>W</th><th>D</th><th>more</th></tr>${rows.join("")}</table>${numbers("Timers", "T", timers)}${numbers("Counters", "C", counters)}</div>`;
}
// Symbols that nothing uses, and addresses that have none.
function symbols() {
  const table = (title, column, rows) => `<h3>${title}</h3>` + (rows.length ? `<table><tr><th>Address</th><th>${column}</th></tr>${rows.map(([a, b]) => `<tr><td data-k="${esc(a)}">${esc(a)}</td><td>${esc(b)}</td></tr>`).join("")}</table>` : "<p>none</p>");
  main.innerHTML = head("Symbols", "#symbols") + table("Symbols that nothing uses", "Symbol", xref.unused_symbols.map((s) => [s.address, s.name])) +
    table("Addresses without symbol", "Uses", xref.addresses_without_symbol.map((a) => [a.address, a.uses])) + "</div>";
}
// The calls that the reference data have: with instances and local data, and what nothing calls.
function callTree() {
  let count = 0;
  const line = (b, inner) => `<li>${linkTo(`${esc(b.block)} ${esc(b.name)}`, b.block, b.name)}${inner}`;
  const tree = (block, instance, path) => {
    const b = called.get(block);
    if (!b || count++ > 3000) return "";
    const facts = `${instance ? `, <span class="id" data-k="${esc(instance)}">${esc(instance)}</span>` : ""} <small>local data ${b.local_bytes} bytes${path.length || b.path_bytes === null ? "" : `, at most ${b.path_bytes} in all`}${path.includes(block) ? ", recursion" : ""}</small>`;
    const below = path.includes(block) ? "" : b.calls.map((c) => tree(c.block, c.instance, [...path, block])).join("");
    return line(b, facts) + (below ? `<ul>${below}</ul>` : "") + "</li>";
  };
  const { roots, not_called } = xref.structure;
  main.innerHTML = head("Call structure", "#calls") + `<ul>${roots.map((b) => tree(b, null, [])).join("")}</ul>` +
    (not_called.length ? `<h3>Nothing calls</h3><ul>${not_called.map((b) => line(called.get(b), "</li>")).join("")}</ul>` : "") + "</div>";
}
let found = null;
function structure() {
  if (found) return found;
  if (xref) {
    found = data.pages.map(() => []);
    for (const b of called.values()) for (const caller of b.called_by) {
      const to = pageOf(b.block, b.name), from = pageOf(caller, called.get(caller)?.name);
      if (to === undefined || from === undefined || found[from].includes(to)) continue;
      found[from].push(to);
      (data.pages[to].callers ??= []).push(from);
    }
    return found;
  }
  found = data.pages.map((p, i) => {
  const hits = new Set();
  const add = (n) => { const t = byName.get(fold(n)); if (t !== undefined && t !== i) hits.add(t); };
  for (const s of p.secs) {
    if (s.svg) for (const m of s.svg.matchAll(/<text class="t"[^>]*>([^<]*)</g)) add(m[1].replace(/&quot;/g, ""));
    if (s.text) {
      for (const m of s.text.matchAll(/^[^\n/]*?\b(?:CALL|UC|CC)\s+("[^"]+"|[A-Z]+ ?\d+|\w+)/gim)) add(m[1]);
      for (const m of s.text.matchAll(/("[^"\n]+"|\b[A-Za-z_]\w*)(?=\s*(?:\.\s*("[^"]+"|\w+)\s*)?\()/g)) add(m[1]);
    }
    if (s.svg) for (const m of s.svg.matchAll(/CALL ("[^"]+"|[A-Z]+ ?\d+)/g)) add(m[1]);
  }
  return [...hits].filter((t) => data.pages[t].lang);
});
  found.forEach((list, i) => list.forEach((t) => (data.pages[t].callers ??= []).push(i)));
  return found;
}
// It takes a moment in a large program; nothing waits for it.
setTimeout(() => { structure(); if (here >= 0) for (const c of main.querySelectorAll(".callers")) c.innerHTML = callers(here); }, 50);
function calls() {
  if (xref) return callTree();
  structure();
  let count = 0;
  const tree = (i, path) => {
    if (count++ > 3000) return "";
    const p = data.pages[i], loop = path.includes(i);
    return `<li><span class="go" data-page="${i}">${esc(p.id)} ${esc(p.name === p.id ? "" : p.name)}</span>${loop ? " (recursion)" : found[i].length ? "<ul>" + found[i].map((t) => tree(t, [...path, i])).join("") + "</ul>" : ""}</li>`;
  };
  const roots = data.pages.map((p, i) => i).filter((i) => data.pages[i].lang && !data.pages[i].callers);
  main.innerHTML = head("Call structure", "#calls") + "<ul>" + roots.map((i) => tree(i, [])).join("") + "</ul></div>";
}
const VIEWS = xref
  ? { calls: ["Call structure", calls], addresses: ["Cross references", addresses], assignment: ["Assignment of memory", assignment], symbols: ["Symbols", symbols] }
  : { calls: ["Call structure", calls], addresses: ["Addresses and symbols", addresses] };

// The state at a time of the trace.
let shown = null;
const bit = (v) => (v === "1" || v === "TRUE" ? true : v === "0" || v === "FALSE" ? false : null);
const isDuration = (t) => /^(L?T(IME)?|S5T(IME)?)#/i.test(t);
function number(t, reading) {
  t = t.replace(/_/g, "");
  const m = /^(16|8|2)#([0-9A-F]+)$/i.exec(t);
  if (m) {
    const n = parseInt(m[2], +m[1]), digits = m[1] === "16" ? m[2].length : 0;
    if (reading === "real") return digits === 8 ? new Float32Array(new Uint32Array([n]).buffer)[0] : null;
    return Number.isNaN(n) ? null : reading === "unsigned" ? n : digits === 4 ? (n << 16) >> 16 : digits === 8 ? n | 0 : n;
  }
  if (isDuration(t)) {
    const parts = [...t.matchAll(/(\d+(?:\.\d+)?)(ms|us|ns|[dhms])/gi)].map(([, count, unit]) => count * { d: 864e5, h: 36e5, m: 6e4, s: 1e3, ms: 1, us: 1e-3, ns: 1e-6 }[unit.toLowerCase()]);
    return parts.length ? parts.reduce((sum, part) => sum + part, 0) * (t.includes("#-") ? -1 : 1) : null;
  }
  const n = Number(t.replace(/^[A-Z]+#/i, ""));
  return t === "" || Number.isNaN(n) ? null : n;
}
const all = (vs) => (vs.includes(false) ? false : vs.includes(null) ? null : true);
const any = (vs) => (vs.includes(true) ? true : vs.includes(null) ? null : false);
function flow(logic) {
  const known = new Map();
  const operand = (k) => (/^TRUE$/i.test(k) ? true : /^FALSE$/i.test(k) ? false : k === "SM0.0" ? true : shown.has(k) ? bit(shown.get(k)) : null);
  const input = ([v, neg]) => { const x = typeof v === "number" ? known.get(v) ?? null : operand(v); return x === null ? null : x !== neg; };
  const term = (t) => {
    if (t[0] === "r") return true;
    if (t[0] === "&") return all(t.slice(1).map(input));
    if (t[0] === "|") return any(t.slice(1).map(input));
    if (t[0] === "^") { const vs = t.slice(1).map(input); return vs.includes(null) ? null : vs.filter((v) => v).length % 2 === 1; }
    if (t[0] === "?") {
      const [, net, sign, left, right, reading] = t, a = shown.get(left) ?? left, b = shown.get(right) ?? right, x = number(a, reading), y = number(b, reading);
      const on = net === null ? true : known.get(net) ?? null;
      // What STL loads of a timer is a number without its time base. The CPU compares words of S5TIME with their bases, which texts do not have.
      if (x === null || y === null || isDuration(a) !== isDuration(b) || /^S5T/i.test(a) || /^S5T/i.test(b)) return all([on, null]);
      return all([on, { "=": x === y, "==": x === y, "<>": x !== y, "<": x < y, "<=": x <= y, ">": x > y, ">=": x >= y }[sign] ?? null]);
    }
    return null;
  };
  for (let round = 0; round <= logic.nets.length; round++) {
    let more = false;
    logic.nets.forEach((terms, n) => {
      if (known.has(n) || !terms.length) return;
      const v = any(terms.map(term));
      if (v !== null) { known.set(n, v); more = true; }
    });
    if (more) continue;
    const coil = logic.coils.find(([n, k]) => !known.has(n) && operand(k) !== null);
    if (!coil) break;
    known.set(coil[0], operand(coil[1]));
  }
  return known;
}
// Puts a value into a drawing. It has as much room as its first text, or as the name above it if that is wider. A longer
// value is drawn narrower, since it would lose its first digits at the edge of the drawing.
function tell(el, text) {
  const width = (of, cells = of.textContent.length) => Math.max(cells, 1) * 0.61 * of.getAttribute("font-size");
  const name = el.previousElementSibling;
  el.room ??= Math.max(width(el), name?.matches("text.o") && name.dataset.k === el.dataset.k ? width(name) : 0);
  el.textContent = text;
  if (width(el) > el.room) {
    el.setAttribute("textLength", el.room);
    el.setAttribute("lengthAdjust", "spacingAndGlyphs");
  } else el.removeAttribute("textLength");
}
function paint(div, s) {
  if (!s.svg) return;
  const known = s.logic ? flow(s.logic) : new Map();
  for (const w of div.querySelectorAll("path.w")) {
    const v = known.get(+w.dataset.n);
    w.setAttribute("class", "w " + (v === true ? "on" : v === false ? "off" : "un"));
  }
  for (const t of div.querySelectorAll("text.v")) tell(t, shown.get(t.dataset.k) ?? "");
  for (const t of div.querySelectorAll("text.o")) t.style.fill = bit(shown.get(t.dataset.k)) === true ? "var(--on,#1a9a2f)" : "";
  for (const r of div.querySelectorAll("rect[data-s]")) {
    const faulty = [r.dataset.la, r.dataset.va].some((key) => key !== undefined && bit(shown.get(key)) === true);
    r.setAttribute("class", "b " + (bit(shown.get(r.dataset.s)) === true ? "act" : "k") + (faulty ? " bad" : ""));
  }
}
if (data.trace) {
  const { columns, rows } = data.trace, slider = $("#slider");
  $("#time").hidden = false;
  slider.max = rows.length - 1;
  const at = (i) => {
    shown = new Map(columns.map(([, key], c) => [key, rows[i][1][c]]));
    $("output").textContent = (rows[i][0] / 1000).toFixed(3) + " s";
    for (const d of main.querySelectorAll(".draw")) if (d.done) paint(d, data.pages[d.dataset.page].secs[d.dataset.sec]);
  };
  slider.value = data.start ?? 0;
  slider.oninput = () => at(+slider.value);
  let timer;
  $("#play").onclick = () => {
    if (timer) { clearInterval(timer); timer = null; $("#play").textContent = "▶"; return; }
    $("#play").textContent = "❚❚";
    timer = setInterval(() => { slider.value = (+slider.value + 1) % rows.length; at(+slider.value); }, 200);
  };
  at(+slider.value);
}

// A page around this one may tell values as they change: it asks which operands are in sight, and says what they are, as texts.
const inSight = () => [...main.querySelectorAll(".draw")].filter((d) => d.done && d.getBoundingClientRect().bottom > 0 && d.getBoundingClientRect().top < innerHeight);
const sectionOf = (d) => data.pages[d.dataset.page].secs[d.dataset.sec];
let asked = new Map();
window.live = {
  // Names of what is in sight.
  keys() {
    const found = new Set(), input = (i) => typeof i[0] === "string" && found.add(i[0]);
    for (const d of inSight()) {
      for (const r of d.querySelectorAll("rect[data-s]")) found.add(r.dataset.s);
      if (isWatched(d)) continue;
      for (const t of d.querySelectorAll("text.v,text.o")) found.add(t.dataset.k);
      const logic = sectionOf(d).logic;
      for (const t of logic?.nets.flat() ?? []) if (t[0] === "?") t.slice(3, 5).forEach((k) => found.add(k)); else t.slice(1).forEach((i) => Array.isArray(i) && input(i));
      for (const [, k] of logic?.coils ?? []) found.add(k);
    }
    const keys = [...found].filter((k) => k && !/^(TRUE|FALSE|[-+]?\d.*|\w+#[-+\d].*)$/i.test(k));
    asked = new Map(keys.map((k) => [typedName.get(k) ?? k, k]));
    return [...asked.keys()];
  },
  set(values) {
    shown = new Map(values.map(([name, text]) => [asked.get(name) ?? name, text]));
    for (const d of inSight()) if (isWatched(d)) lightSteps(d); else paint(d, sectionOf(d));
  },
  // The block in sight, if it has code: `FB1`.
  block: () => (here >= 0 && data.pages[here].lang ? data.pages[here].id.replace(/ /g, "") : null),
  // From now on `see` tells what the probes of this block see; each has a first and a last byte in the source, and what it tells.
  watch(block, places) {
    status.block = block;
    status.places = places;
    status.seen = [];
    status.steps = [];
    status.history = [];
    status.at = new Map();
    places.forEach(([from], i) => status.at.has(from) ? status.at.get(from).push(i) : status.at.set(from, [i]));
    redraw();
  },
  unwatch() { if (status.block) { status.block = null; redraw(); } },
  see(changes, steps, history) {
    for (const [i, v] of changes) status.seen[i] = v;
    if (steps) { status.steps = steps; listSteps(); }
    if (history) { status.history = history; listHistory(); }
    for (const d of inSight()) if (isWatched(d)) look(d);
  },
  uses,
  // These addresses are forced: operands that overlap them are marked, with `modules` those of the periphery too.
  force(names, modules) {
    forced = names.map((name) => range(name)).filter((r) => r);
    forcesModules = modules;
    markForced(main);
  },
  // Opens a block, at a network if it has that: `FC 5`.
  go(block, network) {
    const i = byName.get(fold(block));
    if (i === undefined) return;
    const k = data.pages[i].secs.findIndex((s) => s.n === network);
    go(i, network && k >= 0 ? k : undefined);
  },
};

let forced = [], forcesModules = false;
function isForced(operand) {
  const r = range(keyOf(operand));
  if (!r) return false;
  const area = forcesModules ? r[0].replace(/^P(?=[IQ])/, "") : r[0];
  return forced.some((f) => f[0] === area && f[1] < r[2] && r[1] < f[2]);
}
function markForced(root) {
  for (const t of root.querySelectorAll("text.o,.draw .id[data-k]")) t.classList.toggle("forced", forced.length > 0 && isForced(t.dataset.k ?? ""));
}

// Status of the block in sight: what its statements see in one call.
const status = { block: null, places: [], seen: [], steps: [], history: [], at: new Map() };
const isWatched = (d) => status.block !== null && data.pages[d.dataset.page].id.replace(/ /g, "") === status.block;
function redraw() {
  for (const d of main.querySelectorAll(".draw")) if (d.done) { d.done = false; fill(d); }
  listSteps();
  listHistory();
}
// What is seen at a place of the source: of several probes that begin there the one with the fewest bytes, and of those one that was reached.
function seenAt(from, ...kinds) {
  let best;
  for (const i of status.at.get(from) ?? []) {
    const [, to, tells] = status.places[i];
    const rank = kinds.indexOf(tells);
    if (rank < 0) continue;
    const order = [status.seen[i] == null ? 1 : 0, rank, to];
    const before = best?.order;
    if (!before || order[0] < before[0] || order[0] === before[0] && (order[1] < before[1] || order[1] === before[1] && order[2] < before[2])) best = { order, value: status.seen[i] };
  }
  return best?.value;
}
// The result of a comparison in an expression: that of the shortest expression that has both operands in it, perhaps in parentheses.
function comparedAt(left, right) {
  let best;
  status.places.forEach(([from, to, tells], i) => {
    if (tells !== "value" || from > left || to <= right) return;
    if (!best || to - from < best.bytes || to - from === best.bytes && best.value == null) best = { bytes: to - from, value: status.seen[i] };
  });
  return best?.value;
}
const truth = (v) => (typeof v === "boolean" ? v : null);
const operandAt = (from) => seenAt(from, "variable", "written", "value");
// The power flow: the program tells it after each contact and gate; what it does not tell follows from the operands at their places.
function flowSeen(logic) {
  const known = new Map();
  const operand = ([k, , place]) => (/^TRUE$/i.test(k) ? true : /^FALSE$/i.test(k) ? false : place === undefined ? null : truth(operandAt(place)));
  const input = (i) => { const x = typeof i[0] === "number" ? known.get(i[0]) ?? null : operand(i); return x === null ? null : x !== i[1]; };
  const term = (t, place) => {
    const told = place === null || place === undefined ? null : truth(seenAt(place, "written"));
    if (told !== null) return told;
    if (t[0] === "r") return true;
    if (t[0] === "&") return all(t.slice(1).map(input));
    if (t[0] === "|") return any(t.slice(1).map(input));
    if (t[0] === "^") { const vs = t.slice(1).map(input); return vs.includes(null) ? null : vs.filter((v) => v).length % 2 === 1; }
    if (t[0] === "?" && t[6]) {
      const [from, inside, inverse] = t[6], result = truth(comparedAt(from, inside));
      return all([t[1] === null ? true : known.get(t[1]) ?? null, result === null ? null : result !== inverse]);
    }
    return null;
  };
  for (let round = 0; round <= logic.nets.length; round++) {
    let more = false;
    logic.nets.forEach((terms, n) => {
      if (known.has(n) || !terms.length) return;
      const v = any(terms.map((t, i) => term(t, logic.places?.[n]?.[i])));
      if (v !== null) { known.set(n, v); more = true; }
    });
    if (!more) break;
  }
  return known;
}
// Paints what has changed: the elements of a drawing are looked up once.
function look(d) {
  const s = sectionOf(d);
  if (d.rows) return lookAtLines(d);
  if (!s.svg) return;
  d.parts ??= {
    wires: [...d.querySelectorAll("path.w")].map((el) => ({ el, net: +el.dataset.n, place: el.dataset.o === undefined ? null : +el.dataset.o })),
    contacts: (s.logic?.contacts ?? []).map(([part, place, open]) => ({ el: d.querySelector(`path.g[data-p="${part}"]`), place, open })).filter((c) => c.el),
    texts: [...d.querySelectorAll("text[data-o]")].map((el) => ({ el, place: +el.dataset.o, isValue: el.classList.contains("v") })),
  };
  const known = s.logic ? flowSeen(s.logic) : new Map();
  for (const w of d.parts.wires) {
    // The wire at an operand has its value; that of a number is neither on nor off.
    const v = w.place === null ? known.get(w.net) : operandAt(w.place);
    const name = "w" + (v === true ? " on" : v === false ? " off" : v === undefined || v === null ? " un" : "");
    if (w.last !== name) w.el.setAttribute("class", (w.last = name));
  }
  for (const c of d.parts.contacts) {
    const v = truth(operandAt(c.place)), name = v !== null && v !== c.open ? "g on" : "g";
    if (c.last !== name) c.el.setAttribute("class", (c.last = name));
  }
  for (const t of d.parts.texts) {
    const v = operandAt(t.place);
    if (t.last === v) continue;
    t.last = v;
    if (t.isValue) tell(t.el, v === undefined || v === null ? "" : v === true ? "TRUE" : v === false ? "FALSE" : String(v));
    else t.el.style.fill = v === true ? "var(--on,#1a9a2f)" : "";
  }
  lightSteps(d);
}
// The name of a step: the last of the texts that are drawn after its box and stand in it.
function nameOf(box) {
  const end = +box.getAttribute("y") + +box.getAttribute("height");
  let name = "";
  for (let el = box.nextElementSibling; el?.matches("rect.s,text.t") && +el.getAttribute("y") < end; el = el.nextElementSibling) if (el.tagName === "text") name = el.textContent;
  return name;
}
function lightSteps(d) {
  d.steps ??= [...d.querySelectorAll("rect[data-s]")].map((el) => ({ el, key: el.dataset.s, name: fold(nameOf(el)) }));
  for (const r of d.steps) {
    const step = status.steps.find((it) => fold(it.step) === r.name);
    const on = step ? step.active : bit(shown?.get(r.key)) === true;
    const name = "b " + (on ? "act" : "k") + (step?.faulty ? " bad" : "");
    if (r.last !== name) r.el.setAttribute("class", (r.last = name));
  }
}
// The active steps with their times, above the chart.
function listSteps() {
  let box = main.querySelector(".steps");
  const list = status.block ? status.steps.filter((it) => it.active || it.faulty) : [];
  if (!list.length) { box?.remove(); return; }
  if (!box) {
    box = document.createElement("table");
    box.className = "steps";
    main.querySelector(".page .history, .page section")?.before(box);
  }
  const time = (ms) => (ms === null || ms === undefined ? "" : (ms / 1000).toFixed(1) + " s");
  box.innerHTML = "<tr><th>Step</th><th>T</th><th>U</th><th></th></tr>" + list.map((it) => `<tr><td>${esc(it.step)}${it.active ? "" : " (left)"}</td><td>${time(it.t_ms)}</td><td>${time(it.u_ms)}</td><td>${it.interlocked ? "interlock not satisfied " : ""}${it.faulty ? "supervision fault" : ""}</td></tr>`).join("");
}
// The steps that have become active since somebody looks, below the active ones.
function listHistory() {
  let box = main.querySelector(".history");
  const list = status.block ? status.history : [];
  if (!list.length) { box?.remove(); return; }
  if (!box) {
    box = document.createElement("details");
    box.className = "history";
    box.open = true;
    box.innerHTML = "<summary>History</summary><table></table>";
    main.querySelector(".page section")?.before(box);
  }
  const clock = (ms) => new Date(ms).toISOString().slice(11, 23), time = (ms) => (ms === null ? "active" : (ms / 1000).toFixed(ms < 10000 ? 3 : 1) + " s");
  box.lastChild.innerHTML = "<tr><th>Step</th><th>Active from</th><th>For</th><th>Cycle</th></tr>" + list.map((it) => `<tr><td>${esc(it.step)}</td><td>${clock(it.clock_ms)}</td><td>${time(it.active_ms)}</td><td>${it.cycle}</td></tr>`).join("");
}
// Code with what its statements see beside each line.
const bytes = new TextEncoder(), chars = new TextDecoder();
// Title, width and name of each column of STL; a small screen shows the first three, and all of a line that is touched.
const REGISTERS = [["RLO", 4], ["STA", 5], ["ACCU1", 9], ["ACCU2", 9], ["AR1", 9], ["AR2", 9], ["DB", 6], ["DI", 6], ["STATUS", 11], ["", 0]];
const columns = (text) => REGISTERS.map(([title, width], n) => `<span class="c${n > 2 ? " more" : ""}" data-title="${title}">${text(title, width)}</span>`).join("");
const HEADS = { registers: columns((title, width) => title.padEnd(width)), stack: "S0...S8   ENO", scl: "" };
function fillLines(div, s) {
  const code = s.code ?? s, lines = code.text.split("\n"), starts = code.starts ?? [];
  const rows = lines.map(() => []);
  status.places.forEach(([from, to, tells], i) => {
    if (tells === "block" || !starts.length || from < starts[0]) return;
    let line = starts.findLastIndex((start) => start <= from);
    const raw = bytes.encode(lines[line]);
    if (line === lines.length - 1 && from > starts[line] + raw.length) return;
    rows[line].push({ i, from, to, tells, name: chars.decode(raw.slice(from - starts[line], Math.max(0, to - starts[line]))).trim() });
  });
  const kind = rows.flat().some((r) => r.tells === "registers") ? "registers" : rows.flat().some((r) => r.tells === "stack") ? "stack" : "scl";
  const head = HEADS[kind] ? `<div class="ln head"><code></code><span class="see">${HEADS[kind]}</span></div>` : "";
  // As wide as the longest line of the block, so that the values are in the same place in all networks.
  const page = data.pages[div.dataset.page];
  page.wide ??= Math.max(...page.secs.flatMap((of) => (of.code ?? of).text?.split("\n") ?? []).map((line) => line.replace(/\t/g, "    ").length), 0);
  div.innerHTML = `<div class="code ${kind}" style="--code:${Math.min(70, Math.max(16, page.wide + 2))}ch">${head}${lines.map((line) => `<div class="ln"><code>${coloured(line, kind === "scl" ? "scl" : "stl") || " "}</code><span class="see"></span></div>`).join("")}</div>`;
  const cells = [...div.querySelectorAll(".see")].slice(head ? 1 : 0);
  div.rows = rows.map((places, at) => ({ places, cell: cells[at] })).filter((row) => row.places.length);
  if (kind === "registers") for (const row of div.rows) {
    row.cell.innerHTML = columns(() => "");
    row.columns = [...row.cell.children];
    row.cell.parentElement.onclick = (e) => { if (!e.target.dataset.k) row.cell.parentElement.classList.toggle("open"); };
  }
  if (forced.length) markForced(div);
  lookAtLines(div);
}
const hex = (n) => (n >>> 0).toString(16).toUpperCase().padStart(8, "0");
function told(row) {
  const seen = row.places.map((p) => ({ ...p, v: status.seen[p.i] })).filter((p) => p.v !== undefined && p.v !== null);
  if (!seen.length) return [row.columns ? REGISTERS.map(() => "") : [""], false];
  if (seen[0].tells === "registers") {
    const rows = seen.map(({ v: [st, a1, a2, r1, r2, db, di, cell] }) => {
      const bits = st.toString(2).padStart(9, "0").replace(/^(.)(....)(....)$/, "$1 $2 $3");
      return [` ${st >> 1 & 1}`, ` ${st >> 2 & 1}`, hex(a1), hex(a2), hex(r1), hex(r2), String(db || ""), String(di || ""), bits, cell ? " " + cell : ""]
        .map((text, n) => text.padEnd(REGISTERS[n][1]));
    });
    return [REGISTERS.map((_, n) => rows.map((row) => row[n]).join("\n")), (seen.at(-1).v[0] & 2) !== 0];
  }
  if (seen[0].tells === "stack") {
    const rows = seen.map(({ v: [n, ops] }) => [...Array(9)].map((_, i) => n >> i & 1).join("") + "  " + (n >> 9 & 1) + "   " + ops.map(([k, v]) => `${k}=${v}`).join(" "));
    return [[rows.join("\n")], (seen.at(-1).v[0] & 1) !== 0];
  }
  const text = (v) => (v === true ? "TRUE" : v === false ? "FALSE" : v);
  const list = seen.filter((p) => p.tells !== "value" && p.tells !== "ran").map((p) => `${p.name}${p.tells === "written" ? " := " : " = "}${text(p.v)}`);
  const result = seen.filter((p) => p.tells === "value" && typeof p.v === "boolean").sort((a, b) => b.to - b.from - (a.to - a.from))[0];
  if (result) list.push(`result ${text(result.v)}`);
  if (!list.length && seen.some((p) => p.tells === "ran")) list.push("has run");
  return [[[...new Set(list)].join("   ")], false];
}
function lookAtLines(d) {
  for (const row of d.rows) {
    const [texts, on] = told(row), last = row.last ?? [];
    texts.forEach((text, n) => { if (last[n] !== text) (row.columns?.[n] ?? row.cell).textContent = text; });
    row.last = texts;
    if (row.on !== on) row.cell.classList.toggle("on", (row.on = on));
  }
}

// What comes into sight is painted then.
let moved = 0;
main.addEventListener("scroll", () => {
  cancelAnimationFrame(moved);
  moved = requestAnimationFrame(() => { for (const d of inSight()) if (isWatched(d)) look(d); });
}, { passive: true });

// Paper gets everything. A drawing that is higher than a sheet is cut where no element is: between rungs, branches and steps.
const PAPER = { width: 700, height: 900 };
function cut(svg) {
  const width = svg.width.baseVal.value, height = svg.height.baseVal.value, most = PAPER.height / Math.min(1, PAPER.width / width);
  if (height <= most) return;
  const boxes = [...svg.querySelectorAll("text,rect,circle,path.g,path.w,path.r")].map((el) => el.getBBox());
  // A long line down may be cut; a short one belongs to a small network.
  const taken = boxes.filter((b) => b.height < (b.width > 0 ? most : most / 4)).map((b) => [b.y, b.y + b.height]).sort((a, b) => a[0] - b[0]);
  const free = [], tops = [0];
  let end = taken[0]?.[1] ?? 0;
  for (const [from, to] of taken) {
    if (from > end + 6) free.push((from + end) / 2);
    end = Math.max(end, to);
  }
  for (let top = 0; height - top > most; tops.push(top)) top = free.findLast((y) => y > top && y <= top + most) ?? top + most;
  svg.replaceWith(...tops.map((top, i) => {
    const part = svg.cloneNode(true), bottom = tops[i + 1] ?? height;
    part.setAttribute("height", bottom - top);
    part.setAttribute("viewBox", `0 ${top} ${width} ${bottom - top}`);
    return part;
  }));
}
addEventListener("beforeprint", () => {
  main.innerHTML = data.pages.map((p, i) => html(i)).join("");
  for (const d of main.querySelectorAll(".draw")) fill(d);
  for (const d of main.querySelectorAll("details")) d.open = true;
  main.querySelectorAll(".draw svg").forEach(cut);
});
addEventListener("afterprint", () => (here >= 0 ? go(here) : fromHash()));

show("");
if (!fromHash() && data.pages.length) go(Math.max(0, data.pages.findIndex((p) => p.id === "OB 1")));
