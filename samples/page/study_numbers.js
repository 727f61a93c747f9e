"use strict";
// The numbers that a study's page shows. Medians, quartiles, orders and what beats what come with the page (samples/study/report_looks.h).
// The page reckons only what depends on the series shown, of which there are too many choices to carry, or on the window's width; the
// program has the same functions, and tests/page/numbers.test.mjs gives both the same numbers.
// A choice is {drawing, view (null: all), metric, series (a set)}.

const cellsOf = (study, want) => study.cells.filter(([model, drawing, view]) => drawing === want.drawing &&
  (want.view === null || view === want.view) && want.series.has(study.models[model].series));

const lookOf = (study, want) => study.looks[want.drawing]?.[study.metrics.indexOf(want.metric)]?.[want.view === null ? 0 : 1 + study.views.indexOf(want.view)];

// A model over its views. The program gives [model, beaten in time, beaten in memory] and, of several cells, low, low quartile, median, high
// quartile, high, ms, least ms, largest ms, bytes; what one cell says stands in the cell.
function pointsOf(study, cells, want) {
  const index = study.metrics.indexOf(want.metric), groups = new Map();
  for (const cell of cells) {
    if (cell[5][index] === null) continue;
    if (!groups.has(cell[0])) groups.set(cell[0], []);
    groups.get(cell[0]).push({ view: cell[2], error: Math.abs(cell[5][index]), ms: cell[3], bytes: cell[4], lowMs: cell[6], highMs: cell[7] });
  }
  return (lookOf(study, want)?.points ?? []).filter(([model]) => groups.has(model)).map(([model, inTime, inMemory, ...numbers]) => {
    const views = groups.get(model), [{ error, ms, bytes, lowMs, highMs }] = views, about = study.models[model];
    const [low, lowQuartile, median, highQuartile, high, middleMs, leastMs, largestMs, mostBytes] =
      numbers.length ? numbers : [error, error, error, error, error, ms, lowMs, highMs, bytes];
    return {
      model, views, drawing: want.drawing, name: about.name, series: study.series[about.series].name, resolution: about.resolution,
      analytic: about.analytic, error: median, low, high, lowQuartile, highQuartile, ms: middleMs, lowMs: leastMs, highMs: largestMs, bytes: mostBytes,
      beaten: { ms: inTime, bytes: inMemory },
    };
  });
}

// Those of `points` that nothing shown beats, cheapest first; `cost` is "ms" or "bytes". The program says which series have a model that
// beats a point. On a front the error falls as the cost rises.
function frontOf(points, cost, beating, shown) {
  return points.filter(point => !beating[point.beaten[cost]].some(series => shown.has(series)))
    .sort((a, b) => a[cost] - b[cost] || b.error - a.error);
}

// The quickest of `points` that is right, and of those that may be as quick by the spread of their times the smallest; the analytic surface is
// no model. `right`: the largest error that is right to the tolerance, null where none can be called so.
function quickestWithin(points, right) {
  const able = points.filter(point => right !== null && point.error <= right && !point.analytic);
  const quickest = [...able].sort((a, b) => a.ms - b.ms || a.bytes - b.bytes)[0];
  return able.filter(point => point === quickest || point.lowMs <= quickest.highMs).sort((a, b) => a.bytes - b.bytes || a.ms - b.ms)[0];
}

// Displacement for a degree over the cells shown, [predicted displacement, normal error] each; of an even number the median is the upper one.
function predictedSlope(pairs) {
  const slopes = pairs.map(([predicted, normal]) => Math.abs(predicted) / Math.abs(normal)).filter(one => one > 0 && Number.isFinite(one))
    .sort((a, b) => a - b);
  return slopes.length ? { low: slopes[0], median: slopes[Math.floor(slopes.length / 2)], high: slopes.at(-1) } : null;
}

// The stretch of a logarithmic axis about `values`: zeros, and what is below `least`, are shown at its floor. `room` beyond either end, as a
// share of the stretch, and half a decade at least.
function logRange(values, least, room) {
  const above = values.filter(value => Number.isFinite(value) && value > least);
  const floor = least > 0 ? least : above.length ? 0.5 * Math.min(...above) : 1;
  const clamped = values.filter(value => Number.isFinite(value) && !(value > floor)).length;
  const low = clamped || !above.length ? floor : Math.min(...above), high = Math.max(low, ...above);
  const margin = Math.max(room * Math.log(high / low), 0.5 * (Math.log(3) - Math.log(high / low)), 0.05);
  return { low: low * Math.exp(-margin), high: high * Math.exp(margin), floor, clamped };
}

function logTicks(low, high, length) {
  const decades = Math.log10(high / low), ticks = [];
  const marks = decades < 0.8 ? [1, 1.5, 2, 3, 4, 5, 6, 7, 8, 9] : decades < length / 200 ? [1, 2, 5] : [1];
  const step = Math.max(1, Math.ceil(decades * 46 / length));
  for (let power = Math.floor(Math.log10(low)); power <= Math.ceil(Math.log10(high)); ++power) {
    if (power % step) continue;
    for (const mark of marks) {
      const value = Number(`${mark}e${power}`);
      if (value >= low && value <= high) ticks.push(value);
    }
  }
  return ticks;
}
