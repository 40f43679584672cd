// node browser.mjs CHROMIUM FOLDER JOBS: open pages in Chromium, do steps in each, print what came of it.
//
// FOLDER/node_modules has playwright-core. JOBS is a JSON file: a list of {page, options, steps}. A step is
// {evaluate: JavaScript}, {press: key}, {hover: JavaScript of [x, y]}, {click: selector}, {wait: JavaScript},
// {seen: selector}: how many colours an element's picture has.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

const [chromium, folder, jobs] = process.argv.slice(2);
const playwright = createRequire(join(resolve(folder), 'node_modules', '_'))('playwright-core');
const browser = await playwright.chromium.launch({
  executablePath: chromium,
  args: ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--no-sandbox'],
});

async function colours(bytes) {
  const blob = new Blob([Uint8Array.from(atob(bytes), (letter) => letter.charCodeAt(0))]);
  const image = await createImageBitmap(blob);
  const pen = new OffscreenCanvas(image.width, image.height).getContext('2d');
  pen.drawImage(image, 0, 0);
  const { data } = pen.getImageData(0, 0, image.width, image.height);
  return new Set(new Uint32Array(data.buffer)).size;
}

// Playwright's own waiting compiles JavaScript in the page, which its policy forbids.
async function until(page, condition) {
  for (let tries = 0; tries < 200; tries++) {
    if (await page.evaluate(condition)) return;
    await new Promise((done) => setTimeout(done, 50));
  }
  throw new Error(`never: ${condition}`);
}

async function taken(page, step) {
  if (step.evaluate) return page.evaluate(step.evaluate);
  if (step.press) return page.keyboard.press(step.press);
  if (step.hover) return page.mouse.move(...(await page.evaluate(step.hover)));
  if (step.click) return page.click(step.click);
  if (step.wait) return until(page, step.wait);
  const picture = await page.locator(step.seen).screenshot();
  return page.evaluate(colours, picture.toString('base64'));
}

const told = [];
for (const job of JSON.parse(readFileSync(jobs, 'utf8'))) {
  const context = await browser.newContext({ viewport: { width: 800, height: 600 }, ...job.options });
  const page = await context.newPage();
  const asked = [];
  const wrong = [];
  page.on('request', (request) => asked.push(request.url().slice(0, 200)));
  page.on('pageerror', (error) => wrong.push(error.message));
  page.on('console', (message) => message.type() === 'error' && wrong.push(message.text()));
  page.on('dialog', (dialog) => { wrong.push(`dialog: ${dialog.message()}`); dialog.dismiss(); });
  await page.goto(pathToFileURL(job.page).href);
  await page.waitForSelector('html[data-state=ready], html[data-state=failed]', { timeout: 120000 });
  const results = [];
  for (const step of job.steps) results.push((await taken(page, step)) ?? null);
  const state = await page.evaluate('({...document.documentElement.dataset})');
  told.push({ state, asked, wrong, results });
  await context.close();
}
await browser.close();
process.stdout.write(JSON.stringify(told));
