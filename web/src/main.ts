/** The page: four views, one connection. */

import "./design/tokens.css";
import "./design/base.css";
import "./design/shell.css";
import { takeToken } from "./core/api";
import { startShell } from "./shell";
import { startTheme } from "./design/theme";
import { startSession } from "./live/session";

takeToken();
startTheme();
startShell(document.getElementById("app") ?? document.body);
void startSession();
