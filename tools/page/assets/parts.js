"use strict";

// Pieces of a report page: an element maker, figures, a sortable table, a histogram, a colour ramp.

/** element("p", { class: "x" }, "text", child) */
function element(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else if (value !== null && value !== undefined && value !== false) node.setAttribute(name, value === true ? "" : value);
  }
  node.append(...children.filter((child) => child !== null && child !== undefined));
  return node;
}

/** Three meaningful digits and three places at most: what is read in mm or px means nothing beyond. No exponent. */
function figure(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "\u2013";
  if (value === 0) return "0";
  return fixed(value, Math.max(0, Math.min(3, 2 - Math.floor(Math.log10(Math.abs(value))))));
}

/** toFixed() without a negative zero. */
function fixed(value, places) {
  return (Number(value.toFixed(places)) + 0).toFixed(places);
}

function facts(list) {
  return element(
    "div",
    { class: "facts" },
    ...list
      .filter(Boolean)
      .map(([value, unit, what]) =>
        element(
          "div",
          { class: "fact" },
          element("b", {}, String(value), unit ? element("small", {}, unit) : null),
          element("span", {}, what),
        ),
      ),
  );
}

/** Light or dark by hand; until it is pressed, as the system says. */
function themeButton() {
  const button = element("button", {
    type: "button",
    class: "theme",
    onclick: () => setTheme(themeNow() === "dark" ? "light" : "dark"),
  });
  const name = () => {
    button.textContent = themeNow() === "dark" ? "Light" : "Dark";
  };
  document.addEventListener("themechange", name);
  name();
  return button;
}

/** columns: [{ name, value(row) -> number or text, show(row) -> text or node, word }]; rows have a `key`. */
class SortableTable {
  constructor(columns, rows, onChoose) {
    this.columns = columns;
    this.rows = rows;
    this.body = element("tbody");
    this.heads = columns.map((column, i) =>
      element(
        "th",
        { class: column.word ? "word" : null, scope: "col" },
        element("button", { type: "button", onclick: () => this.sortBy(i) }, column.name),
      ),
    );
    this.node = element(
      "div",
      { class: "scroll" },
      element("table", {}, element("thead", {}, element("tr", {}, ...this.heads)), this.body),
    );
    this.lines = new Map(
      rows.map((row) => [
        row.key,
        element(
          "tr",
          { onclick: () => onChoose(row.key) },
          ...columns.map((column) =>
            element("td", { class: column.word ? "word" : null }, column.show ? column.show(row) : String(column.value(row))),
          ),
        ),
      ]),
    );
    this.sortBy(0);
  }

  sortBy(i) {
    this.descending = this.sorted === i && !this.descending;
    this.sorted = i;
    const value = this.columns[i].value,
      sign = this.descending ? -1 : 1;
    const missing = (v) => v === null || v === undefined;
    const compare = (a, b) => {
      const x = value(a),
        y = value(b);
      if (missing(x) || missing(y)) return missing(x) - missing(y); // last, either way
      return sign * (typeof x === "string" ? x.localeCompare(y) : x - y);
    };
    this.heads.forEach((head, k) => {
      if (k === i) head.setAttribute("aria-sort", this.descending ? "descending" : "ascending");
      else head.removeAttribute("aria-sort");
    });
    this.body.replaceChildren(...[...this.rows].sort(compare).map((row) => this.lines.get(row.key)));
  }

  choose(key, scroll) {
    for (const line of this.body.querySelectorAll(".chosen")) line.classList.remove("chosen");
    const line = this.lines.get(key);
    if (!line) return;
    line.classList.add("chosen");
    if (scroll) this.node.scrollTo({ top: line.offsetTop - this.node.clientHeight / 2, behavior: "smooth" });
  }
}

function histogram(values, unit) {
  const top = Math.max(...values, 1e-9),
    bins = 24,
    counts = Array(bins).fill(0);
  for (const value of values) counts[Math.min(bins - 1, Math.floor((value / top) * bins))] += 1;
  const most = Math.max(...counts),
    name = "http://www.w3.org/2000/svg";
  const svg = document.createElementNS(name, "svg");
  svg.setAttribute("viewBox", "0 0 480 150");
  svg.setAttribute("class", "bars");
  svg.setAttribute("role", "img");
  svg.setAttribute("aria-label", `distribution of ${values.length} values up to ${figure(top)} ${unit}`);
  const put = (tag, attributes, text) => {
    const node = document.createElementNS(name, tag);
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    if (text) node.textContent = text;
    svg.append(node);
  };
  counts.forEach((count, i) =>
    put("rect", { x: i * 20 + 1, y: 122 - (count / most) * 108, width: 18, height: (count / most) * 108, rx: 2 }),
  );
  put("line", { x1: 0, y1: 122.5, x2: 480, y2: 122.5 });
  [0, 0.5, 1].forEach((share) =>
    put(
      "text",
      { x: share * 480, y: 142, "text-anchor": ["start", "middle", "end"][share * 2] },
      `${figure(share * top)} ${unit}`,
    ),
  );
  put("text", { x: 0, y: 10 }, `${most}`);
  return svg;
}

/** Colour of a share 0..1 along the theme's ramp. */
function rampColour(share, stops) {
  const at = Math.min(0.9999, Math.max(0, share)) * (stops.length - 1),
    i = Math.floor(at),
    part = at - i;
  const parse = (hex) => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16));
  const a = parse(stops[i]),
    b = parse(stops[i + 1]);
  return `rgb(${a.map((x, k) => Math.round(x + part * (b[k] - x))).join(", ")})`;
}

function quantile(values, share) {
  const sorted = values.filter((v) => Number.isFinite(v)).sort((a, b) => a - b);
  return sorted.length ? sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] : null;
}
