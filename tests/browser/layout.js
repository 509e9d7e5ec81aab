// Body of the probe of the layout tests: what is wider than the window, and than a sheet of A4.
const result = { window: innerWidth, page: document.documentElement.scrollWidth, wide: [], paper: [], narrow: [], heads: [] };
const name = (element) => element.id || element.closest('[id]')?.id || element.tagName;

for (const table of document.querySelectorAll('.table table, .plot')) {
  if (table.getBoundingClientRect().right > innerWidth + 0.5) result.wide.push(name(table));
}
// Lines of the tallest head of a table.
const tallest = () => [...document.querySelectorAll('thead')].flatMap((head) => {
  const cell = head.querySelector('th');
  const style = getComputedStyle(cell);
  const inner = cell.getBoundingClientRect().height - parseFloat(style.paddingTop) - parseFloat(style.paddingBottom);
  const lines = Math.round(inner / parseFloat(style.lineHeight));
  return lines > 4 ? [`${name(head)}: ${lines} lines`] : [];
});
result.heads.push(...tallest());

// On paper: the rules for print, on a sheet of A4 less its margins (210 mm - 2 x 14 mm).
const SHEET = 182 / 25.4 * 96;
const rules = [...document.styleSheets].flatMap((sheet) => [...sheet.cssRules]);
const style = document.createElement('style');
style.textContent = rules.filter((rule) => rule.media?.mediaText === 'print')
  .flatMap((rule) => [...rule.cssRules]).filter((rule) => rule.selectorText).map((rule) => rule.cssText).join('\n');
document.head.append(style);
document.body.style.width = SHEET + 'px';
document.body.style.margin = '0';
dispatchEvent(new Event('beforeprint'));
await new Promise((resolve) => setTimeout(resolve, 1500));
for (const table of document.querySelectorAll('.table table')) {
  const over = table.getBoundingClientRect().width - SHEET;
  if (over > 0.5) result.paper.push(`${name(table)}: ${Math.round(over)} px too wide`);
}
for (const plot of document.querySelectorAll('.plot')) {
  const svg = plot.querySelector('.main-svg');
  const box = svg.viewBox.baseVal;
  const shown = svg.getBoundingClientRect();
  // The drawing inside its frame, and the frame on the sheet.
  const drawn = Math.min(shown.width, shown.height * box.width / box.height);
  if (!(drawn > 0.95 * SHEET)) result.narrow.push(`${name(plot)}: ${Math.round(100 * drawn / SHEET)} % of the sheet`);
}
result.heads.push(...tallest());
dispatchEvent(new Event('afterprint'));
return result;
