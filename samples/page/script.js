"use strict";
// Without scripts the page still shows everything; with them the table sorts and any two pictures lie one over the other.

function sortBy(head) {
  const row = head.parentElement;
  const body = row.closest("table").tBodies[0];
  const column = [...row.children].indexOf(head);
  const down = head.getAttribute("aria-sort") === "ascending";
  for (const other of row.children) other.removeAttribute("aria-sort");
  head.setAttribute("aria-sort", down ? "descending" : "ascending");
  const key = line => {
    const cell = line.children[column];
    return "value" in cell.dataset ? parseFloat(cell.dataset.value) : cell.textContent;
  };
  const order = (a, b) => {
    if (typeof a === "string") return down ? b.localeCompare(a) : a.localeCompare(b);
    // What has no value stays below in both orders.
    if (Number.isNaN(a) || Number.isNaN(b)) return Number.isNaN(a) - Number.isNaN(b);
    return down ? b - a : a - b;
  };
  body.append(...[...body.rows].sort((a, b) => order(key(a), key(b))));
}
for (const button of document.querySelectorAll("th button")) button.addEventListener("click", () => sortBy(button.closest("th")));

function startViewer(viewer) {
  const cells = [...document.querySelectorAll(".cell")].filter(cell => cell.querySelector(".picture img"));
  if (cells.length < 2) return;
  const slider = viewer.querySelector("img-comparison-slider");
  const stage = viewer.querySelector(".stage");
  const [left, right, zoom] = ["left", "right", "zoom"].map(name => viewer.querySelector(`select[name=${name}]`));
  const cellOf = select => cells[Number(select.value)];

  for (const select of [left, right]) {
    let group = null;
    cells.forEach((cell, index) => {
      if (group === null || group.label !== cell.dataset.method) {
        group = document.createElement("optgroup");
        group.label = cell.dataset.method;
        select.append(group);
      }
      group.append(new Option(cell.dataset.label, index));
    });
  }

  const announce = () => {
    const share = Math.round(slider.value);
    slider.setAttribute("aria-valuenow", share);
    slider.setAttribute("aria-valuetext", `${share} percent ${cellOf(left).dataset.label}, the rest ${cellOf(right).dataset.label}`);
  };
  const moveTo = share => {
    slider.value = Math.min(100, Math.max(0, share));
    announce();
  };
  // The divider stays in the middle of what is seen.
  const centre = () => moveTo(100 * (stage.scrollLeft + stage.clientWidth / 2) / Math.max(slider.offsetWidth, stage.clientWidth));

  const show = (select, slot) => {
    const cell = cellOf(select), source = cell.querySelector(".picture img");
    const target = slider.querySelector(`[slot=${slot}]`);
    target.src = source.src;
    target.alt = source.alt;
    target.width = source.naturalWidth || source.width;
    target.height = source.naturalHeight || source.height;
    const words = viewer.querySelector(`.sides .${slot}`);
    words.querySelector("strong").textContent = cell.dataset.label;
    words.querySelector("span").textContent = [...cell.querySelectorAll(".numbers li, .notes li")].map(item => item.textContent).join("; ");
    viewer.querySelector("button.worst").disabled = !cellOf(right).dataset.worst;
    announce();
  };

  const factor = () => {
    const picture = slider.querySelector("[slot=first]");
    const width = Number(picture.getAttribute("width")), height = Number(picture.getAttribute("height"));
    if (zoom.value !== "fit") return Number(zoom.value);
    return Math.min(stage.clientWidth / width, 0.78 * window.innerHeight / height, 2);
  };
  const resize = () => {
    const picture = slider.querySelector("[slot=first]");
    slider.style.width = `${Math.round(Number(picture.getAttribute("width")) * factor())}px`;
    stage.classList.toggle("enlarged", factor() > 1);
  };
  const lookAt = (x, y) => {
    stage.scrollLeft = x * factor() - stage.clientWidth / 2;
    stage.scrollTop = y * factor() - stage.clientHeight / 2;
    centre();
  };

  left.addEventListener("change", () => show(left, "first"));
  right.addEventListener("change", () => show(right, "second"));
  zoom.addEventListener("change", () => {
    const width = slider.offsetWidth, height = slider.offsetHeight;
    const x = (stage.scrollLeft + stage.clientWidth / 2) / width, y = (stage.scrollTop + stage.clientHeight / 2) / height;
    resize();
    lookAt(Math.min(x, 1) * slider.offsetWidth / factor(), Math.min(y, 1) * slider.offsetHeight / factor());
  });
  viewer.querySelector("button.worst").addEventListener("click", () => {
    const [x, y] = cellOf(right).dataset.worst.split(",").map(Number);
    zoom.value = "8";
    resize();
    lookAt(x, y);
  });
  slider.addEventListener("slide", announce);
  slider.addEventListener("keydown", event => {
    if (event.key === "Home") moveTo(0);
    else if (event.key === "End") moveTo(100);
    else if (!event.key.startsWith("Arrow")) return;
    event.preventDefault();
  });
  window.addEventListener("resize", resize);

  const beside = index => {
    const method = cells[index].dataset.method;
    const reference = cells.findIndex(cell => cell.dataset.method === method && "reference" in cell.dataset);
    right.value = index;
    left.value = reference >= 0 && reference !== index ? reference : left.value;
    show(left, "first");
    show(right, "second");
  };
  cells.forEach((cell, index) => cell.querySelector(".look").addEventListener("click", () => {
    beside(index);
    viewer.scrollIntoView({ block: "start" });
    slider.focus({ preventScroll: true });
  }));

  viewer.hidden = false;
  left.value = 0;
  beside(1);
  resize();
  moveTo(50);
}
for (const viewer of document.querySelectorAll(".viewer")) startViewer(viewer);
