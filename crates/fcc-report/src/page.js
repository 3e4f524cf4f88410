// Zooms plots: the wheel with Ctrl at the pointer, a drag to move, a double click
// to see all again. Plots over time are zoomed in time, all together, and show
// lines in detail then (page.css); the others as pictures. Fingers zoom the page
// as they always do.
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

const plots = [...document.querySelectorAll(".plot > svg[data-end]")].map((svg) => ({
  svg,
  left: +svg.dataset.left,
  span: svg.dataset.right - svg.dataset.left,
  end: svg.dataset.end / svg.dataset.unit,
  whole: svg.viewBox.baseVal.width,
  times: svg.querySelector(".times"),
}));
// The part of the time that is shown, of 1.
let from = 0, shown = 1;
const ticks = (end) => {
  const least = shown * end / 12;
  const decade = 10 ** Math.floor(Math.log10(least));
  const step = [1, 2, 5, 10].map((n) => n * decade).find((step) => step >= least * (1 - 1e-9));
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const found = [];
  const first = Math.ceil(from * end / step - 1e-9), last = (from + shown) * end / step + 1e-9;
  for (let n = first; n <= last; n++) found.push([n * step / end, (n * step).toFixed(decimals)]);
  return found;
};
const showTime = (newFrom, newShown) => {
  shown = clamp(newShown, 1 / 400, 1);
  from = clamp(newFrom, 0, 1 - shown);
  for (const { svg, left, span, end, times } of plots) {
    const x = (share) => left + (share - from) / shown * span;
    const marks = ticks(end);
    svg.classList.toggle("zoomed", shown < 1);
    for (const part of svg.querySelectorAll(".time")) {
      const height = part.getAttribute("height");
      part.setAttribute("viewBox", `${from * span} 0 ${shown * span} ${height}`);
      part.querySelector(".grid")?.setAttribute(
        "d", marks.map(([share]) => `M${share * span} 0v${height}`).join(""));
    }
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
