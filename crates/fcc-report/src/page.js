// Zooms a plot: the wheel with Ctrl at the pointer, a drag to move, a double
// click to see all of it again. Fingers zoom the page as they always do.
for (const svg of document.querySelectorAll(".plot svg")) {
  const whole = svg.viewBox.baseVal;
  const all = { x: whole.x, y: whole.y, width: whole.width, height: whole.height };
  let view = { ...all };
  const show = (next) => {
    const width = Math.min(Math.max(next.width, all.width / 40), all.width);
    const height = width * all.height / all.width;
    view = {
      x: Math.min(Math.max(next.x, all.x), all.x + all.width - width),
      y: Math.min(Math.max(next.y, all.y), all.y + all.height - height),
      width, height,
    };
    svg.setAttribute("viewBox", `${view.x} ${view.y} ${view.width} ${view.height}`);
    svg.classList.toggle("zoomed", width < all.width);
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
