"use strict";
// The study's page: filters, what follows from them, and the charts drawn anew.

const study = JSON.parse(document.getElementById("study").textContent);
const chosen = name => document.querySelector(`.filters select[name=${name}]`);
const metricOf = name => study.metrics.findIndex(metric => metric.name === name);
const unitText = (value, unit) => `${value === null ? "–" : +value.toPrecision(3)}${unit ? " " + unit : ""}`;

function filters() {
  const views = chosen("view").value;
  return {
    drawing: study.drawings.findIndex(one => one.method === chosen("method").value && one.parameters === chosen("parameters").value),
    view: views === "all" ? null : Number(views),
    metric: study.metrics[metricOf(chosen("metric").value)],
    series: new Set([...document.querySelectorAll(".filters input:checked")].map(box => Number(box.value))),
  };
}

const shownFront = (points, want, cost) => frontOf(points, cost, study.beating, want.series);
const errorAxis = (values, metric, length) => logAxis(values, `${metric.label}${metric.unit ? ` [${metric.unit}]` : ""}`, metric.unit,
  metric.unit === "px" ? study.least : 0, length);
function clampNote(axis) {
  if (!axis.clamped) return "";
  const words = axis.unit in kUnits ? kUnits[axis.unit](axis.floor) : unitText(axis.floor, axis.unit);
  return `${axis.clamped} ${axis.clamped === 1 ? "value" : "values"} at or below ${words} ${axis.clamped === 1 ? "is" : "are"} drawn there. `;
}

// What cannot be told from no error is not quoted.
const errorText = (value, metric) => {
  const floor = study.floors[metric.name];
  return floor && floor.px !== null && value !== null && Math.abs(value) < floor.px ? floor.words : unitText(value, metric.unit);
};
const tip = (point, view, metric, error) => ({
  model: point.model, drawing: point.drawing, lines: [
    [metric.label, errorText(error, metric)],
    ...(view === null && point.views.length > 1
      ? [["views", `${point.views.length}, from ${errorText(point.low, metric)} to ${errorText(point.high, metric)}`]] : [["view", `${view ?? point.views[0].view}`]]),
    ["time", kUnits.ms(point.ms)], ["memory", kUnits.bytes(point.bytes)],
  ],
});

// Each chart: what to draw, a caption, a note, and lines of text below.
const kCharts = {
  chart_accuracy_time: state => accuracyChart(state, "ms", "time to build, trace and ink"),
  chart_accuracy_memory: state => accuracyChart(state, "bytes", "memory that the model holds"),
  chart_order: orderChart,
  chart_views: viewsChart,
  chart_normal_border: normalChart,
};

function accuracyChart({ points, want, size, theme }, cost, title) {
  const x = logAxis(points.map(point => point[cost]), title, cost, 0, size.width);
  const y = errorAxis(points.map(point => point.error), want.metric, size.height);
  const front = shownFront(points, want, cost);
  const dots = points.map(point => ({ ...point, x: x.shown(point[cost]), y: y.shown(point.error), tip: tip(point, want.view, want.metric, point.error),
    ...(front.includes(point) ? { label: point.name } : {}) }));
  const line = front.map(point => ({ x: x.shown(point[cost]), y: y.shown(point.error) }));
  return {
    spec: accuracySpec(dots, line, x, y, size, theme.series, theme, study.floors[want.metric.name]), count: points.length,
    caption: "Each point a model; the line joins those that nothing beats, with their names.",
    note: clampNote(x) + clampNote(y), items: [], data: { front: front.map(point => point.model) },
  };
}

function orderChart({ points, want, size, theme }) {
  const known = points.filter(point => point.resolution > 0);
  const x = logAxis(known.map(point => point.resolution), "edge or voxel, share of the longest side (finer to the left)", "", 0, size.width);
  const y = errorAxis(known.map(point => point.error), want.metric, size.height);
  const fits = lookOf(study, want)?.fits ?? [], lines = [], items = [], orders = [], labels = new Map();
  study.series.forEach((series, index) => {
    const mine = known.filter(point => point.series === series.name);
    orders.push(null);
    if (!mine.length) return;
    const fit = fits[index];
    const expected = study.expected[want.metric.name]?.[index][want.drawing] ?? null;
    const theory = expected === null ? "no order is expected" : `expected ${expected}`;
    items.push([index, fit ? `${series.name}: order ${fit[0].toFixed(2)}${fit[0] < study.leastOrder ? ": does not converge" : ""}, ${theory}` : `${series.name}: too few resolutions for an order, ${theory}`]);
    if (!fit) return;
    // error = factor * resolution^order.
    const [order, factor, ...ends] = fit;
    orders[index] = order;
    for (const resolution of ends) lines.push({ series: series.name, x: resolution, y: factor * resolution ** order });
    labels.set(mine.reduce((a, b) => b.resolution < a.resolution ? b : a), order.toFixed(2));
  });
  const dots = known.map(point => ({ ...point, x: point.resolution, y: y.shown(point.error), tip: tip(point, want.view, want.metric, point.error),
    ...(labels.has(point) ? { label: labels.get(point) } : {}) }));
  const floor = want.metric.unit === "px" ? `Errors below ${Number((study.fitFloor ?? Infinity).toPrecision(2))} px are at the precision of measurement and truth, and left out of the fit. ` : "";
  return { spec: orderSpec(dots, lines, x, y, size, theme.series, theme, study.floors[want.metric.name]), count: known.length, items, note: floor + clampNote(y), data: { orders },
    caption: "Dashed: the order fitted, a number at its fine end; below, what theory expects." };
}

function viewsChart({ points, want, size, theme, narrow }) {
  const finest = points.filter((point, i) => points[i + 1]?.series !== point.series);
  const rows = [...new Set([...shownFront(points, want, "ms"), ...finest, ...shownFront(points, want, "bytes")])].slice(0, 16).sort((a, b) => a.error - b.error);
  const x = errorAxis(rows.flatMap(row => row.views.map(view => view.error)), want.metric, size.width);
  const marks = rows.flatMap(row => row.views.map(view => ({ name: row.name, series: row.series, x: x.shown(view.error),
    tip: tip({ ...row, ms: view.ms, bytes: view.bytes }, view.view, want.metric, view.error) })));
  const shown = rows.map(row => ({ name: row.name, series: row.series, low: x.shown(row.low), lowQuartile: x.shown(row.lowQuartile),
    median: x.shown(row.error), highQuartile: x.shown(row.highQuartile), high: x.shown(row.high), tip: tip(row, want.view, want.metric, row.error) }));
  const wide = narrow ? size.width : Math.max(160, size.width - Math.max(0, ...rows.map(row => theme.measure(row.name))) + 40);
  return { spec: viewsSpec(shown, marks, x, { width: wide }, theme.series, theme, narrow, study.floors[want.metric.name]), count: marks.length, items: [], note: clampNote(x),
    caption: "Each mark a view, the bar the median, the box the middle half: the models that nothing beats, and the finest of each kind." };
}

function normalChart({ cells, want, size, theme }) {
  const border = metricOf(study.roles.compared), normal = metricOf(study.roles.normal), predicted = metricOf(study.roles.predicted);
  const usable = border < 0 || normal < 0 ? [] : cells.filter(cell => cell[5][border] !== null && cell[5][normal] !== null);
  const values = usable.map(cell => [Math.abs(cell[5][normal]), Math.abs(cell[5][border])]);
  const metric = border < 0 ? { label: "displacement", unit: "px" } : study.metrics[border];
  const x = logAxis(values.map(one => one[0]), `${normal < 0 ? "normal error" : study.metrics[normal].label} [deg]`, "deg", 0, size.width), y = errorAxis(values.map(one => one[1]), metric, size.height);
  const slope = predicted < 0 ? null : predictedSlope(usable.map(cell => [cell[5][predicted], cell[5][normal]]));
  const points = usable.map((cell, i) => {
    const model = study.models[cell[0]], row = { model: cell[0], drawing: cell[1], views: [{ view: cell[2] }], ms: cell[3], bytes: cell[4] };
    const about = tip(row, cell[2], metric, values[i][1]);
    about.lines.splice(1, 0, ["normal error", unitText(values[i][0], "deg")], ["predicted", predicted < 0 ? "–" : unitText(cell[5][predicted], "px")]);
    return { name: model.name, series: study.series[model.series].name, x: x.shown(values[i][0]), y: y.shown(values[i][1]), tip: about };
  });
  const line = slope ? `Dashed: predicted from the normals, ${unitText(slope.median, "px")} for a degree in the median; the band holds all cells.`
    : "No cell has a predicted displacement, so there is no line.";
  return { spec: normalSpec(points, slope, x, y, size, theme.series, theme, study.floors[metric.name]), count: points.length, items: [], note: clampNote(x) + clampNote(y),
    caption: `Each point a model in a view. ${line}` };
}

function themeNow() {
  const style = getComputedStyle(document.documentElement), color = name => style.getPropertyValue(name).trim();
  const dark = matchMedia("(prefers-color-scheme: dark)").matches;
  const pen = document.createElement("canvas").getContext("2d");
  pen.font = "11.5px sans-serif";
  return {
    ink: color("--ink"), soft: color("--soft"), line: color("--line"), card: color("--card"), measure: words => pen.measureText(words).width * 1.04,
    // Black does not show on dark paper.
    series: study.series.map(one => ({ ...one, color: dark && one.color === "#000000" ? "#e8e8e8" : one.color })),
  };
}
const configOf = theme => ({
  background: "transparent", font: "sans-serif", view: { stroke: theme.line },
  axis: { labelColor: theme.soft, titleColor: theme.ink, gridColor: theme.line, gridOpacity: 0.7, domainColor: theme.soft, tickColor: theme.soft,
    labelFontSize: 12, titleFontSize: 12.5, titleFontWeight: "normal" },
});

// The numbers of a point and the picture of its model, that stands further down on the page.
const bubble = document.createElement("div");
bubble.className = "bubble";
bubble.hidden = true;
bubble.setAttribute("role", "tooltip");
document.body.append(bubble);
function showBubble(_, event, item, value) {
  bubble.hidden = !value?.tip;
  if (bubble.hidden) return;
  bubble.replaceChildren();
  const name = document.createElement("strong");
  name.textContent = value.name;
  bubble.append(name);
  const list = document.createElement("dl");
  for (const [label, text] of value.tip.lines) {
    const key = document.createElement("dt"), number = document.createElement("dd");
    key.textContent = label;
    number.textContent = text;
    list.append(key, number);
  }
  bubble.append(list);
  const source = document.querySelector(`#cell-${value.tip.model}-${value.tip.drawing} img`);
  if (source) {
    const picture = new Image(source.width, source.height);
    picture.src = source.src;
    picture.alt = source.alt;
    bubble.append(picture);
  }
  const room = 14, box = bubble.getBoundingClientRect();
  const x = event.clientX + room + box.width < innerWidth ? event.clientX + room : Math.max(4, event.clientX - room - box.width);
  bubble.style.left = `${x}px`;
  bubble.style.top = `${Math.max(4, Math.min(event.clientY + room, innerHeight - box.height - 4))}px`;
}

const drawn = new Map();
let turn = 0;
async function draw() {
  const mine = ++turn, want = filters(), theme = themeNow();
  const cells = cellsOf(study, want), points = pointsOf(study, cells, want);
  for (const [id, make] of Object.entries(kCharts)) {
    const figure = document.getElementById(id), plot = figure.querySelector(".plot");
    const narrow = plot.clientWidth < 560, size = { width: Math.max(200, plot.clientWidth - 78), height: narrow ? 300 : 400 };
    const chart = make({ cells, points, want, size, theme, narrow });
    const title = figure.querySelector("h3").textContent;
    figure.querySelector(".caption").textContent = chart.count ? chart.caption : "Nothing to draw with these filters.";
    figure.querySelector(".note").textContent = chart.note;
    figure.querySelector(".orders")?.remove();
    if (chart.items.length) figure.querySelector(".note").before(orderList(chart.items, theme));
    figure.dataset.marks = chart.count;
    figure.dataset.result = JSON.stringify(chart.data ?? {});
    plot.hidden = chart.count === 0;
    drawn.get(id)?.finalize();
    drawn.delete(id);
    if (!chart.count) continue;
    const spec = { ...chart.spec, description: `${title}. ${chart.caption}`, autosize: { type: "pad", contains: "padding" }, padding: 4, config: configOf(theme) };
    const result = await vegaEmbed(plot, spec, { mode: "vega-lite", renderer: "svg", actions: false, ast: true, tooltip: showBubble });
    if (mine !== turn) return result.finalize();
    drawn.set(id, result);
  }
  say(want, points);
  document.body.dataset.drawn = mine;
}

function marker(series, theme) {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg"), path = document.createElementNS("http://www.w3.org/2000/svg", "path");
  svg.setAttribute("viewBox", "-8 -8 16 16");
  svg.setAttribute("class", "marker");
  svg.setAttribute("aria-hidden", "true");
  const outline = { circle: "M6,0A6,6 0 1 1 -6,0A6,6 0 1 1 6,0Z", square: "M-5.5,-5.5H5.5V5.5H-5.5Z", "triangle-up": "M0,-7L7,5.5H-7Z",
    diamond: "M0,-7.5L7.5,0L0,7.5L-7.5,0Z", "triangle-down": "M0,7L7,-5.5H-7Z", cross: "M-2.5,-7H2.5V-2.5H7V2.5H2.5V7H-2.5V2.5H-7V-2.5H-2.5Z" };
  path.setAttribute("d", outline[kShapes[series.marker]]);
  path.setAttribute("fill", theme.series.find(one => one.name === series.name).color);
  svg.append(path);
  return svg;
}

function orderList(items, theme) {
  const list = document.createElement("ul");
  list.className = "orders";
  for (const [index, words] of items) {
    const item = document.createElement("li");
    item.append(marker(study.series[index], theme), words);
    list.append(item);
  }
  return list;
}

function say(want, points) {
  const within = quickestWithin(points, study.floors[want.metric.name]?.right ?? null);
  const all = new Set(study.cells.filter(cell => cell[1] === want.drawing).map(cell => cell[0])).size;
  let words = `${points.length} of ${all} models.`;
  if (want.metric.distance && points.length) {
    words += within ? ` Quickest within ${study.tolerance} px: ${within.name}, ${errorText(within.error, want.metric)} in ${kUnits.ms(within.ms)}.`
      : ` None within ${study.tolerance} px.`;
  }
  document.querySelector(".filters .status").textContent = words;
  chosen("metric").title = want.metric.definition;
  for (const cell of document.querySelectorAll("figure.cell")) {
    cell.hidden = Number(cell.dataset.drawing) !== want.drawing || !want.series.has(study.models[cell.dataset.model].series);
  }
}

function fill(select, options, value) {
  select.replaceChildren(...options.map(([text, key]) => new Option(text, key)));
  select.value = value;
  // A choice of one is none.
  select.closest("label").hidden = options.length < 2;
}
function fillParameters(value) {
  const own = study.drawings.filter(one => one.method === chosen("method").value).map(one => one.parameters);
  fill(chosen("parameters"), own.map(text => [text || "its defaults", text]), own.includes(value) ? value : own[0]);
}

function start() {
  const section = document.querySelector(".filters");
  if (!section) return;
  const main = study.drawings[study.mainDrawing];
  fill(chosen("method"), [...new Set(study.drawings.map(one => one.method))].map(name => [name, name]), main.method);
  fillParameters(main.parameters);
  fill(chosen("view"), [["all, their median", "all"], ...study.views.map(view => [`view ${view}`, view])], "all");
  if (study.views.length < 2) chosen("view").closest("label").hidden = true;
  fill(chosen("metric"), study.metrics.filter(metric => metric.lower).map(metric => [metric.label + (metric.unit ? ` [${metric.unit}]` : ""), metric.name]), study.mainMetric);
  const box = section.querySelector("fieldset"), theme = themeNow();
  study.series.forEach((series, index) => {
    const label = document.createElement("label"), input = document.createElement("input");
    Object.assign(input, { type: "checkbox", value: index, checked: true });
    label.append(input, marker(series, theme), series.name);
    box.append(label);
  });
  section.hidden = false;
  section.addEventListener("change", event => {
    if (event.target === chosen("method")) fillParameters(chosen("parameters").value);
    draw();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  let width = innerWidth, timer = 0;
  addEventListener("resize", () => {
    if (innerWidth === width) return;
    width = innerWidth;
    clearTimeout(timer);
    timer = setTimeout(draw, 150);
  });
  addEventListener("scroll", () => { bubble.hidden = true; }, { passive: true });
  addEventListener("keydown", event => { if (event.key === "Escape") bubble.hidden = true; });
  if (study.metrics.some(metric => metric.lower)) draw();
}
start();
