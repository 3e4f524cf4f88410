/**
 * Thins series out for a plot without losing an extreme: of each part of the range
 * the lowest and the highest value stay, in their order.
 */

export function decimate(time: ArrayLike<number>, series: readonly ArrayLike<number>[], from_s: number, to_s: number, parts: number): [number[], ...number[][]] {
  const first = lowerBound(time, from_s);
  const last = lowerBound(time, to_s);
  const count = last - first;
  if (count <= parts * 2) {
    const indices = Array.from({ length: Math.max(0, count) }, (_, at) => first + at);
    return [indices.map((at) => time[at] ?? NaN), ...series.map((values) => indices.map((at) => values[at] ?? NaN))];
  }
  const times: number[] = [];
  const thinned: number[][] = series.map(() => []);
  for (let part = 0; part < parts; part += 1) {
    const begin = first + Math.floor((part * count) / parts);
    const end = Math.max(begin + 1, first + Math.floor(((part + 1) * count) / parts));
    times.push(time[begin] ?? NaN, time[(begin + end) >> 1] ?? NaN);
    series.forEach((values, which) => {
      let low = begin;
      let high = begin;
      for (let at = begin; at < end; at += 1) {
        const value = values[at] ?? NaN;
        // A NaN is less than nothing: the first real value replaces it.
        if (value < (values[low] ?? NaN) || Number.isNaN(values[low])) low = at;
        if (value > (values[high] ?? NaN) || Number.isNaN(values[high])) high = at;
      }
      thinned[which]?.push(values[Math.min(low, high)] ?? NaN, values[Math.max(low, high)] ?? NaN);
    });
  }
  return [times, ...thinned];
}

function lowerBound(time: ArrayLike<number>, wanted: number): number {
  let low = 0;
  let high = time.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((time[middle] ?? 0) < wanted) low = middle + 1;
    else high = middle;
  }
  return low;
}
