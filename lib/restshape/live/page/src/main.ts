// The page: connects to the server and shows what it says.

import { Connection } from "./connection";

const page = document.getElementById("page")!;
new Connection({
  message: (message) => { page.textContent = JSON.stringify(message); },
  frame: (header) => { page.textContent = JSON.stringify(header.columns); },
  connected: (open) => { page.dataset.connected = String(open); },
});
