/** What to do about a condition that keeps the autopilot from engaging. */

const ADVICE: readonly (readonly [RegExp, string])[] = [
  [/engage switch.*silent|engage switch/i, "Switch the engage switch on, and check its sensor in Health."],
  [/missing|too old|frozen/i, "Check this sensor's age in Health, its cable and its configuration."],
  [/paused/i, "Continue the simulator."],
  [/too slow|below the floor/i, "Speed up, or upload a plan that takes off from here. An upload puts the built-in aircraft back on its runway."],
  [/bank or pitch|spin/i, "Level the aircraft first."],
  [/settling/i, "Wait: navigation settles within 20 s while the aircraft is still."],
  [/time has stopped|nothing arrives/i, "Check that the simulator runs and reaches this board."],
  [/replay/i, "End the simulator's replay."],
  [/another autopilot/i, "Switch the other autopilot off."],
  [/contradict|implausible/i, "Compare the sensors in Health; calibrate the one that differs."],
  [/reloaded|jumped/i, "Wait until the aircraft stands or flies undisturbed."],
  [/pilot moves/i, "Release the stick and the pedals."],
];

export const adviceFor = (condition: string): string | null =>
  ADVICE.find(([pattern]) => pattern.test(condition))?.[1] ?? null;
