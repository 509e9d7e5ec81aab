// Draws every figure of the page from the JSON beside it. The page's Rust code decides what is shown
// (which points, which colour a series has); this file only says it in plotly's words.
'use strict';
(() => {
  const SYMBOLS = ['circle', 'square', 'diamond', 'triangle-up', 'cross', 'triangle-down', 'x', 'star'];
  // Strokes of the looks, and those that a line asks for by itself.
  const STROKES = ['solid', 'dash', 'dot', 'dashdot', 'longdash', 'longdashdot'];
  const DASHES = { dashed: 'dash', dotted: 'dot', faint: 'solid' };
  const PATTERNS = ['', '/', '.', 'x', '-', '|'];
  // From so many series on, lines carry their marker here and there.
  const MANY_SERIES = 8;
  // Of an arrow on a path [px], and strokes [px].
  const ARROW = 11, STROKE = 1.8, THIN = 1.1;
  const CONFIG = {
    responsive: true,
    displaylogo: false,
    doubleClick: 'reset',
    // Named one by one: by itself plotly also offers to send the figure to its makers' cloud.
    modeBarButtons: [['zoom2d', 'pan2d', 'zoomIn2d', 'zoomOut2d', 'resetScale2d'], ['toImage']],
    showSendToCloud: false,
    plotlyServerURL: '',
    toImageButtonOptions: { format: 'svg' },
  };

  // Plotly reads a little HTML in labels; ours are plain text.
  const plain = (text) => text.replace(/&/g, '&amp;').replace(/</g, '&lt;').replace(/>/g, '&gt;');

  const colours = () => {
    const style = getComputedStyle(document.documentElement);
    return (name) => style.getPropertyValue('--' + name).trim();
  };

  const faded = (hex, alpha) => {
    const part = (at) => parseInt(hex.slice(at, at + 2), 16);
    return `rgba(${part(1)},${part(3)},${part(5)},${alpha})`;
  };

  // A band as closed shapes, one for each stretch without a gap.
  const outline = (trace) => {
    const x = [], y = [];
    const usable = (i) => trace.x[i] !== null && trace.y[i] !== null && trace.upper[i] !== null;
    for (let from = 0; from < trace.x.length; from++) {
      if (!usable(from)) continue;
      let to = from;
      while (to + 1 < trace.x.length && usable(to + 1)) to++;
      if (x.length) { x.push(null); y.push(null); }
      for (let i = from; i <= to; i++) { x.push(trace.x[i]); y.push(trace.y[i]); }
      for (let i = to; i >= from; i--) { x.push(trace.x[i]); y.push(trace.upper[i]); }
      from = to;
    }
    return { x, y };
  };

  // 'velocity [rad/s]' as quantity and unit.
  const parts = (label) => {
    const found = /^(.*?)\s*\[([^\]]*)\]$/.exec(label);
    const [quantity, unit] = found ? [found[1], found[2]] : [label, ''];
    return { quantity: plain(quantity), unit: unit && unit !== '-' ? ' ' + plain(unit) : '' };
  };

  // What the box at a point says: quantities with their units, percent signs not taken for placeholders.
  const reading = (figure, panel) => {
    const x = parts(figure.x_label), y = parts(figure.y_labels[panel]);
    const value = `${y.quantity} %{y:.5~g}${y.unit}`;
    if (figure.categories.length) return `%{customdata}: ${value}`;
    return figure.back_and_forth ? `${x.quantity} %{x:.5~g}${x.unit}<br>${value}` : value;
  };

  const toPlotly = (trace, index, all, colour, figure) => {
    const own = trace.colour < 0 ? colour('ink') : colour('c' + trace.colour);
    const common = {
      hovertemplate: `${reading(figure, trace.panel)}<extra>${plain(trace.name)}</extra>`,
      type: 'scatter',
      name: plain(trace.name),
      legendgroup: trace.name,
      showlegend: all.findIndex((other) => other.name === trace.name) === index,
      xaxis: 'x',
      yaxis: trace.panel ? 'y' + (trace.panel + 1) : 'y',
    };
    if (trace.kind === 'band') {
      return { ...common, ...outline(trace), mode: 'lines', line: { width: 0 }, fill: 'toself',
        fillcolor: faded(own, 0.2), hoverinfo: 'skip', hovertemplate: undefined };
    }
    const data = { ...common, x: trace.x, y: trace.y };
    if (figure.categories.length) {
      data.customdata = trace.x.map((x) => (x === null ? '' : plain(figure.categories[Math.round(x)])));
    }
    if (trace.kind === 'bars') {
      return { ...data, type: 'bar', width: 0.92 * trace.width,
        marker: { color: faded(own, 0.85), line: { color: own, width: 1 },
          pattern: { shape: PATTERNS[trace.stroke], fgcolor: colour('paper'), size: 6 } } };
    }
    const symbol = trace.colour < 0 ? 'circle-open' : SYMBOLS[trace.marker];
    const stroke = DASHES[trace.style] ?? STROKES[trace.stroke];
    if (trace.kind === 'points') {
      const many = trace.x.length > 200;
      return { ...data, mode: 'markers',
        marker: { color: own, size: many ? 4 : 6.5, opacity: many ? 0.55 : 0.9,
          symbol },
        error_y: trace.error
          ? { type: 'data', array: trace.error, color: own, thickness: 1, width: 2.5 } : undefined };
    }
    const faint = trace.style === 'faint';
    const marked = new Set(all.map((other) => other.name)).size > MANY_SERIES && !faint && trace.kind !== 'loop';
    return { ...data, mode: marked ? 'lines+markers' : 'lines', connectgaps: false,
      ...(marked ? { marker: { color: own, symbol, size: 6, maxdisplayed: 9 } } : {}),
      line: { color: faint ? faded(own, 0.55) : own, width: faint ? 0.9 : trace.kind === 'loop' ? THIN : STROKE,
        dash: stroke, simplify: false } };
  };

  // The arrows of a path: each a marker that points away from the point before it.
  const arrowsOf = (trace, drawn) => {
    const points = trace.arrows.flatMap((arrow) => [...arrow, [null, null]]);
    return { ...drawn, x: points.map((p) => p[0]), y: points.map((p) => p[1]), mode: 'markers', showlegend: false,
      hoverinfo: 'skip', hovertemplate: undefined, meta: 'arrows',
      marker: { symbol: 'arrow', angleref: 'previous', color: drawn.line.color,
        size: points.map((_, i) => (i % 3 === 1 ? ARROW : 0)), line: { width: 0 } } };
  };

  // A logarithmic axis: over many decades each is marked, in plain numbers where these are short.
  const decades = (traces) => {
    const logs = traces.flatMap((t) => t.x).filter((x) => x > 0).map(Math.log10);
    const [low, high] = logs.reduce(([lo, hi], l) => [Math.min(lo, l), Math.max(hi, l)], [Infinity, -Infinity]);
    return { type: 'log', ...(high - low > 1.5 ? { dtick: 1, minor: { ticks: 'outside', ticklen: 2.5 } } : {}),
      ...(low > -4 && high < 5.5 ? { tickformat: '~g' } : {}) };
  };

  const layoutOf = (figure, colour) => {
    const traces = figure.traces;
    const count = Math.max(1, figure.y_labels.length);
    const gap = count > 1 ? 0.055 : 0;
    const x = parts(figure.x_label);
    const height = (1 - gap * (count - 1)) / count;
    const axis = {
      gridcolor: colour('grid'), linecolor: colour('rule'), showline: true, zeroline: true,
      zerolinecolor: colour('rule'), zerolinewidth: 1, ticks: 'outside', ticklen: 4, tickcolor: colour('rule'),
      exponentformat: 'power', automargin: true, hoverformat: '.5~g',
    };
    const layout = {
      font: { family: getComputedStyle(document.body).fontFamily, size: 12.5, color: colour('ink') },
      paper_bgcolor: 'rgba(0,0,0,0)', plot_bgcolor: 'rgba(0,0,0,0)',
      margin: { l: 70, r: 44, t: 40, b: 52 },
      modebar: { orientation: 'v', bgcolor: 'rgba(0,0,0,0)', color: faded(colour('muted'), 0.7), activecolor: colour('accent') },
      hovermode: figure.back_and_forth || figure.categories.length ? 'closest' : 'x unified',
      hoversubplots: 'axis',
      hoverlabel: { bgcolor: colour('paper'), bordercolor: colour('rule'), font: { color: colour('ink'), size: 12 } },
      showlegend: new Set(traces.map((t) => t.name)).size > 1,
      legend: { orientation: 'h', x: 0, xanchor: 'left', y: 1, yref: 'container', yanchor: 'top',
        bgcolor: 'rgba(0,0,0,0)', font: { size: 12.5 } },
      xaxis: { ...axis, ...(figure.log_x ? decades(traces) : {}), title: { text: plain(figure.x_label), standoff: 8 },
        anchor: count > 1 ? 'y' + count : 'y',
        unifiedhovertitle: { text: `${x.quantity} %{x:.5~g}${x.unit}` },
        ...(figure.categories.length ? { tickmode: 'array', tickvals: figure.categories.map((_, i) => i),
          ticktext: figure.categories.map(plain), range: [-0.5, figure.categories.length - 0.5],
          zeroline: false, showgrid: false } : {}),
        showspikes: !figure.back_and_forth && !figure.categories.length, spikemode: 'across', spikethickness: 1, spikedash: 'dot',
        spikecolor: colour('muted'), spikesnap: 'hovered data' },
    };
    figure.y_labels.forEach((label, panel) => {
      const top = 1 - panel * (height + gap);
      layout['yaxis' + (panel ? panel + 1 : '')] = {
        ...axis, title: { text: plain(label), standoff: 10 },
        domain: [Math.max(0, top - height), top], anchor: 'x', nticks: count > 2 ? 5 : 8,
      };
    });
    return layout;
  };

  // Rows of a legend that a figure's height has room for [px]; what is more makes the figure higher, not its curves lower.
  const LEGEND = 64;
  const places = [...document.querySelectorAll('.plot')];
  const heights = places.map((place) => parseFloat(place.style.height));

  // At once, without waiting: a printer waits for nobody.
  const draw = (place, size = {}) => {
    const height = size.height ?? heights[places.indexOf(place)];
    place.style.height = height + 'px';
    const done = drawIn(place, size);
    const more = Math.ceil((place._fullLayout.legend?._height ?? 0) - LEGEND);
    if (!(more > 0)) return done;
    place.style.height = height + more + 'px';
    const again = drawIn(place, { ...size, height: height + more });
    if (size.height === undefined) delete place.layout.height;
    return again;
  };

  const drawIn = (place, size) => {
    const number = place.id.slice('plot-'.length);
    const figure = JSON.parse(document.getElementById('data-' + number).textContent);
    const colour = colours();
    const traces = figure.traces.flatMap((trace, i, all) => {
      const drawn = toPlotly(trace, i, all, colour, figure);
      return trace.arrows ? [drawn, arrowsOf(trace, drawn)] : [drawn];
    });
    const done = Plotly.react(place, traces, { ...layoutOf(figure, colour), ...size },
      { ...CONFIG, toImageButtonOptions: { ...CONFIG.toImageButtonOptions, filename: 'figure-' + number } });
    // With these a printer may scale the drawing to the sheet, whatever that is.
    place.querySelectorAll('.main-svg').forEach((svg) => {
      // The figure says what it shows in words; its labels, one by one, would say nothing.
      svg.setAttribute('aria-hidden', 'true');
      svg.setAttribute('viewBox', `0 0 ${svg.getAttribute('width')} ${svg.getAttribute('height')}`);
    });
    place.style.setProperty('--shape', `${place._fullLayout.width} / ${place._fullLayout.height}`);
    return done;
  };

  const drawAll = async () => {
    for (const place of places) {
      try {
        await draw(place);
      } catch (error) {
        place.innerHTML = '<p class="failed">This figure could not be drawn.</p>';
        console.error(place.id, error);
      }
      // Lets the browser show what stands before the next one is drawn.
      await new Promise((resolve) => setTimeout(resolve));
    }
    document.documentElement.dataset.figures = 'drawn';
  };

  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', drawAll);
  // On paper: dark on white, as wide as the sheet, and lower, so that a figure rarely needs a page of its own.
  const lay = (printing) => {
    document.documentElement.toggleAttribute('data-print', printing);
    places.forEach((place, i) => {
      draw(place, printing ? { width: 680, height: 0.7 * heights[i] } : {});
    });
  };
  addEventListener('beforeprint', () => lay(true));
  addEventListener('afterprint', () => lay(false));
  drawAll();
})();
