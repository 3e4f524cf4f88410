import { h } from "../../core/dom"; export function openHealth(..._: unknown[]) { return { element: h("p", {}, "not built yet"), close: () => undefined }; }
