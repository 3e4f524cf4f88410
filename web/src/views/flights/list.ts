import { h } from "../../core/dom"; export function openFlights(..._: unknown[]) { return { element: h("p", {}, "not built yet"), close: () => undefined }; }
