// On a narrow screen the panels are a sheet at the bottom, which a button folds.

const NARROW = "(max-width: 760px)";

export function showSheet(): void {
  const button = document.getElementById("sheet")!;
  const fold = (open: boolean): void => { button.setAttribute("aria-expanded", String(open)); };
  button.addEventListener("click", () => fold(button.getAttribute("aria-expanded") !== "true"));
  fold(!matchMedia(NARROW).matches);
}
