"use strict";
// Tables are sorted by a click on a heading, and a slider shows one preload of a table at a time.
// Without this everything is there as well: the slider stays hidden, its table does not.

const text = (cell) => cell.textContent.trim();

const number = (cell) => parseFloat(text(cell).replace("−", "-").replace("< ", ""));

function compare(a, b) {
  const [x, y] = [number(a), number(b)];
  if (Number.isNaN(x) !== Number.isNaN(y)) return Number.isNaN(x) ? 1 : -1; // dashes last
  return Number.isNaN(x) ? text(a).localeCompare(text(b)) : x - y;
}

function sortBy(table, column, heading) {
  const up = heading.getAttribute("aria-sort") !== "ascending";
  for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
  heading.setAttribute("aria-sort", up ? "ascending" : "descending");
  const rows = [...table.tBodies[0].rows];
  rows.sort((a, b) => (up ? 1 : -1) * compare(a.cells[column], b.cells[column]));
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

for (const box of document.querySelectorAll(".slider")) {
  const table = document.getElementById(box.dataset.table);
  const rows = [...table.tBodies[0].rows];
  const values = [...new Set(rows.map((row) => text(row.cells[0])))];
  const headings = [...table.tHead.rows[0].cells].map(text);
  const [input, output, shown] = ["input", "output", "tbody"].map((name) => box.querySelector(name));

  function show() {
    const value = values[input.value];
    const picked = rows.filter((row) => text(row.cells[0]) === value);
    output.textContent = `${headings[0]}: ${value}`;
    input.setAttribute("aria-valuetext", output.textContent);
    shown.replaceChildren(
      ...headings.slice(1).map((heading, k) => {
        const row = document.createElement("tr");
        const name = document.createElement("th");
        name.scope = "row";
        name.textContent = heading;
        row.append(name);
        for (const one of picked) {
          const cell = document.createElement("td");
          cell.textContent = text(one.cells[k + 1]);
          row.append(cell);
        }
        return row;
      }),
    );
  }

  input.max = values.length - 1;
  input.value = Math.max(0, values.indexOf(box.dataset.start));
  input.addEventListener("input", show);
  box.hidden = false;
  show();
}

// what a link leads to may be folded
addEventListener("hashchange", () => {
  const folded = document.getElementById(location.hash.slice(1))?.closest("details");
  if (folded) folded.open = true;
});
