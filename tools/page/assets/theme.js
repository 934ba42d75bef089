"use strict";

// Before the page is painted: light or dark as the system says, or a button; the last word counts. Tells `themechange`.
const systemDark = matchMedia("(prefers-color-scheme: dark)");
const themeNow = () => document.documentElement.dataset.theme;
function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  document.dispatchEvent(new Event("themechange"));
}
const followSystem = () => setTheme(systemDark.matches ? "dark" : "light");
systemDark.addEventListener("change", followSystem);
followSystem();
