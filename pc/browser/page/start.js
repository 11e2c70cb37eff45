// What is loaded by this page is asked for with the token that the page itself was asked for with.
const told = document.getElementById("told");
try {
  const browser = await import("./seamwright.js" + location.search);
  await browser.default({ module_or_path: "./seamwright.wasm" + location.search });
  await browser.show(document.getElementById("screen"));
  window.seamwright = browser;
  told.remove();
} catch (error) {
  told.textContent = "This page cannot be shown: " + error;
}
