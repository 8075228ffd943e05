// How the page and its picture look: the theme (the system's, until another one is chosen), from which side, and whether the camera follows what moves.
import type { Side } from "../render/framing";
import type { Theme } from "../render/shading";
import type { Stage } from "../render/stage";
import { byId } from "./dom";
import type { Plot } from "./plot";
import { showScale } from "./scale";
import { chooseTheme, kLight, themeNow } from "./theme";

export class Look {
  constructor(
    private readonly stage: Stage,
    private readonly plot: Plot,
  ) {
    this.theme(themeNow());
    kLight.addEventListener("change", () => this.theme(themeNow()));
  }

  private theme(theme: Theme): void {
    document.documentElement.dataset.theme = theme;
    this.stage.setTheme(theme);
    this.plot.restyle();
    showScale(this.stage.colorScale);
    byId("theme").setAttribute("aria-pressed", String(theme === "light"));
  }

  otherTheme(): void {
    const theme = document.documentElement.dataset.theme === "light" ? "dark" : "light";
    chooseTheme(theme);
    this.theme(theme);
  }

  following(on: boolean): void {
    this.stage.framing.follow(on);
    byId("view-follow").setAttribute("aria-pressed", String(on));
  }

  from(side: Side): void {
    this.following(false);
    this.stage.frameAll(side);
  }
}
