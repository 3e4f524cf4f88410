/** One drawing per animation frame, whoever asks for it and however often. */

type Drawing = (now: number) => void;

const wanted = new Set<Drawing>();
let scheduled = false;

/** Counts for the tests of smoothness: frames drawn, and the ms spent in them. */
export const frameCounts = { frames: 0, busy_ms: 0 };

function run(now: number): void {
  scheduled = false;
  const due = [...wanted];
  wanted.clear();
  const begin = performance.now();
  for (const draw of due) draw(now);
  frameCounts.frames += 1;
  frameCounts.busy_ms += performance.now() - begin;
}

export function onNextFrame(draw: Drawing): void {
  wanted.add(draw);
  if (scheduled) return;
  scheduled = true;
  requestAnimationFrame(run);
}

export function notOnNextFrame(draw: Drawing): void {
  wanted.delete(draw);
}
