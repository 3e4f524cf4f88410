/** A value that is watched. */

export interface Watched<T> {
  get(): T;
  set(value: T): void;
  /** Calls at once and at each change; returns what ends it. */
  watch(listener: (value: T) => void): () => void;
}

export function watched<T>(initial: T): Watched<T> {
  let current = initial;
  const listeners = new Set<(value: T) => void>();
  return {
    get: () => current,
    set(value) {
      if (Object.is(value, current)) return;
      current = value;
      for (const listener of [...listeners]) listener(value);
    },
    watch(listener) {
      listeners.add(listener);
      listener(current);
      return () => listeners.delete(listener);
    },
  };
}

/** As `watched`, kept in the browser under a key; a preference, not data. */
export function kept<T extends string>(key: string, allowed: readonly T[], initial: T): Watched<T> {
  let stored: string | null = null;
  try {
    stored = localStorage.getItem(key);
  } catch {
    // A browser without storage keeps the preference until the page is closed.
  }
  const value = watched<T>(allowed.find((one) => one === stored) ?? initial);
  value.watch((now) => {
    try {
      localStorage.setItem(key, now);
    } catch {
      // As above.
    }
  });
  return value;
}
