// Zooms plots: the wheel with Ctrl at the pointer, a drag to move, a double click
// to show all again. Plots over time are zoomed in time, all together: they show
// finer lines then (page.css), and their vertical axes fit the visible part. The
// others are enlarged like pictures. Fingers zoom the page as usual.
const clamp = (value, least, most) => Math.min(Math.max(value, least), most);
const onDrag = (svg, move) => svg.addEventListener("pointermove", (event) => {
  if (event.pointerType === "mouse" && event.buttons === 1) {
    const box = svg.getBoundingClientRect();
    move(event.movementX / box.width, event.movementY / box.height);
  }
});
const onWheel = (svg, zoom) => svg.addEventListener("wheel", (event) => {
  if (!event.ctrlKey && !event.metaKey) return;
  event.preventDefault();
  const box = svg.getBoundingClientRect();
  const across = (event.clientX - box.left) / box.width;
  zoom(Math.exp(event.deltaY * 0.002), across, (event.clientY - box.top) / box.height);
}, { passive: false });

// 1, 2 or 5 times a power of ten, at least as large.
const niceStep = (least) => {
  const decade = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((n) => n * decade).find((step) => step >= least * (1 - 1e-9));
};
const decimalsOf = (step) => Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
const multiples = (from, to, step) => {
  const found = [];
  for (let n = Math.ceil(from / step - 1e-9); n <= to / step + 1e-9; n++) found.push(n * step);
  return found;
};

// The panels of a plot: the lines, and the axis of their values.
function panelsOf(svg) {
  const axes = svg.querySelectorAll(".values");
  return [...svg.querySelectorAll(".curves")].map((curves, n) => {
    const { kind, from, to, least, per } = axes[n].dataset;
    const [top, height] = ["y", "height"].map((name) => +curves.getAttribute(name));
    const marks = [...axes[n].children];
    return { curves, axis: axes[n], marks, kind, from: +from, to: +to, least: +least, per: +per, top, height };
  });
}
// The points of a line: a path of absolute starts and relative moves.
const pointsOf = (path) => {
  const scale = path.classList.contains("detail") ? 0.1 : 1;
  const points = [];
  let x = 0, y = 0;
  for (const [, letter, list] of path.getAttribute("d").matchAll(/([Mhl])([^Mhl]*)/g)) {
    const numbers = list.match(/-?\d+/g).map((number) => number * scale);
    if (letter === "M") {
      [x, y] = numbers;
      points.push([], [x, y]);
    } else if (letter === "h") {
      x += numbers[0];
      points.push([x, y]);
    } else {
      for (let n = 0; n < numbers.length; n += 2) {
        x += numbers[n];
        y += numbers[n + 1];
        points.push([x, y]);
      }
    }
  }
  return points;
};
// The least and the largest y of the lines between two x.
const extentOf = (panel, begin, end) => {
  panel.lines ??= [...panel.curves.querySelectorAll("path:not(.overview)")].map(pointsOf);
  let least = Infinity, most = -Infinity;
  const take = (y) => {
    least = Math.min(least, y);
    most = Math.max(most, y);
  };
  for (const points of panel.lines) {
    for (let n = 0; n < points.length; n++) {
      const [x, y] = points[n];
      if (x >= begin && x <= end) take(y);
      const [lastX, lastY] = points[n - 1] ?? [];
      for (const edge of [begin, end]) {
        if (lastX < edge && x > edge) take(lastY + (edge - lastX) / (x - lastX) * (y - lastY));
      }
    }
  }
  return [least, most];
};
// Fits the axes of values to the visible lines.
const fitValues = ({ panels, left, span }, from, shown) => {
  const all = shown === 1;
  const fitted = panels.filter((panel) => panel.kind);
  const extents = all ? [] : fitted.map((panel) => {
    const valueAt = (y) => panel.to - y / panel.height * (panel.to - panel.from);
    const [top, bottom] = extentOf(panel, from * span, (from + shown) * span);
    return top <= bottom ? [valueAt(bottom), valueAt(top)] : [panel.from, panel.to];
  });
  fitted.forEach((panel, n) => {
    if (all) {
      panel.curves.setAttribute("viewBox", `0 0 ${span} ${panel.height}`);
      panel.axis.replaceChildren(...panel.marks);
      return;
    }
    const together = extents.filter((_, other) =>
      other === n || (panel.kind === "together" && fitted[other].kind === "together"));
    const low = Math.min(...together.map(([low]) => low));
    const high = Math.max(...together.map(([, high]) => high));
    const reach = Math.max(high - low, panel.least) * 0.56;
    const [least, most] = [(low + high) / 2 - reach, (low + high) / 2 + reach];
    const perUnit = panel.height / (panel.to - panel.from);
    panel.curves.setAttribute("viewBox", [
      from * span, (panel.to - most) * perUnit, shown * span, (most - least) * perUnit].join(" "));
    drawValues(panel, left, span, least, most);
  });
};
const drawValues = (panel, left, span, least, most) => {
  const [grid, tick, label] = panel.marks;
  if (!label) return;
  const wanted = (most - least) / panel.per / Math.max(2, panel.height / 320);
  const isCompass = panel.kind === "compass";
  const range = [least / panel.per, most / panel.per];
  let step = isCompass && wanted > 1
    ? [2, 5, 10, 30, 45, 90, 180].find((step) => step >= wanted) ?? 180 : niceStep(wanted);
  // A scale needs at least two ticks.
  for (let n = 0; n < 2 && multiples(...range, step).length < 2; n++) step = niceStep(0.4 * step);
  const text = (value) => isCompass
    ? (((value % 360) + 360) % 360).toFixed(decimalsOf(step)).padStart(3, "0")
    : value.toFixed(decimalsOf(step)).replace(/^-(?=0*\.?0*$)/, "").replace("-", "\u2212");
  const marks = multiples(...range, step).flatMap((value) => {
    const y = panel.top + (most - value * panel.per) / (most - least) * panel.height;
    const [ownGrid, ownTick, ownLabel] = [grid, tick, label].map((mark) => mark.cloneNode());
    ownGrid.setAttribute("points", `${left},${y} ${left + span},${y}`);
    ownTick.setAttribute("points", `${left - 30},${y} ${left},${y}`);
    ownLabel.setAttribute("y", y);
    ownLabel.textContent = text(value);
    return [ownGrid, ownTick, ownLabel];
  });
  panel.axis.replaceChildren(...marks);
};

const plots = [...document.querySelectorAll(".plot > svg[data-end]")].map((svg) => ({
  svg,
  left: +svg.dataset.left,
  span: svg.dataset.right - svg.dataset.left,
  end: svg.dataset.end / svg.dataset.unit,
  whole: svg.viewBox.baseVal.width,
  times: svg.querySelector(".times"),
  panels: panelsOf(svg),
}));
// The part of the time that is shown, of 1.
let from = 0, shown = 1;
const ticks = (end) => {
  const step = niceStep(shown * end / 12);
  const places = multiples(from * end, (from + shown) * end, step);
  return places.map((at) => [at / end, at.toFixed(decimalsOf(step))]);
};
const showTime = (newFrom, newShown) => {
  shown = clamp(newShown, 1 / 400, 1);
  from = clamp(newFrom, 0, 1 - shown);
  for (const plot of plots) {
    const { svg, left, span, end, times } = plot;
    const x = (share) => left + (share - from) / shown * span;
    const marks = ticks(end);
    svg.classList.toggle("zoomed", shown < 1);
    for (const part of svg.querySelectorAll(".time")) {
      const height = part.getAttribute("height");
      part.setAttribute("viewBox", `${from * span} 0 ${shown * span} ${height}`);
      part.querySelector(".grid")?.setAttribute(
        "d", marks.map(([share]) => `M${share * span} 0v${height}`).join(""));
    }
    fitValues(plot, from, shown);
    const word = times.firstElementChild;
    times.replaceChildren(...marks.map(([share, text]) => {
      const shownWord = word.cloneNode();
      shownWord.textContent = text;
      shownWord.setAttribute("x", x(share));
      return shownWord;
    }));
    for (const mark of svg.querySelectorAll(".mark")) {
      mark.dataset.at ??= mark.getAttribute("x");
      const at = x((mark.dataset.at - left) / span);
      mark.setAttribute("x", at);
      mark.style.display = at < left - 1 || at > left + span + 1 ? "none" : "";
    }
  }
};
for (const { svg, left, span, whole } of plots) {
  onWheel(svg, (factor, across) => {
    const share = clamp((across * whole - left) / span, 0, 1);
    const next = clamp(shown * factor, 1 / 400, 1);
    showTime(from + share * (shown - next), next);
  });
  onDrag(svg, (across) => { if (shown < 1) showTime(from - across * whole / span * shown, shown); });
  svg.addEventListener("dblclick", () => showTime(0, 1));
}

for (const svg of document.querySelectorAll(".plot > svg:not([data-end])")) {
  const { width, height } = svg.viewBox.baseVal;
  let view = { x: 0, y: 0, part: 1 };
  const show = (x, y, part) => {
    part = clamp(part, 1 / 40, 1);
    view = { x: clamp(x, 0, width * (1 - part)), y: clamp(y, 0, height * (1 - part)), part };
    svg.setAttribute("viewBox", `${view.x} ${view.y} ${width * part} ${height * part}`);
    svg.classList.toggle("zoomed", part < 1);
  };
  onWheel(svg, (factor, across, down) => {
    const part = clamp(view.part * factor, 1 / 40, 1);
    const less = view.part - part;
    show(view.x + across * width * less, view.y + down * height * less, part);
  });
  onDrag(svg, (across, down) => show(
    view.x - across * width * view.part, view.y - down * height * view.part, view.part));
  svg.addEventListener("dblclick", () => show(0, 0, 1));
}
