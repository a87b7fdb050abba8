"use strict";
// Sorts tables by a click on a heading; zooms charts, and states their values at a cursor that a
// slider moves. Without this script, the page has the same content.

const text = (cell) => cell.textContent.trim();

const number = (cell) => parseFloat(text(cell).replace("−", "-").replace("< ", ""));

function compare(a, b) {
  const [x, y] = [number(a), number(b)];
  if (Number.isNaN(x) !== Number.isNaN(y)) return Number.isNaN(x) ? 1 : -1; // dashes last
  return Number.isNaN(x) ? text(a).localeCompare(text(b)) : x - y;
}

function sortBy(table, column, heading) {
  const ascending = heading.getAttribute("aria-sort") !== "ascending";
  for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
  heading.setAttribute("aria-sort", ascending ? "ascending" : "descending");
  const rows = [...table.tBodies[0].rows];
  rows.sort((a, b) => (ascending ? 1 : -1) * compare(a.cells[column], b.cells[column]));
  table.tBodies[0].append(...rows);
}

for (const table of document.querySelectorAll("table.sortable")) {
  [...table.tHead.rows[0].cells].forEach((heading, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.title = "sort";
    button.append(...heading.childNodes);
    button.addEventListener("click", () => sortBy(table, column, heading));
    heading.append(button);
  });
}

// As page/charts.py draws them: margins, axes, ticks.
const LEFT = 56, RIGHT = 14, TOP = 24, BOTTOM = 40, LANE = 9;
const digits = (value) => String(+value.toPrecision(3));

function ticksOf(low, high, log) {
  const ticks = [];
  if (log) {
    const [first, last] = [Math.floor(Math.log10(low)), Math.ceil(Math.log10(high))];
    for (let k = first; k < last; k++)
      for (const m of last - first < 4 ? [1, 2, 5] : [1]) ticks.push(+`${m}e${k}`);
    const inside = ticks.filter((tick) => low <= tick && tick <= high);
    if (inside.length > 1) return inside;
    ticks.length = 0;
  }
  const leastStep = (high - low) / 5, power = 10 ** Math.floor(Math.log10(leastStep));
  const step = [1, 2, 5, 10].map((m) => m * power).find((size) => size >= leastStep);
  for (let k = Math.ceil(low / step); k <= high / step; k++) ticks.push(+(step * k).toPrecision(9));
  return ticks;
}

class Chart {
  constructor(figure) {
    this.figure = figure;
    this.svg = figure.querySelector("svg");
    this.field = figure.querySelector(".field");
    this.cursor = figure.querySelector(".cursor");
    this.data = JSON.parse(this.svg.dataset.chart);
    this.whole = this.data.x;
    this.ratio = this.svg.viewBox.baseVal.height / this.svg.viewBox.baseVal.width;
    this.x = null;
    this.zoomTo(this.whole);
    this.follow();
  }

  share(value, axis) {
    const [low, high] = axis ? this.y : this.at;
    if (!this.data.log[axis]) return (value - low) / (high - low);
    return Math.log(Math.max(value, 1e-300) / low) / Math.log(high / low);
  }

  place(x, y) {
    return [this.share(x, 0) * this.width, (1 - this.share(y, 1)) * this.height];
  }

  value(pixel) { // of the abscissa
    const [low, high] = this.at, share = pixel / this.width;
    return this.data.log[0] ? low * (high / low) ** share : low + share * (high - low);
  }

  zoomTo(range) {
    this.at = range;
    this.y = this.data.y;
    if (range !== this.whole) {
      const inside = this.data.lines.flatMap((line) =>
        line.points.filter(([x, y]) => y !== null && x >= range[0] && x <= range[1]));
      const heights = inside.map((point) => point[1]).filter((y) => y > 0 || !this.data.log[1]);
      if (heights.length > 1) {
        const [low, high] = [Math.min(...heights), Math.max(...heights)];
        const room = 0.08 * (high - low) || 0.1 * Math.abs(high) || 1;
        this.y = this.data.log[1] ? [low / 1.1, high * 1.1] : [low - room, high + room];
      }
    }
    this.draw();
  }

  draw() {
    const width = this.svg.clientWidth || this.svg.viewBox.baseVal.width;
    const height = Math.max(this.ratio * width, Math.min(width, 230));
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.width = width - LEFT - RIGHT; // of the field
    this.height = height - TOP - BOTTOM;
    this.field.setAttribute("width", this.width);
    this.field.setAttribute("height", this.height);
    for (const mark of this.field.querySelectorAll("[data-at]")) {
      const at = mark.dataset.at.split(" ").map(Number);
      const [x, y] = this.place(at[0], at[1]);
      if (at.length === 2) mark.setAttribute("transform", `translate(${x} ${y})`);
      else mark.setAttribute("d", `M${x} ${y}L${this.place(at[2], at[3]).join(" ")}`);
    }
    for (const mark of this.field.querySelectorAll("[data-x]")) {
      const [a, b] = mark.dataset.x.split(" ").map((x) => this.share(+x, 0) * this.width);
      mark.setAttribute("x", a);
      mark.setAttribute("width", Math.max(b - a, 0));
      mark.setAttribute("y", this.height - (+mark.dataset.lane + 1) * LANE);
    }
    for (const label of this.field.querySelectorAll("text.lanes")) {
      label.setAttribute("x", this.share(+label.dataset.from, 0) * this.width + 4);
      label.setAttribute("y", this.height - 4);
    }
    const limit = this.field.querySelector(".limit");
    if (limit) {
      const y = Math.min(Math.max(this.place(1, +limit.dataset.limit)[1], 0), this.height);
      const below = limit.dataset.least === "1";
      limit.setAttribute("width", this.width);
      limit.setAttribute("y", below ? y : 0);
      limit.setAttribute("height", below ? this.height - y : y);
    }
    this.drawGrid();
    this.svg.querySelector("text.x").setAttribute("x", LEFT + this.width / 2);
    this.svg.querySelector("text.x").setAttribute("y", height - 6);
    this.show(this.x);
  }

  drawGrid() {
    const parts = [];
    const xTicks = ticksOf(...this.at, this.data.log[0]);
    const interval = Math.ceil((xTicks.length * 38) / this.width); // of labels, which need room
    xTicks.forEach((tick, k) => {
      const x = LEFT + this.share(tick, 0) * this.width;
      parts.push(["path", { d: `M${x} ${TOP}v${this.height}` }]);
      if (k % interval === 0)
        parts.push(["text", { x, y: TOP + this.height + 16, "text-anchor": "middle" }, tick]);
    });
    for (const tick of ticksOf(...this.y, this.data.log[1])) {
      const y = TOP + (1 - this.share(tick, 1)) * this.height;
      parts.push(["path", { d: `M${LEFT} ${y}h${this.width}` }]);
      parts.push(["text", { x: LEFT - 6, y: y + 4, "text-anchor": "end" }, tick]);
    }
    this.svg.querySelector(".grid").replaceChildren(
      ...parts.map(([name, attributes, label]) => {
        const node = document.createElementNS("http://www.w3.org/2000/svg", name);
        for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
        if (label !== undefined) node.textContent = digits(label);
        return node;
      }),
    );
  }

  near(line, x) { // the index of the point of a line that is nearest on the axis
    const distance = ([abscissa]) => Math.abs(this.share(abscissa, 0) - this.share(x, 0));
    return line.points.reduce((best, point, k) =>
      (distance(point) < distance(line.points[best]) ? k : best), 0);
  }

  show(x) { // the cursor at an abscissa, or the recommendations without one
    this.x = x;
    const at = x === null ? 0 : this.share(x, 0) * this.width;
    this.cursor.setAttribute("d", x === null ? "" : `M${at} 0v${this.height}`);
    this.figure.querySelectorAll(".keys b").forEach((label, k) => {
      const line = this.data.lines[k];
      let point = line.star, note = "";
      if (x !== null) {
        const nearest = this.near(line, x);
        [point, note] = [line.points[nearest], line.notes[nearest]];
      }
      const units = this.data.units;
      const value = point && point[1] !== null ? digits(point[1]) + units[1] : "–";
      const place = point && (x === null ? this.data.places : Math.abs(point[0] / x - 1) > 1e-6);
      label.textContent = value + (place ? ` at ${+point[0].toPrecision(4)}${units[0]}` : "");
      const end = point && line.ends[line.points.findIndex(([at]) => at === point[0])];
      if (end && x !== null) label.textContent += `, ended by ${end}`;
      label.parentElement.classList.toggle("beyond", note !== "");
      label.parentElement.title = note && `requirements violated: ${note}`;
    });
  }

  follow() { // the pointer: values where it is, zoom to a range that it draws, back by two clicks
    let start = null;
    const box = document.createElementNS("http://www.w3.org/2000/svg", "rect");
    box.setAttribute("class", "drawn");
    this.field.append(box);
    const pixel = (event) => {
      const { left, width } = this.svg.getBoundingClientRect();
      const x = ((event.clientX - left) / width) * this.svg.viewBox.baseVal.width - LEFT;
      return Math.min(Math.max(x, 0), this.width);
    };
    const end = () => {
      start = null;
      box.setAttribute("width", 0);
    };
    this.svg.addEventListener("pointerdown", (event) => {
      start = pixel(event);
      this.svg.setPointerCapture(event.pointerId);
    });
    this.svg.addEventListener("pointermove", (event) => {
      const x = pixel(event);
      const nearest = this.data.lines.map((line) => line.points[this.near(line, this.value(x))][0]);
      const distance = (value) => Math.abs(this.share(value, 0) * this.width - x);
      const closest = nearest.reduce((a, b) => (distance(b) < distance(a) ? b : a));
      pick(this.figure.dataset.group, closest);
      if (start === null) return;
      box.setAttribute("x", Math.min(x, start));
      box.setAttribute("width", Math.abs(x - start));
      box.setAttribute("height", this.height);
    });
    this.svg.addEventListener("pointerup", (event) => {
      const range = [start, pixel(event)].sort((a, b) => a - b);
      if (start !== null && range[1] - range[0] > 12) this.zoomTo(range.map((x) => this.value(x)));
      end();
    });
    this.svg.addEventListener("pointercancel", end);
    this.svg.addEventListener("dblclick", () => this.zoomTo(this.whole));
  }
}

const charts = [...document.querySelectorAll(".chart")].map((figure) => new Chart(figure));

function pick(group, x) {
  for (const chart of charts) if (chart.figure.dataset.group === group) chart.show(x);
  for (const slider of sliders) if (slider.group === group) slider.stand(x);
}

const sliders = [...document.querySelectorAll(".slider")].map((box) => {
  const { group } = box.dataset;
  const [input, output, back] = ["input", "output", "button"].map((name) => box.querySelector(name));
  const [first] = charts.filter((chart) => chart.figure.dataset.group === group);
  const stops = [...new Set(first.data.lines.flatMap((line) => line.points.map(([x]) => x)))]
    .sort((a, b) => a - b);
  const stars = first.data.lines.map((line) => line.star).filter((star) => star);
  stars.sort((a, b) => b[1] - a[1]); // the longest life first

  function stand(x) {
    const recommended = stars.some((star) => star[0] === x) ? " (recommended)" : "";
    const at = x === null ? "the recommended preloads; move the slider for other preloads" : `${+x.toPrecision(4)}${first.data.units[0]}${recommended}`;
    output.textContent = x === null && !stars.length ? "Move the slider for values" : `Values at ${at}`;
    input.setAttribute("aria-valuetext", output.textContent);
    if (x !== null) input.value = stops.indexOf(x);
  }

  input.max = stops.length - 1;
  input.value = Math.max(0, stops.indexOf(stars.length ? stars[0][0] : stops[0]));
  input.addEventListener("input", () => pick(group, stops[input.value]));
  back.addEventListener("click", () => pick(group, null));
  back.hidden = !stars.length;
  box.hidden = false;
  stand(null);
  return { group, stand };
});

addEventListener("resize", () => {
  for (const chart of charts) chart.draw();
});

// opens the folded part that contains the target of a link
addEventListener("hashchange", () => {
  const folded = document.getElementById(location.hash.slice(1))?.closest("details");
  if (folded) folded.open = true;
});
