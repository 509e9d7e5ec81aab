// See tests/src/browser.rs: this runs before anything else on the page under test.
'use strict';
(() => {
  const complaints = [];
  const note = (kind, what) => complaints.push(`${kind}: ${what}`);
  // Captured, so that a resource that fails to load is seen too.
  addEventListener('error', (event) => note('error', event.message || `cannot load ${event.target?.outerHTML?.slice(0, 200)}`), true);
  addEventListener('unhandledrejection', (event) => note('unhandled rejection', event.reason));
  document.addEventListener('securitypolicyviolation', (event) => note('policy', `${event.violatedDirective} ${event.blockedURI}`));
  for (const level of ['error', 'warn']) {
    const original = console[level];
    console[level] = (...what) => { note(`console.${level}`, what.join(' ')); original.apply(console, what); };
  }

  const figures = () => [...document.querySelectorAll('.plot')].map((place) => {
    const data = JSON.parse(document.getElementById(place.id.replace('plot', 'data')).textContent);
    const shown = (trace) => trace.x.some((x, i) => x !== null && trace.y[i] !== null);
    const inked = (group) => [...group.querySelectorAll('path')].some((path) => (path.getAttribute('d') || '').length > 4);
    return {
      expected: data.traces.filter(shown).length,
      // The arrows of a path are a trace of their own to plotly.
      drawn: [...place.querySelectorAll('.scatterlayer .trace, .barlayer .trace')]
        .filter((group) => group.__data__?.[0]?.trace?.meta !== 'arrows').filter(inked).length,
      axis_titles: [...place.querySelectorAll('.xtitle, .ytitle, .y2title, .y3title, .y4title, .y5title, .y6title')].map((title) => title.textContent),
    };
  });

  const probe = async () => { /*PROBE*/ };

  const report = async () => {
    let result = null, drawn = [];
    try { drawn = figures(); result = (await probe()) ?? null; } catch (error) { note('probe', error.stack); }
    // What the browser reports late (a failed load, a rejected promise) is still to come.
    await new Promise((resolve) => setTimeout(resolve, 500));
    const requests = performance.getEntriesByType('resource').map((entry) => entry.name)
      .filter((name) => !name.startsWith('data:') && !name.startsWith('blob:'));
    const element = document.createElement('script');
    element.type = 'application/json';
    element.id = 'collected';
    element.textContent = JSON.stringify({ complaints, requests, figures: drawn, probe: result,
      height: document.documentElement.scrollHeight }).replace(/</g, '\\u003c');
    document.body.append(element);
  };

  addEventListener('load', () => {
    let left = 400;
    const wait = setInterval(() => {
      const done = !document.querySelector('.plot') || document.documentElement.dataset.figures === 'drawn';
      if (!done && --left > 0) return;
      clearInterval(wait);
      if (!done) note('figures', 'not drawn after 20 s of the page\'s own time');
      report();
    }, 50);
  });
})();
