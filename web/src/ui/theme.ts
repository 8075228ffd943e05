// Light or dark: what was chosen in this browser, else what the system prefers.
import type { Theme } from "../render/shading";

const kKey = "chosen-theme";

export const kLight = matchMedia("(prefers-color-scheme: light)");

export function themeNow(): Theme {
  const chosen = localStorage.getItem(kKey);
  return chosen === "light" || chosen === "dark" ? chosen : kLight.matches ? "light" : "dark";
}

export function chooseTheme(theme: Theme): void {
  localStorage.setItem(kKey, theme);
}
