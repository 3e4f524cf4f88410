// Zooms a plot: the wheel with Ctrl at the pointer, a drag to move, a double
// click to see all of it again. Fingers zoom the page as they always do. Zoomed,
// lines are shown in detail (page.css), and the time shown is below the plot.
for (const svg of document.querySelectorAll(".plot svg")) {
  const whole = svg.viewBox.baseVal;
  const all = { x: whole.x, y: whole.y, width: whole.width, height: whole.height };
  let view = { ...all };
  const caption = svg.closest("figure").querySelector("figcaption");
  const range = caption.appendChild(document.createElement("output"));
  const time = (x) => {
    const { left, right, end } = svg.dataset;
    const share = (x - left) / (right - left);
    return (Math.min(Math.max(share, 0), 1) * end).toFixed(2);
  };
  const show = (next) => {
    const width = Math.min(Math.max(next.width, all.width / 40), all.width);
    const height = width * all.height / all.width;
    view = {
      x: Math.min(Math.max(next.x, all.x), all.x + all.width - width),
      y: Math.min(Math.max(next.y, all.y), all.y + all.height - height),
      width, height,
    };
    svg.setAttribute("viewBox", `${view.x} ${view.y} ${view.width} ${view.height}`);
    const zoomed = width < all.width;
    svg.classList.toggle("zoomed", zoomed);
    range.textContent = zoomed && svg.dataset.end
      ? ` Shown: ${time(view.x)} s to ${time(view.x + width)} s.` : "";
  };
  svg.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && !event.metaKey) return;
    event.preventDefault();
    const box = svg.getBoundingClientRect();
    const across = (event.clientX - box.left) / box.width;
    const down = (event.clientY - box.top) / box.height;
    const width = Math.min(view.width * Math.exp(event.deltaY * 0.002), all.width);
    const height = width * all.height / all.width;
    show({ x: view.x + across * (view.width - width), y: view.y + down * (view.height - height), width });
  }, { passive: false });
  svg.addEventListener("pointermove", (event) => {
    if (event.pointerType !== "mouse" || event.buttons !== 1 || view.width === all.width) return;
    const scale = view.width / svg.getBoundingClientRect().width;
    show({ ...view, x: view.x - event.movementX * scale, y: view.y - event.movementY * scale });
  });
  svg.addEventListener("dblclick", () => show(all));
}
