"use strict";
// Without scripts the page still shows every outcome; with them marks open, and the matrix shows only what is asked for.

const results = JSON.parse(document.querySelector("#stability").textContent);
const matrix = document.querySelector(".matrix");
const marks = [...matrix.querySelectorAll("button.mark")];
const panel = document.querySelector("#panel");
const title = panel.querySelector("h3");
const inside = panel.querySelector(".inside");
const status = document.querySelector(".filters .status");
const small = matchMedia("(max-width: 760px)");
let pinned = null;

function element(name, text, ...children) {
  const made = document.createElement(name);
  if (text) made.textContent = text;
  made.append(...children);
  return made;
}
const number = value => (value === null ? "none" : Number(value.toPrecision(4)).toString());

function facts(pairs) {
  const list = document.createElement("dl");
  for (const [name, value] of pairs) if (value) list.append(element("dt", name), element("dd", value));
  return list;
}

function fill(mark) {
  const group = results.marks[Number(mark.dataset.mark)], cell = results.cells[group.worst];
  const about = results.cases.find(one => one.name === cell.case);
  title.textContent = `${mark.querySelector("b").textContent} ${cell.outcome}: ${cell.case.replaceAll("_", " ")}`;
  const unit = cell.unit ? ` ${cell.unit}` : "";
  const found = [];
  const bytes = results.pictures[cell.picture];
  if (bytes) {
    const picture = new Image();
    picture.src = `data:image/png;base64,${bytes}`;
    picture.alt = `${cell.case.replaceAll("_", " ")}, ${cell.method || "the surface itself"} on ${cell.surface}, where it is worst`;
    found.push(picture);
  } else if (cell.picture) {
    found.push(element("p", `Picture: ${cell.picture}`));
  }
  if (cell.message) found.push(element("p", cell.message));
  const drawn = Object.entries(cell.parameters).map(([name, value]) => `${name} = ${number(value)}`).join(", ");
  found.push(facts([
    ["surface", cell.surface.replaceAll("_", " ")],
    ["method", cell.method || "none: the surface itself"],
    ["number", cell.number === null ? "" : number(cell.number) + unit],
    ["bound", cell.number === null ? "" : cell.outer > cell.bound ? `${number(cell.bound)}${unit}; degraded up to ${number(cell.outer)}${unit}` : number(cell.bound) + unit],
    ["must hold", about.holds],
    ["looked at", about.looks],
    ["parameters", drawn],
    ["draws", group.cells.length > 1 ? `${group.cells.length}, this is the worst` : ""],
  ]));
  if (cell.said.length) {
    found.push(element("p", "What the program says of it:"), element("ul", "", ...cell.said.map(text => element("li", text))));
  }
  found.push(element("p", "To run it again:"), element("code", cell.command));
  inside.replaceChildren(...found);
}

function show(mark) {
  fill(mark);
  const box = mark.getBoundingClientRect();
  panel.classList.toggle("left", box.left + box.width / 2 > innerWidth / 2);
  panel.hidden = false;
  panel.scrollTop = 0;
  for (const other of matrix.querySelectorAll(".open")) other.classList.remove("open");
  mark.classList.add("open");
}
function hide() {
  panel.hidden = true;
  for (const other of matrix.querySelectorAll(".open")) other.classList.remove("open");
}
function close() {
  const back = pinned;
  pinned = null;
  hide();
  if (back) back.focus({ preventScroll: true });
  // Focus alone would show it again.
  hide();
}

// One stop for the tabulator; arrows go on from there.
function reach(mark) {
  for (const other of marks) other.tabIndex = other === mark ? 0 : -1;
}
const shown = () => marks.filter(mark => !mark.hidden);
function neighbour(mark, key) {
  const all = shown(), at = all.indexOf(mark);
  if (key === "ArrowRight") return all[at + 1];
  if (key === "ArrowLeft") return all[at - 1];
  const line = mark.closest("tr"), lines = [...matrix.querySelectorAll("tr.case")].filter(one => all.some(other => one.contains(other)));
  const next = lines[lines.indexOf(line) + (key === "ArrowDown" ? 1 : -1)];
  if (!next) return undefined;
  const x = mark.getBoundingClientRect().left, off = other => Math.abs(other.getBoundingClientRect().left - x);
  return all.filter(other => next.contains(other)).sort((a, b) => off(a) - off(b))[0];
}

matrix.addEventListener("keydown", event => {
  const mark = event.target.closest("button.mark");
  if (!mark || !event.key.startsWith("Arrow")) return;
  event.preventDefault();
  const to = neighbour(mark, event.key);
  if (to) to.focus();
});
matrix.addEventListener("focusin", event => {
  const mark = event.target.closest("button.mark");
  if (!mark) return;
  reach(mark);
  if (!pinned && !small.matches && mark.matches(":focus-visible")) show(mark);
});
matrix.addEventListener("focusout", () => { if (!pinned) hide(); });
matrix.addEventListener("pointerover", event => {
  const mark = event.target.closest("button.mark");
  if (mark && !pinned && event.pointerType === "mouse" && !small.matches) show(mark);
});
matrix.addEventListener("pointerout", event => {
  if (!pinned && event.target.closest("button.mark") && !panel.contains(event.relatedTarget)) hide();
});
matrix.addEventListener("click", event => {
  const mark = event.target.closest("button.mark");
  if (!mark) return;
  pinned = mark;
  reach(mark);
  show(mark);
  title.focus({ preventScroll: true });
});
panel.querySelector(".close").addEventListener("click", close);
document.addEventListener("keydown", event => { if (event.key === "Escape" && !panel.hidden) close(); });

function filter() {
  const outcomes = new Set([...document.querySelectorAll("input[name=outcome]:checked")].map(box => box.value));
  const surface = document.querySelector("select[name=surface]").value;
  for (const mark of marks) {
    mark.hidden = !([...outcomes].some(name => mark.classList.contains(name)) && (!surface || mark.dataset.surface === surface));
  }
  const any = part => [...part.querySelectorAll("button.mark")].some(mark => !mark.hidden);
  for (const part of matrix.querySelectorAll(".marks, tr.case, tbody")) part.hidden = !any(part);
  for (const line of document.querySelectorAll(".list tbody tr")) {
    line.hidden = ![...outcomes].some(name => line.classList.contains(name));
  }
  const cases = matrix.querySelectorAll("tr.case:not([hidden])").length;
  status.textContent = `${shown().length} of ${marks.length} marks shown, in ${cases} of ${results.cases.length} cases.`;
  const first = shown()[0];
  if (first && !shown().some(mark => mark.tabIndex === 0)) reach(first);
  if (pinned && pinned.hidden) close();
}
document.querySelector(".filters").addEventListener("change", filter);
filter();
