import { h } from "../../core/dom"; export function openPlan(..._: unknown[]) { return { element: h("p", {}, "not built yet"), close: () => undefined }; }
