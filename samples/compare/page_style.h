#pragma once

namespace limn {

inline constexpr const char* kPageStyle = R"css(
:root { color-scheme: light dark; --paper: #f6f6f4; --card: #ffffff; --ink: #1a1a1a; --soft: #5a5a5a; --line: #d8d8d4; --accent: #0b57d0; --good: #e8f1e4; }
@media (prefers-color-scheme: dark) {
  :root { --paper: #161718; --card: #202224; --ink: #ececea; --soft: #a6a8aa; --line: #3a3d40; --accent: #8ab4f8; --good: #22331f; }
}
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 16px/1.55 system-ui, -apple-system, "Segoe UI", "DejaVu Sans", sans-serif; }
main { max-width: 1280px; margin: 0 auto; padding: 24px 20px 48px; }
h1 { font-size: 1.7rem; line-height: 1.25; margin: 0 0 12px; }
h2 { font-size: 1.2rem; margin: 36px 0 10px; }
p { max-width: 78ch; margin: 0 0 10px; }
.lead { font-size: 1.06rem; }
ul.results { max-width: 82ch; padding-left: 1.2em; margin: 8px 0 0; }
ul.results li { margin: 5px 0; }
.legend span { display: inline-block; margin-right: 18px; white-space: nowrap; }
.legend i { display: inline-block; width: 14px; height: 14px; margin-right: 6px; vertical-align: -2px; border-radius: 2px; }
.cells { display: grid; gap: 20px; grid-template-columns: repeat(auto-fit, minmax(min(100%, 280px), 1fr)); }
.cell { background: var(--card); border: 1px solid var(--line); border-radius: 8px; padding: 12px; margin: 0; }
.cell h3 { margin: 0; font-size: 1.05rem; }
.cell .details { color: var(--soft); margin: 0 0 8px; min-height: 1.5em; font-size: .92rem; }
.cell img { display: block; width: 100%; height: auto; background: #fff; border: 1px solid var(--line); border-radius: 4px; margin-bottom: 8px; }
.cell img.pixels { image-rendering: pixelated; }
.cell figcaption { color: var(--soft); font-size: .88rem; margin: -2px 0 10px; }
.numbers { list-style: none; padding: 0; margin: 0; font-variant-numeric: tabular-nums; font-size: .95rem; }
.scroll { overflow-x: auto; border: 1px solid var(--line); border-radius: 8px; background: var(--card); }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; font-size: .92rem; }
th, td { padding: 8px 12px; text-align: right; border-bottom: 1px solid var(--line); white-space: nowrap; }
th:first-child, td:first-child { text-align: left; position: sticky; left: 0; background: var(--card); }
tbody tr:last-child td { border-bottom: 0; }
th { vertical-align: bottom; font-weight: 600; }
th button { all: unset; cursor: pointer; }
th button:focus-visible { outline: 2px solid var(--accent); outline-offset: 3px; }
th[aria-sort="ascending"] button::after { content: " \2191"; }
th[aria-sort="descending"] button::after { content: " \2193"; }
th small { display: block; color: var(--soft); font-weight: 400; }
td.best { background: var(--good); }
details { margin-top: 28px; color: var(--soft); }
summary { cursor: pointer; color: var(--ink); }
code { font-size: .88rem; overflow-wrap: anywhere; }
)css";

/// Clicking a column's head sorts by it; a second click turns the order round. Without scripts the table is simply not sortable.
inline constexpr const char* kPageScript = R"js(
document.querySelectorAll("th button").forEach(button => button.addEventListener("click", () => {
  const head = button.closest("th"), row = head.parentElement, body = row.closest("table").tBodies[0];
  const column = [...row.children].indexOf(head), down = head.getAttribute("aria-sort") === "ascending";
  [...row.children].forEach(other => other.removeAttribute("aria-sort"));
  head.setAttribute("aria-sort", down ? "descending" : "ascending");
  const key = line => { const cell = line.children[column]; const n = parseFloat(cell.dataset.value); return Number.isNaN(n) ? cell.textContent : n; };
  [...body.rows].sort((a, b) => { const x = key(a), y = key(b); const order = typeof x === "number" && typeof y === "number" ? x - y : String(x).localeCompare(String(y)); return down ? -order : order; })
    .forEach(line => body.append(line));
}));
)js";

}  // namespace limn
