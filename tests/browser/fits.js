// Body of a function: what does not fit the window, and curves of one figure that look alike.
const window_ = document.documentElement.clientWidth;
const name = (element) => `${element.tagName} in ${element.closest('[id]')?.id || 'the page'}`;
const wide = [...document.querySelectorAll('body, body *')].filter((element) => {
  const box = element.getBoundingClientRect();
  return box.width > 0 && box.right > window_ + 1 && !element.parentElement?.closest('.sideways') && !element.closest('.skip, .hidden');
}).map(name);
// What moves sideways is reached by keyboard.
const stuck = [...document.querySelectorAll('.sideways')]
  .filter((one) => one.scrollWidth > one.clientWidth && (one.tabIndex !== 0 || getComputedStyle(one).overflowX !== 'auto')).map(name);
const alike = [...document.querySelectorAll('.plot')].flatMap((plot) => {
  const looks = new Map();
  for (const trace of plot._fullData ?? []) {
    // Of a band the edge is drawn in no width; it has the look of its curve.
    if (trace.fill === 'toself' || trace.meta === 'arrows' || trace.visible !== true) continue;
    const { line, marker, mode } = trace;
    const bar = trace.type === 'bar';
    const look = bar ? `${marker.color} ${marker.pattern.shape}` : `${mode.includes('lines') ? `${line.color} ${line.dash}` : ''} ${mode.includes('markers') ? `${marker.color} ${marker.symbol}` : ''}`;
    looks.set(`${trace.type} ${look}`, (looks.get(`${trace.type} ${look}`) ?? new Set()).add(trace.name));
  }
  return [...looks].filter(([, names]) => names.size > 1).map(([look, names]) => `${plot.id}: ${[...names].join(', ')} are ${look}`);
});
const untitled = [...document.querySelectorAll('.plot')].flatMap((plot) => Object.entries(plot._fullLayout ?? {})
  .filter(([key, axis]) => /^[xy]axis/.test(key) && !/[a-z]{3}/i.test(axis.title?.text ?? '')).map(([key]) => `${plot.id} ${key}`));
return { wide, stuck, alike, untitled, page: document.documentElement.scrollWidth - window_ };
