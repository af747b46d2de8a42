// Opens a log with a layout in Lichtblick, and takes a picture of it.
//
//     node viewer.mjs --viewer FOLDER --browser FILE --log FILE --layout FILE --time TIME --picture FILE
//
// FOLDER is a web build of Lichtblick, and TIME the moment to show, such as 2026-05-14T09:30:24Z. Prints what the viewer
// complains of; the exit code is 1 if there is an error among it. Nothing on the network is reached, so the map has no
// tiles.

import { createReadStream, readFileSync, statSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";
import { parseArgs } from "node:util";
import { chromium } from "playwright-core";

const SIZE = { width: 1600, height: 1000 };

// Drawing without a graphics card takes a minute or two.
const TIMEOUT_MS = 600_000;

// Where a production build of the viewer has room for a layout to begin with.
const LAYOUT_PLACEHOLDER = "/*LICHTBLICK_SUITE_DEFAULT_LAYOUT_PLACEHOLDER*/";

const CONTENT_TYPES = {
  ".css": "text/css",
  ".js": "text/javascript",
  ".json": "application/json",
  ".png": "image/png",
  ".svg": "image/svg+xml",
  ".wasm": "application/wasm",
};

// What the viewer remembers of earlier runs.
const SETTINGS = {
  "fox.workspace": { state: { sidebars: { left: { open: false }, right: { open: false } } }, version: 1 },
  "studio.app-configuration.colorScheme": "light",
  "studio.app-configuration.timezone": "UTC",
  "studio.app-configuration.launchPreference": "web",
  "studio.app-configuration.telemetry.telemetryEnabled": false,
  "studio.app-configuration.telemetry.crashReportingEnabled": false,
};

function readOptions() {
  const names = ["viewer", "browser", "log", "layout", "time", "picture"];
  const { values } = parseArgs({ options: Object.fromEntries(names.map((name) => [name, { type: "string" }])) });
  for (const name of names) {
    if (!values[name]) throw new Error(`--${name} is missing`);
  }
  return values;
}

// Logs are read in ranges.
function sendFile(request, response, file) {
  const { size } = statSync(file);
  const range = /^bytes=(\d+)-(\d*)$/.exec(request.headers.range ?? "");
  const start = range ? Number(range[1]) : 0;
  const end = range?.[2] ? Math.min(Number(range[2]), size - 1) : size - 1;
  response.writeHead(range ? 206 : 200, {
    "content-type": CONTENT_TYPES[extname(file)] ?? "application/octet-stream",
    "content-length": end - start + 1,
    "accept-ranges": "bytes",
    ...(range && { "content-range": `bytes ${start}-${end}/${size}` }),
  });
  if (request.method === "HEAD") {
    response.end();
  } else {
    createReadStream(file, { start, end }).pipe(response);
  }
}

function readPage(viewer, layout) {
  const page = readFileSync(join(viewer, "index.html"), "utf8");
  if (!page.includes(LAYOUT_PLACEHOLDER)) {
    throw new Error(`${viewer} is not a production build of Lichtblick`);
  }
  const script = JSON.stringify(JSON.parse(readFileSync(layout, "utf8"))).replaceAll("<", "\\u003c");
  return page.replace(LAYOUT_PLACEHOLDER, () => script);
}

async function serve({ viewer, log, layout }) {
  const page = readPage(viewer, layout);
  const server = createServer((request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url, "http://localhost").pathname));
    const file = join(viewer, path);
    if (path === "/") {
      response.writeHead(200, { "content-type": "text/html" }).end(page);
    } else if (path === "/log.mcap") {
      sendFile(request, response, log);
    } else if (statSync(file, { throwIfNoEntry: false })?.isFile()) {
      sendFile(request, response, file);
    } else {
      response.writeHead(404).end();
    }
  });
  await new Promise((done) => server.listen(0, "127.0.0.1", done));
  return server;
}

// Runs in the page. Not all that the viewer knows is in the page's text, so this reads its stores, which it finds through
// React.
function readViewer() {
  const root = document.querySelector("#root");
  const key = Object.keys(root).find((name) => name.startsWith("__reactContainer$"));
  const stores = [];
  const fibers = key ? [root[key].stateNode.current] : [];
  while (fibers.length > 0) {
    const fiber = fibers.pop();
    const value = fiber.memoizedProps?.value;
    if (typeof value?.getState === "function") stores.push(value.getState());
    fibers.push(...[fiber.sibling, fiber.child].filter(Boolean));
  }
  const player = stores.find((store) => store.public?.playerState)?.public.playerState;
  if (!player) return undefined;

  const alerts = stores.find((store) => Array.isArray(store.alerts))?.alerts ?? [];
  const problems = [...(player.alerts ?? []), ...alerts].map(({ severity, message, error, tip }) => ({
    severity,
    text: [message, error?.message ?? error, tip].filter(Boolean).join(": "),
  }));
  const addError = (text) => problems.push({ severity: "error", text });
  const visit = (path, node) => {
    if (node?.error) addError(`${path}: ${node.error}`);
    const inside = { ...node?.fields, ...node?.children };
    for (const [name, child] of Object.entries(inside)) visit(`${path} > ${child?.label ?? name}`, child);
  };
  const settings = stores.find((store) => store.settingsTrees)?.settingsTrees ?? {};
  for (const [panel, tree] of Object.entries(settings)) visit(panel, { children: tree?.nodes });
  for (const { textContent } of document.querySelectorAll(".notistack-Snackbar")) addError(textContent);
  for (const text of document.body.innerText.split("\n")) {
    if (/Unknown panel type|unexpected error/i.test(text)) addError(text);
  }
  const time = player.activeData?.currentTime;
  return {
    failed: player.presence === "ERROR",
    ready: player.presence === "PRESENT" && !document.querySelector('[data-testid="progress-plot"]'),
    time: time && time.sec * 1000 + Math.floor(time.nsec / 1e6),
    problems,
  };
}

// The picture, once the viewer shows this time and nothing changes any more. The bar at the top is left out, because it
// shows the address of the log.
async function takePicture(page, time) {
  const bar = await page.locator("[data-tourid=app-bar]").boundingBox({ timeout: TIMEOUT_MS });
  await page.setViewportSize({ width: SIZE.width, height: SIZE.height + bar.height });
  const clip = { x: 0, y: bar.height, ...SIZE };
  const end = Date.now() + TIMEOUT_MS;
  let picture;
  for (let same = 0; same < 3; ) {
    if (Date.now() > end) throw new Error("the viewer does not come to rest");
    await page.waitForTimeout(1000);
    const before = picture;
    picture = await page.screenshot({ clip });
    const viewer = await page.evaluate(readViewer);
    if (viewer?.failed) throw new Error("the viewer cannot open the log");
    same = viewer?.ready && viewer.time === time && before?.equals(picture) ? same + 1 : 0;
  }
  return picture;
}

async function main() {
  const options = readOptions();
  const time = Date.parse(options.time);
  const server = await serve(options);
  const origin = `http://127.0.0.1:${server.address().port}`;
  const browser = await chromium.launch({
    executablePath: options.browser,
    args: [
      "--no-sandbox", // It does not work for root.
      "--use-gl=angle",
      "--use-angle=swiftshader",
      "--enable-unsafe-swiftshader",
      "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
    ],
  });
  const problems = [];
  try {
    const page = await browser.newPage({ viewport: SIZE, locale: "en-US", timezoneId: "UTC" });
    await page.addInitScript((settings) => {
      for (const [name, value] of Object.entries(settings)) localStorage.setItem(name, JSON.stringify(value));
    }, SETTINGS);
    page.on("pageerror", (error) => problems.push({ severity: "error", text: String(error) }));
    page.on("console", (message) => {
      const isNotReached = message.text().includes("ERR_NAME_NOT_RESOLVED");
      if (message.type() === "error" && !isNotReached) problems.push({ severity: "error", text: message.text() });
    });
    const query = new URLSearchParams({ ds: "remote-file", "ds.url": `${origin}/log.mcap`, time: options.time });
    await page.goto(`${origin}/?${query}`);
    writeFileSync(options.picture, await takePicture(page, time));
    problems.push(...(await page.evaluate(readViewer)).problems);
  } finally {
    await browser.close();
    server.close();
  }
  const lines = problems.map(({ severity, text }) => `${severity}: ${text.split("\n")[0]}`);
  for (const line of new Set(lines)) console.error(line);
  process.exitCode = problems.some(({ severity }) => severity === "error") ? 1 : 0;
}

await main();
