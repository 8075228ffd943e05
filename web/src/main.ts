// Entry of the page.
import "./style.css";
import { App } from "./ui/app";
import { showProblem } from "./ui/problems";

try {
  void new App().start();
} catch (error) {
  const detail = error instanceof Error ? error.message : String(error);
  showProblem({ title: "This browser cannot draw the scene", status: 0, code: "no_webgl", detail: `${detail}. The viewer needs WebGL 2; the API and its pictures work without.` });
}
