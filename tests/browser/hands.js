// Body of the probe of `figures_answer_the_mouse`: uses the second figure (three panels over time) by mouse.
const plot = document.getElementById('plot-2');
plot.scrollIntoView({ behavior: 'instant' });
const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const at = (element, fraction) => {
  const box = element.getBoundingClientRect();
  return { clientX: box.left + fraction * box.width, clientY: box.top + box.height / 2 };
};
const mouse = (target, kind, where) =>
  target.dispatchEvent(new MouseEvent(kind, { ...where, bubbles: true, cancelable: true, view: window, button: 0, buttons: 1 }));
const span = () => { const [from, to] = plot._fullLayout.xaxis.range; return to - from; };
const shown = () => plot._fullData.filter((trace) => trace.visible === true).length;

const area = plot.querySelector('.nsewdrag');
const result = { span_before: span(), shown_before: shown() };
result.shared_axes = new Set(plot._fullData.map((trace) => trace.xaxis)).size;

result.buttons = [...plot.querySelectorAll('.modebar-btn')].map((button) => button.dataset.title).join(', ');

mouse(area, 'mousemove', at(area, 0.5));
await pause(300);
result.hover = plot.querySelector('.hoverlayer').textContent;

mouse(area, 'mousedown', at(area, 0.3));
for (const step of [0.4, 0.5, 0.6]) mouse(document, 'mousemove', at(area, step));
mouse(document, 'mouseup', at(area, 0.6));
await pause(1000);
result.span_zoomed = span();

for (let click = 0; click < 2; click++) {
  const here = plot.querySelector('.nsewdrag');
  mouse(here, 'mousedown', at(here, 0.5));
  mouse(document, 'mouseup', at(here, 0.5));
  await pause(50);
}
await pause(1000);
result.span_reset = span();

const entry = plot.querySelector('.legendtoggle');
mouse(entry, 'mousedown', at(entry, 0.5));
mouse(entry, 'mouseup', at(entry, 0.5));
await pause(1000);
result.shown_after_click = shown();
return result;
