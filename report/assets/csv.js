// Saves a figure's data or a table as CSV (RFC 4180), by the buttons beside them. Needs no network: the file is made here.
'use strict';
(() => {
  const cell = (value) => {
    const text = value === null || value === undefined ? '' : String(value);
    return /[",\r\n]/.test(text) ? '"' + text.replace(/"/g, '""') + '"' : text;
  };
  const csv = (rows) => rows.map((row) => row.map(cell).join(',')).join('\r\n') + '\r\n';

  // One row a point: its panel's axis, its series, and the values as they are drawn.
  const figure = (number) => {
    const data = JSON.parse(document.getElementById('data-' + number).textContent);
    const rows = [['panel', 'series', data.x_label, 'value', 'half_error_bar', 'upper_edge']];
    for (const trace of data.traces) {
      trace.x.forEach((x, i) => {
        const at = data.categories.length && x !== null ? data.categories[Math.round(x)] : x;
        rows.push([data.y_labels[trace.panel], trace.name, at, trace.y[i], trace.error?.[i], trace.upper?.[i]]);
      });
    }
    return csv(rows);
  };

  // Parts of a wide table stand below each other and begin with the same column: they become one.
  const table = (number) => {
    const rows = [];
    document.querySelectorAll(`#table-${number} table`).forEach((part, index) => {
      [...part.rows].forEach((row, r) => {
        const cells = [...row.cells].map((c) => {
          const copy = c.cloneNode(true);
          copy.querySelectorAll('.hidden').forEach((mark) => mark.remove());
          // Spaces that only align the points of numbers are left out.
          return copy.textContent.replace(/[\u2007\u2008]/g, '').trim();
        });
        rows[r] = (rows[r] ?? []).concat(index ? cells.slice(1) : cells);
      });
    });
    return csv(rows);
  };

  addEventListener('click', (event) => {
    const button = event.target.closest?.('button.csv');
    if (!button) return;
    const { figure: ofFigure, table: ofTable } = button.dataset;
    const text = ofFigure ? figure(ofFigure) : table(ofTable);
    const link = document.createElement('a');
    link.href = URL.createObjectURL(new Blob(['\ufeff' + text], { type: 'text/csv;charset=utf-8' }));
    link.download = (ofFigure ? 'figure-' + ofFigure : 'table-' + ofTable) + '.csv';
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  });
})();
