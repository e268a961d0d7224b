// Columns sorted by their heads, within each group of rows; areas that scroll sideways say so.
(() => {
"use strict";
const NAMES = { ascending: "lowest first", descending: "highest first", none: "as it was" };

/* Rows that stay together: one of ours, and those of the paper that follow it. */
const blocks = (rows) => rows.reduce((found, row) => {
  if (row.classList.contains("paper") && found.length) found.at(-1).push(row);
  else found.push([row]);
  return found;
}, []);

const key = (row, column) => {
  const cell = row.cells[column];
  if ("value" in cell.dataset) return Number(cell.dataset.value);
  const text = cell.textContent.trim();
  return text === "" || text === "–" ? null : text;
};

/* Numbers before words, what is undefined last, whichever way. */
const compare = (a, b, sign) => {
  if (a === null || b === null) return (a === null) - (b === null);
  if (typeof a !== typeof b) return typeof a === "number" ? -1 : 1;
  return sign * (typeof a === "number" ? a - b : a < b ? -1 : a > b ? 1 : 0);
};

const sort = (bodies, column, way) => bodies.forEach(({ body, was }) => {
  const sorted = was.map((rows) => ({ rows, key: key(rows[0], column) }));
  const sign = way === "descending" ? -1 : 1;
  if (way !== "none") sorted.sort((a, b) => compare(a.key, b.key, sign));
  body.append(...sorted.flatMap(({ rows }) => rows));
});

const sortable = (table) => {
  const heads = [...table.tHead.rows[0].cells];
  const bodies = [...table.tBodies].map((body) => (
    { body, was: blocks([...body.rows].filter((row) => !row.classList.contains("group"))) }));
  const said = table.parentElement.parentElement.appendChild(document.createElement("p"));
  said.className = "unseen";
  said.setAttribute("role", "status");
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    head.setAttribute("aria-sort", "none");
    const first = head.dataset.first || "ascending";
    const ways = [first, first === "ascending" ? "descending" : "ascending", "none"];
    button.addEventListener("click", () => {
      const way = ways[(ways.indexOf(head.getAttribute("aria-sort")) + 1) % 3];
      heads.forEach((other) => other.setAttribute("aria-sort", other === head ? way : "none"));
      sort(bodies, column, way);
      said.textContent = `Sorted by ${head.textContent}: ${NAMES[way]}`;
    });
  });
};

/* An area that does not scroll needs no stop of the tab key. */
const scrolling = (area) => {
  const more = area.scrollWidth - area.clientWidth;
  area.classList.toggle("before", area.scrollLeft > 1);
  area.classList.toggle("after", area.scrollLeft < more - 1);
  area.setAttribute("role", more > 1 ? "region" : "group");
  if (more > 1) area.tabIndex = 0;
  else area.removeAttribute("tabindex");
};

document.querySelectorAll(".table table").forEach(sortable);
document.querySelectorAll(".scroll").forEach((area) => {
  area.addEventListener("scroll", () => scrolling(area), { passive: true });
  new ResizeObserver(() => scrolling(area)).observe(area);
});
})();
