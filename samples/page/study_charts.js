"use strict";
// What the charts look like: each function makes a vega-lite specification from numbers that study.js has worked out.

const kShapes = ["circle", "square", "triangle-up", "diamond", "triangle-down", "cross"];
const kUnits = {
  ms: value => value >= 1000 ? `${+(value / 1000).toPrecision(3)} s` : `${+value.toPrecision(3)} ms`,
  bytes: value => {
    const [factor, unit] = value >= 1e9 ? [1e9, "GB"] : value >= 1e6 ? [1e6, "MB"] : value >= 1e3 ? [1e3, "kB"] : [1, "B"];
    return `${+(value / factor).toPrecision(4)} ${unit}`;
  },
};
// The same texts on vega's axes; its own expressions, because the page may not make scripts from text.
const kAxisLabels = {
  ms: "datum.value >= 1000 ? format(datum.value / 1000, '~r') + ' s' : format(datum.value, '~r') + ' ms'",
  bytes: "datum.value >= 1e9 ? format(datum.value / 1e9, '~r') + ' GB' : datum.value >= 1e6 ? format(datum.value / 1e6, '~r') + ' MB' : " +
    "datum.value >= 1e3 ? format(datum.value / 1e3, '~r') + ' kB' : format(datum.value, '~r') + ' B'",
};

// An axis around `values`, `length` px long.
function logAxis(values, title, unit, least, length) {
  const { low, high, floor, clamped } = logRange(values, least, 0.07);
  return { domain: [low, high], floor, clamped, title, unit, ticks: logTicks(low, high, length), shown: value => Math.max(value, floor) };
}

const share = (axis, value) => Math.log(axis.shown(value) / axis.domain[0]) / Math.log(axis.domain[1] / axis.domain[0]);
const valueAt = (axis, part) => axis.domain[0] * Math.pow(axis.domain[1] / axis.domain[0], part);

function scaled(field, axis, more = {}) {
  return {
    field, type: "quantitative", scale: { type: "log", domain: axis.domain, nice: false, clamp: true },
    axis: { title: axis.title, values: axis.ticks, grid: true, labelOverlap: "greedy",
      ...(kAxisLabels[axis.unit] ? { labelExpr: kAxisLabels[axis.unit] } : { format: "~r" }) }, ...more,
  };
}

const bySeries = series => ({
  color: { field: "series", type: "nominal", legend: null, scale: { domain: series.map(one => one.name), range: series.map(one => one.color) } },
  shape: { field: "series", type: "nominal", legend: null,
    scale: { domain: series.map(one => one.name), range: series.map(one => kShapes[one.marker]) } },
});
const colorOnly = series => ({ color: bySeries(series).color });

// Free places for words beside points, in px; what has no room stays without.
function placeLabels(points, box, measure) {
  const taken = points.map(point => ({ x: point.px - 6, y: point.py - 6, width: 12, height: 12 }));
  const free = one => one.x >= 0 && one.y >= 0 && one.x + one.width <= box.width && one.y + one.height <= box.height &&
    !taken.some(other => other.x < one.x + one.width && one.x < other.x + other.width && other.y < one.y + one.height && one.y < other.y + other.height);
  const placed = [];
  for (const point of points.filter(one => one.label)) {
    const width = measure(point.label) + 4, height = 15;
    place: for (const away of [9, 22, 38, 58, 82]) {
      for (const x of [point.px + 0.7 * away, point.px - 0.7 * away - width, point.px - 0.5 * width]) {
        for (const y of [point.py - away - 0.5 * height, point.py + away - 0.5 * height]) {
          const spot = { x, y, width, height };
          if (!free(spot)) continue;
          taken.push(spot);
          placed.push({ point, x: x + 2, y: y + 0.5 * height, endX: Math.min(Math.max(point.px, x), x + width), endY: y < point.py ? y + height : y,
            away });
          break place;
        }
      }
    }
  }
  return placed;
}

function labelLayers(points, x, y, size, theme) {
  const at = points.map(point => ({ ...point, px: size.width * share(x, point.x), py: size.height * (1 - share(y, point.y)) }));
  const labels = placeLabels(at, size, theme.measure).map(one => ({
    words: one.point.label, x: one.point.x, y: one.point.y, lx: valueAt(x, one.x / size.width), ly: valueAt(y, 1 - one.y / size.height),
    ex: valueAt(x, one.endX / size.width), ey: valueAt(y, 1 - one.endY / size.height), far: one.away > 10,
  }));
  const plain = (field, axis) => ({ field, type: "quantitative", scale: { type: "log", domain: axis.domain, nice: false, clamp: true } });
  return [
    { data: { values: labels.filter(one => one.far) }, mark: { type: "rule", color: theme.soft, strokeWidth: 0.8 },
      encoding: { x: plain("x", x), y: plain("y", y), x2: { field: "ex" }, y2: { field: "ey" } } },
    { data: { values: labels }, mark: { type: "text", align: "left", baseline: "middle", fontSize: 11.5, color: theme.ink },
      encoding: { x: plain("lx", x), y: plain("ly", y), text: { field: "words" } } },
  ];
}

// Grey where errors cannot be told from none; `channel` is the error's axis.
function floorLayers(floor, axis, channel, theme) {
  const px = floor?.px ?? null;
  if (px === null || px <= axis.domain[0]) return [];
  const at = field => ({ field, type: "quantitative", scale: { type: "log", domain: axis.domain, nice: false, clamp: true } });
  const values = [{ low: axis.domain[0], px: Math.min(px, axis.domain[1]), words: `${floor.words}: not to be told from no error` }];
  return [
    { data: { values }, mark: { type: "rect", color: theme.soft, opacity: 0.14, name: "floor" }, encoding: { [channel]: at("low"), [`${channel}2`]: { field: "px" } } },
    { data: { values }, mark: { type: "text", align: "left", baseline: "top", fontSize: 11, color: theme.soft, dx: 5, dy: 4, x: 0, y: 0, ...(channel === "y" ? { y: undefined } : {}) },
      encoding: { ...(channel === "y" ? { y: at("px") } : {}), text: { field: "words" } } },
  ];
}

const kPointer = { tooltip: { expr: "datum" } };

// points: {x, y, series, name, label}, those of the front with a label, in order.
function accuracySpec(points, front, x, y, size, series, theme, floor) {
  return {
    ...size, layer: [
      ...floorLayers(floor, y, "y", theme),
      { data: { values: front.length ? [...front, { x: x.domain[1], y: front.at(-1).y }] : [] },
        mark: { type: "line", interpolate: "step-after", color: theme.ink, strokeWidth: 1.6, name: "front" }, encoding: { x: scaled("x", x), y: scaled("y", y) } },
      { data: { values: points }, mark: { type: "point", filled: true, opacity: 1, stroke: theme.card, strokeWidth: 1, ...kPointer },
        encoding: { x: scaled("x", x), y: scaled("y", y), ...bySeries(series),
          size: { condition: { test: "isValid(datum.label)", value: 150 }, value: 60 } } },
      ...labelLayers(points, x, y, size, theme),
    ],
  };
}

// fits: two points a series, both ends of the fitted line.
function orderSpec(points, fits, x, y, size, series, theme, floor) {
  const position = { x: scaled("x", x), y: scaled("y", y) };
  return {
    ...size, layer: [
      ...floorLayers(floor, y, "y", theme),
      { data: { values: points }, mark: { type: "line", strokeWidth: 1.2, opacity: 0.4 }, encoding: { ...position, ...colorOnly(series) } },
      { data: { values: fits }, mark: { type: "line", strokeWidth: 2, strokeDash: [6, 4], clip: true }, encoding: { ...position, ...colorOnly(series) } },
      { data: { values: points }, mark: { type: "point", filled: true, opacity: 1, size: 80, stroke: theme.card, strokeWidth: 1, ...kPointer },
        encoding: { ...position, ...bySeries(series) } },
      ...labelLayers(points, x, y, size, theme),
    ],
  };
}

// rows: {name, series, low, lowQuartile, median, highQuartile, high}; marks: {name, series, x}.
function viewsSpec(rows, marks, x, size, series, theme, narrow, floor) {
  const names = rows.map(row => row.name);
  const y = { field: "name", type: "nominal", sort: names, scale: { domain: names },
    axis: narrow ? null : { title: null, labelLimit: 320, ticks: false, grid: false, domain: false } };
  const at = field => scaled(field, x);
  const layer = [
    ...floorLayers(floor, x, "x", theme),
    { data: { values: rows }, mark: { type: "rule", strokeWidth: 1 }, encoding: { y, x: at("low"), x2: { field: "high" }, ...colorOnly(series) } },
    { data: { values: rows }, mark: { type: "bar", opacity: 0.25, height: 15 },
      encoding: { y, x: at("lowQuartile"), x2: { field: "highQuartile" }, ...colorOnly(series) } },
    { data: { values: marks }, mark: { type: "point", filled: true, opacity: 1, size: 45, stroke: theme.card, strokeWidth: 1, ...kPointer },
      encoding: { y, x: at("x"), ...bySeries(series) } },
    { data: { values: rows }, mark: { type: "tick", color: theme.ink, thickness: 2.5, size: 20, opacity: 1, ...kPointer }, encoding: { y, x: at("median") } },
  ];
  // Names above their rows, where beside them there is no room.
  if (narrow) {
    layer.push({ data: { values: rows }, mark: { type: "text", align: "left", x: 3, dy: -16, fontSize: 11, color: theme.ink },
      encoding: { y, text: { field: "name" } } });
  }
  return { width: size.width, height: { step: narrow ? 46 : 30 }, layer };
}

// slope: px for a degree, {low, median, high}, or null.
function normalSpec(points, slope, x, y, size, series, theme, floor) {
  const layer = floorLayers(floor, y, "y", theme), position = { x: scaled("x", x), y: scaled("y", y) };
  if (slope) {
    // What leaves the chart is bent to its edge: the line has many points, and those outside are not among them.
    const ends = Array.from({ length: 121 }, (_, i) => valueAt(x, i / 120))
      .map(degrees => ({ x: degrees, y: slope.median * degrees, low: slope.low * degrees, high: slope.high * degrees }));
    const inside = ends.filter(one => one.y >= y.domain[0] && one.y <= y.domain[1]);
    layer.push({ data: { values: ends }, mark: { type: "area", color: theme.soft, opacity: 0.18, clip: true },
      encoding: { x: scaled("x", x), y: scaled("low", y), y2: { field: "high" } } });
    layer.push({ data: { values: inside }, mark: { type: "line", color: theme.ink, strokeWidth: 1.8, strokeDash: [6, 4], clip: true }, encoding: position });
  }
  layer.push({ data: { values: points }, mark: { type: "point", filled: true, opacity: 0.9, size: 50, stroke: theme.card, strokeWidth: 1, ...kPointer },
    encoding: { ...position, ...bySeries(series) } });
  return { ...size, layer };
}
