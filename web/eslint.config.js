import ts from "typescript-eslint";

const markup = "Texts are data: use textContent or core/dom.ts.";

export default ts.config(
  { ignores: ["dist", "node_modules"] },
  ...ts.configs.strict,
  {
    files: ["src/**/*.ts", "mock/**/*.js"],
    rules: {
      eqeqeq: "error",
      "no-eval": "error",
      "no-implied-eval": "error",
      "no-new-func": "error",
      "no-alert": "error",
      "no-restricted-properties": [
        "error",
        { property: "innerHTML", message: markup },
        { property: "outerHTML", message: markup },
        { property: "insertAdjacentHTML", message: markup },
        { property: "createContextualFragment", message: markup },
        { object: "document", property: "write", message: markup },
      ],
      "@typescript-eslint/no-non-null-assertion": "error",
    },
  },
);
