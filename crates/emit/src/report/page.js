// Reads figures off under the pointer, a finger or by the arrow keys; a double click or Enter enlarges one, Escape ends that. A stretch
// of time drawn with the mouse, or + and -, shows that stretch in all figures of the same times. Writes figures as SVG and their lines as
// CSV. Links and printing open what is folded.
(function () {
  'use strict';
  var reader = document.createElement('output');
  reader.className = 'reader';
  reader.hidden = true;
  document.body.appendChild(reader);
  function range(svg, name) { return svg.getAttribute(name).split(' ').map(Number); }
  // The box of the whole figure; what is shown of it may be less.
  function whole(svg) {
    svg.whole = svg.whole || { width: svg.viewBox.baseVal.width, height: svg.viewBox.baseVal.height };
    return svg.whole;
  }
  // The part of the axis at a part of what is shown.
  function across(svg, fx) {
    var shown = svg.viewBox.baseVal;
    return (shown.x + fx * shown.width) / whole(svg).width;
  }
  function short(v, r) {
    var step = Math.abs(r[1] - r[0]) / 500;
    var small = 1e-4 > step;
    if (small || Math.abs(v) >= 1e6) { return v.toExponential(3); }
    return v.toFixed(Math.max(0, Math.min(6, Math.ceil(-Math.log10(step)))));
  }
  // Corners of a line, `null` where it is broken; none if it runs back, as a portrait does.
  function corners(path) {
    var at = [0, 0];
    var all = [];
    var forward = true;
    var steps = path.getAttribute('d').matchAll(/([Ml])(-?\d+) ?(-?\d+)/g);
    for (var step of steps) {
      var to = [Number(step[2]), Number(step[3])];
      if (step[1] === 'M') { all.push(null); } else { to = [at[0] + to[0], at[1] + to[1]]; }
      forward = forward && to[0] >= at[0];
      all.push(to);
      at = to;
    }
    return forward ? all : [];
  }
  // Where a line is at a place across, if it is there; of dots the nearest.
  function height(path, x) {
    path.corners = path.corners || corners(path);
    var reach = path.classList.contains('dots') ? 20 : 0;
    for (var i = 1; path.corners.length > i; i += 1) {
      var a = path.corners[i - 1];
      var b = path.corners[i];
      if (b && reach && reach >= Math.abs(b[0] - x)) { return b[1]; }
      if (a && b && x >= a[0] && b[0] >= x) {
        return b[0] > a[0] ? a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0]) : b[1];
      }
    }
    return null;
  }
  function values(svg, fx, ry) {
    var box = whole(svg);
    var found = [];
    ['measured', 'simulated', 'residual', 'input', 'model'].forEach(function (name) {
      svg.querySelectorAll('path.' + name + ':not(.filled)').forEach(function (path) {
        var y = height(path, fx * box.width);
        if (y !== null) { found.push((path.dataset.name || name) + ' ' + short(ry[1] - y / box.height * (ry[1] - ry[0]), ry)); }
      });
    });
    return found.join(', ');
  }
  function show(svg, fx, fy, x, y) {
    var rx = range(svg, 'data-x');
    var ry = range(svg, 'data-y');
    var at = across(svg, fx);
    var text = short(rx[0] + at * (rx[1] - rx[0]), rx);
    var lines = values(svg, at, ry);
    if (lines) { text += ': ' + lines; }
    else if (fy !== null) { text += ', ' + short(ry[1] - fy * (ry[1] - ry[0]), ry); }
    reader.textContent = text;
    reader.hidden = false;
    reader.style.left = Math.min(x + 12, window.innerWidth - reader.offsetWidth - 4) + 'px';
    reader.style.top = Math.max(2, y - 28) + 'px';
  }
  function large(figure) {
    var was = figure.classList.contains('large');
    document.querySelectorAll('figure.large').forEach(function (f) { f.classList.remove('large'); });
    if (!was) { figure.classList.add('large'); }
  }
  // 1, 2 or 5 times a power of ten, so that about so many steps fit.
  function step(wide, most) {
    var power = Math.pow(10, Math.floor(Math.log10(wide / most)));
    var lead = wide / most / power;
    return (lead > 5 ? 10 : lead > 2 ? 5 : lead > 1 ? 2 : 1) * power;
  }
  // Shows a stretch of the axis across, both ends as parts of the whole, with round numbers of its own.
  function stretch(svg, from, to) {
    var box = whole(svg);
    var rx = range(svg, 'data-x');
    var plot = svg.closest('.plot');
    var below = plot.querySelector('.below');
    var grid = svg.querySelector('.grid');
    if (!svg.marks) { svg.marks = { below: below.innerHTML, grid: grid.getAttribute('d') }; }
    svg.setAttribute('viewBox', [from * box.width, 0, (to - from) * box.width, box.height].join(' '));
    if (from === 0) { if (to === 1) {
      below.innerHTML = svg.marks.below;
      grid.setAttribute('d', svg.marks.grid);
      return;
    } }
    var low = rx[0] + from * (rx[1] - rx[0]);
    var high = rx[0] + to * (rx[1] - rx[0]);
    var by = step(high - low, 6);
    var lines = svg.marks.grid.replace(/M-?\d+ 0v\d+/g, '');
    below.textContent = '';
    var last = Math.floor(high / by + 0.01);
    for (var k = Math.ceil(low / by - 0.01); last >= k; k += 1) {
      var label = document.createElement('span');
      label.style.left = 100 * (k * by - low) / (high - low) + '%';
      label.textContent = String(Number((k * by).toPrecision(12))).replace('-', '\u2212');
      below.appendChild(label);
      lines += 'M' + (k * by - rx[0]) / (rx[1] - rx[0]) * box.width + ' 0v' + box.height;
    }
    grid.setAttribute('d', lines);
  }
  // The figures over the same times move together.
  function together(svg, from, to) {
    var wide = Math.max(to - from, 0.001);
    from = Math.max(0, Math.min(1 - wide, from));
    document.querySelectorAll('#series svg[data-x]').forEach(function (other) {
      if (other.getAttribute('data-x') === svg.getAttribute('data-x')) { stretch(other, from, Math.min(1, from + wide)); }
    });
  }
  function zoomable(svg, at) {
    var begun = null;
    var mark = document.createElement('div');
    mark.className = 'stretch';
    function place(e) {
      var box = svg.getBoundingClientRect();
      return Math.max(0, Math.min(1, (e.clientX - box.left) / box.width));
    }
    svg.addEventListener('pointerdown', function (e) {
      if (e.pointerType !== 'mouse' || e.button !== 0) { return; }
      begun = place(e);
      svg.setPointerCapture(e.pointerId);
    });
    svg.addEventListener('pointermove', function (e) {
      if (begun === null) { return; }
      var box = svg.getBoundingClientRect();
      var frame = svg.closest('.plot').getBoundingClientRect();
      var ends = [begun, place(e)].sort(function (a, b) { return a - b; });
      svg.closest('.plot').appendChild(mark);
      mark.style.left = box.left - frame.left + ends[0] * box.width + 'px';
      mark.style.width = (ends[1] - ends[0]) * box.width + 'px';
      mark.style.top = box.top - frame.top + 'px';
      mark.style.height = box.height + 'px';
    });
    svg.addEventListener('pointerup', function (e) {
      if (begun === null) { return; }
      var ends = [begun, place(e)].sort(function (a, b) { return a - b; });
      begun = null;
      mark.remove();
      if (ends[1] - ends[0] > 0.01) { together(svg, across(svg, ends[0]), across(svg, ends[1])); }
    });
    svg.addEventListener('pointercancel', function () { begun = null; mark.remove(); });
    svg.addEventListener('keydown', function (e) {
      var shown = svg.viewBox.baseVal;
      var wide = shown.width / whole(svg).width;
      var by = { '+': 0.5, '=': 0.5, '-': 2, '0': 1e6 }[e.key];
      if (!by || e.ctrlKey || e.metaKey) { return; }
      wide = Math.min(1, wide * by);
      together(svg, across(svg, at()) - wide / 2, across(svg, at()) + wide / 2);
      e.preventDefault();
    });
  }
  document.querySelectorAll('svg[data-x]').forEach(function (svg) {
    var at = 0.5;
    var figure = svg.closest('figure');
    if (svg.closest('#series')) { zoomable(svg, function () { return at; }); }
    svg.setAttribute('tabindex', '0');
    ['pointermove', 'pointerdown'].forEach(function (name) {
      svg.addEventListener(name, function (e) {
        var box = svg.getBoundingClientRect();
        show(svg, (e.clientX - box.left) / box.width, (e.clientY - box.top) / box.height, e.clientX, e.clientY);
      });
    });
    svg.addEventListener('pointerleave', function () { reader.hidden = true; });
    svg.addEventListener('blur', function () { reader.hidden = true; });
    svg.addEventListener('dblclick', function () {
      if (svg.viewBox.baseVal.width !== whole(svg).width) { together(svg, 0, 1); return; }
      if (figure) { large(figure); }
    });
    svg.addEventListener('keydown', function (e) {
      var step = { ArrowLeft: -0.01, ArrowRight: 0.01 }[e.key];
      if (step) {
        at = Math.max(0, Math.min(1, at + step));
        var box = svg.getBoundingClientRect();
        show(svg, at, null, box.left + at * box.width, box.top);
        e.preventDefault();
      }
      if (e.key === 'Enter') { if (figure) { large(figure); } }
    });
  });
  function unfold(id) {
    var part = id && document.getElementById(id);
    var folded = part && part.querySelector('details');
    if (folded) { folded.open = true; }
  }
  window.addEventListener('hashchange', function () { unfold(location.hash.slice(1)); });
  document.querySelectorAll('a[href^="#"]').forEach(function (a) {
    a.addEventListener('click', function () { unfold(a.hash.slice(1)); });
  });
  window.addEventListener('beforeprint', function () {
    document.querySelectorAll('details').forEach(function (d) { d.open = true; });
  });
  function make(name, attributes, parent) {
    var made = document.createElementNS(document.querySelector('svg').namespaceURI, name);
    Object.keys(attributes).forEach(function (key) { made.setAttribute(key, attributes[key]); });
    if (parent) { parent.appendChild(made); }
    return made;
  }
  // A plot by itself, as large as on the page: its styles written out, its labels as text.
  function picture(plot) {
    var frame = plot.getBoundingClientRect();
    var svg = plot.querySelector('svg');
    var box = svg.getBoundingClientRect();
    var paper = getComputedStyle(document.documentElement).getPropertyValue('--paper').trim();
    var out = make('svg', { width: frame.width, height: frame.height, 'font-family': 'sans-serif', 'font-size': 11 });
    make('rect', { width: '100%', height: '100%', fill: paper }, out);
    var inner = svg.cloneNode(true);
    var to = inner.querySelectorAll('path, rect');
    svg.querySelectorAll('path, rect').forEach(function (from, i) {
      var style = getComputedStyle(from);
      ['fill', 'stroke', 'stroke-width', 'stroke-dasharray', 'stroke-linecap', 'opacity', 'vector-effect'].forEach(function (name) {
        to[i].setAttribute(name, style.getPropertyValue(name));
      });
    });
    var place = { x: box.left - frame.left, y: box.top - frame.top, width: box.width, height: box.height };
    Object.keys(place).forEach(function (key) { inner.setAttribute(key, place[key]); });
    out.appendChild(inner);
    plot.querySelectorAll('.beside span, .below span, .x-name, .y-name').forEach(function (label) {
      var at = label.getBoundingClientRect();
      var x = (at.left + at.right) / 2 - frame.left;
      var y = (at.top + at.bottom) / 2 - frame.top;
      var text = make('text', { x: x, y: y, 'text-anchor': 'middle', 'dominant-baseline': 'central', fill: getComputedStyle(label).color }, out);
      if (label.className === 'y-name') { text.setAttribute('transform', 'rotate(-90 ' + x + ' ' + y + ')'); }
      text.textContent = label.textContent;
    });
    return new XMLSerializer().serializeToString(out) + '\n';
  }
  // The corners of all lines in units of the axes, to the resolution of the figure.
  function table(svg) {
    var rx = range(svg, 'data-x');
    var ry = range(svg, 'data-y');
    var box = whole(svg);
    var out = 'line,x,y\n';
    svg.querySelectorAll('path:not(.grid):not(.filled)').forEach(function (path) {
      corners(path).forEach(function (at) {
        if (!at) { return; }
        var x = rx[0] + at[0] / box.width * (rx[1] - rx[0]);
        var y = ry[1] - at[1] / box.height * (ry[1] - ry[0]);
        out += (path.dataset.name || path.getAttribute('class').split(' ')[0]) + ',' + x.toPrecision(7) + ',' + y.toPrecision(7) + '\n';
      });
    });
    return out;
  }
  function save(name, kind, content) {
    var link = document.createElement('a');
    link.href = URL.createObjectURL(new Blob([content], { type: kind }));
    link.download = name;
    link.click();
    setTimeout(function () { URL.revokeObjectURL(link.href); }, 1000);
  }
  document.querySelectorAll('figure').forEach(function (figure) {
    var caption = figure.querySelector('figcaption');
    var plots = figure.querySelectorAll('.plot');
    if (!caption || !plots.length) { return; }
    var saves = document.createElement('span');
    saves.className = 'save';
    function button(word, act) {
      var b = document.createElement('button');
      b.type = 'button';
      b.textContent = word;
      b.addEventListener('click', act);
      saves.appendChild(b);
    }
    var name = (caption.textContent || 'figure').trim().split(/\s/)[0].replace(/[^\w-]/g, '') || 'figure';
    button('SVG', function () {
      plots.forEach(function (plot) { save(name + '.svg', 'image/svg+xml', picture(plot)); });
    });
    button('CSV', function () {
      plots.forEach(function (plot) { save(name + '.csv', 'text/csv', table(plot.querySelector('svg'))); });
    });
    caption.appendChild(saves);
  });
  document.addEventListener('keydown', function (e) {
    if (e.key === 'Escape') {
      document.querySelectorAll('figure.large').forEach(function (f) { f.classList.remove('large'); });
    }
  });
}());
