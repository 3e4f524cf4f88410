/** One drawing per animation frame, whoever asks for it and however often. */

type Drawing = (now: number) => void;

let wanted = new Set<Drawing>();
let scheduled = false;

function schedule(): void {
  if (scheduled) return;
  scheduled = true;
  requestAnimationFrame(run);
}

/** What a drawing asks for is drawn in the same frame, unless it was drawn in it already. */
function run(now: number): void {
  const drawn = new Set<Drawing>();
  const later = new Set<Drawing>();
  for (const draw of wanted) {
    wanted.delete(draw);
    if (drawn.has(draw)) later.add(draw);
    else {
      drawn.add(draw);
      try {
        draw(now);
      } catch (error) {
        // One view's mistake does not stop the others from being drawn.
        reportError(error);
      }
    }
  }
  wanted = later;
  scheduled = false;
  if (later.size > 0) schedule();
}

export function onNextFrame(draw: Drawing): void {
  wanted.add(draw);
  schedule();
}

export function notOnNextFrame(draw: Drawing): void {
  wanted.delete(draw);
}
